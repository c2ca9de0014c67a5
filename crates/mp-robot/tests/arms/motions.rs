//! Validity, clearance and certified motions, against plain triangle distances and against sampling.

use crate::common::{
    Six, across, cases_of, clutter, obstacle, random_tree, round_clutter, six, six_of_balls,
};
use mp_collide::reference::RefMesh;
use mp_cspace::{
    Certified, Clearance, Configuration, Coordinates, Joints, MotionCheck, MotionClearance, MotionValidity,
    Path, Rng, Space, Validity, least_clearance,
};
use mp_geom::{
    TriMesh,
    primitives::{cuboid, cylinder},
};
use mp_robot::{Arm, ArmModel, ArmVerifier, Joint, JointKind, Link};
use nalgebra::{Isometry3, SVector, Vector3};

fn arm() -> (Arm, Joints<Six>) {
    let arm = Arm::new(&six(), clutter()).unwrap();
    let space = arm.space().unwrap();
    (arm, space)
}

/// The least distance from obstacles, and from links too, by the reference implementation, from the model and the names of the pairs only.
fn plain_distance(arm: &Arm, obstacles: &[RefMesh], q: &[f64], still: &[&str]) -> [f64; 2] {
    let identity = Isometry3::identity();
    let links: Vec<(&str, RefMesh)> =
        arm.meshes_at(q).into_iter().map(|(name, mesh)| (name, RefMesh::new(&mesh))).collect();
    let mut least = f64::INFINITY;
    for (name, link) in &links {
        for obstacle in obstacles.iter().filter(|_| !still.contains(name)) {
            least = least.min(link.clearance(&identity, obstacle, &identity, f64::INFINITY));
        }
    }
    let from_obstacles = least;
    for [a, b] in arm.checked_pairs() {
        let find = |name: &str| &links.iter().find(|(n, _)| *n == name).unwrap().1;
        least = least.min(find(a).clearance(&identity, find(b), &identity, f64::INFINITY));
    }
    [from_obstacles, least]
}

fn references(arm: &Arm) -> Vec<RefMesh> {
    arm.obstacles().map(|(_, mesh)| RefMesh::new(mesh)).collect()
}

fn consistent(mut arm: Arm, still: &[&str], samples: usize) -> [usize; 2] {
    let space: Joints<Configuration> = arm.space().unwrap();
    let mut rng = Rng::seed(7);
    let (mut counts, obstacles) = ([0, 0], references(&arm));
    for _ in 0..samples {
        let q = space.sample_uniform(&mut rng);
        let (valid, clearance) = (arm.is_valid(&q), arm.clearance(&q, f64::INFINITY));
        let [from_obstacles, plain] = plain_distance(&arm, &obstacles, q.as_slice(), still);
        assert_eq!(valid, clearance > 0.0);
        assert_eq!(valid, !arm.in_contact(&q));
        assert!((clearance - plain).abs() < 1e-11 || plain == clearance, "{clearance} {plain}");
        assert!(arm.clearance(&q, 0.01) >= clearance.min(0.01) - 1e-12);
        let alone = arm.obstacle_clearance(&q, f64::INFINITY);
        assert!(
            (alone - from_obstacles).abs() < 1e-11 || alone == from_obstacles,
            "{alone} {from_obstacles}"
        );
        counts[usize::from(valid)] += 1;
    }
    counts
}

#[test]
fn answers_are_those_of_the_reference() {
    let counts = consistent(arm().0, &["base"], cases_of(400));
    assert!(counts.into_iter().all(|n| n > cases_of(60)), "{counts:?}");
    let mut rng = Rng::seed(5);
    let mut sum = [0, 0];
    for count in 4..14 {
        let mut model = random_tree(&mut rng, count);
        model.may_touch = Some(Vec::new());
        let Ok(arm) = Arm::new(&model, clutter()) else { continue };
        // Whatever hangs on the root by fixed joints stands still.
        let mut still: Vec<&str> = Vec::new();
        let root = model.links.iter().find(|l| model.joints.iter().all(|j| j.child != l.name)).unwrap();
        still.push(&root.name);
        for _ in 0..count {
            let fixed = model.joints.iter().filter(|j| j.kind == JointKind::Fixed);
            let more: Vec<_> = fixed.filter(|j| still.contains(&&*j.parent)).map(|j| &*j.child).collect();
            still.extend(more);
        }
        let counts = consistent(arm, &still, cases_of(60));
        sum = [sum[0] + counts[0], sum[1] + counts[1]];
    }
    assert!(sum[0] > cases_of(50) && sum[1] >= cases_of(6), "{sum:?}");
}

/// Links of balls are compared as balls, in lanes, with all forms of solids: answers are those of the reference, of one state and of eight.
#[test]
fn answers_of_balls_are_those_of_the_reference() {
    let mut arm = Arm::new(&six_of_balls(), round_clutter()).unwrap();
    assert!(arm.tolerance() > 0.0 && MotionClearance::<Six>::contacts_at_once(&arm) == 8);
    let counts = consistent(arm.clone(), &["base"], cases_of(400));
    assert!(counts.into_iter().all(|n| n > cases_of(60)), "{counts:?}");
    let (space, obstacles): (Joints<Six>, _) = (arm.space().unwrap(), references(&arm));
    let (mut rng, mut found, mut free) = (Rng::seed(2), [0; 8], 0);
    for round in 0..cases_of(400) {
        // Near a state that is free, so that only some of the eight touch.
        let near =
            std::iter::repeat_with(|| space.sample_uniform(&mut rng)).find(|q| arm.is_valid(q)).unwrap();
        let size = [0.1, 0.3, 1.0][round % 3];
        let states = [(); 8].map(|()| space.interpolate(&near, &space.sample_uniform(&mut rng), size));
        let touching = states.map(|q| plain_distance(&arm, &obstacles, q.as_slice(), &["base"])[1] <= 0.0);
        match arm.first_within(&states.each_ref(), 0.0) {
            Some(k) => {
                assert!(touching[k], "{touching:?} {k}");
                found[k] += 1;
            }
            None => {
                assert!(touching.iter().all(|touches| !touches), "{touching:?}");
                free += 1;
            }
        }
    }
    assert!(
        free > cases_of(40) && found.iter().filter(|n| **n > cases_of(4)).count() > 5,
        "{found:?} {free}"
    );
    let nan = Six::repeat(f64::NAN);
    let near = std::iter::repeat_with(|| space.sample_uniform(&mut rng)).find(|q| arm.is_valid(q)).unwrap();
    assert_eq!(arm.first_within(&[&near, &nan], 0.0), Some(1));
}

/// Of eight states together: whether one is nearer than a clearance is what the reference says, for balls and for meshes.
#[test]
fn eight_states_within_a_clearance_are_those_of_the_reference() {
    for of_balls in [true, false] {
        let links = if of_balls { six_of_balls() } else { six() };
        let mut arm = Arm::new(&links, if of_balls { round_clutter() } else { clutter() }).unwrap();
        let (space, obstacles): (Joints<Six>, _) = (arm.space().unwrap(), references(&arm));
        let (mut rng, mut nearer, mut free) = (Rng::seed(3), 0, 0);
        for round in 0..cases_of(200) {
            let near =
                std::iter::repeat_with(|| space.sample_uniform(&mut rng)).find(|q| arm.is_valid(q)).unwrap();
            let size = [0.03, 0.1, 0.3][round % 3];
            let states = [(); 8].map(|()| space.interpolate(&near, &space.sample_uniform(&mut rng), size));
            let distances = states.map(|q| plain_distance(&arm, &obstacles, q.as_slice(), &["base"])[1]);
            for clearance in [0.004, 0.03] {
                match arm.first_within(&states.each_ref(), clearance) {
                    Some(k) => {
                        assert!(distances[k] <= clearance + 1e-9, "{distances:?} {k} {clearance}");
                        nearer += usize::from(distances[k] > 0.0);
                    }
                    None => {
                        assert!(
                            distances.iter().all(|d| *d >= clearance - 1e-9),
                            "{distances:?} {clearance}"
                        );
                        free += 1;
                    }
                }
            }
        }
        assert!(nearer > cases_of(10) && free > cases_of(20), "{nearer} {free}");
    }
}

/// What keeps a clearance from obstacles is free of what is nearer, in lanes too.
#[test]
fn balls_keep_a_clearance() {
    let arm = Arm::new(&six_of_balls(), round_clutter()).unwrap();
    let (mut keeping, mut plain) = (arm.clone().keeping(0.03), arm.clone());
    let space: Joints<Six> = arm.space().unwrap();
    let (mut rng, mut nearer) = (Rng::seed(6), 0);
    for _ in 0..cases_of(1000) {
        let q = space.sample_uniform(&mut rng);
        let (is_free, is_kept) = (plain.is_valid(&q), keeping.is_valid(&q));
        let clearance = Clearance::clearance(&mut keeping, &q, f64::INFINITY);
        assert!(is_free || !is_kept);
        assert!(is_kept == (clearance > 0.0), "{clearance}");
        nearer += usize::from(is_free && !is_kept);
    }
    assert!(nearer > cases_of(50), "{nearer}");
}

#[test]
fn certified_motions_of_balls_are_free() {
    let arm = Arm::new(&six_of_balls(), round_clutter()).unwrap();
    let space: Joints<Six> = arm.space().unwrap();
    let counts = agree(&arm, &space, cases_of(900));
    assert!(counts.into_iter().all(|n| n > cases_of(100)), "{counts:?}");
    let mut verifier = ArmVerifier::new(&space, &arm).unwrap();
    let mut certified = Certified::new(&space, arm.clone(), arm.tolerance()).unwrap();
    let (mut rng, mut proved) = (Rng::seed(12), 0);
    while proved < cases_of(60) {
        let a = space.sample_uniform(&mut rng);
        let b = space.interpolate(&a, &space.sample_uniform(&mut rng), 0.3);
        if certified.check_motion(&a, &b).is_free() {
            assert!(verifier.check_motion(&a, &b).is_free());
            proved += 1;
        }
    }
    let least = least_clearances_agree(&arm, &space, cases_of(30));
    assert!(least.into_iter().all(|n| n > 0), "{least:?}");
}

/// Which pairs are compared: not those a joint joins, not those that always touch, not those given.
#[test]
fn pairs_that_may_touch() {
    let all = |model: &ArmModel| {
        let arm = Arm::new(model, []).unwrap();
        arm.checked_pairs().into_iter().map(|[a, b]| format!("{a} {b}")).collect::<Vec<_>>()
    };
    let mut model = six();
    // Seven links: 21 pairs, six of them joined.
    let pairs = all(&model);
    assert_eq!(pairs.len(), 15);
    assert!(pairs.contains(&"base upper".to_owned()) && !pairs.contains(&"upper fore".to_owned()));
    // A case about the wrist: the tool always sticks through it.
    let case = cuboid(0.24, 0.24, 0.24).unwrap();
    model.links[4] = model.links[4].clone().with(&case, &Isometry3::translation(0.0, 0.0, 0.11));
    let without = all(&model);
    assert!(!without.contains(&"roll tool".to_owned()) && without.len() == 14, "{without:?}");
    model.may_touch = Some(vec![("tool".into(), "base".into())]);
    let given = all(&model);
    assert!(given.contains(&"roll tool".to_owned()) && !given.contains(&"base tool".to_owned()));
    // Links of one rigid body are never compared.
    model.may_touch = None;
    model.links.push(model.links[6].clone());
    model.links[7].name = "camera".into();
    model.joints.push(Joint::new("mount", "tool", "camera", JointKind::Fixed));
    assert!(!all(&model).contains(&"tool camera".to_owned()));
    assert!(all(&model).contains(&"fore camera".to_owned()));
}

/// Certified motions are free at every sample; refused ones hit something or come near it.
fn agree(arm: &Arm, space: &Joints<Six>, motions: usize) -> [usize; 2] {
    let tolerance = arm.tolerance();
    let mut certified = Certified::new(space, arm.clone(), tolerance).unwrap();
    let mut exact = arm.clone();
    let mut rng = Rng::seed(11);
    let mut counts = [0, 0];
    for i in 0..motions {
        let a = space.sample_uniform(&mut rng);
        let b = space.interpolate(&a, &space.sample_uniform(&mut rng), [1.0, 0.3, 0.05][i % 3]);
        let at = |t: f64| space.interpolate(&a, &b, t);
        match certified.check_motion(&a, &b) {
            MotionCheck::Free { clearance } => {
                counts[1] += 1;
                assert!(clearance >= certified.margin());
                for k in 0..=100 {
                    let found = exact.clearance(&at(f64::from(k) / 100.0), 1.0);
                    assert!(found >= clearance * (1.0 - 1e-9), "{found} {clearance}");
                }
            }
            MotionCheck::Collision { at: t } => {
                counts[0] += 1;
                assert!(!exact.is_valid(&at(t)));
            }
            MotionCheck::Unproven { at: t } => {
                assert!(exact.clearance(&at(t), 1.0) < 2.0 * tolerance);
            }
        }
    }
    counts
}

#[test]
fn certified_motions_are_free() {
    let (arm, space) = arm();
    let counts = agree(&arm, &space, cases_of(900));
    assert!(counts.into_iter().all(|n| n > cases_of(100)), "{counts:?}");
    // Alone it hits itself only.
    let alone = arm.among([]).unwrap();
    let counts = agree(&alone, &space, cases_of(900));
    assert!(counts.into_iter().all(|n| n > cases_of(40)), "{counts:?}");
}

/// The arm with the search for the least clearance that all robots have.
struct AsOneBody(Arm);
impl<Q: Coordinates> Clearance<Q> for AsOneBody {
    fn clearance(&mut self, q: &Q, enough: f64) -> f64 {
        self.0.clearance(q, enough)
    }
}
impl<Q: Coordinates> MotionClearance<Q> for AsOneBody {
    fn motion_bound(&self, from: &Q, to: &Q) -> f64 {
        self.0.motion_bound(from, to)
    }
}

/// The least clearance link by link and pair by pair is that of the arm as one body, found with fewer looks.
pub(crate) fn least_clearances_agree<C>(arm: &Arm, space: &C, motions: usize) -> [usize; 2]
where
    C: Space<State: Coordinates>,
{
    let mut rng = Rng::seed(3);
    let (mut parts, mut whole) = (arm.clone(), AsOneBody(arm.clone()));
    let (mut counts, mut looks) = ([0, 0], [0, 0]);
    for i in 0..motions {
        let a = space.sample_uniform(&mut rng);
        let b = space.interpolate(&a, &space.sample_uniform(&mut rng), [0.3, 0.05, 1.0][i % 3]);
        let c = space.sample_uniform(&mut rng);
        let path = Path::straight(vec![a, b, c]);
        for accuracy in [1e-2, 3e-3] {
            let [x, y] = [
                least_clearance(space, &mut parts, &path, accuracy).unwrap(),
                least_clearance(space, &mut whole, &path, accuracy).unwrap(),
            ];
            for t in [x, y] {
                let q = space.interpolate(&path.states[t.edge], &path.states[t.edge + 1], t.at);
                let there = arm.clone().clearance(&q, f64::INFINITY);
                assert!((there - t.found).abs() <= 2e-6 * t.found, "{there} {t:?}");
                assert!(t.found - t.clearance <= accuracy * 1.001, "{t:?}");
            }
            assert!(x.clearance <= y.found && y.clearance <= x.found * 1.000002, "{x:?} {y:?}");
            counts[usize::from(x.found > 0.0)] += 1;
            if x.found > 0.0 {
                looks[0] += parts.take_counters().clearance_checks;
                looks[1] += whole.0.take_counters().clearance_checks;
            }
            (_, _) = (parts.take_counters(), whole.0.take_counters());
        }
    }
    assert!(2 * looks[0] < looks[1], "{looks:?}");
    counts
}

#[test]
fn least_clearances_of_parts_are_those_of_the_whole() {
    let alone = arm().0.among([]).unwrap();
    let counts = least_clearances_agree(&alone, &arm().1, 60);
    assert!(counts.into_iter().all(|n| n > 4), "{counts:?}");
    let mut far =
        Arm::new(&six(), [obstacle("ball", cuboid(0.3, 0.3, 0.3).unwrap(), [1.4, 0.2, 0.9, 0.0, 0.0, 0.0])])
            .unwrap();
    let counts = least_clearances_agree(&far, &arm().1, 60);
    assert!(counts.into_iter().all(|n| n > 4), "{counts:?}");
    // A configuration that is none.
    let nan = Six::repeat(f64::NAN);
    let least = least_clearance(&arm().1, &mut far, &Path::straight(vec![nan, nan]), 0.1).unwrap();
    assert_eq!((least.clearance, least.found), (0.0, 0.0));
}

/// A sheet of 1e-4 m and thinner in the way of the tool is never passed.
#[test]
fn a_thin_wall_is_never_crossed() {
    let mut rng = Rng::seed(3);
    for thickness in [1e-4, 1e-7, 1e-12] {
        let sheet = obstacle("wall", cuboid(thickness, 4.0, 4.0).unwrap(), [0.35, 0.0, 0.0, 0.2, 0.1, 0.0]);
        let plane = sheet.2;
        let mut arm = Arm::new(&six(), [sheet]).unwrap();
        let space: Joints<Six> = arm.space().unwrap();
        let mut certified = Certified::new(&space, arm.clone(), arm.tolerance()).unwrap();
        for [a, b] in across(&mut arm, &space, &plane, cases_of(150), &mut rng) {
            assert!(!certified.check_motion(&a, &b).is_free());
        }
    }
}

/// Two fins of 1e-4 m on one arm that can only pass through each other.
#[test]
fn links_do_not_pass_through_each_other() {
    let fin = |x: f64, y: f64| cuboid(x, y, 0.3).unwrap();
    let at = Isometry3::translation;
    let turn = JointKind::Revolute { low: -3.0, high: 3.0 };
    let model = ArmModel {
        links: vec![
            Link::new("base").with(&fin(0.5, 1e-4), &at(0.5, 0.0, 0.0)),
            Link::new("hub"),
            Link::new("hand").with(&fin(0.5, 1e-4), &at(0.3, 0.0, 0.0)),
        ],
        joints: vec![
            Joint::new("a", "base", "hub", turn).axis(Vector3::z()),
            Joint::new("b", "hub", "hand", turn).axis(Vector3::z()).at(at(0.1, 0.0, 0.0)),
        ],
        ..ArmModel::default()
    };
    let mut arm = Arm::new(&model, []).unwrap();
    assert_eq!(arm.checked_pairs(), [["base", "hand"]]);
    let space: Joints<SVector<f64, 2>> = arm.space().unwrap();
    let mut certified = Certified::new(&space, arm.clone(), arm.tolerance()).unwrap();
    let mut rng = Rng::seed(9);
    let (mut crossings, mut free) = (0, 0);
    while crossings < 300 {
        let [a, b] = [0, 1].map(|_| space.sample_uniform(&mut rng));
        let check = certified.check_motion(&a, &b);
        let y = |t: f64| {
            let q = space.interpolate(&a, &b, t);
            let tip =
                arm.kinematics().link_poses(q.as_slice()).unwrap()[2] * nalgebra::Point3::new(0.4, 0.0, 0.0);
            (tip.x > 0.3 && tip.x < 0.7).then_some(tip.y)
        };
        let ys: Vec<_> = (0..=400).map(|k| y(f64::from(k) / 400.0)).collect();
        let crosses = ys.windows(2).any(|w| matches!(w, [Some(a), Some(b)] if a * b < 0.0));
        if crosses {
            crossings += 1;
            assert!(!check.is_free());
        }
        free += usize::from(check.is_free());
    }
    assert!(free > 100 && arm.is_valid(&SVector::from([1.0, 0.0])));
}

/// Two wheels side by side on an axle, as in the legs of walking robots: all their facets are equally near, all along.
#[test]
fn a_wheel_that_turns_beside_another_costs_little() {
    let wheel = cylinder(0.046, 0.04, 64).unwrap();
    let turn = JointKind::Revolute { low: -3.0, high: 3.0 };
    let beside = Isometry3::translation(0.0, 0.0, 0.04235);
    let model = ArmModel {
        links: vec![
            Link::new("hip").with(&wheel, &Isometry3::identity()),
            Link::new("axle"),
            Link::new("rotor").with(&wheel, &Isometry3::identity()),
        ],
        joints: vec![
            Joint::new("a", "hip", "axle", turn).axis(Vector3::z()),
            Joint::new("b", "axle", "rotor", turn).axis(Vector3::z()).at(beside),
        ],
        ..ArmModel::default()
    };
    let mut arm = Arm::new(&model, []).unwrap();
    let space: Joints<SVector<f64, 2>> = arm.space().unwrap();
    let path = Path::straight(vec![SVector::from([-1.0, 0.0]), SVector::from([1.0, 1.5])]);
    let least = least_clearance(&space, &mut arm, &path, 1e-5).unwrap();
    assert!((0.00234..=0.00235).contains(&least.clearance), "{least:?}");
    let work = arm.take_counters();
    // Almost all by their boxes: hardly a state of the motion needs triangles, of which there are 128 × 128 pairs.
    assert!(work.work.triangle_tests < work.clearance_checks, "{work:?}");
    let mut verifier = ArmVerifier::new(&space, &arm).unwrap();
    assert!(verifier.check_motion(&path.states[0], &path.states[1]).is_free());
    assert!(verifier.parts() < 500, "{}", verifier.parts());
}

/// The bound of the whole motion holds for every vertex; it is that of the link that moves most.
#[test]
fn no_vertex_moves_farther_than_the_bound() {
    let mut rng = Rng::seed(4);
    let mut best = 0.0_f64;
    for count in 3..20 {
        let model = random_tree(&mut rng, count);
        let Ok(arm) = Arm::new(&model, []) else { continue };
        let space: Joints<Configuration> = arm.space().unwrap();
        for size in [1.0, 0.1] {
            let a = space.sample_uniform(&mut rng);
            let b = space.interpolate(&a, &space.sample_uniform(&mut rng), size);
            let vertices = |t: f64| {
                let meshes = arm.meshes_at(space.interpolate(&a, &b, t).as_slice());
                meshes
                    .iter()
                    .flat_map(|(_, mesh): &(_, TriMesh)| mesh.vertices().to_vec())
                    .collect::<Vec<_>>()
            };
            let bound = arm.motion_bound(&a, &b);
            let mut last = vertices(0.0);
            let mut travels = vec![0.0; last.len()];
            for k in 1..=100 {
                let next = vertices(f64::from(k) / 100.0);
                let steps = last.iter().zip(&next).map(|(p, q)| (q - p).norm());
                travels.iter_mut().zip(steps).for_each(|(travel, step)| *travel += step);
                last = next;
            }
            let most = travels.into_iter().fold(0.0, f64::max);
            assert!(most <= bound + 1e-12, "{most} {bound}");
            best = best.max(most / bound.max(1e-9));
        }
    }
    assert!(best > 0.7, "{best}");
}

#[test]
fn checks_do_not_allocate_and_are_counted() {
    let (mut arm, space) = arm();
    let mut rng = Rng::seed(1);
    let states: Vec<Six> = (0..50).map(|_| space.sample_uniform(&mut rng)).collect();
    let mut certified = Certified::new(&space, arm.clone(), arm.tolerance()).unwrap();
    let mut run = |arm: &mut Arm| {
        for q in states.windows(2) {
            arm.is_valid(&q[0]);
            arm.clearance(&q[0], 0.1);
            let b = space.interpolate(&q[0], &q[1], 0.1);
            certified.check_motion(&q[0], &b);
        }
    };
    run(&mut arm);
    let measured = allocation_counter::measure(|| run(&mut arm));
    assert_eq!(measured.count_total, 0);
    let counted = arm.take_counters();
    assert_eq!((counted.collision_checks, counted.clearance_checks), (98, 98));
    assert!(counted.work.box_tests > 0);
    assert_eq!(arm.counters(), mp_robot::CheckCounters::default());
    let other = certified.valid.among([]).unwrap();
    assert_eq!(other.counters(), mp_robot::CheckCounters::default());
    assert!(certified.valid.counters().clearance_checks > 0);
}

/// The same whether the number of coordinates is known when compiling or not.
#[test]
fn static_and_dynamic_configurations_agree() {
    let (mut arm, space) = arm();
    let dynamic: Joints<Configuration> = arm.space().unwrap();
    let mut rng = Rng::seed(2);
    let tolerance = arm.tolerance();
    let mut a_check = Certified::new(&space, arm.clone(), tolerance).unwrap();
    let mut b_check = Certified::new(&dynamic, arm.clone(), tolerance).unwrap();
    for _ in 0..100 {
        let [a, b] = [0, 1].map(|_| space.sample_uniform(&mut rng));
        let [c, d] = [a, b].map(|q| Configuration::from(q.as_slice()));
        assert_eq!(arm.clearance(&a, 1.0), arm.clearance(&c, 1.0));
        assert_eq!(a_check.check_motion(&a, &b), b_check.check_motion(&c, &d));
    }
}

#[test]
fn gradients_are_derivatives_of_the_clearance() {
    let (mut arm, space) = arm();
    mp_cspace::testkit::check_clearance_gradient(&space, &mut arm, 0.5, (200, 1e-5, 1e-3), 2);
    // Joints that slide, and that follow others, with a clearance that is kept.
    let (mut rng, mut checked) = (Rng::seed(3), 0);
    for count in 4..16 {
        let post = obstacle("post", cuboid(0.2, 0.3, 0.4).unwrap(), [1.0, 0.2, 0.3, 0.4, 0.0, 0.0]);
        let Ok(arm) = Arm::new(&random_tree(&mut rng, count), vec![post]) else { continue };
        let Ok(space) = arm.space::<Configuration>() else { continue };
        let (mut arm, mut samples) = (arm.keeping(0.01), Rng::seed(2));
        let mut is_near = || {
            let clearance = arm.clearance(&space.sample_uniform(&mut samples), 5.0);
            clearance > 0.0 && clearance < 5.0
        };
        if (0..100).filter(|_| is_near()).count() > 20 {
            mp_cspace::testkit::check_clearance_gradient(&space, &mut arm, 5.0, (100, 1e-5, 1e-3), 2);
            checked += 1;
        }
    }
    assert!(checked > 3, "{checked}");
}
