//! OBPRM: a bar is turned to pass a window between four beams.
//!
//! `cargo run -p mp-roadmap --example obprm [SEED]`

mod window;

use mp_roadmap::{Obprm, OnSurfaces};

fn main() -> window::Result {
    let (space, robot) = (window::space()?, window::bar()?);
    let problem = window::problem(&space, &robot)?;
    window::run(Obprm::new(problem, robot, window::REACH, OnSurfaces::default())?)
}
