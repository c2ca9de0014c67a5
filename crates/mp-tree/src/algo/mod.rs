//! The named algorithms, one file each, and the list of those that are made by name.

pub mod add_rrt;
pub mod aorrtc;
pub mod bi_rrt;
pub mod con_con;
pub mod con_ext;
pub mod cvp_rrt;
pub mod cyclic_rrt;
pub mod dd_rrt;
pub mod informed_rrt_star;
pub mod mvb_rrt;
pub mod obrrt;
pub mod or_parallel;
pub mod rc_rrt;
pub mod restarts;
pub mod rrs;
pub mod rrs_connect;
pub mod rrt;
pub mod rrt_connect;
pub mod rrt_inputs;
pub mod rrt_star;
pub mod rsrt;
pub mod shared_tree;
pub mod utility_rrt;

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
    rrt: Rrt;
    rrt_connect: RrtConnect;
    bi_rrt: BiRrt;
    con_ext: RrtConExt;
    con_con: RrtConCon;
    rrt_star: RrtStar;
    informed_rrt_star: Informed, InformedRrtStar;
    aorrtc: Aorrtc;
    rrt_inputs: RrtInputs;
    rsrt: Rsrt;
    cvp_rrt: CvpRrt, LeastViolated;
    rc_rrt: RcRrt, Unexhausted;
    dd_rrt: DdRrt, Domain, DynamicDomain;
    add_rrt: ;
    mvb_rrt: MvbRrt, VoronoiBias;
    utility_rrt: UtilityGuided, UtilityRrt;
    obrrt: GrowthWeights, Obrrt, ObstacleGuided;
    cyclic_rrt: Cyclic, CyclicRrt, Listed;
    rrs: Rrs;
    rrs_connect: RrsConnect;
}
