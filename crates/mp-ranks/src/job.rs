//! Jobs: what is handed out, and what becomes of the results.

use std::collections::VecDeque;

/// What is to be done, as the master sees it.
pub trait Job {
    /// The item to hand out next. `None` when there is none, at least until another result is taken.
    fn next(&mut self) -> Option<u64>;
    /// About how many items are left to hand out.
    fn left(&self) -> u64;
    /// Takes the result of an item, done by `rank`. Results come in any order.
    ///
    /// # Errors
    /// When the result is not what it should be: what is wrong.
    fn take(&mut self, item: u64, rank: usize, result: Vec<u8>) -> Result<(), String>;
    /// A number that only falls, which the [context](crate::ItemContext) of all items that are worked on
    /// gets: for searches, the best so far.
    fn bound(&self) -> u64 {
        u64::MAX
    }
}

/// A job of items that are known beforehand.
#[derive(Debug)]
pub struct Items<F> {
    left: VecDeque<u64>,
    take: F,
}

impl<F: FnMut(u64, usize, Vec<u8>) -> Result<(), String>> Items<F> {
    /// Hands out `items` in this order; `take` gets each with the rank that did it and its result.
    pub fn new(items: impl IntoIterator<Item = u64>, take: F) -> Self {
        Self { left: items.into_iter().collect(), take }
    }

    /// Hands out the items of the greatest cost first, equal ones in their order: what takes long and begins
    /// late makes all others wait. Costs need only be right in proportion.
    pub fn dearest_first(items: impl IntoIterator<Item = u64>, cost: impl Fn(u64) -> f64, take: F) -> Self {
        let mut order: Vec<(u64, f64)> = items.into_iter().map(|item| (item, cost(item))).collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        Self::new(order.into_iter().map(|(item, _)| item), take)
    }
}

impl<F: FnMut(u64, usize, Vec<u8>) -> Result<(), String>> Job for Items<F> {
    fn next(&mut self) -> Option<u64> {
        self.left.pop_front()
    }
    fn left(&self) -> u64 {
        self.left.len() as u64
    }
    fn take(&mut self, item: u64, rank: usize, result: Vec<u8>) -> Result<(), String> {
        (self.take)(item, rank, result)
    }
}
