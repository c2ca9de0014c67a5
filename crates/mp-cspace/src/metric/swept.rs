//! An approximate swept volume as a distance.

use super::Metric;
use crate::{Linear, Se2, Se2State, Se3, Space, SpaceError};
use nalgebra::{Isometry3, Point3, Vector3};

/// The approximate volume (m³) that a rigid body sweeps, beyond its own, on the straight motion from one pose
/// to another: the distance that best reflects how likely a local planner fails (Benitez et al. 2010, *Key
/// Elements for Motion Planning Algorithms*, §3.1), "rough but inexpensive".
///
/// Each triangle of the surface sweeps its area times the travel of its centre along its normal (the mean
/// over the normals at both ends); half of the triangles sweep outward: `½ Σ Aᵢ·|nᵢ·Δxᵢ|`. Exact for a convex
/// body that does not turn. Where it turns, parts of the surface that slide along themselves sweep nothing,
/// and chords replace arcs. The cost grows with the number of triangles, so give a coarse mesh.
///
/// Not a [`TrueMetric`](crate::TrueMetric): the triangle inequality does not hold, and different states may
/// be at distance zero (a ball that turns). Its nearest neighbours are found by [`Linear`](crate::Linear)
/// search.
#[derive(Clone, Debug, PartialEq)]
pub struct SweptVolume {
    /// Centre of each triangle, and its normal times its area.
    panels: Vec<(Vector3<f64>, Vector3<f64>)>,
    area: f64,
    radius: f64,
}

impl SweptVolume {
    /// The metric of the body with these triangles (m), in its own frame.
    ///
    /// # Errors
    /// When there is no triangle, or a corner is not finite.
    pub fn new(triangles: impl IntoIterator<Item = [Point3<f64>; 3]>) -> Result<Self, SpaceError> {
        let (mut panels, mut area, mut radius) = (Vec::new(), 0.0, 0.0_f64);
        for [a, b, c] in triangles {
            let normal = (b - a).cross(&(c - a)) * 0.5;
            let center = (a.coords + b.coords + c.coords) / 3.0;
            if !(normal.norm() + center.norm()).is_finite() {
                let name = "the distance of a corner from the origin";
                return Err(SpaceError::Weight { name, value: normal.norm() + center.norm() });
            }
            area += normal.norm();
            radius = radius.max(center.norm());
            panels.push((center, normal));
        }
        if panels.is_empty() {
            return Err(SpaceError::Empty { what: "the set of triangles" });
        }
        Ok(Self { panels, area, radius })
    }

    /// A bound on the distance of poses whose translations lie in a box with this diagonal (m).
    fn extent_of(&self, diagonal: f64) -> f64 {
        0.5 * self.area * (diagonal + 2.0 * self.radius)
    }

    fn swept(&self, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
        let [ra, rb] = [from, to].map(|q| *q.rotation.to_rotation_matrix().matrix());
        let shift = to.translation.vector - from.translation.vector;
        let swept = self.panels.iter().map(|(center, normal)| {
            let moved = rb * center - ra * center + shift;
            0.5 * ((ra * normal).dot(&moved).abs() + (rb * normal).dot(&moved).abs())
        });
        0.5 * swept.sum::<f64>()
    }
}

impl Metric<Se3> for SweptVolume {
    type Nn = Linear;

    fn distance(&self, _: &Se3, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
        self.swept(from, to)
    }
    fn extent(&self, space: &Se3) -> f64 {
        self.extent_of(space.translations().extent())
    }
}

impl Metric<Se2> for SweptVolume {
    type Nn = Linear;

    fn distance(&self, _: &Se2, from: &Se2State, to: &Se2State) -> f64 {
        self.swept(&from.to_isometry3(0.0), &to.to_isometry3(0.0))
    }
    fn extent(&self, space: &Se2) -> f64 {
        self.extent_of(space.translations().extent())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rng, WithMetric};
    use std::f64::consts::FRAC_PI_2;

    /// The sides of a box about the origin, each of `n` by `n` rectangles.
    fn sides(size: Vector3<f64>, n: u32) -> Vec<[Point3<f64>; 3]> {
        let mut triangles = Vec::new();
        for axis in 0..3 {
            for side in [-0.5, 0.5] {
                let at = |u: u32, v: u32| {
                    let mut p = Vector3::zeros();
                    p[axis] = side;
                    p[(axis + 1) % 3] = f64::from(u) / f64::from(n) - 0.5;
                    p[(axis + 2) % 3] = f64::from(v) / f64::from(n) - 0.5;
                    Point3::from(p.component_mul(&size))
                };
                for (u, v) in (0..n).flat_map(|u| (0..n).map(move |v| (u, v))) {
                    triangles.push([at(u, v), at(u + 1, v), at(u, v + 1)]);
                    triangles.push([at(u + 1, v + 1), at(u + 1, v), at(u, v + 1)]);
                }
            }
        }
        triangles
    }

    #[test]
    fn a_box_that_does_not_turn_sweeps_its_shadow() {
        let size = Vector3::new(1.0, 2.0, 3.0);
        let swept = SweptVolume::new(sides(size, 1)).unwrap();
        let from = Isometry3::identity();
        for (shift, volume) in
            [([2.0, 0.0, 0.0], 12.0), ([0.0, -1.0, 0.0], 3.0), ([1.0, 1.0, 1.0], 6.0 + 3.0 + 2.0)]
        {
            let to = Isometry3::translation(shift[0], shift[1], shift[2]);
            assert!((swept.swept(&from, &to) - volume).abs() < 1e-12);
            assert!((swept.swept(&to, &from) - volume).abs() < 1e-12);
        }
    }

    /// A rod turned about its middle sweeps two sectors whose radius is half its length. At a small angle
    /// chords are nearly arcs.
    #[test]
    fn a_rod_that_turns_sweeps_sectors() {
        let swept = SweptVolume::new(sides(Vector3::new(2.0, 1e-3, 0.5), 40)).unwrap();
        let (a, b) = (Se2State::new(3.0, 1.0, 0.4), Se2State::new(3.0, 1.0, 0.4 + 0.2));
        let sectors = 0.5 * 0.2 * mp_math::powi(1.0, 2) * 2.0 * 0.5;
        let found = swept.swept(&a.to_isometry3(0.0), &b.to_isometry3(0.0));
        assert!((found / sectors - 1.0).abs() < 0.02, "{found} {sectors}");
        // About its own axis the rod sweeps next to nothing.
        let roll = Isometry3::rotation(Vector3::x() * FRAC_PI_2);
        assert!(swept.swept(&Isometry3::identity(), &roll) < 0.5);
        let yaw = Isometry3::rotation(Vector3::z() * FRAC_PI_2);
        assert!(swept.swept(&Isometry3::identity(), &yaw) > 0.3);
    }

    #[test]
    fn no_two_states_are_farther_than_the_extent() {
        let swept = SweptVolume::new(sides(Vector3::new(1.0, 0.2, 0.6), 2)).unwrap();
        let space = WithMetric::new(Se3::new([-1.0; 3], [1.0; 3]).unwrap(), swept);
        let mut rng = Rng::seed(4);
        for _ in 0..500 {
            let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            let d = space.distance(&a, &b);
            assert!(d > 0.0 && d <= space.extent() && space.distance(&a, &a) == 0.0);
            assert!((space.distance(&b, &a) - d).abs() < 1e-12);
        }
        assert!(SweptVolume::new([]).is_err());
        assert!(SweptVolume::new([[Point3::new(f64::NAN, 0.0, 0.0); 3]]).is_err());
    }
}
