//! The colours of pictures, `0xRRGGBB` in sRGB.

use crate::canvas::{Colour, mix, srgb};

/// The robot at its start.
pub const START: u32 = 0x2e9e5b;
/// The robot half way.
pub const MIDDLE: u32 = 0xe6b422;
/// The robot at its goal.
pub const GOAL: u32 = 0xcf3a3a;
/// Letters, walls and outlines.
pub const INK: u32 = 0x2b3440;
/// Obstacles in the plane.
pub const OBSTACLE: u32 = 0x8d99a8;
/// The colours of successive obstacles in space.
pub const OBSTACLES: [u32; 6] = [0xb4bdc9, 0xc9bda9, 0xacbfb3, 0xc2b2bd, 0xa9bcc4, 0xcdc7ae];
/// A path in the plane.
pub const PATH: u32 = 0xc77d0a;

/// The colour of the path at the fraction `t` of its length.
pub(crate) fn gradient(t: f32) -> Colour {
    let (start, middle, goal) = (srgb(START), srgb(MIDDLE), srgb(GOAL));
    if t < 0.5 { mix(start, middle, 2.0 * t) } else { mix(middle, goal, 2.0 * t - 1.0) }
}
