use super::*;
use crate::toml_problem::tests::is_clear;

const GOOD: &str = "[world]\nwalls = [[0, 0], [4, 3]]\n\n[robot]\ndisc = 0.07\n\n[motion]\nstart = [0.3, 0.3]\n\
                    goal = [3.5, 2.5]\n\n[[obstacle]]\nname = \"box\"\nrectangle = [[1, 1], [2, 1.5]]\n\n\
                    [[obstacle]]\npolygon = [[2, 2], [3, 2], [3, 2.5]]\nholes = [[[2.8, 2.1], [2.9, 2.1], [2.9, 2.2]]]\n\n\
                    [[obstacle]]\ncircle = [3, 1, 0.25]\n";

fn folder(problem: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    // Two rows of three pixels: the upper left and the lower right are black, one is grey.
    std::fs::write(dir.path().join("map.pgm"), b"P5 3 2 255\n\x00\xff\xff\xff\x90\x00").unwrap();
    let yaml = "image: map.pgm\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
                free_thresh: 0.196\n";
    std::fs::write(dir.path().join("map.yaml"), yaml).unwrap();
    let path = dir.path().join("room.toml");
    std::fs::write(&path, problem).unwrap();
    (dir, path)
}

/// 51 of 255 are a fifth, which is not below a fifth: 1 - 204/255 would be, by a rounding.
#[test]
fn a_pixel_at_the_threshold_is_not_free() {
    let map = |threshold: &str, negate: u8| {
        let yaml = format!(
            "image: m.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: {negate}\nfree_thresh: {threshold}\n"
        );
        RosMap::parse("m.yaml", yaml.as_bytes()).unwrap()
    };
    for (value, threshold, negate) in
        [(204, "0.2", 0), (153, "0.4", 0), (102, "0.6", 0), (51, "0.2", 1), (102, "0.4", 1)]
    {
        let grid =
            mp_formats::grid::GridMap::parse("m.pgm", &[b"P5 1 1 255\n", &[value][..]].concat()).unwrap();
        let obstacle = map(threshold, negate).outline(&grid, false, &mp_stop::Interrupt::never()).unwrap();
        assert!(obstacle.is_some(), "{value} {threshold}");
    }
}

#[test]
fn a_world_of_polygons() {
    let (_dir, path) = folder(GOOD);
    let read = crate::ProblemFile::load_from(&crate::Disk, &path).unwrap();
    assert!(matches!(read, crate::ProblemFile::World(_)));
    let problem = PlanarProblem::load(&path).unwrap();
    assert_eq!((problem.name.as_str(), &problem.file.robot), ("room", &PlanarShape::Disc(0.07)));
    assert_eq!(problem.bounds, [[0.0, 0.0], [4.0, 3.0]]);
    let names: Vec<_> = problem.obstacles.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["box", "obstacle 2", "obstacle 3"]);
    let areas: Vec<f64> = problem.obstacles.iter().map(|o| o.polygon.area()).collect();
    assert!((areas[0] - 0.5).abs() < 1e-12 && (areas[1] - 0.245).abs() < 1e-12);
    // Around the circle.
    assert!(areas[2] > 0.19635 && areas[2] < 0.2);
    let fault = problem.file.fault(PlanarPart::Goal(0), "no", "move it");
    assert_eq!((fault.line(), fault.column(), fault.remedy()), (Some(9), Some(8), Some("move it")));
    let polygon = GOOD.replace("disc = 0.07", "polygon = [[0, 0], [1, 0], [0, 1]]");
    let turned = polygon.replace("[0.3, 0.3]", "[0.3, 0.3, 0]").replace("[3.5, 2.5]", "[3.5, 2.5, 1.5]");
    let file = PlanarFile::parse("f", turned.as_bytes()).unwrap();
    assert!(
        matches!(file.robot, PlanarShape::Polygon(_))
            && file.goals == [[3.5, 2.5, 1.5].map(GoalPart::Exactly)]
    );
}

#[test]
fn worlds_of_pixels() {
    let at = |p: &Polygon, x: f64, y: f64| p.contains(&Point2::new(x, y));
    for (world, unknown) in [
        ("image = \"map.pgm\"\nscale = 0.5\norigin = [-1, 2]", false),
        ("image = \"map.pgm\"\nscale = 0.5\norigin = [-1, 2]\nthreshold = 0.6", true),
        ("map = \"map.yaml\"", true),
        ("map = \"map.yaml\"\nunknown = \"free\"", false),
    ] {
        let (_dir, path) = folder(&GOOD.replace("walls = [[0, 0], [4, 3]]", world));
        let problem = PlanarProblem::load(&path).unwrap();
        assert_eq!(problem.bounds, [[-1.0, 2.0], [0.5, 3.0]]);
        let map = &problem.obstacles[3].polygon;
        assert!(at(map, -0.75, 2.75) && at(map, 0.25, 2.25), "{world}");
        assert!(!at(map, -0.75, 2.25) && !at(map, -0.25, 2.75));
        assert_eq!(at(map, -0.25, 2.25), unknown, "{world}");
    }
}

/// Whether `p` is in an obstacle or outside of the walls.
fn is_taken(problem: &PlanarProblem, p: Point2<f64>) -> bool {
    let polygons = problem.obstacles.iter().map(|o| o.polygon.clone()).collect();
    mp_geom::planar::PlanarWorld::new(polygons, problem.walls).unwrap().contains(&p)
}

/// A pixel that is white and transparent is unknown; one that is grey and opaque is free, black and opaque an obstacle.
#[test]
fn opacity_of_maps_of_ros_counts() {
    let map = RosMap::parse("m.yaml", b"image: m.png\nresolution: 1\norigin: [0, 0, 0]\n").unwrap();
    let with = |alpha: Option<Vec<f32>>| {
        let grid = mp_formats::grid::GridMap {
            size: [3, 1],
            brightness: vec![255.0, 205.0, 0.0],
            with_alpha: alpha,
        };
        [false, true].map(|unknown_is_free| {
            let polygon = map.outline(&grid, unknown_is_free, &mp_stop::Interrupt::never()).unwrap().unwrap();
            [0.5, 1.5, 2.5].map(|x| polygon.contains(&Point2::new(x, 0.5)))
        })
    };
    assert_eq!(with(None), [[false, true, true], [false, false, true]]);
    let alpha = vec![191.25, 217.5, 63.75];
    assert_eq!(with(Some(alpha)), [[true, false, true], [false, false, true]]);
}

#[test]
fn nothing_is_free_outside_of_a_map() {
    use nalgebra::{Isometry2, Vector2};
    let image = "image = \"map.pgm\"\nscale = 0.5\norigin = [-1, 2]";
    let wide = "walls = [[-9, -9], [9, 9]]";
    for (world, yaw, is_known) in [
        ("map = \"map.yaml\"".to_owned(), 0.0, true),
        ("map = \"map.yaml\"\nunknown = \"obstacle\"".to_owned(), 0.4, true),
        (format!("map = \"map.yaml\"\n{wide}"), -2.0, true),
        ("map = \"map.yaml\"\nbounds = [[-9, -9], [9, 9]]".to_owned(), std::f64::consts::FRAC_PI_2, true),
        ("map = \"map.yaml\"\nbounds = [[-9, -9], [9, 9]]".to_owned(), 3.0 * std::f64::consts::PI, true),
        ("map = \"map.yaml\"\nunknown = \"free\"".to_owned(), 0.4, false),
        (format!("map = \"map.yaml\"\n{wide}\nunknown = \"free\""), 0.0, false),
        (image.to_owned(), 0.0, true),
        (format!("{image}\nunknown = \"free\""), 0.0, false),
        (format!("{image}\n{wide}"), 0.0, false),
    ] {
        let (dir, path) = folder("");
        let yaml = std::fs::read_to_string(dir.path().join("map.yaml")).unwrap();
        // All pixels are free.
        std::fs::write(dir.path().join("map.pgm"), b"P5 3 2 255\n\xff\xff\xff\xff\xff\xff").unwrap();
        std::fs::write(dir.path().join("map.yaml"), yaml.replace("2.0, 0.0]", &format!("2.0, {yaw}]")))
            .unwrap();
        let robot = "[robot]\ndisc = 0.07\n[motion]\nstart = [0, 0]\ngoal = [0, 0]\n";
        std::fs::write(&path, format!("[world]\n{world}\n{robot}")).unwrap();
        let problem = PlanarProblem::load(&path).unwrap();
        let place = Isometry2::new(Vector2::new(-1.0, 2.0), yaw);
        for (i, j) in (-4..20).flat_map(|i| (-4..20).map(move |j| (i, j))) {
            // In the frame of the map, which is 1.5 m by 1 m.
            let p = Point2::new(0.13 * f64::from(i) + 0.01, 0.13 * f64::from(j) + 0.01);
            let outside = p.x < 0.0 || p.y < 0.0 || p.x > 1.5 || p.y > 1.0;
            assert_eq!(is_taken(&problem, place * p), outside && is_known, "{world}, {yaw}: {p}");
        }
    }
    let (_dir, path) = folder(&GOOD.replace("walls = ", "map = \"map.yaml\"\nwalls = "));
    // The walls and the map have 0.5 m by 1 m in common.
    assert_eq!(PlanarProblem::load(&path).unwrap().walls, Some([[0.0, 2.0], [0.5, 3.0]]));
}

#[test]
fn faults_have_their_place() {
    let image = GOOD.replace("walls = [[0, 0], [4, 3]]", "image = \"map.pgm\"\nscale = 0.5");
    let mut wrong = Vec::new();
    for (good, from, to, line, words) in [
        (GOOD, "walls = [[0, 0], [4, 3]]", "", 1, "no bounds"),
        (GOOD, "[[0, 0], [4, 3]]", "[[0, 0], [4, 0]]", 2, "the walls"),
        (GOOD, "walls", "wall", 2, "wall"),
        (GOOD, "walls = [", "scale = 1\nwalls = [", 2, "`scale` belongs to an image"),
        (GOOD, "disc = 0.07", "", 4, "disc and a polygon"),
        (GOOD, "disc = 0.07", "disc = 0", 5, "the radius is 0"),
        (GOOD, "disc = 0.07", "polygon = [[0, 0], [1, 1]]", 5, "2 points"),
        (GOOD, "[0.3, 0.3]", "[0.3, 0.3, 0]", 8, "the start has 3"),
        (GOOD, "[0.3, 0.3]", "[0.3, nan]", 8, "the start has NaN"),
        (GOOD, "goal = [3.5, 2.5]", "", 8, "no goal"),
        (GOOD, "[3.5, 2.5]", "[3.5]", 9, "the goal has 1"),
        (GOOD, "[2, 1.5]", "[1, 1.5]", 13, "the rectangle"),
        (GOOD, "[2, 1.5]", "[2, 1.5], [3, 3]", 13, "length 3"),
        (GOOD, "[[0, 0], [4, 3]]", "[[0, 0, 0], [4, 3, 0]]", 2, "length 3"),
        (GOOD, "0.25]", "0.25, 1]", 20, "length 4"),
        (GOOD, "[3, 2.5]]", "[3, 2.5, 0]]", 16, "length 3"),
        (&image, "scale", "origin = [0, 0, 0]\nscale", 3, "length 3"),
        (GOOD, "rectangle = [[1, 1], [2, 1.5]]", "", 11, "exactly one shape"),
        (GOOD, "0.25]", "-0.25]", 20, "radius"),
        (GOOD, "circle = ", "holes = [[[0, 0], [1, 0], [0, 1]]]\ncircle = ", 20, "holes"),
        (GOOD, ", [3, 2.5]]", "]", 16, "2 points"),
        (&image, "scale = 0.5", "", 2, "no scale"),
        (&image, "scale = 0.5", "scale = -1", 3, "the scale is -1"),
        (&image, "scale = 0.5", "scale = 0.5\nthreshold = 2", 4, "the threshold is 2"),
        (&image, "scale = 0.5", "scale = 0.5\nmap = \"map.yaml\"", 4, "an image and a map"),
        (&image, "scale = 0.5", "scale = 9e8", 2, "beyond"),
        (&image, "map.pgm", "nap.pgm", 2, "no such file"),
        (&image, "map.pgm", "map.yaml", 2, "neither a PNG nor a PGM image"),
        (
            GOOD,
            "walls = [[0, 0], [4, 3]]",
            "map = \"map.yaml\"\nwalls = [[1, 0], [4, 3]]",
            1,
            "nothing in common",
        ),
        (GOOD, "walls = ", "unknown = \"no\"\nwalls = ", 2, "neither"),
    ] {
        assert!(good.contains(from), "{from}");
        let (_dir, path) = folder(&good.replacen(from, to, 1));
        let error = PlanarProblem::load(&path).unwrap_err();
        if !is_clear(&error, line, words) {
            wrong.push(format!("{to}: {error}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn maps_of_ros() {
    let text = "# a map\nimage: \"a b.png\"  # here\nresolution: 0.05\norigin:\n- -1.5\n- 2\n- 0.1\nnegate: 1\nmode: trinary\nx: y\n";
    let map = RosMap::parse("m.yaml", text.as_bytes()).unwrap();
    assert_eq!((map.image.as_str(), map.origin, map.negate), ("a b.png", [-1.5, 2.0, 0.1], true));
    for (from, to, line, words) in [
        ("resolution: 0.05", "", 10, "no `resolution`"),
        ("0.05", "-1", 3, "resolution is -1"),
        ("0.05", "five", 3, "not metres"),
        ("- 0.1\n", "", 5, "2 numbers"),
        ("negate: 1", "negate: 2", 8, "neither"),
        ("trinary", "scale", 9, "mode"),
        ("x: y", "x", 10, "not YAML"),
        ("negate: 1", "negate: [0, 1]", 8, "no single value"),
        ("x: y", "negate: 0", 10, "`negate` is there twice"),
        ("- 2", "- [2, 3]", 5, "0 numbers"),
        ("- 2", "- two", 6, "`two` is not a number of the origin"),
        ("0.05", ".nan", 3, "not metres"),
        ("image: \"a b.png\"", "image: ~", 10, "no `image`"),
        ("image: \"a b.png\"", "image: \"a", 2, "not YAML"),
        ("x: y", "occupied_thresh: 1.5", 10, "not a probability"),
        ("x: y", "free_thresh: 0.9", 1, "above"),
        ("image: \"a b.png\"", "", 10, "no `image`"),
    ] {
        let error = RosMap::parse("m.yaml", text.replacen(from, to, 1).as_bytes()).unwrap_err();
        assert!(error.to_string().contains(words) && error.remedy().is_some(), "{error}");
        assert!(error.line().is_some_and(|l| l.abs_diff(line) <= 1), "{error}");
    }
    let unknown = RosMap::parse("m.yaml", text.replacen("- 0.1", "- -nan", 1).as_bytes()).unwrap_err();
    assert!(unknown.remedy().is_some_and(|help| help.contains("write 0")), "{unknown}");
    assert!(RosMap::parse("m.yaml", b"- image: a.png\n").unwrap_err().to_string().contains("m.yaml:1:1"));
}

#[test]
fn maps_of_ros_in_other_spellings_of_yaml() {
    let read = |text: &str| {
        RosMap::parse("m.yaml", text.as_bytes()).unwrap_or_else(|e| panic!("{text}: {}", e.report()))
    };
    let plain = read("image: m.pgm\nresolution: 0.05\norigin: [0, -1, 0.5]\n");
    let latin = b"image: m.pgm # Gr\xf6\xdfe\nresolution: 0.05\norigin: [0, -1, 0.5]\n";
    assert_eq!(RosMap::parse("m.yaml", latin).unwrap(), plain);
    for text in [
        "image: m.pgm\nresolution: .05\norigin: [0,\n  -1, 0.5]\n",
        "image: 'm.pgm'\nresolution: 5e-2\norigin: [\n    0.0, # x\n    -1.,\n    5.0E-1,\n]\nnegate: False\n",
        "%YAML 1.2\n---\n\"image\": \"m.pgm\"\n'resolution': \"0.05\"\norigin:\n    - 0\n    - -1\n    - +.5\nnegate: no\n...\n",
        "{image: m.pgm, resolution: 0.05, origin: [0, -1, 0.5], negate: 0}",
        "{\"image\": \"m.pgm\",\r\n \"resolution\": 0.05,\r\n \"origin\": [0, -1, 0.5]}\r\n",
        "r: &r 0.05\nimage: &i m.pgm\nresolution: *r\norigin: [&z 0, -1, &h 0.5]\nnegate: 00\nname: *i\n",
        "z: &z 0\nother: {deep: [[&r .05]]}\nimage: m.pgm\nresolution: *r\norigin: [*z, -1, 0.5]\nnegate: *z\n",
        "image: m.pgm\nresolution: 0.05\norigin: [0, -1, 0.5]\nnegate: 0.00\n\0",
        "image: >-\n  m.pgm\nresolution:   # metres\n  0.05\norigin: &o [0, -1, 0.5]\nmode: Trinary\nother: {a: [1, 2], b: *o}\nnegate: OFF",
        "# c\n\nimage: m.pgm # c\nresolution: 0.05\n\norigin: 0, -1, 0.5\nmore:\n  - [1, 2]\n  - {a: b}\n",
        "\u{feff}image: m.pgm\nresolution: 0.05\norigin: [0, -1, 0.5]\nnote: \"a: b # c\"\n---\nimage: other.pgm\n",
    ] {
        assert_eq!(read(text), plain, "{text}");
    }
    for negated in ["1", "True", "true", "YES", "on"] {
        assert!(
            read(&format!("image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: {negated}")).negate
        );
    }
}
