//! Problems in TOML: the place of every value, so that errors can point at it, and the table of start and goals.

use crate::changes::{help_of, option_at};
use crate::pose_goal::PoseEntry;
use mp_formats::error::{Error, ErrorKind};
use mp_formats::mesh::MAX_COORDINATE;
use mp_formats::text::clipped;
use mp_geom::pose_from_six;
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;

/// A TOML text and the name that errors give it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TomlText<'a> {
    pub(crate) file: &'a str,
    pub(crate) text: &'a str,
    /// Says where the format is described: the remedy of errors that have no better one.
    pub(crate) guide: &'static str,
}

impl TomlText<'_> {
    /// The tables of the text.
    pub(crate) fn read<T: DeserializeOwned>(&self) -> Result<T, Error> {
        toml::from_str(self.text).map_err(|e| {
            let span = e.span().unwrap_or(0..0);
            // The parser's message may have several lines; an error has one.
            let message = e.message().split_whitespace().collect::<Vec<_>>().join(" ");
            let message = mp_formats::text::clipped_to(&message, 300);
            self.error(&span, message).with_kind(ErrorKind::Format)
        })
    }

    /// A value of the text, as another type.
    pub(crate) fn value<T: DeserializeOwned>(&self, value: &Spanned<toml::Value>) -> Result<T, Error> {
        let read = T::deserialize(value.get_ref().clone());
        read.map_err(|e| {
            let message = e.message().split_whitespace().collect::<Vec<_>>().join(" ");
            self.error(&value.span(), mp_formats::text::clipped_to(&message, 300))
                .with_kind(ErrorKind::Format)
        })
    }

    pub(crate) fn error(&self, span: &Range<usize>, message: impl Into<String>) -> Error {
        let length = span.end.saturating_sub(span.start).max(1);
        let error = Error::at(ErrorKind::Content, self.file, self.text, span.start, length, message.into());
        match option_at(self.text, span.start) {
            Some(option) => error.in_option(option).help(help_of(option)),
            None => error.help(self.guide),
        }
    }

    /// Refuses numbers that are not finite or beyond [`MAX_COORDINATE`].
    pub(crate) fn check(&self, what: &str, values: &[f64], span: &Range<usize>) -> Result<(), Error> {
        match values.iter().find(|v| v.is_nan() || v.abs() > MAX_COORDINATE) {
            None => Ok(()),
            Some(v) => Err(self.error(span, format!("{what} has {v}")).expected(format!(
                "finite numbers below {MAX_COORDINATE:e}, in metres, radians and seconds"
            ))),
        }
    }

    /// As [`check`](Self::check), and refuses numbers that are not above zero.
    pub(crate) fn positive(&self, what: &str, values: &[f64], span: &Range<usize>) -> Result<(), Error> {
        self.check(what, values, span)?;
        match values.iter().find(|v| **v <= 0.0) {
            None => Ok(()),
            Some(v) => Err(self.error(span, format!("{what} is {v}")).expected("numbers above zero")),
        }
    }

    /// The six numbers of a pose; zeros when it is not given.
    pub(crate) fn six(&self, what: &str, six: Option<Spanned<Exactly<f64, 6>>>) -> Result<[f64; 6], Error> {
        let Some(six) = six else { return Ok([0.0; 6]) };
        self.check(what, &six.get_ref().0, &six.span())?;
        Ok(six.into_inner().0)
    }
}

/// A list of `N`. For an array, the reader of TOML takes a longer list too, and drops the rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exactly<T, const N: usize>(pub(crate) [T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Exactly<T, N> {
    fn deserialize<D: Deserializer<'de>>(list: D) -> Result<Self, D::Error> {
        let all = Vec::deserialize(list)?;
        let length = all.len();
        let expected = format!("an array of length {N}");
        all.try_into().map(Self).map_err(|_| D::Error::invalid_length(length, &expected.as_str()))
    }
}

/// What a goal asks of one number of a configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GoalPart {
    /// The number must have this value.
    Exactly(f64),
    /// To be in this interval, both ends included.
    Between([f64; 2]),
    /// Nothing.
    Free,
}

/// A goal as a problem gives it.
#[derive(Clone, Debug, PartialEq)]
pub enum GoalEntry {
    /// All numbers of a configuration, in order.
    All(Vec<f64>),
    /// Some of them, by name; the others are free.
    Named(BTreeMap<String, GoalPart>),
    /// A link of an arm at a place.
    Pose(PoseEntry),
    /// A state of an arm that its SRDF names.
    State(String),
}

/// The start of a robot made of links and joints, as a problem gives it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(
    untagged,
    deny_unknown_fields,
    expecting = "a start is a list of numbers, a table of joints, such as { joint1 = 0.5 }, where the others are at zero, or the name of \
                 a state of the SRDF, such as \"home\""
)]
pub enum StartEntry {
    /// All numbers of a configuration, in order.
    All(Vec<f64>),
    /// Values by name; the others are zero, or the limit nearest to zero.
    Named(NamedStart),
    /// All numbers of a configuration, and values by name of the joints that are held.
    Beside {
        /// The numbers, in order.
        numbers: Vec<f64>,
        /// Where the joints are that do not move.
        held: NamedStart,
    },
}

/// Values of joints by name.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum NamedStart {
    /// Those of some joints.
    Joints(BTreeMap<String, f64>),
    /// A state that the SRDF names.
    State(String),
}

impl StartEntry {
    /// All numbers of the configuration; none when they are given by names.
    #[must_use]
    pub fn row(&self) -> &[f64] {
        match self {
            Self::All(numbers) | Self::Beside { numbers, .. } => numbers,
            Self::Named(_) => &[],
        }
    }

    /// What it gives by names.
    #[must_use]
    pub fn by_name(&self) -> Option<&NamedStart> {
        match self {
            Self::All(_) => None,
            Self::Named(named) | Self::Beside { held: named, .. } => Some(named),
        }
    }

    /// Its numbers, for checks of their size.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        let named = match self.by_name() {
            Some(NamedStart::Joints(values)) => values.values().copied().collect(),
            _ => Vec::new(),
        };
        [self.row(), &named].concat()
    }
}

impl GoalEntry {
    /// What the goal asks of each number of a configuration, of which the first `least` have no defaults. With `tolerance` above
    /// zero, values become intervals.
    ///
    /// # Errors
    /// What is wrong and what is expected: too many or too few numbers, or a name that is not in `names`.
    pub fn parts(
        &self,
        what: &str,
        names: &[String],
        least: usize,
        tolerance: f64,
    ) -> Result<Vec<GoalPart>, [String; 2]> {
        let about = |part: GoalPart| match part {
            GoalPart::Exactly(v) if tolerance > 0.0 => GoalPart::Between([v - tolerance, v + tolerance]),
            part => part,
        };
        match self {
            Self::All(values) if [least, names.len()].contains(&values.len()) => {
                let free = std::iter::repeat_n(GoalPart::Free, names.len() - values.len());
                Ok(values.iter().map(|v| about(GoalPart::Exactly(*v))).chain(free).collect())
            }
            Self::All(values) => {
                let numbers =
                    if values.len() == 1 { "1 number".into() } else { format!("{} numbers", values.len()) };
                Err([format!("{what} has {numbers}"), format!("{least}: {}", names[..least].join(", "))])
            }
            Self::Named(parts) => {
                if let Some(name) = parts.keys().find(|name| !names.contains(name)) {
                    let message = format!("{what} names `{}`, which the robot does not have", clipped(name));
                    return Err([message, format!("one or more of: {}", names.join(", "))]);
                }
                Ok(names.iter().map(|name| parts.get(name).copied().map_or(GoalPart::Free, about)).collect())
            }
            Self::Pose(pose) => Err([
                format!("{what} is a place of the link `{}`", clipped(&pose.link)),
                format!(
                    "numbers of a configuration ({}): only arms whose base stands still, and that do not move by inputs, have links as goals",
                    names.join(", ")
                ),
            ]),
            Self::State(state) => Err([
                format!("{what} is the state `{}`", clipped(state)),
                format!(
                    "numbers of a configuration ({}): only robots made of links and joints have states, in their SRDF",
                    names.join(", ")
                ),
            ]),
        }
    }

    /// All numbers of the configuration; `None` when some are free.
    #[must_use]
    pub fn values(&self) -> Option<&[f64]> {
        match self {
            Self::All(values) => Some(values),
            Self::Named(_) | Self::Pose(_) | Self::State(_) => None,
        }
    }

    /// Its numbers, for checks of their size.
    fn numbers(&self) -> Vec<f64> {
        match self {
            Self::All(values) => values.clone(),
            Self::Pose(goal) => [&goal.pose[..], &goal.within].concat(),
            Self::State(_) => Vec::new(),
            Self::Named(parts) => parts
                .values()
                .flat_map(|part| match part {
                    GoalPart::Exactly(v) => vec![*v],
                    GoalPart::Between(range) => range.to_vec(),
                    GoalPart::Free => Vec::new(),
                })
                .collect(),
        }
    }
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "a goal is a list of numbers, or a table of the numbers that are fixed, such as { x = 1.0, y = [2.0, 2.5] }, or of a \
                 link and its pose, such as { link = \"tool\", pose = [0.4, 0, 0.3, 0, 3.14, 0] }, or the name of a state of an SRDF"
)]
pub(crate) enum GoalText {
    All(Vec<f64>),
    State(String),
    Named(BTreeMap<String, PartText>),
}

#[derive(Deserialize)]
#[serde(untagged)]
pub(crate) enum PartText {
    Exactly(f64),
    Between([f64; 2]),
    /// Of a [`PoseEntry`].
    Numbers(Vec<f64>),
    Text(String),
}

/// The table `motion` of a problem.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MotionTable<S = Vec<f64>> {
    start: Spanned<S>,
    goal: Option<Spanned<GoalText>>,
    goals: Option<Spanned<Vec<Spanned<GoalText>>>>,
    tolerance: Option<Spanned<f64>>,
    speed: Option<Spanned<f64>>,
    start_time: Option<Spanned<f64>>,
    goal_time: Option<Spanned<PartText>>,
    horizon: Option<Spanned<f64>>,
}

/// The start and the goals of a problem, at least one, and their places.
pub(crate) struct Motion<S = Vec<f64>> {
    pub(crate) start: S,
    pub(crate) goals: Vec<GoalEntry>,
    /// How far a number of the last configuration may be from that of the goal; 0 when it is not given.
    pub(crate) tolerance: f64,
    pub(crate) timing: Option<Timing>,
    pub(crate) places: MotionPlaces,
}

/// When a robot moves among obstacles that move: seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// The greatest speed of the robot, in the metric of its space per second; `None` for a robot that moves by inputs.
    pub speed: Option<f64>,
    /// When the motion begins.
    pub start: f64,
    /// The time of the arrival; any time when it is not given.
    pub goal: Option<[f64; 2]>,
    /// The last time at which the robot may move; `None` for a time after which nothing else moves.
    pub horizon: Option<f64>,
}

/// Where start and goals are in the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MotionPlaces {
    pub(crate) start: Range<usize>,
    pub(crate) goals: Vec<Range<usize>>,
    pub(crate) tolerance: Option<Range<usize>>,
    pub(crate) speed: Option<Range<usize>>,
}

impl MotionPlaces {
    /// Where the goal of this index is; the start when there is no such goal.
    pub(crate) fn goal(&self, index: usize) -> &Range<usize> {
        self.goals.get(index).unwrap_or(&self.start)
    }
}

impl<S> MotionTable<S> {
    /// The start and the goals; `check` checks the numbers of the start, and takes its name in errors. `by_inputs` says that the
    /// robot moves by inputs among obstacles that move: then it has times, and no speed.
    pub(crate) fn read(
        self,
        text: &TomlText<'_>,
        by_inputs: bool,
        check: impl Fn(&str, &Spanned<S>) -> Result<(), Error>,
    ) -> Result<Motion<S>, Error> {
        check("the start", &self.start)?;
        let goals = Goals { goal: self.goal, goals: self.goals }.read(text, &self.start.span())?;
        let places = MotionPlaces {
            start: self.start.span(),
            goals: goals.iter().map(|(_, place)| place.clone()).collect(),
            tolerance: self.tolerance.as_ref().map(Spanned::span),
            speed: self.speed.as_ref().map(Spanned::span),
        };
        let goals = goals.into_iter().map(|(goal, _)| goal).collect();
        let tolerance = match &self.tolerance {
            None => 0.0,
            Some(given) => {
                text.positive("the tolerance", &[*given.get_ref()], &given.span())?;
                *given.get_ref()
            }
        };
        let timing = timing(text, by_inputs, self.speed, self.start_time, self.goal_time, self.horizon)?;
        Ok(Motion { start: self.start.into_inner(), goals, tolerance, timing, places })
    }
}

/// A goal, or several, of a table that may have others.
pub(crate) struct Goals {
    pub(crate) goal: Option<Spanned<GoalText>>,
    pub(crate) goals: Option<Spanned<Vec<Spanned<GoalText>>>>,
}

impl Goals {
    /// The goals, at least one, and where each is. Without any the error is at `place`.
    pub(crate) fn read(
        self,
        text: &TomlText<'_>,
        place: &Range<usize>,
    ) -> Result<Vec<(GoalEntry, Range<usize>)>, Error> {
        let goals = match (self.goal, self.goals) {
            (Some(goal), None) => vec![goal],
            (None, Some(goals)) if !goals.get_ref().is_empty() => goals.into_inner(),
            (None, Some(goals)) => {
                return Err(text.error(&goals.span(), "there are no goals").expected("at least one"));
            }
            (Some(_), Some(goals)) => {
                let message = "there is a goal and a list of goals";
                return Err(text.error(&goals.span(), message).expected("`goal` or `goals`, not both"));
            }
            (None, None) => {
                let message = "the motion has no goal";
                return Err(text.error(place, message).expected("`goal = [...]` beside `start`"));
            }
        };
        goals.into_iter().map(|goal| one_goal(text, goal)).collect()
    }
}

fn one_goal(text: &TomlText<'_>, goal: Spanned<GoalText>) -> Result<(GoalEntry, Range<usize>), Error> {
    let span = goal.span();
    let goal = match goal.into_inner() {
        GoalText::All(values) => GoalEntry::All(values),
        GoalText::State(name) => GoalEntry::State(name),
        GoalText::Named(parts) if parts.is_empty() => {
            let message = "the goal asks for nothing";
            return Err(text.error(&span, message).expected("at least one number, such as { x = 1.0 }"));
        }
        GoalText::Named(parts) if matches!(parts.get("link"), Some(PartText::Text(_))) => {
            GoalEntry::Pose(PoseEntry::read(text, parts, &span)?)
        }
        GoalText::Named(parts) => {
            let parts = parts.into_iter().map(|(name, part)| match part {
                PartText::Exactly(v) => Ok((name, GoalPart::Exactly(v))),
                PartText::Between(range) => {
                    let what = format!("{} of the goal", clipped(&name));
                    Ok((name, GoalPart::Between(interval(text, &what, range, &span)?)))
                }
                PartText::Numbers(_) | PartText::Text(_) => {
                    let message =
                        format!("{} of the goal is neither a number nor an interval", clipped(&name));
                    Err(text.error(&span, message).expected("such as { x = 1.0, y = [2.0, 2.5] }"))
                }
            });
            GoalEntry::Named(parts.collect::<Result<_, Error>>()?)
        }
    };
    text.check("the goal", &goal.numbers(), &span)?;
    Ok((goal, span))
}

/// An interval whose ends are in order.
fn interval(
    text: &TomlText<'_>,
    what: &str,
    range: [f64; 2],
    span: &Range<usize>,
) -> Result<[f64; 2], Error> {
    text.check(what, &range, span)?;
    if range[0] <= range[1] {
        return Ok(range);
    }
    let message = format!("{what} is from {} to {}", range[0], range[1]);
    Err(text.error(span, message).expected("the lower end first"))
}

/// When the robot moves; `None` when no speed is given to a robot that does not move by inputs.
fn timing(
    text: &TomlText<'_>,
    by_inputs: bool,
    speed: Option<Spanned<f64>>,
    start: Option<Spanned<f64>>,
    goal: Option<Spanned<PartText>>,
    horizon: Option<Spanned<f64>>,
) -> Result<Option<Timing>, Error> {
    if by_inputs && let Some(speed) = &speed {
        let message = "the robot moves by inputs, and has a speed in [motion] too";
        return Err(text.error(&speed.span(), message).expected("no speed here: inputs say how fast it is"));
    }
    if speed.is_none() && !by_inputs {
        let stray = [
            ("start_time", start.as_ref().map(Spanned::span)),
            ("goal_time", goal.as_ref().map(Spanned::span)),
            ("horizon", horizon.as_ref().map(Spanned::span)),
        ];
        return match stray.into_iter().find_map(|(name, span)| Some((name, span?))) {
            None => Ok(None),
            Some((name, span)) => {
                let message = format!("`{name}` is given, and no speed");
                Err(text.error(&span, message).expected("`speed = METRES_PER_SECOND` beside it"))
            }
        };
    }
    if let Some(speed) = &speed {
        text.positive("the speed", &[*speed.get_ref()], &speed.span())?;
    }
    let seconds = |what: &str, value: f64, span: &Range<usize>| {
        text.check(what, &[value], span)?;
        match value >= 0.0 {
            true => Ok(value),
            false => Err(text.error(span, format!("{what} is {value}")).expected("seconds, zero or more")),
        }
    };
    let at = |what: &str, given: &Option<Spanned<f64>>| {
        given.as_ref().map(|given| seconds(what, *given.get_ref(), &given.span())).transpose()
    };
    let begin = at("the time of the start", &start)?.unwrap_or(0.0);
    let end = at("the horizon", &horizon)?;
    if let (Some(end), Some(place)) = (end, &horizon)
        && end <= begin
    {
        let message = format!("the horizon is {end} s, and the start at {begin} s");
        return Err(text.error(&place.span(), message).expected("a time after the start"));
    }
    let arrival = match goal {
        None => None,
        Some(goal) => {
            let span = goal.span();
            let range = match goal.into_inner() {
                PartText::Exactly(time) => [time; 2],
                PartText::Between(range) => interval(text, "the time of the goal", range, &span)?,
                PartText::Numbers(_) | PartText::Text(_) => {
                    let message = "the time of the goal is neither a number nor an interval";
                    return Err(text.error(&span, message).expected("such as 5.0 or [4.5, 5.5], in seconds"));
                }
            };
            seconds("the time of the goal", range[0], &span)?;
            if by_inputs && range[0] == range[1] {
                let message = "a robot that moves by inputs cannot arrive at an exact time";
                return Err(text.error(&span, message).expected("an interval: `goal_time = [4.5, 5.5]`"));
            }
            if range[1] < begin || end.is_some_and(|end| range[0] > end) {
                let message = format!(
                    "the goal is at {} to {} s, which is not between start and horizon",
                    range[0], range[1]
                );
                return Err(text.error(&span, message).expected("a time after the start, up to the horizon"));
            }
            Some(range)
        }
    };
    let speed = speed.map(Spanned::into_inner);
    Ok(Some(Timing { speed, start: begin, goal: arrival, horizon: end }))
}

/// The timed poses of something that moves, at increasing times: each row has the time (s) and `numbers` more numbers, of which
/// the last `optional` may be left out.
pub(crate) fn timed_rows(
    text: &TomlText<'_>,
    what: &str,
    rows: &Spanned<Vec<Vec<f64>>>,
    [numbers, optional]: [usize; 2],
    expected: &str,
) -> Result<Vec<Vec<f64>>, Error> {
    let span = rows.span();
    let fault = |message: String| Err(text.error(&span, message).expected(expected));
    if rows.get_ref().is_empty() {
        return fault(format!("the path of {what} is empty"));
    }
    let mut last = f64::NEG_INFINITY;
    let mut found: Vec<Vec<f64>> = Vec::new();
    for (i, row) in rows.get_ref().iter().enumerate() {
        text.check(&format!("the path of {what}"), row, &span)?;
        if ![1 + numbers - optional, 1 + numbers].contains(&row.len()) {
            return fault(format!("row {} of the path of {what} has {} numbers", i + 1, row.len()));
        }
        if row[0] <= last {
            return fault(format!(
                "row {} of the path of {what} is at {} s, not after the row before",
                i + 1,
                row[0]
            ));
        }
        last = row[0];
        let mut row = row.clone();
        row.resize(1 + numbers, 0.0);
        if found.last().is_some_and(|before| is_half_turn(before, &row)) {
            let message = format!(
                "row {} of the path of {what} is turned half way round from the row before: nothing says which way it turns",
                i + 1
            );
            return Err(text
                .error(&span, message)
                .expected("a row between the two, such as one at a quarter turn"));
        }
        found.push(row);
    }
    Ok(found)
}

/// Whether two timed poses, with an angle or three, are exactly half a turn apart.
fn is_half_turn(from: &[f64], to: &[f64]) -> bool {
    let rotation = |row: &[f64]| match *row {
        [_, x, y, angle] => pose_from_six([x, y, 0.0, angle, 0.0, 0.0]).rotation,
        _ => pose_from_six(std::array::from_fn(|i| row.get(i + 1).copied().unwrap_or(0.0))).rotation,
    };
    // The cosine of half of the angle between them.
    rotation(from).coords.dot(&rotation(to).coords).abs() < 1e-9
}

#[cfg(test)]
pub(crate) mod tests {
    use mp_formats::error::Error;

    /// Whether an error is at `line`, says `words`, has a remedy and is shown on one line.
    pub(crate) fn is_clear(error: &Error, line: usize, words: &str) -> bool {
        let shown = error.to_string();
        let placed = error.line() == Some(line) && shown.contains(words);
        placed && error.remedy().is_some() && !shown.contains('\n')
    }
}
