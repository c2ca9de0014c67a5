//! Headline numbers of the pages of results, computed again from the raw results beside them.

#![cfg(test)]

use crate::experiment::{Table, mean};
use std::collections::BTreeMap;
use std::path::Path;

/// A file below `docs/results`.
fn read(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/results");
    std::fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Raw results: for each row the cells of these columns.
fn rows<const N: usize>(name: &str, columns: [&str; N]) -> Vec<[String; N]> {
    let table = Table::parse(&read(&format!("data/{name}.csv")));
    let mut columns = columns
        .map(|column| table.column(column).unwrap_or_else(|| panic!("{name}.csv has no column {column}")));
    let row = |_| std::array::from_fn(|i| columns[i].next().unwrap().to_owned());
    (0..table.rows.len()).map(row).collect()
}

/// Asserts that the page says this, wherever its lines break.
fn says(page: &str, text: &str) {
    let one_line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(one_line(&read(page)).contains(&one_line(text)), "{page} does not say: {text}");
}

fn number(cell: &str) -> f64 {
    cell.parse().unwrap_or_else(|_| panic!("`{cell}` is no number"))
}

#[test]
fn numbers_of_rsrt_are_those_of_the_raw_results() {
    let runs = rows("rsrt-clutter", ["model", "planner", "solved"]);
    let solved = |model: &str, planner: &str| {
        runs.iter().filter(|[m, p, solved]| m == model && p == planner && solved == "1").count()
    };
    let of = runs.iter().filter(|[m, p, _]| m == "velocities" && p == "rrt").count();
    let [a, b] = ["rrt", "rsrt"].map(|planner| solved("velocities", planner));
    let [c, d] = ["rrt", "rsrt"].map(|planner| solved("positions", planner));
    let text = format!("ALG. 4 solves {a} of {of} problems and RSRT {b}; with positions {c} and {d}.");
    says("rsrt.md", &text);

    let runs = rows("rsrt-factorial", ["problem", "order", "accept", "solved"]);
    let is_empty = |problem: &str| problem.ends_with(", empty");
    let runs: Vec<_> = runs.iter().filter(|[problem, ..]| !is_empty(problem)).collect();
    let of = |order: &str, accept: &str| {
        let of_cell = runs.iter().filter(|[_, o, a, _]| o == order && a == accept);
        (of_cell.clone().filter(|[.., solved]| solved == "1").count(), of_cell.count())
    };
    let (alg4, all) = of("test-all", "nearer");
    let [sorted, any, rsrt] =
        [("sort-first", "nearer"), ("test-all", "any"), ("sort-first", "any")].map(|(o, a)| of(o, a).0);
    says(
        "rsrt.md",
        &format!(
            "{alg4} of {all} runs are solved by ALG. 4, {sorted} with sorting alone, {any} with any alone, and {rsrt} by RSRT"
        ),
    );

    let areas = rows("rsrt-expansion", ["moves", "start", "nodes", "most", "mean"]);
    let of = |moves: &str| {
        let such =
            areas.iter().filter(|[m, start, nodes, ..]| m == moves && start == "0.5 0.5" && nodes == "353");
        mean(such.map(|[.., most, mean]| number(most) / number(mean))).unwrap()
    };
    let [twenty, twenty_two] = ["four inputs, step 1/20", "four inputs, step 1/22"].map(of);
    says("rsrt.md", &format!("with four inputs of 1/20 of the side {twenty:.1} ("));
    says("rsrt.md", &format!("at 353 nodes, of 1/22 {twenty_two:.1}"));
}

#[test]
fn numbers_of_rrs_are_those_of_the_raw_results() {
    let runs = rows("rrs", ["world", "planner", "step_cm", "solved", "iterations", "accepted"]);
    // For each world, planner and step: trials, trials solved, iterations and nodes accepted.
    let mut sums: BTreeMap<[&str; 3], [f64; 4]> = BTreeMap::new();
    for [world, planner, step, solved, iterations, accepted] in &runs {
        let sum = sums.entry([world, planner, step]).or_default();
        let of_run = [1.0, number(solved), number(iterations), number(accepted)];
        sum.iter_mut().zip(of_run).for_each(|(sum, value)| *sum += value);
    }
    let over_steps = |world: &str, planner: &str, of: fn(&[f64; 4]) -> f64| {
        let such = sums.iter().filter(|([w, p, _], _)| *w == world && *p == planner);
        mean(such.map(|(_, sum)| 100.0 * of(sum))).unwrap()
    };
    let accepted = |planner| over_steps("high", planner, |sum| sum[3] / sum[2]);
    let text = format!("in `high` {:.1}% in the mean against {:.1}%", accepted("rrs"), accepted("rrt"));
    says("rrs.md", &text);
    let solved = |planner| over_steps("maze", planner, |sum| sum[1] / sum[0]);
    says("rrs.md", &format!("in the maze {:.0} against {:.0}% in the mean", solved("rrs"), solved("rrt")));

    let driven = rows("rrs-follow", ["path", "executed"]);
    let collisions = |path: &str| driven.iter().filter(|[p, m]| p == path && number(m) <= 0.0).count();
    let [relaxed, found, rrt] = ["rrs relaxed", "rrs", "rrt relaxed"].map(collisions);
    says(
        "rrs.md",
        &format!("{relaxed} of 300 collide with RRS relaxed on the landscape of risk, {found} as found"),
    );
    says("rrs.md", &format!("but RRT relaxed is as safe ({rrt} of 300)"));
}

#[test]
fn numbers_of_roadmaps_are_those_of_the_raw_results() {
    let solved = |experiment: &str, generation: &str| {
        let runs = rows(experiment, ["checks", "generation", "connection", "solved"]);
        let such = runs.iter().filter(|[checks, made, connection, _]| {
            checks == "certified" && made == generation && connection != "turns where far"
        });
        such.filter(|[.., solved]| solved == "1").count()
    };
    let [free, uniform, contact] =
        ["obprm free", "uniform", "obprm contact"].map(|made| solved("roadmaps-contact", made));
    let text = format!(
        "its free nodes solve {free} of 140 runs, uniform samples {uniform}; its contact nodes {contact}"
    );
    says("roadmaps.md", &text);
    let [salvaged, alone] = ["uniform, salvaged", "uniform"].map(|made| solved("roadmaps-geometry", made));
    says("roadmaps.md", &format!("{salvaged} of 140 against {alone}, interval of the difference"));
    let runs = rows("roadmaps-ends", ["scene", "generation", "solved"]);
    let alpha = |generation: &str| {
        let such = runs.iter().filter(|[scene, made, _]| scene == "alpha-1.5" && made == generation);
        such.filter(|[.., solved]| solved == "1").count()
    };
    assert_eq!(["gaussian", "prm", "obprm free"].map(alpha), [0; 3]);
    says("roadmaps.md", &format!("Gaussian samples with them {} of 20", alpha("gaussian, trees")));
}
