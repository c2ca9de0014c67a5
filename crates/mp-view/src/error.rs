//! Why bytes are not a scene file.

use thiserror::Error;

/// Why bytes are not a scene file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ViewError {
    /// The bytes do not begin as scene files do.
    #[error("not a scene file of the viewer: it must begin with the letters MPV1")]
    NotAScene,
    /// The file ends before its head does.
    #[error("the file is cut off: it has {found} bytes, but its head needs {expected}")]
    CutOff {
        /// How many bytes the head needs.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// The head is not the JSON expected.
    #[error("the head of the file cannot be read: {reason}")]
    Head {
        /// What is wrong with it.
        reason: String,
    },
    /// The file has another version.
    #[error("the file has version {found}; this program reads version {expected}")]
    Version {
        /// The version of the file.
        found: u32,
        /// The version read.
        expected: u32,
    },
    /// An array reaches beyond the end of the file, or does not fit its purpose.
    #[error("the array {what} {problem}")]
    Array {
        /// Which array.
        what: String,
        /// What is wrong with it.
        problem: &'static str,
    },
}
