//! Constraints of one's own, on each kind of robot.

use mp_cspace::Length;
use mp_plan::{Constraint, ErrorKind, PathRows, Request, Scene};

/// Scenes of all kinds, each with a radius, in the first two numbers of a configuration, of what is forbidden.
const SCENES: [(&str, f64); 6] = [
    ("cubicles", 0.3),
    ("arm", 0.15),
    ("gempa-2", 0.1),
    ("rrs-low", 0.05),
    ("crossing", 0.1),
    ("velocities", 0.1),
];

fn request(scene: &Scene) -> Request {
    Request::new(scene.default_planner()).seed(1).iterations(200_000)
}

fn planned(scene: &Scene) -> PathRows {
    let report = scene.plan(&request(scene)).unwrap();
    assert!(report.solved, "{}: {:?}", scene.name(), report.why);
    PathRows { format: scene.path_format(), columns: scene.columns(), rows: report.path.unwrap() }
}

#[test]
fn paths_keep_to_a_constraint_whatever_the_robot_is() {
    for (name, radius) in SCENES {
        let scene = Scene::find(name).unwrap();
        let before = planned(&scene);
        // Around the row that is farthest from both ends.
        let off = |a: &[f64], b: &[f64]| mp_math::hypot(a[0] - b[0], a[1] - b[1]);
        let [first, last] = [before.rows.first().unwrap(), before.rows.last().unwrap()];
        let nearest_end = |row: &Vec<f64>| off(row, first).min(off(row, last));
        let middle =
            before.rows.iter().max_by(|a, b| nearest_end(a).total_cmp(&nearest_end(b))).unwrap().clone();
        assert!(nearest_end(&middle) > 2.0 * radius, "{name}: {}", nearest_end(&middle));
        let beside = move |row: &[f64]| off(row, &middle) > radius;
        let rule = Constraint::new("beside the middle", Length::Fraction(0.002), beside.clone());
        let under = scene.under(rule).unwrap();

        let verdict = under.check(&before).unwrap();
        let faults = verdict.faults.join(" ");
        assert!(!verdict.free && faults.contains("constraint `beside the middle`"), "{name}: {faults}");
        let after = planned(&under);
        assert!(after.rows.iter().all(|row| beside(row)), "{name}");
        assert!(under.check(&after).unwrap().free && scene.check(&after).unwrap().free, "{name}");
        assert!(under.details().iter().any(|(what, text)| what == "constraint" && text.contains("beside")));
        assert!(under.certificate(&after, 0.0, &mp_plan::Interrupt::never()).is_err(), "{name}");
    }
}

#[test]
fn ends_against_a_constraint_are_refused() {
    let scene = Scene::find("easy").unwrap();
    let start = scene.start();
    let rule = |every| Constraint::new("not at the start", every, move |row: &[f64]| row != start);
    let under = scene.under(rule(Length::Fraction(0.01))).unwrap();
    let error = under.plan(&Request::default()).unwrap_err();
    assert!(error.to_string().contains("against the constraint `not at the start`"), "{error}");
    assert!(matches!(error.kind(), ErrorKind::NotFree(_)));
    assert!(!under.explain(&scene.start()).unwrap().free && scene.explain(&scene.start()).unwrap().free);
    // A clearance, and other ends, keep it.
    assert!(!under.keeping(0.01).unwrap().explain(&scene.start()).unwrap().free);
    let moved = under.with_ends(&scene.goals()[0], &[scene.goals()[0].clone()]).unwrap();
    assert!(!moved.explain(&scene.start()).unwrap().free);
}

/// A motion by inputs is tested all along, however near its ends are to each other.
#[test]
fn a_circle_is_not_short() {
    let text = "[world]\nwalls = [[0, 0], [20, 10]]\n[robot]\nkind = \"unicycle\"\ndisc = 0.1\nspeed = 2\nturning = 3.15\nduration = 2\n\
                [motion]\nstart = [9, 5, 0]\ngoal = [9, 5, 0]\ntolerance = 0.5\n";
    let scene = Scene::parse("circle", text, std::path::Path::new("")).unwrap();
    // A whole circle of radius 0.5 about (9, 5.5).
    let turning = std::f64::consts::PI;
    let rows = vec![scene.start(), vec![9.0, 5.0, 2.0 * turning, 0.5 * turning, turning, 2.0]];
    let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    for (most, free) in [(6.001, true), (5.99, false)] {
        let low = Constraint::new("low", Length::Fraction(0.002), move |row: &[f64]| row[1] <= most);
        let verdict = scene.under(low).unwrap().check(&path).unwrap();
        assert_eq!(verdict.free, free, "{most}: {:?}", verdict.faults);
    }
}

#[test]
fn tested_states_must_be_apart() {
    let scene = Scene::find("easy").unwrap();
    let error = scene.under(Constraint::new("any", Length::Fraction(0.0), |_| true)).unwrap_err();
    assert!(error.to_string().contains("constraint `any`"), "{error}");
}
