//! The results on a pair of meshes, and the comparison of answers.

use super::ours::{OURS, TreeBuild};
use super::pairs::Pair;
use super::record::TimedAnswers;

#[derive(Clone, Debug)]
pub(crate) struct PairResults {
    pub(crate) pair: String,
    /// Triangles of both meshes.
    pub(crate) triangles: usize,
    /// A bound of the coordinates, metres.
    pub(crate) size: f64,
    /// The fastest build of each library.
    pub(crate) builds: Vec<TreeBuild>,
    pub(crate) records: Vec<TimedAnswers>,
}

impl PairResults {
    /// The results of a pair that is not measured yet.
    pub(crate) fn new(pair: &Pair) -> Self {
        Self {
            pair: pair.name.clone(),
            triangles: pair.a.triangles().len() + pair.b.triangles().len(),
            size: pair.a.aabb().diagonal() + pair.radius(),
            builds: Vec::new(),
            records: Vec::new(),
        }
    }

    /// Adds `build`, of which the fastest of each library is kept.
    pub(crate) fn built(&mut self, build: TreeBuild) {
        match self.builds.iter_mut().find(|b| b.lib == build.lib) {
            Some(known) => known.ms = known.ms.min(build.ms),
            None => self.builds.push(build),
        }
    }

    pub(crate) fn record(&self, lib: &str, set: &str, query: &str) -> Option<&TimedAnswers> {
        self.records.iter().find(|r| r.what.lib == lib && r.what.set == set && r.what.query == query)
    }

    /// The number of answers compared with ours, the number that differ, and the largest relative difference
    /// of distances.
    pub(crate) fn differences(&self, of: &TimedAnswers) -> Option<(usize, usize, f64)> {
        let ours = self.record(OURS, &of.what.set, &of.what.query)?;
        let both = ours.answers.iter().zip(&of.answers);
        let (mut count, mut differ, mut largest) = (0, 0, 0.0_f64);
        for (&own, &other) in both {
            count += 1;
            if of.what.query == "distance" {
                // The rounding error of a distance is relative to the coordinates.
                let off = (own - other.max(0.0)).abs();
                let tolerated = if own == 0.0 { 0.0 } else { RELATIVE * own + ROUNDING * self.size };
                differ += usize::from(off.is_nan() || off > tolerated);
                largest = if own > 0.0 { largest.max(off / own) } else { largest };
            } else {
                differ += usize::from(own != other);
            }
        }
        Some((count, differ, largest))
    }
}

/// Distances differ when they do by more than this fraction of them, plus the rounding of coordinates.
const RELATIVE: f64 = 1e-12;
/// The rounding of coordinates, as a fraction of their size.
const ROUNDING: f64 = 1e-14;
