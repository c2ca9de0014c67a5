//! External energies, which push snakes.

use crate::params::{not_negative, positive};
use mp_cspace::{ParameterError, obstacles::ClearanceGradient};

/// An energy of states, which a snake lowers by moving.
///
/// Closures that return the energy and write the gradient are fields too.
pub trait Field<S> {
    /// The energy (no unit) at `q`; its gradient is written to `gradient`, one number per degree of freedom,
    /// as the velocities of [`Space::moved`](mp_cspace::Space::moved). Both finite.
    fn energy(&mut self, q: &S, gradient: &mut [f64]) -> f64;

    /// The signed clearance (m) that was computed with the last energy, if the field has one.
    fn clearance(&self) -> Option<f64> {
        None
    }

    /// The signed clearance (m) at `q`, infinite if the field has none. Leaves meaningless numbers in
    /// `gradient`.
    #[inline]
    fn clearance_at(&mut self, q: &S, gradient: &mut [f64]) -> f64 {
        self.energy(q, gradient);
        self.clearance().unwrap_or(f64::INFINITY)
    }
}

impl<S, F: FnMut(&S, &mut [f64]) -> f64> Field<S> for F {
    #[inline]
    fn energy(&mut self, q: &S, gradient: &mut [f64]) -> f64 {
        self(q, gradient)
    }
}

/// A field without force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Nothing;

impl<S> Field<S> for Nothing {
    fn energy(&mut self, _: &S, gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        0.0
    }
}

/// The repulsion of obstacles: `½·(1 − c/range)²` where the clearance `c` is below `range`, and 0 elsewhere.
///
/// Inside obstacles `c` is minus the depth, so the energy falls toward the outside wherever the clearance
/// gradient is known.
#[derive(Clone, Debug)]
pub struct Repulsion<F> {
    /// The clearance and its gradient.
    pub clearance: F,
    range: f64,
    per_range: f64,
    last: f64,
}

impl<F> Repulsion<F> {
    /// Obstacles that repel within `range` (m).
    ///
    /// # Errors
    /// When the range is not positive and finite.
    pub fn new(clearance: F, range: f64) -> Result<Self, ParameterError> {
        let range = positive("the range of repulsion", range)?;
        Ok(Self { clearance, range, per_range: 1.0 / range, last: f64::INFINITY })
    }

    /// The range of the repulsion (m).
    #[must_use]
    pub fn range(&self) -> f64 {
        self.range
    }
}

impl<S, F: ClearanceGradient<S>> Field<S> for Repulsion<F> {
    #[inline(always)]
    fn energy(&mut self, q: &S, gradient: &mut [f64]) -> f64 {
        self.last = self.clearance.clearance_gradient(q, self.range, gradient);
        let near = 1.0 - self.last * self.per_range;
        if near <= 0.0 {
            gradient.fill(0.0);
            return 0.0;
        }
        let push = -near * self.per_range;
        gradient.iter_mut().for_each(|g| *g *= push);
        0.5 * near * near
    }
    fn clearance(&self) -> Option<f64> {
        Some(self.last)
    }
    #[inline]
    fn clearance_at(&mut self, q: &S, gradient: &mut [f64]) -> f64 {
        self.last = self.clearance.clearance_gradient(q, self.range, gradient);
        self.last
    }
}

/// A field plus a second one with a weight: the constraint energy of the paper, or a risk beside a repulsion.
#[derive(Clone, Debug)]
pub struct With<A, B> {
    /// The first field, which gives the clearance.
    pub first: A,
    /// The second field.
    pub second: B,
    weight: f64,
    scratch: Vec<f64>,
}

impl<A, B> With<A, B> {
    /// `first + weight · second`.
    ///
    /// # Errors
    /// When the weight is negative or not finite.
    pub fn new(first: A, second: B, weight: f64) -> Result<Self, ParameterError> {
        Ok(Self {
            first,
            second,
            weight: not_negative("the weight of a field", weight)?,
            scratch: Vec::new(),
        })
    }
}

impl<S, A: Field<S>, B: Field<S>> Field<S> for With<A, B> {
    fn energy(&mut self, q: &S, gradient: &mut [f64]) -> f64 {
        self.scratch.resize(gradient.len(), 0.0);
        let second = self.second.energy(q, &mut self.scratch);
        let first = self.first.energy(q, gradient);
        gradient.iter_mut().zip(&self.scratch).for_each(|(g, s)| *g += self.weight * s);
        first + self.weight * second
    }
    fn clearance(&self) -> Option<f64> {
        self.first.clearance()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    fn wall(q: &Vector2<f64>, _: f64, g: &mut [f64]) -> f64 {
        g.copy_from_slice(&[1.0, 0.0]);
        q.x
    }

    /// Gradients are derivatives of energies; the second field counts with its weight.
    #[test]
    fn gradients_are_derivatives() {
        let repulsion = Repulsion::new(wall, 0.5).unwrap();
        let bowl = |q: &Vector2<f64>, g: &mut [f64]| {
            g.copy_from_slice(q.as_slice());
            0.5 * q.norm_squared()
        };
        let mut field = With::new(repulsion, bowl, 3.0).unwrap();
        let mut ask = |x: f64, y: f64| {
            let mut g = [f64::NAN; 2];
            (field.energy(&Vector2::new(x, y), &mut g), g, Field::<Vector2<f64>>::clearance(&field))
        };
        for (x, y) in [(-0.4, 0.3), (0.2, -0.1), (0.7, 0.0)] {
            let h = 1e-6;
            let (_, g, clearance) = ask(x, y);
            assert_eq!(clearance, Some(x));
            assert!(((ask(x + h, y).0 - ask(x - h, y).0) / (2.0 * h) - g[0]).abs() < 1e-6);
            assert!(((ask(x, y + h).0 - ask(x, y - h).0) / (2.0 * h) - g[1]).abs() < 1e-6);
        }
        assert!((ask(0.7, 0.0).1[0] - 2.1).abs() < 1e-12);
    }

    #[test]
    fn bad_numbers_are_refused() {
        assert!(Repulsion::new(wall, 0.0).is_err() && Repulsion::new(wall, f64::NAN).is_err());
        assert!(With::new(Nothing, Nothing, -1.0).is_err());
    }
}
