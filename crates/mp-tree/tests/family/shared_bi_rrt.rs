//! Two trees grown by several threads.

use crate::common::*;
use crate::shared_tree::{GOAL, Local, Log, Point, START, STEP, fragile, local, tuning};
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_tree::*;
use rand::RngExt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

type Shared<'c> = SharedBiRrt<'c, Rn<2>, Local<'c>, KdTree<2>>;

fn make<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    (batch, threads): (u64, usize),
    resolution: f64,
) -> Shared<'c> {
    let problem = |_| Problem::new(space, local(space, boxes, resolution), Exact(boxes.clone()), START, GOAL);
    SharedBiRrt::new(batch, Workers::new(threads).unwrap(), tuning(0.05), problem).unwrap()
}

/// The path, the events and the counts are the same on any number of threads; with a local planner
/// that skips over a thin wall too, where paths are rejected and both trees pruned. No path touches a wall.
#[test]
fn the_number_of_threads_changes_nothing() {
    let space = square();
    let (mut rejected, mut pruned) = (0, [false; 2]);
    for (boxes, resolution) in [(slit(0.2, 0.8, 0.04), 1e-3), (slit(1e-3, 0.8, 0.1), 0.05)] {
        for batch in [1, 5, 16] {
            for seed in 0..6 {
                let come = |threads| {
                    let mut planner = make(&space, &boxes, (batch, threads), resolution);
                    let mut log = Log::default();
                    let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(20_000), &mut log);
                    (outcome, planner.progress(), log.0)
                };
                let one = come(1);
                let Outcome::Solved(path) = &one.0 else { panic!("batch {batch} seed {seed}: {:?}", one.1) };
                assert_path(&space, path, &START, |q| *q == GOAL, |_| true);
                assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
                rejected += one.1.rejected;
                for (tree, pruned) in pruned.iter_mut().enumerate() {
                    *pruned |= one.2.contains(&format!("Pruned {{ tree: {tree}"));
                }
                for threads in [2, 4] {
                    assert!(one == come(threads), "batch {batch} seed {seed}: {threads} threads differ");
                }
            }
        }
    }
    assert!(rejected > 10 && pruned == [true; 2], "{rejected} paths were rejected, {pruned:?}");
}

/// The trees by hand, which never meet: nearest of all nodes before the batch, one step, in order, nothing
/// twice; then the other tree toward each new node.
#[test]
fn a_batch_grows_one_tree_and_then_the_other_toward_what_it_gave() {
    let (space, boxes) = (square(), hollow([0.75, 0.25], 0.2, 0.02, 0.0));
    let (batch, batches) = (7, 40);
    let mut planner = make(&space, &boxes, (batch, 2), 1e-3);
    let outcome = planner.solve(&mut Rng::seed(9), &mut Iterations(batches), &mut ());
    assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations));

    let seed = Rng::seed(9).random();
    let mut trees = [vec![START], vec![GOAL]];
    let mut grow = local(&space, &boxes, 1e-3);
    let mut step = |before: &[Point], target: &Point, tree: usize| {
        let distance = |q: &&Point| space.distance(q, target);
        let near = before.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
        let way = [Direction::Forward, Direction::Backward][tree];
        match grow.extend(near, target, way, Reach::Step(STEP)) {
            Extension::Advanced(motion) | Extension::Reached(motion) => Some(motion.end),
            Extension::Trapped => None,
        }
    };
    for n in 0..batches {
        let (tree, before) = ((n % 2) as usize, trees.clone());
        let samples = n * batch..(n + 1) * batch;
        let ends = samples.filter_map(|i| {
            let target = space.sample_uniform(&mut Rng::stream(seed, i));
            step(&before[tree], &target, tree)
        });
        let ends: Vec<Point> = ends.collect();
        let other = tree ^ 1;
        let joined: Vec<Point> = ends.iter().filter_map(|end| step(&before[other], end, other)).collect();
        for (tree, found) in [(tree, ends), (other, joined)] {
            for end in found {
                if !trees[tree].contains(&end) {
                    trees[tree].push(end);
                }
            }
        }
    }
    let grown = planner.trees().map(|tree| tree.states().to_vec());
    assert_eq!(grown, trees);
    assert!(trees[0].len() > 100 && trees[1].len() > 30, "{:?}", trees.map(|tree| tree.len()));
}

#[test]
fn cancelled_and_resumed_it_comes_to_the_same() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.04));
    let whole = make(&space, &boxes, (4, 2), 1e-3).solve(&mut Rng::seed(3), &mut Iterations(20_000), &mut ());
    assert!(matches!(whole, Outcome::Solved(_)));
    let (cancel, mut planner, mut rng) = (Cancel::new(), make(&space, &boxes, (4, 2), 1e-3), Rng::seed(3));
    let mut batches = 0;
    let mut raise = OnEvent(|event: Event<'_, Point>| {
        batches += u64::from(matches!(event, Event::Iteration(_)));
        if batches == 3 {
            cancel.cancel();
        }
    });
    let outcome = planner.solve(&mut rng, &mut cancel.clone(), &mut raise);
    assert_eq!(outcome, Outcome::Stopped(StopReason::Cancelled));
    assert_eq!(planner.solve(&mut rng, &mut Iterations(20_000), &mut ()), whole);
}

/// Where the trees meet several times in a batch, each meeting is returned in its turn, once.
#[test]
fn every_meeting_is_returned() {
    let (space, boxes) = (square(), slit(0.01, 0.3, 0.3));
    let mut planner = make(&space, &boxes, (64, 2), 1e-3);
    let mut rng = Rng::seed(1);
    let mut paths: Vec<Vec<Point>> = Vec::new();
    while planner.progress().iterations < 60 {
        let Some(path) = planner.step(&mut rng, &mut ()) else { continue };
        assert_path(&space, &path, &START, |q| *q == GOAL, |_| true);
        assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
        paths.push(path.states);
    }
    let different = paths.iter().enumerate().filter(|(i, path)| !paths[..*i].contains(path)).count();
    assert!(different > 20, "{different} of {} paths", paths.len());
}

#[test]
fn a_panic_on_a_thread_loses_its_sample_and_no_tree() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.01));
    for threads in [1, 2] {
        let (well, ill) = (AtomicU64::new(0), AtomicU64::new(1));
        let problem = |i| {
            let local = fragile(&space, &boxes, if i == 2 { &ill } else { &well });
            Problem::new(&space, local, Exact(boxes.clone()), START, GOAL)
        };
        let workers = Workers::new(threads).unwrap();
        let mut planner = Shared::new(4, workers, tuning(0.05), problem).unwrap();
        let mut rng = Rng::seed(2);
        for batch in 1..=5 {
            assert_eq!(planner.step(&mut rng, &mut ()), None);
            assert_eq!(planner.panics(), batch);
        }
        let nodes = |planner: &Shared<'_>| planner.trees().map(|tree| tree.states().to_vec());
        let before = nodes(&planner);
        assert!(before.iter().all(|tree| tree.len() > 5));

        // When all panic the caller hears of it, and may go on.
        well.store(1, Relaxed);
        let why = catch_unwind(AssertUnwindSafe(|| planner.step(&mut rng, &mut ()))).unwrap_err();
        assert_eq!(why.downcast_ref::<&str>(), Some(&"trouble"));
        assert_eq!(nodes(&planner), before);
        well.store(0, Relaxed);
        let outcome = planner.solve(&mut rng, &mut Iterations(20_000), &mut ());
        let Outcome::Solved(path) = outcome else { panic!("{:?}", planner.progress()) };
        assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
        let after = nodes(&planner);
        assert!(after.iter().zip(&before).all(|(after, before)| after.starts_with(before)));
    }
}

#[test]
fn bad_input_is_refused() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.04));
    let problem = |_| Problem::new(&space, local(&space, &boxes, 1e-3), Exact(boxes.clone()), START, GOAL);
    for batch in [0, 1025, u64::MAX] {
        let made = Shared::new(batch, Workers::single(), tuning(0.05), problem);
        assert!(matches!(made, Err(BuildError::OutOfRange { name: "batch", .. })));
    }
    let unbalanced = Tuning { balance: 0.5, ..tuning(0.05) };
    let made = Shared::new(2, Workers::single(), unbalanced, problem);
    assert!(matches!(made, Err(BuildError::OutOfRange { name: "balance", .. })));
    let region = |_| {
        let goals = Goals::region(|q: &Point| q.x > 0.9);
        Problem::new(&space, local(&space, &boxes, 1e-3), Exact(boxes.clone()), START, goals)
    };
    let made = Shared::new(2, Workers::single(), tuning(0.05), region);
    assert!(matches!(made, Err(BuildError::NoGoalState { planner: "shared-bi-rrt" })));
}

/// By name, the same planner.
#[test]
fn by_name_it_is_the_same() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.04));
    let problem = || Problem::new(&space, local(&space, &boxes, 1e-3), Exact(boxes.clone()), START, GOAL);
    let settings = Settings::parse(["step=0.1", "batch=5"]).unwrap();
    let workers = Workers::new(2).unwrap();
    let mut named = build_from("shared-bi-rrt", problem, KdTree::<2>::new(), &settings, &workers).unwrap();
    let mut made = make(&space, &boxes, (5, 1), 1e-3);
    let solve = |planner: &mut dyn Planner<Point, Edge = ()>| {
        planner.solve(&mut Rng::seed(4), &mut Iterations(20_000), &mut ())
    };
    assert_eq!(solve(&mut made), solve(&mut named));
}
