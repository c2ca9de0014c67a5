//! Sines and cosines of eight angles, with the bits of [`mp_math::sin_cos`].

use super::{LANES, Wide};
use crate::Lanes;
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
/// Added and taken away again it rounds to an integer, the last bits of which are those of the sum.
const TO_INTEGER: f64 = 6_755_399_441_055_744.0;
/// π/2 in two parts: products of the first with small integers are exact.
const QUARTER: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];
/// Angles that are no larger, and of which the rest is in this range, are computed in lanes. fdlibm reduces others in another way.
const LARGEST: f64 = 50.0;
const REST: [f64; 2] = [2e-3, 0.785];

macro_rules! bits {
    ($i:ident => $value:expr) => {{
        let mut out = [0_u64; LANES];
        let mut $i = 0;
        while $i < LANES {
            out[$i] = $value;
            $i += 1;
        }
        out
    }};
}

impl Wide {
    /// Sines and cosines of angles in radians, each with the bits of [`mp_math::sin_cos`].
    #[inline(always)]
    #[must_use]
    pub fn sin_cos<L: Lanes>(self) -> [Self; 2] {
        let shifted = self * FRAC_2_PI + TO_INTEGER;
        let turns = shifted - TO_INTEGER;
        // The rest of the angle, in two parts.
        let (near, little) = (self - turns * QUARTER[0], turns * QUARTER[1]);
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
        let one = Self::splat(1.0);
        let base = one - half;
        let cos = base + (((one - base) - half) + (z * r - x * y));
        let quarter = bits!(i => shifted.0[i].to_bits() & 3);
        // Without a turn the second part is zero, and fdlibm leaves it out.
        let sin = lanes!(i => if turns.0[i] == 0.0 { whole.0[i] } else { rest.0[i] });
        let [sin, cos] = [
            bits!(i => (if quarter[i] & 1 == 0 { sin.0[i] } else { cos.0[i] }).to_bits() ^ (quarter[i] & 2) << 62),
            bits!(i => (if quarter[i] & 1 == 0 { cos.0[i] } else { sin.0[i] }).to_bits() ^ ((quarter[i] + 1) & 2) << 62),
        ]
        .map(|all| lanes!(i => f64::from_bits(all[i])));
        let (least, most) = (Self::splat(REST[0]), Self::splat(REST[1]));
        let (size, angle) = (x.abs(), self.abs());
        // Written so that NaN is not in lanes.
        let in_lanes = size.less::<L>(most) & least.less::<L>(size) & angle.less::<L>(Self::splat(LARGEST));
        if in_lanes == (1 << LANES) - 1 { [sin, cos] } else { self.alone([sin, cos], in_lanes) }
    }

    /// With what cannot be computed in lanes.
    #[cold]
    #[inline(never)]
    fn alone(self, [mut sin, mut cos]: [Self; 2], in_lanes: u32) -> [Self; 2] {
        for i in (0..LANES).filter(|i| in_lanes >> i & 1 == 0) {
            (sin.0[i], cos.0[i]) = mp_math::sin_cos(self.0[i]);
        }
        [sin, cos]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wide::{AnyLanes, WideKernel};
    use crate::{Isa, run};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    struct SinCos(Wide);

    impl WideKernel for SinCos {
        type Output = [Wide; 2];
        #[inline(always)]
        fn run<L: Lanes>(self) -> [Wide; 2] {
            self.0.sin_cos::<L>()
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
                let [sin, cos] = run(isa, AnyLanes(SinCos(angles)));
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
