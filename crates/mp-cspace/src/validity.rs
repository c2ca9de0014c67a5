//! When a state, and when a motion, is free.

/// Whether a state is free.
///
/// Scratch memory and counters are plain fields of the implementor: clone it per thread.
/// Closures implement it.
pub trait Validity<S> {
    /// Whether `q` is free (no collision, every constraint holds).
    fn is_valid(&mut self, q: &S) -> bool;
}

impl<S, F: FnMut(&S) -> bool> Validity<S> for F {
    #[inline]
    fn is_valid(&mut self, q: &S) -> bool {
        self(q)
    }
}

/// A lower bound on how far the robot is from touching anything, in metres.
pub trait Clearance<S> {
    /// A lower bound on the distance between the robot at `q` and the nearest obstacle.
    ///
    /// The search may stop as soon as the bound reaches `enough`: any return value ≥ `enough`
    /// says only "at least `enough`". Zero or less means contact, or no bound known.
    fn clearance(&mut self, q: &S, enough: f64) -> f64;
}

/// An upper bound on how far any point of the robot travels, in metres.
pub trait MotionBound<S> {
    /// An upper bound on the length of the curve traced by any point of the robot while it moves
    /// from `from` to `to` along the space's interpolation.
    ///
    /// Travel is at constant speed: over a part `dt` of the motion, no point travels farther
    /// than `dt` times this.
    fn motion_bound(&self, from: &S, to: &S) -> f64;
}

/// What a check of a whole motion found. Times are fractions of the motion in \[0, 1\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionCheck {
    /// Free all along; `clearance` (m) is a lower bound on the distance to any obstacle over the
    /// whole motion, zero where the check does not know one (a discrete check never does).
    Free {
        /// Lower bound on clearance, metres.
        clearance: f64,
    },
    /// The state at fraction `at` is in collision.
    Collides {
        /// Fraction of the motion.
        at: f64,
    },
    /// Within the tolerance of contact at fraction `at` (grazing): neither proved. Planners treat
    /// it as a collision.
    Undecided {
        /// Fraction of the motion.
        at: f64,
    },
}

impl MotionCheck {
    /// Whether the motion was found free.
    #[must_use]
    pub fn is_free(&self) -> bool {
        matches!(self, Self::Free { .. })
    }
}

/// Whether a whole motion along the space's interpolation is free.
///
/// Both what planners check edges with (discrete or certified) and what independently verifies
/// a finished path implement it.
pub trait MotionValidity<S> {
    /// Checks the motion from `from` to `to`, both ends included.
    fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck;
}

impl<S, V: MotionValidity<S> + ?Sized> MotionValidity<S> for &mut V {
    fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck {
        (**self).check_motion(from, to)
    }
}
impl<S, V: MotionValidity<S> + ?Sized> MotionValidity<S> for Box<V> {
    fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck {
        (**self).check_motion(from, to)
    }
}
