//! RRTConExt: a point leaves a bug trap in the plane.
//!
//! `cargo run -p mp-tree --example trees con_ext [SEED]`

use crate::shared;
pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    shared::run(mp_tree::RrtConExt::new(shared::bug_trap(&space)?, shared::tuning())?)
}
