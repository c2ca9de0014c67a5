//! `bench`: starts the program `mp-bench`, which is separate so that planning does not need it built.

use crate::cli::Bench;
use mp_plan::Error;
use std::path::PathBuf;
use std::process::Command;

/// The program with the benchmarks.
const PROGRAM: &str = "mp-bench";

/// Runs `mp-bench` with the arguments, from the folder of this program or from the search path. True when it succeeds.
pub(crate) fn run(args: &Bench) -> Result<bool, Error> {
    let name = format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().and_then(|exe| Some(exe.parent()?.join(&name)));
    let program = beside.filter(|file| file.is_file()).unwrap_or_else(|| PathBuf::from(&name));
    match Command::new(&program).args(&args.arguments).status() {
        Ok(status) => match status.code() {
            Some(0) => Ok(true),
            Some(1) => Ok(false),
            code => std::process::exit(code.unwrap_or(130)),
        },
        Err(e) => Err(Error::new(format!("cannot run {}: {e}", program.display()))
            .help("install it: cargo install --path crates/mp-bench")),
    }
}
