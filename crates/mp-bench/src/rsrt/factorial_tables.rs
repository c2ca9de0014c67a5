//! The factorial experiment as tables and charts.

use super::factorial::{ACCEPTS, Case, FactorialProblem, ORDERS, Plan};
use crate::error::Result;
use crate::experiment::{Log, Median, Table, paired_ratio, seconds};
use crate::plot::{Axis, ChartCurve, Labels, chart};
use mp_experiments::clutter::Run;

/// An order and a condition.
type Corner = [&'static str; 2];

const ALG4: Corner = [ORDERS[0], ACCEPTS[0]];
const ALG4_ANY: Corner = [ORDERS[0], ACCEPTS[1]];
const SORTED: Corner = [ORDERS[1], ACCEPTS[0]];
const RSRT: Corner = [ORDERS[1], ACCEPTS[1]];
const CORNERS: [Corner; 4] = [ALG4, SORTED, ALG4_ANY, RSRT];

/// A change between two corners: its name, before, and after.
type Change = (&'static str, Corner, Corner);

const CHANGES: [Change; 5] = [
    ("sorting (nearer)", ALG4, SORTED),
    ("sorting (any)", ALG4_ANY, RSRT),
    ("accepting any (test all)", ALG4, ALG4_ANY),
    ("accepting any (sorted)", SORTED, RSRT),
    ("both: RSRT for ALG. 4", ALG4, RSRT),
];

/// A measure of a run that is solved.
type Measure = (&'static str, fn(&Run) -> f64);

const MEASURES: [Measure; 3] = [
    ("time", |run| run.seconds),
    ("collision checks", |run| run.checks as f64),
    ("iterations", |run| run.iterations as f64),
];

/// The runs, for summaries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Results<'a> {
    pub(super) log: &'a Log<Case, Run>,
    pub(super) plan: &'a Plan,
}

impl<'a> Results<'a> {
    fn problems(&self) -> impl Iterator<Item = &'a FactorialProblem> {
        self.plan.problems.iter().filter(|problem| !problem.empty)
    }

    fn runs(&self, problem: &str, inputs: usize, corner: Corner) -> Vec<&'a Run> {
        self.log.runs((1..=self.plan.seeds).map(|seed| Plan::case(problem, inputs, corner, seed)))
    }

    /// The ratio before : after of a measure, over the pairs of runs with the same problem and seed.
    fn gain(
        &self,
        problems: &[&FactorialProblem],
        inputs: usize,
        (_, before, after): Change,
        of: fn(&Run) -> f64,
    ) -> Option<(Median, usize)> {
        paired_ratio(problems.iter().flat_map(|problem| {
            (1..=self.plan.seeds).filter_map(move |seed| {
                let run = |corner| self.log.get(&Plan::case(problem.name, inputs, corner, seed));
                let value = |run: &Run| run.solved.then(|| of(run));
                Some((value(run(before)?), value(run(after)?)))
            })
        }))
    }

    fn cell(
        &self,
        problems: &[&FactorialProblem],
        inputs: usize,
        change: Change,
        of: fn(&Run) -> f64,
    ) -> String {
        let Some((median, used)) = self.gain(problems, inputs, change, of) else { return "–".into() };
        let number = |v: f64| match v {
            v if v == f64::INFINITY => "∞".to_owned(),
            v if v >= 9.95 => format!("{v:.0}"),
            v => format!("{v:.2}"),
        };
        format!("{} ({} – {}), {used}", number(median.median), number(median.low), number(median.high))
    }

    fn changes(
        &self,
        first: [&str; 2],
        rows: Vec<(String, String, Vec<&FactorialProblem>, usize)>,
        of: fn(&Run) -> f64,
    ) -> Table {
        let head = first.into_iter().filter(|h| !h.is_empty()).map(str::to_owned);
        let mut table = Table::new(head.chain(CHANGES.map(|change| change.0.to_owned())));
        for (a, b, problems, inputs) in rows {
            let names = [(first[0], a), (first[1], b)].into_iter().filter(|(head, _)| !head.is_empty());
            let cells = CHANGES.iter().map(|change| self.cell(&problems, inputs, *change, of));
            table.rows.push(names.map(|(_, name)| name).chain(cells).collect());
        }
        table
    }

    /// Which of the two changes brings what, at each number of inputs: over all problems with obstacles, a
    /// table for each measure.
    pub(super) fn headline(&self) -> Vec<(String, Table)> {
        let problems: Vec<_> = self.problems().collect();
        let rows = || {
            let row = |&inputs: &usize| (inputs.to_string(), String::new(), problems.clone(), inputs);
            self.plan.inputs.iter().map(row).collect()
        };
        MEASURES
            .map(|(name, of)| (format!("Ratio of {name}"), self.changes(["inputs", ""], rows(), of)))
            .into()
    }

    /// The same for each problem, a table for each measure.
    pub(super) fn by_problem(&self) -> Vec<(String, Table)> {
        let rows = || {
            let rows = self.problems().flat_map(|problem| {
                let row =
                    |&inputs: &usize| (problem.name.to_owned(), inputs.to_string(), vec![problem], inputs);
                self.plan.inputs.iter().map(row).collect::<Vec<_>>()
            });
            rows.collect()
        };
        let titled = |(name, of): Measure| {
            (format!("Ratio of {name}, by problem"), self.changes(["problem", "inputs"], rows(), of))
        };
        MEASURES.map(titled).into()
    }

    /// Solved runs and median times of the four corners.
    pub(super) fn corners(&self) -> Table {
        let mut table = Table::new(["problem", "inputs"]);
        table.head.extend(CORNERS.iter().map(|[order, accept]| format!("{order}, {accept}")));
        for problem in &self.plan.problems {
            for &inputs in &self.plan.inputs {
                let cells = CORNERS.iter().map(|corner| {
                    let runs = self.runs(problem.name, inputs, *corner);
                    let solved = runs.iter().filter(|run| run.solved).count();
                    let time =
                        Median::of(runs.iter().map(|r| if r.solved { r.seconds } else { f64::INFINITY }));
                    let time =
                        time.map_or("–".into(), |t| t.cell(&format!("> {}", self.plan.cap), seconds));
                    format!("{solved}/{}: {time}", runs.len())
                });
                let names = [problem.name.to_owned(), inputs.to_string()];
                table.rows.push(names.into_iter().chain(cells).collect());
            }
        }
        table
    }

    /// What each change brings, against the number of inputs.
    pub(super) fn charts(&self) -> Vec<(String, Result<String>)> {
        let problems: Vec<_> = self.problems().collect();
        let marks: Vec<f64> = self.plan.inputs.iter().map(|n| *n as f64).collect();
        let gains = MEASURES.map(|(name, of)| {
            let curves: Vec<ChartCurve> = CHANGES
                .iter()
                .enumerate()
                .map(|(i, change)| {
                    let known = self.plan.inputs.iter().filter_map(|&inputs| {
                        Some((inputs as f64, self.gain(&problems, inputs, *change, of)?.0))
                    });
                    let known: Vec<(f64, Median)> = known.collect();
                    // Sorting, accepting and both have a colour each; what they start from has a pattern.
                    let curve = ChartCurve::of_medians(change.0, i / 2, &known, f64::INFINITY);
                    curve.pattern(i % 2 + 2 * usize::from(i == 4))
                })
                .collect();
            let title = format!("Ratio of {name}, before : after a change, over all problems");
            let y = format!("ratio of {name}");
            let labels = Labels { title: &title, x: "inputs", y: &y };
            let file = format!("gain-{}", name.replace(' ', "-"));
            (file, chart(labels, [Axis::LogAt(&marks), Axis::Log], &curves))
        });
        let times = self.problems().map(|problem| {
            let curves: Vec<ChartCurve> = CORNERS
                .iter()
                .enumerate()
                .map(|(i, corner)| {
                    let known = self.plan.inputs.iter().filter_map(|&inputs| {
                        let runs = self.runs(problem.name, inputs, *corner);
                        let time = runs.iter().map(|r| if r.solved { r.seconds } else { f64::INFINITY });
                        Some((inputs as f64, Median::of(time)?))
                    });
                    let known: Vec<(f64, Median)> = known.collect();
                    ChartCurve::of_medians(corner.join(", "), i, &known, self.plan.cap).pattern(i)
                })
                .collect();
            let title = format!("{}: time to a path", problem.name);
            let labels = Labels { title: &title, x: "inputs", y: "s of processor time" };
            let name = problem.name.replace(", ", "-").replace(' ', "-").to_lowercase();
            (name, chart(labels, [Axis::LogAt(&marks), Axis::Log], &curves))
        });
        gains.into_iter().chain(times).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::factorial::PROBLEMS;
    use super::*;

    #[test]
    fn each_change_is_told_from_the_other() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = Log::open(&folder.path().join("runs.jsonl"), 6.0, false).unwrap();
        let plan = Plan { seeds: 9, inputs: vec![12, 48], problems: PROBLEMS[..4].to_vec(), cap: 6.0 };
        for case in plan.cases() {
            // Sorting makes four times fewer checks, accepting any two times fewer iterations.
            let (sorted, any) = (case.order == ORDERS[1], case.accept == ACCEPTS[1]);
            let iterations = if any { 100 } else { 200 } * case.seed;
            let checks = iterations * if sorted { 3 } else { 12 };
            let solved = any || case.inputs == 12 || case.seed > 8;
            let run = Run { solved, seconds: 1e-3 * checks as f64, iterations, checks, ..Run::default() };
            log.learn([(case, run)]);
        }
        let results = Results { log: &log, plan: &plan };
        let headline = results.headline();
        let row = |table: usize, row: usize| headline[table].1.rows[row].join(" | ");
        // Two problems with obstacles, nine seeds each.
        assert_eq!(
            row(1, 0),
            "12 | 4.00 (4.00 – 4.00), 18 | 4.00 (4.00 – 4.00), 18 | 2.00 (2.00 – 2.00), 18 | 2.00 (2.00 – 2.00), 18 | \
             8.00 (8.00 – 8.00), 18"
        );
        assert_eq!(row(2, 0).split(" | ").nth(1), Some("1.00 (1.00 – 1.00), 18"));
        // Cut short before, solved after: infinite; cut short in both: left out.
        assert_eq!(row(1, 1).split(" | ").nth(1), Some("4.00 (4.00 – 4.00), 2"));
        assert_eq!(row(1, 1).split(" | ").nth(3), Some("∞ (∞ – ∞), 18"));
        assert_eq!(results.by_problem()[0].1.rows.len(), 4);
        assert_eq!(results.corners().rows.len(), 8);
        let charts = results.charts();
        assert_eq!(charts.len(), 5);
        assert!(charts.iter().all(|(_, c)| c.as_ref().is_ok_and(|c| c.contains("<polyline"))));
    }
}
