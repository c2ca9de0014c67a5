//! The tables `robot` of robot problems: each a robot.

use crate::drive::{DriveTable, Driven};
use crate::toml_problem::{Exactly, TomlText};
use mp_formats::error::Error;
use mp_geom::pose_from_six;
use nalgebra::Isometry3;
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::Range;
use toml::Spanned;

/// Which joints move, where not all do.
#[derive(Clone, Debug, PartialEq)]
pub enum MovingJoints {
    /// Those of a group of the SRDF.
    Group(String),
    /// These.
    Listed(Vec<String>),
}

/// A robot of a [`RobotFile`](super::RobotFile).
#[derive(Clone, Debug, PartialEq)]
pub struct RobotEntry {
    /// What its links and joints are called after, if there are several: `left/elbow`.
    pub name: Option<String>,
    /// The name of the URDF file.
    pub urdf: String,
    /// The name of the SRDF file.
    pub srdf: Option<String>,
    /// Whether the robot has no SRDF (`srdf = false`): then none is looked for either.
    pub without_srdf: bool,
    /// The folder that `package://` means.
    pub packages: Option<String>,
    /// The pose of the root link, six numbers; zeros if the base floats.
    pub base: [f64; 6],
    /// The lower and the upper corner (m) of the box in which the origin of the root link moves, if the base floats.
    pub floating: Option<[[f64; 3]; 2]>,
    /// The lower and the upper corner (m) of the rectangle in which the origin of the root link moves, if the base moves in the plane.
    pub planar: Option<[[f64; 2]; 2]>,
    /// Whether the meshes of the robot are solids; other shapes always are.
    pub solid: bool,
    /// Limits that replace those of the URDF, by joint. Equal ones hold the joint.
    pub limits: Vec<(String, [f64; 2])>,
    /// Joints that are held, and where (rad or m).
    pub hold: Vec<(String, f64)>,
    /// Which joints move; all that are not held when it is not given.
    pub moving: Option<MovingJoints>,
    /// How far (rad or m) the start may be beyond a limit; 0 when it is not given.
    pub limit_tolerance: f64,
    /// Limits of velocity (rad/s or m/s), acceleration (per s²) and jerk (per s³), in place of what the URDF says: of all joints where there is no
    /// name. Later ones count.
    pub max_rates: [Vec<(Option<String>, f64)>; 3],
    /// How the robot moves, if it moves by inputs.
    pub driven: Option<Driven>,
    pub(super) places: RobotPlaces,
}

impl RobotEntry {
    /// The pose of the root link in the world, if the base stands still.
    #[must_use]
    pub fn pose(&self) -> Isometry3<f64> {
        pose_from_six(self.base)
    }
}

/// Where things of a robot are in the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RobotPlaces {
    pub(super) urdf: Range<usize>,
    pub(super) srdf: Range<usize>,
    pub(super) robot: Range<usize>,
    pub(super) base: Range<usize>,
    pub(super) limits: Vec<Range<usize>>,
    pub(super) hold: Vec<Range<usize>>,
    pub(super) moving: Range<usize>,
    pub(super) rates: [Range<usize>; 3],
}

impl RobotPlaces {
    pub(super) fn of(&self, part: RobotPart) -> &Range<usize> {
        match part {
            RobotPart::Srdf => &self.srdf,
            RobotPart::Robot => &self.robot,
            RobotPart::Base => &self.base,
            RobotPart::Moving => &self.moving,
            RobotPart::Rates(i) => self.rates.get(i).unwrap_or(&self.urdf),
            RobotPart::Limits(i) => self.limits.get(i).unwrap_or(&self.urdf),
            RobotPart::Hold(i) => self.hold.get(i).unwrap_or(&self.urdf),
            RobotPart::Urdf => &self.urdf,
        }
    }
}

/// A part of a robot in a [`RobotFile`](super::RobotFile) that an error can point at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotPart {
    /// The entry that names the URDF.
    Urdf,
    /// The entry that names the SRDF.
    Srdf,
    /// The table `robot`.
    Robot,
    /// The entry that places the base.
    Base,
    /// The limits of this index.
    Limits(usize),
    /// The held joint of this index.
    Hold(usize),
    /// Which joints move.
    Moving,
    /// The limits of velocity (0), of acceleration (1) or of jerk (2).
    Rates(usize),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RobotTable {
    name: Option<String>,
    #[serde(alias = "mjcf")]
    urdf: Spanned<String>,
    srdf: Option<Spanned<SrdfEntry>>,
    packages: Option<String>,
    #[serde(default)]
    solid: bool,
    base: Option<Spanned<BaseEntry>>,
    bounds: Option<Spanned<Corners>>,
    #[serde(default)]
    limits: BTreeMap<String, Spanned<Exactly<f64, 2>>>,
    #[serde(default)]
    hold: BTreeMap<String, Spanned<f64>>,
    group: Option<Spanned<String>>,
    joints: Option<Spanned<Vec<String>>>,
    limit_tolerance: Option<Spanned<f64>>,
    max_velocity: Option<Spanned<RateEntry>>,
    max_acceleration: Option<Spanned<RateEntry>>,
    max_jerk: Option<Spanned<RateEntry>>,
    kind: Option<Spanned<String>>,
    duration: Option<Spanned<f64>>,
    speeds: Option<Spanned<Vec<f64>>>,
    accelerations: Option<Spanned<Vec<f64>>>,
}

/// The name of an SRDF, or that there is to be none.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected the name of an SRDF, or `false` for none")]
enum SrdfEntry {
    Name(String),
    Is(bool),
}

/// A limit of velocity, acceleration or jerk: one for all joints, or for some of them.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number, or one for each joint: `{ joint1 = 1.5 }`")]
enum RateEntry {
    All(f64),
    Joints(BTreeMap<String, f64>),
}

/// Limits of joints by name, or of all.
type Rates = Vec<(Option<String>, f64)>;

/// The limits of an entry, and where it is.
fn rates_of(
    source: &TomlText<'_>,
    what: &str,
    entry: Option<Spanned<RateEntry>>,
) -> Result<(Rates, Range<usize>), Error> {
    let Some(entry) = entry else { return Ok((Vec::new(), 0..0)) };
    let span = entry.span();
    let rates: Vec<_> = match entry.into_inner() {
        RateEntry::All(rate) => vec![(None, rate)],
        RateEntry::Joints(rates) => rates.into_iter().map(|(joint, rate)| (Some(joint), rate)).collect(),
    };
    for (joint, rate) in &rates {
        source.check(what, &[*rate], &span)?;
        if *rate <= 0.0 {
            let of = joint
                .as_ref()
                .map_or_else(String::new, |joint| format!(" of {}", mp_formats::text::clipped(joint)));
            return Err(source.error(&span, format!("{what}{of} is {rate}")).expected("a number above zero"));
        }
    }
    Ok((rates, span))
}

/// The lower and the upper corner of a box, or of a rectangle.
type Corners = Exactly<Vec<f64>, 2>;

/// Where the base stands, or how it moves.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected six numbers, `[x, y, z, α, β, γ]`, \"planar\" or \"floating\"")]
enum BaseEntry {
    Pose([f64; 6]),
    Word(String),
}

/// The table `robot`, or several.
pub(super) enum RobotTables {
    One(Box<RobotTable>),
    Several(Vec<Spanned<RobotTable>>),
}

impl<'de> Deserialize<'de> for RobotTables {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Tables)
    }
}

struct Tables;

impl<'de> Visitor<'de> for Tables {
    type Value = RobotTables;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table `[robot]`, or several `[[robot]]`")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<RobotTables, A::Error> {
        let table = RobotTable::deserialize(MapAccessDeserializer::new(map))?;
        Ok(RobotTables::One(Box::new(table)))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<RobotTables, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(RobotTables::Several)
    }
}

/// Where the base stands, or in which bounds it moves.
#[derive(Default)]
struct Base {
    pose: [f64; 6],
    floating: Option<[[f64; 3]; 2]>,
    planar: Option<[[f64; 2]; 2]>,
}

fn base_of(
    source: &TomlText<'_>,
    base: Option<Spanned<BaseEntry>>,
    bounds: Option<Spanned<Corners>>,
) -> Result<Base, Error> {
    let span = base.as_ref().map_or(0..0, Spanned::span);
    let word = match base.map(Spanned::into_inner) {
        Some(BaseEntry::Word(word)) => Some(word),
        Some(BaseEntry::Pose(pose)) => {
            source.check("the base", &pose, &span)?;
            if let Some(bounds) = bounds {
                let message = "the base stands still, but has bounds";
                return Err(source
                    .error(&bounds.span(), message)
                    .expected("`base = \"floating\"` or `base = \"planar\"` beside them"));
            }
            return Ok(Base { pose, ..Base::default() });
        }
        None => None,
    };
    match (word.as_deref(), bounds) {
        (Some("floating"), Some(bounds)) => {
            let floating = Some(corners(source, &bounds, "`[[x, y, z], [x, y, z]]`")?);
            Ok(Base { floating, ..Base::default() })
        }
        (Some("planar"), Some(bounds)) => {
            let planar = Some(corners(source, &bounds, "`[[x, y], [x, y]]`")?);
            Ok(Base { planar, ..Base::default() })
        }
        (Some("floating"), None) => {
            let message = "the base floats without bounds";
            Err(source.error(&span, message).expected(
                "`bounds = [[x, y, z], [x, y, z]]` beside it: the box in which the origin of the root link moves",
            ))
        }
        (Some("planar"), None) => {
            let message = "the base moves in the plane without bounds";
            Err(source.error(&span, message).expected(
                "`bounds = [[x, y], [x, y]]` beside it: the rectangle in which the origin of the root link moves",
            ))
        }
        (Some(word), _) => {
            let message = format!("the base is `{}`", mp_formats::text::clipped(word));
            let expected = "six numbers, `[x, y, z, α, β, γ]`, \"planar\" or \"floating\"";
            Err(source.error(&span, message).expected(expected))
        }
        (None, Some(bounds)) => {
            let message = "there are bounds of a base that stands still";
            let expected = "`base = \"floating\"` or `base = \"planar\"` beside them";
            Err(source.error(&bounds.span(), message).expected(expected))
        }
        (None, None) => Ok(Base::default()),
    }
}

/// The corners of the bounds of a base, with `N` numbers each.
fn corners<const N: usize>(
    source: &TomlText<'_>,
    bounds: &Spanned<Corners>,
    expected: &str,
) -> Result<[[f64; N]; 2], Error> {
    let (Exactly(given), span) = (bounds.get_ref(), bounds.span());
    source.check("the bounds of the base", &given.concat(), &span)?;
    let expected = format!("the lower corner, then the upper: {expected}");
    let [Ok(low), Ok(high)] = given.each_ref().map(|corner| <[f64; N]>::try_from(corner.as_slice())) else {
        let message = format!("a corner of the bounds of the base does not have {N} numbers");
        return Err(source.error(&span, message).expected(expected));
    };
    if (0..N).all(|i| low[i] < high[i]) {
        return Ok([low, high]);
    }
    Err(source.error(&span, "the bounds of the base enclose nothing").expected(expected))
}

/// Which joints move, and where that is said.
fn moving_of(
    source: &TomlText<'_>,
    group: Option<Spanned<String>>,
    joints: Option<Spanned<Vec<String>>>,
) -> Result<(Option<MovingJoints>, Range<usize>), Error> {
    match (group, joints) {
        (Some(_), Some(joints)) => {
            let message = "there is a group and a list of joints";
            Err(source.error(&joints.span(), message).expected("`group` or `joints`, not both"))
        }
        (Some(group), None) => Ok((Some(MovingJoints::Group(group.get_ref().clone())), group.span())),
        (None, Some(joints)) if joints.get_ref().is_empty() => {
            Err(source.error(&joints.span(), "no joint moves").expected("the names of one or more joints"))
        }
        (None, Some(joints)) => Ok((Some(MovingJoints::Listed(joints.get_ref().clone())), joints.span())),
        (None, None) => Ok((None, 0..0)),
    }
}

/// The robots of the tables.
pub(super) fn robots_of(
    source: &TomlText<'_>,
    tables: Spanned<RobotTables>,
) -> Result<Vec<RobotEntry>, Error> {
    let span = tables.span();
    let tables = match tables.into_inner() {
        RobotTables::One(table) => return Ok(vec![robot_of(source, *table, span)?]),
        RobotTables::Several(tables) => tables,
    };
    let several = tables.len() > 1;
    let each = tables.into_iter().map(|table| {
        let span = table.span();
        robot_of(source, table.into_inner(), span)
    });
    let robots: Vec<_> = each.collect::<Result<_, _>>()?;
    let mut names = BTreeSet::new();
    for robot in robots.iter().filter(|_| several) {
        let wrong = |message: &str, expected: &str| {
            Err(source.error(&robot.places.robot, message).expected(expected))
        };
        match &robot.name {
            None => {
                return wrong(
                    "one of several robots has no name",
                    "`name = \"left\"`: its links and joints are called `left/…` then",
                );
            }
            Some(name) if !names.insert(name) => {
                return wrong("two robots have the same name", "a name of its own for each");
            }
            Some(_) => {}
        }
        if robot.floating.is_some() {
            return wrong(
                "one of several robots floats",
                "bases that stand still or move in the plane, or one robot alone",
            );
        }
        if robot.driven.is_some() {
            return wrong(
                "one of several robots moves by inputs",
                "robots without `kind`, or one robot alone",
            );
        }
    }
    Ok(robots)
}

fn robot_of(source: &TomlText<'_>, robot: RobotTable, robot_span: Range<usize>) -> Result<RobotEntry, Error> {
    let table = DriveTable::by_numbers(robot.kind, robot.duration, robot.speeds, robot.accelerations);
    let driven = table.read(source, &robot_span, &["velocities", "accelerations"])?;
    let base_span = robot.base.as_ref().map_or(0..0, Spanned::span);
    let Base { pose: base, floating, planar } = base_of(source, robot.base, robot.bounds)?;
    let (moving, moving_span) = moving_of(source, robot.group, robot.joints)?;
    let srdf_span = robot.srdf.as_ref().map_or(0..0, Spanned::span);
    let (srdf, without_srdf) = match robot.srdf.map(Spanned::into_inner) {
        Some(SrdfEntry::Name(name)) => (Some(name), false),
        Some(SrdfEntry::Is(false)) => (None, true),
        Some(SrdfEntry::Is(true)) => {
            return Err(source.error(&srdf_span, "`srdf = true` names no file").expected(
                "the name of an SRDF; without `srdf` one near the URDF is taken, if there is one, and with `false` none",
            ));
        }
        None => (None, false),
    };
    let (mut limits, mut places_of_limits) = (Vec::new(), Vec::new());
    for (joint, range) in robot.limits {
        let (what, span) = (format!("the limits of {}", mp_formats::text::clipped(&joint)), range.span());
        let Exactly([low, high]) = *range.get_ref();
        source.check(&what, &[low, high], &span)?;
        if low > high {
            let message = format!("{what} are {low} to {high}");
            let expected = "the lower one first, below the upper, or equal ones, which hold the joint";
            return Err(source.error(&span, message).expected(expected));
        }
        places_of_limits.push(span);
        limits.push((joint, [low, high]));
    }
    let (mut hold, mut places_of_hold) = (Vec::new(), Vec::new());
    for (joint, value) in robot.hold {
        let (what, span) = (format!("the held joint {}", mp_formats::text::clipped(&joint)), value.span());
        source.check(&what, &[*value.get_ref()], &span)?;
        if limits.iter().any(|(limited, _)| *limited == joint) {
            let message = format!("{what} has limits too");
            return Err(source.error(&span, message).expected("a joint in `limits` or in `hold`, not both"));
        }
        places_of_hold.push(span);
        hold.push((joint, value.into_inner()));
    }
    let limit_tolerance = robot.limit_tolerance.as_ref().map_or(0.0, |spanned| *spanned.get_ref());
    if let Some(spanned) = &robot.limit_tolerance {
        source.check("the tolerance of limits", &[limit_tolerance], &spanned.span())?;
        if limit_tolerance < 0.0 {
            let message = format!("the tolerance of limits is {limit_tolerance}");
            let expected = "a number of at least zero: radians, or metres for joints that slide";
            return Err(source.error(&spanned.span(), message).expected(expected));
        }
    }
    let (mut max_rates, mut places_of_rates) = <([Rates; 3], [Range<usize>; 3])>::default();
    let rates = [robot.max_velocity, robot.max_acceleration, robot.max_jerk];
    for (i, (entry, what)) in rates.into_iter().zip(["velocity", "acceleration", "jerk"]).enumerate() {
        (max_rates[i], places_of_rates[i]) = rates_of(source, &format!("the limit of {what}"), entry)?;
    }
    let places = RobotPlaces {
        urdf: robot.urdf.span(),
        srdf: srdf_span,
        robot: robot_span,
        base: base_span,
        limits: places_of_limits,
        hold: places_of_hold,
        moving: moving_span,
        rates: places_of_rates,
    };
    Ok(RobotEntry {
        name: robot.name,
        urdf: robot.urdf.into_inner(),
        srdf,
        without_srdf,
        packages: robot.packages,
        solid: robot.solid,
        base,
        floating,
        planar,
        limits,
        hold,
        moving,
        limit_tolerance,
        max_rates,
        driven,
        places,
    })
}
