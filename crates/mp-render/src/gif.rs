//! Films as GIF files.

use crate::error::RenderError;
use crate::picture::Picture;
use crate::quantize::Palette;
use ::gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};

/// The index of the colour that leaves a pixel as it was; the others are colours.
const UNCHANGED: u8 = 255;

/// A GIF file that grows frame by frame. It has one palette, repeats without end, and holds of each frame
/// only what changed.
///
/// ```
/// use mp_render::{Gif, Scene};
/// let picture = Scene::default().draw((64, 48))?;
/// let mut gif = Gif::new(&[picture.clone()], 20.0)?;
/// gif.add(&picture);
/// assert!(gif.finish().starts_with(b"GIF89a"));
/// # Ok::<(), mp_render::RenderError>(())
/// ```
pub struct Gif {
    encoder: Result<Encoder<Vec<u8>>, EncodingError>,
    size: (usize, usize),
    palette: Palette,
    shown: Option<Vec<u8>>,
    rate: f64,
    frames: u32,
}

impl std::fmt::Debug for Gif {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Gif").field("size", &self.size).field("frames", &self.frames).finish_non_exhaustive()
    }
}

impl Gif {
    /// The most frames per second: players slow down those that are faster.
    pub const MAX_RATE: f64 = 50.0;

    /// A file with `rate` frames per second, whose palette suits pictures like `samples`, which have its
    /// size.
    ///
    /// # Errors
    /// When there is no sample, or the rate is not above 0 and up to [`MAX_RATE`](Self::MAX_RATE).
    pub fn new(samples: &[Picture], rate: f64) -> Result<Self, RenderError> {
        let first = samples.first().ok_or(RenderError::Size { width: 0, height: 0 })?;
        if !(rate > 0.0 && rate <= Self::MAX_RATE) {
            return Err(RenderError::Rate { rate, most: Self::MAX_RATE });
        }
        let palette = Palette::new(samples, usize::from(UNCHANGED));
        let size = (first.width(), first.height());
        let colours = palette.colours.as_flattened();
        let encoder = Encoder::new(Vec::new(), size.0 as u16, size.1 as u16, colours);
        let encoder = encoder.and_then(|mut encoder| {
            encoder.set_repeat(Repeat::Infinite)?;
            Ok(encoder)
        });
        Ok(Self { encoder, size, palette, shown: None, rate, frames: 0 })
    }

    /// Adds a frame, which must have the size of the samples; others are left out.
    pub fn add(&mut self, picture: &Picture) {
        if (picture.width(), picture.height()) != self.size {
            debug_assert!(false, "a frame of another size");
            return;
        }
        let pixels = picture.rgb().as_chunks::<3>().0;
        let shown: Vec<u8> = pixels.iter().map(|&p| self.palette.nearest(p)).collect();
        let mut frame = match &self.shown {
            None => {
                Frame { buffer: shown.clone().into(), ..self.rectangle([0, 0], [self.size.0, self.size.1]) }
            }
            Some(before) => self.difference(before, &shown),
        };
        // Whole hundredths of a second, so that no error adds up.
        let time = |frames: u32| (100.0 * f64::from(frames) / self.rate).round();
        frame.delay = (time(self.frames + 1) - time(self.frames)).min(f64::from(u16::MAX)) as u16;
        frame.dispose = DisposalMethod::Keep;
        self.frames += 1;
        self.shown = Some(shown);
        if let Ok(encoder) = &mut self.encoder
            && let Err(e) = encoder.write_frame(&frame)
        {
            self.encoder = Err(e);
        }
    }

    /// An empty frame for the rectangle.
    fn rectangle(&self, [left, top]: [usize; 2], [width, height]: [usize; 2]) -> Frame<'static> {
        let [left, top, width, height] = [left, top, width, height].map(|v| v as u16);
        Frame { left, top, width, height, ..Frame::default() }
    }

    /// The frame of what changed: at least one pixel.
    fn difference(&self, before: &[u8], now: &[u8]) -> Frame<'static> {
        let width = self.size.0;
        let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
        for (i, _) in before.iter().zip(now).enumerate().filter(|(_, (a, b))| a != b) {
            let at = [i % width, i / width];
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(at[k]), high[k].max(at[k] + 1));
            }
        }
        if high[0] == 0 {
            (low, high) = ([0; 2], [1; 2]);
        }
        let row = |y: usize| y * width + low[0]..y * width + high[0];
        let changed = |i: usize| if before[i] == now[i] { UNCHANGED } else { now[i] };
        let buffer: Vec<u8> = (low[1]..high[1]).flat_map(row).map(changed).collect();
        Frame {
            buffer: buffer.into(),
            transparent: Some(UNCHANGED),
            ..self.rectangle(low, [high[0] - low[0], high[1] - low[1]])
        }
    }

    /// The content of the file.
    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        // This cannot fail: writing to memory does not, and frames have the size of the file.
        let written = self.encoder.and_then(Encoder::into_inner);
        debug_assert!(written.is_ok(), "{:?}", written.as_ref().err());
        written.unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square that moves to the right; the third frame is the second again.
    fn frames() -> Vec<Picture> {
        let frame = |at: usize| {
            Picture::from_fn((40, 30), move |x, y| {
                let inside = (at..at + 6).contains(&x) && (10..16).contains(&y);
                if inside { [200, 30, 30] } else { [255, 255, 250] }
            })
        };
        [2, 9, 9, 30].map(frame).to_vec()
    }

    #[test]
    fn a_film_reads_back_frame_by_frame() {
        let frames = frames();
        let mut gif = Gif::new(&frames, 30.0).unwrap();
        frames.iter().for_each(|frame| gif.add(frame));
        let bytes = gif.finish();
        assert!(bytes.len() < 1500, "{}", bytes.len());

        let mut options = ::gif::DecodeOptions::new();
        options.set_color_output(::gif::ColorOutput::Indexed);
        let mut decoder = options.read_info(bytes.as_slice()).unwrap();
        assert_eq!((decoder.width(), decoder.height(), decoder.repeat()), (40, 30, Repeat::Infinite));
        let palette: Vec<[u8; 3]> = decoder.global_palette().unwrap().as_chunks().0.to_vec();
        let mut screen = vec![[0; 3]; 40 * 30];
        let mut delays = Vec::new();
        for wanted in &frames {
            let frame = decoder.read_next_frame().unwrap().unwrap();
            delays.push(frame.delay);
            for (i, &index) in frame.buffer.iter().enumerate() {
                let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
                if frame.transparent != Some(index) {
                    let at = (y + usize::from(frame.top)) * 40 + x + usize::from(frame.left);
                    screen[at] = palette[usize::from(index)];
                }
            }
            assert_eq!(screen.as_flattened(), wanted.rgb());
        }
        assert!(decoder.read_next_frame().unwrap().is_none());
        assert_eq!(delays, [3, 4, 3, 3], "30 frames take 100 hundredths of a second");
    }

    #[test]
    fn rates_that_players_do_not_keep_are_refused() {
        for rate in [0.0, -1.0, 50.1, f64::NAN, f64::INFINITY] {
            let error = Gif::new(&frames(), rate).unwrap_err().to_string();
            assert!(error.contains("up to 50"), "{error}");
        }
        assert!(Gif::new(&[], 10.0).is_err());
    }
}
