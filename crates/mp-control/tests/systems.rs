//! Input sets, flows, the planner that chooses among inputs, and the verifiers that replay its edges.

use mp_control::*;
use mp_cspace::testkit::{SpaceKit, check_local_planner, check_nearest_neighbors, check_true_metric};
use mp_cspace::{Rng, *};
use nalgebra::{DVector, SVector, Vector2};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

type Pair<const N: usize> = (SVector<f64, N>, SVector<f64, N>);

fn square() -> Rn<2> {
    Rn::new([0.0; 2], [1.0; 2]).unwrap()
}

/// Free outside the disc in the middle of the square.
fn free(q: &Vector2<f64>) -> bool {
    (q - Vector2::new(0.5, 0.5)).norm() > 0.3
}

fn straight<C: Space>(space: &C) -> Straight<'_, C, Discrete<'_, C, impl FnMut(&C::State) -> bool + use<C>>> {
    Straight::new(space, Discrete::new(space, |_: &C::State| true, Length::Fraction(0.01)).unwrap())
}

/// Extends at random in both orders under the same condition: the same successor, and RSRT tests no more.
fn orders_agree<C, F, U, V>(space: &C, flow: F, inputs: &InputSet<U>, duration: f64, valid: V, seed: u64)
where
    C: Space,
    U: Input,
    F: Flow<C::State, U> + Clone,
    V: Validity<C::State> + Clone,
{
    let make = |order, accept| {
        let check = DiscreteFlowCheck::new(space, valid.clone(), Length::Fraction(0.01)).unwrap();
        let planner = InputPlanner::new(space, flow.clone(), inputs.clone(), duration, check).unwrap();
        planner.ordered(order).accepting(accept)
    };
    let mut verifier =
        ReplayFinely::new(space, flow.clone(), valid.clone(), Length::Fraction(0.001)).unwrap();
    let mut rng = Rng::seed(seed);
    let mut valid = valid.clone();
    let (mut same, mut trapped, mut fewer) = (0, 0, 0);
    for accept in [Accept::Nearer, Accept::Any] {
        let (mut all, mut sorted) = (make(Order::TestAll, accept), make(Order::SortFirst, accept));
        for _ in 0..300 {
            let (from, toward) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            if !valid.is_valid(&from) {
                continue;
            }
            let before = (all.counters().tested, sorted.counters().tested);
            let reach = Reach::Step(f64::INFINITY);
            let a = all.extend(&from, &toward, Direction::Forward, reach);
            let b = sorted.extend(&from, &toward, Direction::Forward, reach);
            assert_eq!(a, b);
            let tests = (all.counters().tested - before.0, sorted.counters().tested - before.1);
            assert!(tests.1 <= tests.0, "RSRT tested more: {tests:?}");
            fewer += u32::from(tests.1 < tests.0);
            match b {
                Extension::Trapped => trapped += 1,
                Extension::Advanced(m) | Extension::Reached(m) => {
                    same += 1;
                    let nearer = space.distance(&m.end, &toward) < space.distance(&from, &toward);
                    assert!(nearer || accept == Accept::Any);
                    // The edge replays to the bit, and no other edge does.
                    let again = flow.integrate(&from, &m.edge.input, m.edge.duration);
                    assert_eq!(again, m.end);
                    let longer = ControlSegment { duration: m.edge.duration * 1.5, ..m.edge.clone() };
                    assert!(!verifier.check_segment(&from, &longer, &m.end).is_free());
                    assert!(!verifier.check_segment(&from, &m.edge, &from).is_free());
                }
            }
        }
        let (all, sorted) = (all.counters(), sorted.counters());
        assert_eq!((all.expansions, all.successors), (sorted.expansions, sorted.successors));
    }
    assert!(same > 100 && fewer > 100, "{same} {trapped} {fewer}");
}

#[test]
fn both_orders_take_the_same_successor() {
    let space = square();
    let inputs = InputSet::grid([0.2, 0.2], 5).unwrap();
    orders_agree(&space, Kinematic::new(&space).unwrap(), &inputs, 1.0, free, 1);
    let space = WithMetric::new(space, Manhattan);
    orders_agree(&space, Kinematic::new(&space).unwrap(), &inputs, 1.0, free, 2);

    let space = Se2::new([0.0; 2], [1.0; 2]).unwrap();
    let valid = |q: &Se2State| free(&q.translation);
    orders_agree(&space, Unicycle, &Unicycle::inputs(0.2, 1.0).unwrap(), 1.0, valid, 3);
    let car = Car::new(0.1).unwrap();
    orders_agree(&space, car, &Car::inputs(0.2, 0.7, 3).unwrap(), 1.0, valid, 4);

    let space = Product::with_velocity(square(), [0.5, 0.5]).unwrap();
    let flow = DoubleIntegrator::new(space.spaces().0).unwrap();
    let inputs = InputSet::grid([0.5, 0.5], 3).unwrap();
    orders_agree(&space, flow, &inputs, 0.4, OnPosition(free), 5);
}

/// The finer verifier accepts the motions that the planner finds free, except where the planner's resolution
/// missed an obstacle.
#[test]
fn verifiers_agree_with_checks_up_to_resolution() {
    let space = Product::with_velocity(square(), [0.5, 0.5]).unwrap();
    let flow = DoubleIntegrator::new(space.spaces().0).unwrap();
    let inputs = InputSet::grid([0.5, 0.5], 3).unwrap();
    let valid = OnPosition(free);
    let check = DiscreteFlowCheck::new(&space, valid.clone(), Length::Fraction(0.001)).unwrap();
    let mut planner = InputPlanner::new(&space, flow, inputs, 0.4, check).unwrap();
    let mut verifier = ReplayFinely::new(&space, flow, valid.clone(), Length::Fraction(1e-4)).unwrap();
    let mut rng = Rng::seed(3);
    let (mut passed, mut refused) = (0, 0);
    for _ in 0..1000 {
        let (from, toward) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
        if !free(&from.0) {
            continue;
        }
        let extension = planner.extend(&from, &toward, Direction::Forward, Reach::Step(1.0));
        let Extension::Advanced(m) = extension else { continue };
        match verifier.check_segment(&from, &m.edge, &m.end).is_free() {
            true => passed += 1,
            false => refused += 1,
        }
    }
    assert!(passed > 300 && refused <= passed / 50, "{passed} {refused}");
}

/// A motion of a full turn ends where it began, and is tested between nevertheless.
#[test]
fn motions_that_come_round_are_tested_on_the_way() {
    let space = Se2::new([-2.0; 2], [2.0; 2]).unwrap();
    let inputs = InputSet::new([[TAU, TAU]]).unwrap();
    let beyond = |q: &Se2State| q.translation.y < 1.0;
    let check = DiscreteFlowCheck::new(&space, beyond, Length::Absolute(0.5)).unwrap();
    let mut planner = InputPlanner::new(&space, Unicycle, inputs, 0.999, check).unwrap();
    let mut verifier = ReplayFinely::new(&space, Unicycle, beyond, Length::Absolute(0.5)).unwrap();
    let (from, toward) = (Se2State::new(0.0, 0.0, 0.0), Se2State::new(0.0, 0.1, 0.0));
    assert_eq!(planner.extend(&from, &toward, Direction::Forward, Reach::Step(1.0)), Extension::Trapped);
    assert_eq!(planner.counters().tested, 1);
    let leg = ControlSegment { input: [TAU, TAU], duration: 0.999 };
    let end = Unicycle.integrate(&from, &leg.input, leg.duration);
    assert!(space.distance(&from, &end) < 0.02);
    assert!(!verifier.check_segment(&from, &leg, &end).is_free());
}

#[test]
fn systems_move_as_their_equations_say() {
    let line = Rn::<1>::new([-100.0], [100.0]).unwrap();
    let falling = DoubleIntegrator::new(&line).unwrap();
    let (q, v): Pair<1> = falling.integrate(&([3.0].into(), [2.0].into()), &-9.81, 2.0);
    assert!((q.x - (3.0 + 4.0 - 0.5 * 9.81 * 4.0)).abs() < 1e-12 && (v.x - (2.0 - 19.62)).abs() < 1e-12);

    let origin = Se2State::default();
    let half_round = Unicycle.integrate(&origin, &[FRAC_PI_2, 1.0], PI);
    assert!((half_round.translation - Vector2::new(0.0, PI)).norm() < 1e-12);
    assert!((half_round.angle.abs() - PI).abs() < 1e-12);
    let ahead = Unicycle.integrate(&origin, &[2.0, 1e-9], 3.0);
    assert!((ahead.translation - Vector2::new(6.0, 9e-9)).norm() < 1e-12);
    // Wheelbase over the tangent of the steering angle is the radius.
    let car = Car::new(2.0).unwrap();
    let quarter = car.integrate(&origin, &[-1.0, mp_math::atan(0.5)], FRAC_PI_2 * 4.0);
    assert!((quarter.translation - Vector2::new(-4.0, 4.0)).norm() < 1e-12, "{quarter:?}");

    // About a fixed axis the integrator of rotations is exact; about several it agrees with small steps.
    let space = Se3::new([-9.0; 3], [9.0; 3]).unwrap();
    let flow = DoubleIntegrator::new(&space).unwrap();
    let rest = (space.interpolate(&Default::default(), &Default::default(), 0.0), SVector::<f64, 6>::zeros());
    let turned = flow.integrate(&rest, &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 1.0);
    assert!((turned.0.rotation.angle() - 0.5).abs() < 1e-15);
    let input = [0.1, 0.0, 0.0, 0.3, -0.2, 0.4];
    let begin = (rest.0, SVector::from([0.0, 0.2, 0.0, 1.0, 0.5, -0.3]));
    let error = |t: f64| {
        let whole = flow.integrate(&begin, &input, t);
        let fine = (0..1000).fold(begin, |s, _| flow.integrate(&s, &input, t / 1000.0));
        space.distance(&whole.0, &fine.0)
    };
    assert!(error(0.2) < 3e-4 && error(0.1) < error(0.2) / 7.0, "{} {}", error(0.2), error(0.1));

    let decay = Rk4::new(|q: &SVector<f64, 1>, u: &f64| -q * *u, 0.1).unwrap();
    assert!((decay.integrate(&[1.0].into(), &1.0, 1.0).x - mp_math::exp(-1.0)).abs() < 1e-6);
}

/// With many joints that are soon too fast, few states have an input that does not leave the space; these are
/// looked for.
#[test]
fn inputs_that_seldom_stay_in_the_space_are_enough() {
    let joints = Rn::new([-1.0; 6], [1.0; 6]).unwrap();
    let space = Product::with_velocity(joints, [1.0; 6]).unwrap();
    let flow = DoubleIntegrator::new(space.spaces().0).unwrap();
    let planner = |duration: f64| {
        let inputs = InputSet::grid([1.6; 6], 2).unwrap();
        let check = DiscreteFlowCheck::new(&space, |_: &_| true, Length::Fraction(0.01)).unwrap();
        InputPlanner::new(&space, flow, inputs, duration, check).map(drop)
    };
    assert!(planner(1.0).is_ok());
    assert!(matches!(planner(3.0), Err(InputError::LeavesSpace { .. })));
}

/// The reversed flow, run forward again, leads back up to rounding.
fn reverses<C: Space, U, F: Flow<C::State, U>>(space: &C, flow: &F, input: &U, time: f64, q: &C::State) {
    let before = flow.reversed(q, input, time).unwrap();
    let gap = space.distance(&flow.integrate(&before, input, time), q);
    assert!(gap <= 1e-9 * space.extent(), "{gap} from {q:?}");
}

proptest! {
    #[test]
    fn flows_can_be_reversed(u in prop::array::uniform12(0.0..1.0_f64), a in prop::array::uniform6(-1.0..1.0_f64), time in 0.01..2.0_f64) {
        let plane = Se2::new([0.0; 2], [1.0; 2]).unwrap();
        let q = plane.unit_cube_to_state(&u);
        reverses(&plane, &Unicycle, &[a[0], a[1]], time, &q);
        reverses(&plane, &Car::new(0.3).unwrap(), &[a[0], a[1]], time, &q);
        reverses(&plane, &Kinematic::new(&plane).unwrap(), &[a[0], a[1], a[2]], time, &q);
        let space = Product::with_velocity(Se2::new([0.0; 2], [1.0; 2]).unwrap(), [1.0; 3]).unwrap();
        let flow = DoubleIntegrator::new(space.spaces().0).unwrap();
        reverses(&space, &flow, &[a[3], a[4], a[5]], time, &space.unit_cube_to_state(&u));
        let poses = Se3::new([0.0; 3], [1.0; 3]).unwrap();
        reverses(&poses, &Kinematic::new(&poses).unwrap(), &a, time, &poses.unit_cube_to_state(&u));
        let space = Product::with_velocity(poses.clone(), [1.0; 6]).unwrap();
        let flow = DoubleIntegrator::new(&poses).unwrap();
        reverses(&space, &flow, &a, time, &space.unit_cube_to_state(&u));
    }
}

#[test]
fn backward_edges_run_forward_to_the_bit_or_are_refused() {
    let space = square();
    let flow = Kinematic::new(&space).unwrap();
    // Rounding spoils most of these...
    let inputs = InputSet::spread([0.2, 0.2], 24).unwrap();
    let mut planner =
        InputPlanner::new(&space, flow, inputs.clone(), 0.7, RecordedFlowCheck(straight(&space))).unwrap();
    let mut verifier =
        ReplayMotions::new(flow, FineDiscrete::new(&space, free, Length::Fraction(1e-3)).unwrap());
    let mut rng = Rng::seed(1);
    for _ in 0..300 {
        let (node, toward) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
        let extension = planner.extend(&node, &toward, Direction::Backward, Reach::Step(1.0));
        if let Extension::Advanced(m) | Extension::Reached(m) = extension {
            assert_eq!(flow.integrate(&m.end, &m.edge.input, m.edge.duration), node);
            let clear = free(&node) && free(&m.end) && free(&((node + m.end) / 2.0));
            assert!(clear || !verifier.check_segment(&m.end, &m.edge, &node).is_free());
        }
    }
    let counters = planner.counters();
    assert!(counters.irreversible > 0 && counters.irreversible < counters.successors);
    // ... and none of those whose edges are the straight motion between.
    let mut planner =
        InputPlanner::new(&space, flow, inputs.clone(), 0.7, LocalFlowCheck(straight(&space))).unwrap();
    let node = Vector2::new(0.4, 0.4);
    let extension = planner.extend(&node, &Vector2::new(0.9, 0.9), Direction::Backward, Reach::Step(1.0));
    assert!(matches!(extension, Extension::Advanced(_)));
    assert_eq!(planner.counters().irreversible, 0);
    // A flow that cannot be reversed has no backward successors.
    let one_way = |q: &Vector2<f64>, u: &Vector2<f64>, t: f64| q + u * t;
    let check = DiscreteFlowCheck::new(&space, free, Length::Fraction(0.01)).unwrap();
    let mut planner = InputPlanner::new(&space, one_way, inputs, 0.7, check).unwrap();
    let extension = planner.extend(&node, &Vector2::new(0.1, 0.1), Direction::Backward, Reach::Step(1.0));
    assert_eq!(extension, Extension::Trapped);
    assert_eq!(planner.counters().irreversible, 24);
}

#[test]
fn goals_are_connected_to_from_within_a_step() {
    let space = square();
    let flow = Kinematic::new(&space).unwrap();
    let goal = Vector2::new(0.31, 0.1);
    let local = || {
        InputPlanner::new(
            &space,
            flow,
            InputSet::axes([0.1, 0.1]).unwrap(),
            1.0,
            LocalFlowCheck(straight(&space)),
        )
    };
    for order in [Order::TestAll, Order::SortFirst] {
        let mut planner = local().unwrap().ordered(order).reaching([goal]);
        let from = Vector2::new(0.2, 0.1);
        let extension = planner.extend(&from, &goal, Direction::Forward, Reach::Step(0.2));
        assert!(matches!(extension, Extension::Reached(m) if m.end == goal));
        let too_far = planner.extend(&from, &goal, Direction::Forward, Reach::Step(0.05));
        assert!(matches!(too_far, Extension::Advanced(_)));
        let no_goal = planner.extend(&from, &Vector2::new(0.31, 0.11), Direction::Forward, Reach::Step(0.2));
        assert!(matches!(no_goal, Extension::Advanced(_)));
        // All the way to any state, as the straight planner does.
        let full = planner.extend(&from, &Vector2::new(0.9, 0.8), Direction::Forward, Reach::Full);
        assert!(matches!(full, Extension::Reached(_)));
    }
    check_local_planner(&space, &mut local().unwrap(), f64::INFINITY, 5);
    let mut recorded = InputPlanner::new(
        &space,
        flow,
        InputSet::axes([0.25, 0.25]).unwrap(),
        1.0,
        RecordedFlowCheck(straight(&space)),
    )
    .unwrap();
    check_local_planner(&space, &mut recorded, f64::INFINITY, 6);
    // An input that leads to the very target reaches it, by either reach.
    let (from, target) = (Vector2::new(0.25, 0.5), Vector2::new(0.5, 0.5));
    for reach in [Reach::Full, Reach::Step(1.0)] {
        let extension = recorded.extend(&from, &target, Direction::Forward, reach);
        assert!(
            matches!(extension, Extension::Reached(Motion { edge: ControlSegment { input, .. }, .. }) if input.x == 0.25)
        );
    }
    assert_eq!(
        recorded.extend(&from, &Vector2::new(0.6, 0.5), Direction::Forward, Reach::Full),
        Extension::Trapped
    );
}

#[test]
fn bad_input_is_a_typed_error() {
    let nan = f64::NAN;
    assert_eq!(InputSet::<f64>::new([]), Err(InputError::Empty { what: "the set of inputs" }));
    assert!(matches!(InputSet::new([Vec::new()]), Err(InputError::Empty { .. })));
    for bad in [nan, f64::INFINITY] {
        assert!(matches!(InputSet::new([1.0, bad]), Err(InputError::NotFinite { index: 1, .. })));
        assert!(InputSet::axes([1.0, bad]).is_err() && Car::new(bad).is_err());
        assert!(Rk4::new((), bad).is_err() && Unicycle::inputs(1.0, bad).is_err());
    }
    let still = Rk4::new(|_: &Vector2<f64>, u: &Vector2<f64>| *u, 0.1).unwrap();
    assert!(still.integrate(&Vector2::zeros(), &Vector2::zeros(), nan).iter().all(|x| x.is_nan()));
    assert!(matches!(InputSet::axes([0.0; 0]), Err(InputError::Empty { .. })));
    assert!(InputSet::axes([0.0]).is_err() && InputSet::axes_dyn(&[-1.0]).is_err());
    assert!(InputSet::grid([1.0], 1).is_err() && InputSet::grid_dyn(&[1.0; 30], 5).is_err());
    assert!(InputSet::spread([1.0], 0).is_err());
    assert!(Car::inputs(1.0, FRAC_PI_2, 1).is_err() && Car::inputs(0.0, 0.5, 1).is_err());
    let space = square();
    assert!(InputSet::uniform(&space, 0.1, 0, 0).is_err() && InputSet::uniform(&space, nan, 0, 1).is_err());

    let flow = Kinematic::new(&space).unwrap();
    let axes = || InputSet::axes([0.1, 0.1]).unwrap();
    let check = || DiscreteFlowCheck::new(&space, free, Length::Fraction(0.01)).unwrap();
    for duration in [0.0, -1.0, nan, f64::INFINITY] {
        let error = InputPlanner::new(&space, flow, axes(), duration, check()).map(drop).unwrap_err();
        assert!(matches!(error, InputError::Parameter(_)), "{error}");
    }
    for duration in [20.0, 1e9] {
        let error = InputPlanner::new(&space, flow, axes(), duration, check()).map(drop).unwrap_err();
        assert!(matches!(error, InputError::LeavesSpace { .. }), "{error}");
    }
    // Too many entries: nothing moves.
    let three = InputSet::axes([0.1; 3]).unwrap();
    assert!(InputPlanner::new(&space, flow, three, 1.0, check()).is_err());
    let broken = |_: &Vector2<f64>, u: &Vector2<f64>, _: f64| u / 0.0;
    let error = InputPlanner::new(&space, broken, axes(), 1.0, check()).map(drop).unwrap_err();
    assert!(matches!(error, InputError::FlowNotFinite { index: 0, .. }), "{error}");

    assert!(Product::with_velocity(square(), [1.0]).is_err());
    for limits in [[1.0, 0.0], [1.0, nan]] {
        assert!(Product::with_velocity(square(), limits).is_err());
    }
    /// A space without velocities.
    #[derive(Clone, Debug)]
    struct Bare;
    impl Space for Bare {
        type State = f64;
        fn distance(&self, from: &f64, to: &f64) -> f64 {
            (to - from).abs()
        }
        fn dim(&self) -> usize {
            1
        }
        fn extent(&self) -> f64 {
            1.0
        }
        fn interpolate_into(&self, from: &f64, to: &f64, t: f64, out: &mut f64) {
            *out = from + (to - from) * t;
        }
        fn unit_cube_to_state(&self, u: &[f64]) -> f64 {
            u[0]
        }
        fn sample_uniform(&self, _: &mut Rng) -> f64 {
            0.5
        }
        fn contains(&self, q: &f64) -> bool {
            (0.0..=1.0).contains(q)
        }
    }
    assert!(matches!(Kinematic::new(&Bare).unwrap_err(), InputError::NoMotion { .. }));
    assert!(DoubleIntegrator::new(&Bare).is_err() && InputSet::uniform(&Bare, 0.1, 0, 1).is_err());
}

/// A flow that breaks down in a corner that the probes do not see.
#[test]
fn states_that_are_not_finite_are_dropped_and_counted() {
    let space = square();
    let flow = |q: &Vector2<f64>, u: &Vector2<f64>, t: f64| {
        let to = q + u * t;
        if to.x > 0.999 && to.y > 0.999 { Vector2::new(f64::NAN, to.y) } else { to }
    };
    let inputs = InputSet::axes([0.01, 0.01]).unwrap();
    let check = DiscreteFlowCheck::new(&space, |_: &Vector2<f64>| true, Length::Fraction(0.01)).unwrap();
    let mut planner = InputPlanner::new(&space, flow, inputs, 1.0, check).unwrap();
    let from = Vector2::new(0.9995, 0.9895);
    let extension = planner.extend(&from, &Vector2::new(1.0, 1.0), Direction::Forward, Reach::Step(1.0));
    assert!(matches!(extension, Extension::Advanced(m) if m.end.iter().all(|x| x.is_finite())));
    let counters = planner.counters();
    assert_eq!((counters.not_finite, counters.outside, counters.successors), (1, 1, 4));
}

/// The kit on states with velocities, under every metric.
fn kit<C: Space + TrueMetric + DefaultNn>(space: &C) {
    SpaceKit::new().run(space);
    let mut rng = Rng::seed(2);
    let states: Vec<_> = (0..30).map(|_| space.sample_uniform(&mut rng)).collect();
    check_true_metric(space, &states, 1e-12);
    check_nearest_neighbors(space, &mut C::Nn::default(), 300, 3);
}

#[test]
fn spaces_with_velocities_conform() {
    let space = Product::with_velocity(Se3::new([0.0; 3], [2.0; 3]).unwrap(), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        .unwrap();
    kit(&space);
    kit(&WithMetric::new(space.clone(), Euclidean));
    kit(&WithMetric::new(space.clone(), Manhattan));
    let weights = [1.0, 1.0, 1.0, 0.5, 0.1, 0.1, 0.1, 0.2, 0.2, 0.2];
    kit(&WithMetric::new(space.clone(), ScaledEuclidean::new(&space, weights).unwrap()));
    kit(&Product::with_velocity(Se2::new([0.0; 2], [2.0; 2]).unwrap(), [1.0; 3]).unwrap());
}

/// Uniform inputs are one reach long in the metric, each level a quarter of the one before.
fn uniform_inputs_reach<C: Space>(space: &C, reach: f64, directions: usize) {
    let inputs = InputSet::uniform(space, reach, directions, 3).unwrap();
    let flow = Kinematic::new(space).unwrap();
    let middle = space.unit_cube_to_state(&vec![0.5; space.dim()]);
    let count = inputs.len() / 3;
    for (i, input) in inputs.inputs().iter().enumerate() {
        let length = space.distance(&middle, &flow.integrate(&middle, input, 1.0));
        let expected = reach * mp_math::powi(0.25, (i / count) as i32);
        let tolerance = if directions == 0 { 1e-6 } else { 1.0 };
        assert!((length / expected - 1.0).abs() < tolerance, "{length} for {expected}: {input:?}");
    }
}

#[test]
fn uniform_inputs_move_by_the_step() {
    let space = Se3::new([0.0; 3], [10.0; 3]).unwrap();
    uniform_inputs_reach(&space, 1.0, 0);
    uniform_inputs_reach(&space, 1.0, 40);
    uniform_inputs_reach(&WithMetric::new(space.clone(), Manhattan), 1.0, 0);
    uniform_inputs_reach(&Se2::new([0.0; 2], [1.0; 2]).unwrap(), 0.1, 0);
    assert_eq!(InputSet::uniform(&space, 1.0, 0, 2).unwrap().len(), 24);
    // Inputs turn by about half a turn at most.
    let flow = Kinematic::new(&space).unwrap();
    let far = InputSet::uniform(&space, 9.0, 0, 1).unwrap();
    let middle = space.unit_cube_to_state(&[0.5; 6]);
    for input in far.inputs() {
        let turned: f64 = input[3..].iter().map(|x| x.abs()).sum();
        assert!(turned <= 1.3 * PI, "{input:?}");
        assert!(space.distance(&middle, &flow.integrate(&middle, input, 1.0)) > 0.5);
    }
    // Axes first, then the spread directions; every set contains the smaller ones.
    let limits = [1.0, 2.0, 0.5, 1.0, 1.0, 3.0];
    let sets = [12, 48, 192].map(|n| InputSet::<DVector<f64>>::directions_dyn(&limits, n).unwrap());
    assert_eq!(sets[0], InputSet::axes_dyn(&limits).unwrap());
    assert_eq!(sets[1].len(), 48);
    assert!(sets.windows(2).all(|pair| pair[1].inputs().starts_with(pair[0].inputs())));
    for v in sets[2].inputs() {
        let on_ellipsoid: f64 = v.iter().zip(&limits).map(|(x, limit)| mp_math::powi(x / limit, 2)).sum();
        assert!((on_ellipsoid - 1.0).abs() < 1e-12);
        assert!(sets[2].inputs().iter().any(|w| (v + w).norm() < 1e-12), "the opposite is missing");
    }
    assert_eq!(InputSet::directions([1.0, 1.0], 3).unwrap(), InputSet::spread([1.0, 1.0], 3).unwrap());
    assert!(InputSet::directions([1.0], 0).is_err());
    let all: Vec<DVector<f64>> = InputSet::spread_dyn(&[1.0, 2.0, 3.0], 50).unwrap().inputs().to_vec();
    for (v, w) in all.iter().zip(&all[1..]).step_by(2) {
        assert_eq!(*v, -w);
        let scaled = v.component_div(&DVector::from_column_slice(&[1.0, 2.0, 3.0]));
        assert!((scaled.norm() - 1.0).abs() < 1e-12);
    }
}
