//! Robots that move by inputs, among obstacles that move, and goals that leave something free: beside a second computation.

use mp_control::{Car, DoubleIntegrator, Flow};
use mp_cspace::{Rn, Rng, Se2State};
use mp_plan::{Finish, PathRows, Request, Scene};
use nalgebra::Vector2;
use rand::RngExt;
use std::f64::consts::TAU;

fn path(scene: &Scene, rows: Vec<Vec<f64>>) -> PathRows {
    PathRows { format: scene.path_format(), columns: scene.columns(), rows }
}

/// Whether the robot touches something at any of many moments along inputs that are held one after the other; `at` gives the
/// row after a part of the last input.
fn touches(scene: &Scene, moments: impl IntoIterator<Item = Vec<f64>>) -> bool {
    moments.into_iter().any(|row| !scene.explain(&row).unwrap().touching.is_empty())
}

/// Random inputs of a car: what the scene finds free touches nothing, and what touches something is not free.
#[test]
fn a_car_is_where_its_inputs_lead() {
    let scene = Scene::find("parking").unwrap();
    let car = Car::new(2.5).unwrap();
    let (mut rng, mut free, mut hit) = (Rng::seed(5), 0, 0);
    for _ in 0..60 {
        let mut q = Se2State::new(3.0, 5.5, 0.0);
        let mut rows = vec![scene.start()];
        let mut moments = Vec::new();
        for _ in 0..rng.random_range(6..40) {
            let speed = if rng.random_range(0..4) > 0 { 2.0 } else { -1.0 };
            let input = [speed, rng.random_range(-0.46..0.3)];
            let duration = rng.random_range(0.2..0.5);
            for i in 0..=60 {
                let p = car.integrate(&q, &input, duration * f64::from(i) / 60.0);
                moments.push(vec![p.translation.x, p.translation.y, p.angle, 0.0, 0.0, 0.0]);
            }
            q = car.integrate(&q, &input, duration);
            rows.push(vec![q.translation.x, q.translation.y, q.angle, input[0], input[1], duration]);
        }
        let verdict = scene.check(&path(&scene, rows)).unwrap();
        // The car seldom ends where it should.
        let faults: Vec<_> =
            verdict.faults.iter().filter(|fault| !fault.starts_with("does not end")).collect();
        let touched = touches(&scene, moments);
        assert!(!(touched && faults.is_empty()), "{verdict:?}");
        assert!(faults.iter().all(|fault| !fault.contains("input")), "{verdict:?}");
        free += usize::from(faults.is_empty());
        hit += usize::from(touched);
    }
    assert!(free > 10 && hit > 10, "{free} {hit}");
}

#[test]
fn a_puck_is_where_its_accelerations_lead() {
    let scene = Scene::find("accelerations").unwrap();
    let plane = Rn::<2>::new([0.0; 2], [4.0, 3.0]).unwrap();
    let system = DoubleIntegrator::new(&plane).unwrap();
    let mut rng = Rng::seed(6);
    let (mut free, mut hit) = (0, 0);
    for _ in 0..80 {
        let mut state = (Vector2::new(0.4, 0.4), Vector2::zeros());
        let mut rows = vec![scene.start()];
        let mut moments = Vec::new();
        for _ in 0..rng.random_range(2..10) {
            let input = Vector2::new(rng.random_range(-0.3..0.8), rng.random_range(-0.3..0.8));
            for i in 0..=60 {
                let (q, _) = system.integrate(&state, &input, 0.4 * f64::from(i) / 60.0);
                moments.push(vec![q.x, q.y, 0.0, 0.0, 0.0, 0.0, 0.0]);
            }
            state = system.integrate(&state, &input, 0.4);
            let (q, v) = state;
            rows.push(vec![q.x, q.y, v.x, v.y, input.x, input.y, 0.4]);
        }
        let fast = rows.iter().any(|row| row[2].abs().max(row[3].abs()) > 1.0);
        let verdict = scene.check(&path(&scene, rows)).unwrap();
        let faults: Vec<_> =
            verdict.faults.iter().filter(|fault| !fault.starts_with("does not end")).collect();
        let touched = touches(&scene, moments);
        assert!(!((touched || fast) && faults.is_empty()), "{verdict:?}");
        free += usize::from(faults.is_empty());
        hit += usize::from(touched);
    }
    assert!(free > 10 && hit > 10, "{free} {hit}");
}

#[test]
fn paths_touch_nothing_at_any_moment() {
    for name in
        ["crossing", "blade", "parking", "unicycle", "velocities", "accelerations", "warehouse", "flyer"]
    {
        let scene = Scene::find(name).unwrap();
        let report = scene.plan(&Request::new(scene.default_planner()).seed(9)).unwrap();
        let rows = report.path.unwrap_or_else(|| panic!("{name}: {:?}", report.why));
        let track = scene.track(&path(&scene, rows)).unwrap();
        assert!(track.rows.len() > 50 && track.clearance.iter().all(|c| *c > 0.0), "{name}");
        assert!(!touches(&scene, track.rows), "{name}");
    }
}

/// Front ends move start and goal: the kind of goal stays.
#[test]
fn ends_can_be_moved() {
    let scene = Scene::find("velocities").unwrap();
    let mut goal = scene.goals().remove(0);
    (goal[0], goal[1]) = (4.0, 0.8);
    let moved = scene.with_ends(&[0.9, 3.4, 0.1, 0.0, 0.0, 0.0, 0.0], &[goal]).unwrap();
    let report = moved.plan(&Request::new("rsrt").seed(2)).unwrap();
    let rows = report.path.unwrap();
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert_eq!(first[..3], [0.9, 3.4, 0.1]);
    assert!(
        (last[0] - 4.0).abs() <= 0.15 && (last[1] - 0.8).abs() <= 0.15 && last[2].abs() <= 0.15,
        "{last:?}"
    );

    let scene = Scene::find("crossing").unwrap();
    let moved = scene.with_ends(&[3.0, 1.0, 0.0], &[vec![9.0, 9.0, 30.0]]).unwrap();
    let rows = moved.plan(&Request::new("rrt")).unwrap().path.unwrap();
    assert_eq!((rows[0][..2].to_vec(), rows[rows.len() - 1][..2].to_vec()), (vec![3.0, 1.0], vec![9.0, 9.0]));
}

/// The lines of a file say nothing about other ends than its own.
#[test]
fn ends_that_were_moved_have_no_place_in_the_file() {
    for (name, goal) in [("rrs-corridor", vec![-99.0, 0.0, 0.0]), ("crossing", vec![3.0, 99.0, 0.0])] {
        let scene = Scene::find(name).unwrap();
        let width = scene.start().len();
        let error =
            scene.with_ends(&scene.start(), &[goal[..width].to_vec()]).unwrap().check_ends().unwrap_err();
        assert!(
            error.to_string().contains("the goal is") && !error.to_string().contains(".toml:"),
            "{error}"
        );
    }
}

/// What is said of planners that cannot plan for a robot is true, and so is which others can.
#[test]
fn planners_that_cannot_plan_are_known_before() {
    for name in ["easy", "rrs-corridor", "crossing", "parking", "arm", "wrench"] {
        let scene = Scene::find(name).unwrap();
        let cannot: Vec<_> = scene.planners_that_cannot().into_iter().map(|(name, _)| name).collect();
        for planner in mp_plan::planners().map(|info| info.name) {
            let report = scene.plan(&Request::new(planner).iterations(1));
            assert_eq!(report.is_err(), cannot.contains(&planner), "{name}, {planner}: {report:?}");
            let Err(error) = report else { continue };
            let (_, others) =
                error.remedy().and_then(|help| help.split_once("take one of: ")).expect(planner);
            let others: Vec<_> = others.split(", ").collect();
            assert!(!others.is_empty() && others.iter().all(|other| !cannot.contains(other)), "{others:?}");
        }
    }
    // It prefers states of low cost, whatever these are.
    let costs = Request::new("t-rrt").iterations(1).objective("clearance".parse().unwrap());
    let scene = Scene::find("crossing").unwrap();
    assert!(scene.plan(&costs).is_ok() && scene.plan(&Request::new("t-rrt").iterations(1)).is_err());
}

/// Each goal of a set is reached when it is the only one that can be.
#[test]
fn any_goal_of_a_set_will_do() {
    let scene = Scene::find("docks").unwrap();
    let mut ends = [0; 4];
    for seed in 1..=12 {
        let rows = scene.plan(&Request::new("rrt").seed(seed)).unwrap().path.unwrap();
        let end = rows[rows.len() - 1].clone();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        // Angles go on over whole turns.
        let turn = |yaw: f64| (yaw / TAU - (yaw / TAU).round()).abs() * TAU;
        let which = match end[..] {
            [x, y, yaw] if near(x, 5.4) && near(y, 0.5) && turn(yaw) < 1e-9 => 0,
            [x, y, yaw] if near(x, 5.4) && near(y, 1.2) && turn(yaw) < 1e-9 => 1,
            [x, y, _] if near(x, 5.4) && near(y, 3.5) => 2,
            [x, y, yaw] if (2.5..=4.0).contains(&x) && near(y, 3.6) && turn(yaw) <= 0.1 + 1e-9 => 3,
            _ => panic!("no goal: {end:?}"),
        };
        ends[which] += 1;
    }
    assert!(ends.iter().filter(|n| **n > 0).count() > 1, "{ends:?}");
}

/// Measured velocities are as far off as other numbers.
#[test]
fn a_start_velocity_a_hair_beyond_its_limit_is_at_the_limit() {
    let puck = |speed: f64| {
        let text = format!(
            "[world]\nwalls = [[0, 0], [20, 10]]\nbounds = [[1, 1], [19, 9]]\n[robot]\nkind = \"accelerations\"\ndisc = 0.1\n\
             speeds = [1, 2]\naccelerations = [1, 1]\nduration = 1\n[motion]\nstart = [5, 5, 0.5, {speed:?}]\n\
             goal = {{ x = [6, 10], y = [5, 8] }}\n"
        );
        Scene::parse("puck", &text, std::path::Path::new("")).unwrap()
    };
    for (speed, at) in [(2.000_001, 2.0), (-2.000_001, -2.0), (1.999_999, 1.999_999)] {
        let scene = puck(speed);
        assert_eq!(scene.start()[2..4], [0.5, at]);
        scene.check_ends().unwrap();
    }
    assert!(puck(2.001).check_ends().is_err());
}

/// A curve that is in bounds at both ends and in its middle, but leaves them by a hair in between, is refused.
#[test]
fn curves_stay_in_bounds_between_their_ends() {
    // x = 9 + v t - t²/2 is greatest at t = v, which is no moment that halving finds.
    let puck = |speed: f64| {
        let text = format!(
            "[world]\nwalls = [[0, 0], [20, 10]]\nbounds = [[1, 1], [10, 9]]\n[robot]\nkind = \"accelerations\"\ndisc = 0.1\n\
             speeds = [4, 4]\naccelerations = [1, 1]\nduration = 4\n[motion]\nstart = [9, 5, {speed:?}, 0]\n\
             goal = {{ x = [5, 10], y = [4, 6] }}\n"
        );
        let scene = Scene::parse("puck", &text, std::path::Path::new("")).unwrap();
        let end = vec![9.0 + 3.3 * speed - 0.5 * 3.3 * 3.3, 5.0, speed - 3.3, 0.0, -1.0, 0.0, 3.3];
        let rows = vec![scene.start(), end];
        scene.check(&path(&scene, rows)).unwrap()
    };
    let most = f64::sqrt(2.0);
    assert!(puck(most - 1e-6).free);
    let outside = puck(most + 1e-6);
    assert!(!outside.free, "{outside:?}");
    // A unicycle on a circle of radius one about (9, 5): its rightmost place is (10, 5).
    let unicycle = |bound: f64| {
        let text = format!(
            "[world]\nwalls = [[0, 0], [20, 10]]\nbounds = [[1, 1], [{bound:?}, 9]]\n[robot]\nkind = \"unicycle\"\ndisc = 0.1\n\
             speed = 1\nturning = 1\nduration = 3\n[motion]\nstart = [9.5, {:?}, {:?}]\ngoal = {{ x = [5, 10] }}\n",
            5.0 - 0.75_f64.sqrt(),
            std::f64::consts::FRAC_PI_6
        );
        let scene = Scene::parse("unicycle", &text, std::path::Path::new("")).unwrap();
        let car = |t: f64| {
            mp_control::Unicycle.integrate(
                &Se2State::new(9.5, 5.0 - 0.75_f64.sqrt(), std::f64::consts::FRAC_PI_6),
                &[1.0, 1.0],
                t,
            )
        };
        let end = car(2.9);
        let rows = vec![scene.start(), vec![end.translation.x, end.translation.y, end.angle, 1.0, 1.0, 2.9]];
        scene.check(&path(&scene, rows)).unwrap()
    };
    assert!(unicycle(10.0 + 1e-6).free);
    assert!(!unicycle(10.0 - 1e-6).free);
}

/// Among obstacles that move too, a path of a mesh in the plane may not leave it.
#[test]
fn meshes_in_the_plane_stay_there_among_obstacles_that_move() {
    let text = "[robot]\nbox = [0.5, 0.5, 0.5]\nplanar = true\nbounds = [[-5, -5, -1], [5, 5, 1]]\n[motion]\nstart = [-4, 0, 0]\n\
                goal = [4, 0, 0]\nspeed = 2\n[[moving]]\nbox = [1, 1, 1]\npath = [[0, 0, 4, 0], [5, 0, 3, 0]]\n";
    let scene = Scene::parse("flat", text, std::path::Path::new("")).unwrap();
    let rows = |z: f64| {
        vec![
            vec![-4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            vec![0.0, 0.0, z, 0.0, 0.0, 0.0, 4.0],
            vec![4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0],
        ]
    };
    let verdict = |z: f64| scene.check(&path(&scene, rows(z))).unwrap();
    assert!(verdict(0.0).free, "{:?}", verdict(0.0));
    assert!(verdict(0.5).faults.concat().contains("leaves the plane"), "{:?}", verdict(0.5));
}

/// A goal is as near for a robot that is as good as free of limits of speed and time.
#[test]
fn goals_among_obstacles_that_move_are_reached_however_long_there_is_time() {
    let world = |speed: f64, horizon: f64| {
        let text = format!(
            "[world]\nwalls = [[0, 0], [4, 4]]\n[robot]\ndisc = 0.1\n[motion]\nstart = [1, 1]\ngoal = [3, 3]\nspeed = {speed:?}\n\
             horizon = {horizon:?}\n[[moving]]\nrectangle = [[-0.2, -0.2], [0.2, 0.2]]\npath = [[0, 2, 3.5], [5, 2, 0.5]]\n"
        );
        Scene::parse("long", &text, std::path::Path::new("")).unwrap()
    };
    for (speed, horizon) in [(1.0, 10.0), (9e8, 10.0), (1.0, 1e7), (1.0, 9e8), (9e8, 9e8)] {
        let scene = world(speed, horizon);
        let report = scene.plan(&Request::new("rrt").iterations(3_000)).unwrap();
        let Some(rows) = report.path else { continue };
        let verdict = scene.check(&path(&scene, rows)).unwrap();
        assert!(verdict.free, "speed {speed}, horizon {horizon}: {verdict:?}");
    }
}

/// A configuration beside the plane is not the one below it: it is out of bounds, and no end.
#[test]
fn configurations_of_a_body_in_the_plane_are_in_it() {
    let text = "[robot]\nbox = [0.5, 0.5, 0.5]\nplanar = true\nbounds = [[-5, -5, -1], [5, 5, 1]]\n[motion]\nstart = [-4, 0, 0]\n\
                goal = [4, 0, 0]\n[[obstacle]]\nbox = [1, 1, 1]\n";
    let scene = Scene::parse("flat", text, std::path::Path::new("")).unwrap();
    assert!(scene.explain(&[3.0, 0.0, 0.0, 1.0, 0.0, 0.0]).unwrap().free);
    for beside in
        [[3.0, 0.0, 0.5, 1.0, 0.0, 0.0], [3.0, 0.0, 0.0, 1.0, 0.1, 0.0], [3.0, 0.0, 0.0, 1.0, 0.0, 0.1]]
    {
        let told = scene.explain(&beside).unwrap();
        assert!(
            !told.free && !told.in_bounds && told.fault.unwrap().contains("leaves the plane"),
            "{beside:?}"
        );
        assert!(told.nearest_free.is_some_and(|near| scene.explain(&near).unwrap().free), "{beside:?}");
        let refused = scene.with_ends(&beside, &scene.goals()).unwrap_err().to_string();
        assert!(refused.contains("the start leaves the plane"), "{refused}");
        let refused = scene.with_ends(&scene.start(), &[beside.to_vec()]).unwrap_err().to_string();
        assert!(refused.contains("the goal leaves the plane"), "{refused}");
    }
}

/// What is out of bounds says in which number, and what that may be; a file without bounds, that they were taken.
#[test]
fn out_of_bounds_names_the_number_and_its_limits() {
    let told = |text: &str, at: &[f64]| {
        let scene = Scene::parse("box", text, std::path::Path::new("")).unwrap();
        let mut roadmap = scene.roadmap(&Request::new("prm").nodes(1)).unwrap();
        let error = roadmap.query(at, &scene.goals()[0]).unwrap_err();
        [scene.explain(at).unwrap().fault.unwrap(), error.to_string(), error.remedy().unwrap().to_owned()]
    };
    let body = "[robot]\nbox = [0.5, 0.5, 0.5]\nbounds = [[-5, -5, -1], [5, 2.5, 1]]\n[motion]\nstart = [-4, 0, 0, 0, 0, 0]\n\
                goal = [4, 0, 0, 0, 0, 0]\n[[obstacle]]\nbox = [1, 1, 1]\n";
    let [fault, error, remedy] = told(body, &[0.0, 3.0, 4.0, 0.0, 0.0, 0.0]);
    assert_eq!(fault, "out of bounds: 0 3 4 0 0 0; y may be from -5 to 2.5");
    assert!(error.contains(&format!("the start is {fault}")), "{error}");
    assert_eq!(remedy, "move it, or widen the bounds");
    let open = body.replace("bounds = [[-5, -5, -1], [5, 2.5, 1]]\n", "");
    let [fault, _, remedy] = told(&open, &[0.0, 30.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(
        fault.contains("; y may be from -") && remedy.contains("give the problem bounds"),
        "{fault} {remedy}"
    );
    let plane =
        "[world]\nwalls = [[0, 0], [6, 4]]\n[robot]\ndisc = 0.3\n[motion]\nstart = [1, 1]\ngoal = [5, 3]\n";
    let [fault, ..] = told(plane, &[2.0, 4.5]);
    assert_eq!(fault, "out of bounds: [2, 4.5]; y may be from 0 to 4");
}

/// An input may turn a robot by more than half a turn: headings go on as far as it does, not by the shorter way.
#[test]
fn headings_turn_as_far_as_inputs_do() {
    let text = |drive: &str| {
        format!(
            "[world]\nwalls = [[0, 0], [8, 6]]\n[robot]\npolygon = [[-0.3, -0.1], [0.3, -0.1], [0.3, 0.1], [-0.3, 0.1]]\nduration = 3\n{drive}\n\
             [motion]\nstart = [1, 3, -10]\ngoal = {{ x = 6, y = 3 }}\ntolerance = 0.4\n"
        )
    };
    for drive in [
        "kind = \"unicycle\"\nspeed = 1\nturning = 1.4",
        "kind = \"car\"\nspeed = 1\nwheelbase = 0.3\nsteering = 0.4",
        "kind = \"velocities\"\nspeeds = [1, 1, 1.4]",
        "kind = \"accelerations\"\nspeeds = [1, 1, 2]\naccelerations = [0.3, 0.3, 0.6]",
    ] {
        let scene = Scene::parse("headings", &text(drive), std::path::Path::new("")).unwrap();
        let mut most = 0.0_f64;
        for seed in 1..9 {
            let request = Request { finish: Finish::AsFound, ..Request::new("rsrt").seed(seed) };
            let rows = scene.plan(&request).unwrap().path.unwrap();
            assert_eq!(rows[0][2], -10.0);
            for pair in rows.windows(2) {
                let (inputs, held) = (&pair[1][3..], pair[1][pair[1].len() - 1]);
                let by = match drive.split('"').nth(1) {
                    Some("car") => inputs[0] * mp_math::tan(inputs[1]) / 0.3 * held,
                    Some("unicycle") => inputs[1] * held,
                    Some("velocities") => inputs[2] * held,
                    _ => pair[0][5] * held + inputs[5] * held * held / 2.0,
                };
                assert!((pair[1][2] - pair[0][2] - by).abs() < 1e-9, "{drive}, seed {seed}: {pair:?}");
                most = most.max(by.abs());
            }
            assert!(scene.check(&path(&scene, rows)).unwrap().free);
        }
        assert!(most > TAU / 2.0, "{drive}: {most}");
    }
}

/// Also where the world is as good as without an end, a path is where its inputs lead.
#[test]
fn inputs_lead_as_exactly_in_a_large_world() {
    for size in [5.0, 1e8] {
        let text = format!(
            "[world]\nwalls = [[-{size:?}, -{size:?}], [{size:?}, {size:?}]]\n[robot]\ndisc = 0.1\nkind = \"velocities\"\nspeeds = [1, 1]\n\
             duration = 1\n[motion]\nstart = [0, 0]\ngoal = {{ x = [1.9, 2.1] }}\n"
        );
        let scene = Scene::parse("large", &text, std::path::Path::new("")).unwrap();
        let free = |y: f64| {
            let rows = vec![[0.0; 5].to_vec(), vec![1.0, y, 1.0, 0.0, 1.0], vec![2.0, y, 1.0, 0.0, 1.0]];
            scene.check(&path(&scene, rows)).unwrap().free
        };
        assert!(free(0.0) && !free(1e-3), "{size}");
    }
}

/// How far from the goal a path may end is a part of the world, where that is small.
#[test]
fn paths_end_at_the_goal_in_worlds_of_a_millimetre_too() {
    for (size, angle) in [(1.0, false), (1e-4, false), (1e-6, false), (1.0, true), (1e-4, true)] {
        let [small, far, wide] = [0.1, 3.0, 4.0].map(|times| times * size);
        let (robot, zero) = match angle {
            false => (format!("disc = {small:?}"), ""),
            true => (format!("polygon = [[0, 0], [{small:?}, 0], [0, {small:?}]]"), ", 0"),
        };
        let text = format!(
            "[world]\nwalls = [[0, 0], [{wide:?}, {wide:?}]]\n[robot]\n{robot}\n[motion]\nstart = [{size:?}, {size:?}{zero}]\n\
             goals = [[{size:?}, {far:?}{zero}], [{far:?}, {size:?}{zero}]]\n"
        );
        let scene = Scene::parse("small", &text, std::path::Path::new("")).unwrap();
        let free = |x: f64| {
            let row = |x: f64| [&[x, size][..], &[0.0][..usize::from(angle)]].concat();
            scene.check(&path(&scene, vec![row(size), row(x * size)])).unwrap().free
        };
        assert!(free(3.0) && free(3.0001) && !free(2.9) && !free(1.5), "{size} {angle}");
    }
}
