//! The checks of continuous integration.

mod circles;
mod links;
mod tidy;

use crate::{cargo, note, root};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

/// Runs all checks, even after one has failed.
pub(crate) fn run(tests: bool) -> ExitCode {
    let all: &[&'static str] =
        if has_mpi() { &["--workspace"] } else { &["--workspace", "--exclude", "mp-mpi"] };
    if !has_mpi() {
        note("       without mp-mpi: there is no MPI here (mpi/README.md)");
    }
    let lints = ["--all-targets", "--", "-D", "warnings"];
    // With the features that lints have, which have checked all that this needs.
    // Libraries: nobody publishes the documentation of a program's `main`, and a crate takes two seconds even if it is empty.
    let documented = ["--no-deps", "--lib", "--features", "mp-cspace/testkit,mp-cspace/serde,mp-tree/serde"];
    let on_all = |command: &[&'static str], options: &[&'static str]| [command, all, options].concat();
    let mut steps: Vec<(&str, Vec<&str>)> = vec![
        ("formatting", vec!["fmt", "--all", "--check"]),
        ("lints", on_all(&["clippy", "--quiet"], &lints)),
        ("documentation", on_all(&["doc", "--quiet"], &documented)),
    ];
    if tests {
        steps.push(("tests", on_all(&["test", "--quiet"], &[])));
    }
    let mut failed = Vec::new();
    let mut done = |name, began: Instant, passed: bool| {
        note(&format!("{} {name} ({:.1} s)", mark(passed), began.elapsed().as_secs_f64()));
        if !passed {
            failed.push(name);
        }
    };
    for (name, cargo) in steps {
        done(name, Instant::now(), run_cargo(&cargo));
    }
    done("examples outside of the workspace", Instant::now(), build_outside());
    done("tidiness", Instant::now(), is_tidy());
    if failed.is_empty() {
        return ExitCode::SUCCESS;
    }
    note(&format!("failed: {}", failed.join(", ")));
    ExitCode::FAILURE
}

fn is_tidy() -> bool {
    match tidy::check(&root()) {
        Ok(findings) => {
            findings.iter().for_each(|finding| note(&format!("  error: {finding}")));
            findings.is_empty()
        }
        Err(e) => {
            note(&format!("  {e}"));
            false
        }
    }
}

/// Whether this machine has what `mp-mpi` is compiled with.
fn has_mpi() -> bool {
    Command::new("mpicc").arg("--version").output().is_ok_and(|out| out.status.success())
}

/// Whether the programs of `examples` that depend on `mp-plan` alone, and on `mp-cspace` and `mp-tree` alone, compile outside of the workspace, with
/// the features that they ask for. Without machine code, which takes twice as long.
fn build_outside() -> bool {
    // Lints have compiled most of what they depend on, in the same profile.
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let target = std::path::absolute(&target).unwrap_or(target);
    ["plan-a-scene", "own-robot"].into_iter().all(|name| {
        let folder = root().join("examples").join(name);
        // The versions of the workspace: nothing is fetched.
        if let Err(e) = std::fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")) {
            note(&format!("cannot copy Cargo.lock to {}: {e}", folder.display()));
            return false;
        }
        let mut check = cargo();
        check.args(["check", "--quiet", "--offline"]);
        succeeds(check.current_dir(&folder).env("CARGO_TARGET_DIR", &target))
    })
}

/// The compiler that makes lints.
fn clippy_driver() -> Option<PathBuf> {
    let out = Command::new("rustc").args(["--print", "sysroot"]).output().ok()?;
    let driver = Path::new(String::from_utf8(out.stdout).ok()?.trim()).join("bin/clippy-driver");
    driver.exists().then_some(driver)
}

fn mark(passed: bool) -> &'static str {
    if passed { "ok    " } else { "FAILED" }
}

fn run_cargo(args: &[&str]) -> bool {
    let mut cargo = cargo();
    cargo.args(args).env("RUSTDOCFLAGS", "-D warnings").current_dir(root());
    if let (Some("doc"), Some(driver)) = (args.first().copied(), clippy_driver()) {
        // What `cargo clippy` sets: documentation takes what lints have compiled. Were it set otherwise some
        // day, it would be compiled again.
        let lints = "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__";
        cargo.env("RUSTC_WORKSPACE_WRAPPER", driver).env("CLIPPY_ARGS", lints);
    }
    succeeds(&mut cargo)
}

fn succeeds(command: &mut Command) -> bool {
    match command.status() {
        Ok(status) => status.success(),
        Err(e) => {
            note(&format!("cannot run {command:?}: {e}"));
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::root;
    use std::process::{Command, Stdio};

    /// Methods of `f64` and `f32` whose bits depend on the machine and that `mp-math` does not have.
    const OTHERS: [&str; 9] = ["sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "exp_m1", "ln_1p", "log"];

    /// The functions of `mp-math`.
    fn functions() -> Vec<String> {
        let text = std::fs::read_to_string(root().join("crates/mp-math/src/lib.rs")).unwrap();
        let in_macro = text.lines().filter_map(|line| line.trim().strip_suffix(");")?.split_once(" = "));
        let plain = text.lines().filter_map(|line| line.strip_prefix("pub fn ")?.split_once('('));
        let names = in_macro.chain(plain).map(|(name, _)| name.to_owned());
        names.filter(|name| !name.contains(' ')).collect()
    }

    /// Clippy finds a call of each method in `clippy.toml`, and the list has all of them, for both types.
    #[test]
    fn functions_whose_bits_depend_on_the_machine_are_forbidden() {
        let mut names = functions();
        assert!(names.len() == 17 && names.contains(&"sin_cos".to_owned()), "{names:?}");
        names.extend(OTHERS.map(str::to_owned));
        let folder = std::env::temp_dir().join(format!("mp-lint-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let uses = ["f64", "f32"].map(|float| {
            names.iter().map(|name| format!("    let _ = {float}::{name};\n")).collect::<String>()
        });
        let source = folder.join("lint.rs");
        std::fs::write(&source, format!("pub fn all() {{\n{}}}\n", uses.concat())).unwrap();
        let mut clippy = Command::new("clippy-driver");
        clippy.args([
            "--edition=2024",
            "--crate-type=lib",
            "--emit=metadata",
            "-Dclippy::disallowed_methods",
        ]);
        clippy.arg("--out-dir").arg(&folder).arg(&source).env("CLIPPY_CONF_DIR", root()).stdin(Stdio::null());
        let out = clippy.output();
        std::fs::remove_dir_all(&folder).unwrap();
        let out = out.expect("clippy is a component of rustup");
        let found = String::from_utf8_lossy(&out.stderr);
        for float in ["f64", "f32"] {
            for name in &names {
                assert!(found.contains(&format!("method `{float}::{name}`")), "{float}::{name}\n{found}");
            }
        }
    }
}
