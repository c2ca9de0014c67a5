//! The live line on standard error. It is not there when nobody watches (no terminal).

use indicatif::{ProgressBar, ProgressStyle};
use mp::cspace::{Progress, Stop, StopReason};
use std::time::{Duration, Instant};

/// Iterations between two looks at the clock.
const EVERY: u64 = 64;

/// A line that says what one run has done so far. As a [`Stop`] it never stops anything.
#[derive(Debug)]
pub(crate) struct Line {
    bar: ProgressBar,
    began: Instant,
    drawn: Instant,
    budget: Duration,
}

impl Line {
    /// A line for the run called `name`; hidden when `shown` is false.
    pub(crate) fn new(name: &str, budget: Duration, shown: bool) -> Self {
        let bar = if shown { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix}: {msg}") {
            bar.set_style(style);
        }
        bar.set_prefix(name.to_owned());
        let now = Instant::now();
        Self { bar, began: now, drawn: now, budget }
    }

    /// Shows `message`.
    pub(crate) fn say(&self, message: &str) {
        self.bar.set_message(message.to_owned());
        self.bar.tick();
    }

    /// Takes the line away.
    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Stop for Line {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        if progress.iterations.is_multiple_of(EVERY) && self.drawn.elapsed() > Duration::from_millis(100) {
            self.drawn = Instant::now();
            let (passed, budget) = (self.began.elapsed().as_secs_f64(), self.budget.as_secs_f64());
            self.say(&format!(
                "{} iterations, {} nodes, {} rejected paths, {passed:.1} of {budget} s",
                progress.iterations, progress.nodes, progress.rejected
            ));
        }
        None
    }
}

/// A line that counts finished runs.
pub(crate) fn runs(total: usize, shown: bool) -> ProgressBar {
    let bar = if shown { ProgressBar::new(total as u64) } else { ProgressBar::hidden() };
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos} of {len} runs, {elapsed} {msg}") {
        bar.set_style(style);
    }
    bar
}
