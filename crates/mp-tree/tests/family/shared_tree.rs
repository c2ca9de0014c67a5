//! One tree grown by several threads.

use crate::common::*;
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::Vector2;
use rand::RngExt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

pub(crate) type Point = Vector2<f64>;
pub(crate) type Local<'c> = Straight<'c, Rn<2>, mp_cspace::erased::AnyCheck<'c, Vector2<f64>>>;
type Shared<'c> = SharedTree<'c, Rn<2>, Local<'c>, KdTree<2>>;

pub(crate) const START: Point = Point::new(0.1, 0.2);
pub(crate) const GOAL: Point = Point::new(0.9, 0.2);
pub(crate) const STEP: f64 = 0.1;

pub(crate) fn local<'c>(space: &'c Rn<2>, boxes: &Boxes<2>, resolution: f64) -> Local<'c> {
    let check = Discrete::new(space, boxes.clone(), Length::Absolute(resolution)).unwrap();
    Straight::new(space, Box::new(check))
}

pub(crate) fn tuning(goal_bias: f64) -> Tuning {
    Tuning { step: Length::Absolute(STEP), goal_bias, ..Tuning::default() }
}

fn make<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    (batch, threads): (u64, usize),
    resolution: f64,
) -> Shared<'c> {
    let problem = |_| Problem::new(space, local(space, boxes, resolution), Exact(boxes.clone()), START, GOAL);
    SharedTree::new(batch, Workers::new(threads).unwrap(), tuning(0.05), problem).unwrap()
}

/// All that an observer sees, as text.
#[derive(Default)]
pub(crate) struct Log(pub(crate) String);

impl Observer<Point> for Log {
    fn on(&mut self, event: Event<'_, Point>) {
        self.0 += &format!("{event:?}\n");
    }
}

/// The path, the events and the counts are the same on any number of threads; with a local planner
/// that skips over a thin wall too, where paths are rejected and trees pruned.
#[test]
fn the_number_of_threads_changes_nothing() {
    let space = square();
    let mut rejected = 0;
    for (boxes, resolution) in [(slit(0.2, 0.8, 0.04), 1e-3), (slit(1e-3, 0.8, 0.1), 0.05)] {
        for batch in [1, 5, 16] {
            for seed in 0..4 {
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
                for threads in [2, 4] {
                    assert!(one == come(threads), "batch {batch} seed {seed}: {threads} threads differ");
                }
            }
        }
    }
    assert!(rejected > 10, "only {rejected} paths were rejected");
}

/// The tree by hand: nearest of all nodes before the batch, one step, in order, nothing twice.
#[test]
fn a_batch_is_drawn_from_its_streams_and_grows_from_the_tree_before_it() {
    let (space, boxes) = (square(), hollow([0.9, 0.2], 0.05, 0.02, 0.0));
    let (batch, batches, bias) = (7, 40, 0.2);
    let problem = |_| Problem::new(&space, local(&space, &boxes, 1e-3), Exact(boxes.clone()), START, GOAL);
    let mut planner =
        Shared::with_index(batch, Workers::new(2).unwrap(), KdTree::new(), tuning(bias), problem).unwrap();
    let outcome = planner.solve(&mut Rng::seed(9), &mut Iterations(batches), &mut ());
    assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations));

    let seed = Rng::seed(9).random();
    let (mut nodes, mut parents, mut same) = (vec![START], vec![None], 0);
    for first in (0..batches).map(|n| n * batch) {
        let before = nodes.clone();
        for sample in first..first + batch {
            let mut rng = Rng::stream(seed, sample);
            let target = if rng.random_bool(bias) { GOAL } else { space.sample_uniform(&mut rng) };
            let distance = |id: &usize| space.distance(&before[*id], &target);
            let near = (0..before.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
            let mut local_planner = local(&space, &boxes, 1e-3);
            let extension =
                local_planner.extend(&before[near], &target, Direction::Forward, Reach::Step(STEP));
            let (Extension::Advanced(motion) | Extension::Reached(motion)) = extension else { continue };
            match nodes.contains(&motion.end) {
                true => same += 1,
                false => {
                    nodes.push(motion.end);
                    parents.push(Some(near as NodeId));
                }
            }
        }
    }
    let tree = planner.tree();
    assert_eq!(tree.states(), nodes);
    assert!((0..tree.len()).all(|id| tree.parent(id as NodeId) == parents[id]));
    assert!(tree.len() > 100 && same > 0, "{} nodes, {same} found twice", tree.len());
    assert_eq!(planner.progress().motions, 1 + batch * batches);
}

#[test]
fn cancelled_and_resumed_it_comes_to_the_same() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.04));
    let whole = make(&space, &boxes, (8, 2), 1e-3).solve(&mut Rng::seed(3), &mut Iterations(20_000), &mut ());
    assert!(matches!(whole, Outcome::Solved(_)));
    let (cancel, mut planner, mut rng) = (Cancel::new(), make(&space, &boxes, (8, 2), 1e-3), Rng::seed(3));
    let mut batches = 0;
    let mut raise = OnEvent(|event: Event<'_, Point>| {
        batches += u64::from(matches!(event, Event::Iteration(_)));
        if batches == 3 {
            cancel.cancel();
        }
    });
    let outcome = planner.solve(&mut rng, &mut cancel.clone(), &mut raise);
    assert_eq!(outcome, Outcome::Stopped(StopReason::Cancelled));
    assert_eq!(planner.progress().iterations, 3);
    assert_eq!(planner.solve(&mut rng, &mut Iterations(20_000), &mut ()), whole);
}

/// Every arrival of a batch is returned in its turn, and is in the tree once.
#[test]
fn several_goals_may_be_reached_in_one_batch() {
    let space = square();
    let boxes: Boxes<2> = slit(0.1, 0.2, 0.1);
    let problem = |_| {
        let goals = Goals::region(|q: &Point| q.x > 0.15);
        Problem::new(&space, local(&space, &boxes, 1e-3), Exact(boxes.clone()), START, goals)
    };
    let mut planner = Shared::new(32, Workers::single(), tuning(0.0), problem).unwrap();
    let mut rng = Rng::seed(1);
    let mut ends = Vec::new();
    while let Some(path) = planner.step(&mut rng, &mut ()) {
        let end = *path.states.last().unwrap();
        assert!(end.x > 0.15 && !ends.contains(&end));
        ends.push(end);
        if ends.len() == 60 {
            break;
        }
    }
    let nodes = planner.tree().states();
    assert!(ends.len() == 60 && nodes.len() < 100, "{} of {} nodes", ends.len(), nodes.len());
    assert!(nodes.iter().enumerate().all(|(i, q)| !nodes[..i].contains(q)));
}

/// Panics on each extension while `trouble` is above zero.
pub(crate) fn fragile<'c>(space: &'c Rn<2>, boxes: &Boxes<2>, trouble: &'c AtomicU64) -> Local<'c> {
    checked(space, Fragile(local(space, boxes, 1e-3).check, trouble))
}

#[test]
fn a_panic_on_a_thread_loses_its_sample_and_no_tree() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.04));
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
        let nodes = planner.tree().states().to_vec();
        assert!(nodes.len() > 5);

        // When all panic the caller hears of it, and may go on.
        well.store(1, Relaxed);
        let why = catch_unwind(AssertUnwindSafe(|| planner.step(&mut rng, &mut ()))).unwrap_err();
        assert_eq!(why.downcast_ref::<&str>(), Some(&"trouble"));
        assert_eq!(planner.tree().states(), nodes);
        well.store(0, Relaxed);
        let outcome = planner.solve(&mut rng, &mut Iterations(20_000), &mut ());
        assert!(matches!(outcome, Outcome::Solved(_)));
        assert_eq!(planner.tree().states()[..nodes.len()], nodes);
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
    let made = Shared::new(2, Workers::single(), tuning(f64::NAN), problem);
    assert!(matches!(made, Err(BuildError::OutOfRange { name: "goal-bias", .. })));
    let fails = |i| match i {
        2 => Err(BuildError::Unmade { reason: "out of robots".into() }),
        _ => problem(i),
    };
    let made = Shared::new(2, Workers::single(), tuning(0.05), fails);
    assert!(matches!(made, Err(BuildError::Unmade { .. })));
}

#[test]
fn by_name_it_is_the_same() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.04));
    let problem = || Problem::new(&space, local(&space, &boxes, 1e-3), Exact(boxes.clone()), START, GOAL);
    let settings = Settings::parse(["step=0.1", "batch=5"]).unwrap();
    let workers = Workers::new(2).unwrap();
    let mut named = build_from("shared-rrt", problem, KdTree::<2>::new(), &settings, &workers).unwrap();
    let mut made = make(&space, &boxes, (5, 1), 1e-3);
    let solve = |planner: &mut dyn Planner<Point, Edge = ()>| {
        planner.solve(&mut Rng::seed(4), &mut Iterations(20_000), &mut ())
    };
    assert_eq!(solve(&mut made), solve(&mut named));
}
