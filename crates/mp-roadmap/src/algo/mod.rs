//! The named algorithms, one file each, and the list of those that are made by name.

pub mod bridge_prm;
pub mod gaussian_prm;
pub mod lazy_prm;
pub mod obprm;
pub mod obstacle_geometry_prm;
pub mod prm;
pub mod prm_star;
pub mod visibility_prm;

use crate::by_name::{Maker, Types};
use mp_cspace::PlannerInfo;

/// Lists the planners made by name, each with the types of its file that stand at the root of the crate. Each file has an
/// `INFO` and a `make`.
macro_rules! planners {
    ($($module:ident: $($kind:ident),*;)+) => {
        /// All of them.
        pub(crate) const PLANNERS: &[PlannerInfo] = &[$($module::INFO),+];

        /// The planner called `name`, and what makes it.
        pub(crate) fn find<'c, 's, T: Types<'c>>(name: &str) -> Option<(&'static PlannerInfo, Maker<'c, 's, T>)> {
            $(if $module::INFO.is_called(name) {
                return Some((&$module::INFO, $module::make));
            })+
            None
        }

        /// Their types.
        pub(crate) mod types {
            $($(pub use super::$module::$kind;)*)+
        }
    };
}

planners! {
    prm: Learn, Learning, Prm;
    prm_star: PrmStar, Star;
    lazy_prm: LazyPrm, Unchecked;
    visibility_prm: Visibility, VisibilityPrm;
    gaussian_prm: GaussianPrm, NearObstacles;
    bridge_prm: BetweenObstacles, BridgePrm;
    obprm: Obprm, OnObstacles, OnSurfaces, Strategy;
    obstacle_geometry_prm: AroundObstacles, ByGeometry, ObstacleGeometryPrm;
}
