//! Erased problems of rows are planned as generic ones of states, to the bit.

use crate::common::*;
use mp_cspace::erased::AnySpace;
use mp_cspace::obstacles::ObstacleHints;
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::SVector;
use std::sync::Arc;

/// A robot as planners by name may want one.
trait Robot<S>: MotionClearance<S> + Validity<S> + ObstacleHints<S> + Clone + Send + Sync {}
impl<S, V: MotionClearance<S> + Validity<S> + ObstacleHints<S> + Clone + Send + Sync> Robot<S> for V {}

type Made<'c, P, S> = Problem<'c, P, Straight<'c, P, mp_cspace::erased::AnyCheck<'c, S>>>;

/// A problem in `planned`, which is `space` or its erasure.
fn problem<'c, C: Space, P: Space<State = C::State>, V: Robot<C::State> + 'c>(
    space: &'c C,
    planned: &'c P,
    robot: &V,
    [start, goal]: &[C::State; 2],
) -> Result<Made<'c, P, C::State>, BuildError> {
    let check = Certified::new(space, robot.clone(), 1e-3).unwrap();
    let fine = FineDiscrete::new(space, robot.clone(), Length::Fraction(1e-3)).unwrap();
    let local = Straight::new(planned, Box::new(check) as mp_cspace::erased::AnyCheck<'c, C::State>);
    let problem = Problem::new(planned, local, fine, start.clone(), goal.clone())?;
    Ok(problem.with_obstacles(knowledge(space, robot)))
}

fn same<C, V>(space: &C, robot: V, ends: [C::State; 2], names: &[String])
where
    C: DefaultNn<State: StateVector, Nn: Send + Sync + 'static> + Clone + Send + 'static,
    AsVectors<C>: DefaultNn<State = Configuration, Nn: 'static>,
    V: Robot<C::State>,
{
    let (rows, robot_of_rows) = (AsVectors(space.clone()), OnVectors::<_, C::State>::new(robot.clone()));
    let (erased, ends_of_rows) = (AnySpace::new(&rows), ends.each_ref().map(Configuration::of));
    let (settings, workers) = (Settings::parse(["step=10%"]).unwrap(), Workers::single());
    for name in names {
        let make = || problem(space, space, &robot, &ends);
        let generic = build_from(name, make, C::Nn::default(), &settings, &workers).unwrap();
        let make = || problem(&rows, &erased, &robot_of_rows, &ends_of_rows);
        let any = mp_tree::erased::build(name, Arc::new(make), AnyIndex::of(&rows), &settings, &workers);
        let any = any.unwrap();
        assert_same(name, generic, any);
    }
}

/// Both find the same, and do the same for it.
fn assert_same<S: StateVector>(
    name: &str,
    mut generic: AnyPlanner<'_, S, ()>,
    mut any: AnyPlanner<'_, Configuration, ()>,
) {
    for seed in 1..3 {
        let found = [solved(&mut *generic, seed), solved(&mut *any, seed)];
        assert_eq!(found[0], found[1], "{name} seed {seed}");
    }
}

/// What a planner finds, in rows, and what it did for it.
fn solved<S: StateVector>(
    planner: &mut dyn Planner<S, Edge = ()>,
    seed: u64,
) -> (Result<Vec<Configuration>, StopReason>, Progress) {
    let stop = &mut Iterations(planner.progress().iterations + 1_500);
    let outcome = match planner.solve(&mut Rng::seed(seed), stop, &mut ()) {
        Outcome::Solved(path) => Ok(path.states.iter().map(Configuration::of).collect()),
        Outcome::Stopped(reason) => Err(reason),
    };
    (outcome, planner.progress())
}

/// The planners, and each wrapper once.
fn names() -> Vec<String> {
    let wrapped = [
        "or-rrt",
        "shared-rrt",
        "shared-bi-rrt",
        "shared-rrs",
        "restart-rrs-connect",
        "or-restart-rrt-connect",
    ];
    planners().iter().map(|info| info.name).chain(wrapped).map(str::to_owned).collect()
}

#[test]
fn a_point_is_planned_the_same() {
    let ends = [SVector::from([0.1, 0.2]), SVector::from([0.9, 0.2])];
    same(&square(), slit(0.1, 0.8, 0.1), ends, &names());
}

#[test]
fn a_rod_is_planned_the_same() {
    let rod = Rod { boxes: slit(0.05, 0.5, 0.15), half_length: 0.1, radius: 0.01 };
    let ends = [Se2State::new(0.2, 0.3, 1.0), Se2State::new(0.8, 0.3, -1.0)];
    some_are_the_same(&Se2::new([0.0; 2], [1.0; 2]).unwrap(), rod, ends);
}

/// States without a size at compile time.
#[test]
fn joints_are_planned_the_same() {
    let space = Joints::<Configuration>::intervals(&[0.0; 2], &[1.0; 2]).unwrap();
    let robot = OnVectors::<_, SVector<f64, 2>>::new(slit(0.1, 0.8, 0.1));
    some_are_the_same(&space, robot, [[0.1, 0.2].into(), [0.9, 0.2].into()]);
}

/// Three planners by their types, as compiling all of them takes its time.
fn some_are_the_same<C, V>(space: &C, robot: V, ends: [C::State; 2])
where
    C: DefaultNn<State: StateVector, Nn: Send + Sync + 'static> + Clone + Send + 'static,
    AsVectors<C>: DefaultNn<State = Configuration, Nn: 'static>,
    V: Robot<C::State>,
{
    let (rows, robot_of_rows) = (AsVectors(space.clone()), OnVectors::<_, C::State>::new(robot.clone()));
    let (erased, ends_of_rows) = (AnySpace::new(&rows), ends.each_ref().map(Configuration::of));
    let settings = Settings::parse(["step=10%"]).unwrap();
    let tuning = Tuning { step: Length::Fraction(0.1), ..Tuning::default() };
    let generic = |name: &str| -> AnyPlanner<'_, C::State, ()> {
        let problem = problem(space, space, &robot, &ends).unwrap();
        match name {
            "rrt" => Box::new(Rrt::new(problem, tuning).unwrap()),
            "rrt-connect" => Box::new(RrtConnect::new(problem, tuning).unwrap()),
            _ => Box::new(RrtStar::new(problem, tuning).unwrap()),
        }
    };
    for name in ["rrt", "rrt-connect", "rrt-star"] {
        let make = Arc::new(|| problem(&rows, &erased, &robot_of_rows, &ends_of_rows));
        let any = mp_tree::erased::build(name, make, AnyIndex::of(&rows), &settings, &Workers::single());
        assert_same(name, generic(name), any.unwrap());
    }
}
