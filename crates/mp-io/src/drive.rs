//! Robots that move by inputs: cars, unicycles, velocities and accelerations, as problems in TOML describe them.

use crate::toml_problem::TomlText;
use mp_formats::error::Error;
use std::ops::Range;
use toml::Spanned;

/// How a robot moves by inputs.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// A car with steered front wheels; its origin is the middle of the rear axle. Inputs are speed and steering angle.
    Car {
        /// Its speed, m/s.
        speed: f64,
        /// The distance between its axles, metres.
        wheelbase: f64,
        /// The greatest steering angle, rad.
        steering: f64,
        /// Whether it can reverse.
        reverse: bool,
    },
    /// A body that drives along its x axis and turns, also on the spot. Inputs are speed and turning rate.
    Unicycle {
        /// Its speed, m/s.
        speed: f64,
        /// Its turning rate, rad/s.
        turning: f64,
        /// Whether it can reverse.
        reverse: bool,
    },
    /// A robot moved by velocities, one for each degree of freedom.
    Velocities {
        /// Their limits, m/s and rad/s.
        speeds: Vec<f64>,
    },
    /// A robot moved by accelerations, one for each degree of freedom. Its velocities are part of its state.
    Accelerations {
        /// The limits of the velocities, m/s and rad/s.
        speeds: Vec<f64>,
        /// The limits of the accelerations, m/s² and rad/s².
        accelerations: Vec<f64>,
    },
}

/// A robot that moves by inputs, each held for a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Driven {
    /// How it moves.
    pub drive: Drive,
    /// How long an input is held, seconds.
    pub duration: f64,
}

/// What the table `robot` says of inputs.
#[derive(Default)]
pub(crate) struct DriveTable {
    pub(crate) kind: Option<Spanned<String>>,
    pub(crate) duration: Option<Spanned<f64>>,
    pub(crate) speed: Option<Spanned<f64>>,
    pub(crate) turning: Option<Spanned<f64>>,
    pub(crate) wheelbase: Option<Spanned<f64>>,
    pub(crate) steering: Option<Spanned<f64>>,
    pub(crate) turning_radius: Option<Spanned<f64>>,
    pub(crate) reverse: Option<Spanned<bool>>,
    pub(crate) speeds: Option<Spanned<Vec<f64>>>,
    pub(crate) accelerations: Option<Spanned<Vec<f64>>>,
}

/// The keys that each kind has, beside `duration`.
const KEYS: [(&str, &[&str]); 4] = [
    ("car", &["speed", "wheelbase", "steering", "turning_radius", "reverse"]),
    ("unicycle", &["speed", "turning", "reverse"]),
    ("velocities", &["speeds"]),
    ("accelerations", &["speeds", "accelerations"]),
];

impl DriveTable {
    /// The keys of robots that move by velocities or accelerations.
    pub(crate) fn by_numbers(
        kind: Option<Spanned<String>>,
        duration: Option<Spanned<f64>>,
        speeds: Option<Spanned<Vec<f64>>>,
        accelerations: Option<Spanned<Vec<f64>>>,
    ) -> Self {
        Self { kind, duration, speeds, accelerations, ..Self::default() }
    }

    /// How the robot of the table at `table` moves by inputs; `None` when it has no kind. `kinds` are those that it may have.
    pub(crate) fn read(
        self,
        text: &TomlText<'_>,
        table: &Range<usize>,
        kinds: &[&str],
    ) -> Result<Option<Driven>, Error> {
        let places = [
            ("duration", self.duration.as_ref().map(Spanned::span)),
            ("speed", self.speed.as_ref().map(Spanned::span)),
            ("turning", self.turning.as_ref().map(Spanned::span)),
            ("wheelbase", self.wheelbase.as_ref().map(Spanned::span)),
            ("steering", self.steering.as_ref().map(Spanned::span)),
            ("turning_radius", self.turning_radius.as_ref().map(Spanned::span)),
            ("reverse", self.reverse.as_ref().map(Spanned::span)),
            ("speeds", self.speeds.as_ref().map(Spanned::span)),
            ("accelerations", self.accelerations.as_ref().map(Spanned::span)),
        ];
        let given = || places.iter().filter_map(|(name, span)| Some((*name, span.clone()?)));
        let Some(kind) = &self.kind else {
            return match given().next() {
                None => Ok(None),
                Some((name, span)) => {
                    let message = format!("`{name}` is given, and no kind of robot");
                    Err(text.error(&span, message).expected(format!("`kind = {}` beside it", one_of(kinds))))
                }
            };
        };
        let keys = KEYS.iter().find(|(name, _)| name == kind.get_ref() && kinds.contains(name));
        let Some((name, keys)) = keys else {
            let message =
                format!("there is no kind of robot `{}` here", mp_formats::text::clipped(kind.get_ref()));
            return Err(text
                .error(&kind.span(), message)
                .expected(format!("`kind = {}`, or no kind", one_of(kinds))));
        };
        if let Some((key, span)) = given().find(|(key, _)| *key != "duration" && !keys.contains(key)) {
            let message = format!("a robot of the kind `{name}` has no `{key}`");
            return Err(text.error(&span, message).expected(format!("only duration, {}", keys.join(", "))));
        }
        let missing = |key: &str, what: &str| {
            let message = format!("a robot of the kind `{name}` needs `{key}`");
            text.error(table, message).expected(format!("`{key} = {what}`"))
        };
        let positive = |key: &str, what: &str, given: &Option<Spanned<f64>>| {
            let Some(given) = given else { return Err(missing(key, what)) };
            text.positive(&format!("`{key}`"), &[*given.get_ref()], &given.span())?;
            Ok(*given.get_ref())
        };
        let list = |key: &str, what: &str, given: &Option<Spanned<Vec<f64>>>| {
            let Some(given) = given else { return Err(missing(key, what)) };
            text.positive(&format!("`{key}`"), given.get_ref(), &given.span())?;
            Ok(given.get_ref().clone())
        };
        let duration = positive("duration", "SECONDS, how long an input is held", &self.duration)?;
        let reverse = self.reverse.as_ref().is_none_or(|r| *r.get_ref());
        let speed = || positive("speed", "METRES_PER_SECOND", &self.speed);
        let limits = || list("speeds", "[…], a limit for each degree of freedom", &self.speeds);
        let drive = match *name {
            "car" => {
                let wheelbase = positive("wheelbase", "METRES between the axles", &self.wheelbase)?;
                let steering = match (&self.steering, &self.turning_radius) {
                    (Some(angle), None) => {
                        positive("steering", "", &self.steering)?;
                        if *angle.get_ref() >= std::f64::consts::FRAC_PI_2 {
                            let message = format!("the steering angle is {}", angle.get_ref());
                            return Err(text
                                .error(&angle.span(), message)
                                .expected("an angle below π/2 rad"));
                        }
                        *angle.get_ref()
                    }
                    (None, Some(_)) => {
                        mp_math::atan(wheelbase / positive("turning_radius", "", &self.turning_radius)?)
                    }
                    (Some(_), Some(radius)) => {
                        let message = "there is a steering angle and a turning radius";
                        return Err(text.error(&radius.span(), message).expected("one of them"));
                    }
                    (None, None) => return Err(missing("steering", "RADIANS`, or `turning_radius = METRES")),
                };
                Drive::Car { speed: speed()?, wheelbase, steering, reverse }
            }
            "unicycle" => Drive::Unicycle {
                speed: speed()?,
                turning: positive("turning", "RADIANS_PER_SECOND", &self.turning)?,
                reverse,
            },
            "velocities" => Drive::Velocities { speeds: limits()? },
            _ => Drive::Accelerations {
                speeds: limits()?,
                accelerations: list(
                    "accelerations",
                    "[…], a limit for each degree of freedom",
                    &self.accelerations,
                )?,
            },
        };
        Ok(Some(Driven { drive, duration }))
    }
}

impl Driven {
    /// Refuses limits whose number is not that of the degrees of freedom, which have these names.
    ///
    /// # Errors
    /// What is wrong, and what is expected.
    pub fn check(&self, names: &[String]) -> Result<(), [String; 2]> {
        let lists: &[(&str, &Vec<f64>)] = match &self.drive {
            Drive::Velocities { speeds } => &[("speeds", speeds)],
            Drive::Accelerations { speeds, accelerations } => {
                &[("speeds", speeds), ("accelerations", accelerations)]
            }
            _ => &[],
        };
        match lists.iter().find(|(_, list)| list.len() != names.len()) {
            None => Ok(()),
            Some((key, list)) => Err([
                format!("`{key}` has {} of {} limits", list.len(), names.len()),
                format!("one for each of: {}", names.join(", ")),
            ]),
        }
    }

    /// The names of the numbers of a state, given those of a configuration: with velocities where inputs are accelerations.
    #[must_use]
    pub fn state_names(&self, names: &[String]) -> Vec<String> {
        let velocities = names.iter().map(|name| format!("v_{name}"));
        match self.drive {
            Drive::Accelerations { .. } => names.iter().cloned().chain(velocities).collect(),
            _ => names.to_vec(),
        }
    }

    /// The name and the unit of each number of an input, given those of a configuration.
    #[must_use]
    pub fn input_names(&self, columns: &[(String, String)]) -> Vec<(String, String)> {
        let own = |list: [[&str; 2]; 2]| list.map(|[name, unit]| (name.to_owned(), unit.to_owned())).to_vec();
        let each = |letter: &str, per: &str| {
            columns.iter().map(|(name, unit)| (format!("{letter}_{name}"), format!("{unit}{per}"))).collect()
        };
        match self.drive {
            Drive::Car { .. } => own([["speed", "m/s"], ["steering", "rad"]]),
            Drive::Unicycle { .. } => own([["speed", "m/s"], ["turning", "rad/s"]]),
            Drive::Velocities { .. } => each("u", "/s"),
            Drive::Accelerations { .. } => each("a", "/s²"),
        }
    }
}

/// The names as a choice.
fn one_of(kinds: &[&str]) -> String {
    kinds.iter().map(|kind| format!("\"{kind}\"")).collect::<Vec<_>>().join(" | ")
}
