//! What continuous integration runs.

mod tidy;

use crate::cli::Ci;
use crate::output::note;
use crate::scenes::root;
use miette::{IntoDiagnostic, Result, WrapErr};
use std::process::Command;
use std::time::Instant;

/// Runs every check, to the end even when one fails. True when all passed.
pub(crate) fn run(args: &Ci) -> Result<bool> {
    let clippy = ["clippy", "--quiet", "--workspace", "--all-targets", "--", "-D", "warnings"];
    let mut steps: Vec<(&str, &[&str])> = vec![
        ("formatting", &["fmt", "--all", "--check"]),
        ("lints", &clippy),
        ("documentation", &["doc", "--quiet", "--workspace", "--no-deps"]),
    ];
    if !args.no_tests {
        steps.push(("tests", &["test", "--quiet", "--workspace"]));
    }
    let mut failed = Vec::new();
    for (name, cargo) in steps {
        let began = Instant::now();
        let passed = run_cargo(cargo)?;
        note(&format!("{} {name} ({:.1} s)", mark(passed), began.elapsed().as_secs_f64()));
        if !passed {
            failed.push(name);
        }
    }
    let findings = tidy::check(&root())?;
    for finding in &findings {
        note(&format!("  {finding}"));
    }
    let tidy = !findings.iter().any(|f| f.is_error);
    note(&format!("{} tidiness", mark(tidy)));
    if !tidy {
        failed.push("tidiness");
    }
    if !failed.is_empty() {
        note(&format!("failed: {}", failed.join(", ")));
    }
    Ok(failed.is_empty())
}

fn mark(passed: bool) -> &'static str {
    if passed { "ok    " } else { "FAILED" }
}

fn run_cargo(args: &[&str]) -> Result<bool> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(args)
        .env("RUSTDOCFLAGS", "-D warnings")
        .current_dir(root())
        .status()
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot run cargo {}", args.join(" ")))?;
    Ok(status.success())
}
