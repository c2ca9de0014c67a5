//! The algorithms and the list of those that can be made by name: one file each, but for those that differ in
//! one slot.
//!
//! | algorithm | | trees | per iteration |
//! |---|---|---|---|
//! | [`Rrt`](crate::Rrt) | [`rrt`] | from the start | one step toward a sample |
//! | [`CyclicRrt`](crate::CyclicRrt) | [`cyclic_rrt`] | from the start, with cycles | as RRT, or an edge to a similar node; lists alternative paths |
//! | [`RrtConnect`](crate::RrtConnect) | [`rrt_connect`] | from start and goal | one step toward a sample; then the other tree all the way to it |
//! | [`Aorrtc`](crate::Aorrtc) | [`aorrtc`] | from start and goal, new ones for each better path | as RRT-Connect, in the space of states and costs; anytime |
//! | [`RrtStar`](crate::RrtStar) | [`rrt_star`] | from the start, rewired | one step toward a sample, inserted under the cheapest parent; anytime |
//! | [`InformedRrtStar`](crate::InformedRrtStar) | [`informed_rrt_star`] | from the start, rewired | as RRT*, toward samples that can be on a better path |
//! | [`BiRrt`](crate::BiRrt) | [`rrt_connect`] | from start and goal | one step toward a sample; then one step of the other tree toward it |
//! | [`RrtConExt`](crate::RrtConExt) | [`rrt_connect`] | from start and goal | all the way toward a sample; then one step of the other tree |
//! | [`RrtConCon`](crate::RrtConCon) | [`rrt_connect`] | from start and goal | all the way toward a sample; then the other tree all the way to it |
//! | [`RrtInputs`](crate::RrtInputs) | [`rrt_inputs`] | from the start, by a set of inputs | the best of all successors free of collision |
//! | [`CvpRrt`](crate::CvpRrt) | [`cvp_rrt`] | from the start, by a set of inputs | one untried input, at a node that has not often failed |
//! | [`RcRrt`](crate::RcRrt) | [`rc_rrt`] | from the start, by a set of inputs | untried inputs, until all are exhausted |
//! | [`Rsrt`](crate::Rsrt) | [`rsrt`] | from the start, by a set of inputs | the first successor free of collision, sorted by distance |
//! | [`DdRrt`](crate::DdRrt) | [`dd_rrt`] | from start and goal | as RRT-Connect, without samples far from nodes that failed |
//! | [`DdRrt`](crate::DdRrt) | [`dd_rrt`] | from start and goal | the same, each node learning what is far |
//! | [`MvbRrt`](crate::MvbRrt) | [`mvb_rrt`] | from start and goal | as RRT-Connect, toward the mean of the samples nearest to one node |
//! | [`UtilityRrt`](crate::UtilityRrt) | [`utility_rrt`] | from start and goal | as RRT-Connect, the most promising of several expansions |
//! | [`RetractionRrt`](crate::RetractionRrt) | [`retraction_rrt`] | from start and goal | as RRT-Connect; what is blocked goes on along the obstacle |
//! | [`Obrrt`](crate::Obrrt) | [`obrrt`] | from the start | one step toward a sample or along an obstacle, by hints |
//! | [`ObrrtConnect`](crate::ObrrtConnect) | [`obrrt`] | from start and goal | as RRT-Connect, one step toward a sample or along an obstacle; or on as the tree came: [`walks`] |
//! | [`TRrt`](crate::TRrt) | [`t_rrt`] | from the start | one step toward a sample, if its end does not cost too much more |
//! | [`Rrs`](crate::Rrs) | [`rrs`] | from the start, of edges that bend | one step toward a sample, around obstacles by a snake |
//! | [`RrsConnect`](crate::RrsConnect) | [`rrs`] | from start and goal, of edges that bend | as RRT-Connect, around obstacles by snakes |
//!
//! [`SharedTree`](crate::SharedTree) ([`shared_tree`]) is RRT, and [`SharedBiRrt`](crate::SharedBiRrt)
//! ([`shared_bi_rrt`]) is Bi-RRT, with trees that all threads grow.

pub mod aorrtc;
pub mod cvp_rrt;
pub mod cyclic_rrt;
pub mod dd_rrt;
pub mod informed_rrt_star;
pub mod mvb_rrt;
pub mod obrrt;
pub mod or_parallel;
pub mod rc_rrt;
pub mod restarts;
pub mod retraction_rrt;
pub mod rrs;
pub mod rrt;
pub mod rrt_connect;
pub mod rrt_inputs;
pub mod rrt_star;
pub mod rsrt;
pub mod shared_bi_rrt;
pub mod shared_tree;
pub mod t_rrt;
pub mod utility_rrt;
pub mod walks;

use crate::by_name::{BuildFn, Types};
use mp_cspace::registry::PlannerInfo;

/// Lists the planners that can be made by name: the module of each, with an `INFO` and a `make`, and the
/// types beside these that the crate exports.
macro_rules! planners {
    ($($file:ident $(::$module:ident)?: $($kind:ident),*;)+) => {
        /// All planners that can be made by name.
        pub(crate) const PLANNERS: &[PlannerInfo] = &[$($file$(::$module)?::INFO),+];

        /// The planner called `name`, and the function that makes it.
        pub(crate) fn find<'c, 's, T: Types<'c>>(name: &str) -> Option<(&'static PlannerInfo, BuildFn<'c, 's, T>)> {
            $(if $file$(::$module)?::INFO.is_called(name) {
                return Some((&$file$(::$module)?::INFO, $file$(::$module)?::make));
            })+
            None
        }

        /// The types that the crate exports.
        pub(crate) mod types {
            pub use super::walks::Walks;
            $($(pub use super::$file::$kind;)*)+
        }
    };
}

planners! {
    rrt: Rrt;
    rrt_connect::ext_con: RrtConnect;
    rrt_connect::ext_ext: BiRrt;
    rrt_connect::con_ext: RrtConExt;
    rrt_connect::con_con: RrtConCon;
    rrt_star: RrtStar;
    informed_rrt_star: Informed, InformedRrtStar;
    aorrtc: Aorrtc;
    rrt_inputs: RrtInputs;
    rsrt: Rsrt;
    cvp_rrt: CvpRrt, LeastViolated;
    rc_rrt: RcRrt, Unexhausted;
    dd_rrt: DdRrt, Domain, DynamicDomain;
    dd_rrt::adaptive: ;
    mvb_rrt: MvbRrt, VoronoiBias;
    utility_rrt: UtilityGuided, UtilityRrt;
    retraction_rrt: Retract, RetractionRrt;
    obrrt: GrowthWeights, Obrrt, ObrrtConnect, ObstacleGuided;
    obrrt::connect: ;
    cyclic_rrt: Cyclic, CyclicRrt, Listed;
    rrs: Rrs;
    rrs::connect: RrsConnect;
    t_rrt: TRrt, Temperature, Transition;
}
