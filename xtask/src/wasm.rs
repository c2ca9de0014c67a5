//! The planner inside pages: builds it for WebAssembly.

use crate::{bad, cargo, note, root};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

const TARGET: &str = "wasm32-unknown-unknown";

/// The modules, each for the scenes of one kind of robot, and the features of mp-wasm that it needs.
const MODULES: [(&str, &str); 3] = [("rigid", ""), ("planar", "planar"), ("arms", "arms")];

/// The environment variable in which `mp` gets the folder of the modules.
const VARIABLE: &str = "MP_PLANNERS";

/// Builds the modules. Returns their folder.
pub(crate) fn build() -> Result<PathBuf, String> {
    if !has_target() {
        note(&format!("adding the target {TARGET} by rustup"));
        let added = Command::new("rustup").args(["target", "add", TARGET]).status();
        if !added.is_ok_and(|status| status.success()) {
            return Err(format!(
                "the planner inside pages needs Rust's target {TARGET}: install it, by rustup with\n    \
                 rustup target add {TARGET}"
            ));
        }
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let folder = target.join("planners");
    std::fs::create_dir_all(&folder).map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
    for (name, features) in MODULES {
        let mut command = cargo();
        command.args(["build", "--package", "mp-wasm", "--profile", "wasm", "--target", TARGET]);
        command.args(["--features", features, "--manifest-path"]).arg(root().join("Cargo.toml"));
        command.current_dir(root());
        match command.status() {
            Ok(status) if status.success() => {}
            Ok(_) => return Err("the planner inside pages could not be built".to_owned()),
            Err(e) => return Err(format!("cannot run cargo: {e}")),
        }
        let made = target.join(TARGET).join("wasm").join("mp_wasm.wasm");
        let module = folder.join(format!("{name}.wasm"));
        std::fs::copy(&made, &module).map_err(|e| format!("cannot write {}: {e}", module.display()))?;
    }
    Ok(folder)
}

fn has_target() -> bool {
    let listed = Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]).output();
    listed.is_ok_and(|out| PathBuf::from(String::from_utf8_lossy(&out.stdout).trim()).is_dir())
}

/// `cargo xtask wasm`.
pub(crate) fn run() -> ExitCode {
    match build() {
        Ok(folder) => {
            note(&format!("the planners for pages are in {}", folder.display()));
            ExitCode::SUCCESS
        }
        Err(message) => bad(&message),
    }
}

/// The environment of `mp`: where the modules are, built if the arguments ask for a planner inside a page.
pub(crate) fn environment(arguments: &[OsString]) -> Result<Option<(&'static str, PathBuf)>, String> {
    let wanted = arguments.iter().any(|a| a == "--with-planner");
    if !wanted || std::env::var_os(VARIABLE).is_some() {
        return Ok(None);
    }
    Ok(Some((VARIABLE, build()?)))
}
