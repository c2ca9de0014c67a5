//! The checks of continuous integration.

mod circles;
mod tidy;

use crate::{cargo, note, root};
use std::process::ExitCode;
use std::time::Instant;

/// Runs all checks, even after one has failed.
pub(crate) fn run(tests: bool) -> ExitCode {
    let clippy = ["clippy", "--quiet", "--workspace", "--all-targets", "--", "-D", "warnings"];
    let mut steps: Vec<(&str, &[&str])> = vec![
        ("formatting", &["fmt", "--all", "--check"]),
        ("lints", &clippy),
        ("documentation", &["doc", "--quiet", "--workspace", "--no-deps"]),
    ];
    if tests {
        steps.push(("tests", &["test", "--quiet", "--workspace"]));
    }
    let mut failed = Vec::new();
    for (name, cargo) in steps {
        let began = Instant::now();
        let passed = run_cargo(cargo);
        note(&format!("{} {name} ({:.1} s)", mark(passed), began.elapsed().as_secs_f64()));
        if !passed {
            failed.push(name);
        }
    }
    let tidy = match tidy::check(&root()) {
        Ok(findings) => {
            findings.iter().for_each(|finding| note(&format!("  error: {finding}")));
            findings.is_empty()
        }
        Err(e) => {
            note(&format!("  {e}"));
            false
        }
    };
    note(&format!("{} tidiness", mark(tidy)));
    if !tidy {
        failed.push("tidiness");
    }
    if failed.is_empty() {
        return ExitCode::SUCCESS;
    }
    note(&format!("failed: {}", failed.join(", ")));
    ExitCode::FAILURE
}

fn mark(passed: bool) -> &'static str {
    if passed { "ok    " } else { "FAILED" }
}

fn run_cargo(args: &[&str]) -> bool {
    let status = cargo().args(args).env("RUSTDOCFLAGS", "-D warnings").current_dir(root()).status();
    match status {
        Ok(status) => status.success(),
        Err(e) => {
            note(&format!("cannot run cargo {}: {e}", args.join(" ")));
            false
        }
    }
}
