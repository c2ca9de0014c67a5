//! Systems given by a differential equation.

use crate::Flow;
use mp_cspace::ParameterError;
use nalgebra::SVector;

/// A vector moved by a differential equation `dq/dt = f(q, u)`, integrated by the classical fourth-order
/// Runge-Kutta method.
///
/// ```
/// use mp_control::{Flow, Rk4};
/// use nalgebra::Vector2;
/// // A pendulum with a torque.
/// let pendulum = Rk4::new(|q: &Vector2<f64>, u: &f64| Vector2::new(q.y, u - q.x.sin()), 0.01)?;
/// let q = pendulum.integrate(&Vector2::new(1e-3, 0.0), &0.0, std::f64::consts::PI);
/// assert!((q.x + 1e-3).abs() < 1e-9);
/// # Ok::<(), mp_cspace::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Rk4<F> {
    derivative: F,
    step: f64,
}

/// The most steps of one integration; beyond that steps get longer.
const MAX_STEPS: u32 = 1_000_000;

impl<F> Rk4<F> {
    /// Integrates `derivative` in equal steps of at most `step` seconds.
    ///
    /// # Errors
    /// When the step is not positive and finite.
    pub fn new(derivative: F, step: f64) -> Result<Self, ParameterError> {
        Ok(Self { derivative, step: ParameterError::positive("the step", step)? })
    }

    fn run<U, const N: usize>(&self, from: &SVector<f64, N>, input: &U, time: f64) -> SVector<f64, N>
    where
        F: Fn(&SVector<f64, N>, &U) -> SVector<f64, N>,
    {
        // One step at least, also for a time that is no number: so is the state then.
        let steps = ((time.abs() / self.step).ceil() as u32).clamp(1, MAX_STEPS);
        let h = time / f64::from(steps);
        let f = |q: SVector<f64, N>| (self.derivative)(&q, input);
        (0..steps).fold(*from, |q, _| {
            let a = f(q);
            let b = f(q + a * (0.5 * h));
            let c = f(q + b * (0.5 * h));
            let d = f(q + c * h);
            q + (a + (b + c) * 2.0 + d) * (h / 6.0)
        })
    }
}

impl<F, U, const N: usize> Flow<SVector<f64, N>, U> for Rk4<F>
where
    F: Fn(&SVector<f64, N>, &U) -> SVector<f64, N>,
{
    fn integrate(&self, from: &SVector<f64, N>, input: &U, time: f64) -> SVector<f64, N> {
        self.run(from, input, time)
    }
    fn reversed(&self, to: &SVector<f64, N>, input: &U, time: f64) -> Option<SVector<f64, N>> {
        Some(self.run(to, input, -time))
    }
}
