//! Measured costs replayed for any number of ranks.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Who does which item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    /// Each rank has as many items in a row as the others.
    Blocks,
    /// Item `k` is done by rank `k` modulo the number of ranks:
    /// [shards](https://slurm.schedmd.com/job_array.html).
    Shards,
    /// The master hands out items in their order, as [`run`](crate::run) does.
    InOrder,
    /// The master hands out the dearest items first, by costs that are known.
    DearestFirst,
}

/// What became of a job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simulated {
    /// From the beginning to the end, seconds.
    pub makespan_s: f64,
    /// The cost of all items, divided by the time of all ranks.
    pub efficiency: f64,
    /// The part of the time in which the master receives and sends.
    pub master_load: f64,
}

/// A moment, in order.
#[derive(Clone, Copy, Debug, PartialEq)]
struct At(f64);
impl Eq for At {}
impl PartialOrd for At {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for At {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// Replays items of these costs (s) on `ranks` ranks. A message takes `latency_s`, and the master `message_s`
/// for a result and the item that it sends in return. The master works on no items: of ranks that do, there
/// are `ranks`.
///
/// Takes time in proportion to the number of items times the logarithm of the number of ranks.
#[must_use]
pub fn simulate(costs: &[f64], policy: Policy, ranks: usize, latency_s: f64, message_s: f64) -> Simulated {
    let ranks = ranks.max(1);
    let total: f64 = costs.iter().sum();
    let (makespan_s, messages) = match policy {
        Policy::Blocks => {
            let of = |rank: usize| &costs[rank * costs.len() / ranks..(rank + 1) * costs.len() / ranks];
            ((0..ranks).map(|rank| of(rank).iter().sum()).fold(0.0, f64::max), 0)
        }
        Policy::Shards => {
            let of = |rank: usize| costs.iter().skip(rank).step_by(ranks).sum();
            ((0..ranks).map(of).fold(0.0, f64::max), 0)
        }
        Policy::InOrder => (handed_out(costs, ranks, latency_s, message_s), costs.len()),
        Policy::DearestFirst => {
            let mut costs = costs.to_vec();
            costs.sort_by(|a, b| b.total_cmp(a));
            (handed_out(&costs, ranks, latency_s, message_s), costs.len())
        }
    };
    let whole = makespan_s.max(f64::MIN_POSITIVE);
    Simulated {
        makespan_s,
        efficiency: total / (ranks as f64 * whole),
        master_load: messages as f64 * message_s / whole,
    }
}

/// The makespan of items that are handed out in this order; while there are plenty, each rank has one more
/// than it works on.
fn handed_out(costs: &[f64], ranks: usize, latency_s: f64, message_s: f64) -> f64 {
    let mut master = Master {
        left: costs.iter(),
        latency_s,
        free_at: 0.0,
        makespan: 0.0,
        waiting: vec![None; ranks],
        results: BinaryHeap::new(),
    };
    // One item for each rank, then one ahead; later items are sent in return for results.
    for rank in 0..ranks {
        master.free_at += message_s;
        master.send(rank, true);
    }
    for rank in 0..ranks {
        master.free_at += message_s;
        master.send_if_plenty(rank);
    }
    while let Some(Reverse((At(arrived), rank))) = master.results.pop() {
        master.free_at = master.free_at.max(arrived) + message_s;
        match master.waiting[rank].take() {
            Some((reached, cost)) => master.begin(rank, reached.max(arrived - latency_s), cost),
            None => master.send(rank, true),
        }
        master.send_if_plenty(rank);
    }
    master.makespan
}

/// The master of a job that is replayed.
struct Master<'a> {
    /// The costs of the items that are left.
    left: std::slice::Iter<'a, f64>,
    latency_s: f64,
    /// When it is done with all messages before.
    free_at: f64,
    makespan: f64,
    /// Of each rank the item behind the one that it works on: when it reached it, and its cost.
    waiting: Vec<Option<(f64, f64)>>,
    /// Results on their way, by when they arrive.
    results: BinaryHeap<Reverse<(At, usize)>>,
}

impl Master<'_> {
    /// A rank begins an item at a moment.
    fn begin(&mut self, rank: usize, at: f64, cost: f64) {
        let end = at + cost;
        self.makespan = self.makespan.max(end);
        self.results.push(Reverse((At(end + self.latency_s), rank)));
    }

    /// Sends the next item, if there is one, to a rank that is idle or not.
    fn send(&mut self, rank: usize, idle: bool) {
        let Some(&cost) = self.left.next() else { return };
        let reached = self.free_at + self.latency_s;
        match idle {
            true => self.begin(rank, reached, cost),
            false => self.waiting[rank] = Some((reached, cost)),
        }
    }

    fn send_if_plenty(&mut self, rank: usize) {
        let plenty = 8 * self.waiting.len();
        if self.left.len() > plenty && self.waiting[rank].is_none() {
            self.send(rank, false);
        }
    }
}
