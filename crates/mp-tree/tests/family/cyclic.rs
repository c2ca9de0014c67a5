//! RRT with cycles, and the alternatives it lists.

use crate::common::*;
use crate::engine::Remembers;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::Vector2;

type Point = Vector2<f64>;
type Ends = [Point; 2];

const START: Point = Point::new(0.1, 0.5);
const GOAL: Point = Point::new(0.9, 0.5);
const STEP: f64 = 0.1;
const TOLERANCE: f64 = 0.5;

/// Verifies exactly, and that an edge is where it was.
struct Replayed(Boxes<2>);

impl Verify<Point, Ends> for Replayed {
    fn verify_state(&mut self, q: &Point) -> MotionCheck {
        Exact(self.0.clone()).check_motion(q, q)
    }
    fn verify_edge(&mut self, from: &Point, edge: &Ends, to: &Point) -> MotionCheck {
        assert_eq!(*edge, [*from, *to], "an edge was moved");
        Exact(self.0.clone()).check_motion(from, to)
    }
}

type Cyclic<'c> = CyclicRrt<'c, Rn<2>, Remembers<'c>, KdTree<2>>;

fn planner<'c>(space: &'c Rn<2>, boxes: &Boxes<2>, (resolution, gain): (f64, f64)) -> Cyclic<'c> {
    biased(space, boxes, (resolution, gain), 0.05)
}

fn biased<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    (resolution, gain): (f64, f64),
    goal_bias: f64,
) -> Cyclic<'c> {
    let check = Discrete::new(space, boxes.clone(), Length::Absolute(resolution)).unwrap();
    let local = Remembers { straight: checked(space, check), gain };
    let problem = Problem::new(space, local, Replayed(boxes.clone()), START, GOAL).unwrap();
    let tuning = Tuning { step: Length::Absolute(STEP), patience: 1_000_000, goal_bias, ..Tuning::default() };
    CyclicRrt::new(problem, tuning, TOLERANCE).unwrap()
}

fn grow(planner: &mut Cyclic<'_>, seed: u64, iterations: u64) {
    let mut rng = Rng::seed(seed);
    for _ in 0..iterations {
        planner.step(&mut rng, &mut ());
    }
}

/// A block with a way above it and one below.
fn block() -> Boxes<2> {
    Boxes(vec![([0.2, 0.2], [0.8, 0.8])])
}

/// Each path leads from start to goal by edges that are there, free and run in its direction; none
/// visits a state twice; costs ascend and are what the motions cost.
fn assert_alternatives(paths: &[(Path<Point, Ends>, f64)], boxes: &Boxes<2>) {
    for (i, (path, cost)) in paths.iter().enumerate() {
        assert_eq!((path.states[0], path.states[path.states.len() - 1]), (START, GOAL));
        assert_eq!(path.edges.len() + 1, path.states.len());
        for (pair, edge) in path.states.windows(2).zip(&path.edges) {
            assert_eq!(pair, edge);
            assert!(!boxes.hit(&pair[0], &pair[1]), "not free");
            assert!((pair[1] - pair[0]).norm() <= STEP * (1.0 + TOLERANCE) + 1e-9, "too far apart");
        }
        let length: f64 = path.states.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        assert!((length - cost).abs() < 1e-9);
        assert!((1..path.states.len()).all(|n| !path.states[..n].contains(&path.states[n])));
        assert!(paths[..i].iter().all(|(other, less)| other != path && less <= cost));
    }
}

#[test]
fn both_ways_round_a_block_are_listed() {
    let (space, boxes) = (square(), block());
    for seed in 0..8 {
        let mut planner = planner(&space, &boxes, (1e-3, -1.0));
        grow(&mut planner, seed, 1_500);
        assert!(planner.cycles().count() > 50);
        let paths = planner.alternatives(40);
        assert_eq!(paths.len(), 40);
        assert_alternatives(&paths, &boxes);
        let routes = planner.routes(2, 0.3).unwrap();
        assert_alternatives(&routes, &boxes);
        let above: Vec<bool> = routes.iter().map(|(path, _)| path.states.iter().any(|q| q.y > 0.8)).collect();
        assert!(above.len() == 2 && above[0] != above[1], "seed {seed}: {above:?}");
        assert!((routes[0].1 - paths[0].1).abs() < 1e-9);

        // The first is no worse than the tree alone; fewer are the first of more; again the same.
        let goal = planner.tree().states().iter().position(|q| *q == GOAL).unwrap();
        assert!(paths[0].1 <= planner.tree().cost(goal as NodeId) + 1e-9);
        assert_eq!(planner.alternatives(40), paths);
        assert_eq!(planner.alternatives(3), paths[..3]);
        assert_eq!(planner.alternatives(0), []);
    }
}

#[test]
fn the_same_seed_lists_the_same() {
    let (space, boxes) = (square(), block());
    let come = || {
        let mut planner = planner(&space, &boxes, (1e-3, -1.0));
        grow(&mut planner, 3, 800);
        (planner.alternatives(10), planner.cycles().collect::<Vec<_>>(), planner.progress())
    };
    assert_eq!(come(), come());
}

/// The local planner skips over thin walls, so that paths are rejected and the tree is pruned, many
/// times: edges beside the tree stay where they were, none is left without its ends, and no
/// alternative crosses a wall.
#[test]
fn pruning_keeps_the_edges_beside_the_tree_in_their_place() {
    let space = square();
    let mut boxes = block();
    boxes.0.extend([([0.4, 0.8], [0.401, 0.95]), ([0.6, 0.05], [0.601, 0.2])]);
    let (mut rejected, mut lost) = (0, 0);
    for seed in 0..8 {
        let mut planner = biased(&space, &boxes, (0.06, -1.0), 0.01);
        let mut rng = Rng::seed(seed);
        let mut before = (0, 0_usize);
        for _ in 0..2_000 {
            planner.step(&mut rng, &mut ());
            let now = (planner.progress().rejected, planner.cycles().count());
            if now.0 > before.0 {
                lost += before.1.saturating_sub(now.1);
                let tree = planner.tree();
                for (a, b) in planner.cycles() {
                    assert!((a as usize) < tree.len() && (b as usize) < tree.len());
                    let apart = (tree.state(a) - tree.state(b)).norm();
                    assert!(apart <= STEP * (1.0 + TOLERANCE) + 1e-9, "{a} and {b} are {apart} apart");
                    assert!(tree.parent(a) != Some(b) && tree.parent(b) != Some(a));
                }
            }
            before = now;
        }
        rejected += before.0;
        let paths = planner.alternatives(20);
        assert!(paths.len() == 20, "seed {seed}: {} paths", paths.len());
        assert_alternatives(&paths, &boxes);
        // Pruning after alternatives were listed keeps what was learnt of edges in its place as well.
        grow(&mut planner, seed + 100, 1_000);
        assert_alternatives(&planner.alternatives(20), &boxes);
    }
    assert!(rejected > 20 && lost > 20, "{rejected} rejected, {lost} edges lost");
}

/// Motions that cannot run backward are not.
#[test]
fn one_way_motions_are_run_one_way() {
    let (space, boxes) = (square(), block());
    let mut listed = 0;
    for seed in 0..6 {
        let mut planner = planner(&space, &boxes, (1e-3, 1e-3));
        grow(&mut planner, seed, 3_000);
        let paths = planner.alternatives(10);
        assert_alternatives(&paths, &boxes);
        assert!(paths.iter().all(|(path, _)| path.states.is_sorted_by(|a, b| a.x < b.x)));
        listed += paths.len();
    }
    assert!(listed >= 6, "only {listed} paths");
}

#[test]
fn without_a_path_there_is_no_alternative() {
    let (space, boxes) = (square(), hollow([0.9, 0.5], 0.05, 0.02, 0.0));
    let mut planner = planner(&space, &boxes, (1e-3, -1.0));
    assert_eq!(planner.alternatives(5), []);
    grow(&mut planner, 1, 1_500);
    assert!(planner.cycles().count() > 10);
    assert_eq!(planner.routes(5, 0.1), Ok(Vec::new()));
    assert_eq!(planner.alternatives(5), []);
}

#[test]
fn bad_tolerances_are_refused() {
    let (space, boxes) = (square(), block());
    for apart in [-0.1, f64::NAN] {
        let error = planner(&space, &boxes, (1e-3, -1.0)).routes(2, apart).unwrap_err();
        assert!(matches!(error, BuildError::OutOfRange { name: "apart", .. }), "{error}");
    }
    for (tolerance, step, name) in [
        (-0.1, 0.1, "tolerance"),
        (1.1, 0.1, "tolerance"),
        (f64::NAN, 0.1, "tolerance"),
        (f64::INFINITY, 0.1, "tolerance"),
        (0.2, -0.1, "step"),
    ] {
        let check = Discrete::new(&space, boxes.clone(), Length::Absolute(0.01)).unwrap();
        let local = checked(&space, check);
        let problem = Problem::new(&space, local, Exact(boxes.clone()), START, GOAL).unwrap();
        let tuning = Tuning { step: Length::Absolute(step), ..Tuning::default() };
        let error = CyclicRrt::new(problem, tuning, tolerance).map(|_| ()).unwrap_err();
        assert!(matches!(error, BuildError::OutOfRange { name: n, .. } if n == name), "{error}");
    }
}

/// A way below two blocks, one between them and one above: each is listed once.
#[test]
fn three_routes_are_three_ways() {
    let (space, boxes) = (square(), Boxes(vec![([0.3, 0.2], [0.7, 0.55]), ([0.3, 0.67], [0.7, 0.85])]));
    for seed in 0..6 {
        let mut planner = planner(&space, &boxes, (1e-3, -1.0));
        grow(&mut planner, seed, 3_000);
        let routes = planner.routes(3, 0.25).unwrap();
        assert_alternatives(&routes, &boxes);
        let way = |path: &Path<Point, Ends>| {
            let inside = path.states.iter().find(|q| q.x > 0.35 && q.x < 0.65).unwrap();
            u8::from(inside.y > 0.4) + u8::from(inside.y > 0.75)
        };
        let mut ways: Vec<u8> = routes.iter().map(|(path, _)| way(path)).collect();
        ways.sort_unstable();
        assert_eq!(ways, [0, 1, 2], "seed {seed}");
    }
}
