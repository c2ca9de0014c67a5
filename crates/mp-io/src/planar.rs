//! Worlds in the plane: polygons, images and maps, a robot, a start and goals, in TOML.

mod problem;
mod ros_map;
#[cfg(test)]
mod tests;

pub use problem::PlanarProblem;
pub use ros_map::RosMap;

use crate::drive::{Drive, DriveTable, Driven};
use crate::toml_problem::{Exactly, GoalPart, MotionPlaces, MotionTable, Timing, TomlText, timed_rows};
use mp_formats::error::Error;
use mp_formats::files::decode;
use mp_geom::planar::Polygon;
use nalgebra::Point2;
use serde::Deserialize;
use std::ops::Range;
use toml::Spanned;

/// The page that describes the format.
const GUIDE: &str = "the format is described in docs/formats/planar-world.md";

/// Corners of a polygon around a circle.
const CORNERS: usize = 32;

/// A robot in the plane, in its own frame, metres.
#[derive(Clone, Debug, PartialEq)]
pub enum PlanarShape {
    /// A disc of this radius, which does not turn.
    Disc(f64),
    /// A polygon, which turns about the origin.
    Polygon(Polygon),
}

/// An obstacle of a [`PlanarFile`].
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarObstacle {
    /// Its name in messages.
    pub name: String,
    /// Its shape in the world, metres.
    pub polygon: Polygon,
}

/// An obstacle of a [`PlanarFile`] that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarMoving {
    /// Its name in messages.
    pub name: String,
    /// Its shape in its own frame, metres.
    pub polygon: Polygon,
    /// Where its frame is: time (s), x, y (m) and angle (rad), at increasing times.
    pub path: Vec<[f64; 4]>,
}

/// The image or map of a world, as the file names it.
#[derive(Clone, Debug, PartialEq)]
pub enum PlanarMap {
    /// An image with its scale.
    Image {
        /// The name of the image file.
        file: String,
        /// Metres per pixel.
        scale: f64,
        /// The lower left corner, metres.
        origin: [f64; 2],
        /// Pixels darker than this are obstacles; 0 is black, 1 white.
        threshold: f64,
    },
    /// The name of a map file of ROS's map_server.
    Ros(String),
}

/// The content of a file of a world in the plane; the files that it names are not yet read.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarFile {
    /// Lower and upper corner of walls around everything.
    pub walls: Option<[[f64; 2]; 2]>,
    /// Lower and upper corner of the region in which the origin of the robot may be.
    pub bounds: Option<[[f64; 2]; 2]>,
    /// An image whose dark pixels are obstacles.
    pub map: Option<PlanarMap>,
    /// Whether the unknown pixels of a ROS map are free, and what is outside of it or of an image.
    pub unknown_is_free: bool,
    /// The polygons.
    pub obstacles: Vec<PlanarObstacle>,
    /// The obstacles that move.
    pub moving: Vec<PlanarMoving>,
    /// The shape of the robot.
    pub robot: PlanarShape,
    /// How the robot moves, if it moves by inputs.
    pub driven: Option<Driven>,
    /// When the robot moves, if there are obstacles that move.
    pub timing: Option<Timing>,
    /// The start: x and y, and for a polygon the angle (rad). For a robot with accelerations, its velocities may follow.
    pub start: Vec<f64>,
    /// What each goal asks of each number, at least one goal.
    pub goals: Vec<Vec<GoalPart>>,
    places: Places,
    text: String,
    file: String,
}

/// Where things are in the text.
#[derive(Clone, Debug, PartialEq)]
struct Places {
    world: Range<usize>,
    map: Range<usize>,
    robot: Range<usize>,
    motion: MotionPlaces,
}

/// A part of a [`PlanarFile`] that an error can point at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanarPart {
    /// The table `world`.
    World,
    /// The name of the image or map.
    Map,
    /// The table `robot`.
    Robot,
    /// The start configuration.
    Start,
    /// The goal of this index.
    Goal(usize),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    world: Spanned<WorldTable>,
    robot: Spanned<RobotTable>,
    motion: MotionTable,
    #[serde(default)]
    obstacle: Vec<Spanned<ObstacleTable>>,
    #[serde(default)]
    moving: Vec<Spanned<MovingTable>>,
}

type Corners = Spanned<Exactly<Exactly<f64, 2>, 2>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WorldTable {
    walls: Option<Corners>,
    bounds: Option<Corners>,
    image: Option<Spanned<String>>,
    scale: Option<Spanned<f64>>,
    origin: Option<Spanned<Exactly<f64, 2>>>,
    threshold: Option<Spanned<f64>>,
    map: Option<Spanned<String>>,
    unknown: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotTable {
    disc: Option<Spanned<f64>>,
    polygon: Option<Spanned<Vec<Exactly<f64, 2>>>>,
    kind: Option<Spanned<String>>,
    duration: Option<Spanned<f64>>,
    speed: Option<Spanned<f64>>,
    turning: Option<Spanned<f64>>,
    wheelbase: Option<Spanned<f64>>,
    steering: Option<Spanned<f64>>,
    turning_radius: Option<Spanned<f64>>,
    reverse: Option<Spanned<bool>>,
    speeds: Option<Spanned<Vec<f64>>>,
    accelerations: Option<Spanned<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MovingTable {
    name: Option<String>,
    polygon: Option<Spanned<Vec<Exactly<f64, 2>>>>,
    #[serde(default)]
    holes: Vec<Spanned<Vec<Exactly<f64, 2>>>>,
    rectangle: Option<Corners>,
    circle: Option<Spanned<Exactly<f64, 3>>>,
    path: Spanned<Vec<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObstacleTable {
    name: Option<String>,
    polygon: Option<Spanned<Vec<Exactly<f64, 2>>>>,
    #[serde(default)]
    holes: Vec<Spanned<Vec<Exactly<f64, 2>>>>,
    rectangle: Option<Corners>,
    circle: Option<Spanned<Exactly<f64, 3>>>,
}

impl PlanarFile {
    /// Reads `bytes`, the content of a world in the plane that errors call `file`. No other file is read.
    ///
    /// # Errors
    /// [`Error`] when it is not a world in the plane, with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = decode(file, bytes)?;
        let source = TomlText { file, text, guide: GUIDE };
        let File { world, robot, motion, obstacle, moving } = source.read()?;
        let world_span = world.span();
        let world = world.into_inner();
        let walls = corners(&source, "the walls", world.walls.as_ref())?;
        let bounds = corners(&source, "the bounds", world.bounds.as_ref())?;
        let unknown_is_free = match world.unknown.as_ref().map(|u| u.get_ref().as_str()) {
            None | Some("obstacle") => false,
            Some("free") => true,
            Some(_) => {
                let span = world.unknown.as_ref().map_or(0..0, Spanned::span);
                let message = "what is unknown is neither obstacle nor free";
                return Err(source.error(&span, message).expected("`unknown = \"obstacle\"` or `\"free\"`"));
            }
        };
        let map_span = world.image.as_ref().or(world.map.as_ref()).map_or(0..0, Spanned::span);
        let map = map_of(&source, world, &map_span)?;
        let robot_span = robot.span();
        let (body, driven) = body(&source, robot)?;
        let names = ["x", "y", "yaw"].map(str::to_owned);
        let names = &names[..if matches!(body, PlanarShape::Disc(_)) { 2 } else { 3 }];
        if let Some(driven) = &driven {
            let wrong = driven.check(names);
            wrong.map_err(|[message, expected]| source.error(&robot_span, message).expected(expected))?;
        }
        let state_names = driven.as_ref().map_or_else(|| names.to_vec(), |driven| driven.state_names(names));
        let state = |what: &str, q: &Spanned<Vec<f64>>| {
            source.check(what, q.get_ref(), &q.span())?;
            if [names.len(), state_names.len()].contains(&q.get_ref().len()) {
                return Ok(());
            }
            let message = format!("{what} has {} numbers", q.get_ref().len());
            let expected =
                if names.len() == 2 { "x and y: a disc does not turn" } else { "x, y and the angle" };
            Err(source.error(&q.span(), message).expected(expected))
        };
        let motion = motion.read(&source, driven.is_some() && !moving.is_empty(), state)?;
        let goals = motion.goals.iter().enumerate().map(|(i, goal)| {
            let parts = goal.parts("the goal", &state_names, names.len(), motion.tolerance);
            let place = motion.places.goal(i);
            parts.map_err(|[message, expected]| source.error(place, message).expected(expected))
        });
        let goals: Vec<Vec<GoalPart>> = goals.collect::<Result<_, _>>()?;
        check_reachable(&source, driven.is_some(), &motion.places, &goals)?;
        let obstacles = obstacle.into_iter().enumerate().map(|(i, o)| entry(&source, i, o));
        let moving = moving.into_iter().enumerate().map(|(i, m)| moving_entry(&source, i, m));
        let moving: Vec<PlanarMoving> = moving.collect::<Result<_, _>>()?;
        check_timing(&source, moving.len(), motion.timing.is_some(), &motion.places)?;
        Ok(Self {
            walls,
            bounds,
            map,
            unknown_is_free,
            obstacles: obstacles.collect::<Result<_, _>>()?,
            moving,
            robot: body,
            driven,
            timing: motion.timing,
            start: motion.start,
            goals,
            places: Places { world: world_span, map: map_span, robot: robot_span, motion: motion.places },
            text: text.to_owned(),
            file: file.to_owned(),
        })
    }

    /// An error about a part of the file, for faults that are found only when the world is made.
    #[must_use]
    pub fn fault(&self, part: PlanarPart, message: &str, help: &str) -> Error {
        let span = match part {
            PlanarPart::World => &self.places.world,
            PlanarPart::Map => &self.places.map,
            PlanarPart::Robot => &self.places.robot,
            PlanarPart::Start => &self.places.motion.start,
            PlanarPart::Goal(i) => self.places.motion.goal(i),
        };
        TomlText { file: &self.file, text: &self.text, guide: GUIDE }.error(span, message).help(help)
    }
}

fn corners(
    source: &TomlText<'_>,
    what: &str,
    given: Option<&Corners>,
) -> Result<Option<[[f64; 2]; 2]>, Error> {
    let Some(given) = given else { return Ok(None) };
    let (Exactly([Exactly(low), Exactly(high)]), span) = (*given.get_ref(), given.span());
    source.check(what, &[low, high].concat(), &span)?;
    if low[0] < high[0] && low[1] < high[1] {
        return Ok(Some([low, high]));
    }
    let message =
        format!("{what} from ({}, {}) to ({}, {}) enclose nothing", low[0], low[1], high[0], high[1]);
    Err(source.error(&span, message).expected("the lower left corner, then the upper right"))
}

/// The image or map. Refuses settings of an image where there is none.
fn map_of(
    source: &TomlText<'_>,
    world: WorldTable,
    place: &Range<usize>,
) -> Result<Option<PlanarMap>, Error> {
    let of_image = [
        ("scale", world.scale.as_ref().map(Spanned::span)),
        ("origin", world.origin.as_ref().map(Spanned::span)),
        ("threshold", world.threshold.as_ref().map(Spanned::span)),
    ];
    let stray = of_image.iter().find_map(|(name, span)| Some((name, span.clone()?)));
    match (world.image, world.map, stray) {
        (Some(_), Some(map), _) => {
            let message = "there is an image and a map";
            Err(source.error(&map.span(), message).expected("`image` or `map`, not both"))
        }
        (None, _, Some((name, span))) => {
            let message = format!("`{name}` belongs to an image, and there is none");
            Err(source.error(&span, message).expected("`image = \"FILE\"` beside it"))
        }
        (None, map, None) => Ok(map.map(|name| PlanarMap::Ros(name.into_inner()))),
        (Some(image), None, _) => {
            let Some(scale) = world.scale else {
                let message = "the image has no scale";
                return Err(source.error(place, message).expected("`scale = METRES_PER_PIXEL`"));
            };
            source.positive("the scale", &[*scale.get_ref()], &scale.span())?;
            let origin = match world.origin {
                Some(origin) => {
                    source.check("the origin", &origin.get_ref().0, &origin.span())?;
                    origin.into_inner().0
                }
                None => [0.0; 2],
            };
            let threshold = match world.threshold {
                Some(t) if (0.0..=1.0).contains(t.get_ref()) => t.into_inner(),
                Some(t) => {
                    let message = format!("the threshold is {}", t.get_ref());
                    return Err(source
                        .error(&t.span(), message)
                        .expected("a number from 0 (black) to 1 (white)"));
                }
                None => 0.5,
            };
            Ok(Some(PlanarMap::Image {
                file: image.into_inner(),
                scale: scale.into_inner(),
                origin,
                threshold,
            }))
        }
    }
}

/// The shape of the robot, and how it moves by inputs.
fn body(source: &TomlText<'_>, robot: Spanned<RobotTable>) -> Result<(PlanarShape, Option<Driven>), Error> {
    let span = robot.span();
    let robot = robot.into_inner();
    let shape = match (robot.disc, robot.polygon) {
        (Some(radius), None) => {
            source.positive("the radius", &[*radius.get_ref()], &radius.span())?;
            PlanarShape::Disc(radius.into_inner())
        }
        (None, Some(ring)) => PlanarShape::Polygon(polygon(source, "the robot", vec![ring])?),
        _ => {
            let message = "the robot is not exactly one of a disc and a polygon";
            return Err(source
                .error(&span, message)
                .expected("`disc = RADIUS` or `polygon = [[x, y], ...]`"));
        }
    };
    let table = DriveTable {
        kind: robot.kind,
        duration: robot.duration,
        speed: robot.speed,
        turning: robot.turning,
        wheelbase: robot.wheelbase,
        steering: robot.steering,
        turning_radius: robot.turning_radius,
        reverse: robot.reverse,
        speeds: robot.speeds,
        accelerations: robot.accelerations,
    };
    let driven = table.read(source, &span, &["car", "unicycle", "velocities", "accelerations"])?;
    // A car and a unicycle have a direction, so that their shape turns, round as it may be.
    let heads =
        driven.as_ref().is_some_and(|d| matches!(d.drive, Drive::Car { .. } | Drive::Unicycle { .. }));
    Ok(match shape {
        PlanarShape::Disc(radius) if heads => {
            let round = Polygon::around_circle([0.0; 2], radius, CORNERS);
            let round =
                round.map_err(|e| source.error(&span, format!("the robot: {e}")).expected("a radius"));
            (PlanarShape::Polygon(round?), driven)
        }
        shape => (shape, driven),
    })
}

/// Refuses goals that a robot moved by inputs cannot reach exactly.
fn check_reachable(
    source: &TomlText<'_>,
    driven: bool,
    places: &MotionPlaces,
    goals: &[Vec<GoalPart>],
) -> Result<(), Error> {
    let exact = |parts: &Vec<GoalPart>| parts.iter().any(|part| matches!(part, GoalPart::Exactly(_)));
    match (driven, goals.iter().position(exact), &places.tolerance) {
        (true, Some(i), _) => {
            let message = "a robot that moves by inputs cannot reach these numbers exactly";
            Err(source
                .error(places.goal(i), message)
                .expected("`tolerance = 0.1` in [motion], or intervals: { x = [1.0, 1.2] }"))
        }
        (false, _, Some(place)) => {
            let message = "only robots that move by inputs need a tolerance";
            Err(source
                .error(place, message)
                .expected("intervals in the goal: { x = [1.0, 1.2] }, or no tolerance"))
        }
        _ => Ok(()),
    }
}

/// Refuses obstacles that move without a speed of the robot, and a speed without them.
fn check_timing(
    source: &TomlText<'_>,
    moving: usize,
    timed: bool,
    places: &MotionPlaces,
) -> Result<(), Error> {
    match (moving, timed, &places.speed) {
        (1.., false, _) => {
            let message = "obstacles move, and the robot has no speed";
            Err(source.error(&places.start, message).expected("`speed = METRES_PER_SECOND` in [motion]"))
        }
        (0, true, Some(place)) => {
            let message = "the robot has a speed, and nothing else moves";
            Err(source.error(place, message).expected("obstacles that move: `[[moving]]`, or no speed"))
        }
        _ => Ok(()),
    }
}

/// The obstacle of a table that moves.
fn moving_entry(
    source: &TomlText<'_>,
    index: usize,
    table: Spanned<MovingTable>,
) -> Result<PlanarMoving, Error> {
    let span = table.span();
    let MovingTable { name, polygon, holes, rectangle, circle, path } = table.into_inner();
    let name = name.unwrap_or_else(|| format!("moving obstacle {}", index + 1));
    let shape = ObstacleTable { name: Some(name), polygon, holes, rectangle, circle };
    let PlanarObstacle { name, polygon } = shaped(source, index, span, shape)?;
    let shown = mp_formats::text::clipped(&name).to_string();
    let rows = timed_rows(
        source,
        &shown,
        &path,
        [3, 1],
        "rows [TIME, x, y] or [TIME, x, y, ANGLE], times increasing",
    )?;
    let path = rows.iter().map(|row| [row[0], row[1], row[2], row[3]]).collect();
    Ok(PlanarMoving { name, polygon, path })
}

/// The polygon of these rings; `what` is its name in errors.
fn polygon(
    source: &TomlText<'_>,
    what: &str,
    rings: Vec<Spanned<Vec<Exactly<f64, 2>>>>,
) -> Result<Polygon, Error> {
    let mut points = Vec::new();
    let mut whole = 0..0;
    for (i, ring) in rings.into_iter().enumerate() {
        let span = ring.span();
        let ring: Vec<[f64; 2]> = ring.into_inner().into_iter().map(|point| point.0).collect();
        source.check(what, &ring.concat(), &span)?;
        if ring.len() < 3 {
            let message = format!("{what} has a ring of {} points", ring.len());
            return Err(source.error(&span, message).expected("at least three points"));
        }
        if i == 0 {
            whole = span;
        }
        points.push(ring.into_iter().map(Point2::from).collect());
    }
    Polygon::new(points).map_err(|e| source.error(&whole, format!("{what}: {e}")).expected("a polygon"))
}

/// The obstacle of a table.
fn entry(
    source: &TomlText<'_>,
    index: usize,
    table: Spanned<ObstacleTable>,
) -> Result<PlanarObstacle, Error> {
    let span = table.span();
    shaped(source, index, span, table.into_inner())
}

/// The obstacle of the table at `span`.
fn shaped(
    source: &TomlText<'_>,
    index: usize,
    span: Range<usize>,
    table: ObstacleTable,
) -> Result<PlanarObstacle, Error> {
    let name = table.name.unwrap_or_else(|| format!("obstacle {}", index + 1));
    let shown = mp_formats::text::clipped(&name).to_string();
    let made = |span: &Range<usize>, made: Result<Polygon, mp_geom::planar::PolygonError>| {
        made.map_err(|e| source.error(span, format!("{shown}: {e}")).expected("sizes above zero, in metres"))
    };
    let polygon = match (table.polygon, table.rectangle, table.circle) {
        (Some(outline), None, None) => {
            let rings = [outline].into_iter().chain(table.holes).collect();
            return Ok(PlanarObstacle { polygon: polygon(source, &shown, rings)?, name });
        }
        (None, Some(rectangle), None) => {
            let span = rectangle.span();
            match corners(source, "the rectangle", Some(&rectangle))? {
                Some([low, high]) => made(&span, Polygon::rectangle(low, high))?,
                None => return Err(source.error(&span, format!("{shown} has no corners"))),
            }
        }
        (None, None, Some(circle)) => {
            let Exactly([x, y, radius]) = *circle.get_ref();
            source.check("the circle", &[x, y, radius], &circle.span())?;
            made(&circle.span(), Polygon::around_circle([x, y], radius, CORNERS))?
        }
        _ => {
            let message = format!("{shown} needs exactly one shape");
            return Err(source.error(&span, message).expected("one of `polygon`, `rectangle`, `circle`"));
        }
    };
    match table.holes.first() {
        None => Ok(PlanarObstacle { name, polygon }),
        Some(hole) => {
            let message = format!("{shown} has holes, but is not a polygon");
            Err(source.error(&hole.span(), message).expected("`holes` beside `polygon` only"))
        }
    }
}
