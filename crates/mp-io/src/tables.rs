//! TOML: tables with a place for every value, so that errors can point at it.

use crate::error::{Error, ErrorKind};
use crate::problem::MAX_COORDINATE;
use serde::de::DeserializeOwned;
use std::ops::Range;
use toml::Spanned;

/// A text and the name that errors give it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    pub(crate) file: &'a str,
    pub(crate) text: &'a str,
    /// Where the format is described.
    pub(crate) guide: &'static str,
}

impl Source<'_> {
    /// The tables of the text.
    pub(crate) fn read<T: DeserializeOwned>(&self) -> Result<T, Error> {
        toml::from_str(self.text).map_err(|e| {
            let span = e.span().unwrap_or(0..0);
            // One line, whatever the parser says.
            let message = e.message().split_whitespace().collect::<Vec<_>>().join(" ");
            let message = crate::text::clipped_to(&message, 300);
            let length = span.end.saturating_sub(span.start).max(1);
            Error::at(ErrorKind::Format, self.file, self.text, span.start, length, message).help(self.guide)
        })
    }

    pub(crate) fn error(&self, span: &Range<usize>, message: impl Into<String>) -> Error {
        let length = span.end.saturating_sub(span.start).max(1);
        Error::at(ErrorKind::Content, self.file, self.text, span.start, length, message.into())
            .help(self.guide)
    }

    /// Finite and not absurdly large.
    pub(crate) fn check(&self, what: &str, values: &[f64], span: &Range<usize>) -> Result<(), Error> {
        match values.iter().find(|v| v.is_nan() || v.abs() > MAX_COORDINATE) {
            None => Ok(()),
            Some(v) => Err(self
                .error(span, format!("{what} has {v}"))
                .expected(format!("finite numbers below {MAX_COORDINATE:e}, in metres and radians"))),
        }
    }

    pub(crate) fn positive(&self, what: &str, values: &[f64], span: &Range<usize>) -> Result<(), Error> {
        self.check(what, values, span)?;
        match values.iter().find(|v| **v <= 0.0) {
            None => Ok(()),
            Some(v) => {
                Err(self.error(span, format!("{what} is {v}")).expected("lengths above zero, in metres"))
            }
        }
    }

    pub(crate) fn six(&self, what: &str, six: Option<Spanned<[f64; 6]>>) -> Result<[f64; 6], Error> {
        let Some(six) = six else { return Ok([0.0; 6]) };
        self.check(what, six.get_ref(), &six.span())?;
        Ok(six.into_inner())
    }
}
