//! Arms, and robots in the plane, on the command line: plan, check, render, info, and bad input.

use crate::common::{Dir, finish, mp, start_with};

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
    // The joint turns without end: it comes to the goal from the other side.
    let turns = (0.7 - path[path.len() - 1][0].as_f64().unwrap()) / std::f64::consts::TAU;
    assert!(path[0][0].as_f64() == Some(-0.7) && (turns - turns.round()).abs() < 1e-12, "{turns}");
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

/// Joints are sorted by name in messages of ROS: the elbow comes before the shoulder.
#[test]
fn columns_are_read_by_name() {
    let dir = dir();
    assert_eq!(mp(&dir, &["plan", "two.toml", "--out", "p.csv"]).code, 0);
    let rows: Vec<Vec<f64>> = dir
        .read("p.csv")
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let sorted = |header: &str, scale: f64| {
        let lines = rows.iter().map(|row| format!("{},{}\n", row[1] * scale, row[0] * scale));
        header.to_owned() + "\n" + &lines.collect::<String>()
    };
    let degrees = 180.0 / std::f64::consts::PI;
    for (text, code) in [
        (sorted("elbow,shoulder", 1.0), 0),
        (sorted("elbow [deg],shoulder_deg", degrees), 0),
        (sorted("shoulder,elbow", 1.0), 1),
        (sorted("elbow [rad],shoulder [deg]", 1.0), 1),
        (sorted("elbow,wrist", 1.0), 2),
        (sorted("elbow,elbow", 1.0), 2),
        (sorted("elbow [mm],shoulder", 1.0), 2),
    ] {
        dir.write("q.csv", &text);
        let check = mp(&dir, &["check", "two.toml", "q.csv"]);
        assert_eq!(check.code, code, "{text}: {check:?}");
        if code == 2 {
            assert!(check.stderr.contains("q.csv:1:"), "{check:?}");
        }
    }
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
        ("two.urdf", "lost.urdf", &["lost.urdf:2:1:", "thumb.stl", "share/hand/thumb.stl"][..]),
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

/// A robot alone: planned from a free configuration to another, and what was chosen is said.
#[test]
fn a_robot_alone_is_planned_checked_drawn_and_described() {
    let dir = Dir::new();
    // The links of a chain of four turn in one plane: at zero the last one, which is bent back, lies in the first.
    let link = |i: u32| {
        format!(
            "<link name=\"l{i}\"><collision><origin xyz=\"0.2 0 0\"/><geometry><mesh filename=\"package://kit/bar.off\"/>\
             </geometry></collision></link>\n<joint name=\"j{i}\" type=\"revolute\"><parent link=\"l{}\"/><child link=\"l{i}\"/>\
             <origin xyz=\"0.4 0 0\" rpy=\"0 0 {}\"/><axis xyz=\"0 0 1\"/><limit lower=\"-0.5\" upper=\"1.5\"/></joint>\n",
            i - 1,
            if i > 1 { 2.0 } else { 0.0 },
        )
    };
    let links: String = (1..5).map(link).collect();
    for folder in ["robots", "kit"] {
        std::fs::create_dir(dir.path(folder)).unwrap();
    }
    dir.write("robots/alone.urdf", format!("<robot name=\"alone\">\n<link name=\"l0\"/>\n{links}</robot>"));
    let bar = "OFF\n4 4 0\n-0.15 0 0\n0.15 0.02 0\n0.15 -0.02 0.02\n0.15 -0.02 -0.02\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n";
    dir.write("kit/bar.off", bar);
    let file = "robots/alone.urdf";
    let run = mp(&dir, &["plan", file, "--json", "--out", "p.txt", "--picture", "p.png"]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.stderr.contains("note: alone.urdf is a robot alone"), "{run:?}");
    let report = run.json();
    assert_eq!((&report["verified"], &report["space"]), (&true.into(), &"4 joints".into()));
    let path = report["path"].as_array().unwrap();
    let row = |i: usize| path[i].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect::<Vec<_>>();
    let (start, goal) = (row(0), row(path.len() - 1));
    assert!(start.iter().chain(&goal).all(|x| (-0.5..=1.5).contains(x)), "{start:?} {goal:?}");
    // Half way from each joint of the start to 1.5 links touch: a configuration near that is taken, which the start sees.
    assert!(run.stderr.contains("a configuration near that to which the straight motion is free"), "{run:?}");
    assert!(start.iter().zip(&goal).any(|(a, b)| b - a > 0.5), "{start:?} {goal:?}");
    assert_eq!(report["iterations"], 1);
    let again = mp(&dir, &["plan", file, "--json"]);
    assert_eq!(again.json()["path"], report["path"]);
    assert_eq!(mp(&dir, &["check", file, "p.txt"]).code, 0);
    assert_eq!(mp(&dir, &["render", file, "p.txt", "--picture", "r.png"]).code, 0);
    let info = mp(&dir, &["info", file]);
    assert!(info.code == 0 && info.stdout.contains("note      alone.urdf is a robot alone"), "{info:?}");
}

/// A map alone: a disc goes from one end of its free space to the other.
#[test]
fn a_map_alone_is_planned_checked_drawn_and_described() {
    let dir = Dir::new();
    // Two rooms with a door; a third one that is shut.
    let rows = [
        "##############",
        "#....#....#..#",
        "#....#....#..#",
        "#.........#..#",
        "#....#....#..#",
        "##############",
    ];
    let pixels: String = rows
        .iter()
        .flat_map(|row| {
            row.chars()
                .flat_map(|c| [c; 4])
                .map(|c| if c == '#' { "0 " } else { "254 " })
                .chain(["\n"])
                .collect::<Vec<_>>()
                .repeat(4)
        })
        .collect();
    dir.write("rooms.pgm", format!("P2\n56 24\n255\n{pixels}"));
    dir.write("rooms.yaml", "image: rooms.pgm\nresolution: 0.25\norigin: [-2, 3, 0]\n");
    // Where maps of a country have their origin, checks resolve millimetres.
    dir.write("far.yaml", "image: rooms.pgm\nresolution: 0.05\norigin: [4e5, 5.2e6, 0]\n");
    let far = mp(&dir, &["plan", "far.yaml"]);
    assert!(far.code == 0 && far.stdout.contains("solved"), "{far:?}");
    for file in ["rooms.yaml", "rooms.pgm"] {
        let run = mp(&dir, &["plan", file, "--json", "--out", "p.txt", "--picture", "p.svg"]);
        assert_eq!(run.code, 0, "{run:?}");
        assert!(run.stderr.contains("a disc with the radius 0.2 m"), "{run:?}");
        let report = run.json();
        assert_eq!((&report["verified"], &report["space"]), (&true.into(), &"R2".into()));
        let path = report["path"].as_array().unwrap();
        let x = |i: usize| path[i][0].as_f64().unwrap();
        // In different rooms: the wall between them is at 3 to 4 m.
        let (a, b) = (x(0).min(x(path.len() - 1)), x(0).max(x(path.len() - 1)));
        assert!(a < 3.0 && b > 4.0 && b < 8.0, "{a} {b}");
        assert_eq!(mp(&dir, &["check", file, "p.txt"]).code, 0);
        let info = mp(&dir, &["info", file]);
        assert!(info.code == 0 && info.stdout.contains("rooms.yaml is a map alone"), "{info:?}");
    }
    // In a small map the disc is smaller.
    dir.write("small.yaml", "image: rooms.pgm\nresolution: 0.01\norigin: [0, 0, 0]\n");
    let info = mp(&dir, &["info", "small.yaml"]);
    assert!(info.code == 0 && info.stdout.contains("half of the widest clearance"), "{info:?}");
}

/// A free-flying manipulator: a box with two turning links and a sliding one.
const FLYER: &str = r#"<robot name="flyer">
<link name="body"><collision><geometry><box size="0.3 0.3 0.2"/></geometry></collision></link>
<link name="upper"><collision><origin xyz="0.2 0 0"/><geometry><box size="0.3 0.06 0.06"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.15 0 0"/><geometry><box size="0.24 0.05 0.05"/></geometry></collision></link>
<link name="probe"><collision><origin xyz="0.1 0 0"/><geometry><box size="0.16 0.02 0.02"/></geometry></collision></link>
<joint name="shoulder" type="revolute"><parent link="body"/><child link="upper"/><origin xyz="0.16 0 0"/><axis xyz="0 1 0"/>
<limit lower="-1.6" upper="1.6"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0.38 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="reach" type="prismatic"><parent link="lower"/><child link="probe"/><origin xyz="0.2 0 0"/><axis xyz="1 0 0"/>
<limit lower="-0.1" upper="0.1"/></joint>
</robot>"#;

/// From the front of a wall into a hole in it, which only the arm can enter.
const INSPECT: &str = "[robot]\nurdf = \"flyer.urdf\"\nbase = \"floating\"\nbounds = [[-2, -1, -1], [0.6, 1, 1]]\n\n[motion]\n\
    start = [-1.2, 0.4, -0.3, 2, 0.4, 0.1, -0.5, 2, 0]\ngoal = [-0.3, 0, 0, 0, 0, 0, 0, 0, 0.1]\n\n\
    [[obstacle]]\nname = \"upper wall\"\nbox = [0.3, 4, 2]\npose = [0.75, 0, 1.1, 0, 0, 0]\n\n\
    [[obstacle]]\nname = \"lower wall\"\nbox = [0.3, 4, 2]\npose = [0.75, 0, -1.1, 0, 0, 0]\n";

#[test]
fn a_floating_arm_is_planned_checked_drawn_and_described() {
    let dir = Dir::new();
    dir.write("flyer.urdf", FLYER);
    dir.write("inspect.toml", INSPECT);
    let run = mp(&dir, &["plan", "inspect.toml", "--json", "--out", "p.txt", "--picture", "p.png"]);
    assert_eq!(run.code, 0, "{run:?}");
    let report = run.json();
    assert_eq!((&report["verified"], &report["space"]), (&true.into(), &"SE3 × 3 joints".into()));
    let text = dir.read("p.txt");
    let (first, rows) = text.split_once('\n').unwrap();
    assert_eq!(first, format!("{} 9", report["path"].as_array().unwrap().len()));
    assert_eq!(rows.lines().count(), report["path"].as_array().unwrap().len());
    let again = mp(&dir, &["plan", "inspect.toml", "--json", "--threads", "2", "--out", "q.csv"]);
    assert_eq!(again.json()["path"], report["path"]);
    assert!(
        dir.read("q.csv").starts_with("x [m],y [m],z [m],alpha [rad],beta [rad],gamma [rad],shoulder [rad]")
    );
    for file in ["p.txt", "q.csv"] {
        let check = mp(&dir, &["check", "inspect.toml", file, "--json"]);
        assert_eq!((check.code, &check.json()["free"]), (0, &true.into()), "{check:?}");
    }
    assert_eq!(mp(&dir, &["render", "inspect.toml", "p.txt", "--out", "r.html"]).code, 0);
    let info = mp(&dir, &["info", "inspect.toml"]);
    for words in
        ["x from -2 to 0.6 m", "alpha turns without end", "reach from -0.1 to 0.1 m", "base      floats"]
    {
        assert!(info.stdout.contains(words), "{words}: {info:?}");
    }
    for metric in ["scaled", "euclidean", "manhattan"] {
        let run = mp(&dir, &["plan", "inspect.toml", "--metric", metric, "--json"]);
        assert_eq!((run.code, &run.json()["verified"]), (0, &true.into()), "{metric}: {run:?}");
    }
    // The straight way hits the wall, and it is said with what.
    dir.write(
        "straight.txt",
        "2 9\n-1.2 0.4 -0.3 2 0.4 0.1 -0.5 2 0\n-0.3 0 0 0 0 0 0 0 0.1\n".replace("-1.2 0.4", "0.4 0.4"),
    );
    let check = mp(&dir, &["check", "inspect.toml", "straight.txt"]);
    assert!(check.code == 1 && check.stdout.contains("lower wall"), "{check:?}");
}

#[test]
fn bad_floating_problems_are_told_what_to_do() {
    let dir = Dir::new();
    dir.write("flyer.urdf", FLYER);
    dir.write("named.urdf", FLYER.replace("\"reach\"", "\"gamma\""));
    dir.write(
        "still.urdf",
        FLYER
            .replace("type=\"revolute\"", "type=\"fixed\"")
            .replace("continuous", "fixed")
            .replace("prismatic", "fixed"),
    );
    for (from, to, words) in [
        ("flyer.urdf", "named.urdf", &["named.urdf", "\"gamma\"", "another name"][..]),
        ("flyer.urdf", "still.urdf", &["still.urdf", "no joint"]),
        ("bounds = [[-2, -1, -1], [0.6, 1, 1]]\n", "", &["inspect.toml:3", "bounds = [[x, y, z]"]),
        ("\"floating\"", "\"round\"", &["inspect.toml:3", "`round`", "planar"]),
        (
            "-0.5, 2, 0]",
            "-0.5, 2]",
            &["inspect.toml:7", "the start has 8 numbers", "gamma, shoulder, elbow, reach"],
        ),
        ("[-1.2, 0.4", "[-2.5, 0.4", &["inspect.toml:7", "x may be from -2 to 0.6"]),
        (
            "goal = [-0.3, 0, 0",
            "goal = [0.52, 0, 0.05",
            &["inspect.toml:8", "in collision", "body in upper wall", "nearest free"],
        ),
    ] {
        assert!(INSPECT.contains(from), "{from}");
        dir.write("inspect.toml", INSPECT.replacen(from, to, 1));
        let run = mp(&dir, &["plan", "inspect.toml"]);
        let told = run.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(run.code == 2 && words.iter().all(|word| told.contains(word)), "{to}: {told}");
    }
}

/// A robot whose hand touches its base unless the arm is folded, in a folder as packages of ROS have it.
fn clumsy() -> Dir {
    let dir = Dir::new();
    let block = |name: &str, at: &str| {
        format!(
            "<link name=\"{name}\"><collision><origin xyz=\"{at}\"/><geometry><box size=\"0.2 0.2 0.2\"/></geometry></collision></link>"
        )
    };
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-2\" upper=\"2\" velocity=\"1\"/></joint>"
        )
    };
    let urdf = format!(
        "<robot name=\"clumsy\">{}<link name=\"arm\"/>{}{}{}</robot>",
        block("base", "0 0 0"),
        block("hand", "0.1 0 0"),
        joint("a", "base", "arm"),
        joint("b", "arm", "hand")
    );
    std::fs::create_dir_all(dir.path("clumsy_description/urdf")).unwrap();
    std::fs::create_dir_all(dir.path("clumsy_moveit_config/config")).unwrap();
    dir.write("clumsy_description/urdf/arm.urdf", &urdf);
    dir.write("clumsy.toml", "[robot]\nurdf = \"clumsy_description/urdf/arm.urdf\"\nSRDF\n[motion]\nstart = [0, 0]\ngoal = [1, 1]\n");
    dir
}

/// Ctrl-C while pairs of links are looked at is no bad input.
#[cfg(unix)]
#[test]
fn an_srdf_that_is_interrupted_is_not_made() {
    let dir = Dir::empty();
    let of = |f: &dyn Fn(usize) -> String| (0..400).map(f).collect::<String>();
    let links = of(&|i| {
        format!(
            "<link name=\"l{i}\"><collision><geometry><box size=\".1 .1 .1\"/></geometry></collision></link>"
        )
    });
    let joints = of(&|i| {
        format!(
            "<joint name=\"j{i}\" type=\"revolute\"><parent link=\"l{i}\"/><child link=\"l{}\"/><origin xyz=\"0 0 .3\"/><axis xyz=\"0 1 0\"/>\
             <limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>",
            i + 1
        )
    });
    dir.write("long.urdf", format!("<robot name=\"long\">{links}<link name=\"l400\"/>{joints}</robot>"));
    let child = start_with(&dir, &["srdf", "long.urdf", "--out", "long.srdf"], &[]);
    std::thread::sleep(std::time::Duration::from_millis(1000));
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let run = finish(child);
    assert_eq!((run.code, run.stderr.trim()), (1, "interrupted: nothing was written"), "{run:?}");
    assert!(!dir.exists("long.srdf"));
}

#[test]
fn an_srdf_is_made_and_found() {
    let dir = clumsy();
    let robot = "clumsy_description/urdf/arm.urdf";
    // The base and the hand touch always, and no joint connects them: that was found without an SRDF too.
    let apart = "<robot name=\"clumsy\"><enable_collisions link1=\"base\" link2=\"hand\"/></robot>";
    let in_package = "clumsy_moveit_config/config/other.srdf";
    let refused = |dir: &Dir| mp(dir, &["plan", robot, "--out", "p.txt"]);
    dir.write(in_package, apart);
    let run = refused(&dir);
    assert!(run.code == 2 && run.stderr.contains("other.srdf") && run.stderr.contains("base"), "{run:?}");
    // One of another robot is not taken, but one called like the URDF is; and `false` takes none.
    dir.write(in_package, apart.replace("clumsy", "other"));
    assert_eq!(refused(&dir).code, 0);
    dir.write("clumsy_description/urdf/arm.srdf", apart.replace("clumsy", "other"));
    assert_eq!(refused(&dir).code, 2);
    let problem = dir.read("clumsy.toml");
    dir.write("none.toml", problem.replace("SRDF", "srdf = false"));
    assert_eq!(mp(&dir, &["plan", "none.toml", "--out", "p.txt"]).code, 0);
    dir.write("true.toml", problem.replace("SRDF", "srdf = true"));
    let run = mp(&dir, &["plan", "true.toml", "--out", "p.txt"]);
    assert!(
        run.code == 2 && run.stderr.contains("true.toml:3:") && run.stderr.contains("names no file"),
        "{run:?}"
    );

    // What is written is not replaced unasked.
    let srdf = ["srdf", robot, "--out", "clumsy_description/urdf/arm.srdf"];
    let run = mp(&dir, &srdf);
    assert!(run.code == 2 && run.stderr.contains("is there already"), "{run:?}");
    let run = mp(&dir, &[&srdf[..], &["--replace"]].concat());
    assert!(
        run.code == 0 && run.stderr.contains("0 adjacent, 0 at the neutral configuration, 1 always"),
        "{run:?}"
    );
    let text = dir.read("clumsy_description/urdf/arm.srdf");
    let line =
        "<disable_collisions link1=\"base\" link2=\"hand\" reason=\"Always\"/> <!-- in 100.0% of them -->";
    assert!(text.contains("<robot name=\"clumsy\">") && text.contains(line), "{text}");
    assert_eq!(mp(&dir, &["srdf", robot]).stdout, text);
    let run = refused(&dir);
    assert_eq!(run.code, 0, "{run:?}");
    // What the robot was read from is not replaced at all.
    let (before, problem) = (dir.read(robot), dir.read("none.toml"));
    for [from, out] in [[robot, robot], ["none.toml", robot], ["none.toml", "none.toml"]] {
        let run = mp(&dir, &["srdf", from, "--out", out, "--replace"]);
        assert!(run.code == 2 && run.stderr.contains("would overwrite the input"), "{run:?}");
    }
    assert_eq!((dir.read(robot), dir.read("none.toml")), (before, problem));
    let info = mp(&dir, &["info", robot]);
    assert!(info.stdout.contains("arm.srdf was found: it lets 1 pair of links touch"), "{info:?}");
    for bad in [["srdf", "gone.urdf"], ["srdf", "window.env"]] {
        assert_eq!(mp(&dir, &bad).code, 2);
    }
}

#[test]
fn configurations_that_place_a_link_are_listed() {
    let dir = dir();
    let at = ["ik", "two.toml", "--link", "lower", "--position", "0.6 -0.8 0"];
    let run = mp(&dir, &at);
    assert!(run.code == 0 && run.stderr.contains("columns: shoulder elbow"), "{run:?}");
    // What is listed is free, and places the link: the origin of the second bar is at the end of the first.
    for line in run.stdout.lines() {
        let numbers: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
        let turns = (numbers[0] + 0.927_295_218_001_612_2) / std::f64::consts::TAU;
        assert!((turns - turns.round()).abs() < 1e-8, "{line}");
        assert_eq!(mp(&dir, &["check", "two.toml", "--at", line]).code, 0, "{line}");
    }
    // With the direction there is one; toward the post it is in collision.
    let at = ["ik", "two.toml", "--link", "lower", "--pose", "1 0 0 1.5 0 0", "--json"];
    let all = mp(&dir, &[&at[..], &["--all"]].concat());
    assert_eq!((all.code, all.json().as_array().unwrap().len()), (0, 1), "{all:?}");
    assert!(mp(&dir, &["ik", "two.toml", "--link", "lower", "--pose", "1 0 0 0 0 0", "--json"]).code == 1);
    for (more, words) in [
        (vec!["--link", "toe", "--position", "1 0 0"], ["no link \"toe\"", "base, upper, lower"]),
        (vec!["--link", "lower", "--position", "1 0"], ["2 numbers", "x y z"]),
        (vec!["--link", "lower", "--position", "1 0 x"], ["`x` is not a finite number", ""]),
        (vec!["--link", "lower", "--position", "1 0 nan"], ["`nan` is not a finite number", "0.5"]),
        (vec!["--link", "lower", "--pose", "inf 0 0 0 0 0"], ["`inf` is not a finite number", "0.5"]),
        (vec!["--link", "lower"], ["where the link is to be", "--pose or --position"]),
        (vec!["--link", "lower", "--position", "4 0 0"], ["cannot get there", "move the goal"]),
        (vec!["--link", "lower", "--pose", "1 0 0 0 0 0", "--free", "w"], ["`free` is `w`", ""]),
    ] {
        let run = mp(&dir, &[&["ik", "two.toml"], &more[..]].concat());
        assert!(run.code == 2 && words.iter().all(|word| run.stderr.contains(word)), "{run:?}");
    }
    let run = mp(&dir, &["ik", "window.env", "--link", "a", "--position", "0 0 0"]);
    assert!(run.code == 2 && run.stderr.contains("no arm whose base stands still"), "{run:?}");
}

/// Start, goals and obstacles by options mean what the same text means in a problem.
#[test]
fn ends_and_obstacles_by_options_are_text_of_the_problem() {
    let dir = dir();
    dir.write(
        "two.srdf",
        "<robot name=\"two\"><group_state name=\"left\" group=\"g\"><joint name=\"shoulder\" value=\"-0.7\"/></group_state></robot>",
    );
    let post = "box = [0.2, 0.2, 1], at = [1.5, 0, 0], name = \"post\"";
    let all = ["--from", "-0.7,0", "--to", "0.7 0", "--obstacle", post];
    let args = |scene: &'static str| [&["plan", scene, "--json", "--out", "p.txt"][..], &all].concat();
    let alone = mp(&dir, &args("two.urdf"));
    assert_eq!(alone.code, 0, "{alone:?}");
    let problem = mp(&dir, &["plan", "two.toml", "--json"]);
    assert_eq!(alone.json()["path"], problem.json()["path"]);
    // A problem has an obstacle more, in the same place.
    let changed = mp(&dir, &args("two.toml"));
    assert_eq!(changed.json()["path"][0], problem.json()["path"][0], "{changed:?}");
    let named =
        mp(&dir, &["plan", "two.urdf", "--json", "--from", "left", "--to", "0.7,0", "--obstacle", post]);
    assert_eq!(named.json()["path"], problem.json()["path"], "{named:?}");
    assert_eq!(mp(&dir, &[&["check", "two.urdf", "p.txt"][..], &all].concat()).code, 0);
    assert_eq!(mp(&dir, &["check", "two.urdf", "p.txt"]).code, 1, "the ends are others");
    let info = mp(&dir, &["info", "two.urdf", "--obstacle", post, "--to", "elbow = [1, 2]"]);
    assert!(info.stdout.contains("post at 1.5") && info.stdout.contains("elbow 1 to 2"), "{info:?}");
    // A rigid body of a format without tables.
    let moved = mp(&dir, &["info", "window.env", "--obstacle", post, "--from", "-2.5,0,0,0,0,0"]);
    assert!(moved.stdout.contains("post at 1.5") && moved.stdout.contains("start     -2.5"), "{moved:?}");
    for (wrong, said) in [
        (["--from", "1,2,3"], "--from: the start has 3 numbers"),
        (["--from", "right"], "the SRDF has the states left"),
        (["--to", "link = 'lower', pose = [1, 2]"], "--to: the pose of the goal has 2 numbers"),
        (["--obstacle", "box = 1"], "--obstacle: a box has 3 lengths"),
        (["--obstacle", "ball = 1"], "--obstacle: unknown field `ball`"),
    ] {
        let run = mp(&dir, &["plan", "two.urdf", wrong[0], wrong[1]]);
        assert!(run.code == 2 && run.stderr.contains(said), "{wrong:?}: {run:?}");
    }
}

/// A robot is named, and found in the folders of the environment.
#[test]
fn robots_are_named() {
    let dir = dir();
    for folder in ["kit", "kit/a", "kit/b"] {
        std::fs::create_dir(dir.path(folder)).unwrap();
    }
    for file in ["kit/a/crane.urdf", "kit/a/lift.urdf", "kit/b/lift.urdf"] {
        dir.write(file, URDF);
    }
    let kit = dir.path("kit").display().to_string();
    let run = |args: &[&str]| finish(start_with(&dir, args, &[("MP_ROBOTS", &kit)]));
    let plan = run(&["plan", "crane", "--json"]);
    assert_eq!((plan.code, &plan.json()["scene"]), (0, &"crane".into()), "{plan:?}");
    let listed = run(&["robots", "--json"]).json();
    let names: Vec<_> = listed.as_array().unwrap().iter().take(3).map(|r| r["name"].clone()).collect();
    assert_eq!(names, ["crane", "lift", "lift"]);
    assert_eq!((&listed[0]["joints"], run(&["robots", "cran"]).stdout.lines().count()), (&2.into(), 1));
    let several = run(&["plan", "lift"]);
    assert!(several.code == 2 && several.stderr.contains("2 robots are called lift"), "{several:?}");
    assert_eq!(run(&["info", "b/lift"]).code, 0);
}
