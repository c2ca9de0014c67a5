//! Certificates of trajectories: what a controller runs between two points is a polynomial.

use crate::{certified, sealed};
use mp_plan::{Interrupt, Knots, Pace, Scene, Trajectory};
use mp_verify_certificate::{is_of_path, verify};
use serde_json::{Value, json};

/// A timed path through a shipped scene, and the certificate of its curve.
fn timed(name: &str) -> (Scene, Trajectory, String) {
    let scene = Scene::find(name).unwrap();
    let never = Interrupt::never();
    let made = scene.time(&certified(name).0, &Pace::default(), &never).unwrap().trajectory;
    let clearance = scene.check_trajectory(&made, &never).unwrap().clearance;
    let certificate = scene.certificate_of_trajectory(&made, clearance, &never).unwrap();
    assert!(certificate.clearance() >= Some(0.5 * clearance), "{name}");
    let text = certificate.to_json().to_owned();
    (scene, made, text)
}

#[test]
fn curves_of_arms_have_certificates_that_another_program_replays() {
    for name in ["arm", "arm-7", "mobile-arm", "two-arms", "humanoid"] {
        let (scene, made, text) = timed(name);
        let proved = verify(&text).unwrap_or_else(|why| panic!("{name}: {why}"));
        assert_eq!((proved.scene.as_str(), proved.configurations), (name, made.knots().times.len()));
        assert!(proved.clearance > Some(0.0) && proved.parts >= proved.edges, "{name}");
        assert_eq!(scene.certificate_differences(&text).unwrap(), Vec::<String>::new(), "{name}");
        // The same rows as a path: what is between them is another motion.
        let rows = json!({ "path": made.knots().positions }).to_string();
        assert!(is_of_path(&text, &rows).unwrap_err().contains("curves"), "{name}");
        let file: Value = serde_json::from_str(&text).unwrap();
        let refused = |what: &str, change: &dyn Fn(&mut Value)| {
            let mut changed = file.clone();
            change(&mut changed);
            verify(&sealed(changed)).map(|_| ()).expect_err(&format!("{name}: {what}"))
        };
        // Beyond the limits between two points that are within.
        let mut changed = file.clone();
        let to = |file: &mut Value, i: usize, by: f64| {
            let c = &mut file["curves"][0][0][i];
            *c = json!(c.as_f64().unwrap() + by);
        };
        to(&mut changed, 1, 100.0);
        to(&mut changed, 2, -100.0);
        let differences = scene.certificate_differences(&sealed(changed)).unwrap();
        let joint = &scene.columns()[0].name;
        assert!(
            differences.iter().any(|d| d.contains(joint) && d.contains("limits")),
            "{name}: {differences:?}"
        );
        let edges = proved.edges;
        for edge in [0, edges / 2, edges - 1] {
            // The same ends, by a detour.
            let why = refused("a detour", &|file| {
                let c = &mut file["curves"][edge][0];
                let more = |c: &Value, by: f64| json!(c.as_f64().unwrap() + by);
                (c[1], c[2]) = (more(&c[1], 4.0), more(&c[2], -4.0));
            });
            assert!(["do not leave", "m apart"].iter().any(|w| why.contains(w)), "{name}: {why}");
            let why = refused("another end", &|file| {
                file["curves"][edge][0][3] = json!(file["curves"][edge][0][3].as_f64().unwrap() + 0.1);
            });
            assert!(
                ["away from", "do not leave", "m apart"].iter().any(|w| why.contains(w)),
                "{name}: {why}"
            );
            let why = refused("another begin", &|file| file["curves"][edge][0][0] = json!(1.25));
            assert!(why.contains("does not begin"), "{name}: {why}");
        }
        let why = refused("no curves", &|file| drop(file.as_object_mut().unwrap().remove("curves")));
        assert!(why.contains("version 3"), "{name}: {why}");
        let why = refused("version 2", &|file| file["certificate"] = json!(2));
        assert!(why.contains("version 3"), "{name}: {why}");
        let why = refused("a curve less", &|file| drop(file["curves"].as_array_mut().unwrap().pop()));
        assert!(why.contains("each edge"), "{name}: {why}");
    }
}

#[test]
fn what_stands_still_and_what_collides() {
    let scene = Scene::find("arm").unwrap();
    let columns = scene.columns();
    let joints = || columns.iter().map(|column| (column.name.as_str(), column.unit.as_str()));
    let start = scene.start();
    let still = Knots { times: vec![0.0], positions: vec![start.clone()], ..Knots::default() };
    let still = Trajectory::of_controller(joints(), still).unwrap();
    let certificate = scene.certificate_of_trajectory(&still, 0.0, &Interrupt::never()).unwrap();
    assert_eq!(verify(certificate.to_json()).unwrap().edges, 0);
    // Between two places that are one, far away.
    let zero = vec![0.0; start.len()];
    let quick = (0..start.len()).map(|i| if i == 1 { 12.0 } else { 0.0 }).collect();
    let knots = Knots {
        times: vec![0.0, 1.0],
        positions: vec![start.clone(), start],
        velocities: vec![quick, zero],
        accelerations: Vec::new(),
    };
    let swing = Trajectory::of_controller(joints(), knots).unwrap();
    let error = scene.certificate_of_trajectory(&swing, 0.0, &Interrupt::never()).unwrap_err().to_string();
    assert!(error.contains("between configurations 1 and 2"), "{error}");
}
