//! Walks: two trees, half of whose steps go on as they came, leave a bug trap in the plane.
//!
//! `cargo run -p mp-tree --example trees walks [SEED]`

use crate::shared;
use mp_cspace::{Linear, Uniform};
use mp_tree::{Append, Connect, Extend, NearestSelector, Samples, TreePlannerParts, TwoTrees, Walks};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let parts = TreePlannerParts {
        target_sampler: Samples(Uniform(&space)),
        selector: NearestSelector(Linear::default()),
        extender: (Walks::new(Extend, 0.5)?, Connect::default()),
        inserter: Append,
        tuning: shared::tuning(),
    };
    shared::run(TwoTrees::assemble("walks", shared::bug_trap(&space)?, parts)?)
}
