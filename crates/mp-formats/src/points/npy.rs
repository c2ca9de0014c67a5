//! Arrays of numpy, as `numpy.save` writes them: a row of floats for each point.

use super::{bytes_at, error, rows};
use crate::error::Error;
use crate::text::clipped;
use mp_stop::Interrupt;
use nalgebra::Point3;

/// Arrays of three or four rows with more columns than this are points by columns: no camera gives as many numbers for a point.
const MOST_COLUMNS: usize = 32;

pub(super) fn read(file: &str, bytes: &[u8], interrupt: &mut Interrupt) -> Result<Vec<Point3<f64>>, Error> {
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err(error(file, 0, "the file does not begin as one of numpy"));
    }
    let [major, _] = bytes_at(file, bytes, 6)?;
    let (length, from) = match major {
        1 => (usize::from(u16::from_le_bytes(bytes_at(file, bytes, 8)?)), 10),
        _ => (u32::from_le_bytes(bytes_at(file, bytes, 8)?) as usize, 12),
    };
    let head =
        bytes[from..].get(..length).ok_or_else(|| error(file, bytes.len(), "the file ends too early"))?;
    let head = String::from_utf8_lossy(head);
    let value = |name: &str| {
        let (_, rest) = head.split_once(&format!("'{name}':"))?;
        Some(rest.trim_start())
    };
    let expected = |what: &str| {
        let message =
            format!("the array is no row of floats for each point: {what} in `{}`", clipped(head.trim()));
        error(file, from, message)
            .expected("numpy.save of an array of float32 or float64 with the shape (n, 3)")
    };
    let kind =
        value("descr").and_then(|rest| rest.strip_prefix('\'')?.split_once('\'')).map(|(kind, _)| kind);
    let (size, big) = match kind {
        Some("<f4") => (4, false),
        Some("<f8") => (8, false),
        Some(">f4") => (4, true),
        Some(">f8") => (8, true),
        _ => return Err(expected("another type of numbers")),
    };
    let by_columns = value("fortran_order").is_some_and(|rest| rest.starts_with("True"));
    let shape = value("shape").and_then(|rest| rest.strip_prefix('(')?.split_once(')'));
    let shape: Option<Vec<usize>> = shape.and_then(|(sides, _)| {
        sides.split(',').map(str::trim).filter(|s| !s.is_empty()).map(|s| s.parse().ok()).collect()
    });
    let Some([count, columns]) = shape.as_deref().filter(|shape| shape.get(1) >= Some(&3)) else {
        return Err(expected("another shape"));
    };
    // A row of x, a row of y, a row of z, and perhaps one more.
    if (3..=4).contains(count) && *columns > MOST_COLUMNS {
        return Err(
            expected("a column for each point").help("save the array with its axes exchanged, array.T")
        );
    }
    let row = columns.checked_mul(size).ok_or_else(|| expected("too many columns"))?;
    let (rows, all) = (rows(file, bytes, from + length, *count, row)?, &bytes[from + length..]);
    let number = |bytes: &[u8]| -> Result<f64, Error> {
        Ok(match (size, big) {
            (4, false) => f32::from_le_bytes(bytes_at(file, bytes, 0)?).into(),
            (4, true) => f32::from_be_bytes(bytes_at(file, bytes, 0)?).into(),
            (_, false) => f64::from_le_bytes(bytes_at(file, bytes, 0)?),
            (_, true) => f64::from_be_bytes(bytes_at(file, bytes, 0)?),
        })
    };
    let point = |(i, row): (usize, &[u8])| {
        let mut point = Point3::origin();
        for (k, x) in point.iter_mut().enumerate() {
            *x = number(if by_columns { &all[(k * count + i) * size..] } else { &row[k * size..] })?;
        }
        Ok(point)
    };
    super::all(file, rows.enumerate().map(point), interrupt)
}

#[cfg(test)]
mod tests {
    use super::super::tests::read;

    fn array(head: &str, numbers: &[u8]) -> Vec<u8> {
        [b"\x93NUMPY\x01\x00", &(head.len() as u16).to_le_bytes()[..], head.as_bytes(), numbers].concat()
    }

    fn head(kind: &str, by_columns: &str, shape: &str) -> String {
        format!("{{'descr': '{kind}', 'fortran_order': {by_columns}, 'shape': {shape}, }}   \n")
    }

    #[test]
    fn arrays_of_all_kinds() {
        let numbers = [1.0, 2.0, 3.0, 4.0, 5.0, f64::NAN];
        let single: Vec<u8> = numbers.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect();
        let big: Vec<u8> = numbers.iter().flat_map(|x| x.to_be_bytes()).collect();
        let columns: Vec<u8> =
            [0, 3, 1, 4, 2, 5].iter().flat_map(|i: &usize| numbers[*i].to_le_bytes()).collect();
        for bytes in [
            array(&head("<f4", "False", "(2, 3)"), &single),
            array(&head(">f8", "False", "(2, 3)"), &big),
            array(&head("<f8", "True", "(2, 3)"), &columns),
        ] {
            let found = read("a.npy", &bytes).unwrap();
            assert!(found[0] == [1.0, 2.0, 3.0] && found[1][..2] == [4.0, 5.0] && found[1][2].is_nan());
            for end in [0, 7, 20, bytes.len() - 1] {
                assert!(read("a.npy", &bytes[..end]).is_err(), "{end}");
            }
        }
        assert_eq!(read("a.npy", &array(&head("<f4", "False", "(1, 6)"), &single)).unwrap().len(), 1);
    }

    #[test]
    fn arrays_of_something_else() {
        for (kind, shape) in [
            ("<i4", "(2, 3)"),
            ("|O", "(2, 3)"),
            ("<f4", "(3, 2)"),
            ("<f4", "(6,)"),
            ("<f4", "(1, 2, 3)"),
            ("<f4", "(99999999999999999, 3)"),
            ("<f4", ""),
        ] {
            let error = read("a.npy", &array(&head(kind, "False", shape), &[0; 24])).unwrap_err();
            assert!(error.to_string().contains("a.npy"), "{error}");
        }
        assert!(read("a.npy", &array(&head("<f4", "False", "(0, 3)"), &[])).is_err());
        for by_columns in ["False", "True"] {
            let turned = array(&head("<f4", by_columns, "(3, 100)"), &[0; 1200]);
            let error = read("a.npy", &turned).unwrap_err().to_string();
            assert!(error.contains("a column for each point"), "{error}");
        }
    }
}
