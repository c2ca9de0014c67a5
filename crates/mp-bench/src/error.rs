//! Errors: those of `mp-plan`, made of any other.

use mp_plan::Error;
use std::fmt::Display;

/// What comes of a measurement.
pub(crate) type Result<T> = std::result::Result<T, Error>;

/// An error of any kind as one of `mp-plan`.
pub(crate) trait IntoError<T> {
    /// The same with its message.
    fn into_error(self) -> Result<T>;
    /// The same, said to have happened while doing `what`: "cannot read the file".
    fn doing(self, what: impl FnOnce() -> String) -> Result<T>;
}

impl<T, E: Display> IntoError<T> for std::result::Result<T, E> {
    fn into_error(self) -> Result<T> {
        self.map_err(|e| Error::new(e.to_string()))
    }
    fn doing(self, what: impl FnOnce() -> String) -> Result<T> {
        self.map_err(|e| Error::new(e.to_string()).context(what()))
    }
}
