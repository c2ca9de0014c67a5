//! Lettering with a built-in stroke font, so that pictures need no font file.

use crate::camera::Projected;
use crate::raster::stroke;

/// Glyphs on a grid four units wide: capitals from y = 0 to the baseline at 6, small letters from 2, tails
/// down to 8. Each word is a polyline of `xy` digit pairs; `~` rounds its corners.
#[rustfmt::skip]
const GLYPHS: &[(char, &str)] = &[
    ('A', "062046 1333"), ('B', "0006 ~00404303 ~03434606"), ('C', "~413000063645"), ('D', "0006 ~00404606"),
    ('E', "40000646 0333"), ('F', "400006 0333"), ('G', "~413000063645 454323"), ('H', "0006 4046 0343"),
    ('I', "0006"), ('J', "~30360605"), ('K', "0006 4004 1346"), ('L', "000646"), ('M', "0600234046"),
    ('N', "06004640"), ('O', "~204046060020"), ('P', "0600 ~00404303"), ('Q', "~204046060020 2446"),
    ('R', "0600 ~00404303 2346"), ('S', "~4140000343460605"), ('T', "0040 2026"), ('U', "~00064640"),
    ('V', "002640"), ('W', "0016233640"), ('X', "0046 4006"), ('Y', "002340 2326"), ('Z', "00400646"),
    ('a', "3236 ~332202062635"), ('b', "0006 ~031232361605"), ('c', "~332202062635"),
    ('d', "3036 ~332202062635"), ('e', "0434 ~343202062635"), ('f', "~20101216 0222"),
    ('g', "~332202062635 ~3236380807"), ('h', "0006 ~0312323436"), ('i', "0206 0000"),
    ('j', "~12161808 1010"), ('k', "0006 3205 1436"), ('l', "0006"), ('m', "0206 ~0312222426 ~2332424446"),
    ('n', "0206 ~0312323436"), ('o', "~123236060212"), ('p', "0208 ~031232361605"),
    ('q', "3238 ~332202062635"), ('r', "0206 ~031222"), ('s', "~3332020434360605"), ('t', "~10151626 0222"),
    ('u', "~0204062635 3236"), ('v', "022642"), ('w', "0216233642"), ('x', "0236 3206"), ('y', "0226 4218"),
    ('z', "02320636"),
    ('0', "~204046060020"), ('1', "112026"), ('2', "~0100404306 0646"), ('3', "~0100404313 ~1343460605"),
    ('4', "36300444"), ('5', "400003 ~030242460605"), ('6', "~30000646430304"), ('7', "004016"),
    ('8', "~204043030020 ~234346060323"), ('9', "~16464000034342"),
    ('.', "0606"), (',', "0607"), (':', "0303 0606"), ('-', "0424"), ('+', "0444 2226"), ('=', "0343 0545"),
    ('(', "~10020517"), (')', "~00121507"), ('/', "0640"), ('%', "0640 0101 4545"), ('_', "0747"),
    ('\'', "0001"), ('°', "~102022020010"), ('×', "0236 3206"), ('→', "0444 224426"), ('#', "1016 3036 0242 0444"),
    ('·', "0303"),
];

/// Drawn for a character that is not in the font.
const UNKNOWN: &str = "0040460600";

fn glyph(c: char) -> &'static str {
    GLYPHS.iter().find(|(g, _)| *g == c).map_or(UNKNOWN, |(_, strokes)| strokes)
}

fn polylines(strokes: &str) -> impl Iterator<Item = Vec<[f32; 2]>> + '_ {
    strokes.split(' ').map(|word| {
        let digits = word.trim_start_matches('~').as_bytes();
        let points = digits.chunks(2).map(|d| [f32::from(d[0] - b'0'), f32::from(d[1] - b'0')]).collect();
        if word.starts_with('~') { rounded(rounded(points)) } else { points }
    })
}

/// Cuts each inner corner (Chaikin 1974), by at most one unit.
fn rounded(points: Vec<[f32; 2]>) -> Vec<[f32; 2]> {
    let mut out = vec![points[0]];
    for w in points.windows(3) {
        let toward = |end: [f32; 2]| {
            let (x, y) = (end[0] - w[1][0], end[1] - w[1][1]);
            let length = (x * x + y * y).sqrt().max(1e-6);
            let t = (0.4 * length).min(1.0) / length;
            [w[1][0] + (end[0] - w[1][0]) * t, w[1][1] + (end[1] - w[1][1]) * t]
        };
        out.extend([toward(w[0]), toward(w[2])]);
    }
    out.push(points[points.len() - 1]);
    out
}

/// The width of a character with the gap after it, in units of the grid.
fn advance(c: char) -> f32 {
    if c == ' ' {
        return 3.5;
    }
    let right = polylines(glyph(c)).flatten().map(|p| p[0]).fold(0.0, f32::max);
    right + 2.0
}

/// Width of `text` with capitals `height` samples high.
pub(crate) fn width(text: &str, height: f32) -> f32 {
    text.chars().map(advance).sum::<f32>() * height / 6.0
}

/// Writes `text` with its baseline from (`x`, `y`) and capitals `height` samples high; `bold` widens
/// the strokes. Calls `fragment(sample, coverage)`.
pub(crate) fn write(
    size: (usize, usize),
    text: &str,
    (mut x, y): (f32, f32),
    height: f32,
    bold: f32,
    mut fragment: impl FnMut(usize, f32),
) {
    let unit = height / 6.0;
    for c in text.chars() {
        if c != ' ' {
            for points in polylines(glyph(c)) {
                let at = |p: [f32; 2]| Projected { x: x + p[0] * unit, y: y + (p[1] - 6.0) * unit, key: 0.0 };
                for w in points.windows(2) {
                    stroke(size, at(w[0]), at(w[1]), 0.36 * unit * bold, |i, _, c| fragment(i, c));
                }
            }
        }
        x += advance(c) * unit;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_glyph_is_well_formed_and_distinct_from_unknown() {
        for (c, strokes) in GLYPHS {
            for word in strokes.split(' ') {
                let digits = word.trim_start_matches('~');
                assert!(digits.len() >= 4 && digits.len() % 2 == 0, "{c}: {word}");
                assert!(digits.bytes().all(|d| d.is_ascii_digit()), "{c}: {word}");
            }
        }
        for c in "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789".chars() {
            assert!(glyph(c) != UNKNOWN, "{c}");
        }
    }

    #[test]
    fn text_is_as_wide_as_it_says() {
        let (w, h) = (300, 60);
        let mut right = 0;
        write((w, h), "Hello 42", (10.0, 40.0), 18.0, 1.0, |i, _| right = right.max(i % w));
        let end = 10.0 + width("Hello 42", 18.0);
        assert!((right as f32) < end && right as f32 > end - 12.0, "{right} {end}");
    }
}
