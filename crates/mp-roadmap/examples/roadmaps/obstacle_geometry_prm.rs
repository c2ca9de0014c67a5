//! Obstacle-geometry PRM: a bar is turned to pass a window between four beams.
//!
//! `cargo run -p mp-roadmap --example roadmaps obstacle_geometry_prm [SEED]`

use crate::window;
use mp_roadmap::{ByGeometry, ObstacleGeometryPrm};

pub(crate) fn main() -> window::Result {
    let (space, robot) = (window::space()?, window::bar()?);
    let problem = window::problem(&space, &robot)?;
    window::run(ObstacleGeometryPrm::new(problem, robot, window::REACH, ByGeometry::default())?)
}
