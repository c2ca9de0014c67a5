//! The named algorithms, one file each.

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
