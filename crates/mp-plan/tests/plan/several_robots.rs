//! Several robots in one scene.

use crate::which_joints::scene_of;
use mp_plan::{Interrupt, PathRows, Request, Scene};

fn load(robots: [&str; 2], motion: &str) -> Result<Scene, mp_plan::Error> {
    let robot =
        |more: &str| format!("[[robot]]\nurdf = \"r.urdf\"\nhold = {{ finger = 0, raise = 0.2 }}\n{more}\n");
    let problem = format!("{}{}[motion]\n{motion}\n", robot(robots[0]), robot(robots[1]));
    scene_of(problem)
}

const LEFT: &str = "name = \"left\"\nsrdf = \"r.srdf\"";
const RIGHT: &str = "name = \"right\"\nbase = [2.6, 0, 0, 3.14159265, 0, 0]";

#[test]
fn two_arms_get_out_of_each_others_way() {
    // Each has to pass where the other stands at the start.
    let motion = "start = [0.4, 0.5, 1.2, 0.3]\ngoal = [-0.9, -0.5, -0.4, -0.5]";
    let scene = load([LEFT, RIGHT], motion).unwrap();
    let names: Vec<_> = scene.columns().into_iter().map(|column| column.name).collect();
    assert_eq!(names, ["left/shoulder", "left/elbow", "right/shoulder", "right/elbow"]);
    scene.check_ends().unwrap();
    let rows = |rows: Vec<Vec<f64>>| PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    assert!(!scene.check(&rows(vec![scene.start(), scene.goals()[0].clone()])).unwrap().free);
    let report = scene.plan(&Request::new("rrt-connect").iterations(50_000)).unwrap();
    assert!(report.solved && report.verified);
    let certificate = scene.certificate(&rows(report.path.unwrap()), 0.0, &Interrupt::never()).unwrap();
    assert!(certificate.to_json().contains("right/lower"));
    // One alone is compared as it always was.
    let touch = load([LEFT, RIGHT], "start = [0, 0, 0, 0]\ngoal = [-0.9, -0.5, -0.4, -0.5]").unwrap();
    let error = touch.check_ends().unwrap_err().report();
    assert!(
        error.contains("left/") && error.contains("right/") && error.contains("move one of the robots"),
        "{error}"
    );
}

#[test]
fn states_and_links_of_several_robots() {
    let also = &format!("{RIGHT}\nsrdf = \"r.srdf\"");
    let scene =
        load([LEFT, also], "start = \"home\"\ngoal = { link = \"right/tip\", position = [2.6, 1.7, 0.5] }")
            .unwrap();
    assert_eq!(scene.start(), [0.8, 0.2, 0.8, 0.2]);
    // The left arm stays where it is.
    assert!(scene.goals().iter().all(|goal| goal[..2] == [0.8, 0.2]));
    let named =
        load([LEFT, RIGHT], "start = { \"right/elbow\" = 1 }\ngoal = { \"left/elbow\" = 0.5 }").unwrap();
    assert_eq!(named.start(), [0.0, 0.0, 0.0, 1.0]);
    let ball = "goal = [0.4, 0.2, 0.8, 0.2]\n[[attached]]\nname = \"ball\"\nlink = \"right/tip\"\nsphere = 0.05\npose = [0.3, 0, 0, 0, 0, 0]";
    let carrying = load([LEFT, also], &format!("start = \"home\"\n{ball}")).unwrap();
    assert!(carrying.bodies().iter().any(|body| body.name == "ball"));
}

#[test]
fn what_cannot_be_of_several_robots_is_an_error_at_its_place() {
    let motion = "start = [0.4, 0.5, 1.2, 0.3]\ngoal = [-0.9, -0.5, -0.4, -0.5]";
    for (second, words) in [
        ("", ["p.toml:6:", "no name", "`left/"]),
        ("name = \"left\"", ["p.toml:6:", "same name", "its own"]),
        (
            "name = \"b\"\nbase = \"floating\"\nbounds = [[0, 0, 0], [1, 1, 1]]",
            ["p.toml:6:", "floats", "one robot alone"],
        ),
        (
            "name = \"b\"\nkind = \"velocities\"\nspeeds = [1, 1]\nduration = 0.3",
            ["p.toml:6:", "by inputs", "one robot alone"],
        ),
        ("name = \"b\"\nsrdf = \"none.srdf\"", ["p.toml:10:", "none.srdf", ""]),
        ("name = \"b\"\ngroup = \"arms\"", ["p.toml:10:", "no group", ""]),
        ("name = \"b\"\nlimits = { wrist = [0, 1] }", ["p.toml:10:", "wrist", "shoulder"]),
    ] {
        let error = match load([LEFT, second], motion) {
            Err(error) => error.report(),
            Ok(_) => panic!("{second} is no error"),
        };
        assert!(words.iter().all(|word| error.contains(word)), "{second}: {error}");
    }
    // In one place.
    let error = load([LEFT, "name = \"right\""], motion).unwrap().check_ends().unwrap_err().report();
    assert!(error.contains("left/") && error.contains("right/"), "{error}");
}
