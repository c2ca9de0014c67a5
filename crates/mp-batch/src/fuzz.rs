//! Entry points for fuzzing, as those of [`mp_io::fuzz`]: lists of problems and their results.
//!
//! None may panic, hang or take memory out of proportion, whatever the bytes.

use crate::list::{Next, ResultsReader, checksum, merged};
use crate::{ItemResult, ProblemList};
use mp_plan::{Error, Scene};

/// Reads any bytes. The error is the one that refuses them.
pub type Target = fn(&[u8]) -> Result<(), Error>;

/// What is read: a name, and the function to call.
pub const TARGETS: [(&str, Target); 2] = [("many-list", many_list), ("many-results", many_results)];

/// Lists of problems, with a small scene for all of them, which is shipped.
///
/// # Errors
/// When the bytes are refused.
pub fn many_list(bytes: &[u8]) -> Result<(), Error> {
    let list = ProblemList::parse("f.jsonl", bytes)?;
    assert!(list.items() > 0 && !list.scenes().is_empty());
    let problems = list.with_scene(&Scene::find("easy")?);
    for item in [0, list.items() / 2, list.items() - 1] {
        if let Ok((scene, request)) = problems.problem(item, Some(1.0)) {
            // Results tell whether the request suits the scene.
            let _ = scene.prepare(&request);
        }
    }
    assert!(problems.problem(list.items(), None).is_err());
    Ok(())
}

/// Results of lists, with the right checksum. A shard that is the whole is merged.
///
/// # Errors
/// When the bytes are refused.
pub fn many_results(bytes: &[u8]) -> Result<(), Error> {
    let bytes = checksum(bytes);
    let read = || ResultsReader::new("f.jsonl".to_owned(), &bytes[..]);
    let mut reader = read()?;
    loop {
        match reader.read()? {
            Next::Item(result) => {
                let again = serde_json::to_vec(&result).unwrap_or_default();
                assert_eq!(serde_json::from_slice::<ItemResult>(&again).ok(), Some(*result));
            }
            Next::Cut => return Ok(()),
            Next::End => break,
        }
    }
    // One of several shards is not the whole.
    let Ok(merged) = merged(vec![read()?]).inspect_err(check_error) else { return Ok(()) };
    let merged = merged.collect::<Result<Vec<_>, _>>()?.concat();
    let mut again = ResultsReader::new("f.jsonl".to_owned(), &merged[..])?;
    while !matches!(again.read()?, Next::End) {}
    Ok(())
}

/// Checks that an error can be shown.
fn check_error(error: &Error) {
    let line = error.to_string();
    assert!(!line.contains(char::is_control) && line.chars().count() < 500, "{line}");
}
