//! Restarts as tables and charts.

use super::restarts::{Case, Plan, SCHEDULES};
use crate::error::Result;
use crate::experiment::{Log, Median, Table, bootstrap, restricted_mean, seconds, survival};
use crate::plot::{Axis, ChartCurve, Labels, chart};
use mp_experiments::clutter::Run;

/// The runs, for summaries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Results<'a> {
    pub(super) log: &'a Log<Case, Run>,
    pub(super) plan: &'a Plan,
}

/// A run as survival analysis has it: its time, and whether it ended then.
fn timed(run: &Run, cap: f64) -> (f64, bool) {
    (run.seconds.min(cap), run.solved)
}

impl<'a> Results<'a> {
    /// The times of the runs, by seed.
    fn times(&self, problem: &str, schedule: &str) -> Vec<(f64, bool)> {
        self.log.runs(self.plan.runs(problem, schedule)).iter().map(|run| timed(run, self.plan.cap)).collect()
    }

    fn mean(&self, times: &[(f64, bool)], drawn: &[usize]) -> f64 {
        restricted_mean(drawn.iter().map(|&i| times[i]), self.plan.cap)
    }

    /// For each problem and schedule: expected times, and how many times shorter than without restarts they
    /// are.
    pub(super) fn summary(&self) -> Table {
        let head =
            ["problem", "restarts", "solved", "median s", "mean s", "none : this", "slowest of 20 runs, s"];
        let mut table = Table::new(head);
        let cap = self.plan.cap;
        for problem in &self.plan.problems {
            let none = self.times(problem.name, SCHEDULES[0]);
            for schedule in SCHEDULES {
                let times = self.times(problem.name, schedule);
                if times.is_empty() || times.len() != none.len() {
                    continue;
                }
                let all: Vec<usize> = (0..times.len()).collect();
                let solved = times.iter().filter(|t| t.1).count();
                // A lower bound of the mean where some runs were cut short.
                let at_least = |runs: &[(f64, bool)]| if runs.iter().all(|t| t.1) { "" } else { "≥ " };
                let (low, high) = bootstrap(times.len(), |drawn| self.mean(&times, drawn));
                let mean = format!(
                    "{}{} ({} – {})",
                    at_least(&times),
                    seconds(self.mean(&times, &all)),
                    seconds(low),
                    seconds(high)
                );
                let factor = |drawn: &[usize]| self.mean(&none, drawn) / self.mean(&times, drawn);
                let (low, high) = bootstrap(times.len(), factor);
                let factor = format!("{}{:.2} ({low:.2} – {high:.2})", at_least(&none), factor(&all));
                let infinite = |t: &(f64, bool)| if t.1 { t.0 } else { f64::INFINITY };
                let median = Median::of(times.iter().map(infinite))
                    .map_or("–".into(), |m| m.cell(&format!("> {cap}"), seconds));
                let mut sorted: Vec<f64> = times.iter().map(infinite).collect();
                sorted.sort_by(f64::total_cmp);
                let slow = sorted[(sorted.len() * 19).div_ceil(20).clamp(1, sorted.len()) - 1];
                let slow = if slow.is_finite() { seconds(slow) } else { format!("> {cap}") };
                let names = [problem.name, schedule].map(str::to_owned);
                let factor = if schedule == SCHEDULES[0] { "1".to_owned() } else { factor };
                let cells = [format!("{solved}/{}", times.len()), median, mean, factor, slow];
                table.rows.push(names.into_iter().chain(cells).collect());
            }
        }
        table
    }

    /// For each problem, the share of runs that are still going on, against time.
    pub(super) fn charts(&self) -> Vec<(String, Result<String>)> {
        let of = |name: &str| {
            let curves = SCHEDULES.iter().enumerate().map(|(i, schedule)| {
                let steps = survival(self.times(name, schedule));
                ChartCurve::new(*schedule, i, steps).pattern(i % 4)
            });
            let title = format!("{name}: runs that still go on");
            let labels = Labels { title: &title, x: "s of processor time", y: "share of runs" };
            let file = name.replace(". ", "-").replace(", ", "-").replace(' ', "-").to_lowercase();
            (file, chart(labels, [Axis::Log, Axis::FromZero(Some(1.0))], &curves.collect::<Vec<_>>()))
        };
        self.plan.problems.iter().map(|problem| of(problem.name)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::restarts::PROBLEMS;
    use super::*;

    #[test]
    fn restarts_are_compared_with_none() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = Log::open(&folder.path().join("runs.jsonl"), 6.0, false).unwrap();
        let plan = Plan { seeds: 20, problems: PROBLEMS[..1].to_vec(), cap: 6.0 };
        for case in plan.cases() {
            // Without restarts every fourth run never ends.
            let lost = case.schedule == "none" && case.seed % 4 == 0;
            let run = Run { solved: !lost, seconds: if lost { 6.01 } else { 0.5 }, ..Run::default() };
            log.learn([(case, run)]);
        }
        let results = Results { log: &log, plan: &plan };
        let rows = results.summary().rows;
        assert_eq!(rows.len(), 5);
        assert_eq!(rows[0][2..4], ["15/20", "0.500 (0.500 – 0.500)"]);
        assert!(rows[0][4].starts_with("≥ 1.88 ("), "{}", rows[0][4]);
        assert_eq!(rows[0][5..], ["1", "> 6"]);
        assert!(rows[1][4].starts_with("0.500 (0.500 – 0.500)"), "{}", rows[1][4]);
        assert!(rows[1][5].starts_with("≥ 3.75 ("), "{}", rows[1][5]);
        let charts = results.charts();
        assert!(charts[0].1.as_ref().is_ok_and(|c| c.contains("counter") && c.contains("<polyline")));
    }
}
