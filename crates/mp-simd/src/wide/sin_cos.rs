//! Sines and cosines of eight angles, with the bits of [`mp_math::sin_cos`].

use super::{Doubles, LANES, Wide};
use std::f64::consts::FRAC_2_PI;

/// The polynomials of fdlibm for the sine and the cosine between −π/4 and π/4 (S. Moshier and K. C. Ng), each by falling powers.
const SIN: [f64; 6] = [
    1.589_690_995_211_55e-10,
    -2.505_076_025_340_686_3e-8,
    2.755_731_370_707_006_8e-6,
    -0.000_198_412_698_298_579_5,
    0.008_333_333_333_322_49,
    -0.166_666_666_666_666_32,
];
const COS: [f64; 6] = [
    -1.135_964_755_778_819_5e-11,
    2.087_572_321_298_175e-9,
    -2.755_731_435_139_066_3e-7,
    2.480_158_728_947_673e-5,
    -0.001_388_888_888_887_411,
    0.041_666_666_666_666_6,
];
/// Added and taken away again it rounds to an integer.
const TO_INTEGER: f64 = 6_755_399_441_055_744.0;
/// π/2 in two parts: products of the first with small integers are exact.
const QUARTER: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];
/// Angles that are no larger, and of which the rest is in this range, are computed in lanes. fdlibm reduces others in another way.
const LARGEST: f64 = 50.0;
const REST: [f64; 2] = [2e-3, 0.785];

/// The nearest integers.
#[inline(always)]
fn round<D: Doubles>(x: D) -> D {
    (x + TO_INTEGER) - TO_INTEGER
}

/// Sines and cosines of angles in radians, each with the bits of [`mp_math::sin_cos`].
#[inline(always)]
#[must_use]
pub fn sin_cos<D: Doubles>(angles: D) -> [D; 2] {
    let turns = round(angles * FRAC_2_PI);
    // The rest of the angle, in two parts.
    let (near, little) = (angles - turns * QUARTER[0], turns * QUARTER[1]);
    let x = near - little;
    let y = (near - x) - little;
    let z = x * x;
    let w = z * z;
    let [s6, s5, s4, s3, s2, s1] = SIN;
    let (cube, r) = (z * x, (z * s4 + s3) * z + s2 + z * w * (z * s6 + s5));
    let whole = x + cube * (z * r + s1);
    let rest = x - ((z * (y * 0.5 - cube * r) - y) - cube * s1);
    let [c6, c5, c4, c3, c2, c1] = COS;
    let r = z * ((z * c3 + c2) * z + c1) + w * w * ((z * c6 + c5) * z + c4);
    let half = z * 0.5;
    let (one, other) = (D::splat(1.0), D::splat(-1.0));
    let base = one - half;
    let cos = base + (((one - base) - half) + (z * r - x * y));
    // Without a turn the second part is zero, and fdlibm leaves it out.
    let middle = D::splat(0.5);
    let sin = turns.abs().where_less(middle, whole, rest);
    // Of the quarters of a turn what is left by whole and by half turns: -2 to 2, and -1 to 1.
    let left = turns - round(turns * 0.25) * 4.0;
    let odd = (turns - round(turns * 0.5) * 2.0).abs();
    let [sin, cos] = [middle.where_less(odd, cos, sin), middle.where_less(odd, sin, cos)];
    let below = left.where_less(D::splat(-0.5), other, D::splat(1.5).where_less(left, other, one));
    let behind = left.where_less(D::splat(-1.5), other, middle.where_less(left, other, one));
    let [sin, cos] = [sin * below, cos * behind];
    let (least, most) = (D::splat(REST[0]), D::splat(REST[1]));
    let (size, angle) = (x.abs(), angles.abs());
    // Written so that NaN is not in lanes.
    let in_lanes = size.less(most) & least.less(size) & angle.less(D::splat(LARGEST));
    if in_lanes == (1 << LANES) - 1 {
        return [sin, cos];
    }
    let [sin, cos] = alone(&angles.store(), [sin.store(), cos.store()], in_lanes);
    [D::load(&sin), D::load(&cos)]
}

/// With what cannot be computed in lanes.
#[cold]
#[inline(never)]
fn alone(angles: &Wide, [mut sin, mut cos]: [Wide; 2], in_lanes: u32) -> [Wide; 2] {
    for i in (0..LANES).filter(|i| in_lanes >> i & 1 == 0) {
        (sin.0[i], cos.0[i]) = mp_math::sin_cos(angles.0[i]);
    }
    [sin, cos]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wide::WideKernel;
    use crate::{Isa, run_wide};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    struct SinCos(Wide);

    impl WideKernel for SinCos {
        type Output = [Wide; 2];
        #[inline(always)]
        fn run<D: Doubles>(self) -> [Wide; 2] {
            sin_cos(D::load(&self.0)).map(D::store)
        }
    }

    /// Of angles of all sizes, near multiples of π/4, small, large and none: the bits of one at a time.
    #[test]
    fn eight_are_as_one_at_a_time() {
        let mut rng = Pcg64::seed_from_u64(5);
        let special = [0.0, -0.0, 1e-9, -1e-310, f64::NAN, f64::INFINITY, 1e9, -1e300];
        for round in 0..100_000 {
            let mut angle = |i: usize| match (round + i) % 5 {
                0 => {
                    let multiple = f64::from(rng.random_range(-40_i32..40)) * std::f64::consts::FRAC_PI_4;
                    multiple + mp_math::powi(10.0, rng.random_range(-17..0)) * rng.random_range(-1.0..1.0)
                }
                1 => rng.random_range(-60.0..60.0),
                2 if round % 7 == 0 => special[rng.random_range(0..special.len())],
                _ => rng.random_range(-3.2..3.2),
            };
            let angles = Wide(std::array::from_fn(&mut angle));
            let expected = angles.0.map(mp_math::sin_cos).map(|(sin, cos)| [sin, cos].map(f64::to_bits));
            for isa in Isa::available() {
                let [sin, cos] = run_wide(isa, SinCos(angles));
                for (i, expected) in expected.iter().enumerate() {
                    let found = [sin.0[i], cos.0[i]];
                    let is_none = found.iter().chain(&expected.map(f64::from_bits)).all(|x| x.is_nan());
                    let same = found.map(f64::to_bits) == *expected;
                    assert!(same || is_none, "{isa:?} {} {found:?}", angles.0[i]);
                }
            }
        }
    }
}
