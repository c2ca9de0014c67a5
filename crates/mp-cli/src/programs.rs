//! Starts programs that are separate: `bench`, so that planning does not need it built, and `verify-certificate`, which must share no
//! code with this one.

use crate::cli::Passed;
use crate::input::scene;
use crate::output::print;
use mp_plan::Error;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The program with the benchmarks, and its folder in the repository.
pub(crate) const BENCH: [&str; 2] = ["mp-bench", "crates/mp-bench"];
/// The program that replays certificates.
const VERIFY_CERTIFICATE: [&str; 2] = ["mp-verify-certificate", "crates/mp-verify-certificate"];

/// The most bytes of a certificate.
const MAX_CERTIFICATE_BYTES: u64 = 1 << 32;

/// Replays a certificate, and compares it with the scene that `--scene` names: that program does not know scenes.
pub(crate) fn verify_certificate(args: &Passed) -> Result<bool, Error> {
    let (mut passed, mut named, mut file) = (Vec::new(), None, None);
    let mut words = args.arguments.iter();
    while let Some(word) = words.next() {
        let text = word.to_string_lossy();
        let given = match text.strip_prefix("--scene=") {
            Some(scene) => Some(OsString::from(scene)),
            None if text == "--scene" => words.next().cloned(),
            None => {
                passed.push(word.clone());
                match &*text {
                    "--path" | "--mesh" => passed.extend(words.next().cloned()),
                    option if option.starts_with("--") => {}
                    _ => file = file.or(Some(PathBuf::from(word))),
                }
                continue;
            }
        };
        let one = given.filter(|given| named.is_none() && !given.is_empty());
        named =
            Some(one.ok_or_else(|| {
                Error::new("--scene needs one scene").help("--scene SCENE: a file or a name")
            })?);
    }
    let Some(named) = named else { return turn_into(VERIFY_CERTIFICATE, args) };
    let named = PathBuf::from(named);
    let scene = scene(&named, &mp_io::ProblemChanges::default())?;
    let file = file.ok_or_else(|| {
        Error::new("no certificate is named").help("mp verify-certificate FILE --scene SCENE")
    })?;
    passed.push("--scene-compared".into());
    if !run(VERIFY_CERTIFICATE, &Passed { arguments: passed })? {
        return Ok(false);
    }
    let text = String::from_utf8_lossy(&mp_store::read(&file, MAX_CERTIFICATE_BYTES)?).into_owned();
    let differences = scene.certificate_differences(&text)?;
    let name = named.display();
    match differences.as_slice() {
        [] => print(&format!("  bodies, poses, pairs and ends are those of {name}"))?,
        all => {
            let lines: Vec<&str> = all.iter().take(20).map(String::as_str).collect();
            let more = if all.len() > 20 {
                format!("\n  and {} differences more", all.len() - 20)
            } else {
                String::new()
            };
            print(&format!(
                "{}: refused, it is not about {name}\n  {}{more}",
                file.display(),
                lines.join("\n  ")
            ))?;
        }
    }
    Ok(differences.is_empty())
}

/// A program, from the folder of this program or from the search path.
fn found(program: &str) -> PathBuf {
    let name = format!("{program}{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().and_then(|exe| Some(exe.parent()?.join(&name)));
    beside.filter(|file| file.is_file()).unwrap_or_else(|| PathBuf::from(&name))
}

fn cannot_run(program: &Path, folder: &str, e: &std::io::Error) -> Error {
    Error::new(format!("cannot run {}: {e}", program.display()))
        .help(format!("install it: cargo install --path {folder}"))
}

/// Turns this process into a program with the arguments: signals reach it, and its exit code is the one that is seen.
#[cfg(unix)]
pub(crate) fn turn_into([program, folder]: [&str; 2], args: &Passed) -> Result<bool, Error> {
    use std::os::unix::process::CommandExt;
    let program = found(program);
    Err(cannot_run(&program, folder, &Command::new(&program).args(&args.arguments).exec()))
}

/// Runs a program with the arguments: other systems cannot turn one process into another.
#[cfg(not(unix))]
pub(crate) fn turn_into(program: [&str; 2], args: &Passed) -> Result<bool, Error> {
    run(program, args)
}

/// Runs a program with the arguments. True when it succeeds.
fn run([program, folder]: [&str; 2], args: &Passed) -> Result<bool, Error> {
    let program = found(program);
    match Command::new(&program).args(&args.arguments).status() {
        Ok(status) => match status.code() {
            Some(0) => Ok(true),
            Some(1) => Ok(false),
            code => std::process::exit(code.unwrap_or(130)),
        },
        Err(e) => Err(cannot_run(&program, folder, &e)),
    }
}
