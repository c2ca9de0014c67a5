//! Trees in files: built once, loaded without building. `docs/formats/tree.md` describes the format.

mod check;
mod error;
mod format;
mod reader;

use std::io::{Read, Write};
use std::path::Path;

use mp_geom::TriMesh;
use xxhash_rust::xxh3::Xxh3;

use crate::mesh::CollisionMesh;
use crate::triangle::Triangle;

pub use error::{TreeError, TreeFileError};
pub(crate) use format::read;

/// Trees in files.
impl CollisionMesh {
    /// Mesh and tree as bytes, in the format of `docs/formats/tree.md`: the same bytes for the same mesh and
    /// tree. O(n) for n triangles.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        format::write(self)
    }

    /// The mesh and its tree from what [`CollisionMesh::to_bytes`] gave; O(n), several times faster than
    /// building. Answers are the same bit for bit.
    ///
    /// Everything is checked: whatever the bytes, there is an error, or a tree whose answers are right for
    /// the triangles it has.
    ///
    /// # Errors
    /// [`TreeError`], with the place and what was expected there.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TreeError> {
        format::read(bytes, true)
    }

    /// Writes [`CollisionMesh::to_bytes`] to a file, in one step: to a temporary file in the same folder, then
    /// renamed, so that nobody ever reads half of it.
    ///
    /// # Errors
    /// [`TreeError::Io`] when that cannot be done, or `path` is something other than a file.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), TreeFileError> {
        let path = path.as_ref();
        write_atomic(path, &self.to_bytes()).map_err(|e| TreeFileError::new(path, e.into()))
    }

    /// Reads what [`CollisionMesh::save`] wrote.
    ///
    /// # Errors
    /// As [`CollisionMesh::from_bytes`]; [`TreeError::Io`] when the file cannot be read.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, TreeFileError> {
        let path = path.as_ref();
        read_file(path).and_then(|bytes| Self::from_bytes(&bytes)).map_err(|e| TreeFileError::new(path, e))
    }

    /// [`CollisionMesh::load`], when the file holds the tree of `mesh`.
    ///
    /// # Errors
    /// [`TreeError::OtherMesh`] when it is the tree of another mesh, for instance because `mesh` has changed;
    /// otherwise as [`CollisionMesh::load`].
    pub fn load_for(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<Self, TreeFileError> {
        let path = path.as_ref();
        let loaded = Self::load(path)?;
        let (expected, found) = (Self::fingerprint_of(mesh), loaded.fingerprint());
        if expected == found {
            Ok(loaded)
        } else {
            Err(TreeFileError::new(path, TreeError::OtherMesh { expected, found }))
        }
    }

    /// A hash of the triangles, in their order: XXH3-64 of the coordinates of the corners as little-endian
    /// `f64`. The same on any machine. Meant to notice that a mesh has changed, not to resist forgery. O(n).
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        fingerprint(self.triangles().into_iter())
    }

    /// What [`CollisionMesh::fingerprint`] is for the tree of `mesh`, without building it.
    #[must_use]
    pub fn fingerprint_of(mesh: &TriMesh) -> u64 {
        fingerprint((0..mesh.triangles().len()).map(|i| mesh.triangle(i)))
    }
}

fn fingerprint(triangles: impl Iterator<Item = Triangle>) -> u64 {
    let mut hash = Xxh3::new();
    for triangle in triangles {
        let mut bytes = [0; 72];
        let numbers = triangle.iter().flat_map(|p| [p.x, p.y, p.z]);
        for (eight, x) in bytes.chunks_exact_mut(8).zip(numbers) {
            eight.copy_from_slice(&x.to_le_bytes());
        }
        hash.update(&bytes);
    }
    hash.digest()
}

/// The bytes of a file that says it is a tree, and is as long as it says.
fn read_file(path: &Path) -> Result<Vec<u8>, TreeError> {
    // Opening a pipe could wait for ever.
    regular(&std::fs::metadata(path)?)?;
    let file = std::fs::File::open(path)?;
    let found = file.metadata()?.len();
    let mut bytes = Vec::new();
    (&file).take(format::HEADER as u64).read_to_end(&mut bytes)?;
    let expected = format::length(&bytes)?;
    if expected != found {
        return Err(TreeError::Length { expected, found });
    }
    (&file).take(expected - bytes.len() as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn write_atomic(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let existing = std::fs::metadata(path).ok();
    existing.as_ref().map_or(Ok(()), regular)?;
    // Through a link, not in place of it.
    let target = if path.is_symlink() { std::fs::canonicalize(path)? } else { path.to_owned() };
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".mp-").suffix(".tmp");
    #[cfg(unix)]
    {
        // What `File::create` gives; the process' umask still applies.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(&target)?;
    Ok(())
}

fn regular(metadata: &std::fs::Metadata) -> std::io::Result<()> {
    if metadata.is_file() {
        return Ok(());
    }
    Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, "not a regular file"))
}
