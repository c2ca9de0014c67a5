//! Robots among clouds of points: planned, explained, and with a certificate.

use super::certified_in;
use mp_plan::Scene;
use mp_verify_certificate::verify;
use std::fmt::Write;
use std::path::Path;

/// A wall across the plane x = 0 with a window, in points 2 cm apart, some of them in one place or lost.
fn window(folder: &Path) {
    let mut text = "# scan\nnan nan nan\n".to_owned();
    for (i, j) in (-50..=50).flat_map(|i| (-50..=50).map(move |j| (i, j))) {
        let (y, z) = (0.02 * f64::from(i), 0.02 * f64::from(j));
        if y.abs() > 0.3 || z.abs() > 0.3 {
            writeln!(text, "0 {y} {z}\n0.0001 {y} {z}").unwrap();
        }
    }
    std::fs::write(folder.join("wall.xyz"), text).unwrap();
}

#[test]
fn a_body_passes_a_window_in_a_cloud() {
    let folder = tempfile::tempdir().unwrap();
    window(folder.path());
    let scene = "[robot]\nbox = [0.4, 0.3, 0.1]\nbounds = [[-0.8, -0.7, -0.7], [0.8, 0.7, 0.7]]\n[motion]\nstart = [-0.7, 0, 0, 0, 0, 0]\ngoal = [0.7, 0.1, 0.2, 0, 0, 0]\n\
        [[obstacle]]\nname = \"wall\"\npoints = { radius = 0.02, file = \"wall.xyz\" }\n\
        [[obstacle]]\nname = \"table\"\nbox = [0.2, 0.2, 0.2]\npose = [-0.3, 0.5, 0, 0, 0, 0]\n";
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let scene = Scene::find(folder.path().join("scene.toml").to_str().unwrap()).unwrap();
    let (path, certificate) = certified_in(&scene);
    assert!(path.rows.len() > 2);
    let proved = verify(&certificate).unwrap();
    assert!(proved.clearance > Some(0.0));
    // All points are in it: without one that is near, another certificate; a wall through the window refutes it.
    let model: serde_json::Value = serde_json::from_str(&certificate).unwrap();
    let wall =
        model["model"]["bodies"].as_array().unwrap().iter().find(|body| body["name"] == "wall").unwrap();
    let points = wall["vertices"].as_array().unwrap().len();
    assert_eq!(points, 101 * 101 - 31 * 31);
    assert!((wall["radius"].as_f64().unwrap() - 0.02005).abs() < 1e-6, "{}", wall["radius"]);
    let mut other = model.clone();
    let wall =
        other["model"]["bodies"].as_array_mut().unwrap().iter_mut().find(|b| b["name"] == "wall").unwrap();
    wall["radius"] = serde_json::json!(0.5);
    assert!(verify(&super::sealed(other)).is_err());
    // In the wall, the cloud is named.
    let explained = scene.explain(&[0.0, 0.6, 0.0, 0.0, 0.0, 0.0]).unwrap();
    assert!(
        explained.touching.iter().any(|contact| contact.other == "wall" && contact.depth > Some(0.0)),
        "{explained:?}"
    );
}

/// A cloud of one point is as large as its ball, and what else stands still is no larger for it.
#[test]
fn a_cloud_of_one_point_is_one_ball() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "[robot]\nbox = [0.1, 0.1, 0.1]\nbounds = [[-1, -1, -1], [1, 1, 1]]\n[motion]\nstart = [-0.7, 0, 0, 0, 0, 0]\ngoal = [0.7, 0, 0, 0, 0, 0]\n\
        [[obstacle]]\nname = \"point\"\npoints = { radius = 0.3, at = [[0, 0, 0.9]] }\n\
        [[obstacle]]\nname = \"floor\"\nbox = [1.9, 1.9, 0.1]\npose = [0, 0, -0.3, 0, 0, 0]\n";
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let scene = Scene::find(folder.path().join("scene.toml").to_str().unwrap()).unwrap();
    // The floor is 0.2 m below the robot: less than the radius of the point.
    let proved = verify(&certified_in(&scene).1).unwrap();
    assert!(proved.clearance > Some(0.0), "{proved:?}");
}

/// A camera sees the arm too.
#[test]
fn points_on_the_robot_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = "<robot name='r'><link name='base'/><link name='arm'><collision><origin xyz='0.5 0 0'/><geometry><box size='1 0.1 0.1'/>\
        </geometry></collision></link><joint name='j' type='revolute'><parent link='base'/><child link='arm'/><axis xyz='0 0 1'/>\
        <limit lower='-3' upper='3' effort='1' velocity='1'/></joint></robot>";
    std::fs::write(folder.path().join("r.urdf"), urdf).unwrap();
    // Along the surface of the arm, inside of it, and beside it, where it moves.
    let points = "0.5 0.055 0\n0.2 0 0.06\n0.7 0 0\n0.3 -0.9 0\n0.31 -0.9 0.2\n";
    std::fs::write(folder.path().join("scan.xyz"), points).unwrap();
    let scene = |members: &str| {
        let text = format!(
            "[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [0]\ngoal = [1.5]\n[[obstacle]]\nname = \"scan\"\n\
             points = {{ radius = 0.01, file = \"scan.xyz\" }}\n{members}"
        );
        std::fs::write(folder.path().join("scene.toml"), text).unwrap();
        Scene::find(folder.path().join("scene.toml").to_str().unwrap())
    };
    assert!(!scene("").unwrap().explain(&[0.0]).unwrap().free);
    let filtered = scene("self_filter = 0.02").unwrap();
    assert!(filtered.explain(&[0.0]).unwrap().free);
    // The others are there, in the check, the verifier and the certificate.
    assert!(!filtered.explain(&[-1.249]).unwrap().free);
    assert!(verify(&certified_in(&filtered).1).is_ok());
    let error = scene("self_filter = 2").unwrap_err().to_string();
    assert!(error.contains("all 5 points of scan") && error.contains("scene.toml"), "{error}");
    // Also where ends are chosen, and where the base floats.
    let scene = |robot: &str, ends: &str| {
        let text = format!(
            "[robot]\nurdf = \"r.urdf\"\n{robot}\n[motion]\n{ends}\n[[obstacle]]\nname = \"scan\"\n\
             points = {{ radius = 0.01, file = \"scan.xyz\" }}\nself_filter = 0.02\n"
        );
        std::fs::write(folder.path().join("scene.toml"), text).unwrap();
        Scene::find(folder.path().join("scene.toml").to_str().unwrap()).unwrap()
    };
    let floating = "base = \"floating\"\nbounds = [[-1, -1, -1], [1, 1, 1]]";
    for (robot, ends, base) in [
        ("", "start = [0]\ngoal = []", 0),
        ("", "start = []\ngoal = [1.5]", 0),
        ("", "start = []\ngoal = []", 0),
        (floating, "start = [0, 0, 0, 0, 0, 0, 0]\ngoal = [0, 0, 0.5, 0, 0, 0, 0]", 6),
    ] {
        let scene = scene(robot, ends);
        let at = |joint: f64| scene.explain(&[vec![0.0; base], vec![joint]].concat()).unwrap().free;
        assert!(scene.start().iter().all(|x| *x == 0.0), "{ends}: {:?}", scene.start());
        assert!(at(0.0) && !at(-1.249), "{ends}");
        let note = "3 of 5 points of scan are on the robot at the start, and left out";
        assert_eq!(scene.notes().iter().filter(|line| *line == note).count(), 1, "{:?}", scene.notes());
    }
}

/// An arm of which each link is balls of several sizes: each keeps its own in the certificate.
#[test]
fn links_of_balls_keep_their_radii() {
    let folder = tempfile::tempdir().unwrap();
    let ball = |x: f64, radius: f64| {
        format!(
            "<collision><origin xyz='{x} 0 0'/><geometry><sphere radius='{radius}'/></geometry></collision>"
        )
    };
    let link = |name: &str| {
        format!("<link name='{name}'>{}{}{}</link>", ball(0.1, 0.06), ball(0.3, 0.04), ball(0.45, 0.02))
    };
    let joint = |name: &str, parent: &str, child: &str, x: f64| {
        format!(
            "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/>\
             <origin xyz='{x} 0 0'/><axis xyz='0 0 1'/><limit lower='-3' upper='3' effort='1' velocity='1'/></joint>"
        )
    };
    let urdf = format!(
        "<robot name='r'><link name='base'/>{}{}{}{}</robot>",
        link("upper"),
        link("lower"),
        joint("a", "base", "upper", 0.0),
        joint("b", "upper", "lower", 0.5)
    );
    std::fs::write(folder.path().join("r.urdf"), urdf).unwrap();
    let scene = "[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [-1.2, 0.3]\ngoal = [1.4, -0.2]\n\
        [[obstacle]]\nname = \"post\"\ncapsule = [0.1, 1.0]\npose = [0.8, 0.1, 0, 0, 0, 0]\n";
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let scene = Scene::find(folder.path().join("scene.toml").to_str().unwrap()).unwrap();
    let (_, certificate) = certified_in(&scene);
    assert!(verify(&certificate).unwrap().clearance > Some(0.0));
    let model: serde_json::Value = serde_json::from_str(&certificate).unwrap();
    let lower = model["model"]["bodies"].as_array().unwrap().iter().find(|b| b["name"] == "lower").unwrap();
    assert_eq!((&lower["radius"], &lower["radii"]), (&0.06.into(), &serde_json::json!([0.06, 0.04, 0.02])));
    // Balls that are too large, or not as many as there are centres, are no body of a certificate.
    for (radii, refused) in [
        (serde_json::json!([0.06, 0.04, 0.06]), false),
        (serde_json::json!([0.06, 0.04, 0.07]), true),
        (serde_json::json!([0.06, 0.04]), true),
    ] {
        let mut other: serde_json::Value = serde_json::from_str(&certificate).unwrap();
        let bodies = other["model"]["bodies"].as_array_mut().unwrap();
        bodies.iter_mut().find(|b| b["name"] == "lower").unwrap()["radii"] = radii;
        let answer = verify(&super::sealed(other));
        assert!(!refused || answer.unwrap_err().to_string().contains("lower"));
    }
}
