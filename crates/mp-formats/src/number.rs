//! Numbers as text.

use std::fmt;

/// A number, shown with the fewest digits that read back to the same bits; very large and very small ones
/// with an exponent.
#[derive(Clone, Copy, Debug)]
pub struct Num(pub f64);

impl fmt::Display for Num {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-5..1e16).contains(&size) {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}

/// The numbers, separated by blanks.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a>(pub &'a [f64]);

impl fmt::Display for Row<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, v) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str(" ")?;
            }
            Num(*v).fmt(f)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn short() {
        assert_eq!(Row(&[0.1, -0.0, 10.0, 1e-7, 1.5e300]).to_string(), "0.1 -0 10 1e-7 1.5e300");
    }

    proptest! {
        #[test]
        fn reads_back_to_the_same_bits(v in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL) {
            prop_assert_eq!(Num(v).to_string().parse::<f64>().unwrap().to_bits(), v.to_bits());
        }
    }
}
