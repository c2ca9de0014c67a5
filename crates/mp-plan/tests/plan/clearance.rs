//! Paths that keep a clearance from obstacles, for each kind of robot.

use mp_cspace::Length;
use mp_plan::{Constraint, Interrupt, MotionValidator, PathRows, Request, Scene};

/// Scenes, each with a clearance (m) that its ends have.
const SCENES: [(&str, f64); 9] = [
    ("cubicles", 0.5),
    ("arm", 0.03),
    ("gempa-2", 0.1),
    ("docks", 0.015),
    ("rrs-low", 0.03),
    ("planar-bugtrap", 0.1),
    ("crossing", 0.1),
    ("velocities", 0.05),
    ("warehouse", 0.02),
];

fn request(scene: &Scene) -> Request {
    Request::new(scene.default_planner()).seed(1).iterations(50_000).sharp_clearance()
}

/// The path of a request, and the clearance of its report.
fn planned(scene: &Scene, request: &Request) -> (PathRows, f64) {
    let report = scene.plan(request).unwrap();
    assert!(report.solved, "{}: {:?}", scene.name(), report.why);
    let rows = report.path.unwrap();
    let clearance = report.clearance.unwrap();
    (PathRows { format: scene.path_format(), columns: scene.columns(), rows }, clearance)
}

#[test]
fn paths_keep_what_is_asked_for() {
    for (name, clearance) in SCENES {
        let scene = Scene::find(name).unwrap();
        let (path, known) = planned(&scene, &request(&scene).clearance(clearance));
        // Links of the arm may be nearer to each other.
        assert!(known >= clearance || name == "arm", "{name}: {known}");
        assert!(scene.keeping(clearance).unwrap().check(&path).unwrap().free, "{name}");
        // The verifier of the plain scene measures by itself.
        let verdict = scene.check(&path).unwrap();
        assert!(verdict.free && (verdict.clearance >= clearance || name == "arm"), "{name}: {verdict:?}");
        let certificate =
            scene.keeping(clearance).unwrap().certificate(&path, known, &Interrupt::never()).unwrap();
        assert!(certificate.clearance() >= Some(clearance.min(known)), "{name}");
    }
}

/// It is free one way alone.
#[test]
fn half_a_turn_of_a_body_is_said() {
    let body = "[robot]\nbox = [2, 0.1, 0.1]\n\n[motion]\nstart = [0, 0, 0, 0, 0, 0]\ngoal = [0, 0, 0, 3.141592653589793, 0, 0]\n\n\
        [[obstacle]]\nbox = [0.1, 0.1, 0.1]\npose = [9, 0, 0, 0, 0, 0]\n";
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("half.toml");
    std::fs::write(&file, body).unwrap();
    let scene = Scene::load(&file).unwrap();
    for (middle, odd) in [(None, true), (Some(1.5), false)] {
        let angles = [Some(0.0), middle, Some(std::f64::consts::PI)];
        let rows = angles.into_iter().flatten().map(|a| vec![0.0, 0.0, 0.0, a, 0.0, 0.0]).collect();
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        let verdict = scene.check(&path).unwrap();
        let said =
            verdict.warnings.concat().contains("between configurations 1 and 2 it turns half way round");
        assert!(verdict.free && said == odd, "{verdict:?}");
    }
}

/// It was said to come too near to contact, a thousand kilometres from it.
#[test]
fn a_motion_that_is_too_long_for_a_proof_is_said_to_be_so() {
    let far = "[robot]\nbox = [1e-3, 1e-3, 1e-3]\n\n[motion]\nstart = [-1e6, 0, 0, 0, 0, 0]\ngoal = [1e6, 0, 0, 0, 0, 0]\n\n\
        [[obstacle]]\nbox = [1, 1, 1]\npose = [0, 9, 0, 0, 0, 0]\n";
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("far.toml");
    std::fs::write(&file, far).unwrap();
    let scene = Scene::load(&file).unwrap();
    let rows = [-1e6, 1e6].map(|x| vec![x, 0.0, 0.0, 0.0, 0.0, 0.0]).to_vec();
    let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    let faults = scene.check(&path).unwrap().faults;
    assert!(faults[0].starts_with("cannot be proved free in one piece"), "{faults:?}");
}

#[test]
fn more_than_a_path_keeps_is_refused() {
    for (name, clearance) in SCENES.into_iter().filter(|(name, _)| *name != "arm") {
        let scene = Scene::find(name).unwrap();
        let (path, known) = planned(&scene, &request(&scene));
        assert!(known < clearance, "{name} keeps {known} unasked: choose more here");
        let verdict = scene.keeping(known + 2.0 * clearance).unwrap().check(&path).unwrap();
        let fault = verdict.faults.join(" ");
        assert!(!verdict.free && fault.contains("nearer to an obstacle than"), "{name}: {fault}");
        assert_eq!(verdict.clearance_kept, known + 2.0 * clearance);
    }
}

#[test]
fn sampled_motions_and_roadmaps_mind_it() {
    let scene = Scene::find("easy").unwrap();
    for planner in ["rrt-connect", "prm", "lazy-prm", "obprm", "rrs", "visibility-prm"] {
        for motion in [MotionValidator::Certified, "discrete:1%".parse().unwrap()] {
            let request = Request::new(planner).seed(3).iterations(20_000).clearance(0.1).motion(motion);
            let report = scene.plan(&request).unwrap();
            assert!(
                !report.solved || report.clearance >= Some(0.1),
                "{planner} {motion}: {:?}",
                report.clearance
            );
            assert!(report.solved || planner == "rrs", "{planner} {motion}: {:?}", report.why);
            assert_eq!(report.clearance_kept, 0.1);
        }
    }
}

/// What was blocked for a clearance may be free without one: guards and components would be other ones.
#[test]
fn a_roadmap_is_of_one_clearance() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("map");
    let scene = Scene::find("easy").unwrap();
    let grow = |clearance: f64| {
        let request = Request::new("visibility-prm").seed(1).iterations(300).clearance(clearance);
        scene.plan(&Request { roadmap: Some(file.clone()), ..request }).map(|report| report.nodes)
    };
    let kept = grow(0.1).unwrap();
    assert!(grow(0.1).unwrap() >= kept);
    for other in [0.0, 0.05] {
        assert!(grow(other).unwrap_err().report().contains("metric or clearance"), "{other}");
    }
}

#[test]
fn ends_too_near_are_said_with_what_is_near() {
    let scene = Scene::find("arm").unwrap();
    let error = scene.plan(&request(&scene).clearance(0.5)).unwrap_err().report();
    assert!(error.contains(" m from contact between ") && error.contains("must be kept"), "{error}");
    let scene = Scene::find("rrs-high").unwrap();
    let error = scene.plan(&request(&scene).clearance(0.2)).unwrap_err().report();
    assert!(error.contains("0.185 m from contact") && error.contains("nearest free"), "{error}");
}

/// Of the configurations that reach a place, one that does not keep the clearance, or a constraint, is no reason to refuse the others.
#[test]
fn a_place_is_reached_where_the_clearance_is_kept() {
    let scene = Scene::find("mobile-arm").unwrap();
    let (goals, kept) = (scene.goals(), scene.keeping(0.02).unwrap());
    let free: Vec<_> = goals.iter().filter(|q| kept.explain(q).unwrap().free).cloned().collect();
    assert!(free.len() > 10 && free.len() < goals.len(), "{}", free.len());
    assert_eq!(kept.goals(), free);
    assert!(kept.check_ends().is_ok(), "{:?}", kept.check_ends());
    let report = scene.plan(&request(&scene).clearance(0.02)).unwrap();
    assert!(report.solved && report.clearance_kept == 0.02, "{:?}", report.why);

    let mut turned: Vec<f64> = goals.iter().map(|q| q[8]).collect();
    turned.sort_by(f64::total_cmp);
    let most = turned[turned.len() / 2].max(scene.start()[8]);
    let rule = Constraint::new("turned", Length::Fraction(0.01), move |q: &[f64]| q[8] <= most);
    let under = scene.under(rule).unwrap();
    assert_eq!(under.goals(), goals.into_iter().filter(|q| q[8] <= most).collect::<Vec<_>>());
    assert!(under.goals().len() < turned.len() && under.check_ends().is_ok());
    // Where none is free, all are there to be explained.
    assert_eq!(scene.keeping(5.0).unwrap().goals().len(), turned.len());
}

#[test]
fn clearances_that_are_no_lengths_are_refused() {
    let scene = Scene::find("easy").unwrap();
    for clearance in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(scene.keeping(clearance).is_err());
        assert!(scene.plan(&request(&scene).clearance(clearance)).is_err());
    }
    let asked = request(&scene).clearance(0.1);
    assert!(scene.prepare(&asked).is_err(), "the scene keeps none");
    let kept = scene.for_request(&asked).unwrap();
    assert_eq!(kept.clearance_kept(), 0.1);
    assert!(kept.prepare(&asked).is_ok());
}

/// A request without a clearance plans with that of the scene, to the same bytes as with it.
#[test]
fn it_may_be_said_of_the_scene_or_of_the_request() {
    let scene = Scene::find("cubicles").unwrap();
    let asked = scene.plan(&request(&scene).clearance(0.3)).unwrap();
    let kept = scene.keeping(0.3).unwrap().plan(&request(&scene)).unwrap();
    assert_eq!(asked.without_times(), kept.without_times());
}

#[test]
fn the_sample_does_not_graze() {
    let scene = Scene::find("cubicles").unwrap();
    for seed in 1..=5 {
        let (_, clearance) = planned(&scene, &request(&scene).seed(seed));
        assert!(clearance > 0.01, "seed {seed}: {clearance}");
    }
}

/// Spheres are balls, not meshes around them: what passes between two of them with half a millimetre to spare is free, for a body and for the link of an
/// arm. A little nearer it is not.
#[test]
fn spheres_are_round() {
    let slide = r#"<robot name="r"><link name="base"/><link name="tip"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
        <joint name="j" type="prismatic"><parent link="base"/><child link="tip"/><axis xyz="1 0 0"/><limit lower="-0.8" upper="0.8"/></joint></robot>"#;
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("slide.urdf"), slide).unwrap();
    let body = "box = [0.2, 0.2, 0.2]\nbounds = [[-1, -1, -1], [1, 1, 1]]";
    let ends = "start = [-0.8, 0, 0, 0, 0, 0]\ngoal = [0.8, 0, 0, 0, 0, 0]";
    for (robot, ends) in [(body, ends), ("urdf = \"slide.urdf\"", "start = [-0.8]\ngoal = [0.8]")] {
        let verdict = |half: f64| {
            let sphere = |y: f64| format!("[[obstacle]]\nsphere = 0.4\npose = [0, {y}, 0, 0.3, 0.2, 0.1]\n");
            let spheres = [half, -half].map(sphere).concat();
            let file = dir.path().join("scene.toml");
            std::fs::write(&file, format!("[robot]\n{robot}\n[motion]\n{ends}\n{spheres}")).unwrap();
            let scene = Scene::load(&file).unwrap();
            let rows = vec![scene.start(), scene.goals().remove(0)];
            scene.check(&PathRows { format: scene.path_format(), columns: scene.columns(), rows }).unwrap()
        };
        let free = verdict(0.5005);
        assert!(free.free && (1e-5..=5.01e-4).contains(&free.clearance), "{robot}: {free:?}");
        assert!(!verdict(0.4995).free, "{robot}");
    }
}
