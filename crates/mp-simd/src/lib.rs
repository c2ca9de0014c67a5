//! Eight numbers at a time on every CPU.
//!
//! - A [`Kernel`] computes with eight `f32`. It is generic over [`Lanes`] and never names an instruction set: [`run`] compiles it for
//!   each of them, and runs it on the one that is asked for, [`Isa::detect`] for the widest the CPU has. Where the CPU has fused
//!   multiply-add, [`Lanes::mul_add`] rounds once, so the last bits differ from one instruction set to another: kernels bound the error.
//! - [`wide`] has eight `f64`, never fused: the same bits on every CPU.
//!
//! The eight lanes are one register of 256 bits (AVX2, AVX-512) or two of 128 (SSE2, NEON, WebAssembly); those of [`wide`] take twice as much.
//! `Isa::Scalar`, plain arrays, is the twin the others are tested against.
//!
//! ```
//! use mp_simd::{Isa, Kernel, Lanes, run};
//!
//! /// The lengths of eight vectors in the plane.
//! struct Lengths<'a>(&'a [f32; 8], &'a [f32; 8]);
//!
//! impl Kernel for Lengths<'_> {
//!     type Output = [f32; 8];
//!     #[inline(always)]
//!     fn run<L: Lanes>(self) -> [f32; 8] {
//!         let (x, y) = (L::load(self.0), L::load(self.1));
//!         let mut out = [0.0; 8];
//!         x.square().add(y.square()).sqrt().store(&mut out);
//!         out
//!     }
//! }
//!
//! assert_eq!(run(Isa::detect(), Lengths(&[3.0; 8], &[4.0; 8])), [5.0; 8]);
//! ```
#![allow(unsafe_code)] // Intrinsics and `#[target_feature]` calls; each block says why it is sound.

#[cfg(target_arch = "aarch64")]
mod arm;
#[cfg(any(
    feature = "scalar",
    not(any(
        target_arch = "x86_64",
        target_arch = "aarch64",
        all(target_arch = "wasm32", target_feature = "simd128")
    ))
))]
mod scalar;
#[cfg(all(not(feature = "scalar"), target_arch = "wasm32", target_feature = "simd128"))]
mod wasm;
#[cfg(target_arch = "x86_64")]
mod x86;

pub mod wide;

use std::ops::{BitAnd, BitOr};
use wide::{Wide, WideKernel};

/// The lanes that every CPU of this architecture has, with vectors where there are any.
#[cfg(all(not(feature = "scalar"), target_arch = "aarch64"))]
use arm::Neon as Scalar;
#[cfg(any(
    feature = "scalar",
    not(any(
        target_arch = "x86_64",
        target_arch = "aarch64",
        all(target_arch = "wasm32", target_feature = "simd128")
    ))
))]
use scalar::Scalar;
#[cfg(all(not(feature = "scalar"), target_arch = "wasm32", target_feature = "simd128"))]
use wasm::Simd128 as Scalar;
#[cfg(all(not(feature = "scalar"), target_arch = "x86_64"))]
use x86::Sse2 as Scalar;

/// An instruction set a kernel can run on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Isa {
    /// Plain arrays, on any CPU. On x86-64, aarch64 and WebAssembly with SIMD compiled only with the feature `scalar`; without
    /// that feature this is the set of vectors that each of them has at least, with the same answers.
    Scalar,
    /// Two 128-bit registers (every x86-64).
    Sse2,
    /// One 256-bit register with fused multiply-add.
    Avx2,
    /// As AVX2 with the 32 registers and mask registers of AVX-512VL.
    Avx512,
    /// Two 128-bit registers (every aarch64).
    Neon,
}

impl Isa {
    /// The widest this CPU has.
    #[must_use]
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
            {
                return Self::Avx512;
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                return Self::Avx2;
            }
            Self::Sse2
        }
        #[cfg(target_arch = "aarch64")]
        {
            Self::Neon
        }
        #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
        {
            Self::Scalar
        }
    }

    /// Every instruction set this CPU has, scalar first where it is compiled.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let plain = cfg!(any(feature = "scalar", not(any(target_arch = "x86_64", target_arch = "aarch64"))));
        let mut all: Vec<Self> = plain.then_some(Self::Scalar).into_iter().collect();
        match Self::detect() {
            Self::Scalar => {}
            Self::Sse2 => all.push(Self::Sse2),
            Self::Avx2 => all.extend([Self::Sse2, Self::Avx2]),
            Self::Avx512 => all.extend([Self::Sse2, Self::Avx2, Self::Avx512]),
            Self::Neon => all.push(Self::Neon),
        }
        all
    }
}

/// The result of a comparison in eight lanes.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> {
    /// Bit `i` is set where the comparison holds in lane `i`.
    fn bits(self) -> u32;
}

/// Eight lanes of `f32`. A NaN compares false.
pub trait Lanes: Copy {
    /// The result of a comparison.
    type Mask: Mask;
    /// The numbers of an array, the first in lane 0.
    fn load(a: &[f32; 8]) -> Self;
    /// Writes the lanes to an array, lane 0 first.
    fn store(self, a: &mut [f32; 8]);
    /// The same number eight times.
    fn splat(x: f32) -> Self;
    /// Four values in the lower lanes and again in the upper.
    fn twice(a: &[f32; 4]) -> Self;
    /// One value in the four lower lanes, another in the upper.
    fn halves(low: f32, high: f32) -> Self;
    /// `self + b`.
    fn add(self, b: Self) -> Self;
    /// `self − b`.
    fn sub(self, b: Self) -> Self;
    /// `self · b`.
    fn mul(self, b: Self) -> Self;
    /// `self / b`.
    fn div(self, b: Self) -> Self;
    /// `self · b + c`, fused where the CPU can.
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self.mul(b).add(c)
    }
    /// `self · b − c`, fused where the CPU can.
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul(b).sub(c)
    }
    /// Absolute values.
    fn abs(self) -> Self;
    /// Square roots.
    fn sqrt(self) -> Self;
    /// `self · self`.
    #[inline(always)]
    fn square(self) -> Self {
        self.mul(self)
    }
    /// The lesser; `b` where they cannot be compared.
    fn min(self, b: Self) -> Self;
    /// The greater; `b` where they cannot be compared.
    fn max(self, b: Self) -> Self;
    /// Where `self` ≤ `b`.
    fn le(self, b: Self) -> Self::Mask;
    /// Where `self` < `b`.
    fn lt(self, b: Self) -> Self::Mask;
    /// The lanes of `a` where `mask` holds, those of `b` elsewhere.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
}

/// A computation generic over the lanes. Its `run` and all that this calls must be `#[inline(always)]`: only then is it compiled for the
/// instruction set it runs on. The result is right without, but slow.
pub trait Kernel {
    /// What it computes.
    type Output;
    /// Computes it.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Runs `kernel` on `isa`, or on plain arrays where this CPU lacks it.
#[inline]
pub fn run<K: Kernel>(isa: Isa, kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    match isa {
        // SAFETY: `supported` has just said that the CPU has the features the function enables.
        Isa::Avx512 if supported(isa) => return unsafe { x86::avx512(kernel) },
        // SAFETY: as above.
        Isa::Avx2 if supported(isa) => return unsafe { x86::avx2(kernel) },
        #[cfg(feature = "scalar")]
        Isa::Sse2 => return kernel.run::<x86::Sse2>(),
        _ => {}
    }
    #[cfg(all(feature = "scalar", target_arch = "aarch64"))]
    if isa == Isa::Neon {
        return kernel.run::<arm::Neon>();
    }
    // On other processors there is nothing to choose from.
    #[cfg(not(any(target_arch = "x86_64", all(feature = "scalar", target_arch = "aarch64"))))]
    let _ = isa;
    kernel.run::<Scalar>()
}

/// Runs a kernel of eight `f64` on `isa`, or on arrays where there are no registers for it.
#[inline]
fn run_wide<K: WideKernel>(isa: Isa, kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    match isa {
        // SAFETY: `supported` has just said that the CPU has the features the function enables.
        Isa::Avx512 if supported(isa) => return unsafe { x86::doubles::avx512(kernel) },
        // SAFETY: as above.
        Isa::Avx2 if supported(isa) => return unsafe { x86::doubles::avx2(kernel) },
        _ => {}
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = isa;
    kernel.run::<Wide>()
}

/// Whether this CPU has `isa` (the standard library caches the answer).
#[cfg(target_arch = "x86_64")]
#[inline]
fn supported(isa: Isa) -> bool {
    let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
    match isa {
        Isa::Avx512 => avx2 && is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl"),
        Isa::Avx2 => avx2,
        _ => true,
    }
}

/// Asks the CPU to fetch the `size_of::<T>()` bytes at `item` into its cache.
#[inline(always)]
pub fn prefetch<T>(item: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let p = std::ptr::from_ref(item).cast::<i8>();
        let mut at = 0;
        while at < size_of::<T>() {
            // SAFETY: a prefetch is a hint that never faults; the address is inside `item`.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(p.add(at)) };
            at += 64;
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = item;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation on one pair of vectors and a third: the bits of the results, and the comparison.
    struct Each([[f32; 8]; 3]);

    impl Kernel for Each {
        type Output = (Vec<[f32; 8]>, [u32; 4]);
        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let [a, b, c] = [L::load(&self.0[0]), L::load(&self.0[1]), L::load(&self.0[2])];
            let results = [
                a.add(b),
                a.sub(b),
                a.mul(b),
                a.div(b),
                a.abs(),
                a.sqrt(),
                a.min(b),
                a.max(b),
                a.square(),
                L::select(a.lt(b), a, c),
                L::splat(self.0[0][3]),
                L::twice(&std::array::from_fn(|i| self.0[0][i])),
                L::halves(self.0[0][5], self.0[1][2]),
                c,
            ];
            let mut out = vec![[0.0; 8]; results.len()];
            for (r, o) in results.iter().zip(&mut out) {
                r.store(o);
            }
            (out, [a.le(b), a.lt(b), a.le(b) & b.le(a), a.lt(b) | b.lt(a)].map(|m| m.bits()))
        }
    }

    /// The two fused operations.
    struct Fused([[f32; 8]; 3]);

    impl Kernel for Fused {
        type Output = [[f32; 8]; 2];
        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let [a, b, c] = [L::load(&self.0[0]), L::load(&self.0[1]), L::load(&self.0[2])];
            let mut out = [[0.0; 8]; 2];
            a.mul_add(b, c).store(&mut out[0]);
            a.mul_sub(b, c).store(&mut out[1]);
            out
        }
    }

    fn same(x: f32, y: f32) -> bool {
        x.to_bits() == y.to_bits() || (x.is_nan() && y.is_nan())
    }

    #[test]
    fn every_instruction_set_agrees_with_scalar_lane_by_lane() {
        let special =
            [0.0, -0.0, 1.0, -1.5, f32::MIN_POSITIVE, f32::MAX, f32::INFINITY, f32::NAN, -1e-30, 3e7];
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            if state.is_multiple_of(5) {
                special[(state >> 8) as usize % special.len()]
            } else {
                (state >> 8) as f32 * 1e-4 - 800.0
            }
        };
        for _ in 0..2000 {
            let input: [[f32; 8]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| next()));
            let (expected, mask) = run(Isa::Scalar, Each(input));
            let mut one_register: Option<[[u32; 8]; 2]> = None;
            for isa in Isa::available() {
                let (got, got_mask) = run(isa, Each(input));
                assert_eq!(got_mask, mask, "{isa:?} {input:?}");
                for (g, e) in got.iter().flatten().zip(expected.iter().flatten()) {
                    assert!(same(*g, *e), "{isa:?}: {g} is not {e} for {input:?}");
                }
                let fused = run(isa, Fused(input));
                for lane in 0..8 {
                    let [a, b, c] = [input[0][lane], input[1][lane], input[2][lane]];
                    for (got, c) in [(fused[0][lane], c), (fused[1][lane], -c)] {
                        let both = [a * b + c, a.mul_add(b, c)];
                        assert!(both.iter().any(|x| same(*x, got)), "{isa:?}: {a} · {b} + {c} = {got}");
                    }
                }
                // The same lanes compiled twice: the same bits, with and without AVX-512.
                if let Isa::Avx2 | Isa::Avx512 = isa {
                    let bits = fused.map(|r| r.map(|x| if x.is_nan() { f32::NAN } else { x }.to_bits()));
                    assert_eq!(bits, *one_register.get_or_insert(bits), "{isa:?} {input:?}");
                }
            }
        }
    }
}
