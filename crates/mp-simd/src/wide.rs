//! Eight places at a time in `f64`: balls around links at eight states of a motion, against bodies and against each other.
//!
//! Each lane is computed by additions, multiplications, divisions and square roots as IEEE 754 has them, never fused, so it has the same
//! bits on every processor.
//!
//! A [`Wide`] is eight numbers in memory. A [`WideKernel`] loads them into registers, [`Doubles`], of which it does not name the kind.

use crate::{Isa, run_wide};
use std::ops::{Add, Div, Mul, Sub};

/// How many numbers a [`Wide`] has.
pub const LANES: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Wide(pub [f64; LANES]);

/// Eight numbers that a kernel computes with: in registers, or as an array of which the compiler makes what it can.
pub trait Doubles:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// Eight numbers from memory.
    fn load(all: &Wide) -> Self;
    /// Eight numbers for the memory.
    fn store(self) -> Wide;
    /// The same number eight times.
    fn splat(x: f64) -> Self;
    /// The lesser of each lane; `b` where they cannot be compared.
    fn min(self, b: Self) -> Self;
    /// The greater of each lane; `b` where they cannot be compared.
    fn max(self, b: Self) -> Self;
    /// Absolute values.
    fn abs(self) -> Self;
    /// Square roots.
    fn sqrt(self) -> Self;
    /// Bit `i` is set where lane `i` is less than that of `b`; not where they cannot be compared.
    fn less(self, b: Self) -> u32;
    /// In each lane `x` where this is less than `b`, else `y`.
    fn where_less(self, b: Self, x: Self, y: Self) -> Self;
    /// The least and the greatest; anything where one is no number.
    fn range(self) -> [f64; 2];

    /// The greatest absolute value; not a number if any is none.
    #[inline(always)]
    fn largest(self) -> f64 {
        let all = self.abs();
        let are_finite = all.less(Self::splat(f64::INFINITY)) == (1 << LANES) - 1;
        if are_finite { all.range()[1] } else { largest_of_any(&all.store()) }
    }
}

/// The greatest of absolute values, some of which are infinite or no number.
#[cold]
#[inline(never)]
fn largest_of_any(all: &Wide) -> f64 {
    if all.0.iter().any(|x| x.is_nan()) { f64::NAN } else { f64::INFINITY }
}

/// A computation on eight numbers. `run` and all it calls are to be `#[inline(always)]`, so that they are compiled for the processor's
/// widest instructions. No [`Doubles`] are given to closures, as by `map` of an array: these are functions of their own.
pub trait WideKernel {
    /// What it computes.
    type Output;
    /// Computes it.
    fn run<D: Doubles>(self) -> Self::Output;
}

/// Runs `kernel` with the widest instructions of the processor. The results are the same on all.
#[inline]
pub fn on_widest<K: WideKernel>(kernel: K) -> K::Output {
    run_wide(Isa::detect(), kernel)
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

pub use sin_cos::sin_cos;

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
}

impl Doubles for Wide {
    #[inline(always)]
    fn load(all: &Self) -> Self {
        *all
    }
    #[inline(always)]
    fn store(self) -> Self {
        self
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; LANES])
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        lanes!(i => if self.0[i] < b.0[i] { self.0[i] } else { b.0[i] })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        lanes!(i => if self.0[i] > b.0[i] { self.0[i] } else { b.0[i] })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        lanes!(i => self.0[i].abs())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        lanes!(i => self.0[i].sqrt())
    }
    #[inline(always)]
    fn less(self, b: Self) -> u32 {
        let (mut bits, mut i) = (0, 0);
        while i < LANES {
            bits |= u32::from(self.0[i] < b.0[i]) << i;
            i += 1;
        }
        bits
    }
    #[inline(always)]
    fn where_less(self, b: Self, x: Self, y: Self) -> Self {
        lanes!(i => if self.0[i] < b.0[i] { x.0[i] } else { y.0[i] })
    }
    #[inline(always)]
    fn range(self) -> [f64; 2] {
        [halved!(self.0, <), halved!(self.0, >)]
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

/// Eight points or vectors.
pub type Wide3 = [Wide; 3];

/// Three times eight numbers from memory.
#[inline(always)]
#[must_use]
pub fn load3<D: Doubles>(all: &Wide3) -> [D; 3] {
    [D::load(&all[0]), D::load(&all[1]), D::load(&all[2])]
}

/// Three times eight numbers for the memory.
#[inline(always)]
#[must_use]
pub fn store3<D: Doubles>([x, y, z]: [D; 3]) -> Wide3 {
    [x.store(), y.store(), z.store()]
}

/// The scalar product.
#[inline(always)]
#[must_use]
pub fn dot<D: Doubles>(a: &[D; 3], b: &[D; 3]) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
#[inline(always)]
#[must_use]
pub fn cross<D: Doubles>(a: &[D; 3], b: &[D; 3]) -> [D; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a − b`.
#[inline(always)]
#[must_use]
pub fn sub<D: Doubles>(a: &[D; 3], b: &[D; 3]) -> [D; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + times · b`.
#[inline(always)]
#[must_use]
pub fn add<D: Doubles>(a: &[D; 3], b: &[D; 3], times: f64) -> [D; 3] {
    [a[0] + b[0] * times, a[1] + b[1] * times, a[2] + b[2] * times]
}

/// Eight poses: the rows of the rotation matrices, and the origins.
#[derive(Clone, Copy, Debug)]
pub struct Frames<D> {
    /// The rows of the rotation matrices.
    pub turn: [[D; 3]; 3],
    /// The origins of the frames.
    pub origin: [D; 3],
}

/// Eight poses in memory.
pub type WideFrame = Frames<Wide>;

impl<D: Doubles> Frames<D> {
    /// Eight poses from memory.
    #[inline(always)]
    #[must_use]
    pub fn load(all: &WideFrame) -> Self {
        let [a, b, c] = &all.turn;
        Self { turn: [load3(a), load3(b), load3(c)], origin: load3(&all.origin) }
    }

    /// Eight poses for the memory.
    #[inline(always)]
    #[must_use]
    pub fn store(self) -> WideFrame {
        let [a, b, c] = self.turn;
        WideFrame { turn: [store3(a), store3(b), store3(c)], origin: store3(self.origin) }
    }

    /// Where it carries the point `p`.
    #[inline(always)]
    #[must_use]
    pub fn point(&self, p: &[f64; 3]) -> [D; 3] {
        let [x, y, z] = self.vector(p);
        [x + self.origin[0], y + self.origin[1], z + self.origin[2]]
    }

    /// Where it carries the vector `v`.
    #[inline(always)]
    #[must_use]
    pub fn vector(&self, v: &[f64; 3]) -> [D; 3] {
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
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// All operations, chained.
    struct All([Wide; 12]);

    impl WideKernel for All {
        type Output = ([Wide3; 3], [u32; 2], [f64; 3]);
        #[inline(always)]
        fn run<D: Doubles>(self) -> Self::Output {
            let [a, b, c, d, e, f, g, h, i, x, y, z] = self.0;
            let stored = WideFrame { turn: [[a, b, c], [d, e, f], [g, h, i]], origin: [x, y, z] };
            let frame = Frames::<D>::load(&stored);
            let p = frame.point(&[0.3, -1.7, 11.1]);
            let q = cross(&p, &frame.vector(&[3.7, 0.1, -0.9]));
            let a = D::load(&a);
            let r = [dot(&p, &q).abs().sqrt(), (q[1] * 1.1).min(p[0]).max(a + 0.7), p[2] - 0.3];
            let s = p[1].where_less(q[1], r[0] / q[2], add(&p, &q, 0.1)[2]);
            let [least, most] = s.range();
            let vectors = [p, [q[0], s, q[2]], sub(&q, &r)].map(store3);
            (vectors, [p[0].less(q[0]), s.less(D::splat(0.0))], [r[0].largest(), least, most])
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
            let bits = |(vectors, less, numbers): ([Wide3; 3], [u32; 2], [f64; 3])| {
                (vectors.map(|v| v.map(|x| x.0.map(f64::to_bits))), less, numbers.map(f64::to_bits))
            };
            let expected = bits(All(numbers).run::<Wide>());
            for isa in Isa::available() {
                assert_eq!(bits(run_wide(isa, All(numbers))), expected, "{isa:?}");
            }
            let one = bits(All(numbers.map(|x| Wide::splat(x.0[5]))).run::<Wide>());
            for (all, one) in expected.0.iter().flatten().zip(one.0.iter().flatten()) {
                assert_eq!(all[5], one[0]);
            }
        }
    }

    /// Of two times eight numbers: those that are less, the lesser, the greater, those taken where less, the absolute values, the largest.
    struct Compared(Wide, Wide);

    impl WideKernel for Compared {
        type Output = (u32, [Wide; 4], f64);
        #[inline(always)]
        fn run<D: Doubles>(self) -> Self::Output {
            let (a, b) = (D::load(&self.0), D::load(&self.1));
            let all = [a.min(b), a.max(b), a.where_less(b, a, D::splat(7.0)), a.abs()];
            (a.less(b), all.map(D::store), a.largest())
        }
    }

    #[test]
    fn what_cannot_be_compared_is_not_less() {
        let (nan, one) = (Wide::splat(f64::NAN), Wide::splat(1.0));
        for isa in Isa::available() {
            for (a, b) in [(nan, one), (one, nan)] {
                let (less, [min, max, taken, _], largest) = run_wide(isa, Compared(a, b));
                assert_eq!((less, taken.0), (0, [7.0; LANES]), "{isa:?}");
                for (found, b) in min.0.iter().chain(&max.0).zip(b.0.iter().cycle()) {
                    assert_eq!(found.is_nan(), b.is_nan(), "{isa:?}");
                }
                assert_eq!(largest.is_nan(), a.0[0].is_nan(), "{isa:?}");
            }
            for k in 0..LANES {
                let one = Wide(std::array::from_fn(|i| if i == k { f64::NAN } else { -3.0 }));
                assert!(run_wide(isa, Compared(one, one)).2.is_nan(), "{isa:?}");
            }
            let all = Wide([1.0, -4.0, 3.0, 0.0, -0.0, 2.0, 0.0, -1.0]);
            let (less, [min, max, taken, abs], largest) = run_wide(isa, Compared(all, Wide::splat(0.0)));
            assert_eq!((less, largest), (0b1000_0010, 4.0), "{isa:?}");
            assert_eq!(min.0, [0.0, -4.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0]);
            assert_eq!(max.0, [1.0, 0.0, 3.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
            assert_eq!(taken.0, [7.0, -4.0, 7.0, 7.0, 7.0, 7.0, 7.0, -1.0]);
            let bits = [1.0, 4.0, 3.0, 0.0, 0.0, 2.0, 0.0, 1.0].map(f64::to_bits);
            assert_eq!(abs.0.map(f64::to_bits), bits);
            let infinite = Wide([1.0, f64::NEG_INFINITY, 3.0, 0.0, 0.0, 2.0, 0.0, -1.0]);
            assert_eq!(run_wide(isa, Compared(infinite, all)).2, f64::INFINITY);
        }
        let all = Wide([1.0, -4.0, 3.0, 0.0, 0.0, 2.0, 0.0, -1.0]);
        assert_eq!((all.largest(), all.range()), (4.0, [-4.0, 3.0]));
    }
}
