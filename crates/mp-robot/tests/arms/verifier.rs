//! The independent check, and answers for people.

use crate::common::{Six, across, clutter, obstacle, random_tree, six};
use mp_cspace::{
    Certified, Clearance, Configuration, Curve, Joints, MotionCheck, MotionValidity, Rng, Space, TrueMetric,
    Validity,
};
use mp_geom::TriMesh;
use mp_geom::primitives::{cuboid, cylinder, sphere};
use mp_robot::{Arm, ArmModel, ArmVerifier, Joint, JointKind, Link};
use nalgebra::{Isometry3, Vector3};
use rand::RngExt;

/// The verifier proves what is certified, finds what sampling finds, and claims no more clearance than there is.
pub(crate) fn agree<C: Space<State = Configuration> + TrueMetric>(
    arm: &Arm,
    space: &C,
    motions: usize,
) -> [usize; 2] {
    let tolerance = arm.tolerance();
    let mut certified = Certified::new(space, arm.clone(), tolerance).unwrap();
    let mut verifier = ArmVerifier::new(space, arm).unwrap();
    let mut exact = arm.clone();
    let mut rng = Rng::seed(13);
    let mut counts = [0, 0];
    for i in 0..motions {
        let a = space.sample_uniform(&mut rng);
        let b = space.interpolate(&a, &space.sample_uniform(&mut rng), [1.0, 0.3, 0.05][i % 3]);
        let verified = verifier.check_motion(&a, &b);
        // Nothing of the motions before is left.
        assert_eq!(ArmVerifier::new(space, arm).unwrap().check_motion(&a, &b), verified);
        let accepted = certified.check_motion(&a, &b).is_free();
        assert!(
            verified.is_free() || !accepted,
            "the verifier does not prove what was certified: {verified:?}"
        );
        match verified {
            MotionCheck::Free { clearance } => {
                counts[1] += 1;
                assert!(clearance >= verifier.tolerance() * (1.0 - 1e-9));
                for k in 0..=40 {
                    let q = space.interpolate(&a, &b, f64::from(k) / 40.0);
                    assert!(exact.clearance(&q, 1e9) >= clearance - 1e-9);
                }
            }
            MotionCheck::Collision { at } => {
                counts[0] += 1;
                assert!(exact.clearance(&space.interpolate(&a, &b, at), 1.0) < 1e-11);
            }
            MotionCheck::Unproven { at } => {
                assert!(exact.clearance(&space.interpolate(&a, &b, at), 1.0) < 2.0 * tolerance);
            }
        }
    }
    counts
}

#[test]
fn it_agrees_with_certified_motions_and_samples() {
    let arm = Arm::new(&six(), clutter()).unwrap();
    let counts = agree(&arm, &arm.space().unwrap(), 300);
    assert!(counts.into_iter().all(|n| n > 40), "{counts:?}");
    let alone = arm.among([]).unwrap();
    let counts = agree(&alone, &alone.space().unwrap(), 200);
    assert!(counts[0] > 3 && counts[1] > 100, "{counts:?}");
    // Trees with joints of all kinds.
    let mut rng = Rng::seed(8);
    let mut sum = [0, 0];
    for count in 4..12 {
        let Ok(arm) = Arm::new(&random_tree(&mut rng, count), clutter()) else { continue };
        let counts = agree(&arm, &arm.space().unwrap(), 30);
        sum = [sum[0] + counts[0], sum[1] + counts[1]];
    }
    assert!(sum.into_iter().all(|n| n > 10), "{sum:?}");
}

#[test]
fn it_sees_thin_walls_and_edges_whose_ends_are_free() {
    let sheet = obstacle("wall", cuboid(1e-7, 4.0, 4.0).unwrap(), [0.35, 0.0, 0.0, 0.2, 0.1, 0.0]);
    let plane = sheet.2;
    let mut arm = Arm::new(&six(), [sheet]).unwrap();
    let space: Joints<Six> = arm.space().unwrap();
    let mut verifier = ArmVerifier::new(&space, &arm).unwrap();
    let mut rng = Rng::seed(3);
    for [a, b] in across(&mut arm, &space, &plane, 100, &mut rng) {
        assert!(!verifier.check_motion(&a, &b).is_free());
    }
    // A pole between two free ends.
    let pole = obstacle("pole", cuboid(0.05, 0.05, 2.0).unwrap(), [0.5, 0.0, 0.5, 0.0, 0.0, 0.0]);
    let mut arm = Arm::new(&six(), [pole]).unwrap();
    let mut verifier = ArmVerifier::new(&space, &arm).unwrap();
    let at = |turn: f64| Six::from([turn, 1.2, 0.4, 0.0, 0.0, 0.0]);
    assert!(arm.is_valid(&at(-1.0)) && arm.is_valid(&at(1.0)));
    let found = verifier.check_motion(&at(-1.0), &at(1.0));
    let MotionCheck::Collision { at: t } = found else { panic!("{found:?}") };
    assert!(!arm.is_valid(&space.interpolate(&at(-1.0), &at(1.0), t)));
    assert!(verifier.check_motion(&at(1.0), &at(2.0)).is_free());
    assert_eq!(verifier.check_motion(&at(0.0), &at(0.0)), MotionCheck::Collision { at: 0.0 });
}

/// What is near an obstacle, and touches another one, collides, whichever is asked about first.
#[test]
fn an_end_that_touches_collides_where_another_obstacle_is_near() {
    let tolerance = 1e-3;
    let block =
        |name: &str, x: f64| obstacle(name, cuboid(0.1, 0.05, 0.05).unwrap(), [x, 0.0, 0.5, 0.0, 0.0, 0.0]);
    let (near, touching) = (block("near", 0.1 + 0.5 * tolerance), block("touching", -0.09));
    for obstacles in [[near.clone(), touching.clone()], [touching, near]] {
        let arm = Arm::new(&six(), obstacles).unwrap();
        let space: Joints<Six> = arm.space().unwrap();
        let mut verifier = ArmVerifier::with_tolerance(&space, &arm, tolerance).unwrap();
        let up = Six::zeros();
        assert_eq!(verifier.check_motion(&up, &up), MotionCheck::Collision { at: 0.0 });
    }
}

/// Polynomials: for each piece one for each coordinate.
struct Pieces(Vec<Vec<[f64; 6]>>);

impl Curve for Pieces {
    fn pieces(&self) -> usize {
        self.0.len()
    }
    fn polynomial(&self, piece: usize, coordinate: usize) -> [f64; 6] {
        self.0[piece][coordinate]
    }
}

impl Pieces {
    /// Four pieces, one after the other, each of which bends away from the straight motion by up to `bend` (rad).
    fn random(rng: &mut Rng, space: &Joints<Configuration>, bend: f64) -> Self {
        let mut from = space.sample_uniform(rng);
        let piece = |_| {
            let to = space.interpolate(&from, &space.sample_uniform(rng), 0.4);
            let bent = |(a, b): (&f64, &f64)| {
                // Bent by u²·(1 − u), and u³·(1 − u)².
                let [x, y] = [bend, 4.0 * bend].map(|most| most * rng.random_range(-1.0..1.0));
                [*a, b - a, 6.0 * x, y - 6.0 * x, -2.0 * y, y]
            };
            let row = from.iter().zip(to.iter()).map(bent).collect();
            from = to;
            row
        };
        Self((0..4).map(piece).collect())
    }

    /// The state at a fraction of all pieces.
    fn at(&self, t: f64) -> Configuration {
        let x = t * self.0.len() as f64;
        let piece = (x as usize).min(self.0.len() - 1);
        let u = x - piece as f64;
        let value = |c: &[f64; 6]| (0..6).map(|i| c[i] * mp_math::powi(u, i as i32)).sum::<f64>();
        self.0[piece].iter().map(value).collect()
    }
}

/// Curves are proved, and refuted where dense samples first find contact.
#[test]
fn curves_are_proved_and_their_first_fault_is_found() {
    let mut arm = Arm::new(&six(), clutter()).unwrap();
    let space: Joints<Configuration> = arm.space().unwrap();
    let mut verifier = ArmVerifier::new(&space, &arm).unwrap();
    let (mut rng, mut counts) = (Rng::seed(44), [0; 3]);
    for case in 0..crate::common::cases_of(400) {
        let curve = Pieces::random(&mut rng, &space, [0.0, 0.2, 1.0][case % 3]);
        let samples = |arm: &mut Arm, until: f64| {
            let mut states = (0..=2000).map(|k| curve.at(until * f64::from(k) / 2000.0));
            states.all(|q| arm.is_valid(&q))
        };
        match verifier.check_curve(&curve).unwrap() {
            MotionCheck::Free { clearance } => {
                counts[0] += 1;
                assert!(clearance >= verifier.tolerance() * (1.0 - 1e-9));
                for k in 0..=200 {
                    assert!(arm.clearance(&curve.at(f64::from(k) / 200.0), 1e9) >= clearance - 1e-9);
                }
            }
            MotionCheck::Collision { at } => {
                counts[1] += 1;
                assert!(!arm.is_valid(&curve.at(at)), "{case}");
                // The first contact is found to a thousandth of a piece.
                assert!(samples(&mut arm, (at - 0.5e-3).max(0.0)) || at == 0.0, "{case}: {at}");
            }
            MotionCheck::Unproven { at } => {
                counts[2] += 1;
                assert!(arm.clearance(&curve.at(at), 1.0) < 2.0 * arm.tolerance());
                assert!(samples(&mut arm, (at - 0.5e-3).max(0.0)), "{case}: {at}");
            }
        }
    }
    assert!(counts[0] > 20 && counts[1] > 100, "{counts:?}");
    // A pole that only the bent motion meets, in the middle of the second piece.
    let pole = obstacle("pole", cuboid(0.05, 0.05, 2.0).unwrap(), [0.5, 0.0, 0.5, 0.0, 0.0, 0.0]);
    let arm = Arm::new(&six(), [pole]).unwrap();
    let mut verifier = ArmVerifier::new(&space, &arm).unwrap();
    let still = |x: f64| [x, 0.0, 0.0, 0.0, 0.0, 0.0];
    let rest = [still(1.2), still(0.4), still(0.0), still(0.0), still(0.0)];
    let turn = |c: [f64; 6]| [&[c][..], &rest].concat();
    let around = |by: f64| Pieces(vec![turn(still(1.0)), turn([1.0, -by, by, 0.0, 0.0, 0.0])]);
    assert!(verifier.check_curve(&around(0.4)).unwrap().is_free());
    let MotionCheck::Collision { at } = verifier.check_curve(&around(4.0)).unwrap() else { panic!() };
    assert!((0.5..0.75).contains(&at), "{at}");
    for x in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(!verifier.check_curve(&Pieces(vec![turn([0.0, x, 0.0, 0.0, 0.0, 0.0])])).unwrap().is_free());
    }
}

#[test]
fn it_refuses_what_is_no_motion() {
    let arm = Arm::new(&six(), clutter()).unwrap();
    let space: Joints<Configuration> = arm.space().unwrap();
    let mut verifier = ArmVerifier::new(&space, &arm).unwrap();
    let zero = Configuration::zeros(6);
    for x in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(!verifier.check_motion(&zero, &[x; 6].into()).is_free());
    }
    assert!(!verifier.check_motion(&Configuration::zeros(5), &Configuration::zeros(5)).is_free());
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(ArmVerifier::with_tolerance(&space, &arm, tolerance).is_err());
    }
    assert!(verifier.check_motion(&zero, &zero).is_free() && verifier.parts() > 0);
}

#[test]
fn contacts_are_named() {
    let wall = obstacle("wall", cuboid(0.2, 2.0, 2.0).unwrap(), [0.9, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let mut arm = Arm::new(&six(), [wall]).unwrap();
    // Stretched out toward the wall at a height of 0.3 m: the tool ends at 0.42 + 0.32 + 0.11 + 0.09 + 0.1 m.
    let q = Six::from([0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0, 0.0]);
    let contacts = arm.explain(q.as_slice());
    let names: Vec<_> = contacts.iter().map(|c| (c.link.as_str(), c.other.as_str())).collect();
    // The link between is inside the wall, and touches its surface nowhere.
    assert_eq!(names, [("roll", "wall"), ("pitch", "wall"), ("tool", "wall")]);
    assert!(contacts.iter().all(|c| !c.with_itself && c.depth > 0.01 && c.depth < 0.3), "{contacts:?}");
    // Alone it hits itself only, wherever it is not free.
    let mut alone = arm.among([]).unwrap();
    let space: Joints<Six> = alone.space().unwrap();
    let mut rng = Rng::seed(6);
    let mut hits = 0;
    for _ in 0..300 {
        let q = space.sample_uniform(&mut rng);
        let contacts = alone.explain(q.as_slice());
        assert_eq!(contacts.is_empty(), alone.is_valid(&q));
        assert!(contacts.iter().all(|c| c.with_itself && c.depth >= 0.0), "{contacts:?}");
        hits += usize::from(!contacts.is_empty());
    }
    assert!(hits > 3);
    let free = Six::from([3.0, 0.3, 0.3, 0.0, 0.3, 0.0]);
    assert!(arm.explain(free.as_slice()).is_empty() && arm.is_valid(&free));
    assert!(arm.explain(&[0.0; 5]).is_empty() && arm.explain(&[f64::NAN; 6]).is_empty());
}

#[test]
fn nearest_free_is_free_and_near() {
    let mut arm = Arm::new(&six(), clutter()).unwrap();
    let space: Joints<Six> = arm.space().unwrap();
    let (mut rng, margin) = (Rng::seed(23), arm.tolerance());
    let mut tried = 0;
    while tried < 10 {
        let q = space.sample_uniform(&mut rng);
        if arm.clearance(&q, margin) >= margin {
            assert_eq!(arm.nearest_free(&q, &space, margin), Some(q));
            continue;
        }
        tried += 1;
        let free = arm.nearest_free(&q, &space, margin).unwrap();
        assert!(arm.clearance(&free, 1.0) >= margin && space.contains(&free));
        assert_eq!(arm.nearest_free(&q, &space, margin), Some(free));
        let samples = (0..2000).map(|_| space.sample_uniform(&mut rng)).collect::<Vec<_>>();
        let valid = samples.iter().filter(|p| arm.is_valid(*p));
        let best = valid.map(|p| space.distance(&q, p)).fold(f64::INFINITY, f64::min);
        assert!(space.distance(&q, &free) <= 1.2 * best);
    }
    // In a cage that holds it fast.
    let cage = obstacle("cage", cuboid(0.1, 0.1, 0.2).unwrap(), [0.0, 0.0, 0.3, 0.0, 0.0, 0.0]);
    let mut caged = arm.among([cage]).unwrap();
    assert_eq!(caged.nearest_free(&Six::zeros(), &space, margin), None);
    assert_eq!(caged.nearest_free(&Six::repeat(f64::NAN), &space, margin), None);
}

#[test]
fn held_joints_are_where_they_are_for_both() {
    let mut model = six();
    model.joints[2].kind = mp_robot::JointKind::Revolute { low: 0.9, high: 0.9 };
    model.joints[4] = model.joints[4].clone().mimic("joint 3", -0.5, 0.1);
    let arm = Arm::new(&model, clutter()).unwrap();
    let counts = agree(&arm, &arm.space().unwrap(), 150);
    assert!(counts.into_iter().all(|n| n > 15), "{counts:?}");
}

/// A base of the shape `first`, a stalk that turns, and a hand of the shape `last` that slides out of the base.
fn slider(first: &TriMesh, last: &TriMesh) -> ArmModel {
    let here = Isometry3::identity();
    let stalk = cuboid(0.02, 0.02, 0.02).unwrap();
    let joint = |name: &str, [parent, child]: [&str; 2], kind| {
        Joint::new(name, parent, child, kind).axis(Vector3::x())
    };
    ArmModel {
        links: vec![
            Link::new("base").with(first, &here),
            Link::new("stalk").with(&stalk, &Isometry3::translation(0.0, 0.0, 3.0)),
            Link::new("hand").with(last, &here),
        ],
        joints: vec![
            joint("turn", ["base", "stalk"], JointKind::Revolute { low: -0.1, high: 0.1 }),
            joint("slide", ["stalk", "hand"], JointKind::Prismatic { low: -3.0, high: 3.0 }),
        ],
        ..ArmModel::default()
    }
}

/// What checker and verifier say of the motion from `q` to `to`.
fn judged(arm: &Arm, q: [f64; 2], to: [f64; 2]) -> bool {
    let space: Joints<Configuration> = arm.space().unwrap();
    let mut arm = arm.clone();
    let [q, to] = [q, to].map(Configuration::from);
    let free = arm.is_valid(&q);
    assert_eq!((arm.clearance(&q, 1.0) > 0.0, arm.clearance(&q, 0.0) > 0.0), (free, free));
    let contacts = arm.explain(q.as_slice());
    assert!(contacts.is_empty() == free && contacts.iter().all(|c| c.depth > 0.0), "{contacts:?}");
    let mut certified = Certified::new(&space, arm.clone(), arm.tolerance()).unwrap();
    let mut verifier = ArmVerifier::new(&space, &arm).unwrap();
    for (from, to) in [(&q, &to), (&to, &q), (&q, &to)] {
        assert_eq!(certified.check_motion(from, to).is_free(), free);
        assert_eq!(verifier.check_motion(from, to).is_free(), free);
    }
    free
}

/// Links in links, links in obstacles and obstacles in links.
#[test]
fn solids_have_an_inside_and_surfaces_have_none() {
    let pebble = sphere(0.1, 2).unwrap();
    let (inside, near) = ([0.01, 0.2], [-0.02, 0.25]);
    for solid in [cuboid(1.0, 1.2, 1.4).unwrap(), sphere(0.7, 2).unwrap(), cylinder(0.7, 1.0, 16).unwrap()] {
        for (around, free) in [(solid.clone(), false), (solid.into_surface(), true)] {
            for inner in [pebble.clone(), pebble.clone().into_surface()] {
                for (first, last) in [(&around, &inner), (&inner, &around)] {
                    // Both links collide where one is in the other, but not elsewhere, so that the pair is compared.
                    let arm = Arm::new(&slider(first, last), []).unwrap();
                    assert_eq!(arm.checked_pairs(), [["base", "hand"]]);
                    assert_eq!(judged(&arm, inside, near), free);
                    assert!(judged(&arm, [0.0, 2.0], [0.1, 2.9]));
                    let named = arm.clone().enclosures(&inside);
                    assert_eq!(named.len(), usize::from(free), "{named:?}");
                }
                let it = |mesh: &TriMesh| [obstacle("it", mesh.clone(), [2.0, 0.0, 0.0, 0.0, 0.0, 0.0])];
                for (hand, other) in [(&inner, &around), (&around, &inner)] {
                    let arm = Arm::new(&slider(&cuboid(0.1, 0.1, 0.1).unwrap(), hand), it(other)).unwrap();
                    assert_eq!(judged(&arm, [0.01, 1.95], [0.02, 2.05]), free);
                    let named = arm.clone().enclosures(&[0.01, 1.95]);
                    assert_eq!(named.len(), usize::from(free), "{named:?}");
                    let mut floating = slider(&cuboid(0.1, 0.1, 0.1).unwrap(), hand);
                    let corner = nalgebra::Point3::new(4.0, 4.0, 4.0);
                    floating.floating = Some(mp_geom::Aabb::new(-corner, corner));
                    let mut arm = Arm::new(&floating, it(other)).unwrap();
                    let space = arm.floating_space().unwrap();
                    let q = space.state(&Isometry3::translation(0.0, 0.05, 0.0), &[0.01, 1.95]);
                    let to = space.state(&Isometry3::translation(0.02, 0.0, 0.0), &[0.01, 1.95]);
                    assert_eq!(arm.is_valid(&q), free);
                    let mut verifier = ArmVerifier::new(&space, &arm).unwrap();
                    assert_eq!(verifier.check_motion(&q, &to).is_free(), free);
                }
            }
        }
    }
}

/// A hand that is inside of the base by design is not compared with it: as if they touched.
#[test]
fn links_that_are_always_nested_may_be() {
    let (block, pebble) = (cuboid(9.0, 9.0, 9.0).unwrap(), sphere(0.1, 1).unwrap());
    let mut model = slider(&block, &pebble);
    model.links[1].shapes.clear();
    let arm = Arm::new(&model, []).unwrap();
    assert!(arm.checked_pairs().is_empty() && judged(&arm, [0.0, 0.3], [0.1, 2.0]));
    // Inside of a surface they are apart, and compared.
    let arm = Arm::new(&slider(&block.into_surface(), &pebble), []).unwrap();
    assert_eq!(arm.checked_pairs(), [["base", "hand"]]);
}
