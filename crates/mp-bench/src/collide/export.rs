//! Pairs and poses as files, for other programs.
//!
//! `DIR/data/PAIR.A.off` and `PAIR.B.off` are the meshes; `PAIR.poses.txt` has a pose on each line, nine
//! numbers of the rotation, row by row, and three of the translation; first the uniform poses, then those
//! near contact. `PAIR.edges.txt` has the poses of edges in the same form. All numbers are written so that
//! they read back to the same bits. `DIR/out` is for the answers of the programs.

use super::pairs::Pair;
use super::poses::QueryPoses;
use crate::error::Result;
use mp_plan::{make_folder, write_file};
use nalgebra::Isometry3;
use std::fmt::Write;
use std::path::Path;

/// Writes `pair` and `poses` into `folder`.
///
/// # Errors
/// When a file cannot be written.
pub(crate) fn export(folder: &Path, pair: &Pair, poses: &QueryPoses) -> Result<()> {
    let (data, answers) = (folder.join("data"), folder.join("out"));
    for (side, mesh) in [("A", &pair.a), ("B", &pair.b)] {
        let text = mp_io::off_text(mesh);
        write_file(&data.join(format!("{}.{side}.off", pair.name)), text.as_bytes())?;
    }
    let lines = text(poses.uniform.iter().chain(&poses.near));
    write_file(&data.join(format!("{}.poses.txt", pair.name)), lines.as_bytes())?;
    write_file(&data.join(format!("{}.edges.txt", pair.name)), text(&poses.edges).as_bytes())?;
    make_folder(&answers)
}

/// The text with one pose on each line.
fn text<'p>(poses: impl IntoIterator<Item = &'p Isometry3<f64>>) -> String {
    let mut out = String::new();
    for pose in poses {
        let rotation = pose.rotation.to_rotation_matrix();
        let rows = rotation.matrix().transpose();
        for number in rows.iter().chain(&pose.translation.vector) {
            let _ = write!(out, "{number:?} ");
        }
        out.pop();
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::pairs::tori;
    use super::super::poses::{Counts, EDGE, Meshes};
    use super::*;

    #[test]
    fn what_is_written_reads_back_to_the_same_bits() {
        let pair = tori("tori", 8).unwrap();
        let counts = Counts { uniform: 7, near: 8, edges: 2 };
        let poses = QueryPoses::new(&pair, &Meshes::new(&pair), counts, 1).unwrap();
        let dir = tempfile::tempdir().unwrap();
        export(dir.path(), &pair, &poses).unwrap();
        assert!(dir.path().join("out").is_dir());
        let data = dir.path().join("data");
        assert_eq!(mp_io::read_mesh(data.join("tori.A.off")).unwrap(), pair.a);
        assert_eq!(mp_io::read_mesh(data.join("tori.B.off")).unwrap(), pair.b);
        let read = |name: &str| -> Vec<Vec<f64>> {
            let text = std::fs::read_to_string(data.join(name)).unwrap();
            text.lines().map(|l| l.split(' ').map(|w| w.parse().unwrap()).collect()).collect()
        };
        let all: Vec<_> = poses.uniform.iter().chain(&poses.near).collect();
        let lines = read("tori.poses.txt");
        assert_eq!((lines.len(), read("tori.edges.txt").len()), (15, 2 * EDGE));
        for (line, pose) in lines.iter().zip(all) {
            assert_eq!(line[9..], *pose.translation.vector.as_slice());
            let r = pose.rotation.to_rotation_matrix();
            assert!((0..9).all(|k| line[k] == r[(k / 3, k % 3)]));
        }
    }
}
