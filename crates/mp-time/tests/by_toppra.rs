//! Durations of 200 random paths beside those of another program: `toppra_durations.csv` has what the package `toppra` of PyPI finds, written
//! by `durations_by_toppra.py`.

use mp_time::toppra::{Grid, fastest, seconds};
use std::f64::consts::{FRAC_PI_2, TAU};

const JOINTS: usize = 7;
const WAVES: usize = 3;
const POINTS: usize = 101;

/// As `Numbers` of the script.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The duration along the path of a seed, and the most that a limit is exceeded at a point of the grid, as a part of it.
fn duration(seed: u64) -> (f64, f64) {
    let mut numbers = Numbers(seed);
    let mut wave = |k: usize| (numbers.next() - 0.5, k as f64 + 1.0, TAU * numbers.next());
    let path: Vec<Vec<_>> = (0..JOINTS).map(|_| (0..WAVES).map(&mut wave).collect()).collect();
    let velocity: Vec<f64> = (0..JOINTS).map(|_| 0.5 + 1.5 * numbers.next()).collect();
    let acceleration: Vec<f64> = (0..JOINTS).map(|_| 1.0 + 3.0 * numbers.next()).collect();
    let at = |s: f64, order: i32| -> Vec<f64> {
        let wave = |(a, k, phase): &(f64, f64, f64)| {
            a * mp_math::powi(*k, order) * mp_math::sin(k * s + phase + f64::from(order) * FRAC_PI_2)
        };
        path.iter().map(|joint| joint.iter().map(wave).sum()).collect()
    };
    let step = 2.0 / (POINTS - 1) as f64;
    let ends: Vec<[Vec<f64>; 2]> =
        (0..POINTS).map(|i| [1, 2].map(|order| at(i as f64 * step, order))).collect();
    let mut grid = Grid::new(&acceleration);
    for w in ends.windows(2) {
        grid.push(step, [[&w[0][0], &w[0][1]], [&w[1][0], &w[1][1]]]);
    }
    for (i, [first, _]) in ends.iter().enumerate() {
        for (first, limit) in first.iter().zip(&velocity) {
            grid.cap(i, (limit / first) * (limit / first));
        }
    }
    let x = fastest(&grid).unwrap();
    let mut beyond = 0.0_f64;
    for (i, x) in x.windows(2).enumerate() {
        let u = (x[1] - x[0]) / (2.0 * step);
        for (end, x) in ends[i..].iter().zip(x) {
            for joint in 0..JOINTS {
                let [first, second] = [end[0][joint], end[1][joint]];
                beyond = beyond.max((first * u + second * x).abs() / acceleration[joint] - 1.0);
                beyond = beyond.max(first.abs() * x.sqrt() / velocity[joint] - 1.0);
            }
        }
    }
    (x.windows(2).map(|x| seconds(step, x[0], x[1])).sum(), beyond)
}

#[test]
fn durations_are_those_of_toppra() {
    for line in include_str!("toppra_durations.csv").lines().skip(1) {
        let (seed, theirs) = line.split_once(',').unwrap();
        let theirs: f64 = theirs.parse().unwrap();
        let (ours, beyond) = duration(seed.parse().unwrap());
        let off = (ours / theirs - 1.0).abs();
        assert!(off < 1e-3, "seed {seed}: {ours} s, and {theirs} s by toppra");
        // Rounding only.
        assert!(beyond < 1e-9, "seed {seed}: limits are exceeded by {beyond}");
    }
}
