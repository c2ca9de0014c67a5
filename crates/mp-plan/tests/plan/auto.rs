//! `auto`: searches that take turns.

use mp_plan::{Finish, MetricName, PathRows, Report, Request, Scene};

/// What comes of short turns.
fn in_turns(scene: &Scene, seed: u64, turn: u64) -> Report {
    scene.plan(&Request::new("auto").seed(seed).set("turn", turn)).unwrap()
}

#[test]
fn what_is_found_in_the_first_turn_is_the_path_of_balanced_rrt_connect() {
    let plain = (MetricName::Default, "rrt-connect balance=1");
    let scaled = (MetricName::Scaled, "rrt-connect balance=1 metric=scaled");
    for (name, (metric, won)) in [("twisty", plain), ("docks", plain), ("arm", scaled)] {
        let scene = Scene::find(name).unwrap();
        for step in ["5%", "3%"] {
            // Shortening goes by the metric of the request.
            let found = |request: Request| {
                let request = Request { finish: Finish::AsFound, ..request.set("step", step) };
                scene.plan(&request).unwrap()
            };
            let alone = found(Request::new("rrt-connect").metric(metric).set("balance", 1));
            let auto = found(Request::default());
            assert_eq!(auto.won.as_deref(), Some(won));
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

/// Its first search keeps a metric that is asked for.
#[test]
fn arms_have_searches_of_their_own() {
    let scene = Scene::find("arm-7").unwrap();
    let won = |metric| {
        let won = (1..=8).map(|seed| {
            let request = Request::new("auto").seed(seed).metric(metric).set("turn", 20);
            scene.plan(&request).unwrap().won.unwrap()
        });
        won.collect::<std::collections::BTreeSet<_>>()
    };
    let (scaled, asked) = (won(MetricName::Default), won(MetricName::Manhattan));
    assert!(scaled.contains("obrrt-connect balance=1 metric=scaled"), "{scaled:?}");
    assert!(scaled.iter().all(|won| !won.contains("step=0.3%") && !won.contains("prm")), "{scaled:?}");
    assert!(scaled.contains("rrt-connect balance=1 metric=scaled"), "{scaled:?}");
    assert!(asked.contains("rrt-connect balance=1"), "{asked:?}");
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
