//! The runner: `cargo xtask plan …` builds the program `mp` and starts it, `cargo xtask bench …` the program
//! `mp-bench`; `cargo xtask ci` runs what continuous integration runs.
//!
//! It has no dependencies and does no work itself, so that it compiles in a second.

mod ci;
mod fuzz;
mod golden;
mod memcheck;
mod programs;
mod wasm;

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const HELP: &str = "\
Builds and starts the programs of the workspace:

  cargo xtask plan | many | merge | view | check | info | render | scenes | completions | man …   the program `mp`: see `cargo xtask plan --help`
  cargo xtask bench [SUITE …]   measurements, the program `mp-bench`; alone it lists the suites
  cargo xtask verify-certificate FILE   replays a certificate, with the program `mp-verify-certificate`
  cargo xtask soak --out DIR …  random problems for every planner under an oracle: see `cargo xtask soak --help`
  cargo xtask wasm              builds the planner inside pages, for `render … --with-planner`
  cargo xtask assets [--check]  generates the shipped scenes, or checks that they are up to date
  cargo xtask golden [--required] [--built] [WAY…]   the same bits on other processors: native, no-fma, nehalem, aarch64, wasm32
  cargo xtask fuzz [--seconds N] [TARGET…]   every reader under libFuzzer: see `cargo xtask fuzz --help`
  cargo xtask memcheck [TEST…]  tests of the kernels and of arms under valgrind
  cargo xtask ci [--no-tests]   formatting, lints, tests, documentation, examples and tidiness

Exit code: 0 solved or true, 1 not solved within the budget or false, 2 bad input.";

fn main() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let command = arguments.first().map(|c| c.to_string_lossy().into_owned()).unwrap_or_default();
    match command.as_str() {
        "plan" | "many" | "merge" | "view" | "check" | "info" | "render" | "scenes" | "completions"
        | "man" | "--version" => start("mp-motion-cli", "mp", &arguments),
        "bench" => start("mp-bench", "mp-bench", &arguments[1..]),
        "verify-certificate" => start("mp-verify-certificate", "mp-verify-certificate", &arguments[1..]),
        "soak" => start("mp-soak", "mp-soak", &arguments[1..]),
        "wasm" => wasm::run(),
        "golden" => golden::run(&arguments[1..]),
        "fuzz" => fuzz::run(&arguments[1..]),
        "memcheck" => memcheck::run(&arguments[1..]),
        "assets" => start("mp-bench", "mp-bench", &arguments),
        "ci" => match arguments[1..].iter().map(|a| a.to_string_lossy()).collect::<Vec<_>>().as_slice() {
            [] => ci::run(true),
            [only] if only == "--no-tests" => ci::run(false),
            other => bad(&format!("`ci` takes --no-tests or nothing, not {}", other.join(" "))),
        },
        "" | "help" | "--help" | "-h" => {
            let _ = writeln!(std::io::stdout().lock(), "{HELP}");
            ExitCode::SUCCESS
        }
        other => bad(&format!("there is no command `{other}`\n\n{HELP}")),
    }
}

fn bad(message: &str) -> ExitCode {
    note(&format!("error: {message}"));
    ExitCode::from(2)
}

/// Prints a line on standard error.
fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// The folder of the workspace.
fn root() -> PathBuf {
    // Cargo gives the present folder of the package; the one known at compile time may have moved.
    let package = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let package = package.filter(|p| p.ends_with("xtask") && p.is_dir());
    let package = package.unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")));
    package.parent().map(Path::to_path_buf).unwrap_or(package)
}

/// The cargo that started this program.
fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// A program of the workspace, which is built first, optimised. It runs in the current folder.
fn program(package: &str, program: &str) -> Command {
    let manifest = root().join("Cargo.toml");
    let mut command = cargo();
    command.args(["run", "--release", "--package", package, "--bin", program, "--manifest-path"]);
    command.arg(manifest).arg("--");
    command
}

/// Builds a program of the workspace, optimised, and starts it.
fn start(package: &str, name: &str, arguments: &[OsString]) -> ExitCode {
    let mut command = program(package, name);
    command.args(arguments);
    match wasm::environment(arguments) {
        Ok(variable) => command.envs(variable),
        Err(message) => return bad(&message),
    };
    match command.status() {
        Ok(status) => ExitCode::from(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(130)),
        Err(e) => bad(&format!("cannot run cargo: {e}")),
    }
}
