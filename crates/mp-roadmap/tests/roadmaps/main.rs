//! Roadmaps on problems whose answer is known.

mod around;
#[path = "../../../mp-tree/tests/common/mod.rs"]
mod common;
mod conformance;
mod engine;
mod keep;
mod regions;

use mp_cspace::registry::PlannerInfo;

/// The planners that need not know what obstacles look like; [`around`] tests the others.
fn blind() -> impl Iterator<Item = &'static PlannerInfo> {
    let asks = ["obprm", "obstacle-geometry-prm"];
    mp_roadmap::planners().iter().filter(move |info| !asks.contains(&info.name))
}
