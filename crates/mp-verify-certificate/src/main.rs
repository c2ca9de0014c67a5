//! `mp-verify-certificate FILE`: says whether a certificate proves its path free.
//!
//! Exit code: 0 proved, 1 refused, 2 bad input.

use mp_verify_certificate::Proved;
use std::io::Write;
use std::process::ExitCode;

const HELP: &str = "\
Replays a certificate of `mp plan --certificate FILE`: proves again, with code of its own, that the path is free of collision.

It says nothing of your scene: `mp verify-certificate FILE --scene SCENE` also compares bodies, poses, pairs and ends with one.

usage: mp-verify-certificate FILE [--path PATH] [--mesh NAME=MESH]…

  FILE              the certificate
  --path PATH       also say whether it is the certificate of this path: text, .json or .csv
  --mesh NAME=MESH  also say whether the body NAME is this mesh: OFF, OBJ, STL or GEMPA text, to the last bit

exit code: 0 proved, 1 refused, 2 bad input";

/// What a replay cannot know.
const NOT_COMPARED: &str = "\n  not compared with a scene: which bodies there are, where they stand and how they move, which may touch, and where the path \
                            begins and ends. `mp verify-certificate FILE --scene SCENE` does that";

fn main() -> ExitCode {
    let (mut files, mut path, mut meshes, mut compared) = (Vec::new(), None, Vec::new(), false);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match (word.as_str(), words.len()) {
            ("-h" | "--help", _) => return say(HELP, 0),
            ("--path", 1..) if path.is_none() => path = words.next(),
            // By `mp`, which does that.
            ("--scene-compared", _) => compared = true,
            ("--mesh", 1..) => meshes.extend(words.next()),
            (option, _) if option.starts_with("--") => return say(HELP, 2),
            _ => files.push(word),
        }
    }
    let [file] = files.as_slice() else { return say(HELP, 2) };
    let read = |file: &str| std::fs::read(file).map_err(|e| format!("error: cannot read {file}: {e}"));
    let text = |file: &str| {
        let text = String::from_utf8(read(file)?);
        text.map_err(|_| format!("error: cannot read {file}: it is not text in UTF-8"))
    };
    let named = |mesh: &String| {
        let (name, file) = mesh.rsplit_once('=').ok_or(format!("error: --mesh {mesh} is not NAME=MESH"))?;
        Ok((name.to_owned(), read(file)?))
    };
    let meshes: Result<Vec<(String, Vec<u8>)>, String> = meshes.iter().map(named).collect();
    let (text, path, meshes) = match (text(file), path.as_deref().map(text).transpose(), meshes) {
        (Ok(text), Ok(path), Ok(meshes)) => (text, path, meshes),
        (Err(e), ..) | (_, Err(e), _) | (.., Err(e)) => return say(&e, 2),
    };
    match replayed(&text, path.as_deref(), &meshes) {
        Ok(told) => say(&format!("{file}: {told}{}", if compared { "" } else { NOT_COMPARED }), 0),
        Err(why) => say(&format!("{file}: refused\n  {why}"), 1),
    }
}

/// What is said of a certificate that proves its path, and is that of the files.
fn replayed(text: &str, path: Option<&str>, meshes: &[(String, Vec<u8>)]) -> Result<String, String> {
    let began = std::time::Instant::now();
    let Proved { scene, configurations, edges, parts, pairs, may_touch, clearance } =
        mp_verify_certificate::verify(text)?;
    let rate = edges as f64 / began.elapsed().as_secs_f64();
    let clearance =
        clearance.map_or("there is nothing to hit".to_owned(), |c| format!("clearance at least {c} m"));
    let touch = match may_touch {
        0 => String::new(),
        n => format!("; {n} pairs of links of the robot may touch, and were not looked at"),
    };
    let mut told = format!(
        "proved free in {scene}\n  {configurations} configurations, {edges} edges in {parts} parts, {clearance}\n  \
         {pairs} pairs of bodies are kept apart{touch}\n  {rate:.0} edges a second"
    );
    path.map_or(Ok(()), |path| mp_verify_certificate::is_of_path(text, path))?;
    if !meshes.is_empty() {
        let others = mp_verify_certificate::is_of_meshes(text, meshes)?;
        let others = if others.is_empty() { "none".to_owned() } else { others.join(", ") };
        told += &format!("\n  bodies are the meshes of their files; not compared: {others}");
    }
    Ok(told)
}

/// Prints what was found, on standard error if the input is bad, and gives the exit code.
fn say(line: &str, code: u8) -> ExitCode {
    let _ = match code {
        2 => writeln!(std::io::stderr(), "{line}"),
        _ => writeln!(std::io::stdout(), "{line}"),
    };
    ExitCode::from(code)
}
