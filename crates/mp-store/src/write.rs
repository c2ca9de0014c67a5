//! Writing files whole or not at all.

use crate::error::{Error, ErrorKind};
use crate::temporary::{Temporary, sweep};
use std::fs::{Metadata, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// At most this number of links are followed to a file.
const LINKS: usize = 40;

/// Small parts are collected and written in blocks of this number of bytes.
const BUFFER: usize = 1 << 16;

/// The folder of a file; the current one for a bare name.
#[must_use]
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes a folder, and those above it, when it is missing.
///
/// # Errors
/// When it cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), Error> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    if folder.is_dir() {
        return Ok(());
    }
    let above = folder_of(folder);
    if above != folder {
        make_folder(above)?;
    }
    match std::fs::create_dir(folder) {
        Ok(()) => {
            sync_folder(above);
            Ok(())
        }
        // Another process was faster.
        Err(_) if folder.is_dir() => Ok(()),
        Err(e) => {
            let remedy = format!("make {} a folder that you may write to", above.display());
            Err(Error::io(folder, "make the folder", &e, remedy))
        }
    }
}

/// Writes `bytes` to `path` in one step: to a temporary file in the same folder, which is then renamed. A
/// reader sees the old file or the whole new one, also after the process was killed or the machine lost its
/// power. A failure leaves the old file as it was.
///
/// A link stays a link: the file that it leads to is replaced. The new file has the permissions and, as far
/// as the system allows it, the owner of the old one. Temporary files that a killed process left in the
/// folder are removed.
///
/// # Errors
/// When the folder is missing or not writable, the file is write-protected or not a regular file, or the disk
/// is full.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    write_parts(path, [Ok::<_, Error>(bytes)])
}

/// As [`write`](fn@write), of a file that is made part by part, as it may be too large for memory. An error
/// among the parts is returned, and leaves the old file as it was.
///
/// # Errors
/// As [`write`](fn@write), and the first among the parts.
pub fn write_parts<B: AsRef<[u8]>, E: From<Error>>(
    path: &Path,
    parts: impl IntoIterator<Item = Result<B, E>>,
) -> Result<(), E> {
    let (target, old) = target(path)?;
    let folder = folder_of(&target);
    sweep(folder);
    let new = filled(path, folder, old.as_ref(), parts)?;
    new.rename(&target).map_err(|e| write_failed(path, folder, &e))?;
    sync_folder(folder);
    Ok(())
}

/// A temporary file in `folder` with these parts, which is on the disk: what `path` will be, in place of the
/// file `old`.
pub(crate) fn filled<B: AsRef<[u8]>, E: From<Error>>(
    path: &Path,
    folder: &Path,
    old: Option<&Metadata>,
    parts: impl IntoIterator<Item = Result<B, E>>,
) -> Result<Temporary, E> {
    let failed = |e: io::Error| write_failed(path, folder, &e);
    let mut new = Temporary::new_in(folder).map_err(failed)?;
    if let Some(old) = old {
        keep_access(&new, old).map_err(failed)?;
    }
    let mut bytes = 0;
    let mut file = BufWriter::with_capacity(BUFFER, &mut new.file);
    for part in parts {
        let part = part?;
        bytes += part.as_ref().len();
        file.write_all(part.as_ref()).map_err(failed)?;
    }
    file.flush().map_err(failed)?;
    drop(file);
    new.file.sync_all().map_err(failed)?;
    tracing::debug!(file = %path.display(), bytes, "written");
    Ok(new)
}

/// Refuses a path that [`write`](fn@write) would not be able to write: for programs that work for long before
/// they write. The folder may be missing, if it could be made.
///
/// # Errors
/// As [`write`](fn@write).
pub fn writable(path: &Path) -> Result<(), Error> {
    let (target, _) = target(path)?;
    // The nearest folder that exists must be one, and take new files.
    let mut folder = folder_of(&target);
    while !folder.exists() && folder_of(folder) != folder {
        folder = folder_of(folder);
    }
    if !folder.is_dir() {
        let message = format!("cannot write the file: {} is not a folder", folder.display());
        return Err(Error::new(ErrorKind::Io, path, message, "name a file in a folder"));
    }
    Temporary::new_in(folder).map(drop).map_err(|e| write_failed(path, folder, &e))
}

/// The regular file that writing to `path` replaces, and what is known about it if it exists.
pub(crate) fn target(path: &Path) -> Result<(PathBuf, Option<Metadata>), Error> {
    let failed = |e: io::Error| write_failed(path, folder_of(path), &e);
    let refused = |what: &str, remedy: &str| {
        Err(Error::new(ErrorKind::Io, path, format!("cannot write the file: {what}"), remedy))
    };
    // Where a link leads to a pipe that has no name, nothing is found at the end.
    if std::fs::metadata(path).is_ok_and(|old| !old.is_file() && !old.is_dir()) {
        return refused("this is a device or a pipe", "name a regular file");
    }
    let target = followed(path).map_err(failed)?;
    match std::fs::metadata(&target) {
        Ok(old) if old.is_dir() => refused("this is a folder", "name a file inside it"),
        // Renaming would replace the device or pipe itself.
        Ok(old) if !old.is_file() => refused("this is a device or a pipe", "name a regular file"),
        // Renaming would replace a write-protected file too.
        Ok(old) => match OpenOptions::new().write(true).open(&target) {
            Err(e) if e.kind() == io::ErrorKind::PermissionDenied => {
                refused("it is write-protected", "make it writable, or name another file")
            }
            Err(e) => Err(failed(e)),
            Ok(_) => Ok((target, Some(old))),
        },
        // What is wrong with the folder is said when a file is made in it.
        Err(e) if matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
            Ok((target, None))
        }
        Err(e) => Err(failed(e)),
    }
}

/// The path at the end of a chain of links. There need not be a file.
pub(crate) fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut at = path.to_owned();
    for _ in 0..LINKS {
        if !at.is_symlink() {
            return Ok(at);
        }
        at = folder_of(&at).join(std::fs::read_link(&at)?);
    }
    Err(io::Error::other("too many links lead from one to the next"))
}

pub(crate) fn write_failed(path: &Path, folder: &Path, error: &io::Error) -> Error {
    let remedy = match error.kind() {
        io::ErrorKind::NotFound => format!("create the folder {}", folder.display()),
        io::ErrorKind::NotADirectory => "name a file in a folder".to_owned(),
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            format!("make the folder {} writable, or write elsewhere", folder.display())
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "make room, or write elsewhere".to_owned()
        }
        _ => "write elsewhere".to_owned(),
    };
    Error::io(path, "write the file", error, remedy)
}

/// Gives a new file the owner and the permissions of the old one.
fn keep_access(new: &Temporary, old: &Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let own = new.file.metadata()?;
        let other = |ours: u32, theirs: u32| (ours != theirs).then_some(theirs);
        let (user, group) = (other(own.uid(), old.uid()), other(own.gid(), old.gid()));
        // Only the administrator may give files away; a group may be given by its members.
        if (user.is_some() || group.is_some()) && fchown(&new.file, user, group).is_err() {
            let _ = fchown(&new.file, None, group);
        }
    }
    new.file.set_permissions(old.permissions())
}

/// Makes the entries of a folder permanent, as far as the system can do that.
pub(crate) fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    if let Err(e) = std::fs::File::open(folder).and_then(|folder| folder.sync_all()) {
        tracing::debug!(folder = %folder.display(), error = %e, "the folder was not synced");
    }
    #[cfg(not(unix))]
    let _ = folder;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writing_is_all_or_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.txt");
        write(&path, b"one").unwrap();
        write(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
        let e = write(&dir.path().join("missing/a.txt"), b"x").unwrap_err();
        assert!(e.remedy().starts_with("create the folder"), "{}", e.remedy());
        assert_eq!(write(dir.path(), b"x").unwrap_err().kind(), ErrorKind::Io);
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn parts_that_end_with_an_error_change_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.txt");
        write_parts(&path, ["one", " and ", "two"].map(Ok::<_, Error>)).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"one and two");
        let bad = || Error::new(ErrorKind::Io, Path::new("x"), "no more", "wait");
        let e = write_parts(&path, [Ok(vec![b'x'; 2 * BUFFER]), Err(bad())]).unwrap_err();
        assert_eq!(e.message(), "no more");
        assert_eq!(std::fs::read(&path).unwrap(), b"one and two");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_a_killed_process_left_is_swept_up() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join(".mp-00ff00ff00ff00ff.tmp"), "half").unwrap();
        write(&dir.path().join("a.txt"), b"one").unwrap();
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_cannot_be_written_is_known_beforehand() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("file");
        write(&file, b"").unwrap();
        assert!(writable(dir.path()).is_err());
        assert!(writable(&file.join("below")).unwrap_err().message().ends_with("file is not a folder"));
        assert_eq!(write(&file.join("below"), b"").unwrap_err().remedy(), "name a file in a folder");
        assert!(writable(&file).is_ok());
        assert!(writable(&dir.path().join("new/folder/file")).is_ok());
        assert!(writable(Path::new("relative")).is_ok());
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn folders_are_made_as_needed() {
        let dir = tempfile::tempdir().unwrap();
        make_folder(&dir.path().join("a/b/c")).unwrap();
        make_folder(&dir.path().join("a/b/c")).unwrap();
        make_folder(Path::new("")).unwrap();
        write(&dir.path().join("a/file"), b"").unwrap();
        let e = make_folder(&dir.path().join("a/file/b")).unwrap_err();
        assert!(e.message().starts_with("cannot make the folder"), "{e}");
    }

    #[cfg(unix)]
    mod unix {
        use super::*;
        use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};

        #[test]
        fn links_stay_links_and_devices_stay_devices() {
            let dir = tempfile::tempdir().unwrap();
            let at = |name: &str| dir.path().join(name);
            std::fs::write(at("a.txt"), "old").unwrap();
            symlink(at("a.txt"), at("link")).unwrap();
            symlink("link", at("link to link")).unwrap();
            write(&at("link to link"), b"new").unwrap();
            assert!(at("link").is_symlink() && at("link to link").is_symlink());
            assert_eq!(std::fs::read(at("a.txt")).unwrap(), b"new");
            symlink("/dev/null", at("null")).unwrap();
            assert!(write(&at("null"), b"x").unwrap_err().message().contains("device"));
            assert!(writable(&at("null")).unwrap_err().message().contains("device"));
            // A pipe is reached by a link that has no target of that name.
            let (_reader, writer) = std::io::pipe().unwrap();
            let pipe = PathBuf::from(format!("/dev/fd/{}", std::os::fd::AsRawFd::as_raw_fd(&writer)));
            for refused in [write(&pipe, b"x"), writable(&pipe)] {
                assert!(refused.unwrap_err().message().contains("pipe"));
            }
            // A link to a file that is yet to be written.
            symlink("later.txt", at("early")).unwrap();
            write(&at("early"), b"x").unwrap();
            assert!(at("early").is_symlink() && at("later.txt").is_file());
            symlink("round", at("round")).unwrap();
            assert!(write(&at("round"), b"x").unwrap_err().message().contains("too many links"));
        }

        #[test]
        fn permissions_stay_as_they_are() {
            let dir = tempfile::tempdir().unwrap();
            let path = dir.path().join("a.txt");
            write(&path, b"one").unwrap();
            let fresh = std::fs::metadata(&path).unwrap().mode() & 0o777;
            std::fs::write(dir.path().join("usual"), "").unwrap();
            assert_eq!(fresh, std::fs::metadata(dir.path().join("usual")).unwrap().mode() & 0o777);
            for mode in [0o600, 0o664, 0o755] {
                std::fs::set_permissions(&path, std::fs::Permissions::from_mode(mode)).unwrap();
                write(&path, b"two").unwrap();
                assert_eq!(std::fs::metadata(&path).unwrap().mode() & 0o777, mode);
            }
        }

        /// The administrator may write to any file: then there is nothing to refuse.
        #[test]
        fn write_protected_files_and_folders_are_refused() {
            let dir = tempfile::tempdir().unwrap();
            let (path, folder) = (dir.path().join("a.txt"), dir.path().join("folder"));
            std::fs::write(&path, "old").unwrap();
            std::fs::create_dir(&folder).unwrap();
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o444)).unwrap();
            std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o555)).unwrap();
            if OpenOptions::new().write(true).open(&path).is_ok() {
                return;
            }
            for refused in [write(&path, b"new"), writable(&path)] {
                assert!(refused.unwrap_err().message().contains("write-protected"));
            }
            for refused in [write(&folder.join("x"), b"new"), writable(&folder.join("x"))] {
                assert!(refused.unwrap_err().remedy().contains("writable"));
            }
            assert_eq!(std::fs::read(&path).unwrap(), b"old");
        }
    }
}
