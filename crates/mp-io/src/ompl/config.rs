//! OMPL.app problem files, `.cfg`: the section `[problem]`.

use crate::problem::SpaceKind;
use mp_formats::error::{Error, ErrorKind};
use mp_formats::files::{MAX_TEXT_BYTES, read_file};
use mp_formats::text::{Text, Token, clipped};
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use std::collections::HashMap;
use std::path::Path;

/// A start or a goal, as an OMPL.app problem gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OmplState {
    /// x, y, z, metres; z is 0 in the plane.
    pub position: Point3<f64>,
    /// The angle, radians.
    pub theta: f64,
    /// The axis it turns about, of any length; Z in the plane. A zero axis means no rotation.
    pub axis: Vector3<f64>,
}

impl OmplState {
    /// The pose in the world (m).
    #[must_use]
    pub fn pose(&self) -> Isometry3<f64> {
        let rotation = match Unit::try_new(self.axis, f64::EPSILON) {
            Some(axis) => UnitQuaternion::from_axis_angle(&axis, self.theta),
            None => UnitQuaternion::identity(),
        };
        Isometry3::from_parts(Translation3::from(self.position.coords), rotation)
    }
}

/// The content of the section `[problem]` of an OMPL.app problem.
#[derive(Clone, Debug, PartialEq)]
pub struct OmplProblem {
    /// `name`: what the problem is called.
    pub name: Option<String>,
    /// `robot`: the mesh file of the robot.
    pub robot: String,
    /// `world`: the mesh file of the obstacles.
    pub world: Option<String>,
    /// The plane when neither z nor an axis is given, else space.
    pub space: SpaceKind,
    /// `start.*`: the pose of the robot at the start.
    pub start: OmplState,
    /// `goal.*`: the pose of the robot at the goal.
    pub goal: OmplState,
    /// `volume.min.*` and `volume.max.*`, when all of them are given: lowest x, y, z, highest x, y, z of the
    /// position; z is 0 in the plane.
    pub volume: Option<[f64; 6]>,
    /// `threshold`: a state within this distance of the goal counts as the goal.
    pub threshold: Option<f64>,
    /// `control`: the kind of a kinodynamic problem.
    pub control: Option<String>,
}

/// Where the parts of a problem are in its text.
#[derive(Debug)]
pub(super) struct Places<'a> {
    pub(super) robot: Token<'a>,
    pub(super) world: Option<Token<'a>>,
    pub(super) control: Option<Token<'a>>,
    pub(super) start: Token<'a>,
    pub(super) goal: Token<'a>,
}

impl OmplProblem {
    /// Reads the file `path`; the meshes it names are not opened.
    ///
    /// # Errors
    /// [`Error`] when it cannot be read or is not an OMPL.app problem.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        Self::parse(&path.display().to_string(), &read_file(path, MAX_TEXT_BYTES)?)
    }

    /// Reads `bytes`, the content of a file that errors call `file`.
    ///
    /// # Errors
    /// [`Error`] when it is not an OMPL.app problem, with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        Ok(parse(&Text::new(file, bytes, super::GUIDE)?)?.0)
    }
}

pub(super) fn parse<'a>(text: &Text<'a>) -> Result<(OmplProblem, Places<'a>), Error> {
    let section = Section::read(text)?;
    let robot = section.required("robot")?;
    let given = |key: &str| section.get(key).is_some();
    let spatial = ["z", "axis.x", "axis.y", "axis.z"];
    let space = match ["start", "goal"].iter().any(|s| spatial.iter().any(|k| given(&format!("{s}.{k}")))) {
        true => SpaceKind::Se3,
        false => SpaceKind::Se2,
    };
    let problem = OmplProblem {
        name: section.get("name").filter(|t| !t.text.is_empty()).map(|t| t.text.to_owned()),
        robot: robot.text.to_owned(),
        world: section.get("world").filter(|t| !t.text.is_empty()).map(|t| t.text.to_owned()),
        space,
        start: section.state("start", space)?,
        goal: section.state("goal", space)?,
        volume: section.volume(space)?,
        threshold: section.get("threshold").map(|t| text.number(t, "a distance")).transpose()?,
        control: section.get("control").filter(|t| !t.text.is_empty()).map(|t| t.text.to_owned()),
    };
    let places = Places {
        robot,
        world: section.get("world"),
        control: section.get("control"),
        start: section.required("start.x")?,
        goal: section.required("goal.x")?,
    };
    Ok((problem, places))
}

/// The keys and values of `[problem]`.
struct Section<'t, 'a> {
    text: &'t Text<'a>,
    title: Token<'a>,
    values: HashMap<String, Token<'a>>,
}

impl<'t, 'a> Section<'t, 'a> {
    fn read(text: &'t Text<'a>) -> Result<Self, Error> {
        let mut title = None;
        let mut inside = false;
        let mut values: HashMap<String, Token<'a>> = HashMap::new();
        for line in text.lines() {
            let end = line.text.find('#').unwrap_or(line.text.len());
            let line = Token { text: &line.text[..end], at: line.at }.trimmed();
            if line.text.is_empty() || line.text.starts_with(';') {
                continue;
            }
            if line.text.starts_with('[') {
                inside = line.text.eq_ignore_ascii_case("[problem]");
                if inside {
                    title = title.or(Some(line));
                }
                if !line.text.ends_with(']') {
                    return Err(text.error(line, "the title of a section does not end").expected("`]`"));
                }
                continue;
            }
            if !inside {
                continue;
            }
            let Some(equals) = line.text.find('=') else {
                let message = format!("`{}` has no value", clipped(line.text));
                return Err(text.error(line, message).expected("key = value"));
            };
            let key = Token { text: &line.text[..equals], at: line.at }.trimmed();
            let value = Token { text: &line.text[equals + 1..], at: line.at + equals + 1 }.trimmed();
            if values.insert(key.text.to_ascii_lowercase(), value).is_some() {
                return Err(text
                    .error(key, format!("`{}` is given twice", clipped(key.text)))
                    .expected("every key once")
                    .help("remove one of them"));
            }
        }
        let title = title.ok_or_else(|| {
            text.error_at_end("the section [problem]")
                .help("an OMPL.app problem begins with the line [problem]")
        })?;
        Ok(Self { text, title, values })
    }

    fn get(&self, key: &str) -> Option<Token<'a>> {
        self.values.get(key).copied()
    }

    fn required(&self, key: &str) -> Result<Token<'a>, Error> {
        self.get(key).filter(|t| !t.text.is_empty()).ok_or_else(|| {
            let place = self.get(key).unwrap_or(self.title);
            self.text.error(place, format!("[problem] has no `{key}`")).expected(format!("{key} = …"))
        })
    }

    fn number(&self, key: &str) -> Result<f64, Error> {
        self.text.number(self.required(key)?, &format!("{key} = a number"))
    }

    fn state(&self, which: &str, space: SpaceKind) -> Result<OmplState, Error> {
        let number = |key: &str| {
            self.number(&format!("{which}.{key}")).map_err(|e| self.explain_missing_key(e, which, space))
        };
        let (x, y, theta) = (number("x")?, number("y")?, number("theta")?);
        Ok(match space {
            SpaceKind::Se2 => OmplState { position: Point3::new(x, y, 0.0), theta, axis: Vector3::z() },
            SpaceKind::Se3 => OmplState {
                position: Point3::new(x, y, number("z")?),
                theta,
                axis: Vector3::new(number("axis.x")?, number("axis.y")?, number("axis.z")?),
            },
        })
    }

    /// Adds which keys belong together: a missing key may be due to a mixture of the two kinds of problems, or a goal that leaves
    /// numbers free may be meant.
    fn explain_missing_key(&self, e: Error, which: &str, space: SpaceKind) -> Error {
        let all = match space {
            SpaceKind::Se2 => "the goal needs x, y, theta",
            SpaceKind::Se3 => {
                "in space, start and goal each need x, y, z, theta, axis.x, axis.y, axis.z; in the plane x, y, theta"
            }
        };
        match (which, space) {
            ("goal", _) => {
                e.help(format!("{all}. Goals that leave numbers free are in rigid problems (.toml)"))
            }
            (_, SpaceKind::Se2) => e,
            (_, SpaceKind::Se3) => e.help(all),
        }
    }

    /// The volume; `None` when it is not complete.
    fn volume(&self, space: SpaceKind) -> Result<Option<[f64; 6]>, Error> {
        let axes: &[&str] = if space == SpaceKind::Se2 { &["x", "y"] } else { &["x", "y", "z"] };
        let complete = axes
            .iter()
            .all(|a| ["min", "max"].iter().all(|m| self.get(&format!("volume.{m}.{a}")).is_some()));
        if !complete {
            return Ok(None);
        }
        let mut out = [0.0; 6];
        for (i, axis) in axes.iter().enumerate() {
            out[i] = self.number(&format!("volume.min.{axis}"))?;
            out[i + 3] = self.number(&format!("volume.max.{axis}"))?;
            if out[i] > out[i + 3] {
                let place = self.required(&format!("volume.min.{axis}"))?;
                let message = format!("volume.min.{axis} is above volume.max.{axis}, {}", out[i + 3]);
                return Err(self
                    .text
                    .error(place, message)
                    .expected("the lower of the two")
                    .with_kind(ErrorKind::Content));
            }
        }
        Ok(Some(out))
    }
}
