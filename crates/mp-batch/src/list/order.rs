//! The order in which the items of a list are handed out.

use super::{ProblemList, Shard};
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

/// The cost of an item of whose kind none was handed out.
const UNTRIED: f64 = f64::INFINITY;
/// The cost of an item of whose kind some are worked on and none is done. They take longer than those that
/// are done.
const UNKNOWN: f64 = f64::MAX;

/// Hands out the items of a shard, the dearest first.
///
/// The time of an item is estimated by the mean of the finished items of its line; if there are none, by
/// those with the same scene, planner and budget. An item without any such estimate counts as the most
/// expensive one, so that an estimate exists soon.
///
/// Results are written in the order of the items, so the result of an expensive item waits for the cheap ones
/// before it. To bound how many, items come in blocks, each of which begins when everything before the last
/// one is written.
pub(super) struct Order<'l> {
    list: &'l ProblemList,
    shard: Shard,
    /// How many items each block has, and the shard.
    block: u64,
    count: u64,
    /// The place in the shard where the last block begins, and that where it ends.
    begin: u64,
    end: u64,
    /// How many items are not handed out.
    left: u64,
    runs: BinaryHeap<ItemRange>,
    costs: Costs,
}

/// Items of a line that follow each other, by their places in the shard.
struct ItemRange {
    cost: f64,
    next: u64,
    end: u64,
    line: usize,
}

impl Ord for ItemRange {
    fn cmp(&self, other: &Self) -> Ordering {
        self.cost.total_cmp(&other.cost).then(other.next.cmp(&self.next))
    }
}
impl PartialOrd for ItemRange {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for ItemRange {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}
impl Eq for ItemRange {}

/// What items took, seconds.
struct Costs {
    lines: HashMap<usize, Mean>,
    /// The kind of each line.
    kinds: Vec<usize>,
    of_kinds: Vec<Mean>,
    tried: Vec<bool>,
}

#[derive(Clone, Copy, Default)]
struct Mean {
    count: f64,
    sum: f64,
}

impl Mean {
    fn add(&mut self, cost: f64) {
        self.count += 1.0;
        self.sum += cost;
    }
    fn get(self) -> Option<f64> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}

impl Costs {
    fn new(list: &ProblemList) -> Self {
        let mut known = HashMap::new();
        let kind = |line: &super::Problem| {
            let planner = line.names_planner.then_some(&line.request.planner);
            let next = known.len();
            *known.entry(format!("{} {planner:?} {:?}", line.scene, line.request.budget)).or_insert(next)
        };
        let kinds: Vec<usize> = list.problems.iter().map(kind).collect();
        let (of_kinds, tried) = (vec![Mean::default(); known.len()], vec![false; known.len()]);
        Self { lines: HashMap::new(), kinds, of_kinds, tried }
    }

    fn of(&self, line: usize) -> f64 {
        let kind = self.kinds[line];
        let unknown = if self.tried[kind] { UNKNOWN } else { UNTRIED };
        let of_line = self.lines.get(&line).and_then(|mean| mean.get());
        of_line.or_else(|| self.of_kinds[kind].get()).unwrap_or(unknown)
    }
}

impl<'l> Order<'l> {
    /// From the place `begin` on, in blocks of this many items; `left` of them are to be handed out.
    pub(super) fn new(list: &'l ProblemList, shard: Shard, begin: u64, left: u64, block: u64) -> Self {
        let count = shard.count(list.items);
        let (runs, costs) = (BinaryHeap::new(), Costs::new(list));
        Self { list, shard, block: block.max(1), count, begin, end: begin, left, runs, costs }
    }

    /// How many are to be handed out.
    pub(super) fn left(&self) -> u64 {
        self.left
    }

    /// The place of the next item; those that are `known` are left out. `written` results are written. `None`
    /// when there is no item, at least until more are.
    pub(super) fn next(&mut self, written: u64, known: impl Fn(u64) -> bool) -> Option<u64> {
        loop {
            match self.pop() {
                Some(place) if known(place) => {}
                Some(place) => {
                    self.left = self.left.saturating_sub(1);
                    return Some(place);
                }
                None if self.end < self.count && written >= self.begin => self.begin_block(),
                None => return None,
            }
        }
    }

    /// An item took this many seconds.
    pub(super) fn learn(&mut self, place: u64, seconds: f64) {
        let line = self.line(place);
        self.costs.lines.entry(line).or_default().add(seconds);
        self.costs.of_kinds[self.costs.kinds[line]].add(seconds);
    }

    /// The dearest item of the blocks that have begun.
    fn pop(&mut self) -> Option<u64> {
        loop {
            let mut top = self.runs.pop()?;
            // More is known of it by now.
            top.cost = self.costs.of(top.line);
            if self.runs.peek().is_some_and(|next| top < *next) {
                self.runs.push(top);
                continue;
            }
            self.costs.tried[self.costs.kinds[top.line]] = true;
            let place = top.next;
            top.next += 1;
            if top.next < top.end {
                self.runs.push(top);
            }
            return Some(place);
        }
    }

    fn begin_block(&mut self) {
        self.begin = self.end;
        self.end = self.count.min(self.begin.saturating_add(self.block));
        let mut next = self.begin;
        while next < self.end {
            let line = self.line(next);
            // The items of the shard before the next line.
            let after = self.list.problems.get(line + 1).map_or(self.list.items, |problem| problem.first);
            let end = self.shard.count(after).clamp(next + 1, self.end);
            self.runs.push(ItemRange { cost: self.costs.of(line), next, end, line });
            next = end;
        }
    }

    /// The line of the item at a place.
    fn line(&self, place: u64) -> usize {
        let item = self.shard.item(place);
        self.list.problems.partition_point(|problem| problem.first <= item) - 1
    }
}
