//! Tree growth: nodes per second of RRT in an empty unit cube, against the number of nodes.
//!
//! Every iteration is one uniform sample, one nearest-neighbour query, one motion check (which
//! always passes) and one insertion. For comparison, a bare loop does the same work
//! without a planner, which shows the overhead of the engine.

use crate::clock::{nanoseconds, seconds_since};
use crate::error::Result;
use mp_cspace::{
    DefaultNn, Direction, Discrete, Extension, FineDiscrete, Length, LocalPlanner, Motion, NearestNeighbors,
    NodeId, Planner, Reach, Rn, Rng, Se3, Space, Straight,
};
use mp_plan::Error;
use mp_tree::{Goals, Problem, Rrt, Tuning};
use nalgebra::{Isometry3, SVector};
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Longest step, and resolution of the motion check, as fractions of the extent.
const STEP: f64 = 0.2;
const RESOLUTION: Length = Length::Fraction(0.01);
const SEED: u64 = 1;

/// What is measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Growing<'a> {
    /// The numbers of nodes at which the clock is read, ascending.
    pub(crate) sizes: &'a [usize],
    /// Seconds after which the growth of one tree is stopped.
    pub(crate) cap: f64,
    /// The number of repetitions, of which the fastest counts.
    pub(crate) repeats: usize,
}

/// Trees up to this size are grown ten times as often.
const SMALL: usize = 10_000;

/// The names of the spaces.
pub(crate) const SPACES: [&str; 4] = ["r2", "r3", "r6", "se3"];

/// Growth to one size.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Row {
    /// Nodes of the tree.
    pub(crate) nodes: usize,
    /// Processor seconds of RRT, from the empty tree.
    pub(crate) planner: f64,
    /// Processor seconds of the bare loop, from the empty tree.
    pub(crate) bare: f64,
}

impl Row {
    /// Nodes per second of RRT, from the empty tree.
    pub(crate) fn rate(&self) -> f64 {
        self.nodes as f64 / self.planner
    }
}

impl Growing<'_> {
    /// Measures in one of [`SPACES`]. Sizes that are not reached within the cap are left out.
    ///
    /// # Errors
    /// When there is no such space, or a setting is out of range.
    pub(crate) fn measure(&self, space: &str) -> Result<Vec<Row>> {
        match space {
            "r2" => self.in_cube::<2>(),
            "r3" => self.in_cube::<3>(),
            "r6" => self.in_cube::<6>(),
            "se3" => {
                let start = Isometry3::translation(0.1, 0.1, 0.1);
                self.grow(&Se3::new([0.0; 3], [1.0; 3])?, &start)
            }
            _ => Err(Error::new(format!("there is no space `{space}`"))),
        }
    }

    fn in_cube<const N: usize>(&self) -> Result<Vec<Row>>
    where
        Rn<N>: DefaultNn + Space<State = SVector<f64, N>>,
    {
        self.grow(&Rn::<N>::new([0.0; N], [1.0; N])?, &SVector::repeat(0.1))
    }

    fn grow<C: DefaultNn>(&self, space: &C, start: &C::State) -> Result<Vec<Row>> {
        let free = |_: &C::State| true;
        let local = || -> Result<_> { Ok(Straight::new(space, Discrete::new(space, free, RESOLUTION)?)) };
        let (mut planner, mut bare) = (Vec::new(), Vec::new());
        // Small trees grow very quickly: they are grown many times, so that the fastest time is undisturbed.
        let small = self.sizes.iter().filter(|&&size| size <= SMALL).count();
        let rounds = std::iter::repeat_n(&self.sizes[..small], 10 * self.repeats);
        for sizes in rounds.chain(std::iter::repeat_n(self.sizes, self.repeats)) {
            let verifier = FineDiscrete::new(space, free, RESOLUTION)?;
            let nowhere = Goals::region(|_: &C::State| false);
            let problem = Problem::new(space, local()?, verifier, start.clone(), nowhere)?;
            let tuning = Tuning { step: Length::Fraction(STEP), ..Tuning::default() };
            let mut rrt = Rrt::new(problem, tuning)?;
            let mut rng = Rng::seed(SEED);
            let times = clocked(sizes, self.cap, || {
                rrt.step(&mut rng, &mut ());
                rrt.progress().nodes
            });
            best(&mut planner, &times);
            drop(rrt);

            let mut plain = BareLoop::new(space, start.clone(), local()?, STEP * space.extent());
            let mut rng = Rng::seed(SEED);
            let times = clocked(sizes, self.cap, || plain.step(&mut rng));
            best(&mut bare, &times);
        }
        let times = planner.into_iter().zip(bare);
        Ok(self
            .sizes
            .iter()
            .zip(times)
            .map(|(&nodes, (planner, bare))| Row { nodes, planner, bare })
            .collect())
    }
}

/// The work of RRT without a planner.
struct BareLoop<'c, C: DefaultNn, L> {
    space: &'c C,
    local: L,
    step: f64,
    points: Vec<C::State>,
    parents: Vec<NodeId>,
    index: C::Nn,
}

impl<'c, C: DefaultNn, L: LocalPlanner<C::State>> BareLoop<'c, C, L> {
    fn new(space: &'c C, start: C::State, local: L, step: f64) -> Self {
        let (points, mut index) = (vec![start], C::Nn::default());
        index.inserted(space, &points, 0);
        Self { space, local, step, points, parents: vec![0], index }
    }

    fn step(&mut self, rng: &mut Rng) -> usize {
        let q = self.space.sample_uniform(rng);
        if let Some(hit) = self.index.nearest(self.space, &self.points, &q) {
            let from = &self.points[hit.id as usize];
            match self.local.extend(from, &q, Direction::Forward, Reach::Step(self.step)) {
                Extension::Trapped => {}
                Extension::Advanced(Motion { end, .. }) | Extension::Reached(Motion { end, .. }) => {
                    self.points.push(end);
                    self.parents.push(hit.id);
                    self.index.inserted(self.space, &self.points, (self.points.len() - 1) as NodeId);
                }
            }
        }
        self.points.len()
    }
}

/// Runs `step`, which returns the number of nodes, until the last size or the cap (s); returns the processor
/// time at which each size was reached.
fn clocked(sizes: &[usize], cap: f64, mut step: impl FnMut() -> usize) -> Vec<f64> {
    let (begun, began) = (Instant::now(), nanoseconds());
    let mut times = Vec::new();
    for &size in sizes {
        let mut i = 0_u32;
        while step() < size {
            i = i.wrapping_add(1);
            if i.is_multiple_of(1024) && begun.elapsed().as_secs_f64() > cap {
                return times;
            }
        }
        times.push(seconds_since(began).max(1e-9));
    }
    times
}

/// Keeps the least time of each size.
fn best(least: &mut Vec<f64>, times: &[f64]) {
    for (i, &time) in times.iter().enumerate() {
        match least.get_mut(i) {
            Some(known) => *known = known.min(time),
            None => least.push(time),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_every_space_at_every_size() {
        let growing = Growing { sizes: &[10, 100], cap: 60.0, repeats: 1 };
        for space in SPACES {
            let rows = growing.measure(space).unwrap();
            assert_eq!(rows.iter().map(|row| row.nodes).collect::<Vec<_>>(), [10, 100]);
            assert!(rows.iter().all(|row| row.planner > 0.0 && row.bare > 0.0));
        }
    }

    #[test]
    fn refuses_spaces_it_does_not_know_and_keeps_the_cap() {
        let growing = Growing { cap: 0.0, sizes: &[usize::MAX], repeats: 1 };
        assert!(growing.measure("r9").unwrap_err().to_string().contains("r9"));
        assert!(growing.measure("r2").unwrap().is_empty());
    }
}
