//! Systems whose inputs are accelerations.

use crate::{Flow, Input, InputError};
use mp_cspace::Space;

/// Positions with a velocity per degree of freedom, moved at constant acceleration.
///
/// States are pairs: a position of any space that has [velocities](Space::moved), and its velocity.
/// Inputs are accelerations, one number per degree of freedom (m/s², rad/s², about world axes):
///
/// > v(t) = v + a·t, q(t) = q moved at v + a·t/2 for t
///
/// which is exact for vectors and angles. For rotations in space it is the Magnus integrator of second
/// order: exact where acceleration and angular velocity share an axis, else off by O(t³·|ω × α|).
///
/// The only bounds on velocities are those of the space of states: planners drop successors outside it.
#[derive(Debug)]
pub struct DoubleIntegrator<'c, P> {
    positions: &'c P,
}

impl<P> Clone for DoubleIntegrator<'_, P> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<P> Copy for DoubleIntegrator<'_, P> {}

impl<'c, P: Space> DoubleIntegrator<'c, P> {
    /// The states over `positions`, the first of the [spaces](mp_cspace::Product::spaces) of their product
    /// with velocities.
    ///
    /// # Errors
    /// When the space of positions has no velocities.
    pub fn new(positions: &'c P) -> Result<Self, InputError> {
        crate::Kinematic::new(positions).map(|_| Self { positions })
    }

    #[inline]
    fn run<V: Input, U: Input>(&self, (q, v): &(P::State, V), input: &U, time: f64) -> (P::State, V) {
        let mean = v.plus(input, 0.5 * time);
        let q = self.positions.moved(q, mean.entries(), time).unwrap_or_else(|| q.clone());
        (q, v.plus(input, time))
    }
}

impl<P: Space, V: Input, U: Input> Flow<(P::State, V), U> for DoubleIntegrator<'_, P> {
    #[inline]
    fn integrate(&self, from: &(P::State, V), input: &U, time: f64) -> (P::State, V) {
        self.run(from, input, time)
    }
    #[inline]
    fn reversed(&self, to: &(P::State, V), input: &U, time: f64) -> Option<(P::State, V)> {
        Some(self.run(to, input, -time))
    }
}
