//! How much checking a robot has done.

use mp_collide::{Counters, Query};

/// Counts of the checks a robot has made. The same queries always give the same counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct CheckCounters {
    /// Configurations tested for collision.
    pub collision_checks: u64,
    /// Configurations whose clearance was computed.
    pub clearance_checks: u64,
    /// The boxes and triangles compared for these checks.
    pub work: Counters,
}

impl CheckCounters {
    /// Collision and clearance checks together.
    #[must_use]
    pub fn queries(&self) -> u64 {
        self.collision_checks + self.clearance_checks
    }

    /// These counts with the work of `query`.
    pub(crate) fn with(self, query: &Query) -> Self {
        Self { work: query.counters, ..self }
    }

    /// Sets these counts and those of `query` to zero. Returns the counts before.
    pub(crate) fn take(&mut self, query: &mut Query) -> Self {
        let counters = self.with(query);
        *self = Self::default();
        query.counters = Counters::default();
        counters
    }
}

impl std::ops::AddAssign for CheckCounters {
    fn add_assign(&mut self, other: Self) {
        self.collision_checks += other.collision_checks;
        self.clearance_checks += other.clearance_checks;
        self.work += other.work;
    }
}
