//! Few balls around a mesh: what they keep apart needs no search.

use super::{Content, Node, RefMesh, Search, cuboid::Cuboid};
use nalgebra::{Isometry3, Point3};

/// Balls are those so far below the root of the tree: at most sixteen.
pub(super) const DEPTH: u32 = 4;

impl RefMesh {
    /// A ball around the mesh: its center and its radius.
    #[must_use]
    pub fn around(&self) -> (Point3<f64>, f64) {
        let mut made = None;
        let root = self.ball(self.root, &mut made);
        (root.center, root.radius)
    }

    /// Whether it is nothing but [balls](mp_geom::TriMesh::balls).
    #[must_use]
    pub fn is_balls(&self) -> bool {
        self.is_balls
    }

    /// A lower bound (m) on the distance of this mesh at `pose` from a ball: that of the box around it. At most 0 where the ball overlaps
    /// the box.
    #[must_use]
    pub fn distance_bound(&self, pose: &Isometry3<f64>, center: &Point3<f64>, radius: f64) -> f64 {
        let p = pose.inverse_transform_point(center);
        let size = self.size + p.coords.norm() + pose.translation.vector.norm();
        self.box_distance(&p) - radius - super::TOUCHING * (size + radius)
    }

    /// The distance of a point from the box around the mesh; 0 inside.
    fn box_distance(&self, p: &Point3<f64>) -> f64 {
        self.cuboid_around().way_to(p).map_or(0.0, |way| way.norm())
    }

    /// The box around the mesh.
    pub(super) fn cuboid_around(&self) -> Cuboid {
        let mut made = None;
        let root = self.ball(self.root, &mut made);
        Cuboid { middle: root.center, half: root.half }
    }

    /// The balls `depth` below the root, and those above without balls below them.
    pub(super) fn balls_of_depth(&self, depth: u32) -> Vec<(Point3<f64>, f64)> {
        let (mut open, mut found) = (vec![(self.root, 0)], Vec::new());
        while let Some((node, below)) = open.pop() {
            let mut made = None;
            let ball = self.ball(node, &mut made);
            match ball.content {
                Content::Parts(parts) if below < depth => {
                    open.extend(parts.map(|part: Node| (part, below + 1)))
                }
                _ => found.push((ball.center, ball.radius)),
            }
        }
        found
    }
}

impl Search<'_> {
    /// A lower bound on the distance, by the balls of each mesh: against the box around the other, and against its balls.
    pub(super) fn parts_apart(&self) -> f64 {
        let (a, b) = (&self.a.parts, &self.b.parts);
        let least = |gaps: &mut dyn Iterator<Item = f64>| gaps.fold(f64::INFINITY, f64::min) - self.touching;
        let from_b = least(&mut a.iter().map(|(center, radius)| {
            self.b.box_distance(&self.pose_ab.inverse_transform_point(center)) - radius
        }));
        if from_b >= self.best {
            return from_b;
        }
        let placed: Vec<(Point3<f64>, f64)> =
            b.iter().map(|(center, radius)| (self.pose_ab * center, *radius)).collect();
        let from_a = least(&mut placed.iter().map(|(center, radius)| self.a.box_distance(center) - radius));
        if from_a >= self.best {
            return from_a;
        }
        let nearest = |(p, r): &(Point3<f64>, f64)| {
            placed.iter().map(|(q, s)| (q - p).norm() - s).fold(f64::INFINITY, f64::min) - r
        };
        least(&mut a.iter().map(nearest)).max(from_a).max(from_b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::{TriMesh, primitives};
    use nalgebra::Vector3;

    /// What balls and boxes say is never more than the distance, and often enough.
    #[test]
    fn parts_are_no_farther_apart_than_meshes() {
        let cloud =
            TriMesh::of_balls((0..40).map(|i| Point3::new(0.02 * f64::from(i), 0.0, 0.1)).collect(), 0.03);
        let meshes = [
            primitives::cuboid(0.1, 0.5, 0.9).unwrap(),
            primitives::torus(0.3, 0.1, 24, 12).unwrap(),
            cloud.unwrap(),
        ];
        let trees = meshes.each_ref().map(RefMesh::new);
        let mut decided = 0;
        for i in 0..600_usize {
            let t = i as f64;
            let shift = Vector3::new(mp_math::sin(t), mp_math::cos(1.3 * t), mp_math::sin(0.7 * t));
            let pose = Isometry3::new(shift, Vector3::new(t, 0.3 * t, -t));
            let (a, b, here) = (&trees[i % 3], &trees[i / 3 % 3], Isometry3::translation(0.1, 0.0, 0.2));
            let distance = a.clearance(&here, b, &pose, f64::INFINITY);
            let (center, radius) = a.around();
            assert!(b.distance_bound(&pose, &(here * center), radius) <= distance);
            for enough in [0.01, 0.1, 10.0] {
                let search = a.search(&here, b, &pose, enough).unwrap();
                let bound = search.parts_apart();
                assert!(bound <= distance, "{bound} {distance}");
                decided += u32::from(bound >= search.best);
                assert_eq!(a.at_least(&here, b, &pose, enough).is_ok(), distance >= search.best);
            }
        }
        assert!(decided > 600, "{decided}");
    }
}
