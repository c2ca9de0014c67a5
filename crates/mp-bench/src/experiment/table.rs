//! Tables, as Markdown and as comma-separated values.

use super::provenance;
use std::collections::BTreeMap;

/// The heading of a column, and the function that gives its cell for an item.
pub(crate) type Column<'a, T> = (&'a str, &'a dyn Fn(&T) -> String);

/// A table of text cells.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
    /// The commits at which the runs in it were made, and how many runs of each: empty where all is of now.
    pub(crate) commits: BTreeMap<String, usize>,
}

impl Table {
    /// A table with these headings and no rows.
    pub(crate) fn new(head: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let head = head.into_iter().map(Into::into).collect();
        Self { head, rows: Vec::new(), commits: BTreeMap::new() }
    }

    /// A table with a row for each of `items`.
    pub(crate) fn of<T>(items: impl IntoIterator<Item = T>, columns: &[Column<'_, T>]) -> Self {
        let mut table = Self::new(columns.iter().map(|(head, _)| *head));
        table.rows =
            items.into_iter().map(|item| columns.iter().map(|(_, cell)| cell(&item)).collect()).collect();
        table
    }

    /// The table, of runs that were made at these commits.
    pub(crate) fn made_at(self, commits: BTreeMap<String, usize>) -> Self {
        Self { commits, ..self }
    }

    pub(crate) fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |", cells.join(" | "));
        let rule: Vec<String> = self.head.iter().map(|_| "---".to_owned()).collect();
        let mut lines = vec![line(&self.head), line(&rule)];
        lines.extend(self.rows.iter().map(|row| line(row)));
        lines.join("\n")
    }

    /// The table as comma-separated values.
    pub(crate) fn csv(&self) -> String {
        let quote = |cell: &str| match cell.contains([',', '"', '\n']) {
            true => format!("\"{}\"", cell.replace('"', "\"\"")),
            false => cell.to_owned(),
        };
        let line = |cells: &[String]| cells.iter().map(|cell| quote(cell)).collect::<Vec<_>>().join(",");
        let lines = std::iter::once(&self.head).chain(&self.rows).map(|row| line(row) + "\n");
        lines.collect()
    }

    /// Reads comma-separated values; lines that begin with `#` are left out.
    pub(crate) fn parse(text: &str) -> Self {
        let mut lines = text.lines().filter(|line| !line.starts_with('#')).map(cells);
        let mut table = Self::new(lines.next().unwrap_or_default());
        table.rows.extend(lines);
        table
    }

    /// The cells of a column, by its heading.
    pub(crate) fn column(&self, head: &str) -> Option<impl Iterator<Item = &str>> {
        let at = self.head.iter().position(|name| name == head)?;
        Some(self.rows.iter().map(move |row| row.get(at).map_or("", String::as_str)))
    }

    /// The comma-separated values as a file: before them, in lines that begin with `#`, what made them.
    pub(crate) fn csv_file(&self) -> String {
        let head = provenance::lines(self).into_iter().map(|(name, text)| format!("# {name}: {text}\n"));
        head.collect::<String>() + &self.csv()
    }
}

/// The cells of a line of comma-separated values; those with commas are in quotes.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match (c, cells.last_mut()) {
            ('"', _) => quoted = !quoted,
            (',', _) if !quoted => cells.push(String::new()),
            (c, Some(cell)) => cell.push(c),
            (_, None) => {}
        }
    }
    cells
}

/// A boolean as a table cell: 1 or 0.
pub(crate) fn bit(yes: bool) -> String {
    u8::from(yes).to_string()
}

/// The tables in Markdown, under headings of this level.
pub(crate) fn sections<T: std::fmt::Display>(level: usize, parts: &[(T, Table)]) -> String {
    let part =
        |(title, table): &(T, Table)| format!("{} {title}\n\n{}\n", "#".repeat(level), table.markdown());
    parts.iter().map(part).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables() {
        let mut table = Table::new(["a", "b"]);
        table.rows.push(vec!["1,5".into(), "x".into()]);
        let same = Table::of(["1,5"], &[("a", &|v| (*v).to_owned()), ("b", &|_| "x".to_owned())]);
        assert_eq!((&same.head, &same.rows), (&table.head, &table.rows));
        assert_eq!(table.csv(), "a,b\n\"1,5\",x\n");
        let read = Table::parse(&format!("# commit: x\n{}", table.csv()));
        assert_eq!((&read.head, &read.rows), (&table.head, &table.rows));
        assert!(read.column("b").unwrap().eq(["x"]) && read.column("c").is_none());
        assert_eq!(table.markdown(), "| a | b |\n| --- | --- |\n| 1,5 | x |");
        assert_eq!(sections(2, &[("T", table)]), "## T\n\n| a | b |\n| --- | --- |\n| 1,5 | x |\n");
    }
}
