//! Tests under valgrind: reads of memory that was never written or is not ours, in the only crate with `unsafe` code and in
//! what calls it with large sizes.

use crate::{bad, cargo, note, root};
use std::ffi::OsString;
use std::process::{Command, ExitCode, Stdio};

/// The packages whose tests are run: mp-collide has the kernels, mp-robot calls them for arms.
const PACKAGES: [&str; 2] = ["mp-collide", "mp-robot"];

/// The programs of tests that are run beside those of the library with the kernels: whole queries, and the motions of arms.
const TESTS: [&str; 2] = ["differential", "arms"];

/// The exit code of valgrind when it found an error.
const ERROR: &str = "97";

/// `cargo xtask memcheck [FILTER…]`: the tests whose names contain a filter, or all.
pub(crate) fn run(filters: &[OsString]) -> ExitCode {
    let found = Command::new("valgrind").arg("--version").stdout(Stdio::null()).status();
    if !found.is_ok_and(|status| status.success()) {
        return bad(
            "memcheck needs valgrind (https://valgrind.org): on Debian and Ubuntu `apt-get install valgrind`",
        );
    }
    let programs = match programs() {
        Ok(programs) => programs,
        Err(message) => return bad(&message),
    };
    let mut failed = Vec::new();
    for program in &programs {
        note(&format!("under valgrind: {program}"));
        let mut command = Command::new("valgrind");
        command.args(["--quiet", "--track-origins=yes", &format!("--error-exitcode={ERROR}"), program]);
        // Valgrind runs one thread at a time. It has no AVX-512, so the kernels of AVX2 and narrower ones are run.
        command.arg("--test-threads=1").args(filters).current_dir(root());
        if !command.status().is_ok_and(|status| status.success()) {
            failed.push(program.as_str());
        }
    }
    if failed.is_empty() {
        note(&format!("ok     {} programs of tests, no error of memory", programs.len()));
        return ExitCode::SUCCESS;
    }
    note(&format!("FAILED {}", failed.join(", ")));
    ExitCode::FAILURE
}

/// Builds the tests; returns the paths of their programs.
fn programs() -> Result<Vec<String>, String> {
    let mut command = cargo();
    command.args(["test", "--no-run", "--quiet", "--message-format=json"]);
    PACKAGES.iter().for_each(|package| drop(command.args(["--package", package])));
    let built = command.stderr(Stdio::inherit()).current_dir(root()).output();
    let built = built.map_err(|e| format!("cannot run cargo: {e}"))?;
    if !built.status.success() {
        return Err("the tests could not be built".to_owned());
    }
    let text = String::from_utf8_lossy(&built.stdout);
    let programs: Vec<String> = text.lines().filter_map(executable).map(str::to_owned).collect();
    if programs.is_empty() {
        return Err("cargo named no programs of tests".to_owned());
    }
    Ok(programs)
}

/// The program named in a message of cargo, when it has those tests.
fn executable(message: &str) -> Option<&str> {
    let (_, rest) = message.split_once("\"executable\":\"")?;
    let (path, _) = rest.split_once('"')?;
    let name = path.rsplit(['/', '\\']).next()?;
    let is_library = name.starts_with("mp_collide-");
    (is_library || TESTS.iter().any(|test| name.starts_with(test))).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::executable;

    #[test]
    fn programs_are_found_in_messages() {
        let message = |path: &str| {
            format!("{{\"reason\":\"compiler-artifact\",\"executable\":\"{path}\",\"fresh\":true}}")
        };
        let collide = message("/t/debug/deps/mp_collide-12ab");
        assert_eq!(executable(&collide), Some("/t/debug/deps/mp_collide-12ab"));
        assert_eq!(executable(&message("/t/debug/deps/allocations-12ab")), None);
        assert_eq!(executable("{\"reason\":\"compiler-artifact\",\"executable\":null}"), None);
    }
}
