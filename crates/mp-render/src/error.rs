//! Errors of drawing.

use nalgebra::Point2;
use thiserror::Error;

/// The widest and highest picture, pixels.
pub const MAX_SIDE: usize = 8192;

/// The largest coordinate that is drawn, metres.
pub(crate) const MAX_COORDINATE: f64 = 1e60;

/// Why a picture could not be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The picture has no pixels, or too many.
    #[error("cannot draw {width} × {height} pixels: expected 1 to {MAX_SIDE} each way")]
    Size {
        /// Its width, pixels.
        width: usize,
        /// Its height, pixels.
        height: usize,
    },
    /// There is no memory for the picture.
    #[error("there is no memory for {width} × {height} pixels: expected {} MB, as for a limit of this process", .bytes >> 20)]
    Memory {
        /// Its width, pixels.
        width: usize,
        /// Its height, pixels.
        height: usize,
        /// What drawing takes, bytes.
        bytes: usize,
    },
    /// A coordinate is NaN, infinite, or beyond 10⁶⁰ m.
    #[error("cannot draw {what}: expected finite coordinates, none beyond {MAX_COORDINATE:e} m")]
    OutOfRange {
        /// What has the coordinate, such as "obstacle 3".
        what: String,
    },
    /// The rectangle of a drawing is empty.
    #[error(
        "cannot draw between ({}, {}) and ({}, {}): expected the lower left corner, then the upper right one",
        low.x, low.y, high.x, high.y
    )]
    Corners {
        /// The lower left one, metres.
        low: Point2<f64>,
        /// The upper right one, metres.
        high: Point2<f64>,
    },
    /// A text does not name what it should.
    #[error("`{text}`: expected {expected}")]
    Text {
        /// The text that was given.
        text: String,
        /// What it should name.
        expected: &'static str,
    },
    /// The frames of a film cannot be shown so fast.
    #[error("cannot show {rate} frames per second: expected a rate above 0 and up to {most}")]
    Rate {
        /// Frames per second.
        rate: f64,
        /// The most that is possible.
        most: f64,
    },
}

/// What a picture takes while it is drawn: bytes for each pixel, and for threads and their stacks. Measured,
/// and a third more.
const BYTES: [usize; 2] = [256, 64 << 20];

/// Refuses pictures without pixels, with too many, and with more than there is memory for.
pub(crate) fn check_size((width, height): (usize, usize)) -> Result<(), RenderError> {
    let fits = |side: usize| (1..=MAX_SIDE).contains(&side);
    if !(fits(width) && fits(height)) {
        return Err(RenderError::Size { width, height });
    }
    let bytes = width * height * BYTES[0] + BYTES[1];
    // In WebAssembly, memory that was asked for once stays taken.
    let has_room = cfg!(target_family = "wasm") || Vec::<u8>::new().try_reserve_exact(bytes).is_ok();
    if has_room { Ok(()) } else { Err(RenderError::Memory { width, height, bytes }) }
}

/// Refuses coordinates out of range; `what` names the thing that has them.
pub(crate) fn check_range(
    coordinates: impl IntoIterator<Item = f64>,
    what: impl FnOnce() -> String,
) -> Result<(), RenderError> {
    // NaN fails this comparison.
    let fits = coordinates.into_iter().all(|c| c.abs() <= MAX_COORDINATE);
    if fits { Ok(()) } else { Err(RenderError::OutOfRange { what: what() }) }
}
