use super::*;
use crate::toml_problem::tests::is_clear;
use mp_formats::files::Files;
use mp_geom::TriMesh;
use nalgebra::Point3;

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
    assert_eq!((problem.name.as_str(), problem.robots[0].urdf.as_str()), ("task", "<robot name=\"arm\"/>"));
    assert_eq!(problem.file.robots[0].pose().translation.z, 0.5);
    assert_eq!(problem.file.robots[0].limits, [("elbow".to_owned(), [-1.0, 1.5])]);
    assert_eq!(problem.file.goals, [vec![1.0, 0.0], vec![0.0, -1.0]].map(crate::GoalEntry::All));
    let names: Vec<_> = problem.obstacles.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["table", "obstacle 2", "obstacle 3", "obstacle 4"]);
    let sizes: Vec<_> = problem.obstacles.iter().map(|o| o.mesh.aabb().max).collect();
    assert_eq!(sizes[0], [0.5, 1.0, 0.05].into());
    assert!(sizes[1].x >= 0.25 && sizes[1].x < 0.256 && problem.obstacles[1].pose.translation.x == 1.0);
    assert!(sizes[3].x >= 0.1 && sizes[3].z == 0.5);
    let error = problem.file.fault(RobotFilePart::Goal(1), "no", "move it");
    assert_eq!((error.line(), error.column(), error.remedy()), (Some(8), Some(18), Some("move it")));
}

/// Equal primitives share the memory of one mesh; others have their own. Spheres are balls.
#[test]
fn equal_primitives_share_a_mesh() {
    let figures = ["sphere = 0.25", "sphere = 0.25", "sphere = 0.5", "box = [1, 2, 3]", "box = [1, 2, 3]"];
    let more = ["box = [3, 2, 1]", "cylinder = [0.25, 1]", "cylinder = [0.25, 1]", "cylinder = [1, 0.25]"];
    let shapes: Vec<&str> = figures.into_iter().chain(more).collect();
    let obstacles: String = shapes.iter().map(|shape| format!("[[obstacle]]\n{shape}\n")).collect();
    let (_dir, path) = folder(&GOOD.replace("[[obstacle]]\nmesh = \"wall.off\"\n\n", &obstacles));
    let problem = RobotProblem::load(&path).unwrap();
    let meshes: Vec<_> = problem.obstacles[2..][..shapes.len()].iter().map(|o| &o.mesh).collect();
    for (i, a) in meshes.iter().enumerate() {
        for (j, b) in meshes.iter().enumerate() {
            let shared = std::ptr::eq(a.vertices().as_ptr(), b.vertices().as_ptr());
            assert_eq!(shared, shapes[i] == shapes[j], "{} and {}", shapes[i], shapes[j]);
        }
    }
    assert_eq!((meshes[2].balls(), meshes[2].vertices()), (&[(0..1, 0.5)][..], &[Point3::origin()][..]));
}

/// All shapes, in every kind of file.
#[test]
fn shapes_are_read() {
    let cloud = "# a cloud\n0 0 0\n0.5, 0, 0, 255\n  1 0 0.25 7 7\n";
    for (shape, size, solids) in [
        ("capsule = [0.25, 1]", [0.5, 0.5, 1.5], 1),
        ("cone = [0.5, 2]", [1.0, 1.0, 2.0], 1),
        ("torus = [1, 0.25]", [2.5, 2.5, 0.5], 1),
        ("tetrahedron = 1", [0.87, 1.0, 0.82], 1),
        ("hull = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3], [0.1, 0.1, 0.1]]", [1.0, 2.0, 3.0], 1),
        ("points = { radius = 0.05, at = [[0, 0, 0], [1, 0, 0.25]] }", [1.1, 0.1, 0.35], 0),
        ("points = { radius = 0.05, file = \"cloud.xyz\" }", [1.1, 0.1, 0.35], 0),
        (
            "height_field = { cell = [0.5, 1], heights = [[0, 1, 0], [0, 1, 2]], bottom = -1 }",
            [1.0, 1.0, 3.0],
            1,
        ),
    ] {
        let (dir, path) = folder(&GOOD.replace("sphere = 0.25", shape));
        std::fs::write(dir.path().join("cloud.xyz"), cloud).unwrap();
        let mesh = &RobotProblem::load(&path).unwrap().obstacles[1].mesh;
        let found = mesh.aabb().max - mesh.aabb().min;
        assert!((0..3).all(|i| (found[i] - size[i]).abs() < 0.08), "{shape}: {found}");
        assert_eq!(mesh.solids().len(), solids, "{shape}");
        // The same as a body that moves, and as an obstacle that does.
        let rigid = format!(
            "[robot]\n{shape}\n[motion]\nstart = [0, 0, 9, 0, 0, 0]\ngoal = [1, 0, 9, 0, 0, 0]\nspeed = 1\n\
             [[moving]]\n{shape}\npath = [[0, 0, 0, 0], [1, 1, 0, 0]]\n"
        );
        std::fs::write(&path, rigid).unwrap();
        let task = crate::RigidTask::load_from(&crate::Disk, &path).unwrap();
        assert_eq!((&task.problem.robot.mesh, &task.moving[0].mesh), (&mesh.faceted(), mesh), "{shape}");
    }
}

#[test]
fn what_is_attached_has_a_name_of_its_own() {
    let then = "[[then]]\nattach = \"table\"\nto = \"tip\"\ngoal = [0, 0]\n";
    let next = |text: &str| {
        let (_dir, path) = folder(&format!("{text}{then}"));
        RobotProblem::load(&path).unwrap().next_part(&[0.0, 0.0], |_| Some(Default::default()))
    };
    assert_eq!(next(GOOD).unwrap().unwrap().attached[0].name, "table");
    let [message, expected] = next(&GOOD.replace("sphere =", "name = \"table\"\nsphere =")).unwrap_err();
    assert!(
        message.contains("several bodies \"table\"") && expected.contains("rename"),
        "{message}; {expected}"
    );
}

#[test]
fn faults_have_their_place() {
    let mut wrong = Vec::new();
    for (from, to, line, words) in [
        ("urdf = \"arm.urdf\"", "", 1, "urdf"),
        ("urdf = ", "udrf = ", 2, "udrf"),
        ("[0, 0.5]", "[0, nan]", 7, "the start has NaN"),
        ("[0, 0.5]", "[0, 1e99]", 7, "the start"),
        ("[0, 0.5]", "0", 7, "a start is"),
        ("[0, 0.5]", "[0, 0.5", 8, "comma"),
        ("goals = [[1, 0], [0.0, -1]]", "", 7, "no goal"),
        ("[[1, 0], [0.0, -1]]", "[]", 8, "no goals"),
        ("goals = [[1, 0], [0.0, -1]]", "goal = [1, 0]\ngoals = [[1, 0]]", 9, "a goal and a list"),
        ("[-1, 1.5]", "[1.5, -1]", 4, "limits of elbow"),
        ("limits = ", "max_velocity = 0\nlimits = ", 4, "limit of velocity is 0"),
        ("limits = ", "max_velocity = inf\nlimits = ", 4, "limit of velocity"),
        (
            "limits = ",
            "max_acceleration = { elbow = -1 }\nlimits = ",
            4,
            "limit of acceleration of elbow is -1",
        ),
        ("limits = ", "max_acceleration = [1]\nlimits = ", 4, "{ joint1 = 1.5 }"),
        ("[1, 2, 0.1]", "[1, 0, 0.1]", 12, "length in y of the box"),
        ("sphere = 0.25", "sphere = -0.25", 15, "radius"),
        ("sphere = 0.25", "sphere = 0.25\nbox = [1, 1, 1]", 16, "2 shapes"),
        ("sphere = 0.25", "", 14, "0 shapes"),
        ("sphere = 0.25", "sphere = [0.25, 1]", 15, "expected f64"),
        ("sphere = 0.25", "capsule = 0.25", 15, "capsule = [radius, length]"),
        ("sphere = 0.25", "capsule = [0.25, \"long\"]", 15, "long"),
        ("sphere = 0.25", "teapot = 0.25", 15, "teapot"),
        ("sphere = 0.25", "sphere = 0.25\nsolid = true", 16, "no mesh"),
        ("sphere = 0.25", "hull = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]", 15, "no inside"),
        ("sphere = 0.25", "hull = [[0, 0], [1, 0]]", 15, ""),
        ("sphere = 0.25", "points = { radius = 0.1 }", 15, "two places, or in none"),
        ("sphere = 0.25", "points = { radius = 0.1, file = \"lost.xyz\" }", 15, "lost.xyz"),
        ("sphere = 0.25", "points = { radius = 0.1, cell = 0, at = [[0, 0, 0]] }", 15, "side of a cell"),
        ("sphere = 0.25", "points = { radius = 0.1, cell = 1e-300, at = [[1, 0, 0]] }", 15, "too small"),
        ("sphere = 0.25", "sphere = 0.25\nself_filter = 0.1", 16, "cannot leave out"),
        (
            "sphere = 0.25",
            "points = { radius = 0.1, at = [[0, 0, 0]] }\nself_filter = -1",
            16,
            "cannot leave out",
        ),
        ("sphere = 0.25", "points = { radius = -0.1, at = [[0, 0, 0]] }", 15, "radius"),
        ("sphere = 0.25", "height_field = { cell = [1, 1], heights = [[0, 1], [0]] }", 15, "equally long"),
        ("sphere = 0.25", "height_field = { cell = [1, 1], heights = [[0, nan]] }", 15, "NaN"),
        ("0.5, 0, 0, 0]", "0.5]", 3, ""),
        ("[-1, 1.5]", "[-1, 1.5, 2]", 4, "length 3"),
        ("[1, 0, 0, 0, 0, 0]", "[1, 0, 0, 0, 0, 0, 1]", 16, "length 7"),
        ("0.25\npose = [1, 0, 0, 0, 0, 0]", "0.25\nat = [1, 0, 0, 0]", 16, "length 4"),
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
fn velocities_accelerations_and_jerk_have_limits() {
    let text = "max_velocity = 1.5\nmax_acceleration = { elbow = 4, wrist = 2 }\nmax_jerk = 50\nlimits = ";
    let (_dir, path) = folder(&GOOD.replace("limits = ", text));
    let robot = RobotProblem::load(&path).unwrap().file.robots.remove(0);
    let [velocity, acceleration, jerk] = robot.max_rates;
    assert_eq!((velocity, jerk), (vec![(None, 1.5)], vec![(None, 50.0)]));
    assert_eq!(acceleration, [(Some("elbow".to_owned()), 4.0), (Some("wrist".to_owned()), 2.0)]);
}

#[test]
fn a_base_floats_within_bounds() {
    let at = |text: &str| {
        let (_dir, path) = folder(&GOOD.replace("base = [0, 0, 0.5, 0, 0, 0]", text));
        RobotProblem::load(path)
    };
    let problem = at("base = \"floating\"\nbounds = [[-1, -2, 0], [1, 2, 3.5]]").unwrap();
    assert_eq!(problem.file.robots[0].floating, Some([[-1.0, -2.0, 0.0], [1.0, 2.0, 3.5]]));
    assert_eq!(problem.file.fault(RobotFilePart::Robot(0, RobotPart::Base), "no", "").line(), Some(3));
    assert_eq!(at("").unwrap().file.robots[0].floating, None);
    for (text, line, words) in [
        ("base = \"floating\"", 3, "without bounds"),
        ("base = \"planar\"", 3, "without bounds"),
        ("base = \"round\"", 3, "`round`"),
        ("base = [0, 0, 1]", 3, "floating"),
        ("bounds = [[0, 0, 0], [1, 1, 1]]", 3, "stands still"),
        ("base = [0, 0, 0, 0, 0, 0]\nbounds = [[0, 0, 0], [1, 1, 1]]", 4, "stands still"),
        ("base = \"floating\"\nbounds = [[0, 0, 0], [1, 0, 1]]", 4, "enclose nothing"),
        ("base = \"floating\"\nbounds = [[0, 0, 0], [1, 1, 1], [2, 2, 2]]", 4, "length 3"),
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
    let mut problem = RobotProblem::load(&path).unwrap().robots.remove(0);
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
    let mut problem = RobotProblem::load(at("tasks/task.toml")).unwrap().robots.remove(0);
    let found = [
        "../meshes/arm.off",
        "package://robot/meshes/arm.off",
        "package://parts/meshes/hand.off",
        "model://parts/meshes/hand.off",
        // No package: relative to a folder above.
        "package:///meshes/arm.off",
        // A package that has another name here.
        "package://robot_support/meshes/arm.off",
        "package:///robot/meshes/arm.off",
        "package:///share/parts/meshes/hand.off",
    ];
    for name in found {
        assert!(problem.mesh(name).is_ok(), "{name}: {:?}", problem.mesh(name));
    }
    // Names of URIs, and names that only look like them.
    std::fs::create_dir_all(at("prefix/share/robot/my mesh")).unwrap();
    for name in ["my mesh/größe.off", "meshes/a%20b.off", "meshes/a b.off"] {
        crate::write_off(at("prefix/share/robot").join(name), &mesh).unwrap();
    }
    let meant = "my%20mesh/gr%C3%B6%C3%9Fe.off";
    let absolute = format!("file://{}/{meant}", at("prefix/share/robot").display());
    for name in [
        &format!("package://robot/{meant}"),
        &format!("package:///{meant}"),
        &format!("../{meant}"),
        &absolute,
        &absolute.replace("file://", "file://localhost"),
    ] {
        assert!(problem.mesh(name).is_ok(), "{name}: {:?}", problem.mesh(name));
    }
    assert!(problem.mesh_file("../meshes/a%20b.off").unwrap().ends_with("a%20b.off"));
    assert!(problem.mesh("../meshes/b%20a.off").unwrap_err().contains("b%20a.off"));
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

/// Files in memory: a post of 0.2 × 0.2 × 1 from z = 0 on, in COLLADA with this `asset`, and problems that name it. It keeps what
/// readers remark.
#[derive(Debug)]
struct Posts {
    dae: String,
    remarks: std::sync::Mutex<Vec<String>>,
}

impl Posts {
    fn new(asset: &str, unit: f64) -> Self {
        let post = mp_geom::primitives::cuboid(0.2 / unit, 0.2 / unit, 1.0 / unit).unwrap();
        let up = |z: f64| z + 0.5 / unit;
        let numbers: String =
            post.vertices().iter().map(|p| format!("{} {} {} ", p.x, p.y, up(p.z))).collect();
        let corners: String = post.triangles().iter().flatten().map(|i| format!("{i} ")).collect();
        let dae = format!(
            "<COLLADA>{asset}<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array \
             id=\"a\">{numbers}</float_array></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\
             <triangles count=\"12\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>{corners}</p></triangles></mesh>\
             </geometry></library_geometries><library_visual_scenes><visual_scene id=\"s\"><node><instance_geometry \
             url=\"#g\"/></node></visual_scene></library_visual_scenes></COLLADA>"
        );
        Self { dae, remarks: std::sync::Mutex::default() }
    }
}

impl Files for Posts {
    fn read(&self, path: &std::path::Path, limit: u64) -> Result<Vec<u8>, Error> {
        let files = crate::InMemory(|name: &str| {
            Some(match name {
                "arm.urdf" => "<robot name=\"arm\"/>",
                "arm.toml" => {
                    "[robot]\nurdf = \"arm.urdf\"\n[motion]\nstart = [0]\ngoal = [1]\n[[obstacle]]\nmesh = \"post.dae\"\n"
                }
                "body.toml" => {
                    "[robot]\nmesh = \"post.dae\"\n[motion]\nstart = [0, 0, 0, 0, 0, 0]\ngoal = [1, 0, 0, 0, 0, 0]\n\
                     [[obstacle]]\nmesh = \"post.dae\"\npose = [5, 0, 0, 0, 0, 0]\n"
                }
                "post.env" => "Robot\npost.dae\n0 0 0 0 0 0\n1 0 0 0 0 0\nEnd\n",
                "post.dae" => self.dae.as_str(),
                _ => return None,
            })
        });
        files.read(path, limit)
    }
    fn note(&self, _: &std::path::Path, remark: &str) {
        self.remarks.lock().unwrap().push(remark.to_owned());
    }
}

#[test]
fn robots_and_problems_in_toml_keep_the_axes_of_collada_and_scenes_turn_them() {
    let asset =
        |up: &str, unit: f64| format!("<asset><unit meter=\"{unit}\"/><up_axis>{up}</up_axis></asset>");
    let upright = [[-0.1, -0.1, 0.0], [0.1, 0.1, 1.0]];
    for (asset, unit, turned, said) in [
        (asset("Z_UP", 1.0), 1.0, [[-0.1, 0.0, -0.1], [0.1, 1.0, 0.1]], "Z_UP"),
        (asset("X_UP", 1.0), 1.0, [[-0.1, -0.1, 0.0], [0.1, 0.1, 1.0]], "X_UP"),
        (asset("Y_UP", 1.0), 1.0, upright, "Y_UP"),
        (String::new(), 1.0, upright, "Y_UP"),
        (asset("Z_UP", 0.001), 0.001, [[-0.1, 0.0, -0.1], [0.1, 1.0, 0.1]], "0.001 m"),
    ] {
        let files = Posts::new(&asset, unit);
        let is = |what: &str, mesh: &TriMesh, corners: [[f64; 3]; 2]| {
            let aabb = mesh.aabb();
            let off = (aabb.min - Point3::from(corners[0]))
                .amax()
                .max((aabb.max - Point3::from(corners[1])).amax());
            assert!(off < 1e-12, "{what} of {asset}: {aabb:?}");
        };
        let arm = RobotProblem::load_from(&files, "arm.toml".as_ref()).unwrap();
        is("a link", &arm.robots[0].mesh_from(&files, "post.dae").unwrap(), upright);
        is("an obstacle beside an arm", &arm.obstacles[0].mesh, upright);
        let body = crate::RigidTask::load_from(&files, "body.toml".as_ref()).unwrap();
        is("a body", &body.problem.robot.mesh, upright);
        is("an obstacle beside a body", &body.problem.obstacles[0].mesh, upright);
        let heard = std::mem::take(&mut *files.remarks.lock().unwrap()).join("; ");
        assert!(
            heard.contains(said) && heard.contains("stay as they are") && !heard.contains("turned"),
            "{heard}"
        );
        // As assimp reads them, for OMPL.app and old scenes.
        let scene = crate::RigidProblem::load_from(&files, "post.env".as_ref()).unwrap();
        is("a scene", &scene.robot.mesh, turned);
        let heard = files.remarks.lock().unwrap().join("; ");
        assert_eq!(heard.contains("turned so that Y is up"), !asset.is_empty() && said != "Y_UP", "{heard}");
    }
}

#[test]
fn descriptions_that_would_take_hours_are_refused_at_once() {
    let attributes: String = (0..200_000).map(|i| format!(" a{i}=\"1\"")).collect();
    let spaces: String = (0..20_000).map(|i| format!("<link xmlns:n{i}=\"{i}\"/>")).collect();
    for (robot, words) in [
        (format!("<robot name=\"a\"{attributes}/>"), "more than 64 attributes"),
        (format!("<robot>\n<link{attributes}/></robot>"), "more than 64 attributes"),
        (format!("<robot><!-- a=\"1\" --><gazebo{attributes}></gazebo></robot>"), "more than 64 attributes"),
        (format!("<robot>{spaces}</robot>"), "more than 64 declarations"),
    ] {
        let files = crate::InMemory(|name: &str| match name {
            "arm.urdf" => Some(robot.as_bytes().to_vec()),
            "arm.toml" => Some(b"[robot]\nurdf = \"arm.urdf\"\n[motion]\nstart = [0]\ngoal = [1]\n".to_vec()),
            _ => None,
        });
        let e = RobotProblem::load_from(&files, "arm.toml".as_ref()).unwrap_err();
        assert!(e.to_string().contains(words) && e.kind() == crate::ErrorKind::TooLarge, "{e}");
    }
    // The SRDF as well.
    let srdf = format!("<robot name=\"a\"{attributes}/>");
    let files = crate::InMemory(|name: &str| match name {
        "arm.urdf" => Some(b"<robot/>".to_vec()),
        "arm.srdf" => Some(srdf.as_bytes().to_vec()),
        _ => Some(
            b"[robot]\nurdf = \"arm.urdf\"\nsrdf = \"arm.srdf\"\n[motion]\nstart = [0]\ngoal = [1]\n"
                .to_vec(),
        ),
    });
    let e = RobotProblem::load_from(&files, "arm.toml".as_ref()).unwrap_err();
    assert!(e.to_string().contains("more than 64 attributes"), "{e}");
}
