//! RrsConnect: a point leaves a bug trap in the plane by edges that bend.
//!
//! `cargo run -p mp-tree --example trees rrs_connect [SEED]`

use crate::shared;
use mp_tree::RrsConnect;

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let problem = shared::bending_trap(&space)?;
    shared::run(RrsConnect::new(problem, shared::tuning())?)
}
