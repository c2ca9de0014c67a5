//! The spanning wrench of seven degrees of freedom: its jaw shuts to pass a slot in a wall, and opens to take a nut.

use mp_plan::{Cancel, PathRows, Request, Scene, in_parallel};
use nalgebra::Point3;

/// Seeds that must all be solved.
const SEEDS: usize = 20;
/// Wider than this (m) the head does not fit into the slot, 0.44 m high and 0.26 m wide, however it rolls: it is 0.06 m
/// thick, and its outer edges are 0.13 m farther apart than its jaws are wide.
const WIDEST_IN_SLOT: f64 = 0.335;

/// Every seed is solved within the default budget, and every path is proved free. In the slot the jaw is shut far enough, and
/// at the nut it is open.
#[test]
fn it_is_solved_on_every_seed_and_shuts_and_opens() {
    let scene = Scene::find("wrench").unwrap();
    let (names, goal) = (scene.columns(), &scene.goals()[0]);
    assert_eq!(
        names.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(" "),
        "x y z alpha beta gamma width"
    );
    assert!(goal[6] > WIDEST_IN_SLOT && scene.start()[6] > WIDEST_IN_SLOT);
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let plan = |i: usize| scene.plan(&Request::new("rrt-connect").seed(1 + i as u64)).unwrap();
    let reports = in_parallel(SEEDS, threads, &Cancel::new(), plan);
    assert_eq!(reports.len(), SEEDS);
    for report in reports.into_iter().flatten() {
        let rows = report.path.clone().unwrap_or_else(|| panic!("seed {}: {:?}", report.seed, report.why));
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        assert!(report.solved && scene.check(&path).unwrap().free, "seed {}", report.seed);
        let along = scene.track(&path).unwrap();
        let in_slot: Vec<_> = along.rows.iter().filter(|row| row[0].abs() < 0.05).collect();
        let widest = in_slot.iter().map(|row| row[6]).fold(0.0, f64::max);
        assert!(!in_slot.is_empty() && widest < WIDEST_IN_SLOT, "seed {}: {widest}", report.seed);
        let last = along.rows.last().unwrap();
        assert!((last[6] - goal[6]).abs() < 1e-6, "seed {}: {last:?}", report.seed);
        let head = scene.traced(last).unwrap();
        assert!((head - Point3::new(goal[0], goal[1], goal[2])).norm() < 1e-6);
    }
}

/// With its jaw held as wide as the nut needs it, the wrench does not get through the slot.
#[test]
fn with_its_jaw_held_open_it_does_not_pass() {
    let files = mp_io::InMemory(|name: &str| {
        let bytes = mp_scenes::file(name)?.bytes;
        let text =
            String::from_utf8_lossy(bytes).replace("bounds =", "limits = { width = [0.34, 0.38] }\nbounds =");
        Some(if name.ends_with("wrench.toml") { text.into_bytes() } else { bytes.to_vec() })
    });
    let scene = Scene::load_from(&files, std::path::Path::new("scenes/wrench.toml")).unwrap();
    for seed in 1..=3 {
        let report = scene.plan(&Request::new("rrt-connect").seed(seed).iterations(4_000)).unwrap();
        assert!(!report.solved && report.iterations == 4_000, "seed {seed}: {report:?}");
    }
}
