//! `mp-verify-certificate FILE`: says whether a certificate proves its path free.
//!
//! Exit code: 0 proved, 1 refused, 2 bad input.

use std::io::Write;
use std::process::ExitCode;

const HELP: &str = "\
Replays a certificate of `mp plan --certificate FILE`: proves again, with code of its own, that the path is free of collision.

usage: mp-verify-certificate FILE [--path PATH]

  FILE         the certificate
  --path PATH  also say whether it is the certificate of this path: text, .json or .csv

exit code: 0 proved, 1 refused, 2 bad input";

fn main() -> ExitCode {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = match arguments.iter().position(|a| a == "--path") {
        Some(i) if i + 1 < arguments.len() => {
            let path = arguments.remove(i + 1);
            arguments.remove(i);
            Some(path)
        }
        _ => None,
    };
    let [file] = arguments.as_slice() else {
        say(std::io::stderr(), HELP);
        return ExitCode::from(2);
    };
    if ["-h", "--help"].contains(&file.as_str()) {
        say(std::io::stdout(), HELP);
        return ExitCode::SUCCESS;
    }
    let read = |file: &String| std::fs::read_to_string(file).map_err(|e| format!("cannot read {file}: {e}"));
    let (text, path) = match (read(file), path.as_ref().map(read).transpose()) {
        (Ok(text), Ok(path)) => (text, path),
        (Err(e), _) | (_, Err(e)) => {
            say(std::io::stderr(), &format!("error: {e}"));
            return ExitCode::from(2);
        }
    };
    let began = std::time::Instant::now();
    let proved = mp_verify_certificate::verify(&text);
    let took = began.elapsed().as_secs_f64();
    let of_path = path.map_or(Ok(()), |path| mp_verify_certificate::is_of_path(&text, &path));
    match proved.and_then(|proved| of_path.map(|()| proved)) {
        Ok(proved) => {
            let clearance = match proved.clearance {
                Some(clearance) => format!("clearance at least {clearance} m"),
                None => "there is nothing to hit".to_owned(),
            };
            let mut text = format!(
                "{file}: proved free in {}\n  {} configurations, {} edges in {} parts, {clearance}\n  {} pairs of bodies are kept apart",
                proved.scene, proved.configurations, proved.edges, proved.parts, proved.pairs
            );
            if proved.may_touch > 0 {
                text += &format!(
                    "; {} pairs of links of the robot may touch, and were not looked at",
                    proved.may_touch
                );
            }
            say(std::io::stdout(), &format!("{text}\n  {:.0} edges a second", proved.edges as f64 / took));
            ExitCode::SUCCESS
        }
        Err(why) => {
            say(std::io::stdout(), &format!("{file}: refused\n  {why}"));
            ExitCode::from(1)
        }
    }
}

/// Prints a line.
fn say(mut to: impl Write, line: &str) {
    let _ = writeln!(to, "{line}");
}
