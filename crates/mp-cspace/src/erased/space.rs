//! A space behind a pointer.

use crate::{Rng, Space, TrueMetric};
use std::fmt::{self, Debug};
use std::sync::Arc;

/// The methods of [`Space`] as a trait object.
trait ErasedSpace<S>: Send + Sync {
    fn dim(&self) -> usize;
    fn distance(&self, from: &S, to: &S) -> f64;
    fn interpolate_into(&self, from: &S, to: &S, t: f64, out: &mut S);
    fn interpolate(&self, from: &S, to: &S, t: f64) -> S;
    fn unit_cube_to_state(&self, u: &[f64]) -> S;
    fn sample_uniform(&self, rng: &mut Rng) -> S;
    fn sample_between(&self, from: &S, to: &S, sum: f64, rng: &mut Rng) -> Option<S>;
    fn contains(&self, q: &S) -> bool;
    fn moved(&self, from: &S, velocity: &[f64], time: f64) -> Option<S>;
    fn velocity_into(&self, from: &S, to: &S, out: &mut [f64]) -> bool;
    fn with_rotation_of(&self, position: &S, rotation: &S) -> S;
}

impl<S, C: Space<State = S> + Send> ErasedSpace<S> for C {
    fn dim(&self) -> usize {
        Space::dim(self)
    }
    fn distance(&self, from: &S, to: &S) -> f64 {
        Space::distance(self, from, to)
    }
    fn interpolate_into(&self, from: &S, to: &S, t: f64, out: &mut S) {
        Space::interpolate_into(self, from, to, t, out);
    }
    fn interpolate(&self, from: &S, to: &S, t: f64) -> S {
        Space::interpolate(self, from, to, t)
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> S {
        Space::unit_cube_to_state(self, u)
    }
    fn sample_uniform(&self, rng: &mut Rng) -> S {
        Space::sample_uniform(self, rng)
    }
    fn sample_between(&self, from: &S, to: &S, sum: f64, rng: &mut Rng) -> Option<S> {
        Space::sample_between(self, from, to, sum, rng)
    }
    fn contains(&self, q: &S) -> bool {
        Space::contains(self, q)
    }
    fn moved(&self, from: &S, velocity: &[f64], time: f64) -> Option<S> {
        Space::moved(self, from, velocity, time)
    }
    fn velocity_into(&self, from: &S, to: &S, out: &mut [f64]) -> bool {
        Space::velocity_into(self, from, to, out)
    }
    fn with_rotation_of(&self, position: &S, rotation: &S) -> S {
        Space::with_rotation_of(self, position, rotation)
    }
}

/// Any space whose states are `S`, behind a pointer: the same distances, samples and interpolations, to the bit.
///
/// ```
/// use mp_cspace::{Manhattan, Rn, Space, WithMetric, erased::AnySpace};
/// use nalgebra::Vector2;
/// let (own, manhattan) = (Rn::<2>::new([0.0; 2], [3.0, 4.0])?, Manhattan);
/// let other = WithMetric::new(own.clone(), manhattan);
/// // Two types of spaces, one type of erased ones.
/// let extents = [AnySpace::new(&own), AnySpace::new(&other)].map(|space| space.extent());
/// assert_eq!(extents, [5.0, 7.0]);
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
pub struct AnySpace<'c, S> {
    space: Arc<dyn ErasedSpace<S> + 'c>,
    /// Kept here because it is read often and never changes.
    extent: f64,
}

impl<'c, S> AnySpace<'c, S> {
    /// A copy of `space`, erased. Clones of the result share that copy.
    pub fn new<C: Space<State = S> + Clone + Send + 'c>(space: &C) -> Self {
        Self { space: Arc::new(space.clone()), extent: space.extent() }
    }
}

// Derived, it would require `S: Clone`.
impl<S> Clone for AnySpace<'_, S> {
    fn clone(&self) -> Self {
        Self { space: Arc::clone(&self.space), extent: self.extent }
    }
}

impl<S> Debug for AnySpace<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (dim, extent) = (self.space.dim(), self.extent);
        f.debug_struct("AnySpace").field("dim", &dim).field("extent", &extent).finish_non_exhaustive()
    }
}

impl<S: Clone + Debug + PartialEq + Send + Sync> Space for AnySpace<'_, S> {
    type State = S;
    #[inline]
    fn distance(&self, from: &S, to: &S) -> f64 {
        self.space.distance(from, to)
    }

    fn dim(&self) -> usize {
        self.space.dim()
    }
    #[inline]
    fn extent(&self) -> f64 {
        self.extent
    }
    #[inline]
    fn interpolate_into(&self, from: &S, to: &S, t: f64, out: &mut S) {
        self.space.interpolate_into(from, to, t, out);
    }
    #[inline]
    fn interpolate(&self, from: &S, to: &S, t: f64) -> S {
        self.space.interpolate(from, to, t)
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> S {
        self.space.unit_cube_to_state(u)
    }
    #[inline]
    fn sample_uniform(&self, rng: &mut Rng) -> S {
        self.space.sample_uniform(rng)
    }
    fn sample_between(&self, from: &S, to: &S, sum: f64, rng: &mut Rng) -> Option<S> {
        self.space.sample_between(from, to, sum, rng)
    }
    fn contains(&self, q: &S) -> bool {
        self.space.contains(q)
    }
    fn moved(&self, from: &S, velocity: &[f64], time: f64) -> Option<S> {
        self.space.moved(from, velocity, time)
    }
    fn velocity_into(&self, from: &S, to: &S, out: &mut [f64]) -> bool {
        self.space.velocity_into(from, to, out)
    }
    fn with_rotation_of(&self, position: &S, rotation: &S) -> S {
        self.space.with_rotation_of(position, rotation)
    }
}

/// Marks every erased space, whatever the space inside: only the [index](crate::erased::AnyIndex) relies on the mark,
/// and it keeps the space it was made for.
impl<S> TrueMetric for AnySpace<'_, S> {}
