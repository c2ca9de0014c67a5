//! Rrs: a point leaves a bug trap in the plane by edges that bend.
//!
//! `cargo run -p mp-tree --example rrs [SEED]`

mod shared;

use mp_tree::Rrs;

fn main() -> shared::Result {
    let space = shared::square()?;
    let problem = shared::bending_trap(&space)?;
    shared::run(Rrs::new(problem, shared::tuning())?)
}
