//! Trees whose edges bend, by name, of a point and of a rod: what they find is free, and what cannot be found
//! is not.

use crate::common::*;
use mp_cspace::erased::AnySpace;
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_snake::*;
use mp_tree::*;
use nalgebra::{SVector, Vector2};
use std::sync::Arc;

type Point = Vector2<f64>;

/// The signed distance to boxes, and its gradient.
fn field(boxes: &Boxes<2>) -> impl FnMut(&Point, f64, &mut [f64]) -> f64 + Clone + use<> {
    let boxes = boxes.clone();
    move |q, _, gradient| {
        let to_box = |(low, high): &([f64; 2], [f64; 2])| {
            let beyond = Point::from_fn(|i, _| (low[i] - q[i]).max(q[i] - high[i]));
            let sign = Point::from_fn(|i, _| if 2.0 * q[i] < low[i] + high[i] { -1.0 } else { 1.0 });
            let outside = beyond.map(|x| x.max(0.0));
            let deepest = if beyond.x > beyond.y { Point::x() } else { Point::y() };
            match outside.norm() {
                0.0 => (beyond.max(), deepest.component_mul(&sign)),
                far => (far, (outside / far).component_mul(&sign)),
            }
        };
        let nearest = boxes.0.iter().map(to_box).min_by(|a, b| a.0.total_cmp(&b.0));
        let (distance, slope) = nearest.unwrap_or((f64::INFINITY, Point::zeros()));
        gradient.copy_from_slice(slope.as_slice());
        distance
    }
}

/// A grid of small boxes, every second row shifted.
fn orchard() -> Boxes<2> {
    let place = |i: usize, j: usize| [0.1 + 0.16 * i as f64 + 0.08 * (j % 2) as f64, 0.14 + 0.12 * j as f64];
    let around = |[x, y]: [f64; 2]| ([x - 0.03, y - 0.025], [x + 0.03, y + 0.025]);
    Boxes((0..5).flat_map(|i| (0..7).map(move |j| around(place(i, j)))).collect())
}

fn problem<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    ends: [[f64; 2]; 2],
) -> Problem<'c, Rn<2>, Checked<'c, Rn<2>>> {
    let local = certified(space, boxes.clone(), 1e-3);
    let problem = Problem::new(space, local, Exact(boxes.clone()), ends[0].into(), SVector::from(ends[1]));
    bending(problem.unwrap(), field(boxes))
}

/// A problem that knows the gradient of the clearance.
fn bending<'c, C: Space, L: LocalPlanner<C::State>>(
    problem: Problem<'c, C, L>,
    field: impl FnMut(&C::State, f64, &mut [f64]) -> f64 + Send + 'c,
) -> Problem<'c, C, L> {
    problem
        .with_obstacles(ObstacleKnowledge { gradient: Some(Box::new(field)), ..ObstacleKnowledge::default() })
}

const SNAKES: [&str; 2] = ["rrs", "rrs-connect"];
const BENDS: [&str; 3] = ["bend=snake", "bend=bulge", "bend=hybrid"];

fn solve(
    name: &str,
    boxes: &Boxes<2>,
    ends: [[f64; 2]; 2],
    settings: &[&str],
    seed: u64,
    limit: u64,
) -> (Option<Path<Point>>, u64) {
    let space = square();
    let settings = Settings::parse(settings).unwrap();
    let problem = problem(&space, boxes, ends);
    let mut planner = build(name, problem, &settings).unwrap();
    let path = match planner.solve(&mut Rng::seed(seed), &mut Iterations(limit), &mut ()) {
        Outcome::Solved(path) => Some(path),
        Outcome::Stopped(_) => None,
    };
    (path, planner.progress().iterations)
}

const ENDS: [[f64; 2]; 2] = [[0.03, 0.05], [0.97, 0.95]];

#[test]
fn passages_are_passed_and_paths_are_free() {
    let space = square();
    let trap = hollow([0.5, 0.5], 0.2, 0.05, 0.03);
    let worlds = [
        (slit(0.1, 0.8, 0.06), [[0.1, 0.2], [0.9, 0.2]]),
        (trap, [[0.5, 0.5], [0.05, 0.5]]),
        (orchard(), ENDS),
    ];
    for (name, bend) in SNAKES.into_iter().flat_map(|name| BENDS.map(|bend| (name, bend))) {
        for (boxes, ends) in &worlds {
            for seed in 0..10 {
                let settings = ["step=0.25", "range=0.03", bend];
                let (path, _) = solve(name, boxes, *ends, &settings, seed, 40_000);
                let path = path.unwrap_or_else(|| panic!("{name} {bend} seed {seed}"));
                assert_path(
                    &space,
                    &path,
                    &ends[0].into(),
                    |q| *q == Point::from(ends[1]),
                    |q| boxes.distance(q) > 0.0,
                );
                assert!(!path.states.windows(2).any(|w| boxes.hit(&w[0], &w[1])), "{} seed {seed}", name);
                let again = solve(name, boxes, *ends, &settings, seed, 40_000);
                assert_eq!(again.0, Some(path), "the same seed gives the same path");
            }
        }
    }
}

#[test]
fn what_is_closed_stays_closed() {
    let closed = hollow([0.5, 0.5], 0.2, 0.02, 0.0);
    for name in SNAKES {
        for seed in 0..3 {
            let (path, _) = solve(name, &closed, [[0.5, 0.5], [0.05, 0.5]], &["range=0.1"], seed, 1500);
            assert_eq!(path, None, "{} seed {seed}", name);
        }
    }
}

/// Among small obstacles, with steps longer than the gaps, bends save most of the iterations.
#[test]
fn rescued_samples_save_iterations() {
    for (plain, bending, most) in [("rrt", "rrs", 0.5), ("rrt-connect", "rrs-connect", 0.7)] {
        let total = |name: &str, settings: &[&str]| {
            (0..20).map(|seed| solve(name, &orchard(), ENDS, settings, seed, 40_000).1).sum::<u64>() as f64
        };
        let plain = total(plain, &["step=0.4"]);
        for bend in BENDS {
            let bent = total(bending, &["step=0.4", "range=0.03", bend]);
            assert!(bent < most * plain, "{bending} {bend}: {bent} iterations instead of {plain}");
        }
    }
}

/// Edges of the tree are curves, verified piece by piece; a verifier that finds one of the pieces in
/// collision rejects the path.
#[test]
fn edges_of_the_tree_are_curves() {
    let (space, boxes) = (square(), orchard());
    let check = Certified::new(&space, boxes.clone(), 1e-3).unwrap();
    let local = SnakePlanner::new(&space, check, field(&boxes), 0.03).unwrap();
    let [start, goal] = ENDS.map(Point::from);
    let problem = Problem::new(&space, local, Exact(boxes.clone()), start, goal).unwrap();
    let tuning = Tuning { step: Length::Absolute(0.4), ..Tuning::default() };
    let mut planner = Rrs::with_index(problem, <KdTree>::default(), tuning).unwrap();
    let Outcome::Solved(path) = planner.solve(&mut Rng::seed(4), &mut Iterations(10_000), &mut ()) else {
        panic!("not solved")
    };
    assert!(path.edges.iter().any(|edge| !edge.vertices().is_empty()));
    let plain = path.flattened();
    assert!(!plain.states.windows(2).any(|w| boxes.hit(&w[0], &w[1])));
    assert_eq!(
        plain.states.len(),
        path.states.len() + path.edges.iter().map(|e| e.vertices().len()).sum::<usize>()
    );

    // A world with one more obstacle, of which the local planner knows nothing, on a bend.
    let bend = path.edges.iter().find_map(|edge| edge.vertices().get(1)).unwrap();
    let mut wider = boxes.clone();
    wider.0.push((bend.map(|x| x - 1e-3).into(), bend.map(|x| x + 1e-3).into()));
    let i = path.edges.iter().position(|edge| edge.vertices().contains(bend)).unwrap();
    let verdict = Exact(wider).verify_edge(&path.states[i], &path.edges[i], &path.states[i + 1]);
    assert!(matches!(verdict, MotionCheck::Collision { at } if (0.0..=1.0).contains(&at)), "{verdict:?}");
}

/// In rows, whose planners are compiled in the library already.
#[test]
fn a_rod_bends_and_turns() {
    let space = AsVectors(Se2::new([0.0; 2], [1.0; 2]).unwrap());
    let rod = OnVectors::<_, Se2State>::new(Rod { boxes: orchard(), half_length: 0.03, radius: 0.005 });
    let ends = [Se2State::new(0.05, 0.05, 0.0), Se2State::new(0.95, 0.95, 1.0)];
    let (any, [start, goal]) = (AnySpace::new(&space), ends.each_ref().map(Configuration::of));
    let settings = Settings::parse(["step=0.5", "range=0.02"]).unwrap();
    for (name, seed) in [("rrs", 1), ("rrs-connect", 2)] {
        let problem = || {
            let local = checked(&any, Certified::new(&space, rod.clone(), 1e-3).unwrap());
            let verifier = FineDiscrete::new(&space, rod.clone(), Length::Absolute(1e-4)).unwrap();
            let problem = Problem::new(&any, local, verifier, start.clone(), goal.clone())?;
            Ok(problem.with_obstacles(knowledge(&space, &rod)))
        };
        let (index, workers) = (AnyIndex::of(&space), Workers::single());
        let mut planner =
            mp_tree::erased::build(name, Arc::new(problem), index, &settings, &workers).unwrap();
        let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(20_000), &mut ());
        let Outcome::Solved(path) = outcome else { panic!("{name}: {outcome:?}") };
        assert_path(&space, &path, &start, |q| *q == goal, |q| rod.clone().is_valid(q));
    }
}

#[test]
fn bad_settings_are_refused() {
    let (space, boxes) = (square(), orchard());
    let refused = |name: &str, text: &str| {
        let settings = Settings::parse([text]).unwrap();
        build(name, problem(&space, &boxes, ENDS), &settings).map(drop).unwrap_err().to_string()
    };
    for (text, word) in [
        ("range=0", "range"),
        ("range=150%", "range"),
        ("snake-steps=0", "iterations"),
        ("bend=straight", "snake, bulge or hybrid"),
        ("rnage=1", "did you mean `range`"),
    ] {
        let message = refused("rrs", text);
        assert!(message.contains(word), "{text}: {message}");
    }
    assert!(planner("rss").unwrap_err().to_string().contains("`rrs`"));
}

/// Observers learn how edges bend: every piece of every edge is free, in forward time, in the trees from the
/// start and from the goal.
#[test]
fn events_tell_how_edges_bend() {
    let (space, boxes) = (square(), orchard());
    for name in SNAKES {
        let (mut bent, mut check) = ([0; 2], Exact(boxes.clone()));
        for seed in 0..20 {
            let settings = Settings::parse(["step=0.2", "range=0.05"]).unwrap();
            let problem = problem(&space, &boxes, [[0.02, 0.02], [0.98, 0.98]]);
            let mut planner = build(name, problem, &settings).unwrap();
            let mut trees = [Vec::new(), Vec::new()];
            let mut note = OnEvent(|event: Event<'_, Point>| match event {
                Event::Rooted { tree, state, .. } => trees[tree].push(*state),
                Event::Added { tree, parent, state, through, .. } => {
                    let parent = trees[tree][parent as usize];
                    let (from, to) = if tree == 0 { (parent, *state) } else { (*state, parent) };
                    let line: Vec<Point> =
                        [from].into_iter().chain(through.iter().copied()).chain([to]).collect();
                    for ends in line.windows(2) {
                        let free = check.check_motion(&ends[0], &ends[1]).is_free();
                        assert!(free, "{name}, tree {tree}: {line:?}");
                    }
                    bent[tree] += usize::from(through.len() > 1);
                    trees[tree].push(*state);
                }
                Event::Pruned { .. } => panic!("no edge of this scene fails"),
                _ => {}
            });
            let _ = planner.solve(&mut Rng::seed(seed), &mut Iterations(300), &mut note);
        }
        assert!(bent[0] > 0 && (name == "rrs" || bent[1] > 0), "{name}: {bent:?}");
    }
}
