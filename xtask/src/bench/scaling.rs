//! Tree growth: nodes per second of RRT in an empty unit cube, against the number of nodes.
//!
//! Every iteration is one uniform sample, one nearest-neighbour query, one motion check (that
//! always passes) and one insertion. Beside each planner runs the bare loop of the same work
//! without a planner, so that what the engine adds can be read off.

use mp::cspace::{
    DefaultNn, Direction, Discrete, Extension, FineDiscrete, LocalPlanner, Motion, NearestNeighbors, NodeId,
    Planner, Reach, Resolution, Rn, Rng, Se3, Space, SpaceError, Straight,
};
use mp::tree::{Goals, Problem, Rrt, Step, Tuning};
use nalgebra::{Isometry3, SVector};
use std::time::{Duration, Instant};

/// What to measure.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    /// Which spaces, of [`SPACES`].
    pub(crate) spaces: Vec<String>,
    /// At how many nodes to read the clock, ascending.
    pub(crate) sizes: Vec<usize>,
    /// Longest step, a fraction of the extent.
    pub(crate) step: f64,
    /// Resolution of the motion check, a fraction of the extent.
    pub(crate) resolution: f64,
    /// Seconds after which one growth is cut short.
    pub(crate) cap: f64,
    /// How often to repeat; the fastest counts.
    pub(crate) repeats: usize,
    /// The seed.
    pub(crate) seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            spaces: SPACES.iter().map(|name| (*name).to_owned()).collect(),
            sizes: vec![1_000, 10_000, 100_000, 1_000_000],
            step: 0.2,
            resolution: 0.01,
            cap: 60.0,
            repeats: 3,
            seed: 1,
        }
    }
}

/// Trees of this size and below are grown ten times as often.
const SMALL: usize = 10_000;

/// The spaces there are.
pub(crate) const SPACES: [&str; 4] = ["r2", "r3", "r6", "se3"];

/// Growth to one size in one space.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Which space.
    pub(crate) space: String,
    /// Nodes of the tree.
    pub(crate) nodes: usize,
    /// Processor seconds of RRT, from nothing.
    pub(crate) planner: f64,
    /// Processor seconds of the bare loop, from nothing.
    pub(crate) bare: f64,
}

impl Row {
    /// Nodes per second of RRT, from nothing.
    pub(crate) fn rate(&self) -> f64 {
        self.nodes as f64 / self.planner
    }
}

/// Measures; `watch` sees each row as it comes. Sizes not reached under the cap are left out.
///
/// # Errors
/// When a space is not known, or an option is out of range.
pub(crate) fn measure(
    options: &Options,
    mut watch: impl FnMut(&Row),
) -> Result<Vec<Row>, Box<dyn std::error::Error + Send + Sync>> {
    let mut rows = Vec::new();
    for name in &options.spaces {
        let new = match name.as_str() {
            "r2" => grow_rn::<2>(name, options)?,
            "r3" => grow_rn::<3>(name, options)?,
            "r6" => grow_rn::<6>(name, options)?,
            "se3" => {
                let start = Isometry3::translation(0.1, 0.1, 0.1);
                grow(name, &Se3::new([0.0; 3], [1.0; 3])?, &start, options)?
            }
            _ => return Err(format!("there is no space `{name}`; there are: {}", SPACES.join(", ")).into()),
        };
        new.iter().for_each(&mut watch);
        rows.extend(new);
    }
    Ok(rows)
}

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn grow_rn<const N: usize>(name: &str, options: &Options) -> Result<Vec<Row>, Failure>
where
    Rn<N>: DefaultNn + Space<State = SVector<f64, N>>,
{
    let space = unit_cube::<N>()?;
    grow(name, &space, &SVector::repeat(0.1), options)
}

fn unit_cube<const N: usize>() -> Result<Rn<N>, SpaceError> {
    Rn::new([0.0; N], [1.0; N])
}

fn grow<C: DefaultNn>(
    name: &str,
    space: &C,
    start: &C::State,
    options: &Options,
) -> Result<Vec<Row>, Failure> {
    let free = |_: &C::State| true;
    let resolution = Resolution::Fraction(options.resolution);
    let local = || Ok::<_, Failure>(Straight::new(space, Discrete::new(space, free, resolution)?));
    let (mut planner, mut bare) = (Vec::new(), Vec::new());
    // Small trees grow in no time: many short growths first, so that the fastest is undisturbed.
    let small = options.sizes.iter().filter(|&&size| size <= SMALL).count();
    let rounds = std::iter::repeat_n(&options.sizes[..small], 10 * options.repeats);
    for sizes in rounds.chain(std::iter::repeat_n(&options.sizes[..], options.repeats)) {
        let verifier = FineDiscrete::new(space, free, resolution)?;
        let nowhere = Goals::region(|_: &C::State| false);
        let problem = Problem::new(space, local()?, verifier, start.clone(), nowhere)?;
        let tuning = Tuning { step: Step::Fraction(options.step), ..Tuning::default() };
        let mut rrt = Rrt::new(problem, tuning)?;
        let mut rng = Rng::seed(options.seed);
        let times = clocked(sizes, options.cap, || {
            rrt.step(&mut rng, &mut ());
            rrt.progress().nodes
        });
        best(&mut planner, &times);
        drop(rrt);

        let mut plain = Bare::new(space, start.clone(), local()?, options.step * space.extent());
        let mut rng = Rng::seed(options.seed);
        let times = clocked(sizes, options.cap, || plain.step(&mut rng));
        best(&mut bare, &times);
    }
    let rows = options.sizes.iter().zip(planner.iter().zip(&bare)).map(|(&nodes, (&planner, &bare))| Row {
        space: name.to_owned(),
        nodes,
        planner,
        bare,
    });
    Ok(rows.collect())
}

/// The same work as RRT's without a planner.
struct Bare<'c, C: DefaultNn, L> {
    space: &'c C,
    local: L,
    step: f64,
    points: Vec<C::State>,
    parents: Vec<NodeId>,
    index: C::Nn,
}

impl<'c, C: DefaultNn, L: LocalPlanner<C::State>> Bare<'c, C, L> {
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

/// Runs `step`, which tells the number of nodes, until the last size or the cap (s); the time at
/// which each size was reached.
fn clocked(sizes: &[usize], cap: f64, mut step: impl FnMut() -> usize) -> Vec<f64> {
    let (begun, cap) = (Instant::now(), Duration::try_from_secs_f64(cap).unwrap_or(Duration::MAX));
    let used = processor_seconds();
    let mut times = Vec::new();
    for &size in sizes {
        let mut i = 0_u32;
        while step() < size {
            i = i.wrapping_add(1);
            if i.is_multiple_of(1024) && begun.elapsed() > cap {
                return times;
            }
        }
        let clock = begun.elapsed().as_secs_f64();
        // The system counts processor time in ticks of some milliseconds: too coarse below.
        let fine = used.filter(|_| clock > 0.5).zip(processor_seconds()).map(|(a, b)| b - a);
        times.push(fine.unwrap_or(clock).max(1e-9));
    }
    times
}

/// Processor time of this thread, which a busy machine disturbs less than the clock, where the
/// system tells it.
fn processor_seconds() -> Option<f64> {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: u64 = told.split(' ').next()?.parse().ok()?;
    Some(nanoseconds as f64 * 1e-9)
}

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
        let options = Options { sizes: vec![10, 100], repeats: 1, ..Options::default() };
        let mut seen = 0;
        let rows = measure(&options, |_| seen += 1).unwrap();
        assert_eq!((rows.len(), seen), (2 * SPACES.len(), 2 * SPACES.len()));
        assert!(rows.iter().all(|row| row.planner > 0.0 && row.bare > 0.0));
    }

    #[test]
    fn refuses_spaces_it_does_not_know_and_keeps_the_cap() {
        let options = Options { spaces: vec!["r9".into()], ..Options::default() };
        assert!(measure(&options, |_| ()).unwrap_err().to_string().contains("r9"));
        let options = Options { cap: 0.0, sizes: vec![usize::MAX], repeats: 1, ..Options::default() };
        assert!(measure(&options, |_| ()).unwrap().is_empty());
    }
}
