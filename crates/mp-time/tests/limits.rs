//! Limits hold along timed paths, looked at a thousand times a second: by the points of the trajectory alone, and cubic polynomials written
//! down here another time.

use mp_cspace::Rng;
use mp_time::{BlendedPath, Limits, Trajectory, timed};
use rand::RngExt;

/// Positions at 1 kHz, by the form of Hermite's basis. The last row is at the last point.
fn sampled(trajectory: &Trajectory, joint: usize) -> Vec<f64> {
    let knots = trajectory.knots();
    let (mut piece, mut positions) = (0, Vec::new());
    let last = *knots.times.last().unwrap();
    for i in 0.. {
        let t = f64::from(i) * 1e-3;
        if t > last {
            return positions;
        }
        while piece + 2 < knots.times.len() && knots.times[piece + 1] < t {
            piece += 1;
        }
        let [t0, t1] = [knots.times[piece], knots.times[piece + 1]];
        let (h, u) = (t1 - t0, (t - t0) / (t1 - t0));
        let of = |rows: &[Vec<f64>]| [rows[piece][joint], rows[piece + 1][joint]];
        let ([p0, p1], [v0, v1]) = (of(&knots.positions), of(&knots.velocities));
        positions.push(
            (1.0 + 2.0 * u) * (1.0 - u) * (1.0 - u) * p0
                + u * (1.0 - u) * (1.0 - u) * h * v0
                + u * u * (3.0 - 2.0 * u) * p1
                + u * u * (u - 1.0) * h * v1,
        );
    }
    unreachable!()
}

/// Positions of a quintic trajectory at 1 kHz, by Hermite's basis of degree five, and where it ends for a moment before and behind it.
fn sampled_quintic(trajectory: &Trajectory, joint: usize) -> Vec<f64> {
    let knots = trajectory.knots();
    let (times, [first, last]) = (&knots.times, trajectory.span());
    let mut positions = vec![knots.positions[0][joint]; 5];
    let mut piece = 0;
    for i in 0..=((last - first) * 1e3) as usize {
        let t = first + i as f64 * 1e-3;
        while piece + 2 < times.len() && times[piece + 1] < t {
            piece += 1;
        }
        let h = times[piece + 1] - times[piece];
        let u = (t - times[piece]) / h;
        let (u3, w) = (u * u * u, 1.0 - u);
        let w3 = w * w * w;
        let side = |point: usize, a: f64, b: f64, sign: f64| {
            let [q, v, acc] =
                [&knots.positions, &knots.velocities, &knots.accelerations].map(|rows| rows[point][joint]);
            // `a` is how far from the point, as a part of the piece, and `b` the third power of the rest.
            b * (q * (1.0 + 3.0 * a + 6.0 * a * a)
                + sign * h * v * a * (1.0 + 3.0 * a)
                + 0.5 * h * h * acc * a * a)
        };
        positions.push(side(piece, u, w3, 1.0) + side(piece + 1, w, u3, -1.0));
    }
    positions.extend([knots.positions[times.len() - 1][joint]; 5]);
    positions
}

/// A path as planners make it: some lines of very different lengths, at times with a point twice, in a line, or back the same way.
fn path(rng: &mut Rng, joints: usize) -> Vec<Vec<f64>> {
    let mut points = vec![(0..joints).map(|_| rng.random_range(-2.0..2.0)).collect::<Vec<f64>>()];
    for _ in 0..rng.random_range(1..9) {
        let last = points[points.len() - 1].clone();
        let length = if rng.random_bool(0.2) { 1e-3 } else { rng.random_range(0.1..1.5) };
        let moved = |rng: &mut Rng, x: &f64| match rng.random_bool(0.2) {
            true => *x,
            false => x + length * rng.random_range(-1.0..1.0),
        };
        points.push(match (rng.random_range(0..12), points.len()) {
            (0, _) => last,
            (1, n) if n > 1 => last.iter().zip(&points[n - 2]).map(|(b, a)| b + 0.5 * (b - a)).collect(),
            (2, n) if n > 1 => points[n - 2].clone(),
            _ => last.iter().map(|x| moved(rng, x)).collect(),
        });
    }
    points
}

#[test]
fn limits_hold_at_1_khz() {
    let mut rng = Rng::seed(44);
    let (mut timed_paths, mut busy, mut total) = (0, 0.0, 0.0);
    for case in 0..200 {
        let joints = rng.random_range(1..8);
        let points = path(&mut rng, joints);
        let Ok(mut blended) = BlendedPath::new(&points, rng.random_range(0.0..0.2)) else { continue };
        for corner in 0..blended.corners() {
            blended.tighten(corner, [1.0, 0.1, 0.0][rng.random_range(0..3)]);
        }
        let velocity: Vec<f64> = (0..joints).map(|_| rng.random_range(0.5..3.0)).collect();
        let acceleration: Vec<f64> = (0..joints).map(|_| rng.random_range(0.5..9.0)).collect();
        let limits = Limits::new(velocity.clone(), acceleration.clone()).unwrap();
        let timing = timed(&blended, &limits, (0..joints).map(|_| ("j", "rad"))).unwrap();
        let trajectory = &timing.trajectory;
        let all: Vec<Vec<f64>> = (0..joints).map(|joint| sampled(trajectory, joint)).collect();
        for joint in 0..joints {
            let q = &all[joint];
            let velocities = q.windows(2).map(|w| (w[1] - w[0]) / 1e-3);
            let accelerations = q.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]) / 1e-6);
            // Differences round to 1e-16 · 2 / 1e-6.
            for (what, numbers, limit, rounding) in [
                ("velocity", velocities.collect::<Vec<_>>(), velocity[joint], 1e-12),
                ("acceleration", accelerations.collect(), acceleration[joint], 1e-8),
            ] {
                let most = numbers.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                assert!(most <= limit * (1.0 + 1e-3) + rounding, "{case}: {what} {most} of {limit}");
            }
            let (first, last) = (&points[0], &points[points.len() - 1]);
            assert!((q[0] - first[joint]).abs() < 1e-12);
            assert!((trajectory.knots().positions.last().unwrap()[joint] - last[joint]).abs() < 1e-9);
        }
        // At every moment something is at its limit, or nearly so: it is not only slow.
        for i in 1..all[0].len() - 1 {
            let at_limit = (0..joints).any(|joint| {
                let q = &all[joint][i - 1..=i + 1];
                let (v, a) = ((q[2] - q[0]) / 2e-3, (q[2] - 2.0 * q[1] + q[0]) / 1e-6);
                v.abs() > 0.95 * velocity[joint] || a.abs() > 0.9 * acceleration[joint]
            });
            (busy, total) = (busy + f64::from(u8::from(at_limit)), total + 1.0);
        }
        // Corners are where it says.
        for (corner, time) in timing.corners.iter().enumerate() {
            let at = trajectory.at(*time).position;
            let off =
                at.iter().zip(blended.corner(corner)).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
            assert!(
                off <= 1.2 * blended.deviation(corner) + 1e-9,
                "{case}: {off} {}",
                blended.deviation(corner)
            );
        }
        timed_paths += 1;
    }
    assert!(timed_paths > 190, "{timed_paths}");
    assert!(busy > 0.9 * total, "{busy} of {total}");
}

#[test]
fn limits_of_jerk_hold_at_1_khz() {
    let mut rng = Rng::seed(45);
    let mut timed_paths = 0;
    for case in 0..200 {
        let joints = rng.random_range(1..8);
        let points = path(&mut rng, joints);
        let allowed = rng.random_range(0.0..0.2);
        let Ok(mut blended) = BlendedPath::new(&points, allowed) else { continue };
        for corner in 0..blended.corners() {
            blended.tighten(corner, [1.0, 0.1, 0.0][rng.random_range(0..3)]);
        }
        let mut drawn = |low: f64, high: f64| -> Vec<f64> {
            (0..joints).map(|_| mp_math::exp(rng.random_range(mp_math::ln(low)..mp_math::ln(high)))).collect()
        };
        let (velocity, acceleration, mut jerk) = (drawn(0.5, 3.0), drawn(0.5, 15.0), drawn(1.0, 8000.0));
        if joints > 1 {
            jerk[0] = f64::INFINITY;
        }
        let limits =
            Limits::new(velocity.clone(), acceleration.clone()).unwrap().with_jerk(jerk.clone()).unwrap();
        let timing = timed(&blended, &limits, (0..joints).map(|_| ("j", "rad"))).unwrap();
        let made = timing.trajectory.in_nanoseconds().unwrap();
        for joint in 0..joints {
            let q = sampled_quintic(&made, joint);
            let of = |f: &dyn Fn(&[f64]) -> f64| q.windows(4).map(|w| f(w).abs()).fold(0.0, f64::max);
            // Differences round to 1e-16 · 8 / 1e-9.
            for (what, most, limit, rounding) in [
                ("velocity", of(&|w| (w[1] - w[0]) / 1e-3), velocity[joint], 1e-12),
                ("acceleration", of(&|w| (w[2] - 2.0 * w[1] + w[0]) / 1e-6), acceleration[joint], 1e-8),
                ("jerk", of(&|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]) / 1e-9), jerk[joint], 1e-5),
            ] {
                assert!(most <= limit * (1.0 + 1e-3) + rounding, "{case} {joint}: {what} {most} of {limit}");
            }
            let ends = [made.at(0.0).position[joint], made.at(made.duration()).position[joint]];
            assert!((ends[0] - points[0][joint]).abs() < 1e-12);
            assert!((ends[1] - points[points.len() - 1][joint]).abs() < 1e-9);
        }
        for (corner, time) in timing.corners.iter().enumerate() {
            let at = made.at(*time).position;
            let off =
                at.iter().zip(blended.corner(corner)).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
            assert!((off - timing.deviations[corner]).abs() < 1e-3 && off < allowed + 1e-6, "{case}: {off}");
        }
        timed_paths += 1;
    }
    assert!(timed_paths > 190, "{timed_paths}");
}

/// Where points were left out and all gets slower, a millisecond is a shorter part of it, in which there may be more jerk.
#[test]
fn limits_of_jerk_hold_on_short_paths() {
    let mut rng = Rng::seed(81);
    for case in 0..60 {
        let mut points = vec![vec![0.0; 3]];
        for _ in 0..5 {
            let far = mp_math::exp(rng.random_range(-16.0..-7.0));
            let last = points.last().unwrap();
            points.push(last.iter().map(|q| q + far * rng.random_range(-1.0..1.0)).collect());
        }
        let mut blended = BlendedPath::new(&points, 0.1).unwrap();
        (0..blended.corners()).for_each(|corner| blended.tighten(corner, 0.0));
        let jerk = [24.0, 30.0, f64::INFINITY];
        let limits =
            Limits::new(vec![1.0; 3], vec![3.0, 3.0, 0.5]).unwrap().with_jerk(jerk.to_vec()).unwrap();
        let timing = timed(&blended, &limits, [("j", "rad"); 3]).unwrap();
        let made = timing.trajectory.in_nanoseconds().unwrap();
        for (joint, limit) in jerk.iter().enumerate() {
            let most = made.jerkiest(joint);
            assert!(most.amount < limit * (1.0 + 5e-4), "{case} {joint}: {most:?}");
        }
    }
}

/// How long a motion of one joint takes at least, from standing still to standing still.
fn least_seconds(far: f64, v: f64, a: f64, j: f64) -> f64 {
    // The largest acceleration that is reached on the way to full speed, and how far that takes.
    let full = |a: f64, v: f64| v * (v / a + a / j);
    let a = a.min((v * j).sqrt());
    if full(a, v) <= far {
        return far / v + v / a + a / j;
    }
    // Without full speed: v · (v / a + a / j) = far, or without full acceleration.
    let slower = 0.5 * (-a * a / j + (a * a * a * a / (j * j) + 4.0 * a * far).sqrt());
    match slower >= a * a / j {
        true => 2.0 * (slower / a + a / j),
        false => 4.0 * mp_math::cbrt(0.5 * far / j),
    }
}

#[test]
fn straight_motions_within_jerk_are_not_much_longer_than_the_shortest() {
    let (mut rng, mut ratios) = (Rng::seed(46), Vec::new());
    for _ in 0..300 {
        let mut drawn =
            |low: f64, high: f64| mp_math::exp(rng.random_range(mp_math::ln(low)..mp_math::ln(high)));
        let (far, v, a, j) = (drawn(0.01, 5.0), drawn(0.3, 3.0), drawn(0.5, 15.0), drawn(1.0, 8000.0));
        let limits = Limits::new(vec![v], vec![a]).unwrap().with_jerk(vec![j]).unwrap();
        let path = BlendedPath::new(&[vec![0.0], vec![far]], 0.1).unwrap();
        let made = timed(&path, &limits, [("a", "rad")]).unwrap().trajectory;
        ratios.push(made.duration() / least_seconds(far, v, a, j));
    }
    ratios.sort_by(f64::total_cmp);
    let (least, middle, most) = (ratios[0], ratios[ratios.len() / 2], ratios[ratios.len() - 1]);
    assert!(least > 0.999 && middle < 1.02 && most < 1.25, "{least} {middle} {most}");
    assert!(Limits::new(vec![1.0], vec![1.0]).unwrap().with_jerk(vec![0.0]).is_err());
    assert!(Limits::new(vec![1.0], vec![1.0]).unwrap().with_jerk(vec![1.0; 2]).is_err());
}

#[test]
fn a_straight_motion_takes_what_the_formula_says() {
    // 1 rad at 1 rad/s and 2 rad/s²: half a second up, half a second down, and the rest at full speed. The grid has the switch a little late.
    let path = BlendedPath::new(&[vec![0.0], vec![1.0]], 0.1).unwrap();
    let limits = Limits::new(vec![1.0], vec![2.0]).unwrap();
    let timing = timed(&path, &limits, [("a", "rad")]).unwrap();
    assert!((timing.trajectory.duration() - 1.5).abs() < 2e-3, "{}", timing.trajectory.duration());
    // Three pieces are exact.
    assert!(timing.trajectory.knots().times.len() <= 6);
    let half = limits.scaled(0.5, 0.25, 1.0).unwrap();
    let slow = timed(&path, &half, [("a", "rad")]).unwrap().trajectory;
    assert!((slow.duration() - 3.0).abs() < 4e-3, "{}", slow.duration());
    let errors = [(0.0, 1.0), (1.0, 0.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)];
    assert!(errors.iter().all(|(v, a)| Limits::new(vec![*v], vec![*a]).is_err()));
    assert!(Limits::new(vec![f64::INFINITY], vec![1.0]).is_ok());
}

/// Where it stops at each of many corners, each line takes what the formula says.
#[test]
fn lines_between_many_stops_take_what_the_formula_says() {
    let mut rng = Rng::seed(45);
    let points: Vec<Vec<f64>> = (0..60).map(|_| vec![rng.random_range(-2.0..2.0)]).collect();
    let path = BlendedPath::new(&points, 0.0).unwrap();
    let timing = timed(&path, &Limits::new(vec![1.0], vec![2.0]).unwrap(), [("a", "rad")]).unwrap();
    let line = |w: &[Vec<f64>]| least_seconds((w[1][0] - w[0][0]).abs(), 1.0, 2.0, f64::INFINITY);
    let (duration, least) = (timing.trajectory.duration(), points.windows(2).map(line).sum::<f64>());
    // Points that go on in a line are no stops.
    assert!(duration <= 1.002 * least, "{duration} {least}");
}
