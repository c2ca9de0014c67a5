//! The error of this crate: what is wrong, where, what was expected and what to do about it.

use std::fmt::{self, Display};

/// The most characters of a report, and of its parts: errors cite files, which may hold anything.
const MAX_REPORT: usize = 499;
const MAX_FILE: usize = 120;
const MAX_MESSAGE: usize = 300;
const MAX_EXPECTED: usize = 140;
const MAX_HELP: usize = 240;

/// What kind of thing went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file or folder cannot be read or written.
    Io,
    /// The text or the bytes do not follow the format.
    Format,
    /// The format allows it, but this crate does not read it.
    Unsupported,
    /// Well formed, but its content makes no sense: an empty mesh, a start outside the bounds.
    Content,
    /// Larger than this crate reads.
    TooLarge,
    /// The reader was interrupted: see [`Until`](crate::files::Until).
    Interrupted,
}

/// A bad file: what is wrong, in which file, line and column, what was expected, and a remedy.
///
/// [`Display`] gives one line, `file:line:column: what is wrong`; [`report`](Self::report) shows the line of the file and
/// the remedy as well. Both have less than 500 characters, whatever is in the file.
#[derive(Clone, Debug)]
pub struct Error(Box<Inner>);

#[derive(Clone, Debug)]
struct Inner {
    kind: ErrorKind,
    file: String,
    position: Option<(usize, usize)>,
    message: String,
    expected: Option<String>,
    help: Option<String>,
    excerpt: Option<Excerpt>,
    cited_at: Option<String>,
}

/// The part of a line around an error, short enough for a screen, so that an error never holds a whole file.
#[derive(Clone, Debug)]
struct Excerpt {
    text: String,
    /// Byte range in `text` that is wrong.
    start: usize,
    len: usize,
    line: usize,
}

impl Error {
    /// An error of this kind about a file: for [`Files`](crate::files::Files) of your own.
    pub fn new(kind: ErrorKind, file: impl Display, message: impl Into<String>) -> Self {
        let message = one_line(&message.into(), MAX_MESSAGE);
        Self(Box::new(Inner {
            kind,
            file: file.to_string(),
            position: None,
            message,
            expected: None,
            help: None,
            excerpt: None,
            cited_at: None,
        }))
    }

    /// The error of a reader that was interrupted.
    pub fn interrupted(file: impl Display) -> Self {
        Self::new(
            ErrorKind::Interrupted,
            file,
            "the time was up, or the work interrupted, while this file was read",
        )
        .help("give more time, or simplify the file")
    }

    /// An error in a line, counted from 1, of `text`, the content of `file`: for texts that other crates read.
    #[must_use]
    pub fn in_line(
        kind: ErrorKind,
        file: impl Display,
        text: &str,
        line: usize,
        message: impl Into<String>,
    ) -> Self {
        let before = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
        let words = text[before..].lines().next().unwrap_or_default();
        let blanks = words.len() - words.trim_start().len();
        Self::at(kind, &file.to_string(), text, before + blanks, words.trim().len(), message.into())
    }

    /// An error at bytes `start..start + len` of `text`, the content of `file`.
    #[must_use]
    pub fn at(kind: ErrorKind, file: &str, text: &str, start: usize, len: usize, message: String) -> Self {
        let start = floor_boundary(text, start.min(text.len()));
        let end = floor_boundary(text, start.saturating_add(len).min(text.len())).max(start);
        let (line, line_start) = line_of(text.as_bytes(), start);
        let column = text[line_start..start].chars().count() + 1;
        let mut e = Self::new(kind, file, message);
        e.0.position = Some((line, column));
        e.0.excerpt = Some(Excerpt::cut(text, line_start, start..end, line));
        e
    }

    /// Adds what was expected there.
    #[must_use]
    pub fn expected(mut self, what: impl Into<String>) -> Self {
        self.0.expected = Some(one_line(&what.into(), MAX_EXPECTED));
        self
    }

    /// Adds what to do about it.
    #[must_use]
    pub fn help(mut self, what: impl Into<String>) -> Self {
        self.0.help = Some(one_line(&what.into(), MAX_HELP));
        self
    }

    /// The same error as one of this kind.
    #[must_use]
    pub fn with_kind(mut self, kind: ErrorKind) -> Self {
        self.0.kind = kind;
        self
    }

    /// An error in the text of an option, instead of in a line of a file.
    #[must_use]
    pub fn in_option(mut self, option: &str) -> Self {
        (self.0.file, self.0.position, self.0.excerpt) = (option.to_owned(), None, None);
        self
    }

    /// Adds the place at which another file names the file in error.
    #[must_use]
    pub fn cited_at(mut self, place: String) -> Self {
        self.0.cited_at = Some(one_line(&place, MAX_FILE));
        self
    }

    /// Adds line and column, counted from 1.
    #[must_use]
    pub fn with_position(mut self, line: usize, column: usize) -> Self {
        self.0.position = Some((line, column));
        self
    }

    /// What kind of thing went wrong.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// The file in error, by the name it was given.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.0.file
    }

    /// The line of the error, counted from 1; `None` when the error is not at one place of a text.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        self.0.position.map(|p| p.0)
    }

    /// The column of the error, in characters, counted from 1.
    #[must_use]
    pub fn column(&self) -> Option<usize> {
        self.0.position.map(|p| p.1)
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> Option<&str> {
        self.0.help.as_deref()
    }

    /// What to do about a file that another file names and that cannot be used.
    #[must_use]
    pub fn remedy_of_named_file(&self) -> &str {
        self.remedy().unwrap_or("check the name of the file")
    }

    /// A few lines for a person: what is wrong and where, the line of the file with the wrong part underlined,
    /// and what to do. They end without a line break. The line of the file is left out where it would make them too long.
    ///
    /// ```text
    /// a.off:2:5: `bad` is not a number; expected x y z
    ///   2 | two bad three
    ///     |     ^^^ expected x y z
    ///   help: write a number
    /// ```
    #[must_use]
    pub fn report(&self) -> String {
        let help = self.0.help.as_ref().map_or_else(String::new, |help| format!("\n  help: {help}"));
        let mut text = self.line_of(MAX_REPORT - help.chars().count());
        if let Some(excerpt) = &self.0.excerpt {
            let (line, mark) = (excerpt.line.to_string(), excerpt.mark());
            let label =
                self.0.expected.as_ref().map_or_else(|| "here".to_owned(), |x| format!("expected {x}"));
            let shown = format!(
                "\n  {line} | {}\n  {:width$} | {mark} {label}",
                excerpt.text,
                "",
                width = line.len()
            );
            if [&text, &shown, &help].map(|part| part.chars().count()).iter().sum::<usize>() <= MAX_REPORT {
                text += &shown;
            }
        }
        text + &help
    }

    /// The error in one line of at most `most` characters.
    fn line_of(&self, most: usize) -> String {
        let mut text = format!("{}:", shortened(&self.0.file, MAX_FILE));
        if let Some((line, column)) = self.0.position {
            text += &format!("{line}:{column}:");
        }
        text += &format!(" {}", self.0.message);
        if let Some(expected) = &self.0.expected {
            text += &format!("; expected {expected}");
        }
        if let Some(place) = &self.0.cited_at {
            text += &format!(" (named at {place})");
        }
        one_line(&text, most)
    }
}

/// At most `most` characters of `text`: of a longer one its beginning and its end.
#[must_use]
pub fn shortened(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text.to_owned();
    }
    let end = most / 3;
    let beginning = text.chars().take(most.saturating_sub(end + 1));
    beginning.chain(['…']).chain(text.chars().skip(count - end)).collect()
}

/// A text that may cite anything as one line of at most `most` characters: [`shortened`], without control characters.
#[must_use]
pub fn one_line(text: &str, most: usize) -> String {
    let text = shortened(text, most);
    if text.contains(char::is_control) { text.replace(char::is_control, "\u{fffd}") } else { text }
}

impl Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.line_of(MAX_REPORT))
    }
}

impl std::error::Error for Error {}

impl From<mp_store::Error> for Error {
    fn from(e: mp_store::Error) -> Self {
        let kind = match e.kind() {
            mp_store::ErrorKind::TooLarge => ErrorKind::TooLarge,
            _ => ErrorKind::Io,
        };
        Self::new(kind, e.path().display(), e.message()).help(e.remedy())
    }
}

impl Excerpt {
    fn cut(text: &str, line_start: usize, wrong: std::ops::Range<usize>, line: usize) -> Self {
        const BEFORE: usize = 60;
        const AFTER: usize = 90;
        let bytes = text.as_bytes();
        let mut from = line_start;
        if wrong.start - line_start > BEFORE {
            from = floor_boundary(text, wrong.start - BEFORE);
        }
        let limit = floor_boundary(text, (wrong.start + AFTER).min(text.len()));
        let to = (wrong.start..limit).find(|&i| matches!(bytes[i], b'\n' | b'\r')).unwrap_or(limit);
        let end = wrong.end.clamp(wrong.start, to);
        let before = printable(&text[from..wrong.start]);
        let inside = printable(&text[wrong.start..end]);
        Self {
            start: before.len(),
            len: inside.len(),
            text: before + &inside + &printable(&text[end..to]),
            line,
        }
    }

    /// Blanks up to the wrong part, then a mark as long as it; tabs stay tabs, so that the mark is right below.
    fn mark(&self) -> String {
        let before = self.text[..self.start].chars().map(|c| if c == '\t' { '\t' } else { ' ' });
        let wrong = self.text[self.start..self.start + self.len].chars().count().max(1);
        before.collect::<String>() + &"^".repeat(wrong)
    }
}

/// The text without control characters, which could disturb a terminal.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\t' { '\u{fffd}' } else { c }).collect()
}

/// Checks that an error can be shown: one line, a place inside the file, a remedy.
///
/// # Panics
/// When it cannot. For tests.
pub fn check_error(error: &Error) {
    let line = error.to_string();
    assert!(!line.contains(char::is_control) && line.chars().count() < 500, "{line}");
    assert!(error.line().is_none_or(|l| l > 0) && error.column().is_none_or(|c| c > 0));
    assert!(error.remedy().is_some(), "{line}");
    let report = error.report();
    assert!(report.lines().count() <= 4 && report.chars().count() < 500, "{report}");
    // Tabs of the file stay in its line and above the mark below.
    assert!(!report.contains(|c: char| c.is_control() && !matches!(c, '\n' | '\t')), "{report:?}");
}

/// Line of byte `at` (from 1), and where that line begins. A line ends at `\n`, `\r\n` or a lone `\r`.
pub(crate) fn line_of(text: &[u8], at: usize) -> (usize, usize) {
    let (mut line, mut start) = (1, 0);
    for (i, &b) in text[..at].iter().enumerate() {
        if b == b'\n' || (b == b'\r' && text.get(i + 1) != Some(&b'\n')) {
            line += 1;
            start = i + 1;
        }
    }
    (line, start)
}

/// The last boundary of a character at or before byte `at`.
fn floor_boundary(text: &str, mut at: usize) -> usize {
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shows_the_line_and_its_number() {
        let text = "one\r\ntwo bad three\nfour";
        let e = Error::at(ErrorKind::Format, "a.off", text, 9, 3, "`bad` is not a number".into())
            .expected("x y z")
            .help("write a number");
        assert_eq!(e.to_string(), "a.off:2:5: `bad` is not a number; expected x y z");
        insta::assert_snapshot!(e.report(), @r"
        a.off:2:5: `bad` is not a number; expected x y z
          2 | two bad three
            |     ^^^ expected x y z
          help: write a number
        ");
    }

    #[test]
    fn control_characters_are_not_shown() {
        let e = Error::at(ErrorKind::Format, "f", "a\u{1b}[31m bad", 7, 3, "\u{1b}[2J".into());
        assert!(!e.report().contains('\u{1b}') && !e.to_string().contains('\u{1b}'));
        assert!(e.report().contains("bad"));
        let named = Error::new(ErrorKind::Io, "a\u{8}b", "no")
            .cited_at("c\u{8}:1".into())
            .expected("d\u{8}")
            .help("e\u{8}");
        for shown in [named.to_string(), named.report()] {
            assert!(!shown.contains('\u{8}'), "{shown:?}");
        }
    }

    #[test]
    fn an_endless_line_is_cut() {
        let text = "x ".repeat(1_000_000);
        let e = Error::at(ErrorKind::Format, "a.off", &text, 1_000_000, 1, "no".into());
        assert_eq!((e.line(), e.column()), (Some(1), Some(1_000_001)));
        assert!(e.0.excerpt.as_ref().unwrap().text.len() < 200);
        assert!(e.report().starts_with("a.off:1:1000001: no\n  1 | "));
    }

    #[test]
    fn reports_are_short_whatever_is_cited() {
        let long = "é\t".repeat(20_000);
        for help in ["", "do this", &long] {
            for expected in ["", "x y z", &long] {
                let e =
                    Error::at(ErrorKind::Format, "a.off", &long, 200, 30_000, format!("`{long}` is wrong"));
                let e = e.expected(expected).help(help).cited_at(long.clone());
                assert!(e.to_string().chars().count() < 500 && e.report().chars().count() < 500, "{e}");
                assert!(e.to_string().starts_with("a.off:1:"), "{e}");
            }
        }
        let far = Error::new(ErrorKind::Io, "folder/".repeat(600) + "scene.env", "no such file");
        assert!(far.to_string().ends_with("scene.env: no such file"), "{far}");
        assert_eq!(shortened("abcdefghij", 10), "abcdefghij");
        assert_eq!(shortened("abcdefghijk", 10), "abcdef…ijk");
    }

    #[test]
    fn a_line_is_shown_without_its_indentation() {
        let e = Error::in_line(ErrorKind::Format, "a.urdf", "<robot>\n  <joint/>\n", 2, "no");
        assert_eq!((e.line(), e.column()), (Some(2), Some(3)));
        assert!(e.report().contains("^^^^^^^^"), "{}", e.report());
        assert!(Error::in_line(ErrorKind::Format, "a", "", 9, "no").report().starts_with("a:1:1: no"));
    }

    #[test]
    fn places_after_the_end_and_inside_characters_are_moved() {
        for at in 0..12 {
            let e = Error::at(ErrorKind::Format, "f", "αβ\n→", at, 5, "m".into());
            assert!(e.report().contains('^'));
        }
    }
}
