//! Nothing that a snake or a relaxation returns is in collision, by a judge that shares no code with the check.

use crate::worlds::{Judge, Point, World, square};
use mp_cspace::testkit::check_local_planner;
use mp_cspace::{Direction, Extension, KnownFree, LocalPlanner, MotionValidity, Path, Reach, Rng, Space};
use mp_snake::{Bulged, Params, Repulsion, Snake, SnakePlanner, relax};
use rand::RngExt;

/// Both ways round, steps and all the way, in ten thousand worlds.
#[test]
fn bent_edges_are_free() {
    let space = square();
    let (mut bent, mut blocked) = (0, 0);
    for seed in 0..10_000 {
        let mut rng = Rng::seed(seed);
        let world = World::random(&mut rng);
        let mut local = SnakePlanner::new(&space, world.check(&space), world.field(), 0.1).unwrap();
        let mut judge = Judge(&world);
        let from = space.sample_uniform(&mut rng);
        let toward = space.sample_uniform(&mut rng);
        if !local.admits(&from) {
            continue;
        }
        let direction = if seed % 2 == 0 { Direction::Forward } else { Direction::Backward };
        let reach = if seed % 3 == 0 { Reach::Step(0.5) } else { Reach::Full };
        let extension = local.extend(&from, &toward, direction, reach);
        let (Extension::Reached(motion) | Extension::Advanced(motion)) = extension else {
            blocked += u32::from(local.admits(&toward));
            continue;
        };
        let (a, b) =
            if direction == Direction::Forward { (&from, &motion.end) } else { (&motion.end, &from) };
        assert!(motion.edge.check(a, b, &mut judge).is_free(), "seed {seed}");
        let path = Path { states: vec![*a, *b], edges: vec![motion.edge.clone()] }.flattened();
        assert!(path.clearance(&mut judge).is_some(), "seed {seed}");
        assert!((path.length(&space) - motion.cost).abs() < 1e-9);
        bent += u32::from(!motion.edge.vertices().is_empty());
    }
    assert!(bent > 1000 && bent > 2 * blocked, "{bent} bent, {blocked} lost");
}

/// Each piece of a bulge that fits was asked about, told an end that was known to be free; also where corners were
/// added on the way.
#[test]
fn bulges_ask_about_every_piece() {
    let space = square();
    let (mut plain, mut mended) = (0, 0);
    for seed in 0..10_000 {
        let mut rng = Rng::seed(seed);
        let world = World::random(&mut rng);
        let mut check = world.check(&space);
        let [a, b] = [(); 2].map(|()| space.sample_uniform(&mut rng));
        if !(check.check_motion(&a, &a).is_free() && check.check_motion(&b, &b).is_free()) {
            continue;
        }
        let mut field = Repulsion::new(world.field(), 0.1).unwrap();
        let mut snake = Snake::new(&space, Params::for_edges(0.1).unwrap()).unwrap();
        let mut curve = snake.between(&a, &b);
        let (mut free, mut ends) = (Vec::new(), vec![a, b]);
        let bulged = snake.bulge(&mut curve, &mut field, 0.05, |from, to, known| {
            assert!(known != KnownFree::From || ends.contains(from), "seed {seed}");
            assert!(known != KnownFree::To || ends.contains(to), "seed {seed}");
            let failed = check.check_extension(from, to, known).failed_at();
            if failed.is_none() {
                free.push((*from, *to));
                ends.extend([*from, *to]);
            }
            failed
        });
        if bulged == Bulged::Fits {
            assert_eq!((curve[0], curve[curve.len() - 1]), (a, b));
            assert!(curve.windows(2).all(|w| free.contains(&(w[0], w[1]))), "seed {seed}");
            let count = if curve.len() > 4 { &mut mended } else { &mut plain };
            *count += 1;
        }
    }
    assert!(plain > 500 && mended > 100, "{plain} as they were laid, {mended} with more corners");
}

/// A path through random free states, relaxed: free, of the same ends, no longer, of less energy or the same path.
#[test]
fn relaxed_paths_are_free_and_no_worse() {
    let space = square();
    let (mut better, mut tried) = (0, 0);
    for seed in 0..10_000 {
        let mut rng = Rng::seed(seed);
        let world = World::random(&mut rng);
        let (mut check, mut judge) = (world.check(&space), Judge(&world));
        let mut states: Vec<Point> = Vec::new();
        for _ in 0..12 {
            let q = match states.last() {
                Some(last) => last + Point::new(rng.random_range(-0.4..0.4), rng.random_range(-0.4..0.4)),
                None => space.sample_uniform(&mut rng),
            };
            let last = states.last().copied().unwrap_or(q);
            if space.contains(&q) && check.check_motion(&last, &q).is_free() {
                states.push(q);
            }
        }
        if states.len() < 3 {
            continue;
        }
        tried += 1;
        let path = Path::straight(states);
        let stretch = if seed % 2 == 0 { 1.0 } else { 1.2 };
        let params = Params { iterations: 20, ..Params::for_range(0.1).unwrap() };
        let mut field = Repulsion::new(world.field(), 0.1).unwrap();
        let relaxed = relax(&space, &mut check, &mut field, &path, params, stretch).unwrap();
        assert_eq!(relaxed.path.states.first(), path.states.first());
        assert_eq!(relaxed.path.states.last(), path.states.last());
        assert!(relaxed.path.clearance(&mut judge).is_some(), "seed {seed}");
        assert!(relaxed.path.length(&space) <= stretch * path.length(&space), "seed {seed}");
        assert!(relaxed.is_better() != (relaxed.path == path), "seed {seed}");
        better += u32::from(relaxed.is_better());
    }
    assert!(tried > 5000 && 2 * better > tried, "{better} of {tried}");
}

#[test]
fn the_local_planner_keeps_the_contract() {
    let space = square();
    let world = World::random(&mut Rng::seed(5));
    let mut local = SnakePlanner::new(&space, world.check(&space), world.field(), 0.1).unwrap();
    check_local_planner(&space, &mut local, 0.6, 1);
    let done = local.counters();
    assert!(done.bent > 0 && done.straight > 0 && done.not_tried > 0 && done.iterations > 0, "{done:?}");
}
