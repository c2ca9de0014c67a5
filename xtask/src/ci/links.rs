//! Links of the documentation: files and headings that they name must exist.

use super::tidy::{Result, list, read};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

/// Dead links in the Markdown files of the workspace at `root`, a line each.
pub(super) fn dead(root: &Path) -> Result<Vec<String>> {
    let mut files = Vec::new();
    markdown(root, &mut files)?;
    files.sort();
    let pages =
        files.into_iter().map(|file| Ok((file.clone(), read(&file)?))).collect::<Result<BTreeMap<_, _>>>()?;
    let mut findings = Vec::new();
    for (file, text) in &pages {
        for (line, link) in links(text) {
            if let Some(lack) = lack(root, &pages, file, link) {
                let shown = file.strip_prefix(root).unwrap_or(file).display();
                findings.push(format!("{shown}, line {line}: the link {link} is dead: {lack}"));
            }
        }
    }
    Ok(findings)
}

/// Markdown files in a folder, but not those that others made.
fn markdown(folder: &Path, out: &mut Vec<PathBuf>) -> Result<()> {
    for entry in list(folder)? {
        let path = entry?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let foreign = name.starts_with('.') || ["node_modules", "out", "target"].contains(&&*name);
        if path.is_dir() && !path.is_symlink() && !foreign {
            markdown(&path, out)?;
        } else if path.extension().is_some_and(|e| e == "md") {
            out.push(path);
        }
    }
    Ok(())
}

/// Lines that are no code, with their numbers from 1.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_code = false;
    text.lines().enumerate().filter_map(move |(i, line)| {
        let fence = line.trim_start().starts_with("```");
        in_code ^= fence;
        (!fence && !in_code).then_some((i + 1, line))
    })
}

/// Targets of links and pictures, with the numbers of their lines. Not those of the web.
fn links<'t>(text: &'t str) -> impl Iterator<Item = (usize, &'t str)> {
    let split = |(i, line): (usize, &'t str)| line.split("](").skip(1).map(move |rest| (i, rest));
    let targets = prose(text).flat_map(split).filter_map(|(i, rest)| Some((i, rest.split_once(')')?.0)));
    targets.filter(|(_, link)| !link.contains(':'))
}

/// What a link of `file` names that is not there.
fn lack(root: &Path, pages: &BTreeMap<PathBuf, String>, file: &Path, link: &str) -> Option<String> {
    let (path, heading) = link.split_once('#').map_or((link, None), |(path, heading)| (path, Some(heading)));
    let target = if path.is_empty() { file.to_owned() } else { plain(&file.parent()?.join(path)) };
    if !target.exists() || !target.starts_with(root) {
        return Some("there is no such file".to_owned());
    }
    let heading = heading?;
    let known = pages.get(&target).is_some_and(|text| headings(text).contains(heading));
    (!known).then(|| "there is no such heading".to_owned())
}

/// A path without `..`.
fn plain(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        if part != Component::ParentDir {
            out.push(part);
        } else if !out.pop() {
            return path.to_owned();
        }
    }
    out
}

/// The names by which links reach the headings of a page: small letters, hyphens for blanks, no punctuation.
fn headings(text: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (_, line) in prose(text) {
        let title = line.trim_start_matches('#');
        if title.len() < line.len() && title.starts_with(' ') {
            let kept = title.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
            let name: String = kept.map(|c| if c == ' ' { '-' } else { c }).collect();
            names.insert(name.to_lowercase());
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_and_headings_are_found() {
        let text = "# A `b`: c, d\n[x](a.md) ![y](p/q.png)\n```\n[no](no.md)\n# no\n```\n[w](https://w.org) [h](#a-b-c-d)\n";
        assert_eq!(links(text).collect::<Vec<_>>(), [(2, "a.md"), (2, "p/q.png"), (7, "#a-b-c-d")]);
        assert_eq!(headings(text).into_iter().collect::<Vec<_>>(), ["a-b-c-d"]);
        let page = Path::new("/r/docs/a.md");
        let pages = BTreeMap::from([(page.to_owned(), text.to_owned())]);
        assert_eq!(lack(Path::new("/r"), &pages, page, "b.md").unwrap(), "there is no such file");
        assert_eq!(plain(Path::new("/r/docs/../x/./a.md")), Path::new("/r/x/a.md"));
    }

    #[test]
    fn dead_headings_are_found() {
        let root = crate::root();
        let page = root.join("README.md");
        let pages = BTreeMap::from([(page.clone(), "# One\n".to_owned())]);
        assert_eq!(lack(&root, &pages, &page, "#one"), None);
        assert_eq!(lack(&root, &pages, &page, "README.md#two").unwrap(), "there is no such heading");
    }
}
