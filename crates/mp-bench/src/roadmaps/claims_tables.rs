//! The experiments on the paper's claims, as tables.

use super::claims::{
    CERTIFIED, Case, Cell, Experiment, FAR, GEOMETRY, METRICS, NEAREST, Plan, Run, SALVAGED, UNIFORM,
    WITH_TREES, connections, generations,
};
use crate::experiment::{Log, Table, bootstrap, geometric_mean, mean, short, wilson_percent};

/// The runs, for summaries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Results<'a> {
    pub(super) log: &'a Log<Case, Run>,
    pub(super) plan: &'a Plan,
}

/// Two cells that differ in one thing: before and after.
type Pair = [Cell; 2];

/// What a change brings, with 95% intervals by the bootstrap over scenes and seeds.
struct Change {
    /// The runs solved after less those before, percentage points.
    solved: [f64; 3],
    /// The queries before : after.
    queries: [f64; 3],
}

impl Change {
    fn cells(&self) -> [String; 2] {
        let ([mid, low, high], [ratio, least, most]) = (self.solved, self.queries);
        // No minus before zero.
        let points = |v: f64| format!("{:+.1}", (10.0 * v).round() / 10.0 + 0.0).replace('-', "−");
        [
            format!("{} ({} – {})", points(mid), points(low), points(high)),
            format!("{ratio:.2} ({least:.2} – {most:.2})"),
        ]
    }
}

/// A count, with its Wilson interval in percent.
fn share(k: usize, n: usize) -> String {
    if n == 0 {
        return "–".into();
    }
    format!("{k} of {n} ({})", wilson_percent(k, n))
}

fn solved(runs: &[&Run]) -> usize {
    runs.iter().filter(|run| run.solved).count()
}

impl<'a> Results<'a> {
    fn run(&self, cell: &Cell, scene: &str, seed: u64) -> Option<&'a Run> {
        self.log.get(&cell.case(scene, seed))
    }

    /// The scenes and seeds.
    fn units(&self) -> impl Iterator<Item = (&'a str, u64)> {
        let plan = self.plan;
        plan.scenes.iter().flat_map(|scene| (1..=plan.seeds).map(move |seed| (scene.as_str(), seed)))
    }

    fn runs(&self, cells: &[Cell], scene: Option<&str>) -> Vec<&'a Run> {
        let units = self.units().filter(|(name, _)| scene.is_none_or(|scene| scene == *name));
        units
            .flat_map(|(scene, seed)| cells.iter().filter_map(move |cell| self.run(cell, scene, seed)))
            .collect()
    }

    /// The queries of a run, those of a run that was cut short being the budget.
    fn queries(&self, run: &Run) -> f64 {
        let most = self.plan.budget as f64;
        if run.solved { (run.queries as f64).clamp(1.0, most) } else { most }
    }

    /// What changing each pair's first cell to its second brings: the mean over the pairs of a scene and
    /// seed, then over scenes and seeds. `None` without runs.
    fn change(&self, pairs: &[Pair], scene: Option<&str>) -> Option<Change> {
        let units = self.units().filter(|(name, _)| scene.is_none_or(|scene| scene == *name));
        let unit = |(scene, seed): (&str, u64)| {
            let both = pairs.iter().filter_map(|pair| {
                let [before, after] = [self.run(&pair[0], scene, seed)?, self.run(&pair[1], scene, seed)?];
                let points = 100.0 * (f64::from(u8::from(after.solved)) - f64::from(u8::from(before.solved)));
                Some((points, mp_math::ln(self.queries(before) / self.queries(after))))
            });
            let both: Vec<(f64, f64)> = both.collect();
            Some((mean(both.iter().map(|b| b.0))?, mean(both.iter().map(|b| b.1))?))
        };
        let units: Vec<(f64, f64)> = units.filter_map(unit).collect();
        let of = |value: fn(&(f64, f64)) -> f64| {
            let mean =
                |drawn: &[usize]| drawn.iter().map(|&i| value(&units[i])).sum::<f64>() / drawn.len() as f64;
            let (low, high) = bootstrap(units.len(), mean);
            [mean(&(0..units.len()).collect::<Vec<_>>()), low, high]
        };
        (!units.is_empty()).then(|| Change { solved: of(|u| u.0), queries: of(|u| u.1).map(mp_math::exp) })
    }

    fn changed(&self, pairs: &[Pair], scene: Option<&str>) -> [String; 2] {
        self.change(pairs, scene).map_or(["–".into(), "–".into()], |change| change.cells())
    }

    /// All cells of the experiment that `such` selects.
    fn cells(&self, such: impl Fn(&Cell) -> bool) -> Vec<Cell> {
        self.plan.experiment.cells().into_iter().filter(such).collect()
    }

    /// Pairs of cells of the experiment: what `from` gives for a cell, if it exists, and the cell.
    fn pairs(&self, from: impl Fn(&Cell) -> Option<Cell>) -> Vec<Pair> {
        let cells = self.plan.experiment.cells();
        let pair =
            |cell: &Cell| from(cell).filter(|before| cells.contains(before)).map(|before| [before, *cell]);
        cells.iter().filter_map(pair).collect()
    }

    /// The changes from the first of `levels` of a factor to each other one, in all cells that `among`
    /// selects and in which both exist, and how many runs each level solves.
    fn factor(
        &self,
        name: &str,
        levels: impl Iterator<Item = &'static str>,
        member: for<'c> fn(&'c mut Cell) -> &'c mut &'static str,
        among: impl Fn(&Cell) -> bool,
    ) -> Table {
        let mut table = Table::new([name, "solved", "nodes", "components", "mean s"]);
        table.head.extend(["solved, points", "queries, ratio"].map(str::to_owned));
        let mut levels = levels.peekable();
        let base = levels.peek().copied().unwrap_or_default();
        for level in levels {
            let is = |cell: &Cell| *member(&mut cell.clone()) == level && among(cell);
            let runs = self.runs(&self.cells(is), None);
            let pairs = self.pairs(|cell| {
                let mut before = *cell;
                *member(&mut before) = base;
                is(cell).then_some(before)
            });
            let mut row = vec![level.to_owned(), share(solved(&runs), runs.len())];
            row.extend(sizes(&runs));
            row.push(mean_seconds(&runs));
            match level == base {
                true => row.extend(["–".into(), "1".into()]),
                false => row.extend(self.changed(&pairs, None)),
            }
            table.rows.push(row);
        }
        table
    }

    /// The text of the experiment.
    pub(super) fn parts(&self) -> Vec<(String, Table)> {
        match self.plan.experiment {
            Experiment::Factorial => self.factorial(),
            Experiment::Geometry => vec![("Each part left out".into(), self.geometry())],
            Experiment::Contact => vec![("Discrete and certified checks".into(), self.contact())],
            Experiment::Ends => vec![("Trees from the ends".into(), self.ends())],
        }
    }

    fn factorial(&self) -> Vec<(String, Table)> {
        let connection = self.factor("connection", connections(), |cell| &mut cell.connection, |_| true);
        let generation = self.factor("generation", generations(), |cell| &mut cell.generation, |_| true);
        let metric = self.factor("metric", METRICS.into_iter(), |cell| &mut cell.metric, without_lengths);
        vec![
            ("Connection".into(), connection),
            ("Connection, for each generation: solved, points".into(), self.interaction(0)),
            ("Connection, for each generation: queries, ratio".into(), self.interaction(1)),
            ("Generation".into(), generation),
            ("Metric".into(), metric),
            ("Metric, for each scene".into(), self.metric_by_scene()),
        ]
    }

    /// What each way to connect brings with each way to make nodes, over all metrics.
    fn interaction(&self, which: usize) -> Table {
        let mut table = Table::new(["generation", "solved by k nearest"]);
        let others = || connections().filter(|connection| *connection != NEAREST);
        table.head.extend(others().map(str::to_owned));
        for generation in generations() {
            let nearest = self.cells(|cell| cell.generation == generation && cell.connection == NEAREST);
            let runs = self.runs(&nearest, None);
            let mut row = vec![generation.to_owned(), share(solved(&runs), runs.len())];
            row.extend(others().map(|connection| {
                let pairs = self.pairs(|cell| {
                    (cell.generation == generation && cell.connection == connection)
                        .then_some(Cell { connection: NEAREST, ..*cell })
                });
                let [points, ratio] = self.changed(&pairs, None);
                if which == 0 { points } else { ratio }
            }));
            table.rows.push(row);
        }
        table
    }

    /// What the metric brings in each scene, over all ways to connect nodes, and those to make them that have
    /// no lengths.
    fn metric_by_scene(&self) -> Table {
        let mut table = Table::new(["scene"]);
        for metric in METRICS {
            table.head.push(format!("{metric}: solved"));
            if metric != METRICS[0] {
                table.head.extend([format!("{metric}: points"), "queries, ratio".to_owned()]);
            }
        }
        for scene in &self.plan.scenes {
            let mut row = vec![scene.clone()];
            for metric in METRICS {
                let runs = self
                    .runs(&self.cells(|cell| cell.metric == metric && without_lengths(cell)), Some(scene));
                row.push(share(solved(&runs), runs.len()));
                if metric != METRICS[0] {
                    let pairs = self.pairs(|cell| {
                        (cell.metric == metric && without_lengths(cell))
                            .then_some(Cell { metric: METRICS[0], ..*cell })
                    });
                    row.extend(self.changed(&pairs, Some(scene)));
                }
            }
            table.rows.push(row);
        }
        table
    }

    /// What is lost without each part of obstacle-geometry PRM, and what salvage brings.
    fn geometry(&self) -> Table {
        let mut table = Table::new(["planner", "solved", "nodes", "components", "against", "solved, points"]);
        table.head.push("queries, ratio".to_owned());
        for cell in self.plan.experiment.cells() {
            let runs = self.runs(&[cell], None);
            let name = if cell.generation == GEOMETRY && cell.connection == NEAREST {
                "no turns where far".to_owned()
            } else {
                cell.generation.to_owned()
            };
            let before = match cell.generation {
                SALVAGED => Cell::of(UNIFORM, NEAREST),
                _ => Cell::of(GEOMETRY, FAR),
            };
            let mut row = vec![name, share(solved(&runs), runs.len())];
            row.extend(sizes(&runs));
            if cell == before {
                row.extend(["–", "–", "1"].map(str::to_owned));
            } else {
                row.push(before.generation.to_owned());
                row.extend(self.changed(&[[before, cell]], None));
            }
            table.rows.push(row);
        }
        table
    }

    /// OBPRM under motion checks of both kinds.
    fn contact(&self) -> Table {
        let mut table = Table::new([
            "generation",
            "checks",
            "a path is found",
            "solved: it is verified",
            "solved, points",
            "queries, ratio",
            "first path fails the verification",
            "paths that fail it",
            "mean s",
        ]);
        for cell in self.plan.experiment.cells() {
            let runs = self.runs(&[cell], None);
            // A run that found a path solved the problem, or its path was rejected.
            let found = runs.iter().filter(|run| run.rejected > 0 || run.solved).count();
            let mut row = vec![cell.generation.to_owned(), cell.checks.to_owned()];
            row.extend([found, solved(&runs)].map(|k| share(k, runs.len())));
            match cell.checks == CERTIFIED {
                true => row.extend(["–".into(), "1".into()]),
                false => row.extend(self.changed(&[[Cell { checks: CERTIFIED, ..cell }, cell]], None)),
            }
            // The first path that a run finds fails when the verifier rejects any at all.
            let failed = runs.iter().filter(|run| run.rejected > 0).count();
            let paths: u64 = runs.iter().map(|run| run.rejected).sum();
            row.push(share(failed, found));
            row.push(format!("{paths} of {}", paths + solved(&runs) as u64));
            row.push(mean_seconds(&runs));
            table.rows.push(row);
        }
        table
    }

    /// What trees from start and goal bring with each way to make nodes.
    fn ends(&self) -> Table {
        let mut table =
            Table::new(["generation", "solved", "with trees", "solved, points", "queries, ratio"]);
        table.head.extend(["mean s", "with trees: mean s"].map(str::to_owned));
        for names in WITH_TREES {
            let pair = names.map(|name| Cell::of(name, NEAREST));
            let [without, with] = pair.map(|cell| self.runs(&[cell], None));
            let mut row = vec![names[0].to_owned()];
            row.extend([&without, &with].map(|runs| share(solved(runs), runs.len())));
            row.extend(self.changed(&[pair], None));
            row.extend([&without, &with].map(|runs| mean_seconds(runs)));
            table.rows.push(row);
        }
        table
    }

    /// The runs solved in each scene, a row for each cell.
    pub(super) fn by_scene(&self) -> Table {
        let cells = self.plan.experiment.cells();
        let various =
            |member: fn(&Cell) -> &'static str| cells.iter().any(|cell| member(cell) != member(&cells[0]));
        type Member = (&'static str, fn(&Cell) -> &'static str);
        let members: [Member; 3] =
            [("generation", |c| c.generation), ("connection", |c| c.connection), ("checks", |c| c.checks)];
        let members: Vec<Member> = members.into_iter().filter(|(_, member)| various(*member)).collect();
        let mut table = Table::new(members.iter().map(|(name, _)| *name));
        table.head.extend(self.plan.scenes.iter().cloned());
        // Metrics share a row.
        let metrics: Vec<&str> =
            METRICS.into_iter().filter(|m| cells.iter().any(|cell| cell.metric == *m)).collect();
        for cell in cells.iter().filter(|cell| cell.metric == metrics[0]) {
            let mut row: Vec<String> = members.iter().map(|(_, member)| member(cell).to_owned()).collect();
            row.extend(self.plan.scenes.iter().map(|scene| {
                let count = |metric: &&'static str| {
                    let runs = self.runs(&[Cell { metric, ..*cell }], Some(scene));
                    if runs.is_empty() { "–".to_owned() } else { solved(&runs).to_string() }
                };
                metrics.iter().map(count).collect::<Vec<_>>().join(" / ")
            }));
            table.rows.push(row);
        }
        table
    }

    /// The Wilson intervals of counts, to read the other tables with.
    pub(super) fn intervals(&self) -> String {
        let n = self.plan.seeds as usize;
        let of = |i: usize| format!("{}: {}", i * n / 4, wilson_percent(i * n / 4, n));
        let counts = (0..=4).map(of).collect::<Vec<_>>().join(", ");
        format!("Of {n} runs, with 95% Wilson intervals: {counts}.")
    }
}

/// Whether the nodes of a cell do not depend on the metric: lengths, as the distance of the pairs of Gaussian
/// sampling, are measured in it.
fn without_lengths(cell: &Cell) -> bool {
    !["gaussian", "bridge", "obprm free", "obprm shells"].contains(&cell.generation)
}

/// The mean processor time of runs, solved or not.
fn mean_seconds(runs: &[&Run]) -> String {
    mean(runs.iter().map(|run| run.seconds)).map_or("–".into(), short)
}

/// The geometric means of nodes and of components.
fn sizes(runs: &[&Run]) -> [String; 2] {
    let of = |value: fn(&Run) -> usize| {
        let values = runs.iter().map(|run| value(run).max(1) as f64);
        geometric_mean(values).map_or("–".into(), short)
    };
    [of(|run| run.nodes), of(|run| run.components)]
}

#[cfg(test)]
mod tests {
    use super::super::claims::{CHECKS, STAGED};
    use super::*;

    fn plan(experiment: Experiment) -> Plan {
        Plan { experiment, budget: 1_000, seeds: 8, scenes: vec!["a".to_owned(), "b".to_owned()] }
    }

    fn results(plan: &Plan, run: impl Fn(&Cell, &str, u64) -> Run) -> (tempfile::TempDir, Log<Case, Run>) {
        let folder = tempfile::tempdir().unwrap();
        let mut log = Log::open(&folder.path().join("runs.jsonl"), 1e3, false).unwrap();
        for cell in plan.experiment.cells() {
            for scene in &plan.scenes {
                let seeds = 1..=plan.seeds;
                log.learn(seeds.map(|seed| (cell.case(scene, seed), run(&cell, scene, seed))));
            }
        }
        (folder, log)
    }

    const RUN: Run =
        Run { solved: true, seconds: 0.5, nodes: 50, components: 4, queries: 400, motions: 50, rejected: 0 };

    #[test]
    fn each_factor_is_told_from_the_others() {
        let plan = plan(Experiment::Factorial);
        // Staged takes half of the queries, the Euclidean metric twice as many; only `gaussian` is cut short
        // in `b`.
        let (_folder, log) = results(&plan, |cell, scene, seed| {
            let factor = if cell.connection == STAGED { 0.5 } else { 1.0 }
                * if cell.metric == METRICS[1] { 2.0 } else { 1.0 };
            let solved = cell.generation != "gaussian" || scene == "a";
            Run { solved, queries: (factor * (300.0 + seed as f64 * 4.0)) as u64, ..RUN }
        });
        let results = Results { log: &log, plan: &plan };
        let parts = results.parts();
        let row = |part: usize, name: &str| {
            let row = parts[part].1.rows.iter().find(|row| row[0] == name).unwrap();
            row[1..].join(" | ")
        };
        // 16 runs of each cell; 24 cells, of which three (one for each metric) solve half of them.
        assert_eq!(row(0, NEAREST), "360 of 384 (91–96%) | 50.00 | 4.00 | 0.5000 | – | 1");
        let staged = row(0, STAGED);
        // Runs that are cut short before and after count as equal: 15 of 16 pairs in log 2.
        assert!(staged.contains("| +0.0 (+0.0 – +0.0) | 1.9"), "{staged}");
        assert!(row(4, METRICS[1]).ends_with("| 0.50 (0.50 – 0.50)"), "{}", row(4, METRICS[1]));
        assert!(row(4, METRICS[2]).ends_with("| 1.00 (1.00 – 1.00)"));
        let gaussian = row(3, "gaussian");
        assert!(gaussian.starts_with("72 of 144 (42–58%)") && gaussian.contains("| −50.0 (−"), "{gaussian}");
        assert!(row(1, "uniform").contains("| – | +0.0"), "{}", row(1, "uniform"));
        assert!(row(2, "obprm free").contains("2.00 (2.00 – 2.00)"));
        assert_eq!(row(5, "b").split(" | ").nth(2), Some("+0.0 (+0.0 – +0.0)"));
        let each = results.by_scene();
        assert_eq!(each.rows.len(), 8 * 4 - 3);
        assert_eq!(each.rows[3].join(" | "), "gaussian | k nearest | 8 / 8 / 8 | 0 / 0 / 0");
    }

    #[test]
    fn parts_are_compared_with_the_whole_and_first_paths_are_counted() {
        let of = plan(Experiment::Geometry);
        let (_folder, log) = results(&of, |cell, _, seed| {
            let solved = cell.generation != "no volume" || seed > 4;
            Run { solved, queries: if cell.generation == SALVAGED { 100 } else { 400 }, ..RUN }
        });
        let table = Results { log: &log, plan: &of }.geometry();
        let row = |name: &str| table.rows.iter().find(|row| row[0] == name).unwrap()[1..].join(" | ");
        assert_eq!(row(GEOMETRY), "16 of 16 (81–100%) | 50.00 | 4.00 | – | – | 1");
        assert!(row("no volume").contains("8 of 16 (28–72%) | 50.00 | 4.00 | obstacle geometry | −50.0 (−"));
        assert!(row(SALVAGED).ends_with("| uniform | +0.0 (+0.0 – +0.0) | 4.00 (4.00 – 4.00)"));
        assert!(row("no turns where far").contains("| obstacle geometry | +0.0"));

        let of = plan(Experiment::Contact);
        let (_folder, log) = results(&of, |cell, scene, seed| {
            // Discrete: a quarter of the first paths fail, twice each; `b` is not solved with certified
            // checks.
            let discrete = cell.checks != CERTIFIED;
            let rejected = if discrete && seed % 4 == 0 { 2 } else { 0 };
            Run { solved: discrete || scene == "a", rejected, ..RUN }
        });
        let results = Results { log: &log, plan: &of };
        let table = results.contact();
        assert_eq!(table.rows.len(), 5 * CHECKS.len());
        assert_eq!(table.rows[0][2..5], ["8 of 16 (28–72%)", "8 of 16 (28–72%)", "–"]);
        assert!(table.rows[1][4].starts_with("+50.0 (+"), "{}", table.rows[1][4]);
        assert_eq!(table.rows[1][6..8], ["4 of 16 (10–49%)", "8 of 24"]);
        assert_eq!(table.rows[0][6..8], ["0 of 8 (0–32%)", "0 of 8"]);
        assert_eq!(results.by_scene().head, ["generation", "checks", "a", "b"]);
        assert_eq!(results.intervals().matches('%').count(), 6);
    }
}
