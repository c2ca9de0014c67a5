//! A panic in the user's code does not lose the tree: planning goes on with it.

use crate::common::*;
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::Vector2;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

type Point = Vector2<f64>;

/// Calls until the next panic, shared by all that may panic. Zero: never.
#[derive(Clone, Debug, Default)]
struct Fuse(Arc<AtomicU64>);

impl Fuse {
    fn burn(&self) {
        let left = self.0.load(Relaxed);
        self.0.store(left.saturating_sub(1), Relaxed);
        assert!(left != 1, "the fuse");
    }
}

/// Panics where it is asked, then is right.
#[derive(Clone, Debug)]
struct Fragile<V>(V, Fuse);

impl<V: MotionValidity<Point>> MotionValidity<Point> for Fragile<V> {
    fn check_motion(&mut self, from: &Point, to: &Point) -> MotionCheck {
        self.1.burn();
        self.0.check_motion(from, to)
    }
}

impl Observer<Point> for Fuse {
    fn on(&mut self, event: Event<'_, Point>) {
        if matches!(event, Event::Rooted { .. } | Event::Added { .. } | Event::Pruned { .. }) {
            self.burn();
        }
    }
}

fn planner<'c>(name: &str, space: &'c Rn<2>, boxes: &Boxes<2>, fuse: &Fuse) -> AnyPlanner<'c, Point, ()> {
    let coarse = Discrete::new(space, boxes.clone(), Length::Absolute(0.05)).unwrap();
    // Of the type that other tests have, too.
    let check: mp_cspace::erased::AnyCheck<'c, Point> = Box::new(Fragile(coarse, fuse.clone()));
    let local = Straight::new(space, check);
    let verifier = Fragile(Exact(boxes.clone()), fuse.clone());
    let goals = Goals::states([Point::new(0.9, 0.2), Point::new(0.9, 0.9)]);
    let problem = Problem::new(space, local, verifier, Point::new(0.1, 0.2), goals).unwrap();
    let problem = problem.with_obstacles(knowledge(space, boxes));
    build_with(name, problem, KdTree::<2>::new(), &Settings::parse(["step=0.1"]).unwrap()).unwrap()
}

/// Whatever call of the user's code panics, the first one or a later one, on every planner: the
/// next steps go on from the tree there is and solve the problem.
#[test]
fn planning_goes_on_after_a_panic_anywhere() {
    let (space, boxes) = (square(), slit(1e-3, 0.6, 0.1));
    for info in planners() {
        let mut interrupted = 0;
        for calls in (1..40).chain([80, 160, 320]) {
            let mut fuse = Fuse::default();
            let mut planner = planner(info.name, &space, &boxes, &fuse);
            fuse.0.store(calls, Relaxed);
            let mut rng = Rng::seed(calls);
            let mut nodes = 0;
            let path = loop {
                let before = planner.progress();
                let step = AssertUnwindSafe(|| planner.step(&mut rng, &mut fuse));
                match catch_unwind(step) {
                    Ok(Some(path)) => break path,
                    Ok(None) => nodes = planner.progress().nodes,
                    Err(_) => {
                        interrupted += 1;
                        let after = planner.progress();
                        let kept = after.nodes >= nodes || after.rejected > before.rejected;
                        assert!(kept, "{}: {calls} calls: lost nodes", info.name);
                        assert_eq!(after.iterations, before.iterations + 1);
                    }
                }
                assert!(before.iterations < 20_000, "{} after {calls} calls", info.name);
            };
            assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
            assert_eq!(path.states[0], Point::new(0.1, 0.2));
        }
        assert!(interrupted > 30, "{}: only {interrupted} panics", info.name);
    }
}
