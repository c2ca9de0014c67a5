//! What the crate `xacro-rs` 0.2 computes otherwise than the program of ROS does, found in the files before the result is believed.

use roxmltree::{Document, Node, ParsingOptions};
use std::collections::{BTreeMap, BTreeSet};

type Names = BTreeSet<String>;

/// A macro: the names that it has of its own, and what its body says.
#[derive(Default)]
struct Macro {
    own: Names,
    used: Names,
    called: Names,
}

/// What files define.
#[derive(Default)]
pub(super) struct Definitions {
    macros: BTreeMap<String, Macro>,
    /// Properties outside of macros, with the names in their values.
    properties: BTreeMap<String, Names>,
    /// The names of arguments.
    pub(super) arguments: Names,
}

impl Definitions {
    /// Adds what is defined in a file. What is found to mean something else there is the answer, in words.
    pub(super) fn add(&mut self, text: &str) -> Option<String> {
        let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
        // What is no XML is an error of the crate.
        let document = Document::parse_with_options(text, options).ok()?;
        document.descendants().find_map(|node| self.add_node(node))
    }

    fn add_node(&mut self, node: Node<'_, '_>) -> Option<String> {
        let found = texts(node).flat_map(expressions).find_map(otherwise);
        if found.is_some() {
            return found;
        }
        let name = node.attribute("name").unwrap_or_default();
        match directive(node)? {
            "arg" => {
                self.arguments.insert(name.to_owned());
            }
            "property" => {
                let lazy =
                    node.attribute("lazy_eval").is_none_or(|lazy| ["true", "True", "1"].contains(&lazy));
                if !lazy || node.has_attribute("remove") {
                    return Some(format!("`lazy_eval` and `remove` of the property `{name}`"));
                }
                if !node.ancestors().any(|above| directive(above) == Some("macro")) {
                    let names = node.descendants().flat_map(texts).flat_map(names_in);
                    self.properties.entry(name.to_owned()).or_default().extend(names);
                }
            }
            "macro" => {
                let params = node.attribute("params").unwrap_or_default();
                let mut made = Macro::default();
                let mut given = Names::new();
                for param in params.split_whitespace() {
                    let param = param.trim_start_matches('*');
                    given.insert(param.split([':', '=']).next().unwrap_or_default().to_owned());
                }
                if let Some(other) = names_in(params).find(|name| given.contains(name)) {
                    return Some(format!(
                        "`{other}` in a default of a parameter of the macro `{name}`, which has that parameter"
                    ));
                }
                made.own = given;
                for inner in node.descendants().skip(1) {
                    made.used.extend(texts(inner).flat_map(names_in));
                    match directive(inner) {
                        Some("property") => made.own.extend(inner.attribute("name").map(str::to_owned)),
                        Some(called) => made.called.extend([called.to_owned()]),
                        None => {}
                    }
                }
                self.macros.insert(name.to_owned(), made);
            }
            _ => {}
        }
        None
    }

    /// A property that depends on a name which a macro has of its own, where it is used: its value is that of the place where it is
    /// defined for ROS, and that of the place where it is used for the crate.
    pub(super) fn hidden(&self) -> Option<String> {
        for (name, within) in &self.macros {
            let (mut reached, mut open) = (Names::new(), vec![name]);
            while let Some((called, inner)) = open.pop().and_then(|called| self.macros.get_key_value(called))
            {
                if !reached.insert(called.clone()) {
                    continue;
                }
                open.extend(inner.called.iter().filter(|called| self.macros.contains_key(*called)));
                for used in inner.used.iter().filter(|used| !inner.own.contains(*used)) {
                    if let Some(other) = self.depends(used, &within.own) {
                        return Some(format!(
                            "the property `{used}`, which depends on `{other}`, within the macro `{name}`, which has a `{other}` of its own,"
                        ));
                    }
                }
            }
        }
        None
    }

    /// On which of these names the property `used` depends, if it is none of them.
    fn depends(&self, used: &str, own: &Names) -> Option<String> {
        let (mut seen, mut open) = (Names::new(), vec![used]);
        while let Some(name) = open.pop() {
            if own.contains(name) {
                // Where `used` itself is of the macro, it is its own.
                return (name != used).then(|| name.to_owned());
            }
            if seen.insert(name.to_owned()) {
                open.extend(self.properties.get(name).into_iter().flatten().map(String::as_str));
            }
        }
        None
    }
}

/// The name of an element of xacro.
fn directive<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    let space = node.tag_name().namespace()?;
    (space.contains("xacro") || node.lookup_prefix(space) == Some("xacro")).then(|| node.tag_name().name())
}

/// The values of attributes, and the text.
fn texts<'a>(node: Node<'a, '_>) -> impl Iterator<Item = &'a str> {
    node.attributes().map(|a| a.value()).chain(node.text().filter(|_| node.is_text()))
}

/// What stands in `${…}`.
fn expressions(text: &str) -> impl Iterator<Item = &str> {
    text.split("${").skip(1).map(|rest| {
        let mut quote = None;
        let end = rest.find(|c| {
            match (quote, c) {
                (None, '\'' | '"') => quote = Some(c),
                (Some(open), c) if open == c => quote = None,
                _ => {}
            }
            quote.is_none() && c == '}'
        });
        &rest[..end.unwrap_or(rest.len())]
    })
}

/// The words, numbers and signs of an expression, without strings; `**` is one.
fn tokens(expression: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = expression.trim_start();
    while let Some(c) = rest.chars().next() {
        let word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let len = match c {
            '\'' | '"' => rest[1..].find(c).map_or(rest.len(), |end| end + 2),
            c if word(c) => rest.find(|c| !word(c)).unwrap_or(rest.len()),
            _ if rest.starts_with("**") => 2,
            c => c.len_utf8(),
        };
        tokens.push(&rest[..len]);
        rest = rest[len..].trim_start();
    }
    tokens
}

fn names_in(text: &str) -> impl Iterator<Item = String> {
    let words = expressions(text).flat_map(tokens);
    words.filter(|word| word.starts_with(|c: char| c.is_alphabetic() || c == '_')).map(|word| {
        // `y.a.b` is of `y`.
        word.split('.').next().unwrap_or_default().to_owned()
    })
}

/// What an expression has that is computed otherwise.
fn otherwise(expression: &str) -> Option<String> {
    let tokens = tokens(expression);
    let of = |what: &str| Some(format!("{what} in `${{{}}}`", mp_formats::text::clipped(expression)));
    for (i, token) in tokens.iter().enumerate() {
        match *token {
            "%" => return of("`%`"),
            "int" if tokens.get(i + 1) == Some(&"(") => return of("`int`"),
            // What is put in may be below zero.
            "$" if tokens.get(i + 1) == Some(&"(") && tokens.get(operand(&tokens, i + 1)) == Some(&"**") => {
                return of("`**`");
            }
            "-" if (i == 0 || is_operator(tokens[i - 1]))
                && tokens.get(operand(&tokens, i + 1)) == Some(&"**") =>
            {
                return of("a minus before `**`");
            }
            _ => {}
        }
    }
    None
}

fn is_operator(token: &str) -> bool {
    ["if", "else", "and", "or", "not", "in"].contains(&token)
        || (token.chars().all(|c| !c.is_alphanumeric() && c != '_' && c != '.')
            && !matches!(token, ")" | "]" | "}"))
            && !token.starts_with(['\'', '"'])
}

/// Where the operand that begins with a token ends: a name or number, brackets, and brackets behind it.
fn operand(tokens: &[&str], begin: usize) -> usize {
    let (mut depth, mut at) = (0_usize, begin);
    while let Some(token) = tokens.get(at) {
        match *token {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" if depth > 0 => depth -= 1,
            "-" | "+" | "$" if at == begin => {
                return operand(tokens, begin + 1);
            }
            _ if depth == 0 && at > begin => break,
            _ => {}
        }
        at += 1;
    }
    at
}
