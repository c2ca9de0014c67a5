//! What one search leaves for the next one.

use super::{RefMesh, Search, axis};
use nalgebra::{Isometry3, Vector3};

/// What a search between two meshes leaves for the next one between the same two: triangles that were near, and an axis or a plane by which
/// the meshes were apart. Where they have not moved much, one of these decides again.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hint {
    /// The last triangles found to be too near.
    pub(super) near: Option<[u32; 2]>,
    /// A unit vector in the frame of the second mesh, from it to the first.
    pub(super) apart: Option<Vector3<f64>>,
    /// A plane in front of the second mesh, in its frame: its normal, and how far from the origin it is.
    pub(super) plane: Option<(Vector3<f64>, f64)>,
}

impl RefMesh {
    /// As [`at_least`](Self::at_least), where `hint` comes from the last call for the same two meshes, at other poses; it is changed
    /// for the next one. It does not change whether the answer is `Ok`, but may change which lower bound or which distance it has. Where the bound
    /// is less than `wanted`, a better one is looked for.
    ///
    /// # Errors
    /// As [`at_least`](Self::at_least).
    pub fn at_least_from(
        &self,
        pose_wa: &Isometry3<f64>,
        other: &RefMesh,
        pose_wb: &Isometry3<f64>,
        [enough, wanted]: [f64; 2],
        hint: &mut Hint,
    ) -> Result<f64, f64> {
        let Some(mut search) = self.search(pose_wa, other, pose_wb, enough) else { return Err(0.0) };
        (search.any, search.hint) = (true, *hint);
        let enough = search.best;
        let mut found = search.run();
        if found >= enough && found < wanted {
            // What was not looked at is all that there is.
            let passed = if search.passed < f64::INFINITY { search.passed } else { found };
            found = found.max(passed).max(search.by_axis(0.0, wanted));
        }
        *hint = search.hint;
        if found < enough { Err(found) } else { Ok(found) }
    }
}

impl Search<'_> {
    /// What the hint decides: the distance of its triangles where that is too small, or the gap along its axis where that is enough.
    pub(super) fn by_hint(&mut self) -> Option<f64> {
        let Hint { near, apart, .. } = self.hint;
        if let Some(near) = near.filter(|near| self.knows(*near)) {
            let distance = self.distance_of(near);
            if distance < self.best {
                self.best = distance;
                return Some(self.found());
            }
        }
        let gap = axis::gap(&self.a.corners, &self.b.corners, &self.pose_ab, apart?) - self.touching;
        (gap >= self.best).then_some(gap)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives;

    /// Along motions, hints change no decision, and what they say is true.
    #[test]
    fn hints_change_no_decision() {
        let meshes = [
            primitives::cuboid(0.4, 0.5, 0.9).unwrap(),
            primitives::torus(0.5, 0.1, 24, 12).unwrap(),
            primitives::sphere(0.3, 2).unwrap(),
        ];
        let trees = meshes.each_ref().map(RefMesh::new);
        let (mut near, mut apart, mut decided) = (0, 0, 0);
        for (i, a) in trees.iter().enumerate() {
            for b in &trees {
                let mut hint = Hint::default();
                for k in 0..200 {
                    let t = 0.02 * f64::from(k) + i as f64;
                    let shift = Vector3::new(
                        1.2 * mp_math::cos(t),
                        mp_math::sin(2.0 * t),
                        0.3 * mp_math::sin(7.0 * t),
                    );
                    let pose = Isometry3::new(shift, Vector3::new(t, 0.3 * t, -t));
                    let here = Isometry3::translation(0.1, 0.0, 0.2);
                    let enough = [0.3, 0.01][k as usize % 2];
                    let distance = a.clearance(&here, b, &pose, f64::INFINITY);
                    let mut search = a.search(&here, b, &pose, enough).unwrap();
                    search.hint = hint;
                    decided += u32::from(search.by_hint().is_some());
                    let found = a.at_least_from(&here, b, &pose, [enough, 0.5], &mut hint);
                    assert_eq!(found.is_ok(), a.at_least(&here, b, &pose, enough).is_ok());
                    match found {
                        Ok(bound) => {
                            assert!(enough <= bound && bound <= distance + 1e-12, "{bound} {distance}");
                            // Of convex bodies the bound that is wanted is found.
                            let is_convex = |mesh: &RefMesh| !std::ptr::eq(mesh, &trees[1]);
                            let found = bound >= distance.min(0.5) - 1e-6;
                            assert!(found || !(is_convex(a) && is_convex(b)), "{bound} {distance}");
                            apart += 1;
                        }
                        Err(found) => {
                            assert!(distance - 1e-12 <= found && found < enough, "{found} {distance}");
                            near += 1;
                        }
                    }
                }
            }
        }
        assert!(near > 300 && apart > 300 && decided > 500, "{near} {apart} {decided}");
        // Of other meshes, a hint is as good as none.
        let mut hint = Hint { near: Some([1_000_000, 1]), apart: Some(Vector3::z()), plane: None };
        let far = Isometry3::translation(3.0, 0.0, 0.0);
        assert!(trees[0].at_least_from(&far, &trees[2], &Isometry3::identity(), [0.1; 2], &mut hint).is_ok());
    }
}
