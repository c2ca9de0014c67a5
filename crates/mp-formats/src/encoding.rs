//! Texts that are not UTF-8: names and comments in meshes, and XML in the encoding that it declares.

use crate::error::{Error, ErrorKind};
use crate::files::{decode, without_end_marks};
use crate::text::clipped;
use std::borrow::Cow;

/// What windows-1252 has for the bytes 0x80 to 0x9f; where it has nothing, as ISO-8859-1.
const WINDOWS: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}', '\u{90}',
    '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// `bytes` as windows-1252, which has all characters of ISO-8859-1 that are no controls.
fn western(bytes: &[u8]) -> String {
    bytes
        .iter()
        .map(|&b| WINDOWS.get(usize::from(b).wrapping_sub(0x80)).copied().unwrap_or(char::from(b)))
        .collect()
}

/// The text of a mesh or a map: UTF-8, or else an encoding that extends ASCII. Which one does not matter, because everything but names
/// and comments is ASCII.
///
/// # Errors
/// When it has zero bytes, but for those at its end.
pub fn decode_mesh<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, str>, Error> {
    let bytes = without_end_marks(bytes);
    match decode(file, bytes) {
        Ok(text) => Ok(Cow::Borrowed(text)),
        // A text has no zero bytes.
        Err(e) if bytes.contains(&0) => Err(e),
        Err(_) => Ok(Cow::Owned(western(bytes))),
    }
}

/// The text of an XML file, in the encoding that it declares or that its first bytes show.
pub(crate) fn decode_xml<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, str>, Error> {
    match bytes {
        [0xff, 0xfe, body @ ..] => return wide(file, body, u16::from_le_bytes),
        [0xfe, 0xff, body @ ..] => return wide(file, body, u16::from_be_bytes),
        [b'<', 0, ..] => return wide(file, bytes, u16::from_le_bytes),
        [0, b'<', ..] => return wide(file, bytes, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, ..] => return decode(file, bytes).map(Cow::Borrowed),
        _ => {}
    }
    let declared = declared(bytes).unwrap_or_default();
    match declared.to_ascii_lowercase().as_str() {
        "" => {}
        "iso-8859-1" | "iso_8859-1" | "iso8859-1" | "latin1" | "latin-1" | "l1" | "windows-1252"
        | "cp1252" | "cp-1252" => return Ok(Cow::Owned(western(bytes))),
        // That it is one byte for a character shows in the declaration.
        "utf-8" | "utf8" | "utf-16" | "utf16" => return decode(file, bytes).map(Cow::Borrowed),
        // Every other encoding that can be declared in ASCII has the characters of ASCII.
        _ => {
            return decode(file, bytes).ok().filter(|text| text.is_ascii()).map(Cow::Borrowed).ok_or_else(
                || {
                    let message = format!(
                        "the encoding `{}`, which the file declares, is not read here",
                        clipped(&declared)
                    );
                    Error::new(ErrorKind::Unsupported, file, message)
                        .with_position(1, 1)
                        .expected("UTF-8, UTF-16, ISO-8859-1 or windows-1252; in any other only ASCII")
                        .help("save the file as UTF-8, with encoding=\"UTF-8\" in its first line")
                },
            );
        }
    }
    decode(file, bytes).map(Cow::Borrowed).map_err(|e| match bytes.contains(&0) {
        true => e,
        false => e.expected("UTF-8, for the file declares no encoding").help(
            "save the file as UTF-8, or declare its encoding in the first line: <?xml version=\"1.0\" \
             encoding=\"ISO-8859-1\"?>",
        ),
    })
}

/// The encoding in the declaration of an XML file, if it has one.
fn declared(bytes: &[u8]) -> Option<String> {
    let head = bytes.trim_ascii_start().strip_prefix(b"<?xml")?;
    let head = &head[..head.windows(2).position(|w| w == b"?>")?.min(500)];
    let at = head.windows(8).position(|w| w == b"encoding")?;
    let value = head[at + 8..].trim_ascii_start().strip_prefix(b"=")?.trim_ascii_start();
    let quote = value.first().filter(|q| matches!(q, b'"' | b'\''))?;
    let end = value[1..].iter().position(|b| b == quote)?;
    Some(String::from_utf8_lossy(&value[1..=end]).trim().to_owned())
}

/// UTF-16, with its units in this order of bytes.
fn wide<'a>(file: &str, bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<Cow<'a, str>, Error> {
    let (pairs, rest) = bytes.as_chunks::<2>();
    let text = String::from_utf16(&pairs.iter().map(|pair| unit(*pair)).collect::<Vec<_>>());
    match text {
        Ok(text) if rest.is_empty() => Ok(Cow::Owned(text)),
        _ => {
            Err(Error::new(ErrorKind::Format, file, "the file begins as UTF-16 text, but goes on otherwise")
                .with_position(1, 1)
                .expected("UTF-16 to the end")
                .help("the file may be cut short: write it again, or save it as UTF-8"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn xml(bytes: &[u8]) -> Result<String, Error> {
        decode_xml("r.urdf", bytes).map(Cow::into_owned)
    }

    #[test]
    fn xml_is_read_in_the_encoding_that_it_declares() {
        let body = "<robot name=\"Größe – 5 €\"/>";
        let with = |encoding: &str| format!("<?xml version='1.0' encoding='{encoding}'?>\n{body}");
        let western = |text: &str| -> Vec<u8> {
            let byte = |c: char| match WINDOWS.iter().position(|w| *w == c) {
                Some(i) => 0x80 + i as u8,
                None => c as u8,
            };
            text.chars().map(byte).collect()
        };
        for encoding in ["ISO-8859-1", "iso-8859-1", "latin1", "windows-1252", "CP1252"] {
            assert_eq!(xml(&western(&with(encoding))).unwrap(), with(encoding));
        }
        for encoding in ["UTF-8", "utf8"] {
            assert_eq!(xml(with(encoding).as_bytes()).unwrap(), with(encoding));
            assert_eq!(xml(format!("\u{feff}{}", with(encoding)).as_bytes()).unwrap(), with(encoding));
        }
        // With and without a mark of the order of bytes, in both orders.
        let text = with("UTF-16");
        for mark in ["\u{feff}", ""] {
            let units: Vec<u16> = format!("{mark}{text}").encode_utf16().collect();
            assert_eq!(xml(&units.iter().flat_map(|u| u.to_le_bytes()).collect::<Vec<_>>()).unwrap(), text);
            assert_eq!(xml(&units.iter().flat_map(|u| u.to_be_bytes()).collect::<Vec<_>>()).unwrap(), text);
        }
        // Of an encoding that is not known, what is ASCII.
        let plain = "<?xml version=\"1.0\" encoding=\"GB2312\" ?><robot/>";
        assert_eq!(xml(plain.as_bytes()).unwrap(), plain);
        assert_eq!(xml(b"<?xml version=\"1.0\" encoding = \"US-ASCII\"?><robot/>").unwrap().len(), 51);
    }

    #[test]
    fn other_encodings_are_refused_with_what_to_do() {
        let says = |bytes: &[u8], words: &[&str]| {
            let e = xml(bytes).unwrap_err();
            crate::error::check_error(&e);
            let shown = e.report();
            assert!(words.iter().all(|w| shown.contains(w)), "{shown}");
        };
        says(
            b"<robot>\n<!-- \xe4 -->",
            &["r.urdf:2:6", "0xe4", "declares no encoding", "encoding=\"ISO-8859-1\""],
        );
        says(
            b"<?xml version=\"1.0\" encoding=\"GB2312\"?><!-- \xb9 -->",
            &["GB2312", "save the file as UTF-8"],
        );
        says(b"<?xml version=\"1.0\" encoding=\"US-ASCII\"?><!-- \xe4 -->", &["US-ASCII"]);
        says(b"<?xml version=\"1.0\" encoding=\"UTF-8\"?><!-- \xe4 -->", &["0xe4"]);
        says(b"\xff\xfe<\0r", &["UTF-16"]);
        says(b"\xff\xfe<\0\x00\xd8<\0", &["UTF-16"]);
        says(b"<robot>\0\xff</robot>", &["binary"]);
    }

    #[test]
    fn names_and_comments_of_meshes_may_be_in_any_encoding() {
        assert_eq!(decode_mesh("m.stl", b"solid Geh\xe4use \x80\n").unwrap(), "solid Gehäuse €\n");
        assert_eq!(decode_mesh("m.stl", "solid Gehäuse\n".as_bytes()).unwrap(), "solid Gehäuse\n");
        assert_eq!(decode_mesh("m.stl", b"solid Geh\xe4use\0\0\x1a").unwrap(), "solid Gehäuse");
        assert!(decode_mesh("m.stl", b"solid\0\xe4").is_err());
    }
}
