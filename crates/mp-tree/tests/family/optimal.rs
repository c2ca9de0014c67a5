//! Planners that improve: paths get ever cheaper, trees stay what their events say.

use crate::common::*;
use crate::engine::Remembers;
use mp_cspace::registry::{Demand, PlannerInfo, Settings};
use mp_cspace::*;
use mp_tree::*;
use nalgebra::Vector2;

type Point = Vector2<f64>;
type Local<'c> = Straight<'c, Rn<2>, mp_cspace::erased::AnyCheck<'c, Vector2<f64>>>;

const START: [f64; 2] = [0.1, 0.2];
const GOAL: [f64; 2] = [0.9, 0.2];

/// A wall with a gap whose lower edge is at 0.5: around it goes the shortest way.
fn wall() -> (Boxes<2>, f64) {
    let leg = Point::new(0.35, 0.3).norm();
    (slit(0.1, 0.6, 0.2), 2.0 * leg + 0.1)
}

fn problem<'c>(space: &'c Rn<2>, boxes: &Boxes<2>) -> Problem<'c, Rn<2>, Local<'c>> {
    let local = certified(space, boxes.clone(), 1e-4);
    let problem = Problem::new(space, local, Exact(boxes.clone()), START.into(), Point::from(GOAL)).unwrap();
    problem.with_obstacles(knowledge(space, boxes))
}

fn improving() -> impl Iterator<Item = &'static PlannerInfo> {
    let space = square();
    let improves = move |info: &&PlannerInfo| {
        build(info.name, problem(&space, &Boxes::default()), &Settings::default()).unwrap().improves()
    };
    planners().iter().filter(improves)
}

/// The lengths of the paths found, in turn.
fn lengths(name: &str, seed: u64, iterations: u64, settings: &[&str]) -> Vec<f64> {
    let (space, (boxes, _)) = (square(), wall());
    let settings = Settings::parse(settings).unwrap();
    let mut planner = build(name, problem(&space, &boxes), &settings).unwrap();
    let mut lengths = Vec::new();
    let found = |path: &Path<Point>, _| {
        assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
        assert_eq!(path.states.first(), Some(&Point::from(START)));
        assert_eq!(path.states.last(), Some(&Point::from(GOAL)));
        lengths.push(path.length(&space));
    };
    let (best, reason) =
        improve(&mut *planner, &mut Rng::seed(seed), &mut Iterations(iterations), &mut (), found);
    assert_eq!(reason, Some(StopReason::Iterations));
    assert_eq!(best.map(|path| path.length(&space)), lengths.last().copied());
    lengths
}

#[test]
fn paths_become_ever_shorter_and_nearly_the_shortest() {
    let (_, shortest) = wall();
    assert!(improving().count() >= 2);
    for info in improving() {
        for seed in 0..5 {
            let lengths = lengths(info.name, seed, 4_000, &["step=0.1"]);
            assert!(lengths.len() > 2, "{} seed {seed}: {lengths:?}", info.name);
            assert!(lengths.is_sorted_by(|a, b| a > b), "{} seed {seed}: {lengths:?}", info.name);
            let last = lengths.last().unwrap();
            assert!(*last > shortest && *last < 1.03 * shortest, "{} seed {seed}: {last}", info.name);
        }
    }
}

#[test]
fn informed_samples_find_shorter_paths_in_the_same_time() {
    let (_, shortest) = wall();
    let excess = |name: &str| -> f64 {
        (0..10).map(|seed| lengths(name, seed, 1_500, &["step=0.1"]).last().unwrap() - shortest).sum()
    };
    let (blind, informed) = (excess("rrt-star"), excess("informed-rrt-star"));
    assert!(informed < 0.7 * blind, "{informed} against {blind}");
}

#[test]
fn a_ball_does_as_well_as_a_number() {
    let (_, shortest) = wall();
    let lengths = lengths("rrt-star", 1, 4_000, &["step=0.1", "gamma=1.5"]);
    assert!(*lengths.last().unwrap() < 1.03 * shortest);
}

/// The cost of an expensive disc between start and goal.
fn disc(q: &Point) -> f64 {
    nearness((q - Point::new(0.5, 0.25)).norm(), 0.25)
}

fn around_disc(space: &Rn<2>) -> StateCostIntegral<'_, Rn<2>, fn(&Point) -> f64> {
    StateCostIntegral::new(space, disc as fn(&Point) -> f64, 20.0, Length::Fraction(0.002)).unwrap()
}

/// The least cost between start and goal along the edges of a grid, by Dijkstra's algorithm without a heap.
fn on_grid(space: &Rn<2>) -> f64 {
    const N: usize = 40;
    let mut objective = around_disc(space);
    let at = |i: usize| Point::new((i % (N + 1)) as f64, (i / (N + 1)) as f64) / N as f64;
    let [start, goal] =
        [START, GOAL].map(|p| (p[1] * N as f64) as usize * (N + 1) + (p[0] * N as f64) as usize);
    let mut costs = vec![f64::INFINITY; (N + 1) * (N + 1)];
    let mut open: Vec<usize> = (0..costs.len()).collect();
    costs[start] = 0.0;
    loop {
        let (place, &here) =
            open.iter().enumerate().min_by(|a, b| costs[*a.1].total_cmp(&costs[*b.1])).unwrap();
        if here == goal {
            return costs[goal];
        }
        open.swap_remove(place);
        // All directions of a square of seven by seven: 1.4% longer than straight at most.
        for &next in &open {
            let apart = (at(next) - at(here)) * N as f64;
            if apart.amax() < 3.5 {
                costs[next] = costs[next].min(costs[here] + objective.cost(&at(here), &at(next)));
            }
        }
    }
}

#[test]
fn paths_go_around_an_expensive_disc() {
    let space = square();
    let best = on_grid(&space);
    let mut objective = around_disc(&space);
    assert!(best < 0.3 * objective.cost(&START.into(), &GOAL.into()));
    for info in improving() {
        for seed in 0..3 {
            let problem = problem(&space, &Boxes::default()).with_objective(Box::new(around_disc(&space)));
            let mut planner = build(info.name, problem, &Settings::parse(["step=0.1"]).unwrap()).unwrap();
            let mut costs = Vec::new();
            let found = |path: &Path<Point>, _| costs.push(objective.path_cost(path));
            improve(&mut *planner, &mut Rng::seed(seed), &mut Iterations(4_000), &mut (), found);
            assert!(costs.is_sorted_by(|a, b| a > b), "{} seed {seed}: {costs:?}", info.name);
            let last = costs.last().unwrap() / best;
            // The grid is no cheaper than the best way, but for what the integral misses, and hardly dearer.
            assert!(last > 0.98 && last < 1.04, "{} seed {seed}: {last}", info.name);
        }
    }
}

/// Rebuilds parents from events alone.
#[derive(Default)]
struct Parents(Vec<Option<NodeId>>, usize);

impl Observer<Point> for Parents {
    fn on(&mut self, event: Event<'_, Point>) {
        match event {
            Event::Rooted { .. } => self.0.push(None),
            Event::Added { id, parent, .. } => {
                assert_eq!(id as usize, self.0.len());
                self.0.push(Some(parent));
            }
            Event::Rewired { id, parent, .. } => {
                self.1 += 1;
                self.0[id as usize] = Some(parent);
            }
            Event::Pruned { survivors, .. } => {
                let renamed = |id| survivors.binary_search(&id).unwrap() as NodeId;
                self.0 = survivors.iter().map(|&id| self.0[id as usize].map(renamed)).collect();
            }
            _ => {}
        }
    }
}

/// With a check that skips over the wall now and then, so that there is pruning too.
#[test]
fn events_tell_of_rewiring_and_costs_add_up() {
    let (space, boxes) = (square(), slit::<2>(1e-3, 0.6, 0.05));
    for patience in [0, 3, u64::MAX] {
        let check = Discrete::new(&space, boxes.clone(), Length::Absolute(0.05)).unwrap();
        let local = checked(&space, check);
        let problem =
            Problem::new(&space, local, Exact(boxes.clone()), START.into(), Point::from(GOAL)).unwrap();
        let tuning = Tuning { step: Length::Absolute(0.1), patience, ..Tuning::default() };
        let mut planner = RrtStar::new(problem, tuning).unwrap();
        let (mut seen, mut rng) = (Parents::default(), Rng::seed(1));
        let mut paths = 0;
        for _ in 0..3_000 {
            paths += usize::from(planner.step(&mut rng, &mut seen).is_some());
        }
        let tree = planner.tree();
        let ids = 0..tree.len() as NodeId;
        assert_eq!(ids.clone().map(|id| tree.parent(id)).collect::<Vec<_>>(), seen.0);
        for id in ids {
            let (cost, length) = (tree.cost(id), tree.path(id).length(&space));
            assert!((cost - length).abs() < 1e-12);
            if patience == 0 || tree.is_verified(id) {
                let edge = tree.parent(id).map(|parent| (tree.state(parent), tree.state(id)));
                assert!(edge.is_none_or(|(a, b)| !boxes.hit(a, b)));
            }
        }
        // One that believes such a check to the end always prefers the way through the wall.
        assert!(seen.1 > 1_000 && (paths > 0 || patience > 3), "{} rewired, {paths} paths", seen.1);
        assert_eq!(planner.progress().rejected > 0, patience > 0);
    }
}

struct Anything;
impl Verify<Point, [Point; 2]> for Anything {
    fn verify_state(&mut self, _: &Point) -> MotionCheck {
        MotionCheck::Free { clearance: 0.0 }
    }
    fn verify_edge(&mut self, _: &Point, _: &[Point; 2], _: &Point) -> MotionCheck {
        MotionCheck::Free { clearance: 0.0 }
    }
}

#[test]
fn rewired_edges_are_in_forward_time_in_trees_of_both_directions() {
    let (space, (boxes, _)) = (square(), wall());
    let local = certified(&space, boxes, 1e-3);
    let problem =
        Problem::new(&space, Remembers::new(local), Anything, START.into(), Point::from(GOAL)).unwrap();
    let parts = TreePlannerParts {
        target_sampler: Samples(Uniform(&space)),
        selector: NearestSelector(Linear::new()),
        extender: (Extend, Connect::default()),
        inserter: Rewire::default(),
        tuning: Tuning { step: Length::Absolute(0.05), ..Tuning::default() },
    };
    let mut planner = TwoTrees::assemble("rewired", problem, parts).unwrap();
    let (mut rng, mut rewired) = (Rng::seed(1), [0; 2]);
    for _ in 0..1_000 {
        let mut count = OnEvent(|event: Event<'_, Point>| {
            if let Event::Rewired { tree, .. } = event {
                rewired[tree] += 1;
            }
        });
        planner.step(&mut rng, &mut count);
    }
    assert!(rewired.iter().all(|&count| count > 50), "{rewired:?}");
    for tree in planner.trees() {
        for id in 0..tree.len() as NodeId {
            let path = tree.path(id);
            for (pair, edge) in path.states.windows(2).zip(&path.edges) {
                assert_eq!(pair, edge);
            }
        }
    }
}

#[test]
fn goals_of_every_kind_improve() {
    let (space, (boxes, _)) = (square(), wall());
    let ends = [Point::new(0.9, 0.9), Point::new(0.9, 0.2)];
    let local = || certified(&space, boxes.clone(), 1e-3);
    for info in improving().filter(|info| info.can(Demand::Region)) {
        let kinds: [Goals<'_, Point>; 3] = [
            Goals::states(ends),
            Goals::region(|q: &Point| q.x > 0.9),
            Goals::sampled(Ball::new(&space, ends[1], 0.05).unwrap()),
        ];
        for goals in kinds {
            let problem = Problem::new(&space, local(), Exact(boxes.clone()), START.into(), goals).unwrap();
            let problem = problem.with_obstacles(knowledge(&space, &boxes));
            let mut planner = build(info.name, problem, &Settings::parse(["step=0.1"]).unwrap()).unwrap();
            let mut lengths = Vec::new();
            improve(&mut *planner, &mut Rng::seed(1), &mut Iterations(3_000), &mut (), |path, _| {
                lengths.push(path.length(&space));
            });
            assert!(lengths.len() > 1 && lengths.is_sorted_by(|a, b| a > b), "{lengths:?}");
        }
    }
}

#[test]
fn what_counts_as_near_must_be_in_range() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for near in [Near::KNearest { factor: bad }, Near::Radius { gamma: bad }] {
            assert!(matches!(Rewire::new(near), Err(BuildError::OutOfRange { .. })));
        }
    }
}
