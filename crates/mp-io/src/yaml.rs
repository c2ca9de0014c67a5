//! YAML as the values of JSON.

use mp_formats::error::{Error, ErrorKind};
use saphyr_parser::{Event, Parser, ScalarStyle, StrInput};
use serde_json::{Map, Number, Value};
use std::collections::HashMap;

/// No message is nested deeper.
const DEPTH: usize = 32;

/// Aliases may repeat so much: values, and bytes of texts.
const REPEATED: usize = 1 << 20;

/// The first document of `text`, which errors call `file`.
pub(crate) fn value(file: &str, text: &str) -> Result<Value, Error> {
    let mut reader =
        Reader { file, text, events: Parser::new_from_str(text), anchors: HashMap::new(), repeated: 0 };
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
    /// The values that have an anchor, by its number.
    anchors: HashMap<usize, Value>,
    /// How much aliases have repeated.
    repeated: usize,
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
        let anchor = match &event {
            Event::Scalar(_, _, id, _) | Event::SequenceStart(id, _) | Event::MappingStart(id, _) => *id,
            _ => 0,
        };
        let value = self.value_itself(event, at, depth)?;
        if anchor > 0 {
            self.anchors.insert(anchor, value.clone());
        }
        Ok(value)
    }

    fn value_itself(&mut self, event: Event<'t>, at: usize, depth: usize) -> Result<Value, Error> {
        match event {
            Event::Scalar(text, .., Some(tag)) if !tag.is_yaml_core_schema() => {
                angle(&text, &tag.suffix).ok_or_else(|| self.error(at, "this has a tag, which is not read"))
            }
            Event::Scalar(text, ScalarStyle::Plain, ..) if octal(&text) => {
                let message = format!("{text} is one number in YAML 1.1 and another one in YAML 1.2");
                Err(self
                    .error(at, message)
                    .help("leave the zeros at its beginning out, or write it between quotes"))
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
            Event::Alias(id) => {
                let value = self.anchors.get(&id);
                let value = value
                    .ok_or_else(|| self.error(at, "this is an alias of a key, or of what it is a part of"))?;
                let [size, height] = extent(value);
                if depth + height > DEPTH || self.repeated + size > REPEATED {
                    return Err(self.error(at, "this alias repeats too much, or is nested too deep"));
                }
                self.repeated += size;
                Ok(value.clone())
            }
            _ => Err(self.error(at, "the file ends too early")),
        }
    }
}

/// How much is in a value, and how deep it is nested.
fn extent(value: &Value) -> [usize; 2] {
    let all = |values: &mut dyn Iterator<Item = &Value>| {
        values.map(extent).fold([1, 1], |[size, height], [its, high]| [size + its, height.max(high + 1)])
    };
    match value {
        Value::Array(items) => all(&mut items.iter()),
        Value::Object(entries) => {
            let [size, height] = all(&mut entries.values());
            [size + entries.keys().map(|key| 1 + key.len()).sum::<usize>(), height]
        }
        Value::String(text) => [1 + text.len(), 0],
        _ => [1, 0],
    }
}

/// A number if it reads as one and is not between quotes.
fn scalar(text: &str, plain: bool) -> Value {
    if !plain {
        return Value::String(text.to_owned());
    }
    match text {
        "" | "~" | "null" | "Null" | "NULL" => Value::Null,
        "true" | "True" | "TRUE" => Value::Bool(true),
        "false" | "False" | "FALSE" => Value::Bool(false),
        _ => {
            let number = text.parse::<i64>().ok().map(Number::from);
            let number = number.or_else(|| text.parse().ok().and_then(Number::from_f64));
            number.map_or_else(|| Value::String(text.to_owned()), Value::Number)
        }
    }
}

/// Whether a whole number begins with a zero and so is in octal digits in YAML 1.1, which PyYAML and yaml-cpp read, and in decimal ones in
/// YAML 1.2, where that makes a difference.
fn octal(text: &str) -> bool {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    let zero = digits.len() > 1 && digits.starts_with('0') && digits.bytes().all(|b| b.is_ascii_digit());
    zero && u64::from_str_radix(digits, 8) != digits.parse()
}

/// An angle (rad) with one of the tags of MoveIt, `!degrees 90` and `!radians 1.57`.
fn angle(text: &str, tag: &str) -> Option<Value> {
    let number: f64 = text.trim().parse().ok()?;
    let radians = match tag {
        "degrees" => number.to_radians(),
        "radians" => number,
        _ => return None,
    };
    Number::from_f64(radians).map(Value::Number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Value, String> {
        value("t.yaml", text).map_err(|e| e.report())
    }

    #[test]
    fn aliases_repeat_values() {
        let plain = read("a: 1\nb: [1, [0, 2], x]\nc: [0, 2]\nd: {e: 1}\nf: {e: 1}\n");
        assert_eq!(read("a: &a 1\nb: [*a, &id001 [0, 2], x]\nc: *id001\nd: &d {e: *a}\nf: *d\n"), plain);
        for text in ["a: &a [*a]\n", "a: *b\n", "a: &a x\n*a : 1\n"] {
            assert!(read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_that_begin_with_zero() {
        let same = [("0", 0.0), ("00", 0.0), ("07", 7.0), ("-03", -3.0), ("0.10", 0.1), ("010.5", 10.5)];
        for (text, number) in same {
            assert_eq!(read(&format!("sec: {text}")).unwrap()["sec"].as_f64(), Some(number), "{text}");
        }
        for text in ["010", "-012", "+010", "08", "0000001000"] {
            let said = read(&format!("a: 1\nsec: {text}\n")).unwrap_err();
            assert!(said.contains("t.yaml:2:6") && said.contains("leave the zeros"), "{said}");
        }
        assert_eq!(read("a: '010'").unwrap()["a"], "010");
    }

    #[test]
    fn aliases_repeat_no_floods() {
        let line = |i: usize| format!("- &a{i} [{}]\n", vec![format!("*a{}", i - 1); 10].join(", "));
        let flood: String = (1..12).map(line).collect();
        assert!(read(&format!("- &a0 lol\n{flood}")).unwrap_err().contains("repeats too much"));
        let deep: String = (1..100).map(|i| format!("- &a{i} [*a{}]\n", i - 1)).collect();
        assert!(read(&format!("- &a0 1\n{deep}")).unwrap_err().contains("nested too deep"));
    }
}
