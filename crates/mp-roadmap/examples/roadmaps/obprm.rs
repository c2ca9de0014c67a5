//! OBPRM: a bar is turned to pass a window between four beams.
//!
//! `cargo run -p mp-roadmap --example roadmaps obprm [SEED]`

use crate::window;
use mp_roadmap::{Obprm, OnSurfaces};

pub(crate) fn main() -> window::Result {
    let (space, robot) = (window::space()?, window::bar()?);
    let problem = window::problem(&space, &robot)?;
    window::run(Obprm::new(problem, robot, window::REACH, OnSurfaces::default())?)
}
