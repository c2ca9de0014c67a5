//! Goals that are places of a link.

use mp_io::InMemory;
use mp_plan::{FreeTurns, Interrupt, PathRows, PoseEntry, Request, Scene};
use std::path::Path;

/// Two bars of a metre that turn about z one above the other, and a tip at the end, which turns about the bar.
const URDF: &str = r#"<robot name="two">
<link name="base"/>
<link name="upper"><collision><origin xyz="0.5 0 0"/><geometry><box size="0.9 0.1 0.1"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.5 0 0.2"/><geometry><box size="0.9 0.1 0.1"/></geometry></collision></link>
<link name="tip"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
<limit lower="-2.5" upper="2.5" velocity="1"/></joint>
<joint name="end" type="fixed"><parent link="lower"/><child link="tip"/><origin xyz="1 0 0.2"/></joint>
</robot>"#;

fn load(goal: &str, more: &str) -> Result<Scene, mp_plan::Error> {
    let base = if more.contains("floating") { "0.5, 0.5, 0.5, 0, 0, 0, " } else { "" };
    let motion = format!("[motion]\nstart = [{base}0.8, 0.2]\ngoal = {goal}\n");
    load_text(format!("[robot]\nurdf = \"r.urdf\"\n{more}\n{motion}"))
}

fn load_text(problem: String) -> Result<Scene, mp_plan::Error> {
    let at = move |name: &str| match name {
        "p.toml" => Some(problem.clone()),
        "r.urdf" => Some(URDF.to_owned()),
        _ => None,
    };
    Scene::load_from(&InMemory(at), Path::new("p.toml"))
}

/// Where the tip is, by trigonometry.
fn tip(row: &[f64]) -> [f64; 2] {
    let [first, second] = [row[0], row[0] + row[1]];
    [mp_math::cos(first) + mp_math::cos(second), mp_math::sin(first) + mp_math::sin(second)]
}

fn planned(scene: &Scene) -> Vec<f64> {
    let report = scene.plan(&Request::new("rrt-connect").iterations(20_000)).unwrap();
    assert!(report.solved && report.verified);
    report.path.unwrap().last().unwrap().clone()
}

#[test]
fn a_path_ends_where_a_link_is_wanted() {
    let at = "{ link = \"tip\", position = [1.0, 1.0, 0.2] }";
    let scene = load(at, "").unwrap();
    assert!(scene.notes().iter().any(|note| note.contains("2 of 2 configurations")), "{:?}", scene.notes());
    let end = planned(&scene);
    let [x, y] = tip(&end);
    assert!((x - 1.0).abs() < 1e-8 && (y - 1.0).abs() < 1e-8, "{end:?}");
    // The elbow is on one side of it or on the other. With a post on one, it is on the other.
    let post = |x: f64, y: f64| format!("[[obstacle]]\nbox = [0.2, 0.2, 2]\npose = [{x}, {y}, 0, 0, 0, 0]\n");
    let with = |post: String| {
        let problem =
            format!("[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [0.8, 0.2]\ngoal = {at}\n{post}");
        load_text(problem).unwrap()
    };
    let (right, left) = (planned(&with(post(0.0, 1.0))), planned(&with(post(1.0, 0.0))));
    assert!(
        right[0].abs() < 1e-6 && (left[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-6,
        "{right:?} {left:?}"
    );
    // With the direction of the bar as well there is one; the direction alone about its own axis may be free.
    let half = std::f64::consts::FRAC_PI_2;
    let pose = load(&format!("{{ link = \"tip\", pose = [1, 1, 0.2, {half}, 0, 0] }}"), "").unwrap();
    assert!((planned(&pose)[0]).abs() < 1e-6);
    let rolled = format!("{{ link = \"tip\", pose = [1, 1, 0.2, {half}, 0, 1], free = \"x\" }}");
    assert!((planned(&load(&rolled, "").unwrap())[0]).abs() < 1e-6);
    // Room around a place that is a bit too far.
    let far = load("{ link = \"tip\", position = [1.5, 1.5, 0.2], position_tolerance = 0.2 }", "").unwrap();
    let [x, y] = tip(&planned(&far));
    assert!([x, y].iter().all(|v| (v - 1.5).abs() < 0.2 + 1e-8), "{x} {y}");
    // The same again, also as one of several goals.
    assert_eq!(planned(&scene), end);
    let text =
        format!("[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [0.8, 0.2]\ngoals = [[-2, 0.3], {at}]\n");
    assert_eq!(load_text(text).unwrap().goals().len(), 3);
}

/// A path of somebody else may end at a configuration that is not one of those that were looked for.
#[test]
fn a_path_that_ends_anywhere_at_a_place_is_free() {
    let goals = "[[-2, 0.3], { link = \"tip\", position = [1.5, 1.5, 0.2], position_tolerance = 0.2 }]";
    let text =
        |goals: &str| format!("[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [0.8, 0.2]\ngoals = {goals}\n");
    let scene = load_text(text(goals)).unwrap();
    let faults = |scene: &Scene, end: [f64; 2]| {
        let rows = vec![vec![0.8, 0.2], end.to_vec()];
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        scene.check(&path).unwrap().faults
    };
    for end in [[0.7, 0.3], [0.75, 0.05], [0.5, 0.5], [0.7, -0.1], [0.2, 0.9], [-2.0, 0.3], [0.8, 0.2]] {
        let inside = tip(&end).iter().all(|x| (x - 1.5).abs() <= 0.2);
        assert_eq!(faults(&scene, end).is_empty(), inside || end == [-2.0, 0.3], "{end:?}");
    }
    // Other goals of the same scene are no places.
    let other = scene.with_ends(&[0.8, 0.2], &[vec![-2.0, 0.3]]).unwrap();
    assert!(!faults(&other, [0.7, 0.1]).is_empty());
}

#[test]
fn configurations_that_reach_a_place_are_listed() {
    let scene = load("[0, 0]", "").unwrap();
    let place = |link: &str, x: f64| PoseEntry {
        link: link.to_owned(),
        pose: [x, 1.0, 0.2, 0.0, 0.0, 0.0],
        within: [0.0; 3],
        free: FreeTurns::All,
    };
    let never = Interrupt::never();
    let found = scene.reaching(&place("tip", 1.0), 10, &never).unwrap();
    assert_eq!(found.len(), 2);
    assert!(found.iter().all(|reached| reached.free && (tip(&reached.row)[0] - 1.0).abs() < 1e-8));
    assert!(
        scene.reaching(&place("toe", 1.0), 10, &never).unwrap_err().report().contains("upper, lower, tip")
    );
    assert!(scene.reaching(&place("base", 1.0), 10, &never).unwrap_err().report().contains("no joint moves"));
    for x in [f64::NAN, f64::INFINITY] {
        let e = scene.reaching(&place("tip", x), 10, &never).unwrap_err().report();
        assert!(e.contains("finite numbers"), "{e}");
    }
    let below = PoseEntry { within: [-1.0, 0.0, 0.0], ..place("tip", 1.0) };
    assert!(scene.reaching(&below, 10, &never).is_err());
    assert!(scene.reaching(&place("tip", 2.0), 10, &never).unwrap_err().report().contains("2.245 m from"));
    assert!(Scene::find("easy").unwrap().reaching(&place("tip", 1.0), 10, &never).is_err());
}

#[test]
fn places_that_cannot_be_goals_are_errors() {
    for (goal, robot, words) in [
        ("{ link = \"tip\", position = [3, 0, 0.2] }", "", ["p.toml:6:", "cannot get there", "reaches 2"]),
        (
            "{ link = \"tip\", position = [1, 1, 0.3] }",
            "",
            ["p.toml:6:", "no configuration", "position_tolerance"],
        ),
        ("{ link = \"toe\", position = [1, 1, 0.2] }", "", ["p.toml:6:", "no link \"toe\"", "lower, tip"]),
        (
            "{ link = \"tip\", pose = [1, 1, 0.2] }",
            "",
            ["p.toml:6:", "pose of the goal has 3 numbers", "position ="],
        ),
        (
            "{ link = \"tip\", position = [1, 1] }",
            "",
            ["p.toml:6:", "position of the goal has 2 numbers", "pose ="],
        ),
        (
            "{ link = \"tip\", pose = [1, 1, 0, 0, 0, 0], free = \"w\" }",
            "",
            ["p.toml:6:", "`free` is `w`", "\"z\""],
        ),
        (
            "{ link = \"tip\", position = [1, 1, 0], free = \"z\" }",
            "",
            ["p.toml:6:", "free already", "link ="],
        ),
        (
            "{ link = \"tip\", position = [1, 1, 0], tolerance = 1 }",
            "",
            ["p.toml:6:", "`tolerance`", "position_tolerance"],
        ),
        (
            "{ link = \"tip\", position = [1, 1, 0], position_tolerance = -1 }",
            "",
            ["p.toml:6:", "below zero", "0.01"],
        ),
        ("{ link = \"tip\" }", "", ["p.toml:6:", "where tip is to be", "position ="]),
        ("{ link = \"tip\", position = [1, 1, nan] }", "", ["p.toml:6:", "NaN", "finite"]),
        ("{ shoulder = \"tip\" }", "", ["p.toml:6:", "shoulder", "neither a number"]),
        (
            "{ link = \"tip\", position = [1, 1, 0.2] }",
            "base = \"floating\"\nbounds = [[0, 0, 0], [1, 1, 1]]",
            ["place of the link", "numbers", "stands still"],
        ),
        (
            "{ link = \"tip\", position = [1, 1, 0.2] }",
            "kind = \"velocities\"\nspeeds = [1, 1]\nduration = 0.3",
            ["place of the link", "shoulder, elbow", "by inputs"],
        ),
    ] {
        let error = match load(goal, robot) {
            Err(error) => error.report(),
            Ok(_) => panic!("{goal} is no error"),
        };
        // The lines of the robot come before that of the goal.
        let moved = if robot.is_empty() { words[0] } else { "p.toml:" };
        assert!(
            error.contains(moved) && words[1..].iter().all(|word| error.contains(word)),
            "{goal}: {error}"
        );
    }
    let walled = "[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [2, 0.2]\ngoal = { link = \"tip\", position = [1, 1, 0.2] }\n\
                  [[obstacle]]\nname = \"wall\"\nbox = [0.5, 0.5, 1]\npose = [0.8, 0.8, 0.2, 0, 0, 0]\n";
    let error = load_text(walled.to_owned()).err().unwrap().report();
    let words = ["p.toml:5:", "2 configurations place \"tip\" there", "lower in wall", "deep"];
    assert!(words.iter().all(|word| error.contains(word)), "{error}");
}
