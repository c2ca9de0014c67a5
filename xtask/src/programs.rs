//! Programs of tests, built by cargo and started by something else.

use crate::{cargo, root};
use std::path::{Path, PathBuf};

/// Builds what `cargo test` builds with these arguments and environment variables. Returns the programs with
/// these names.
pub(crate) fn test_programs(
    arguments: &[&str],
    variables: impl Iterator<Item = (&'static str, &'static str)>,
    names: &[&str],
) -> Result<Vec<PathBuf>, String> {
    let mut command = cargo();
    command.args(["test", "--no-run", "--quiet", "--message-format=json"]).args(arguments);
    command.envs(variables).current_dir(root());
    let built = command.output().map_err(|e| format!("cannot run cargo: {e}"))?;
    let mut programs: Vec<PathBuf> = executables(&String::from_utf8_lossy(&built.stdout)).collect();
    programs.retain(|program| names.contains(&name_of(program).as_str()));
    if !built.status.success() || programs.is_empty() {
        return Err(format!("the tests could not be built:\n{}", String::from_utf8_lossy(&built.stderr)));
    }
    Ok(programs)
}

/// The name of a test program, without the hash of cargo.
pub(crate) fn name_of(program: &Path) -> String {
    let stem = program.file_stem().unwrap_or_default().to_string_lossy();
    stem.rsplit_once('-').map_or(&*stem, |(name, _)| name).to_owned()
}

/// The test programs in the messages of cargo.
fn executables(messages: &str) -> impl Iterator<Item = PathBuf> {
    let tests = messages.lines().filter(|line| line.contains("\"test\":true}"));
    let paths = tests.filter_map(|line| line.split_once("\"executable\":\"")?.1.split_once('"'));
    paths.map(|(path, _)| PathBuf::from(path.replace("\\\\", "\\")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn test_programs_are_found_in_the_messages_of_cargo() {
        let messages = r#"{"reason":"compiler-artifact","profile":{"opt_level":"2","test":false},"executable":"/a/mp","fresh":true}
{"reason":"compiler-artifact","profile":{"opt_level":"2","test":true},"executable":"/a/bits-0f","fresh":true}
{"reason":"compiler-artifact","profile":{"opt_level":"2","test":true},"executable":null,"fresh":true}
{"reason":"build-finished","success":true}"#;
        let found: Vec<PathBuf> = executables(messages).collect();
        assert_eq!(found, [PathBuf::from("/a/bits-0f")]);
        assert_eq!(name_of(&found[0]), "bits");
    }
}
