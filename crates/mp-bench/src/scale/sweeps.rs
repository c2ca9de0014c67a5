//! Sweeps: items that do not depend on each other, handed out by each policy.

use super::{LATENCY_S, MESSAGE_S, RANKS};
use crate::clock::{nanoseconds, seconds_since};
use crate::error::Result;
use crate::experiment::{Table, mean, seconds, short};
use mp_cspace::Rng;
use mp_plan::Error;
use mp_ranks::{Items, Link, Options, Policy, Simulated, run, simulate, threads};

/// Measured runs of the papers' experiments, as the pages beside them publish them: name and table.
const TABLES: [(&str, &str); 4] = [
    ("RSRT, factorial", include_str!("../../../../docs/results/data/rsrt-factorial.csv")),
    ("RSRT, restarts", include_str!("../../../../docs/results/data/rsrt-restarts.csv")),
    ("roadmaps, factorial", include_str!("../../../../docs/results/data/roadmaps-factorial.csv")),
    ("RRS, a flying body", include_str!("../../../../docs/results/data/rrs-flying.csv")),
];

/// The policies, with their names in tables.
const POLICIES: [(Policy, &str); 4] = [
    (Policy::Blocks, "blocks"),
    (Policy::Shards, "shards"),
    (Policy::InOrder, "in order"),
    (Policy::DearestFirst, "dearest first"),
];

/// What the items of a sweep cost, in the order of its cases, seconds.
#[derive(Clone, Debug)]
pub(super) struct SweepCosts {
    pub(super) name: String,
    pub(super) each: Vec<f64>,
}

/// Those of the planning problems, and of the papers' experiments.
pub(super) fn all_costs(problems: Vec<f64>) -> Result<Vec<SweepCosts>> {
    let mut all = vec![SweepCosts { name: "planning problems".into(), each: problems }];
    for (name, table) in TABLES {
        let each = column_of(table, "seconds")
            .ok_or_else(|| Error::new(format!("the table of {name} has no column `seconds` of numbers")))?;
        all.push(SweepCosts { name: name.into(), each });
    }
    Ok(all)
}

/// The numbers in a column of comma-separated values, whose quoted cells have no quotes inside.
fn column_of(table: &str, column: &str) -> Option<Vec<f64>> {
    Table::parse(table).column(column)?.map(|cell| cell.parse().ok()).collect()
}

/// The costs of `items` items, drawn from measured ones with a seed, in the order of the measured: what is
/// alike lies together, as in a sweep.
fn drawn(costs: &[f64], items: usize, stream: u64) -> Vec<f64> {
    let mut rng = Rng::stream(1, stream);
    let mut rows: Vec<usize> = (0..items).map(|_| (rng.unit() * costs.len() as f64) as usize).collect();
    rows.sort_unstable();
    rows.into_iter().filter_map(|row| costs.get(row).copied()).collect()
}

/// The replays as tables, one for each sweep, and what messages cost here.
pub(super) fn text(costs: &[SweepCosts], items: usize) -> String {
    let mut parts = vec![format!(
        "{items} items drawn from each sweep (seed 1). A message takes {} ms, and the master {} µs for a result and the next item. Between threads here \
         its processor time was {} µs.",
        1e3 * LATENCY_S,
        1e6 * MESSAGE_S,
        short(1e6 * master_seconds())
    )];
    for (stream, sweep) in costs.iter().enumerate() {
        let most = sweep.each.iter().copied().fold(0.0, f64::max);
        let mean = mean(sweep.each.iter().copied()).unwrap_or(0.0);
        let measured = sweep.each.len();
        parts.push(format!(
            "**{}**: {measured} measured, mean {}, longest {}",
            sweep.name,
            seconds(mean),
            seconds(most)
        ));
        parts.push(table(&drawn(&sweep.each, items, stream as u64)).markdown());
    }
    parts.join("\n\n")
}

/// A row for each number of ranks: of each policy its efficiency, and makespan and load of the master of the
/// last.
fn table(costs: &[f64]) -> Table {
    let policies = POLICIES.iter().map(|(_, name)| (*name).to_owned());
    let rest = ["makespan, s", "of the ideal", "master load"].map(str::to_owned);
    let mut table =
        Table::new(["ranks".to_owned(), "items each".into()].into_iter().chain(policies).chain(rest));
    for ranks in RANKS {
        let all = POLICIES.map(|(policy, _)| simulate(costs, policy, ranks, LATENCY_S, MESSAGE_S));
        let [.., last] = all;
        let ideal = costs.iter().sum::<f64>() / ranks as f64;
        let efficiency = |of: Simulated| format!("{:.3}", of.efficiency);
        let mut row = vec![ranks.to_string(), (costs.len() / ranks).to_string()];
        row.extend(all.map(efficiency));
        row.extend([
            seconds(last.makespan_s),
            format!("{:.2}", last.makespan_s / ideal),
            format!("{:.4}", last.master_load),
        ]);
        table.rows.push(row);
    }
    table
}

/// What the master needs for an item without work, seconds of processor time: two ranks, here threads.
pub(super) fn master_seconds() -> f64 {
    const ITEMS: u64 = 50_000;
    let nothing = |_: u64, _: &mp_ranks::ItemContext| Ok(Vec::new());
    let mut links = threads(2).into_iter();
    let Some(master) = links.next() else { return 0.0 };
    std::thread::scope(|scope| {
        for link in links {
            scope.spawn(move || run(&link as &dyn Link, &Options::default(), None, &nothing));
        }
        let mut job = Items::new(0..ITEMS, |_, _, _| Ok(()));
        let began = nanoseconds();
        let _ = run(&master, &Options::default(), Some(&mut job), &nothing);
        seconds_since(began) / ITEMS as f64
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_tables_are_read() {
        let costs = all_costs(vec![1.0]).unwrap();
        let measured: Vec<usize> = costs.iter().map(|sweep| sweep.each.len()).collect();
        assert_eq!(measured, [1, 3520, 480, 4350, 480]);
        assert!(costs.iter().flat_map(|sweep| &sweep.each).all(|cost| *cost > 0.0 && *cost < 100.0));
        assert_eq!(column_of("a,b\n\"x, y\",2\nz,3", "b"), Some(vec![2.0, 3.0]));
        assert_eq!(column_of("a,b\nx,y", "b"), None);
    }

    #[test]
    fn items_are_drawn_in_order() {
        let costs: Vec<f64> = (0..100).map(f64::from).collect();
        let items = drawn(&costs, 5000, 3);
        assert!(items.is_sorted() && items.len() == 5000 && items == drawn(&costs, 5000, 3));
        let of = |cost: f64| items.iter().filter(|item| **item == cost).count();
        assert!(
            costs.iter().all(|cost| (15..=95).contains(&of(*cost))),
            "50 of each, and five deviations of 7"
        );
        assert_eq!(table(&items).rows.len(), RANKS.len());
    }
}
