//! What a name inside a folder may be: the one place that decides it.

use crate::error::{Error, ErrorKind};
use crate::temporary::{Temporary, sweep};
use crate::write::{filled, sync_folder, target, write_failed};
use std::path::{Path, PathBuf};

/// The most bytes of a name: what file systems take.
const LONGEST: usize = 255;

/// Signs that names may have besides letters and digits of all scripts.
const SIGNS: &str = "-_ .()+,@";

/// Names that lead to devices on Windows, whatever follows after a dot.
const DEVICES: [&str; 6] = ["con", "prn", "aux", "nul", "conin$", "conout$"];

/// Whether `name` may be the name of a file inside a folder: on no system does such a name lead to another
/// folder, a device or a stream, or become another name. It has letters, digits, blanks and `-_.()+,@`, at
/// most 255 bytes; it neither begins with a dot or a blank, nor ends with one, and is not what Windows calls
/// a device.
///
/// ```
/// assert!(mp_store::check_name("my room.env").is_ok());
/// for name in ["../room.env", "C:room.env", "a/b", "a\\b", "aux.txt", "room.env ", ""] {
///     assert!(mp_store::check_name(name).is_err());
/// }
/// ```
///
/// # Errors
/// When it may not.
pub fn check_name(name: &str) -> Result<(), Error> {
    if is_plain(name) {
        return Ok(());
    }
    let shown: String = name.escape_debug().take(80).collect();
    let remedy = "take letters, digits, blanks, `-` and `_`, and no folders";
    let what = format!("`{shown}` is no name for a file here");
    Err(Error::new(ErrorKind::Io, Path::new("name"), what, remedy))
}

/// The file called `name` inside `folder`, and never one outside.
///
/// # Errors
/// When it is [no such name](check_name), and when there is a link of that name, which could lead out of the
/// folder.
pub fn in_folder(folder: &Path, name: &str) -> Result<PathBuf, Error> {
    check_name(name)?;
    let file = folder.join(name);
    match file.is_symlink() {
        true => Err(Error::new(
            ErrorKind::Io,
            &file,
            "this is a link, which could lead elsewhere",
            "take another name",
        )),
        false => Ok(file),
    }
}

fn is_plain(name: &str) -> bool {
    let edge = |c: char| c == '.' || c.is_whitespace();
    let allowed = |c: char| c.is_alphanumeric() || SIGNS.contains(c);
    let stem = name.split('.').next().unwrap_or_default().trim().to_lowercase();
    let numbered = ["com", "lpt"].iter().find_map(|port| stem.strip_prefix(port)).is_some_and(|rest| {
        let mut digits = rest.chars();
        digits.next().is_some_and(|c| "0123456789¹²³".contains(c)) && digits.next().is_none()
    });
    (1..=LONGEST).contains(&name.len())
        && name.chars().all(allowed)
        && !name.starts_with(edge)
        && !name.ends_with(edge)
        && !DEVICES.contains(&&*stem)
        && !numbered
}

/// Writes files into a folder, all or none: each is written to a temporary file first, and they get their
/// [names](in_folder) in the end, in this order. So that a failure, such as a full disk, leaves everything as
/// it was, and a reader of the last file finds the others. Files that exist are replaced only if `overwrite`.
///
/// # Errors
/// As [`in_folder`] and [`write`](fn@crate::write); when two names are one on some systems; when a file
/// exists and must not be replaced; and the first error among the parts.
pub fn write_all<B: AsRef<[u8]>, E: From<Error>>(
    folder: &Path,
    files: impl IntoIterator<Item = (String, impl IntoIterator<Item = Result<B, E>>)>,
    overwrite: bool,
) -> Result<(), E> {
    sweep(folder);
    let mut ready: Vec<Ready> = Vec::new();
    for (name, parts) in files {
        let file = in_folder(folder, &name)?;
        let refused = |what: &str, remedy: &str| Error::new(ErrorKind::Io, &file, what, remedy);
        let same = |other: &Ready| other.name.to_lowercase() == name.to_lowercase();
        if ready.iter().any(same) {
            return Err(refused("two files have this name", "give them other names").into());
        }
        let (_, old) = target(&file)?;
        if old.is_some() && !overwrite {
            return Err(exists(&file).into());
        }
        let new = filled(&file, folder, old.as_ref(), parts)?;
        ready.push(Ready { name, file, new, replaces: old.is_some() });
    }
    let mut done: Vec<(PathBuf, bool, Option<Temporary>)> = Vec::new();
    for Ready { file, new, replaces, .. } in ready {
        // The old one stays under another name until all is done, where the system can do that.
        let old = if replaces { Temporary::of(&file).ok() } else { None };
        let named = if overwrite { new.rename(&file) } else { new.name_anew(&file) };
        if let Err(e) = named {
            for (file, replaced, old) in done {
                let _ = match (old, replaced) {
                    (Some(old), _) => old.rename(&file),
                    (None, true) => Ok(()),
                    (None, false) => std::fs::remove_file(&file),
                };
            }
            let appeared = !overwrite && e.kind() == std::io::ErrorKind::AlreadyExists;
            return Err(if appeared { exists(&file) } else { write_failed(&file, folder, &e) }.into());
        }
        done.push((file, replaces, old));
    }
    sync_folder(folder);
    Ok(())
}

fn exists(file: &Path) -> Error {
    let remedy = "take another name, or say that it may be overwritten";
    Error::new(ErrorKind::Io, file, "the file exists already", remedy)
}

/// A file that is written under a temporary name.
struct Ready {
    name: String,
    file: PathBuf,
    new: Temporary,
    /// Whether there is a file of that name.
    replaces: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    type Parts = Vec<Result<&'static str, Error>>;

    fn files(parts: [(&str, Parts); 3]) -> impl Iterator<Item = (String, Parts)> + use<> {
        parts.map(|(name, parts)| (name.to_owned(), parts)).into_iter()
    }

    fn content(folder: &Path) -> Vec<(String, String)> {
        let of = |entry: std::io::Result<std::fs::DirEntry>| {
            let path = entry.unwrap().path();
            let text =
                if path.is_file() { std::fs::read_to_string(&path).unwrap() } else { "folder".to_owned() };
            (path.file_name().unwrap().to_string_lossy().into_owned(), text)
        };
        let mut all: Vec<_> = std::fs::read_dir(folder).unwrap().map(of).collect();
        all.sort();
        all
    }

    #[test]
    fn names_stay_inside_of_the_folder() {
        let long = "x".repeat(256);
        for name in [
            "",
            ".",
            "..",
            "...",
            "../a",
            "a/..",
            "a/b",
            "/a",
            "a\\b",
            "..\\a",
            "\\\\host\\a",
            "C:",
            "C:a",
            "a:stream",
            "~/a",
            "$HOME/a",
            "%2e%2e%2fa",
            "a\0",
            "a\n",
            "a\u{7f}",
            "a\u{85}",
            "a\u{202e}txt",
            "a\u{200b}",
            "a\u{ff0f}b",
            "a\u{2215}b",
            "a\u{2044}b",
            "\u{ff0e}\u{ff0e}",
            "a\u{29f9}b",
            "CON",
            "con.txt",
            "Aux .txt",
            "nul",
            "prn.a.b",
            "COM1",
            "lpt9.txt",
            "com\u{b9}.txt",
            "conin$",
            "a.",
            "a ",
            "a\u{a0}",
            " a",
            "\u{3000}a",
            ".a",
            "*",
            "a?",
            "a|b",
            "a<b",
            "a>b",
            "\"a\"",
            "a;b",
            "a&b",
            "`a`",
            "a'b",
            long.as_str(),
        ] {
            let refused = in_folder(Path::new("f"), name).unwrap_err();
            assert!(refused.message().contains("is no name for a file here"), "{name:?}");
            assert!(refused.message().chars().count() < 120 && !refused.message().contains(char::is_control));
        }
        for name in [
            "a",
            "a.txt",
            "a b.mp.json",
            "Ünï-2 (3)+,@_.env",
            "com",
            "com10.txt",
            "console.txt",
            "a..b",
            "x.con",
            &long[..255],
        ] {
            assert_eq!(in_folder(Path::new("f"), name).unwrap(), Path::new("f").join(name), "{name}");
        }
    }

    #[test]
    fn all_files_are_written_or_none() {
        let dir = tempfile::tempdir().unwrap();
        let full = || Error::new(ErrorKind::Io, Path::new("x"), "the disk is full", "make room");
        let good = || files([("a", vec![Ok("1"), Ok("2")]), ("b", vec![Ok("3")]), ("c", vec![])]);
        write_all(dir.path(), good(), false).unwrap();
        let before = content(dir.path());
        assert_eq!(before.iter().map(|(name, text)| format!("{name}{text}")).collect::<String>(), "a12b3c");
        // The writer fails at the first file, in the middle of the second, and at the last.
        for bad in [
            files([("a", vec![Err(full())]), ("b", vec![Ok("9")]), ("d", vec![Ok("9")])]),
            files([("a", vec![Ok("9")]), ("b", vec![Ok("9"), Err(full())]), ("d", vec![Ok("9")])]),
            files([("d", vec![Ok("9")]), ("a", vec![Ok("9")]), ("b", vec![Ok("9"), Ok("9"), Err(full())])]),
        ] {
            assert_eq!(write_all(dir.path(), bad, true).unwrap_err().message(), "the disk is full");
            assert_eq!(content(dir.path()), before);
        }
        // What exists is not replaced unasked; names that are one on some systems, and bad names, come to
        // nothing.
        for (bad, overwrite, why) in [
            (
                files([("d", vec![Ok("9")]), ("e", vec![Ok("9")]), ("b", vec![Ok("9")])]),
                false,
                "exists already",
            ),
            (files([("a", vec![Ok("9")]), ("d", vec![Ok("9")]), ("A", vec![Ok("9")])]), true, "two files"),
            (files([("a", vec![Ok("9")]), ("d", vec![Ok("9")]), ("../a", vec![Ok("9")])]), true, "no name"),
        ] {
            let e = write_all(dir.path(), bad, overwrite).unwrap_err();
            assert!(e.message().contains(why), "{e}");
            assert_eq!(content(dir.path()), before);
        }
        std::fs::create_dir(dir.path().join("folder")).unwrap();
        let before = content(dir.path());
        let bad = files([("a", vec![Ok("9")]), ("b", vec![Ok("9")]), ("folder", vec![Ok("9")])]);
        assert!(write_all(dir.path(), bad, true).unwrap_err().message().contains("this is a folder"));
        assert_eq!(content(dir.path()), before);
        write_all(dir.path(), files([("a", vec![Ok("7")]), ("b", vec![Ok("8")]), ("d", vec![])]), true)
            .unwrap();
        assert_eq!(content(dir.path()).len(), before.len() + 1);
    }

    /// Of several that write a new file at the same time, one does, and the others hear of it.
    #[test]
    fn a_new_file_is_written_by_one() {
        let dir = tempfile::tempdir().unwrap();
        for i in 0..50 {
            let begin = std::sync::Barrier::new(4);
            let write = |who: usize| {
                let file = [(format!("{i}.toml"), [Ok::<_, Error>(who.to_string())])];
                begin.wait();
                write_all(dir.path(), file, false)
            };
            let all: Vec<_> = std::thread::scope(|scope| {
                let threads: Vec<_> = (0..4).map(|who| scope.spawn(move || write(who))).collect();
                threads.into_iter().map(|thread| thread.join().unwrap()).collect()
            });
            let written = std::fs::read_to_string(dir.path().join(format!("{i}.toml"))).unwrap();
            for (who, result) in all.into_iter().enumerate() {
                let said = result.map_err(|e| e.message().to_owned());
                let expected = if written == who.to_string() {
                    Ok(())
                } else {
                    Err("the file exists already".to_owned())
                };
                assert_eq!(said, expected, "{i} {who}");
            }
        }
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 50);
    }

    /// A name that is taken by a folder after all was checked: the files that had their names already are as
    /// before.
    #[test]
    fn a_name_that_cannot_be_given_undoes_the_others() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("a"), "old").unwrap();
        let place = dir.path().join("c");
        let late = || {
            std::fs::create_dir_all(place.join("full")).unwrap();
            Ok::<_, Error>("9")
        };
        // Parts are made one after the other: the last one puts a folder in the way of its own file.
        let made = ["a", "b", "c"].map(|name| {
            let part = move || if name == "c" { late() } else { Ok("9") };
            (name.to_owned(), std::iter::once_with(part))
        });
        assert!(write_all(dir.path(), made, true).is_err());
        let after = content(dir.path());
        assert_eq!(after, [("a".to_owned(), "old".to_owned()), ("c".to_owned(), "folder".to_owned())]);
    }

    #[test]
    #[cfg(unix)]
    fn links_are_neither_followed_nor_replaced() {
        use std::os::unix::fs::symlink;
        let (dir, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        std::fs::write(outside.path().join("victim"), "old").unwrap();
        symlink(outside.path().join("victim"), dir.path().join("a")).unwrap();
        symlink(outside.path().join("new"), dir.path().join("b")).unwrap();
        symlink(outside.path(), dir.path().join("c")).unwrap();
        for name in ["a", "b", "c"] {
            let e = write_all(dir.path(), [(name.to_owned(), [Ok::<_, Error>("9")])], true).unwrap_err();
            assert!(e.message().contains("this is a link"), "{e}");
            assert!(dir.path().join(name).is_symlink());
        }
        assert_eq!(content(outside.path()), [("victim".to_owned(), "old".to_owned())]);
    }
}
