//! Which file a name leads to.

use crate::write::followed;
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

/// The identity of a file: equal for all names that lead to the same file, by links, `./x`, or letters of
/// another case where the system does not tell them apart. The file need not exist.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FileId(Id);

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Id {
    /// Device and number of a file that exists.
    #[cfg(unix)]
    Inode(u64, u64),
    /// Where the file is, or would be.
    Place(PathBuf),
}

impl FileId {
    /// The identity of the file at `path`.
    #[must_use]
    pub fn of(path: &Path) -> Self {
        let path = followed(path).unwrap_or_else(|_| path.to_owned());
        #[cfg(unix)]
        if let Ok(meta) = std::fs::metadata(&path) {
            use std::os::unix::fs::MetadataExt;
            return Self(Id::Inode(meta.dev(), meta.ino()));
        }
        let place = place(&path);
        // These systems usually do not tell upper from lower case.
        let folds = cfg!(any(windows, target_os = "macos"));
        Self(Id::Place(if folds { place.to_string_lossy().to_lowercase().into() } else { place }))
    }
}

/// The absolute path, without links, `.` and `..`. The last parts need not exist.
fn place(path: &Path) -> PathBuf {
    let mut missing: Vec<OsString> = Vec::new();
    let mut existing = path;
    loop {
        let known = if existing.as_os_str().is_empty() { Path::new(".") } else { existing };
        if let Ok(mut place) = std::fs::canonicalize(known) {
            for part in missing.iter().rev() {
                match Path::new(part).components().next() {
                    Some(Component::ParentDir) => drop(place.pop()),
                    Some(Component::CurDir) | None => {}
                    Some(_) => place.push(part),
                }
            }
            return place;
        }
        let mut parts = existing.components();
        let Some(last) = parts.next_back() else { return path.to_owned() };
        missing.push(last.as_os_str().to_owned());
        existing = parts.as_path();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_names_of_a_file_are_the_same_file() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        std::fs::write(at("a"), "").unwrap();
        std::fs::write(at("b"), "").unwrap();
        std::fs::create_dir(at("folder")).unwrap();
        let same = |a: &str, b: &str| FileId::of(&at(a)) == FileId::of(&at(b));
        for (a, b) in [
            ("a", "./a"),
            ("a", "folder/../a"),
            ("new", "./new"),
            ("new", "folder/../new"),
            ("new/x", "new/../new/./x"),
        ] {
            assert!(same(a, b), "{a} {b}");
        }
        for (a, b) in [("a", "b"), ("a", "folder/a"), ("new", "newer"), ("new/x", "x")] {
            assert!(!same(a, b), "{a} {b}");
        }
        assert_eq!(
            FileId::of(Path::new("no-such-file")),
            FileId::of(&std::env::current_dir().unwrap().join("no-such-file"))
        );
    }

    #[test]
    #[cfg(unix)]
    fn links_of_both_kinds_are_the_same_file() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        let same = |a: &str, b: &str| FileId::of(&at(a)) == FileId::of(&at(b));
        std::fs::write(at("a"), "").unwrap();
        std::fs::create_dir(at("folder")).unwrap();
        std::os::unix::fs::symlink("a", at("soft")).unwrap();
        std::fs::hard_link(at("a"), at("hard")).unwrap();
        std::os::unix::fs::symlink("folder", at("there")).unwrap();
        std::os::unix::fs::symlink("later", at("early")).unwrap();
        assert!(same("a", "soft") && same("a", "hard") && same("folder/x", "there/x"));
        assert!(same("early", "later"));
        assert!(!same("early", "soft"));
    }
}
