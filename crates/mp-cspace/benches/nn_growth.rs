//! Nodes per second of a tree that grows in an empty unit cube, by size, space and index.
//!
//! `cargo bench -p mp-cspace --bench nn_growth -- SPACE [INDEX] [NODES] [REPEATS]`
//! with SPACE one of `r2 r3 r6 se2 se3 so3 t6`, INDEX one of `default dynamic metric linear`.
//! Prints the average rate, by processor time, when the tree reaches 10³, 10⁴ … nodes: the median
//! over the repeats, and the best.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a benchmark talks to its user")]

use mp_cspace::nn::grow;
use mp_cspace::{
    DefaultNn, Joints, KdTree, Linear, MetricTree, NearestNeighbors, Rn, Rng, Se2, Se3, So3, Space,
    SpaceError, TrueMetric, nn::Embed,
};
use nalgebra::SVector;
use rustix::time::{ClockId, clock_gettime};

fn seconds() -> f64 {
    let t = clock_gettime(ClockId::ProcessCPUTime);
    t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
}

struct Request {
    name: String,
    index: String,
    nodes: usize,
    repeats: u64,
}

impl Request {
    fn run<C: DefaultNn + Embed + TrueMetric>(&self, space: &C) {
        match self.index.as_str() {
            "dynamic" => self.time::<C, KdTree>(space),
            "metric" => self.time::<C, MetricTree>(space),
            "linear" => self.time::<C, Linear>(space),
            _ => self.time::<C, C::Nn>(space),
        }
    }

    fn time<C: Space, N: NearestNeighbors<C> + Default>(&self, space: &C) {
        let sizes: Vec<usize> = (3..8).map(|e| 10usize.pow(e)).filter(|&n| n <= self.nodes).collect();
        let mut rates = vec![Vec::new(); sizes.len()];
        for seed in 1..=self.repeats {
            let start = space.unit_cube_to_state(&vec![0.1; space.dim()]);
            let mut rng = Rng::seed(seed);
            let began = seconds();
            let mut reached = Vec::new();
            let at = |n| reached.push(n as f64 / (seconds() - began));
            grow(space, &mut N::default(), start, 0.2 * space.extent(), &mut rng, &sizes, at);
            rates.iter_mut().zip(reached).for_each(|(all, rate)| all.push(rate));
        }
        for (size, all) in sizes.iter().zip(&mut rates) {
            all.sort_by(f64::total_cmp);
            let (median, best) = (all[all.len() / 2], all[all.len() - 1]);
            println!("{} {} {size} {median:.0} {best:.0}", self.name, self.index);
        }
    }
}

fn main() -> Result<(), SpaceError> {
    let mut args = std::env::args().skip(1).filter(|word| word != "--bench");
    let request = Request {
        name: args.next().unwrap_or_else(|| "r3".into()),
        index: args.next().unwrap_or_else(|| "default".into()),
        nodes: args.next().and_then(|n| n.parse::<f64>().ok()).unwrap_or(1e5) as usize,
        repeats: args.next().and_then(|n| n.parse().ok()).unwrap_or(3),
    };
    match request.name.as_str() {
        "r2" => request.run(&Rn::<2>::new([0.0; 2], [1.0; 2])?),
        "r3" => request.run(&Rn::<3>::new([0.0; 3], [1.0; 3])?),
        "r6" => request.run(&Rn::<6>::new([0.0; 6], [1.0; 6])?),
        "se2" => request.run(&Se2::new([0.0; 2], [1.0; 2])?),
        "se3" => request.run(&Se3::new([0.0; 3], [1.0; 3])?),
        "so3" => request.run(&So3),
        "t6" => request.run(&Joints::<SVector<f64, 6>>::circles(6)?),
        other => eprintln!("no space is called {other}"),
    }
    Ok(())
}
