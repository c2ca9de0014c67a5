//! Polynomials of degree five or less: values, derivatives, and their exact range.

/// Coefficients, the constant first.
pub(crate) type Polynomial = [f64; 6];

/// The value at `x`, by Horner's scheme.
pub(crate) fn value(c: &Polynomial, x: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

pub(crate) fn derivative(c: &Polynomial) -> Polynomial {
    std::array::from_fn(|i| if i < 5 { (i + 1) as f64 * c[i + 1] } else { 0.0 })
}

/// Halvings of an interval until it is as short as numbers resolve.
const HALVINGS: u32 = 60;

/// Where the polynomial changes its sign between `a` and `b`, in order: between neighbouring turning points it is monotone.
fn roots(c: &Polynomial, a: f64, b: f64) -> Vec<f64> {
    if c[1..].iter().all(|c| *c == 0.0) {
        return Vec::new();
    }
    let mut ends = vec![a];
    ends.extend(roots(&derivative(c), a, b));
    ends.push(b);
    let root = |w: &[f64]| {
        let (mut low, mut high) = (w[0], w[1]);
        let rises = value(c, high) > 0.0;
        if (value(c, low) > 0.0) == rises {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let side = if (value(c, middle) > 0.0) == rises { &mut high } else { &mut low };
            *side = middle;
        }
        Some(0.5 * (low + high))
    };
    ends.windows(2).filter_map(root).collect()
}

/// The least and the largest value between `a` and `b`, and where they are: at an end, or where the derivative is zero.
pub(crate) fn extremes(c: &Polynomial, a: f64, b: f64) -> [(f64, f64); 2] {
    let at = |x: f64| (value(c, x), x);
    let inner = roots(&derivative(c), a, b);
    let all = [a, b].into_iter().chain(inner).map(at);
    all.fold([at(a); 2], |[low, high], it| {
        [if it.0 < low.0 { it } else { low }, if it.0 > high.0 { it } else { high }]
    })
}

/// Bounds of the values of a polynomial, the constant first, between `a` and `b`, which rounding cannot exceed.
#[must_use]
pub fn range(c: &Polynomial, a: f64, b: f64) -> [f64; 2] {
    let [low, high] = extremes(c, a, b).map(|it| it.0);
    let size = a.abs().max(b.abs());
    // Of six terms, and of a turning point that rounding hides, each no more than some units in the last place of what is added up.
    let rounding = 64.0 * f64::EPSILON * value(&c.map(f64::abs), size);
    [low - rounding, high + rounding]
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_cspace::Rng;
    use rand::RngExt;

    #[test]
    fn ranges_hold_and_are_reached() {
        let mut rng = Rng::seed(1);
        for case in 0..2000 {
            let degree = case % 6;
            let c: Polynomial =
                std::array::from_fn(|i| if i <= degree { rng.random_range(-3.0..3.0) } else { 0.0 });
            let (a, b) = (rng.random_range(-2.0..0.0), rng.random_range(0.0..2.0));
            let [low, high] = range(&c, a, b);
            let samples = (0..=4000).map(|i| value(&c, a + (b - a) * f64::from(i) / 4000.0));
            let (least, most) =
                samples.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            assert!(low <= least && most <= high, "{c:?}");
            // Samples miss a turning point by 5e-4 at most, where the second derivative is at most 20·3·8 + …
            assert!(least - low < 1e-3 && high - most < 1e-3, "{c:?}: {low} {least} {most} {high}");
        }
    }

    #[test]
    fn roots_of_known_polynomials_are_found() {
        // (x − 1)(x − 2)(x − 3)(x − 4), and one that only touches zero.
        let found = roots(&[24.0, -50.0, 35.0, -10.0, 1.0, 0.0], 0.0, 5.0);
        assert_eq!(found.len(), 4);
        assert!(found.iter().zip(1..).all(|(x, n)| (x - f64::from(n)).abs() < 1e-12), "{found:?}");
        assert!(roots(&[0.0, 0.0, 1.0, 0.0, 0.0, 0.0], -1.0, 1.0).len() <= 1);
    }
}
