//! Goals that are sets: some components fixed and others free, and regions alone.

use crate::common::*;
use mp_cspace::registry::{Demand, Settings};
use mp_cspace::*;
use mp_tree::*;

type Check<'c> = Box<dyn MotionValidity<Se2State> + Send + 'c>;

fn world() -> (Se2, Rod) {
    let rod = Rod { boxes: slit(0.05, 0.5, 0.1), half_length: 0.1, radius: 0.01 };
    (Se2::new([0.0; 2], [1.0; 2]).unwrap(), rod)
}

fn planner<'c>(
    name: &str,
    (space, rod): &'c (Se2, Rod),
    goals: Goals<'c, Se2State>,
) -> Result<AnyPlanner<'c, Se2State, ()>, BuildError> {
    let check: Check<'c> = Box::new(Certified::new(space, rod.clone(), 1e-3).unwrap());
    let verifier = FineDiscrete::new(space, rod.clone(), Length::Absolute(1e-3)).unwrap();
    let start = Se2State::new(0.2, 0.3, 1.0);
    let problem = Problem::new(space, Straight::new(space, check), verifier, start, goals)?;
    build(name, problem.with_obstacles(knowledge(space, rod)), &Settings::parse(["step=0.3"])?)
}

fn solve(planner: &mut dyn Planner<Se2State, Edge = ()>, world: &(Se2, Rod)) -> Se2State {
    let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(40_000), &mut ());
    let Outcome::Solved(path) = outcome else { panic!("{:?}", planner.progress()) };
    let mut rod = world.1.clone();
    assert_path(&world.0, &path, &Se2State::new(0.2, 0.3, 1.0), |_| true, |q| rod.is_valid(q));
    *path.states.last().unwrap()
}

/// There, turned anyhow; or turned so, wherever beyond the wall.
#[test]
fn some_components_fixed_others_free() {
    let world = world();
    let there = Se2State::new(0.8, 0.3, 2.0);
    for info in planners() {
        for (fixed, tolerance) in [(vec![0, 1], 0.0), (vec![0, 1], 0.05), (vec![0, 2], 0.05)] {
            let goal = FixedFactors::new(&world.0, there, fixed.clone(), tolerance).unwrap();
            let goals = Goals::region(goal.clone()).with_sampler(goal.clone());
            let end = solve(&mut *planner(info.name, &world, goals).unwrap(), &world);
            assert!(goal.reached(&end), "{}: {end:?}", info.name);

            // As a sampler alone: the fixed components are exact.
            let end = solve(&mut *planner(info.name, &world, Goals::sampled(goal.clone())).unwrap(), &world);
            let exact = FixedFactors::new(&world.0, there, fixed, 0.0).unwrap();
            assert!(exact.reached(&end), "{}: {end:?}", info.name);
        }
    }
}

/// A region alone is enough for planners that can do with it; others say what they need.
#[test]
fn regions_alone() {
    let world = world();
    let goal = FixedFactors::new(&world.0, Se2State::new(0.8, 0.3, 0.0), [0], 0.05).unwrap();
    for info in planners() {
        let made = planner(info.name, &world, Goals::region(goal.clone()));
        if info.can(Demand::Region) {
            assert!(goal.reached(&solve(&mut *made.unwrap(), &world)), "{}", info.name);
        } else {
            let error = made.err().unwrap();
            assert_eq!(error, BuildError::NoGoalState { planner: info.name });
        }
    }
}
