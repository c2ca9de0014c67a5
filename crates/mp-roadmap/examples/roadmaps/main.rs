//! Each planner of the crate on a small problem, a file for each.
//!
//! `cargo run -p mp-roadmap --example roadmaps NAME [SEED]`
#![allow(clippy::print_stdout)] // examples talk

mod bridge_prm;
mod gaussian_prm;
mod lazy_prm;
mod obprm;
mod obstacle_geometry_prm;
mod prm;
mod prm_star;
mod regional_prm;
mod shared;
mod visibility_prm;
mod window;

/// Its name, and what it does.
type Example = (&'static str, fn() -> shared::Result);

const EXAMPLES: &[Example] = &[
    ("bridge_prm", bridge_prm::main),
    ("gaussian_prm", gaussian_prm::main),
    ("lazy_prm", lazy_prm::main),
    ("obprm", obprm::main),
    ("obstacle_geometry_prm", obstacle_geometry_prm::main),
    ("prm", prm::main),
    ("prm_star", prm_star::main),
    ("regional_prm", regional_prm::main),
    ("visibility_prm", visibility_prm::main),
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
