//! Limits of jerk: a trajectory is averaged over a window of time.
//!
//! Biagiotti and Melchiorri, *FIR filters for online trajectory planning with time- and frequency-domain specifications*, Control Engineering
//! Practice 20 (2012). The mean of the positions of the last T seconds,
//!
//! q̃(t) = 1/T · ∫ q(τ) dτ from t − T to t,
//!
//! moves by the means of the velocities and of the accelerations before, so that limits of both still hold, and its jerk is
//! (a(t) − a(t − T)) / T. From standing still to standing still it takes T longer. Lines stay lines; corners are cut a little more.

use crate::{Knots, TimeError, Trajectory};

/// More rounds than this do not make the window any longer.
const ROUNDS: usize = 40;

/// A window (s) that is long enough for the limits of jerk (rad/s³ or m/s³; infinite where there is none) of each joint, and hardly longer than
/// that needs. Zero if there are no limits.
pub(crate) fn window(trajectory: &Trajectory, jerk: &[f64]) -> f64 {
    let needs = |window: f64| {
        let limited = jerk.iter().enumerate().filter(|(_, limit)| limit.is_finite());
        limited.map(|(joint, limit)| jump(trajectory, joint, window) / limit).fold(0.0, f64::max)
    };
    let mut found = needs(0.0);
    for _ in 0..ROUNDS {
        let needed = needs(found);
        if needed <= found * (1.0 + 1e-6) {
            return found.max(needed);
        }
        found = needed;
    }
    // From the one extreme of the acceleration to the other is enough in any case.
    let all = jerk.iter().enumerate().map(|(joint, limit)| 2.0 * trajectory.hardest(joint).amount / limit);
    all.fold(0.0, f64::max)
}

/// The largest change of the acceleration of a joint over a window of time (s). Before and behind the trajectory it stands still.
fn jump(trajectory: &Trajectory, joint: usize, window: f64) -> f64 {
    let change = |to: f64| {
        let ([from, from_behind], [to, to_behind]) =
            (trajectory.accelerations(joint, to - window), trajectory.accelerations(joint, to));
        match window > 0.0 {
            true => (to - from).abs().max((to_behind - from_behind).abs()),
            false => (to_behind - to).abs(),
        }
    };
    let times = &trajectory.knots().times;
    times.iter().flat_map(|t| [*t, t + window]).map(change).fold(0.0, f64::max)
}

/// The mean over the last `window` seconds of a cubic trajectory that begins and ends standing still. It is quintic. It is exact, unless two points are
/// nearer to each other than `apart` seconds: one of them is left out.
///
/// # Errors
/// When numbers are too large to stay finite.
pub(crate) fn averaged(trajectory: &Trajectory, window: f64, apart: f64) -> Result<Trajectory, TimeError> {
    let [first, last] = trajectory.span();
    let end = last + window;
    let mut times: Vec<f64> = trajectory.knots().times.iter().flat_map(|t| [*t, t + window]).collect();
    times.sort_by(f64::total_cmp);
    times.dedup_by(|after, before| *after - *before < apart);
    times.retain(|t| *t == first || end - t >= apart);
    times.push(end);
    let mut knots = Knots::default();
    for t in times {
        let [from, to] = [t - window, t].map(|t| trajectory.at(t));
        let mean = |from: &[f64], to: &[f64]| from.iter().zip(to).map(|(a, b)| (b - a) / window).collect();
        knots.velocities.push(mean(&from.position, &to.position));
        knots.accelerations.push(mean(&from.velocity, &to.velocity));
        knots.positions.push(trajectory.mean(t - window, t));
        knots.times.push(t);
    }
    Trajectory::new(trajectory.joints(), knots, crate::Interpolation::Quintic)
}

impl Trajectory {
    /// The accelerations of a joint just before and just behind a time (s): zero outside of the trajectory.
    fn accelerations(&self, joint: usize, time: f64) -> [f64; 2] {
        let [first, last] = self.span();
        let behind = if time >= first && time < last { self.acceleration(joint, time) } else { 0.0 };
        // At a point the piece before it counts.
        let is_point = self.knots().times.binary_search_by(|t| t.total_cmp(&time)).ok();
        let before = match is_point {
            Some(0) => 0.0,
            Some(i) => self.acceleration_before(joint, i),
            None => behind,
        };
        [before, behind]
    }

    /// The mean position (rad or m) of each joint of a cubic trajectory between two times (s).
    fn mean(&self, from: f64, to: f64) -> Vec<f64> {
        let inside = self.knots().times.iter().filter(|t| **t > from && **t < to);
        let ends: Vec<f64> = [from].into_iter().chain(inside.copied()).chain([to]).collect();
        let mut sum = vec![0.0; self.joints().len()];
        for w in ends.windows(2) {
            // Simpson's rule, which is exact for cubic polynomials.
            for (t, weight) in [(w[0], 1.0), (0.5 * (w[0] + w[1]), 4.0), (w[1], 1.0)] {
                let part = weight / 6.0 * (w[1] - w[0]) / (to - from);
                sum.iter_mut().zip(self.at(t).position).for_each(|(sum, q)| *sum += part * q);
            }
        }
        sum
    }
}
