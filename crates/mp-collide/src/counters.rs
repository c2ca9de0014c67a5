//! Counters of the work of queries.

/// How much work queries have done: the same numbers for the same queries, on any machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Queries answered (each pose of a batch counts).
    pub queries: u64,
    /// Pairs of boxes compared.
    pub box_tests: u64,
    /// Pairs of triangles compared.
    pub triangle_tests: u64,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.queries += other.queries;
        self.box_tests += other.box_tests;
        self.triangle_tests += other.triangle_tests;
    }
}
