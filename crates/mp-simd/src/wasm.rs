//! 128-bit vectors of WebAssembly, two at a time. None of its operations needs `unsafe`.

use super::{Lanes, Mask};
use std::arch::wasm32::{
    f32x4, f32x4_abs, f32x4_add, f32x4_div, f32x4_extract_lane, f32x4_le, f32x4_lt, f32x4_mul, f32x4_pmax,
    f32x4_pmin, f32x4_splat, f32x4_sqrt, f32x4_sub, i32x4_bitmask, v128, v128_and, v128_bitselect, v128_or,
};
use std::ops::{BitAnd, BitOr};

/// Two vectors.
#[derive(Clone, Copy)]
pub(super) struct Simd128(v128, v128);

impl Lanes for Simd128 {
    type Mask = Both;
    #[inline(always)]
    fn load(a: &[f32; 8]) -> Self {
        Self(f32x4(a[0], a[1], a[2], a[3]), f32x4(a[4], a[5], a[6], a[7]))
    }
    #[inline(always)]
    fn store(self, a: &mut [f32; 8]) {
        let four = |v| {
            [
                f32x4_extract_lane::<0>(v),
                f32x4_extract_lane::<1>(v),
                f32x4_extract_lane::<2>(v),
                f32x4_extract_lane::<3>(v),
            ]
        };
        let ([a0, a1, a2, a3], [a4, a5, a6, a7]) = (four(self.0), four(self.1));
        *a = [a0, a1, a2, a3, a4, a5, a6, a7];
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self(f32x4_splat(x), f32x4_splat(x))
    }
    #[inline(always)]
    fn twice(a: &[f32; 4]) -> Self {
        let four = f32x4(a[0], a[1], a[2], a[3]);
        Self(four, four)
    }
    #[inline(always)]
    fn halves(low: f32, high: f32) -> Self {
        Self(f32x4_splat(low), f32x4_splat(high))
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(f32x4_add(self.0, b.0), f32x4_add(self.1, b.1))
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(f32x4_sub(self.0, b.0), f32x4_sub(self.1, b.1))
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(f32x4_mul(self.0, b.0), f32x4_mul(self.1, b.1))
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        Self(f32x4_div(self.0, b.0), f32x4_div(self.1, b.1))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(f32x4_abs(self.0), f32x4_abs(self.1))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(f32x4_sqrt(self.0), f32x4_sqrt(self.1))
    }
    // These take their first operand unless the second is less (greater).
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Self(f32x4_pmin(b.0, self.0), f32x4_pmin(b.1, self.1))
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Self(f32x4_pmax(b.0, self.0), f32x4_pmax(b.1, self.1))
    }
    #[inline(always)]
    fn le(self, b: Self) -> Both {
        Both(f32x4_le(self.0, b.0), f32x4_le(self.1, b.1))
    }
    #[inline(always)]
    fn lt(self, b: Self) -> Both {
        Both(f32x4_lt(self.0, b.0), f32x4_lt(self.1, b.1))
    }
    #[inline(always)]
    fn select(mask: Both, a: Self, b: Self) -> Self {
        Self(v128_bitselect(a.0, b.0, mask.0), v128_bitselect(a.1, b.1, mask.1))
    }
}

/// What comparing [`Simd128`]s gives: a lane of ones where it holds.
#[derive(Clone, Copy)]
pub(super) struct Both(v128, v128);

impl BitAnd for Both {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, b: Self) -> Self {
        Self(v128_and(self.0, b.0), v128_and(self.1, b.1))
    }
}

impl BitOr for Both {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, b: Self) -> Self {
        Self(v128_or(self.0, b.0), v128_or(self.1, b.1))
    }
}

impl Mask for Both {
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(i32x4_bitmask(self.0)) | (u32::from(i32x4_bitmask(self.1)) << 4)
    }
}
