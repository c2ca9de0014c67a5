//! Objectives by name: paths that cost less, farther from obstacles.

use mp_plan::{ObjectiveName, PathRows, Request, Scene};

const CLEARANCE: ObjectiveName = ObjectiveName::Clearance { weight: 10.0, range: None };

/// The length, least clearance and cost of the paths planned for their length and by clearance. `--nocapture` prints them as a row of
/// docs/results/objectives.md.
#[allow(clippy::print_stdout, reason = "it is a measurement")]
fn both(name: &str, planner: &str) -> [[f64; 3]; 2] {
    let scene = Scene::find(name).unwrap();
    let [plain, by_clearance] = [ObjectiveName::Length, CLEARANCE].map(|objective| {
        let mut request = Request::new(planner).objective(objective).iterations(20_000).sharp_clearance();
        (request.budget.time_s, request.budget.nodes) = (None, Some(4_000));
        let report = scene.plan(&request).unwrap();
        assert!(report.solved && report.verified, "{name} {planner}: {:?}", report.why);
        let rows = report.path.unwrap();
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        let cost = scene.path_cost(&path, CLEARANCE).unwrap();
        assert_eq!(report.cost, (!objective.is_length()).then_some(cost), "{name}");
        [report.path_length.unwrap(), report.clearance.unwrap(), cost]
    });
    let [[a, b, c], [d, e, f]] = [plain, by_clearance];
    println!("| `{name}` | `{planner}` | {a:.2} | {d:.2} | {b:.3} | {e:.3} | {c:.2} | {f:.2} |");
    [plain, by_clearance]
}

/// The scenes have so much room.
fn are_better(name: &str, planners: &[&str]) {
    for planner in planners {
        let [plain, by_clearance] = both(name, planner);
        assert!(by_clearance[1] > plain[1] && by_clearance[2] < 0.7 * plain[2], "{name} {planner}");
    }
}

#[test]
fn paths_by_clearance_cost_less_and_are_farther_from_obstacles() {
    are_better("easy", &["auto", "t-rrt", "aorrtc"]);
    are_better("cubicles", &["auto", "t-rrt"]);
}

#[test]
#[ignore = "takes ten seconds: the rest of the table"]
fn so_are_those_of_planners_that_improve_in_a_larger_scene() {
    are_better("easy", &["rrt-star"]);
    are_better("cubicles", &["aorrtc", "rrt-star"]);
}

/// Whatever the robot is, also one that moves by inputs or among obstacles that move.
#[test]
fn all_kinds_of_robots_have_it() {
    for name in ["gempa-2", "docks", "planar-bugtrap", "crossing", "velocities", "mobile-arm", "arm"] {
        let [plain, by_clearance] = both(name, Scene::find(name).unwrap().default_planner());
        // Shortening begins with the same path, and ends with one that costs no more than without.
        assert!(by_clearance[2] <= plain[2], "{name}");
    }
}

#[test]
fn names_are_read_and_faults_explained() {
    for name in ["length", "clearance", "clearance:3", "clearance:0.5:0.2"] {
        assert_eq!(name.parse::<ObjectiveName>().unwrap().to_string(), name);
    }
    assert_eq!("clearance".parse::<ObjectiveName>().unwrap(), CLEARANCE);
    for (name, words) in [
        ("clear", "there is no objective `clear`"),
        ("length:2", "there is no objective"),
        ("clearance:0", "the weight of the objective is `0`: must be a finite number above zero"),
        ("clearance:1:x", "the range of the objective is `x`: not a number"),
    ] {
        let error = name.parse::<ObjectiveName>().unwrap_err().report();
        assert!(error.contains(words) && error.contains("help: "), "{error}");
    }
    let read: Request = serde_json::from_str(r#"{"objective": "clearance:3:0.5"}"#).unwrap();
    assert_eq!(read.objective, ObjectiveName::Clearance { weight: 3.0, range: Some(0.5) });
    assert!(!serde_json::to_string(&Request::default()).unwrap().contains("objective"));
}
