//! Errors: those of `mp-plan`, into which all others are converted.

use mp_plan::Error;
use std::fmt::Display;

/// The result of a function of this crate.
pub(crate) type Result<T> = std::result::Result<T, Error>;

/// Converts any error into one of `mp-plan`.
pub(crate) trait IntoError<T> {
    /// The error with the same message.
    fn into_error(self) -> Result<T>;
    /// The error with the context `what`, such as "cannot read the file".
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
