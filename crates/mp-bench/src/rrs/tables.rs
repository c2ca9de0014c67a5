//! The six measures of §4: tables and charts, compared with the values in the paper.

use super::series::{PLANNERS, Plan, WORLDS};
use crate::error::Result;
use crate::experiment::{Log, Table, bit, mean};
use crate::plot::{Axis, Bars, ChartCurve, Labels, bars, chart};
use mp_experiments::rrs::{Case, ITERATIONS, Run};

/// The runs, for summaries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Results<'a> {
    pub(super) log: &'a Log<Case, Run>,
    pub(super) plan: &'a Plan,
}

/// The measures of one planner in one world at one step; those of paths are over the solved trials.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Measures {
    /// Nodes added per sample, percent, over all trials.
    accepted: f64,
    /// Iterations as a percentage of the limit; trials that were not solved used all of them.
    iterations: f64,
    /// Trials solved, percent.
    converged: f64,
    /// Mean length of paths, centimetres; NaN where none was found.
    length: f64,
    /// Mean processor time of all trials, milliseconds.
    time: f64,
    /// Mean least distance from obstacles, centimetres.
    safety: f64,
    /// Processor time per iteration, microseconds.
    per_iteration: f64,
    /// Iterations of all trials.
    all_iterations: f64,
    /// Edges per thousand iterations: straight, bulged, relaxed from a bulge, bent only by a snake, not bent.
    edges: [f64; 5],
}

impl Measures {
    /// The measures of some runs of a planner; `None` without runs.
    fn of(planner: &str, runs: &[&Run]) -> Option<Self> {
        if runs.is_empty() {
            return None;
        }
        let solved = || runs.iter().filter(|r| r.solved);
        let total = |value: &dyn Fn(&Run) -> f64| runs.iter().map(|r| value(r)).sum::<f64>();
        let iterations = total(&|r| r.iterations as f64);
        Some(Measures {
            accepted: 100.0 * total(&|r| accepted(planner, r) as f64) / iterations.max(1.0),
            iterations: 100.0
                * finite_mean(
                    runs.iter().map(|r| if r.solved { r.iterations as f64 } else { ITERATIONS as f64 }),
                )
                / ITERATIONS as f64,
            converged: 100.0 * solved().count() as f64 / runs.len() as f64,
            length: 100.0 * finite_mean(solved().map(|r| r.length)),
            time: 1e3 * finite_mean(runs.iter().map(|r| r.seconds)),
            safety: 100.0 * finite_mean(solved().map(|r| r.safety)),
            per_iteration: 1e6 * total(&|r| r.seconds) / iterations.max(1.0),
            all_iterations: iterations,
            edges: [
                total(&|r| r.straight as f64),
                total(&|r| r.bulged as f64),
                total(&|r| r.relaxed as f64),
                total(&|r| r.by_snake as f64),
                total(&|r| r.not_bent as f64),
            ]
            .map(|n| 1e3 * n / iterations.max(1.0)),
        })
    }
}

/// Accepted samples: the root is a node that is not a sample. RRT-Connect has two of them, and may add many
/// nodes for one sample.
fn accepted(planner: &str, run: &Run) -> u64 {
    let roots = if planner == "rrt-connect" { 2 } else { 1 };
    (run.nodes as u64).saturating_sub(roots)
}

/// The number with at most four significant digits.
fn four_digits(v: f64) -> String {
    format!("{v:.3e}").parse::<f64>().unwrap_or(v).to_string()
}

/// The name in files, title, axis label and value of a measure.
type Measure = (&'static str, &'static str, &'static str, fn(&Measures) -> f64);
const MEASURES: [Measure; 6] = [
    ("accepted", "accepted samples", "% of samples", |s| s.accepted),
    ("iterations", "iterations", "% of 5,000", |s| s.iterations),
    ("converged", "trials solved", "%", |s| s.converged),
    ("length", "length of the path", "cm", |s| s.length),
    ("time", "time", "ms of processor time", |s| s.time),
    ("safety", "safety", "cm from the nearest obstacle", |s| s.safety),
];

/// The mean of the finite values; NaN when there are none.
fn finite_mean(values: impl Iterator<Item = f64>) -> f64 {
    mean(values.filter(|v| v.is_finite())).unwrap_or(f64::NAN)
}

impl<'a> Results<'a> {
    fn measures(&self, world: &str, planner: &str, step: u32) -> Option<Measures> {
        let case = |trial| Case { world: world.into(), planner: planner.into(), step, trial };
        let runs = self.log.runs((0..self.plan.trials).map(case));
        Measures::of(planner, &runs)
    }

    /// A measure at all steps in some worlds.
    fn over(&self, worlds: &[&str], planner: &str, of: impl Fn(&Measures) -> f64) -> Vec<f64> {
        let at = worlds.iter().flat_map(|world| self.plan.steps.iter().map(move |step| (world, *step)));
        at.filter_map(|(world, step)| self.measures(world, planner, step).map(|s| of(&s))).collect()
    }

    /// Microseconds per iteration, over all trials at all steps in these worlds together.
    fn per_iteration(&self, worlds: &[&str], planner: &str) -> f64 {
        let sum = |of: fn(&Measures) -> f64| self.over(worlds, planner, of).iter().sum::<f64>();
        sum(|s| s.per_iteration * s.all_iterations) / sum(|s| s.all_iterations)
    }

    /// Milliseconds of all trials at all steps in these worlds together, for each that was solved.
    fn per_solution(&self, worlds: &[&str], planner: &str) -> f64 {
        let sum = |of: fn(&Measures) -> f64| self.over(worlds, planner, of).iter().sum::<f64>();
        sum(|s| s.time) / sum(|s| 0.01 * s.converged)
    }

    /// A row for each world and planner: means over all steps, with the least and greatest values.
    pub(super) fn summary(&self) -> Table {
        let heads = MEASURES.iter().map(|m| format!("{}, {}", m.1, m.2));
        let mut table = Table::new(
            ["world".into(), "planner".into()].into_iter().chain(heads).chain(["µs per iteration".into()]),
        );
        for world in WORLDS {
            for planner in PLANNERS {
                let mut row = vec![world.to_owned(), planner.to_owned()];
                row.extend(MEASURES.iter().map(|m| spread(&self.over(&[world], planner, m.3))));
                row.push(spread(&self.over(&[world], planner, |s| s.per_iteration)));
                table.rows.push(row);
            }
        }
        table
    }

    /// A row for each trial. Lengths and safety are in centimetres, times in milliseconds, with four digits;
    /// what is zero or was not found is left out.
    pub(super) fn each(&self) -> Table {
        let heads = ["world", "planner", "step_cm", "trial", "solved", "iterations", "accepted"];
        let mut table = Table::new(heads.into_iter().chain(["length_cm", "safety_cm", "ms"]).chain(EDGES));
        for case in self.plan.cases() {
            let Some(run) = self.log.get(&case) else { continue };
            let mut row = vec![case.world.clone(), case.planner.clone()];
            row.extend([case.step.to_string(), case.trial.to_string(), bit(run.solved)]);
            row.extend([run.iterations, accepted(&case.planner, run)].map(|n| n.to_string()));
            let found = |value: f64| if run.solved { four_digits(100.0 * value) } else { String::new() };
            row.extend([found(run.length), found(run.safety), four_digits(1e3 * run.seconds)]);
            let count = |n: u64| if n > 0 { n.to_string() } else { String::new() };
            row.extend([run.straight, run.bulged, run.relaxed, run.by_snake, run.not_bent].map(count));
            table.rows.push(row);
        }
        table.made_at(self.log.commits(&self.plan.cases()))
    }

    /// The values in the paper, and those measured.
    pub(super) fn markdown(&self) -> String {
        let heads = [
            "world",
            "measure",
            "paper: RRS",
            "RRS",
            "hybrid (ours)",
            "bulges (ours)",
            "field=paper (eq. 3)",
            "field=risk",
            "up to Δq",
            "paper: RRT",
            "RRT",
            "RRT up to Δq",
        ];
        let mut table = Table::new(heads.into_iter().chain(["RRT-Connect"]));
        for (world, measure, rrs, rrt) in PAPER {
            let Some(m) = MEASURES.iter().find(|m| m.0 == *measure) else { continue };
            let cell = |planner| spread(&self.over(&[*world], planner, m.3));
            table.rows.push(vec![
                (*world).into(),
                format!("{}, {}", m.1, m.2),
                (*rrs).into(),
                cell("rrs"),
                cell("rrs-hybrid"),
                cell("rrs-bulge"),
                cell("rrs-paper"),
                cell("rrs-risk"),
                cell("rrs-upto"),
                (*rrt).into(),
                cell("rrt"),
                cell("rrt-upto"),
                cell("rrt-connect"),
            ]);
        }
        let heads =
            ["time of an iteration", "mean of those at each Δq", "time of a trial", "time for a solution"];
        let heads = heads.iter().flat_map(|h| [format!("{h}, RRS : RRT"), format!("{h}, up to Δq")]);
        let mut ratios = Table::new(["world".to_owned()].into_iter().chain(heads));
        let each = WORLDS.iter().map(|world| (*world, std::slice::from_ref(world)));
        for (name, worlds) in each.chain([("all together", &WORLDS[..])]) {
            let mean_of =
                |of: fn(&Measures) -> f64| move |p: &str| finite_mean(self.over(worlds, p, of).into_iter());
            let pairs = [("rrs", "rrt"), ("rrs-upto", "rrt-upto")];
            let mut row = vec![name.to_owned()];
            let mut put = |of: &dyn Fn(&str) -> f64| {
                row.extend(pairs.map(|(a, b)| format!("{:.2}", of(a) / of(b))));
            };
            put(&|p| self.per_iteration(worlds, p));
            put(&mean_of(|s| s.per_iteration));
            put(&mean_of(|s| s.time));
            put(&|p| self.per_solution(worlds, p));
            ratios.rows.push(row);
        }
        let tables = [table, ratios, self.differences(), self.edges()].map(|table| table.markdown());
        tables.join("\n\n") + "\n"
    }

    /// What RRS gains over RRT with the same steps: the difference of each measure of a trial, paired by step
    /// and seed, with its 95% interval. Lengths and safety are those of trials that both solved.
    fn differences(&self) -> Table {
        let heads = MEASURES.iter().map(|m| format!("{}, {}", m.1, m.2));
        let mut table = Table::new(["world".into(), "difference".into()].into_iter().chain(heads));
        for world in WORLDS {
            for (planner, other) in PAIRS {
                let mut row = vec![world.to_owned(), format!("{} less {}", name(planner), name(other))];
                row.extend(
                    MEASURES.iter().map(|m| {
                        interval(&self.by_trial(world, [planner, other], |a, b| (m.3)(a) - (m.3)(b)))
                    }),
                );
                table.rows.push(row);
            }
        }
        table
    }

    /// How the edges of trees came about, per thousand samples, and the most and the least at any step that
    /// only a snake bent.
    fn edges(&self) -> Table {
        let heads = ["world", "planner", "straight", "bulge", "bulge, relaxed", "only a snake", "not bent"];
        let mut table = Table::new(heads);
        for world in WORLDS {
            for planner in PLANNERS.into_iter().filter(|planner| planner.starts_with("rrs")) {
                let mut row = vec![world.to_owned(), name(planner).to_owned()];
                row.extend([0, 1, 2, 3, 4].map(|k| spread(&self.over(&[world], planner, |s| s.edges[k]))));
                table.rows.push(row);
            }
        }
        table
    }

    /// Figures 5 to 9: each measure against the step, for each world.
    pub(super) fn charts(&self) -> Vec<(String, Result<String>)> {
        let mut charts = Vec::new();
        for world in WORLDS {
            for (file, title, y, of) in MEASURES {
                let curve = |(i, planner): (usize, &&str)| {
                    let at = |&step: &u32| Some((f64::from(step), of(&self.measures(world, planner, step)?)));
                    ChartCurve::new(name(planner), i, self.plan.steps.iter().filter_map(at).collect())
                };
                let others = ["rrs-bulge", "rrs-risk", "rrt-connect"];
                let shown = PLANNERS.iter().filter(|planner| !others.contains(planner));
                let curves: Vec<ChartCurve> = shown.enumerate().map(curve).collect();
                let title = format!("{world}: {title}");
                charts.push((
                    format!("{world}-{file}"),
                    chart(
                        Labels { title: &title, x: "Δq, cm", y },
                        [Axis::Even, Axis::FromZero(None)],
                        &curves,
                    ),
                ));
            }
        }
        charts.extend(self.averages());
        charts
    }

    /// Figure 9: the averages of safety and time in each world over all steps, with their 95% intervals over
    /// the trials.
    fn averages(&self) -> Vec<(String, Result<String>)> {
        let shown = MEASURES.into_iter().filter(|measure| ["safety", "time"].contains(&measure.0));
        let average = |(file, title, y, of): Measure| {
            let of_planner = |planner: &str| {
                let height = |world: &&str| {
                    let (mean, half) = mean_and_half(&self.by_trial(world, [planner; 2], |one, _| of(one)));
                    (mean, mean - half, mean + half)
                };
                Bars { name: name(planner).to_owned(), heights: WORLDS.iter().map(height).collect() }
            };
            let all = ["rrt", "rrs", "rrs-hybrid"].map(of_planner);
            let title = format!("Average {title}");
            (format!("average-{file}"), bars(Labels { title: &title, x: "", y }, &WORLDS, &all))
        };
        shown.map(average).collect()
    }

    /// For each trial the mean over all steps of a value of two planners' runs, where both have one. Runs of
    /// a trial have the same seed, and in random worlds the same world, so they are not independent:
    /// intervals are over trials.
    fn by_trial(
        &self,
        world: &str,
        planners: [&str; 2],
        value: impl Fn(&Measures, &Measures) -> f64,
    ) -> Vec<f64> {
        let of_trial = |trial| {
            let at = |&step: &u32| {
                let [a, b] = planners.map(|planner| {
                    let case = Case { world: world.into(), planner: planner.into(), step, trial };
                    Measures::of(planner, &[self.log.get(&case)?])
                });
                Some(value(&a?, &b?)).filter(|v| v.is_finite())
            };
            mean(self.plan.steps.iter().filter_map(at))
        };
        (0..self.plan.trials).filter_map(of_trial).collect()
    }
}

/// The name of a planner in charts.
fn name(planner: &str) -> &'static str {
    match planner {
        "rrt" => "RRT",
        "rrs" => "RRS",
        "rrs-hybrid" => "hybrid (ours)",
        "rrs-bulge" => "bulges (ours)",
        "rrs-paper" => "RRS, field=paper (eq. 3)",
        "rrs-risk" => "RRS, field=risk",
        "rrt-upto" => "RRT, up to Δq",
        "rrs-upto" => "RRS, up to Δq",
        _ => "RRT-Connect, up to Δq",
    }
}

/// The columns of how many edges came about in which way.
const EDGES: [&str; 5] = ["straight", "bulge", "relaxed_bulge", "snake", "not_bent"];

/// The planners whose trials are compared one by one: RRS, and RRT with the same steps.
const PAIRS: [(&str, &str); 7] = [
    ("rrs", "rrt"),
    ("rrs", "rrs-hybrid"),
    ("rrs-hybrid", "rrt"),
    ("rrs-bulge", "rrt"),
    ("rrs-paper", "rrt"),
    ("rrs-risk", "rrt"),
    ("rrs-upto", "rrt-upto"),
];

/// The mean, and half of its 95% interval; NaN without values.
fn mean_and_half(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = mean(values.iter().copied()).unwrap_or(f64::NAN);
    let spread = values.iter().map(|v| mp_math::powi(v - mean, 2)).sum::<f64>() / (n - 1.0).max(1.0);
    (mean, 1.96 * (spread / n).sqrt())
}

/// The mean with its 95% interval, by the normal distribution: there are thousands of values.
pub(super) fn interval(values: &[f64]) -> String {
    let (mean, half) = mean_and_half(values);
    if mean.is_nan() {
        return "–".into();
    }
    let digits = if half < 0.0995 {
        3
    } else if half < 0.995 {
        2
    } else {
        1
    };
    format!("{mean:.digits$} ± {half:.digits$}")
}

/// The mean, with the least and the greatest value.
fn spread(values: &[f64]) -> String {
    let known: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if known.is_empty() {
        return "–".into();
    }
    let show = |v: f64| {
        format!(
            "{v:.*}",
            if v.abs() < 9.95 {
                2
            } else if v.abs() < 99.5 {
                1
            } else {
                0
            }
        )
    };
    let (low, high) =
        known.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    format!("{} ({} – {})", show(finite_mean(known.into_iter())), show(low), show(high))
}

/// The values of RRS and RRT in §5 of the paper.
const PAPER: &[(&str, &str, &str, &str)] = &[
    ("maze", "accepted", "65 at 30 cm", "below 50 at 30 cm"),
    ("maze", "iterations", "about 8 up to 100 cm", "double, more beyond"),
    ("maze", "converged", "96 – 100", "down to 70"),
    ("maze", "length", "slightly shorter", ""),
    ("low", "accepted", "mean 67.1, above 50", "best 18.8"),
    ("low", "iterations", "mean 2", "mean 52"),
    ("low", "converged", "100", "100 down to 5"),
    ("low", "length", "mean 555", "mean 733"),
    ("high", "accepted", "above 50", "best 13.2"),
    ("high", "iterations", "3.4 – 18.5", "42.0 – 99.6"),
    ("high", "converged", "97 – 100", "down to 1 beyond 65 cm"),
    ("high", "length", "best 1087", "best 1229"),
    ("random", "accepted", "above 40 at some Δq", "below 5"),
    ("random", "iterations", "below 70 mostly", "above 70"),
    ("random", "converged", "75 – 82", "below 44"),
    ("random", "length", "shorter, stable", ""),
    ("maze", "safety", "greater", ""),
    ("low", "safety", "greater", ""),
    ("high", "safety", "greater", ""),
    ("random", "safety", "greater", ""),
    ("maze", "time", "less", ""),
    ("low", "time", "less", ""),
    ("high", "time", "less", ""),
    ("random", "time", "less", ""),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_summed_up() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = Log::open(&folder.path().join("runs.jsonl"), 5000.0, false).unwrap();
        let plan = Plan { trials: 2, steps: vec![30, 60] };
        for case in plan.cases() {
            let solved = case.trial == 0 || case.planner == "rrs";
            let iterations = if solved { 1000 } else { 5000 };
            let seconds = if case.planner == "rrs" { 2e-3 } else { 4e-3 };
            let run =
                Run { solved, seconds, iterations, nodes: 501, length: 5.0, safety: 0.02, ..Run::default() };
            log.learn([(case, run)]);
        }
        let results = Results { log: &log, plan: &plan };
        let measures = results.measures("low", "rrs", 30).unwrap();
        assert_eq!((measures.accepted, measures.iterations, measures.converged), (50.0, 20.0, 100.0));
        assert_eq!(
            (measures.length, measures.safety, measures.time, measures.per_iteration),
            (500.0, 2.0, 2.0, 2.0)
        );
        let measures = results.measures("low", "rrt", 30).unwrap();
        assert_eq!((measures.iterations, measures.converged), (60.0, 50.0));
        assert!((measures.accepted - 100.0 / 6.0).abs() < 1e-9);
        assert_eq!(results.summary().rows.len(), 4 * 9);
        let each = results.each();
        assert_eq!((each.rows.len(), each.head.len()), (4 * 9 * 2 * 2, 15));
        let row =
            each.rows.iter().find(|row| row[..4] == ["low", "rrs", "60", "1"].map(String::from)).unwrap();
        assert_eq!(row[4..10], ["1", "1000", "500", "500", "2", "2"].map(String::from));
        assert_eq!([four_digits(1234.567), four_digits(0.000_123_46)], ["1235", "0.0001235"]);
        let text = results.markdown();
        // 2 µs by 4 ms in 3,000 iterations.
        assert!((results.per_iteration(&["low"], "rrt") - 8.0 / 6.0).abs() < 1e-9);
        assert!(text.contains("| low | 1.50 | 1.00 |"), "{text}");
        assert!(text.contains("mean 67.1") && text.contains("50.0 (50.0 – 50.0)"), "{text}");
        assert_eq!(results.charts().len(), 26);
        assert!(results.charts().iter().all(|(_, chart)| chart.is_ok()));
    }
}
