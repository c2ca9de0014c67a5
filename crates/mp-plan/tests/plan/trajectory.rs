//! Paths with times: the curve is proved, looked at again by other means, and stretched back where it is not free.

use mp_cspace::{Clearance, Configuration, Length, Rng, Validity};
use mp_plan::{
    ArmScene, Cancel, Constraint, Interpolation, Interrupt, Knots, Pace, PathRows, Request, Scene, TimedPath,
    Trajectory, TrajectoryKind,
};
use rand::RngExt;

/// The shipped scenes of arms whose base stands still or drives, but for `shelf`: among its cloud of points planning alone takes longer than all of these.
const ARMS: [&str; 9] =
    ["arm", "arm-6", "arm-7", "mobile-arm", "humanoid", "tool-pose", "two-arms", "carry", "rsrt-arm-64"];

fn planned(scene: &Scene, seed: u64) -> PathRows {
    let report = scene.plan(&Request::default().seed(seed)).unwrap();
    assert!(report.solved, "{}: {:?}", scene.name(), report.why);
    PathRows { format: scene.path_format(), columns: scene.columns(), rows: report.path.unwrap() }
}

fn timed(scene: &Scene, path: &PathRows, pace: &Pace) -> TimedPath {
    scene.time(path, pace, &Interrupt::never()).unwrap_or_else(|e| panic!("{}: {e}", scene.name()))
}

/// Positions of a cubic trajectory every `step` seconds, by Hermite's basis, and its last point.
fn sampled(trajectory: &Trajectory, step: f64) -> Vec<Vec<f64>> {
    let Knots { times, positions, velocities, .. } = trajectory.knots();
    let (mut rows, mut piece) = (Vec::new(), 0);
    let last = times[times.len() - 1];
    for i in 0.. {
        let t = f64::from(i) * step;
        if t >= last {
            break;
        }
        while times[piece + 1] < t {
            piece += 1;
        }
        let h = times[piece + 1] - times[piece];
        let u = (t - times[piece]) / h;
        let w = 1.0 - u;
        let basis = [(1.0 + 2.0 * u) * w * w, u * w * w * h, u * u * (3.0 - 2.0 * u), -u * u * w * h];
        let value = |j: usize| {
            let ends = [
                positions[piece][j],
                velocities[piece][j],
                positions[piece + 1][j],
                velocities[piece + 1][j],
            ];
            basis.iter().zip(ends).map(|(b, x)| b * x).sum()
        };
        rows.push((0..positions[0].len()).map(value).collect());
    }
    rows.push(positions[positions.len() - 1].clone());
    rows
}

#[test]
fn trajectories_of_all_shipped_arms_are_proved() {
    for name in ARMS {
        let scene = Scene::find(name).unwrap();
        let path = planned(&scene, 1);
        let made = timed(&scene, &path, &Pace::default());
        let rows = sampled(&made.trajectory, 1e-3);
        // The chords of a thousandth of a second, by the verifier of straight motions.
        let chords = PathRows { rows: rows.clone(), ..path.clone() };
        let verdict = scene.check(&chords).unwrap();
        assert!(verdict.free, "{name}: {:?}", verdict.faults);
        // Limits, by differences; those that are not known are 1.
        for (joint, column) in scene.columns().iter().enumerate() {
            let q: Vec<f64> = rows[..rows.len() - 1].iter().map(|row| row[joint]).collect();
            let [velocity, acceleration] = rates(name, &column.name);
            let v = q.windows(2).map(|w| (w[1] - w[0]).abs() / 1e-3).fold(0.0, f64::max);
            let a = q.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs() / 1e-6).fold(0.0, f64::max);
            assert!(v <= velocity * 1.001 + 1e-9, "{name}: {v} of {velocity} of {}", column.name);
            assert!(a <= acceleration * 1.001 + 1e-6, "{name}: {a} of {acceleration} of {}", column.name);
        }
        let verdict = scene.check_trajectory(&made.trajectory, &Interrupt::never()).unwrap();
        assert!(verdict.free && verdict.clearance > 0.0, "{name}: {:?}", verdict.faults);
        let least = verdict.trajectory.unwrap().least_at.unwrap();
        let there = scene.explain(&made.trajectory.at(least).position).unwrap().clearance;
        assert!(
            there >= verdict.clearance && there <= verdict.clearance + 0.5 * there,
            "{name}: {there} {}",
            verdict.clearance
        );
        assert_eq!(timed(&scene, &path, &Pace::default()), made, "{name}");
        // All limits halved: velocities by two, so that it takes longer than before, but not more than twice as long.
        let slow = timed(&scene, &path, &Pace { velocity: 0.5, acceleration: 0.25, ..Pace::default() });
        let ratio = slow.trajectory.duration() / made.trajectory.duration();
        assert!((1.9..2.1).contains(&ratio), "{name}: {ratio}");
        // Stopping at each corner takes longer.
        let stops = timed(&scene, &path, &Pace { deviation: 0.0, ..Pace::default() });
        assert!(stops.trajectory.duration() >= made.trajectory.duration() && stops.tightened.is_empty());
    }
}

/// The limits of a joint of a shipped scene: velocities are those of the URDF.
fn rates(scene: &str, joint: &str) -> [f64; 2] {
    let file = format!("{}/../mp-scenes/assets/robots", env!("CARGO_MANIFEST_DIR"));
    let urdf = match scene {
        "arm" | "tool-pose" | "two-arms" | "carry" => "six",
        "rsrt-arm-64" => "rsrt-arm",
        other => other,
    };
    let text = std::fs::read_to_string(format!("{file}/{urdf}.urdf")).unwrap();
    let own = joint.rsplit('/').next().unwrap();
    let element = text.split("<joint ").find(|part| part.starts_with(&format!("name=\"{own}\"")));
    let element = element.map_or("", |part| part.split("</joint>").next().unwrap());
    let velocity = element.split("velocity=\"").nth(1).and_then(|rest| rest.split('"').next());
    [velocity.map_or(1.0, |v| v.parse().unwrap()), 1.0]
}

/// An arm of one joint that slides and one that turns past posts.
fn posts(posts: &str) -> Scene {
    crane("max_acceleration = { x = 2, y = 4 }", posts)
}

/// The same with limits as its problem says them.
fn crane(limits: &str, posts: &str) -> Scene {
    let urdf = "<robot name='crane'><link name='rail'/><link name='cart'/>\
        <link name='tip'><collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link>\
        <joint name='x' type='prismatic'><parent link='rail'/><child link='cart'/><axis xyz='1 0 0'/>\
        <limit lower='-3' upper='3' effort='1' velocity='1'/></joint>\
        <joint name='y' type='prismatic'><parent link='cart'/><child link='tip'/><axis xyz='0 1 0'/>\
        <limit lower='-3' upper='3' effort='1' velocity='2'/></joint></robot>";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("crane.urdf"), urdf).unwrap();
    let text = format!(
        "[robot]\nurdf = \"crane.urdf\"\n{limits}\n\n\
         [motion]\nstart = [0, 0]\ngoal = [1, 1]\n\n{posts}"
    );
    let file = folder.path().join("posts.toml");
    std::fs::write(&file, text).unwrap();
    Scene::load(&file).unwrap()
}

fn corner(scene: &Scene) -> PathRows {
    let rows = vec![vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 1.0]];
    PathRows { format: scene.path_format(), columns: scene.columns(), rows }
}

#[test]
fn corners_are_rounded_only_as_far_as_is_free() {
    let pace = Pace { deviation: 0.2, ..Pace::default() };
    let open = posts("");
    let made = timed(&open, &corner(&open), &pace);
    assert!(made.tightened.is_empty() && made.corners == 1 && made.notes.is_empty(), "{:?}", made.notes);
    // The least distance from the corner, in the middle of the parabola.
    let nearest = |made: &TimedPath| {
        let off = |row: &Vec<f64>| mp_math::hypot(row[0] - 1.0, row[1]);
        sampled(&made.trajectory, 1e-3).iter().map(off).fold(9.0, f64::min)
    };
    // Each line is long enough for half of what is allowed: a quarter of √2 times half of it.
    assert!((nearest(&made) - 0.25 * 0.5 * std::f64::consts::SQRT_2).abs() < 1e-3, "{}", nearest(&made));
    // A post inside of the corner: the path passes it by 2 cm, the rounded one would not.
    let post = |size: f64| {
        format!(
            "[[obstacle]]\nname = \"post\"\nbox = [{size}, {size}, 1]\nat = [{0}, {1}, 0]\n",
            0.93 - 0.5 * size,
            0.07 + 0.5 * size
        )
    };
    let near = posts(&post(0.2));
    let close = timed(&near, &corner(&near), &pace);
    assert_eq!((close.tightened.len(), close.tightened[0].configuration), (1, 2));
    assert!(close.tightened[0].deviation > 0.0 && nearest(&close) < nearest(&made));
    assert!(close.trajectory.duration() > made.trajectory.duration());
    assert!(
        close.summary().contains("1 of 1 corner rounded less, for the curve to be free: configuration 2 at"),
        "{}",
        close.summary()
    );
    // So near that it must stop there, at the corner itself.
    let touching = posts(&post(0.2).replace("at = [0.8", "at = [0.8499").replace(", 0.17,", ", 0.1501,"));
    let stops = timed(&touching, &corner(&touching), &pace);
    assert!(stops.tightened[0].deviation < 1e-3 && nearest(&stops) < 1e-3, "{:?}", stops.tightened);
    let chords = |scene: &Scene, made: &TimedPath| {
        let path = PathRows { rows: sampled(&made.trajectory, 1e-4), ..corner(scene) };
        scene.check(&path).unwrap()
    };
    for (scene, made) in [(&near, &close), (&touching, &stops)] {
        assert!(chords(scene, made).free);
        assert!(scene.check_trajectory(&made.trajectory, &Interrupt::never()).unwrap().free);
    }
    // What is free among nothing is refused among posts, at the time at which samples find it.
    for scene in [&near, &touching] {
        let verdict = scene.check_trajectory(&made.trajectory, &Interrupt::never()).unwrap();
        let time = verdict.trajectory.as_ref().unwrap().collides_at.unwrap();
        assert!(!verdict.free && verdict.faults[0].contains("hits tip in post"), "{:?}", verdict.faults);
        let free = |t: f64| scene.explain(&made.trajectory.at(t).position).unwrap().free;
        assert!(!free(time) && (0..1000).all(|i| free((time - 1e-3) * f64::from(i) / 1000.0)), "{time}");
        let verdict = chords(scene, &made);
        assert!(!verdict.free);
    }
    // Paths that are not free get no times.
    let wall = posts("[[obstacle]]\nname = \"wall\"\nbox = [0.1, 1, 1]\nat = [0.5, 0, 0]\n");
    let error = wall.time(&corner(&wall), &pace, &Interrupt::never()).unwrap_err();
    assert!(error.to_string().contains("the path is not free: hits tip in wall"), "{error}");
    let mut beyond = corner(&open);
    beyond.rows[1][0] = 9.0;
    let error = open.time(&beyond, &pace, &Interrupt::never()).unwrap_err();
    assert!(error.to_string().contains("the path is not free: configuration 2 is out of"), "{error}");
    let constraint = Constraint::new("low", Length::Fraction(0.01), |row: &[f64]| row[0] + row[1] < 3.0);
    assert_eq!(timed(&near.under(constraint).unwrap(), &corner(&near), &pace), close);
    // One that holds at the corner alone: it is not rounded at all.
    let constraint =
        Constraint::new("along", Length::Fraction(0.001), |row: &[f64]| row[1] < 1e-6 || row[0] > 1.0 - 1e-6);
    let along = timed(&open.under(constraint).unwrap(), &corner(&open), &pace);
    assert_eq!(along.tightened[0].deviation, 0.0);
    // A curve that goes to both sides of one place, where it is at the ends and in the middle.
    let knots = Knots {
        times: vec![0.0, 2.0],
        positions: vec![vec![0.0, 0.0]; 2],
        velocities: vec![vec![0.0, 0.5]; 2],
        accelerations: Vec::new(),
    };
    let wave = Trajectory::of_controller([("x", "m"), ("y", "m")], knots).unwrap();
    for (least, kept) in [(-0.0963, true), (-0.0961, false)] {
        let above = Constraint::new("above", Length::Fraction(0.001), move |row: &[f64]| row[1] >= least);
        let verdict = open.under(above).unwrap().check_trajectory(&wave, &Interrupt::never()).unwrap();
        let broken = verdict.faults.iter().any(|fault| fault.contains("constraint `above`"));
        assert_eq!(broken, !kept, "{least}: {:?}", verdict.faults);
    }
}

#[test]
fn jerk_is_limited_where_the_robot_says_so() {
    let beside = "[[obstacle]]\nname = \"post\"\nbox = [0.1, 0.1, 1]\nat = [0.8499, 0.17, 0]\n";
    let [free, soft] = ["", "\nmax_jerk = { x = 10, y = 20 }"]
        .map(|jerk| crane(&format!("max_acceleration = {{ x = 2, y = 4 }}{jerk}"), beside));
    let made = timed(&soft, &corner(&soft), &Pace::default());
    assert_eq!(made.trajectory.interpolation(), Interpolation::Quintic);
    for (joint, limit) in [(0, 10.0), (1, 20.0)] {
        // By differences of positions, a thousand a second.
        let at = |i: usize| made.trajectory.at(i as f64 * 1e-3).position[joint];
        let jerk = |i: usize| (at(i + 3) - 3.0 * at(i + 2) + 3.0 * at(i + 1) - at(i)).abs() / 1e-9;
        let most = (0..(made.trajectory.duration() * 1e3) as usize).map(jerk).fold(0.0, f64::max);
        assert!(most < 1.001 * limit && most > 0.5 * limit, "{joint}: {most}");
    }
    let verdict = soft.check_trajectory(&made.trajectory, &Interrupt::never()).unwrap();
    assert!(verdict.free, "{:?}", verdict.faults);
    // It takes longer, and longer still with half of it. What is fast is too rough.
    let fast = timed(&free, &corner(&free), &Pace::default());
    let gentle = timed(&soft, &corner(&soft), &Pace { jerk: 0.5, ..Pace::default() });
    let durations = [&fast, &made, &gentle].map(|made| made.trajectory.duration());
    assert!(durations[0] < durations[1] && durations[1] < durations[2], "{durations:?}");
    let verdict = soft.check_trajectory(&fast.trajectory, &Interrupt::never()).unwrap();
    let of: Vec<_> = verdict.trajectory.unwrap().limits.into_iter().map(|fault| fault.of).collect();
    assert_eq!(of, ["jerk", "jerk"], "{:?}", verdict.faults);
    assert!(verdict.faults[0].contains("/s³ at "), "{:?}", verdict.faults);
}

/// An interrupted proof says nothing about collisions.
#[test]
fn an_interrupted_check_is_no_collision() {
    let scene = posts("[[obstacle]]\nname = \"post\"\nbox = [0.1, 0.1, 1]\nat = [0.8499, 0.17, 0]\n");
    let path = corner(&scene);
    let made = timed(&scene, &path, &Pace::default()).trajectory;
    let cancel = Cancel::new();
    cancel.cancel();
    let ended = [
        scene.check_trajectory(&made, &Interrupt::new(cancel.clone())).map(drop),
        scene.at_rate(&made, 50.0, &Pace::default(), &Interrupt::new(cancel.clone())).map(drop),
        scene.time(&path, &Pace::default(), &Interrupt::new(cancel)).map(drop),
    ];
    for ended in ended {
        let error = ended.unwrap_err();
        assert_eq!(error.message(), "the trajectory was not proved in time", "{error}");
    }
}

/// Between few points a curve is another one: it is compared with the limits that the trajectory keeps to, also those that are taken where none
/// is known.
#[test]
fn limits_at_a_rate_are_those_of_the_pace() {
    let pace = Pace { velocity: 0.5, acceleration: 0.5, ..Pace::default() };
    for (limits, acceleration) in [("max_acceleration = { x = 2, y = 4 }", [1.0, 2.0]), ("", [0.5, 0.5])] {
        let scene = crane(limits, "");
        let made = timed(&scene, &corner(&scene), &pace).trajectory;
        for rate in [200.0, 3.0, 1.1] {
            let (sampled, faults) = scene.at_rate(&made, rate, &pace, &Interrupt::never()).unwrap();
            let mut beyond = 0;
            for (joint, name) in ["x", "y"].into_iter().enumerate() {
                let is_beyond = sampled.hardest(joint).amount > 1.001 * acceleration[joint];
                let words = format!("the acceleration of {name} reaches");
                assert_eq!(
                    faults.iter().any(|fault| fault.starts_with(&words)),
                    is_beyond,
                    "{rate}: {faults:?}"
                );
                beyond += usize::from(is_beyond);
            }
            assert!(beyond > 0 || rate > 100.0, "{rate}");
        }
    }
    let scene = posts("");
    let made = timed(&scene, &corner(&scene), &pace).trajectory;
    let error = scene.at_rate(&made, 1e8, &pace, &Interrupt::never()).unwrap_err();
    assert!(error.message().contains("take a rate above 0 Hz and below"), "{error}");
}

/// A path that is a part of another one gets times, and it is said that it leads elsewhere.
#[test]
fn ends_that_are_not_those_of_the_scene_are_told() {
    let scene = posts("");
    let mut path = corner(&scene);
    assert!(timed(&scene, &path, &Pace::default()).ends.is_empty());
    path.rows.pop();
    assert_eq!(timed(&scene, &path, &Pace::default()).ends, ["does not end at the goal: 1 off"]);
    path.rows.remove(0);
    let ends = timed(&scene, &path, &Pace::default()).ends;
    assert_eq!(ends, ["does not begin at the start: 1 off", "does not end at the goal: 1 off"]);
}

#[test]
fn what_controllers_run_is_what_is_checked() {
    // A post beside the straight motion between two points: how it is met depends on the curve between them.
    let scene = posts("[[obstacle]]\nname = \"post\"\nbox = [0.1, 0.1, 1]\nat = [0.5, 0.75, 0]\n");
    let times = vec![0.0, 2.0];
    let rows = |a: [f64; 2], b: [f64; 2]| vec![a.to_vec(), b.to_vec()];
    let made = |velocities: Vec<Vec<f64>>, accelerations: Vec<Vec<f64>>| {
        let knots = Knots {
            times: times.clone(),
            positions: rows([0.0, 0.0], [1.0, 1.0]),
            velocities,
            accelerations,
        };
        Trajectory::of_controller([("x", "m"), ("y", "m")], knots).unwrap()
    };
    let check = |trajectory: &Trajectory| scene.check_trajectory(trajectory, &Interrupt::never()).unwrap();
    let straight = made(Vec::new(), Vec::new());
    let verdict = check(&straight);
    assert!(verdict.free && verdict.summary().contains("2 s, linear curve"), "{verdict:?}");
    let smooth = made(rows([0.0; 2], [0.0; 2]), Vec::new());
    assert!(check(&smooth).free);
    // Quick to the side first: the knots are as free as before.
    let bent = made(rows([0.0, 1.0], [0.0, 0.0]), Vec::new());
    let verdict = check(&bent);
    assert!(
        !verdict.free && verdict.faults.iter().any(|f| f.contains("hits tip in post")),
        "{:?}",
        verdict.faults
    );
    let quintic = made(rows([0.0; 2], [0.0; 2]), rows([0.0, 9.0], [0.0, 0.0]));
    // Whatever file it comes from, a curve that collides between free points is refused.
    for kind in [TrajectoryKind::Csv, TrajectoryKind::Json, TrajectoryKind::Yaml, TrajectoryKind::Mcap] {
        for (curve, free) in [(&smooth, true), (&bent, false)] {
            let bytes = scene.trajectory_bytes(curve, kind).unwrap();
            let read = scene.parse_trajectory("t", &bytes, kind, None).unwrap().unwrap();
            assert_eq!(&read, curve, "{kind:?}");
            let verdict = check(&read).trajectory.unwrap();
            assert_eq!(verdict.collides_at.is_none(), free, "{kind:?} {verdict:?}");
        }
    }
    let verdict = check(&quintic);
    assert_eq!(verdict.trajectory.as_ref().unwrap().curve, "quintic");
    // Beyond the limits of velocity and acceleration, each with its time.
    let limits = &verdict.trajectory.as_ref().unwrap().limits;
    let of: Vec<_> = limits.iter().map(|fault| (fault.joint.as_str(), fault.of.as_str())).collect();
    assert!(of.contains(&("y", "acceleration")), "{of:?}");
    assert!(limits.iter().all(|fault| fault.reached > fault.limit && (0.0..=2.0).contains(&fault.time)));
    // Others than the joints of the scene, and ends elsewhere.
    let knots = smooth.knots().clone();
    let swapped = Trajectory::of_controller([("y", "m"), ("x", "m")], knots.clone()).unwrap();
    assert!(scene.check_trajectory(&swapped, &Interrupt::never()).is_err());
    let mut elsewhere = knots;
    elsewhere.positions[0] = vec![0.2, -3.5];
    let verdict = check(&Trajectory::of_controller([("x", "m"), ("y", "m")], elsewhere).unwrap());
    let faults = verdict.faults.join("\n");
    assert!(
        faults.contains("does not begin at the start") && faults.contains("the position of y reaches -3.5"),
        "{faults}"
    );
}

/// As in MoveIt, positions of its file beside the SRDF take the place of those of the URDF, and a note says so.
#[test]
fn limits_of_position_are_those_of_moveit() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let joint = |name: &str, kind: &str, parent: &str, child: &str| {
        format!(
            "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/><axis xyz='0 0 1'/>\
             <limit lower='-3' upper='3'/></joint>"
        )
    };
    let joints = [joint("a", "revolute", "base", "b1"), joint("b", "continuous", "b1", "b2")].concat();
    let links = ["base", "b1", "b2"].map(|name| format!("<link name='{name}'/>")).concat();
    write("two.urdf", &format!("<robot name='two'>{links}{joints}</robot>"));
    write("two.srdf", "<robot name='two'/>");
    let load = |file: &str, more: &str| {
        write("joint_limits.yaml", &format!("joint_limits:\n{file}"));
        let motion = "[motion]\nstart = [0, 0]\ngoal = [0.5, 1]\n";
        write("two.toml", &format!("[robot]\nurdf = \"two.urdf\"\n{more}{motion}"));
        Scene::load(folder.path().join("two.toml")).map_err(|e| e.to_string())
    };
    let limits = |file: &str, more: &str| load(file, more).unwrap().limits();
    assert_eq!(limits("", ""), [Some([-3.0, 3.0]), None]);
    let narrow = "  a:\n    has_position_limits: true\n    min_position: -1\n    max_position: 1\n";
    let scene = load(narrow, "").unwrap();
    let notes = scene.notes().join("\n");
    assert!(notes.contains("joint_limits.yaml") && notes.contains("a from -1 to 1"), "{notes}");
    assert_eq!(scene.limits(), [Some([-1.0, 1.0]), None]);
    // Wider ones too, and the problem comes before the file.
    assert_eq!(limits(&narrow.replace(": 1", ": 3.5"), "")[0], Some([-1.0, 3.5]));
    assert_eq!(limits(narrow, "limits = { a = [-2, 2] }\n")[0], Some([-2.0, 2.0]));
    // One limit with the other of the URDF; there must be room between them.
    assert_eq!(limits("  a:\n    max_position: 1\n", "")[0], Some([-3.0, 1.0]));
    let error = load("  a:\n    min_position: 4\n", "").unwrap_err();
    assert!(error.contains("joint_limits.yaml") && error.contains("from 4 to 3"), "{error}");
    // As in MoveIt, a continuous joint keeps turning.
    let scene = load(&narrow.replace("a:", "b:"), "").unwrap();
    assert!(scene.notes().iter().any(|note| note.contains("not taken") && note.contains(": b")));
    assert_eq!(scene.limits()[1], None);
    // A file that cannot be used is an error, as an SRDF is.
    let error = load("  a:\n    has_velocity_limits: ture\n", "").unwrap_err();
    assert!(error.contains("joint_limits.yaml:3") && error.contains("ture"), "{error}");
    assert!(load("  a:\n    has_velocity_limits: ture\n", "srdf = false\n").is_ok());
    // The part that MoveIt takes where a request names none is said, not taken.
    let scene = load("  a:\n    max_velocity: 1\ndefault_velocity_scaling_factor: 0.1\n", "").unwrap();
    let notes = scene.notes().join("\n");
    assert!(notes.contains("--velocity-scale 0.1") && !notes.contains("acceleration-scale"), "{notes}");
    let scene = load("  a:\ndefault_velocity_scaling_factor: 1\n", "").unwrap();
    assert!(!scene.notes().iter().any(|note| note.contains("scale")), "{:?}", scene.notes());
}

/// MoveIt's file beside the SRDF comes before the URDF, and the problem before both.
#[test]
fn limits_are_those_of_the_problem_of_moveit_and_of_the_urdf() {
    let folder = tempfile::tempdir().unwrap();
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{child}'/><axis xyz='0 0 1'/>\
             <limit effort='1' velocity='2'/></joint>"
        )
    };
    let joints = [joint("a", "base", "b1"), joint("b", "b1", "b2"), joint("c", "b2", "b3")].concat();
    let links = ["base", "b1", "b2", "b3"].map(|name| format!("<link name='{name}'/>")).concat();
    let config = folder.path().join("three_moveit_config/config");
    std::fs::create_dir_all(&config).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("three.urdf", &format!("<robot name='three'>{links}{joints}</robot>"));
    write("three_moveit_config/config/three.srdf", "<robot name='three'/>");
    write(
        "three_moveit_config/config/joint_limits.yaml",
        "joint_limits:\n  b:\n    has_velocity_limits: true\n    max_velocity: 0.5\n    has_acceleration_limits: true\n    \
         max_acceleration: 3\n  c:\n    has_velocity_limits: true\n    max_velocity: 0.5\n  finger:\n    has_velocity_limits: true\n    \
         max_velocity: 9\n",
    );
    let problem = "[robot]\nurdf = \"three.urdf\"\nmax_velocity = { c = 0.25 }\n[motion]\nstart = [0, 0, 0]\ngoal = [1, 0, 0]\n";
    write("three.toml", problem);
    let scene = Scene::load(folder.path().join("three.toml")).unwrap();
    for (joint, velocity, acceleration) in [(0, 2.0, 1.0), (1, 0.5, 3.0), (2, 0.25, 1.0)] {
        let mut end = vec![0.0; 3];
        // Long enough for full speed, and not so long that this is reached within one interval of the grid.
        end[joint] = [9.0, 0.6, 0.6][joint];
        let rows = vec![
            vec![0.0; 3],
            end.iter().map(|x| x / 3.0).collect(),
            end.iter().map(|x| x / 1.5).collect(),
            end,
        ];
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        let made = timed(&scene, &path, &Pace::default());
        assert!((made.trajectory.fastest(joint).amount - velocity).abs() < 1e-3, "{joint}");
        assert!((made.trajectory.hardest(joint).amount - acceleration).abs() < 1e-3, "{joint}");
        assert!(
            made.notes.len() == 1 && made.notes[0].contains("acceleration of a, c is known"),
            "{:?}",
            made.notes
        );
    }
    let wrong = problem.replace("{ c =", "{ d =");
    write("three.toml", &wrong);
    let error = Scene::load(folder.path().join("three.toml")).unwrap_err().to_string();
    assert!(error.contains("\"d\"") && error.contains("\"a\", \"b\", \"c\""), "{error}");
}

/// A base in the plane has no limits in any file but the problem: a number for all joints counts for it, and it can be named.
#[test]
fn limits_of_the_problem_are_those_of_a_base_in_the_plane_too() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "mobile.urdf",
        "<robot name='mobile'><link name='base'/><link name='arm'/><joint name='a' type='continuous'><parent link='base'/>\
         <child link='arm'/><axis xyz='0 0 1'/><limit effort='1' velocity='2'/></joint></robot>",
    );
    let load = |rates: &str| {
        let robot = "[robot]\nurdf = \"mobile.urdf\"\nbase = \"planar\"\nbounds = [[-9, -9], [9, 9]]\n";
        let ends = if rates.contains("hold") { "[0, 0, 0]" } else { "[0, 0, 0, 0]" };
        write("mobile.toml", &format!("{robot}{rates}\n[motion]\nstart = {ends}\ngoal = {ends}\n"));
        Scene::load(folder.path().join("mobile.toml"))
    };
    for (rates, column, velocity, acceleration) in [
        ("max_velocity = 0.25\nmax_acceleration = 0.5", 0, 0.25, 0.5),
        ("max_velocity = 0.25\nmax_acceleration = 0.5", 2, 0.25, 0.5),
        ("max_velocity = { theta = 0.5, x = 0.25 }\nmax_acceleration = { x = 0.5 }", 0, 0.25, 0.5),
        ("max_velocity = { theta = 0.5, x = 0.25 }\nmax_acceleration = { x = 0.5 }", 2, 0.5, 1.0),
        ("max_velocity = 0.5\nmax_acceleration = 1\nhold = { a = 0.1 }", 1, 0.5, 1.0),
        ("max_velocity = { a = 0.5, y = 0.25 }\nhold = { a = 0.1 }", 1, 0.25, 1.0),
    ] {
        let scene = load(rates).unwrap();
        let mut path =
            PathRows { format: scene.path_format(), columns: scene.columns(), rows: vec![scene.start(); 4] };
        path.rows.iter_mut().zip(0..).for_each(|(row, i)| row[column] = f64::from(i) / 3.0);
        let made = timed(&scene, &path, &Pace::default()).trajectory;
        assert!((made.fastest(column).amount - velocity).abs() < 1e-3, "{rates}, {column}");
        assert!((made.hardest(column).amount - acceleration).abs() < 1e-3, "{rates}, {column}");
    }
    let error = load("max_velocity = { thetta = 0.25 }").unwrap_err().to_string();
    assert!(error.contains("\"thetta\"") && error.contains("\"x\", \"y\", \"theta\", \"a\""), "{error}");
}

#[test]
fn robots_without_trajectories_say_so() {
    for name in ["easy", "gempa-2", "wrench", "velocities", "crossing"] {
        let scene = Scene::find(name).unwrap();
        let path =
            PathRows { format: scene.path_format(), columns: scene.columns(), rows: vec![scene.start()] };
        let error = scene.time(&path, &Pace::default(), &Interrupt::never()).unwrap_err();
        assert!(error.to_string().contains("there are no trajectories"), "{name}: {error}");
    }
    let scene = posts("");
    for pace in [
        Pace { velocity: 0.0, ..Pace::default() },
        Pace { acceleration: f64::NAN, ..Pace::default() },
        Pace { deviation: -1.0, ..Pace::default() },
    ] {
        assert!(scene.time(&corner(&scene), &pace, &Interrupt::never()).is_err(), "{pace:?}");
    }
    let still = PathRows { rows: vec![vec![0.0, 0.0]; 3], ..corner(&scene) };
    assert_eq!(timed(&scene, &still, &Pace::default()).trajectory.duration(), 0.0);
}

/// Judges curves whose points were changed at random: the verdict, and what samples `step` seconds apart find by the checker of planners, which
/// shares no code with it. Returns how many were free, and how many samples found to collide.
fn judged(name: &str, count: usize, step: f64) -> [usize; 2] {
    let file = format!("{}/../mp-scenes/assets/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let mut arm = ArmScene::from_problem(mp_io::RobotProblem::load(file).unwrap()).unwrap().arm().clone();
    let scene = Scene::find(name).unwrap();
    let made = timed(&scene, &planned(&scene, 1), &Pace::default()).trajectory;
    let names: Vec<_> = scene.columns().into_iter().map(|c| (c.name, c.unit)).collect();
    let (mut rng, mut counts) = (Rng::seed(44), [0; 2]);
    for case in 0..count {
        let mut knots = made.knots().clone();
        let last = knots.times.len() - 1;
        for _ in 0..rng.random_range(1..6) {
            let (knot, joint) = (rng.random_range(0..=last), rng.random_range(0..names.len()));
            let size: f64 = rng.random_range(0.0..1.0);
            match rng.random_range(0..3) {
                0 if knot > 0 && knot < last => {
                    knots.positions[knot][joint] += 2.0 * size * rng.random_range(-1.0..1.0)
                }
                1 => knots.velocities[knot][joint] += 10.0 * size * rng.random_range(-1.0..1.0),
                // Fewer points: the curve between the others is another.
                _ if knot > 0 && knot < last => {
                    let many = rng.random_range(1..8).min(last - knot);
                    knots.times.drain(knot..knot + many);
                    knots.positions.drain(knot..knot + many);
                    knots.velocities.drain(knot..knot + many);
                    break;
                }
                _ => {}
            }
        }
        let joints = names.iter().map(|(name, unit)| (name.as_str(), unit.as_str()));
        let curve = Trajectory::of_controller(joints, knots).unwrap();
        let verdict = scene.check_trajectory(&curve, &Interrupt::never()).unwrap();
        let collides_at = verdict.trajectory.unwrap().collides_at;
        let hit = sampled(&curve, step).into_iter().position(|row| !arm.is_valid(&Configuration::from(row)));
        match (hit, collides_at) {
            (None, None) => counts[0] += 1,
            (Some(hit), Some(at)) => {
                counts[1] += 1;
                // The first contact is not behind the first sample that finds one, but for what the proof resolves.
                assert!(
                    at <= hit as f64 * step + 2e-3,
                    "{name} {case}: {at} s, and {} s by samples",
                    hit as f64 * step
                );
            }
            (Some(hit), None) => {
                panic!("{name} {case}: certified free, and in contact at {} s", hit as f64 * step)
            }
            // Between samples, or too near to contact to tell.
            (None, Some(at)) => {
                let there: Configuration = curve.at(at).position.into();
                assert!(arm.clearance(&there, 1.0) < 2.0 * arm.tolerance(), "{name} {case}: {at} s");
            }
        }
    }
    counts
}

#[test]
fn changed_curves_are_judged_as_samples_judge_them() {
    for name in ["arm", "arm-7"] {
        let [free, hit] = judged(name, 80, 2e-3);
        assert!(free > 3 && hit > 1, "{name}: {free} free, {hit} in contact");
    }
}

/// The same with many more: `cargo test --release -p mp-plan --test plan a_thousand -- --ignored --nocapture`.
#[test]
#[ignore = "minutes: a measurement"]
#[allow(clippy::print_stdout, reason = "it is a measurement")]
fn a_thousand_changed_curves_are_judged_as_dense_samples_judge_them() {
    for name in ["arm", "arm-6", "arm-7", "humanoid"] {
        let [free, hit] = judged(name, 250, 1e-4);
        println!("{name}: of 250 changed curves {free} are free, and {hit} in contact by samples of 0.1 ms");
    }
}

/// A shipped scene whose robot has this limit of jerk.
fn with_jerk(name: &str, jerk: f64) -> Scene {
    let assets = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../mp-scenes/assets");
    let folder = tempfile::tempdir().unwrap();
    let own = |path: &str| folder.path().join(path);
    std::fs::create_dir_all(own("robots")).unwrap();
    std::fs::create_dir_all(own("scenes")).unwrap();
    for entry in std::fs::read_dir(assets.join("robots")).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), own("robots").join(entry.file_name())).unwrap();
    }
    let text = std::fs::read_to_string(assets.join(format!("scenes/{name}.toml"))).unwrap();
    let text = text.replacen("[robot]\n", &format!("[robot]\nmax_jerk = {jerk}\n"), 1);
    std::fs::write(own("scenes/task.toml"), text).unwrap();
    Scene::load(own("scenes/task.toml")).unwrap()
}

/// How long the proof of curves takes beside planning, and how often corners have to be rounded less, between random free ends, without and with limits of
/// jerk: `cargo test --release -p mp-plan --test plan random_arm_problems -- --ignored --nocapture`.
#[test]
#[ignore = "minutes: a measurement"]
#[allow(clippy::print_stdout, reason = "it is a measurement")]
fn random_arm_problems_are_timed() {
    for name in ["arm", "arm-6", "arm-7", "humanoid", "mobile-arm"] {
        for jerk in [f64::INFINITY, 10.0] {
            let scene = if jerk.is_finite() { with_jerk(name, jerk) } else { Scene::find(name).unwrap() };
            measured(name, &scene, jerk);
        }
    }
}

#[allow(clippy::print_stdout, reason = "it is a measurement")]
fn measured(name: &str, scene: &Scene, jerk: f64) {
    let mut rng = Rng::seed(44);
    let limits = scene.limits();
    let mut free = || loop {
        let number = |limits: &Option<[f64; 2]>| {
            let [low, high] = limits.unwrap_or([-3.0, 3.0]);
            rng.random_range(low..high)
        };
        let row: Vec<f64> = limits.iter().map(number).collect();
        if scene.explain(&row).unwrap().clearance > 0.005 {
            return row;
        }
    };
    let (mut solved, mut corners, mut tightened, mut stretched) = (0, 0, 0, 0);
    let [mut planning, mut timing, mut checking, mut seconds] = [0.0; 4];
    for seed in 0..20 {
        let problem = scene.with_ends(&free(), &[free()]).unwrap();
        let began = std::time::Instant::now();
        let report = problem.plan(&Request::default().seed(seed).iterations(20_000)).unwrap();
        let Some(rows) = report.path else { continue };
        planning += began.elapsed().as_secs_f64();
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        let began = std::time::Instant::now();
        let made = timed(&problem, &path, &Pace::default());
        timing += began.elapsed().as_secs_f64();
        let began = std::time::Instant::now();
        let verdict = problem.check_trajectory(&made.trajectory, &Interrupt::never()).unwrap();
        checking += began.elapsed().as_secs_f64();
        assert!(verdict.free, "{name} {seed}: {:?}", verdict.faults);
        (solved, corners, tightened) = (solved + 1, corners + made.corners, tightened + made.tightened.len());
        stretched += usize::from(!made.tightened.is_empty());
        seconds += made.trajectory.duration();
    }
    let each = 1e3 / f64::from(solved);
    println!(
        "{name}, jerk {jerk}: {solved} solved, {corners} corners, {tightened} rounded less, in {stretched} trajectories; in the mean \
         {:.0} ms planning, {:.0} ms timing with both proofs, {:.0} ms checking, {:.2} s long",
        planning * each,
        timing * each,
        checking * each,
        seconds * each / 1e3
    );
}
