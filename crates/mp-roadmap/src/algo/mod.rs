//! The algorithms and the list of those that can be made by name: one file each.
//!
//! | algorithm | | nodes | edges |
//! |---|---|---|---|
//! | [`Prm`](crate::Prm) | [`prm`] | uniform, then more where connecting is difficult | to near nodes of other components |
//! | [`PrmStar`](crate::PrmStar) | [`prm_star`] | uniform | to a growing number of near nodes; anytime |
//! | [`LazyPrm`](crate::LazyPrm) | [`lazy_prm`] | uniform, not checked | to near nodes, checked when a path leads along them |
//! | [`VisibilityPrm`](crate::VisibilityPrm) | [`visibility_prm`] | guards that see no other guard; connections that see two components | from connections to guards |
//! | [`GaussianPrm`](crate::GaussianPrm) | [`gaussian_prm`] | near obstacles | as PRM |
//! | [`BridgePrm`](crate::BridgePrm) | [`bridge_prm`] | between obstacles, and uniform | as PRM |
//! | [`Obprm`](crate::Obprm) | [`obprm`] | on and near the surfaces of obstacles | as PRM, or to near nodes of each obstacle; then by turns in place |
//! | [`ObstacleGeometryPrm`](crate::ObstacleGeometryPrm) | [`obstacle_geometry_prm`] | far from obstacles, by spheres; near them, by their direction and volume | as PRM; then by turns in place far from obstacles |
//! | [`RegionalPrm`](crate::RegionalPrm) | [`regional_prm`] | uniform, region by region | as PRM within each region, then between adjacent regions |

pub mod bridge_prm;
pub mod gaussian_prm;
pub mod lazy_prm;
pub mod obprm;
pub mod obstacle_geometry_prm;
pub mod prm;
pub mod prm_star;
pub mod regional_prm;
pub mod visibility_prm;

use crate::by_name::{BuildFn, Types};
use mp_cspace::registry::PlannerInfo;

/// Lists the planners that can be made by name, each with the types of its file that the crate exports. Each
/// file has an `INFO` and a `make`.
macro_rules! planners {
    ($($module:ident: $($kind:ident),*;)+) => {
        /// All planners that can be made by name.
        pub(crate) const PLANNERS: &[PlannerInfo] = &[$($module::INFO),+];

        /// The planner called `name`, and the function that makes it.
        pub(crate) fn find<'c, 's, T: Types<'c>>(name: &str) -> Option<(&'static PlannerInfo, BuildFn<'c, 's, T>)> {
            $(if $module::INFO.is_called(name) {
                return Some((&$module::INFO, $module::make));
            })+
            None
        }

        /// The types that the crate exports.
        pub(crate) mod types {
            $($(pub use super::$module::$kind;)*)+
        }
    };
}

planners! {
    prm: Learn, Learning, Prm;
    prm_star: PrmStar, Star;
    lazy_prm: AroundRemoved, LazyPrm;
    visibility_prm: Visibility, VisibilityPrm;
    gaussian_prm: GaussianPrm, NearObstacles;
    bridge_prm: BetweenObstacles, BridgePrm;
    obprm: Obprm, OnObstacles, OnSurfaces, Strategy;
    obstacle_geometry_prm: AroundObstacles, ByGeometry, ObstacleGeometryPrm;
    regional_prm: InRegions, RegionalPrm, Regions, Subdivision;
}
