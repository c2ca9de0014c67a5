//! Maps of ROS's map_server: a YAML file and an image.

use super::GUIDE;
use mp_formats::encoding::decode_mesh;
use mp_formats::error::{Error, ErrorKind};
use mp_formats::grid::GridMap;
use mp_formats::mesh::MAX_COORDINATE;
use mp_formats::text::clipped;
use mp_geom::planar::Polygon;
use nalgebra::Isometry2;
use saphyr_parser::{Event, Parser, StrInput};
use std::collections::HashMap;
use std::ops::Range;

/// The largest YAML file of a map, bytes; they have some hundred.
const MAX_BYTES: usize = 1 << 20;
/// The longest scalar that an alias repeats, bytes.
const MAX_REPEATED: usize = 256;

/// The content of the YAML file of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct RosMap {
    /// The name of the image file, as the YAML file gives it.
    pub image: String,
    /// Metres per pixel.
    pub resolution: f64,
    /// x, y (m) and yaw (rad) of the lower left corner.
    pub origin: [f64; 3],
    /// Whether white pixels are occupied, instead of black ones.
    pub negate: bool,
    /// A pixel is occupied when it is more likely occupied than this.
    pub occupied_thresh: f64,
    /// A pixel is free when it is less likely occupied than this.
    pub free_thresh: f64,
}

impl RosMap {
    /// Reads `bytes`, the content of a YAML file of map_server that errors call `file`: `image`, `resolution` and
    /// `origin`, and, with defaults, `negate` (0), `occupied_thresh` (0.65), `free_thresh`
    /// (0.196) and `mode` (`trinary`, the only one read). Other keys are skipped.
    ///
    /// # Errors
    /// [`Error`] with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = &*decode_mesh(file, bytes)?;
        let yaml = Yaml { file, text };
        let mut map = Self {
            image: String::new(),
            resolution: 0.0,
            origin: [0.0; 3],
            negate: false,
            occupied_thresh: 0.65,
            free_thresh: 0.196,
        };
        let mut entries = yaml.entries()?;
        for (key, value) in &entries {
            match key.as_str() {
                "image" => map.image = yaml.scalar(value)?.to_owned(),
                "resolution" => {
                    let v = yaml.number(value, "metres per pixel")?;
                    if v <= 0.0 {
                        return Err(yaml
                            .error(&value.span, format!("the resolution is {v}"))
                            .expected("metres above zero"));
                    }
                    map.resolution = v;
                }
                "origin" => {
                    let what = "a number of the origin";
                    // Three numbers without brackets are no list in YAML, but mean one.
                    let words = match &value.content {
                        Content::List(items) => items.iter().map(|item| yaml.number(item, what)).collect(),
                        Content::Scalar(text) => {
                            text.split(',').map(|word| yaml.number_of(word, value, what)).collect()
                        }
                        Content::Other => Ok(Vec::new()),
                    };
                    // Some programs that save maps write `-nan` for an angle that they do not know.
                    let help = "the origin is `[x, y, yaw]`, metres and radians: write 0 for an angle that is not known";
                    let words: Vec<f64> = words.map_err(|e: Error| e.help(help))?;
                    map.origin = *words.as_array().ok_or_else(|| {
                        let message = format!("the origin has {} numbers", words.len());
                        yaml.error(&value.span, message).expected("`[x, y, yaw]`")
                    })?;
                }
                "negate" => {
                    let word = yaml.scalar(value)?.to_ascii_lowercase();
                    map.negate = match (word.as_str(), word.parse::<f64>().ok()) {
                        ("false" | "no" | "off" | "n", _) | (_, Some(0.0)) => false,
                        ("true" | "yes" | "on" | "y", _) | (_, Some(1.0)) => true,
                        _ => {
                            let message = "negate is neither 0 nor 1".to_owned();
                            return Err(yaml
                                .error(&value.span, message)
                                .expected("0 or 1, or false or true"));
                        }
                    }
                }
                "occupied_thresh" => map.occupied_thresh = yaml.share(value)?,
                "free_thresh" => map.free_thresh = yaml.share(value)?,
                "mode" => {
                    let mode = yaml.scalar(value)?;
                    if !mode.eq_ignore_ascii_case("trinary") {
                        let message = format!("maps of mode `{}` are not read", clipped(mode));
                        return Err(yaml
                            .error(&value.span, message)
                            .expected("`trinary`")
                            .with_kind(ErrorKind::Unsupported));
                    }
                }
                _ => {}
            }
        }
        let end = text.chars().count();
        entries.retain(|(_, value)| !matches!(&value.content, Content::Scalar(text) if matches!(text.as_str(), "" | "~")));
        for key in ["image", "resolution", "origin"] {
            if !entries.iter().any(|(known, _)| known == key) {
                let message = format!("the map has no `{key}`");
                return Err(yaml.error(&(end..end), message).expected(format!("`{key}: …`")));
            }
        }
        if map.free_thresh > map.occupied_thresh {
            let message = "free_thresh is above occupied_thresh".to_owned();
            return Err(yaml
                .error(&(0..1), message)
                .expected("the threshold of what is free below that of what is occupied"));
        }
        Ok(map)
    }

    /// The obstacles of the map whose image is `grid`, unknown pixels included unless they are free; `None` when there are none. Where the image has
    /// transparency, it counts as for map_server: a pixel is as bright as the mean of red, green, blue and opacity.
    ///
    /// # Errors
    /// When coordinates are not finite or beyond 10⁶⁰, or `interrupt` says to end.
    pub fn outline(
        &self,
        grid: &GridMap,
        unknown_is_free: bool,
        interrupt: &mp_stop::Interrupt,
    ) -> Result<Option<Polygon>, mp_geom::planar::PolygonError> {
        let occupied = |brightness: f32| {
            // In one division: a pixel may be at a threshold.
            let probability =
                if self.negate { f64::from(brightness) } else { 255.0 - f64::from(brightness) } / 255.0;
            if unknown_is_free {
                probability > self.occupied_thresh
            } else {
                // All that is not free is an obstacle, unknown pixels included.
                probability >= self.free_thresh
            }
        };
        let [x, y, yaw] = self.origin;
        let polygon = grid.outline_with_alpha(self.resolution, [0.0; 2], occupied, interrupt)?;
        Ok(polygon.map(|p| p.transformed(&Isometry2::new([x, y].into(), yaw))))
    }
}

/// A value of the file, and where it is, in characters.
struct Value {
    content: Content,
    span: Range<usize>,
}

enum Content {
    Scalar(String),
    List(Vec<Value>),
    /// A mapping, a list of lists, or an alias of one: no key that is read has such values.
    Other,
}

/// What is in the text, with the scalars that have an anchor, by its number: they stand for their aliases.
struct Events<'t> {
    parser: Parser<'t, StrInput<'t>>,
    anchors: HashMap<usize, Event<'t>>,
}

/// A YAML file that is a mapping.
struct Yaml<'a> {
    file: &'a str,
    text: &'a str,
}

impl Yaml<'_> {
    /// An error at characters of the text.
    fn error(&self, span: &Range<usize>, message: String) -> Error {
        let byte = |i| self.text.char_indices().nth(i).map_or(self.text.len(), |(at, _)| at);
        let start = byte(span.start);
        let length = byte(span.end).saturating_sub(start).max(1);
        Error::at(ErrorKind::Format, self.file, self.text, start, length, message).help(GUIDE)
    }

    /// The keys of the first document and their values.
    fn entries(&self) -> Result<Vec<(String, Value)>, Error> {
        if self.text.len() > MAX_BYTES {
            let message =
                format!("the file has {} bytes, more than the {MAX_BYTES} of a map", self.text.len());
            return Err(Error::new(ErrorKind::TooLarge, self.file, message).help(GUIDE));
        }
        let mut entries: Vec<(String, Value)> = Vec::new();
        let mut key: Option<String> = None;
        let mut events = Events { parser: Parser::new_from_str(self.text), anchors: HashMap::new() };
        let mut inside = false;
        while let Some((event, span)) = self.next(&mut events)? {
            match event {
                Event::MappingStart(..) if !inside => inside = true,
                Event::Scalar(..) | Event::SequenceStart(..) | Event::MappingStart(..) | Event::Alias(_)
                    if !inside =>
                {
                    let message = "the file is no mapping of keys to values".to_owned();
                    return Err(self.error(&span, message).expected("lines of the form `key: value`"));
                }
                Event::MappingEnd if inside => return Ok(entries),
                _ if !inside => {}
                Event::Scalar(text, ..) if key.is_none() => key = Some(text.into_owned()),
                event => {
                    let value = self.value(event, span, &mut events)?;
                    let Some(key) = key.take() else {
                        let message = "a key is no word".to_owned();
                        return Err(self
                            .error(&value.span, message)
                            .expected("lines of the form `key: value`"));
                    };
                    if entries.iter().any(|(known, _)| *known == key) {
                        let message = format!("`{}` is there twice", clipped(&key));
                        return Err(self.error(&value.span, message).expected("each key once"));
                    }
                    entries.push((key, value));
                }
            }
        }
        Ok(entries)
    }

    /// The value that begins with `event`.
    fn value<'t>(
        &self,
        event: Event<'t>,
        span: Range<usize>,
        events: &mut Events<'t>,
    ) -> Result<Value, Error> {
        let content = match event {
            Event::Scalar(text, ..) => Content::Scalar(text.into_owned()),
            Event::SequenceStart(..) | Event::MappingStart(..) => {
                let (mut depth, mut items, is_list) =
                    (1, Vec::new(), matches!(event, Event::SequenceStart(..)));
                let mut plain = is_list;
                while let Some((event, span)) = self.next(events)? {
                    match event {
                        Event::SequenceStart(..) | Event::MappingStart(..) => {
                            (depth, plain) = (depth + 1, false)
                        }
                        Event::SequenceEnd | Event::MappingEnd => depth -= 1,
                        Event::Scalar(text, ..) => {
                            items.push(Value { content: Content::Scalar(text.into_owned()), span });
                        }
                        _ => plain = false,
                    }
                    if depth == 0 {
                        break;
                    }
                }
                if plain { Content::List(items) } else { Content::Other }
            }
            _ => Content::Other,
        };
        Ok(Value { content, span })
    }

    fn next<'t>(&self, events: &mut Events<'t>) -> Result<Option<(Event<'t>, Range<usize>)>, Error> {
        match events.parser.next() {
            None => Ok(None),
            Some(Ok((event, span))) => {
                let event = match &event {
                    Event::Alias(id) => events.anchors.get(id).cloned().unwrap_or(event),
                    Event::Scalar(text, _, id, _) if *id > 0 && text.len() <= MAX_REPEATED => {
                        events.anchors.insert(*id, event.clone());
                        event
                    }
                    _ => event,
                };
                Ok(Some((event, span.start.index()..span.end.index())))
            }
            Some(Err(e)) => {
                let at = e.marker().index();
                Err(self
                    .error(&(at..at), format!("this is not YAML: {}", e.info()))
                    .expected("lines of the form `key: value`"))
            }
        }
    }

    fn scalar<'v>(&self, value: &'v Value) -> Result<&'v str, Error> {
        match &value.content {
            Content::Scalar(text) => Ok(text.trim()),
            _ => Err(self
                .error(&value.span, "this is no single value".to_owned())
                .expected("a word or a number")),
        }
    }

    fn number(&self, value: &Value, what: &str) -> Result<f64, Error> {
        self.number_of(self.scalar(value)?, value, what)
    }

    fn number_of(&self, word: &str, value: &Value, what: &str) -> Result<f64, Error> {
        match word.trim().parse::<f64>() {
            Ok(v) if v.is_finite() && v.abs() <= MAX_COORDINATE => Ok(v),
            _ => {
                let message = format!("`{}` is not {what}", clipped(word));
                Err(self.error(&value.span, message).expected("a finite number"))
            }
        }
    }

    fn share(&self, value: &Value) -> Result<f64, Error> {
        match self.number(value, "a probability")? {
            v if (0.0..=1.0).contains(&v) => Ok(v),
            v => Err(self
                .error(&value.span, format!("{v} is not a probability"))
                .expected("a number from 0 to 1")),
        }
    }
}
