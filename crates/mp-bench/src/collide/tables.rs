//! Tables of the results.

use super::ours::{OURS, TreeBuild};
use super::pair_results::PairResults;
use super::record::TimedAnswers;
use crate::experiment::{Table, geometric_mean};

/// Nanoseconds per query of each library, and the ratio to ours.
pub(crate) fn speed(all: &[PairResults], query: &str, chosen: impl Fn(&str) -> bool) -> Table {
    let asked = || all.iter().flat_map(|m| &m.records).map(|r| &r.what).filter(|what| what.query == query);
    let others = asked().map(|what| &*what.lib).filter(|lib| *lib != OURS && chosen(lib));
    let (libs, sets) = (distinct(others), distinct(asked().map(|what| &*what.set)));
    let mut table = Table::new(["pair", "poses", OURS].into_iter().chain(libs.iter().copied()));
    let mut ratios = vec![Vec::new(); libs.len()];
    for m in all {
        for set in &sets {
            let Some(ours) = m.record(OURS, set, query) else { continue };
            let mut row = vec![m.pair.clone(), (*set).to_owned(), digits(ours.least)];
            for (lib, ratios) in libs.iter().zip(&mut ratios) {
                row.push(m.record(lib, set, query).map_or("–".into(), |r| {
                    let ratio = r.least / ours.least;
                    ratios.push(ratio);
                    format!("{} ({ratio:.1}×)", digits(r.least))
                }));
            }
            table.rows.push(row);
        }
    }
    if !libs.is_empty() {
        let means = ratios.iter().map(|r| geometric_mean(r.iter().copied()));
        table.rows.push(last_row("geometric mean", means));
        table.rows.push(last_row("least", ratios.iter().map(|r| r.iter().copied().reduce(f64::min))));
    }
    table
}

/// The items without repetitions, in the order in which they first come.
fn distinct<T: PartialEq>(items: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut all = Vec::new();
    items.into_iter().for_each(|item| {
        if !all.contains(&item) {
            all.push(item)
        }
    });
    all
}

fn last_row(name: &str, ratios: impl Iterator<Item = Option<f64>>) -> Vec<String> {
    let row = [name.to_owned(), String::new(), String::new()];
    row.into_iter().chain(ratios.map(|r| r.map_or("–".into(), |r| format!("{r:.1}×")))).collect()
}

/// Milliseconds to build both trees.
pub(crate) fn build_times(all: &[PairResults]) -> Table {
    builds(all, |b, own, _| {
        format!(
            "{:.2}{}",
            b.ms,
            if b.lib == OURS { String::new() } else { format!(" ({:.1}×)", b.ms / own.ms) }
        )
    })
}

/// Bytes per triangle of both trees.
pub(crate) fn memory(all: &[PairResults]) -> Table {
    builds(all, |b, _, triangles| match b.bytes {
        0 => "–".into(),
        bytes => format!("{:.0}", bytes as f64 / triangles as f64),
    })
}

/// A table of the builds; `cell` takes the build of a library, ours, and the number of triangles.
fn builds(all: &[PairResults], cell: impl Fn(&TreeBuild, &TreeBuild, usize) -> String) -> Table {
    let built = all.iter().flat_map(|m| &m.builds).map(|build| &*build.lib);
    let libs = distinct([OURS].into_iter().chain(built));
    let mut table = Table::new(["pair", "triangles"].into_iter().chain(libs.iter().copied()));
    for m in all {
        let of = |lib: &str| m.builds.iter().find(|b| b.lib == lib);
        let Some(own) = of(OURS) else { continue };
        let mut row = vec![m.pair.clone(), m.triangles.to_string()];
        row.extend(libs.iter().map(|lib| of(lib).map_or("–".into(), |b| cell(b, own, m.triangles))));
        table.rows.push(row);
    }
    table
}

/// The numbers of answers of each library that differ from ours.
pub(crate) fn agreement(all: &[PairResults]) -> Table {
    let mut table = Table::new([
        "library",
        "query",
        "answers",
        "differ from ours",
        "largest relative difference",
        "where",
    ]);
    let asked = all.iter().flat_map(|m| &m.records).map(|r| (&*r.what.lib, &*r.what.query));
    for (lib, query) in distinct(asked.filter(|(lib, _)| *lib != OURS)) {
        let (mut count, mut differ, mut largest, mut places) = (0, 0, 0.0_f64, Vec::new());
        for m in all {
            for record in m.records.iter().filter(|r| r.what.lib == lib && r.what.query == query) {
                let Some((n, d, l)) = m.differences(record) else { continue };
                (count, differ, largest) = (count + n, differ + d, largest.max(l));
                if d > 0 {
                    places.push(format!("{} {}: {d}", m.pair, record.what.set));
                }
            }
        }
        let largest = if query == "distance" { format!("{largest:.1e}") } else { "–".into() };
        let row =
            [lib.into(), query.into(), count.to_string(), differ.to_string(), largest, places.join(", ")];
        table.rows.push(row.to_vec());
    }
    table
}

/// A row for every library, pair, set and query.
pub(crate) fn each(all: &[PairResults]) -> Table {
    let of = |m: &PairResults, r: &TimedAnswers| m.differences(r).unwrap_or((0, 0, 0.0));
    Table::of(
        all.iter().flat_map(|m| m.records.iter().map(move |r| (m, r))),
        &[
            ("lib", &|(_, r)| r.what.lib.clone()),
            ("pair", &|(m, _)| m.pair.clone()),
            ("set", &|(_, r)| r.what.set.clone()),
            ("query", &|(_, r)| r.what.query.clone()),
            ("answers", &|(_, r)| r.answers.len().to_string()),
            ("median_ns", &|(_, r)| format!("{:.1}", r.median())),
            ("least_ns", &|(_, r)| format!("{:.1}", r.least)),
            ("differ", &|(m, r)| of(m, r).1.to_string()),
            ("relative_difference", &|(m, r)| format!("{:.1e}", of(m, r).2)),
        ],
    )
}

/// Whether `mp-collide` gives the same answers on all instruction sets.
pub(crate) fn consistent(all: &[PairResults]) -> bool {
    all.iter().all(|m| {
        let own = m.records.iter().filter(|r| is_ours(&r.what.lib));
        own.filter_map(|r| m.differences(r)).all(|(_, differ, _)| differ == 0)
    })
}

/// Whether a name is that of `mp-collide`, on any instruction set.
pub(crate) fn is_ours(lib: &str) -> bool {
    lib.strip_prefix(OURS).is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
}

fn digits(ns: f64) -> String {
    if ns < 100.0 { format!("{ns:.1}") } else { format!("{ns:.0}") }
}

#[cfg(test)]
mod tests {
    use super::super::record::QueryId;
    use super::*;

    fn record(lib: &str, set: &str, query: &str, ns: f64, answers: &[f64]) -> TimedAnswers {
        TimedAnswers {
            what: QueryId::new(lib, set, query),
            medians: vec![ns],
            least: ns,
            answers: answers.to_vec(),
        }
    }

    fn measured() -> PairResults {
        let records = vec![
            record("mp", "near", "collide", 50.0, &[1.0, 0.0, 1.0]),
            record("mp_scalar", "near", "collide", 200.0, &[1.0, 0.0, 1.0]),
            record("x", "near", "collide", 500.0, &[1.0, 1.0]),
            record("mp", "uniform", "collide", 100.0, &[0.0]),
            record("x", "uniform", "collide", 4000.0, &[0.0]),
            record("mp", "near", "distance", 1.0, &[0.0, 1.0, 2.0]),
            record("x", "near", "distance", 1.0, &[-1.0, 1.0 + 5e-13, 2.1]),
        ];
        let (pair, builds) = ("p".to_owned(), Vec::new());
        let mut m = PairResults { pair, triangles: 10, size: 1.0, builds, records };
        for (lib, ms, bytes) in [("mp", 2.0, 1000), ("mp", 1.0, 1000), ("x", 3.0, 0)] {
            m.built(TreeBuild { lib: lib.into(), ms, bytes });
        }
        m
    }

    #[test]
    fn ratios_and_their_geometric_mean() {
        let table = speed(&[measured()], "collide", |lib| !is_ours(lib));
        assert_eq!(table.head, ["pair", "poses", "mp", "x"]);
        assert_eq!(table.rows[0], ["p", "near", "50.0", "500 (10.0×)"]);
        assert_eq!(table.rows[1], ["p", "uniform", "100", "4000 (40.0×)"]);
        assert_eq!(table.rows[2], ["geometric mean", "", "", "20.0×"]);
        assert_eq!(table.rows[3], ["least", "", "", "10.0×"]);
        let table = speed(&[measured()], "collide", is_ours);
        assert_eq!(table.rows[1], ["p", "uniform", "100", "–"]);
        assert!(speed(&[measured()], "motion", |_| true).rows.is_empty());
    }

    #[test]
    fn differences_are_counted() {
        let table = agreement(&[measured()]);
        let row = |i: usize| table.rows[i].join(" ");
        assert_eq!(row(0), "mp_scalar collide 3 0 – ");
        assert_eq!(row(1), "x collide 3 1 – p near: 1");
        assert_eq!(row(2), "x distance 3 1 5.0e-2 p near: 1");
        assert!(consistent(&[measured()]));
        let mut wrong = measured();
        wrong.records[1].answers[0] = 0.0;
        assert!(!consistent(&[wrong]));
        assert_eq!(each(&[measured()]).rows.len(), 7);
    }

    #[test]
    fn builds_keep_the_fastest() {
        let table = build_times(&[measured()]);
        assert_eq!(table.head, ["pair", "triangles", "mp", "x"]);
        assert_eq!(table.rows, [["p", "10", "1.00", "3.00 (3.0×)"]]);
        assert_eq!(memory(&[measured()]).rows, [["p", "10", "100", "–"]]);
    }
}
