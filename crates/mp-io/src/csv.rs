//! Paths as comma-separated values, for spreadsheets and data frames.

use crate::error::{Error, ErrorKind};
use crate::number::Num;
use crate::text::Text;
use std::fmt::Write as _;

/// The rows of a path in comma-separated values: a first line of names is skipped, so are blank lines, and
/// all rows have as many numbers as the first.
///
/// # Errors
/// [`Error`] with the line and column.
pub fn parse_csv(file: &str, bytes: &[u8]) -> Result<Vec<Vec<f64>>, Error> {
    let text = Text::new(file, bytes, "path.md")?;
    let what = "one configuration: numbers separated by commas";
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let names = |cell: &str| cell.trim().parse::<f64>().is_err();
        if i == 0 && line.text.split(',').all(names) {
            continue;
        }
        let row = line.cells().map(|cell| text.number(cell, what)).collect::<Result<Vec<_>, _>>()?;
        if let Some(first) = rows.first()
            && first.len() != row.len()
        {
            let message = format!("configuration {} has {} numbers", rows.len() + 1, row.len());
            return Err(text
                .error(line, message)
                .expected(format!("{} numbers, as in the first", first.len())));
        }
        rows.push(row);
    }
    match rows.is_empty() {
        true => Err(text.error_at_end(what).with_kind(ErrorKind::Content)),
        false => Ok(rows),
    }
}

/// The rows as comma-separated values, below a line of `names` if there are any. Numbers have the fewest digits that
/// read back to the same bits.
#[must_use]
pub fn csv_text(names: &[String], rows: &[Vec<f64>]) -> String {
    let mut out = String::new();
    if !names.is_empty() {
        let _ = writeln!(out, "{}", names.join(","));
    }
    for row in rows {
        for (i, v) in row.iter().enumerate() {
            let _ = write!(out, "{}{}", if i > 0 { "," } else { "" }, Num(*v));
        }
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_read_back_below_their_names() {
        let rows = vec![vec![0.1, -2.0, 1e-9], vec![0.0, 3.5, 7.0]];
        let text = csv_text(&["x [m]".into(), "y [m]".into(), "yaw [rad]".into()], &rows);
        assert_eq!(text, "x [m],y [m],yaw [rad]\n0.1,-2,1e-9\n0,3.5,7\n");
        assert_eq!(parse_csv("p.csv", text.as_bytes()).unwrap(), rows);
        assert_eq!(parse_csv("p.csv", b" 1 , 2\r\n\r\n3,4\r\n").unwrap(), [[1.0, 2.0], [3.0, 4.0]]);
    }

    #[test]
    fn faults_have_their_place() {
        let fault = |text: &str| {
            let e = parse_csv("p.csv", text.as_bytes()).unwrap_err();
            (e.line(), e.column())
        };
        assert_eq!(fault("x,y\n1,2\n3\n"), (Some(3), Some(1)));
        assert_eq!(fault("1,2\n3,up\n"), (Some(2), Some(3)));
        assert_eq!(fault("1,2\n3,\n").0, Some(2));
        assert!(parse_csv("p.csv", b"x,y\n").is_err() && parse_csv("p.csv", b"").is_err());
        assert!(parse_csv("p.csv", b"1,nan\n").is_err());
    }
}
