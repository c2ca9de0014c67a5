//! Spaces: the traits, and the spaces one file each.

mod ellipsoid;
mod floating;
mod joints;
mod poses;
mod product;
mod rn;
mod se2;
mod se3;
mod so3;
mod vectors;

pub use floating::FloatingJoints;
pub use joints::{Coordinates, JointRange, Joints};
pub use product::Product;
pub use rn::Rn;
pub use se2::{Se2, Se2State};
pub use se3::Se3;
pub use so3::So3;
pub(crate) use so3::twice;
pub use vectors::{AsVectors, OnVectors};

use crate::{Rng, layout::Layout};
use std::fmt::Debug;

/// Marks a distance that is symmetric and satisfies the triangle inequality: that of the space itself, or
/// that of a [`Metric`](crate::Metric) on the space `C`.
///
/// Metric trees require it, as they prune with the triangle inequality. Different states may be at distance
/// zero (the unit quaternions `q` and `-q` are).
pub trait TrueMetric<C: ?Sized = Self> {}

/// A configuration space (or state space): its states, their distances, and the interpolation between them.
///
/// Contract, checked by the conformance kit (`testkit::SpaceKit`, with the feature `testkit`):
/// - `interpolate(a, b, 0) = a` and `interpolate(a, b, 1) = b`, exactly;
/// - constant speed along a shortest curve: `distance(a, interpolate(a, b, t)) = t · distance(a, b)`
///   up to rounding (with another metric, put on by [`WithMetric`](crate::WithMetric), this may not
///   hold: maximum displacement measures chords);
/// - every sample is contained, and so is every state between two contained ones;
/// - no two contained states are farther apart than `extent`.
///
/// Threads share spaces, and pass states to each other.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no configuration space",
    label = "not a `Space`",
    note = "implement `Space`; or take one of `Rn`, `Se2`, `Se3`, `Joints`, `Product`"
)]
pub trait Space: Sync {
    /// A configuration. Equality is exact: planners use it to recognise a state they already have.
    type State: Clone + Debug + PartialEq + Send + Sync;

    /// The distance from `from` to `to`, in the space's own unit: finite, not negative, and zero from a state
    /// to itself. It need neither be symmetric nor satisfy the triangle inequality; a space where both hold
    /// is marked [`TrueMetric`].
    fn distance(&self, from: &Self::State, to: &Self::State) -> f64;

    /// Number of degrees of freedom.
    fn dim(&self) -> usize;

    /// An upper bound on the distance between any two states: the diameter of the space.
    ///
    /// Resolutions and steps given as a *fraction* are fractions of this.
    fn extent(&self) -> f64;

    /// The state at fraction `t` ∈ \[0, 1\] of the way from `from` to `to`, written to `out`.
    fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State);

    /// The state at `u` ∈ \[0, 1)^[`dim`](Space::dim): a measure-preserving map of the unit cube
    /// onto the space. Uniform and low-discrepancy samplers both go through it.
    ///
    /// # Panics
    /// When `u.len() < self.dim()`.
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State;

    /// A state drawn uniformly.
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State;

    /// A state drawn uniformly among those whose distances from `from` and to `to` add up to at most
    /// `sum`; where there is none, as `sum` is too small, a state between the two. `None` where the space has no direct method (the
    /// default), or finds no such state within its bounds in a hundred tries: then draw uniformly, and reject.
    fn sample_between(
        &self,
        _from: &Self::State,
        _to: &Self::State,
        _sum: f64,
        _rng: &mut Rng,
    ) -> Option<Self::State> {
        None
    }

    /// Whether `q` is finite and within the bounds of the space.
    fn contains(&self, q: &Self::State) -> bool;

    /// The state that a constant velocity leads to from `from` in `time` seconds (backwards when negative).
    /// Velocities have one number per degree of freedom, translations (m/s) before rotations (rad/s), about
    /// world axes. The state may be out of bounds.
    ///
    /// Contract: as long as no rotation reaches half a turn, the motion is the space's own interpolation,
    /// up to rounding. `None`, the default, where the space has no velocities or their number is not
    /// [`dim`](Space::dim).
    fn moved(&self, _from: &Self::State, _velocity: &[f64], _time: f64) -> Option<Self::State> {
        None
    }

    /// The constant velocity that leads from `from` to `to` in one second along the interpolation, written to
    /// `out`: the inverse of [`moved`](Space::moved). `false`, the default, where the space has no velocities
    /// or the length of `out` is not [`dim`](Space::dim).
    fn velocity_into(&self, _from: &Self::State, _to: &Self::State, _out: &mut [f64]) -> bool {
        false
    }

    /// The state with the position of `position` and the rotation of `rotation`. In a space without
    /// rotations, the default, this is `position` itself.
    ///
    /// Contract: interpolation between states of the same rotation does not turn, and between states of the
    /// same position does not move.
    fn with_rotation_of(&self, position: &Self::State, _rotation: &Self::State) -> Self::State {
        position.clone()
    }

    /// As [`interpolate_into`](Space::interpolate_into), returning the state.
    #[inline]
    fn interpolate(&self, from: &Self::State, to: &Self::State, t: f64) -> Self::State {
        let mut out = from.clone();
        self.interpolate_into(from, to, t, &mut out);
        out
    }
}

/// A space that is a product of factors which move independently of each other: the axes of a
/// box, the angles of a torus, the rotation of a rigid body (one factor, by its angle).
///
/// Each factor has its own true metric and is interpolated at constant speed by itself, so any
/// weighted sum or Euclidean norm over the factors is again a true metric of constant speed.
/// [`Euclidean`](crate::Euclidean), [`ScaledEuclidean`](crate::ScaledEuclidean),
/// [`Manhattan`](crate::Manhattan) and partial shortcuts work on factors.
pub trait Factored: Space {
    /// The factors are numbered from 0 up to this.
    fn factors(&self) -> usize;

    /// Calls `f(i, d)` for each factor `i` in order, `d` ≥ 0 being the distance in that factor.
    fn each_factor(&self, from: &Self::State, to: &Self::State, f: &mut impl FnMut(usize, f64));

    /// An upper bound on the distance in one factor; zero for a factor that does not exist.
    fn factor_extent(&self, factor: usize) -> f64;

    /// Sets one factor of `out` to the state at fraction `t` between `from` and `to`.
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Self::State,
        to: &Self::State,
        t: f64,
        out: &mut Self::State,
    );

    /// How the coordinates of each factor bound the distance in it: a [`KdTree`](crate::KdTree) uses them
    /// under a metric made of factors.
    fn factor_layouts(&self) -> Vec<Layout>;

    /// Calls `put(i, x)` with the coordinates `x` of each factor `i`, factors in order.
    fn embed_factors(&self, state: &Self::State, put: &mut impl FnMut(usize, f64));
}

/// The methods of [`Space`] that the space in a field answers: all but `distance`, `extent` and
/// `sample_between`.
macro_rules! as_inside {
    ($field:tt) => {
        fn dim(&self) -> usize {
            self.$field.dim()
        }
        #[inline]
        fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State) {
            self.$field.interpolate_into(from, to, t, out);
        }
        #[inline]
        fn interpolate(&self, from: &Self::State, to: &Self::State, t: f64) -> Self::State {
            self.$field.interpolate(from, to, t)
        }
        #[inline]
        fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
            self.$field.unit_cube_to_state(u)
        }
        #[inline]
        fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
            self.$field.sample_uniform(rng)
        }
        #[inline]
        fn contains(&self, q: &Self::State) -> bool {
            self.$field.contains(q)
        }
        #[inline]
        fn moved(&self, from: &Self::State, velocity: &[f64], time: f64) -> Option<Self::State> {
            self.$field.moved(from, velocity, time)
        }
        #[inline]
        fn velocity_into(&self, from: &Self::State, to: &Self::State, out: &mut [f64]) -> bool {
            self.$field.velocity_into(from, to, out)
        }
        #[inline]
        fn with_rotation_of(&self, position: &Self::State, rotation: &Self::State) -> Self::State {
            self.$field.with_rotation_of(position, rotation)
        }
    };
}
pub(crate) use as_inside;

/// Linear interpolation that is exact at both ends and never leaves \[a, b\] by rounding.
#[inline]
pub(crate) fn lerp(a: f64, b: f64, t: f64) -> f64 {
    if t < 0.5 { a + (b - a) * t } else { b - (b - a) * (1.0 - t) }
}

/// `low + u · (high - low)` kept within the bounds.
#[inline]
pub(crate) fn scale(low: f64, high: f64, u: f64) -> f64 {
    (low + (high - low) * u).min(high)
}
