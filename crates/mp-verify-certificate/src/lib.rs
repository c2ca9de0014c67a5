//! Replays certificates: files that prove a path free of collision, written by `mp plan --certificate`.
//!
//! It shares no code with the planner. It has its own reading, kinematics, bounds on motions and trees, and
//! plain arithmetic decides: two convex pieces are as far apart as the gap between their corners along an
//! axis. The format, and what a certificate proves, is described in docs/formats/certificate.md.
//!
//! ```
//! let refused = mp_verify_certificate::verify("{}").unwrap_err();
//! assert!(refused.contains("no checksum"));
//! ```

#![allow(
    clippy::disallowed_methods,
    reason = "bits may differ here; the planner's own functions may not be used"
)]

mod file;
mod mesh;
mod motion;
mod replay;
mod shape;
mod solid;

pub use replay::Proved;

/// Replays a certificate.
///
/// # Errors
/// Why it proves nothing, in a sentence.
pub fn verify(text: &str) -> Result<Proved, String> {
    replay::replay(&file::read(text)?)
}

/// Whether a certificate is of the path in a file: text, JSON or comma-separated values.
///
/// # Errors
/// Where they differ, in a sentence.
pub fn is_of_path(text: &str, path: &str) -> Result<(), String> {
    let file::Certificate { path: rows, columns, curves, .. } = file::read(text)?;
    if curves.is_some() {
        return Err("it proves the curves of a trajectory, not the straight lines of a path".to_owned());
    }
    let mut headers: Vec<String> = Vec::new();
    let given: Vec<Vec<f64>> = match serde_json::from_str::<serde_json::Value>(path) {
        Ok(serde_json::Value::Object(mut file)) => {
            let name = |column: &serde_json::Value| {
                let text = |key| column[key].as_str().unwrap_or_default();
                format!("{}[{}],", column.as_str().unwrap_or(text("name")), text("unit"))
            };
            let list = |key: &&str| Some(file.get(*key)?.as_array()?.iter().map(name).collect());
            headers.extend(["columns", "names", "joint_names", "jointNames", "name"].iter().filter_map(list));
            let path = file.remove("path").ok_or("the file of the path has no member `path`")?;
            serde_json::from_value(path).map_err(|e| format!("the path cannot be read: {e}"))?
        }
        _ => {
            let numbers = |line: &str| -> Option<Vec<f64>> {
                let words = line.split([' ', '\t', ',']).filter(|word| !word.is_empty());
                words.map(|word| word.parse().ok()).collect()
            };
            let mut lines = path.lines().filter(|line| !line.trim().is_empty()).peekable();
            headers.extend(lines.next_if(|line| numbers(line).is_none()).map(|line| format!("{line},")));
            let row = |line| numbers(line).ok_or(format!("a line of the path is not numbers: {line}"));
            let rows = lines.map(row).collect::<Result<Vec<_>, _>>()?;
            // One or two numbers alone are counts, the first that of the lines which follow.
            let counts = |row: &Vec<f64>| row.len() < 3 && row.first() == Some(&((rows.len() - 1) as f64));
            rows[usize::from(!path.contains(',') && rows.first().is_some_and(counts))..].to_vec()
        }
    };
    // What a file calls its columns decides what its numbers mean.
    let plain = |name: &str| name.replace(['"', ' '], "").replace("[]", "");
    let own = columns.iter().map(|name| plain(name) + ",");
    let bare = columns.iter().map(|name| plain(name.rsplit_once(" [").map_or(name, |(name, _)| name)) + ",");
    let known: [String; 2] = [own.collect(), bare.collect()];
    if let Some(header) = headers.iter().find(|header| !known.contains(&plain(header))) {
        return Err(format!("the columns of the path are not those of the certificate: {header}"));
    }
    if given.len() != rows.len() {
        return Err(format!("the path has {} configurations, the certificate {}", given.len(), rows.len()));
    }
    let other = given.iter().zip(&rows).position(|(a, b)| a != b).map(|i| i + 1);
    other.map_or(Ok(()), |i| Err(format!("configuration {i} of the path is another one in the certificate")))
}

/// Whether bodies of a certificate are the meshes of files: pairs of the name of a body and the content of a
/// file (OFF, OBJ, STL, GEMPA text). Returns the names of the bodies that were not compared.
///
/// # Errors
/// Which body is another, in a sentence.
pub fn is_of_meshes(text: &str, meshes: &[(String, Vec<u8>)]) -> Result<Vec<String>, String> {
    let bodies = file::read(text)?.model.bodies;
    for (name, mesh) in meshes {
        let mut named = bodies.iter().filter(|body| body.name == *name).peekable();
        if named.peek().is_none() {
            let names: Vec<&str> = bodies.iter().map(|body| body.name.as_str()).take(20).collect();
            return Err(format!("no body is called {name}; there are {}", names.join(", ")));
        }
        let mut all = named.map(|body| mesh::is_of(body, mesh));
        all.try_for_each(|is| is.map_err(|why| format!("{name} is not the mesh of its file: {why}")))?;
    }
    let names = bodies.into_iter().map(|body| body.name);
    Ok(names.filter(|name| meshes.iter().all(|(compared, _)| compared != name)).collect())
}
