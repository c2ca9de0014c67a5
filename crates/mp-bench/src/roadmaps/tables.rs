//! The results, as tables and a chart.

use super::runs::{BESIDE, Case, Plan, Run, planners};
use super::scenes::Corridors;
use crate::error::Result;
use crate::experiment::{Log, Median, Table, short, wilson, wilson_percent};
use crate::plot::{Axis, ChartCurve, Labels, charts};

/// The runs, for summaries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Results<'a> {
    pub(super) log: &'a Log<Case, Run>,
    pub(super) plan: &'a Plan,
}

/// The width at which the success rate falls below one half, from the widest on: interpolated in the
/// logarithm of the width. Infinite if the rate is below half at the widest, zero if it never is.
fn falls(points: &[(f64, f64)]) -> f64 {
    let Some(i) = points.iter().position(|(_, share)| *share < 0.5) else { return 0.0 };
    let Some(before) = i.checked_sub(1) else { return f64::INFINITY };
    let [(wide, high), (narrow, low)] = [points[before], points[i]];
    let t = (high - 0.5) / (high - low);
    mp_math::exp(mp_math::ln(wide) + t * (mp_math::ln(narrow) - mp_math::ln(wide)))
}

fn thousands(v: f64) -> String {
    if v < 10_000.0 { format!("{:.1}k", 1e-3 * v) } else { format!("{:.0}k", 1e-3 * v) }
}

impl Results<'_> {
    fn runs(&self, scene: &str, planner: &str) -> Vec<&Run> {
        self.log.runs(self.plan.cases(scene, planner))
    }

    /// The number of runs solved with at most `budget` queries, and the number of runs.
    fn share(&self, scene: &str, planner: &str, budget: u64) -> (usize, usize) {
        let runs = self.runs(scene, planner);
        (runs.iter().filter(|run| run.solved_within(budget)).count(), runs.len())
    }

    /// The whole budget and two smaller ones: a run that needed fewer queries would have been solved with
    /// them as well.
    fn budgets(&self) -> [u64; 3] {
        [self.plan.budget / 10, self.plan.budget * 3 / 10, self.plan.budget]
    }

    /// A row for each scene and planner, with medians over all runs. The queries of a run that was not
    /// solved count as beyond the budget.
    pub(super) fn summary(&self, scenes: &[String]) -> Table {
        let [few, some, all] = self.budgets();
        let [by_few, by_some] = [few, some].map(|budget| format!("by {}", thousands(budget as f64)));
        let solved = format!("solved by {}", thousands(all as f64));
        let beyond = format!("> {}", thousands(all as f64));
        let rows = scenes.iter().flat_map(|scene| {
            planners().into_iter().map(move |planner| (scene, planner, self.runs(scene, planner)))
        });
        let median = |runs: &[&Run], value: fn(&Run) -> f64| {
            Median::of(runs.iter().map(|run| value(run))).unwrap_or_default()
        };
        let count = |runs: &[&Run], value: fn(&Run) -> f64| format!("{:.0}", median(runs, value).median);
        let of_map = |planner: &str, cell: String| if planner == BESIDE { "–".to_owned() } else { cell };
        Table::of(
            rows.filter(|(.., runs)| !runs.is_empty()),
            &[
                ("scene", &|(scene, ..)| (*scene).clone()),
                ("planner", &|(_, planner, _)| (*planner).to_owned()),
                (&by_few, &|(scene, planner, _)| self.share(scene, planner, few).0.to_string()),
                (&by_some, &|(scene, planner, _)| self.share(scene, planner, some).0.to_string()),
                (&solved, &|(scene, planner, runs)| {
                    format!("{}/{}", self.share(scene, planner, all).0, runs.len())
                }),
                ("95%", &|(scene, planner, runs)| {
                    wilson_percent(self.share(scene, planner, all).0, runs.len())
                }),
                ("queries (95%)", &|(.., runs)| {
                    let queries =
                        median(runs, |run| if run.solved { run.checks as f64 } else { f64::INFINITY });
                    queries.cell(&beyond, thousands)
                }),
                ("build s", &|(.., runs)| short(median(runs, |run| run.seconds).median)),
                ("query ms", &|(.., runs)| {
                    let again = Median::of(runs.iter().filter_map(|run| run.again));
                    again.map_or_else(|| "–".to_owned(), |m| short(1e3 * m.median))
                }),
                ("nodes", &|(.., runs)| count(runs, |run| run.nodes as f64)),
                ("edges", &|(_, planner, runs)| of_map(planner, count(runs, |run| run.edges as f64))),
                ("components", &|(_, planner, runs)| {
                    of_map(planner, count(runs, |run| run.components as f64))
                }),
                ("motions", &|(.., runs)| count(runs, |run| run.motions as f64)),
            ],
        )
    }

    /// The width at which the success rate of a planner with `budget` queries falls below half, and its
    /// interval: the widths at which the ends of the confidence intervals of the rates fall below half.
    fn width(&self, corridors: &Corridors, planner: &str, budget: u64) -> [f64; 3] {
        let seeds = self.plan.seeds as usize;
        let points = |end: fn(usize, usize) -> f64| -> Vec<(f64, f64)> {
            // Cases that were skipped, as nothing was solved in a wider corridor, count as not solved.
            let share = |slack: f64| end(self.share(&corridors.scene(slack), planner, budget).0, seeds);
            corridors.slacks.iter().map(|&slack| (slack, share(slack))).collect()
        };
        [
            falls(&points(|k, n| k as f64 / n as f64)),
            falls(&points(|k, n| wilson(k, n).1)),
            falls(&points(|k, n| wilson(k, n).0)),
        ]
    }

    /// The solved runs in each corridor, and the width at which the success rate falls below half.
    pub(super) fn corridor(&self, corridors: &Corridors) -> Table {
        let [few, _, all] = self.budgets();
        let mut head = vec!["planner".to_owned()];
        head.extend(corridors.slacks.iter().map(|slack| format!("{slack} m")));
        head.push(format!("half by {} (95%)", thousands(all as f64)));
        head.push(format!("half by {}", thousands(few as f64)));
        let mut table = Table::new(head);
        let [widest, narrowest] = [corridors.slacks[0], corridors.slacks[corridors.slacks.len() - 1]];
        let metres = |v: f64| match v {
            0.0 => format!("< {narrowest}"),
            v if v.is_infinite() => format!("> {widest}"),
            v => format!("{v:.3}"),
        };
        for planner in planners() {
            let mut row = vec![planner.to_owned()];
            row.extend(corridors.slacks.iter().map(|&slack| {
                match self.share(&corridors.scene(slack), planner, all) {
                    (_, 0) => "–".to_owned(),
                    (solved, _) => solved.to_string(),
                }
            }));
            let [half, low, high] = self.width(corridors, planner, all).map(metres);
            row.push(format!("{half} ({low} – {high})"));
            row.push(metres(self.width(corridors, planner, few)[0]));
            table.rows.push(row);
        }
        table
    }

    /// Charts of the success rate against the width of the corridor.
    pub(super) fn charts(&self, corridors: &Corridors) -> Vec<(String, Result<String>)> {
        let curve = |(i, planner): (usize, &'static str)| {
            let share = |slack: f64| self.share(&corridors.scene(slack), planner, self.plan.budget);
            let shares = corridors.slacks.iter().map(|&slack| (slack, share(slack)));
            let points = shares.map(|(slack, (k, n))| (slack, k as f64 / n.max(1) as f64));
            ChartCurve::new(planner, i, points.collect())
        };
        let curves: Vec<ChartCurve> = planners().into_iter().enumerate().map(curve).collect();
        let labels = Labels {
            title: corridors.title,
            x: "width of the corridor less that of the robot, m",
            y: "share of runs solved",
        };
        charts(labels, [Axis::Log, Axis::FromZero(Some(1.02))], curves)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roadmaps::scenes::CORRIDORS;

    #[test]
    fn success_falls_between_two_widths() {
        let half = falls(&[(0.8, 1.0), (0.4, 0.75), (0.1, 0.25), (0.05, 0.6)]);
        assert!((half - 0.2).abs() < 1e-12, "halfway in the logarithm: {half}");
        assert_eq!(falls(&[(0.8, 0.4), (0.4, 1.0)]), f64::INFINITY);
        assert_eq!(falls(&[(0.8, 0.9), (0.4, 0.5)]), 0.0);
    }

    #[test]
    fn smaller_budgets_are_in_the_log_of_the_larger() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = Log::open(&folder.path().join("runs.jsonl"), 1e4, false).unwrap();
        let corridors = CORRIDORS[0];
        for (i, &slack) in corridors.slacks.iter().enumerate() {
            for seed in 1..=2 {
                let case = Case { scene: corridors.scene(slack), planner: "prm".to_owned(), seed };
                let checks = if i < 2 { 900 } else { 9_000 };
                let (solved, seconds, again) = (i < 4, 0.1, Some(1e-3));
                let run =
                    Run { solved, seconds, again, nodes: 5, edges: 4, components: 1, checks, motions: 9 };
                log.learn([(case, run)]);
            }
        }
        let plan = Plan { budget: 10_000, seeds: 2 };
        let results = Results { log: &log, plan: &plan };
        let table = results.corridor(&corridors);
        let row = &table.rows[0];
        assert_eq!((&*row[0], &*row[1], &*row[4], &*row[5]), ("prm", "2", "2", "0"));
        let between = |text: &str, [low, high]: [f64; 2]| {
            let v: f64 = text.split(' ').next().unwrap().parse().unwrap();
            assert!((low..high).contains(&v), "{text}");
        };
        let slacks = corridors.slacks;
        between(&row[slacks.len() + 1], [slacks[4], slacks[3]]);
        between(&row[slacks.len() + 2], [slacks[2], slacks[1]]);
        let summary = results.summary(&[corridors.scene(slacks[3])]);
        assert_eq!(summary.rows.len(), 1, "only what was run");
        assert_eq!(
            summary.rows[0][2..5],
            ["0", "0", "2/2"].map(str::to_owned),
            "9,000 of 1,000, 3,000, 10,000"
        );
        let charts = results.charts(&corridors);
        assert!(charts.iter().all(|(_, chart)| chart.as_ref().is_ok_and(|c| c.contains("<polyline"))));
    }
}
