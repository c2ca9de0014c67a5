//! `auto`: searches that take turns.

use mp_plan::{PathRows, Report, Request, Scene};

/// What comes of short turns.
fn in_turns(scene: &Scene, seed: u64, turn: u64) -> Report {
    scene.plan(&Request::new("auto").seed(seed).set("turn", turn)).unwrap()
}

#[test]
fn what_is_found_in_the_first_turn_is_the_path_of_balanced_rrt_connect() {
    for name in ["twisty", "docks", "arm"] {
        let scene = Scene::find(name).unwrap();
        for step in ["5%", "3%"] {
            let alone = Request::new("rrt-connect").set("step", step).set("balance", 1);
            let alone = scene.plan(&alone).unwrap();
            let auto = scene.plan(&Request::default().set("step", step)).unwrap();
            assert_eq!(auto.won.as_deref(), Some("rrt-connect balance=1"));
            assert_eq!(
                (auto.fingerprint, auto.collision_checks),
                (alone.fingerprint, alone.collision_checks)
            );
        }
    }
}

#[test]
fn all_have_turns_and_paths_are_repeated() {
    let mut winners = std::collections::BTreeSet::new();
    for name in ["twisty", "cubicles", "gempa-3"] {
        let scene = Scene::find(name).unwrap();
        for seed in 1..=4 {
            let report = in_turns(&scene, seed, 20);
            assert_eq!(report.clone().without_times(), in_turns(&scene, seed, 20).without_times());
            winners.extend(report.won);
            let rows = report.path.unwrap();
            let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
            assert!(scene.check(&path).unwrap().free, "{name} {seed}");
        }
    }
    assert!(winners.len() >= 3, "{winners:?}");
    assert!(winners.iter().any(|won| won.contains('=')), "{winners:?}");
}

/// In the plane and for arms some of the searches are missing.
#[test]
fn robots_that_cannot_do_all_have_the_rest() {
    for name in ["docks", "arm", "rrs-high", "maze"] {
        let scene = Scene::find(name).unwrap();
        let report = in_turns(&scene, 3, 20);
        assert!(report.solved && report.won.is_some(), "{name}: {:?}", report.why);
    }
}

#[test]
fn settings_are_those_of_the_first_search_and_others_are_refused() {
    let scene = Scene::find("easy").unwrap();
    for (name, value) in [("turn", "many"), ("step", "far"), ("slides", "3")] {
        let error = scene.plan(&Request::new("auto").set(name, value)).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
    let budget = Request::new("auto").set("turn", 10).iterations(50).set("step", "0.001%");
    let report = Scene::find("twisty").unwrap().plan(&budget).unwrap();
    assert_eq!((report.iterations, report.won), (50, None));
}
