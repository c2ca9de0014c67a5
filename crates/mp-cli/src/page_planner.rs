//! The planner that is put inside a page: a module of `mp-wasm`, and the files of the scene.

use mp_plan::{Error, Scene};
use std::path::PathBuf;

/// The environment variable with the folder of the module. `cargo xtask` sets it.
const VARIABLE: &str = "MP_PLANNERS";

const MODULE: &str = "planner.wasm";

/// The largest module that is read, bytes (64 MiB).
const MAX_MODULE_BYTES: u64 = 64 << 20;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PagePlanner {
    /// The WebAssembly module.
    pub(crate) module: Vec<u8>,
    /// The files of the scene, which the page opens in it.
    pub(crate) files: Vec<(String, Vec<u8>)>,
}

impl PagePlanner {
    /// The planner, and this scene.
    ///
    /// # Errors
    /// When there is no such module, or the files of the scene cannot be read any more.
    pub(crate) fn of(scene: &Scene) -> Result<Self, Error> {
        let beside =
            std::env::current_exe().ok().and_then(|program| Some(program.parent()?.join("planners")));
        let folders: Vec<PathBuf> =
            std::env::var_os(VARIABLE).map(PathBuf::from).into_iter().chain(beside).collect();
        let places: Vec<PathBuf> = folders.iter().map(|folder| folder.join(MODULE)).collect();
        let Some(place) = places.iter().find(|place| place.is_file()) else {
            let sought = places.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ");
            return Err(Error::new(format!("there is no planner for pages: {sought} was sought")).help(format!(
                "in the repository `cargo xtask wasm` builds it, and `cargo xtask render … --with-planner` takes it; \
                 or set {VARIABLE} to the folder that holds {MODULE}"
            )));
        };
        let module = mp_store::read(place, MAX_MODULE_BYTES)?;
        if !module.starts_with(b"\0asm") {
            return Err(Error::new(format!("{} is no WebAssembly module", place.display()))
                .help("build it again: `cargo xtask wasm`"));
        }
        Ok(Self { module, files: scene.input_files()? })
    }
}
