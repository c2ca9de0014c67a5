//! Starts programs that are separate: `bench`, so that planning does not need it built, and `verify-certificate`, which must share no
//! code with this one.

use crate::cli::Passed;
use mp_plan::Error;
use std::path::PathBuf;
use std::process::Command;

/// The program with the benchmarks, and its folder in the repository.
pub(crate) const BENCH: [&str; 2] = ["mp-bench", "crates/mp-bench"];
/// The program that replays certificates.
pub(crate) const VERIFY_CERTIFICATE: [&str; 2] = ["mp-verify-certificate", "crates/mp-verify-certificate"];

/// Runs a program with the arguments, from the folder of this program or from the search path. True when it succeeds.
pub(crate) fn run([program, folder]: [&str; 2], args: &Passed) -> Result<bool, Error> {
    let name = format!("{program}{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().and_then(|exe| Some(exe.parent()?.join(&name)));
    let program = beside.filter(|file| file.is_file()).unwrap_or_else(|| PathBuf::from(&name));
    match Command::new(&program).args(&args.arguments).status() {
        Ok(status) => match status.code() {
            Some(0) => Ok(true),
            Some(1) => Ok(false),
            code => std::process::exit(code.unwrap_or(130)),
        },
        Err(e) => Err(Error::new(format!("cannot run {}: {e}", program.display()))
            .help(format!("install it: cargo install --path {folder}"))),
    }
}
