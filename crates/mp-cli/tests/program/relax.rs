//! Paths relaxed in fields of choice, and pictures of the fields, by the command line.

use crate::common::{Dir, mp};

/// A black and white image for the world `rrs-follow`: its left half is dark.
fn image(dir: &Dir) {
    let row = [vec!["0"; 50], vec!["255"; 50]].concat().join(" ");
    dir.write("left.pgm", format!("P2 100 40 255\n{}\n", vec![row; 40].join("\n")));
}

#[test]
fn each_field_is_planned_checked_and_drawn() {
    let dir = Dir::empty();
    image(&dir);
    let mut pictures = Vec::new();
    for field in ["clearance", "paper", "risk", "risk:2", "image:left.pgm"] {
        let run = mp(
            &dir,
            &["plan", "rrs-follow", "--relax", field, "--out", "path.txt", "--picture", "path.svg", "--json"],
        );
        assert_eq!(run.code, 0, "{run:?}");
        let report = run.json();
        assert!(report["clearance"].as_f64().unwrap() > 0.0 && report["shortened"] == false, "{report}");
        assert_eq!(mp(&dir, &["check", "rrs-follow", "path.txt"]).code, 0);
        let picture = dir.read("path.svg");
        assert!(!pictures.contains(&picture), "{field}");
        let drawn =
            mp(&dir, &["render", "rrs-follow", "path.txt", "--field", field, "--picture", "again.svg"]);
        assert_eq!(drawn.code, 0, "{drawn:?}");
        // The strongest shade of a field, as in the picture of the run.
        assert!(picture.contains("#b2182b") && dir.read("again.svg").contains("#b2182b"), "{field}");
        pictures.push(picture);
    }
    // Without a value it is the field of clearance, and a page has no picture of it.
    let run = mp(&dir, &["plan", "rrs-follow", "--relax", "--picture", "path.svg", "--out", "plain.txt"]);
    assert_eq!((run.code, dir.read("path.svg") == pictures[0]), (0, true));
    let page = mp(&dir, &["plan", "rrs-follow", "--relax", "risk", "--picture", "page.html"]);
    assert_eq!(page.code, 0, "{page:?}");
    // A request in a file.
    dir.write("request.json", r#"{"planner": "rrt-connect", "finish": "relax", "field": "risk"}"#);
    let run = mp(&dir, &["plan", "rrs-follow", "--request", "request.json", "--out", "risk.txt"]);
    assert_eq!(run.code, 0, "{run:?}");
    assert_ne!(dir.read("risk.txt"), dir.read("plain.txt"));
}

#[test]
fn bad_fields_are_explained() {
    let dir = Dir::empty();
    image(&dir);
    dir.write("square.pgm", "P2 2 2 255\n0 0 0 0\n");
    dir.write("no.png", "no picture");
    dir.write("field.json", r#"{"finish": "relax", "field": "wind"}"#);
    let (picture, bent) = (["--picture", "x.svg"], ["plan", "--planner", "rrs"]);
    for (arguments, words) in [
        (vec!["plan", "--relax", "rrs-follow"], ["no field `rrs-follow`", "A scene stands before --relax"]),
        (vec!["plan", "rrs-follow", "--relax", "risk:0"], ["factor of the noise is `0`", "above zero"]),
        (vec!["plan", "rrs-follow", "--relax", "image:gone.png"], ["gone.png", "no such file"]),
        (vec!["plan", "rrs-follow", "--relax", "image:no.png"], ["no.png", "neither a PNG nor a PGM"]),
        (vec!["plan", "rrs-follow", "--relax", "image:square.pgm"], ["2 × 2 pixels", "2 × 1 pixels"]),
        (
            vec!["plan", "cubicles", "--relax", "paper"],
            ["for discs and polygons in worlds, not for SE3", "`clearance`"],
        ),
        (
            vec!["plan", "arm", "--relax", "risk"],
            ["for discs and polygons in worlds, not for", "`clearance`"],
        ),
        (
            [&bent[..], &["rrs-follow", "--set", "field=wind"]].concat(),
            ["no field `wind`", "there are: clearance"],
        ),
        (
            [&bent[..], &["rrs-follow", "--set", "field=risk:0"]].concat(),
            ["factor of the noise is `0`", "above zero"],
        ),
        (
            [&bent[..], &["rrs-follow", "--set", "field=image:gone.png"]].concat(),
            ["gone.png", "no such file"],
        ),
        (
            [&bent[..], &["rrs-follow", "--set", "field=image:no.png"]].concat(),
            ["no.png", "neither a PNG nor a PGM"],
        ),
        (
            [&bent[..], &["cubicles", "--set", "field=paper"]].concat(),
            ["for discs and polygons in worlds, not for SE3", "`clearance`"],
        ),
        (vec!["plan", "crossing", "--relax"], ["no clearance gradient", "leave relaxing out"]),
        (vec!["plan", "rrs-follow", "--request", "field.json"], ["no field `wind`", "is not a request"]),
        ([&["render", "rrs-follow", "--field", "risk"], &picture[..]].concat(), ["of a path", "name a path"]),
        (
            vec!["render", "cubicles", "--field", "clearance", "--picture", "x.png"],
            ["is not drawn", "world of the plane"],
        ),
        (
            vec!["render", "rrs-follow", "--field", "clearance", "--picture", "x.html"],
            ["--field has no meaning", "pictures and films"],
        ),
    ] {
        let run = mp(&dir, &arguments);
        assert!(run.code == 2 && words.iter().all(|w| run.stderr.contains(w)), "{arguments:?}: {run:?}");
    }
}
