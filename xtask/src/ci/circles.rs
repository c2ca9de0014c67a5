//! Circles of imports between the folders of a crate.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The folders that each folder imports.
type Imports = BTreeMap<String, BTreeSet<String>>;

/// A circle between the folders of the crate whose `sources`, with their text, are below `src`, if there is
/// one.
pub(super) fn of(src: &Path, sources: &[(PathBuf, String)]) -> Option<Vec<String>> {
    let inside: Vec<(&Path, &str)> = sources
        .iter()
        .filter_map(|(path, text)| Some((path.strip_prefix(src).ok()?, text.as_str())))
        .collect();
    let folder = |path: &Path| (path.components().count() > 1).then(|| first(path));
    let folders: BTreeSet<String> = inside.iter().filter_map(|(path, _)| folder(path)).collect();
    let root = inside.iter().find(|(path, _)| *path == Path::new("lib.rs")).map_or("", |(_, text)| text);
    let exported = exports(root, &folders);
    let mut imports = Imports::new();
    for (path, text) in &inside {
        let Some(from) = folder(path).or_else(|| owner(path, &folders)) else { continue };
        for name in names(text) {
            let to = if folders.contains(&name) { Some(&name) } else { exported.get(&name) };
            if let Some(to) = to.filter(|to| **to != from) {
                imports.entry(from.clone()).or_default().insert(to.clone());
            }
        }
    }
    folders.iter().find_map(|start| circle(start, &imports))
}

fn first(path: &Path) -> String {
    path.components().next().map(|c| c.as_os_str().to_string_lossy().into_owned()).unwrap_or_default()
}

/// The folder to which a file at the root of the crate belongs: `algo.rs` belongs to `algo`.
fn owner(path: &Path, folders: &BTreeSet<String>) -> Option<String> {
    let stem = path.file_stem()?.to_string_lossy().into_owned();
    folders.contains(&stem).then_some(stem)
}

/// The code without comments and unit tests, which may import anything.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn words(text: &str) -> impl Iterator<Item = String> + '_ {
    text.split(|c| !is_word(c)).filter(|word| !word.is_empty()).map(str::to_owned)
}

/// The names after `crate::`, in braces or alone.
fn names(text: &str) -> Vec<String> {
    let code = code(text);
    let mut out = Vec::new();
    for part in code.split("crate::").skip(1) {
        match part.strip_prefix('{') {
            Some(list) => out.extend(words(list.split(';').next().unwrap_or_default())),
            None => out.extend(words(part).next()),
        }
    }
    out
}

/// For each name that the root of the crate exports, the folder it comes from.
fn exports(root: &str, folders: &BTreeSet<String>) -> BTreeMap<String, String> {
    let mut out = BTreeMap::new();
    for part in code(root).split("pub use ").skip(1) {
        let statement = part.split(';').next().unwrap_or_default();
        let mut words = words(statement);
        if let Some(folder) = words.next().filter(|word| folders.contains(word)) {
            out.extend(words.map(|name| (name, folder.clone())));
        }
    }
    out
}

/// The chain of imports from `start` back to itself, if there is one.
fn circle(start: &str, imports: &Imports) -> Option<Vec<String>> {
    let mut pending = vec![vec![start.to_owned()]];
    let mut seen = BTreeSet::new();
    while let Some(way) = pending.pop() {
        let last = way.last()?;
        for next in imports.get(last).into_iter().flatten() {
            let mut longer = way.clone();
            longer.push(next.clone());
            if next == start {
                return Some(longer);
            }
            if seen.insert(next.clone()) {
                pending.push(longer);
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sources(files: &[(&str, &str)]) -> Vec<(PathBuf, String)> {
        files.iter().map(|(path, text)| (Path::new("c/src").join(path), (*text).to_owned())).collect()
    }

    #[test]
    fn circles_are_found_through_the_root_too() {
        let lib = ("lib.rs", "pub use b::{Thing, Other};\npub use a::Start;");
        let line = sources(&[
            lib,
            ("a/x.rs", "use crate::Thing;"),
            ("b/y.rs", "use crate::c::Far;"),
            ("c/z.rs", ""),
        ]);
        assert_eq!(of(Path::new("c/src"), &line), None);
        let back = ("c/z.rs", "use crate::{\n    Start,\n    b::Thing,\n};");
        let ring = sources(&[lib, ("a/x.rs", "use crate::Thing;"), ("b/y.rs", "use crate::c::Far;"), back]);
        assert!(of(Path::new("c/src"), &ring).is_some());
        let harmless = ("c/z.rs", "// use crate::Start;\n#[cfg(test)]\nmod tests { use crate::Start; }");
        let none =
            sources(&[lib, ("a/x.rs", "use crate::Thing;"), ("b/y.rs", "use crate::c::Far;"), harmless]);
        assert_eq!(of(Path::new("c/src"), &none), None);
    }
}
