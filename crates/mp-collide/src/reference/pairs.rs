//! Pairs of triangles that may touch.

use super::RefMesh;
use nalgebra::Isometry3;

impl RefMesh {
    /// Calls `visit` with every pair of triangles, of this mesh at `pose_wa` and of `other` at `pose_wb`, whose
    /// balls meet, and perhaps some more, until it returns `true`. Returns whether it did; `true` for bad input.
    ///
    /// Triangles that touch, or come as near as rounding of the poses, are always among them.
    pub fn any_near_pair(
        &self,
        pose_wa: &Isometry3<f64>,
        other: &RefMesh,
        pose_wb: &Isometry3<f64>,
        mut visit: impl FnMut(usize, usize) -> bool,
    ) -> bool {
        let Some(search) = self.search(pose_wa, other, pose_wb, 0.0) else { return true };
        let mut stack = vec![(self.root, other.root)];
        while let Some((i, j)) = stack.pop() {
            if search.bound(i, j) >= search.best {
                continue;
            }
            match search.split(i, j) {
                Ok(pairs) => stack.extend(pairs),
                Err([k, l]) if visit(k as usize, l as usize) => return true,
                Err(_) => {}
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives;

    #[test]
    fn no_pair_that_touches_is_left_out() {
        let mesh = primitives::sphere(0.5, 2).unwrap();
        let (a, n) = (RefMesh::new(&mesh), mesh.triangles().len());
        let turn = nalgebra::Vector3::new(0.3, 0.2, 0.1);
        for x in [0.0, 0.5, 0.9, 1.0, 3.0] {
            let (here, there) = (Isometry3::identity(), Isometry3::new([x, 0.1, 0.0].into(), turn));
            let mut seen = std::collections::BTreeSet::new();
            assert!(!a.any_near_pair(&here, &a, &there, |i, j| !seen.insert((i, j))));
            let touch = |i: usize, j: usize| {
                crate::triangle::intersect(&mesh.triangle(i), &mesh.triangle(j).map(|p| there * p))
            };
            let all = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            let touching: Vec<_> = all.filter(|&(i, j)| touch(i, j)).collect();
            assert!(touching.iter().all(|pair| seen.contains(pair)));
            assert!(seen.len() < n * n / 2 && touching.is_empty() == (x >= 1.0), "{x} {}", seen.len());
            assert!(touching.is_empty() || a.any_near_pair(&here, &a, &there, touch));
        }
    }
}
