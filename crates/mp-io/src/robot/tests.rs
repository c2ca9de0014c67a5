use super::*;
use crate::toml_problem::tests::is_clear;

const GOOD: &str = "[robot]\nurdf = \"arm.urdf\"\nbase = [0, 0, 0.5, 0, 0, 0]\nlimits = { elbow = [-1, 1.5] }\n\n\
                    [motion]\nstart = [0, 0.5]\ngoals = [[1, 0], [0.0, -1]]\n\n\
                    [[obstacle]]\nname = \"table\"\nbox = [1, 2, 0.1]\n\n\
                    [[obstacle]]\nsphere = 0.25\npose = [1, 0, 0, 0, 0, 0]\n\n\
                    [[obstacle]]\nmesh = \"wall.off\"\n\n[[obstacle]]\ncylinder = [0.1, 1]\n";

fn folder(problem: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("arm.urdf"), "<robot name=\"arm\"/>").unwrap();
    let wall = mp_geom::primitives::cuboid(0.1, 1.0, 1.0).unwrap();
    crate::write_off(dir.path().join("wall.off"), &wall).unwrap();
    let path = dir.path().join("task.toml");
    std::fs::write(&path, problem).unwrap();
    (dir, path)
}

#[test]
fn a_problem_and_its_files() {
    let (_dir, path) = folder(GOOD);
    let problem = RobotProblem::load(&path).unwrap();
    assert_eq!((problem.name.as_str(), problem.urdf.as_str()), ("task", "<robot name=\"arm\"/>"));
    assert_eq!(problem.base().translation.z, 0.5);
    assert_eq!(problem.file.limits, [("elbow".to_owned(), [-1.0, 1.5])]);
    assert_eq!(problem.file.goals, [vec![1.0, 0.0], vec![0.0, -1.0]].map(crate::GoalEntry::All));
    let names: Vec<_> = problem.obstacles.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["table", "obstacle 2", "obstacle 3", "obstacle 4"]);
    let sizes: Vec<_> = problem.obstacles.iter().map(|o| o.mesh.aabb().max).collect();
    assert_eq!(sizes[0], [0.5, 1.0, 0.05].into());
    assert!(sizes[1].x >= 0.25 && sizes[1].x < 0.256 && problem.obstacles[1].pose.translation.x == 1.0);
    assert!(sizes[3].x >= 0.1 && sizes[3].z == 0.5);
    let error = problem.file.fault(RobotPart::Goal(1), "no", "move it");
    assert_eq!((error.line(), error.column(), error.remedy()), (Some(8), Some(18), Some("move it")));
}

#[test]
fn faults_have_their_place() {
    let mut wrong = Vec::new();
    for (from, to, line, words) in [
        ("urdf = \"arm.urdf\"", "", 1, "urdf"),
        ("urdf = ", "udrf = ", 2, "udrf"),
        ("[0, 0.5]", "[0, nan]", 7, "the start has NaN"),
        ("[0, 0.5]", "[0, 1e99]", 7, "the start"),
        ("[0, 0.5]", "\"zero\"", 7, "zero"),
        ("[0, 0.5]", "[0, 0.5", 8, "comma"),
        ("goals = [[1, 0], [0.0, -1]]", "", 7, "no goal"),
        ("[[1, 0], [0.0, -1]]", "[]", 8, "no goals"),
        ("goals = [[1, 0], [0.0, -1]]", "goal = [1, 0]\ngoals = [[1, 0]]", 9, "a goal and a list"),
        ("[-1, 1.5]", "[1.5, -1]", 4, "limits of elbow"),
        ("[1, 2, 0.1]", "[1, 0, 0.1]", 12, "side of the box"),
        ("sphere = 0.25", "sphere = -0.25", 15, "radius"),
        ("sphere = 0.25", "sphere = 0.25\nbox = [1, 1, 1]", 14, "2 shapes"),
        ("sphere = 0.25", "", 14, "0 shapes"),
        ("0.5, 0, 0, 0]", "0.5]", 3, ""),
        ("wall.off", "wal.off", 19, "wal.off"),
        ("arm.urdf", "leg.urdf", 2, "leg.urdf"),
    ] {
        assert!(GOOD.contains(from), "{from}");
        let (_dir, path) = folder(&GOOD.replacen(from, to, 1));
        let error = RobotProblem::load(&path).unwrap_err();
        if !is_clear(&error, line, words) {
            wrong.push(format!("{to}: {error}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_base_floats_within_bounds() {
    let at = |text: &str| {
        let (_dir, path) = folder(&GOOD.replace("base = [0, 0, 0.5, 0, 0, 0]", text));
        RobotProblem::load(path)
    };
    let problem = at("base = \"floating\"\nbounds = [[-1, -2, 0], [1, 2, 3.5]]").unwrap();
    assert_eq!(problem.file.floating, Some([[-1.0, -2.0, 0.0], [1.0, 2.0, 3.5]]));
    assert_eq!(problem.file.fault(RobotPart::Base, "no", "").line(), Some(3));
    assert_eq!(at("").unwrap().file.floating, None);
    for (text, line, words) in [
        ("base = \"floating\"", 3, "without bounds"),
        ("base = \"planar\"", 3, "`planar`"),
        ("base = [0, 0, 1]", 3, "floating"),
        ("bounds = [[0, 0, 0], [1, 1, 1]]", 3, "stands still"),
        ("base = [0, 0, 0, 0, 0, 0]\nbounds = [[0, 0, 0], [1, 1, 1]]", 4, "stands still"),
        ("base = \"floating\"\nbounds = [[0, 0, 0], [1, 0, 1]]", 4, "enclose nothing"),
        ("base = \"floating\"\nbounds = [[0, 0, 0], [1, inf, 1]]", 4, "bounds of the base"),
    ] {
        let error = at(text).unwrap_err();
        assert!(is_clear(&error, line, words), "{text}: {error}");
    }
}

#[test]
fn meshes_are_found() {
    let (dir, path) = folder(GOOD);
    let package = dir.path().join("parts/meshes");
    std::fs::create_dir_all(&package).unwrap();
    std::fs::copy(dir.path().join("wall.off"), package.join("a.off")).unwrap();
    let mut problem = RobotProblem::load(&path).unwrap();
    for name in ["wall.off", "parts/meshes/a.off", "package://parts/meshes/a.off"] {
        assert!(problem.mesh(name).is_ok(), "{name}");
    }
    let error = problem.mesh("package://legs/a.off").unwrap_err();
    assert!(error.contains("packages = ") && error.contains("legs"), "{error}");
    assert!(problem.mesh("b.off").unwrap_err().contains("no such file"));
    problem.packages = Some(dir.path().to_owned());
    assert!(problem.mesh("package://parts/meshes/a.off").is_ok());
    let error = problem.mesh("package://meshes/a.off").unwrap_err();
    assert!(error.contains("meshes/a.off") && error.contains("share/meshes/a.off"), "{error}");
    assert!(error.contains(&dir.path().canonicalize().unwrap().display().to_string()), "{error}");
    problem.packages = Some(dir.path().join("lost"));
    assert!(problem.mesh("package://parts/meshes/a.off").unwrap_err().contains("lost"));
}

#[test]
fn packages_are_found_where_they_are_installed() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    std::fs::create_dir_all(at("prefix/share/robot/urdf")).unwrap();
    std::fs::create_dir_all(at("prefix/share/parts/meshes")).unwrap();
    std::fs::create_dir_all(at("prefix/share/robot/meshes")).unwrap();
    let mesh = mp_geom::primitives::cuboid(0.1, 1.0, 1.0).unwrap();
    for name in ["prefix/share/robot/meshes/arm.off", "prefix/share/parts/meshes/hand.off"] {
        crate::write_off(at(name), &mesh).unwrap();
    }
    std::fs::write(at("prefix/share/robot/urdf/arm.urdf"), "<robot name=\"arm\"/>").unwrap();
    std::fs::create_dir_all(at("tasks")).unwrap();
    let text = "[robot]\nurdf = \"../prefix/share/robot/urdf/arm.urdf\"\n[motion]\nstart = [0]\ngoal = [1]\n";
    std::fs::write(at("tasks/task.toml"), text).unwrap();
    let mut problem = RobotProblem::load(at("tasks/task.toml")).unwrap();
    let found = [
        "../meshes/arm.off",
        "package://robot/meshes/arm.off",
        "package://parts/meshes/hand.off",
        // No package: relative to a folder above.
        "package:///meshes/arm.off",
        "package:///robot/meshes/arm.off",
        "package:///share/parts/meshes/hand.off",
    ];
    for name in found {
        assert!(problem.mesh(name).is_ok(), "{name}: {:?}", problem.mesh(name));
    }
    for folder in ["prefix", "prefix/share"] {
        problem.packages = Some(at(folder));
        assert!(problem.mesh("package://parts/meshes/hand.off").is_ok(), "{folder}");
    }
    problem.packages = Some(at("prefix/share/parts"));
    assert!(problem.mesh("package://parts/meshes/hand.off").is_ok());
    problem.packages = None;
    for name in ["package://parts/meshes/foot.off", "package:///meshes/foot.off"] {
        let error = problem.mesh(name).unwrap_err();
        let places = ["foot.off", "share/", "every folder above", "packages = "];
        assert!(places.iter().all(|word| error.contains(word)), "{error}");
    }
    for name in ["package://", "package://parts", "package://parts/", "package:///"] {
        assert!(problem.mesh(name).unwrap_err().contains("names no file"), "{name}");
    }
    let lost = problem.mesh("file:///lost/arm.off").unwrap_err();
    assert!(lost.contains("/lost/arm.off") && lost.contains("no such file"), "{lost}");
}
