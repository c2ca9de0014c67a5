//! A space behind a pointer.

use crate::{Rng, Space, TrueMetric, space::as_inside};
use std::fmt::{self, Debug};
use std::sync::Arc;

/// Any space whose states are `S`, behind a pointer: the same distances, samples and interpolations, to the
/// bit.
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
    space: Arc<dyn Space<State = S> + Send + 'c>,
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
        f.debug_struct("AnySpace").field("extent", &self.extent).finish_non_exhaustive()
    }
}

impl<S: Clone + Debug + PartialEq + Send + Sync> Space for AnySpace<'_, S> {
    type State = S;
    #[inline]
    fn distance(&self, from: &S, to: &S) -> f64 {
        self.space.distance(from, to)
    }
    #[inline]
    fn extent(&self) -> f64 {
        self.extent
    }
    fn sample_between(&self, from: &S, to: &S, sum: f64, rng: &mut Rng) -> Option<S> {
        self.space.sample_between(from, to, sum, rng)
    }
    as_inside!(space);
}

/// Marks every erased space, whatever the space inside: only the [index](crate::erased::AnyIndex) relies on
/// the mark, and it keeps the space it was made for.
impl<S> TrueMetric for AnySpace<'_, S> {}
