//! The one random number generator of the workspace.

use rand::{RngExt, SeedableRng, TryRng};
use std::convert::Infallible;
use std::f64::consts::TAU;

/// A seeded PCG-64 generator (O'Neill 2014, *PCG*).
///
/// All randomness of a planner flows from one seed. Parallel work item `i` uses
/// [`Rng::stream`]`(seed, i)`, so that results do not depend on the number of threads.
///
/// ```
/// use mp_cspace::Rng;
/// use rand::RngExt;
/// let (mut a, mut b) = (Rng::seed(7), Rng::seed(7));
/// assert_eq!(a.random::<u64>(), b.random::<u64>());
/// assert_ne!(Rng::stream(7, 0).random::<u64>(), Rng::stream(7, 1).random::<u64>());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rng(rand_pcg::Pcg64);

impl Rng {
    /// The generator of `seed`.
    #[must_use]
    pub fn seed(seed: u64) -> Self {
        Self(rand_pcg::Pcg64::seed_from_u64(seed))
    }

    /// Independent stream `i` of `seed`, for parallel work item `i`.
    #[must_use]
    pub fn stream(seed: u64, i: u64) -> Self {
        // The stream number selects the increment of the congruential generator; mixing the
        // state as well keeps neighbouring (seed, i) pairs apart from the first output on.
        let state =
            u128::from(seed) ^ (u128::from(i).wrapping_mul(0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c835));
        Self(rand_pcg::Pcg64::new(state, u128::from(i)))
    }

    /// A number drawn uniformly from \[0, 1): enough to sample a space of your own. For other distributions
    /// use the crate `rand`, of which this is a generator.
    pub fn unit(&mut self) -> f64 {
        self.random()
    }

    /// A standard normal deviate (Box and Muller 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.random::<f64>(), self.random::<f64>());
        (-2.0 * mp_math::ln(u)).sqrt() * mp_math::cos(TAU * v)
    }
}

impl TryRng for Rng {
    type Error = Infallible;
    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.0.try_next_u32()
    }
    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.0.try_next_u64()
    }
    #[inline]
    fn try_fill_bytes(&mut self, dst: &mut [u8]) -> Result<(), Infallible> {
        self.0.try_fill_bytes(dst)
    }
}
