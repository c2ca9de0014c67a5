//! The problems as scene files.

use mp_cspace::{Rng, Validity};
use mp_experiments::clutter::{MOVERS, Mover, Obstacle};
use mp_geom::pose_from_six;
use mp_io::{Disk, PlacedBody, RigidTask, RobotProblem};
use mp_robot::{Arm, ArmModel, FreeFlyer};
use nalgebra::SVector;
use rand::RngExt;
use std::path::{Path, PathBuf};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../mp-scenes/assets").join(name)
}

fn shipped(name: &str) -> String {
    std::fs::read_to_string(file(name)).unwrap()
}

const FLYER: &str = "scenes/rsrt-flyer-64.toml";
const ARM: &str = "scenes/rsrt-arm-64.toml";

/// Where they are not, `cargo run -p mp-experiments --example world` prints what they are to be.
#[test]
fn the_shipped_scenes_are_worlds_of_the_experiment() {
    let [flyer, arm] = MOVERS.map(|name| Mover::find(name).unwrap());
    assert_eq!(shipped(FLYER), flyer.scene_text(64, 0).unwrap());
    assert_eq!(shipped(ARM), arm.scene_text(64, 0).unwrap());
    let (robot, text) = arm.urdf().unwrap();
    assert_eq!(shipped(robot), text);
    assert!(shipped(ARM).contains(&format!("urdf = \"../{robot}\"")) && flyer.urdf().is_none());
}

fn bodies(read: &[PlacedBody]) -> impl Iterator<Item = Obstacle> {
    read.iter().map(|body| (body.name.clone(), body.mesh.clone(), body.pose))
}

/// Rows of numbers below `bounds` in magnitude, around `middle`.
fn rows(count: usize, middle: [f64; 6], bounds: [f64; 6]) -> Vec<[f64; 6]> {
    let mut rng = Rng::seed(64);
    let mut row = || std::array::from_fn(|i| middle[i] + rng.random_range(-bounds[i]..=bounds[i]));
    (0..count).map(|_| row()).collect()
}

/// `is_free` says the same as the robot of the experiment, and there are many of both answers.
fn agree(name: &str, rows: &[[f64; 6]], mut is_free: impl FnMut([f64; 6]) -> bool) {
    let mover = Mover::find(name).unwrap();
    let free = mover.are_free(&mover.obstacles(64, 0).unwrap(), rows).unwrap();
    for (row, free) in rows.iter().zip(&free) {
        assert_eq!(is_free(*row), *free, "{name} at {row:?}");
    }
    let count = free.iter().filter(|free| **free).count();
    assert!(
        (rows.len() / 10..rows.len() * 9 / 10).contains(&count),
        "{name}: {count} of {} free",
        rows.len()
    );
}

#[test]
fn a_loaded_scene_has_the_same_free_configurations() {
    let task = RigidTask::load_from(&Disk, &file(FLYER)).unwrap();
    let (problem, pi) = (&task.problem, std::f64::consts::PI);
    let mut flyer = FreeFlyer::new(&problem.robot.mesh, bodies(&problem.obstacles)).unwrap();
    let half_turns = [5.0, 5.0, 5.0, pi, 0.5 * pi, pi];
    let poses = rows(800, [5.0, 5.0, 5.0, 0.0, 0.0, 0.0], half_turns);
    agree(MOVERS[0], &poses, |row| flyer.is_valid(&pose_from_six(row)));

    let problem = RobotProblem::load(file(ARM)).unwrap();
    let model = ArmModel::from_urdf(&problem.robots[0].urdf, |_| Err("it has no meshes".into())).unwrap();
    let mut arm = Arm::new(&model, bodies(&problem.obstacles)).unwrap();
    agree(MOVERS[1], &rows(800, [0.0; 6], [2.6; 6]), |row| arm.is_valid(&SVector::from(row)));
}
