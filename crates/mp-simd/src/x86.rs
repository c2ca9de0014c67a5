//! 256-bit registers, and 128-bit ones two at a time.

pub(super) mod doubles;

use super::{Kernel, Lanes, Mask};
use std::arch::x86_64::*;
use std::ops::{BitAnd, BitOr};

#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
pub(super) fn avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2>()
}
#[target_feature(enable = "avx2,fma")]
pub(super) fn avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2>()
}

/// SAFETY of every block below: `Avx2` is only ever used as the lanes of a kernel inside
/// [`avx2`] or [`avx512`], which are entered only on a CPU that has these features; loads and
/// stores are unaligned and within the referenced array.
#[derive(Clone, Copy)]
pub(super) struct Avx2(__m256);

impl Lanes for Avx2 {
    type Mask = Avx2Mask;
    #[inline(always)]
    fn load(a: &[f32; 8]) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_loadu_ps(a.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, a: &mut [f32; 8]) {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_storeu_ps(a.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_set1_ps(x) })
    }
    #[inline(always)]
    fn twice(a: &[f32; 4]) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_broadcast_ps(&_mm_loadu_ps(a.as_ptr())) })
    }
    #[inline(always)]
    fn halves(low: f32, high: f32) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_set_m128(_mm_set1_ps(high), _mm_set1_ps(low)) })
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_add_ps(self.0, b.0) })
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_sub_ps(self.0, b.0) })
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_mul_ps(self.0, b.0) })
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_div_ps(self.0, b.0) })
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_fmadd_ps(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_fmsub_ps(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_sqrt_ps(self.0) })
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_min_ps(self.0, b.0) })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_max_ps(self.0, b.0) })
    }
    #[inline(always)]
    fn le(self, b: Self) -> Avx2Mask {
        // SAFETY: see `Avx2`.
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, b.0) })
    }
    #[inline(always)]
    fn lt(self, b: Self) -> Avx2Mask {
        // SAFETY: see `Avx2`.
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, b.0) })
    }
    #[inline(always)]
    fn select(mask: Avx2Mask, a: Self, b: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_blendv_ps(b.0, a.0, mask.0) })
    }
}

/// What comparing [`Avx2`]s gives: all bits of a lane or none.
#[derive(Clone, Copy)]
pub(super) struct Avx2Mask(__m256);

impl BitAnd for Avx2Mask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, b: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_and_ps(self.0, b.0) })
    }
}

impl BitOr for Avx2Mask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, b: Self) -> Self {
        // SAFETY: see `Avx2`.
        Self(unsafe { _mm256_or_ps(self.0, b.0) })
    }
}

impl Mask for Avx2Mask {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_movemask_ps(self.0) }.cast_unsigned()
    }
}

/// SAFETY of every block below: SSE2 is part of every x86-64.
#[derive(Clone, Copy)]
pub(super) struct Sse2(__m128, __m128);

impl Lanes for Sse2 {
    type Mask = Sse2Mask;
    #[inline(always)]
    fn load(a: &[f32; 8]) -> Self {
        // SAFETY: unaligned loads of floats 0..4 and 4..8 of the array.
        unsafe { Self(_mm_loadu_ps(a.as_ptr()), _mm_loadu_ps(a.as_ptr().add(4))) }
    }
    #[inline(always)]
    fn store(self, a: &mut [f32; 8]) {
        // SAFETY: unaligned stores to floats 0..4 and 4..8 of the array.
        unsafe {
            _mm_storeu_ps(a.as_mut_ptr(), self.0);
            _mm_storeu_ps(a.as_mut_ptr().add(4), self.1);
        }
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see `Sse2`.
        let v = unsafe { _mm_set1_ps(x) };
        Self(v, v)
    }
    #[inline(always)]
    fn twice(a: &[f32; 4]) -> Self {
        // SAFETY: an unaligned load of the array.
        let v = unsafe { _mm_loadu_ps(a.as_ptr()) };
        Self(v, v)
    }
    #[inline(always)]
    fn halves(low: f32, high: f32) -> Self {
        // SAFETY: see `Sse2`.
        unsafe { Self(_mm_set1_ps(low), _mm_set1_ps(high)) }
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe { Self(_mm_add_ps(self.0, b.0), _mm_add_ps(self.1, b.1)) }
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe { Self(_mm_sub_ps(self.0, b.0), _mm_sub_ps(self.1, b.1)) }
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe { Self(_mm_mul_ps(self.0, b.0), _mm_mul_ps(self.1, b.1)) }
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe { Self(_mm_div_ps(self.0, b.0), _mm_div_ps(self.1, b.1)) }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe {
            let sign = _mm_set1_ps(-0.0);
            Self(_mm_andnot_ps(sign, self.0), _mm_andnot_ps(sign, self.1))
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe { Self(_mm_sqrt_ps(self.0), _mm_sqrt_ps(self.1)) }
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe { Self(_mm_min_ps(self.0, b.0), _mm_min_ps(self.1, b.1)) }
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe { Self(_mm_max_ps(self.0, b.0), _mm_max_ps(self.1, b.1)) }
    }
    #[inline(always)]
    fn le(self, b: Self) -> Sse2Mask {
        // SAFETY: see `Sse2`.
        unsafe { Sse2Mask(_mm_cmple_ps(self.0, b.0), _mm_cmple_ps(self.1, b.1)) }
    }
    #[inline(always)]
    fn lt(self, b: Self) -> Sse2Mask {
        // SAFETY: see `Sse2`.
        unsafe { Sse2Mask(_mm_cmplt_ps(self.0, b.0), _mm_cmplt_ps(self.1, b.1)) }
    }
    #[inline(always)]
    fn select(mask: Sse2Mask, a: Self, b: Self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe {
            let either = |m, a, b| _mm_or_ps(_mm_and_ps(m, a), _mm_andnot_ps(m, b));
            Self(either(mask.0, a.0, b.0), either(mask.1, a.1, b.1))
        }
    }
}

/// What comparing [`Sse2`]s gives: all bits of a lane or none.
#[derive(Clone, Copy)]
pub(super) struct Sse2Mask(__m128, __m128);

impl BitAnd for Sse2Mask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, b: Self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe { Self(_mm_and_ps(self.0, b.0), _mm_and_ps(self.1, b.1)) }
    }
}

impl BitOr for Sse2Mask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, b: Self) -> Self {
        // SAFETY: see `Sse2`.
        unsafe { Self(_mm_or_ps(self.0, b.0), _mm_or_ps(self.1, b.1)) }
    }
}

impl Mask for Sse2Mask {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see `Sse2`.
        let (lo, hi) = unsafe { (_mm_movemask_ps(self.0), _mm_movemask_ps(self.1)) };
        (lo | (hi << 4)).cast_unsigned()
    }
}
