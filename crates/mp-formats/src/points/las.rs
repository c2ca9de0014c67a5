//! LAS, the point clouds of surveys (ASPRS LAS 1.0 to 1.4): whole numbers with a scale and an offset. LAZ is not read.

use super::{all, bytes_at, error, rows};
use crate::error::{Error, ErrorKind};
use mp_stop::Interrupt;
use nalgebra::Point3;

pub(super) fn read(file: &str, bytes: &[u8], interrupt: &mut Interrupt) -> Result<Vec<Point3<f64>>, Error> {
    if !bytes.starts_with(b"LASF") {
        return Err(error(file, 0, "the file does not begin with LASF"));
    }
    let [minor] = bytes_at(file, bytes, 25)?;
    let start = u32::from_le_bytes(bytes_at(file, bytes, 96)?) as usize;
    let [format] = bytes_at(file, bytes, 104)?;
    if format > 10 {
        return Err(Error::new(ErrorKind::Unsupported, file, "the points are compressed (LAZ)")
            .help("write them as LAS, as `las2las -i FILE.laz -o FILE.las` does"));
    }
    let row = usize::from(u16::from_le_bytes(bytes_at(file, bytes, 105)?));
    let few = u32::from_le_bytes(bytes_at(file, bytes, 107)?) as usize;
    let count = match few {
        0 if minor >= 4 => {
            usize::try_from(u64::from_le_bytes(bytes_at(file, bytes, 247)?)).unwrap_or(usize::MAX)
        }
        few => few,
    };
    if row < 12 {
        return Err(error(file, 105, format!("points of {row} bytes have no coordinates")));
    }
    let float = |at: usize| bytes_at(file, bytes, at).map(f64::from_le_bytes);
    let scale = [float(131)?, float(139)?, float(147)?];
    let offset = [float(155)?, float(163)?, float(171)?];
    let point = |row: &[u8]| {
        let mut point = Point3::origin();
        for k in 0..3 {
            point[k] = f64::from(i32::from_le_bytes(bytes_at(file, row, 4 * k)?)) * scale[k] + offset[k];
        }
        Ok(point)
    };
    all(file, rows(file, bytes, start, count, row)?.map(point), interrupt)
}

#[cfg(test)]
mod tests {
    use super::super::tests::read;

    fn file(minor: u8, format: u8) -> Vec<u8> {
        let mut bytes = vec![0; 375];
        let mut put = |at: usize, with: &[u8]| bytes[at..at + with.len()].copy_from_slice(with);
        put(0, b"LASF");
        put(24, &[1, minor]);
        put(96, &375_u32.to_le_bytes());
        put(104, &[format]);
        put(105, &20_u16.to_le_bytes());
        match minor {
            4 => put(247, &2_u64.to_le_bytes()),
            _ => put(107, &2_u32.to_le_bytes()),
        }
        for (k, at) in [131, 139, 147].into_iter().enumerate() {
            put(at, &0.5_f64.to_le_bytes());
            put(at + 24, &(10.0 * k as f64).to_le_bytes());
        }
        for point in [[2_i32, 4, 6], [-2, 0, 1]] {
            bytes.extend(point.iter().flat_map(|x| x.to_le_bytes()));
            bytes.extend([9; 8]);
        }
        bytes
    }

    #[test]
    fn points_have_a_scale_and_an_offset() {
        for (minor, format) in [(2, 0), (3, 3), (4, 6)] {
            let bytes = file(minor, format);
            assert_eq!(read("a.las", &bytes).unwrap(), [[1.0, 12.0, 23.0], [-1.0, 10.0, 20.5]]);
            for end in [0, 3, 100, 374, bytes.len() - 1] {
                assert!(read("a.las", &bytes[..end]).is_err(), "{end}");
            }
        }
        let error = read("a.las", &file(2, 131)).unwrap_err();
        assert!(error.to_string().contains("LAZ"), "{error}");
        let mut short = file(2, 0);
        short[105] = 3;
        assert!(read("a.las", &short).is_err());
    }
}
