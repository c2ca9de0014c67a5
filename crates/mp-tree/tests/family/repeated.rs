//! Planners that run planners: several at once, and one after the other.

use crate::common::*;
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::Vector2;
use rand::RngExt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

type Point = Vector2<f64>;
type Local<'c> = Straight<'c, Rn<2>, mp_cspace::erased::AnyCheck<'c, Vector2<f64>>>;
type Made<'c> = Result<Problem<'c, Rn<2>, Local<'c>>, BuildError>;

fn problem<'c>(space: &'c Rn<2>, boxes: &Boxes<2>) -> Made<'c> {
    let local = certified(space, boxes.clone(), 1e-3);
    let ends = [Point::new(0.1, 0.2), Point::new(0.9, 0.2)];
    let problem = Problem::new(space, local, Exact(boxes.clone()), ends[0], ends[1])?;
    Ok(problem.with_obstacles(knowledge(space, boxes)))
}

fn tuning() -> Tuning {
    Tuning { step: Length::Absolute(0.1), ..Tuning::default() }
}

fn narrow() -> Boxes<2> {
    slit(0.2, 0.8, 0.02)
}

fn closed() -> Boxes<2> {
    hollow([0.9, 0.2], 0.05, 0.02, 0.0)
}

type RunResult = (Outcome<Path<Point>>, Progress);

fn solve(planner: &mut impl Planner<Point, Edge = ()>, seed: u64, iterations: u64) -> RunResult {
    let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(iterations), &mut ());
    (outcome, planner.progress())
}

#[test]
fn the_run_with_fewest_iterations_wins_on_any_number_of_threads() {
    let (space, boxes) = (square(), narrow());
    let run = |_| RrtConnect::new(problem(&space, &boxes)?, tuning());
    let mut winners = Vec::new();
    for seed in 0..8 {
        // Each run by itself.
        let stream_seed = Rng::seed(seed).random();
        let alone = (0..6).map(|i| {
            let mut planner = run(i).unwrap();
            let mut rng = Rng::stream(stream_seed, i);
            let Outcome::Solved(path) = planner.solve(&mut rng, &mut Iterations(100_000), &mut ()) else {
                panic!("run {i}")
            };
            (planner.progress().iterations, i, path)
        });
        let (iterations, winner, path) = alone.min_by_key(|(iterations, i, _)| (*iterations, *i)).unwrap();
        winners.push(winner);
        for slice in [1, 7, 1000] {
            let mut first: Option<RunResult> = None;
            for threads in 1..=4 {
                let workers = Workers::new(threads).unwrap();
                let mut planner = OrParallel::new(6, slice, workers, run).unwrap();
                let now = solve(&mut planner, seed, 100_000);
                assert_eq!(now.0, Outcome::Solved(path.clone()), "seed {seed}");
                assert_eq!(planner.winner(), Some(winner as usize));
                assert!(now.1.iterations >= iterations && now.1.iterations < iterations + slice);
                assert_eq!(*first.get_or_insert(now.clone()), now, "{threads} threads");
            }
        }
    }
    winners.sort_unstable();
    winners.dedup();
    assert!(winners.len() > 2, "only {winners:?} ever win");
}

#[test]
fn the_number_of_runs_matters_and_budgets_end_them_all() {
    let (space, boxes) = (square(), closed());
    let run = |_| RrtConnect::new(problem(&space, &boxes)?, tuning());
    for runs in [1, 3] {
        let mut planner = OrParallel::new(runs, 10, Workers::new(2).unwrap(), run).unwrap();
        let (outcome, progress) = solve(&mut planner, 1, 500);
        assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations));
        assert_eq!(progress.iterations, 500);
        assert!(planner.planners().all(|planner| planner.progress().iterations == 500));
        assert_eq!(planner.planners().count() as u64, runs);
    }
}

#[test]
fn parallel_runs_can_be_cancelled_and_go_on() {
    let (space, boxes) = (square(), narrow());
    let run = |_| RrtConnect::new(problem(&space, &boxes)?, tuning());
    let make = || OrParallel::new(4, 2, Workers::new(2).unwrap(), run).unwrap();
    let (whole, _) = solve(&mut make(), 3, 100_000);
    let (cancel, mut planner, mut rng) = (Cancel::new(), make(), Rng::seed(3));
    let mut rounds = 0;
    let mut raise = OnEvent(|event: Event<'_, Point>| {
        rounds += u64::from(matches!(event, Event::Iteration(_)));
        if rounds == 3 {
            cancel.cancel();
        }
    });
    let outcome = planner.solve(&mut rng, &mut cancel.clone(), &mut raise);
    assert_eq!(outcome, Outcome::Stopped(StopReason::Cancelled));
    assert_eq!(planner.progress().iterations, 6);
    assert_eq!(planner.solve(&mut rng, &mut Iterations(100_000), &mut ()), whole);
}

#[test]
fn a_run_that_panics_does_not_take_the_others_along() {
    let (space, boxes) = (square(), narrow());
    let (well, ill) = (AtomicU64::new(0), AtomicU64::new(1));
    for threads in [1, 2] {
        let run = |i| {
            let check = Certified::new(&space, boxes.clone(), 1e-3).unwrap();
            let local = checked(&space, Fragile(check, if i == 0 { &ill } else { &well }));
            let (start, goal) = (Point::new(0.1, 0.2), Point::new(0.9, 0.2));
            RrtConnect::new(Problem::new(&space, local, Exact(boxes.clone()), start, goal)?, tuning())
        };
        let mut planner = OrParallel::new(3, 8, Workers::new(threads).unwrap(), run).unwrap();
        let (outcome, _) = solve(&mut planner, 1, 100_000);
        assert!(matches!(outcome, Outcome::Solved(_)) && planner.winner() != Some(0));
        assert!(planner.panics() > 0);

        // When all panic the caller hears of it, and may go on.
        well.store(1, Relaxed);
        let mut planner = OrParallel::new(3, 8, Workers::new(threads).unwrap(), run).unwrap();
        let mut rng = Rng::seed(1);
        let why = catch_unwind(AssertUnwindSafe(|| planner.step(&mut rng, &mut ()))).unwrap_err();
        assert_eq!(why.downcast_ref::<&str>(), Some(&"trouble"));
        well.store(0, Relaxed);
        let outcome = planner.solve(&mut rng, &mut Iterations(100_000), &mut ());
        assert!(matches!(outcome, Outcome::Solved(_)));
    }
}

#[test]
fn attempts_draw_from_streams_of_their_own() {
    let (space, boxes) = (square(), narrow());
    for schedule in [Schedule::Luby, Schedule::Counter, Schedule::Zeta] {
        let (mut restarted, unit) = (0, 20);
        for seed in 0..6 {
            let stream_seed = Rng::seed(seed).random();
            let mut spent = 0;
            let lengths = schedule.lengths(Rng::stream(stream_seed, 0));
            let by_hand = (1..).zip(lengths).find_map(|(attempt, length)| {
                let mut planner = RrtConnect::new(problem(&space, &boxes).unwrap(), tuning()).unwrap();
                let mut rng = Rng::stream(stream_seed, attempt);
                let outcome = planner.solve(&mut rng, &mut Iterations(length * unit), &mut ());
                spent += planner.progress().iterations;
                matches!(outcome, Outcome::Solved(_)).then_some((attempt, outcome))
            });
            let make = |_| RrtConnect::new(problem(&space, &boxes)?, tuning());
            let mut planner = Restarts::new(schedule, unit, make).unwrap();
            let (outcome, progress) = solve(&mut planner, seed, 100_000);
            assert_eq!(Some((planner.attempt(), outcome)), by_hand, "{schedule:?} seed {seed}");
            assert_eq!(progress.iterations, spent);
            restarted += planner.attempt() - 1;
        }
        assert!(restarted > 5, "{schedule:?}: {restarted} restarts");
    }
}

/// The wide search: run k makes a unit more at every count that k divides, and none is dropped.
#[test]
fn wide_attempts_take_turns() {
    let (space, boxes) = (square(), narrow());
    let unit = 20;
    let mut others = 0;
    for seed in 0..6 {
        let make = |_| RrtConnect::new(problem(&space, &boxes)?, tuning());
        let mut planner = Restarts::new(Schedule::Wide, unit, make).unwrap();
        let (outcome, progress) = solve(&mut planner, seed, 100_000);
        let stream_seed = Rng::seed(seed).random();
        let (mut runs, mut by_hand) = (Vec::new(), None);
        for count in 1.. {
            runs.push((make(count).unwrap(), Rng::stream(stream_seed, count)));
            by_hand = (1..=count).filter(|k| count.is_multiple_of(*k)).find_map(|k| {
                let (planner, rng) = &mut runs[k as usize - 1];
                let outcome = planner.solve(rng, &mut Iterations(unit * (count / k)), &mut ());
                matches!(outcome, Outcome::Solved(_)).then_some((k, outcome))
            });
            if by_hand.is_some() {
                break;
            }
        }
        assert_eq!(Some((planner.attempt(), outcome)), by_hand, "seed {seed}");
        let sum = |of: &dyn Fn(Progress) -> u64| runs.iter().map(|(p, _)| of(p.progress())).sum::<u64>();
        assert_eq!(progress.iterations, sum(&|p| p.iterations));
        // The last count may have ended before its new run began, whose trees are empty.
        assert_eq!(progress.nodes as u64, sum(&|p| p.nodes as u64));
        others += u64::from(planner.attempt() > 1);
    }
    assert!(others > 0, "the first run was always the fastest");
}

#[test]
fn restarts_keep_budgets_and_can_be_interrupted() {
    let (space, boxes) = (square(), closed());
    let make = |boxes: &Boxes<2>| {
        let boxes = boxes.clone();
        let space = &space;
        let attempt = move |_| RrtConnect::new(problem(space, &boxes)?, tuning());
        Restarts::new(Schedule::Luby, 7, attempt).unwrap()
    };
    let (outcome, progress) = solve(&mut make(&boxes), 1, 1_000);
    assert_eq!((outcome, progress.iterations), (Outcome::Stopped(StopReason::Iterations), 1_000));

    let (whole, _) = solve(&mut make(&narrow()), 1, 100_000);
    let (mut parts, mut rng) = (make(&narrow()), Rng::seed(1));
    let resumed = (1..).find_map(|n| {
        let outcome = parts.solve(&mut rng, &mut Iterations(13 * n), &mut ());
        matches!(outcome, Outcome::Solved(_)).then_some(outcome)
    });
    assert_eq!(resumed, Some(whole));
}

/// What cannot be made a second time leaves the first at work.
#[test]
fn an_attempt_that_cannot_be_made_is_done_without() {
    let (space, boxes) = (square(), narrow());
    let attempt = |k| match k {
        1 => RrtConnect::new(problem(&space, &boxes)?, tuning()),
        _ => Err(BuildError::Unmade { reason: "out of robots".into() }),
    };
    let mut planner = Restarts::new(Schedule::Luby, 5, attempt).unwrap();
    assert!(matches!(solve(&mut planner, 1, 100_000).0, Outcome::Solved(_)));
    assert_eq!(planner.attempt(), 1);
}

#[test]
fn every_planner_can_be_wrapped_by_name() {
    let (space, boxes) = (square(), slit(0.1, 0.8, 0.1));
    for info in planners() {
        for (prefix, settings) in
            [("or-", "runs=3"), ("restart-", "unit=200"), ("or-restart-", "schedule=counter")]
        {
            let name = format!("{prefix}{}", info.name);
            let settings = Settings::parse(["step=0.1", settings]).unwrap();
            let come = |threads| {
                let workers = Workers::new(threads).unwrap();
                let make = || problem(&space, &boxes);
                let mut planner = build_from(&name, make, KdTree::<2>::new(), &settings, &workers).unwrap();
                solve(&mut planner, 1, 50_000)
            };
            let (one, two) = (come(1), come(2));
            let Outcome::Solved(path) = &one.0 else { panic!("{name}: {one:?}") };
            assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
            assert_eq!(one, two, "{name}");
        }
        // Not wrapped, it is the planner itself.
        let settings = Settings::parse(["step=0.1"]).unwrap();
        let make = || problem(&space, &boxes);
        let mut plain =
            build_from(info.name, make, KdTree::<2>::new(), &settings, &Workers::single()).unwrap();
        let mut same = build_with(info.name, make().unwrap(), KdTree::<2>::new(), &settings).unwrap();
        assert_eq!(solve(&mut plain, 2, 50_000), solve(&mut same, 2, 50_000));
    }
}

#[test]
fn bad_numbers_and_names_are_refused() {
    let (space, boxes) = (square(), narrow());
    let build = |name: &str, setting: &str| {
        let settings = Settings::parse([setting]).unwrap();
        let make = || problem(&space, &boxes);
        build_from(name, make, KdTree::<2>::new(), &settings, &Workers::single()).map(|_| ())
    };
    for meta in meta_planners() {
        let inner = meta.around.map_or("rrt-connect", |names| names[0]);
        let name = format!("{}{inner}", meta.prefix);
        for parameter in meta.parameters {
            for bad in ["0", "-7", "99999999999999"] {
                assert!(build(&name, &format!("{}={bad}", parameter.name)).is_err(), "{}", parameter.name);
            }
            build(&name, &format!("{}={}", parameter.name, parameter.default)).unwrap();
        }
        let error = build(&name, "stride=1").unwrap_err().to_string();
        assert!(error.contains(meta.parameters[0].name) && error.contains("goal-bias"), "{error}");
        let error = build(&format!("{}rrt-conect", meta.prefix), "step=0.1").unwrap_err();
        assert!(error.to_string().contains("did you mean `rrt-connect`?"), "{error}");
    }
    assert!(matches!(build("or-or-or-or-or-rrt", "runs=1"), Err(BuildError::UnknownPlanner { .. })));
    for name in ["shared-rrt-connect", "shared-or-rrt", "or-shared-rsrt"] {
        assert!(matches!(build(name, "step=0.1"), Err(BuildError::UnknownPlanner { .. })), "{name}");
    }
    build("or-shared-rrt", "batch=3").unwrap();
    build("or-shared-bi-rrt", "batch=3").unwrap();
    build("shared-rrt-ext-ext", "balance=2").unwrap();
    assert!(matches!(build("or-", "runs=1"), Err(BuildError::UnknownPlanner { .. })));
    for threads in [0, Workers::MOST + 1] {
        assert!(matches!(Workers::new(threads), Err(BuildError::OutOfRange { name: "threads", .. })));
    }
    let fails = || Made::Err(BuildError::Unmade { reason: "no robot".into() });
    let made = build_from("or-rrt", fails, KdTree::<2>::new(), &Settings::default(), &Workers::single());
    assert_eq!(made.map(|_| ()), Err(BuildError::Unmade { reason: "no robot".into() }));
}
