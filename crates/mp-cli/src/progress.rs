//! The progress line on standard error, shown only on a terminal.

use mp_plan::{Progress, Stage, Watch};
use std::io::{IsTerminal, Write};
use std::time::Instant;

/// A line that shows the progress of a run.
#[derive(Debug)]
pub(crate) struct Line {
    name: String,
    began: Instant,
    budget: Option<f64>,
    shown: bool,
}

impl Line {
    /// A line that begins with `name`; hidden when `shown` is false or standard error is not a terminal.
    pub(crate) fn new(name: &str, budget: Option<f64>, shown: bool) -> Self {
        let shown = shown && std::io::stderr().is_terminal();
        Self { name: name.to_owned(), began: Instant::now(), budget, shown }
    }

    /// Shows `message`.
    pub(crate) fn say(&self, message: &str) {
        if self.shown {
            let mut out = std::io::stderr().lock();
            let _ = write!(out, "\r\x1b[2K{}: {message}", self.name);
            let _ = out.flush();
        }
    }
}

/// Clears the line.
impl Drop for Line {
    fn drop(&mut self) {
        if self.shown {
            let mut out = std::io::stderr().lock();
            let _ = write!(out, "\r\x1b[2K");
            let _ = out.flush();
        }
    }
}

impl Watch for Line {
    fn stage(&mut self, stage: Stage) {
        match stage {
            Stage::Relaxing => self.say("solved; relaxing the path"),
            Stage::Finishing => self.say("solved; shortening and verifying the path"),
            _ => {}
        }
    }
    fn progress(&mut self, progress: &Progress) {
        let budget = self.budget.map(|s| format!(" of {s}")).unwrap_or_default();
        self.say(&format!(
            "{} iterations, {} nodes, {} rejected paths, {:.1}{budget} s",
            progress.iterations,
            progress.nodes,
            progress.rejected,
            self.began.elapsed().as_secs_f64()
        ));
    }
}
