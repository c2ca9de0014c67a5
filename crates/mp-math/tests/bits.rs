//! The bits of all functions, and how far they are from the standard library.
#![allow(clippy::disallowed_methods)] // Compared with the methods of `f64`.

use mp_math::*;

type Function = (&'static str, fn(f64) -> f64, fn(f64) -> f64, fn(Number) -> f64, u64);
type FunctionOfTwo = (&'static str, fn(f64, f64) -> f64, fn(f64, f64) -> f64, fn(Number) -> [f64; 2], u64);

/// A pseudo-random number in [0, 1).
type Number = f64;

/// Numbers in [0, 1), always the same (PCG's multiplier, upper bits).
fn numbers() -> impl Iterator<Item = Number> {
    let mut state = 1_u64;
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    })
}

/// Numbers of both signs from 1e-6 to 1e6, all magnitudes alike.
fn any(u: Number) -> f64 {
    let (sign, u) = if u < 0.5 { (-1.0, 2.0 * u) } else { (1.0, 2.0 * u - 1.0) };
    let exponent = (u * 40.0) as i32 - 20;
    sign * powi(2.0, exponent) * (1.0 + (u * 40.0).fract())
}

fn positive(u: Number) -> f64 {
    any(u).abs()
}

fn within_one(u: Number) -> f64 {
    2.0 * u - 1.0
}

fn exponent(u: Number) -> f64 {
    1400.0 * u - 700.0
}

/// Two numbers of one.
fn two(u: Number) -> [f64; 2] {
    [any(u), any((u * 1e6).fract())]
}

const OF_ONE: [Function; 13] = [
    ("sin", sin, f64::sin, any, 0x9fe1_7b22_21ad_367c),
    ("cos", cos, f64::cos, any, 0x0e60_223d_b9a5_308c),
    ("tan", tan, f64::tan, any, 0x1447_442e_7071_7161),
    ("asin", asin, f64::asin, within_one, 0x0338_05b3_f7be_05d2),
    ("acos", acos, f64::acos, within_one, 0xa20c_295e_74cf_47d7),
    ("atan", atan, f64::atan, any, 0xae7e_5776_959a_88a4),
    ("exp", exp, f64::exp, exponent, 0x089e_a355_d468_a9c6),
    ("exp2", exp2, f64::exp2, exponent, 0xcd4a_f4a3_a293_a6b6),
    ("ln", ln, f64::ln, positive, 0x7694_c1c2_a8c3_bd9e),
    ("log2", log2, f64::log2, positive, 0x5a99_ff80_4825_2764),
    ("log10", log10, f64::log10, positive, 0x03a3_6207_8f80_ce28),
    ("cbrt", cbrt, f64::cbrt, any, 0x2389_7bb6_14c4_3b01),
    ("powi", |x| powi(x, 13), |x| x.powi(13), any, 0x19a4_d6a0_c2f7_6849),
];

const OF_TWO: [FunctionOfTwo; 3] = [
    ("atan2", atan2, f64::atan2, two, 0x1ef9_33de_8da7_10e0),
    ("hypot", hypot, f64::hypot, two, 0x60dd_c7cb_c92b_3032),
    ("powf", powf, f64::powf, |u| [positive(u), 10.0 * within_one((u * 1e6).fract())], 0x7569_d836_36c8_6ee1),
];

const MANY: usize = 50_000;

/// A hash of the bits of all results (FNV-1a).
fn hash(results: impl Iterator<Item = f64>) -> u64 {
    results.fold(0xcbf2_9ce4_8422_2325, |h, v| (h ^ v.to_bits()).wrapping_mul(0x0100_0000_01b3))
}

/// The bits are those of the machine on which this test was written.
#[test]
fn bits_are_the_same_on_every_machine() {
    let one = OF_ONE
        .map(|(name, f, _, of, expected)| (name, hash(numbers().take(MANY).map(|u| f(of(u)))), expected));
    let of_two = OF_TWO.map(|(name, f, _, of, expected)| {
        let results = numbers().take(MANY).map(|u| {
            let [x, y] = of(u);
            f(x, y)
        });
        (name, hash(results), expected)
    });
    let differ: Vec<String> = (one.into_iter().chain(of_two))
        .filter(|(_, found, expected)| found != expected)
        .map(|(name, found, _)| format!("{name} {found:#018x}"))
        .collect();
    assert!(differ.is_empty(), "{differ:#?}");
}

/// How many numbers of type `f64` lie between two of the same sign.
fn units(a: f64, b: f64) -> u64 {
    (a.to_bits() as i64 - b.to_bits() as i64).unsigned_abs()
}

/// The standard library is within a unit in the last place of the true value.
#[test]
fn values_are_those_of_the_standard_library_up_to_rounding() {
    for (name, f, standard, of, _) in OF_ONE {
        let far = numbers().take(MANY).map(|u| units(f(of(u)), standard(of(u)))).max();
        assert!(far <= Some(3), "{name}: {far:?}");
    }
    for (name, f, standard, of, _) in OF_TWO {
        let far = numbers().take(MANY).map(of).map(|[x, y]| units(f(x, y), standard(x, y))).max();
        assert!(far <= Some(3), "{name}: {far:?}");
    }
}

#[test]
fn sine_and_cosine_at_once_are_those_of_each() {
    for x in numbers().take(MANY).map(any).chain([0.0, -0.0, 1e-300, f64::MAX]) {
        let (s, c) = sin_cos(x);
        assert_eq!([s.to_bits(), c.to_bits()], [sin(x).to_bits(), cos(x).to_bits()], "{x}");
    }
}

#[test]
fn small_powers_are_products() {
    for x in numbers().take(1000).map(any) {
        assert_eq!([powi(x, 0), powi(x, 1), powi(x, 2), powi(x, 3)], [1.0, x, x * x, x * x * x]);
        assert_eq!([powi(x, -1), powi(x, -2)], [1.0 / x, 1.0 / (x * x)]);
    }
    assert_eq!([powi(2.0, 1023), powi(2.0, -1022)], [2.0_f64.powi(1023), f64::MIN_POSITIVE]);
    assert_eq!(powi(0.5, i32::MIN), f64::INFINITY);
}

#[test]
fn edges_of_the_domain() {
    assert!(
        [asin(1.1), acos(-1.1), ln(-1.0), powf(-1.0, 0.5), sin(f64::INFINITY)].iter().all(|v| v.is_nan())
    );
    assert_eq!([atan2(0.0, -1.0), atan2(-0.0, -1.0)], [std::f64::consts::PI, -std::f64::consts::PI]);
    assert_eq!([ln(0.0), exp(-1e4), exp(1e4)], [f64::NEG_INFINITY, 0.0, f64::INFINITY]);
    assert_eq!([exp2(10.0), log2(1024.0), cbrt(27.0), hypot(3e200, 0.0)], [1024.0, 10.0, 3.0, 3e200]);
}
