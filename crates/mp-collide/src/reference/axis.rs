//! Whether an axis separates two sets of points: a quick lower bound on the distance of meshes.

use nalgebra::{IsometryMatrix3, Matrix2, Point3, Vector2, Vector3};

/// Bodies of more corners have no axis looked for: every step compares all of them.
pub(super) const MOST_CORNERS: usize = 2000;

/// Axes tried for one pair.
const MOST_AXES: usize = 16;

/// A lower bound on the distance of the convex hulls of `a` and of `b` at `pose_ab`, not negative, and so on that of all
/// that is inside of them. It may be far below; it is at least `enough`, or near the distance, when that is at least `least`, and the
/// search ends as soon as it is known to be less than that.
///
/// Any axis bounds the distance, by the gap between the two sets along it. Which axes to try, the algorithm of Gilbert,
/// Johnson and Keerthi (1988) says: from the origin to the nearest point of a simplex of differences of corners. `best` becomes the axis with
/// the largest gap, as a unit vector in the frame of `b` from `b` to `a`; where there is one already, the search begins with its corners.
pub(super) fn separation(
    a: &[Point3<f64>],
    b: &[Point3<f64>],
    pose_ab: &IsometryMatrix3<f64>,
    [least, enough]: [f64; 2],
    best: &mut Option<Vector3<f64>>,
) -> f64 {
    let (Some(first_a), Some(first_b)) = (a.first(), b.first()) else { return 0.0 };
    let mut bound = 0.0;
    let first = best.take().map(|axis| end(a, b, pose_ab, axis));
    let mut simplex = vec![first.unwrap_or_else(|| first_a - pose_ab * first_b)];
    for _ in 0..MOST_AXES {
        let Some(nearest) = reduce(&mut simplex) else { break };
        let length = nearest.norm();
        // The hulls are no farther apart than this.
        if length < least.max(f64::MIN_POSITIVE) {
            break;
        }
        let axis = nearest / length;
        let axis_b = pose_ab.rotation.inverse() * axis;
        let corner = end(a, b, pose_ab, axis_b);
        let gap = corner.dot(&axis);
        if gap > bound {
            (bound, *best) = (gap, Some(axis_b));
        }
        // No corner is nearer along the axis than the point found: it is the nearest.
        if bound >= enough || gap >= length * (1.0 - 1e-9) {
            break;
        }
        simplex.push(corner);
    }
    bound
}

/// The gap between two sets along an axis, a unit vector in the frame of `b` from `b` to `a`; negative where they overlap.
pub(super) fn gap(
    a: &[Point3<f64>],
    b: &[Point3<f64>],
    pose_ab: &IsometryMatrix3<f64>,
    axis: Vector3<f64>,
) -> f64 {
    if a.is_empty() || b.is_empty() {
        return 0.0;
    }
    let axis_a = pose_ab.rotation * axis;
    lowest(a, axis_a) - pose_ab.translation.vector.dot(&axis_a) + lowest(b, -axis)
}

/// How low corners are along an axis.
pub(super) fn lowest(points: &[Point3<f64>], axis: Vector3<f64>) -> f64 {
    // Four at a time, so that none waits for the one before it.
    let mut least = [f64::INFINITY; 4];
    let mut take = |k: usize, p: &Point3<f64>| {
        let x = p.coords.dot(&axis);
        least[k] = if x < least[k] { x } else { least[k] };
    };
    let (fours, rest) = points.as_chunks::<4>();
    fours.iter().for_each(|four| (0..4).for_each(|k| take(k, &four[k])));
    rest.iter().for_each(|p| take(0, p));
    least.into_iter().fold(f64::INFINITY, f64::min)
}

/// The difference of the lowest corner of `a` and the highest of `b` along an axis of `b`, of which neither is empty.
fn end(
    a: &[Point3<f64>],
    b: &[Point3<f64>],
    pose_ab: &IsometryMatrix3<f64>,
    axis: Vector3<f64>,
) -> Vector3<f64> {
    let first_lowest = |points: &[Point3<f64>], axis: Vector3<f64>| {
        let along = points.iter().map(|p| p.coords.dot(&axis));
        along.enumerate().fold((0, f64::INFINITY), |least, x| if x.1 < least.1 { x } else { least }).0
    };
    a[first_lowest(a, pose_ab.rotation * axis)] - pose_ab * b[first_lowest(b, -axis)]
}

/// The point of a simplex of up to four corners nearest to the origin, `None` when the origin is inside. Keeps the corners
/// of the side that it is on.
fn reduce(simplex: &mut Vec<Vector3<f64>>) -> Option<Vector3<f64>> {
    if let &[p, q, r, s] = simplex.as_slice()
        && holds_origin([p, q, r, s])
    {
        return None;
    }
    let n = simplex.len();
    let mut best: Option<(f64, Vector3<f64>, Vec<Vector3<f64>>)> = None;
    for side in (1..1_u32 << n).filter(|side| side.count_ones() <= 3) {
        let corners: Vec<_> = (0..n).filter(|i| side >> i & 1 == 1).map(|i| simplex[i]).collect();
        if let Some(point) = foot(&corners)
            && best.as_ref().is_none_or(|(square, ..)| point.norm_squared() < *square)
        {
            best = Some((point.norm_squared(), point, corners));
        }
    }
    let (_, point, corners) = best?;
    *simplex = corners;
    Some(point)
}

/// The foot of the perpendicular from the origin to a corner, an edge or a triangle; `None` when it is outside.
fn foot(corners: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    match *corners {
        [p] => Some(p),
        [p, q] => {
            let u = q - p;
            let s = -p.dot(&u) / u.norm_squared();
            (0.0..=1.0).contains(&s).then(|| p + u * s)
        }
        [p, q, r] => {
            let (u, v) = (q - p, r - p);
            let gram = Matrix2::new(u.dot(&u), u.dot(&v), u.dot(&v), v.dot(&v));
            let weights = gram.try_inverse()? * Vector2::new(-p.dot(&u), -p.dot(&v));
            let inside = weights.x >= 0.0 && weights.y >= 0.0 && weights.sum() <= 1.0;
            inside.then(|| p + u * weights.x + v * weights.y)
        }
        _ => None,
    }
}

/// Whether the origin is on the inner side of each face of a tetrahedron.
fn holds_origin([p, q, r, s]: [Vector3<f64>; 4]) -> bool {
    [[p, q, r, s], [q, r, s, p], [r, s, p, q], [s, p, q, r]].into_iter().all(|[a, b, c, opposite]| {
        let normal = (b - a).cross(&(c - a));
        normal.dot(&(opposite - a)) * normal.dot(&-a) > 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::RefMesh;
    use mp_geom::{TriMesh, primitives};
    use nalgebra::Isometry3;

    fn corners(mesh: &TriMesh) -> Vec<Point3<f64>> {
        mesh.vertices().to_vec()
    }

    fn matrix(pose: &Isometry3<f64>) -> IsometryMatrix3<f64> {
        IsometryMatrix3::from_parts(pose.translation, pose.rotation.to_rotation_matrix())
    }

    #[test]
    fn convex_bodies_are_as_far_apart_as_their_meshes() {
        let bodies = [
            primitives::cuboid(1.0, 2.0, 0.5).unwrap(),
            primitives::cylinder(0.5, 2.0, 24).unwrap(),
            primitives::sphere(0.4, 2).unwrap(),
        ];
        let (mut apart, mut touching) = (0, 0);
        for (k, (a, b)) in bodies.iter().flat_map(|a| bodies.iter().map(move |b| (a, b))).enumerate() {
            for i in 0..60 {
                let t = f64::from(i) + 60.0 * k as f64;
                let turn = if i % 3 == 0 { 0.0 } else { 1.7 * mp_math::sin(0.3 * t) };
                let at = Vector3::new(
                    1.6 * mp_math::sin(0.9 * t),
                    1.5 * mp_math::cos(0.7 * t),
                    1.4 * mp_math::sin(1.1 * t),
                );
                let pose = Isometry3::new(at, Vector3::new(turn, -0.4 * turn, 0.8 * turn));
                let (mesh_a, mesh_b) = (RefMesh::new(a), RefMesh::new(b));
                let distance = mesh_a.clearance(&Isometry3::identity(), &mesh_b, &pose, f64::INFINITY);
                let bound =
                    |enough| separation(&corners(a), &corners(b), &matrix(&pose), [enough; 2], &mut None);
                let apart_at_all = bound(1e-9) > 0.0;
                // Inside of each other they are apart as surfaces, and not as solids.
                if apart_at_all {
                    apart += 1;
                    for part in [0.1, 0.5, 0.9, 1.0 - 1e-6] {
                        let found = bound(part * distance);
                        assert!(
                            part * distance <= found && found <= distance + 1e-12,
                            "{found} {distance} {pose}"
                        );
                    }
                    assert!(bound(1.1 * distance) <= distance + 1e-12);
                } else {
                    touching += 1;
                }
            }
        }
        assert!(apart > 100 && touching > 50, "{apart} {touching}");
    }

    #[test]
    fn bodies_within_their_hulls_are_not_separated() {
        let ring = primitives::torus(1.0, 0.2, 24, 12).unwrap();
        let ball = primitives::sphere(0.3, 1).unwrap();
        let here = IsometryMatrix3::identity();
        assert_eq!(separation(&corners(&ring), &corners(&ball), &here, [0.1; 2], &mut None), 0.0);
        assert_eq!(separation(&[], &corners(&ball), &here, [0.1; 2], &mut None), 0.0);
        // Flat sets: all in one plane, and one point.
        let plane = [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
        let above = [Point3::new(0.2, 0.2, 0.5)];
        let height = separation(&plane, &above, &here, [0.499_999; 2], &mut None);
        assert!((height - 0.5).abs() < 1e-12, "{height}");
        assert_eq!(separation(&plane, &plane, &here, [0.1; 2], &mut None), 0.0);
    }
}
