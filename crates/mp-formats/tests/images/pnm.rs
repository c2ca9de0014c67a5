//! Images of Netpbm.

use super::{read, refused};
use mp_formats::error::ErrorKind;
use mp_formats::grid::GridMap;
use proptest::prelude::*;

/// The file of an image: `kind` 1 to 6, samples of all pixels of which `most` is white (of bits: 1 is black).
fn file(kind: u8, size: [usize; 2], most: u16, samples: &[u16], space: &str) -> Vec<u8> {
    let mut out = format!("P{kind}{space}{}{space}{}", size[0], size[1]);
    if kind % 3 != 1 {
        out += &format!("{space}{most}");
    }
    if kind <= 3 {
        samples.iter().for_each(|v| out += &format!("{space}{v}"));
        return out.into_bytes();
    }
    let mut out = (out + "\n").into_bytes();
    match kind {
        4 => {
            for row in samples.chunks(size[0]) {
                let byte =
                    |bits: &[u16]| bits.iter().enumerate().map(|(i, v)| (*v as u8) << (7 - i)).sum::<u8>();
                out.extend(row.chunks(8).map(byte));
            }
        }
        _ if most > 255 => out.extend(samples.iter().flat_map(|v| v.to_be_bytes())),
        _ => out.extend(samples.iter().map(|v| *v as u8)),
    }
    out
}

fn channels(kind: u8) -> usize {
    if kind.is_multiple_of(3) { 3 } else { 1 }
}

/// A kind, a size, the largest value, and samples.
fn image() -> impl Strategy<Value = (u8, [usize; 2], u16, Vec<u16>)> {
    let most = prop_oneof![Just(255_u16), Just(65535), Just(1), 1..=255_u16, 1..=65535_u16];
    (1..=6_u8, [1..20_usize, 1..20_usize], most).prop_flat_map(|(kind, size, most)| {
        let most = if kind % 3 == 1 { 1 } else { most };
        let count = size[0] * size[1] * channels(kind);
        (Just(kind), Just(size), Just(most), prop::collection::vec(0..=most, count))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn every_kind_is_read(
        (kind, size, most, samples) in image(),
        space in prop::sample::select(vec![" ", "\n", "\r\n", "\t \u{b}\u{c}", "# 1 2\n", " # \u{e9}\n#\r "]),
    ) {
        let grid = GridMap::parse("map.pgm", &file(kind, size, most, &samples, space)).unwrap();
        prop_assert_eq!(grid.size, size);
        let exact = |v: &u16| match kind % 3 {
            1 => 255.0 - 255.0 * f64::from(*v),
            _ => (255.0 * f64::from(*v) / f64::from(most)).round(),
        };
        for (pixel, brightness) in samples.chunks(channels(kind)).zip(grid.brightness) {
            let wanted = pixel.iter().map(exact).sum::<f64>() / pixel.len() as f64;
            // Between two steps of 8 bits rounding may go either way.
            let slack = if [1, 255, 65535].contains(&most) { 1e-4 } else { 1.0001 };
            prop_assert!((wanted - f64::from(brightness)).abs() < slack, "{pixel:?} {wanted} {brightness}");
        }
    }

    #[test]
    fn spoilt_files_are_read_or_refused(
        (kind, size, most, samples) in image(),
        at in 0.0..1.0_f64,
        byte: u8,
        cut: bool,
    ) {
        let mut bytes = file(kind, size, most, &samples, " ");
        let at = (at * bytes.len() as f64) as usize;
        if cut { bytes.truncate(at) } else { bytes[at] = byte }
        match read(&bytes) {
            Ok(brightness) => prop_assert!(brightness.iter().all(|b| (0.0..=255.0).contains(b))),
            Err(error) => prop_assert!(!error.to_string().contains('\n') && error.remedy().is_some()),
        }
    }
}

#[test]
fn bits_may_touch_and_comments_may_be_anywhere() {
    assert_eq!(read(b"P1#a\n2#b\n2 01\n#c\n10").unwrap(), [255.0, 0.0, 0.0, 255.0]);
    assert_eq!(read(b"P2 2 1 255#a\n7#b\n 9").unwrap(), [7.0, 9.0]);
    assert_eq!(read(b"P5 2 1 255#a\n\x07\x09").unwrap(), [7.0, 9.0]);
    // Only one white space: what follows are pixels.
    assert_eq!(read(b"P5 2 1 255\n\n#").unwrap(), [10.0, 35.0]);
    // What comes after is not read.
    assert_eq!(read(b"P5 1 1 255\n\x05P5 1 1").unwrap(), [5.0]);
}

#[test]
fn what_is_wrong_is_said() {
    for (bytes, kind, words) in [
        (&b"P5"[..], ErrorKind::Format, "1:3: the image ends before the width"),
        (b"P5 3\n", ErrorKind::Format, "the image ends before the height"),
        (b"P5 # 3 3 255", ErrorKind::Format, "the image ends before the width"),
        (b"P5 3 x2 255\n", ErrorKind::Format, "1:6: `x` is not part of a number; expected the height"),
        (b"P5 3 -2 255\n", ErrorKind::Format, "`-` is not"),
        (b"P5 3\n\xff2 255\n", ErrorKind::Format, "2:1: `\\xff` is not"),
        (b"P5 0 2 255\n", ErrorKind::TooLarge, "0 × 2 pixels; expected 1 to 8192"),
        (b"P5 8193 1 255\n", ErrorKind::TooLarge, "8193 × 1 pixels"),
        (b"P5 8192 99999999999999999999 255\n", ErrorKind::TooLarge, "expected 1 to 8192"),
        (b"P5 1 1 0\n\0", ErrorKind::Format, "1:8: the largest value of a pixel is 0; expected 1 to 65535"),
        (b"P5 1 1 65536\n\0\0", ErrorKind::Format, "expected 1 to 65535"),
        (b"P5 1 1 255", ErrorKind::Format, "the image ends before its pixels"),
        (b"P5 2 2 255\n\0\0\0", ErrorKind::Format, "there are 3 bytes of pixels; expected at least 4"),
        (b"P5 8192 8192 65535\n", ErrorKind::Format, "expected at least 134217728"),
        (b"P6 2 1 256\n\0\0\0\0\0", ErrorKind::Format, "expected at least 12"),
        (b"P4 9 2\n\0\0\0", ErrorKind::Format, "expected at least 4"),
        (b"P5 1 1 9\n\x0a", ErrorKind::Format, "a pixel has the value 10; expected 0 to 9"),
        (b"P2 2 1 9\n1\n10", ErrorKind::Format, "3:1: a pixel has the value 10; expected 0 to 9"),
        (b"P2 2 1 9\n1", ErrorKind::Format, "expected at least 3"),
        (b"P2 2 1 9\n1    \n", ErrorKind::Format, "the image ends before the value of a pixel"),
        (b"P2 2 1 9\n1.0 2", ErrorKind::Format, "2:2: `.` is not part of a number"),
        (b"P1 2 1\n0 2", ErrorKind::Format, "2:3: a pixel has the value `2`; expected 0 or 1"),
        (b"P1 2 1\n0  ", ErrorKind::Format, "ends before the value of a pixel"),
    ] {
        refused(bytes, kind, words);
    }
}
