//! Other programs that are measured as well.

use crate::error::{IntoError, Result};
use mp_plan::Error;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::process::Command;

/// The result of another planner in one run.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct FirstPath {
    pub(crate) solved: u8,
    pub(crate) time: f64,
    /// Seconds of processor time, if the program tells them.
    pub(crate) cpu: Option<f64>,
    pub(crate) checks: f64,
    pub(crate) valid_at_20x_finer: i32,
}

/// Runs another planner once on a problem that [`mp_io::export_ompl`] has written. A range of 0 stands for
/// its own longest step.
///
/// # Errors
/// As [`json_lines`].
pub(crate) fn first_path(
    program: &Path,
    problem: &Path,
    planner: &str,
    seed: u64,
    time: f64,
    range: f64,
) -> Result<FirstPath> {
    let mut command = Command::new(program);
    command.arg("--problem").arg(problem).args(["--planner", planner, "--seeds", "1"]);
    command.args(["--seed0", &seed.to_string(), "--time", &time.to_string()]);
    command.args(["--range", &range.to_string()]);
    let told = json_lines(&mut command)?.into_iter().next();
    told.ok_or_else(|| Error::new(format!("{} printed no line of JSON", program.display())))
}

/// The lines of JSON that a program prints.
///
/// # Errors
/// When it cannot be run, fails without having printed any, or prints other ones.
pub(crate) fn json_lines<T: DeserializeOwned>(command: &mut Command) -> Result<Vec<T>> {
    let name = command.get_program().to_string_lossy().into_owned();
    let done = command.output().doing(|| format!("cannot run {name}"))?;
    let text = String::from_utf8_lossy(&done.stdout);
    let lines = text.lines().filter(|line| line.starts_with('{')).map(serde_json::from_str);
    let lines: Vec<T> =
        lines.collect::<std::result::Result<_, _>>().doing(|| format!("cannot read what {name} printed"))?;
    match lines.is_empty() && !done.status.success() {
        true => {
            Err(Error::new(format!("{name} failed: {}", done.status))
                .help(String::from_utf8_lossy(&done.stderr)))
        }
        false => Ok(lines),
    }
}
