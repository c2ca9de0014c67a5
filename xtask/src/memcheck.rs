//! Tests under valgrind: reads of memory that was never written or is not ours, in the vectors of mp-simd, which have
//! `unsafe` code, and in what calls them with large sizes.

use crate::programs::test_programs;
use crate::{bad, note, root};
use std::ffi::OsString;
use std::process::{Command, ExitCode, Stdio};

/// Which tests are built: mp-simd has the vectors, mp-collide the kernels, mp-robot calls them for arms.
const TESTS: [&str; 8] = [
    "--package=mp-simd",
    "--package=mp-collide",
    "--package=mp-robot",
    "--lib",
    "--test",
    "differential",
    "--test",
    "arms",
];

/// The programs of tests that are run: of the vectors, of the library with the kernels, of whole queries, and of arms.
const PROGRAMS: [&str; 4] = ["mp_simd", "mp_collide", "differential", "arms"];

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
    let programs = match test_programs(&TESTS, std::iter::empty(), &PROGRAMS) {
        Ok(programs) => programs,
        Err(message) => return bad(&message),
    };
    let mut failed = Vec::new();
    for program in &programs {
        note(&format!("under valgrind: {}", program.display()));
        let mut command = Command::new("valgrind");
        command.args(["--quiet", "--track-origins=yes", &format!("--error-exitcode={ERROR}")]).arg(program);
        // Valgrind runs one thread at a time. It has no AVX-512, so the kernels of AVX2 and narrower ones are
        // run.
        command.arg("--test-threads=1").args(filters).current_dir(root());
        // Tests with many cases take fewer of them.
        command.env("MP_MEMCHECK", "1");
        if !command.status().is_ok_and(|status| status.success()) {
            failed.push(program.display().to_string());
        }
    }
    if failed.is_empty() {
        note(&format!("ok     {} programs of tests, no error of memory", programs.len()));
        return ExitCode::SUCCESS;
    }
    note(&format!("FAILED {}", failed.join(", ")));
    ExitCode::FAILURE
}
