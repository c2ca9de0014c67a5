//! 128-bit registers of ARM, two at a time.

use super::{Lanes, Mask};
use std::arch::aarch64::*;
use std::ops::{BitAnd, BitOr};

/// NEON is part of every aarch64, so its intrinsics need no detection.
#[derive(Clone, Copy)]
pub(super) struct Neon(float32x4_t, float32x4_t);

impl Lanes for Neon {
    type Mask = NeonMask;
    #[inline(always)]
    fn load(a: &[f32; 8]) -> Self {
        // SAFETY: loads of floats 0..4 and 4..8 of the array.
        unsafe { Self(vld1q_f32(a.as_ptr()), vld1q_f32(a.as_ptr().add(4))) }
    }
    #[inline(always)]
    fn store(self, a: &mut [f32; 8]) {
        // SAFETY: stores to floats 0..4 and 4..8 of the array.
        unsafe {
            vst1q_f32(a.as_mut_ptr(), self.0);
            vst1q_f32(a.as_mut_ptr().add(4), self.1);
        }
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: NEON is part of aarch64 (so for every block below).
        let v = unsafe { vdupq_n_f32(x) };
        Self(v, v)
    }
    #[inline(always)]
    fn twice(a: &[f32; 4]) -> Self {
        // SAFETY: a load of the array.
        let v = unsafe { vld1q_f32(a.as_ptr()) };
        Self(v, v)
    }
    #[inline(always)]
    fn halves(low: f32, high: f32) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vdupq_n_f32(low), vdupq_n_f32(high)) }
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vaddq_f32(self.0, b.0), vaddq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vsubq_f32(self.0, b.0), vsubq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vmulq_f32(self.0, b.0), vmulq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vdivq_f32(self.0, b.0), vdivq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vfmaq_f32(c.0, self.0, b.0), vfmaq_f32(c.1, self.1, b.1)) }
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vfmaq_f32(vnegq_f32(c.0), self.0, b.0), vfmaq_f32(vnegq_f32(c.1), self.1, b.1)) }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vabsq_f32(self.0), vabsq_f32(self.1)) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vsqrtq_f32(self.0), vsqrtq_f32(self.1)) }
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe {
            Self(
                vbslq_f32(vcltq_f32(self.0, b.0), self.0, b.0),
                vbslq_f32(vcltq_f32(self.1, b.1), self.1, b.1),
            )
        }
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe {
            Self(
                vbslq_f32(vcgtq_f32(self.0, b.0), self.0, b.0),
                vbslq_f32(vcgtq_f32(self.1, b.1), self.1, b.1),
            )
        }
    }
    #[inline(always)]
    fn le(self, b: Self) -> NeonMask {
        // SAFETY: see `splat`.
        unsafe { NeonMask(vcleq_f32(self.0, b.0), vcleq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    fn lt(self, b: Self) -> NeonMask {
        // SAFETY: see `splat`.
        unsafe { NeonMask(vcltq_f32(self.0, b.0), vcltq_f32(self.1, b.1)) }
    }
    #[inline(always)]
    fn select(mask: NeonMask, a: Self, b: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vbslq_f32(mask.0, a.0, b.0), vbslq_f32(mask.1, a.1, b.1)) }
    }
}

/// What comparing [`Neon`]s gives: all bits of a lane or none.
#[derive(Clone, Copy)]
pub(super) struct NeonMask(uint32x4_t, uint32x4_t);

impl BitAnd for NeonMask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, b: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vandq_u32(self.0, b.0), vandq_u32(self.1, b.1)) }
    }
}

impl BitOr for NeonMask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, b: Self) -> Self {
        // SAFETY: see `splat`.
        unsafe { Self(vorrq_u32(self.0, b.0), vorrq_u32(self.1, b.1)) }
    }
}

impl Mask for NeonMask {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see `splat`; each lane of the mask keeps one bit of its own.
        unsafe {
            let bits = vld1q_u32([1, 2, 4, 8].as_ptr());
            vaddvq_u32(vandq_u32(self.0, bits)) | (vaddvq_u32(vandq_u32(self.1, bits)) << 4)
        }
    }
}
