//! Nothing that a snake or a relaxation returns is in collision, by a judge that shares no code with the
//! check.

use crate::worlds::{Judge, Point, World, square};
use mp_cspace::testkit::check_local_planner;
use mp_cspace::{
    Direction, Extension, FineDiscrete, KnownFree, Length, LocalPlanner, MotionValidity, Path, Reach, Rn,
    Rng, Space,
};
use mp_snake::{
    Bend, Bending, Bent, Bulged, Grid, Params, Repulsion, Snake, SnakeCounters, SnakePlanner, blurred, relax,
};
use nalgebra::Vector2;
use rand::RngExt;

/// Both ways round, steps and all the way, bent in each way, in ten thousand worlds. Snakes bend motions that
/// no bulge bends, and hybrid bends more than either alone; where it relaxes what a bulge has bent, it keeps
/// farther away.
#[test]
fn bent_edges_are_free() {
    let space = square();
    let mut counters = [SnakeCounters::default(); 3];
    let [mut nearer, mut farther] = [0.0; 2];
    for seed in 0..10_000 {
        let mut rng = Rng::seed(seed);
        let world = World::random(&mut rng);
        let mut judge = Judge(&world);
        let from = space.sample_uniform(&mut rng);
        let toward = space.sample_uniform(&mut rng);
        let direction = if seed % 2 == 0 { Direction::Forward } else { Direction::Backward };
        let reach = if seed % 3 == 0 { Reach::Step(0.5) } else { Reach::Full };
        let mut clearances = [None; 3];
        for (k, bend) in Bending::ALL.into_iter().enumerate() {
            let (check, field) = (world.check(&space), Repulsion::new(world.field(), 0.1).unwrap());
            let params = Params::for_edges(0.1).unwrap();
            let mut local = SnakePlanner::with_bend(&space, check, field, params, bend).unwrap();
            if !local.admits(&from) {
                continue;
            }
            let extension = local.extend(&from, &toward, direction, reach);
            counters[k] = sum(counters[k], local.counters());
            let (Extension::Reached(motion) | Extension::Advanced(motion)) = extension else { continue };
            let (a, b) =
                if direction == Direction::Forward { (&from, &motion.end) } else { (&motion.end, &from) };
            assert!(motion.edge.check(a, b, &mut judge).is_free(), "seed {seed}, {bend}");
            let path = Path { states: vec![*a, *b], edges: vec![motion.edge.clone()] }.flattened();
            let clearance = path.clearance(&mut judge);
            assert!(clearance.is_some(), "seed {seed}, {bend}");
            assert!((path.length(&space) - motion.cost).abs() < 1e-9);
            let along =
                path.states.windows(2).flat_map(|w| (0..20).map(|i| w[0].lerp(&w[1], f64::from(i) / 20.0)));
            let least = along.map(|q| world.distance(&q).0).fold(f64::INFINITY, f64::min);
            let compared = local.counters().bent() > 0 && local.counters().by_snake == 0;
            clearances[k] = compared.then_some(least);
        }
        if let [_, Some(bulge), Some(hybrid)] = clearances {
            nearer += bulge;
            farther += hybrid;
        }
    }
    let [snake, bulge, hybrid] = counters;
    assert!(bulge.bent() > 1000 && bulge.bent() > 2 * bulge.not_bent, "{bulge:?}");
    assert!(snake.by_snake == snake.bent() && snake.by_snake > 1000, "{snake:?}");
    assert!(hybrid.relaxed > 1000 && hybrid.by_snake > 30, "{hybrid:?}");
    assert!(hybrid.bent() > bulge.bent().max(snake.bent()), "{counters:?}");
    assert!(farther > 1.05 * nearer, "{nearer} {farther}");
}

/// From few nodes to many: a contour keeps its ends, what it calls free is free, and has less energy than the
/// straight motion.
#[test]
fn contours_keep_their_ends_and_lower_the_energy() {
    let space = square();
    let (mut freed, mut blocked) = (0, 0);
    for seed in 0..3000 {
        let mut rng = Rng::seed(seed);
        let world = World::random(&mut rng);
        let mut check = world.check(&space);
        let [from, to] = [(); 2].map(|()| space.sample_uniform(&mut rng));
        let mut free = |a, b| check.check_motion(a, b).is_free();
        if !free(&from, &from) || !free(&to, &to) || free(&from, &to) {
            continue;
        }
        let mut snake = Snake::new(&space, Params::for_edges(0.1).unwrap()).unwrap();
        let mut field = Repulsion::new(world.field(), 0.1).unwrap();
        let mut curve = snake.between(&from, &to);
        let (bent, steps) = Bending::Snake.bend(&mut snake, &mut curve, &mut field, &mut check);
        assert_eq!((curve[0], curve[curve.len() - 1]), (from, to), "seed {seed}");
        if bent == Bent::Not {
            blocked += 1;
            continue;
        }
        freed += 1;
        assert!(bent == Bent::Snake && steps > 0);
        assert!(Path::straight(curve.clone()).clearance(&mut Judge(&world)).is_some(), "seed {seed}");
        let parts = (curve.len() - 1) as f64;
        let straight: Vec<Point> = (0..curve.len()).map(|i| from.lerp(&to, i as f64 / parts)).collect();
        let [before, after] = [&straight, &curve].map(|curve| snake.energy(curve, &mut field).total());
        assert!(after < before, "seed {seed}: {before} {after}");
    }
    assert!(freed > 700 && 5 * freed > 3 * (freed + blocked), "{freed} of {}", freed + blocked);
}

fn sum(a: SnakeCounters, b: SnakeCounters) -> SnakeCounters {
    SnakeCounters {
        straight: a.straight + b.straight,
        bulged: a.bulged + b.bulged,
        relaxed: a.relaxed + b.relaxed,
        by_snake: a.by_snake + b.by_snake,
        not_tried: a.not_tried + b.not_tried,
        not_bent: a.not_bent + b.not_bent,
        iterations: a.iterations + b.iterations,
    }
}

/// A field that has no clearance bends motions too: an image of the world, blurred.
#[test]
fn any_field_bends() {
    let space = square();
    let mut bent = 0;
    for seed in 0..200 {
        let mut rng = Rng::seed(seed);
        let world = World::random(&mut rng);
        let image = Grid::from_fn([-1.0, -1.0], 0.02, (100, 100), |q| {
            f64::from(u8::from(world.distance(&q).0 < 0.0))
        });
        let energy = blurred(&image.unwrap(), 0.05).unwrap().map(|x| 5.0 * x);
        let [from, to] = [(); 2].map(|()| space.sample_uniform(&mut rng));
        let params = Params::for_edges(0.1).unwrap();
        for bend in Bending::ALL {
            let check = world.check(&space);
            let mut local = SnakePlanner::with_bend(&space, check, energy.clone(), params, bend).unwrap();
            if !local.admits(&from) {
                continue;
            }
            let Extension::Reached(motion) = local.extend(&from, &to, Direction::Forward, Reach::Full) else {
                continue;
            };
            assert!(motion.edge.check(&from, &to, &mut Judge(&world)).is_free(), "seed {seed}, {bend}");
            bent += local.counters().bent();
            assert!(bend != Bending::Bulge || motion.edge.vertices().is_empty(), "no clearance, no bulge");
        }
    }
    assert!(bent > 20, "{bent} bent");
}

#[test]
fn ways_to_bend_have_names() {
    for bend in Bending::ALL {
        assert_eq!(bend.name().parse(), Ok(bend));
    }
    let error = "Snake".parse::<Bending>().unwrap_err().to_string();
    assert_eq!(error, "`Snake` is no way to bend a motion: expected snake, bulge or hybrid");
}

/// Each piece of a bulge that fits was asked about, told an end that was known to be free; also where corners
/// were added on the way.
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

/// A path through random free states, relaxed: free, of the same ends, no longer, of less energy or the same
/// path.
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
    assert!(done.bent() > 0 && done.straight > 0 && done.not_tried > 0 && done.iterations > 0, "{done:?}");
}

/// A narrow valley, in which steps as long as the range of repulsion overshoot: the pace becomes as short as
/// the field needs.
#[test]
fn the_pace_follows_the_field() {
    let space = Rn::<2>::new([-1.0; 2], [1.0; 2]).unwrap();
    let path = Path::straight(vec![Vector2::new(-1.0, 0.0), Vector2::new(1.0, 0.0)]);
    let bed = |x: f64| 0.03 * mp_math::cos(0.5 * std::f64::consts::PI * x);
    for width in [0.05, 0.01, 0.005] {
        let mut field = |q: &Vector2<f64>, gradient: &mut [f64]| {
            let off = (q.y - bed(q.x)) / width;
            gradient.copy_from_slice(&[0.0, off / width]);
            0.5 * off * off
        };
        let params =
            Params { membrane: 0.0, plate: 0.0, iterations: 200, ..Params::for_range(0.15).unwrap() };
        let mut check = FineDiscrete::new(&space, |_: &Vector2<f64>| true, Length::Absolute(0.01)).unwrap();
        let relaxed = relax(&space, &mut check, &mut field, &path, params, 1.2).unwrap();
        let off = relaxed.path.states.iter().map(|q| (q.y - bed(q.x)).abs()).fold(0.0, f64::max);
        assert!(relaxed.is_better() && off < 0.3 * width, "{width}: {off} {:?}", relaxed.energy);
    }
}
