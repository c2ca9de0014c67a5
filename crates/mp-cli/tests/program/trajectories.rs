//! Trajectories on the command line: planned, timed, and checked whoever made them.

use crate::common::{Dir, fed, mp};

/// Two joints that slide, past a post that a rounded corner would hit.
const URDF: &str = r#"<robot name="crane"><link name="rail"/><link name="cart"/>
<link name="tip"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<joint name="reach" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="turn" type="revolute"><parent link="cart"/><child link="tip"/><origin xyz="0 0 0.2"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="2"/></joint>
</robot>"#;

const TASK: &str = "[robot]\nurdf = \"crane.urdf\"\nmax_acceleration = { reach = 2, turn = 4 }\n\n[motion]\nstart = [0, 0]\ngoal = [1, 1]\n\n\
                    [[obstacle]]\nname = \"post\"\nbox = [0.1, 0.1, 1]\nat = [1.2, 0, 0]\n";

fn dir() -> Dir {
    let dir = Dir::empty();
    dir.write("crane.urdf", URDF);
    dir.write("crane.toml", TASK);
    dir
}

/// Rows of a file of comma-separated values, without its first line.
fn rows(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}

#[test]
fn a_trajectory_is_planned_timed_and_checked_in_every_format() {
    let dir = dir();
    for file in ["t.csv", "t.json", "t.yaml", "t.mcap"] {
        let run = mp(&dir, &["plan", "crane.toml", "--out", "p.csv", "--trajectory", file]);
        assert_eq!(run.code, 0, "{run:?}");
        assert!(
            run.stderr.contains("trajectory: ") && run.stderr.contains("cubic curve, proved free"),
            "{run:?}"
        );
        let check = mp(&dir, &["check", "crane.toml", file, "--json"]);
        let verdict = check.json();
        assert_eq!(
            (check.code, &verdict["free"], &verdict["trajectory"]["curve"]),
            (0, &true.into(), &"cubic".into())
        );
        assert!(
            verdict["clearance"].as_f64().unwrap() > 0.0 && verdict["trajectory"]["least_at"].is_number()
        );
        let check = mp(&dir, &["check", "crane.toml", file, "--certificate", "c.json"]);
        assert_eq!(check.code, 0, "{check:?}");
        let replayed = mp(&dir, &["verify-certificate", "c.json", "--scene", "crane.toml"]);
        assert!(replayed.code == 0 && replayed.stdout.contains("proved free in crane"), "{replayed:?}");
        let timed = mp(&dir, &["time", "crane.toml", "p.csv", "--out", &format!("again-{file}")]);
        assert_eq!(timed.code, 0, "{timed:?}");
        assert_eq!(dir.bytes(&format!("again-{file}")), dir.bytes(file));
    }
    // One metre at 1 m/s and 2 m/s²: half a second up, half a second down.
    let all = rows(&dir.read("t.csv"));
    assert!((all[all.len() - 1][0] - 1.5).abs() < 0.01, "{all:?}");
    let slow =
        mp(&dir, &["time", "crane.toml", "p.csv", "--velocity-scale", "0.5", "--acceleration-scale", "0.25"]);
    assert!(
        slow.stdout.starts_with("time [s],reach [m],turn [rad],reach_velocity [m/s],turn_velocity [rad/s]\n"),
        "{slow:?}"
    );
    let all = rows(&slow.stdout);
    assert!((all[all.len() - 1][0] - 3.0).abs() < 0.02, "{all:?}");
    let without = mp(&dir, &["plan", "crane.toml", "--velocity-scale", "0.5"]);
    assert!(without.code == 2 && without.stderr.contains("by --trajectory"), "{without:?}");
    // More than the limits is no part of them.
    for over in ["--velocity-scale", "--acceleration-scale", "--jerk-scale"] {
        let over = mp(&dir, &["time", "crane.toml", "p.csv", over, "1.5"]);
        assert!(
            over.code == 2 && over.stderr.contains("is 1.5") && over.stderr.contains("at most 1"),
            "{over:?}"
        );
    }
    let sampled = mp(&dir, &["time", "crane.toml", "p.csv", "--rate", "100"]);
    assert_eq!(sampled.code, 0, "{sampled:?}");
    let all = rows(&sampled.stdout);
    assert!((all[7][0] - 0.07).abs() < 1e-9 && all.len() > 149, "{all:?}");
    let check = fed(&dir, &["check", "crane.toml", "-"], &sampled.stdout);
    assert!(check.code == 0 && check.stdout.contains("certified free"), "{check:?}");
}

#[test]
fn trajectories_of_others_are_checked_by_name_and_unit() {
    let dir = dir();
    let check = |name: &str, text: &str, more: &[&str]| {
        dir.write(name, text);
        mp(&dir, &[&["check", "crane.toml", name], more].concat())
    };
    // Degrees, another order, semicolons, lines of Windows.
    let good = "turn [deg];t [ms];reach [cm]\r\n0;0;0\r\n57.29577951308232;2000;100\r\n";
    let run = check("a.csv", good, &[]);
    assert!(run.code == 0 && run.stdout.contains("2 s, linear curve"), "{run:?}");
    // What is free between the points depends on the curve: with velocities it overshoots into the post.
    let fast = "time,reach,turn,reach_velocity,turn_velocity\n0,0,0,0,0\n2,1,1,-2,0\n";
    let run = check("b.csv", fast, &["--json"]);
    let verdict = run.json();
    assert_eq!((run.code, &verdict["trajectory"]["curve"]), (1, &"cubic".into()), "{run:?}");
    let faults = verdict["faults"].to_string();
    assert!(
        faults.contains("hits tip in post") && faults.contains("the velocity of reach reaches"),
        "{faults}"
    );
    let at = verdict["trajectory"]["collides_at"].as_f64().unwrap();
    assert!((1.0..2.0).contains(&at), "{at}");
    assert_eq!(verdict["trajectory"]["limits"][0]["joint"], "reach");
    assert_eq!(check("b.csv", fast, &["--as", "linear"]).code, 0);
    assert_eq!(check("b.csv", fast, &["--as", "controller"]).code, 1);
    assert_eq!(check("b.csv", fast, &["--as", "quintic"]).code, 2);
    // Nobody stops a robot at once.
    let moving = "time,reach,turn,reach_velocity,turn_velocity\n0,0,0,0,0\n2,1,1,0.5,0\n";
    let run = check("b.csv", moving, &["--json"]);
    assert!(
        run.code == 0 && run.json()["warnings"].to_string().contains("ends while reach moves"),
        "{run:?}"
    );
    // The same in a message of MoveIt.
    let point = |q: &str, v: &str, sec: u32| {
        format!(
            "{{\"positions\": {q}, \"velocities\": {v}, \"time_from_start\": {{\"sec\": {sec}, \"nanosec\": 0}}}}"
        )
    };
    let message = |velocity: &str| {
        format!(
            "{{\"trajectory\": [{{\"joint_trajectory\": {{\"joint_names\": [\"turn\", \"reach\"], \"points\": [{}, {}]}}}}]}}",
            point("[0, 0]", "[0, 0]", 0),
            point("[1, 1]", velocity, 2)
        )
    };
    assert_eq!(check("c.json", &message("[0, 0]"), &[]).code, 0);
    assert_eq!(check("c.json", &message("[0, -2]"), &[]).code, 1);
    // What is not certain is refused, with its place.
    for (name, text, words) in [
        ("d.csv", "time,reach,wrist\n0,0,0\n", "d.csv:1:12"),
        ("d.csv", "time,reach,turn,turn\n0,0,0,0\n", "the same number"),
        ("d.csv", "time,reach,turn\n0,0,0\n0,1,1\n", "times that increase"),
        ("d.json", &message("[0, 0]").replace("\"turn\"", "\"wrist\""), "`wrist` is no number"),
        ("d.yaml", "joint_names: [reach]\n", "no trajectory"),
    ] {
        let run = check(name, text, &[]);
        assert!(run.code == 2 && run.stderr.contains(words), "{text}: {run:?}");
    }
    // A path has no times, and is checked as before.
    let run = check("e.csv", "turn,reach\n0,0\n1,1\n", &[]);
    assert!(run.code == 0 && !run.stdout.contains("curve"), "{run:?}");
    assert_eq!(check("e.csv", "turn,reach\n0,0\n1,1\n", &["--as", "linear"]).code, 2);
    let run = mp(&dir, &["plan", "easy", "--trajectory", "t.csv", "--out", "p.txt", "--picture", "p.png"]);
    assert!(run.code == 2 && run.stderr.contains("has none"), "{run:?}");
    let run = mp(&dir, &["plan", "crane.toml", "--trajectory", "t.txt"]);
    assert!(run.code == 2 && run.stderr.contains(".yaml"), "{run:?}");
}
