//! `mp-verify-certificate FILE`: says whether a certificate proves its path free.
//!
//! Exit code: 0 proved, 1 refused, 2 bad input.

use mp_verify_certificate::Proved;
use std::io::Write;
use std::process::ExitCode;

const HELP: &str = "\
Replays a certificate of `mp plan --certificate FILE`: proves again, with code of its own, that the path is free of collision.

usage: mp-verify-certificate FILE [--path PATH]

  FILE         the certificate
  --path PATH  also say whether it is the certificate of this path: text, .json or .csv

exit code: 0 proved, 1 refused, 2 bad input";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (file, path) = match words.as_slice() {
        ["-h" | "--help"] => return say(HELP, 0),
        [file] => (file, None),
        [file, "--path", path] | ["--path", path, file] => (file, Some(path)),
        _ => return say(HELP, 2),
    };
    let read =
        |file: &&str| std::fs::read_to_string(file).map_err(|e| format!("error: cannot read {file}: {e}"));
    let (text, path) = match (read(file), path.map(read).transpose()) {
        (Ok(text), Ok(path)) => (text, path),
        (Err(e), _) | (_, Err(e)) => return say(&e, 2),
    };
    let began = std::time::Instant::now();
    let proved = mp_verify_certificate::verify(&text);
    let rate = |proved: &Proved| proved.edges as f64 / began.elapsed().as_secs_f64();
    let rate = proved.as_ref().map_or(0.0, rate);
    let of_path = path.map_or(Ok(()), |path| mp_verify_certificate::is_of_path(&text, &path));
    match proved.and_then(|proved| of_path.map(|()| proved)) {
        Ok(Proved { scene, configurations, edges, parts, pairs, may_touch, clearance }) => {
            let clearance = clearance
                .map_or("there is nothing to hit".to_owned(), |c| format!("clearance at least {c} m"));
            let touch = match may_touch {
                0 => String::new(),
                n => format!("; {n} pairs of links of the robot may touch, and were not looked at"),
            };
            let told = format!(
                "{file}: proved free in {scene}\n  {configurations} configurations, {edges} edges in {parts} parts, {clearance}\n  \
                 {pairs} pairs of bodies are kept apart{touch}\n  {rate:.0} edges a second"
            );
            say(&told, 0)
        }
        Err(why) => say(&format!("{file}: refused\n  {why}"), 1),
    }
}

/// Prints what was found, on standard error if the input is bad, and gives the exit code.
fn say(line: &str, code: u8) -> ExitCode {
    let _ = match code {
        2 => writeln!(std::io::stderr(), "{line}"),
        _ => writeln!(std::io::stdout(), "{line}"),
    };
    ExitCode::from(code)
}
