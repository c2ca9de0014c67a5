//! Images of Netpbm: PBM, PGM and PPM, as text (P1 to P3) and as bytes (P4 to P6).

use super::{GridMap, check_size, fault, mean, rounded};
use crate::error::{Error, line_of};

/// The largest value that a sample may have, 16 bits.
const MAX_VALUE: u32 = 65535;

/// Reads an image that begins with `P1` to `P6`.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<GridMap, Error> {
    let mut reader = Reader { file, bytes, at: 2 };
    let (text, bits, channels) = match bytes[1] {
        b'1' => (true, true, 1),
        b'2' => (true, false, 1),
        b'3' => (true, false, 3),
        b'4' => (false, true, 1),
        b'5' => (false, false, 1),
        _ => (false, false, 3),
    };
    let size = [reader.number("the width")? as usize, reader.number("the height")? as usize];
    check_size(file, size)?;
    // In an image of bits, 1 is black.
    let levels = if bits { vec![255, 0] } else { levels(reader.largest()?) };
    let pixels = size[0] * size[1];
    if !text {
        reader.space()?;
        let brightness = reader.bytes(size, channels, bits, &levels)?;
        return Ok(GridMap { size, brightness, with_alpha: None });
    }
    // One digit at least for each sample, and between two numbers one separator.
    reader.enough(if bits { pixels } else { 2 * channels * pixels - 1 })?;
    let mut brightness = Vec::with_capacity(pixels);
    for _ in 0..pixels {
        let mut pixel = [0; 3];
        for level in &mut pixel[..channels] {
            *level = if bits { reader.bit()? } else { reader.sample(&levels)? };
        }
        brightness.push(mean(&pixel[..channels]));
    }
    Ok(GridMap { size, brightness, with_alpha: None })
}

/// For each value of a sample from 0 to `white_value`, the 8 bits it becomes.
fn levels(white_value: u32) -> Vec<u8> {
    let white: u16 = if white_value < 256 { 255 } else { u16::MAX };
    let factor = f32::from(white) / white_value as f32;
    let level = |v: u32| match (v as f32 * factor).round() {
        v if white == 255 => v as u8,
        v => rounded(v as u16),
    };
    (0..=white_value).map(level).collect()
}

/// The bytes of an image, and how far they have been read.
struct Reader<'a> {
    file: &'a str,
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    /// An error at byte `at`, with its line and column.
    fn fault(&self, at: usize, message: impl Into<String>) -> Error {
        let (line, start) = line_of(self.bytes, at.min(self.bytes.len()));
        fault(self.file, message).with_position(line, at - start + 1)
    }

    /// Passes over white space and comments, from `#` to the end of the line.
    fn skip(&mut self) {
        let mut comment = false;
        while let Some(&byte) = self.bytes.get(self.at) {
            comment = if comment { !matches!(byte, b'\n' | b'\r') } else { byte == b'#' };
            if !comment && !is_space(byte) {
                return;
            }
            self.at += 1;
        }
    }

    /// The next whole number; one that is too large becomes [`u32::MAX`].
    fn number(&mut self, what: &str) -> Result<u32, Error> {
        self.skip();
        let start = self.at;
        let mut value = 0_u32;
        while let Some(digit @ b'0'..=b'9') = self.bytes.get(self.at) {
            value = value.saturating_mul(10).saturating_add(u32::from(digit - b'0'));
            self.at += 1;
        }
        match self.bytes.get(self.at) {
            Some(byte) if !is_space(*byte) && *byte != b'#' => {
                let message = format!("`{}` is not part of a number", byte.escape_ascii());
                Err(self.fault(self.at, message).expected(format!("{what}, a whole number")))
            }
            None if start == self.at => Err(self.fault(start, format!("the image ends before {what}"))),
            _ => Ok(value),
        }
    }

    /// The largest value of a sample.
    fn largest(&mut self) -> Result<u32, Error> {
        self.skip();
        let start = self.at;
        let largest = self.number("the largest value of a pixel")?;
        if (1..=MAX_VALUE).contains(&largest) {
            return Ok(largest);
        }
        let message = format!("the largest value of a pixel is {largest}");
        Err(self.fault(start, message).expected(format!("1 to {MAX_VALUE}")))
    }

    /// The next sample that is a number, as 8 bits.
    fn sample(&mut self, levels: &[u8]) -> Result<u8, Error> {
        self.skip();
        let start = self.at;
        let value = self.number("the value of a pixel")?;
        levels.get(value as usize).copied().ok_or_else(|| {
            self.fault(start, format!("a pixel has the value {value}"))
                .expected(format!("0 to {}", levels.len() - 1))
        })
    }

    /// The next sample that is a single digit, as 8 bits. Digits may follow each other without a separator.
    fn bit(&mut self) -> Result<u8, Error> {
        self.skip();
        self.at += 1;
        match self.bytes.get(self.at - 1) {
            Some(b'0') => Ok(255),
            Some(b'1') => Ok(0),
            Some(byte) => {
                let message = format!("a pixel has the value `{}`", byte.escape_ascii());
                Err(self.fault(self.at - 1, message).expected("0 or 1"))
            }
            None => Err(self.fault(self.bytes.len(), "the image ends before the value of a pixel")),
        }
    }

    /// Skips the single white space before binary pixels; a comment with the end of its line counts as one.
    fn space(&mut self) -> Result<(), Error> {
        match self.bytes.get(self.at) {
            Some(b'#') => {
                let end = self.bytes[self.at..].iter().position(|b| matches!(b, b'\n' | b'\r'));
                self.at = end.map_or(self.bytes.len(), |i| self.at + i + 1);
                Ok(())
            }
            Some(_) => {
                self.at += 1;
                Ok(())
            }
            None => Err(self.fault(self.at, "the image ends before its pixels")),
        }
    }

    /// Refuses an image with fewer than `count` bytes left.
    fn enough(&self, count: usize) -> Result<(), Error> {
        let left = self.bytes.len() - self.at;
        if left >= count {
            return Ok(());
        }
        let message = format!("the image ends early: there are {left} bytes of pixels");
        Err(fault(self.file, message).expected(format!("at least {count}")))
    }

    /// The brightness of binary pixels: bytes, or bits in rows of whole bytes.
    fn bytes(
        &self,
        [width, height]: [usize; 2],
        channels: usize,
        bits: bool,
        levels: &[u8],
    ) -> Result<Vec<f32>, Error> {
        let wide = levels.len() > 256;
        let row = if bits { width.div_ceil(8) } else { width * channels * if wide { 2 } else { 1 } };
        self.enough(row * height)?;
        let mut brightness = Vec::with_capacity(width * height);
        for row in self.bytes[self.at..][..row * height].chunks_exact(row) {
            let value = |i: usize| match (bits, wide) {
                (true, _) => usize::from(row[i / 8] >> (7 - i % 8) & 1),
                (_, true) => usize::from(u16::from_be_bytes([row[2 * i], row[2 * i + 1]])),
                _ => usize::from(row[i]),
            };
            for x in 0..width {
                let mut pixel = [0; 3];
                for (k, level) in pixel[..channels].iter_mut().enumerate() {
                    let value = value(x * channels + k);
                    *level = *levels.get(value).ok_or_else(|| {
                        fault(self.file, format!("a pixel has the value {value}"))
                            .expected(format!("0 to {}", levels.len() - 1))
                    })?;
                }
                brightness.push(mean(&pixel[..channels]));
            }
        }
        Ok(brightness)
    }
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b'\t' | b'\n' | 0x0b | 0x0c | b'\r' | b' ')
}
