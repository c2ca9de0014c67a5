//! The shipped files are the generated ones, and every scene is a sound problem.

use super::{files_rs, generate, stale};
use mp_cspace::{Clearance, MotionValidity, Rng, Se2, Se2State, Se3, Space, Validity};
use mp_geom::six_from_pose;
use mp_io::{PathFile, RigidProblem, RobotProblem, SpaceKind};
use mp_plan::{ArmScene, Description, FloatingScene, Motion, TypedMotion};
use mp_robot::{FreeFlyer, PlanarFlyer, Verifier};
use nalgebra::Isometry3;
use std::f64::consts::PI;
use std::path::PathBuf;

fn assets() -> PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets")
}

fn scenes() -> Vec<RigidProblem> {
    let files = generate();
    let scenes = files.keys().filter(|path| path.ends_with(".env"));
    scenes.map(|path| RigidProblem::load(assets().join(path)).expect(path)).collect()
}

fn obstacles(p: &RigidProblem) -> Vec<(String, mp_geom::TriMesh, Isometry3<f64>)> {
    p.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose)).collect()
}

fn space(p: &RigidProblem) -> Se3 {
    let b = p.bounds.expect("every scene has bounds");
    Se3::new([b.min.x, b.min.y, b.min.z], [b.max.x, b.max.y, b.max.z]).unwrap()
}

/// The radius of the robot about its origin.
fn radius(p: &RigidProblem) -> f64 {
    p.robot.mesh.vertices().iter().map(|v| v.coords.norm()).fold(0.0, f64::max)
}

#[test]
fn committed_files_are_regenerated_bit_for_bit() {
    let files = generate();
    assert_eq!(files, generate());
    for (path, bytes) in &files {
        let found = std::fs::read(assets().join(path)).expect(path);
        assert!(found == *bytes, "{path} differs: run `mp-bench assets`");
    }
    assert!(stale(&assets(), &files).unwrap().is_empty());
    let table = std::fs::read_to_string(assets().join("../src/files.rs")).unwrap();
    assert_eq!(table, files_rs(&files), "run `mp-bench assets`");
    let total: usize = files.values().map(Vec::len).sum();
    assert!(total < 6_000_000, "{total} bytes");
}

#[test]
fn nothing_else_is_shipped() {
    let files = generate();
    for folder in ["scenes", "meshes", "paths", "robots"] {
        let mut pending = vec![assets().join(folder)];
        while let Some(dir) = pending.pop() {
            for entry in std::fs::read_dir(dir).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    pending.push(path);
                } else {
                    let inside = path.strip_prefix(assets()).unwrap().to_string_lossy().replace('\\', "/");
                    assert!(files.contains_key(&inside), "{inside} is made by nobody");
                }
            }
        }
    }
}

#[test]
fn meshes_are_solid() {
    for p in scenes() {
        let meshes = p.obstacles.iter().map(|o| (&o.name, &o.mesh)).chain([(&p.robot.name, &p.robot.mesh)]);
        for (name, mesh) in meshes {
            let report = mesh.topology();
            assert!(report.is_solid(), "{}: {name} is no solid", p.name);
            assert!(report.degenerate.is_empty() && report.duplicates.is_empty(), "{}: {name}", p.name);
            assert!(mesh.mass_properties().unwrap().volume > 0.0, "{}: {name} is inside out", p.name);
        }
    }
}

#[test]
fn starts_and_goals_are_free_and_within_bounds() {
    for p in scenes() {
        let clearances = match p.space {
            SpaceKind::Se2 => {
                let b = p.bounds.unwrap();
                let space = Se2::new([b.min.x, b.min.y], [b.max.x, b.max.y]).unwrap();
                let mut robot = PlanarFlyer::new(&p.robot.mesh, obstacles(&p)).unwrap();
                [&p.start, &p.goal].map(|pose| {
                    let six = six_from_pose(pose);
                    let q = Se2State::new(six[0], six[1], six[3]);
                    assert!(space.contains(&q) && robot.is_valid(&q), "{}", p.name);
                    robot.clearance(&q, 1.0)
                })
            }
            _ => {
                let mut robot = FreeFlyer::new(&p.robot.mesh, obstacles(&p)).unwrap();
                [&p.start, &p.goal].map(|q| {
                    assert!(space(&p).contains(q) && robot.is_valid(q), "{}", p.name);
                    robot.clearance(q, 1.0)
                })
            }
        };
        // Some begin in their narrow passage.
        let least = crate::puzzle(&p.name).map_or(0.05, |known| (0.99 * known.room * radius(&p)).min(0.05));
        assert!(clearances.iter().all(|&c| c > least), "{}: {clearances:?}", p.name);
    }
}

#[test]
fn the_apartment_and_the_tubes_are_as_large_as_promised() {
    for p in scenes() {
        let triangles: usize = p.obstacles.iter().map(|o| o.mesh.triangles().len()).sum();
        let robot = p.robot.mesh.triangles().len();
        match p.name.as_str() {
            "apartment" => assert!(triangles >= 20_000 && robot >= 2_000, "{triangles}, {robot}"),
            "cubicles" => assert!((500..700).contains(&triangles) && (30..50).contains(&robot)),
            name if name.starts_with("alpha") => assert!(triangles.min(robot) > 900, "{triangles}, {robot}"),
            _ => {}
        }
    }
}

/// The path was made by hand, for all scales: the certified checker proves that the tubes come apart.
#[test]
fn the_alphas_come_apart() {
    let path = PathFile::read(assets().join("paths/alpha.txt")).unwrap().poses();
    let alphas: Vec<_> = scenes().into_iter().filter(|p| p.name.starts_with("alpha")).collect();
    assert_eq!(alphas.len(), 6);
    for p in alphas {
        assert_eq!((path[0], path[path.len() - 1]), (p.start, p.goal), "{}", p.name);
        let robot = FreeFlyer::new(&p.robot.mesh, obstacles(&p)).unwrap();
        let space = space(&p);
        let mut verifier = Verifier::new(&space, &robot).unwrap();
        for (i, step) in path.windows(2).enumerate() {
            assert!(verifier.check_motion(&step[0], &step[1]).is_free(), "{}: motion {i}", p.name);
        }
    }
}

/// Each hard scene has a known solution: the certified checker proves it, and its least clearance is the room that the scene is said to
/// leave.
#[test]
fn puzzles_can_be_solved_and_are_as_tight_as_said() {
    let easy: Vec<&str> = crate::without_solution().collect();
    let puzzles: Vec<RigidProblem> =
        scenes().into_iter().filter(|p| !easy.contains(&p.name.as_str())).collect();
    for p in &puzzles {
        let known = crate::puzzle(&p.name).unwrap();
        let path = PathFile::read(assets().join(format!("paths/{}.txt", p.name))).unwrap().poses();
        assert_eq!((path[0], path[path.len() - 1]), (p.start, p.goal), "{}", p.name);
        let mut robot = FreeFlyer::new(&p.robot.mesh, obstacles(p)).unwrap();
        let space = space(p);
        let mut verifier = Verifier::new(&space, &robot).unwrap();
        let mut least = f64::INFINITY;
        for (i, step) in path.windows(2).enumerate() {
            assert!(verifier.check_motion(&step[0], &step[1]).is_free(), "{}: motion {i}", p.name);
            for part in 0..20 {
                let q = space.interpolate(&step[0], &step[1], f64::from(part) / 20.0);
                least = least.min(robot.clearance(&q, 1.0));
            }
        }
        let room = least / radius(p);
        // The numbers have two or three digits, and corners between samples come a little nearer.
        assert!((room / known.room - 1.0).abs() < 0.05, "{}: {room}", p.name);
    }
    assert!(puzzles.len() >= 12 && crate::PUZZLES.is_sorted_by_key(|known| known.grade));
    for known in crate::PUZZLES {
        let solved = puzzles.iter().any(|p| p.name == known.scene);
        assert!(crate::scene(known.scene).is_some() && (solved || known.grade == 1), "{}", known.scene);
    }
}

/// Start and goals of the arm are free, and the straight way from one to the other is not.
#[test]
fn the_arm_has_something_to_do() {
    let scene =
        ArmScene::from_problem(RobotProblem::load(assets().join("scenes/arm.toml")).unwrap()).unwrap();
    assert!(scene.lint().is_empty() && scene.arm().dof() == 6);
    let mut verifier = scene.verifier().unwrap();
    for goal in scene.goals() {
        assert!(verifier.check_motion(goal, goal).is_free());
        assert!(!verifier.check_motion(scene.start(), goal).is_free());
    }
}

/// The wrench passes the slot with its jaw shut and not with its jaw as wide as the nut needs it, and takes the nut with its
/// jaw open only.
#[test]
fn the_wrench_must_shut_to_pass_and_open_to_arrive() {
    let problem = RobotProblem::load(assets().join("scenes/wrench.toml")).unwrap();
    let scene = FloatingScene::from_problem(problem).unwrap();
    assert!(scene.lint().is_empty() && scene.arm().dof() == 7);
    let mut verifier = scene.verifier().unwrap();
    let (start, goal) = (scene.start().clone(), scene.goals()[0].clone());
    let (shut, wide) = (0.05, scene.row(&goal)[6]);
    assert!(verifier.check_motion(&start, &start).is_free() && verifier.check_motion(&goal, &goal).is_free());
    let with_jaw = |q: &[f64], width: f64| scene.state(&[&q[..6], &[width]].concat());
    // Straight through the slot, the jaws first.
    let (before, behind) = ([-1.0, -0.03, 0.0, 0.0, 0.0, 0.0], [0.6, -0.03, 0.0, 0.0, 0.0, 0.0]);
    let through = |width| [with_jaw(&before, width), with_jaw(&behind, width)];
    let [from, to] = through(shut);
    assert!(verifier.check_motion(&from, &to).is_free());
    let [from, to] = through(wide);
    assert!(!verifier.check_motion(&from, &to).is_free());
    // At the nut.
    let at_nut = scene.row(&goal);
    for width in [0.04, 0.1, 0.2, 0.3] {
        let q = with_jaw(&at_nut, width);
        assert!(!verifier.check_motion(&q, &q).is_free(), "{width}");
    }
    // With the jaws in the slot, the wrench lengthwise and a little askew, either way round and either side up.
    let (mut checker, mut rng) = (scene.checker().clone(), Rng::seed(1));
    let mut free = [0; 2];
    for i in 0..40_000 {
        let mut near = |middle: f64, off: f64| middle + off * (2.0 * rng.unit() - 1.0);
        let (back, over) = (PI * f64::from(i & 1), PI * f64::from((i >> 1) & 1));
        let place = [near(-0.1 * mp_math::cos(back), 0.07), near(0.0, 0.2), near(0.0, 0.1)];
        let row = [place, [near(back, 0.35), near(0.0, 0.35), near(over, 0.6)]].concat();
        for (free, width) in free.iter_mut().zip([shut, wide]) {
            *free += usize::from(checker.is_valid(&with_jaw(&row, width)));
        }
    }
    assert!(free[0] > 50 && free[1] == 0, "{free:?}");
}

#[test]
fn worlds_in_the_plane_are_sound() {
    for file in generate().keys().filter(|path| path.contains("/rrs-")) {
        mp_plan::Scene::load(assets().join(file)).unwrap().check_ends().expect(file);
    }
}
