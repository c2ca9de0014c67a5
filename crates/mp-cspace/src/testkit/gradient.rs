//! Axioms of clearance gradients.

use crate::{Rng, Space, obstacles::ClearanceGradient};
use rand::RngExt;

/// Checks a [`ClearanceGradient`] on `samples` random states, queried with `reach` (m): answers are
/// reproducible and finite, and at free states gradients are the derivatives of the clearance, by central
/// differences over `step` (time at random velocities of up to 1 per degree of freedom). Kinks (where another
/// obstacle becomes the nearest) are allowed at one in twenty of the states, and differences of up to
/// `tolerance` (m/s) everywhere.
///
/// # Panics
/// When an axiom is violated, naming it and the state; when the space has no velocities
/// ([`Space::moved`]); and when no sample is free and within reach.
pub fn check_clearance_gradient<C: Space>(
    space: &C,
    field: &mut impl ClearanceGradient<C::State>,
    reach: f64,
    (samples, step, tolerance): (usize, f64, f64),
    seed: u64,
) {
    let mut rng = Rng::seed(seed);
    let dim = space.dim();
    let mut query = |q: &C::State| {
        // The old content of the buffer must not matter.
        let mut gradient = vec![f64::NAN; dim];
        let clearance = field.clearance_gradient(q, reach, &mut gradient);
        assert!(!clearance.is_nan(), "clearance gradient: clearance is a number, violated at {q:?}");
        let finite = gradient.iter().all(|g| g.is_finite());
        assert!(finite, "clearance gradient: all of it is finite, violated by {gradient:?} at {q:?}");
        (clearance, gradient)
    };
    let (mut compared, mut kinks, mut worst) = (0, 0, None);
    for _ in 0..samples {
        let q = space.sample_uniform(&mut rng);
        let velocity: Vec<f64> = (0..dim).map(|_| rng.random_range(-1.0..1.0)).collect();
        let (clearance, gradient) = query(&q);
        assert!(
            query(&q) == (clearance, gradient.clone()),
            "clearance gradient: the same question gets the same answer, violated at {q:?}"
        );
        let [Some(before), Some(after)] = [-step, step].map(|t| space.moved(&q, &velocity, t)) else {
            panic!("clearance gradient: the space must know velocities (`Space::moved`)");
        };
        let [before, after] = [before, after].map(|q| query(&q).0);
        if ![before, clearance, after].iter().all(|&c| c > 0.0 && c < reach) {
            continue;
        }
        compared += 1;
        let expected = (after - before) / (2.0 * step);
        let found: f64 = gradient.iter().zip(&velocity).map(|(g, v)| g * v).sum();
        if (found - expected).abs() > tolerance {
            kinks += 1;
            worst = Some((q, velocity, found, expected));
        }
    }
    assert!(compared > 0, "clearance gradient: no sample was free and within a reach of {reach}");
    assert!(
        kinks * 20 <= compared,
        "clearance gradient: it is the derivative of the clearance, violated at {kinks} of {compared} states, \
         as (state, velocity, found, expected) {worst:?}"
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rn;
    use nalgebra::Vector2;

    fn check(field: impl FnMut(&Vector2<f64>, f64, &mut [f64]) -> f64) {
        let (space, mut field) = (Rn::<2>::new([-2.0; 2], [2.0; 2]).unwrap(), field);
        check_clearance_gradient(&space, &mut field, 1.0, (300, 1e-4, 1e-3), 1);
    }

    #[test]
    fn a_gradient_passes() {
        check(|q, _, g| {
            g.copy_from_slice((q / q.norm()).as_slice());
            q.norm() - 1.0
        });
    }

    #[test]
    #[should_panic(expected = "derivative of the clearance")]
    fn a_wrong_sign_fails() {
        check(|q, _, g| {
            g.copy_from_slice((-q / q.norm()).as_slice());
            q.norm() - 1.0
        });
    }

    #[test]
    #[should_panic(expected = "all of it is finite")]
    fn an_entry_left_out_fails() {
        check(|q, _, g| {
            g[0] = 0.0;
            q.norm() - 1.0
        });
    }
}
