//! Visib-PRM: the few guards and connections that cover a ring of walls and what is around.
//!
//! `cargo run -p mp-roadmap --example roadmaps visibility_prm [SEED]`

use crate::shared;
use mp_cspace::Iterations;
use mp_roadmap::VisibilityPrm;

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let planner = VisibilityPrm::new(shared::bug_trap(&space)?, 2_000)?;
    let mut builder = planner.into_builder();
    let reason = builder.build(&mut shared::rng()?, &mut Iterations(1_000_000), &mut ());
    let map = builder.map();
    for id in 0..map.len() as u32 {
        let q = map.state(id);
        println!("{:<10} {:8.3} {:8.3}", map.tag(id).kind.name(), q.x, q.y);
    }
    println!(
        "{reason:?}: the guards see about {:.2}% of the free space",
        100.0 * builder.connector().coverage()
    );
    shared::tell(map);
    Ok(())
}
