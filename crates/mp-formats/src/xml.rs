//! The text of an XML file, safe to be parsed.

use crate::encoding::decode_xml;
use crate::error::{Error, ErrorKind};
use crate::files::without_end_marks;
use std::borrow::Cow;

/// The most attributes of one element.
const MAX_ATTRIBUTES: usize = 64;
/// The most name space declarations of a document.
const MAX_NAMESPACES: usize = 64;

/// The text of an XML file, if it is one that is parsed in time and memory in proportion to its size.
///
/// # Errors
/// When it is not, or its encoding is not known.
pub fn text<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, str>, Error> {
    let is_wide = bytes.len() > 1 && (bytes[..2].contains(&0) || bytes.starts_with(b"\xff\xfe"));
    let text = decode_xml(file, if is_wide { bytes } else { without_end_marks(bytes) })?;
    refuse_floods(file, &text)?;
    Ok(without_late_declaration(text))
}

/// The text with blanks in place of a declaration that blanks or comments precede: most readers of XML pass over it.
fn without_late_declaration(text: Cow<'_, str>) -> Cow<'_, str> {
    let mut rest = text.trim_start();
    while let Some(end) = rest.strip_prefix("<!--").and_then(|comment| comment.find("-->")) {
        rest = rest["<!--".len() + end + "-->".len()..].trim_start();
    }
    let at = text.len() - rest.len();
    match rest.find("?>").filter(|_| at > 0 && rest.starts_with("<?xml")) {
        Some(end) => {
            let blank = |c: char| if c == '\n' { '\n' } else { ' ' };
            let end = at + end + "?>".len();
            let blanks: String = text[at..end].chars().map(blank).collect();
            Cow::Owned([&text[..at], &blanks, &text[end..]].concat())
        }
        None => text,
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_other_readers_pass_over_is_no_error() {
        let of = |bytes: &[u8]| text("f", bytes).unwrap().into_owned();
        assert_eq!(of(b"<robot/>\n\0\0"), "<robot/>\n");
        assert_eq!(of(b"\n<?xml version='1.0'?>\n<robot/>"), "\n                     \n<robot/>");
        assert_eq!(of(b"<!-- a -->\n<?xml?><robot/>"), "<!-- a -->\n       <robot/>");
        assert_eq!(of(b"<?xml version='1.0'?><robot/>"), "<?xml version='1.0'?><robot/>");
        assert!(text("f", b"<rob\0ot/>").is_err());
    }
}
