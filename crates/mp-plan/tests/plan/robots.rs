//! Robots from files: limits, angles without limits in written paths, and robots alone.

use mp_cspace::Interrupt;
use mp_io::{Disk, InMemory};
use mp_plan::{PathFileKind, PathRows, ProblemChanges, Report, Request, Scene};
use std::f64::consts::PI;
use std::path::Path;

/// The scene of the first of some files in memory.
fn load(files: &[(&str, &str)]) -> Result<Scene, mp_plan::Error> {
    let files: Vec<(String, String)> =
        files.iter().map(|(n, t)| ((*n).to_owned(), (*t).to_owned())).collect();
    let first = files[0].0.clone();
    let at = move |name: &str| files.iter().find(|(n, _)| n == name).map(|(_, text)| text.clone());
    Scene::load_from(&InMemory(at), Path::new(&first))
}

fn scene(files: &[(&str, &str)]) -> Scene {
    load(files).unwrap()
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, limit: Option<[f64; 2]>) -> String {
    let limit = limit.map_or(String::new(), |[low, high]| {
        format!("<limit lower=\"{low}\" upper=\"{high}\" effort=\"1\" velocity=\"1\"/>")
    });
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
         <origin xyz=\"0 0 0.3\"/><axis xyz=\"0 0 1\"/>{limit}</joint>"
    )
}

fn bar(name: &str, length: f64) -> String {
    format!(
        "<link name=\"{name}\"><collision><origin xyz=\"{} 0 0\"/><geometry><box size=\"{length} .05 .05\"/></geometry>\
         </collision></link>",
        0.5 * length
    )
}

/// Two bars that turn about z one above the other: `a` without limits, `b` with these.
fn two_bars(limits: [f64; 2]) -> String {
    let joints =
        [joint("a", "continuous", "base", "one", None), joint("b", "revolute", "one", "two", Some(limits))];
    format!(
        "<robot name=\"r\"><link name=\"base\"/>{}{}{}</robot>",
        bar("one", 0.5),
        bar("two", 0.4),
        joints.concat()
    )
}

fn problem(robot: &str, start: &str, goal: &str) -> String {
    format!("[robot]\nurdf = \"r.urdf\"\n{robot}\n[motion]\nstart = {start}\ngoal = {goal}\n")
}

fn planned(scene: &Scene) -> (Report, PathRows) {
    let report = scene.plan(&Request::new(scene.default_planner())).unwrap();
    let rows = report.path.clone().unwrap();
    let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    (report, path)
}

/// No number of these columns jumps by more than half a turn, and what is written is free as it reads back in every format.
fn goes_on(scene: &Scene, path: &PathRows, columns: &[usize]) {
    for pair in path.rows.windows(2) {
        columns.iter().for_each(|&i| assert!((pair[1][i] - pair[0][i]).abs() <= PI + 1e-9, "{pair:?}"));
    }
    for kind in [PathFileKind::Text, PathFileKind::Json, PathFileKind::Csv] {
        let read = scene.parse_path("p", path.to_file(kind).as_bytes(), kind).unwrap();
        assert_eq!(read.rows, path.rows);
        let verdict = scene.check(&read).unwrap();
        assert!(verdict.free, "{verdict:?}");
    }
    let certificate = scene.certificate(path, 0.0, &Interrupt::never()).unwrap();
    #[cfg(not(target_family = "wasm"))]
    mp_verify_certificate::verify(certificate.to_json()).unwrap();
}

#[test]
fn continuous_joints_go_on_from_the_start_as_given() {
    let urdf = two_bars([-1.0, 1.0]);
    // Start and goal of the joint without limits, and the number in the last row.
    let ends = [
        (3.0, -3.0, 3.283_185_307_179_586),
        (-3.0, 3.0, -3.283_185_307_179_586),
        (3.0, 9.28, 2.996_814_692_820_414),
        (9.0, 9.5, 9.5),
        (-20.0, 0.5, -18.349_555_921_538_76),
        (0.25, 0.5, 0.5),
    ];
    for (start, goal, last) in ends {
        let toml = problem("", &format!("[{start}, 0]"), &format!("[{goal}, 0.5]"));
        let scene = scene(&[("p.toml", &toml), ("r.urdf", &urdf)]);
        let (_, path) = planned(&scene);
        assert_eq!(path.rows[0], [start, 0.0]);
        assert!((path.rows[path.rows.len() - 1][0] - last).abs() < 1e-12, "{:?}", path.rows);
        goes_on(&scene, &path, &[0]);
        assert_eq!(scene.start(), [start, 0.0]);
        // The same with ends given later.
        let moved = scene.with_ends(&[start + 2.0 * PI, 0.0], &[vec![goal, 0.0]]).unwrap();
        let (_, path) = planned(&moved);
        assert_eq!(path.rows[0], [start + 2.0 * PI, 0.0]);
        goes_on(&moved, &path, &[0]);
    }
}

/// Around a wall the long way, in many rows: with joints that move by inputs and on a base that floats too.
#[test]
fn no_kind_of_robot_jumps() {
    let urdf = two_bars([-1.0, 1.0]);
    let wall = "[[obstacle]]\nname = \"wall\"\nbox = [0.1, 0.02, 1.0]\npose = [-0.4, 0, 0.3, 0, 0, 0]\n";
    let toml = problem("", "[2.5, 0]", "[-2.5, 0.5]") + wall;
    let around = scene(&[("p.toml", &toml), ("r.urdf", &urdf)]);
    let (_, path) = planned(&around);
    assert!((path.rows[path.rows.len() - 1][0] + 2.5).abs() < 1e-12, "{:?}", path.rows);
    goes_on(&around, &path, &[0]);

    let inputs = "kind = \"velocities\"\nspeeds = [1.0, 1.0]\nduration = 0.2";
    let toml = problem(inputs, "[3.0, 0]", "{ a = [-3.1, -2.9], b = [-0.5, 0.5] }");
    let driven = scene(&[("p.toml", &toml), ("r.urdf", &urdf)]);
    let (_, path) = planned(&driven);
    assert!(path.rows.last().unwrap()[0] > 3.1, "{:?}", path.rows);
    goes_on(&driven, &path, &[0]);

    let floats = "base = \"floating\"\nbounds = [[-1, -1, -1], [1, 1, 1]]";
    let toml = problem(floats, "[0, 0, 0, 3.0, 0, 0, 3.0, 0]", "[0.5, 0, 0, -3.0, 0, 0, -3.0, 0.5]");
    let floating = scene(&[("p.toml", &toml), ("r.urdf", &urdf)]);
    let (_, path) = planned(&floating);
    let last = path.rows.last().unwrap();
    assert!(
        (last[3] - (2.0 * PI - 3.0)).abs() < 1e-9 && (last[6] - (2.0 * PI - 3.0)).abs() < 1e-9,
        "{last:?}"
    );
    goes_on(&floating, &path, &[3, 4, 5, 6]);

    let world = "[world]\nbounds = [[0, 0], [4, 4]]\n[robot]\npolygon = [[-0.3, -0.1], [0.3, -0.1], [0.3, 0.1], [-0.3, 0.1]]\n\
                 [motion]\nstart = [1, 1, 9.0]\ngoal = [3, 3, -3.0]\n";
    let plane = scene(&[("w.toml", world)]);
    let (_, path) = planned(&plane);
    assert_eq!(path.rows[0][2], 9.0);
    assert!((path.rows.last().unwrap()[2] - (4.0 * PI - 3.0)).abs() < 1e-12, "{:?}", path.rows);
    goes_on(&plane, &path, &[2]);
}

#[test]
fn a_start_beyond_a_limit() {
    let urdf = two_bars([-1.0, 1.57]);
    let at = |robot: &str, start: f64| {
        let toml = problem(robot, &format!("[0, {start}]"), "[0.5, 0]");
        scene(&[("p.toml", &toml), ("r.urdf", &urdf)])
    };
    // A hair beyond: as on the limit.
    for start in [1.57, 1.570_000_1, 1.570_001, -1.000_000_5] {
        let scene = at("", start);
        let (_, path) = planned(&scene);
        assert!((path.rows[0][1] - start).abs() <= 1.001e-6 && (-1.0..=1.57).contains(&path.rows[0][1]));
        goes_on(&scene, &path, &[0]);
        assert!(scene.notes().is_empty());
    }
    // Limits with five decimals, and ends at the angles that they are meant to be.
    let five = |x: f64| (1e5 * x).floor() / 1e5;
    let (quarter, half) = (PI / 2.0, PI);
    let toml = problem("", &format!("[0, {quarter}]"), &format!("[0.5, {}]", -half));
    let rounded = two_bars([-five(half), five(quarter)]);
    let (_, path) = planned(&scene(&[("p.toml", &toml), ("r.urdf", &rounded)]));
    assert_eq!([path.rows[0][1], path.rows.last().unwrap()[1]], [five(quarter), -five(half)]);
    // More is refused, and the help says by which settings it is not.
    let error = at("", 1.5709).check_ends().unwrap_err();
    let shown = error.report();
    assert!(shown.contains("1.5709") && shown.contains("b may be from -1 to 1.57"), "{shown}");
    assert!(
        shown.contains("limits = { b = [-1, 1.5709] }") && shown.contains("limit_tolerance = 0.0009"),
        "{shown}"
    );
    // The tolerance is that of a start, a base in the plane has bounds, and of several robots each has its limits.
    let goal = scene(&[("p.toml", &problem("", "[0, 0]", "[0, 1.5709]")), ("r.urdf", &urdf)]);
    let shown = goal.check_ends().unwrap_err().report();
    assert!(shown.contains("limits = { b = [-1, 1.5709] }") && !shown.contains("tolerance"), "{shown}");
    let toml =
        problem("base = \"planar\"\nbounds = [[-1, -1], [1, 1]]", "[2, 0, 0, 0, 0]", "[0, 0, 0, 0, 0]");
    let shown = scene(&[("p.toml", &toml), ("r.urdf", &urdf)]).check_ends().unwrap_err().report();
    assert!(shown.contains("widen the `bounds` in [robot]"), "{shown}");
    let toml = "[[robot]]\nname = \"l1\"\nurdf = \"r.urdf\"\n[[robot]]\nname = \"l2\"\nurdf = \"r.urdf\"\nbase = [9, 0, 0, 0, 0, 0]\n\
                [motion]\nstart = [0, 0, 0, 2]\ngoal = [0, 0, 0, 0]\n";
    let shown = scene(&[("p.toml", toml), ("r.urdf", &urdf)]).check_ends().unwrap_err().report();
    assert!(shown.contains("in the [[robot]] \"l2\": `limits = { b = [-1, 2] }`"), "{shown}");
    for robot in ["limit_tolerance = 0.001", "limits = { b = [-1, 1.6] }"] {
        let scene = at(robot, 1.5709);
        let (_, path) = planned(&scene);
        assert_eq!(path.rows[0][1], 1.5709);
        goes_on(&scene, &path, &[0]);
        assert_eq!(scene.notes().len(), usize::from(robot.starts_with("limit_t")), "{:?}", scene.notes());
    }
    assert!(at("limit_tolerance = 0.0001", 1.5709).check_ends().is_err());
    let toml = problem("limit_tolerance = -1", "[0, 0]", "[0.5, 0]");
    assert!(load(&[("p.toml", &toml), ("r.urdf", &urdf)]).unwrap_err().to_string().contains("limits is -1"));
}

/// Two fingers, of which the second goes half as far as the first, and an arm to move.
#[test]
fn limits_of_a_joint_that_others_mimic() {
    let urdf = r#"<robot name="r"><link name="base"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<link name="left"><collision><origin xyz="1 0 0"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<link name="right"><collision><origin xyz="-1 0 0"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<joint name="f1" type="prismatic"><parent link="base"/><child link="left"/><limit lower="0" upper="0.04"/></joint>
<joint name="f2" type="prismatic"><parent link="base"/><child link="right"/><axis xyz="-1 0 0"/><limit lower="0" upper="0.02"/>
<mimic joint="f1" multiplier="0.5"/></joint></robot>"#;
    let at = |robot: &str| {
        let toml = problem(robot, "[0.0402]", "[0.01]");
        scene(&[("p.toml", &toml), ("r.urdf", urdf)])
    };
    assert!(at("").check_ends().is_err());
    for robot in ["limit_tolerance = 0.001", "limits = { f1 = [0, 0.0402] }"] {
        let (_, path) = planned(&at(robot));
        assert_eq!(path.rows[0], [0.0402], "{robot}");
    }
    // The help works.
    let help = at("").check_ends().unwrap_err().report();
    assert!(help.contains("limits = { f1 = [0, 0.0402] }"), "{help}");
}

/// What a path that is a hair beyond a limit proves, where `check` calls it free.
#[test]
fn a_path_a_hair_beyond_a_limit_has_a_certificate() {
    let toml = problem("", "[0, 1.57]", "[0.5, 0]");
    let scene = scene(&[("p.toml", &toml), ("r.urdf", &two_bars([-1.0, 1.57]))]);
    let (_, mut path) = planned(&scene);
    path.rows[0][1] += 5e-6;
    assert!(scene.check(&path).unwrap().free);
    let certificate = scene.certificate(&path, 0.0, &Interrupt::never()).unwrap();
    assert_eq!(scene.certificate_differences(certificate.to_json()).unwrap(), [""; 0]);
}

/// Limits of 1e9 m mean none, and do not make the tolerance a metre.
#[test]
fn a_joint_that_slides_without_limits() {
    let urdf = r#"<robot name="r"><link name="world"/><link name="base"><collision><geometry><box size="0.4 0.4 0.2"/></geometry></collision></link>
<joint name="x" type="prismatic"><parent link="world"/><child link="base"/><limit lower="-1e9" upper="1e9"/></joint></robot>"#;
    let of = |robot: &str, start: &str| {
        let toml =
            problem(robot, start, "[7]") + "[[obstacle]]\nbox = [1, 1, 1]\npose = [0, 1, 0, 0, 0, 0]\n";
        scene(&[("p.toml", &toml), ("r.urdf", urdf)])
    };
    let small = of("", "[5]");
    assert_eq!(small.limits(), [Some([-9995.0, 10_005.0])]);
    assert!(small.notes().iter().any(|note| note.contains("\"x\" has limits that mean none")));
    planned(&small);
    let given = of("limits = { x = [-2e6, 2e6] }", "[5]");
    assert_eq!(given.limits(), [Some([-2e6, 2e6])]);
}

#[test]
fn equal_limits_hold_a_joint() {
    let urdf = two_bars([-1.0, 1.57]);
    for (limits, left) in
        [("{ a = [0.5, 0.5] }", "b"), ("{ b = [-0.25, -0.25] }", "a"), ("{ a = [9, 9], b = [0, 1] }", "b")]
    {
        let toml = problem(&format!("limits = {limits}"), "[0]", "[1]");
        let scene = scene(&[("p.toml", &toml), ("r.urdf", &urdf)]);
        let names: Vec<_> = scene.columns().into_iter().map(|c| c.name).collect();
        assert_eq!(names, [left]);
        let (_, path) = planned(&scene);
        goes_on(&scene, &path, &[]);
    }
    let all = problem("limits = { a = [0, 0], b = [0, 0] }", "[]", "[]");
    let error = load(&[("p.toml", &all), ("r.urdf", &urdf)]).unwrap_err().to_string();
    assert!(error.contains("no joint of this arm moves"), "{error}");
    let wrong = problem("limits = { a = [0.5, 0.4] }", "[0]", "[0]");
    assert!(load(&[("p.toml", &wrong), ("r.urdf", &urdf)]).is_err());
}

/// The chosen ends see each other: the straight motion between them is free. Also where the first choice is behind something.
#[test]
fn the_ends_of_a_robot_alone_see_each_other() {
    // A post on the base, between zero and half way; a rail without end; joints with limits far beyond a turn.
    let post = "<link name=\"base\"><collision><origin xyz=\"0.3 0.3 0.3\"/><geometry><box size=\"0.1 0.1 0.6\"/></geometry></collision></link>";
    let rail = [
        joint("x", "prismatic", "world", "base", Some([-1e6, 1e6])),
        joint("a", "revolute", "base", "one", Some([-0.5, 3.1])),
        joint("b", "revolute", "one", "two", Some([-1e3, 1e3])),
    ];
    let on_rail = format!(
        "<robot name=\"r\"><link name=\"world\"/>{post}{}{}{}</robot>",
        bar("one", 0.5),
        bar("two", 0.4),
        rail.concat()
    );
    // Arms that fold into each other.
    let (mut links, mut joints) = (bar("l0", 0.3), String::new());
    for i in 0..5 {
        links += &bar(&format!("l{}", i + 1), 0.3);
        joints +=
            &joint(&format!("j{i}"), "revolute", &format!("l{i}"), &format!("l{}", i + 1), Some([-6.2, 6.2]))
                .replace("0 0 0.3", "0.3 0 0.02");
    }
    let folding = format!("<robot name=\"r\">{links}{joints}</robot>");
    for urdf in [two_bars([-1.0, 1.0]), on_rail, folding] {
        let scene = scene(&[("r.urdf", &urdf)]);
        let (report, path) = planned(&scene);
        assert!(report.collision_checks < 10_000, "{report:?}");
        let ends = PathRows { rows: vec![scene.start(), scene.goals()[0].clone()], ..path };
        let verdict = scene.check(&ends).unwrap();
        assert!(verdict.free, "{verdict:?} {:?}", scene.notes());
        let far = ends.rows[0].iter().zip(&ends.rows[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(far > 0.2 && far < 10.0, "{ends:?}");
    }
}

/// A robot whose links always touch says which, how deep, and that an SRDF is the remedy; one beside the file is named.
#[test]
fn links_that_touch_everywhere_are_named() {
    let block = |name: &str, z: f64| {
        format!(
            "<link name=\"{name}\"><collision><origin xyz=\"0 0 {z}\"/><geometry><box size=\"0.2 0.2 0.2\"/></geometry></collision></link>"
        )
    };
    let make = |z: f64| {
        let slide = joint("c", "prismatic", "m", "cover", Some([0.0, 0.05])).replace("0 0 0.3", "0 0 0");
        let turn = joint("a", "revolute", "base", "m", Some([-2.0, 2.0])).replace("0 0 0.3", "0 0 0");
        format!(
            "<robot name=\"r\">{}<link name=\"m\"/>{}{turn}{slide}</robot>",
            block("base", 0.0),
            block("cover", z)
        )
    };
    // 0.05 mm apart, all the time: free, and said.
    let near = make(0.200_05).replace("upper=\"0.05\"", "upper=\"0.00001\"");
    let near = scene(&[("r.urdf", &near)]);
    assert!(near.notes()[0].contains("\"base\" and \"cover\""), "{:?}", near.notes());
    planned(&near);
    // Between two that are too close to each other: it never touches neither.
    let roof = joint("r", "fixed", "base", "roof", None).replace("0 0 0.3", "0 0 0") + &block("roof", 0.37);
    let moving =
        make(0.15).replace("upper=\"0.05\"", "upper=\"0.1\"").replace("</robot>", &(roof + "</robot>"));
    let problem = problem("", "[0, 0]", "[1, 0]");
    let refused = |files: &[(&str, &str)]| match load(files) {
        Err(error) => error.report(),
        Ok(scene) => scene.check_ends().unwrap_err().report(),
    };
    let alone = make(0.1).replace("lower=\"0\"", "lower=\"-0.05\"");
    let kept = "<robot name=\"r\"/>";
    let named = problem.replace("urdf =", "srdf = \"s.srdf\"\nurdf =");
    for (files, srdf) in [
        (
            vec![("p.toml", problem.as_str()), ("r.urdf", moving.as_str())],
            "`mp srdf r.urdf --out r.srdf` makes one",
        ),
        (vec![("p.toml", problem.as_str()), ("r.urdf", moving.as_str()), ("r.srdf", kept)], "in r.srdf"),
        (vec![("p.toml", named.as_str()), ("r.urdf", alone.as_str()), ("s.srdf", kept)], "in s.srdf"),
    ] {
        let error = refused(&files);
        for what in ["base", "cover", "deep", "SRDF", srdf] {
            assert!(
                error.contains(what) || (what == "SRDF" && error.contains("disable_collisions")),
                "{what}: {error}"
            );
        }
    }
    // The note of an SRDF of another robot names it, and is not an error of the URDF.
    let other = "<robot name=\"r\"><disable_collisions link1=\"base\" link2=\"cover\"/><disable_collisions link1=\"foot\" link2=\"cover\"/></robot>";
    let noted = scene(&[("p.toml", &named), ("r.urdf", &alone), ("s.srdf", other)]);
    assert_eq!(noted.notes(), ["s.srdf: the SRDF names links that this robot does not have: \"foot\""]);
    noted.check_ends().unwrap();
}

/// A scene with changes is read again with them, elsewhere too.
#[test]
fn changes_are_among_the_files_of_a_scene() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("r.urdf");
    std::fs::write(&file, two_bars([-1.0, 1.0])).unwrap();
    let changes = ProblemChanges {
        from: Some("0.1, 0.2".to_owned()),
        to: vec!["b = 0.5".to_owned()],
        obstacles: vec!["sphere = 0.1, at = [0, 0, 5]".to_owned()],
        arguments: Vec::new(),
    };
    let scene = Scene::load_changed(&Disk, &file, &changes).unwrap();
    assert_eq!((scene.name(), scene.start(), scene.goals()[0][1]), ("r", vec![0.1, 0.2], 0.5));
    assert_eq!(scene.file(), Some(file.as_path()));
    let again = Scene::load_again(&Disk, scene.files().clone(), None).unwrap();
    let all = |scene: &Scene| (scene.start(), scene.goals(), format!("{:?}", scene.bodies()));
    assert_eq!(all(&again), all(&scene));
    let files = scene.input_files().unwrap();
    let files: Vec<(String, String)> =
        files.into_iter().map(|(name, bytes)| (name, String::from_utf8(bytes).unwrap())).collect();
    let there: Vec<(&str, &str)> = files.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
    assert_eq!(all(&load(&there).unwrap()), all(&scene));
    // Of a body in a format without tables no file says them.
    let body = Scene::find_changed(
        "easy",
        &ProblemChanges { to: Vec::new(), from: None, ..changes },
        &Interrupt::never(),
    );
    let body = body.unwrap();
    assert_eq!(body.bodies().len(), Scene::find("easy").unwrap().bodies().len() + 1);
    assert!(body.input_files().unwrap_err().to_string().contains("changed by options"));
}

/// A state of the SRDF stands for the values of its joints. Those that it does not name are zero at the start, and as at the start in a goal.
#[test]
fn states_of_the_srdf_are_ends() {
    let srdf = "<robot name='r'><group_state name='up' group='g'><joint name='b' value='0.5'/></group_state>\
                <group_state name='side' group='g'><joint name='a' value='1'/></group_state></robot>";
    let files = |start, goal| {
        let text = problem("srdf = \"r.srdf\"", start, goal);
        load(&[("p.toml", &text), ("r.urdf", &two_bars([-1.0, 1.0])), ("r.srdf", srdf)])
    };
    let scene = files("\"up\"", "\"side\"").unwrap();
    assert_eq!((scene.start(), scene.goals()), (vec![0.0, 0.5], vec![vec![1.0, 0.5]]));
    let chosen = files("\"up\"", "[]").unwrap();
    assert_eq!(chosen.start(), [0.0, 0.5]);
    assert!(
        chosen.notes().iter().any(|note| note.starts_with("the goal is half way")),
        "{:?}",
        chosen.notes()
    );
    let chosen = files("[]", "\"side\"").unwrap();
    assert_eq!((chosen.start(), chosen.goals()), (vec![0.0, 0.0], vec![vec![1.0, 0.0]]));
    // A note is about the ends of its own scene, also where the robot is that of the scene before.
    let about_a = |scene: &Scene| scene.notes().iter().any(|note| note.contains("leaves out"));
    let text = Some(problem("srdf = \"r.srdf\"", "[0.1, 0.2]", "[1, 0.5]"));
    let of = mp_plan::SceneFiles { file: "p.toml".into(), text, ..Default::default() };
    let at = |name: &str| match name {
        "r.urdf" => Some(two_bars([-1.0, 1.0])),
        _ => (name == "r.srdf").then(|| srdf.to_owned()),
    };
    let next = Scene::load_again(&InMemory(at), of.into(), Some(&scene)).unwrap();
    assert!(about_a(&scene) && !about_a(&next), "{:?}", next.notes());
    let error = files("\"up\"", "\"down\"").unwrap_err();
    assert_eq!(error.file().and_then(mp_io::Error::line), Some(6), "{error}");
    assert!(error.remedy().is_some_and(|help| help.contains("side, up")), "{error:?}");
}

/// The arms of our own making go from one compartment, bin or room to the next.
#[test]
fn arms_of_our_own_are_planned() {
    for (name, joints) in [("arm-6", 6), ("arm-7", 7), ("mobile-arm", 9)] {
        let scene = Scene::find(name).unwrap();
        let (report, path) = planned(&scene);
        assert!(report.verified && scene.columns().len() == joints, "{name}: {report:?}");
        let straight =
            PathRows { rows: vec![path.rows[0].clone(), path.rows[path.rows.len() - 1].clone()], ..path };
        assert!(!scene.check(&straight).unwrap().free, "{name}: the straight motion is free");
    }
}
