//! Plain arrays, on any CPU.

use super::{Lanes, Mask};
use std::ops::{BitAnd, BitOr};

/// Plain arrays.
#[derive(Clone, Copy)]
pub(super) struct Scalar([f32; 8]);

// In tests, where kernels are compiled for all sets of instructions, these are called: in line, plain arrays are as much code as all the
// others together.
impl Scalar {
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self(self.0.map(f))
    }

    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn zip(self, b: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], b.0[i])))
    }

    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn compare(self, b: Self, holds: impl Fn(f32, f32) -> bool) -> Bits {
        Bits((0..8).fold(0, |m, i| m | (u32::from(holds(self.0[i], b.0[i])) << i)))
    }
}

impl Lanes for Scalar {
    type Mask = Bits;
    #[inline(always)]
    fn load(a: &[f32; 8]) -> Self {
        Self(*a)
    }
    #[inline(always)]
    fn store(self, a: &mut [f32; 8]) {
        *a = self.0;
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; 8])
    }
    #[inline(always)]
    fn twice(a: &[f32; 4]) -> Self {
        Self(std::array::from_fn(|i| a[i % 4]))
    }
    #[inline(always)]
    fn halves(low: f32, high: f32) -> Self {
        Self(std::array::from_fn(|i| if i < 4 { low } else { high }))
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.zip(b, |x, y| x + y)
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.zip(b, |x, y| x - y)
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.zip(b, |x, y| x * y)
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        self.zip(b, |x, y| x / y)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f32::abs)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        self.zip(b, |x, y| if x < y { x } else { y })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        self.zip(b, |x, y| if x > y { x } else { y })
    }
    #[inline(always)]
    fn le(self, b: Self) -> Bits {
        self.compare(b, |x, y| x <= y)
    }
    #[inline(always)]
    fn lt(self, b: Self) -> Bits {
        self.compare(b, |x, y| x < y)
    }
    #[inline(always)]
    fn select(mask: Bits, a: Self, b: Self) -> Self {
        Self(std::array::from_fn(|i| if mask.0 >> i & 1 == 1 { a.0[i] } else { b.0[i] }))
    }
}

/// What comparing [`Scalar`]s gives: a bit per lane.
#[derive(Clone, Copy)]
pub(super) struct Bits(u32);

impl BitAnd for Bits {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, b: Self) -> Self {
        Self(self.0 & b.0)
    }
}

impl BitOr for Bits {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, b: Self) -> Self {
        Self(self.0 | b.0)
    }
}

impl Mask for Bits {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0
    }
}
