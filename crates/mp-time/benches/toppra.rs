//! How long TOPP-RA takes: seven joints, 100 intervals, and the whole timing of a path with five corners.
//!
//! `cargo bench -p mp-time --bench toppra`

#![allow(clippy::print_stdout, reason = "it is what a benchmark does")]

use mp_cspace::Rng;
use mp_time::toppra::{Grid, fastest};
use mp_time::{BlendedPath, Limits, timed};
use rand::RngExt;
use std::hint::black_box;
use std::time::Instant;

const JOINTS: usize = 7;

/// The least and the middle of the times (µs) of a function.
fn microseconds(mut work: impl FnMut()) -> [f64; 2] {
    let mut times: Vec<f64> = (0..501)
        .map(|_| {
            let began = Instant::now();
            work();
            began.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    times.sort_by(f64::total_cmp);
    [times[0], times[times.len() / 2]]
}

fn main() {
    let mut rng = Rng::seed(1);
    let mut numbers =
        |low: f64, high: f64| (0..JOINTS).map(|_| rng.random_range(low..high)).collect::<Vec<f64>>();
    let limits = Limits::new(numbers(0.5, 2.0), numbers(1.0, 4.0)).expect("they are above zero");
    let waves = numbers(1.0, 4.0);
    let ends: Vec<[Vec<f64>; 2]> = (0..=100)
        .map(|i| {
            let s = f64::from(i) * 0.02;
            let of = |f: &dyn Fn(f64) -> f64| waves.iter().map(|k| f(*k)).collect();
            [of(&|k| mp_math::cos(k * s)), of(&|k| -k * mp_math::sin(k * s))]
        })
        .collect();
    let [least, middle] = microseconds(|| {
        let mut grid = Grid::new(limits.acceleration());
        for (i, w) in ends.windows(2).enumerate() {
            grid.push(0.02, [[&w[0][0], &w[0][1]], [&w[1][0], &w[1][1]]]);
            let caps =
                w[0][0].iter().zip(limits.velocity()).map(|(first, limit)| (limit / first) * (limit / first));
            grid.cap(i, caps.fold(f64::INFINITY, f64::min));
        }
        black_box(fastest(black_box(&grid)));
    });
    println!("a smooth path, 7 joints, 100 intervals: {least:.1} µs at best, {middle:.1} µs in the middle");
    let points: Vec<Vec<f64>> = (0..7).map(|_| numbers(-1.0, 1.0)).collect();
    let path = BlendedPath::new(&points, 0.1).expect("it has different points");
    let [least, middle] = microseconds(|| {
        black_box(timed(black_box(&path), &limits, (0..JOINTS).map(|_| ("j", "rad"))).ok());
    });
    println!("the timing of a path with five corners: {least:.1} µs at best, {middle:.1} µs in the middle");
    let limits = limits.with_jerk(numbers(10.0, 100.0)).expect("they are above zero");
    let [least, middle] = microseconds(|| {
        black_box(timed(black_box(&path), &limits, (0..JOINTS).map(|_| ("j", "rad"))).ok());
    });
    println!("the same within jerk: {least:.1} µs at best, {middle:.1} µs in the middle");
}
