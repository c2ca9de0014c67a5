//! The small parts of the library that others use alone: numbers, requests, tracks, and what is in a file.

use mp_geom::TriMesh;
use mp_geom::primitives::cuboid;
use mp_io::InMemory;
use mp_plan::info::{Info, MeshInfo, Surface};
use mp_plan::{
    End, ErrorKind, Length, MetricName, MotionValidator, PathFileKind, PathRows, RelaxField, Request, Scene,
    Track, at_least, brief, plain, write_file,
};
use nalgebra::{Isometry3, Point3};
use std::path::Path;

#[test]
fn errors_say_what_they_are_about() {
    let scene = Scene::find("easy").unwrap();
    let kind = |request: Request| scene.plan(&request).unwrap_err().kind();
    assert_eq!(kind(Request::new("rrt-conect")), ErrorKind::Planner);
    assert_eq!(kind(Request::default().set("step", "far")), ErrorKind::Request);
    assert_eq!(Scene::load("nowhere.env").unwrap_err().kind(), ErrorKind::File);
    let below = scene.with_ends(&[0.0, 0.0, -99.0, 0.0, 0.0, 0.0], &scene.goals()).unwrap();
    assert_eq!(below.check_ends().unwrap_err().kind(), ErrorKind::NotFree(End::Start));
}

#[test]
fn lower_bounds_are_not_more_than_they_are() {
    for (v, text) in [
        (0.0, "0"),
        (0.3, "0.3"),
        (0.18666, "0.186"),
        (0.0809, "0.08"),
        (4.0058e-5, "4.005e-5"),
        (99.9996, "99.999"),
        (123.47, "123.4"),
        (1_234_567.0, "1.234e6"),
    ] {
        assert_eq!(at_least(v), text);
    }
    for i in 1..20_000 {
        let v = f64::from(i) * 7.3e-6;
        let shown: f64 = at_least(v).parse().unwrap();
        assert!(shown <= v && v - shown <= 1e-3_f64.max(1e-3 * v), "{v}: {shown}");
    }
}

#[test]
fn numbers_are_brief() {
    for (v, text) in [
        (0.0, "0"),
        (1.0, "1"),
        (-0.00001, "-1.000e-5"),
        (12.3456, "12.346"),
        (1234.56, "1234.6"),
        (2e7, "2.000e7"),
    ] {
        assert_eq!(brief(v), text);
    }
    // What is pasted back is the same place.
    for (v, text) in [
        (-1e-12, "0"),
        (-5.123_456_7e-7, "-0.00000051234567"),
        (0.1 + 0.2, "0.3"),
        (4_500_012.345, "4500012.345"),
        (-500_002.640_999_97, "-500002.64099997"),
        (4_500_012.329_598_493, "4500012.329598493"),
        (123_456_789.123_456_79, "123456789.12345679"),
        (1e300, "1e300"),
        (-1e16, "-1e16"),
    ] {
        assert_eq!(plain(v), text);
    }
}

/// A wall with a gap at the edge of the map: only who leaves the map passes.
#[test]
fn robots_do_not_leave_maps() {
    let mut image = vec![255_u8; 40 * 40];
    image[19 * 40..19 * 40 + 39].fill(0);
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    std::fs::write(file("map.pgm"), [b"P5 40 40 255\n".as_slice(), &image].concat()).unwrap();
    let bar = "polygon = [[-0.5, -0.02], [0.01, -0.02], [0.01, 0.02], [-0.5, 0.02]]";
    let square = "polygon = [[-0.03, -0.03], [0.03, -0.03], [0.03, 0.03], [-0.03, 0.03]]";
    for (robot, turned, yaw, name) in [
        (bar, ", 0", 0.0, "the edge of the map"),
        (bar, ", 0", 0.1, "the outside of the map"),
        (square, ", 0", -0.1, "the outside of the map"),
        ("disc = 0.03", "", 0.0, "the edge of the map"),
    ] {
        let yaml = format!("image: map.pgm\nresolution: 0.05\norigin: [0, 0, {yaw}]\n");
        std::fs::write(file("map.yaml"), yaml).unwrap();
        for (unknown, passes) in [("obstacle", false), ("free", true)] {
            let motion = format!("start = [1, 0.5{turned}]\ngoal = [1, 1.6{turned}]");
            let world = format!("map = \"map.yaml\"\nunknown = \"{unknown}\"");
            let text = format!("[world]\n{world}\n[robot]\n{robot}\n[motion]\n{motion}\n");
            std::fs::write(file("gap.toml"), text).unwrap();
            let scene = Scene::load(file("gap.toml")).unwrap();
            let report = scene.plan(&Request::new("rrt-connect").iterations(20_000)).unwrap();
            assert_eq!(report.path.is_some(), passes, "{robot}, {yaw}, {unknown}");
            // Half of it is outside.
            let edge = [1.0, yaw + 0.001, 0.0];
            let found = scene.explain(&edge[..if turned.is_empty() { 2 } else { 3 }]).unwrap();
            let names: Vec<String> = found.touching.into_iter().map(|touch| touch.other).collect();
            assert!(passes || names.iter().any(|other| other == name), "{names:?}");
        }
    }
}

#[test]
fn the_folder_of_a_file_is_made() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a/b.txt");
    write_file(&path, b"one").unwrap();
    write_file(&path, b"two").unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"two");
    assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
}

/// The robot is where the way says, whatever the spacing of the configurations.
#[test]
fn tracks_are_followed_at_even_speed() {
    let places = [0.0, 1.0, 1.0, 1.5, 8.0];
    let track = Track {
        poses: places.iter().map(|x| vec![Isometry3::translation(*x, 0.0, 0.0)]).collect(),
        trace: places.iter().map(|x| Point3::new(*x, 1.0, 0.0)).collect(),
        travel: places.to_vec(),
        ..Track::default()
    };
    for (fraction, x) in
        [(0.0, 0.0), (0.0625, 0.5), (0.125, 1.0), (0.5, 4.0), (1.0, 8.0), (-1.0, 0.0), (2.0, 8.0)]
    {
        let (poses, point) = track.at(fraction).unwrap();
        assert!(
            (poses[0].translation.x - x).abs() < 1e-12 && (point.x - x).abs() < 1e-12,
            "{fraction}: {point}"
        );
    }
    let still = Track { travel: vec![0.0; 5], ..track };
    assert_eq!(still.at(0.7).unwrap().1.x, 0.0);
    assert!(Track::default().at(0.5).is_none());
}

#[test]
fn txt_files_are_told_apart_by_how_they_begin() {
    let dir = tempfile::tempdir().unwrap();
    let read = |text: &str| {
        let file = dir.path().join("x.txt");
        std::fs::write(&file, text).unwrap();
        Info::read(&file)
    };
    // Poses have a length in metres, joints have none.
    for (text, numbers, length) in
        [("\n  2 \n0 0 0 0 0 0\n1 0 0 0 0 0\n", 6, Some(1.0)), ("2 3\n0 0 0\n1 0 0\n", 3, None)]
    {
        let found = read(text).unwrap();
        let Info::Path(path) = &found else { panic!("{text:?}: {found}") };
        assert_eq!((path.configurations, path.numbers, path.length), (2, numbers, length));
    }
    let triangle = read("1\n0 0 0 1 0 0 0 1 0\n").unwrap();
    assert!(
        matches!(&triangle, Info::Mesh(MeshInfo { surface, .. }) if surface.triangles == 1),
        "{triangle}"
    );
    for (text, said) in
        [("Robot\nr.off\n", "r.off"), ("OFF\n3 1 0\n", "vertex 0 of 3"), ("", "number of triangles")]
    {
        let e = read(text).unwrap_err().report();
        assert!(e.contains(said), "{text:?}: {e}");
    }
    assert!(Info::read(dir.path()).is_err());
}

/// Kinds of robots: their paths are read by the names of columns.
#[test]
fn columns_are_matched_by_name_for_every_kind_of_robot() {
    for name in ["arm", "flyer", "easy", "planar-bugtrap", "parking", "crossing", "accelerations", "docks"] {
        let scene = Scene::find(name).unwrap();
        let columns = scene.columns();
        let rows = vec![scene.start(), scene.goals().remove(0)];
        let path = PathRows { format: scene.path_format(), columns: columns.clone(), rows };
        let verdict = scene.check(&path).unwrap();
        let read = |text: &str| scene.parse_path("p.csv", text.as_bytes(), PathFileKind::Csv);
        assert_eq!(read(&path.to_csv()).unwrap(), path, "{name}");
        // As a data frame writes it: sorted, with an index, and angles in degrees.
        let mut sorted: Vec<usize> = (0..columns.len()).collect();
        sorted.sort_by_key(|i| std::cmp::Reverse(&columns[*i].name));
        let unit = |i: &usize| columns[*i].unit.replace("rad", "deg");
        let header: String = sorted.iter().map(|i| format!(",{} ({})", columns[*i].name, unit(i))).collect();
        let row = |(k, row): (usize, &Vec<f64>)| {
            let value =
                |i: &usize| if columns[*i].unit.contains("rad") { row[*i].to_degrees() } else { row[*i] };
            sorted.iter().fold(format!("\n{k}"), |text, i| text + &format!(",{}", value(i)))
        };
        let rows: String = path.rows.iter().enumerate().map(row).collect();
        let again = read(&(header.clone() + &rows)).unwrap();
        let differences =
            again.rows.iter().flatten().zip(path.rows.iter().flatten()).map(|(a, b)| (a - b).abs());
        assert!(differences.fold(0.0, f64::max) < 1e-12, "{name}: {again:?}");
        assert_eq!(scene.check(&again).unwrap().free, verdict.free, "{name}");
        let first = &columns[0].name;
        for header in [
            header.replace(&format!("{first} "), "stray "),
            header.replace(&format!(",{first} ("), &format!(",{} (", columns[1].name)),
            header.replace(&format!("{first} ({})", unit(&0)), &format!("{first} (kg)")),
        ] {
            let error = read(&(header + &rows)).unwrap_err().report();
            assert!(error.contains("p.csv:1:") && error.contains("mp info"), "{name}: {error}");
        }
        // Rows in another order than the robot's are not checked as if they were in its order.
        let mut turned = path.clone();
        turned.columns.reverse();
        assert!(scene.check(&turned).is_err(), "{name}");
        let names: Vec<_> = turned.columns.iter().map(ToString::to_string).collect();
        let rows: Vec<Vec<f64>> = path.rows.iter().map(|row| row.iter().rev().copied().collect()).collect();
        assert_eq!(scene.named_rows("the table", &names, &rows).unwrap(), path.rows, "{name}");
    }
}

#[test]
fn what_bounds_nothing_is_not_watertight() {
    let dir = tempfile::tempdir().unwrap();
    let surface = |text: &str| {
        let file = dir.path().join("m.obj");
        std::fs::write(&file, text).unwrap();
        MeshInfo::read(&file).unwrap().surface
    };
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 0 0\nv 0 0 1\n";
    for (faces, said) in [
        ("f 1 1 2\n", "nothing is left"),
        ("f 1 1 1\nf 2 2 3\n", "nothing is left"),
        ("f 1 2 5\nf 1 5 2\n", "nothing is left"),
        // Both sides of a sheet, and a tetrahedron pressed flat.
        ("f 1 2 3\nf 1 3 2\n", "boundary edges"),
        ("f 1 2 3\nf 1 3 2\nf 2 4 3\nf 2 3 4\n", "boundary edges"),
        ("f 1 2 3\nf 2 4 3\nf 1 4 2\nf 1 3 4\n", "bounds no volume"),
    ] {
        let surface = surface(&format!("{corners}{faces}"));
        assert!(!surface.watertight && surface.warnings.join("; ").contains(said), "{faces}: {surface:?}");
    }
    // A tetrahedron does, also with each triangle on both sides.
    let solid = "f 1 3 2\nf 1 2 6\nf 2 3 6\nf 3 1 6\n";
    assert!(surface(&format!("{corners}{solid}")).watertight);
    let both = surface(&format!("{corners}{solid}f 1 2 3\nf 1 6 2\nf 2 6 3\nf 3 6 1\n"));
    assert!(both.watertight && both.two_sided && both.warnings.is_empty(), "{both:?}");
}

/// Of angles that are degrees, most likely, all who plan hear.
#[test]
fn angles_in_degrees_are_in_the_notes_of_a_scene() {
    let notes = |angle: &str| {
        let text = format!(
            "[robot]\nbox = [1, 1, 1]\n[motion]\nstart = [0, 0, 0, 0, 0, 0]\ngoal = [5, 0, 0, {angle}, 0, 0]\n"
        );
        let scene = Scene::load_from(&InMemory(move |_: &str| Some(text.clone())), Path::new("p.toml"));
        scene.unwrap().notes().to_vec()
    };
    assert!(notes("1.57").is_empty());
    assert!(notes("90")[0].starts_with("p.toml: the goal is turned by 90 radians"), "{:?}", notes("90"));
}

#[test]
fn what_readers_passed_over_is_in_the_notes() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(dir.path().join(name), bytes).unwrap();
    let mut binary = vec![b' '; 80];
    binary.extend(1_u32.to_le_bytes());
    binary.extend([0; 12]);
    [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().for_each(|v| binary.extend(v.to_le_bytes()));
    binary.extend([0; 2]);
    binary.extend(b"\r\n");
    write("tail.stl", &binary);
    write("edge.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 2 3\n");
    for (name, said) in
        [("tail.stl", "2 bytes after the last triangle"), ("edge.obj", "fewer than three corners")]
    {
        let shown = Info::read(&dir.path().join(name)).unwrap().to_string();
        assert!(shown.contains("note ") && shown.contains(said) && shown.contains(name), "{shown}");
    }
    // A scene says it of the files that it names, each once.
    write(
        "body.toml",
        b"[robot]\nmesh = \"tail.stl\"\n[motion]\nstart = [0, 0, 0, 0, 0, 0]\ngoal = [1, 0, 0, 0, 0, 0]\n\
          [[obstacle]]\nmesh = \"tail.stl\"\npose = [9, 0, 0, 0, 0, 0]\n[[obstacle]]\nmesh = \"edge.obj\"\npose = [9, 9, 0, 0, 0, 0]\n",
    );
    let shown = Info::read(&dir.path().join("body.toml")).unwrap().to_string();
    assert_eq!(
        shown.matches("2 bytes after the last triangle of binary STL are passed over: tail.stl\n").count(),
        1,
        "{shown}"
    );
    assert!(shown.contains("fewer than three corners are left out: edge.obj"), "{shown}");
}

#[test]
fn robots_of_other_formats_are_told_what_they_are() {
    let dir = tempfile::tempdir().unwrap();
    for (name, text, said, remedy) in [
        (
            "r.sdf",
            "<?xml version=\"1.0\"?>\n<sdf version=\"1.6\"><model name=\"m\"/></sdf>",
            "SDF, the format of Gazebo",
            "URDF of the robot",
        ),
        (
            "r.world",
            "<sdf version=\"1.6\"><world name=\"w\"/></sdf>",
            "SDF, the format of Gazebo",
            "URDF of the robot",
        ),
        ("r.urdf", "<mujoco model=\"m\"/>", "there is no <worldbody>", "the file of the whole model"),
        ("sdf.urdf", "<sdf version=\"1.9\"/>", "SDF, the format of Gazebo", "URDF of the robot"),
        ("a.launch.xml", "<launch/>", "a launch file", "names"),
    ] {
        let file = dir.path().join(name);
        std::fs::write(&file, text).unwrap();
        let e = Info::read(&file).unwrap_err().report();
        assert!(e.contains(said) && e.contains(remedy) && !e.contains("xacro"), "{name}: {e}");
    }
    // What is URDF is read, whatever its name.
    let file = dir.path().join("robot.xml");
    std::fs::write(&file, "<robot name=\"r\"/>").unwrap();
    assert!(Info::read(&file).unwrap_err().report().contains("at least one link"), "it has nothing");
}

#[test]
fn lengths_and_motions() {
    assert_eq!("20%".parse::<Length>().unwrap(), Length::Fraction(0.2));
    assert_eq!("0.5".parse::<Length>().unwrap(), Length::Absolute(0.5));
    let one = MotionValidator::Discrete(Length::Fraction(0.01));
    assert_eq!("discrete:1%".parse::<MotionValidator>().unwrap(), one);
    assert_eq!(one.to_string(), "discrete:1%");
    for bad in ["", "0", "-1", "nan", "inf", "101%", "0%", "1e-322%", "%", "x"] {
        assert!(bad.parse::<Length>().is_err(), "{bad}");
        assert!(format!("discrete:{bad}").parse::<MotionValidator>().is_err(), "{bad}");
    }
}

#[test]
fn fields_are_read_back() {
    for text in ["clearance", "paper", "risk", "risk:2", "image:a b.png"] {
        assert_eq!(text.parse::<RelaxField>().unwrap().to_string(), text);
    }
    for bad in ["", "risks", "risk:", "risk:0", "risk:x", "image:", "image", "paper:2", "clearance:1"] {
        assert!(bad.parse::<RelaxField>().is_err(), "{bad}");
    }
}

#[test]
fn requests_are_read_back_and_checked() {
    let request = Request::new("prm")
        .metric(MetricName::MaxDisplacement)
        .motion("discrete:2%".parse().unwrap())
        .relax(RelaxField::Risk(2.0));
    let text = serde_json::to_string(&request).unwrap();
    assert_eq!(serde_json::from_str::<Request>(&text).unwrap(), request);
    assert_eq!(serde_json::from_str::<Request>("{}").unwrap(), Request::default());
    assert!(serde_json::from_str::<Request>(r#"{"planer": "prm"}"#).is_err());
    assert!(request.check().is_ok());
    for bad in [
        Request::new("rrt-conect"),
        Request::default().set("stepp", 1),
        Request::default().time(f64::NAN),
        Request::default().threads(0),
        Request { roadmap: Some("x".into()), ..Request::default() },
    ] {
        assert!(bad.check().is_err(), "{bad:?}");
    }
}

#[test]
fn a_box_is_sound_and_an_open_one_is_not() {
    let whole = cuboid(1.0, 2.0, 3.0).unwrap();
    let shape = Surface::of(&whole);
    assert!(shape.watertight && shape.warnings.is_empty(), "{:?}", shape.warnings);
    assert!((shape.area - 22.0).abs() < 1e-12);
    let open = TriMesh::new(whole.vertices().to_vec(), whole.triangles()[2..].to_vec()).unwrap();
    let shape = Surface::of(&open);
    assert!(!shape.watertight && !shape.two_sided);
    assert_eq!(shape.warnings, ["4 boundary edges: the surface has holes, or is a sheet"]);
}

/// As SketchUp writes surfaces: with vertices of their own for each side.
#[test]
fn the_other_sides_of_triangles_are_no_defects() {
    let whole = cuboid(1.0, 2.0, 3.0).unwrap();
    let doubled = |mesh: &TriMesh, turn: bool| {
        let n = mesh.vertices().len() as u32;
        let other =
            mesh.triangles().iter().map(|&[a, b, c]| if turn { [c, b, a] } else { [a, b, c] }.map(|i| i + n));
        let triangles = mesh.triangles().iter().copied().chain(other).collect();
        TriMesh::new([mesh.vertices(), mesh.vertices()].concat(), triangles).unwrap()
    };
    let shape = Surface::of(&doubled(&whole, true));
    assert!(shape.two_sided && shape.warnings.is_empty(), "{:?}", shape.warnings);
    let twice = Surface::of(&doubled(&whole, false));
    assert!(!twice.two_sided && !twice.warnings.is_empty());
    let open = TriMesh::new(whole.vertices().to_vec(), whole.triangles()[2..].to_vec()).unwrap();
    let shape = Surface::of(&doubled(&open, true));
    assert_eq!(shape.warnings, ["4 boundary edges: the surface has holes, or is a sheet"]);
}
