//! Images, whose dark pixels are obstacles.

mod pnm;

use crate::error::{Error, ErrorKind};
use mp_geom::planar::{Polygon, PolygonError, outline};
use mp_stop::Interrupt;
use std::io::Cursor;

/// The widest and highest image, pixels.
const MAX_SIDE: usize = 8192;

/// The brightness of the pixels of an image, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct GridMap {
    /// Pixels in a row, and rows.
    pub size: [usize; 2],
    /// The mean of red, green and blue, 0 to 255.
    pub brightness: Vec<f32>,
    /// The mean of red, green, blue and opacity, 0 to 255, if the image has transparency: what map_server takes for the brightness.
    pub with_alpha: Option<Vec<f32>>,
}

impl GridMap {
    /// Reads `bytes`, the content of a PNG or PNM (PGM, PPM, PBM) image that errors call `file`.
    ///
    /// Colours of 16 bits are rounded to 8. Transparency does not count, but in [`with_alpha`](Self::with_alpha).
    ///
    /// # Errors
    /// [`Error`] when it is not such an image, or larger than 8192 × 8192 pixels.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        match bytes {
            [0x89, b'P', b'N', b'G', ..] => read_png(file, bytes),
            [b'P', b'1'..=b'6', ..] => pnm::read(file, bytes),
            _ => Err(fault(file, "this is neither a PNG nor a PGM image")),
        }
    }

    /// The polygon of the pixels for which `occupied(brightness)` is true, `scale` metres wide each, the lower
    /// left corner of the image at `origin`; `None` when there is none.
    ///
    /// # Errors
    /// When coordinates are not finite or beyond 10⁶⁰, or `interrupt` says to end.
    pub fn outline(
        &self,
        scale: f64,
        origin: [f64; 2],
        occupied: impl Fn(f32) -> bool,
        interrupt: &Interrupt,
    ) -> Result<Option<Polygon>, PolygonError> {
        self.outline_where(&self.brightness, scale, origin, &occupied, interrupt)
    }

    /// As [`outline`](Self::outline), with the brightness that map_server takes: where the image has transparency, opacity is averaged in.
    ///
    /// # Errors
    /// As [`outline`](Self::outline).
    pub fn outline_with_alpha(
        &self,
        scale: f64,
        origin: [f64; 2],
        occupied: impl Fn(f32) -> bool,
        interrupt: &Interrupt,
    ) -> Result<Option<Polygon>, PolygonError> {
        let brightness = self.with_alpha.as_ref().unwrap_or(&self.brightness);
        self.outline_where(brightness, scale, origin, &occupied, interrupt)
    }

    /// As [`outline`](Self::outline), but compiled once, in this crate; asks once for each brightness, of which an image has few.
    fn outline_where(
        &self,
        brightness: &[f32],
        scale: f64,
        origin: [f64; 2],
        occupied: &dyn Fn(f32) -> bool,
        interrupt: &Interrupt,
    ) -> Result<Option<Polygon>, PolygonError> {
        // A brightness is mostly a third of a whole number.
        let mut asked = [None; 3 * 255 + 1];
        let mut is_occupied = |&brightness: &f32| match &mut asked[((3.0 * brightness) as usize).min(3 * 255)]
        {
            Some((known, occupied)) if *known == brightness => *occupied,
            other => other.insert((brightness, occupied(brightness))).1,
        };
        let pixels: Vec<bool> = brightness.iter().map(&mut is_occupied).collect();
        let [width, height] = self.size;
        // The first row of an image is its highest.
        outline([width, height], scale, origin, |x, y| pixels[(height - 1 - y) * width + x], interrupt)
    }
}

/// An error about an image.
fn fault(file: &str, message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Format, file, message).help("save the image as PNG, or as PGM, of 8 bits")
}

/// Refuses images without pixels, and with too many.
fn check_size(file: &str, [width, height]: [usize; 2]) -> Result<(), Error> {
    let fits = |side: usize| (1..=MAX_SIDE).contains(&side);
    if fits(width) && fits(height) {
        return Ok(());
    }
    let message = format!("the image has {width} × {height} pixels");
    Err(Error::new(ErrorKind::TooLarge, file, message)
        .expected(format!("1 to {MAX_SIDE} pixels each way"))
        .help("scale the image"))
}

/// The brightness of a pixel: its grey, or the mean of its red, green and blue.
fn mean(channels: &[u8]) -> f32 {
    channels.iter().map(|v| f32::from(*v)).sum::<f32>() / channels.len() as f32
}

/// 16 bits rounded to 8.
fn rounded(v: u16) -> u8 {
    ((u32::from(v) + 128) / 257) as u8
}

fn read_png(file: &str, bytes: &[u8]) -> Result<GridMap, Error> {
    let failed = |e: png::DecodingError| {
        let why = match e {
            png::DecodingError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
                "it ends early".to_owned()
            }
            e => e.to_string(),
        };
        fault(file, format!("the image cannot be read: {why}"))
    };
    let mut options = png::DecodeOptions::default();
    // Not needed here.
    options.set_ignore_text_chunk(true);
    options.set_ignore_iccp_chunk(true);
    let mut decoder = png::Decoder::new_with_options(Cursor::new(bytes), options);
    let header = decoder.read_header_info().map_err(failed)?;
    let size = [header.width as usize, header.height as usize];
    check_size(file, size)?;
    // Palettes become colours, and less than 8 bits become 8.
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(failed)?;
    // The decoder panics on these: https://github.com/image-rs/image-png/issues/694.
    if let Some(palette) = reader.info().palette.as_ref().filter(|p| !p.len().is_multiple_of(3)) {
        let message = format!("the palette of the image has {} bytes", palette.len());
        return Err(fault(file, message).expected("three for each colour"));
    }
    let too_large = || failed(png::DecodingError::LimitsExceeded);
    let mut samples = vec![0; reader.output_buffer_size().ok_or_else(too_large)?];
    let frame = reader.next_frame(&mut samples).map_err(failed)?;
    if [frame.width as usize, frame.height as usize] != size {
        return Err(fault(file, "the first picture of the animation is smaller than the image"));
    }
    let all = frame.color_type.samples();
    let colours = if all < 3 { 1 } else { 3 };
    // Grey is red, green and blue.
    let shades = |p: &[u8]| match p[..colours] {
        [grey] => [grey; 3],
        _ => [p[0], p[1], p[2]],
    };
    let pixels: Vec<u8> = match frame.bit_depth {
        png::BitDepth::Sixteen => {
            samples.chunks_exact(2).map(|two| rounded(u16::from_be_bytes([two[0], two[1]]))).collect()
        }
        _ => samples,
    };
    let brightness = pixels.chunks_exact(all).map(|p| mean(&p[..colours])).collect();
    let with_alpha = |p: &[u8]| {
        let [red, green, blue] = shades(p);
        mean(&[red, green, blue, p[colours]])
    };
    let with_alpha = (all > colours).then(|| pixels.chunks_exact(all).map(with_alpha).collect());
    Ok(GridMap { size, brightness, with_alpha })
}
