//! Nanoseconds for the nearest and the k nearest of random states, by space and size.
//!
//! `cargo bench -p mp-cspace --bench nn_nearest -- [K] [STATES]`
//! By processor time, the least of 15 trials of 2000 random queries each.

#![allow(clippy::print_stdout, reason = "a benchmark talks to its user")]

use mp_cspace::{DefaultNn, NearestNeighbors, Rn, Rng, Se3, SpaceError};
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;

fn seconds() -> f64 {
    let t = clock_gettime(ClockId::ProcessCPUTime);
    t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
}

/// The least seconds of 15 times `work`, for each of `n`, in nanoseconds.
fn least(n: usize, mut work: impl FnMut()) -> f64 {
    let one = |_| {
        let began = seconds();
        work();
        seconds() - began
    };
    (0..15).map(one).fold(f64::INFINITY, f64::min) / n as f64 * 1e9
}

fn time<C: DefaultNn>(name: &str, space: &C, k: usize, n: usize) {
    let mut rng = Rng::seed(1);
    let states: Vec<_> = (0..n + 2000).map(|_| space.sample_uniform(&mut rng)).collect();
    let (states, queries) = states.split_at(n);
    let mut index = C::Nn::default();
    (0..n).for_each(|i| index.inserted(space, states, i as u32));
    let one = least(queries.len(), || {
        for q in queries {
            black_box(index.nearest(space, states, q));
        }
    });
    let mut out = Vec::new();
    let many = least(queries.len(), || {
        for q in queries {
            index.k_nearest(space, states, q, k, &mut out);
            black_box(&out);
        }
    });
    println!("{name}: nearest of {n} {one:.0} ns, {k} nearest {many:.0} ns");
}

fn main() -> Result<(), SpaceError> {
    let mut args = std::env::args().skip(1).filter(|word| word != "--bench");
    let k = args.next().and_then(|k| k.parse().ok()).unwrap_or(10);
    let n = args.next().and_then(|n| n.parse::<f64>().ok()).unwrap_or(1e5) as usize;
    time("R^2", &Rn::<2>::new([0.0; 2], [1.0; 2])?, k, n);
    time("R^3", &Rn::<3>::new([0.0; 3], [1.0; 3])?, k, n);
    time("R^6", &Rn::<6>::new([0.0; 6], [1.0; 6])?, k, n);
    time("SE(3)", &Se3::new([0.0; 3], [1.0; 3])?, k, n);
    Ok(())
}
