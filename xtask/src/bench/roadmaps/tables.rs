//! What was found, as tables and a chart.

use super::runs::{BESIDE, Case, Plan, Run, planners};
use super::world::{SLACKS, name};
use crate::bench::Table;
use crate::bench::chart::{Curve, Labels, log_log};
use crate::bench::log::Log;
use crate::bench::stats::Median;
use miette::Result;

/// The runs, to be summed up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found<'a> {
    pub(super) log: &'a Log<Case, Run>,
    pub(super) plan: &'a Plan,
    pub(super) scenes: &'a [&'a str],
}

/// The interval that holds a share of which `k` of `n` were seen, with 95% (Wilson 1927, *Probable inference,
/// the law of succession, and statistical inference*).
fn wilson(k: usize, n: usize) -> (f64, f64) {
    const Z: f64 = 1.959_964;
    let (n, p) = (n as f64, k as f64 / n as f64);
    let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    ((middle - half).max(0.0), (middle + half).min(1.0))
}

/// Three digits.
pub(super) fn short(v: f64) -> String {
    match v {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 1.0 => format!("{v:.2}"),
        v => format!("{v:.4}"),
    }
}

impl Found<'_> {
    fn runs(&self, scene: &str, planner: &str) -> Vec<&Run> {
        let case = |seed| Case { scene: scene.to_owned(), planner: planner.to_owned(), seed };
        (1..=u64::from(self.plan.seeds)).filter_map(|seed| self.log.get(&case(seed))).collect()
    }

    fn seconds(&self, scene: &str, planner: &str) -> Option<Median> {
        let runs = self.runs(scene, planner);
        let time = |run: &&Run| if run.solved { run.seconds } else { f64::INFINITY };
        Median::of(&runs.iter().map(time).collect::<Vec<_>>())
    }

    fn share(&self, scene: &str, planner: &str) -> (usize, usize) {
        let runs = self.runs(scene, planner);
        (runs.iter().filter(|run| run.solved).count(), runs.len())
    }

    /// A row for each scene and planner: the medians are over all runs, solved or not, those of time with what
    /// is not solved beyond the cap.
    pub(super) fn summary(&self) -> Table {
        let mut table = Table::new([
            "scene",
            "planner",
            "solved",
            "95%",
            "median s (95%)",
            "nodes",
            "edges",
            "components",
            "checks",
            "motions",
        ]);
        for scene in self.scenes {
            for planner in planners() {
                let runs = self.runs(scene, planner);
                let (solved, of) = self.share(scene, planner);
                let Some(seconds) = self.seconds(scene, planner) else { continue };
                let (low, high) = wilson(solved, of);
                let count = |value: &dyn Fn(&Run) -> f64| {
                    let values: Vec<f64> = runs.iter().map(|run| value(run)).collect();
                    Median::of(&values).map_or_else(String::new, |m| format!("{:.0}", m.median))
                };
                let of_map = |value: &dyn Fn(&Run) -> f64| match planner == BESIDE {
                    true => "–".to_owned(),
                    false => count(value),
                };
                table.rows.push(vec![
                    (*scene).to_owned(),
                    planner.to_owned(),
                    format!("{solved}/{of}"),
                    format!("{:.0}–{:.0}%", 100.0 * low, 100.0 * high),
                    seconds.cell(&format!("> {}", self.plan.cap), short),
                    count(&|run| run.nodes as f64),
                    of_map(&|run| run.edges as f64),
                    of_map(&|run| run.components as f64),
                    count(&|run| run.checks as f64),
                    count(&|run| run.motions as f64),
                ]);
            }
        }
        table
    }

    /// Success in each corridor, and the widest in which a planner solves less than half.
    pub(super) fn corridor(&self) -> Table {
        let head = SLACKS.iter().map(|slack| format!("{slack} m"));
        let mut table =
            Table::new(["planner".to_owned()].into_iter().chain(head).chain(["below 50% from".to_owned()]));
        for planner in planners() {
            let shares: Vec<_> =
                SLACKS.iter().map(|&slack| (slack, self.share(&name(slack), planner))).collect();
            let mut row = vec![planner.to_owned()];
            row.extend(shares.iter().map(|(_, (solved, of))| format!("{solved}/{of}")));
            let fails = shares.iter().find(|(_, (solved, of))| 2 * solved < *of);
            row.push(fails.map_or_else(|| "–".to_owned(), |(slack, _)| format!("{slack} m")));
            table.rows.push(row);
        }
        table
    }

    /// Time to a path against the width of the corridor.
    pub(super) fn chart(&self) -> Result<String> {
        let curves: Vec<Curve> = planners()
            .into_iter()
            .enumerate()
            .map(|(i, planner)| {
                let medians: Vec<_> = SLACKS
                    .iter()
                    .filter_map(|&slack| Some((slack, self.seconds(&name(slack), planner)?)))
                    .collect();
                Curve {
                    ranges: medians.iter().map(|(x, m)| (*x, m.low, m.high)).collect(),
                    ..Curve::new(planner, i, medians.iter().map(|(x, m)| (*x, m.median)).collect())
                }
            })
            .collect();
        let labels = Labels {
            title: "Through a corridor",
            x: "width of the corridor less that of the robot, m",
            y: "median processor time, s",
        };
        log_log(labels, &SLACKS, &curves)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 81 of 263 (Newcombe 1998, table I).
    #[test]
    fn intervals_are_the_tabulated_ones() {
        let (low, high) = wilson(81, 263);
        assert!((low - 0.2553).abs() < 5e-5 && (high - 0.3662).abs() < 5e-5, "{low} {high}");
        assert_eq!(wilson(0, 20).0, 0.0);
        assert_eq!(wilson(20, 20).1, 1.0);
    }
}
