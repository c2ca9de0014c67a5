//! `info`: describes a file.

use crate::cli;
use crate::output::{print, print_json};
use mp_plan::Error;
use mp_plan::info::Info;

/// Describes the file. Always true, as bad files are errors.
pub(crate) fn run(args: &cli::Info) -> Result<bool, Error> {
    let info = Info::read_changed(&args.file, &args.changes.of_problem())?;
    match args.json {
        true => print_json(&info)?,
        false => print(info.to_string().trim_end())?,
    }
    Ok(true)
}
