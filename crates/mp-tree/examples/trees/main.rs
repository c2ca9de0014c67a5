//! Each planner of the crate on a small problem, a file for each.
//!
//! `cargo run -p mp-tree --example trees NAME [SEED]`
#![allow(clippy::print_stdout)] // examples talk

mod add_rrt;
mod aorrtc;
mod bi_rrt;
mod car;
mod con_con;
mod con_ext;
mod cvp_rrt;
mod cyclic_rrt;
mod dd_rrt;
mod informed_rrt_star;
mod mvb_rrt;
mod obrrt;
mod obrrt_connect;
mod or_parallel;
mod rc_rrt;
mod restarts;
mod retraction_rrt;
mod rrs;
mod rrs_connect;
mod rrt;
mod rrt_connect;
mod rrt_inputs;
mod rrt_star;
mod rsrt;
mod shared;
mod shared_bi_rrt;
mod shared_tree;
mod t_rrt;
mod utility_rrt;
mod walks;

/// Its name, and what it does.
type Example = (&'static str, fn() -> shared::Result);

const EXAMPLES: &[Example] = &[
    ("add_rrt", add_rrt::main),
    ("aorrtc", aorrtc::main),
    ("bi_rrt", bi_rrt::main),
    ("car", car::main),
    ("con_con", con_con::main),
    ("con_ext", con_ext::main),
    ("cvp_rrt", cvp_rrt::main),
    ("cyclic_rrt", cyclic_rrt::main),
    ("dd_rrt", dd_rrt::main),
    ("informed_rrt_star", informed_rrt_star::main),
    ("mvb_rrt", mvb_rrt::main),
    ("obrrt", obrrt::main),
    ("obrrt_connect", obrrt_connect::main),
    ("or_parallel", or_parallel::main),
    ("rc_rrt", rc_rrt::main),
    ("restarts", restarts::main),
    ("retraction_rrt", retraction_rrt::main),
    ("rrs", rrs::main),
    ("rrs_connect", rrs_connect::main),
    ("rrt", rrt::main),
    ("rrt_connect", rrt_connect::main),
    ("rrt_inputs", rrt_inputs::main),
    ("rrt_star", rrt_star::main),
    ("rsrt", rsrt::main),
    ("shared_bi_rrt", shared_bi_rrt::main),
    ("shared_tree", shared_tree::main),
    ("t_rrt", t_rrt::main),
    ("utility_rrt", utility_rrt::main),
    ("walks", walks::main),
];

fn main() -> shared::Result {
    let name = std::env::args().nth(1).unwrap_or_default();
    match EXAMPLES.iter().find(|(known, _)| *known == name) {
        Some((_, example)) => example(),
        None => {
            let names: Vec<&str> = EXAMPLES.iter().map(|(name, _)| *name).collect();
            Err(format!("name one of {}", names.join(", ")).into())
        }
    }
}
