//! Numbers that are written and read back.

use proptest::prelude::*;

pub(crate) fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO,
        -100.0..100.0,
        (-50..50_i32).prop_map(f64::from),
    ]
}

pub(crate) fn six() -> impl Strategy<Value = [f64; 6]> {
    proptest::array::uniform6(number())
}
