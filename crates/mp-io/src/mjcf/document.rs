//! The files of a model as one tree of elements, and what elements say with their defaults.

use mp_formats::error::{Error, ErrorKind};
use mp_formats::files::{Files, MAX_TEXT_BYTES};
use mp_formats::text::clipped;
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The most files of a model, and the most elements of a file.
const MAX_FILES: usize = 256;
const MAX_NODES: u32 = 4_000_000;
/// Elements may be nested this deep: a chain of bodies is as deep as it is long.
pub(super) const MAX_DEPTH: usize = 200;

pub(super) type Element<'m> = Node<'m, 'm>;

/// A file of a model.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Source {
    pub(super) file: PathBuf,
    pub(super) text: String,
}

impl Source {
    pub(super) fn parsed(&self) -> Result<Document<'_>, Error> {
        let options = ParsingOptions { nodes_limit: MAX_NODES, ..Default::default() };
        Document::parse_with_options(&self.text, options).map_err(|e| {
            let message = e.to_string();
            let message = message.split(" at ").next().unwrap_or(&message).to_owned();
            Error::in_line(ErrorKind::Format, self.file.display(), &self.text, e.pos().row as usize, message)
                .expected("MJCF, an XML file")
                .help("the file is cut short or not MJCF; document types and entities (<!DOCTYPE …>) are not read")
        })
    }
}

/// The file at `file` with the content `text`, and those that it includes. Names are relative to its folder, also in those, or else to that of the file
/// that says them, as MuJoCo has it.
pub(super) fn sources(files: &dyn Files, file: &Path, text: String) -> Result<Vec<Source>, Error> {
    let folder = folder_of(file);
    let mut all = vec![Source { file: file.to_owned(), text }];
    let mut at = 0;
    while at < all.len() {
        let mut found: Vec<Source> = Vec::new();
        let source = &all[at];
        let document = source.parsed()?;
        let model = Model { sources: &all[at..=at], documents: std::slice::from_ref(&document) };
        for node in document.descendants().filter(|node| node.has_tag_name("include")) {
            let name = model.own(node, "file")?;
            let [place, own] = [folder, folder_of(&source.file)].map(|folder| place_of(folder, name));
            let place = if own != place && !files.holds(&place) && files.holds(&own) { own } else { place };
            if all.iter().chain(&found).any(|known| known.file == place) {
                let message = format!("{} is included a second time", clipped(name));
                return Err(model.error(node, message).help("include each file once"));
            }
            if all.len() + found.len() >= MAX_FILES {
                return Err(model
                    .error(node, format!("more than {MAX_FILES} files"))
                    .help("join some of them"));
            }
            let bytes = files.read(&place, MAX_TEXT_BYTES).map_err(|e| {
                let message = format!("the file included here cannot be used: {e}");
                model.error(node, message).help(e.remedy().unwrap_or("correct its name").to_owned())
            })?;
            let text = mp_formats::xml::text(&place.display().to_string(), &bytes)?.into_owned();
            found.push(Source { file: place, text });
        }
        drop(document);
        all.extend(found);
        at += 1;
    }
    Ok(all)
}

fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

/// A file that a model in `folder` names, in the way of any operating system.
fn place_of(folder: &Path, name: &str) -> PathBuf {
    folder.join(name.trim().replace('\\', "/"))
}

/// The files of a model, parsed.
pub(super) struct Model<'m> {
    pub(super) sources: &'m [Source],
    pub(super) documents: &'m [Document<'m>],
}

impl<'m> Model<'m> {
    /// The elements in `node`; those of the file in place of each `include`.
    pub(super) fn children(&self, node: Element<'m>) -> Vec<Element<'m>> {
        let mut found = Vec::new();
        let mut stack: Vec<Element<'m>> = node.children().filter(Node::is_element).collect();
        stack.reverse();
        while let Some(node) = stack.pop() {
            match node.has_tag_name("include") {
                true => stack.extend(
                    self.included(node)
                        .into_iter()
                        .flat_map(|root| root.children().rev())
                        .filter(Node::is_element),
                ),
                false => found.push(node),
            }
        }
        found
    }

    /// The root of the file that `include` names.
    fn included(&self, include: Element<'m>) -> Option<Element<'m>> {
        let name = include.attribute("file")?;
        let at = |source: usize| {
            let place = place_of(folder_of(&self.sources[source].file), name);
            self.sources.iter().position(|source| source.file == place)
        };
        let at = at(0).or_else(|| at(self.source(include)))?;
        Some(self.documents[at].root_element())
    }

    /// What is inside all elements of this name at the top of the model.
    pub(super) fn inside(&self, name: &str) -> Vec<Element<'m>> {
        self.sections(name).into_iter().flat_map(|section| self.children(section)).collect()
    }

    /// The elements of this name at the top of the model.
    pub(super) fn sections(&self, name: &str) -> Vec<Element<'m>> {
        let mut all = self.children(self.documents[0].root_element());
        all.retain(|node| node.has_tag_name(name));
        all
    }

    /// A file that the model names.
    pub(super) fn place_of(&self, name: &str) -> PathBuf {
        place_of(folder_of(&self.sources[0].file), name)
    }

    /// The folder of the file that `node` is in, from that of the model on, if it is another one.
    pub(super) fn subfolder(&self, node: Element<'m>) -> Option<String> {
        let [main, own] = [0, self.source(node)].map(|source| folder_of(&self.sources[source].file));
        let below = own.strip_prefix(main).ok().filter(|below| below.components().next().is_some());
        below.map(|below| below.display().to_string().replace('\\', "/"))
    }

    /// The number of the file that `node` is in.
    pub(super) fn source(&self, node: Element<'m>) -> usize {
        let text = node.document().input_text().as_ptr();
        self.sources.iter().position(|source| source.text.as_ptr() == text).unwrap_or_default()
    }

    pub(super) fn error(&self, node: Element<'m>, message: impl Into<String>) -> Error {
        let Source { file, text } = &self.sources[self.source(node)];
        let length = 1 + node.tag_name().name().len();
        Error::at(
            ErrorKind::Content,
            &file.display().to_string(),
            text,
            node.range().start,
            length,
            message.into(),
        )
    }

    /// The error at `node` of a model that is larger than what is read.
    pub(super) fn too_large(&self, node: Element<'m>, message: impl Into<String>) -> Error {
        self.error(node, message).with_kind(ErrorKind::TooLarge).help("make the model smaller")
    }

    /// An attribute that `node` must have itself.
    pub(super) fn own(&self, node: Element<'m>, key: &str) -> Result<&'m str, Error> {
        node.attribute(key).filter(|value| !value.trim().is_empty()).ok_or_else(|| {
            let message = format!("<{}> has no {key}", node.tag_name().name());
            self.error(node, message).help(format!("add {key}=\"…\""))
        })
    }
}

/// The default classes: what elements say that do not say it themselves.
#[derive(Default)]
pub(super) struct Classes<'m> {
    names: HashMap<&'m str, usize>,
    /// The class around each.
    around: Vec<usize>,
    /// By class, name of the element, name of the attribute.
    values: HashMap<(usize, &'m str, &'m str), &'m str>,
}

impl<'m> Classes<'m> {
    pub(super) fn of(model: &Model<'m>) -> Result<Self, Error> {
        // The class of the whole model is that of its last section, which is inside of that of the section before: what a class takes over is
        // what was said before it. The outermost is the one around itself.
        let sections = model.sections("default");
        let mut classes =
            Self { around: (0..=sections.len()).map(|i| i.max(1) - 1).collect(), ..Self::default() };
        classes.around[0] = sections.len();
        classes.around[sections.len().min(1)] = sections.len().min(1);
        classes.names.insert("main", 0);
        let mut pending: Vec<_> =
            sections.into_iter().enumerate().map(|(i, node)| (node, i + 1, 1)).collect();
        pending.reverse();
        while let Some((node, class, depth)) = pending.pop() {
            if depth > MAX_DEPTH {
                return Err(too_deep(model, node));
            }
            if let Some(name) = node.attribute("class") {
                classes.names.insert(name, if depth == 1 { 0 } else { class });
            }
            for inner in model.children(node) {
                if inner.has_tag_name("default") {
                    let name = model.own(inner, "class")?;
                    let number = *classes.names.entry(name).or_insert(classes.around.len());
                    if number == classes.around.len() {
                        classes.around.push(class);
                    }
                    pending.push((inner, number, depth + 1));
                    continue;
                }
                let of =
                    |a: roxmltree::Attribute<'m, 'm>| ((class, inner.tag_name().name(), a.name()), a.value());
                classes.values.extend(inner.attributes().map(of));
            }
        }
        Ok(classes)
    }

    pub(super) fn number(&self, model: &Model<'m>, node: Element<'m>, name: &str) -> Result<usize, Error> {
        self.names.get(name).copied().ok_or_else(|| {
            let message = format!("there is no default class \"{}\"", clipped(name));
            model
                .error(node, message)
                .help("write it as <default class=\"…\"> in <default>, or correct its name")
        })
    }

    /// What the class and those around it say, from the inside out.
    fn values(&self, class: usize, element: &'m str, key: &'m str) -> impl Iterator<Item = &'m str> {
        let outer = |class: &usize| Some(self.around[*class]).filter(|around| around != class);
        let classes = std::iter::successors(Some(class), outer);
        classes.filter_map(move |class| self.values.get(&(class, element, key)).copied())
    }
}

/// The error of elements nested too deep.
pub(super) fn too_deep<'m>(model: &Model<'m>, node: Element<'m>) -> Error {
    let message = format!("elements nested more than {MAX_DEPTH} deep");
    model.error(node, message).help("make the chain of bodies shorter")
}

/// What an element says, itself or by its class.
pub(super) struct Said<'a, 'm> {
    pub(super) model: &'a Model<'m>,
    pub(super) node: Element<'m>,
    classes: &'a Classes<'m>,
    class: usize,
    /// What classes call such elements.
    kind: &'m str,
}

impl<'a, 'm> Said<'a, 'm> {
    /// `class` is that of the elements around it, for an element that names none.
    pub(super) fn of(
        model: &'a Model<'m>,
        classes: &'a Classes<'m>,
        node: Element<'m>,
        class: usize,
    ) -> Result<Self, Error> {
        let class = match node.attribute("class") {
            Some(name) => classes.number(model, node, name)?,
            None => class,
        };
        let kind = match node.parent_element().is_some_and(|parent| parent.has_tag_name("equality")) {
            true => "equality",
            false => node.tag_name().name(),
        };
        Ok(Self { model, node, classes, class, kind })
    }

    /// What the element says, and then the classes, from the inside out.
    fn texts(&self, key: &'m str) -> impl Iterator<Item = &'m str> {
        self.node.attribute(key).into_iter().chain(self.classes.values(self.class, self.kind, key))
    }

    pub(super) fn text(&self, key: &'m str) -> Option<&'m str> {
        self.texts(key).next()
    }

    /// The numbers of an attribute.
    pub(super) fn row(&self, key: &'m str) -> Result<Option<Vec<f64>>, Error> {
        self.text(key).map(|value| self.numbers_in(key, value)).transpose()
    }

    /// The numbers of an attribute that may have fewer than its class, which has the others then.
    pub(super) fn joined_row(&self, key: &'m str) -> Result<Vec<f64>, Error> {
        let mut row = Vec::new();
        for value in self.texts(key) {
            row.extend(self.numbers_in(key, value)?.into_iter().skip(row.len()));
        }
        Ok(row)
    }

    fn numbers_in(&self, key: &str, value: &str) -> Result<Vec<f64>, Error> {
        let numbers: Option<Vec<f64>> = value
            .split_ascii_whitespace()
            .map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite()))
            .collect();
        numbers.ok_or_else(|| self.wrong(key, "numbers, with blanks between them"))
    }

    /// An attribute of `N` numbers.
    pub(super) fn numbers<const N: usize>(&self, key: &'m str) -> Result<Option<[f64; N]>, Error> {
        let Some(row) = self.row(key)? else { return Ok(None) };
        let numbers = row.try_into().ok();
        let expected = || if N == 1 { "a number".to_owned() } else { format!("{N} numbers") };
        numbers.map(Some).ok_or_else(|| self.wrong(key, expected()))
    }

    /// An attribute of one number.
    pub(super) fn number(&self, key: &'m str, default: f64) -> Result<f64, Error> {
        Ok(self.numbers::<1>(key)?.map_or(default, |[x]| x))
    }

    /// The error of an attribute.
    pub(super) fn wrong(&self, key: &str, expected: impl Into<String>) -> Error {
        let element = self.node.tag_name().name();
        let value = clipped(self.node.attribute(key).unwrap_or("…"));
        let message = match self.node.has_attribute(key) {
            true => format!("{key} of <{element}> is \"{value}\""),
            false => format!("{key} of <{element}>, which its default class gives, is not usable"),
        };
        self.model.error(self.node, message).expected(expected).help(format!("correct {key}=\"…\""))
    }
}
