//! Rrs: a point leaves a bug trap in the plane by edges that bend.
//!
//! `cargo run -p mp-tree --example trees rrs [SEED]`

use crate::shared;
use mp_tree::Rrs;

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let problem = shared::bending_trap(&space)?;
    shared::run(Rrs::new(problem, shared::tuning())?)
}
