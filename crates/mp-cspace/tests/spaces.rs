//! Every space and metric of the crate against the conformance kit and under proptest.

use mp_cspace::angle::{angle_difference, wrap_angle};
use mp_cspace::nn::Embed;
use mp_cspace::space_time::{ForwardInTime, SpaceTime};
use mp_cspace::testkit::{SpaceKit, check_local_planner, check_true_metric};
use mp_cspace::*;
use nalgebra::{Isometry3, Point2, Point3, SVector, UnitQuaternion, Vector3, Vector4};
use proptest::prelude::*;
use proptest::test_runner;
use std::fmt::Debug;

/// The torus of `N` angles.
fn circles<const N: usize>() -> Joints<SVector<f64, N>> {
    Joints::circles(N).unwrap()
}

type Ok = Result<(), TestCaseError>;

/// The kit, the true-metric axioms, and the straight planner on one space.
fn conforms<C: Space + TrueMetric>(space: &C, kit: SpaceKit) {
    kit.run(space);
    let mut rng = mp_cspace::Rng::seed(9);
    let states: Vec<_> = (0..40).map(|_| space.sample_uniform(&mut rng)).collect();
    check_true_metric(space, &states, 1e-12);
    let check = Discrete::new(space, |_: &C::State| true, Length::Fraction(0.1)).unwrap();
    if kit == SpaceKit::new() {
        check_local_planner(space, &mut Straight::new(space, check), 0.3 * space.extent(), 4);
    }
}

/// Uphill is farther than downhill: what a tree from the goal adds costs what it costs in forward time.
#[test]
fn straight_motions_cost_their_distance_in_forward_time() {
    type Point = nalgebra::Vector2<f64>;
    let uphill =
        MetricFn::new(|a: &Point, b: &Point| (b - a).norm() + 3.0 * (b.y - a.y).max(0.0), 4.5).unwrap();
    let space = WithMetric::new(Rn::<2>::new([0.0; 2], [1.0; 2]).unwrap(), uphill);
    let (low, high) = (Point::new(0.5, 0.25), Point::new(0.5, 0.75));
    let check = Discrete::new(&space, |_: &Point| true, Length::Fraction(0.1)).unwrap();
    let mut planner = Straight::new(&space, check);
    let mut cost =
        |from: &Point, to: &Point, direction, reach| match planner.extend(from, to, direction, reach) {
            Extension::Advanced(motion) | Extension::Reached(motion) => (motion.end, motion.cost),
            Extension::Trapped => panic!("all is free"),
        };
    let (up, down) = (2.0, 0.5);
    assert_eq!(cost(&low, &high, Direction::Forward, Reach::Full), (high, up));
    assert_eq!(cost(&low, &high, Direction::Backward, Reach::Full), (high, down));
    assert_eq!(cost(&high, &low, Direction::Backward, Reach::Full), (low, up));
    // Half of the way.
    let middle = Point::new(0.5, 0.5);
    assert_eq!(cost(&low, &high, Direction::Forward, Reach::Step(0.5 * up)), (middle, 0.5 * up));
    assert_eq!(cost(&low, &high, Direction::Backward, Reach::Step(0.5 * up)), (middle, 0.5 * down));
    assert_eq!(cost(&high, &low, Direction::Backward, Reach::Step(0.5 * down)), (middle, 0.5 * up));
}

/// The axioms on three states and two times chosen by proptest, which shrinks to simple ones.
fn axioms<S: Clone + Debug + PartialEq + Send + Sync>(
    space: &dyn Space<State = S>,
    u: &[Vec<f64>; 3],
    t: f64,
) -> Ok {
    let [a, b, c] = [0, 1, 2].map(|i| space.unit_cube_to_state(&u[i]));
    let slack = 1e-12 * space.extent();
    let (ab, bc, ac) = (space.distance(&a, &b), space.distance(&b, &c), space.distance(&a, &c));
    prop_assert!(ac <= ab + bc + slack);
    prop_assert!((ab - space.distance(&b, &a)).abs() <= slack);
    prop_assert!(ab <= space.extent() + slack);
    let m = space.interpolate(&a, &b, t);
    prop_assert!(space.contains(&m));
    prop_assert!(space.distance(&m, &space.interpolate(&b, &a, 1.0 - t)) <= slack);
    Ok(())
}

/// As [`axioms`], with constant speed.
fn geodesic_axioms<S: Clone + Debug + PartialEq + Send + Sync>(
    space: &dyn Space<State = S>,
    u: &[Vec<f64>; 3],
    t: f64,
) -> Ok {
    let [a, b] = [0, 1].map(|i| space.unit_cube_to_state(&u[i]));
    let (d, m) = (space.distance(&a, &b), space.interpolate(&a, &b, t));
    prop_assert!((space.distance(&a, &m) - t * d).abs() <= 1e-12 * space.extent());
    prop_assert!((space.distance(&m, &b) - (1.0 - t) * d).abs() <= 1e-12 * space.extent());
    axioms(space, u, t)
}

fn cube_points(dim: usize) -> impl Strategy<Value = [Vec<f64>; 3]> {
    let coordinate =
        prop_oneof![4 => 0.0..1.0f64, 1 => Just(0.0), 1 => Just(0.5), 1 => Just(1.0 - f64::EPSILON)];
    prop::array::uniform3(prop::collection::vec(coordinate, dim))
}

/// Three states and a time that `axioms` refuses, as simple ones as there are, fail the test.
fn for_all(dim: usize, axioms: &dyn Fn(&[Vec<f64>; 3], f64) -> Ok) {
    let mut runner = test_runner::TestRunner::new(ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(300)
    });
    let found = runner.run(&(cube_points(dim), 0.0..=1.0f64), |(u, t)| axioms(&u, t));
    found.unwrap_or_else(|e| panic!("{e}"));
}

/// One kit test and one property test per space.
macro_rules! spaces {
    ($($name:ident: $space:expr, $kit:expr, $axioms:ident;)*) => {$(
        mod $name {
            use super::*;
            #[test]
            fn conforms_to_the_kit() {
                conforms(&$space, $kit);
            }
            #[test]
            fn obeys_the_axioms() {
                let space = $space;
                for_all(space.dim(), &|u, t| $axioms(&space, u, t));
            }
        }
    )*};
}

fn hull() -> Vec<Point3<f64>> {
    vec![Point3::new(0.3, 0.1, 0.0), Point3::new(-0.2, 0.4, 0.1), Point3::new(0.0, -0.3, 0.5)]
}
fn r3() -> Rn<3> {
    Rn::new([-1.0, 0.0, 5.0], [1.0, 0.5, 25.0]).unwrap()
}
/// Intervals of radians and metres, and circles.
fn joints<Q: Coordinates>() -> Joints<Q> {
    let interval = |low, high| JointRange::Interval { low, high };
    let ranges = [interval(-6.2, 6.2), JointRange::Circle, interval(0.1, 0.4), JointRange::Circle];
    Joints::new(ranges).unwrap()
}
fn floating() -> FloatingJoints {
    FloatingJoints::new(se3(), joints()).unwrap()
}
fn se2() -> Se2 {
    Se2::new([-1.0, -2.0], [3.0, 4.0]).unwrap()
}
fn se3() -> Se3 {
    Se3::new([-1.0, -2.0, 0.0], [3.0, 4.0, 5.0]).unwrap()
}

spaces! {
    rn: r3(), SpaceKit::new(), geodesic_axioms;
    rn_far_from_zero: Rn::<2>::new([1e9, -1e9], [1e9 + 1.0, -1e9 + 3.0]).unwrap(), SpaceKit::new().tolerance(1e-6), axioms;
    rn_dyn: Joints::<Configuration>::intervals(&[0.0; 7], &[2.0; 7]).unwrap(), SpaceKit::new(), geodesic_axioms;
    so2: circles::<1>(), SpaceKit::new(), geodesic_axioms;
    so3: So3, SpaceKit::new(), geodesic_axioms;
    se2_space: se2(), SpaceKit::new(), geodesic_axioms;
    se3_space: se3(), SpaceKit::new(), geodesic_axioms;
    se3_heavy: se3().with_rotation_weight(30.0).unwrap(), SpaceKit::new(), geodesic_axioms;
    torus: circles::<3>(), SpaceKit::new(), geodesic_axioms;
    joints_static: joints::<Vector4<f64>>(), SpaceKit::new(), geodesic_axioms;
    joints_dynamic: joints::<Configuration>(), SpaceKit::new(), geodesic_axioms;
    joints_manhattan: WithMetric::new(joints::<Vector4<f64>>(), Manhattan), SpaceKit::new(), geodesic_axioms;
    floating_joints: floating(), SpaceKit::new(), geodesic_axioms;
    floating_scaled: WithMetric::new(floating(), ScaledEuclidean::new(&floating(), [1.0, 2.0, 1.0, 0.3, 0.5, 0.1, 1.0, 2.0]).unwrap()), SpaceKit::new(), geodesic_axioms;
    product: Product::new(se2(), 1.0, circles::<2>(), 0.25).unwrap(), SpaceKit::new(), geodesic_axioms;
    nested: Product::new(Product::new(So3, 0.1, circles::<1>(), 1.0).unwrap(), 2.0, r3(), 1.0).unwrap(), SpaceKit::new(), geodesic_axioms;
    euclidean: WithMetric::new(se3(), Euclidean), SpaceKit::new(), geodesic_axioms;
    manhattan: WithMetric::new(Product::new(se3(), 1.0, circles::<1>(), 1.0).unwrap(), Manhattan), SpaceKit::new(), geodesic_axioms;
    scaled: WithMetric::new(se3(), ScaledEuclidean::new(&se3(), [1.0, 2.0, 1.0, 0.3]).unwrap()), SpaceKit::new(), geodesic_axioms;
    displacement: WithMetric::new(se3(), MaxDisplacement::new(hull()).unwrap()), SpaceKit::new().any_speed(), axioms;
    planar_displacement: WithMetric::new(se2(), MaxDisplacement::planar([Point2::new(0.5, 0.0), Point2::new(0.0, 0.2)]).unwrap()), SpaceKit::new().any_speed(), axioms;
}

/// Equation 6 at points of the body, not only at its vertices.
#[test]
fn displacement_is_attained_at_a_vertex() {
    let metric = MaxDisplacement::new(hull()).unwrap();
    let nowhere = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert!(
        metric.distance(&se3(), &nowhere, &Isometry3::identity()).is_nan(),
        "it would be near everything"
    );
    let mut rng = mp_cspace::Rng::seed(3);
    let space = se3();
    for _ in 0..1000 {
        let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
        let d = metric.distance(&se3(), &a, &b);
        let moved = |p: Point3<f64>| (a * p - b * p).norm();
        let vertices = hull().into_iter().map(moved).fold(0.0, f64::max);
        assert!((d - vertices).abs() < 1e-12);
        let inner = hull().iter().fold(Point3::origin(), |sum, p| sum + p.coords / 3.0);
        assert!(moved(inner) <= d + 1e-12);
    }
    let turned =
        Isometry3::from_parts(Vector3::zeros().into(), UnitQuaternion::from_euler_angles(0.0, 0.0, 3.0));
    assert!(metric.distance(&se3(), &Isometry3::identity(), &turned) > 0.6);
}

/// The default distance of SE(3) is position plus half the angle.
#[test]
fn se3_weighs_half_a_metre_per_radian() {
    let a = Isometry3::identity();
    let b = Isometry3::new(Vector3::new(0.0, 2.0, 0.0), Vector3::new(1.5, 0.0, 0.0));
    assert!((se3().distance(&a, &b) - 2.75).abs() < 1e-15);
    assert!((se3().extent() - (77.0_f64.sqrt() + std::f64::consts::FRAC_PI_2)).abs() < 1e-14);
    let (c, d) = (Se2State::new(0.0, 0.0, 3.0), Se2State::new(3.0, 4.0, -3.0));
    assert!((se2().distance(&c, &d) - 5.0 - 0.5 * (std::f64::consts::TAU - 6.0)).abs() < 1e-14);
}

#[test]
fn bad_parameters_are_errors() {
    let nan = f64::NAN;
    assert!(matches!(Rn::new([0.0, nan], [1.0, 1.0]), Err(SpaceError::NotFinite { axis: 1, .. })));
    assert!(matches!(Rn::new([0.0, 1.0], [1.0, 1.0]), Err(SpaceError::EmptyRange { axis: 1, .. })));
    assert!(matches!(Rn::new([0.0], [f64::INFINITY]), Err(SpaceError::NotFinite { axis: 0, .. })));
    assert!(matches!(Rn::new([-1e300], [1e300]), Err(SpaceError::NotFinite { .. })));
    assert!(matches!(Rn::<0>::new([], []), Err(SpaceError::Empty { .. })));
    assert!(matches!(Joints::<Configuration>::intervals(&[0.0], &[1.0, 2.0]), Err(SpaceError::Count { .. })));
    let interval = |low, high| JointRange::Interval { low, high };
    assert!(matches!(Joints::<Vector3<f64>>::new([JointRange::Circle]), Err(SpaceError::Count { .. })));
    assert!(matches!(Joints::<Configuration>::new([]), Err(SpaceError::Empty { .. })));
    let one = |range| Joints::<Configuration>::new([JointRange::Circle, range]);
    assert!(matches!(one(interval(0.3, 0.3)), Err(SpaceError::EmptyRange { axis: 1, .. })));
    assert!(matches!(one(interval(nan, 0.3)), Err(SpaceError::NotFinite { axis: 1, .. })));
    assert!(Se2::new([0.0, 0.0], [1.0, 0.0]).is_err() && Se3::new([0.0; 3], [1.0, nan, 1.0]).is_err());
    for w in [0.0, -1.0, nan, f64::INFINITY] {
        assert!(matches!(se3().with_rotation_weight(w), Err(SpaceError::Weight { .. })));
        assert!(matches!(se2().with_rotation_weight(w), Err(SpaceError::Weight { .. })));
        assert!(
            Product::new(circles::<1>(), w, So3, 1.0).is_err()
                && Product::new(circles::<1>(), 1.0, So3, w).is_err()
        );
        assert!(ScaledEuclidean::new(&circles::<1>(), [w]).is_err());
        assert!(MetricFn::new(|_: &f64, _: &f64| 1.0, w).is_err());
    }
    assert!(matches!(
        ScaledEuclidean::new(&se3(), [1.0; 6]),
        Err(SpaceError::Count { expected: 4, found: 6, .. })
    ));
    assert!(matches!(MaxDisplacement::new([]), Err(SpaceError::Empty { .. })));
    assert!(MaxDisplacement::new([Point3::new(nan, 0.0, 0.0)]).is_err());
    assert_eq!(
        Rn::new([0.0, 3.0], [1.0, 2.0]).unwrap_err().to_string(),
        "axis 1 is empty: its lower bound 3 must be below its upper bound 2"
    );
}

/// Intervals alone equal a box, to the bit; circles alone measure the shorter arcs; mixtures combine both.
#[test]
fn joints_are_boxes_and_tori() {
    let mut rng = mp_cspace::Rng::seed(4);
    let torus = circles::<3>();
    let intervals = Joints::intervals(&[-1.0, 0.0, 5.0], &[1.0, 0.5, 25.0]).unwrap();
    for t in [0.0, 0.25, 0.7, 1.0] {
        let (a, b) = (torus.sample_uniform(&mut rng), torus.sample_uniform(&mut rng));
        let arcs = Vector3::from_fn(|i, _| angle_difference(a[i], b[i]));
        assert!((torus.distance(&a, &b) - arcs.norm()).abs() < 1e-14);
        let gap = torus.interpolate(&a, &b, t) - (a + arcs * t).map(wrap_angle);
        assert!(gap.amax() < 1e-14, "{gap}");
        let (a, b) = (r3().sample_uniform(&mut rng), r3().sample_uniform(&mut rng));
        assert_eq!(intervals.distance(&a, &b), r3().distance(&a, &b));
        assert_eq!(intervals.interpolate(&a, &b, t), r3().interpolate(&a, &b, t));
    }
    // An interval wider than a turn does not go round.
    let (a, b) = (Vector4::new(-6.0, 3.0, 0.2, -3.0), Vector4::new(6.0, -3.0, 0.2, 3.0));
    let short = std::f64::consts::TAU - 6.0;
    let space = joints::<Vector4<f64>>();
    assert!((space.distance(&a, &b) - (144.0 + 2.0 * short * short).sqrt()).abs() < 1e-14);
    assert_eq!(space.interpolate(&a, &b, 0.5)[0], 0.0);
    assert!(space.interpolate(&a, &b, 0.5)[1].abs() > 3.13);
    let wrapped = space.wrapped(&Vector4::new(6.5, 6.5, 9.0, -6.5));
    assert!((wrapped - Vector4::new(6.5, 6.5 - short - 6.0, 9.0, 6.0 + short - 6.5)).norm() < 1e-14);
}

/// A floating base with joints is the product of both spaces, with its states in one list.
#[test]
fn floating_joints_are_a_product() {
    let (list, pair) = (floating(), Product::new(se3(), 1.0, joints::<Configuration>(), 1.0).unwrap());
    let flat = |q: &(Isometry3<f64>, Configuration)| list.state(&q.0, q.1.as_slice());
    assert_eq!((list.dim(), list.factors()), (pair.dim(), pair.factors()));
    assert!((list.extent() - pair.extent()).abs() < 1e-12);
    for seed in 0..100 {
        let mut rng = mp_cspace::Rng::seed(seed);
        let (a, b, c) =
            (pair.sample_uniform(&mut rng), pair.sample_uniform(&mut rng), pair.sample_uniform(&mut rng));
        assert_eq!(flat(&a), list.sample_uniform(&mut mp_cspace::Rng::seed(seed)));
        assert!((pair.distance(&a, &b) - list.distance(&flat(&a), &flat(&b))).abs() < 1e-12);
        assert_eq!(flat(&pair.interpolate(&a, &b, 0.3)), list.interpolate(&flat(&a), &flat(&b), 0.3));
        let mut factors = [Vec::new(), Vec::new()];
        pair.each_factor(&a, &b, &mut |i, d| factors[0].push((i, d)));
        list.each_factor(&flat(&a), &flat(&b), &mut |i, d| factors[1].push((i, d)));
        assert_eq!(factors[0], factors[1]);
        for factor in 0..list.factors() {
            let (mut out, mut listed) = (c.clone(), flat(&c));
            pair.interpolate_factor(factor, &a, &b, 0.7, &mut out);
            list.interpolate_factor(factor, &flat(&a), &flat(&b), 0.7, &mut listed);
            assert_eq!(flat(&out), listed);
        }
        let mut velocity = vec![0.0; list.dim()];
        assert!(list.velocity_into(&flat(&a), &flat(&b), &mut velocity));
        let there = list.moved(&flat(&a), &velocity, 1.0).unwrap();
        assert!(list.distance(&there, &flat(&b)) < 1e-9);
        // The base goes alone when what turns is the same.
        let beside = list.with_rotation_of(&flat(&b), &flat(&a));
        let middle = list.interpolate(&flat(&a), &beside, 0.5);
        assert_eq!(middle.as_slice()[3..], flat(&a).as_slice()[3..]);
        assert_eq!(beside.as_slice()[..3], flat(&b).as_slice()[..3]);
    }
    let state = flat(&pair.sample_uniform(&mut mp_cspace::Rng::seed(1)));
    let mut long = state.clone();
    long[6] += 0.1;
    let short = Configuration::from(&state.as_slice()[..10]);
    assert!(list.contains(&state) && !list.contains(&long) && !list.contains(&short));
    assert_eq!(FloatingJoints::split(&[0.0; 6]), None);
}

#[test]
fn states_that_are_not_contained() {
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    for x in [nan, inf, -1.5, 1.5] {
        assert!(!r3().contains(&[x, 0.2, 6.0].into()));
    }
    for angle in [nan, inf, 3.2, -3.2, -std::f64::consts::PI] {
        assert!(!circles::<2>().contains(&[0.0, angle].into()));
        assert!(!se2().contains(&Se2State { angle, ..Se2State::default() }));
    }
    assert!(circles::<1>().contains(&[std::f64::consts::PI].into()));
    assert!(!Joints::<Configuration>::intervals(&[0.0; 2], &[1.0; 2]).unwrap().contains(&vec![0.5].into()));
    let long = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(1.1, 0.0, 0.0, 0.0));
    let bad = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(nan, 0.0, 0.0, 0.0));
    assert!(!So3.contains(&long) && !So3.contains(&bad));
    assert!(!se3().contains(&Isometry3::translation(9.0, 0.0, 0.0)));
}

proptest! {
    /// Wrapping keeps the direction and lands in range, wherever the angle comes from.
    #[test]
    fn angles_wrap(angle in prop_oneof![-10.0..10.0f64, -1e6..1e6f64]) {
        let wrapped = wrap_angle(angle);
        prop_assert!(circles::<1>().contains(&[wrapped].into()));
        prop_assert!((mp_math::sin(wrapped) - mp_math::sin(angle)).abs() < 1e-9 && (mp_math::cos(wrapped) - mp_math::cos(angle)).abs() < 1e-9);
        prop_assert!(angle_difference(angle, wrapped).abs() < 1e-9);
    }
}

/// Space and time satisfies the kit except constant speed, which impossible motions lack.
#[test]
fn space_time_conforms() {
    fn conforms<C: Embed>(positions: C) {
        let space = SpaceTime::new(positions, 7.0, 0.6).unwrap();
        SpaceKit::new().any_speed().run(&space);
        testkit::check_nearest_neighbors(&space, &mut <SpaceTime<C> as DefaultNn>::Nn::default(), 400, 3);
        let mut rng = mp_cspace::Rng::seed(5);
        let (mut possible, mut not) = (0, 0);
        for _ in 0..2000 {
            let [a, b, c] = [0; 3].map(|_| space.sample_uniform(&mut rng));
            let slower = space.positions().distance(&a.0, &b.0) <= 0.6 * (b.1 - a.1);
            assert_eq!(space.can_move(&a, &b), slower);
            // A possible motion is shorter than every impossible one, and straight at constant speed.
            if space.can_move(&a, &b) {
                possible += 1;
                let t = 0.37;
                let middle = space.interpolate(&a, &b, t);
                assert!(space.can_move(&a, &middle) && space.can_move(&middle, &b));
                let d = space.distance(&a, &b);
                assert!((space.distance(&a, &middle) - t * d).abs() < 1e-9 * space.extent());
                if !space.can_move(&a, &c) {
                    assert!(d <= space.distance(&a, &c));
                    not += 1;
                }
                if space.can_move(&b, &c) {
                    assert!(space.can_move(&a, &c), "possible motions one after the other are possible");
                    assert!(space.distance(&a, &c) <= d + space.distance(&b, &c) + 1e-12);
                }
            }
        }
        assert!(possible > 100 && not > 100, "{possible} {not}");
    }
    conforms(Rn::<2>::new([0.0; 2], [1.0; 2]).unwrap());
    conforms(Se2::new([0.0; 2], [1.0; 2]).unwrap().with_rotation_weight(0.2).unwrap());
    conforms(Se3::new([0.0; 3], [1.0; 3]).unwrap().with_rotation_weight(0.2).unwrap());
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let line = || Rn::<1>::new([0.0], [1.0]).unwrap();
        assert!(SpaceTime::new(line(), bad, 1.0).is_err() && SpaceTime::new(line(), 1.0, bad).is_err());
    }
}

#[test]
fn nothing_moves_back_in_time_or_too_fast() {
    let space = SpaceTime::new(Rn::<1>::new([0.0], [1.0]).unwrap(), 10.0, 0.5).unwrap();
    let at = |x: f64, t: f64| ([x].into(), t);
    let check = Discrete::new(&space, |_: &(nalgebra::Vector1<f64>, f64)| true, Length::Fraction(0.01));
    let mut check = ForwardInTime { space: &space, check: check.unwrap() };
    assert!(check.check_motion(&at(0.0, 0.0), &at(1.0, 2.0)).is_free());
    assert!(check.check_motion(&at(0.3, 1.0), &at(0.3, 1.0)).is_free());
    for (from, to) in [
        (at(0.0, 0.0), at(1.0, 1.9)),
        (at(0.0, 2.0), at(0.0, 1.0)),
        (at(0.0, 2.0), at(0.1, 2.0)),
        (at(0.0, 0.0), at(f64::NAN, 2.0)),
        (at(0.0, 0.0), at(0.0, f64::NAN)),
    ] {
        assert!(!check.check_motion(&from, &to).is_free(), "{from:?} {to:?}");
    }
    let mut rng = mp_cspace::Rng::seed(1);
    let mut goal = space.at_any_time([0.7].into());
    let q = goal.sample(&mut rng);
    assert!(goal.reached(&q) && space.contains(&q) && !goal.reached(&at(0.71, 3.0)));
}

/// The contract of [`Space::with_rotation_of`], and that wrappers pass it on.
#[test]
fn positions_and_rotations_are_taken_apart() {
    fn holds<C: Space + Clone + Send>(space: &C, turns: bool) {
        let mut rng = mp_cspace::Rng::seed(6);
        let erased = erased::AnySpace::new(space);
        for _ in 0..50 {
            let [p, q] = [(); 2].map(|()| space.sample_uniform(&mut rng));
            let mixed = space.with_rotation_of(&p, &q);
            assert_eq!(mixed != p, turns, "{mixed:?}");
            assert_eq!(erased.with_rotation_of(&p, &q), mixed);
            assert_eq!(space.with_rotation_of(&mixed, &p), p);
            // Interpolation at one rotation does not turn, and at one position does not move.
            let moved = space.interpolate(&mixed, &q, 0.3);
            assert!(space.distance(&space.with_rotation_of(&moved, &q), &moved) < 1e-7);
            let turned = space.interpolate(&p, &mixed, 0.3);
            assert!(space.distance(&space.with_rotation_of(&p, &turned), &turned) < 1e-12);
        }
    }
    holds(&se2(), true);
    holds(&se3(), true);
    holds(&WithMetric::new(se3(), Manhattan), true);
    holds(&r3(), false);
    holds(&joints::<Configuration>(), false);
}
