//! Every planner on problems whose answer is known.

use crate::common::*;
use mp_cspace::erased::{AnyIndex, AnySpace};
use mp_cspace::obstacles::ObstacleHints;
use mp_cspace::*;
use mp_tree::{AnyPlanner, Length, Problem, Settings, Tuning, Workers, build, planners};
use nalgebra::{SVector, Vector2};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

const SEEDS: u64 = 20;
/// How many of these seeds are planned with a discrete check as well.
const DISCRETE: u64 = 4;
/// Iterations given to problems that have no solution.
const HOPELESS: u64 = 10_000;

type Check<'c, S> = Box<dyn MotionValidity<S> + Send + 'c>;

/// One type of local planner for each space, so that every planner is compiled once for it.
fn local<'c, C: Space>(
    space: &'c C,
    check: impl MotionValidity<C::State> + Send + 'c,
) -> Straight<'c, C, Check<'c, C::State>> {
    Straight::new(space, Box::new(check))
}

/// Planners that run others, and what they are told beside the step.
const WRAPPED: [(&str, &str); 8] = [
    ("or-rrt-connect", "runs=2"),
    ("or-rrt", "runs=2"),
    ("shared-rrt", "batch=4"),
    ("shared-bi-rrt", "batch=4"),
    ("restart-rrt-connect", "unit=500"),
    ("or-restart-bi-rrt", "runs=2"),
    ("shared-rrs", "batch=4"),
    ("or-rrs-connect", "runs=2"),
];

/// Every planner made by name, wrapped or not, and what it is told beside the step.
fn all() -> Vec<(&'static str, &'static str)> {
    let mut all = WRAPPED.to_vec();
    for info in planners() {
        // Narrow passages are entered by refining.
        all.push((info.name, if info.name == "t-rrt" { "refine=1" } else { "patience=10" }));
    }
    all
}

fn settings(step: f64) -> Settings {
    Settings::parse([format!("step={step}")]).unwrap()
}

/// A problem: a space, a robot in it, where from and where to, and a step that suits. Planners of erased
/// problems are compiled in the library already, and are the same as those compiled for the space, to the
/// bit: see `erased`.
struct World<C: Space, V> {
    space: AsVectors<C>,
    erased: AnySpace<'static, Configuration>,
    robot: OnVectors<V, C::State>,
    ends: [Configuration; 2],
    step: f64,
}

impl<C, V> World<C, V>
where
    C: Space<State: StateVector> + Clone + Send + 'static,
    AsVectors<C>: DefaultNn<State = Configuration, Nn: 'static>,
    V: Validity<C::State> + MotionClearance<C::State> + ObstacleHints<C::State> + Clone + Send + Sync,
{
    fn new(space: &C, robot: V, ends: [C::State; 2], step: f64) -> Self {
        let (space, ends) = (AsVectors(space.clone()), ends.each_ref().map(Configuration::of));
        Self { erased: AnySpace::new(&space), space, robot: OnVectors::new(robot), ends, step }
    }

    fn planner(&self, (name, set): (&str, &str), certified: bool) -> AnyPlanner<'_, Configuration, ()> {
        let (space, robot, [start, goal]) = (&self.space, &self.robot, &self.ends);
        let problem = move || {
            let proof = |tolerance| Certified::new(space, robot.clone(), tolerance).unwrap();
            // What is found by samples is verified by proof, so that no corner is cut.
            let (check, verifier): (Check<'_, Configuration>, Check<'_, Configuration>) = if certified {
                let fine = FineDiscrete::new(space, robot.clone(), Length::Fraction(5e-4)).unwrap();
                (Box::new(proof(1e-3)), Box::new(fine))
            } else {
                let sampled = Discrete::new(space, robot.clone(), Length::Fraction(2e-3)).unwrap();
                (Box::new(sampled), Box::new(proof(1e-5)))
            };
            let local = Straight::new(&self.erased, check);
            let problem = Problem::new(&self.erased, local, verifier, start.clone(), goal.clone())?;
            Ok(problem.with_obstacles(knowledge(space, robot)))
        };
        let settings = Settings::parse([&format!("step={}", self.step), set]).unwrap();
        let (index, workers) = (AnyIndex::of(space), Workers::new(2).unwrap());
        mp_tree::erased::build(name, Arc::new(problem), index, &settings, &workers).unwrap()
    }

    /// Every planner finds a way, whatever the seed, and on the first `discrete` seeds with a discrete check
    /// as well. `free` knows better than the verifier, where anything does.
    fn is_solved(&self, iterations: u64, discrete: u64, free: impl Fn(&C::State, &C::State) -> bool) {
        for named in all() {
            for (seed, certified) in
                (0..SEEDS).map(|seed| (seed, true)).chain((0..discrete).map(|seed| (seed, false)))
            {
                let mut planner = self.planner(named, certified);
                let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(iterations), &mut ());
                let Outcome::Solved(path) = outcome else {
                    panic!("{} seed {seed}: {:?}", named.0, planner.progress())
                };
                let ([start, goal], mut robot) = (&self.ends, self.robot.clone());
                assert_path(&self.space, &path, start, |q| q == goal, |q| robot.is_valid(q));
                let states: Vec<C::State> = path.states.iter().map(|q| q.to().unwrap()).collect();
                assert!(states.windows(2).all(|pair| free(&pair[0], &pair[1])), "{}", named.0);
            }
        }
    }

    /// No planner finds a way, as there is none. One that can tell may say so.
    fn is_never_solved(&self) {
        for named in all() {
            let mut planner = self.planner(named, true);
            let outcome = planner.solve(&mut Rng::seed(3), &mut Iterations(HOPELESS), &mut ());
            match outcome {
                Outcome::Stopped(StopReason::Iterations) => {
                    assert!(planner.progress().iterations >= HOPELESS)
                }
                outcome => {
                    assert_eq!((outcome, named.0), (Outcome::Stopped(StopReason::Exhausted), "rc-rrt"));
                }
            }
        }
    }
}

/// A point of the plane among boxes: whether an edge is free is known exactly.
fn point_of_the_plane(boxes: Boxes<2>, ends: [[f64; 2]; 2], step: f64) {
    let space = square();
    let world = World::new(&space, boxes.clone(), ends.map(SVector::from), step);
    world.is_solved(20_000, DISCRETE, |a, b| !boxes.hit(a, b));
}

/// The same in space.
fn point_of_space(boxes: Boxes<3>, ends: [[f64; 3]; 2], step: f64) {
    let world = World::new(&cube(), boxes.clone(), ends.map(SVector::from), step);
    world.is_solved(20_000, DISCRETE, |a, b| !boxes.hit(a, b));
}

/// The unit cube.
fn cube() -> Rn<3> {
    Rn::new([0.0; 3], [1.0; 3]).unwrap()
}

#[test]
fn empty_space_takes_one_motion() {
    let world = World::new(&cube(), Boxes::default(), [[0.1; 3].into(), [0.9; 3].into()], 0.3);
    // T-RRT makes no motion longer than a step.
    for info in planners().iter().filter(|info| info.name != "t-rrt") {
        let mut planner = world.planner((info.name, "patience=10"), true);
        let path = planner.step(&mut Rng::seed(1), &mut ()).unwrap();
        assert_eq!(path, Path { states: world.ends.to_vec(), edges: vec![()] }, "{}", info.name);
        assert_eq!(planner.progress().motions, 1);
    }
}

#[test]
fn narrow_passage_in_the_plane() {
    point_of_the_plane(slit(0.2, 0.8, 0.04), [[0.1, 0.2], [0.9, 0.2]], 0.1);
}

#[test]
fn narrow_passage_in_space() {
    point_of_space(slit(0.1, 0.7, 0.15), [[0.1; 3], [0.9, 0.1, 0.1]], 0.2);
}

#[test]
fn bug_trap_in_the_plane() {
    point_of_the_plane(hollow([0.4, 0.5], 0.2, 0.05, 0.03), [[0.4, 0.5], [0.05, 0.5]], 0.1);
}

#[test]
fn bug_trap_in_space() {
    point_of_space(hollow([0.4; 3], 0.2, 0.05, 0.08), [[0.4; 3], [0.05, 0.4, 0.4]], 0.2);
}

#[test]
fn a_closed_box_around_the_goal_is_never_solved_in_the_plane() {
    let (space, robot) = (square(), hollow([0.7, 0.5], 0.1, 0.02, 0.0));
    World::new(&space, robot, [[0.1, 0.5].into(), [0.7, 0.5].into()], 0.2).is_never_solved();
}

/// The walls are 1e-3 thick: two points of the verifier would straddle them, a certified check does
/// not.
#[test]
fn a_closed_box_around_the_goal_is_never_solved_in_space() {
    let ends = [[0.1; 3].into(), [0.7, 0.5, 0.5].into()];
    World::new(&cube(), hollow([0.7, 0.5, 0.5], 0.1, 1e-3, 0.0), ends, 0.2).is_never_solved();
}

/// The plane with a rod that must turn to pass.
fn rod(boxes: Boxes<2>) -> (Se2, Rod) {
    (Se2::new([0.0; 2], [1.0; 2]).unwrap(), Rod { boxes, half_length: 0.1, radius: 0.01 })
}

#[test]
fn a_rod_turns_to_pass_a_gap() {
    let (space, robot) = rod(slit(0.05, 0.5, 0.1));
    let ends = [Se2State::new(0.2, 0.3, FRAC_PI_2), Se2State::new(0.8, 0.3, -FRAC_PI_2)];
    World::new(&space, robot, ends, 0.3).is_solved(40_000, DISCRETE, |_, _| true);
}

#[test]
fn a_rod_never_leaves_a_closed_box() {
    let (space, robot) = rod(hollow([0.7, 0.5], 0.15, 0.01, 0.0));
    let ends = [Se2State::new(0.2, 0.5, 0.0), Se2State::new(0.7, 0.5, 0.0)];
    World::new(&space, robot, ends, 0.3).is_never_solved();
}

/// Two links must fold to get past a disc.
#[test]
fn an_arm_of_two_joints_folds() {
    let (space, discs) = (joints::<2>(), vec![(Vector2::new(0.7, 0.7), 0.3)]);
    let robot = Arm { link: 0.5, radius: 0.02, discs };
    let ends = [[0.0, 0.0].into(), [FRAC_PI_2, 0.0].into()];
    World::new(&space, robot, ends, 0.5).is_solved(20_000, DISCRETE, |_, _| true);
}

/// Six links among three discs, from one side of one to the other.
#[test]
fn an_arm_of_six_joints_finds_its_way() {
    let places = [(1.06, 0.51), (-0.2, 0.9), (0.0, -0.9)];
    let discs = places.map(|(x, y)| (Vector2::new(x, y), 0.1)).to_vec();
    let space = Rn::<6>::new([-1.5; 6], [1.5; 6]).unwrap();
    let robot = Arm { link: 0.2, radius: 0.02, discs };
    let ends = [[0.0; 6].into(), [0.9, 0.1, 0.0, 0.0, 0.0, 0.0].into()];
    World::new(&space, robot, ends, 1.0).is_solved(200_000, 0, |_, _| true);
}

/// Discs above and below the base keep the first link on its side; joints cannot turn all around.
#[test]
fn an_arm_never_passes_what_it_cannot() {
    let discs = [0.3, -0.3].map(|y| (Vector2::new(0.0, y), 0.1)).to_vec();
    let two = Arm { link: 0.5, radius: 0.02, discs: discs.clone() };
    let ends = [[0.0, 0.0].into(), [3.0, 0.0].into()];
    World::new(&joints::<2>(), two, ends, 0.5).is_never_solved();
    let space = Rn::<6>::new([-PI; 6], [PI; 6]).unwrap();
    let six = Arm { link: 0.5, radius: 0.02, discs };
    let ends = [[0.0; 6].into(), [3.0, 0.0, 0.0, 0.0, 0.0, 0.0].into()];
    World::new(&space, six, ends, 2.0).is_never_solved();
}

/// A wall 1e-4 thick, with a way around at the top.
#[test]
fn thin_walls_are_never_crossed() {
    let space = square();
    let boxes: Boxes<2> = slit(1e-4, 0.9, 0.1);
    let (start, goal) = (SVector::from([0.1, 0.1]), SVector::from([0.9, 0.1]));
    for info in planners() {
        for seed in 0..SEEDS {
            let check = Certified::new(&space, boxes.clone(), 1e-4).unwrap();
            let verifier = Exact(boxes.clone());
            let problem = Problem::new(&space, local(&space, check), verifier, start, goal).unwrap();
            let problem = problem.with_obstacles(knowledge(&space, &boxes));
            let mut planner = build(info.name, problem, &settings(0.2)).unwrap();
            let mut counts = EventCounts::default();
            let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(20_000), &mut counts);
            let Outcome::Solved(path) = outcome else { panic!("{}: {outcome:?}", info.name) };
            assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
            assert_eq!(counts.rejected, 0, "a certified edge was refuted");
        }
    }
}

/// The local planner skips over a thin wall; the verifier does not.
fn coarse<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
) -> Problem<'c, Rn<2>, Straight<'c, Rn<2>, Check<'c, Vector2<f64>>>> {
    let check = Discrete::new(space, boxes.clone(), Length::Absolute(0.05)).unwrap();
    let ends = [[0.1, 0.1].into(), [0.9, 0.1].into()];
    Problem::new(space, local(space, check), Exact(boxes.clone()), ends[0], ends[1])
        .unwrap()
        .with_obstacles(knowledge(space, boxes))
}

#[test]
fn a_too_coarse_check_is_found_out_and_the_way_around_found() {
    let space = square();
    let boxes: Boxes<2> = slit(1e-3, 0.9, 0.1);
    for info in planners() {
        for patience in ["0", "3", "10"] {
            for seed in 0..5 {
                let settings = Settings::parse([&format!("patience={patience}"), "step=0.2"]).unwrap();
                let mut planner = build(info.name, coarse(&space, &boxes), &settings).unwrap();
                let mut counts = EventCounts::default();
                let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(20_000), &mut counts);
                let Outcome::Solved(path) = outcome else { panic!("{}: {outcome:?}", info.name) };
                assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
                let rejected = planner.progress().rejected;
                assert_eq!(rejected, counts.rejected);
                // T-RRT keeps away from the wall, so it may never be refused.
                let refused = rejected > 0 || (patience != "0" && info.name == "t-rrt");
                assert_eq!(refused, patience != "0", "{}", info.name);
            }
        }
    }
}

#[test]
fn a_too_coarse_check_does_not_open_a_closed_wall() {
    let space = square();
    let boxes = Boxes(vec![([0.5, -1.0], [0.501, 2.0])]);
    for info in planners() {
        // Never distrusting: every candidate is refuted anew, and pruned.
        let settings = Settings::parse(["patience=1000000", "step=0.2"]).unwrap();
        let mut planner = build(info.name, coarse(&space, &boxes), &settings).unwrap();
        let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(3_000), &mut ());
        assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations), "{}", info.name);
        assert!(planner.progress().rejected > 10, "{}", info.name);
    }
}

#[test]
fn the_direct_planner_types_agree_with_the_registry() {
    let space = square();
    let boxes: Boxes<2> = slit(0.2, 0.8, 0.1);
    let tuning = Tuning { step: Length::Absolute(0.1), ..Tuning::default() };
    let solve = |planner: &mut dyn Planner<_, Edge = ()>| match planner.solve(
        &mut Rng::seed(5),
        &mut Iterations(20_000),
        &mut (),
    ) {
        Outcome::Solved(path) => path,
        other => panic!("{other:?}"),
    };
    let mut rrt = mp_tree::Rrt::new(coarse(&space, &boxes), tuning).unwrap();
    let mut connect = mp_tree::RrtConnect::new(coarse(&space, &boxes), tuning).unwrap();
    let paths = [("rrt", solve(&mut rrt)), ("rrt-connect", solve(&mut connect))];
    for (name, path) in paths {
        let mut planner = build(name, coarse(&space, &boxes), &settings(0.1)).unwrap();
        assert_eq!(solve(&mut *planner), path);
    }
}
