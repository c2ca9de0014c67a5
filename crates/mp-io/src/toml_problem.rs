//! Problems in TOML: the place of every value, so that errors can point at it, and the table of start and goals.

use crate::error::{Error, ErrorKind};
use crate::problem::MAX_COORDINATE;
use serde::Deserialize;
use serde::de::DeserializeOwned;
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
            let message = crate::text::clipped_to(&message, 300);
            let length = span.end.saturating_sub(span.start).max(1);
            Error::at(ErrorKind::Format, self.file, self.text, span.start, length, message).help(self.guide)
        })
    }

    /// An error at `span`.
    pub(crate) fn error(&self, span: &Range<usize>, message: impl Into<String>) -> Error {
        let length = span.end.saturating_sub(span.start).max(1);
        Error::at(ErrorKind::Content, self.file, self.text, span.start, length, message.into())
            .help(self.guide)
    }

    /// Refuses numbers that are not finite or beyond [`MAX_COORDINATE`].
    pub(crate) fn check(&self, what: &str, values: &[f64], span: &Range<usize>) -> Result<(), Error> {
        match values.iter().find(|v| v.is_nan() || v.abs() > MAX_COORDINATE) {
            None => Ok(()),
            Some(v) => Err(self
                .error(span, format!("{what} has {v}"))
                .expected(format!("finite numbers below {MAX_COORDINATE:e}, in metres and radians"))),
        }
    }

    /// As [`check`](Self::check), and refuses numbers that are not above zero.
    pub(crate) fn positive(&self, what: &str, values: &[f64], span: &Range<usize>) -> Result<(), Error> {
        self.check(what, values, span)?;
        match values.iter().find(|v| **v <= 0.0) {
            None => Ok(()),
            Some(v) => {
                Err(self.error(span, format!("{what} is {v}")).expected("lengths above zero, in metres"))
            }
        }
    }

    /// The six numbers of a pose; zeros when it is not given.
    pub(crate) fn six(&self, what: &str, six: Option<Spanned<[f64; 6]>>) -> Result<[f64; 6], Error> {
        let Some(six) = six else { return Ok([0.0; 6]) };
        self.check(what, six.get_ref(), &six.span())?;
        Ok(six.into_inner())
    }
}

/// The table `motion` of a problem.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MotionTable {
    start: Spanned<Vec<f64>>,
    goal: Option<Spanned<Vec<f64>>>,
    goals: Option<Spanned<Vec<Spanned<Vec<f64>>>>>,
}

/// The start and the goals of a problem, at least one, and their places.
pub(crate) struct Motion {
    pub(crate) start: Vec<f64>,
    pub(crate) goals: Vec<Vec<f64>>,
    pub(crate) places: MotionPlaces,
}

/// Where start and goals are in the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MotionPlaces {
    pub(crate) start: Range<usize>,
    goals: Vec<Range<usize>>,
}

impl MotionPlaces {
    /// Where the goal of this index is; the start when there is no such goal.
    pub(crate) fn goal(&self, index: usize) -> &Range<usize> {
        self.goals.get(index).unwrap_or(&self.start)
    }
}

impl MotionTable {
    /// The start and the goals, each checked by `check`, which also takes its name in errors.
    pub(crate) fn read(
        self,
        text: &TomlText<'_>,
        check: impl Fn(&str, &Spanned<Vec<f64>>) -> Result<(), Error>,
    ) -> Result<Motion, Error> {
        check("the start", &self.start)?;
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
                let expected = "`goal = [...]` beside `start`";
                return Err(text.error(&self.start.span(), message).expected(expected));
            }
        };
        goals.iter().try_for_each(|goal| check("the goal", goal))?;
        let places =
            MotionPlaces { start: self.start.span(), goals: goals.iter().map(Spanned::span).collect() };
        let goals = goals.into_iter().map(Spanned::into_inner).collect();
        Ok(Motion { start: self.start.into_inner(), goals, places })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use crate::error::Error;

    /// Whether an error is at `line`, says `words`, has a remedy and is shown on one line.
    pub(crate) fn is_clear(error: &Error, line: usize, words: &str) -> bool {
        let shown = error.to_string();
        let placed = error.line() == Some(line) && shown.contains(words);
        placed && error.remedy().is_some() && !shown.contains('\n')
    }
}
