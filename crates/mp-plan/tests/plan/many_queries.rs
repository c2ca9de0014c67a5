//! One roadmap of a scene, asked many times.

use mp_cspace::{Clock, Progress};
use mp_plan::{
    Budget, Cancel, Control, Interrupt, PathRows, RegionalWork, Report, Request, Scene, SceneRoadmap,
    StoppedBy, Watch,
};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Free configurations of a scene, by a walk over its limits that is the same every time.
fn free(scene: &Scene, count: usize) -> Vec<Vec<f64>> {
    let limits = scene.limits();
    let row = |i: usize| -> Vec<f64> {
        let of = |(k, range): (usize, &Option<[f64; 2]>)| {
            let [low, high] = range.unwrap_or([-3.1, 3.1]);
            // Steps that repeat late, other ones for each number.
            let t = (0.5 + i as f64 * (1.0 + k as f64).sqrt() * 0.754_877_666).fract();
            low + t * (high - low)
        };
        limits.iter().enumerate().map(of).collect()
    };
    let found: Vec<_> = (1..20_000)
        .map(row)
        .filter(|row| scene.explain(row).is_ok_and(|e| e.clearance > 0.02))
        .take(count)
        .collect();
    assert_eq!(found.len(), count, "{}", scene.name());
    found
}

/// The path goes from one to the other, and hits nothing on its way.
fn assert_free(scene: &Scene, report: &Report, start: &[f64], goal: &[f64]) {
    let rows = report.path.clone().unwrap();
    // By where it puts the bodies: numbers of a configuration may be whole turns apart.
    let near = |a: &[f64], b: &[f64]| {
        let [a, b] = [a, b].map(|row| scene.poses(row).unwrap());
        a.iter().zip(&b).all(|(a, b)| (a.to_homogeneous() - b.to_homogeneous()).amax() < 1e-6)
    };
    assert!(near(&rows[0], start) && near(&rows[rows.len() - 1], goal), "{start:?} {goal:?} {rows:?}");
    let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    // It is no path of the scene, whose own ends are elsewhere; but that is all that is wrong.
    let verdict = scene.check(&path).unwrap();
    assert!(verdict.faults.iter().all(|fault| fault.contains("does not")), "{:?}", verdict.faults);
    assert!(report.verified && report.clearance > Some(0.0));
}

fn fingerprints(roadmap: &mut SceneRoadmap, ends: &[Vec<f64>]) -> Vec<Option<String>> {
    ends.windows(2).map(|pair| roadmap.query(&pair[0], &pair[1]).unwrap().fingerprint).collect()
}

#[test]
fn queries_are_answered_in_scenes_of_every_kind() {
    for (name, planner, nodes) in [
        ("easy", "prm", 3_000),
        ("maze", "prm", 2_000),
        ("rrs-low", "visibility-prm", 100),
        ("arm", "prm", 500),
    ] {
        let scene = Scene::find(name).unwrap();
        let ends = free(&scene, 8);
        let request = Request::new(planner).seed(3).nodes(nodes).iterations(50_000);
        let mut roadmap = scene.roadmap(&request).unwrap();
        assert!(roadmap.nodes() > 0 && roadmap.nodes() <= nodes + 1 && roadmap.edges() > 0, "{roadmap:?}");
        let mut solved = 0;
        for pair in ends.windows(2) {
            let report = roadmap.query(&pair[0], &pair[1]).unwrap();
            assert_eq!((report.solved, report.why.is_some()), (report.path.is_some(), !report.solved));
            if report.solved {
                solved += 1;
                assert_free(&scene, &report, &pair[0], &pair[1]);
            }
        }
        assert!(solved >= 5, "{name}: {solved} of 7");
        // Asked again it says the same, and asks less, as it has learnt.
        let again = roadmap.query(&ends[0], &ends[1]).unwrap();
        let new = scene.roadmap(&request.clone().threads(2)).unwrap().query(&ends[0], &ends[1]).unwrap();
        assert_eq!(again.fingerprint, new.fingerprint, "{name}");
        let all = fingerprints(&mut roadmap, &ends);
        roadmap.verify().unwrap();
        assert_eq!(fingerprints(&mut roadmap, &ends), all, "{name}");
    }
}

#[test]
fn a_roadmap_grows_and_is_kept() {
    let scene = Scene::find("easy").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("map");
    let mut request = Request::new("prm").seed(5).nodes(50);
    let mut roadmap = scene.roadmap(&request).unwrap();
    assert_eq!(roadmap.nodes(), 50);
    let more = Budget { nodes: Some(120), ..Budget::default() };
    roadmap.grow(more, &mut Control::default()).unwrap();
    assert_eq!(roadmap.nodes(), 120);
    roadmap.save(&file).unwrap();
    request.roadmap = Some(file.clone());
    let mut read = scene.roadmap(&request).unwrap();
    assert_eq!((read.nodes(), read.edges()), (120, roadmap.edges()));
    assert_eq!(read.components(), roadmap.components());
    let ends = free(&scene, 4);
    assert_eq!(fingerprints(&mut read, &ends), fingerprints(&mut roadmap, &ends));
    // A planner that goes on with the file has those nodes, and its own two ends.
    request.budget = Budget { iterations: Some(20_000), ..Budget::default() };
    let report = scene.plan(&request).unwrap();
    assert!(report.solved && report.nodes >= 122, "{}", report.nodes);
}

/// Sizes of the file of a roadmap while it grows.
struct Sizes(PathBuf, Vec<u64>);

impl Watch for Sizes {
    fn progress(&mut self, _: &Progress) {
        if let Ok(meta) = std::fs::metadata(&self.0)
            && self.1.last() != Some(&meta.len())
        {
            self.1.push(meta.len());
        }
    }
}

/// The file is written again and again while the roadmap grows, and nothing else depends on it.
#[test]
fn checkpoints_change_nothing_but_the_file() {
    /// Every reading is 50 ms after the one before.
    fn now() -> Duration {
        static READINGS: AtomicU64 = AtomicU64::new(0);
        Duration::from_millis(50 * READINGS.fetch_add(1, Ordering::Relaxed))
    }
    let scene = Scene::find("easy").unwrap();
    let folder = tempfile::tempdir().unwrap();
    for planner in ["prm", "lazy-prm", "visibility-prm"] {
        for threads in [1, 3] {
            let budget = Budget { time_s: None, iterations: Some(4_000), ..Budget::default() };
            let request = Request { budget, ..Request::new(planner).seed(5).threads(threads) };
            let file = folder.path().join(format!("new/{planner}-{threads}"));
            let kept = Request { roadmap: Some(file.clone()), ..request.clone() };
            let mut sizes = Sizes(file.clone(), Vec::new());
            let mut control =
                Control { clock: Clock::new(now), ..Control::new(Default::default(), &mut sizes) };
            let built = scene.roadmap_with(&kept, &mut control).unwrap();
            assert!(sizes.1.len() > 3 && sizes.1.is_sorted(), "{planner}: {:?}", sizes.1);
            let plain = scene.roadmap(&request).unwrap();
            plain.save(folder.path().join("plain")).unwrap();
            let plain_bytes = std::fs::read(folder.path().join("plain")).unwrap();
            assert!(std::fs::read(&file).unwrap() == plain_bytes, "{planner}: {built:?} {plain:?}");
            // The same while a path is planned.
            std::fs::remove_file(&file).unwrap();
            let mut sizes = Sizes(file, Vec::new());
            let mut control =
                Control { clock: Clock::new(now), ..Control::new(Default::default(), &mut sizes) };
            let report = scene.plan_with(&kept, &mut control).unwrap();
            let plain = scene.plan(&request).unwrap();
            let counts = |r: &Report| {
                (r.iterations, r.nodes, r.motion_checks, r.collision_checks, r.fingerprint.clone())
            };
            assert_eq!(counts(&report), counts(&plain), "{planner}");
        }
    }
    let left: Vec<_> = std::fs::read_dir(folder.path().join("new")).unwrap().collect();
    assert!(left.len() <= 6 || cfg!(not(unix)), "{left:?}");
}

#[test]
fn a_roadmap_in_use_is_refused() {
    let scene = Scene::find("easy").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("map");
    let mut request = Request::new("prm").nodes(50);
    let roadmap = scene.roadmap(&request).unwrap();
    let lock = mp_store::Lock::of_file(&file).unwrap();
    request.roadmap = Some(file.clone());
    for refused in
        [scene.roadmap(&request).map(|_| ()), roadmap.save(&file), scene.plan(&request).map(|_| ())]
    {
        let e = refused.unwrap_err();
        assert!(e.message().contains("in use") && e.remedy().unwrap().contains("wait"), "{e}");
    }
    drop(lock);
    roadmap.save(&file).unwrap();
    assert_eq!(scene.roadmap(&request).unwrap().nodes(), 50);
}

/// What threads prefetch in vain is not counted, so budgets of queries end runs at the same place too.
#[test]
fn counts_do_not_depend_on_threads() {
    for name in ["easy", "cubicles"] {
        let scene = Scene::find(name).unwrap();
        for info in mp_plan::roadmap_planners() {
            let counts = |threads, queries| {
                let budget = Budget { iterations: Some(700), queries, ..Budget::default() };
                let request = Request { budget, ..Request::new(info.name).seed(7).threads(threads) };
                let r = scene.plan(&request).unwrap();
                (r.iterations, r.nodes, r.motion_checks, r.collision_checks, r.stopped_by)
            };
            for queries in [None, Some(5_000)] {
                let one = counts(1, queries);
                assert!(one.3 > 0);
                for threads in [2, 5] {
                    assert_eq!(
                        counts(threads, queries),
                        one,
                        "{name}, {}, {threads} threads, {queries:?}",
                        info.name
                    );
                }
            }
        }
    }
}

#[test]
fn what_cannot_be_answered_says_why() {
    let scene = Scene::find("easy").unwrap();
    let ends = free(&scene, 2);
    let error = scene.roadmap(&Request::new("rrt-connect")).unwrap_err().to_string();
    assert!(error.contains("rrt-connect builds no roadmap"), "{error}");
    // Without nodes only a straight motion is found.
    let mut roadmap = scene.roadmap(&Request::new("prm").nodes(1)).unwrap();
    let report = roadmap.query(&scene.start(), &scene.goals()[0]).unwrap();
    assert_eq!((report.solved, report.stopped_by), (false, Some(StoppedBy::Unanswered)));
    assert!(report.why.unwrap().contains("roadmap"));
    // An end in collision: what it touches, and where it would be free.
    let inside = (0..).map(|i| [f64::from(i % 40) * 0.25 - 5.0, 0.0, f64::from(i / 40) * 0.1, 0.0, 0.0, 0.0]);
    let hits =
        inside.take(4_000).find(|row| scene.explain(row).is_ok_and(|e| !e.touching.is_empty())).unwrap();
    let error = roadmap.query(&ends[0], &hits).unwrap_err().to_string();
    assert!(error.contains("the goal is in collision with"), "{error}");
    let error = roadmap.query(&ends[0][1..], &ends[1]).unwrap_err().to_string();
    assert!(error.contains("finite numbers"), "{error}");
}

/// It owns all it needs: a thread may have it, when the scene is gone.
#[test]
fn it_outlives_the_scene() {
    let (mut roadmap, ends) = {
        let scene = Scene::find("easy").unwrap();
        (
            scene.roadmap(&Request::new("prm").seed(3).nodes(3_000)).unwrap(),
            [scene.start(), scene.goals().remove(0)],
        )
    };
    let solved = std::thread::spawn(move || roadmap.query(&ends[0], &ends[1]).unwrap().solved);
    assert!(solved.join().unwrap());
}

/// The start of the alpha puzzle is in a narrow place, which samples alone do not leave with so few motions.
#[test]
fn trees_from_the_ends_solve_the_alpha_puzzle() {
    let scene = Scene::find("alpha-1.5").unwrap();
    let solved = |ends: &str| {
        let request = |seed| {
            let mut request = Request::new("prm").seed(seed).set("ends", ends);
            request.budget = Budget { queries: Some(150_000), ..Budget::default() };
            request
        };
        (1..=4).filter(|&seed| scene.plan(&request(seed)).unwrap().verified).count()
    };
    assert_eq!([solved("0"), solved("0.5")], [0, 4]);
}

#[test]
fn work_by_regions_is_checked() {
    let scene = Scene::find("easy").unwrap();
    let refused = |request: &Request| scene.regions(request).map(|_| ()).unwrap_err();
    let e = refused(&Request::new("prm"));
    assert!(
        e.to_string().contains("prm builds no roadmap by regions")
            && e.remedy().unwrap().contains("regional-prm")
    );
    let e = refused(&Request::new("regional-prm").nodes(10));
    assert!(e.remedy().unwrap().contains("samples"), "{e}");
    let e = refused(&Request::new("regional-prm").set("regions", 0));
    assert!(e.to_string().contains("regions is 0"), "{e}");
    let request = Request::new("regional-prm").set("regions", 2).set("samples", 10);
    let work = scene.regions(&request).unwrap();
    assert_eq!((work.regions(), work.items(), work.pair(1), work.pair(2)), (2, 3, None, Some([0, 1])));
    let never = Interrupt::never();
    let built: Vec<_> = (0..2).map(|region| work.build(region, &never).unwrap()).collect();
    assert!(built.iter().all(|result| RegionalWork::tally(result).queries > 10));
    let connected = vec![work.connect(2, [&built[0], &built[1]], &never).unwrap()];
    assert!(work.finish(&built, &connected).is_ok());
    assert!(work.finish(&built[1..], &connected).is_err());
    let e = work.finish(&[connected.clone(), connected.clone()].concat(), &connected).unwrap_err();
    assert!(e.to_string().contains("not what it should be"), "{e}");
    assert!(work.connect(2, [&built[0], b"no"], &never).is_err());
    // What was interrupted has no result.
    let cancel = Cancel::new();
    cancel.cancel();
    assert!(work.build(0, &Interrupt::new(cancel)).is_err());
    let tally = RegionalWork::tally(&built[0]);
    assert!(tally.nodes > 0 && tally.edges < tally.nodes && tally.queries > tally.nodes, "{tally:?}");
    assert!(RegionalWork::estimate_pair([&built[0], &built[1]]) >= 2.0);
    let estimates = [0, 0].map(|region| work.estimate(region, &never).unwrap());
    assert!((1.0..=26.0).contains(&estimates[0]));
    assert_eq!(estimates[0], estimates[1]);
}

/// A roadmap by regions answers about what a roadmap of as many uniform samples does.
#[test]
fn regions_answer_what_uniform_samples_answer() {
    let mut tally = [[0; 2]; 2];
    for (i, (name, regions, samples)) in [("easy", 8, 150), ("maze", 9, 600)].into_iter().enumerate() {
        let scene = Scene::find(name).unwrap();
        let ends = free(&scene, 6);
        for seed in 1..=4 {
            let request =
                Request::new("regional-prm").seed(seed).set("regions", regions).set("samples", samples);
            let items = scene.regions(&request).unwrap().items();
            let by_regions = scene.roadmap(&request.iterations(items)).unwrap();
            let plain = Request::new("prm").seed(seed).set("expand", 0).nodes(by_regions.nodes());
            let plain = scene.roadmap(&plain).unwrap();
            for (of, mut roadmap) in tally[i].iter_mut().zip([by_regions, plain]) {
                *of += ends
                    .windows(2)
                    .filter(|pair| {
                        let report = roadmap.query(&pair[0], &pair[1]).unwrap();
                        if report.solved {
                            assert_free(&scene, &report, &pair[0], &pair[1]);
                        }
                        report.solved
                    })
                    .count();
            }
        }
    }
    for [by_regions, plain] in tally {
        assert!(by_regions >= 15 && by_regions + 2 >= plain, "by regions, plain: {tally:?} of 20");
    }
}
