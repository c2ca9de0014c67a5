//! Every planner on problems whose answer is known.

mod common;
use common::*;
use mp_cspace::*;
use mp_tree::{Problem, Settings, Step, Tuning, build, build_with, planners};
use nalgebra::SVector;

const SEEDS: u64 = 5;
/// Iterations given to problems that have no solution.
const HOPELESS: u64 = 100_000;

fn settings(step: f64) -> Settings {
    Settings::parse([format!("step={step}")]).unwrap()
}

/// Solves one problem among boxes with every planner, certified and discrete.
fn solves<const N: usize>(
    space: &Rn<N>,
    boxes: &Boxes<N>,
    [start, goal]: [[f64; N]; 2],
    step: f64,
    iterations: u64,
) {
    let (start, goal) = (SVector::from(start), SVector::from(goal));
    for info in planners() {
        for seed in 0..SEEDS {
            let certified = Certified::new(space, boxes.clone(), 1e-3).unwrap();
            let discrete = Discrete::new(space, boxes.clone(), Resolution::Length(2e-3)).unwrap();
            let checks: [Box<dyn MotionValidity<_> + Send>; 2] = [Box::new(certified), Box::new(discrete)];
            for check in checks {
                let local = Straight::new(space, check);
                let problem = Problem::new(space, local, Exact(boxes.clone()), start, goal).unwrap();
                let mut planner = build(info.name, problem, &settings(step)).unwrap();
                let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(iterations), &mut ());
                let Outcome::Solved(path) = outcome else {
                    panic!("{} seed {seed}: {:?}", info.name, planner.progress())
                };
                assert_path(space, &path, &start, |q| *q == goal, |q| boxes.distance(q) > 0.0);
                assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
            }
        }
    }
}

#[test]
fn empty_space_takes_one_motion() {
    let space = cube();
    for info in planners() {
        let check = Certified::new(&space, Boxes::default(), 1e-3).unwrap();
        let (start, goal) = ([0.1; 3].into(), [0.9; 3].into());
        let local = Straight::new(&space, check);
        let problem = Problem::new(&space, local, Exact(Boxes::default()), start, goal).unwrap();
        let mut planner = build(info.name, problem, &Settings::default()).unwrap();
        let path = planner.step(&mut Rng::seed(1), &mut ()).unwrap();
        assert_eq!(path, Path { states: vec![start, goal], edges: vec![()] });
        assert_eq!(planner.progress().motions, 1);
    }
}

#[test]
fn narrow_passage_in_the_plane() {
    solves(&square(), &slit(0.2, 0.8, 0.04), [[0.1, 0.2], [0.9, 0.2]], 0.1, 20_000);
}

#[test]
fn narrow_passage_in_space() {
    solves(&cube(), &slit(0.1, 0.7, 0.15), [[0.1; 3], [0.9, 0.1, 0.1]], 0.2, 20_000);
}

#[test]
fn bug_trap_in_the_plane() {
    solves(&square(), &hollow([0.4, 0.5], 0.2, 0.05, 0.03), [[0.4, 0.5], [0.05, 0.5]], 0.1, 20_000);
}

#[test]
fn bug_trap_in_space() {
    solves(&cube(), &hollow([0.4; 3], 0.2, 0.05, 0.08), [[0.4; 3], [0.05, 0.4, 0.4]], 0.2, 20_000);
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
            let local = Straight::new(&space, check);
            let problem = Problem::new(&space, local, Exact(boxes.clone()), start, goal).unwrap();
            let mut planner = build(info.name, problem, &settings(0.2)).unwrap();
            let mut counts = EventCounts::default();
            let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(20_000), &mut counts);
            let Outcome::Solved(path) = outcome else { panic!("{}: {outcome:?}", info.name) };
            assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
            assert_eq!(counts.rejected, 0, "a certified edge was refuted");
        }
    }
}

fn never_solves<C, M, V>(
    space: &C,
    check: impl Fn() -> M,
    verifier: impl Fn() -> V,
    [start, goal]: [C::State; 2],
) where
    C: DefaultNn,
    M: MotionValidity<C::State> + Send,
    V: MotionValidity<C::State> + Send,
{
    for info in planners() {
        let local = Straight::new(space, check());
        let problem = Problem::new(space, local, verifier(), start.clone(), goal.clone()).unwrap();
        let mut planner = build(info.name, problem, &settings(0.2)).unwrap();
        // Those that rewire do several times the work per iteration.
        let budget = if planner.improves() { HOPELESS / 10 } else { HOPELESS };
        let outcome = planner.solve(&mut Rng::seed(3), &mut Iterations(budget), &mut ());
        assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations), "{}", info.name);
        assert_eq!(planner.progress().iterations, budget);
    }
}

#[test]
fn a_closed_box_around_the_goal_is_never_solved_in_the_plane() {
    let space = square();
    let boxes: Boxes<2> = hollow([0.7, 0.5], 0.1, 0.02, 0.0);
    let check = || Certified::new(&space, boxes.clone(), 1e-3).unwrap();
    let verifier = || Exact(boxes.clone());
    never_solves(&space, check, verifier, [[0.1, 0.5].into(), [0.7, 0.5].into()]);
}

#[test]
fn a_closed_box_around_the_goal_is_never_solved_in_space() {
    let space = cube();
    let boxes: Boxes<3> = hollow([0.7, 0.5, 0.5], 0.1, 1e-4, 0.0);
    let check = || Certified::new(&space, boxes.clone(), 1e-3).unwrap();
    let verifier = || Exact(boxes.clone());
    never_solves(&space, check, verifier, [[0.1; 3].into(), [0.7, 0.5, 0.5].into()]);
}

/// The plane with a rod that must turn to pass.
fn rod_world(boxes: Boxes<2>) -> (Se2, Rod) {
    (Se2::new([0.0; 2], [1.0; 2]).unwrap(), Rod { boxes, half_length: 0.1, radius: 0.01 })
}

#[test]
fn a_rod_turns_to_pass_a_gap() {
    let (space, rod) = rod_world(slit(0.05, 0.5, 0.08));
    let start = Se2State::new(0.2, 0.3, std::f64::consts::FRAC_PI_2);
    let goal = Se2State::new(0.8, 0.3, -std::f64::consts::FRAC_PI_2);
    for info in planners() {
        for seed in 0..SEEDS {
            let local = Straight::new(&space, Certified::new(&space, rod.clone(), 1e-3).unwrap());
            let verifier = FineDiscrete::new(&space, rod.clone(), Resolution::Length(1e-3)).unwrap();
            let problem = Problem::new(&space, local, verifier, start, goal).unwrap();
            let mut planner = build(info.name, problem, &settings(0.3)).unwrap();
            let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(40_000), &mut ());
            let Outcome::Solved(path) = outcome else { panic!("{} seed {seed}: {outcome:?}", info.name) };
            let mut rod = rod.clone();
            assert_path(&space, &path, &start, |q| *q == goal, |q| rod.is_valid(q));
        }
    }
}

#[test]
fn a_rod_never_leaves_a_closed_box() {
    let (space, rod) = rod_world(hollow([0.7, 0.5], 0.15, 0.01, 0.0));
    let check = || Certified::new(&space, rod.clone(), 1e-3).unwrap();
    let verifier = || FineDiscrete::new(&space, rod.clone(), Resolution::Length(1e-3)).unwrap();
    let ends = [Se2State::new(0.2, 0.5, 0.0), Se2State::new(0.7, 0.5, 0.0)];
    never_solves(&space, check, verifier, ends);
}

/// The local planner skips over a thin wall; the verifier does not.
fn coarse<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
) -> Problem<'c, Rn<2>, Straight<'c, Rn<2>, Discrete<'c, Rn<2>, Boxes<2>>>> {
    let check = Discrete::new(space, boxes.clone(), Resolution::Length(0.05)).unwrap();
    let ends = [[0.1, 0.1].into(), [0.9, 0.1].into()];
    Problem::new(space, Straight::new(space, check), Exact(boxes.clone()), ends[0], ends[1]).unwrap()
}

#[test]
fn a_too_coarse_check_is_found_out_and_the_way_around_found() {
    let space = square();
    let boxes: Boxes<2> = slit(1e-3, 0.9, 0.1);
    for info in planners() {
        for patience in ["0", "3", "10"] {
            for seed in 0..SEEDS {
                let settings = Settings::parse([&format!("patience={patience}"), "step=0.2"]).unwrap();
                let mut planner =
                    build_with(info.name, coarse(&space, &boxes), Linear::new(), &settings).unwrap();
                let mut counts = EventCounts::default();
                let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(20_000), &mut counts);
                let Outcome::Solved(path) = outcome else { panic!("{}: {outcome:?}", info.name) };
                assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
                let rejected = planner.progress().rejected;
                assert_eq!(rejected, counts.rejected);
                assert_eq!(rejected == 0, patience == "0", "{}", info.name);
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
        let mut planner = build_with(info.name, coarse(&space, &boxes), Linear::new(), &settings).unwrap();
        let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(3_000), &mut ());
        assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations), "{}", info.name);
        assert!(planner.progress().rejected > 10, "{}", info.name);
    }
}

#[test]
fn the_direct_planner_types_agree_with_the_registry() {
    let space = square();
    let boxes: Boxes<2> = slit(0.2, 0.8, 0.1);
    let tuning = Tuning { step: Step::Length(0.1), ..Tuning::default() };
    let solve = |planner: &mut dyn Planner<_, Edge = ()>| match planner.solve(
        &mut Rng::seed(5),
        &mut Iterations(20_000),
        &mut (),
    ) {
        Outcome::Solved(path) => path,
        other => panic!("{other:?}"),
    };
    let mut rrt = mp_tree::Rrt::with_index(coarse(&space, &boxes), Linear::new(), tuning).unwrap();
    let mut connect = mp_tree::RrtConnect::with_index(coarse(&space, &boxes), Linear::new(), tuning).unwrap();
    let paths = [("rrt", solve(&mut rrt)), ("rrt-connect", solve(&mut connect))];
    for (name, path) in paths {
        let mut planner = build_with(name, coarse(&space, &boxes), Linear::new(), &settings(0.1)).unwrap();
        assert_eq!(solve(&mut *planner), path);
    }
}
