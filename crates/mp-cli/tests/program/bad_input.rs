//! Bad input: exit code 2, an error that says what to do, and no file written.

use crate::common::{Dir, mp};

/// Command lines that make no sense, and words of the error.
const COMMANDS: &[(&[&str], &[&str])] = &[
    (&[], &["Usage"]),
    (&["plann"], &["plan"]),
    (&["plan", "window.env", "--planner", "rrt-conect"], &["rrt-conect", "'rrt-connect'"]),
    (&["plan", "window.env", "--planner", "dijkstra"], &["dijkstra", "rrt", "rrt-connect"]),
    (&["plan", "window.env", "--metric", "euclidian"], &["'euclidean'"]),
    (&["plan", "window.env", "--objective", "clear"], &["`clear`", "there are: length, clearance"]),
    (&["plan", "window.env", "--hybridize", "2", "--no-shorten"], &["--hybridize", "--no-shorten"]),
    (&["plan", "window.env", "--motion", "discreet"], &["certified", "discrete:R"]),
    (&["plan", "window.env", "--motion", "discrete"], &["resolution", "discrete:1%"]),
    (&["plan", "window.env", "--motion", "discrete:0"], &["above zero"]),
    (&["plan", "window.env", "--motion", "discrete:1e-30"], &["resolution"]),
    (&["plan", "window.env", "--time", "0"], &["--time", "above zero"]),
    (&["plan", "window.env", "--time=-1"], &["--time", "above zero"]),
    (&["plan", "window.env", "--time", "nan"], &["--time", "finite"]),
    (&["plan", "window.env", "--time", "inf"], &["--time", "finite"]),
    (&["plan", "window.env", "--time", "soon"], &["--time", "not a number"]),
    (&["plan", "window.env", "--iterations", "0"], &["--iterations"]),
    (&["plan", "window.env", "--iterations=-5"], &["--iterations"]),
    (&["plan", "window.env", "--step", "0"], &["--step", "above zero"]),
    (&["plan", "window.env", "--step", "200%"], &["--step", "100%"]),
    (&["plan", "window.env", "--step", "1e9"], &["step", "extent"]),
    (&["plan", "window.env", "--runs", "0"], &["--runs"]),
    (&["plan", "window.env", "--threads", "0"], &["--threads"]),
    (&["plan", "window.env", "--seed=-1"], &["--seed"]),
    (&["plan", "window.env", "--seed", "18446744073709551615", "--runs", "2"], &["seeds", "too large"]),
    (&["plan", "window.env", "--set", "goal-bias"], &["goal-bias", "KEY=VALUE"]),
    (&["plan", "window.env", "--set", "goal_bias=0.5"], &["goal_bias", "goal-bias"]),
    (&["plan", "window.env", "--set", "goal-bias=2"], &["goal-bias", "2", "[0, 1]"]),
    (&["plan", "window.env", "--set", "patience=-1"], &["patience"]),
    (&["plan", "window.env", "--picture", "p.svg"], &["p.svg", ".png"]),
    (&["plan", "window.env", "--picture", "p.jpg"], &["p.jpg", ".png"]),
    (&["plan", "window.env", "--picture", "p"], &[".png"]),
    (&["plan", "window.env", "--out", "robot.off/p.txt"], &["robot.off", "not a folder"]),
    (&["plan", "window.env", "--out", "."], &["folder"]),
    (&["plan", "window.env", "--runs", "2", "--out", "p.txt"], &["--out", "{seed}"]),
    (&["plan", "window.env", "plane.env", "--out", "p.txt"], &["--out", "{scene}"]),
    (&["plan", "window.env", "./window.env", "--out", "{scene}.txt"], &["twice"]),
    (&["plan", "windo"], &["no scene windo", "window"]),
    (&["plan", "robot.off"], &["robot.off"]),
    (&["plan", "."], &["folder"]),
    (&["check", "window.env"], &["PATH"]),
    (&["check", "window.env", "missing.txt"], &["missing.txt", "no such file"]),
    (&["check", "window.env", "robot.off"], &["robot.off"]),
    (&["check", "window.env", "--at", "1 2 3"], &["6 finite numbers", "alpha [rad]"]),
    (&["plan", "window.env", "--out", "window.env"], &["overwrite", "window.env"]),
    (&["plan", "window.env", "--out", "p.doc"], &["p.doc", ".csv"]),
    (&["plan", "window.env", "--out", "p"], &["no ending", ".csv"]),
    (&["plan", "window.env", "--picture", "side.off"], &["side.off"]),
    (&["plan", "window.env", "--out", "p.txt", "--planner", "prm", "--roadmap", "./p.txt"], &["same file"]),
    (&["plan", "window.env", "--planner", "prm", "--roadmap", "robot.off"], &["overwrite", "robot.off"]),
    (&["plan", "arm.urdf"], &["arm.urdf", "no links"]),
    (&["plan", "arm.xacro"], &["arm.xacro", "xacro FILE"]),
    (&["info", "arm.srdf"], &["arm.srdf", "robot problem"]),
    (&["info", "map.yaml"], &["map.yaml", "resolution"]),
    (&["info", "photo.png"], &["photo.png", "photo.yaml", "resolution: 0.05"]),
    (&["plan", "torn.yaml"], &["error: torn.pgm", "neither a PNG"]),
    (&["plan", "full.yaml"], &["full.yaml", "no free region"]),
    (&["info", "missing.off"], &["missing.off"]),
    (&["info", "."], &["not a file"]),
    (&["render", "window.env", "--picture", "p.bmp"], &["p.bmp", ".png"]),
    (&["render", "window.env", "--picture", "p.png", "--size", "10x10"], &["64"]),
    (&["render", "window.env", "--picture", "p.png", "--size", "big"], &["WIDTHxHEIGHT"]),
    (&["render", "window.env", "--out", "p.png", "--mode", "solids"], &["solid", "wire", "transparent"]),
    (
        &["render", "window.env", "--out", "p.png", "--camera", "fronte"],
        &["`fronte`", "front, back", "eye=x,y,z"],
    ),
    (&["render", "window.env", "--out", "p.png", "--camera", "eye=1,2,3"], &["a target too"]),
    (&["render", "window.env", "--out", "p.png", "--camera", "eye=1,2,3 target=1,2,3"], &["that differ"]),
    (&["render", "window.env", "--out", "p.png", "--at", "0.5"], &["no path", "name a path"]),
    (&["render", "window.env", "--out", "p.png", "--at", "1.5"], &["from 0 to 1"]),
    (&["render", "window.env", "--out", "p.png", "--turntable"], &["--turntable", ".png", ".gif"]),
    (&["render", "window.env", "--out", "p.png", "--fps", "10"], &["--fps", "films (.gif or .mp4)"]),
    (
        &["render", "window.env", "--out", "p.html", "--mode", "wire"],
        &["--mode", ".html", "pictures and films (.png, .svg"],
    ),
    (&["render", "window.env", "--out", "p.glb", "--camera", "top"], &["--camera", ".glb"]),
    (&["render", "window.env", "--out", "p.gif"], &["nothing moves", "--turntable"]),
    (&["render", "window.env", "--out", "p.gif", "--follow"], &["no path", "follow"]),
    (
        &["render", "window.env", "--out", "p.gif", "--turntable", "--fps", "60"],
        &["60 frames per second", "50"],
    ),
    (&["render", "window.env", "--out", "p.gif", "--turntable", "--seconds", "1e9"], &["100000 frames"]),
    (&["render", "window.env", "--out", "p.gif", "--turntable", "--seconds", "0"], &["above zero"]),
    (&["render", "window.env", "--out", "p.mp4", "--turntable", "--size", "101x100"], &["101x100", "even"]),
    (&["render", "rrs-low", "--out", "p.png", "--camera", "left"], &["rrs-low", "plane", "camera"]),
    (&["render", "rrs-low", "--out", "p.gif", "--turntable"], &["rrs-low", "plane"]),
];

#[test]
fn commands() {
    let dir = Dir::new();
    dir.write("arm.urdf", "<robot name=\"a\"/>");
    dir.write("arm.xacro", "<robot name=\"a\"/>");
    dir.write("arm.srdf", "<robot name=\"a\"/>");
    dir.write("map.yaml", "image: map.pgm\n");
    dir.write("photo.png", "");
    dir.write("torn.yaml", "image: torn.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n");
    dir.write("torn.pgm", "not an image");
    dir.write("full.yaml", "image: full.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n");
    dir.write("full.pgm", "P2\n3 2\n255\n0 0 0\n0 0 0\n");
    let before = dir.entries(".");
    for (args, words) in COMMANDS {
        let run = mp(&dir, args);
        assert_eq!(run.code, 2, "{args:?}: {run:?}");
        assert!(run.stdout.is_empty(), "{args:?}: {run:?}");
        // Messages are wrapped to the width of the screen.
        let told = run.stderr.split_whitespace().filter(|w| *w != "│").collect::<Vec<_>>().join(" ");
        for word in *words {
            assert!(told.contains(word), "{args:?} does not say {word:?}: {told}");
        }
        assert!(!told.contains("panicked"), "{args:?}: {told}");
    }
    assert_eq!(dir.entries("."), before, "nothing is written");
}

const OFF: &str = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/// Scene files that make no sense, and words of the error.
fn scenes() -> Vec<(&'static str, Vec<u8>, &'static [&'static str])> {
    let good = "Robot\nrobot.off\n-2 0 1 0 0 0\n2 0 1 0 0 0\nObstacle #1\nside.off\n0 0 1 0 0 0\nEnd\n";
    let with = |from: &str, to: &str| good.replacen(from, to, 1).into_bytes();
    vec![
        ("empty.env", Vec::new(), &["empty.env"]),
        ("binary.env", vec![0xff, 0xfe, 0x00, 0x80], &["binary.env"]),
        ("latin.env", b"Robot\nrobot\xe9.off\n".to_vec(), &["2", "UTF-8"]),
        ("truncated.env", good.as_bytes()[..30].to_vec(), &["truncated.env"]),
        ("no-end.env", with("End\n", ""), &["no-end.env", "End"]),
        ("word.env", with("-2 0 1", "-2 zero 1"), &["word.env:3:", "zero"]),
        ("nan.env", with("-2 0 1", "-2 nan 1"), &["nan.env:3:"]),
        ("inf.env", with("2 0 1 0 0 0\nOb", "2 0 1e999 0 0 0\nOb"), &["inf.env:4:"]),
        ("five.env", with("-2 0 1 0 0 0", "-2 0 1 0 0"), &["five.env:3:"]),
        ("far.env", with("-2 0 1", "-2e30 0 1"), &["far.env:3:"]),
        ("robot-gone.env", with("robot.off", "gone.off"), &["robot-gone.env:2:", "gone.off"]),
        ("wall-gone.env", with("side.off", "gone.off"), &["wall-gone.env:6:", "gone.off"]),
        ("bad-mesh.env", with("side.off", "bad.off"), &["bad.off", "bad-mesh.env:6"]),
        ("empty-mesh.env", with("side.off", "none.off"), &["none.off"]),
        ("outside.env", with("End\n", "End\nBounds -1 -1 -1 3 1 2\n"), &["outside.env:3:", "out of bounds"]),
        ("bounds.env", with("End\n", "End\nBounds 3 -1 -1 -3 1 2\n"), &["bounds.env"]),
        ("space.env", with("End\n", "End\nSpace SE4\n"), &["space.env:9:", "SE3"]),
        (
            "tilted.env",
            with("-2 0 1 0 0 0", "-2 0 0 0 0.2 0").into_iter().chain(*b"Space SE2\n").collect(),
            &["plane"],
        ),
    ]
}

#[test]
fn scene_files() {
    let dir = Dir::new();
    dir.write("bad.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n");
    dir.write("none.off", "OFF\n0 0 0\n");
    let scenes = scenes();
    for (name, text, _) in &scenes {
        dir.write(name, text);
    }
    let before = dir.entries(".");
    for (name, _, words) in &scenes {
        for args in [&["plan", name, "--out", "p.txt"][..], &["info", name], &["check", name, "p.txt"]] {
            let run = mp(&dir, args);
            assert_eq!(run.code, 2, "{args:?}: {run:?}");
            let told = run.stderr.split_whitespace().filter(|w| *w != "│").collect::<Vec<_>>().join(" ");
            for word in *words {
                assert!(told.contains(word), "{name} does not say {word:?}: {told}");
            }
            assert!(!told.contains("panicked"), "{name}: {told}");
        }
    }
    assert_eq!(dir.entries("."), before, "nothing is written");
}

/// Start and goal in collision: the bodies, the depth and the nearest free configuration are named, and it is free.
#[test]
fn ends_in_collision() {
    let dir = Dir::new();
    let good = dir.read("window.env");
    for (end, line, moved) in
        [("start", "-2 1.4 0.2 0 0 0", "-0.2 1.5 1 0 0 0"), ("goal", "2 1.3 1.8 0.7 0 0", "0.3 -1.5 1 0 0 0")]
    {
        dir.write("hit.env", good.replace(line, moved));
        let run = mp(&dir, &["plan", "hit.env", "--out", "p.txt"]);
        assert_eq!(run.code, 2, "{run:?}");
        let info = mp(&dir, &["info", "hit.env"]);
        assert!(info.code == 0 && info.stdout.contains(&format!("the {end} is in collision")), "{info:?}");
        let told = run.stderr.split_whitespace().filter(|w| *w != "│").collect::<Vec<_>>().join(" ");
        let body = if end == "start" { "Obstacle #1" } else { "Obstacle #2" };
        assert!(told.contains(&format!("the {end} is in collision with {body} (0.")), "{told}");
        let free = told.split("free configuration found is ").nth(1).unwrap_or_else(|| panic!("{told}"));
        dir.write("freed.env", good.replace(line, free.trim()));
        let run = mp(&dir, &["plan", "freed.env", "--json"]);
        assert_eq!(run.code, 0, "{run:?}");
    }
    assert!(!dir.exists("p.txt"));
    // An obstacle that is wholly inside of the robot.
    dir.write(
        "around.toml",
        "[world]\nbounds = [[-5, -5], [5, 5]]\n[robot]\npolygon = [[-4, -4], [4, -4], [4, 4], [-4, 4]]\n\
         [motion]\nstart = [0, 0, 0]\ngoal = [0.1, 0, 0]\n[[obstacle]]\nname = \"post\"\ncircle = [1, 2, 0.1]\n",
    );
    let run = mp(&dir, &["plan", "around.toml"]);
    assert!(run.code == 2 && run.stderr.contains("the start is in collision with post"), "{run:?}");
    dir.write("touch.env", good.replace("-2 1.4 0.2 0 0 0", "-0.50000001 1.4 0.2 0 0 0"));
    let run = mp(&dir, &["plan", "touch.env"]);
    assert!(run.code == 2 && run.stderr.contains("from contact"), "{run:?}");
}

/// However small the scene is, the configuration that is named is free as it is written.
#[test]
fn the_nearest_free_configuration_of_a_tiny_scene() {
    let dir = Dir::new();
    let scene = "[robot]\nbox = [1e-6, 1e-6, 1e-6]\nbounds = [[-1e-4, -1e-4, -1e-4], [1e-4, 1e-4, 1e-4]]\n\
                 [motion]\nstart = [-5.1234567e-5, 0, 0, 0, 0, 0]\ngoal = [5e-5, 0, 0, 0, 0, 0]\n\
                 [[obstacle]]\nbox = [1e-6, 1e-5, 1e-5]\n";
    dir.write("tiny.toml", scene);
    for at in ["1.2345678e-7 0 0 0 0 0", "-3.3e-7 4.9e-6 0 0.3 0 0", "0 0 0 1 2 0.5"] {
        let told = mp(&dir, &["check", "tiny.toml", &format!("--at={at}")]).stdout;
        let free = told.split("free configuration found is ").nth(1).unwrap_or_else(|| panic!("{told}"));
        let run = mp(&dir, &["check", "tiny.toml", &format!("--at={}", free.trim())]);
        assert!(run.code == 0 && run.stdout.contains("is free"), "{at}: {free} {run:?}");
    }
}

/// What is out of bounds by less than numbers of single precision resolve is at their side, for each kind of body.
#[test]
fn ends_that_are_a_hair_out_of_bounds() {
    let dir = Dir::new();
    let link = |name| {
        format!(
            "<link name='{name}'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>"
        )
    };
    let joint = "<joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint>";
    dir.write("one.urdf", format!("<robot name='one'>{}{}{joint}</robot>", link("a"), link("b")));
    let bodies = [
        (
            "rigid.toml",
            "[robot]\nbox = [0.3, 0.3, 0.3]\n",
            "[[0, 0, 0], [4, 4, 4]]",
            ", 2, 0, 0, 0",
            "x y z alpha beta gamma",
        ),
        (
            "floating.toml",
            "[robot]\nurdf = 'one.urdf'\nbase = 'floating'\n",
            "[[0, 0, 0], [4, 4, 4]]",
            ", 2, 0, 0, 0, 0",
            "x y z alpha beta gamma j",
        ),
        ("world.toml", "[robot]\ndisc = 0.2\n[world]\n", "[[0, 0], [4, 4]]", "", "x y"),
    ];
    for (name, robot, bounds, rest, columns) in bodies {
        for (x, code) in [("4.000001", 0), ("4.001", 2)] {
            let ends = format!("start = [{x}, 2{rest}]\ngoal = [1, -0.000001{rest}]\n");
            dir.write(name, format!("{robot}bounds = {bounds}\n[motion]\n{ends}"));
            let run = mp(&dir, &["plan", name, "--out", "p.csv"]);
            assert_eq!(run.code, code, "{name} {x}: {run:?}");
            assert!(code == 0 || run.stderr.contains("the start is out of"), "{run:?}");
        }
        let row = |x: &str| format!("{x}, 2{rest}\n");
        dir.write("q.csv", columns.replace(' ', ",") + "\n" + &row("4.000001") + &row("1"));
        dir.write(name, dir.read(name).replace("4.001", "4.000001").replace("-0.000001", "2"));
        let check = mp(&dir, &["check", name, "q.csv", "--certificate", "c.json"]);
        assert!(check.code == 0 && check.stdout.contains("free"), "{name}: {check:?}");
        let replayed = mp(&dir, &["verify-certificate", "c.json", "--scene", name]);
        assert!(replayed.code == 0 && replayed.stdout.contains("proved free"), "{name}: {replayed:?}");
    }
}

#[test]
fn meshes_and_paths() {
    let dir = Dir::new();
    let files: [(&str, &[u8]); 8] = [
        ("cut.off", &OFF.as_bytes()[..20]),
        ("words.off", b"OFF\n3 1 0\na b c\n"),
        ("huge.off", b"OFF\n4000000000 4000000000 0\n"),
        ("binary.off", &[0, 159, 146, 150]),
        ("count.txt", b"3\n0 0 0 0 0 0\n"),
        ("zero.txt", b"0\n"),
        ("words.json", b"{\"path\": \"none\"}"),
        ("cut.json", b"{\"path\": [[0, 0, 0"),
    ];
    for (name, bytes) in files {
        dir.write(name, bytes);
        let run = mp(&dir, &["info", name]);
        assert_eq!(run.code, 2, "{name}: {run:?}");
        assert!(run.stderr.contains(name), "{name}: {run:?}");
        if !name.ends_with(".off") {
            assert_eq!(mp(&dir, &["check", "window.env", name]).code, 2, "{name}");
        }
    }
}
