//! Eight places at a time in `f64`: balls around links at eight states of a motion, against bodies and against each other.
//!
//! Each lane is computed by additions, multiplications, divisions and square roots as IEEE 754 has them, never fused, so it has the same
//! bits on every processor.

use crate::{Kernel, Lanes, run_on_widest};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// How many numbers a [`Wide`] has.
pub const LANES: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Wide(pub [f64; LANES]);

/// A computation on [`Wide`] numbers. `run` and all it calls are to be `#[inline(always)]`, so that they are compiled for the processor's
/// widest instructions.
pub trait WideKernel {
    /// What it computes.
    type Output;
    /// Computes it.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Runs `kernel` with the widest instructions of the processor. The results are the same on all.
#[inline]
pub fn on_widest<K: WideKernel>(kernel: K) -> K::Output {
    run_on_widest(AnyLanes(kernel))
}

/// A kernel that compares in lanes, and uses no `f32`.
struct AnyLanes<K>(K);

impl<K: WideKernel> Kernel for AnyLanes<K> {
    type Output = K::Output;
    #[inline(always)]
    fn run<L: Lanes>(self) -> K::Output {
        self.0.run::<L>()
    }
}

macro_rules! lanes {
    ($i:ident => $value:expr) => {{
        let mut out = [0.0; LANES];
        let mut $i = 0;
        while $i < LANES {
            out[$i] = $value;
            $i += 1;
        }
        Wide(out)
    }};
}

mod sin_cos;

/// The first of two by this comparison, the second where they cannot be compared.
macro_rules! first {
    ($before:tt, $x:expr, $y:expr) => {
        if $x $before $y { $x } else { $y }
    };
}

/// The first of eight by this comparison, of which one half is compared with the other, and so on.
macro_rules! halved {
    ($all:expr, $before:tt) => {{
        let [a, b, c, d, e, f, g, h] = $all;
        let (a, b) = (first!($before, a, e), first!($before, b, f));
        let (c, d) = (first!($before, c, g), first!($before, d, h));
        let (a, b) = (first!($before, a, c), first!($before, b, d));
        first!($before, a, b)
    }};
}

impl Wide {
    /// The same number eight times.
    #[inline(always)]
    #[must_use]
    pub const fn splat(x: f64) -> Self {
        Self([x; LANES])
    }

    /// The lesser of each lane; `b` where they cannot be compared.
    #[inline(always)]
    #[must_use]
    pub fn min(self, b: Self) -> Self {
        lanes!(i => if self.0[i] < b.0[i] { self.0[i] } else { b.0[i] })
    }

    /// The greater of each lane; `b` where they cannot be compared.
    #[inline(always)]
    #[must_use]
    pub fn max(self, b: Self) -> Self {
        lanes!(i => if self.0[i] > b.0[i] { self.0[i] } else { b.0[i] })
    }

    /// Absolute values.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        lanes!(i => self.0[i].abs())
    }

    /// Square roots.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        lanes!(i => self.0[i].sqrt())
    }

    /// Bit `i` is set where lane `i` is less than that of `b`; not where they cannot be compared.
    #[inline(always)]
    #[must_use]
    pub fn less<L: Lanes>(self, b: Self) -> u32 {
        L::less(&self.0, &b.0)
    }

    /// In each lane `x` where this is less than `b`, else `y`.
    #[inline(always)]
    #[must_use]
    pub fn where_less(self, b: Self, x: Self, y: Self) -> Self {
        lanes!(i => if self.0[i] < b.0[i] { x.0[i] } else { y.0[i] })
    }

    /// The least and the greatest; anything where one is no number.
    #[inline(always)]
    #[must_use]
    pub fn range(self) -> [f64; 2] {
        [halved!(self.0, <), halved!(self.0, >)]
    }

    /// The greatest absolute value; not a number if any is none.
    #[inline(always)]
    #[must_use]
    pub fn largest(self) -> f64 {
        // As integers they are in the same order, and what is no number is above all.
        let (mut bits, mut i) = ([0; LANES], 0);
        while i < LANES {
            bits[i] = self.0[i].abs().to_bits();
            i += 1;
        }
        f64::from_bits(halved!(bits, >))
    }
}

impl Add for Wide {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        lanes!(i => self.0[i] + b.0[i])
    }
}

impl Sub for Wide {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        lanes!(i => self.0[i] - b.0[i])
    }
}

impl Mul for Wide {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        lanes!(i => self.0[i] * b.0[i])
    }
}

impl Mul<f64> for Wide {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: f64) -> Self {
        lanes!(i => self.0[i] * b)
    }
}

impl Add<f64> for Wide {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: f64) -> Self {
        lanes!(i => self.0[i] + b)
    }
}

impl Sub<f64> for Wide {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: f64) -> Self {
        lanes!(i => self.0[i] - b)
    }
}

impl Div for Wide {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        lanes!(i => self.0[i] / b.0[i])
    }
}

impl Neg for Wide {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        lanes!(i => -self.0[i])
    }
}

/// Eight points or vectors.
pub type Wide3 = [Wide; 3];

/// The scalar product.
#[inline(always)]
#[must_use]
pub fn dot(a: &Wide3, b: &Wide3) -> Wide {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
#[inline(always)]
#[must_use]
pub fn cross(a: &Wide3, b: &Wide3) -> Wide3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a − b`.
#[inline(always)]
#[must_use]
pub fn sub(a: &Wide3, b: &Wide3) -> Wide3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + times · b`.
#[inline(always)]
#[must_use]
pub fn add(a: &Wide3, b: &Wide3, times: f64) -> Wide3 {
    [a[0] + b[0] * times, a[1] + b[1] * times, a[2] + b[2] * times]
}

/// Eight poses: the rows of the rotation matrices, and the origins.
#[derive(Clone, Copy, Debug)]
pub struct WideFrame {
    /// The rows of the rotation matrices.
    pub turn: [Wide3; 3],
    /// The origins of the frames.
    pub origin: Wide3,
}

impl WideFrame {
    /// Where it carries the point `p`.
    #[inline(always)]
    #[must_use]
    pub fn point(&self, p: &[f64; 3]) -> Wide3 {
        let [x, y, z] = self.vector(p);
        [x + self.origin[0], y + self.origin[1], z + self.origin[2]]
    }

    /// Where it carries the vector `v`.
    #[inline(always)]
    #[must_use]
    pub fn vector(&self, v: &[f64; 3]) -> Wide3 {
        let t = &self.turn;
        [
            t[0][0] * v[0] + t[0][1] * v[1] + t[0][2] * v[2],
            t[1][0] * v[0] + t[1][1] * v[1] + t[1][2] * v[2],
            t[2][0] * v[0] + t[2][1] * v[1] + t[2][2] * v[2],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Isa, Scalar, run};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// All operations, chained.
    struct All([Wide; 12]);

    impl WideKernel for All {
        type Output = ([Wide3; 3], u32, f64);
        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let [a, b, c, d, e, f, g, h, i, x, y, z] = self.0;
            let frame = WideFrame { turn: [[a, b, c], [d, e, f], [g, h, i]], origin: [x, y, z] };
            let p = frame.point(&[0.3, -1.7, 11.1]);
            let q = cross(&p, &frame.vector(&[3.7, 0.1, -0.9]));
            let r = [dot(&p, &q).abs().sqrt(), (-q[1] * 1.1).min(p[0]).max(a + 0.7), p[2] - 0.3];
            ([p, q, sub(&q, &r)], p[0].less::<L>(q[0]), r[0].largest())
        }
    }

    /// Lane by lane the same bits with all instruction sets, and as one number at a time.
    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let mut rng = Pcg64::seed_from_u64(3);
        for _ in 0..1000 {
            let numbers = std::array::from_fn(|_| {
                Wide(std::array::from_fn(|_| {
                    rng.random_range(-1.0..1.0) * mp_math::powi(10.0, rng.random_range(-9..9))
                }))
            });
            let bits = |(vectors, less, largest): ([Wide3; 3], u32, f64)| {
                (vectors.map(|v| v.map(|x| x.0.map(f64::to_bits))), less, largest.to_bits())
            };
            let expected = bits(All(numbers).run::<Scalar>());
            for isa in Isa::available() {
                assert_eq!(bits(run(isa, AnyLanes(All(numbers)))), expected, "{isa:?}");
            }
            let one = bits(All(numbers.map(|x| Wide::splat(x.0[5]))).run::<Scalar>());
            for (all, one) in expected.0.iter().flatten().zip(one.0.iter().flatten()) {
                assert_eq!(all[5], one[0]);
            }
        }
    }

    struct Less(Wide, Wide);

    impl WideKernel for Less {
        type Output = u32;
        #[inline(always)]
        fn run<L: Lanes>(self) -> u32 {
            self.0.less::<L>(self.1)
        }
    }

    #[test]
    fn what_cannot_be_compared_is_not_less() {
        let nan = Wide::splat(f64::NAN);
        for isa in Isa::available() {
            assert_eq!(run(isa, AnyLanes(Less(nan, Wide::splat(1.0)))), 0);
            assert_eq!(run(isa, AnyLanes(Less(Wide::splat(1.0), nan))), 0);
        }
        for k in 0..LANES {
            let one = Wide(std::array::from_fn(|i| if i == k { f64::NAN } else { -3.0 }));
            assert!(one.largest().is_nan());
        }
        let all = Wide([1.0, -4.0, 3.0, 0.0, 0.0, 2.0, 0.0, -1.0]);
        assert_eq!((all.largest(), all.range()), (4.0, [-4.0, 3.0]));
        assert_eq!(nan.min(Wide::splat(1.0)).0, [1.0; LANES]);
    }
}
