//! Bad input is a typed error before planning begins.

use crate::common::*;
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::Vector2;

type Point = Vector2<f64>;
type Local<'c> = Straight<'c, Rn<2>, mp_cspace::erased::AnyCheck<'c, Vector2<f64>>>;

fn wall() -> Boxes<2> {
    Boxes(vec![([0.4, 0.0], [0.6, 0.5])])
}

fn problem<'c>(
    space: &'c Rn<2>,
    start: [f64; 2],
    goal: impl Into<Goals<'c, Point>>,
) -> Result<Problem<'c, Rn<2>, Local<'c>>, BuildError> {
    let local = certified(space, wall(), 1e-3);
    let problem = Problem::new(space, local, Exact(wall()), start.into(), goal)?;
    Ok(problem.with_obstacles(knowledge(space, &wall())))
}

fn point(x: f64, y: f64) -> Point {
    Point::new(x, y)
}

#[test]
fn ends_must_be_in_the_space_free_and_admitted() {
    let space = square();
    let ok = [0.1, 0.1];
    let nan = f64::NAN;
    for bad in [[1.5, 0.1], [-0.1, 0.1], [nan, 0.1], [0.1, f64::INFINITY]] {
        let error = problem(&space, bad, point(0.9, 0.1)).unwrap_err();
        assert!(matches!(error, BuildError::Outside { endpoint: Endpoint::Start, .. }), "{error}");
        let error = problem(&space, ok, Point::from(bad)).unwrap_err();
        assert!(matches!(error, BuildError::Outside { endpoint: Endpoint::Goal(0), .. }), "{error}");
    }
    let error = problem(&space, [0.5, 0.2], point(0.9, 0.1)).unwrap_err();
    assert!(matches!(error, BuildError::NotFree { endpoint: Endpoint::Start, .. }), "{error}");
    let error = problem(&space, ok, point(0.5, 0.2)).unwrap_err();
    assert!(matches!(error, BuildError::NotFree { endpoint: Endpoint::Goal(0), .. }), "{error}");
    // Free for the exact verifier, within the tolerance of the certified check.
    let error = problem(&space, [0.4 - 1e-5, 0.2], point(0.9, 0.1)).unwrap_err();
    assert!(matches!(error, BuildError::Refused { endpoint: Endpoint::Start, .. }), "{error}");
    let error = problem(&space, ok, Goals::states([point(0.5, 0.2), point(2.0, 0.0)])).unwrap_err();
    assert!(matches!(error, BuildError::NotFree { endpoint: Endpoint::Goal(0), .. }), "{error}");
    let error = problem(&space, ok, Goals::states([])).unwrap_err();
    assert_eq!(error, BuildError::NoGoal);
    assert!(problem(&space, ok, Goals::states([point(0.5, 0.2), point(0.9, 0.1)])).is_ok());
}

#[test]
fn distances_must_be_finite() {
    #[derive(Clone, Debug)]
    struct Unmeasured;
    impl Space for Unmeasured {
        type State = Point;
        fn distance(&self, _: &Point, _: &Point) -> f64 {
            f64::NAN
        }
        fn dim(&self) -> usize {
            2
        }
        fn extent(&self) -> f64 {
            1.0
        }
        fn interpolate_into(&self, from: &Point, to: &Point, t: f64, out: &mut Point) {
            *out = from.lerp(to, t);
        }
        fn unit_cube_to_state(&self, u: &[f64]) -> Point {
            Point::new(u[0], u[1])
        }
        fn sample_uniform(&self, rng: &mut Rng) -> Point {
            square().sample_uniform(rng)
        }
        fn contains(&self, _: &Point) -> bool {
            true
        }
    }
    let local = Straight::new(&Unmeasured, Exact(Boxes::default()));
    let ends = [point(0.1, 0.1), point(0.9, 0.9)];
    let error = Problem::new(&Unmeasured, local, Exact(Boxes::default()), ends[0], ends[1]).unwrap_err();
    assert!(matches!(error, BuildError::Distance { distance } if distance.is_nan()));
}

#[test]
fn parameters_must_be_in_range() {
    let space = square();
    let ready = || problem(&space, [0.1, 0.1], point(0.9, 0.1)).unwrap();
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let steps = [0.0, -1.0, nan, inf, -inf, 2.0];
    let steps = steps.into_iter().flat_map(|value| [Length::Absolute(value), Length::Fraction(value)]);
    let biases = [-0.1, 1.1, nan, inf];
    let tunings = steps
        .map(|step| (Tuning { step, ..Tuning::default() }, "step"))
        .chain(biases.map(|goal_bias| (Tuning { goal_bias, ..Tuning::default() }, "goal-bias")));
    for (tuning, parameter) in tunings {
        let single = Rrt::with_index(ready(), Linear::new(), tuning).map(|_| ()).unwrap_err();
        let double = RrtConnect::with_index(ready(), Linear::new(), tuning).map(|_| ()).unwrap_err();
        for error in [single, double] {
            assert!(matches!(error, BuildError::OutOfRange { name, .. } if name == parameter), "{error}");
        }
    }
    for balance in [-1.0, 0.5, nan] {
        let tuning = Tuning { balance, ..Tuning::default() };
        let error = RrtConnect::with_index(ready(), Linear::new(), tuning).map(|_| ()).unwrap_err();
        assert!(matches!(error, BuildError::OutOfRange { name: "balance", .. }), "{error}");
    }
    let longest =
        Tuning { step: Length::Absolute(space.extent()), goal_bias: 1.0, patience: 0, ..Tuning::default() };
    assert!(Rrt::with_index(ready(), Linear::new(), longest).is_ok());
}

#[test]
fn two_trees_need_a_goal_to_grow_from() {
    let space = square();
    let region = Goals::region(|q: &Point| q.x > 0.8);
    let problem = problem(&space, [0.1, 0.1], region).unwrap();
    let error = RrtConnect::with_index(problem, Linear::new(), Tuning::default()).map(|_| ()).unwrap_err();
    assert_eq!(error, BuildError::NoGoalState { planner: "rrt-connect" });
}

#[test]
fn names_must_be_known() {
    let space = square();
    let build = |name: &str, settings: &str| {
        let ready = problem(&space, [0.1, 0.1], point(0.9, 0.1)).unwrap();
        build_with(name, ready, KdTree::<2>::new(), &Settings::parse([settings]).unwrap()).map(|_| ())
    };
    let message = build("rrt-conect", "step=0.1").unwrap_err().to_string();
    let expected =
        "there is no planner `rrt-conect` (did you mean `rrt-connect`?); there are: rrt, rrt-connect";
    assert!(message.starts_with(expected), "{message}");
    assert!(matches!(build("", "step=0.1"), Err(BuildError::UnknownPlanner { suggestion: None, .. })));
    assert!(matches!(build("rrt", "stride=0.1"), Err(BuildError::UnknownParameter { .. })));
    assert!(matches!(build("rrt", "step=long"), Err(BuildError::Malformed { .. })));
    for info in planners() {
        assert_eq!(planner(info.name).unwrap(), info);
        // Every parameter of the table is read: a value it cannot have is refused.
        for parameter in info.parameters {
            assert!(build(info.name, &format!("{}=-7", parameter.name)).is_err(), "{}", parameter.name);
            assert!(build(info.name, &format!("{}={}", parameter.name, parameter.default)).is_ok());
        }
    }
}

/// A planner that follows obstacles must be told of them.
#[test]
fn obstacles_must_be_known_to_be_followed() {
    let (space, boxes) = (square(), wall());
    let local = || certified(&space, boxes.clone(), 1e-3);
    let problem = || Problem::new(&space, local(), Exact(boxes.clone()), point(0.1, 0.1), point(0.9, 0.1));
    let error = |name| build(name, problem().unwrap(), &Settings::default()).err().unwrap();
    assert_eq!(error("obrrt"), BuildError::NoHints { planner: "obrrt" });
    for planner in ["rrs", "rrs-connect", "retraction-rrt"] {
        assert_eq!(error(planner), BuildError::NoGradient { planner });
    }
}
