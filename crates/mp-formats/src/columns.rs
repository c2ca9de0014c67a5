//! The columns of a table by name: which of them gives which number of a configuration, and in what unit.

use crate::error::{Error, ErrorKind};
use crate::text::clipped;
use mp_geom::{pose_from_quaternion, six_from_pose};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use std::fmt;

/// The meaning of one number of a configuration.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Its name: `x`, `yaw`, or that of a joint.
    pub name: String,
    /// `m` or `rad`.
    pub unit: String,
}

impl Column {
    /// A column with this name and unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }

    /// The columns of the pose of a rigid body: x, y, z (m), α, β and γ (rad).
    #[must_use]
    pub fn of_pose() -> Vec<Self> {
        let names = [("x", "m"), ("y", "m"), ("z", "m"), ("alpha", "rad"), ("beta", "rad"), ("gamma", "rad")];
        names.map(|(name, unit)| Self::new(name, unit)).to_vec()
    }

    /// The column that a table calls `name`, with a unit in brackets if it says one.
    pub(crate) fn named(name: &str) -> Self {
        let (name, unit) = bracketed(name).unwrap_or((name, ""));
        Self::new(normal(name), normal(unit))
    }
}

/// `name [unit]`.
impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} [{}]", self.name, self.unit)
    }
}

/// Other names of the angles of a body whose configuration begins with x and y, all about the same axes.
const ALIASES: [(&str, &[&str]); 4] = [
    ("alpha", &["α", "yaw"]),
    ("beta", &["β", "pitch"]),
    ("gamma", &["γ", "roll"]),
    ("yaw", &["theta", "θ"]),
];

/// A quaternion may stand for the angles of a pose.
const QUATERNION: [&str; 4] = ["qw", "qx", "qy", "qz"];

/// So far a quaternion may be from unit length: files have four digits.
const UNIT_LENGTH: f64 = 1e-3;

/// What is wrong with a table, and in which of its columns.
#[derive(Debug)]
pub struct Fault {
    /// Which column, if it is one.
    pub at: Option<usize>,
    /// What is wrong.
    pub message: String,
    /// What was expected there.
    pub expected: String,
}

/// What to do about a [`Fault`].
pub const HELP: &str = "name each column once and nothing else: `mp info SCENE` lists the names; \
    without names, the numbers are taken in their order";

/// Where the numbers of a configuration are in the rows of a table.
#[derive(Debug)]
pub struct Matching {
    /// For each number its column, and what it is multiplied with and divided by; `None` for an angle from the quaternion.
    sources: Vec<Option<(usize, f64, f64)>>,
    /// The columns of w, x, y and z.
    quaternion: Option<[usize; 4]>,
}

impl Matching {
    /// The matching of columns with these names, which may end with a unit, to those that are `wanted`.
    ///
    /// # Errors
    /// When a column is missing, unknown, named twice, or has a unit that cannot be converted.
    pub fn new(names: &[String], wanted: &[Column]) -> Result<Self, Fault> {
        // What is written reads back the same, whatever the names are.
        let written = |(name, column): (&String, &Column)| {
            let Column { name: own, unit } = column;
            [normal(own), normal(&column.to_string()), normal(&format!("{own} ({unit})"))]
                .contains(&normal(name))
        };
        let in_order = names.len() == wanted.len() && names.iter().zip(wanted).all(written);
        if in_order
            || !names.is_empty() && nameless(names) && names.iter().all(|name| find(name, wanted).is_none())
        {
            let sources = (0..names.len()).map(|at| Some((at, 1.0, 1.0))).collect();
            return Ok(Self { sources, quaternion: None });
        }
        let listed = || wanted.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        let mut found: Vec<Option<(usize, f64, f64)>> = vec![None; wanted.len()];
        let mut quaternion = [None; 4];
        for (at, name) in names.iter().enumerate() {
            let shown = clipped(name);
            let fault = |message: String, expected: String| Fault { at: Some(at), message, expected };
            let place = QUATERNION.iter().position(|q| q.eq_ignore_ascii_case(name.trim()));
            let doubled = match (find(name, wanted), place) {
                (Some((number, unit)), _) => {
                    let Column { name: own, unit: its } = &wanted[number];
                    let Some((times, over)) = factor(unit, its) else {
                        let message = format!("`{shown}` cannot be converted to the unit of {own}, {its}");
                        return Err(fault(message, expected_units(its)));
                    };
                    found[number].replace((at, times, over)).map(|other| other.0)
                }
                (None, Some(place)) if is_pose(wanted) => quaternion[place].replace(at),
                (None, _) if name.trim().is_empty() => {
                    return Err(fault(format!("column {} has no name", at + 1), listed()));
                }
                (None, _) => {
                    return Err(fault(format!("`{shown}` is no number of a configuration here"), listed()));
                }
            };
            if let Some(other) = doubled {
                let message = format!("`{}` and `{shown}` are the same number", clipped(&names[other]));
                return Err(fault(message, "each column once".to_owned()));
            }
        }
        let quaternion = match quaternion {
            [None, None, None, None] => None,
            [Some(w), Some(x), Some(y), Some(z)] => Some([w, x, y, z]),
            some => {
                let expected = QUATERNION.join(", ");
                let message = "a part of the quaternion is missing".to_owned();
                return Err(Fault { at: some.into_iter().flatten().next(), message, expected });
            }
        };
        for (number, source) in found.iter().enumerate() {
            let turned = quaternion.is_some() && (3..6).contains(&number);
            let message = match source {
                Some(_) if turned => "there are angles and a quaternion".to_owned(),
                None if !turned => format!("there is no column for {}", wanted[number].name),
                _ => continue,
            };
            return Err(Fault { at: source.map(|s| s.0), message, expected: listed() });
        }
        Ok(Self { sources: found, quaternion })
    }

    /// The configuration in a row of the table.
    ///
    /// # Errors
    /// When its quaternion does not have length one.
    pub fn configuration(&self, row: &[f64]) -> Result<Vec<f64>, Fault> {
        let number = |source: &Option<(usize, f64, f64)>| {
            source
                .map_or(0.0, |(at, times, over)| if times == over { row[at] } else { row[at] * times / over })
        };
        let mut numbers: Vec<f64> = self.sources.iter().map(number).collect();
        if let Some(number) = numbers.iter().position(|v| !v.is_finite()) {
            let at = self.sources[number].map(|source| source.0);
            return Err(Fault {
                at,
                message: "the number is too large".to_owned(),
                expected: "a finite one".to_owned(),
            });
        }
        if let Some(places) = self.quaternion {
            let [w, x, y, z] = places.map(|at| row[at]);
            let length = (w * w + x * x + y * y + z * z).sqrt();
            let pose = pose_from_quaternion([0.0; 3], w, x, y, z).ok();
            let Some(pose) = pose.filter(|_| (length - 1.0).abs() <= UNIT_LENGTH) else {
                let message = format!("the quaternion has the length {length}");
                return Err(Fault { at: Some(places[0]), message, expected: "the length 1".to_owned() });
            };
            numbers[3..6].copy_from_slice(&six_from_pose(&pose)[3..]);
        }
        Ok(numbers)
    }
}

/// The rows of a table, whose columns have these names, as configurations with the numbers `wanted`: columns are matched by name, and
/// their units, as in `elbow [deg]`, converted. Each row has as many numbers as there are names.
///
/// # Errors
/// When a name is unknown, missing or there twice, or a unit does not fit; errors call the table `what`.
pub fn matched(
    what: &str,
    names: &[String],
    rows: &[Vec<f64>],
    wanted: &[Column],
) -> Result<Vec<Vec<f64>>, Error> {
    let error = |fault: Fault, row: Option<usize>| {
        let place = row.map_or_else(String::new, |i| format!("row {}: ", i + 1));
        Error::new(ErrorKind::Content, what, place + &fault.message).expected(fault.expected).help(HELP)
    };
    let kept = usize::from(is_index(names, wanted));
    let matching = Matching::new(&names[kept..], wanted).map_err(|fault| error(fault, None))?;
    let configuration = |(i, row): (usize, &Vec<f64>)| {
        if row.len() != names.len() {
            let message = format!("configuration {} of the path has {} numbers", i + 1, row.len());
            let expected = format!("one for each of the {} columns", names.len());
            return Err(Error::new(ErrorKind::Content, what, message).expected(expected));
        }
        matching.configuration(&row[kept..]).map_err(|fault| error(fault, Some(i)))
    };
    rows.iter().enumerate().map(configuration).collect()
}

/// Whether the first column is the index of a data frame, which is no part of a configuration.
pub fn is_index(names: &[String], wanted: &[Column]) -> bool {
    let index = |name: &String| ["", "index", "Unnamed: 0"].contains(&name.trim());
    names.len() > 1 && names.first().is_some_and(|name| index(name) && find(name, wanted).is_none())
}

/// Whether the names are those that a data frame gives columns without any.
pub(crate) fn nameless(names: &[String]) -> bool {
    names.iter().enumerate().all(|(i, name)| name.trim().parse() == Ok(i))
}

/// As names are compared.
fn normal(name: &str) -> String {
    name.trim().chars().map(|c| if c.is_control() { '_' } else { c }).collect()
}

/// Whether configurations begin with the pose of a body in space.
fn is_pose(wanted: &[Column]) -> bool {
    wanted.len() >= 6 && Column::of_pose().iter().zip(wanted).all(|(pose, column)| pose == column)
}

/// Which number a column is, and its unit if the name ends with one.
pub fn find<'n>(name: &'n str, wanted: &[Column]) -> Option<(usize, Option<&'n str>)> {
    let suffixed = name.trim().rsplit_once(['_', ' ']);
    let suffixed = suffixed.filter(|(_, unit)| SUFFIXES.contains(unit));
    let readings =
        [Some((name, None)), bracketed(name).map(|(n, u)| (n, Some(u))), suffixed.map(|(n, u)| (n, Some(u)))];
    let exact =
        |(name, unit): (&str, _)| Some((wanted.iter().position(|w| normal(&w.name) == normal(name))?, unit));
    let body = wanted.len() > 1 && wanted[0].name == "x" && wanted[1].name == "y";
    let loose = |(name, unit): (&str, _)| {
        let name = normal(name).to_lowercase();
        let alias = |own: &str| ALIASES.iter().any(|(it, others)| *it == own && others.contains(&&*name));
        let alike = |(i, w): (usize, &Column)| {
            (normal(&w.name).to_lowercase() == name || body && i < 6 && alias(&w.name)).then_some((i, unit))
        };
        let mut all = wanted.iter().enumerate().filter_map(alike);
        all.next().filter(|_| all.next().is_none())
    };
    let readings = || readings.into_iter().flatten();
    readings().find_map(exact).or_else(|| readings().find_map(loose))
}

/// Name and unit of `name [unit]` and `name (unit)`. What has brackets itself is no unit.
pub fn bracketed(name: &str) -> Option<(&str, &str)> {
    let name = name.trim();
    let open = match name.chars().last()? {
        ']' => '[',
        ')' => '(',
        _ => return None,
    };
    let (own, unit) = name[..name.len() - 1].rsplit_once(open)?;
    (!unit.contains(['[', ']', '(', ')'])).then(|| (own.trim(), unit.trim()))
}

/// Units that may end a name without brackets.
const SUFFIXES: [&str; 8] = ["rad", "radians", "deg", "degrees", "m", "mm", "cm", "s"];

/// What a value in a unit is multiplied with and divided by to be in another one.
pub fn factor(from: Option<&str>, to: &str) -> Option<(f64, f64)> {
    let from = from.filter(|unit| !unit.is_empty() && *unit != to);
    let Some(from) = from else { return Some((1.0, 1.0)) };
    let (from, to) = (scale(from)?, scale(to)?);
    (from.0 == to.0).then_some((from.1 * to.2, from.2 * to.1))
}

/// What a unit measures, and what a value in it is multiplied with and divided by to be in metres, radians and seconds.
fn scale(unit: &str) -> Option<((&'static str, u32), f64, f64)> {
    let unit = unit.to_lowercase();
    let (unit, power) = match unit.split_once('/') {
        None => (&*unit, 0),
        Some((unit, "s" | "sec" | "second")) => (unit.trim(), 1),
        Some((unit, "s²" | "s2" | "s^2" | "s**2")) => (unit.trim(), 2),
        Some(_) => return None,
    };
    let (what, times, over) = match unit {
        "m" | "meter" | "meters" | "metre" | "metres" => ("m", 1.0, 1.0),
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => ("m", 1.0, 1e3),
        "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => ("m", 1.0, 1e2),
        "km" => ("m", 1e3, 1.0),
        "in" | "inch" | "inches" => ("m", 0.0254, 1.0),
        "ft" | "foot" | "feet" => ("m", 0.3048, 1.0),
        "rad" | "radian" | "radians" => ("rad", 1.0, 1.0),
        "mrad" => ("rad", 1.0, 1e3),
        "deg" | "degree" | "degrees" | "°" => ("rad", PI / 180.0, 1.0),
        "rev" | "turn" | "turns" => ("rad", TAU, 1.0),
        "s" | "sec" | "second" | "seconds" => ("s", 1.0, 1.0),
        "ms" => ("s", 1.0, 1e3),
        "us" | "µs" => ("s", 1.0, 1e6),
        "ns" => ("s", 1.0, 1e9),
        "min" => ("s", 60.0, 1.0),
        _ => return None,
    };
    Some(((what, power), times, over))
}

/// The units from which values are converted to one.
fn expected_units(unit: &str) -> String {
    let (base, per) =
        unit.split_once('/').map_or((unit, String::new()), |(base, per)| (base, format!("/{per}")));
    let units: &[&str] = match base {
        "m" => &["m", "mm", "cm", "km", "in", "ft"],
        "rad" => &["rad", "deg", "mrad", "rev"],
        "s" => &["s", "ms", "us", "ns", "min"],
        _ => &[base],
    };
    units.iter().map(|unit| format!("{unit}{per}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<String> {
        text.split(',').map(str::to_owned).collect()
    }

    fn arm() -> Vec<Column> {
        [("lift", "m"), ("shoulder", "rad"), ("elbow", "rad")].map(|(n, u)| Column::new(n, u)).to_vec()
    }

    fn row(header: &str, row: &[f64], wanted: &[Column]) -> Result<Vec<f64>, String> {
        let rows = matched("t", &names(header), &[row.to_vec()], wanted);
        rows.map(|rows| rows[0].clone()).map_err(|e| e.report())
    }

    #[test]
    fn columns_are_found_by_name_in_any_order_and_unit() {
        let same = [0.25, 90f64.to_radians(), -1.0];
        for (header, given) in [
            ("lift,shoulder,elbow", &[0.25, 90f64.to_radians(), -1.0][..]),
            ("elbow,lift,shoulder", &[-1.0, 0.25, 90f64.to_radians()]),
            ("elbow [rad],shoulder [deg],lift [mm]", &[-1.0, 90.0, 250.0]),
            ("elbow (rad),shoulder (degrees),lift (cm)", &[-1.0, 90.0, 25.0]),
            ("elbow_rad,shoulder_deg,lift_mm", &[-1.0, 90.0, 250.0]),
            ("Elbow, SHOULDER [°],lift m", &[-1.0, 90.0, 0.25]),
            (",elbow,shoulder [deg],lift", &[7.0, -1.0, 90.0, 0.25]),
            ("index,elbow,shoulder_deg,lift", &[7.0, -1.0, 90.0, 0.25]),
            ("Unnamed: 0,elbow,shoulder_deg,lift", &[7.0, -1.0, 90.0, 0.25]),
            ("0,1,2", &[0.25, 90f64.to_radians(), -1.0]),
            (",0,1,2", &[3.0, 0.25, 90f64.to_radians(), -1.0]),
        ] {
            assert_eq!(row(header, given, &arm()).unwrap(), same, "{header}");
        }
    }

    #[test]
    fn what_is_not_certain_is_refused() {
        for (header, message) in [
            ("lift,shoulder,wrist", "`wrist` is no number of a configuration"),
            ("lift,shoulder", "no column for elbow"),
            ("lift,shoulder,elbow,time", "`time` is no number"),
            ("lift,shoulder,elbow,elbow", "`elbow` and `elbow` are the same"),
            ("lift,shoulder [deg],shoulder [rad],elbow", "are the same"),
            ("lift [deg],shoulder,elbow", "cannot be converted to the unit of lift, m"),
            ("lift,shoulder [mm],elbow", "expected rad, deg"),
            ("lift,shoulder [furlong],elbow", "cannot be converted"),
            ("lift,shoulder [deg/s],elbow", "cannot be converted"),
            ("lift,shoulder,elbow,", "column 4 has no name"),
            ("1,2,3", "`1` is no number"),
            ("lift,shoulder,theta", "`theta` is no number"),
        ] {
            let numbers = vec![0.0; names(header).len()];
            let error = row(header, &numbers, &arm()).unwrap_err();
            assert!(error.contains(message), "{header}: {error}");
        }
        // Names that differ only in case, and one that could be either.
        let alike = ["J", "j", "k"].map(|n| Column::new(n, "rad"));
        assert_eq!(row("k,j,J", &[3.0, 2.0, 1.0], &alike).unwrap(), [1.0, 2.0, 3.0]);
        let alike = ["Ab", "aB"].map(|n| Column::new(n, "rad"));
        assert!(row("ab,aB", &[3.0, 2.0], &alike).is_err());
    }

    #[test]
    fn names_that_look_like_units_are_names() {
        let wanted = ["a", "a_deg", "b [deg]", "c (m)", "1"].map(|n| Column::new(n, "rad"));
        assert_eq!(
            row("1,c (m),b [deg],a_deg,a", &[5.0, 4.0, 3.0, 2.0, 1.0], &wanted).unwrap(),
            [1.0, 2.0, 3.0, 4.0, 5.0]
        );
        let written: Vec<_> = wanted.iter().map(ToString::to_string).rev().collect();
        assert_eq!(
            row(&written.join(","), &[5.0, 4.0, 3.0, 2.0, 1.0], &wanted).unwrap(),
            [1.0, 2.0, 3.0, 4.0, 5.0]
        );
        // Two of one name are known by their order only.
        let twice = ["a", "a"].map(|n| Column::new(n, "V"));
        assert_eq!(row("a [V],a [V]", &[1.0, 2.0], &twice).unwrap(), [1.0, 2.0]);
        assert_eq!(row("a,a", &[1.0, 2.0], &twice).unwrap(), [1.0, 2.0]);
    }

    #[test]
    fn bodies_have_angles_or_a_quaternion() {
        let pose = Column::of_pose();
        let six = [1.0, 2.0, 3.0, 0.4, -0.5, 0.6];
        let [x, y, z, yaw, pitch, roll] = six;
        assert_eq!(row("x,y,z,roll,pitch,yaw", &[x, y, z, roll, pitch, yaw], &pose).unwrap(), six);
        assert_eq!(row("α,β,γ,z,y,x", &[yaw, pitch, roll, z, y, x], &pose).unwrap(), six);
        let q = mp_geom::pose_from_six(six).rotation;
        let [i, j, k, w] = [q.i, q.j, q.k, q.w].map(|v| (v * 1e4).round() / 1e4);
        let mut joined = pose.clone();
        joined.push(Column::new("elbow", "rad"));
        let read = row("elbow,x,y,z,qx,qy,qz,qw", &[7.0, x, y, z, i, j, k, w], &joined).unwrap();
        assert!(read.iter().zip(six.iter().chain(&[7.0])).all(|(a, b)| (a - b).abs() < 1e-3), "{read:?}");
        for (header, message) in [
            ("x,y,z,qx,qy,qz", "a part of the quaternion is missing"),
            ("x,y,z,qx,qy,qz,qw", "the quaternion has the length 2"),
            ("x,y,z,qx,qy,qz,qw,roll", "there are angles and a quaternion"),
            ("x,y,z,yaw,alpha,roll", "`yaw` and `alpha` are the same"),
        ] {
            let error = row(header, &vec![1.0; names(header).len()], &pose).unwrap_err();
            assert!(error.contains(message), "{header}: {error}");
        }
        let planar = [("x", "m"), ("y", "m"), ("yaw", "rad")].map(|(n, u)| Column::new(n, u));
        assert_eq!(row("theta,y,x", &[3.0, 2.0, 1.0], &planar).unwrap(), [1.0, 2.0, 3.0]);
        assert!(row("x,y,qw", &[0.0; 3], &planar).is_err());
        let driven =
            [("x", "m"), ("v_x", "m/s"), ("a_x", "m/s²"), ("duration", "s")].map(|(n, u)| Column::new(n, u));
        let header = "duration [ms],a_x [cm/s^2],v_x [mm/s],x";
        assert_eq!(row(header, &[500.0, 25.0, 2000.0, 1.0], &driven).unwrap(), [1.0, 2.0, 0.25, 0.5]);
    }
}
