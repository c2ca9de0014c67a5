//! Tokens and lines of a text file, and numbers in them, with the places errors need.

use crate::error::{Error, ErrorKind};

/// A text file being read.
#[derive(Clone, Copy, Debug)]
pub struct Text<'a> {
    /// The name that errors call it.
    pub file: &'a str,
    /// Its content.
    pub text: &'a str,
    /// The page that describes the format: the remedy of errors that have no better one.
    pub guide: &'static str,
}

/// A piece of the text, such as a word or a line, and where it begins, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    /// The piece.
    pub text: &'a str,
    /// Where it begins, in bytes.
    pub at: usize,
}

impl<'a> Text<'a> {
    /// The content of `file`, which `guide`, a page of `docs/formats`, describes.
    ///
    /// # Errors
    /// When it is not UTF-8.
    pub fn new(file: &'a str, bytes: &'a [u8], guide: &'static str) -> Result<Self, Error> {
        Ok(Self { file, text: crate::files::decode(file, bytes)?, guide })
    }

    /// An error that points at `token`, and names the guide of the format.
    pub fn error(&self, token: Token<'_>, message: impl Into<String>) -> Error {
        Error::at(ErrorKind::Format, self.file, self.text, token.at, token.text.len(), message.into())
            .help(format!("the format is described in docs/formats/{}", self.guide))
    }

    /// `file:line:column` of a token.
    pub fn place(&self, token: Token<'_>) -> String {
        let e = self.error(token, "");
        format!("{}:{}:{}", self.file, e.line().unwrap_or(1), e.column().unwrap_or(1))
    }

    /// An error that points at the end of the text, where `expected` is missing.
    pub fn error_at_end(&self, expected: impl Into<String>) -> Error {
        let at = self.text.trim_end().len();
        if at == 0 {
            let message = "the file is empty".to_owned();
            return Error::at(ErrorKind::Format, self.file, self.text, 0, 0, message)
                .expected(expected)
                .help("an export may have failed: write the file again");
        }
        Error::at(ErrorKind::Format, self.file, self.text, at, 0, "the file ends too early".into())
            .expected(expected)
            .help("the file may be cut short: copy or export it again")
    }

    /// A finite number.
    ///
    /// # Errors
    /// When the token is none.
    pub fn number(&self, token: Token<'_>, expected: &str) -> Result<f64, Error> {
        match token.text.parse::<f64>() {
            Ok(v) if v.is_finite() => Ok(v),
            Ok(_) => {
                let shown = clipped(token.text);
                Err(self
                    .error(token, format!("`{shown}` is not a finite number"))
                    .expected(expected)
                    .help("coordinates must be finite: correct the program that wrote the file"))
            }
            Err(_) => {
                let shown = clipped(token.text);
                let e = self.error(token, format!("`{shown}` is not a number")).expected(expected);
                Err(if token.text.contains(',') {
                    e.help("write numbers with a decimal point, separated by blanks, without commas")
                } else {
                    e
                })
            }
        }
    }

    /// A count or an index from 0.
    pub(crate) fn count(&self, token: Token<'_>, expected: &str) -> Result<usize, Error> {
        token.text.parse::<usize>().map_err(|_| {
            let digits = token.text.bytes().all(|b| b.is_ascii_digit());
            let what = if digits { "is too large a count" } else { "is not a count" };
            self.error(token, format!("`{}` {what}", clipped(token.text))).expected(expected)
        })
    }
}

/// Whether a word is how a C library writes infinity or what is no number: `-nan(ind)`, `nan(snan)`, `-1.#IND`, `1.#QNAN`, `inf`.
pub(crate) fn is_not_a_number(word: &str) -> bool {
    let word = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
    ["nan", "ind", "inf", "qnan", "snan", "1.#"].iter().any(|start| word.starts_with(start))
}

/// At most 40 characters of `text`, with control characters replaced.
pub fn clipped(text: &str) -> String {
    clipped_to(text, 40)
}

/// At most `most` characters of `text`, with control characters replaced.
pub fn clipped_to(text: &str, most: usize) -> String {
    let mut out: String =
        text.chars().take(most).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(most).is_some() {
        out.push('…');
    }
    out
}

impl<'a> Text<'a> {
    /// The lines that are not blank, trimmed. Lines end at `\n`, `\r\n` or a lone `\r`.
    pub fn lines(&self) -> Lines<'a> {
        Lines { text: self.text, parts: self.text.split(['\n', '\r']) }
    }
}

/// The lines of a [`Text`].
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    text: &'a str,
    parts: std::str::Split<'a, [char; 2]>,
}

impl<'a> Iterator for Lines<'a> {
    type Item = Token<'a>;

    fn next(&mut self) -> Option<Token<'a>> {
        let trimmed = self.parts.by_ref().map(str::trim).find(|line| !line.is_empty())?;
        Some(Token { text: trimmed, at: trimmed.as_ptr() as usize - self.text.as_ptr() as usize })
    }
}

impl<'a> Token<'a> {
    /// The words of a line.
    pub fn words(self) -> impl Iterator<Item = Token<'a>> + Clone {
        self.text.split_whitespace().map(move |word| Token {
            text: word,
            at: self.at + (word.as_ptr() as usize - self.text.as_ptr() as usize),
        })
    }

    /// What cells of the line are between: commas, else semicolons, else tabs.
    pub fn separator(self) -> char {
        let is_between = |separator: &char| self.cells_between(*separator).nth(1).is_some();
        [',', ';', '\t'].into_iter().find(is_between).unwrap_or(',')
    }

    /// The parts between separators, without blanks and quotes around them. Separators between quotes are part of a cell.
    pub fn cells_between(self, separator: char) -> impl Iterator<Item = Token<'a>> + Clone {
        let mut quoted = false;
        let ends = move |c| {
            quoted ^= c == '"';
            c == separator && !quoted
        };
        self.text.split(ends).map(move |cell| {
            Token { text: cell, at: self.at + (cell.as_ptr() as usize - self.text.as_ptr() as usize) }
                .trimmed()
                .unquoted()
        })
    }

    /// Without the quotes around it, if there are both.
    fn unquoted(self) -> Token<'a> {
        let inner = self.text.strip_prefix('"').and_then(|text| text.strip_suffix('"'));
        inner.map_or(self, |text| Token { text, at: self.at + 1 })
    }

    /// Without blanks around it.
    pub fn trimmed(self) -> Token<'a> {
        let start = self.text.trim_start();
        Token { text: start.trim_end(), at: self.at + (self.text.len() - start.len()) }
    }

    /// The empty token right after it.
    pub fn end(self) -> Token<'a> {
        Token { text: &self.text[self.text.len()..], at: self.at + self.text.len() }
    }
}

/// Reads words across lines, for formats in which line breaks mean little; `#` begins a comment.
#[derive(Clone, Debug)]
pub(crate) struct Lexer<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Lexer<'a> {
    pub(crate) fn new(text: &Text<'a>) -> Self {
        Self { text: text.text, at: 0 }
    }

    /// The next word; line breaks and comments are skipped.
    pub(crate) fn next(&mut self) -> Option<Token<'a>> {
        loop {
            if let Some(token) = self.next_on_line() {
                return Some(token);
            }
            if self.at >= self.text.len() {
                return None;
            }
            self.next_line();
        }
    }

    /// The next word of this line; `None` at its end, where reading stays.
    pub(crate) fn next_on_line(&mut self) -> Option<Token<'a>> {
        let bytes = self.text.as_bytes();
        while self.at < bytes.len() && is_blank(bytes[self.at]) {
            self.at += 1;
        }
        let start = self.at;
        while self.at < bytes.len() && (!ends_word(bytes[self.at]) || is_of_number(bytes, self.at)) {
            self.at += 1;
        }
        (self.at > start).then(|| Token { text: &self.text[start..self.at], at: start })
    }

    /// Goes to the next line; returns the comment that ended this one.
    pub(crate) fn next_line(&mut self) -> Option<&'a str> {
        let bytes = self.text.as_bytes();
        let start = self.at;
        while self.at < bytes.len() && !is_break(bytes[self.at]) {
            self.at += 1;
        }
        let skipped = &self.text[start..self.at];
        if self.at < bytes.len() {
            self.at += if bytes[self.at..].starts_with(b"\r\n") { 2 } else { 1 };
        }
        comment_at(skipped).map(|i| &skipped[i + 1..])
    }

    /// The number of words left on this line.
    pub(crate) fn left_on_line(&self) -> usize {
        let mut lookahead = self.clone();
        std::iter::from_fn(|| lookahead.next_on_line()).count()
    }

    /// Where the next read begins, in bytes.
    pub(crate) fn position(&self) -> usize {
        self.at
    }
}

fn is_blank(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | 0x0b | 0x0c)
}

fn is_break(b: u8) -> bool {
    matches!(b, b'\n' | b'\r')
}

/// Whether the byte at `at` is the `#` of `1.#IND`.
fn is_of_number(bytes: &[u8], at: usize) -> bool {
    bytes[at] == b'#'
        && bytes[..at].ends_with(b"1.")
        && bytes.get(at + 1).is_some_and(u8::is_ascii_alphabetic)
}

/// Where the comment of a line begins, if it has one: the `#` of `1.#IND` begins none.
pub(crate) fn comment_at(line: &str) -> Option<usize> {
    line.match_indices('#').map(|(at, _)| at).find(|at| !is_of_number(line.as_bytes(), *at))
}

fn ends_word(b: u8) -> bool {
    is_blank(b) || is_break(b) || b == b'#'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lines_and_comments() {
        let text = Text { guide: "f.md", file: "f", text: "OFF# x\r\n 1\t2 # two\r\r3#\n" };
        let mut lexer = Lexer::new(&text);
        assert_eq!(lexer.next().unwrap().text, "OFF");
        assert_eq!(lexer.next_on_line(), None);
        assert_eq!(lexer.next_line(), Some(" x"));
        assert_eq!(lexer.left_on_line(), 2);
        assert_eq!(lexer.next(), Some(Token { text: "1", at: 9 }));
        assert_eq!(lexer.next().unwrap().text, "2");
        assert_eq!(lexer.next().unwrap().text, "3");
        assert_eq!(lexer.next(), None);
        assert_eq!(text.lines().map(|l| l.text).collect::<Vec<_>>(), ["OFF# x", "1\t2 # two", "3#"]);
        let text = Text { guide: "f.md", file: "f", text: "# a\n-1.#IND 1.#QNAN#x 2#y\n3 1.# z" };
        let mut lexer = Lexer::new(&text);
        let words: Vec<_> = std::iter::from_fn(|| lexer.next().map(|w| w.text)).collect();
        assert_eq!(words, ["-1.#IND", "1.#QNAN", "3", "1."]);
        assert_eq!(["1.#IND # a", "1. #a", "1.#"].map(comment_at), [Some(7), Some(3), Some(2)]);
    }

    #[test]
    fn places_of_words() {
        let text = Text { guide: "f.md", file: "f", text: "OFF# x\r\n 1\t2 # two\r\r3#\n" };
        let line = text.lines().nth(1).unwrap();
        assert_eq!(line.words().map(|w| w.at).collect::<Vec<_>>(), [9, 11, 13, 15]);
    }

    #[test]
    fn numbers() {
        let text = Text { guide: "f.md", file: "f", text: "1 -.5e3 nan 1e999 1,5 x" };
        let got: Vec<_> = text.lines().next().unwrap().words().map(|w| text.number(w, "x")).collect();
        assert_eq!(got[0].as_ref().unwrap(), &1.0);
        assert_eq!(got[1].as_ref().unwrap(), &-500.0);
        assert!(got[2..].iter().all(Result::is_err));
        assert!(got[4].as_ref().unwrap_err().remedy().unwrap().contains("decimal point"));
        assert_eq!(got[3].as_ref().unwrap_err().column(), Some(13));
    }
}
