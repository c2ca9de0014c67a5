//! Things that a link carries.

use crate::which_joints::scene_of;
use mp_cspace::Length;
use mp_plan::{Constraint, Interrupt, PathRows, Request, Scene};

fn load(more: &str, srdf: bool) -> Result<Scene, mp_plan::Error> {
    let of_srdf = if srdf { "srdf = \"r.srdf\"\n" } else { "" };
    let problem = format!("[robot]\nurdf = \"r.urdf\"\n{of_srdf}hold = {{ raise = 0.2 }}\n{more}");
    scene_of(problem)
}

/// A pole that the finger carries crosswise.
const POLE: &str =
    "[[attached]]\nname = \"pole\"\nlink = \"tip\"\nbox = [0.04, 0.8, 0.04]\npose = [0.18, 0, 0, 0, 0, 0]\n";
const MOTION: &str = "[motion]\nstart = [-1, 0.1, 0]\ngoal = [1, -0.1, 0]\n";
/// Two posts between which the bars pass.
const POSTS: &str = "[[obstacle]]\nname = \"post\"\nbox = [0.05, 0.05, 3]\npose = [2.2, 0.2, 0, 0, 0, 0]\n";

#[test]
fn what_is_carried_collides_as_the_robot_does() {
    let pole_at = |y: f64| {
        format!(
            "{MOTION}{POLE}[[obstacle]]\nname = \"post\"\nbox = [0.05, 0.05, 3]\npose = [2.18, {y}, 0, 0, 0, 0]\n"
        )
    };
    let straight = |y: f64| {
        let scene = load(&pole_at(y).replace("start = [-1, 0.1, 0]", "start = [0, 0, 0]"), true).unwrap();
        scene.check_ends().err().map(|e| e.report())
    };
    assert!(straight(0.35).unwrap().contains("pole"));
    assert!(straight(0.5).is_none());
    // Planned, verified, and proved again by the certificate, on which the pole is a body.
    let scene = load(&format!("{MOTION}{POLE}{POSTS}"), true).unwrap();
    let report = scene.plan(&Request::new("rrt-connect").iterations(20_000)).unwrap();
    assert!(report.solved && report.verified);
    let rows = PathRows { format: scene.path_format(), columns: scene.columns(), rows: report.path.unwrap() };
    let certificate = scene.certificate(&rows, 0.0, &Interrupt::never()).unwrap();
    assert!(certificate.to_json().contains("\"pole\""));
    // Without it the same path may be straight.
    let without = load(&format!("{MOTION}{POSTS}"), true).unwrap();
    assert!(without.check(&rows).unwrap().free);
}

#[test]
fn what_is_carried_must_not_touch_the_robot_but_where_it_may() {
    for srdf in [true, false] {
        // The bar that carries the finger is one joint away from it, and would not be compared with the finger.
        let on_bar = |may: &str| {
            let boxed =
                format!("[[attached]]\nname = \"box\"\nlink = \"tip\"\nbox = [0.3, 0.1, 0.1]\n{may}\n");
            load(&format!("{MOTION}{boxed}"), srdf).unwrap()
        };
        let error = on_bar("").check_ends().unwrap_err().report();
        assert!(error.contains("box") && error.contains("may_touch = [\"lower\"]"), "{error}");
        on_bar("may_touch = [\"lower\"]").check_ends().unwrap();
        // Things on one link do not collide with each other, those on two do.
        let two = |link: &str, x: f64| {
            let second = format!(
                "[[attached]]\nname = \"other\"\nlink = \"{link}\"\nsphere = 0.1\npose = [{x}, 0, 0.3, 0, 0, 0]\nmay_touch = [\"lower\", \"tip\"]\n"
            );
            let first = "[[attached]]\nname = \"first\"\nlink = \"tip\"\nsphere = 0.1\npose = [0.1, 0, 0, 0, 0, 0]\nmay_touch = [\"lower\"]\n";
            load(&format!("{MOTION}{first}{second}"), srdf).unwrap().check_ends().err().map(|e| e.report())
        };
        assert!(two("tip", 0.2).is_none());
        assert!(two("lower", 1.05).unwrap().contains("other"));
        assert!(two("lower", 0.5).is_none());
    }
}

#[test]
fn what_is_carried_can_be_a_goal() {
    let goal = "[motion]\nstart = [-1, 0.1, 0]\ngoal = { link = \"pole\", position = [1.2, 1.2, 0.5] }\n";
    let scene = load(&format!("{goal}{POLE}"), true).unwrap();
    assert!(scene.goals().len() > 2);
    let report = scene.plan(&Request::new("rrt-connect").iterations(20_000)).unwrap();
    assert!(report.solved && report.verified);
}

#[test]
fn what_cannot_be_attached_is_an_error_at_its_place() {
    for (attached, words) in [
        ("link = \"tipp\"\nsphere = 0.1", ["p.toml:8:", "\"tipp\"", "upper"]),
        ("link = \"tip\"\nsphere = 0.1\nmay_touch = [\"tap\"]", ["p.toml:8:", "\"tap\"", "upper"]),
        ("name = \"upper\"\nlink = \"tip\"\nsphere = 0.1", ["p.toml:8:", "of that name", "another"]),
        ("link = \"tip\"", ["p.toml:8:", "attached 1", "shape"]),
        ("sphere = 0.1", ["p.toml:8:", "link", "robot-problem.md"]),
        ("link = \"tip\"\nsphere = 0.1\npose = [0, 0, nan, 0, 0, 0]", ["p.toml:11:", "NaN", "finite"]),
        ("link = \"tip\"\nmesh = \"none.stl\"", ["p.toml:10:", "none.stl", ""]),
    ] {
        let error = match load(&format!("{MOTION}[[attached]]\n{attached}\n"), true) {
            Err(error) => error.report(),
            Ok(_) => panic!("{attached} is no error"),
        };
        assert!(words.iter().all(|word| error.contains(word)), "{attached}: {error}");
    }
}

/// A cube that is taken from one place, carried around a wall and put down at another.
const CARRY: &str = "[motion]\nstart = [-1, 0.1, 0]\ngoal = [-0.5, 0, 0.05]\n\
    [[obstacle]]\nname = \"cube\"\nbox = [0.1, 0.1, 0.1]\npose = [2.0009, -1.0931, 0.5, 0, 0, 0]\n\
    [[obstacle]]\nname = \"wall\"\nbox = [0.4, 0.05, 3]\npose = [2.2, 0, 0, 0, 0, 0]\n\
    [[then]]\nattach = \"cube\"\nto = \"tip\"\ngoal = { shoulder = 0.6, elbow = 0 }\n\
    [[then]]\ndetach = \"cube\"\ngoal = [1, 0.5, 0]\n";

#[test]
fn a_motion_of_several_parts_carries_something() {
    let mut scene = load(CARRY, true).unwrap();
    let (never, mut ends) = (Interrupt::never(), Vec::new());
    for (left, name) in [(2, "p"), (1, "p-2"), (0, "p-3")] {
        assert_eq!((scene.parts_left(), scene.name()), (left, name));
        let cube = scene.bodies().into_iter().find(|body| body.name == "cube").unwrap();
        assert_eq!(cube.pose.is_none(), left == 1, "an obstacle before and after, a link in between");
        let report = scene.plan(&Request::new("rrt-connect").iterations(20_000)).unwrap();
        assert!(report.solved && report.verified, "{name}");
        let path = report.path.unwrap();
        if let Some(end) = ends.last() {
            assert_eq!(&path[0], end);
        }
        ends.push(path.last().unwrap().clone());
        match scene.next_part(ends.last().unwrap(), &never).unwrap() {
            Some(next) => scene = next,
            None => assert_eq!(left, 0),
        }
    }
    // Put down where the tip has carried it: 2.2 m along a bar at 0.6 rad, as far from the tip as it was taken.
    let cube = scene.bodies().into_iter().find(|body| body.name == "cube").unwrap().pose.unwrap();
    let at = cube.translation.vector;
    let far = (2.0009_f64 * 2.0009 + 1.0931 * 1.0931).sqrt() - 0.05 + ends[1][2];
    assert!((at.xy().norm() - far).abs() < 1e-4 && (mp_math::atan2(at.y, at.x) - 0.6).abs() < 1e-4, "{at}");
    // What is carried is in the way: straight from one side of the wall to the other it would hit it.
    let second = load(CARRY, true).unwrap().next_part(&ends[0], &never).unwrap().unwrap();
    let rows = vec![ends[0].clone(), vec![0.6, 0.0, ends[0][2]]];
    let straight = PathRows { format: second.path_format(), columns: second.columns(), rows };
    assert!(!second.check(&straight).unwrap().free);
    // A constraint of one's own holds in all parts.
    let low = Constraint::new("low", Length::Fraction(0.01), |row: &[f64]| row[0] < 0.5);
    let under = load(CARRY, true).unwrap().under(low).unwrap();
    assert_eq!(under.parts_left(), 2);
    let second = under.next_part(&ends[0], &never).unwrap().unwrap();
    assert_eq!((second.parts_left(), second.name()), (1, "p-2"));
    let high = second.explain(&ends[1]).unwrap();
    assert!(!high.free && high.fault.unwrap().contains("low"));
}

#[test]
fn parts_that_cannot_be_are_errors_at_their_place() {
    let with = |then: &str| {
        let motion = CARRY.split("[[then]]").next().unwrap();
        load(&format!("{motion}[[then]]\n{then}\n"), true)
    };
    for (then, words) in [
        ("attach = \"cube\"\ngoal = [0, 0, 0]", ["p.toml:16:", "to no link", "`to = "]),
        (
            "attach = \"cube\"\nto = \"tip\"\ndetach = \"cube\"\ngoal = [0, 0, 0]",
            ["p.toml:16:", "attaches and detaches", "two parts"],
        ),
        ("to = \"tip\"\ngoal = [0, 0, 0]", ["p.toml:16:", "nothing is attached", "`attach = "]),
        ("attach = \"cube\"\nto = \"tip\"", ["p.toml:16:", "no goal", "`goal ="]),
        (
            "attach = \"cube\"\nto = \"tip\"\ngoal = []\nspeed = 1",
            ["p.toml:20:", "speed", "robot-problem.md"],
        ),
    ] {
        let error = with(then).map(|_| ()).unwrap_err().report();
        assert!(words.iter().all(|word| error.contains(word)), "{then}: {error}");
    }
    for (then, words) in [
        (
            "attach = \"cub\"\nto = \"tip\"\ngoal = [0, 0, 0]",
            ["p.toml:16:", "no obstacle \"cub\"", "cube, wall"],
        ),
        ("attach = \"cube\"\nto = \"tipp\"\ngoal = [0, 0, 0]", ["p.toml:16:", "no link \"tipp\"", ""]),
        (
            "attach = \"cube\"\nto = \"tip\"\nmay_touch = [\"toe\"]\ngoal = [0, 0, 0]",
            ["p.toml:16:", "\"toe\"", "upper"],
        ),
        ("detach = \"cube\"\ngoal = [0, 0, 0]", ["p.toml:16:", "nothing is attached", "there are none"]),
        ("goal = [0, 0]", ["p.toml:17:", "2 numbers", "shoulder"]),
        ("goal = \"nowhere\"", ["p.toml:17:", "no state", "home"]),
    ] {
        let error = with(then).unwrap().next_part(&[-0.5, 0.0, 0.05], &Interrupt::never());
        let error = error.map(|_| ()).unwrap_err().report();
        assert!(words.iter().all(|word| error.contains(word)), "{then}: {error}");
    }
    assert!(with("goal = [0, 0, 0]").unwrap().next_part(&[0.0], &Interrupt::never()).is_err());
    let carried =
        "[[attached]]\nname = \"lid\"\nlink = \"pole\"\nsphere = 0.01\npose = [0, 0, 0.05, 0, 0, 0]\n";
    let down = "[[then]]\ndetach = \"pole\"\ngoal = [0, 0, 0]\n";
    let scene = load(&format!("{MOTION}{POLE}{carried}{down}"), true).unwrap();
    let error = scene.next_part(&[1.0, -0.1, 0.0], &Interrupt::never()).map(|_| ()).unwrap_err().report();
    assert!(error.contains("carries \"lid\"") && error.contains("`detach = \"lid\"`"), "{error}");
}
