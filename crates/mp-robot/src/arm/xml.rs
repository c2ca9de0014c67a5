//! XML text: safe parsing, with errors that name the line.

use super::UrdfError;
use roxmltree::{Document, Node};
use std::borrow::Cow;

/// Elements may be nested no deeper than this.
const MAX_DEPTH: usize = 64;
/// How many missing declarations of name space prefixes are added at most.
const MAX_PREFIXES: usize = 16;

/// The text of a document whose root is `<robot>`.
pub(super) struct Text<'a> {
    /// What the text should be: "a URDF".
    what: &'static str,
    /// The text, with a declaration added in the line of the root for each prefix that has none.
    text: Cow<'a, str>,
}

impl<'a> Text<'a> {
    /// The text with all its prefixes declared.
    pub(super) fn new(what: &'static str, text: &'a str) -> Result<Self, UrdfError> {
        let mut text = Self { what, text: Cow::Borrowed(text) };
        for _ in 0..=MAX_PREFIXES {
            let prefix = match Document::parse(&text.text) {
                Err(roxmltree::Error::UnknownNamespace(prefix, _)) => prefix,
                _ => return Ok(text),
            };
            let Some(at) = end_of_root_name(&text.text) else { return Ok(text) };
            text.text.to_mut().insert_str(at, &format!(" xmlns:{prefix}=\"{prefix}\""));
        }
        Err(text.wrong(None, format!("more than {MAX_PREFIXES} prefixes of names are not declared")))
    }

    /// The document, if it is XML with the root `<robot>` and not nested too deep for recursive parsers.
    pub(super) fn parse(&self) -> Result<Document<'_>, UrdfError> {
        let document = Document::parse(&self.text).map_err(|error| {
            let shown = error.to_string();
            // The parser puts row and column at the end of its message.
            let message = shown.rsplit_once(" at ").map_or(shown.as_str(), |(message, _)| message);
            self.wrong(Some(error.pos().row), message.to_owned())
        })?;
        let root = document.root_element();
        let found = root.tag_name().name();
        if found != "robot" {
            return Err(match other_format(found) {
                Some((format, remedy)) => {
                    UrdfError::Other { what: self.what, line: line(&root), format, remedy }
                }
                None => self.error(&root, format!("its first element is <{found}>, not <robot>")),
            });
        }
        let mut stack = vec![(root, 1)];
        while let Some((node, depth)) = stack.pop() {
            if depth > MAX_DEPTH {
                return Err(self.error(&node, format!("elements nested more than {MAX_DEPTH} deep")));
            }
            stack.extend(node.children().filter(Node::is_element).map(|child| (child, depth + 1)));
        }
        Ok(document)
    }

    /// The name in an attribute, without blanks around it.
    pub(super) fn named(&self, node: &Node<'_, '_>, name: &str) -> Result<String, UrdfError> {
        let missing = || self.error(node, format!("<{}> has no attribute {name}", node.tag_name().name()));
        node.attribute(name).map(|value| value.trim().to_owned()).ok_or_else(missing)
    }

    /// An error in the line of `node`.
    pub(super) fn error(&self, node: &Node<'_, '_>, message: impl std::fmt::Display) -> UrdfError {
        self.wrong(Some(line(node)), message.to_string())
    }

    fn wrong(&self, line: Option<u32>, message: String) -> UrdfError {
        UrdfError::Syntax { what: self.what, line, message }
    }
}

/// The format of documents with this root, and what to do about them, if it is one that is taken for URDF.
fn other_format(root: &str) -> Option<(&'static str, &'static str)> {
    Some(match root {
        "sdf" | "gazebo" | "world" | "model" => (
            "SDF, the format of Gazebo",
            "take the URDF of the robot, which mostly comes with it, or convert the model to one, such as by sdf2urdf of pysdf",
        ),
        "mujoco" | "mujocoinclude" => {
            ("MJCF, the format of MuJoCo", "read the file by `mp_io::RobotProblem`, which makes a URDF of it")
        }
        "launch" => ("a launch file of ROS", "take the robot description that it names"),
        "COLLADA" => ("COLLADA, a mesh", "name it in a <mesh> of a URDF, or as an obstacle"),
        _ => return None,
    })
}

/// The line of `node`, counted from 1.
pub(super) fn line(node: &Node<'_, '_>) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

/// The first names of a list, and how many more there are.
pub(super) fn some(names: &[String]) -> String {
    const SHOWN: usize = 4;
    let shown: Vec<_> = names.iter().take(SHOWN).map(|name| format!("\"{name}\"")).collect();
    match names.len().saturating_sub(SHOWN) {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// Where the name of the first element ends.
fn end_of_root_name(text: &str) -> Option<usize> {
    let mut at = 0;
    loop {
        at += text[at..].find('<')?;
        let rest = &text[at..];
        let skipped = [("<?", "?>"), ("<!--", "-->")].into_iter().find(|(start, _)| rest.starts_with(start));
        match skipped {
            Some((_, end)) => at += rest.find(end)? + end.len(),
            None => {
                let ends = |c: char| c.is_ascii_whitespace() || c == '/' || c == '>';
                return Some(at + rest.find(ends)?);
            }
        }
    }
}
