//! Systems whose inputs are velocities.

use crate::{Flow, Input, InputError};
use mp_cspace::Space;

/// Configurations of any space, moved at constant velocity. Inputs are velocities, one number per degree
/// of freedom, as [`Space::moved`] takes them: a free-flyer is `Kinematic` on SE(3), an arm on R^n, a
/// holonomic planar body on SE(2).
///
/// Motions that turn by less than half a turn are the space's own interpolation, so any motion check and
/// verifier of straight motions can be used for them.
#[derive(Debug)]
pub struct Kinematic<'c, C> {
    space: &'c C,
}

impl<C> Clone for Kinematic<'_, C> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<C> Copy for Kinematic<'_, C> {}

impl<'c, C: Space> Kinematic<'c, C> {
    /// The configurations of `space`, moved by velocities.
    ///
    /// # Errors
    /// When the space has no velocities.
    pub fn new(space: &'c C) -> Result<Self, InputError> {
        let dim = space.dim();
        let middle = space.unit_cube_to_state(&vec![0.5; dim]);
        match space.moved(&middle, &vec![0.0; dim], 1.0) {
            Some(_) => Ok(Self { space }),
            None => Err(InputError::NoMotion { entries: dim, dim }),
        }
    }
}

impl<C: Space, U: Input> Flow<C::State, U> for Kinematic<'_, C> {
    /// An input with another number of entries does not move the state.
    #[inline]
    fn integrate(&self, from: &C::State, input: &U, time: f64) -> C::State {
        self.space.moved(from, input.entries(), time).unwrap_or_else(|| from.clone())
    }
    #[inline]
    fn reversed(&self, to: &C::State, input: &U, time: f64) -> Option<C::State> {
        self.space.moved(to, input.entries(), -time)
    }
}
