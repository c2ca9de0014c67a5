//! Pictures made of pixels, and PNG files of them.

/// A picture: rows of pixels from the top, each of red, green and blue, 8 bits in sRGB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Picture {
    /// The picture whose pixel in column x and row y is `at(x, y)`.
    pub(crate) fn from_fn(
        (width, height): (usize, usize),
        mut at: impl FnMut(usize, usize) -> [u8; 3],
    ) -> Self {
        let mut rgb = Vec::with_capacity(3 * width * height);
        for y in 0..height {
            for x in 0..width {
                rgb.extend(at(x, y));
            }
        }
        Self { width, height, rgb }
    }

    /// Pixels in a row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// The number of rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Red, green and blue of all pixels, row by row from the top: `3 · width · height` bytes.
    #[must_use]
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Red, green and blue of the pixel in column `x` and row `y`, counted from 0 at the upper left; `None`
    /// outside.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> Option<[u8; 3]> {
        let inside = x < self.width && y < self.height;
        inside.then(|| std::array::from_fn(|k| self.rgb[3 * (y * self.width + x) + k]))
    }

    /// The picture as the content of a PNG file.
    #[must_use]
    pub fn to_png(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        let written = encoder.write_header().and_then(|mut writer| {
            writer.write_image_data(&self.rgb)?;
            writer.finish()
        });
        // This cannot fail: a picture has at least one pixel and the right number of bytes, and a vector
        // takes all of them.
        debug_assert!(written.is_ok(), "{written:?}");
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_reads_back_from_png() {
        for size in [(1, 1), (7, 3), (200, 2)] {
            let picture = Picture::from_fn(size, |x, y| [x as u8, y as u8, (x * 31 + y * 7) as u8]);
            assert_eq!(picture.pixel(0, size.1 - 1), Some([0, size.1 as u8 - 1, (size.1 * 7 - 7) as u8]));
            assert_eq!((picture.pixel(size.0, 0), picture.pixel(0, size.1)), (None, None));
            let png = picture.to_png();
            let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
            let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut rgb).unwrap();
            assert_eq!((info.width as usize, info.height as usize), size);
            assert_eq!(rgb, picture.rgb());
        }
    }
}
