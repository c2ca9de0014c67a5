//! The planner inside pages: builds it for WebAssembly.

use crate::{bad, cargo, note, root};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, ExitCode, Stdio};

const TARGET: &str = "wasm32-unknown-unknown";

/// The modules, each for the scenes of one kind of robot: the features of mp-wasm.
const MODULES: [&str; 8] =
    ["arms", "discs", "driven", "driven-moving", "floating", "moving", "plane", "space"];

/// The environment variable in which `mp` gets the folder of the modules.
const VARIABLE: &str = "MP_PLANNERS";

/// Builds the modules with these names. Returns the folder of all modules.
fn build(names: &[&str]) -> Result<PathBuf, String> {
    install(TARGET).map_err(|how| format!("the planner inside pages needs Rust's target {TARGET}: {how}"))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let folder = target.join("planners");
    std::fs::create_dir_all(&folder).map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
    for name in names {
        let mut command = cargo();
        command.args(["build", "--package", "mp-wasm", "--profile", "wasm", "--target", TARGET]);
        command.args(["--features", name, "--manifest-path"]).arg(root().join("Cargo.toml"));
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

/// `cargo xtask wasm [KIND…]`.
pub(crate) fn run(arguments: &[OsString]) -> ExitCode {
    let named: Vec<&str> = arguments.iter().filter_map(|name| name.to_str()).collect();
    if let Some(unknown) = named.iter().find(|name| !MODULES.contains(name)) {
        return bad(&format!("there is no planner for pages {unknown}: take of {}", MODULES.join(", ")));
    }
    match build(if named.is_empty() { &MODULES } else { &named }) {
        Ok(folder) => {
            note(&format!("the planners for pages are in {}", folder.display()));
            ExitCode::SUCCESS
        }
        Err(message) => bad(&message),
    }
}

/// The environment of `mp`: where the modules are. If the arguments ask for a planner inside a page, its module is built.
pub(crate) fn environment(arguments: &[OsString]) -> Result<Option<(&'static str, PathBuf)>, String> {
    let wanted = arguments.iter().any(|a| a == "--with-planner");
    if !wanted || std::env::var_os(VARIABLE).is_some() {
        return Ok(None);
    }
    let modules = match arguments.get(1).filter(|name| !name.to_string_lossy().starts_with('-')) {
        // `mp` itself will say what is wrong with a scene that has no kind.
        Some(scene) => kind_of(scene).into_iter().collect(),
        None => MODULES.to_vec(),
    };
    Ok(Some((VARIABLE, build(&modules)?)))
}

/// The kind of robot in a scene, as `mp` says it.
fn kind_of(scene: &OsString) -> Option<&'static str> {
    let mut command = crate::program("mp-motion-cli", "mp");
    let out = command.arg("info").arg(scene).arg("--json").stderr(Stdio::inherit()).output().ok()?;
    let out = String::from_utf8(out.stdout).ok()?;
    let (_, kind) = out.split_once("\"robot\":")?;
    let kind = kind.trim_start().strip_prefix('"')?;
    MODULES.into_iter().find(|name| kind.starts_with(&format!("{name}\"")))
}

#[cfg(test)]
mod tests {
    #[test]
    fn each_kind_of_robot_has_its_module() {
        let of = |package: &str| {
            std::fs::read_to_string(crate::root().join("crates").join(package).join("Cargo.toml")).unwrap()
        };
        let (planning, pages) = (of("mp-plan"), of("mp-wasm"));
        let kinds = planning.lines().find_map(|line| line.strip_prefix("kinds = ")).unwrap();
        assert_eq!(kinds, format!("{:?}", super::MODULES));
        let features: Vec<&str> = pages
            .lines()
            .filter_map(|line| line.strip_suffix("\"]")?.split_once(" = [\"mp-plan/"))
            .map(|(name, _)| name)
            .collect();
        assert_eq!(features, super::MODULES);
    }
}
