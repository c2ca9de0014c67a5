//! Which joints of a robot move: held ones, groups, states with names, and bases that move in the plane.

use mp_io::InMemory;
use mp_plan::{Interrupt, PathRows, Request, Scene};
use std::path::Path;

/// A lift with two bars of a metre that turn about z one above the other, and a finger that slides.
const URDF: &str = r#"<robot name="two">
<link name="base"><collision><geometry><box size="0.3 0.3 0.02"/></geometry></collision></link>
<link name="lift"/>
<link name="upper"><collision><origin xyz="0.5 0 0.1"/><geometry><box size="0.9 0.1 0.1"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.5 0 0.3"/><geometry><box size="0.9 0.1 0.1"/></geometry></collision></link>
<link name="tip"><collision><origin xyz="0.1 0 0"/><geometry><box size="0.1 0.02 0.02"/></geometry></collision></link>
<joint name="raise" type="prismatic"><parent link="base"/><child link="lift"/><axis xyz="0 0 1"/><limit lower="0.1" upper="0.4" velocity="1"/></joint>
<joint name="shoulder" type="revolute"><parent link="lift"/><child link="upper"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
<limit lower="-2.5" upper="2.5" velocity="1"/></joint>
<joint name="finger" type="prismatic"><parent link="lower"/><child link="tip"/><origin xyz="1 0 0.3"/><limit lower="0" upper="0.1" velocity="1"/></joint>
</robot>"#;

const SRDF: &str = r#"<robot name="two">
<group name="arm"><chain base_link="lift" tip_link="lower"/></group>
<group name="hand"><link name="tip"/></group>
<group name="both"><group name="arm"/><group name="hand"/></group>
<group name="around"><group name="around"/></group>
<group name="toes"><joint name="of the world"/><link name="toe"/></group>
<group name="upward"><chain base_link="tip" tip_link="lift"/></group>
<group name="apart"><chain base_link="tip" tip_link="gone"/></group>
<group_state name="home" group="arm"><joint name="shoulder" value="0.8"/><joint name="elbow" value="0.2"/></group_state>
<group_state name="home" group="hand"><joint name="finger" value="0.05"/></group_state>
<group_state name="up" group="both"><joint name="raise" value="0.3"/><joint name="shoulder" value="-0.5"/></group_state>
</robot>"#;

/// The scene of the text of a problem about `r.urdf` and `r.srdf`.
pub(crate) fn scene_of(problem: String) -> Result<Scene, mp_plan::Error> {
    let at = move |name: &str| match name {
        "p.toml" => Some(problem.clone()),
        "r.urdf" => Some(URDF.to_owned()),
        "r.srdf" => Some(SRDF.to_owned()),
        _ => None,
    };
    Scene::load_from(&InMemory(at), Path::new("p.toml"))
}

fn load(robot: &str, motion: &str) -> Result<Scene, mp_plan::Error> {
    let problem = format!("[robot]\nurdf = \"r.urdf\"\nsrdf = \"r.srdf\"\n{robot}\n[motion]\n{motion}\n");
    scene_of(problem)
}

fn names(scene: &Scene) -> Vec<String> {
    scene.columns().into_iter().map(|column| column.name).collect()
}

fn path(scene: &Scene) -> Vec<Vec<f64>> {
    let report = scene.plan(&Request::new("rrt-connect").iterations(20_000)).unwrap();
    assert!(report.solved && report.verified);
    report.path.unwrap()
}

/// A joint without end that is held lets joints with limits mimic it, also where it is held by the start, or nothing says where.
#[test]
fn what_mimics_a_joint_without_end() {
    let load = |robot: &str, start: &str, mimic: &str| {
        let toml = format!("[robot]\nurdf = \"r.urdf\"\n{robot}\n[motion]\nstart = {start}\ngoal = [1]\n");
        let urdf = format!(
            "<robot name=\"r\"><link name=\"base\"/><link name=\"a\"/><link name=\"b\"/><link name=\"m\"/>\
             <joint name=\"a\" type=\"continuous\"><parent link=\"base\"/><child link=\"a\"/></joint>\
             <joint name=\"b\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><limit lower=\"-3\" upper=\"3\"/></joint>\
             <joint name=\"m\" type=\"prismatic\"><parent link=\"base\"/><child link=\"m\"/><limit lower=\"0.05\" upper=\"0.4\"/>\
             <mimic joint=\"a\" {mimic}/></joint></robot>"
        );
        let at = move |name: &str| match name {
            "p.toml" => Some(toml.clone()),
            "r.urdf" => Some(urdf.clone()),
            _ => None,
        };
        Scene::load_from(&InMemory(at), Path::new("p.toml"))
    };
    let half = "multiplier=\"0.5\"";
    let by_start = load("joints = [\"b\"]", "{ a = 0.2, b = 0 }", half).unwrap();
    assert_eq!(names(&by_start), ["b"]);
    assert!(by_start.notes().iter().any(|note| note.contains("a at 0.2")), "{:?}", by_start.notes());
    assert_eq!(names(&load("hold = { a = 0.2 }", "[0]", half).unwrap()), ["b"]);
    assert_eq!(names(&load("joints = [\"b\"]", "[0]", "multiplier=\"0.5\" offset=\"0.1\"").unwrap()), ["b"]);
    // Out of the limits of what mimics it, and where the joint moves.
    assert!(load("joints = [\"b\"]", "[0]", half).unwrap_err().to_string().contains("outside of the limits"));
    assert!(load("", "[0, 0]", half).unwrap_err().to_string().contains("without end"));
    // A multiplier of zero follows nothing.
    let still = load("joints = [\"a\"]", "[0]", "multiplier=\"0\" offset=\"0.1\"").unwrap();
    assert_eq!(names(&still), ["a"]);
    assert!(load("joints = [\"a\"]", "[0]", "multiplier=\"0\" offset=\"1\"").is_err());
}

#[test]
fn held_joints_have_no_numbers() {
    let scene = load("hold = { raise = 0.3, finger = 0 }", "start = [0, 0]\ngoal = [1, 1]").unwrap();
    assert_eq!(names(&scene), ["shoulder", "elbow"]);
    // A bar that is at the height of the arm when raised, and not otherwise.
    let bar = "\n[[obstacle]]\nbox = [0.1, 0.1, 0.02]\npose = [0.5, 0.5, 0.2, 0, 0, 0]";
    let goal = |hold: &str| {
        load(
            &format!("hold = {{ raise = {hold}, finger = 0 }}"),
            &format!("start = [0, 0]\ngoal = [0.785, 0]{bar}"),
        )
    };
    assert!(goal("0.3").unwrap().check_ends().is_ok());
    assert!(goal("0.1").unwrap().check_ends().is_err());
    // A link behind held joints stands still, but must not stand in an obstacle.
    let held = |height: f64| {
        let inside = bar.replace("pose = [0.5, 0.5, 0.2,", &format!("pose = [0.5, 0, {height},"));
        let motion = format!("start = [0.5, 0]\ngoal = [-0.5, 0.1]{inside}");
        load("hold = { raise = 0.3, shoulder = 0 }", &motion).unwrap()
    };
    assert_eq!(path(&held(0.2)).last().unwrap(), &[-0.5, 0.1]);
    let (scene, free) = (held(0.4), held(0.2));
    let error = scene.plan(&Request::default()).unwrap_err().report();
    assert!(error.contains("upper in obstacle 1") && error.contains("no joint moves upper"), "{error}");
    let rows = vec![scene.start(), scene.goals().remove(0)];
    let straight = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    assert!(free.check(&straight).unwrap().free);
    let verdict = scene.check(&straight).unwrap();
    assert!(!verdict.free && verdict.faults[0].contains("upper"), "{verdict:?}");
    assert!(free.certificate(&straight, 0.0, &Interrupt::never()).is_ok());
    assert!(scene.certificate(&straight, 0.0, &Interrupt::never()).is_err());
    // A hair beyond the limit is at the limit.
    assert!(load("hold = { raise = 0.4000004 }", "start = [0, 0, 0]\ngoal = [1, 1, 0]").is_ok());
}

#[test]
fn a_group_or_a_list_moves_and_the_others_are_held() {
    let scene = load("group = \"arm\"", "start = \"home\"\ngoal = { elbow = 1 }").unwrap();
    assert_eq!(names(&scene), ["shoulder", "elbow"]);
    assert_eq!(scene.start(), [0.8, 0.2]);
    // Held where the state has it, else at zero, or the limit nearest to it.
    assert!(
        scene.notes().iter().any(|note| note.contains("raise at 0.1, finger at 0.05")),
        "{:?}",
        scene.notes()
    );
    let held = load("group = \"arm\"\nhold = { finger = 0.02 }", "start = \"up\"\ngoal = \"home\"").unwrap();
    assert!(held.notes().iter().any(|note| note.contains("held are raise at 0.3")), "{:?}", held.notes());
    assert_eq!(path(&held).last().unwrap(), &[0.8, 0.2]);
    let scene =
        load("joints = [\"finger\", \"raise\"]", "start = { finger = 0.05, shoulder = 1 }\ngoal = [0.2, 0]")
            .unwrap();
    assert_eq!(names(&scene), ["raise", "finger"]);
    assert_eq!(scene.start(), [0.1, 0.05]);
    assert!(scene.notes().iter().any(|note| note.contains("shoulder at 1, elbow at 0")));
    assert_eq!(names(&load("group = \"hand\"", "start = [0]\ngoal = [0.1]").unwrap()), ["finger"]);
    // A chain may go up.
    let up = load("group = \"upward\"", "start = [0, 0, 0]\ngoal = [1, 1, 0]").unwrap();
    assert_eq!(names(&up), ["shoulder", "elbow", "finger"]);
    assert_eq!(
        names(&load("group = \"both\"", "start = \"home\"\ngoal = [1, 1, 0]").unwrap()),
        ["shoulder", "elbow", "finger"]
    );
}

#[test]
fn a_goal_may_say_where_a_joint_is_held() {
    for raise in ["0.2", "[0.1, 0.3]"] {
        let goal =
            format!("start = [0, 0, 0]\ngoal = {{ raise = {raise}, shoulder = 1, elbow = 1, finger = 0.1 }}");
        let scene = load("hold = { raise = 0.2 }", &goal).unwrap();
        assert_eq!(path(&scene).last().unwrap()[..], [1.0, 1.0, 0.1], "{raise}");
    }
}

#[test]
fn states_of_several_groups_are_one() {
    let scene = load("", "start = \"home\"\ngoals = [\"up\", [0.1, 1, 1, 0]]").unwrap();
    assert_eq!(scene.start(), [0.1, 0.8, 0.2, 0.05]);
    assert_eq!(scene.goals()[0], [0.3, -0.5, 0.2, 0.05]);
    assert!(
        scene
            .notes()
            .iter()
            .any(|note| note.contains("\"up\" leaves out 2 numbers") && note.contains("elbow, finger"))
    );
}

/// A start that could be either of two is none.
#[test]
fn states_that_differ_are_an_error_unless_the_group_says_which_counts() {
    let other = "<group_state name=\"home\" group=\"both\"><joint name=\"shoulder\" value=\"1.5\"/><joint name=\"finger\" value=\"0.05\"/></group_state></robot>";
    let srdf = SRDF.replace("</robot>", other);
    let load = |robot: &str, start: &str, goal: &str| {
        let problem = format!(
            "[robot]\nurdf = \"r.urdf\"\nsrdf = \"r.srdf\"\n{robot}\n[motion]\nstart = {start}\ngoal = {goal}\n"
        );
        let at = |name: &str| match name {
            "p.toml" => Some(problem.clone()),
            "r.urdf" => Some(URDF.to_owned()),
            _ => (name == "r.srdf").then(|| srdf.clone()),
        };
        Scene::load_from(&InMemory(at), Path::new("p.toml"))
    };
    let error = load("", "\"home\"", "[0.2, 0, 0, 0]").unwrap_err().report();
    for words in ["p.toml:6:", "`shoulder`", "0.8", "\"arm\"", "1.5", "\"both\"", "group = "] {
        assert!(error.contains(words), "{error}");
    }
    let error = load("", "[0.2, 0, 0, 0]", "\"home\"").unwrap_err().report();
    assert!(error.contains("p.toml:7:"), "{error}");
    assert_eq!(load("group = \"arm\"", "\"home\"", "[0, 0]").unwrap().start(), [0.8, 0.2]);
    assert_eq!(load("group = \"both\"", "\"home\"", "[0, 0, 0]").unwrap().start(), [1.5, 0.2, 0.05]);
}

#[test]
fn a_base_in_the_plane_drives_around_what_is_in_the_way() {
    let robot = "base = \"planar\"\nbounds = [[-3, -3], [3, 3]]\ngroup = \"arm\"";
    let wall = "\n[[obstacle]]\nname = \"wall\"\nbox = [0.2, 4, 1]\npose = [0, 1, 0.5, 0, 0, 0]";
    let scene =
        load(robot, &format!("start = {{ x = -2, shoulder = 2, elbow = 1 }}\ngoal = [2, 0, 1, 2, 1]{wall}"))
            .unwrap();
    assert_eq!(names(&scene), ["x", "y", "theta", "shoulder", "elbow"]);
    assert_eq!(scene.start(), [-2.0, 0.0, 0.0, 2.0, 1.0]);
    let path = path(&scene);
    // The wall ends at y = -1 and the base is 0.3 m wide.
    let across = path.windows(2).find(|edge| edge[0][0] < 0.0 && edge[1][0] >= 0.0).unwrap();
    assert!(across[0][1].min(across[1][1]) < -1.0, "{across:?}");
    // Its tool as a goal, which the base comes near to.
    let tool =
        load(robot, "start = [-2, 0, 0, 0.5, 0.5]\ngoal = { link = \"tip\", position = [2.5, 2.5, 0.4] }")
            .unwrap();
    assert!(tool.goals().len() > 4);
    // The base is compared with obstacles, as it moves.
    let on_wall = load(robot, &format!("start = [0, 0, 0, 2, 1]\ngoal = [2, 0, 1, 2, 1]{wall}")).unwrap();
    assert!(on_wall.check_ends().unwrap_err().report().contains("base"));
}

/// A base on a rail, and one that only turns so far.
#[test]
fn numbers_of_a_base_are_held_and_limited_as_joints_are() {
    let all = "raise = 0.3, shoulder = 2, elbow = 1, finger = 0";
    let planar = |more: &str, motion: &str| {
        let base = "base = \"planar\"\nbounds = [[-3, -3], [3, 3]]";
        load(&format!("{base}\n{more}"), motion)
    };
    let rail = format!("hold = {{ x = 1.5, theta = 0.5, {all} }}");
    let scene = planar(&rail, "start = [-2]\ngoal = [2]").unwrap();
    assert_eq!(names(&scene), ["y"]);
    assert_eq!(path(&scene).len(), 2);
    // The base is 0.3 m wide: a post beside the rail is passed, one on it is not.
    for (x, free) in [(1.8, true), (1.6, false), (0.0, true)] {
        let post = format!("\n[[obstacle]]\nbox = [0.02, 0.02, 0.05]\nat = [{x}, 1, 0]");
        let scene = planar(&rail, &format!("start = [-2]\ngoal = [2]{post}")).unwrap();
        let ends = vec![scene.start(), scene.goals().remove(0)];
        let straight = PathRows { format: scene.path_format(), columns: scene.columns(), rows: ends };
        assert_eq!(scene.check(&straight).unwrap().free, free, "{x}");
    }
    let turns = format!("limits = {{ theta = [-1, 1] }}\nhold = {{ {all} }}");
    let scene = planar(&turns, "start = [0, 0, 0.5]\ngoal = [0, 0, 1.5]").unwrap();
    assert_eq!(scene.limits()[2], Some([-1.0, 1.0]));
    let error = scene.check_ends().unwrap_err().report();
    assert!(error.contains("limits = { theta = [-1, 1.5] }"), "{error}");
    let error = planar("hold = { x = 4 }", "start = [0, 0, 0, 0, 0, 0]\ngoal = []").unwrap_err().report();
    assert!(error.contains("p.toml:6:") && error.contains("from -3 to 3"), "{error}");
}

#[test]
fn what_cannot_be_is_an_error_at_its_place() {
    let motion = "start = [0.1, 0, 0, 0]\ngoal = [0.2, 0, 0, 0]";
    for (robot, motion, words) in [
        ("hold = { lift = 0.2 }", motion, ["p.toml:4:", "no joint \"lift\"", "raise"]),
        ("hold = { raise = 0.5 }", motion, ["p.toml:4:", "at 0.5", "from 0.1 to 0.4"]),
        ("hold = { raise = nan }", motion, ["p.toml:4:", "NaN", "finite"]),
        (
            "hold = { raise = 0.2 }\nlimits = { raise = [0.1, 0.2] }",
            motion,
            ["p.toml:4:", "limits too", "not both"],
        ),
        ("group = \"legs\"", motion, ["p.toml:4:", "no group \"legs\"", "arm"]),
        ("group = \"toes\"", motion, ["p.toml:4:", "\"toe\"", "does not have"]),
        ("group = \"apart\"", motion, ["p.toml:4:", "\"gone\"", "does not have"]),
        ("group = \"around\"", motion, ["p.toml:4:", "no joint", "moves"]),
        ("group = \"arm\"\njoints = [\"raise\"]", motion, ["p.toml:5:", "group and a list", "not both"]),
        ("joints = []", motion, ["p.toml:4:", "no joint moves", "names"]),
        ("joints = [\"wrist\"]", motion, ["p.toml:4:", "\"wrist\"", "shoulder"]),
        (
            "joints = [\"raise\"]\nlimits = { raise = [0.2, 0.2] }",
            motion,
            ["p.toml:4:", "raise", "does not move"],
        ),
        ("", "start = \"house\"\ngoal = [0.2, 0, 0, 0]", ["p.toml:6:", "no state \"house\"", "home, up"]),
        ("", "start = [0.1, 0, 0, 0]\ngoal = \"house\"", ["p.toml:7:", "no state \"house\"", "home, up"]),
        ("", "start = { wrist = 1 }\ngoal = [0.2, 0, 0, 0]", ["p.toml:6:", "`wrist`", "shoulder"]),
        (
            "hold = { raise = 0.2 }",
            "start = [0, 0, 0]\ngoal = { raise = 0.3, elbow = 1 }",
            ["p.toml:7:", "`raise`", "held at 0.2"],
        ),
        (
            "hold = { raise = 0.2 }",
            "start = { raise = 0.3, elbow = 1 }\ngoal = [0, 0, 0]",
            ["p.toml:6:", "`raise` at 0.3", "held at 0.2"],
        ),
        (
            "limits = { raise = [0.2, 0.2] }",
            "start = { numbers = [0, 0, 0], held = { raise = 0.3 } }\ngoal = [0, 0, 0]",
            ["p.toml:6:", "`raise` at 0.3", "held at 0.2"],
        ),
        ("", "start = 5\ngoal = [0.2, 0, 0, 0]", ["p.toml:6:", "a start is", "\"home\""]),
        ("base = \"planar\"", motion, ["p.toml:4:", "without bounds", "[[x, y], [x, y]]"]),
        (
            "base = \"planar\"\nbounds = [[0, 0, 0], [1, 1, 1]]",
            motion,
            ["p.toml:5:", "2 numbers", "[[x, y], [x, y]]"],
        ),
        ("base = \"planar\"\nbounds = [[0, 0], [0, 1]]", motion, ["p.toml:5:", "enclose nothing", "lower"]),
        ("base = \"round\"", motion, ["p.toml:4:", "`round`", "planar"]),
    ] {
        let error = match load(robot, motion) {
            Err(error) => error.report(),
            Ok(_) => panic!("{robot} {motion} is no error"),
        };
        assert!(words.iter().all(|word| error.contains(word)), "{robot} {motion}: {error}");
    }
}

/// A message of MoveIt says where all joints are and what the robot carries: a scene where that is otherwise says nothing of it.
#[test]
fn a_trajectory_begins_as_the_scene_holds_joints() {
    let scene = load("hold = { raise = 0.3, finger = 0.05 }", "start = [0, 0]\ngoal = [1, 1]").unwrap();
    let read = |state: &str| {
        let text = format!(
            r#"{{"trajectory_start": {state}, "trajectory": [{{"joint_trajectory": {{"joint_names": ["shoulder", "elbow"],
            "points": [{{"positions": [0, 0], "time_from_start": {{"sec": 0, "nanosec": 0}}}},
            {{"positions": [1, 1], "time_from_start": {{"sec": 4, "nanosec": 0}}}}]}}}}]}}"#
        );
        let read = scene.parse_trajectory("t.json", text.as_bytes(), mp_io::TrajectoryKind::Json, None);
        read.map(drop).map_err(|e| e.report())
    };
    let at = |raise: f64, others: &str| {
        let names = r#"["shoulder", "raise", "elbow", "finger"]"#;
        format!(r#"{{"joint_state": {{"name": {names}, "position": [0, {raise}, 0, 0.05]}}{others}}}"#)
    };
    assert_eq!(read(&at(0.305, "")), Ok(()));
    let error = read(&at(0.1, "")).unwrap_err();
    assert!(error.contains("raise at 0.1") && error.contains("holds it at 0.3"), "{error}");
    let carried = r#", "attached_collision_objects": [{"link_name": "tip", "object": {"id": "pole"}}]"#;
    let error = read(&at(0.3, carried)).unwrap_err();
    assert!(error.contains("\"pole\"") && error.contains("[[attached]]"), "{error}");
}
