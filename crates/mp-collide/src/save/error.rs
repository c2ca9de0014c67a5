//! Why a tree could not be saved or loaded.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why bytes are no tree.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TreeError {
    /// The file could not be read or written.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// The first eight bytes are not those of the format.
    #[error("not a file of a collision tree: it does not begin with the bytes 89 4d 50 54 0d 0a 1a 0a")]
    NotATree,
    /// A version of the format that this version of the library cannot read.
    #[error("byte 8: expected version {expected} of the format, found {found}; build the tree anew")]
    Version {
        /// The version in the file.
        found: u32,
        /// The version that can be read.
        expected: u32,
    },
    /// The length is not the one that follows from the counts in the header.
    #[error("expected {expected} bytes from the counts in the header, found {found}: cut off, or damaged")]
    Length {
        /// Bytes there should be.
        expected: u64,
        /// Bytes there are.
        found: u64,
    },
    /// The bytes are not those that were written.
    #[error("byte {at}: expected the checksum {expected:016x}, found {found:016x}: the bytes are damaged")]
    Checksum {
        /// Where the checksum is.
        at: u64,
        /// The checksum of the bytes.
        expected: u64,
        /// The checksum there is.
        found: u64,
    },
    /// Something that cannot be in the tree of a mesh.
    #[error("byte {at}: expected {expected}, found {found}")]
    Invalid {
        /// Where it is.
        at: u64,
        /// What would have been right.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// The tree of another mesh than the one asked for.
    #[error("the tree is that of another mesh: fingerprint {found:016x}, expected {expected:016x}")]
    OtherMesh {
        /// The fingerprint of the mesh asked for.
        expected: u64,
        /// The fingerprint of the mesh in the file.
        found: u64,
    },
}

/// Why a file could not be saved or loaded.
#[derive(Debug, Error)]
#[error("{}: {problem}", path.display())]
pub struct TreeFileError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    #[source]
    pub problem: TreeError,
}

impl TreeFileError {
    pub(super) fn new(path: &Path, problem: TreeError) -> Self {
        Self { path: path.to_owned(), problem }
    }
}
