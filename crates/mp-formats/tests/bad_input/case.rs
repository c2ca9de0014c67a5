//! A case of a table of bad files, and the check of such a table.

use mp_formats::error::Error;
use std::path::Path;

/// Reads the first file of a case.
pub(crate) type Reader = fn(&Path) -> Result<(), Error>;

pub(crate) struct Case {
    reader: Reader,
    /// Name and content; the first one is read.
    pub(crate) files: Vec<(&'static str, Vec<u8>)>,
    /// `file:line:column: message; expected …`.
    error: &'static str,
    /// The remedy, or "".
    help: &'static str,
}

pub(crate) fn case(
    reader: Reader,
    name: &'static str,
    content: impl AsRef<[u8]>,
    error: &'static str,
    help: &'static str,
) -> Case {
    Case { reader, files: vec![(name, content.as_ref().to_vec())], error, help }
}

fn run(folder: &Path, case: &Case) -> Error {
    for (name, content) in &case.files {
        std::fs::write(folder.join(name), content).unwrap();
    }
    let path = folder.join(case.files[0].0);
    (case.reader)(&path).expect_err("bad input must be refused")
}

pub(crate) fn check(cases: &[Case]) {
    let mut wrong = Vec::new();
    for case in cases {
        let dir = tempfile::tempdir().unwrap();
        let e = run(dir.path(), case);
        let prefix = format!("{}/", dir.path().display());
        let folder = dir.path().display().to_string();
        let clean = |s: &str| s.replace(&prefix, "").replace(&folder, "DIR");
        let (error, help) = (clean(&e.to_string()), clean(e.remedy().unwrap_or_default()));
        if error != case.error || help != case.help {
            wrong.push(format!(
                "{:?}\n    {error:?},\n    {help:?}",
                String::from_utf8_lossy(&case.files[0].1)
            ));
        }
        // Whatever is wrong, showing it must work.
        let picture = e.report();
        assert!(picture.len() < 4000, "{picture}");
    }
    assert!(
        wrong.is_empty(),
        "{} of {} cases differ; they gave\n{}",
        wrong.len(),
        cases.len(),
        wrong.join("\n")
    );
}
