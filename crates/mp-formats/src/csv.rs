//! Paths as comma-separated values, for spreadsheets and data frames.

use crate::columns::{Column, Fault, HELP, Matching, is_index, nameless};
use crate::error::{Error, ErrorKind};
use crate::number::Num;
use crate::text::{Text, Token};
use std::fmt::Write as _;

/// The rows of a path in comma-separated values, and the meaning of their numbers. The first line may name the columns, in any order,
/// with units in which their numbers are (`elbow [deg]`): then the rows have the numbers `wanted`, in that order and in those units. A
/// first line of numbers names nothing. If nothing is `wanted`, rows are as in the file, and the columns are those that it names.
///
/// Cells are separated by commas, or all by semicolons or by tabs, and may be quoted. Blank lines are skipped, and all rows have as many
/// numbers as the first. A first column without a name, where the others have one, is the index of a data frame, and no part of a configuration.
///
/// # Errors
/// [`Error`] with the line and column: also when a name is unknown, missing or there twice, or a unit does not fit.
pub fn parse_csv(file: &str, bytes: &[u8], wanted: &[Column]) -> Result<(Vec<Column>, Vec<Vec<f64>>), Error> {
    let text = Text::new(file, bytes, "path.md")?;
    let what = "one configuration: numbers separated by commas";
    let mut lines = text.lines().peekable();
    let separator = lines.peek().map_or(',', |line| line.separator());
    let header = lines.peek().and_then(|line| header(*line, separator, wanted));
    let faulty = |line: Token<'_>, index: usize, fault: Fault| {
        let cell = fault.at.and_then(|at| line.cells_between(separator).nth(index + at)).unwrap_or(line);
        text.error(cell, fault.message).expected(fault.expected).help(HELP)
    };
    let mut columns = wanted.to_vec();
    let (mut names, mut index, mut matching) = (Vec::new(), 0, None);
    if let Some((line, cells)) = lines.peek().copied().zip(header) {
        lines.next();
        index = usize::from(is_index(&cells, wanted));
        names = cells;
        if wanted.is_empty() {
            let named = &names[index..];
            columns =
                if nameless(named) { Vec::new() } else { named.iter().map(|n| Column::named(n)).collect() };
        } else {
            let fault = |fault| faulty(line, index, fault);
            matching = Some(Matching::new(&names[index..], wanted).map_err(fault)?);
        }
    }
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut width = names.len();
    for line in lines {
        let cells = line.cells_between(separator).skip(index);
        let row = cells.map(|cell| text.number(cell, what)).collect::<Result<Vec<_>, _>>()?;
        if width == 0 {
            width = row.len();
        }
        if row.len() + index != width {
            let message = format!("configuration {} has {} numbers", rows.len() + 1, row.len());
            let expected = format!("{} numbers, as in the first line", width - index);
            return Err(text.error(line, message).expected(expected));
        }
        rows.push(match &matching {
            None => row,
            Some(matching) => matching.configuration(&row).map_err(|fault| faulty(line, index, fault))?,
        });
    }
    match rows.is_empty() {
        true => Err(text.error_at_end(what).with_kind(ErrorKind::Content)),
        false => Ok((columns, rows)),
    }
}

/// The names in a line of names: not all of its cells are numbers, and a cell that is a number is the name of a column. A line of numbers alone
/// is one of names if these are the names of all columns, at least three or in quotes: fewer may be a configuration.
fn header(line: Token<'_>, separator: char, wanted: &[Column]) -> Option<Vec<String>> {
    let cells = line.cells_between(separator);
    let names: Vec<String> = cells.map(|cell| cell.text.replace("\"\"", "\"")).collect();
    let is_number = |name: &String| name.parse::<f64>().is_ok();
    let all = names.len() == wanted.len() && wanted.iter().all(|w| names.contains(&w.name));
    if all && (names.len() > 2 || line.text.starts_with('"')) {
        return Some(names);
    }
    let is_name = |name: &String| !is_number(name) || wanted.iter().any(|w| w.name == *name);
    let unnamed = names.len() > 1 && names[0].is_empty() && nameless(&names[1..]);
    if names.iter().all(is_number) || !(unnamed || names.iter().all(is_name)) {
        return None;
    }
    // Tools of Python write the names as a comment.
    let mut names = names;
    if let Some(first) = line.text.strip_prefix('#').and(names[0].strip_prefix('#')) {
        names[0] = first.trim().to_owned();
    }
    Some(names)
}

/// The rows as comma-separated values, below a line of `names` if there are any. Numbers have the fewest digits that
/// read back to the same bits.
#[must_use]
pub fn csv_text(names: &[String], rows: &[Vec<f64>]) -> String {
    let mut out = String::new();
    let quoted = |name: &String| match name.starts_with(['#', '\u{feff}']) || name.contains([',', ';', '"']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.clone(),
    };
    if !names.is_empty() {
        let names = names.iter().map(|name| quoted(&name.replace(char::is_control, "_")));
        let _ = writeln!(out, "{}", names.collect::<Vec<_>>().join(","));
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

    fn columns() -> Vec<Column> {
        [("x", "m"), ("y", "m"), ("yaw", "rad")].map(|(n, u)| Column::new(n, u)).to_vec()
    }

    fn rows(text: &str) -> Vec<Vec<f64>> {
        parse_csv("p.csv", text.as_bytes(), &columns()).unwrap().1
    }

    #[test]
    fn rows_read_back_below_their_names() {
        let written = vec![vec![0.1, -2.0, 1e-9], vec![0.0, 3.5, 7.0]];
        let names: Vec<_> = columns().iter().map(ToString::to_string).collect();
        let text = csv_text(&names, &written);
        assert_eq!(text, "x [m],y [m],yaw [rad]\n0.1,-2,1e-9\n0,3.5,7\n");
        assert_eq!(rows(&text), written);
        assert_eq!(rows(&csv_text(&[], &written)), written);
        assert_eq!(rows(" 1 , 2,3\r\n\r\n3,4,5\r\n"), [[1.0, 2.0, 3.0], [3.0, 4.0, 5.0]]);
        // Whatever the names are, in any order of the columns.
        let odd =
            ["#a", "b,c", "j;k", "d\"e", "f\ng", "2", "h [deg]", " i"].map(|name| Column::new(name, "rad"));
        let header: Vec<_> = odd.iter().map(ToString::to_string).collect();
        let numbers = vec![vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]];
        let text = csv_text(&header, &numbers);
        let turned: Vec<_> = odd.iter().cloned().rev().collect();
        assert_eq!(parse_csv("p.csv", text.as_bytes(), &odd).unwrap(), (odd.to_vec(), numbers.clone()));
        let read = parse_csv("p.csv", text.as_bytes(), &turned).unwrap().1;
        assert_eq!(read, [[8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0]]);
        let one = [Column::new("j;k", "rad")];
        assert_eq!(
            parse_csv("p.csv", csv_text(&[one[0].to_string()], &[vec![1.0]]).as_bytes(), &one).unwrap().1,
            [[1.0]]
        );
        // A byte order mark that is a name is none of the file.
        let (marked, numbers) = parse_csv("p.csv", b" \xef\xbb\xbf ,\n \n3,4\r\n", &[]).unwrap();
        let names: Vec<_> = marked.iter().map(ToString::to_string).collect();
        let text = csv_text(&names, &numbers);
        assert_eq!(parse_csv("p.csv", text.as_bytes(), &[]).unwrap(), (marked, numbers));
    }

    #[test]
    fn names_say_what_the_numbers_are() {
        let half = std::f64::consts::FRAC_PI_2;
        for text in [
            "yaw,x,y\n1.5707963267948966,1,2\n",
            "\u{feff}yaw [deg],x [mm],y [cm]\r\n90,1000,200\r\n",
            "# yaw_deg, x, y\n90, 1, 2\n",
            "\"yaw (deg)\",\"x (m)\",\"y (m)\"\n\"90\",\"1\",\"2\"\n",
            ",y,x,yaw [deg]\n0,2,1,90\n",
            "index,y,x,yaw [deg]\n2026-01-01 00:00,2,1,90\n",
            ",0,1,2\n0,1,2,1.5707963267948966\n",
            "1,2,1.5707963267948966\n",
            "yaw [deg];x;\"y\"\n90;1;2\n",
            "x\tyaw\ty\r\n1\t1.5707963267948966\t2\r\n",
            "1;2;1.5707963267948966\n",
        ] {
            assert_eq!(rows(text), [[1.0, 2.0, half]], "{text}");
        }
        // Joints may be named by numbers.
        let numbered = ["1", "2", "tool"].map(|name| Column::new(name, "rad"));
        assert_eq!(parse_csv("p.csv", b"tool,2,1\n3,4,5\n", &numbered).unwrap().1, [[5.0, 4.0, 3.0]]);
        let numbered = ["1", "2", "3"].map(|name| Column::new(name, "rad"));
        for text in ["3,1,2\n6,4,5\n", "\"3\";\"1\";\"2\"\n6;4;5\n"] {
            assert_eq!(
                parse_csv("p.csv", text.as_bytes(), &numbered).unwrap().1,
                [[4.0, 5.0, 6.0]],
                "{text}"
            );
        }
        let read = |text: &str| parse_csv("p.csv", text.as_bytes(), &numbered[..2]).unwrap().1;
        assert_eq!(read("\"2\",\"1\"\n5,4\n"), [[4.0, 5.0]]);
        assert_eq!(read("2,1\n5,4\n"), [[2.0, 1.0], [5.0, 4.0]]);
        // Without a robot, they are as the file says.
        let (named, read) = parse_csv("p.csv", b",b [deg],a\n0,1,2\n", &[]).unwrap();
        assert_eq!(
            (named, read),
            (vec![Column::new("b", "deg"), Column::new("a", "")], vec![vec![1.0, 2.0]])
        );
        assert!(parse_csv("p.csv", b"1,2\n3,4\n", &[]).unwrap().0.is_empty());
    }

    #[test]
    fn faults_have_their_place() {
        let fault = |text: &str| {
            let e = parse_csv("p.csv", text.as_bytes(), &columns()).unwrap_err();
            (e.line(), e.column())
        };
        assert_eq!(fault("x,y,yaw\n1,2,3\n3\n"), (Some(3), Some(1)));
        assert_eq!(fault("x,y,yaw\n1,2\n1,2\n"), (Some(2), Some(1)));
        assert_eq!(fault("1,2\n3,up\n"), (Some(2), Some(3)));
        assert_eq!(fault("1,2\n3,\n").0, Some(2));
        assert_eq!(fault("1,O.5\n3,4\n"), (Some(1), Some(3)));
        assert_eq!(fault("x,y,pitch\n1,2,3\n"), (Some(1), Some(5)));
        assert_eq!(fault("x,y,y\n1,2,3\n"), (Some(1), Some(5)));
        assert_eq!(fault(",x,y,yaw [m]\n0,1,2,3\n"), (Some(1), Some(6)));
        assert_eq!(fault("x,y\n1,2\n"), (Some(1), Some(1)));
        assert_eq!(fault("x,y,\"yaw\n1,2,3\n"), (Some(1), Some(5)));
        assert_eq!(fault("exported by a tool\nx,y,yaw\n1,2,3\n"), (Some(1), Some(1)));
        for text in ["x,y,yaw\n", "", "1,nan\n", "x;y;yaw\n1,5;2;3\n", "x y yaw\n1 2 3\n"] {
            assert!(parse_csv("p.csv", text.as_bytes(), &columns()).is_err(), "{text}");
        }
    }
}
