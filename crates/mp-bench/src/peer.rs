//! Other programs that are measured as well.

use crate::error::{IntoError, Result};
use mp_plan::Error;
use serde::de::DeserializeOwned;
use std::process::Command;

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
