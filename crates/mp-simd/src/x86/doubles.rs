//! Eight `f64` in one register of 512 bits, or in two of 256.

use crate::wide::{Doubles, LANES, Wide, WideKernel};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
pub(crate) fn avx512<K: WideKernel>(kernel: K) -> K::Output {
    kernel.run::<One>()
}
#[target_feature(enable = "avx2,fma")]
pub(crate) fn avx2<K: WideKernel>(kernel: K) -> K::Output {
    kernel.run::<Two>()
}

/// One register. SAFETY of every block below that names it: it is only ever used inside [`avx512`], which is entered only on a CPU that has
/// these features.
#[derive(Clone, Copy)]
pub(super) struct One([__m512d; 1]);

/// Two registers. SAFETY of every block below that names it: as that of [`One`], inside [`avx2`].
#[derive(Clone, Copy)]
pub(super) struct Two([__m256d; 2]);

/// An operation of two vectors, register by register.
macro_rules! operation {
    ($name:ident: $trait:ident $method:ident $with:ident, $($k:literal)+) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                // SAFETY: see the type.
                unsafe { Self([$($with(self.0[$k], b.0[$k])),+]) }
            }
        }
    };
    ($name:ident: $trait:ident<f64> $method:ident) => {
        impl $trait<f64> for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: f64) -> Self {
                self.$method(Self::splat(b))
            }
        }
    };
}

/// What needs one intrinsic for each register.
macro_rules! doubles {
    (
        $name:ident: $($k:literal)+ of $width:literal;
        $load:ident $store:ident $splat:ident $add:ident $sub:ident $mul:ident $div:ident $sqrt:ident $min:ident $max:ident;
        $a:ident $b:ident $x:ident $y:ident; $abs:expr, $less:expr, $where_less:expr; $all:ident $halves:expr
    ) => {
        operation!($name: Add add $add, $($k)+);
        operation!($name: Sub sub $sub, $($k)+);
        operation!($name: Mul mul $mul, $($k)+);
        operation!($name: Div div $div, $($k)+);
        operation!($name: Add<f64> add);
        operation!($name: Sub<f64> sub);
        operation!($name: Mul<f64> mul);

        impl Doubles for $name {
            #[inline(always)]
            fn load(all: &Wide) -> Self {
                // SAFETY: see the type; the numbers loaded are those of the array.
                unsafe { Self([$($load(all.0.as_ptr().add($k * $width))),+]) }
            }
            #[inline(always)]
            fn store(self) -> Wide {
                let mut all = Wide::splat(0.0);
                // SAFETY: see the type; the numbers stored are those of the array.
                unsafe { $($store(all.0.as_mut_ptr().add($k * $width), self.0[$k]);)+ }
                all
            }
            #[inline(always)]
            fn splat(x: f64) -> Self {
                // SAFETY: see the type.
                unsafe { Self([$splat(x); LANES / $width]) }
            }
            #[inline(always)]
            fn min(self, b: Self) -> Self {
                // SAFETY: see the type.
                unsafe { Self([$($min(self.0[$k], b.0[$k])),+]) }
            }
            #[inline(always)]
            fn max(self, b: Self) -> Self {
                // SAFETY: see the type.
                unsafe { Self([$($max(self.0[$k], b.0[$k])),+]) }
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: see the type.
                unsafe { Self([$($sqrt(self.0[$k])),+]) }
            }
            #[inline(always)]
            fn abs(self) -> Self {
                // SAFETY: see the type.
                unsafe {
                    Self([$({
                        let $a = self.0[$k];
                        $abs
                    }),+])
                }
            }
            #[inline(always)]
            fn less(self, b: Self) -> u32 {
                // SAFETY: see the type.
                unsafe {
                    let mut bits = 0;
                    $({
                        let ($a, $b) = (self.0[$k], b.0[$k]);
                        bits |= $less << ($k * $width);
                    })+
                    bits
                }
            }
            #[inline(always)]
            fn where_less(self, b: Self, x: Self, y: Self) -> Self {
                // SAFETY: see the type.
                unsafe {
                    Self([$({
                        let ($a, $b, $x, $y) = (self.0[$k], b.0[$k], x.0[$k], y.0[$k]);
                        $where_less
                    }),+])
                }
            }
            #[inline(always)]
            fn range(self) -> [f64; 2] {
                // SAFETY: see the type.
                unsafe {
                    let $all = self.0;
                    let [low, high] = $halves;
                    range(_mm256_min_pd(low, high), _mm256_max_pd(low, high))
                }
            }
        }
    };
}

/// The least of four numbers, and the greatest of four.
///
/// # Safety
///
/// As for [`Two`].
#[inline(always)]
unsafe fn range(low: __m256d, high: __m256d) -> [f64; 2] {
    // SAFETY: asked of the caller.
    unsafe {
        let low = _mm_min_pd(_mm256_castpd256_pd128(low), _mm256_extractf128_pd::<1>(low));
        let high = _mm_max_pd(_mm256_castpd256_pd128(high), _mm256_extractf128_pd::<1>(high));
        let least = _mm_min_pd(low, _mm_unpackhi_pd(low, low));
        let greatest = _mm_max_pd(high, _mm_unpackhi_pd(high, high));
        [_mm_cvtsd_f64(least), _mm_cvtsd_f64(greatest)]
    }
}

doubles!(
    One: 0 of 8;
    _mm512_loadu_pd _mm512_storeu_pd _mm512_set1_pd _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_sqrt_pd _mm512_min_pd
        _mm512_max_pd;
    a b x y;
    _mm512_abs_pd(a),
    u32::from(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b)),
    _mm512_mask_blend_pd(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b), y, x);
    all [_mm512_castpd512_pd256(all[0]), _mm512_extractf64x4_pd::<1>(all[0])]
);

doubles!(
    Two: 0 1 of 4;
    _mm256_loadu_pd _mm256_storeu_pd _mm256_set1_pd _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_sqrt_pd _mm256_min_pd
        _mm256_max_pd;
    a b x y;
    _mm256_andnot_pd(_mm256_set1_pd(-0.0), a),
    _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(a, b)).cast_unsigned(),
    _mm256_blendv_pd(y, x, _mm256_cmp_pd::<_CMP_LT_OQ>(a, b));
    all all
);
