//! Searches that race keep pace with each other.

use crate::ItemContext;
use std::collections::VecDeque;
use std::time::Duration;

/// How far a search may be ahead of the last one, as a part of what that has reached.
const LEAD_PART: u64 = 8;
/// How far it may be ahead in any case.
const LEAST_LEAD: u64 = 4;
/// How old the news of other searches may be.
const NEWS: Duration = Duration::from_micros(200);
/// How often it is reported at most how far one is, unless it waits.
const REPORT: Duration = Duration::from_micros(50);
/// How often one who waits asks whether it is over.
const OVER: Duration = Duration::from_millis(5);

/// Keeps items that race at about the same pace. The winner of such a job is the item that needs the least,
/// by the measure of [`ItemContext::reached`], and work beyond the winner is lost. So an item that is an
/// eighth ahead of the slowest one waits for it.
///
/// It costs no time that it waits: the last must get as far as the winner anyway. News take some time, so
/// that what was made in the last fifth of a millisecond does not count.
///
/// All items of the job must be worked on at a time.
#[derive(Debug)]
pub struct Pace {
    item: u64,
    /// How far it was, and when: the first not later than [`NEWS`] ago, if it has come so far.
    was: VecDeque<(Duration, u64)>,
    reported: Option<Duration>,
}

impl Pace {
    /// The pace of an item that begins.
    #[must_use]
    pub fn new(item: u64) -> Self {
        Self { item, was: VecDeque::new(), reported: None }
    }

    /// Tells the others that this search has reached `reach`, which must not fall, and waits while the last one is
    /// too far behind. It does not wait when the race is `over`. `now` is the time since any moment.
    pub fn keep(
        &mut self,
        context: &ItemContext,
        reach: u64,
        now: impl Fn() -> Duration,
        mut over: impl FnMut() -> bool,
    ) {
        let mut reported = self.reaches(now(), reach);
        if reported {
            context.reached(self.item, reach);
        }
        context.wait_while(OVER, || {
            let waits = !over() && self.is_too_far(now(), context.least_reached());
            // Others may wait for this one: nobody may wait without having said how far it is.
            if waits && !std::mem::replace(&mut reported, true) {
                context.reached(self.item, reach);
            }
            waits
        });
    }

    /// Notes that it has reached `reach`. Whether that should be reported.
    fn reaches(&mut self, now: Duration, reach: u64) -> bool {
        self.was.push_back((now, reach));
        let due = self.reported.is_none_or(|reported| now.saturating_sub(reported) >= REPORT);
        if due {
            self.reported = Some(now);
        }
        due
    }

    /// Whether it should wait for the last one, which has reached `least`.
    fn is_too_far(&mut self, now: Duration, least: u64) -> bool {
        let old = |at: Duration| now.saturating_sub(at) >= NEWS;
        while self.was.get(1).is_some_and(|(at, _)| old(*at)) {
            self.was.pop_front();
        }
        let most = least.saturating_add(LEAST_LEAD.max(least / LEAD_PART));
        self.was.front().is_some_and(|(at, reach)| old(*at) && *reach > most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_who_is_far_ahead_waits() {
        let at = Duration::from_micros;
        let mut pace = Pace::new(0);
        // What it made since there may have been news does not count, and it does not report all the time.
        assert!(pace.reaches(at(0), 0) && !pace.is_too_far(at(0), 0));
        assert!(!pace.reaches(at(30), 500) && !pace.is_too_far(at(30), 0));
        assert!(pace.reaches(at(100), 900) && !pace.is_too_far(at(100), 0));
        // It had 500 before the news: the last must come to 445, as an eighth more is 500.
        assert!(pace.reaches(at(250), 1000) && pace.is_too_far(at(250), 0));
        assert!(pace.is_too_far(at(250), 444) && !pace.is_too_far(at(250), 445));
        // In time all of it counts.
        assert!(pace.is_too_far(at(2000), 888) && !pace.is_too_far(at(2000), 889));
    }
}
