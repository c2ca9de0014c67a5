//! Which module a page with a planner inside needs.

use mp_plan::{PathFormat, Scene};

/// The name of the module of `mp-wasm` that plans for the robot of a scene: `rigid`, `planar` or `arms`.
#[must_use]
pub fn planner_module(scene: &Scene) -> &'static str {
    match (scene.path_format(), scene.is_planar_world()) {
        (PathFormat::Poses, _) => "rigid",
        (_, true) => "planar",
        _ => "arms",
    }
}
