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

#[test]
fn tested_states_must_be_apart() {
    let scene = Scene::find("easy").unwrap();
    let error = scene.under(Constraint::new("any", Length::Fraction(0.0), |_| true)).unwrap_err();
    assert!(error.to_string().contains("constraint `any`"), "{error}");
}
