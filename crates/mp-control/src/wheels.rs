//! Systems on wheels: motions along circular arcs, in closed form.

use crate::{Flow, InputError, InputSet};
use mp_cspace::{ParameterError, Se2State};

/// The pose after driving at `speed` (m/s) and turning at `rate` (rad/s) for `time` seconds.
#[inline]
fn arc(from: &Se2State, speed: f64, rate: f64, time: f64) -> Se2State {
    let (half, length) = (0.5 * rate * time, speed * time);
    // The chord: sin(x)/x times the arc's length, x being half the turn, in the direction at half the turn.
    let chord = if half.abs() < 1e-4 { 1.0 - half * half / 6.0 } else { mp_math::sin(half) / half } * length;
    let (s, c) = mp_math::sin_cos(from.angle + half);
    let t = from.translation;
    Se2State::new(t.x + chord * c, t.y + chord * s, from.angle + rate * time)
}

/// A body in the plane that drives along its x axis and turns freely, also on the spot. Inputs are
/// `[speed (m/s), turning rate (rad/s)]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unicycle;

impl Unicycle {
    /// Eight inputs: speed and turning rate zero or at their positive or negative limit, except both zero.
    ///
    /// # Errors
    /// When a limit is not positive and finite.
    pub fn inputs(speed: f64, rate: f64) -> Result<InputSet<[f64; 2]>, InputError> {
        let (v, w) = (
            ParameterError::positive("the speed", speed)?,
            ParameterError::positive("the turning rate", rate)?,
        );
        InputSet::new([[v, 0.0], [v, w], [v, -w], [-v, 0.0], [-v, w], [-v, -w], [0.0, w], [0.0, -w]])
    }
}

impl Flow<Se2State, [f64; 2]> for Unicycle {
    #[inline]
    fn integrate(&self, from: &Se2State, &[speed, rate]: &[f64; 2], time: f64) -> Se2State {
        arc(from, speed, rate, time)
    }
    #[inline]
    fn reversed(&self, to: &Se2State, &[speed, rate]: &[f64; 2], time: f64) -> Option<Se2State> {
        Some(arc(to, speed, rate, -time))
    }
}

/// A car with front-wheel (Ackermann) steering. Its pose is that of the middle of the rear axle. Inputs are
/// `[speed (m/s, negative in reverse), steering angle (rad)]`; it turns at `speed · tan(angle) / wheelbase`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Car {
    wheelbase: f64,
}

impl Car {
    /// A car with this distance (m) between its axles.
    ///
    /// # Errors
    /// When it is not positive and finite.
    pub fn new(wheelbase: f64) -> Result<Self, InputError> {
        Ok(Self { wheelbase: ParameterError::positive("the wheelbase", wheelbase)? })
    }

    /// Inputs forward and in reverse at `speed` (m/s), with the steering in `2 · each_side + 1` positions up
    /// to `steering` (rad) to either side.
    ///
    /// # Errors
    /// When the speed is not positive and finite, or the steering angle not in (0, π/2).
    pub fn inputs(speed: f64, steering: f64, each_side: u16) -> Result<InputSet<[f64; 2]>, InputError> {
        let speed = ParameterError::positive("the speed", speed)?;
        if !(steering > 0.0 && steering < std::f64::consts::FRAC_PI_2) {
            let (name, expected) = ("the steering angle", "in (0, π/2) rad");
            return Err(ParameterError { name, expected, value: steering }.into());
        }
        let n = i32::from(each_side);
        let angles = (-n..=n).map(|i| if n == 0 { 0.0 } else { steering * f64::from(i) / f64::from(n) });
        InputSet::new(angles.flat_map(|angle| [[speed, angle], [-speed, angle]]))
    }

    #[inline]
    fn drive(&self, from: &Se2State, [speed, angle]: [f64; 2], time: f64) -> Se2State {
        arc(from, speed, speed * mp_math::tan(angle) / self.wheelbase, time)
    }
}

impl Flow<Se2State, [f64; 2]> for Car {
    #[inline]
    fn integrate(&self, from: &Se2State, input: &[f64; 2], time: f64) -> Se2State {
        self.drive(from, *input, time)
    }
    #[inline]
    fn reversed(&self, to: &Se2State, input: &[f64; 2], time: f64) -> Option<Se2State> {
        Some(self.drive(to, *input, -time))
    }
}
