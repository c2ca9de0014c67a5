//! `bench`: measurements, as Markdown on standard output and as CSV and JSON in a folder.

mod chart;
mod collide;
mod growth;
mod log;
mod planners;
mod rigid;
mod roadmaps;
mod rrs;
mod rsrt;
mod scaling;
mod stats;

pub(crate) use collide::{PAIRS, Processor, nanoseconds};

use crate::cli;
use crate::output::{note, print, write};
use miette::Result;

/// Runs a suite. True when it could be measured completely.
pub(crate) fn run(args: &cli::Bench) -> Result<bool> {
    match args.suite {
        cli::Suite::Collide => collide::run(args),
        cli::Suite::Planners => planners::run(args),
        cli::Suite::Rigid => rigid::run(args),
        cli::Suite::Rrs => rrs::run(args),
        cli::Suite::Rsrt => rsrt::run(args),
        cli::Suite::Roadmaps => roadmaps::run(args),
        cli::Suite::Scaling => growth::run(args),
    }
}

/// A table, to be printed and written.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    /// With these headings and no rows.
    pub(crate) fn new(head: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self { head: head.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// In Markdown.
    pub(crate) fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |", cells.join(" | "));
        let rule: Vec<String> = self.head.iter().map(|_| "---".to_owned()).collect();
        let mut lines = vec![line(&self.head), line(&rule)];
        lines.extend(self.rows.iter().map(|row| line(row)));
        lines.join("\n")
    }

    /// As comma-separated values.
    pub(crate) fn csv(&self) -> String {
        let quote = |cell: &str| match cell.contains([',', '"', '\n']) {
            true => format!("\"{}\"", cell.replace('"', "\"\"")),
            false => cell.to_owned(),
        };
        let line = |cells: &mut dyn Iterator<Item = &str>| cells.map(quote).collect::<Vec<_>>().join(",");
        let mut text = line(&mut self.head.iter().map(String::as_str));
        for row in &self.rows {
            text.push('\n');
            text.push_str(&line(&mut row.iter().map(String::as_str)));
        }
        text + "\n"
    }

    /// As a list of objects, one of each row; what reads as a number is one.
    pub(crate) fn json(&self) -> serde_json::Value {
        let value = |cell: &String| -> serde_json::Value {
            match cell.parse::<f64>() {
                Ok(number) if number.is_finite() => number.into(),
                _ => cell.as_str().into(),
            }
        };
        let row = |row: &Vec<String>| -> serde_json::Value {
            self.head.iter().cloned().zip(row.iter().map(value)).collect()
        };
        self.rows.iter().map(row).collect()
    }
}

/// Prints `summary` and writes it with `each`, one line per run, to the folder for results.
pub(crate) fn report(args: &cli::Bench, name: &str, summary: &Table, each: &Table) -> Result<()> {
    print(&summary.markdown())?;
    let markdown = args.out.join(format!("{name}.md"));
    write(&markdown, (summary.markdown() + "\n").as_bytes())?;
    let csv = args.out.join(format!("{name}.csv"));
    write(&csv, each.csv().as_bytes())?;
    note(&format!("written: {}, {}", markdown.display(), csv.display()));
    Ok(())
}

/// The median; `None` of nothing.
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    match n {
        0 => None,
        _ => Some(0.5 * (sorted[(n - 1) / 2] + sorted[n / 2])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0]), Some(2.5));
    }

    #[test]
    fn tables() {
        let mut table = Table::new(["a", "b"]);
        table.rows.push(vec!["1,5".into(), "x".into()]);
        assert_eq!(table.csv(), "a,b\n\"1,5\",x\n");
        assert_eq!(table.json(), serde_json::json!([{ "a": "1,5", "b": "x" }]));
        assert_eq!(table.markdown(), "| a | b |\n| --- | --- |\n| 1,5 | x |");
    }
}
