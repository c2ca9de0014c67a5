//! Goals that are sets: some components fixed and others free, and regions alone.

use crate::common::*;
use mp_cspace::erased::{AnyIndex, AnySpace};
use mp_cspace::registry::{Demand, Settings};
use mp_cspace::*;
use mp_tree::*;
use std::sync::Arc;

/// Planners of rows are compiled in the library already.
struct World {
    space: AsVectors<Se2>,
    erased: AnySpace<'static, Configuration>,
    rod: OnVectors<Rod, Se2State>,
    start: Configuration,
}

impl World {
    fn new() -> Self {
        let rod = Rod { boxes: slit(0.05, 0.5, 0.1), half_length: 0.1, radius: 0.01 };
        let space = AsVectors(Se2::new([0.0; 2], [1.0; 2]).unwrap());
        let start = Configuration::of(&Se2State::new(0.2, 0.3, 1.0));
        Self { erased: AnySpace::new(&space), space, rod: OnVectors::new(rod), start }
    }

    /// A planner for the goals that `goals` makes.
    fn planner<'c>(
        &'c self,
        name: &str,
        goals: &'c (dyn Fn() -> Goals<'c, Configuration> + Sync),
    ) -> Result<AnyPlanner<'c, Configuration, ()>, BuildError> {
        let problem = move || {
            let check = Certified::new(&self.space, self.rod.clone(), 1e-3).unwrap();
            let verifier = FineDiscrete::new(&self.space, self.rod.clone(), Length::Absolute(1e-3)).unwrap();
            let local = checked(&self.erased, check);
            let problem = Problem::new(&self.erased, local, verifier, self.start.clone(), goals())?;
            Ok(problem.with_obstacles(knowledge(&self.space, &self.rod)))
        };
        let (settings, index) = (Settings::parse(["step=0.3"])?, AnyIndex::of(&self.space));
        mp_tree::erased::build(name, Arc::new(problem), index, &settings, &Workers::single())
    }

    fn solve(&self, planner: &mut dyn Planner<Configuration, Edge = ()>) -> Configuration {
        let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(40_000), &mut ());
        let Outcome::Solved(path) = outcome else { panic!("{:?}", planner.progress()) };
        let mut rod = self.rod.clone();
        assert_path(&self.space, &path, &self.start, |_| true, |q| rod.is_valid(q));
        path.states.last().unwrap().clone()
    }
}

/// There, turned anyhow; or turned so, wherever beyond the wall.
#[test]
fn some_components_fixed_others_free() {
    let world = World::new();
    let there = Configuration::of(&Se2State::new(0.8, 0.3, 2.0));
    for info in planners() {
        for (fixed, tolerance) in [(vec![0, 1], 0.0), (vec![0, 1], 0.05), (vec![0, 2], 0.05)] {
            let goal = FixedFactors::new(&world.space, there.clone(), fixed.clone(), tolerance).unwrap();
            let goals = || Goals::region(goal.clone()).with_sampler(goal.clone());
            let end = world.solve(&mut *world.planner(info.name, &goals).unwrap());
            assert!(goal.reached(&end), "{}: {end:?}", info.name);

            // As a sampler alone: the fixed components are exact.
            let goals = || Goals::sampled(goal.clone());
            let end = world.solve(&mut *world.planner(info.name, &goals).unwrap());
            let exact = FixedFactors::new(&world.space, there.clone(), fixed, 0.0).unwrap();
            assert!(exact.reached(&end), "{}: {end:?}", info.name);
        }
    }
}

/// A region alone is enough for planners that can do with it; others say what they need.
#[test]
fn regions_alone() {
    let world = World::new();
    let goal =
        FixedFactors::new(&world.space, Configuration::of(&Se2State::new(0.8, 0.3, 0.0)), [0], 0.05).unwrap();
    let goals = || Goals::region(goal.clone());
    for info in planners() {
        let made = world.planner(info.name, &goals);
        if info.can(Demand::Region) {
            assert!(goal.reached(&world.solve(&mut *made.unwrap())), "{}", info.name);
        } else {
            let error = made.err().unwrap();
            assert_eq!(error, BuildError::NoGoalState { planner: info.name });
        }
    }
}

/// Three samples outside of the space for one inside, in turns.
struct MostlyOutside(usize);

impl Sampler<Configuration> for MostlyOutside {
    fn sample(&mut self, _: &mut Rng) -> Configuration {
        self.0 += 1;
        let [x, y] = [[1.4, 0.3], [0.2, 1.4], [0.2, f64::NAN], [0.8, 0.3]][self.0 % 4];
        Configuration::from([x, y, 2.0])
    }
}

#[test]
fn samples_of_a_goal_outside_the_space_are_ignored() {
    let world = World::new();
    let goals = || Goals::sampled(MostlyOutside(0));
    for info in planners() {
        let mut planner = world.planner(info.name, &goals).unwrap();
        let mut nodes = OnEvent(|event: Event<'_, Configuration>| {
            if let Event::Rooted { state, .. } | Event::Added { state, .. } = event {
                assert!(world.space.contains(state), "{}: {state:?}", info.name);
            }
        });
        let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(40_000), &mut nodes);
        assert!(matches!(outcome, Outcome::Solved(_)), "{}", info.name);
    }
}
