//! Arms, and robots in the plane, on the command line: plan, check, render, info, and bad input.

mod common;

use common::{Dir, mp};

const URDF: &str = r#"<robot name="two">
<link name="base"/>
<link name="upper"><collision><origin xyz="0.5 0 0"/><geometry><box size="0.9 0.1 0.1"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.5 0 0"/><geometry><box size="0.9 0.1 0.1"/></geometry></collision></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
<limit lower="-2.5" upper="2.5" velocity="1"/></joint>
</robot>"#;

/// From one side of a post to the other, which a straight arm hits.
const TASK: &str = "[robot]\nurdf = \"two.urdf\"\n\n[motion]\nstart = [-0.7, 0]\ngoal = [0.7, 0]\n\n\
                    [[obstacle]]\nname = \"post\"\nbox = [0.2, 0.2, 1]\npose = [1.5, 0, 0, 0, 0, 0]\n";

fn dir() -> Dir {
    let dir = Dir::new();
    dir.write("two.urdf", URDF);
    dir.write("two.toml", TASK);
    dir
}

#[test]
fn an_arm_is_planned_checked_drawn_and_described() {
    let dir = dir();
    let args = ["plan", "two.toml", "--json", "--out", "p.txt", "--picture", "p.png"];
    let run = mp(&dir, &args);
    assert_eq!(run.code, 0, "{run:?}");
    let report = run.json();
    assert_eq!((&report["solved"], &report["verified"]), (&true.into(), &true.into()));
    assert_eq!(report["space"], "2 joints");
    assert!(report["clearance"].as_f64().unwrap() > 0.0 && dir.exists("p.png"));
    let path = report["path"].as_array().unwrap();
    assert_eq!((path[0][0].as_f64(), path[path.len() - 1][0].as_f64()), (Some(-0.7), Some(0.7)));
    let text = dir.read("p.txt");
    assert_eq!(text.lines().next().unwrap(), format!("{} 2", path.len()));
    // The same again, and what is written is what is checked.
    let again = mp(&dir, &["plan", "two.toml", "--json", "--out", "q.json"]);
    assert_eq!(again.json()["path"], report["path"]);
    for file in ["p.txt", "q.json"] {
        let check = mp(&dir, &["check", "two.toml", file, "--json"]);
        assert_eq!((check.code, &check.json()["free"]), (0, &true.into()), "{check:?}");
    }
    assert_eq!(mp(&dir, &["render", "two.toml", "p.txt", "--picture", "r.png"]).code, 0);
    assert!(dir.bytes("r.png").starts_with(b"\x89PNG"));
    let info = mp(&dir, &["info", "two.toml"]);
    assert_eq!(info.code, 0, "{info:?}");
    for words in ["shoulder turns without end", "elbow from -2.5 to 2.5", "post at 1.5"] {
        assert!(info.stdout.contains(words), "{info:?}");
    }
    let info = mp(&dir, &["info", "p.txt", "--json"]);
    assert_eq!((&info.json()["kind"], &info.json()["numbers"]), (&"path".into(), &2.into()));
}

#[test]
fn a_path_that_hits_is_told_where() {
    let dir = dir();
    dir.write("straight.txt", "2 2\n-0.7 0\n0.7 0\n");
    let check = mp(&dir, &["check", "two.toml", "straight.txt"]);
    assert_eq!(check.code, 1, "{check:?}");
    assert!(check.stdout.contains("post") && check.stdout.contains("configurations 1 and 2"), "{check:?}");
    dir.write("short.txt", "2 2\n-0.7 0\n-0.6 0\n");
    let check = mp(&dir, &["check", "two.toml", "short.txt"]);
    assert_eq!((check.code, check.stdout.contains("does not end at the goal")), (1, true), "{check:?}");
    dir.write("three.txt", "1 3\n0 0 0\n");
    let check = mp(&dir, &["check", "two.toml", "three.txt"]);
    assert_eq!((check.code, check.stderr.contains("3 numbers")), (2, true), "{check:?}");
}

#[test]
fn bad_problems_are_told_what_to_do() {
    let dir = dir();
    let plan = |from: &str, to: &str| {
        assert!(TASK.contains(from), "{from}");
        dir.write("bad.toml", TASK.replacen(from, to, 1));
        let run = mp(&dir, &["plan", "bad.toml"]);
        assert_eq!(run.code, 2, "{run:?}");
        assert!(run.stdout.is_empty());
        // As it is wrapped to the width of a terminal.
        run.stderr
            .split_whitespace()
            .filter(|w| !["│", "×", "╰─▶", "help:"].contains(w))
            .collect::<Vec<_>>()
            .join(" ")
    };
    let mesh = "<collision><geometry><mesh filename=\"package://hand/thumb.stl\"/></geometry></collision>";
    dir.write(
        "lost.urdf",
        URDF.replace("<link name=\"base\"/>", &format!("<link name=\"base\">{mesh}</link>")),
    );
    for (from, to, words) in [
        ("two.urdf", "lost.urdf", &["lost.urdf", "line 2", "thumb.stl", "share/hand/thumb.stl"][..]),
        ("[-0.7, 0]", "[-0.7, 0, 0]", &["the start has 3 numbers", "shoulder, elbow"][..]),
        ("[-0.7, 0]", "[0, 0]", &["the start is in collision", "lower in post", "nearest free"]),
        ("[0.7, 0]", "[0.7, 3]", &["elbow may be from -2.5 to 2.5", "limits"]),
        ("two.urdf", "too.urdf", &["too.urdf", "no such file"]),
        ("urdf = \"two.urdf\"", "urdf = \"two.urdf\"\nlimits = { wrist = [0, 1] }", &["wrist", "shoulder"]),
        ("box = [0.2, 0.2, 1]", "bocks = [1, 1, 1]", &["bocks"]),
    ] {
        let told = plan(from, to);
        assert!(words.iter().all(|word| told.contains(word)), "{to}: {told}");
    }
    let run = mp(&dir, &["plan", "two.toml", "--metric", "max-displacement"]);
    assert_eq!((run.code, run.stderr.contains("take one of: default, euclidean")), (2, true), "{run:?}");
    // Posts on either side that the upper link cannot pass.
    let shut = TASK.to_owned() + "\n[[obstacle]]\nbox = [0.2, 0.2, 1]\npose = [-0.5, 0, 0, 0, 0, 0]\n";
    dir.write("shut.toml", shut.replace("pose = [1.5, 0", "pose = [0.8, 0"));
    let run = mp(&dir, &["plan", "shut.toml", "--iterations", "300", "--json"]);
    assert_eq!((run.code, run.json()["solved"].as_bool()), (1, Some(false)), "{run:?}");
}

const ROOM: &str = "[world]\nwalls = [[0, 0], [3, 2]]\n\n[robot]\ndisc = 0.1\n\n[motion]\nstart = [0.5, 0.5]\n\
                    goal = [2.5, 0.5]\n\n[[obstacle]]\nname = \"shelf\"\nrectangle = [[1.4, 0], [1.6, 1.5]]\n";

#[test]
fn worlds_in_the_plane_are_planned_checked_drawn_and_described() {
    let dir = Dir::new();
    let rod =
        ROOM.replace("disc = 0.1", "polygon = [[-0.2, -0.05], [0.2, -0.05], [0.2, 0.05], [-0.2, 0.05]]");
    dir.write("room.toml", ROOM);
    dir.write(
        "rod.toml",
        rod.replace("[0.5, 0.5]", "[0.5, 0.5, 0]").replace("[2.5, 0.5]", "[2.5, 0.5, 1.5]"),
    );
    for (scene, space, picture) in [("room", "R2", "p.svg"), ("rod", "SE2", "p.png")] {
        let file = format!("{scene}.toml");
        let run = mp(&dir, &["plan", &file, "--json", "--out", "p.txt", "--picture", picture]);
        assert_eq!(run.code, 0, "{run:?}");
        let report = run.json();
        assert_eq!((&report["verified"], &report["space"]), (&true.into(), &space.into()));
        let found = report["path_length"].as_f64().unwrap();
        assert!(found > 2.5 && found < 6.0 && report["clearance"].as_f64().unwrap() > 0.0, "{report}");
        let check = mp(&dir, &["check", &file, "p.txt", "--json"]);
        assert_eq!((check.code, &check.json()["free"]), (0, &true.into()), "{check:?}");
        let info = mp(&dir, &["info", &file]);
        assert!(info.code == 0 && info.stdout.contains(&format!("a scene in {space}")), "{info:?}");
        assert_eq!(mp(&dir, &["render", &file, "p.txt", "--picture", "r.svg"]).code, 0);
        assert!(dir.read("r.svg").contains("<path"));
    }
    assert!(dir.read("p.svg").starts_with("<svg") && dir.bytes("p.png").starts_with(b"\x89PNG"));
    dir.write("straight.txt", "2 2\n0.5 0.5\n2.5 0.5\n");
    let check = mp(&dir, &["check", "room.toml", "straight.txt"]);
    assert_eq!((check.code, check.stdout.contains("hits shelf")), (1, true), "{check:?}");
    let three = mp(&dir, &["check", "rod.toml", "straight.txt"]);
    assert_eq!((three.code, three.stderr.contains("2 numbers")), (2, true), "{three:?}");
    dir.write("shut.toml", ROOM.replace("start = [0.5, 0.5]", "start = [1.5, 0.5]"));
    let shut = mp(&dir, &["plan", "shut.toml"]);
    assert!(shut.code == 2 && shut.stderr.contains("in collision with shelf"), "{shut:?}");
    assert!(
        shut.stderr.contains("the nearest free configuration found is [")
            && shut.stderr.contains("shut.toml"),
        "{shut:?}"
    );
    let metric = mp(&dir, &["plan", "room.toml", "--metric", "manhattan"]);
    assert_eq!((metric.code, metric.stderr.contains("take one of: default")), (2, true), "{metric:?}");
}
