//! Pictures of scenes and paths, made with `mp-render`.

#[cfg(feature = "pictures")]
pub(crate) mod film;
#[cfg(feature = "pictures")]
pub(crate) mod mp4;

use crate::{BodyShape, Error, PathRows, RelaxField, Scene, Sweep};
use mp_geom::TriMesh;
use mp_io::Content;
use mp_render::palette::{GOAL, INK, MIDDLE, OBSTACLE, PATH, START};
use mp_render::{Animation, Drawing, Item, Mode, Moment, View};
use nalgebra::{Isometry3, Point2, Point3};
use std::path::Path;

/// The default size of pictures, in pixels.
pub const PICTURE_SIZE: (usize, usize) = (1280, 960);

/// A format of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PictureKind {
    /// A PNG: pixels.
    Png,
    /// An SVG: lines and areas. Only for worlds in the plane.
    Svg,
}

/// How a picture or a film is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Width and height, pixels.
    pub size: (usize, usize),
    /// How bodies are drawn.
    pub mode: Mode,
    /// From where a scene in space is seen.
    pub view: View,
    /// The moment of the path that a picture shows, as a fraction of its length, 0 to 1; `None` shows all configurations at
    /// once. Films do not use it.
    pub at: Option<f64>,
    /// The field that pushes snakes, to be shown below a world in the plane.
    pub field: Option<RelaxField>,
}

/// Cells along the longer side of the image of a field.
const FIELD_CELLS: usize = 320;

impl Default for Look {
    fn default() -> Self {
        Self { size: PICTURE_SIZE, mode: Mode::default(), view: View::default(), at: None, field: None }
    }
}

impl Scene {
    /// The kind of picture for a file, by the ending of its name.
    ///
    /// # Errors
    /// When this scene cannot be drawn as such a file.
    pub fn picture_kind(&self, file: &Path) -> Result<PictureKind, Error> {
        let fits = |content| content == Content::Png || content == Content::Svg && self.is_planar_world();
        match Content::of(file).find(|content| content.is_shown()) {
            Some(Content::Png) => Ok(PictureKind::Png),
            Some(Content::Svg) if self.is_planar_world() => Ok(PictureKind::Svg),
            Some(Content::Svg) => {
                let what = format!("only worlds in the plane are drawn as .svg, not for {}", file.display());
                Err(Error::new(what).help(format!("end its name in {}", Content::endings(fits))))
            }
            _ => Err(Content::not_named(file, "a picture", fits).into()),
        }
    }

    /// The bytes of a picture of the scene, with the path if one is given, and `caption` below the name of the scene.
    ///
    /// # Errors
    /// When the path is of another robot, or the look does not suit this scene or is not possible.
    pub fn picture(
        &self,
        path: Option<&PathRows>,
        caption: &str,
        kind: PictureKind,
        look: &Look,
    ) -> Result<Vec<u8>, Error> {
        self.check_look(look, path.is_some())?;
        let now = match (path, look.at) {
            (Some(path), Some(at)) => self.track(path)?.at(at).map(|place| (place, at)),
            _ => None,
        };
        if self.is_planar_world() {
            let now = now.as_ref().map(|((poses, _), _)| poses.as_slice());
            let drawing = self.world(path, caption, look)?.drawing(now, None);
            return Ok(match kind {
                PictureKind::Svg => drawing.svg(look.size).map_err(failed)?.into_bytes(),
                PictureKind::Png => drawing.pixels(look.size).map_err(failed)?.to_png(),
            });
        }
        let scene = self.solid(path, caption, look)?;
        let Some(((poses, _), progress)) = now else {
            return Ok(scene.draw(look.size).map_err(failed)?.to_png());
        };
        let shot = scene.shot(look.size, Animation { step: true, ..Animation::default() }).map_err(failed)?;
        let moment =
            Moment { robot: placed_bodies(&self.robot_bodies(), &poses), progress, ..Moment::default() };
        Ok(shot.picture(&moment).map_err(failed)?.to_png())
    }

    /// Refuses a look that does not suit this scene, before any work is done. `path` says whether there is a path.
    ///
    /// # Errors
    /// When a moment of a path is asked for without a path, or a view in space of a world in the plane.
    pub fn check_look(&self, look: &Look, path: bool) -> Result<(), Error> {
        if let Some(at) = look.at {
            if !path {
                return Err(
                    Error::new("there is no path, of which a moment could be drawn").help("name a path")
                );
            }
            if !(0.0..=1.0).contains(&at) {
                return Err(Error::new(format!("{at} is not a moment of the path"))
                    .help("give a fraction of its length, from 0 to 1"));
            }
        }
        let from_above = "top".parse().ok();
        if self.is_planar_world() && look.view != View::Best && Some(look.view) != from_above {
            return Err(Error::new(format!(
                "{} is a world in the plane, which is seen from above",
                self.name()
            ))
            .help("leave out the camera"));
        }
        match look.field {
            Some(_) if !self.is_planar_world() => {
                Err(Error::new(format!("the field of {} is not drawn", self.name()))
                    .help("only that of a world of the plane is"))
            }
            Some(RelaxField::Risk(_)) if !path => {
                Err(Error::new("the landscape of risk is that of a path, and there is none")
                    .help("name a path"))
            }
            _ => Ok(()),
        }
    }

    /// A field as an image: from white, where it does not push, to red where it pushes as an obstacle that is touched.
    fn shades(&self, field: &RelaxField, path: Option<&PathRows>) -> Result<Vec<Item>, Error> {
        let image = self.field(field, &self.start(), path, None, FIELD_CELLS)?;
        let parts: Vec<f64> = image.energy.iter().map(|energy| 2.0 * energy).collect();
        Ok(Item::shades(image.origin.into(), image.cell, image.width, &parts))
    }

    /// The bodies of a robot in space, in their own frames.
    pub(crate) fn robot_bodies(&self) -> Vec<mp_render::Body> {
        let robot = self.bodies().into_iter().filter(|body| body.pose.is_none());
        let drawn = |body: crate::Body| match &body.shape {
            BodyShape::Mesh(mesh) => Some(mp_render::Body::new(mesh, Isometry3::identity())),
            _ => None,
        };
        robot.filter_map(drawn).collect()
    }

    /// The picture of a scene in space.
    pub(crate) fn solid(
        &self,
        path: Option<&PathRows>,
        caption: &str,
        look: &Look,
    ) -> Result<mp_render::Scene, Error> {
        let bodies = self.bodies();
        let mesh = |body: &crate::Body| match &body.shape {
            BodyShape::Mesh(mesh) => Some(mesh.clone()),
            _ => None,
        };
        let mut robot: Vec<TriMesh> = bodies.iter().filter(|b| b.pose.is_none()).filter_map(mesh).collect();
        let moving = robot.split_off(robot.len().saturating_sub(self.moving_obstacles()));
        let still = bodies.iter().filter_map(|body| Some(mp_render::Body::new(&mesh(body)?, body.pose?)));
        // A robot of one body is one model at many poses. A robot of several bodies is merged anew for each configuration.
        let single = match robot.as_slice() {
            [only] => Some(mp_render::Body::new(only, Isometry3::identity())),
            _ => None,
        };
        let shown = |poses: &Vec<Isometry3<f64>>| match (&single, &poses[..robot.len()]) {
            (Some(body), [pose]) => body.at(*pose),
            _ => {
                let placed: Vec<_> =
                    robot.iter().zip(poses).map(|(mesh, pose)| mesh.transformed(pose)).collect();
                TriMesh::merged(placed.iter()).map_or_else(
                    || mp_render::Body::point(poses.last().copied().unwrap_or_default()),
                    |mesh| mp_render::Body::new(&mesh, Isometry3::identity()),
                )
            }
        };
        let sweep = self.sweep(path)?;
        // Obstacles that move are drawn where they are at the start.
        let first = moving.iter().zip(&sweep.start[robot.len()..]);
        let still = still.chain(first.map(|(mesh, pose)| mp_render::Body::new(mesh, *pose)));
        Ok(mp_render::Scene {
            title: self.name().to_owned(),
            subtitle: caption.to_owned(),
            planar: self.is_planar(),
            obstacles: still.collect(),
            start: Some(shown(&sweep.start)),
            goal: Some(shown(&sweep.goal)),
            copies: sweep.between.iter().map(shown).collect(),
            trace: sweep.trace,
            bounds: self.picture_bounds(),
            mode: look.mode,
            view: look.view,
        })
    }

    /// What the pictures of a world in the plane have in common.
    pub(crate) fn world(&self, path: Option<&PathRows>, caption: &str, look: &Look) -> Result<World, Error> {
        let sweep = self.sweep(path)?;
        let (mut low, mut high) = match self.picture_bounds() {
            Some(bounds) => (bounds.min.xy(), bounds.max.xy()),
            None => (Point2::origin(), Point2::new(1.0, 1.0)),
        };
        let (mut robot, mut walls) = (Vec::new(), false);
        let mut items = match &look.field {
            Some(field) => self.shades(field, path)?,
            None => Vec::new(),
        };
        for body in self.bodies() {
            match (body.shape, body.pose) {
                (BodyShape::Area(rings), None) => robot.push(rings),
                (BodyShape::Area(rings), Some(pose)) => {
                    items.push(area(placed(&rings, &pose), OBSTACLE, look.mode));
                }
                (BodyShape::Lines(lines), Some(pose)) => {
                    walls = true;
                    let lines = placed(&lines, &pose);
                    for p in lines.iter().flatten() {
                        (low, high) = (low.inf(p), high.sup(p));
                    }
                    items.push(Item::lines(lines, INK, 4.0));
                }
                _ => {}
            }
        }
        if !walls {
            let frame = vec![low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y), low];
            items.push(Item::lines(vec![frame], OBSTACLE, 1.0));
        }
        let (title, subtitle) = (self.name().to_owned(), caption.to_owned());
        let moving = self.moving_obstacles().min(robot.len());
        Ok(World { title, subtitle, low, high, items, robot, moving, sweep, mode: look.mode })
    }
}

/// A world in the plane, ready to be drawn at many moments.
pub(crate) struct World {
    title: String,
    subtitle: String,
    low: Point2<f64>,
    high: Point2<f64>,
    /// Obstacles and walls.
    items: Vec<Item>,
    robot: Vec<Vec<Vec<Point2<f64>>>>,
    /// How many of the last of these are obstacles that move.
    moving: usize,
    sweep: Sweep,
    mode: Mode,
}

impl World {
    /// The drawing with all configurations at once, or with the robot at `now`. With `centre`, it shows the surroundings of
    /// that point.
    pub(crate) fn drawing(&self, now: Option<&[Isometry3<f64>]>, centre: Option<Point2<f64>>) -> Drawing {
        let at = |poses: &[Isometry3<f64>], colour: u32| {
            let robot = self.robot.iter().zip(poses).take(self.robot.len() - self.moving);
            let rings = robot.flat_map(|(rings, pose)| placed(rings, pose)).collect();
            area(rings, colour, self.mode)
        };
        let sweep = &self.sweep;
        let mut items = self.items.clone();
        // Obstacles that move are drawn where they are at the moment, or at start and goal.
        let obstacles = |poses: &[Isometry3<f64>], faint: f64| {
            let moving = self.robot.iter().zip(poses).skip(self.robot.len() - self.moving);
            let rings = moving.flat_map(|(rings, pose)| placed(rings, pose)).collect();
            area(rings, OBSTACLE, self.mode).faint(faint)
        };
        if self.moving > 0 {
            match now {
                Some(poses) => items.push(obstacles(poses, 1.0)),
                None => {
                    items.extend(sweep.between.iter().map(|poses| obstacles(poses, 0.12)));
                    items.extend([obstacles(&sweep.start, 0.8), obstacles(&sweep.goal, 0.35)]);
                }
            }
        }
        if now.is_none() {
            items.extend(sweep.between.iter().map(|poses| at(poses, MIDDLE).faint(0.3)));
        }
        items.push(Item::lines(vec![sweep.trace.iter().map(Point3::xy).collect()], PATH, 2.5));
        let ends = [at(&sweep.start, START), at(&sweep.goal, GOAL)];
        match now {
            None => items.extend(ends),
            Some(poses) => {
                items.extend(ends.map(|item| item.faint(0.4)));
                items.push(at(poses, MIDDLE));
            }
        }
        let (mut low, mut high) = (self.low, self.high);
        if let Some(centre) = centre {
            let half = (high - low).scale(1.0 / 6.0);
            (low, high) = (centre - half, centre + half);
        }
        Drawing { title: self.title.clone(), subtitle: self.subtitle.clone(), low, high, items }
    }
}

/// An area, filled, seen through or as its outline.
fn area(mut rings: Vec<Vec<Point2<f64>>>, colour: u32, mode: Mode) -> Item {
    match mode {
        Mode::Solid => Item::area(rings, colour),
        Mode::Transparent => Item::area(rings, colour).faint(0.4),
        Mode::Wire => {
            rings.iter_mut().for_each(|ring| ring.extend(ring.first().copied()));
            Item::lines(rings, colour, 1.5)
        }
    }
}

/// The bodies of a robot at poses.
pub(crate) fn placed_bodies(bodies: &[mp_render::Body], poses: &[Isometry3<f64>]) -> Vec<mp_render::Body> {
    bodies.iter().zip(poses).map(|(body, pose)| body.at(*pose)).collect()
}

/// An error of drawing.
pub(crate) fn failed(error: mp_render::RenderError) -> Error {
    match error {
        mp_render::RenderError::Memory { .. } => Error::new(error.to_string())
            .help("draw fewer pixels, or give the process more memory (`ulimit -v`)"),
        error => Error::new(error.to_string()),
    }
}

/// Rings or lines of the plane at a pose.
fn placed(rings: &[Vec<Point2<f64>>], pose: &Isometry3<f64>) -> Vec<Vec<Point2<f64>>> {
    let place = |p: &Point2<f64>| (pose * Point3::new(p.x, p.y, 0.0)).xy();
    rings.iter().map(|ring| ring.iter().map(place).collect()).collect()
}
