//! YAML as the values of JSON.

use mp_formats::error::{Error, ErrorKind};
use saphyr_parser::{Event, Parser, ScalarStyle, StrInput};
use serde_json::{Map, Number, Value};

/// No message is nested deeper.
const DEPTH: usize = 32;

/// The first document of `text`, which errors call `file`.
pub(crate) fn value(file: &str, text: &str) -> Result<Value, Error> {
    let mut reader = Reader { file, text, events: Parser::new_from_str(text) };
    loop {
        match reader.next()? {
            (Event::StreamStart | Event::DocumentStart(..), _) => {}
            (Event::StreamEnd | Event::DocumentEnd, _) => return Ok(Value::Null),
            (event, at) => return reader.value(event, at, 0),
        }
    }
}

struct Reader<'t> {
    file: &'t str,
    text: &'t str,
    events: Parser<'t, StrInput<'t>>,
}

impl<'t> Reader<'t> {
    /// The next event, and at which character it begins.
    fn next(&mut self) -> Result<(Event<'t>, usize), Error> {
        match self.events.next() {
            None => Ok((Event::StreamEnd, self.text.len())),
            Some(Ok((event, span))) => Ok((event, span.start.index())),
            Some(Err(e)) => Err(self.error(e.marker().index(), format!("this is not YAML: {}", e.info()))),
        }
    }

    fn error(&self, at: usize, message: impl Into<String>) -> Error {
        let at = self.text.char_indices().nth(at).map_or(self.text.len(), |(at, _)| at);
        Error::at(ErrorKind::Format, self.file, self.text, at, 1, message.into())
            .help("YAML is read as far as messages of ROS and files of MoveIt use it")
    }

    /// The value that begins with `event`.
    fn value(&mut self, event: Event<'t>, at: usize, depth: usize) -> Result<Value, Error> {
        if depth > DEPTH {
            return Err(self.error(at, "this is nested too deep"));
        }
        match event {
            Event::Scalar(.., Some(tag)) if !tag.is_yaml_core_schema() => {
                Err(self.error(at, "this has a tag, which is not read"))
            }
            Event::Scalar(text, style, ..) => Ok(scalar(&text, style == ScalarStyle::Plain)),
            Event::SequenceStart(..) => {
                let mut items = Vec::new();
                loop {
                    match self.next()? {
                        (Event::SequenceEnd, _) => return Ok(Value::Array(items)),
                        (event, at) => items.push(self.value(event, at, depth + 1)?),
                    }
                }
            }
            Event::MappingStart(..) => {
                let mut entries = Map::new();
                loop {
                    let key = match self.next()? {
                        (Event::MappingEnd, _) => return Ok(Value::Object(entries)),
                        (Event::Scalar(key, ..), at) if entries.contains_key(&*key) => {
                            return Err(self
                                .error(at, format!("`{}` is there twice", mp_formats::text::clipped(&key))));
                        }
                        (Event::Scalar(key, ..), _) => key.into_owned(),
                        (_, at) => return Err(self.error(at, "a key is no word")),
                    };
                    let (event, at) = self.next()?;
                    let value = self.value(event, at, depth + 1)?;
                    entries.insert(key, value);
                }
            }
            Event::Alias(_) => Err(self.error(at, "this is an alias of another value, which is not read")),
            _ => Err(self.error(at, "the file ends too early")),
        }
    }
}

/// A number if it reads as one and is not between quotes.
fn scalar(text: &str, plain: bool) -> Value {
    if !plain {
        return Value::String(text.to_owned());
    }
    match text {
        "" | "~" | "null" => Value::Null,
        "true" => Value::Bool(true),
        "false" => Value::Bool(false),
        _ => {
            let number = text.parse::<i64>().ok().map(Number::from);
            let number = number.or_else(|| text.parse().ok().and_then(Number::from_f64));
            number.map_or_else(|| Value::String(text.to_owned()), Value::Number)
        }
    }
}
