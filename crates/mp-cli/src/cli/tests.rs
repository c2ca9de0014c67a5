//! The definition is sound, `docs/cli.md` says what it says, and commands in the documentation are understood.

use super::*;
use clap::{Arg, ArgAction, CommandFactory};
use std::fmt::Write;
use std::path::Path;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// What writes `docs/cli.md`.
const AGAIN: &str = "MP_WRITE_DOCS=1 cargo test -p mp-motion-cli --bin mp reference";

#[test]
fn the_definition_is_sound() {
    Cli::command().debug_assert();
}

/// The help of all commands, as Markdown.
fn reference() -> String {
    let mut mp = Cli::command();
    mp.build();
    let about = mp.get_long_about().unwrap_or_default();
    let mut out = format!(
        "# The command line\n\n<!-- From the help of the program, by {AGAIN} -->\n\n{about}\n\n\
         `mp COMMAND --help` says what is on this page.\n\n"
    );
    for command in mp.get_subcommands().filter(|c| c.get_name() != "help") {
        let (name, about) = (command.get_name(), command.get_about().unwrap_or_default());
        writeln!(out, "- [`{name}`](#mp-{name}): {}", sentence(&about.to_string())).unwrap();
    }
    for command in mp.get_subcommands_mut().filter(|c| c.get_name() != "help") {
        let usage = command.render_usage().to_string();
        let usage = usage.trim_start_matches("Usage: ");
        let about = command.get_long_about().or(command.get_about()).unwrap_or_default();
        let (name, about) = (command.get_name(), sentence(&about.to_string()));
        write!(out, "\n## mp {name}\n\n{about}\n\n```text\n{usage}\n```\n").unwrap();
        if let Some(examples) = command.get_after_long_help() {
            let examples = examples.to_string();
            let lines: Vec<&str> = examples.lines().skip(1).map(|line| line.trim_start()).collect();
            write!(out, "\n```sh\n{}\n```\n", with_remarks(&lines)).unwrap();
        }
        let items: String = command.get_arguments().filter(|a| a.get_id() != "help").map(item).collect();
        if !items.is_empty() {
            write!(out, "\n{items}").unwrap();
        }
    }
    out
}

/// With the full stop that the help leaves out.
fn sentence(help: &str) -> String {
    format!("{}.", help.trim_end_matches('.'))
}

/// Examples, with what they are for as remarks of a shell.
fn with_remarks(lines: &[&str]) -> String {
    let width = lines.iter().filter_map(|line| line.find("  ")).max().unwrap_or_default();
    let split = |line: &&str| match line.split_once("  ") {
        Some((command, remark)) => {
            let pad = width.saturating_sub(command.chars().count());
            format!("{command}{:pad$}  # {}", "", remark.trim_start())
        }
        None => (*line).to_owned(),
    };
    lines.iter().map(split).collect::<Vec<_>>().join("\n")
}

/// An argument as an item of a list.
fn item(arg: &Arg) -> String {
    let help = arg.get_long_help().or(arg.get_help()).unwrap_or_default();
    let takes = matches!(arg.get_action(), ArgAction::Set | ArgAction::Append);
    let shown = arg.to_string();
    let name = if arg.is_positional() { shown.replace(['[', ']', '<', '>'], "") } else { shown };
    let mut out = format!("- `{name}`: {}", sentence(&help.to_string()));
    let values = if takes { arg.get_possible_values() } else { Vec::new() };
    let explained = values.iter().any(|v| v.get_help().is_some());
    if !values.is_empty() && !explained {
        let names: Vec<&str> = values.iter().map(PossibleValue::get_name).collect();
        write!(out, " One of `{}`.", names.join("`, `")).unwrap();
    }
    if takes && let [default] = arg.get_default_values() {
        write!(out, " Default: `{}`.", default.display()).unwrap();
    }
    out.push('\n');
    for value in values.iter().filter(|_| explained) {
        let help = value.get_help().unwrap_or_default();
        writeln!(out, "    - `{}`: {}", value.get_name(), sentence(&help.to_string())).unwrap();
    }
    out
}

#[test]
fn the_reference_is_what_the_help_says() {
    if cfg!(not(feature = "roadmaps")) {
        return; // There are fewer planners.
    }
    let file = Path::new(ROOT).join("docs/cli.md");
    let reference = reference();
    if std::env::var_os("MP_WRITE_DOCS").is_some() {
        std::fs::write(&file, &reference).unwrap();
    }
    let written = std::fs::read_to_string(&file).unwrap_or_default();
    let differs = written.lines().zip(reference.lines()).find(|(a, b)| a != b);
    assert!(
        written == reference,
        "docs/cli.md is not what the help says ({differs:?}); write it again: {AGAIN}"
    );
}

/// The words of a command line, with quotes and remarks as a shell has them; the first command of several.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in line.chars() {
        match (c, quote) {
            (c, Some(q)) if c == q => quote = None,
            ('"' | '\'', None) => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            ('#', None) if word.is_none() => break,
            ('<' | '>' | '|' | ';' | '&', None) => break,
            (' ', None) => words.extend(word.take()),
            (c, _) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}

/// Files of the documentation, in the folder and those below.
fn pages(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages(&path, out);
        } else if path.extension().is_some_and(|e| e == "md") {
            out.push(path);
        }
    }
}

/// Why the program would not understand a line of the documentation, if it is a command of the program.
fn misunderstood(line: &str) -> Option<String> {
    let line = line.trim_start().trim_start_matches("$ ");
    let command = line.strip_prefix("mp ").or_else(|| {
        let of_runner = line.strip_prefix("cargo xtask ")?;
        let names = ["check", "info", "plan", "render", "view"];
        names.iter().any(|name| of_runner.starts_with(name)).then_some(of_runner)
    })?;
    // A pattern for commands, or the variable of a loop.
    let is_pattern = command.contains(['$', '…', '[']) && !command.contains("= [");
    if is_pattern || command.contains('<') && command.contains('>') {
        return None;
    }
    // Numbers that a reader is to put in.
    let number = |word: String| if matches!(&*word, "N" | "S" | "ε") { "1".to_owned() } else { word };
    let words = words(command).into_iter().map(number);
    let error = Cli::try_parse_from(std::iter::once("mp".to_owned()).chain(words)).err()?;
    let is_help = !error.use_stderr();
    (!is_help).then(|| error.to_string())
}

#[test]
fn commands_in_the_documentation_are_understood() {
    let mut files = vec![Path::new(ROOT).join("README.md"), Path::new(ROOT).join("python/README.md")];
    pages(&Path::new(ROOT).join("docs"), &mut files);
    let mut count = 0;
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let mut in_block = false;
        for (i, line) in text.lines().enumerate() {
            if line.trim_start().starts_with("```") {
                in_block = !in_block;
            } else if in_block || line.starts_with("    ") {
                count += usize::from(line.trim_start().starts_with("mp "));
                if let Some(error) = misunderstood(line) {
                    panic!("{}:{}: {line}\n{error}", file.display(), i + 1);
                }
            }
        }
    }
    assert!(count > 80, "{count} commands");
}

#[test]
fn lines_are_split_as_by_a_shell() {
    assert_eq!(
        words(r#"plan a --to "0, 1" --x 'b "c"'  # why"#),
        ["plan", "a", "--to", "0, 1", "--x", "b \"c\""]
    );
    assert_eq!(words("plan - < my.env"), ["plan", "-"]);
    assert!(
        misunderstood("mp plan easy --sede 7").is_some() && misunderstood("mp plan easy --seed 7").is_none()
    );
}
