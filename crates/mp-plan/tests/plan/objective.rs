//! Objectives by name: paths that cost less, farther from obstacles.

use mp_plan::{ObjectiveName, PathRows, Request, Scene};

const CLEARANCE: ObjectiveName = ObjectiveName::Clearance { weight: 10.0, range: None };

/// The length, least clearance and cost of the path planned with an objective. `--nocapture` prints them as rows of
/// docs/results/objectives.md.
fn planned(name: &str, planner: &str, objective: ObjectiveName) -> [f64; 3] {
    let scene = Scene::find(name).unwrap();
    let mut request = Request::new(planner).objective(objective).iterations(20_000).sharp_clearance();
    (request.budget.time_s, request.budget.nodes) = (None, Some(4_000));
    let report = scene.plan(&request).unwrap();
    assert!(report.solved && report.verified, "{name} {planner}: {:?}", report.why);
    let rows = report.path.unwrap();
    let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    let cost = scene.path_cost(&path, CLEARANCE).unwrap();
    assert_eq!(report.cost, (!objective.is_length()).then_some(cost), "{name}");
    let (length, least) = (report.path_length.unwrap(), report.clearance.unwrap());
    println!("| `{name}` | `{planner}` | `{objective}` | {length:.2} | {least:.3} | {cost:.2} |");
    [length, least, cost]
}

#[test]
fn paths_by_clearance_cost_less_and_are_farther_from_obstacles() {
    for name in ["easy", "cubicles"] {
        for planner in ["auto", "t-rrt", "aorrtc", "rrt-star"] {
            let [plain, by_clearance] = [ObjectiveName::Length, CLEARANCE].map(|o| planned(name, planner, o));
            // The scenes have so much room.
            assert!(by_clearance[2] < 0.7 * plain[2], "{name} {planner}");
        }
    }
}

/// Whatever the robot is, also one that moves by inputs, is constrained in time, or floats.
#[test]
fn all_kinds_of_robots_have_it() {
    for name in [
        "gempa-2",
        "docks",
        "planar-bugtrap",
        "crossing",
        "velocities",
        "warehouse",
        "mobile-arm",
        "arm",
        "shelf",
    ] {
        let planner = Scene::find(name).unwrap().default_planner();
        let [plain, by_clearance] = [ObjectiveName::Length, CLEARANCE].map(|o| planned(name, planner, o));
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
