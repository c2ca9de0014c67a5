//! Problems in TOML as an editor changes them: obstacles that stand still, start and goals. All else of the text stays as it is.

use crate::changes::{quoted, with_ends};
use crate::document::DocumentShape;
use crate::toml_problem::TomlText;
use mp_formats::error::Error;
use mp_geom::planar::Polygon;
use mp_geom::{PRIMITIVES, Shape};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::Range;
use toml::{Spanned, Value};

/// The version written and read.
const VERSION: u32 = 1;
/// The page that describes documents.
const GUIDE: &str =
    "the documents of problems are described in docs/formats/session.md, “Documents of problems”";
/// Corners of a polygon around a circle that is not one in its file.
const CORNERS: usize = 32;
/// Members of an obstacle that are not its shape.
const PLACED: [&str; 4] = ["name", "pose", "at", "scale"];

/// What an editor changes of a problem in TOML. docs/formats/session.md describes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProblemDocument {
    /// The version of the format.
    pub version: u32,
    /// The name of the scene.
    pub name: String,
    /// Whether it is a world in the plane: its obstacles are rectangles, circles and polygons then.
    pub plane: bool,
    /// The start, in place of that of the text.
    #[serde(default)]
    pub start: Option<Vec<f64>>,
    /// The goals, in place of those of the text.
    #[serde(default)]
    pub goals: Option<Vec<Vec<f64>>>,
    /// The obstacles: first those of the text that are left, in their order, then new ones.
    pub obstacles: Vec<ProblemObstacle>,
}

/// An obstacle of a [`ProblemDocument`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProblemObstacle {
    /// What messages and the list of bodies call it.
    pub name: String,
    /// Which obstacle of the text it was, from 0; none when it is new.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<usize>,
    /// Its geometry before it is scaled.
    pub shape: ProblemShape,
    /// The scale along its own axes, each above zero; without, 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f64; 3]>,
    /// x, y, z (m), α, β, γ (rad); in the plane z, β and γ are not used.
    pub pose: [f64; 6],
}

/// A shape of a [`ProblemDocument`], about the origin of its body, metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ProblemShape {
    /// One that documents of rigid bodies have too. A mesh is not one of the text.
    Solid(DocumentShape),
    /// One of the plane, or of the text.
    Other(OtherShape),
}

/// The shapes of a [`ProblemDocument`] that documents of rigid bodies do not have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum OtherShape {
    /// The shape of an obstacle of the text, as it is there.
    Given {
        /// Which obstacle of the text has it, from 0.
        of: usize,
        /// What it is: `mesh`, `hull`, ….
        kind: String,
    },
    /// A disc of the plane.
    Circle {
        /// Its radius.
        radius: f64,
    },
    /// A rectangle of the plane.
    Rectangle {
        /// The lengths of its sides.
        size: [f64; 2],
    },
    /// An outline in the plane and its holes.
    Polygon {
        /// The outline, then each hole.
        rings: Vec<Vec<[f64; 2]>>,
    },
}

type Members = BTreeMap<String, Spanned<Value>>;

/// What is read of a text here. The readers of problems have checked it.
#[derive(Deserialize)]
struct Tables {
    world: Option<serde::de::IgnoredAny>,
    robot: Option<Value>,
    motion: Option<MotionTable>,
    #[serde(default)]
    moving: Vec<serde::de::IgnoredAny>,
    #[serde(default)]
    obstacle: Vec<Spanned<Members>>,
}

#[derive(Deserialize)]
struct MotionTable {
    start: Option<Value>,
    goal: Option<Value>,
}

impl Tables {
    fn read(file: &str, text: &str) -> Result<Self, Error> {
        TomlText { file, text, guide: GUIDE }.read()
    }

    /// How many numbers the start has, if it is a list.
    fn numbers_of_start(&self) -> Option<usize> {
        let start = self.motion.as_ref()?.start.as_ref()?;
        let start = start.as_array().or_else(|| start.get("numbers")?.as_array())?;
        Some(start.len()).filter(|length| *length > 0)
    }
}

impl Tables {
    /// The numbers of a configuration that the text has, if its start has `length`: the first ones. Velocities, which the configuration of a robot
    /// with accelerations has after the time, are of a start alone, where the text has them or the robot is not at rest.
    fn numbers_of(&self, row: &[f64], length: usize, is_start: bool) -> Vec<f64> {
        let kind = self.robot.as_ref().and_then(|robot| robot.get("kind")?.as_str());
        let timed = usize::from(!self.moving.is_empty());
        let n = row.len().saturating_sub(timed + 1) / 3;
        if kind != Some("accelerations") || row.len() != 3 * n + timed + 1 || ![n, 2 * n].contains(&length) {
            return row[..row.len().min(length)].to_vec();
        }
        let velocities = &row[n + timed..][..n];
        let moves = is_start && (length > n || velocities.iter().any(|v| *v != 0.0));
        [&row[..n], if moves { velocities } else { &[] }].concat()
    }
}

impl ProblemDocument {
    /// The document of the problem `text`, which errors call `file` and the document `name`.
    ///
    /// # Errors
    /// [`Error`] when the text is no TOML, or its obstacles are not tables of their own, `[[obstacle]]`.
    pub fn of_text(name: &str, file: &str, text: &str) -> Result<Self, Error> {
        let tables = Tables::read(file, text)?;
        for table in &tables.obstacle {
            region(file, text, table)?;
        }
        let plane = tables.world.is_some();
        let obstacles =
            tables.obstacle.iter().enumerate().map(|(i, table)| obstacle(i, table.get_ref(), plane));
        let obstacles = obstacles.collect();
        Ok(Self { version: VERSION, name: name.to_owned(), plane, start: None, goals: None, obstacles })
    }

    /// Whether the problem `text` leaves it to the program to choose its start or its goal.
    ///
    /// # Errors
    /// [`Error`] when the text, which errors call `file`, is no TOML.
    pub fn chooses_ends(file: &str, text: &str) -> Result<bool, Error> {
        let motion = Tables::read(file, text)?.motion;
        let open = |end: &Option<Value>| {
            end.as_ref().and_then(Value::as_array).is_some_and(|numbers| numbers.is_empty())
        };
        Ok(motion.is_some_and(|motion| open(&motion.start) || open(&motion.goal)))
    }

    /// The text of the edited problem: `text` is the one of which the document was made, and errors call it `file`. Obstacles that were
    /// not changed keep their lines. `mesh` names the files of meshes that the text does not have.
    ///
    /// # Errors
    /// [`Error`] when the document is of another version or of another text. Whether shapes and numbers make sense is for the readers of
    /// problems to say.
    pub fn applied(&self, file: &str, text: &str, mesh: &dyn Fn(&str) -> String) -> Result<String, Error> {
        let source = TomlText { file, text, guide: GUIDE };
        let wrong = |what: String, help: &str| Err(source.error(&(0..0), what).help(help));
        if self.version != VERSION {
            let what = format!("the document has version {}; this program reads {VERSION}", self.version);
            return wrong(what, "write it again with this program, or take a newer one");
        }
        let tables = Tables::read(file, text)?;
        let known = Self::of_text(&self.name, file, text)?;
        let kept: Vec<usize> = self.obstacles.iter().map_while(|o| o.of).collect();
        let new = &self.obstacles[kept.len()..];
        let sorted = kept.windows(2).all(|pair| pair[0] < pair[1]);
        if !sorted
            || new.iter().any(|o| o.of.is_some())
            || kept.last().is_some_and(|i| *i >= tables.obstacle.len())
        {
            let what = "the document is of another problem than this one".to_owned();
            return wrong(what, "open the problem that it was made from");
        }
        let mut out = text.to_owned();
        for (i, table) in tables.obstacle.iter().enumerate().rev() {
            let place = region(file, text, table)?;
            let Some(at) = kept.iter().position(|of| *of == i) else {
                out.replace_range(place, "");
                continue;
            };
            // A name that is given by counting is written as soon as it is counted otherwise.
            let named = at == i || table.get_ref().contains_key("name");
            if !named || self.obstacles[at] != known.obstacles[i] {
                out.replace_range(place, &self.lines(&self.obstacles[at], &tables, source, mesh)?);
            }
        }
        if !out.ends_with('\n') {
            out.push('\n');
        }
        for obstacle in new {
            out.push('\n');
            out += &self.lines(obstacle, &tables, source, mesh)?;
        }
        let length = tables.numbers_of_start().unwrap_or(usize::MAX);
        let row = |row: &Vec<f64>, is_start: bool| list(&tables.numbers_of(row, length, is_start));
        let goals: Vec<String> = self.goals.iter().flatten().map(|goal| row(goal, false)).collect();
        with_ends(file, &out, self.start.as_ref().map(|start| row(start, true)), &goals, false)
    }

    /// The table of an obstacle.
    fn lines(
        &self,
        obstacle: &ProblemObstacle,
        tables: &Tables,
        source: TomlText<'_>,
        mesh: &dyn Fn(&str) -> String,
    ) -> Result<String, Error> {
        let mut lines = vec!["[[obstacle]]".to_owned(), format!("name = {}", quoted(&obstacle.name))];
        if self.plane {
            lines.extend(obstacle.lines_of_plane(source)?);
            return Ok(lines.join("\n") + "\n");
        }
        match &obstacle.shape {
            ProblemShape::Solid(DocumentShape::Mesh { file, solid, .. }) => {
                lines.push(format!("mesh = {}", quoted(&mesh(file))));
                lines.extend(solid.then(|| "solid = true".to_owned()));
            }
            ProblemShape::Solid(figure) => match figure.figure() {
                Some(Shape::Primitive(kind, lengths)) if lengths.len() == 1 => {
                    lines.push(format!("{} = {}", kind.name, number(lengths[0])));
                }
                Some(Shape::Primitive(kind, lengths)) => {
                    lines.push(format!("{} = {}", kind.name, list(&lengths)))
                }
                _ => {}
            },
            ProblemShape::Other(OtherShape::Given { of, .. }) => {
                let given = tables.obstacle.get(*of).ok_or_else(|| {
                    source.error(
                        &(0..0),
                        format!("there is no obstacle {of} whose shape {} could have", obstacle.name),
                    )
                })?;
                let shape = given.get_ref().iter().filter(|(key, _)| !PLACED.contains(&key.as_str()));
                lines.extend(shape.map(|(key, value)| format!("{} = {}", key, inline(value.get_ref()))));
            }
            ProblemShape::Other(_) => {
                let message = format!("{} has a shape of the plane", obstacle.name);
                return Err(source.error(&(0..0), message).expected("a body in space"));
            }
        }
        let (place, angles) = obstacle.pose.split_at(3);
        lines.push(match angles == [0.0; 3] {
            true => format!("at = {}", list(place)),
            false => format!("pose = {}", list(&obstacle.pose)),
        });
        lines.extend(obstacle.scale.map(|scale| format!("scale = {}", list(&scale))));
        Ok(lines.join("\n") + "\n")
    }
}

impl ProblemObstacle {
    /// The outline and the holes of an obstacle of the plane, scaled, in its own frame; `None` when it has another shape, or sizes that are not
    /// above zero.
    #[must_use]
    pub fn rings(&self) -> Option<Vec<Vec<[f64; 2]>>> {
        let ProblemShape::Other(shape) = &self.shape else { return None };
        let points = |polygon: Polygon| -> Vec<Vec<[f64; 2]>> {
            polygon.rings().iter().map(|ring| ring.iter().map(|p| [p.x, p.y]).collect()).collect()
        };
        let rings = match shape {
            OtherShape::Given { .. } => return None,
            OtherShape::Circle { radius } => points(Polygon::around_circle([0.0; 2], *radius, CORNERS).ok()?),
            OtherShape::Rectangle { size: [x, y] } => {
                points(Polygon::rectangle([-0.5 * x, -0.5 * y], [0.5 * x, 0.5 * y]).ok()?)
            }
            OtherShape::Polygon { rings } => rings.clone(),
        };
        let [sx, sy, _] = self.scale.unwrap_or([1.0; 3]);
        Some(
            rings.into_iter().map(|ring| ring.into_iter().map(|[x, y]| [sx * x, sy * y]).collect()).collect(),
        )
    }

    /// The shape of an obstacle of the plane, where it is.
    fn lines_of_plane(&self, source: TomlText<'_>) -> Result<Vec<String>, Error> {
        let [x, y, _, angle, ..] = self.pose;
        let [sx, sy, _] = self.scale.unwrap_or([1.0; 3]);
        match &self.shape {
            ProblemShape::Other(OtherShape::Circle { radius }) if sx == sy => {
                return Ok(vec![format!("circle = {}", list(&[x, y, sx * radius]))]);
            }
            ProblemShape::Other(OtherShape::Rectangle { size: [w, h] }) if angle == 0.0 => {
                let (w, h) = (0.5 * sx * w, 0.5 * sy * h);
                let corners = [[x - w, y - h], [x + w, y + h]].map(|corner| list(&corner));
                return Ok(vec![format!("rectangle = [{}]", corners.join(", "))]);
            }
            _ => {}
        }
        let rings = self.rings().ok_or_else(|| {
            let message = format!("{} has no shape of the plane with sizes above zero", self.name);
            source.error(&(0..0), message).expected("a rectangle, a circle or a polygon, in metres")
        })?;
        let (sin, cos) = mp_math::sin_cos(angle);
        let placed = |[px, py]: &[f64; 2]| list(&[x + cos * px - sin * py, y + sin * px + cos * py]);
        let ring =
            |ring: &Vec<[f64; 2]>| format!("[{}]", ring.iter().map(placed).collect::<Vec<_>>().join(", "));
        let mut rings = rings.iter().map(ring);
        let mut lines = vec![format!("polygon = {}", rings.next().unwrap_or_else(|| "[]".to_owned()))];
        let holes: Vec<String> = rings.collect();
        if !holes.is_empty() {
            lines.push(format!("holes = [{}]", holes.join(", ")));
        }
        Ok(lines)
    }
}

/// The obstacle number `i` of a text.
fn obstacle(i: usize, members: &Members, plane: bool) -> ProblemObstacle {
    let value = |key: &str| members.get(key).map(Spanned::get_ref);
    let of = |key: &str| value(key).map(numbers);
    let name =
        value("name").and_then(Value::as_str).map_or_else(|| format!("obstacle {}", i + 1), str::to_owned);
    let mut pose = [0.0; 6];
    for (to, from) in pose.iter_mut().zip(of("pose").or_else(|| of("at")).unwrap_or_default()) {
        *to = from;
    }
    let mut scale = of("scale").and_then(|scale| scale.try_into().ok());
    let shape = if plane {
        scale = None;
        let (shape, place) = shape_of_plane(&of, value);
        (pose[0], pose[1]) = (place[0], place[1]);
        ProblemShape::Other(shape)
    } else {
        let figure =
            PRIMITIVES.iter().find_map(|kind| DocumentShape::of_primitive(kind.name, &of(kind.name)?));
        figure.map_or_else(
            || {
                let kind = members.keys().find(|key| crate::shape::names().any(|name| name == *key));
                ProblemShape::Other(OtherShape::Given { of: i, kind: kind.cloned().unwrap_or_default() })
            },
            ProblemShape::Solid,
        )
    };
    ProblemObstacle { name, of: Some(i), shape, scale, pose }
}

/// A shape of the plane about its middle, and where that is.
fn shape_of_plane<'v>(
    of: &dyn Fn(&str) -> Option<Vec<f64>>,
    value: impl Fn(&str) -> Option<&'v Value>,
) -> (OtherShape, [f64; 2]) {
    if let Some([x, y, radius]) = of("circle").as_deref() {
        return (OtherShape::Circle { radius: *radius }, [*x, *y]);
    }
    if let Some([a, b, c, d]) = of("rectangle").as_deref() {
        return (OtherShape::Rectangle { size: [c - a, d - b] }, [0.5 * (a + c), 0.5 * (b + d)]);
    }
    let ring = |ring: &Value| -> Vec<[f64; 2]> { numbers(ring).as_chunks::<2>().0.to_vec() };
    let holes = value("holes").and_then(Value::as_array).into_iter().flatten();
    let mut rings: Vec<Vec<[f64; 2]>> = value("polygon").into_iter().chain(holes).map(ring).collect();
    let middle = [0, 1].map(|k| {
        let along = || rings.first().into_iter().flatten().map(|point| point[k]);
        let (low, high) = (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
        0.5 * (low + high)
    });
    for point in rings.iter_mut().flatten() {
        *point = [point[0] - middle[0], point[1] - middle[1]];
    }
    (OtherShape::Polygon { rings }, middle)
}

/// All numbers in a value, in order.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Float(x) => vec![*x],
        Value::Integer(x) => vec![*x as f64],
        Value::Array(all) => all.iter().flat_map(numbers).collect(),
        _ => Vec::new(),
    }
}

/// The lines of an obstacle in a text, from its header to its last member.
fn region(file: &str, text: &str, table: &Spanned<Members>) -> Result<Range<usize>, Error> {
    let span = table.span();
    if !text[span.clone()].starts_with("[[") {
        let message = "the obstacles of this problem stand in one list";
        let help = "write each as a table of its own, `[[obstacle]]`: then the page can change them";
        return Err(TomlText { file, text, guide: GUIDE }.error(&span, message).help(help));
    }
    let start = text[..span.start].rfind('\n').map_or(0, |i| i + 1);
    let within =
        |at: usize| table.get_ref().values().any(|value| value.span().start < at && at < value.span().end);
    let mut end = span.end;
    let mut at = start;
    for line in text[start..].split_inclusive('\n') {
        let begins = at + line.len() - line.trim_start().len();
        if at > start && is_header(line) && !within(begins) {
            break;
        }
        at += line.len();
        // Comments at the end belong to what follows.
        if !line.trim().is_empty() && !line.trim_start().starts_with('#') {
            end = at;
        }
    }
    Ok(start..end)
}

/// Whether a line is the header of a table other than a part of an obstacle.
pub(crate) fn is_header(line: &str) -> bool {
    let line = line.trim_start();
    let inner = line.trim_start_matches('[').trim_start();
    let header =
        line.starts_with('[') && inner.starts_with(|c: char| c.is_alphabetic() || "_\"'".contains(c));
    header && !(inner.starts_with("obstacle") && inner[8..].trim_start().starts_with('.'))
}

/// A number with the fewest digits that read back to the same bits.
fn number(x: f64) -> String {
    let text = format!("{x:?}");
    text.strip_suffix(".0").map_or_else(|| text.clone(), str::to_owned)
}

fn list(numbers: &[f64]) -> String {
    format!("[{}]", numbers.iter().map(|x| number(*x)).collect::<Vec<_>>().join(", "))
}

/// A name of a member, quoted where it has to be.
fn bare(key: &str) -> String {
    let plain = !key.is_empty() && key.bytes().all(|b| b.is_ascii_alphanumeric() || b"-_".contains(&b));
    if plain { key.to_owned() } else { quoted(key) }
}

/// A value in one line.
pub(crate) fn inline(value: &Value) -> String {
    let joined = |parts: Vec<String>| parts.join(", ");
    match value {
        Value::String(text) => quoted(text),
        Value::Integer(x) => x.to_string(),
        Value::Float(x) => format!("{x:?}"),
        Value::Boolean(x) => x.to_string(),
        Value::Datetime(x) => x.to_string(),
        Value::Array(all) => format!("[{}]", joined(all.iter().map(inline).collect())),
        Value::Table(all) => {
            format!(
                "{{ {} }}",
                joined(all.iter().map(|(key, value)| format!("{} = {}", bare(key), inline(value))).collect())
            )
        }
    }
}

/// The names of files in a problem.
#[derive(Deserialize, Default)]
struct Names {
    urdf: Option<Spanned<Value>>,
    srdf: Option<Spanned<Value>>,
    packages: Option<Spanned<Value>>,
    map: Option<Spanned<Value>>,
    image: Option<Spanned<Value>>,
    mesh: Option<Spanned<Value>>,
    points: Option<PointNames>,
}

#[derive(Deserialize)]
struct PointNames {
    file: Option<Spanned<Value>>,
}

#[derive(Deserialize)]
struct AllNames<R> {
    robot: R,
    world: Option<Names>,
    #[serde(default)]
    obstacle: Vec<Names>,
    #[serde(default)]
    attached: Vec<Names>,
    #[serde(default)]
    moving: Vec<Names>,
}

/// The text of a problem, which errors call `file`, with other names for the files that it names: those that `name` gives.
///
/// # Errors
/// [`Error`] when it is no TOML.
pub fn with_file_names(
    file: &str,
    text: &str,
    name: &mut dyn FnMut(&str) -> Option<String>,
) -> Result<String, Error> {
    let source = TomlText { file, text, guide: GUIDE };
    let (robots, others) = match source.read::<AllNames<Names>>() {
        Ok(all) => (vec![all.robot], (all.world, all.obstacle, all.attached, all.moving)),
        Err(_) => {
            let all: AllNames<Vec<Names>> = source.read()?;
            (all.robot, (all.world, all.obstacle, all.attached, all.moving))
        }
    };
    let (world, obstacles, attached, moving) = others;
    let all = robots.into_iter().chain(world).chain(obstacles).chain(attached).chain(moving);
    let mut places: Vec<Spanned<Value>> = all
        .flat_map(|n| {
            [n.urdf, n.srdf, n.packages, n.map, n.image, n.mesh, n.points.and_then(|points| points.file)]
        })
        .flatten()
        .collect();
    places.sort_by_key(|place| std::cmp::Reverse(place.span().start));
    let mut out = text.to_owned();
    for place in places {
        if let Some(other) = place.get_ref().as_str().and_then(&mut *name) {
            out.replace_range(place.span(), &quoted(&other));
        }
    }
    Ok(out)
}
