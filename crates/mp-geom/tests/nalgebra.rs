//! nalgebra computes with the functions of mp-math: the workspace asks for its feature `libm-force`.

use nalgebra::{ComplexField, RealField, UnitComplex, UnitQuaternion, Vector3};

/// Numbers in (-1, 1), spread evenly.
fn numbers() -> impl Iterator<Item = f64> {
    (1..20_000).map(|i| 2.0 * (f64::from(i) * 0.754_877_666).fract() - 1.0)
}

#[test]
fn functions_of_nalgebra_have_the_bits_of_ours() {
    type Pair = (fn(f64) -> f64, fn(f64) -> f64);
    let pairs: [Pair; 11] = [
        (<f64 as ComplexField>::sin, mp_math::sin),
        (<f64 as ComplexField>::cos, mp_math::cos),
        (<f64 as ComplexField>::tan, mp_math::tan),
        (<f64 as ComplexField>::asin, mp_math::asin),
        (<f64 as ComplexField>::acos, mp_math::acos),
        (<f64 as ComplexField>::atan, mp_math::atan),
        (<f64 as ComplexField>::exp, mp_math::exp),
        (|x| ComplexField::ln(x.abs()), |x| mp_math::ln(x.abs())),
        (|x| ComplexField::hypot(x, 0.3), |x| mp_math::hypot(x, 0.3)),
        (|x| ComplexField::powf(x.abs(), 0.3), |x| mp_math::powf(x.abs(), 0.3)),
        (|x| RealField::atan2(x, 0.3), |x| mp_math::atan2(x, 0.3)),
    ];
    for (i, (theirs, ours)) in pairs.into_iter().enumerate() {
        for x in numbers() {
            assert_eq!(theirs(x).to_bits(), ours(x).to_bits(), "{i}: {x}");
        }
    }
}

#[test]
fn rotations_have_the_bits_of_ours() {
    for x in numbers() {
        let (s, c) = mp_math::sin_cos(0.5 * x);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), x);
        assert_eq!([turn.w.to_bits(), turn.k.to_bits()], [c.to_bits(), s.to_bits()]);
        assert_eq!(
            turn.angle().to_bits(),
            (2.0 * mp_math::atan2(turn.imag().norm(), turn.w.abs())).to_bits()
        );
        let (s, c) = mp_math::sin_cos(x);
        let turn = UnitComplex::new(x);
        assert_eq!([turn.re.to_bits(), turn.im.to_bits()], [c.to_bits(), s.to_bits()]);
        assert_eq!(turn.angle().to_bits(), mp_math::atan2(s, c).to_bits());
    }
}
