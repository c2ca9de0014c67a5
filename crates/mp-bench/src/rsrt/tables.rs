//! What was found, as tables and charts.

use super::series::{Case, METRICS, MODELS, MOVERS, PLANNERS, Plan, Series};
use super::solve::Run;
use crate::error::Result;
use crate::experiment::{Log, Median, Table, geometric_mean, ratio, seconds};
use crate::plot::{Axis, Curve, Labels, chart};

/// The runs, to be summed up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found<'a> {
    log: &'a Log<Case, Run>,
    plan: &'a Plan,
}

/// The runs of one series at one level.
#[derive(Clone, Debug)]
struct Group {
    solved: usize,
    of: usize,
    /// Infinite where not solved.
    seconds: Median,
    checks: Median,
    /// Configurations tested per expansion, over all runs, solved or not.
    per_expansion: f64,
}

impl<'a> Found<'a> {
    pub(super) fn new(log: &'a Log<Case, Run>, plan: &'a Plan) -> Self {
        Self { log, plan }
    }

    fn runs(&self, series: &Series, level: usize) -> Vec<&Run> {
        self.log.runs(series.cases(self.plan, level))
    }

    fn group(&self, series: &Series, level: usize) -> Option<Group> {
        let runs = self.runs(series, level);
        let of = |value: &dyn Fn(&Run) -> f64| {
            Median::of(runs.iter().map(|r| if r.solved { value(r) } else { f64::INFINITY }))
        };
        let (checks, expansions) = runs.iter().fold((0, 0), |(c, e), r| (c + r.checks, e + r.expansions));
        Some(Group {
            solved: runs.iter().filter(|r| r.solved).count(),
            of: runs.len(),
            seconds: of(&|r| r.seconds)?,
            checks: of(&|r| r.checks as f64)?,
            per_expansion: checks as f64 / expansions.max(1) as f64,
        })
    }

    fn three(
        &self,
        mover: &'static str,
        model: &'static str,
        metric: &'static str,
        level: usize,
    ) -> [Option<Group>; 3] {
        PLANNERS.map(|planner| self.group(&Series { mover, model, metric, planner }, level))
    }

    /// A row for each mover, model, number of obstacles and metric.
    pub(super) fn summary(&self) -> Table {
        let mut table = Table::new([
            "mover",
            "model",
            "obstacles",
            "metric",
            "solved RRT",
            "RSRT",
            "RRT-Connect",
            "median s RRT",
            "RSRT",
            "RRT-Connect",
            "time RRT : RSRT",
            "checks RRT : RSRT",
            "checks per expansion RRT",
            "RSRT",
        ]);
        let cap = format!("> {}", self.plan.cap);
        for mover in MOVERS {
            for model in MODELS {
                for &level in &self.plan.levels {
                    for metric in METRICS {
                        let groups = self.three(mover, model, metric, level);
                        let mut row = vec![mover.into(), model.into(), level.to_string(), metric.into()];
                        let cell = |g: &Option<Group>, show: &dyn Fn(&Group) -> String| {
                            g.as_ref().map_or_else(|| "–".to_owned(), show)
                        };
                        row.extend(groups.iter().map(|g| cell(g, &|g| format!("{}/{}", g.solved, g.of))));
                        row.extend(groups.iter().map(|g| cell(g, &|g| g.seconds.cell(&cap, seconds))));
                        let two = groups[0].as_ref().zip(groups[1].as_ref());
                        row.push(
                            two.map_or("–".into(), |(a, b)| ratio(&a.seconds, &b.seconds, self.plan.cap)),
                        );
                        row.push(two.map_or("–".into(), |(a, b)| finite(&a.checks, &b.checks)));
                        row.extend(
                            groups[..2].iter().map(|g| cell(g, &|g| format!("{:.1}", g.per_expansion))),
                        );
                        table.rows.push(row);
                    }
                }
            }
        }
        table
    }

    /// A row for each run.
    pub(super) fn each(&self) -> Table {
        let mut table = Table::new([
            "mover",
            "model",
            "metric",
            "planner",
            "obstacles",
            "instance",
            "solved",
            "s",
            "iterations",
            "nodes",
            "checks",
            "expansions",
            "rejected",
            "edges",
        ]);
        for (case, run) in self.log.all() {
            table.rows.push(vec![
                case.mover.clone(),
                case.model.clone(),
                case.metric.clone(),
                case.planner.clone(),
                case.obstacles.to_string(),
                case.instance.to_string(),
                u8::from(run.solved).to_string(),
                format!("{:.6}", run.seconds),
                run.iterations.to_string(),
                run.nodes.to_string(),
                run.checks.to_string(),
                run.expansions.to_string(),
                run.rejected.to_string(),
                run.edges.to_string(),
            ]);
        }
        table
    }

    /// What the paper says, and what was measured.
    pub(super) fn markdown(&self) -> String {
        let mut table = Table::new(["paper says (§4)", "free-flyer", "6-DOF arm"]);
        let mut row = |says: &str, of: &dyn Fn(&'static str) -> String| {
            table.rows.push(vec![says.to_owned(), of(MOVERS[0]), of(MOVERS[1])]);
        };
        row(
            "RSRT is 4 times faster for hard problems (time RRT : RSRT at the most obstacles both solve, positions)",
            &|m| self.over_metrics(m, MODELS[0], true),
        );
        row("the same with velocities", &|m| self.over_metrics(m, MODELS[1], true));
        row(
            "RSRT is faster for easier problems (time RRT : RSRT up to 64 obstacles, geometric mean, positions)",
            &|m| self.over_metrics(m, MODELS[0], false),
        );
        row("the same with velocities", &|m| self.over_metrics(m, MODELS[1], false));
        row(
            "RRT fails for the arm from some number of obstacles (solved RRT / RSRT at the most obstacles, positions)",
            &|m| self.success(m, MODELS[0]),
        );
        row("the same with velocities", &|m| self.success(m, MODELS[1]));
        row(
            "RSRT hardly depends on the metric (greatest : least median over metrics, RRT / RSRT, geometric mean over levels, positions)",
            &|m| self.spread(m, MODELS[0]),
        );
        row("the same with velocities", &|m| self.spread(m, MODELS[1]));
        row(
            "Manhattan is the most efficient metric for the arm (levels where it is, RRT / RSRT, positions)",
            &|m| self.manhattan(m, MODELS[0]),
        );
        row("the same with velocities", &|m| self.manhattan(m, MODELS[1]));
        row(
            "RSRT calls the collision checker less (calls per expansion RRT : RSRT, least over scenes, positions)",
            &|m| self.calls(m, MODELS[0]),
        );
        row("the same with velocities", &|m| self.calls(m, MODELS[1]));
        table.markdown() + "\n"
    }

    /// Time ratios over metrics: of the hardest level that both solve in the median, or the geometric mean
    /// of the levels up to 64.
    fn over_metrics(&self, mover: &'static str, model: &'static str, hardest: bool) -> String {
        let each = METRICS.iter().map(|metric| {
            let known = self.plan.levels.iter().filter_map(|&level| {
                let [a, b, _] = self.three(mover, model, metric, level);
                let (a, b) = (a?.seconds.median, b?.seconds.median);
                (a.is_finite() && b.is_finite()).then_some((level, a / b))
            });
            let known: Vec<(usize, f64)> = known.collect();
            let found = match hardest {
                true => known.last().map(|(level, r)| format!("{r:.2} at {level}")),
                false => {
                    geometric_mean(known.iter().filter(|k| k.0 <= 64).map(|k| k.1)).map(|r| format!("{r:.2}"))
                }
            };
            format!("{metric} {}", found.unwrap_or_else(|| "–".into()))
        });
        each.collect::<Vec<_>>().join(", ")
    }

    fn success(&self, mover: &'static str, model: &'static str) -> String {
        let each = METRICS.iter().map(|metric| {
            let last = |planner| {
                let series = Series { mover, model, metric, planner };
                let level = self.plan.levels.iter().rev().find(|l| !self.runs(&series, **l).is_empty())?;
                let group = self.group(&series, *level)?;
                Some(format!("{}/{} at {level}", group.solved, group.of))
            };
            let [a, b] = ["rrt", "rsrt"].map(|p| last(p).unwrap_or_else(|| "–".into()));
            format!("{metric} {a} / {b}")
        });
        each.collect::<Vec<_>>().join(", ")
    }

    fn medians(
        &self,
        mover: &'static str,
        model: &'static str,
        planner: &'static str,
        level: usize,
    ) -> Option<[f64; 3]> {
        let mut all = [0.0; 3];
        for (value, metric) in all.iter_mut().zip(METRICS) {
            *value = self.group(&Series { mover, model, metric, planner }, level)?.seconds.median;
        }
        all.iter().all(|v| v.is_finite()).then_some(all)
    }

    fn spread(&self, mover: &'static str, model: &'static str) -> String {
        let of = |planner| {
            let levels = self.plan.levels.iter().filter_map(|l| self.medians(mover, model, planner, *l));
            geometric_mean(levels.map(|m| {
                m.iter().fold(0.0, |a: f64, b| a.max(*b)) / m.iter().fold(f64::INFINITY, |a, b| a.min(*b))
            }))
        };
        let [a, b] = ["rrt", "rsrt"].map(|p| of(p).map_or("–".into(), |v| format!("{v:.2}")));
        format!("{a} / {b}")
    }

    fn manhattan(&self, mover: &'static str, model: &'static str) -> String {
        let of = |planner| {
            let levels: Vec<[f64; 3]> =
                self.plan.levels.iter().filter_map(|l| self.medians(mover, model, planner, *l)).collect();
            let best = levels.iter().filter(|m| m[2] <= m[0] && m[2] <= m[1]).count();
            format!("{best} of {}", levels.len())
        };
        format!("{} / {}", of("rrt"), of("rsrt"))
    }

    fn calls(&self, mover: &'static str, model: &'static str) -> String {
        let ratios = METRICS.iter().flat_map(|metric| {
            self.plan.levels.iter().filter_map(move |&level| {
                let [a, b, _] = self.three(mover, model, metric, level);
                Some(a?.per_expansion / b?.per_expansion)
            })
        });
        let ratios: Vec<f64> = ratios.collect();
        let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        match geometric_mean(ratios.iter().copied()) {
            Some(mean) => format!("{least:.2} (mean {mean:.2})"),
            None => "–".into(),
        }
    }

    /// Figure 5, one for each mover and model: time against obstacles.
    pub(super) fn charts(&self) -> Vec<(String, Result<String>)> {
        let mut charts = Vec::new();
        for mover in MOVERS {
            for model in MODELS {
                let mut curves = Vec::new();
                for (p, planner) in PLANNERS.into_iter().enumerate() {
                    for metric in METRICS {
                        let series = Series { mover, model, metric, planner };
                        let groups: Vec<(f64, Median)> = self
                            .plan
                            .levels
                            .iter()
                            .filter_map(|&l| Some((l as f64, self.group(&series, l)?.seconds)))
                            .collect();
                        if groups.is_empty() {
                            continue;
                        }
                        let mut curve = Curve::new(
                            format!("{planner}, {metric}"),
                            p,
                            groups.iter().map(|(l, m)| (*l, m.median)).collect(),
                        );
                        curve.ranges =
                            groups.iter().map(|(l, m)| (*l, m.low, m.high.min(self.plan.cap))).collect();
                        curve.thin = metric != "euclidean";
                        curves.push(curve);
                    }
                }
                let title = format!("{mover}, {model}: time to a path");
                let labels = Labels { title: &title, x: "obstacles", y: "s of processor time" };
                let marks: Vec<f64> = self.plan.levels.iter().map(|l| *l as f64).collect();
                let name = format!("{}-{model}", mover.replace(' ', "-").to_lowercase());
                charts.push((name, chart(labels, [Axis::Log(&marks), Axis::Log(&[])], &curves)));
            }
        }
        charts
    }
}

fn finite(a: &Median, b: &Median) -> String {
    match a.median.is_finite() && b.median.is_finite() {
        true => format!("{:.2}", a.median / b.median),
        false => "–".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_measured_is_summed_up() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = Log::open(&folder.path().join("runs.jsonl"), 6.0, false).unwrap();
        let plan = Plan { cap: 6.0, instances: 4, levels: vec![2, 4] };
        for series in Series::all() {
            for (level, instance) in [(2, 0), (2, 1), (2, 2), (2, 3), (4, 0), (4, 1), (4, 2), (4, 3)] {
                let slow = if series.planner == "rrt" { 2.0 } else { 1.0 };
                let run = Run {
                    solved: !(level == 4 && series.planner == "rrt" && instance > 0),
                    seconds: slow * (1.0 + instance as f64),
                    iterations: 10,
                    nodes: 9,
                    checks: if series.planner == "rrt" { 120 } else { 40 },
                    expansions: 10,
                    rejected: 0,
                    edges: 3,
                };
                log.learn([(series.case(level, instance), run)]);
            }
        }
        let found = Found::new(&log, &plan);
        let summary = found.summary();
        assert_eq!(summary.rows.len(), 2 * 2 * 2 * 3);
        assert_eq!(
            summary.rows[0][7..11],
            ["5.00 (2.00 – 8.00)", "2.50 (1.00 – 4.00)", "2.50 (1.00 – 4.00)", "2.00"]
        );
        assert_eq!(summary.rows[3][4..8], ["1/4", "4/4", "4/4", "> 6 (2.00 – > 6)"]);
        assert_eq!(summary.rows[3][10], "> 2.40");
        assert_eq!(summary.rows[0][11..], ["3.00", "12.0", "4.0"]);
        assert_eq!(found.each().rows.len(), log.all().len());
        let text = found.markdown();
        assert!(text.contains("euclidean 2.00 at 2") && text.contains("1/4 at 4 / 4/4 at 4"), "{text}");
        let charts = found.charts();
        assert_eq!(charts.len(), 4);
        assert!(charts.iter().all(|(_, chart)| chart.as_ref().is_ok_and(|c| c.contains("rsrt, scaled"))));
    }
}
