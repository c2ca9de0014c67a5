//! The results, as tables and charts.

use super::series::{Case, PLANNERS, Plan, Series};
use crate::error::Result;
use crate::experiment::{Log, Median, Table, geometric_mean, ratio, seconds, survival};
use crate::plot::{Axis, ChartCurve, Labels, chart};
use mp_experiments::clutter::{METRICS, MODELS, MOVERS, Run};

/// The runs, for summaries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Results<'a> {
    pub(super) log: &'a Log<Case, Run>,
    pub(super) plan: &'a Plan,
}

/// The runs of one series at one level.
#[derive(Clone, Debug)]
struct SeriesAtLevel {
    solved: usize,
    of: usize,
    /// Times of solved runs; infinite for others.
    seconds: Median,
    checks: Median,
    /// Configurations tested per expansion, over all runs, solved or not.
    per_expansion: f64,
}

impl<'a> Results<'a> {
    fn runs(&self, series: &Series, level: usize) -> Vec<&Run> {
        self.log.runs(series.cases(self.plan, level))
    }

    fn group(&self, series: &Series, level: usize) -> Option<SeriesAtLevel> {
        let runs = self.runs(series, level);
        let of = |value: &dyn Fn(&Run) -> f64| {
            Median::of(runs.iter().map(|r| if r.solved { value(r) } else { f64::INFINITY }))
        };
        let (checks, expansions) = runs.iter().fold((0, 0), |(c, e), r| (c + r.checks, e + r.expansions));
        Some(SeriesAtLevel {
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
    ) -> [Option<SeriesAtLevel>; 3] {
        PLANNERS.map(|planner| self.group(&Series { mover, model, metric, planner }, level))
    }

    /// A row for each robot, model, number of obstacles and metric.
    pub(super) fn summary(&self) -> Table {
        let mut rows = Vec::new();
        for (mover, model) in MOVERS.into_iter().flat_map(|mover| MODELS.map(|model| (mover, model))) {
            for &level in &self.plan.levels {
                rows.extend(METRICS.map(|m| ([mover, model, m], level, self.three(mover, model, m, level))));
            }
        }
        let cap = format!("> {}", self.plan.cap);
        let said = |cell: Option<String>| cell.unwrap_or_else(|| "–".to_owned());
        let solved = |g: &Option<SeriesAtLevel>| said(g.as_ref().map(|g| format!("{}/{}", g.solved, g.of)));
        let time = |g: &Option<SeriesAtLevel>| said(g.as_ref().map(|g| g.seconds.cell(&cap, seconds)));
        let checks = |g: &Option<SeriesAtLevel>| said(g.as_ref().map(|g| format!("{:.1}", g.per_expansion)));
        let both = |[a, b, _]: &[Option<SeriesAtLevel>; 3],
                    cell: &dyn Fn(&SeriesAtLevel, &SeriesAtLevel) -> String| {
            said(a.as_ref().zip(b.as_ref()).map(|(a, b)| cell(a, b)))
        };
        Table::of(
            rows,
            &[
                ("mover", &|(names, ..)| names[0].to_owned()),
                ("model", &|(names, ..)| names[1].to_owned()),
                ("obstacles", &|(_, level, _)| level.to_string()),
                ("metric", &|(names, ..)| names[2].to_owned()),
                ("solved RRT", &|(.., g)| solved(&g[0])),
                ("RSRT", &|(.., g)| solved(&g[1])),
                ("RRT-Connect", &|(.., g)| solved(&g[2])),
                ("median s RRT", &|(.., g)| time(&g[0])),
                ("RSRT", &|(.., g)| time(&g[1])),
                ("RRT-Connect", &|(.., g)| time(&g[2])),
                ("time RRT : RSRT", &|(.., g)| both(g, &|a, b| ratio(&a.seconds, &b.seconds, self.plan.cap))),
                ("checks RRT : RSRT", &|(.., g)| both(g, &|a, b| finite(&a.checks, &b.checks))),
                ("checks per expansion RRT", &|(.., g)| checks(&g[0])),
                ("RSRT", &|(.., g)| checks(&g[1])),
            ],
        )
    }

    /// The statements of the paper, and the measured values.
    pub(super) fn markdown(&self) -> String {
        type Measure<'a> = (&'a str, &'a dyn Fn(&'static str, &'static str) -> String);
        let says: [Measure<'_>; 6] = [
            (
                "RSRT is 4 times faster for hard problems (time RRT : RSRT at the most obstacles both solve, positions)",
                &|mover, model| self.over_metrics(mover, model, true),
            ),
            (
                "RSRT is faster for easier problems (time RRT : RSRT up to 64 obstacles, geometric mean, positions)",
                &|mover, model| self.over_metrics(mover, model, false),
            ),
            (
                "RRT fails for the arm from some number of obstacles (solved RRT / RSRT at the most obstacles, positions)",
                &|mover, model| self.success(mover, model),
            ),
            (
                "RSRT hardly depends on the metric (greatest : least median over metrics, RRT / RSRT, geometric mean over levels, positions)",
                &|mover, model| self.spread(mover, model),
            ),
            (
                "Manhattan is the most efficient metric for the arm (levels where it is, RRT / RSRT, positions)",
                &|mover, model| self.manhattan(mover, model),
            ),
            (
                "RSRT calls the collision checker less (calls per expansion RRT : RSRT, least over scenes, positions)",
                &|mover, model| self.calls(mover, model),
            ),
        ];
        let rows = says
            .iter()
            .flat_map(|(says, of)| [(*says, of, MODELS[0]), ("the same with velocities", of, MODELS[1])]);
        let table = Table::of(
            rows,
            &[
                ("paper says (§4)", &|(says, ..)| (*says).to_owned()),
                ("free-flyer", &|(_, of, model)| of(MOVERS[0], model)),
                ("6-DOF arm", &|(_, of, model)| of(MOVERS[1], model)),
            ],
        );
        table.markdown() + "\n"
    }

    /// Time ratios for each metric: at the hardest level that both solve in the median, or the geometric mean
    /// over the levels up to 64.
    fn over_metrics(&self, mover: &'static str, model: &'static str, hardest: bool) -> String {
        let each = METRICS.iter().map(|metric| {
            let known = self.plan.levels.iter().filter_map(|&level| {
                let [a, b, _] = self.three(mover, model, metric, level);
                let (a, b) = (a?.seconds.median, b?.seconds.median);
                (a.is_finite() && b.is_finite()).then_some((level, a / b))
            });
            let known: Vec<(usize, f64)> = known.collect();
            let ratio = match hardest {
                true => known.last().map(|(level, r)| format!("{r:.2} at {level}")),
                false => {
                    geometric_mean(known.iter().filter(|k| k.0 <= 64).map(|k| k.1)).map(|r| format!("{r:.2}"))
                }
            };
            format!("{metric} {}", ratio.unwrap_or_else(|| "–".into()))
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

    /// Figure 5 for each robot and model of which there are runs: time against the number of obstacles; and
    /// the share of runs that go on at the most obstacles, as runs are cut short there.
    pub(super) fn charts(&self) -> Vec<(String, Result<String>)> {
        let mut charts = Vec::new();
        for mover in MOVERS {
            for model in MODELS {
                let mut curves = Vec::new();
                // As in the paper, RRT and RSRT: the third is in the tables.
                for (p, planner) in [(2, PLANNERS[0]), (0, PLANNERS[1])] {
                    for (m, metric) in METRICS.into_iter().enumerate() {
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
                        let name = format!("{planner}, {metric}");
                        let curve = ChartCurve::of_medians(name, p, &groups, self.plan.cap);
                        curves.push(curve.pattern(m));
                    }
                }
                if curves.is_empty() {
                    continue;
                }
                let title = format!("{mover}, {model}: time to a path");
                let labels = Labels { title: &title, x: "obstacles", y: "s of processor time" };
                let levels = self.plan.levels.iter().map(|l| *l as f64);
                let marks: Vec<f64> =
                    levels.filter(|l| curves.iter().any(|c| c.points.iter().any(|p| p.0 == *l))).collect();
                let name = format!("{}-{model}", mover.replace(' ', "-").to_lowercase());
                charts.push((name.clone(), chart(labels, [Axis::LogAt(&marks), Axis::Log], &curves)));
                charts.extend(self.survival_chart(mover, model).map(|c| (format!("{name}-survival"), c)));
            }
        }
        charts
    }

    /// The share of runs that still go on, against time, at the most obstacles at which RSRT was run, if it
    /// was.
    fn survival_chart(&self, mover: &'static str, model: &'static str) -> Option<Result<String>> {
        let has_runs = |level: &&usize| {
            let series = |metric| Series { mover, model, metric, planner: PLANNERS[1] };
            METRICS.into_iter().any(|metric| !self.runs(&series(metric), **level).is_empty())
        };
        let level = self.plan.levels.iter().rev().find(has_runs).copied()?;
        let mut curves = Vec::new();
        for (colour, planner) in [(2, PLANNERS[0]), (0, PLANNERS[1])] {
            for (pattern, metric) in METRICS.into_iter().enumerate() {
                let runs = self.runs(&Series { mover, model, metric, planner }, level);
                if !runs.is_empty() {
                    let steps = survival(runs.iter().map(|run| (run.seconds, run.solved)));
                    let name = format!("{planner}, {metric}");
                    curves.push(ChartCurve::new(name, colour, steps).pattern(pattern));
                }
            }
        }
        let title = format!("{mover}, {model}, {level} obstacles: runs that still go on");
        let labels = Labels { title: &title, x: "s of processor time", y: "share of runs" };
        Some(chart(labels, [Axis::Log, Axis::FromZero(Some(1.0))], &curves))
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
                    checks: if series.planner == "rrt" { 120 } else { 40 },
                    expansions: 10,
                    ..Run::default()
                };
                log.learn([(series.case(level, instance), run)]);
            }
        }
        let results = Results { log: &log, plan: &plan };
        let summary = results.summary();
        assert_eq!(summary.rows.len(), 2 * 2 * 2 * 3);
        assert_eq!(
            summary.rows[0][7..11],
            ["5.00 (2.00 – 8.00)", "2.50 (1.00 – 4.00)", "2.50 (1.00 – 4.00)", "2.00"]
        );
        assert_eq!(summary.rows[3][4..8], ["1/4", "4/4", "4/4", "> 6 (2.00 – > 6)"]);
        assert_eq!(summary.rows[3][10], "> 2.40");
        assert_eq!(summary.rows[0][11..], ["3.00", "12.0", "4.0"]);
        assert_eq!(plan.cases().len(), log.all().len());
        let text = results.markdown();
        assert!(text.contains("euclidean 2.00 at 2") && text.contains("1/4 at 4 / 4/4 at 4"), "{text}");
        let charts = results.charts();
        assert_eq!(charts.len(), 8);
        assert!(charts.iter().all(|(_, chart)| chart.as_ref().is_ok_and(|c| c.contains("rsrt, scaled"))));
    }
}
