//! Mathematical functions that give the same bits on every processor and operating system.
//!
//! The methods of `f64` with the same names call the C library, which chooses among variants by processor,
//! and the compiler computes them itself where their arguments are constants. Their last bits differ from
//! machine to machine, so a planner with the same seed would find another path. The functions here are those
//! of the crate [`libm`]: additions, multiplications, divisions and square roots in a fixed order, each
//! rounded as IEEE 754 says. The result is at most two units in the last place from the true value ([`powi`]:
//! a unit for each multiplication).
//!
//! Not here, because IEEE 754 fixes their bits and `f64` has them: `sqrt`, `abs`, `floor`, `ceil`, `round`,
//! `trunc`, `rem_euclid`, `mul_add`, `to_radians`, `to_degrees`.
//!
//! ```
//! assert_eq!(mp_math::sin(1e5).to_bits(), 0x3fa2_4daa_9c52_7e96);
//! ```

macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident = $theirs:ident($($x:ident),+);)+) => {
        $($(#[$doc])*
        #[inline]
        #[must_use]
        pub fn $name($($x: f64),+) -> f64 {
            libm::$theirs($($x),+)
        })+
    };
}

functions! {
    /// The sine of an angle in radians.
    sin = sin(x);
    /// The cosine of an angle in radians.
    cos = cos(x);
    /// The tangent of an angle in radians.
    tan = tan(x);
    /// The angle in [−π/2, π/2] whose sine is `x`, radians; NaN outside [−1, 1].
    asin = asin(x);
    /// The angle in [0, π] whose cosine is `x`, radians; NaN outside [−1, 1].
    acos = acos(x);
    /// The angle in (−π/2, π/2) whose tangent is `x`, radians.
    atan = atan(x);
    /// The angle in [−π, π] of the vector (`x`, `y`) from the first axis, radians.
    atan2 = atan2(y, x);
    /// e to the power of `x`.
    exp = exp(x);
    /// 2 to the power of `x`; exact where `x` is an integer.
    exp2 = exp2(x);
    /// The natural logarithm of `x`; NaN below 0.
    ln = log(x);
    /// The logarithm of `x` to base 2; exact where `x` is a power of 2, NaN below 0.
    log2 = log2(x);
    /// The logarithm of `x` to base 10; NaN below 0.
    log10 = log10(x);
    /// `x` to the power of `exponent`; NaN where `x` is below 0 and `exponent` is no integer.
    powf = pow(x, exponent);
    /// √(x² + y²), without overflow on the way.
    hypot = hypot(x, y);
    /// The cube root of `x`, correctly rounded.
    cbrt = cbrt(x);
}

/// The sine and the cosine of an angle in radians, for little more than the price of one: [`sin`] and
/// [`cos`], bit for bit.
#[inline]
#[must_use]
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// `x` to an integer power, by squaring. The square and the cube are `x * x` and `x * x * x`; a negative
/// power is one over the positive one.
#[inline]
#[must_use]
pub fn powi(x: f64, exponent: i32) -> f64 {
    let (mut rest, mut square, mut power) = (exponent.unsigned_abs(), x, 1.0);
    loop {
        if rest & 1 == 1 {
            power *= square;
        }
        rest >>= 1;
        if rest == 0 {
            return if exponent < 0 { 1.0 / power } else { power };
        }
        square *= square;
    }
}
