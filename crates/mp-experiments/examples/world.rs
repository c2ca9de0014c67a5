//! Prints a world of the experiment of Jouandeau et al. 2008 as a scene file, or the arm that its scenes
//! name:
//!
//! ```text
//! cargo run -p mp-experiments --example world free-flyer 64 0 > flyer.toml     # robot, number of boxes, instance
//! cargo run -p mp-experiments --example world "6-DOF arm" 64 0 > scenes/arm.toml
//! cargo run -p mp-experiments --example world "6-DOF arm" > robots/rsrt-arm.urdf
//! ```
#![allow(clippy::print_stdout)] // examples talk

use mp_experiments::clutter::{MOVERS, Mover};

fn main() -> mp_experiments::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [robot, count, instance] => {
            print!("{}", Mover::find(robot)?.scene_text(count.parse()?, instance.parse()?)?);
        }
        [robot] => match Mover::find(robot)?.urdf() {
            Some((_, text)) => print!("{text}"),
            None => return Err(format!("the {robot} has no file of its own").into()),
        },
        _ => {
            return Err(
                format!("say a robot ({}), a number of boxes and an instance", MOVERS.join(", ")).into()
            );
        }
    }
    Ok(())
}
