//! Sets of queries, their answers and times.

use crate::clock::nanoseconds;
use mp_plan::median;
use std::hint::black_box;

/// The identity of a set of queries.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct QueryId {
    /// The library that answered.
    pub(crate) lib: String,
    /// `uniform`, `near` or `edges`.
    pub(crate) set: String,
    /// `collide`, `tolerance`, `distance` or `motion`.
    pub(crate) query: String,
}

impl QueryId {
    pub(crate) fn new(lib: &str, set: &str, query: &str) -> Self {
        Self { lib: lib.to_owned(), set: set.to_owned(), query: query.to_owned() }
    }
}

/// The answers to a set of queries, and how long they took.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TimedAnswers {
    pub(crate) what: QueryId,
    /// Nanoseconds per query, the median of the passes of each round.
    pub(crate) medians: Vec<f64>,
    /// Nanoseconds per query of the fastest pass.
    pub(crate) least: f64,
    /// 0 or 1, metres, or the number of poses before the first collision.
    pub(crate) answers: Vec<f64>,
}

impl TimedAnswers {
    /// The times and answers of one round.
    fn new(what: QueryId, passes: &[f64], answers: Vec<f64>) -> Self {
        let medians = median(passes.iter().copied()).into_iter().collect();
        let least = passes.iter().copied().fold(f64::INFINITY, f64::min);
        Self { what, medians, least, answers }
    }

    /// The median of all rounds.
    pub(crate) fn median(&self) -> f64 {
        median(self.medians.iter().copied()).unwrap_or(f64::INFINITY)
    }
}

/// Adds `new` to `all`, as another round if the same queries are there already.
pub(crate) fn add(all: &mut Vec<TimedAnswers>, new: TimedAnswers) {
    match all.iter_mut().find(|r| r.what == new.what) {
        Some(known) => {
            known.medians.extend(new.medians);
            known.least = known.least.min(new.least);
            if new.answers.len() > known.answers.len() {
                known.answers = new.answers;
            }
        }
        None => all.push(new),
    }
}

/// Runs a query for each of `items`, `passes` times.
pub(crate) fn timed<T>(
    what: QueryId,
    items: &[T],
    passes: usize,
    mut answer: impl FnMut(&T) -> f64,
) -> TimedAnswers {
    let mut answers = vec![0.0; items.len()];
    let passes = (0..passes).map(|_| {
        let begin = nanoseconds();
        for (known, item) in answers.iter_mut().zip(items) {
            *known = answer(black_box(item));
        }
        (nanoseconds() - begin) / items.len().max(1) as f64
    });
    let passes: Vec<f64> = passes.collect();
    TimedAnswers::new(what, &passes, answers)
}

/// Runs a query for each of `items`, once, until `cap` (ns) is used up.
pub(crate) fn timed_once<T>(
    what: QueryId,
    items: &[T],
    cap: f64,
    mut answer: impl FnMut(&T) -> f64,
) -> TimedAnswers {
    let mut answers = Vec::with_capacity(items.len());
    let begin = nanoseconds();
    for item in items {
        answers.push(answer(black_box(item)));
        if nanoseconds() - begin > cap {
            break;
        }
    }
    let pass = (nanoseconds() - begin) / answers.len().max(1) as f64;
    TimedAnswers::new(what, &[pass], answers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_add_up_and_answers_are_kept() {
        let what = QueryId::new("ours", "near", "distance");
        let mut all = Vec::new();
        add(&mut all, timed_once(what.clone(), &[1.0, 2.0], -1.0, |x| x + 1.0));
        assert_eq!(all[0].answers, [2.0]);
        add(&mut all, timed(what, &[1.0, 2.0], 3, |x| x + 1.0));
        add(&mut all, timed(QueryId::new("ours", "near", "collide"), &[1.0], 1, |x| x + 1.0));
        assert_eq!((all.len(), all[0].medians.len()), (2, 2));
        assert_eq!(all[0].answers, [2.0, 3.0]);
        assert!(all[0].least <= all[0].median());
    }
}
