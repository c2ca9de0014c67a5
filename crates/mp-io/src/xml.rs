//! The text of an XML file, safe to be parsed.

use crate::encoding::decode_xml;
use crate::error::{Error, ErrorKind};
use std::borrow::Cow;

/// The most attributes of one element.
const MAX_ATTRIBUTES: usize = 64;
/// The most name space declarations of a document.
const MAX_NAMESPACES: usize = 64;

/// The text of an XML file, if it is one that is parsed in time and memory in proportion to its size.
pub(crate) fn text<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, str>, Error> {
    let text = decode_xml(file, bytes)?;
    refuse_floods(file, &text)?;
    Ok(text)
}

/// Refuses files on which the XML reader would spend time or memory out of proportion: thousands of attributes in one
/// element, or many declarations of name spaces. The reader compares each with all others.
fn refuse_floods(file: &str, text: &str) -> Result<(), Error> {
    let mut rest = text;
    let mut namespaces = 0;
    let flood = |at, message| {
        Error::at(ErrorKind::TooLarge, file, text, at, 1, message)
            .help("write the file again with another program")
    };
    while let Some(open) = rest.find('<') {
        let tag = &rest[open..];
        let skip = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")]
            .into_iter()
            .find(|(s, _)| tag.starts_with(s));
        if let Some((_, end)) = skip {
            let Some(close) = tag.find(end) else { return Ok(()) }; // the XML reader says what is wrong
            rest = &tag[close + end.len()..];
            continue;
        }
        let (mut quote, mut attributes, mut close) = (None, 0, tag.len());
        for (i, b) in tag.bytes().enumerate() {
            match (quote, b) {
                (Some(q), _) if q == b => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(b),
                (None, b'=') => attributes += 1,
                (None, b'>') => {
                    close = i;
                    break;
                }
                _ => {}
            }
            if attributes > MAX_ATTRIBUTES {
                let message = format!("an element with more than {MAX_ATTRIBUTES} attributes");
                return Err(flood(text.len() - tag.len(), message));
            }
        }
        namespaces += tag[..close].matches("xmlns").count();
        if namespaces > MAX_NAMESPACES {
            let message = format!("more than {MAX_NAMESPACES} declarations of name spaces");
            return Err(flood(text.len() - tag.len(), message));
        }
        rest = &tag[close..];
    }
    Ok(())
}
