//! Every planner on problems whose answer is known.

use crate::common::*;
use mp_cspace::erased::{AnyIndex, AnySpace};
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_roadmap::{AnyParallelProblem, AnyPlanner};
use std::f64::consts::FRAC_PI_2;

const SEEDS: u64 = 20;
/// How many of these seeds are planned with a discrete check as well.
const DISCRETE: u64 = 4;
/// Iterations given to problems that have no solution.
const HOPELESS: u64 = 2_000;

type Check<'c, S> = Box<dyn MotionValidity<S> + Send + 'c>;

/// A problem: a space, a robot in it, where from and where to. Planners of erased problems are compiled in
/// the library already, and are the same as those compiled for the space, to the bit: see `around`.
struct World<C: Space, V> {
    space: AsVectors<C>,
    erased: AnySpace<'static, Configuration>,
    robot: OnVectors<V, C::State>,
    ends: [Configuration; 2],
}

/// What a planner needs for narrow passages.
fn settings(name: &str) -> Settings {
    let set: &[&str] = match name {
        "visibility-prm" => &["failures=20000"],
        // An iteration makes as many attempts.
        "regional-prm" => &["regions=4", "samples=8"],
        _ => &[],
    };
    Settings::parse(set).unwrap()
}

impl<C, V> World<C, V>
where
    C: Space<State: StateVector> + Clone + Send + 'static,
    AsVectors<C>: DefaultNn<State = Configuration, Nn: 'static>,
    V: Validity<C::State> + MotionClearance<C::State> + Clone + Send,
{
    fn new(space: &C, robot: V, ends: [C::State; 2]) -> Self {
        let (space, ends) = (AsVectors(space.clone()), ends.each_ref().map(Configuration::of));
        Self { erased: AnySpace::new(&space), space, robot: OnVectors::new(robot), ends }
    }

    fn planner(&self, name: &str, certified: bool) -> AnyPlanner<'_, Configuration, ()> {
        let proof = |tolerance| Certified::new(&self.space, self.robot.clone(), tolerance).unwrap();
        // What is found by samples is verified by proof, so that no corner is cut.
        let (check, verifier): (Check<'_, Configuration>, Check<'_, Configuration>) = if certified {
            let fine = FineDiscrete::new(&self.space, self.robot.clone(), Length::Fraction(5e-4)).unwrap();
            (Box::new(proof(1e-3)), Box::new(fine))
        } else {
            let resolution = Length::Fraction(2e-3);
            let sampled = Discrete::new(&self.space, self.robot.clone(), resolution).unwrap();
            (Box::new(sampled), Box::new(proof(1e-5)))
        };
        let [start, goal] = self.ends.clone();
        let local = Straight::new(&self.erased, check);
        let parallel =
            AnyParallelProblem::from(Problem::new(&self.erased, local, verifier, start, goal).unwrap());
        let index = AnyIndex::of(&self.space);
        mp_roadmap::erased::build(name, parallel, index, &settings(name)).unwrap()
    }

    /// Every planner finds a way, whatever the seed, and on some seeds with a discrete check as well.
    fn is_solved(&self, iterations: u64, free: impl Fn(&C::State, &C::State) -> bool) {
        for info in crate::blind() {
            for (seed, certified) in
                (0..SEEDS).map(|seed| (seed, true)).chain((0..DISCRETE).map(|seed| (seed, false)))
            {
                let mut planner = self.planner(info.name, certified);
                let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(iterations), &mut ());
                let Outcome::Solved(path) = outcome else {
                    panic!("{} seed {seed}: {outcome:?} {:?}", info.name, planner.progress())
                };
                let ([start, goal], mut robot) = (&self.ends, self.robot.clone());
                assert_path(&self.space, &path, start, |q| q == goal, |q| robot.is_valid(q));
                let states: Vec<C::State> = path.states.iter().map(|q| q.to().unwrap()).collect();
                assert!(states.windows(2).all(|pair| free(&pair[0], &pair[1])), "{}", info.name);
            }
        }
    }

    /// No planner finds a way, as there is none.
    fn is_never_solved(&self) {
        for info in crate::blind() {
            let mut planner = self.planner(info.name, true);
            let outcome = planner.solve(&mut Rng::seed(3), &mut Iterations(HOPELESS), &mut ());
            let Outcome::Stopped(reason) = outcome else { panic!("{}: {outcome:?}", info.name) };
            assert!(matches!(reason, StopReason::Iterations | StopReason::Exhausted), "{reason:?}");
        }
    }
}

/// A point among boxes: whether an edge is free is known exactly.
fn point(boxes: Boxes<2>, ends: [[f64; 2]; 2]) {
    let space = square();
    let world = World::new(&space, boxes.clone(), ends.map(Into::into));
    world.is_solved(20_000, |a, b| !boxes.hit(a, b));
}

#[test]
fn empty_space_takes_one_motion() {
    let space = square();
    let (start, goal) = ([0.1; 2].into(), [0.9; 2].into());
    let world = World::new(&space, Boxes::default(), [start, goal]);
    for info in crate::blind() {
        let mut planner = world.planner(info.name, true);
        let path = planner.step(&mut Rng::seed(1), &mut ()).unwrap();
        assert_eq!(path, Path { states: world.ends.to_vec(), edges: vec![()] }, "{}", info.name);
        assert_eq!(planner.progress().motions, 1);
    }
}

#[test]
fn narrow_passage() {
    point(slit(0.2, 0.8, 0.04), [[0.1, 0.2], [0.9, 0.2]]);
}

#[test]
fn bug_trap() {
    point(hollow([0.4, 0.5], 0.2, 0.05, 0.03), [[0.4, 0.5], [0.05, 0.5]]);
}

#[test]
fn a_closed_box_around_the_goal_is_never_solved() {
    let (space, robot) = (square(), hollow([0.7, 0.5], 0.1, 0.02, 0.0));
    World::new(&space, robot, [[0.1, 0.5].into(), [0.7, 0.5].into()]).is_never_solved();
}

/// The plane with a rod that must turn to pass.
fn rod(boxes: Boxes<2>) -> (Se2, Rod) {
    (Se2::new([0.0; 2], [1.0; 2]).unwrap(), Rod { boxes, half_length: 0.1, radius: 0.01 })
}

#[test]
fn a_rod_turns_to_pass_a_gap() {
    let (space, robot) = rod(slit(0.05, 0.5, 0.15));
    let ends = [Se2State::new(0.2, 0.3, FRAC_PI_2), Se2State::new(0.8, 0.3, -FRAC_PI_2)];
    World::new(&space, robot, ends).is_solved(40_000, |_, _| true);
}

#[test]
fn a_rod_never_leaves_a_closed_box() {
    let (space, robot) = rod(hollow([0.7, 0.5], 0.15, 0.01, 0.0));
    let ends = [Se2State::new(0.2, 0.5, 0.0), Se2State::new(0.7, 0.5, 0.0)];
    World::new(&space, robot, ends).is_never_solved();
}
