//! Reading the text of a path.

/// The rows of a path as it is written: a line with the number of rows, and perhaps of numbers in a row, then
/// the rows.
///
/// # Errors
/// When the text is not such a path.
pub fn rows_of(text: &str) -> Result<Vec<Vec<f64>>, String> {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let first = lines.next().ok_or("the path is empty")?;
    let head: Vec<usize> = first
        .split_whitespace()
        .map(|w| w.parse().map_err(|_| format!("`{w}` is no count")))
        .collect::<Result<_, _>>()?;
    let (count, width) = match head[..] {
        [count] => (count, 6),
        [count, width] => (count, width),
        _ => return Err(format!("`{first}` is no head of a path")),
    };
    let number = |w: &str| w.parse::<f64>().map_err(|_| format!("`{w}` is no number"));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split_whitespace().map(number).collect()).collect::<Result<_, _>>()?;
    match rows.len() == count && rows.iter().all(|row| row.len() == width) {
        true => Ok(rows),
        false => Err(format!("the path has not {count} rows of {width} numbers")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_have_one_count_or_two() {
        assert_eq!(rows_of("1\n0 1 2 3 4 5e-1\n").unwrap(), [[0.0, 1.0, 2.0, 3.0, 4.0, 0.5]]);
        assert_eq!(rows_of("2 2\n0 1\n\n2 3\n").unwrap(), [[0.0, 1.0], [2.0, 3.0]]);
        for bad in ["", "1\n0 1\n", "2 2\n0 1\n", "1 1\nx\n", "x\n", "1 2 3\n"] {
            assert!(rows_of(bad).is_err(), "{bad:?}");
        }
    }
}
