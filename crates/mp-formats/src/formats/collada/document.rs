//! The XML document: elements by id, numbers with their places, sources of vertex data.

use crate::error::{Error, ErrorKind};
use crate::text::{Text, Token, clipped, is_not_a_number};
use mp_stop::Interrupt;
use roxmltree::Node;
use std::cell::RefCell;
use std::collections::HashMap;

/// The most XML nodes of a document.
pub(super) const MAX_NODES: u32 = 10_000_000;

/// A parsed file and its elements by id.
pub(super) struct Document<'a> {
    pub(super) text: Text<'a>,
    pub(super) root: Node<'a, 'a>,
    /// The elements of each id: several where a writer gives an id anew in each geometry.
    ids: HashMap<&'a str, Vec<Node<'a, 'a>>>,
    interrupt: RefCell<Interrupt>,
}

/// Rows of numbers: a `<source>` seen through its accessor.
#[derive(Debug)]
pub(super) struct Source {
    values: Vec<f64>,
    offset: usize,
    stride: usize,
    /// The columns of x, y and z.
    xyz: [usize; 3],
    pub(super) count: usize,
    /// The error of the first value that is no number, such as `-nan(ind)`: positions must have none.
    pub(super) no_number: Option<Error>,
}

impl Source {
    /// Whether rows hold points.
    pub(super) fn has_points(&self) -> bool {
        self.xyz.iter().all(|&k| k < self.stride)
    }

    /// Row `i` as a point, when rows hold points.
    pub(super) fn point(&self, i: usize) -> [f64; 3] {
        self.xyz.map(|k| self.values[self.offset + i * self.stride + k])
    }

    /// How many numbers a row has.
    pub(super) fn width(&self) -> usize {
        self.stride
    }

    pub(super) fn row(&self, i: usize) -> &[f64] {
        let start = self.offset + i * self.stride;
        &self.values[start..start + self.stride]
    }
}

impl<'a> Document<'a> {
    pub(super) fn new(
        file: &'a str,
        text: &'a str,
        xml: &'a roxmltree::Document<'a>,
        interrupt: Interrupt,
    ) -> Result<Self, Error> {
        let root = xml.root_element();
        let mut ids: HashMap<_, Vec<_>> = HashMap::new();
        for node in xml.descendants() {
            if let Some(id) = node.attribute("id") {
                ids.entry(id).or_default().push(node);
            }
        }
        let text = Text { file, text, guide: "meshes.md" };
        let document = Self { text, root, ids, interrupt: RefCell::new(interrupt) };
        if root.tag_name().name() != "COLLADA" {
            let message = format!("the document is <{}>", clipped(root.tag_name().name()));
            return Err(document.error(root, message).expected("<COLLADA>"));
        }
        Ok(document)
    }

    /// An error when reading is to end.
    pub(super) fn go_on(&self) -> Result<(), Error> {
        self.interrupt.borrow_mut().go_on().map_err(|_| Error::interrupted(self.text.file))
    }

    /// An error at the start tag of `node`.
    pub(super) fn error(&self, node: Node<'_, '_>, message: impl Into<String>) -> Error {
        let at = node.range().start;
        let name = node.tag_name().name().len();
        self.text.error(Token { text: &self.text.text[at..at + name + 1], at }, message)
    }

    /// The element that the attribute `key` of `node` refers to, as in `url="#id"`. Of several with that id, the one within the innermost element around
    /// `node` that has any: programs number the data of each geometry anew.
    pub(super) fn target(&self, node: Node<'a, 'a>, key: &str) -> Result<Node<'a, 'a>, Error> {
        let tag = node.tag_name().name();
        let Some(url) = node.attribute(key) else {
            return Err(self.error(node, format!("<{tag}> has no `{key}`")));
        };
        let Some(id) = url.strip_prefix('#') else {
            return Err(self
                .error(node, format!("<{tag}> refers to another file, `{}`", clipped(url)))
                .expected(format!("{key}=\"#id\""))
                .with_kind(ErrorKind::Unsupported)
                .help("export everything into one file"));
        };
        let all = self.ids.get(id).ok_or_else(|| {
            self.error(node, format!("<{tag}> refers to `#{}`, which does not exist", clipped(id)))
        })?;
        let within = |around: Node<'a, 'a>| {
            let mut near = all.iter().filter(move |n| around.range().contains(&n.range().start));
            near.next().map(|first| (*first, near.any(|other| other.tag_name() == first.tag_name())))
        };
        match node.ancestors().find_map(within) {
            Some((only, false)) => Ok(only),
            _ => Err(self
                .error(
                    node,
                    format!("<{tag}> refers to `#{}`, and several elements have this id", clipped(id)),
                )
                .expected("an id of one element")
                .help("give each an id of its own, or export the mesh again")),
        }
    }

    /// The words of the text of `node`, with their places.
    pub(super) fn words(&self, node: Node<'a, 'a>) -> impl Iterator<Item = Token<'a>> + use<'a> {
        let whole = self.text.text;
        // From the text of the file, not from the XML tree, so that places are right with all line ends.
        node.children().filter(|c| c.is_text()).flat_map(move |c| {
            let range = c.range();
            Token { text: &whole[range.clone()], at: range.start }.words()
        })
    }

    /// Exactly `N` numbers in the text of `node`.
    pub(super) fn numbers<const N: usize>(&self, node: Node<'a, 'a>) -> Result<[f64; N], Error> {
        let mut out = [0.0; N];
        let mut found = 0;
        let what = format!("{N} numbers in <{}>", node.tag_name().name());
        for word in self.words(node) {
            let value = self.text.number(word, &what)?;
            if let Some(slot) = out.get_mut(found) {
                *slot = value;
            }
            found += 1;
        }
        if found == N {
            return Ok(out);
        }
        Err(self.error(node, format!("<{}> has {found} numbers", node.tag_name().name())).expected(what))
    }

    /// A count in an attribute; `None` when there is no such attribute.
    pub(super) fn count(&self, node: Node<'_, '_>, key: &str) -> Result<Option<usize>, Error> {
        let Some(value) = node.attribute(key) else { return Ok(None) };
        value.trim().parse().map(Some).map_err(|_| {
            let message = format!("{key}=\"{}\" is not a count", clipped(value));
            self.error(node, message)
        })
    }

    /// The rows of the element `<source>`.
    pub(super) fn source(&self, source: Node<'a, 'a>) -> Result<Source, Error> {
        if source.tag_name().name() != "source" {
            let message = format!("<{}> is used as vertex data", clipped(source.tag_name().name()));
            return Err(self.error(source, message).expected("<source>"));
        }
        let accessor = child(source, "technique_common").and_then(|t| child(t, "accessor"));
        let array = match accessor {
            Some(a) if a.has_attribute("source") => Some(self.target(a, "source")?),
            _ => child(source, "float_array"),
        };
        let array = array
            .filter(|a| matches!(a.tag_name().name(), "float_array" | "int_array"))
            .ok_or_else(|| self.error(source, "<source> without numbers").expected("a <float_array>"))?;
        let mut values = Vec::new();
        let mut no_number = None;
        for word in self.words(array) {
            self.go_on()?;
            match self.text.number(word, "a number of the array") {
                Ok(value) => values.push(value),
                // Programs write it for normals of triangles without area.
                Err(e) if is_not_a_number(word.text) => {
                    values.push(f64::NAN);
                    no_number.get_or_insert(e);
                }
                Err(e) => return Err(e),
            }
        }
        if let Some(n) = self.count(array, "count")?.filter(|&n| n != values.len()) {
            let message = format!("the array has {} numbers", values.len());
            return Err(self.error(array, message).expected(format!("{n}, as its count says")));
        }
        let place = accessor.unwrap_or(source);
        let (mut offset, mut stride, mut count, mut xyz) = (0, None, None, [0, 1, 2]);
        if let Some(a) = accessor {
            offset = self.count(a, "offset")?.unwrap_or(0);
            stride = self.count(a, "stride")?;
            count = self.count(a, "count")?;
            let params: Vec<_> = a.children().filter(|c| c.tag_name().name() == "param").collect();
            let named = |axis: &str| {
                params.iter().position(|p| p.attribute("name").is_some_and(|n| n.eq_ignore_ascii_case(axis)))
            };
            if let (Some(x), Some(y), Some(z)) = (named("X"), named("Y"), named("Z")) {
                xyz = [x, y, z];
            }
            // The default of the format is 1; a file with several named columns means them all.
            stride = stride.or((!params.is_empty()).then_some(params.len()));
        }
        let stride = stride.unwrap_or(3);
        if stride == 0 {
            return Err(self.error(place, "a stride of 0"));
        }
        let rows = values.len().saturating_sub(offset) / stride;
        let count = count.unwrap_or(rows);
        if count > rows {
            let message = format!("the array has {rows} rows of {stride} numbers from number {offset} on");
            return Err(self.error(place, message).expected(format!("{count}, as the accessor says")));
        }
        Ok(Source { values, offset, stride, xyz, count, no_number })
    }
}

/// The first child element of that name.
pub(super) fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|c| c.tag_name().name() == name)
}

/// An error of the XML reader, with its place.
pub(super) fn xml_error(file: &str, text: &str, error: &roxmltree::Error) -> Error {
    if matches!(error, roxmltree::Error::NodesLimitReached) {
        let message = format!("the document has more than {MAX_NODES} XML nodes");
        return Error::new(ErrorKind::TooLarge, file, message).help("export the mesh in a compacter format");
    }
    let pos = error.pos();
    let start: usize =
        text.split_inclusive('\n').take(pos.row.saturating_sub(1) as usize).map(str::len).sum();
    let column: usize =
        text[start..].chars().take(pos.col.saturating_sub(1) as usize).map(char::len_utf8).sum();
    let shown = error.to_string();
    let message = shown.split(" at ").next().unwrap_or(&shown).to_owned();
    let e =
        Error::at(ErrorKind::Format, file, text, start + column, 1, message).expected("COLLADA, an XML file");
    if matches!(error, roxmltree::Error::DtdDetected) {
        return e.help("remove the <!DOCTYPE …>: document types and entities are not read");
    }
    e.help("the file is cut short or not COLLADA: export it again")
}
