//! Films, views, modes and meshes from the command line.

use crate::common::{Dir, mp};
use std::io::Write;

/// A path through the window, of two motions.
const PATH: &str = "3\n-2 0 1 0 0 0\n0 0 1 0.3 0 0\n2 0 1 0.7 0 0\n";

type Pixels = Vec<[u8; 3]>;

/// The frames of a GIF as a player shows them, with their delays in hundredths of a second.
fn frames(bytes: &[u8]) -> (Vec<Pixels>, Vec<u16>, (u16, u16)) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).unwrap();
    assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
    let (width, height) = (decoder.width(), decoder.height());
    let mut screen = vec![[0; 3]; usize::from(width) * usize::from(height)];
    let (mut all, mut delays) = (Vec::new(), Vec::new());
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        for (i, [r, g, b, a]) in frame.buffer.as_chunks::<4>().0.iter().enumerate() {
            let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
            if *a > 0 {
                let at = (y + usize::from(frame.top)) * usize::from(width) + x + usize::from(frame.left);
                screen[at] = [*r, *g, *b];
            }
        }
        all.push(screen.clone());
        delays.push(frame.delay);
    }
    (all, delays, (width, height))
}

/// The right number of frames, each of the right length, and the robot goes from left to right. The same on any number of
/// threads.
#[test]
fn a_film_shows_the_robot_on_its_way() {
    let dir = Dir::new();
    dir.write("p.txt", PATH);
    let options = ["--size", "160x120", "--seconds", "1.5", "--fps", "8", "--camera", "front"];
    for (name, threads) in [("a.gif", "1"), ("b.gif", "2"), ("c.gif", "2")] {
        let mut args = vec!["render", "window.env", "p.txt", "--out", name, "--threads", threads];
        args.extend(options);
        let run = mp(&dir, &args);
        assert_eq!(run.code, 0, "{run:?}");
    }
    let bytes = dir.bytes("a.gif");
    assert!(bytes == dir.bytes("b.gif") && bytes == dir.bytes("c.gif"));
    let (frames, delays, size) = frames(&bytes);
    assert_eq!((frames.len(), size), (12, (160, 120)));
    assert_eq!(delays.iter().map(|d| u32::from(*d)).sum::<u32>(), 150);
    assert!(delays.iter().all(|d| (12..=13).contains(d)), "{delays:?}");
    // Where the robot has moved from one frame to the next.
    let moved = |a: &[[u8; 3]], b: &[[u8; 3]]| {
        let changed: Vec<usize> = (0..a.len()).filter(|i| a[*i] != b[*i]).map(|i| i % 160).collect();
        changed.iter().sum::<usize>() as f64 / changed.len() as f64
    };
    let places: Vec<f64> = frames.windows(2).map(|w| moved(&w[0], &w[1])).collect();
    assert!(places.windows(2).all(|w| w[0] < w[1] + 1.0) && places[0] + 40.0 < places[10], "{places:?}");
}

/// Cameras that turn and follow, all configurations at once, an arm, and a world in the plane.
#[test]
fn films_of_all_kinds() {
    let dir = Dir::new();
    dir.write("p.txt", PATH);
    for scene in ["arm", "rrs-low"] {
        let run = mp(&dir, &["plan", scene, "--out", &format!("{scene}.path"), "--json"]);
        assert_eq!(run.code, 0, "{run:?}");
    }
    let cases: [&[&str]; 7] = [
        &["window.env", "--turntable"],
        &["window.env", "p.txt", "--turntable", "--animation", "all"],
        &["window.env", "p.txt", "--turntable", "--follow", "--mode", "wire"],
        &["plane.env", "--turntable", "--mode", "transparent"],
        &["arm", "arm.path", "--camera", "eye=3,-3,2 target=0,0,0.5 ortho"],
        &["rrs-low", "rrs-low.path"],
        &["rrs-low", "rrs-low.path", "--follow", "--mode", "wire"],
    ];
    for case in cases {
        let options = ["--size", "96x64", "--seconds", "0.5", "--fps", "10", "--out", "film.gif"];
        let run = mp(&dir, &[&["render"], case, &options].concat());
        assert_eq!(run.code, 0, "{case:?}: {run:?}");
        let (frames, _, size) = frames(&dir.bytes("film.gif"));
        assert_eq!((frames.len(), size), (5, (96, 64)), "{case:?}");
        assert!(frames.windows(2).all(|w| w[0] != w[1]), "{case:?}: something moves in each frame");
    }
}

#[test]
fn plan_makes_films_and_meshes_too() {
    let dir = Dir::new();
    for (name, start) in [("film.gif", &b"GIF89a"[..]), ("meshes.glb", b"glTF")] {
        let run = mp(&dir, &["plan", "window.env", "--out", "p.txt", "--picture", name, "--json"]);
        assert_eq!((run.code, &run.json()["picture_file"]), (0, &name.into()), "{run:?}");
        assert!(dir.bytes(name).starts_with(start));
    }
    assert_eq!(frames(&dir.bytes("film.gif")).0.len(), 160);
    let run = mp(&dir, &["render", "window.env", "p.txt", "--out", "other.glb", "--seconds", "3"]);
    assert_eq!(run.code, 0, "{run:?}");
    assert_ne!(dir.bytes("meshes.glb"), dir.bytes("other.glb"));
}

/// Each mode, view and moment is another picture, and the defaults are what they say.
#[test]
fn pictures_by_mode_view_and_moment() {
    let dir = Dir::new();
    dir.write("p.txt", PATH);
    let draw = |scene: &str, options: &[&str]| {
        let path = if scene == "rrs-low" { "rrs-low.path" } else { "p.txt" };
        let run =
            mp(&dir, &[&["render", scene, path, "--size", "128x96", "--out", "x.png"], options].concat());
        assert_eq!(run.code, 0, "{options:?}: {run:?}");
        dir.bytes("x.png")
    };
    let variants: [&[&str]; 12] = [
        &[],
        &["--mode", "wire"],
        &["--mode", "transparent"],
        &["--camera", "front"],
        &["--camera", "back"],
        &["--camera", "left"],
        &["--camera", "iso"],
        &["--camera", "iso ortho"],
        &["--camera", "eye=0,-6,3 target=0,0,1 fov=50"],
        &["--at", "0"],
        &["--at", "0.4"],
        &["--animation", "step"],
    ];
    let pictures: Vec<_> = variants.iter().map(|options| draw("window.env", options)).collect();
    for (i, a) in pictures.iter().enumerate() {
        assert!(pictures[..i].iter().all(|b| a != b), "{:?}", variants[i]);
    }
    assert!(draw("window.env", &["--mode", "solid", "--animation", "all"]) == pictures[0]);
    assert!(draw("window.env", &["--at", "0.5"]) == pictures[11]);

    let run = mp(&dir, &["plan", "rrs-low", "--out", "rrs-low.path", "--json"]);
    assert_eq!(run.code, 0, "{run:?}");
    let plane: Vec<_> = [&[][..], &["--mode", "wire"], &["--mode", "transparent"], &["--at", "0.3"]]
        .map(|o| draw("rrs-low", o))
        .into();
    assert!(plane.windows(2).all(|w| w[0] != w[1]));
    assert!(draw("rrs-low", &["--camera", "top"]) == plane[0]);
    let svg = |name: &str, options: &[&str]| {
        let run = mp(&dir, &[&["render", "rrs-low", "rrs-low.path", "--out", name], options].concat());
        assert_eq!(run.code, 0, "{run:?}");
        dir.read(name)
    };
    assert!(svg("a.svg", &["--at", "0.3"]).len() < svg("b.svg", &[]).len(), "one robot instead of many");
}

/// Without ffmpeg an MP4 is an error that says what to do, and nothing is left behind.
#[test]
fn an_mp4_needs_ffmpeg() {
    let dir = Dir::new();
    let before = dir.entries(".");
    let args =
        ["render", "window.env", "--turntable", "--out", "film.mp4", "--size", "64x64", "--seconds", "0.2"];
    let run = crate::common::finish(crate::common::start_with(&dir, &args, &[("PATH", "nowhere")]));
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.stderr.contains("ffmpeg") && run.stderr.contains(".gif"), "{run:?}");
    assert_eq!(dir.entries("."), before);
}

/// A program in the place of ffmpeg: it gets every frame, and when it fails, its words are told and nothing is left behind.
#[cfg(unix)]
#[test]
fn frames_go_to_ffmpeg_and_its_errors_come_back() {
    use std::os::unix::fs::PermissionsExt;
    let dir = Dir::new();
    std::fs::create_dir(dir.path("bin")).unwrap();
    let path = format!("{}:{}", dir.path("bin").display(), std::env::var("PATH").unwrap_or_default());
    let args =
        ["render", "window.env", "--turntable", "--out", "film.mp4", "--size", "64x64", "--seconds", "0.3"];
    let run = |script: &str| {
        dir.write("bin/ffmpeg", format!("#!/bin/sh\n{script}\n"));
        std::fs::set_permissions(dir.path("bin/ffmpeg"), std::fs::Permissions::from_mode(0o755)).unwrap();
        crate::common::finish(crate::common::start_with(&dir, &args, &[("PATH", &path)]))
    };
    let good = run("for last; do :; done; wc -c > \"$last\"");
    assert_eq!(good.code, 0, "{good:?}");
    let expected = 6 * 64 * 64 * 3;
    assert_eq!(dir.read("film.mp4").trim(), expected.to_string());
    std::fs::remove_file(dir.path("film.mp4")).unwrap();
    for script in [
        "echo 'Unknown encoder libx264' >&2; exit 1",
        "cat > /dev/null; echo 'Unknown encoder libx264' >&2; exit 1",
    ] {
        let bad = run(script);
        assert_eq!(bad.code, 2, "{bad:?}");
        assert!(bad.stderr.contains("Unknown encoder libx264") && bad.stderr.contains(".gif"), "{bad:?}");
        assert!(!dir.exists("film.mp4"));
    }
}

/// The real ffmpeg, where there is one: the same file twice, with its index before its frames.
#[test]
fn an_mp4_is_the_same_twice() {
    let found = std::process::Command::new("ffmpeg").arg("-version").output();
    if !found.is_ok_and(|output| output.status.success()) {
        // Tests that pass hide what `eprintln` prints.
        let _ = writeln!(std::io::stderr(), "SKIPPED an_mp4_is_the_same_twice: ffmpeg is not installed");
        return;
    }
    let dir = Dir::new();
    dir.write("p.txt", PATH);
    for (name, threads) in [("a.mp4", "1"), ("b.mp4", "2")] {
        let options = ["--out", name, "--size", "96x64", "--seconds", "1", "--threads", threads];
        let run = mp(&dir, &[&["render", "window.env", "p.txt"], &options[..]].concat());
        assert_eq!(run.code, 0, "{run:?}");
    }
    let bytes = dir.bytes("a.mp4");
    assert!(bytes == dir.bytes("b.mp4"));
    let at = |word: &[u8]| bytes.windows(4).position(|w| w == word).unwrap_or_else(|| panic!("{word:?}"));
    assert_eq!(at(b"ftyp"), 4);
    assert!(at(b"moov") < at(b"mdat"), "a player can begin before the file is complete");
}

/// The first Ctrl-C ends a film, and leaves nothing behind.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_film() {
    let dir = Dir::new();
    let before = dir.entries(".");
    let child = crate::common::start(
        &dir,
        &["render", "window.env", "--turntable", "--out", "film.gif", "--seconds", "3600"],
    );
    std::thread::sleep(std::time::Duration::from_millis(1500));
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let run = crate::common::finish(child);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.stderr.contains("interrupted: film.gif was not written"), "{run:?}");
    assert_eq!(dir.entries("."), before);
}

/// Ctrl-C in the film of the first part of a motion: its path is kept, and the next part is not begun.
#[cfg(unix)]
#[test]
fn ctrl_c_in_the_film_of_a_part_ends_the_motion() {
    let dir = Dir::new();
    let child = crate::common::start(&dir, &["plan", "carry", "--out", "p.txt", "--picture", "f.gif"]);
    let begun = std::time::Instant::now();
    while !dir.exists("p-1.txt") && begun.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    // The film takes many seconds.
    std::thread::sleep(std::time::Duration::from_millis(300));
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let run = crate::common::finish(child);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.stderr.contains("interrupted: part 2 of 3 was not begun"), "{run:?}");
    assert!(run.stdout.contains("part 1 of 3") && dir.exists("p-1.txt"), "{run:?}");
    assert!(!dir.exists("f-1.gif") && !dir.exists("p-2.txt"));
}
