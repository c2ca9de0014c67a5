//! What shapes snakes take.

use crate::worlds::{Point, World, square};
use mp_cspace::{Joints, Product, Rn, Rng, Se2, Se3, So3, Space};
use mp_snake::{Energy, Field, Nothing, Params, Repulsion, Rest, Snake, SnakeError, With};
use nalgebra::{DMatrix, DVector, Vector2};
use rand::RngExt;

fn params() -> Params {
    Params { iterations: 400, tolerance: 1e-4, ..Params::for_range(0.2).unwrap() }
}

/// From any curve to the geodesic between its ends, at even spacing.
fn straightens<C: Space>(space: &C, seed: u64) {
    let mut rng = Rng::seed(seed);
    let params = Params { membrane: 1.0, plate: 0.0, straighten: 0.3, spacing: 0.2, pace: 0.5, ..params() };
    let mut snake = Snake::new(space, params).unwrap();
    let [a, b] = [(); 2].map(|()| space.sample_uniform(&mut rng));
    let straight = snake.between(&a, &b);
    let mut curve = straight.clone();
    let n = curve.len();
    for (i, q) in curve[1..n - 1].iter_mut().enumerate() {
        let bump = 0.3 * mp_math::sin(std::f64::consts::PI * (i + 1) as f64 / (n - 1) as f64);
        let velocity: Vec<f64> = (0..space.dim()).map(|k| if k % 2 == 0 { bump } else { -bump }).collect();
        let moved = space.moved(q, &velocity, 1.0).unwrap();
        if space.contains(&moved) {
            *q = moved;
        }
    }
    let first = snake.energy(&curve, &mut Nothing).total();
    snake.deform(&mut curve, &mut Nothing, |_| false);
    let gap = |c: &[C::State]| c.iter().zip(&straight).map(|(p, q)| space.distance(p, q)).fold(0.0, f64::max);
    assert!(gap(&curve) < 0.02, "{} after {:?}", gap(&curve), snake.trace());
    let best = snake.energy(&straight, &mut Nothing).total();
    assert!(snake.energy(&curve, &mut Nothing).total() - best < 0.01 * (first - best));
}

#[test]
fn with_no_field_snakes_are_straight_in_any_space() {
    straightens(&square(), 1);
    straightens(&Se2::new([-1.0; 2], [1.0; 2]).unwrap(), 2);
    straightens(&Se3::new([-1.0; 3], [1.0; 3]).unwrap(), 3);
    straightens(&Product::new(So3, 1.0, Joints::<Vector2<f64>>::circles(2).unwrap(), 0.5).unwrap(), 4);
}

fn never_rises(trace: &[Energy]) {
    for w in trace.windows(2) {
        assert!(w[1].total() <= w[0].total() * (1.0 + 1e-9), "{w:?}");
    }
}

/// Around a disc in the middle the snake is as symmetric as the disc, and takes the side it is pushed to.
#[test]
fn a_symmetric_obstacle_bends_symmetrically() {
    let space = square();
    let world = World { discs: vec![(Point::new(0.0, -0.02), 0.2)], boxes: vec![] };
    let mut snake = Snake::new(&space, params()).unwrap();
    let mut curve = snake.between(&Point::new(-0.8, 0.0), &Point::new(0.8, 0.0));
    let mut field = Repulsion::new(world.field(), 0.2).unwrap();
    let rest = snake.deform(&mut curve, &mut field, |_| false);
    assert!(matches!(rest, Rest::Converged | Rest::Stagnated), "{rest:?}");
    never_rises(snake.trace());
    let n = curve.len();
    for i in 0..n {
        let mirrored = Point::new(-curve[n - 1 - i].x, curve[n - 1 - i].y);
        assert!((curve[i] - mirrored).norm() < 1e-9, "{} {mirrored}", curve[i]);
        assert!(world.distance(&curve[i]).0 > 0.05 && curve[i].y >= 0.0);
    }
    assert!(curve[n / 2].y > 0.25);
}

/// A parabola: in a field of constant force `f`, a membrane of tension α hangs as f·x·(l − x)/2α.
#[test]
fn in_a_constant_field_a_membrane_hangs_as_a_parabola() {
    let space = square();
    let (tension, force) = (2.0, 0.4);
    let params =
        Params { membrane: tension, plate: 0.0, straighten: 0.0, spacing: 0.05, pace: 1.0, ..params() };
    let mut snake = Snake::new(&space, params).unwrap();
    // The force across the curve only: its slope, squared, is what this differs from the textbook by.
    let mut down = |q: &Point, gradient: &mut [f64]| {
        gradient.copy_from_slice(&[0.0, force]);
        force * q.y
    };
    let mut curve = snake.between(&Point::new(-0.5, 0.0), &Point::new(0.5, 0.0));
    snake.deform(&mut curve, &mut down, |_| false);
    for q in &curve {
        let expected = -force * (q.x + 0.5) * (0.5 - q.x) / (2.0 * tension);
        assert!((q.y - expected).abs() < 1e-3, "{q} {expected}");
    }
    assert!(curve[curve.len() / 2].y < -0.02);
    never_rises(snake.trace());
}

/// One step is the solution of the dense system: of membrane and plate in a constant field.
#[test]
fn a_step_is_that_of_a_dense_solve() {
    let space = square();
    let (h, n) = (0.05, 20);
    let params = Params {
        membrane: 0.7,
        plate: 0.002,
        straighten: 0.0,
        spacing: h,
        pace: 0.01,
        iterations: 1,
        ..params()
    };
    let mut rng = Rng::seed(3);
    let mut curve: Vec<Point> =
        (0..=n).map(|i| Point::new(-0.5 + h * i as f64, rng.random_range(-0.01..0.01))).collect();
    let before = curve.clone();
    Snake::new(&space, params).unwrap().deform(&mut curve, &mut Nothing, |_| false);
    let second = DMatrix::from_fn(n - 1, n + 1, |i, j| match j as i64 - i as i64 {
        0 | 2 => 1.0,
        1 => -2.0,
        _ => 0.0,
    });
    let (a, b) = (params.pace * params.membrane / (h * h), params.pace * params.plate / mp_math::powi(h, 4));
    let inner = second.columns(1, n - 1).into_owned();
    let stiff = -&inner * a + inner.transpose() * &inner * b;
    for k in 0..2 {
        let v = DVector::from_fn(n + 1, |i, _| before[i][k]);
        let force = &second * &v * a - inner.transpose() * (&second * &v) * b;
        let step = (DMatrix::identity(n - 1, n - 1) + &stiff).lu().solve(&force).unwrap();
        for i in 1..n {
            assert!((curve[i][k] - before[i][k] - step[i - 1]).abs() < 1e-12);
        }
    }
}

/// In random worlds, with bends to begin with and a constraint beside, the energy never rises.
#[test]
fn energy_never_rises() {
    let space = square();
    for seed in 0..300 {
        let mut rng = Rng::seed(seed);
        let world = World::random(&mut rng);
        let [a, b] = [(); 2].map(|()| space.sample_uniform(&mut rng));
        let pull = move |q: &Point, gradient: &mut [f64]| {
            gradient.copy_from_slice((q - a).as_slice());
            0.5 * (q - a).norm_squared()
        };
        let repulsion = Repulsion::new(world.field(), 0.15).unwrap();
        let mut field = With::new(repulsion, pull, 0.2).unwrap();
        let mut snake = Snake::new(&space, params()).unwrap();
        let mut curve = snake.between(&a, &b);
        snake.bulge(&mut curve, &mut field, 0.05, |_, _, _| Some(0.5));
        let mut watched = 0;
        snake.deform(&mut curve, &mut field, |moment| {
            assert_eq!(moment.iteration, watched);
            watched += 1;
            false
        });
        never_rises(snake.trace());
        let last = snake.trace().last().copied().unwrap();
        assert_eq!(snake.energy(&curve, &mut field), last);
        assert!((curve[0], curve[curve.len() - 1]) == (a, b) && curve.iter().all(|q| space.contains(q)));
    }
}

/// A bulge takes a curve that meets a wall squarely, where forces push back along it only, to one side.
#[test]
fn a_bulge_finds_a_side() {
    let space = square();
    let world = World { boxes: vec![(Point::new(0.0, 0.03), Point::new(0.1, 0.2))], discs: vec![] };
    let mut field = Repulsion::new(world.field(), 0.2).unwrap();
    let mut snake = Snake::new(&space, params()).unwrap();
    let mut curve = snake.between(&Point::new(-0.8, 0.0), &Point::new(0.8, 0.0));
    let before = snake.energy(&curve, &mut field).total();
    snake.bulge(&mut curve, &mut field, 0.05, |_, _, _| Some(0.5));
    assert!(snake.energy(&curve, &mut field).total() < before);
    snake.deform(&mut curve, &mut field, |_| false);
    assert!(curve.iter().all(|q| world.distance(q).0 > 0.0 && q.y <= 1e-9));
}

/// A space that knows no velocities, and numbers out of range.
#[test]
fn bad_input_is_refused() {
    #[derive(Debug)]
    struct Mute(Rn<2>);
    impl Space for Mute {
        type State = Point;
        fn distance(&self, a: &Point, b: &Point) -> f64 {
            self.0.distance(a, b)
        }
        fn dim(&self) -> usize {
            2
        }
        fn extent(&self) -> f64 {
            self.0.extent()
        }
        fn interpolate_into(&self, a: &Point, b: &Point, t: f64, out: &mut Point) {
            self.0.interpolate_into(a, b, t, out);
        }
        fn unit_cube_to_state(&self, u: &[f64]) -> Point {
            self.0.unit_cube_to_state(u)
        }
        fn sample_uniform(&self, rng: &mut Rng) -> Point {
            self.0.sample_uniform(rng)
        }
        fn contains(&self, q: &Point) -> bool {
            self.0.contains(q)
        }
    }
    assert_eq!(Snake::new(&Mute(square()), params()).unwrap_err(), SnakeError::NoVelocities);
    let space = square();
    for bad in [
        Params { membrane: -1.0, ..params() },
        Params { plate: f64::NAN, ..params() },
        Params { straighten: f64::INFINITY, ..params() },
        Params { spacing: 0.0, ..params() },
        Params { pace: 0.0, ..params() },
        Params { iterations: 0, ..params() },
        Params { tolerance: 0.0, ..params() },
    ] {
        assert!(matches!(Snake::new(&space, bad), Err(SnakeError::Parameter(_))), "{bad:?}");
    }
    assert!(Params::for_range(0.0).is_err());
    let mut snake = Snake::new(&space, params()).unwrap();
    let mut short = [Point::zeros()];
    assert_eq!(snake.deform(&mut short, &mut Nothing, |_| false), Rest::Converged);
    assert_eq!(snake.energy(&[], &mut Nothing), Energy::default());
    let nothing = World::default();
    let mut far = Repulsion::new(nothing.field(), 0.1).unwrap();
    assert_eq!(far.energy(&Point::zeros(), &mut [0.0; 2]), 0.0);
}
