//! Robots that cannot make any motion, obstacles that move, and goals that leave something free, by the command line.

use crate::common::{Dir, mp};

/// The shipped scenes of these kinds, and the planner that each takes by default.
const SCENES: [(&str, &str); 9] = [
    ("crossing", "rrt"),
    ("blade", "rrt"),
    ("docks", "auto"),
    ("unicycle", "rsrt"),
    ("velocities", "rsrt"),
    ("accelerations", "rsrt"),
    ("parking", "rsrt"),
    ("warehouse", "rsrt"),
    ("flyer", "rsrt"),
];

#[test]
fn each_is_planned_written_checked_and_drawn() {
    let dir = Dir::empty();
    for (scene, planner) in SCENES {
        let [path, csv, svg, png] = ["txt", "csv", "svg", "png"].map(|end| format!("path-{scene}.{end}"));
        let picture = if ["blade", "flyer"].contains(&scene) { png } else { svg };
        let run = mp(&dir, &["plan", scene, "--seed", "3", "--out", &path, "--picture", &picture, "--json"]);
        assert_eq!(run.code, 0, "{run:?}");
        let report = run.json();
        assert_eq!((report["planner"].as_str(), report["verified"].as_bool()), (Some(planner), Some(true)));
        assert!(report["clearance"].as_f64().unwrap() > 0.0, "{report}");
        let check = mp(&dir, &["check", scene, &path]);
        assert!(check.code == 0 && check.stdout.contains("certified free"), "{check:?}");
        assert!(dir.exists(&picture));
        // As comma-separated values it has the same numbers.
        assert_eq!(mp(&dir, &["plan", scene, "--seed", "3", "--out", &csv]).code, 0);
        assert_eq!(mp(&dir, &["check", scene, &csv]).code, 0);
        let info = mp(&dir, &["info", scene]);
        assert!(info.code == 0 && (info.stdout.contains("goal is")), "{info:?}");
    }
}

#[test]
fn the_same_seed_gives_the_same_path_on_any_number_of_threads() {
    let dir = Dir::empty();
    for (scene, planner) in [("crossing", "or-rrt"), ("velocities", "or-rsrt"), ("docks", "or-rrt")] {
        let plan = |threads: &str, out: &str| {
            let run = mp(&dir, &["plan", scene, "--planner", planner, "--threads", threads, "--out", out]);
            assert_eq!(run.code, 0, "{run:?}");
            dir.read(out)
        };
        assert_eq!(plan("1", "one.txt"), plan("2", "two.txt"), "{scene}");
    }
    let run = mp(
        &dir,
        &["plan", "velocities", "--planner", "restart-rsrt", "--set", "unit=50", "--out", "again.txt"],
    );
    assert_eq!(run.code, 0, "{run:?}");
    assert_eq!(mp(&dir, &["check", "velocities", "again.txt"]).code, 0);
}

/// The rows of a path without its first line.
fn rows(dir: &Dir, file: &str) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split_whitespace().map(|x| x.parse().unwrap()).collect();
    dir.read(file).lines().skip(1).map(numbers).collect()
}

fn write(dir: &Dir, file: &str, rows: &[Vec<f64>]) {
    let line = |row: &Vec<f64>| row.iter().map(|x| format!("{x} ")).collect::<String>() + "\n";
    let head = format!("{} {}\n", rows.len(), rows[0].len());
    dir.write(file, head + &rows.iter().map(line).collect::<String>());
}

#[test]
fn a_path_that_is_not_what_its_inputs_do_is_refused() {
    let dir = Dir::empty();
    // As found: every input is held for as long as the problem says.
    assert_eq!(mp(&dir, &["plan", "velocities", "--no-shorten", "--out", "good.txt"]).code, 0);
    let good = rows(&dir, "good.txt");
    type Change = fn(&mut Vec<Vec<f64>>);
    let changes: [(Change, &str); 5] = [
        // Elsewhere than the input leads.
        (|rows| rows[2][0] += 1e-4, "configuration 3 is not where its input leads"),
        // Faster than the robot, for the time that it takes to the same place.
        (
            |rows| {
                (3..6).for_each(|i| rows[1][i] *= 1e3);
                rows[1][6] /= 1e3;
            },
            "the input of configuration 2 is beyond its limits",
        ),
        // Longer than an input is held.
        (
            |rows| {
                (3..6).for_each(|i| rows[1][i] /= 10.0);
                rows[1][6] *= 10.0;
            },
            "the input of configuration 2 is held for 5 s, not for up to 0.5 s",
        ),
        (|rows| drop(rows.pop()), "does not end at the goal"),
        (|rows| drop(rows.remove(0)), "does not begin at the start"),
    ];
    for (change, words) in changes {
        let mut bad = good.clone();
        change(&mut bad);
        write(&dir, "bad.txt", &bad);
        let check = mp(&dir, &["check", "velocities", "bad.txt"]);
        assert!(check.code == 1 && check.stdout.contains(words), "{words}: {check:?}");
    }
    // An input that leads into the wall, to where it leads.
    let start = [0.8, 0.5, 0.0];
    let mut into = vec![vec![start[0], start[1], start[2], 0.0, 0.0, 0.0, 0.0]];
    for i in 1..=4 {
        into.push(vec![start[0] + 0.4 * f64::from(i), start[1], 0.0, 0.8, 0.0, 0.0, 0.5]);
    }
    write(&dir, "into.txt", &into);
    let check = mp(&dir, &["check", "velocities", "into.txt"]);
    assert!(check.code == 1 && check.stdout.contains("hits lower wall"), "{check:?}");
}

#[test]
fn a_path_through_what_moves_is_refused() {
    let dir = Dir::empty();
    assert_eq!(mp(&dir, &["plan", "crossing", "--out", "good.txt"]).code, 0);
    let good = rows(&dir, "good.txt");
    for (change, words) in [
        ((|rows| rows[1][2] = 1e-3) as fn(&mut Vec<Vec<f64>>), "too far for"),
        (|rows| rows[2][2] = rows[1][2], "not after the one before"),
        (|rows| drop(rows.pop()), "does not end at the goal"),
        (|rows| rows[0][2] = 0.1, "does not begin at the start"),
    ] {
        let mut bad = good.clone();
        change(&mut bad);
        write(&dir, "bad.txt", &bad);
        let check = mp(&dir, &["check", "crossing", "bad.txt"]);
        assert!(check.code == 1 && check.stdout.contains(words), "{words}: {check:?}");
    }
    // The same way when the gate is closed again, and straight through the lorry that waits.
    let mut late = good.clone();
    late.iter_mut().skip(1).for_each(|row| row[2] += 16.0);
    write(&dir, "late.txt", &late);
    let check = mp(&dir, &["check", "crossing", "late.txt"]);
    assert!(check.code == 1 && check.stdout.contains("hits gate"), "{check:?}");
    let through = [vec![6.0, 0.8, 0.0], vec![6.0, 0.8, 4.2], vec![6.0, 6.4, 9.9]];
    write(&dir, "through.txt", &through);
    let check = mp(&dir, &["check", "crossing", "through.txt"]);
    assert!(check.code == 1 && check.stdout.contains("hits westbound"), "{check:?}");
    let at = mp(&dir, &["check", "crossing", "--at", "6 5 8"]);
    assert!(at.code == 1 && at.stdout.contains("westbound"), "{at:?}");
    assert_eq!(mp(&dir, &["check", "crossing", "--at", "6 5 30"]).code, 0);
}

#[test]
fn planners_that_cannot_do_it_say_why_and_which_can() {
    let dir = Dir::empty();
    for (scene, planner, why, other) in [
        ("crossing", "rrt-connect", "backward", "rrt-star"),
        ("crossing", "prm", "both directions", "rrt"),
        ("crossing", "rsrt", "moves robots by inputs", "rrt-star"),
        ("crossing", "or-rrt-inputs", "moves robots by inputs", "velocities"),
        ("parking", "rrt", "moves by inputs", "rsrt"),
        ("parking", "or-rrt-star", "moves by inputs", "rc-rrt"),
        ("parking", "visibility-prm", "both directions", "rrt-inputs"),
    ] {
        let run = mp(&dir, &["plan", scene, "--planner", planner]);
        assert!(run.code == 2 && run.stderr.contains(why) && run.stderr.contains(other), "{run:?}");
    }
    let relax = mp(&dir, &["plan", "unicycle", "--relax"]);
    assert!(relax.code == 2 && relax.stderr.contains("relaxed"), "{relax:?}");
    let setting = mp(&dir, &["plan", "unicycle", "--set", "unit=3"]);
    assert!(setting.code == 2 && setting.stderr.contains("rsrt has no parameter"), "{setting:?}");
}

const MOVING: &str = "[world]\nwalls = [[0, 0], [4, 3]]\n[robot]\ndisc = 0.1\n[motion]\nstart = [0.5, 0.5]\n\
    goal = { x = 3.5 }\nspeed = 1\n[[moving]]\nname = \"bar\"\nrectangle = [[-0.1, -1], [0.1, 1]]\n\
    path = [[0, 2, 1], [4, 2, 2]]\n";
const CAR: &str = "[world]\nwalls = [[0, 0], [9, 9]]\n[robot]\npolygon = [[0, 0], [1, 0], [1, 1]]\nkind = \"car\"\n\
    speed = 1\nwheelbase = 0.7\nsteering = 0.5\nduration = 0.5\n[motion]\nstart = [2, 2, 0]\n\
    goal = { x = [6, 7], y = [6, 7] }\n";
const PUCK: &str = "[world]\nwalls = [[0, 0], [9, 9]]\n[robot]\ndisc = 0.1\nkind = \"accelerations\"\nspeeds = [1, 1]\n\
    accelerations = [1, 1]\nduration = 0.5\n[motion]\nstart = [2, 2, 0.5, 0]\ngoal = [6, 6]\ntolerance = 0.4\n";

/// A disc moved by velocities goes by a bar that moves.
const AMONG: &str = "[world]\nwalls = [[0, 0], [4, 3]]\n[robot]\ndisc = 0.1\nkind = \"velocities\"\nspeeds = [1, 1]\n\
    duration = 0.4\n\n[motion]\nstart = [0.5, 0.5]\ngoal = { x = [3.4, 3.7] }\nhorizon = 20\n\n[[moving]]\nname = \"bar\"\n\
    rectangle = [[-0.1, -1.4], [0.1, 1.4]]\npath = [[0, 2, 1.5], [4, 2, 1.5], [6, 2, 4.5]]\n";
/// A box moved by velocities goes around a post.
const BODY: &str = "[robot]\nkind = \"velocities\"\nbox = [0.5, 0.2, 0.2]\nbounds = [[-2, -2, -1], [2, 2, 1]]\n\
    speeds = [1, 1, 1, 2, 2, 2]\nduration = 0.4\n[motion]\nstart = [-1.5, 0, 0, 0, 0, 0]\ngoal = [1.5, 0, 0, 0, 0, 0]\n\
    tolerance = 0.3\n[[obstacle]]\nname = \"post\"\nbox = [0.3, 0.8, 4]\n";

/// A box moved by velocities waits for a door.
const DOOR: &str = "[robot]\nkind = \"velocities\"\nbox = [0.5, 0.2, 0.2]\nbounds = [[-2, -1, -0.5], [2, 1, 0.5]]\n\
    speeds = [1, 1, 1, 2, 2, 2]\nduration = 0.4\n[motion]\nstart = [-1.5, 0, 0, 0, 0, 0]\ngoal = [1.5, 0, 0, 0, 0, 0]\n\
    tolerance = 0.3\nhorizon = 15\n[[moving]]\nname = \"door\"\nbox = [0.1, 2.4, 1.4]\n\
    path = [[0, 0, 0, 0], [3, 0, 0, 0], [5, 0, 0, 2]]\n";

#[test]
fn faults_of_files_have_their_line() {
    let dir = Dir::empty();
    let mut wrong = Vec::new();
    for (good, from, to, line, words) in [
        (MOVING, "speed = 1\n", "", 6, "the robot has no speed"),
        (MOVING, "speed = 1\n", "speed = 0\n", 8, "the speed is 0"),
        (MOVING, "speed = 1\n", "speed = 1\nhorizon = -1\n", 9, "the horizon is -1"),
        (MOVING, "speed = 1\n", "speed = 1\nstart_time = 5\nhorizon = 4\n", 10, "a time after the start"),
        (
            MOVING,
            "speed = 1\n",
            "speed = 1\nhorizon = 5\ngoal_time = [6, 7]\n",
            10,
            "not between start and horizon",
        ),
        (MOVING, "speed = 1\n", "speed = 1\ngoal_time = [7, 6]\n", 9, "from 7 to 6"),
        (MOVING, "[4, 2, 2]", "[0, 2, 2]", 12, "row 2 of the path of bar is at 0 s"),
        (MOVING, "[4, 2, 2]", "[4, 2]", 12, "row 2 of the path of bar has 2 numbers"),
        (MOVING, "[[0, 2, 1], [4, 2, 2]]", "[]", 12, "the path of bar is empty"),
        (MOVING, "path = ", "paths = ", 12, "path"),
        (MOVING, "rectangle = [[-0.1, -1], [0.1, 1]]\n", "", 9, "exactly one shape"),
        (MOVING, "{ x = 3.5 }", "{ z = 3.5 }", 7, "`z`, which the robot does not have"),
        (MOVING, "{ x = 3.5 }", "{ x = [3.5, 3] }", 7, "from 3.5 to 3"),
        (MOVING, "{ x = 3.5 }", "{}", 7, "asks for nothing"),
        (MOVING, "{ x = 3.5 }", "{ x = \"far\" }", 7, "neither a number nor an interval"),
        (
            MOVING,
            "disc = 0.1\n",
            "disc = 0.1\nkind = \"velocities\"\nspeeds = [1, 1]\nduration = 1\n",
            11,
            "inputs say how fast it is",
        ),
        (CAR, "speed = 1\n", "", 3, "needs `speed`"),
        (CAR, "\"car\"", "\"cart\"", 5, "no kind of robot `cart`"),
        (CAR, "kind = \"car\"\n", "", 8, "`duration` is given, and no kind"),
        (CAR, "steering = 0.5\n", "", 3, "needs `steering`"),
        (CAR, "steering = 0.5", "steering = 1.6", 8, "the steering angle is 1.6"),
        (
            CAR,
            "steering = 0.5",
            "steering = 0.5\nturning_radius = 2",
            9,
            "a steering angle and a turning radius",
        ),
        (CAR, "steering = 0.5", "steering = 0.5\nspeeds = [1, 1]", 9, "has no `speeds`"),
        (CAR, "duration = 0.5", "duration = 0", 9, "`duration` is 0; expected numbers above zero"),
        (CAR, "{ x = [6, 7], y = [6, 7] }", "[6, 6, 0]", 12, "cannot reach these numbers exactly"),
        (CAR, "[2, 2, 0]", "[2, 2]", 11, "the start has 2"),
        (CAR, "[motion]\n", "[motion]\nspeed = 1\n", 11, "nothing else moves"),
        (PUCK, "speeds = [1, 1]", "speeds = [1]", 3, "`speeds` has 1 of 2 limits"),
        (PUCK, "tolerance = 0.4", "tolerance = 0", 12, "the tolerance is 0"),
        (PUCK, "[2, 2, 0.5, 0]", "[2, 2, 0.5]", 10, "the start has 3"),
        (PUCK, "[6, 6]", "[6, 6, 6]", 11, "the goal has 3"),
        (AMONG, "horizon = 20\n", "speed = 1\n", 12, "no speed here"),
        (AMONG, "horizon = 20\n", "horizon = 0\n", 12, "a time after the start"),
        (AMONG, "horizon = 20\n", "goal_time = [5, 4]\n", 12, "from 5 to 4"),
        (AMONG, "horizon = 20\n", "goal_time = 9\n", 12, "cannot arrive at an exact time"),
        (AMONG, "x = [3.4, 3.7]", "x = 3.5", 11, "cannot reach these numbers exactly"),
        (BODY, "box =", "planar = true\nbox =", 2, "does not move by inputs here"),
        (BODY, "\"velocities\"", "\"car\"", 2, "no kind of robot `car` here"),
        (BODY, "speeds = [1, 1, 1, 2, 2, 2]", "speeds = [1, 1, 1]", 1, "`speeds` has 3 of 6 limits"),
        (BODY, "duration = 0.4\n", "", 1, "needs `duration`"),
        (BODY, "tolerance = 0.3\n", "", 9, "cannot reach these numbers exactly"),
        (
            BODY,
            "goal = [1.5, 0, 0, 0, 0, 0]",
            "goal = { v_x = 0 }",
            9,
            "`v_x`, which the robot does not have",
        ),
        (BODY, "start = [-1.5, 0, 0, 0, 0, 0]", "start = [-1.5, 0, 0]", 8, "the start has 3"),
    ] {
        assert!(good.contains(from), "{from}");
        dir.write("bad.toml", good.replacen(from, to, 1));
        let run = mp(&dir, &["plan", "bad.toml", "--time", "5"]);
        let place = format!("bad.toml:{line}:");
        if run.code != 2 || !run.stderr.contains(&place) || !run.stderr.contains(words) {
            wrong.push(format!("{to:?}: expected {place} {words}: {}", run.stderr));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for good in [MOVING, CAR, PUCK, AMONG, BODY, DOOR] {
        dir.write("good.toml", good);
        let run = mp(&dir, &["plan", "good.toml", "--out", "good.txt"]);
        assert_eq!(run.code, 0, "{run:?}");
        assert_eq!(mp(&dir, &["check", "good.toml", "good.txt"]).code, 0);
    }
}

#[test]
fn times_of_start_and_goal_are_kept() {
    let dir = Dir::empty();
    // Also times later than the usual horizon.
    for (given, asked) in [("[9, 10]", 9.0..=10.0), ("100", 100.0..=100.0), ("[100, 1e6]", 100.0..=1e6)] {
        let times = format!("speed = 1\nstart_time = 1.5\ngoal_time = {given}\n");
        dir.write("timed.toml", MOVING.replace("speed = 1\n", &times));
        assert_eq!(mp(&dir, &["plan", "timed.toml", "--out", "timed.txt"]).code, 0);
        let mut rows = rows(&dir, "timed.txt");
        let times = [rows[0][2], rows[rows.len() - 1][2]];
        assert!(times[0] == 1.5 && asked.contains(&times[1]), "{given}: {times:?}");
        assert_eq!(rows[rows.len() - 1][0], 3.5);
        let last = rows.len() - 1;
        rows[last][2] = 20.0;
        let early: String = rows.iter().map(|row| format!("{} {} {}\n", row[0], row[1], row[2])).collect();
        dir.write("early.txt", format!("{} 3\n{early}", rows.len()));
        assert_eq!(mp(&dir, &["check", "timed.toml", "early.txt"]).code, 1, "{given}");
    }
}

/// How long a path takes: the sum of its last column.
fn seconds(rows: &[Vec<f64>]) -> f64 {
    rows.iter().map(|row| row[row.len() - 1]).sum()
}

/// Shortened paths are verified, take less time, and are the same for the same seed.
#[test]
fn paths_by_inputs_are_shortened() {
    let dir = Dir::empty();
    dir.write("body.toml", BODY);
    dir.write("among.toml", AMONG);
    for (scene, least) in [
        ("unicycle", 0.9),
        ("velocities", 0.9),
        ("accelerations", 0.9),
        ("parking", 0.9),
        ("body.toml", 0.9),
        ("among.toml", 0.99),
    ] {
        let mut parts = Vec::new();
        for seed in ["1", "2"] {
            let plan = |more: &[&str], out: &str| {
                let run =
                    mp(&dir, &[&["plan", scene, "--seed", seed, "--out", out, "--json"], more].concat());
                assert_eq!(run.code, 0, "{run:?}");
                (run.json()["shortened"].as_bool().unwrap(), rows(&dir, out))
            };
            let (shortened, short) = plan(&[], "short.txt");
            assert_eq!(mp(&dir, &["check", scene, "short.txt"]).code, 0);
            let (as_found, long) = plan(&["--no-shorten"], "long.txt");
            assert!(shortened && !as_found, "{scene} {seed}");
            assert!(seconds(&short) <= seconds(&long), "{scene} {seed}");
            assert_eq!(plan(&[], "again.txt").1, short);
            parts.push(seconds(&short) / seconds(&long));
        }
        let mean = parts.iter().sum::<f64>() / parts.len() as f64;
        assert!(mean < least, "{scene}: {parts:?}");
    }
}

/// The robot waits until the bar has gone; at another time the same way is refused.
#[test]
fn inputs_among_what_moves_are_timed() {
    let dir = Dir::empty();
    dir.write("among.toml", AMONG);
    assert_eq!(mp(&dir, &["plan", "among.toml", "--out", "good.txt"]).code, 0);
    let good = rows(&dir, "good.txt");
    // x, y, time, input, duration: the times are the sums of the durations.
    let mut now = 0.0;
    for row in &good {
        now += row[5];
        assert!((row[2] - now).abs() < 1e-9, "{row:?}");
    }
    let beyond = good.iter().find(|row| row[0] > 1.9).unwrap();
    assert!(beyond[2] > 4.0, "{beyond:?}");
    // Straight through while the bar is there.
    let mut through = vec![vec![0.5, 0.5, 0.0, 0.0, 0.0, 0.0]];
    (1..=8).for_each(|i| {
        through.push(vec![0.5 + 0.4 * f64::from(i), 0.5, 0.4 * f64::from(i), 1.0, 0.0, 0.4]);
    });
    write(&dir, "through.txt", &through);
    let check = mp(&dir, &["check", "among.toml", "through.txt"]);
    assert!(check.code == 1 && check.stdout.contains("hits bar"), "{check:?}");
    // Times that do not go with the durations.
    let mut late = good.clone();
    late.iter_mut().skip(1).for_each(|row| row[2] += 1.0);
    write(&dir, "late.txt", &late);
    let check = mp(&dir, &["check", "among.toml", "late.txt"]);
    assert!(check.code == 1 && check.stdout.contains("configuration 2 is not where"), "{check:?}");
    let info = mp(&dir, &["info", "among.toml"]);
    assert!(info.stdout.contains("bar") && info.stdout.contains("velocities up to"), "{info:?}");
}

const URDF: &str = r#"<robot name="two">
<link name="base"/>
<link name="upper"><collision><origin xyz="0.5 0 0"/><geometry><box size="0.9 0.1 0.1"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.5 0 0"/><geometry><box size="0.9 0.1 0.1"/></geometry></collision></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
<limit lower="-2.5" upper="2.5" velocity="1"/></joint>
</robot>"#;
const ARM: &str = "[robot]\nurdf = \"two.urdf\"\n\n[motion]\nstart = [-0.7, 0]\ngoal = { shoulder = 0.7 }\n\n\
                    [[obstacle]]\nname = \"post\"\nbox = [0.2, 0.2, 1]\npose = [1.5, 0, 0, 0, 0, 0]\n";

#[test]
fn arms_have_free_joints_and_inputs_too() {
    let dir = Dir::empty();
    dir.write("two.urdf", URDF);
    let velocities = "kind = \"velocities\"\nspeeds = [1, 1.5]\nduration = 0.4\n";
    let accelerations = "kind = \"accelerations\"\nspeeds = [1, 2]\naccelerations = [2, 4]\nduration = 0.4\n";
    let near = "{ shoulder = [0.6, 0.8] }";
    let by = |inputs: &str, goal: &str| {
        let robot = format!("urdf = \"two.urdf\"\n{inputs}");
        ARM.replace("urdf = \"two.urdf\"\n", &robot).replace("{ shoulder = 0.7 }", goal)
    };
    for (name, text, columns) in [
        ("free", ARM.to_owned(), 2),
        ("set", ARM.replace("goal = { shoulder = 0.7 }", "goals = [{ elbow = 2.4 }, [0.7, 0.1]]"), 2),
        ("velocities", by(velocities, near), 5),
        ("accelerations", by(accelerations, near), 7),
    ] {
        dir.write(&format!("{name}.toml"), text);
        let (scene, path) = (format!("{name}.toml"), format!("{name}.txt"));
        let run = mp(&dir, &["plan", &scene, "--out", &path]);
        assert_eq!(run.code, 0, "{run:?}");
        assert_eq!(mp(&dir, &["check", &scene, &path]).code, 0);
        assert!(rows(&dir, &path).iter().all(|row| row.len() == columns));
    }
    for (text, line, words) in [
        (by("", "{ wrist = 1 }"), 6, "`wrist`, which the robot does not have"),
        (by("", "[0.7]"), 6, "the goal has 1"),
        (by(velocities, "[0.7, 0]"), 9, "cannot reach these numbers exactly"),
        (by(&velocities.replace("1.5", "1.5, 1"), near), 1, "`speeds` has 3 of 2 limits"),
        (by("kind = \"car\"\n", near), 3, "no kind of robot `car` here"),
        (by("", "[0.7, 0]\ntolerance = 0.1"), 7, "only robots that move by inputs"),
        (by("", "[0.7, 0]\nspeed = 0.1"), 7, "needs no speed"),
    ] {
        dir.write("bad.toml", text);
        let run = mp(&dir, &["plan", "bad.toml"]);
        let place = format!("bad.toml:{line}:");
        assert!(
            run.code == 2 && run.stderr.contains(&place) && run.stderr.contains(words),
            "{words}: {run:?}"
        );
    }
}

/// A robot whose base floats, with goals that leave numbers free, and sets of them.
#[test]
fn floating_bases_have_free_goals() {
    let dir = Dir::empty();
    dir.write("two.urdf", URDF);
    let text = |goal: &str| {
        format!(
            "[robot]\nurdf = \"two.urdf\"\nbase = \"floating\"\nbounds = [[-3, -3, -1], [3, 3, 1]]\n[motion]\n\
             start = [-2.5, 0, 0, 0, 0, 0, 0, 0]\n{goal}\n[[obstacle]]\nname = \"wall\"\nbox = [0.2, 2, 1]\n"
        )
    };
    for (goal, ends) in [
        ("goal = { x = 2, elbow = [1, 1.2] }", [2.0, 1.0, 1.2]),
        ("goals = [{ x = 2, beta = 0.5, elbow = 0.3 }]", [2.0, 0.3, 0.3]),
        ("goals = [[2, 0, 0, 0, 0, 0, 0, 0.4], { x = 2, elbow = 0.4 }]", [2.0, 0.4, 0.4]),
    ] {
        dir.write("floating.toml", text(goal));
        let run = mp(&dir, &["plan", "floating.toml", "--out", "path.txt", "--picture", "path.png"]);
        assert_eq!(run.code, 0, "{goal}: {run:?}");
        assert_eq!(mp(&dir, &["check", "floating.toml", "path.txt"]).code, 0);
        let last = rows(&dir, "path.txt").pop().unwrap();
        let [x, low, high] = ends;
        assert!(
            (last[0] - x).abs() < 1e-6 && (low - 1e-6..=high + 1e-6).contains(&last[7]),
            "{goal}: {last:?}"
        );
    }
    for (goal, words) in [
        ("goal = { x = 2, beta = 2 }", "beta from -π/2 to π/2"),
        ("goal = { x = 2, wrist = 1 }", "`wrist`, which the robot does not have"),
        ("goal = [2, 0, 0]", "the goal has 3"),
    ] {
        dir.write("bad.toml", text(goal));
        let run = mp(&dir, &["plan", "bad.toml"]);
        let place = "bad.toml:7:";
        assert!(run.code == 2 && run.stderr.contains(place) && run.stderr.contains(words), "{run:?}");
    }
}

/// Formats with one goal say where there can be more.
#[test]
fn formats_with_one_goal_say_so() {
    let dir = Dir::new();
    let env = dir.read("window.env");
    for (from, to) in [
        ("2 1.3 1.8 0.7 0 0\n", "2 1.3 1.8 0.7 0 0\n2 1 1 0 0 0\n"),
        ("2 1.3 1.8 0.7 0 0\n", "2 1.3 * 0 0 0\n"),
    ] {
        assert!(env.contains(from));
        dir.write("goals.env", env.replacen(from, to, 1));
        let run = mp(&dir, &["plan", "goals.env"]);
        let [place, words] = ["goals.env:", "a rigid problem (.toml) may have several goals"];
        assert!(run.code == 2 && run.stderr.contains(place) && run.stderr.contains(words), "{run:?}");
    }
    dir.write(
        "goal.cfg",
        "[problem]\nrobot=robot.off\nstart.x=0\nstart.y=0\nstart.theta=0\ngoal.x=1\ngoal.y=1\n",
    );
    let run = mp(&dir, &["plan", "goal.cfg"]);
    assert!(run.code == 2 && run.stderr.contains("are in rigid problems (.toml)"), "{run:?}");
    dir.write(
        "goals.mp.json",
        r#"{"version": 1, "name": "x", "space": "SE3", "goals": [[0, 0, 0, 0, 0, 0]]}"#,
    );
    let run = mp(&dir, &["plan", "goals.mp.json"]);
    assert!(run.code == 2 && run.stderr.contains("rigid problems (.toml) have sets of goals"), "{run:?}");
}

/// A path called as a shipped scene does not hide it.
#[test]
fn a_path_does_not_hide_a_shipped_scene() {
    let dir = Dir::empty();
    for scene in ["velocities", "docks"] {
        let path = format!("{scene}.txt");
        for _ in 0..2 {
            let run = mp(&dir, &["plan", scene, "--out", &path]);
            assert_eq!(run.code, 0, "{run:?}");
        }
        assert_eq!(mp(&dir, &["check", scene, &path]).code, 0);
    }
}
