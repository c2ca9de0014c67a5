//! What each rank did of a job.

use std::fmt;

/// Most ranks whose numbers are listed one by one.
const LISTED: usize = 16;

/// How many items each rank has done, and the counted or timed work in them. They show how evenly a job was
/// spread.
///
/// ```
/// let mut shares = mp_ranks::Shares::new(3);
/// for (rank, checks) in [(0, 100.0), (2, 80.0), (1, 60.0), (1, 30.0)] {
///     shares.add(rank, checks);
/// }
/// assert_eq!((shares.items(), shares.efficiency()), (&[1, 2, 1][..], 0.9));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shares {
    items: Vec<u64>,
    work: Vec<f64>,
}

impl Shares {
    /// The shares of `ranks` ranks that have done nothing yet.
    #[must_use]
    pub fn new(ranks: usize) -> Self {
        Self { items: vec![0; ranks], work: vec![0.0; ranks] }
    }

    /// Adds an item that `rank` has done, and the work that it took.
    pub fn add(&mut self, rank: usize, work: f64) {
        if let (Some(items), Some(sum)) = (self.items.get_mut(rank), self.work.get_mut(rank)) {
            *items += 1;
            *sum += work;
        }
    }

    /// How many items each rank has done.
    #[must_use]
    pub fn items(&self) -> &[u64] {
        &self.items
    }

    /// The work of each rank.
    #[must_use]
    pub fn work(&self) -> &[f64] {
        &self.work
    }

    /// The mean work of a rank, divided by the most: 1 when all have done the same. While the busiest one
    /// works, the others do this part of what they could.
    #[must_use]
    pub fn efficiency(&self) -> f64 {
        let most = self.work.iter().copied().fold(0.0, f64::max);
        let sum: f64 = self.work.iter().sum();
        if most > 0.0 { sum / (most * self.work.len() as f64) } else { 1.0 }
    }
}

/// The items and the work of each rank, or of the least and the most busy one, and the efficiency.
impl fmt::Display for Shares {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ranks = self.items.len();
        let s = if ranks == 1 { "" } else { "s" };
        if ranks <= LISTED {
            let items: Vec<_> = self.items.iter().map(u64::to_string).collect();
            let work: Vec<_> = self.work.iter().map(|work| format!("{work:.4e}")).collect();
            write!(f, "{ranks} rank{s}: items {}; work {}", items.join(" "), work.join(" "))?;
        } else {
            let range = |values: &[f64]| {
                let least = values.iter().copied().fold(f64::INFINITY, f64::min);
                (least, values.iter().copied().fold(0.0, f64::max))
            };
            let items = (self.items.iter().min().unwrap_or(&0), self.items.iter().max().unwrap_or(&0));
            let work = range(&self.work);
            write!(
                f,
                "{ranks} rank{s}: items {} to {}; work {:.4e} to {:.4e}",
                items.0, items.1, work.0, work.1
            )?;
        }
        write!(f, "; efficiency {:.3}", self.efficiency())
    }
}
