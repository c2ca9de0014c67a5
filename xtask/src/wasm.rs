//! The planner inside pages: builds it for WebAssembly.

use crate::{bad, cargo, note, root};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

const TARGET: &str = "wasm32-unknown-unknown";

/// The environment variable in which `mp` gets the folder of the module.
const VARIABLE: &str = "MP_PLANNERS";

/// Builds the module. Returns its folder.
fn build() -> Result<PathBuf, String> {
    install(TARGET).map_err(|how| format!("the planner inside pages needs Rust's target {TARGET}: {how}"))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let folder = target.join("planners");
    std::fs::create_dir_all(&folder).map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
    let mut command = cargo();
    command.args(["build", "--package", "mp-wasm", "--profile", "wasm", "--target", TARGET]);
    command.arg("--manifest-path").arg(root().join("Cargo.toml")).current_dir(root());
    match command.status() {
        Ok(status) if status.success() => {}
        Ok(_) => return Err("the planner inside pages could not be built".to_owned()),
        Err(e) => return Err(format!("cannot run cargo: {e}")),
    }
    let made = target.join(TARGET).join("wasm").join("mp_wasm.wasm");
    let module = folder.join("planner.wasm");
    std::fs::copy(&made, &module).map_err(|e| format!("cannot write {}: {e}", module.display()))?;
    Ok(folder)
}

/// Installs a target of the compiler by rustup, if it is not there. The error says how to install it.
pub(crate) fn install(target: &str) -> Result<(), String> {
    let listed = Command::new("rustc").args(["--print", "target-libdir", "--target", target]).output();
    if listed.is_ok_and(|out| PathBuf::from(String::from_utf8_lossy(&out.stdout).trim()).is_dir()) {
        return Ok(());
    }
    note(&format!("adding the target {target} by rustup"));
    let added = Command::new("rustup").args(["target", "add", target]).status();
    if added.is_ok_and(|status| status.success()) {
        return Ok(());
    }
    Err(format!("install it, by rustup with\n    rustup target add {target}"))
}

/// `cargo xtask wasm`.
pub(crate) fn run() -> ExitCode {
    match build() {
        Ok(folder) => {
            note(&format!("the planner for pages is in {}", folder.display()));
            ExitCode::SUCCESS
        }
        Err(message) => bad(&message),
    }
}

/// The environment of `mp`: where the module is. If the arguments ask for a planner inside a page, it is
/// built.
pub(crate) fn environment(arguments: &[OsString]) -> Result<Option<(&'static str, PathBuf)>, String> {
    let wanted = arguments.iter().any(|a| a == "--with-planner");
    if !wanted || std::env::var_os(VARIABLE).is_some() {
        return Ok(None);
    }
    Ok(Some((VARIABLE, build()?)))
}
