//! Tight oriented boxes.
//!
//! Finding the box of least volume exactly takes cubic time (J. O'Rourke, "Finding minimal enclosing
//! boxes", 1985). Two facts about it make good boxes cheap: with one axis fixed, the best box comes from the
//! minimal rectangle around the projected points, which rotating calipers find exactly (G. Toussaint,
//! 1983); and the best box has edges of the hull lying in adjacent faces. So:
//!
//! 1. only points that are extreme in some of many directions are kept;
//! 2. candidate axes: the mesh's own, those of the covariance of the surface (S. Gottschalk, M. C. Lin,
//!    D. Manocha, "OBBTree", 1996), normals of the largest flat parts, normals of pairs of the longest edges,
//!    and directions spread evenly; each refined by calipers about it;
//! 3. the best few are improved: by calipers about each axis in turn, and by tilting the axis in smaller and
//!    smaller steps (as a pattern search, in the spirit of C.-T. Chang, B. Gorissen, S. Melchior, "Fast
//!    oriented bounding box optimization on the rotation group SO(3,R)", 2011);
//! 4. the winner is measured, and improved once more, on all points.

mod calipers;
mod points;

use crate::{TriMesh, mass::sorted_eigen};
use calipers::calipers;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use points::{Points, extremes};
use std::cmp::Ordering;

/// An oriented box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obb {
    /// From the frame of the box, whose origin is its centre, to the frame of the mesh.
    pub pose: Isometry3<f64>,
    /// Half the side lengths along the axes of the box, metres.
    pub half_extents: Vector3<f64>,
}

impl Obb {
    /// The centre.
    #[must_use]
    pub fn center(&self) -> Point3<f64> {
        self.pose.translation.vector.into()
    }

    /// The unit axes.
    #[must_use]
    pub fn axes(&self) -> [Vector3<f64>; 3] {
        [Vector3::x(), Vector3::y(), Vector3::z()].map(|e| self.pose.rotation * e)
    }

    /// Volume, m³.
    #[must_use]
    pub fn volume(&self) -> f64 {
        8.0 * self.half_extents.product()
    }

    /// Distance from `p` to the box, metres; 0 inside.
    #[must_use]
    pub fn distance(&self, p: &Point3<f64>) -> f64 {
        let local = self.pose.inverse_transform_point(p).coords.abs();
        (local - self.half_extents).sup(&Vector3::zeros()).norm()
    }

    /// The eight corners; bit `i` of the index chooses the upper side of axis `i`.
    #[must_use]
    pub fn corners(&self) -> [Point3<f64>; 8] {
        std::array::from_fn(|k| {
            let h = self.half_extents;
            self.pose * Point3::from(Vector3::from_fn(|i, _| if k >> i & 1 == 1 { h[i] } else { -h[i] }))
        })
    }
}

/// How many normals of flat parts are tried.
const FLAT_PARTS: usize = 12;
/// How many edges are tried in all pairs.
const EDGES: usize = 12;
/// How many evenly spread axes are tried.
const SPREAD_AXES: usize = 64;
/// How many directions (each with its opposite) are used to find the extreme points of a large mesh.
const THINNING_DIRECTIONS: usize = 256;
/// How many candidates are improved.
const FINALISTS: usize = 16;
/// First tilt of the pattern search, radians, and the last one.
const TILTS: [f64; 2] = [0.1, 1e-5];
/// Steps of the pattern search.
const MAX_TILTS: usize = 200;
/// Rounds of calipers about the three axes.
const MAX_ROUNDS: usize = 10;

impl TriMesh {
    /// A tight oriented box around the mesh, in practice within a few percent of the smallest volume (of the
    /// smallest area, for a flat mesh). Every vertex is inside up to rounding. O(n log n).
    #[must_use]
    pub fn obb(&self) -> Obb {
        // Relative to the middle, for accuracy far from the origin.
        let middle = self.aabb().center();
        let points: Points = self.vertices().iter().map(|p| p - middle).collect();
        let scale = points.largest();
        // Thickness added to every side, so that flat boxes are compared by area and needles by length.
        let thickness = 1e-6 * scale;
        let few = thinned(&points);
        let mut candidates = vec![Fit::new(&few, Matrix3::identity(), thickness)];
        let frames = self.candidate_frames(&middle);
        candidates.extend(frames.iter().map(|frame| Fit::new(&few, calipers(&few, frame, 0), thickness)));
        // Stable, so that ties go to the earlier candidate.
        candidates.sort_by(Fit::order);
        candidates.truncate(FINALISTS);
        let improved =
            candidates.into_iter().map(|fit| tilted(&few, refined(&few, fit, thickness), thickness));
        let frame = improved.min_by(Fit::order).map_or_else(Matrix3::identity, |fit| fit.frame);
        let fit = refined(&points, Fit::new(&points, frame, thickness), thickness);
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(fit.frame));
        // Measured again along the axes of the quaternion, which differ from the matrix by rounding.
        let (low, high) = points.extents(&rotation.to_rotation_matrix().into_inner());
        let center = middle + rotation * ((low + high) * 0.5);
        Obb {
            pose: Isometry3::from_parts(Translation3::from(center.coords), rotation),
            half_extents: (high - low) * 0.5,
        }
    }

    /// Frames to try, before calipers about their first axis.
    fn candidate_frames(&self, middle: &Point3<f64>) -> Vec<Matrix3<f64>> {
        let surface = self.surface_frame(middle);
        let turned = |m: &Matrix3<f64>, k: usize| {
            Matrix3::from_columns(&[m.column(k), m.column((k + 1) % 3), m.column((k + 2) % 3)])
        };
        let mut frames: Vec<_> =
            [Matrix3::identity(), surface].iter().flat_map(|m| [0, 1, 2].map(|k| turned(m, k))).collect();
        frames.push(surface);
        let edges = self.longest_edges();
        let pairs = edges.iter().enumerate().flat_map(|(i, e)| edges[..i].iter().map(move |f| e.cross(f)));
        let axes = self.flat_part_normals().into_iter().chain(pairs.filter(|n| n.norm() > 1e-6));
        frames.extend(axes.chain(spread_directions(SPREAD_AXES)).filter_map(|n| frame_of(&n)));
        frames
    }

    /// Unit directions of the longest edges, no two parallel.
    fn longest_edges(&self) -> Vec<Vector3<f64>> {
        let mut edges: Vec<_> = (0..self.triangles().len())
            .flat_map(|i| {
                let [a, b, c] = self.triangle(i);
                [b - a, c - b, a - c]
            })
            .collect();
        edges.sort_by(|a, b| b.norm_squared().total_cmp(&a.norm_squared()));
        let mut distinct: Vec<Vector3<f64>> = Vec::new();
        for e in edges.iter().filter_map(|e| e.try_normalize(0.0)) {
            if distinct.iter().all(|d| d.cross(&e).norm() > 1e-4) {
                distinct.push(e);
                if distinct.len() == EDGES {
                    break;
                }
            }
        }
        distinct
    }

    /// Principal axes of the surface.
    fn surface_frame(&self, middle: &Point3<f64>) -> Matrix3<f64> {
        let (mut area, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for i in 0..self.triangles().len() {
            let [a, b, c] = self.triangle(i).map(|p| p - middle);
            let weight = (b - a).cross(&(c - a)).norm() / 12.0;
            let sum = a + b + c;
            area += weight * 12.0;
            first += sum * (weight * 4.0);
            second +=
                (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose()) * weight;
        }
        if area == 0.0 {
            return Matrix3::identity();
        }
        sorted_eigen(&(second - first * first.transpose() / area)).1
    }

    /// Unit normals of the flat parts, largest first.
    fn flat_part_normals(&self) -> Vec<Vector3<f64>> {
        let mut sized: Vec<(f64, Vector3<f64>)> = (0..self.triangles().len())
            .filter_map(|i| {
                let [a, b, c] = self.triangle(i);
                let mut n = (b - a).cross(&(c - a));
                if n[n.iamax()] < 0.0 {
                    n = -n;
                }
                let length = n.norm();
                (length > 0.0 && length.is_finite()).then(|| (length, n / length))
            })
            .collect();
        sized.sort_by(|a, b| b.0.total_cmp(&a.0));
        // Areas of triangles in parallel planes are added; only the largest triangles are used, to stay
        // linear.
        let mut parts: Vec<(f64, Vector3<f64>)> = Vec::new();
        for (size, n) in sized.into_iter().take(4096) {
            match parts.iter().position(|(_, m)| m.dot(&n) > 1.0 - 1e-8) {
                Some(k) => parts[k].0 += size,
                None if parts.len() < 4 * FLAT_PARTS => parts.push((size, n)),
                None => {}
            }
        }
        parts.sort_by(|a, b| b.0.total_cmp(&a.0));
        parts.truncate(FLAT_PARTS);
        parts.into_iter().map(|(_, n)| n).collect()
    }
}

/// A frame (unit columns) and the volume of its box.
struct Fit {
    frame: Matrix3<f64>,
    size: f64,
}

impl Fit {
    fn new(points: &Points, frame: Matrix3<f64>, thickness: f64) -> Self {
        let (low, high) = points.extents(&frame);
        Self { frame, size: (high - low).add_scalar(thickness).product() }
    }
    fn order(&self, other: &Self) -> Ordering {
        self.size.total_cmp(&other.size)
    }
}

/// The points that decide a box: all when few, else those extreme in some of many directions.
fn thinned(points: &Points) -> Points {
    if points.len() <= 2 * THINNING_DIRECTIONS {
        return points.clone();
    }
    let mut along = Vec::new();
    let mut kept: Vec<usize> = spread_directions(THINNING_DIRECTIONS)
        .flat_map(|d| {
            along.clear();
            along.extend(points.along(d));
            extremes(&along)
        })
        .collect();
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|i| points.get(i)).collect()
}

/// `n` directions spread evenly over a half sphere, along a Fibonacci spiral.
fn spread_directions(n: usize) -> impl Iterator<Item = Vector3<f64>> {
    let golden_angle = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..n).map(move |k| {
        let z = (k as f64 + 0.5) / n as f64;
        let (s, c) = mp_math::sin_cos(golden_angle * k as f64);
        let r = (1.0 - z * z).sqrt();
        Vector3::new(r * c, r * s, z)
    })
}

/// Improves by calipers about each axis in turn.
fn refined(points: &Points, mut fit: Fit, thickness: f64) -> Fit {
    for _ in 0..MAX_ROUNDS {
        let before = fit.size;
        for axis in 0..3 {
            let next = Fit::new(points, calipers(points, &fit.frame, axis), thickness);
            if next.size < fit.size {
                fit = next;
            }
        }
        if fit.size > before * (1.0 - 1e-9) {
            break;
        }
    }
    fit
}

/// Improves by tilting the first axis, with calipers about it, in smaller and smaller steps.
fn tilted(points: &Points, mut fit: Fit, thickness: f64) -> Fit {
    let [mut tilt, last] = TILTS;
    for _ in 0..MAX_TILTS {
        if tilt < last {
            break;
        }
        let [x, y, z] = [0, 1, 2].map(|k| fit.frame.column(k).into_owned());
        let tries = (0..8).filter_map(|k| {
            let (s, c) = mp_math::sin_cos(std::f64::consts::FRAC_PI_4 * f64::from(k));
            let frame = frame_of(&(x + (y * c + z * s) * tilt))?;
            Some(Fit::new(points, calipers(points, &frame, 0), thickness))
        });
        match tries.min_by(Fit::order) {
            Some(next) if next.size < fit.size * (1.0 - 1e-6) => fit = refined(points, next, thickness),
            _ => tilt *= 0.5,
        }
    }
    fit
}

/// A right-handed frame with its first axis along `x`; `None` when `x` is zero.
fn frame_of(x: &Vector3<f64>) -> Option<Matrix3<f64>> {
    let x = x.try_normalize(0.0)?;
    let mut least = Vector3::zeros();
    least[x.iamin()] = 1.0;
    let y = (least - x * x.dot(&least)).normalize();
    Some(Matrix3::from_columns(&[x, y, x.cross(&y)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{pose_from_six, primitives::*};
    use nalgebra::Point2;
    use proptest::prelude::*;

    fn pose() -> impl Strategy<Value = Isometry3<f64>> {
        prop::array::uniform6(-3.0..3.0_f64).prop_map(pose_from_six)
    }

    fn holds(obb: &Obb, mesh: &TriMesh) -> bool {
        let tolerance = 1e-12 * (1.0 + obb.center().coords.norm() + obb.half_extents.norm());
        mesh.vertices().iter().all(|p| obb.distance(p) <= tolerance)
    }

    /// Volumes of the boxes along the axes of many rotations.
    fn rotated_boxes(mesh: &TriMesh) -> f64 {
        let points: Points = mesh.vertices().iter().map(|p| p.coords).collect();
        let mut best = f64::INFINITY;
        for a in 0..16 {
            for b in 0..8 {
                for g in 0..16 {
                    let angles = [f64::from(a) * 0.1, f64::from(b) * 0.2, f64::from(g) * 0.1];
                    let r = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]).into_inner();
                    best = best.min(Fit::new(&points, r, 0.0).size);
                }
            }
        }
        best
    }

    /// The best box here is improved from a candidate that is not among the best at first.
    #[test]
    fn candidates_that_begin_badly_are_improved_too() {
        let points = [
            [-0.4772988838639298, 0.0, 0.2648175753777196],
            [0.30955018169472387, 0.7501206776080142, 0.7316731058649364],
            [0.955442165889041, 0.6103144778015004, 0.0],
            [0.9820864306446364, -0.27381076876408245, 0.8126320683234755],
            [0.2374367427491487, -0.90218410251418, 0.5304164478732056],
            [0.43638323498673287, 0.7800353887127692, -0.6146078509823567],
            [0.48109048119590914, 0.0, 0.8259446422341326],
            [0.0, 0.0, 0.9884295715951343],
        ];
        let [i, j, k, w] = [0.4382521850956733, 0.3054359310148973, 0.7210478853988338, 0.441286597650326];
        let turn = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, i, j, k));
        let points = points.map(|p| turn * Point3::from(p));
        let soup: Vec<_> = points.windows(3).map(|w| [w[0], w[1], w[2]]).collect();
        let mesh = TriMesh::from_soup(&soup).unwrap();
        let (volume, tried) = (mesh.obb().volume(), rotated_boxes(&mesh));
        assert!(volume <= tried * 1.001, "{volume} {tried}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn of_a_box_is_the_box(x in 0.1..5.0_f64, y in 0.1..5.0_f64, z in 0.1..5.0_f64, pose in pose()) {
            let mesh = cuboid(x, y, z).unwrap().transformed(&pose);
            let obb = mesh.obb();
            prop_assert!(holds(&obb, &mesh));
            prop_assert!((obb.volume() - x * y * z).abs() < 1e-9 * x * y * z, "{} {}", obb.volume(), x * y * z);
            let cube = cuboid(x, x, x).unwrap().transformed(&pose);
            prop_assert!((cube.obb().volume() - mp_math::powi(x, 3)).abs() < 1e-9 * mp_math::powi(x, 3));
        }

        #[test]
        fn never_worse_than_many_rotations(points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 4..30), pose in pose()) {
            let soup: Vec<_> = points.windows(3).map(|w| [w[0], w[1], w[2]].map(|c| pose * Point3::from(c))).collect();
            let mesh = TriMesh::from_soup(&soup).unwrap();
            let obb = mesh.obb();
            prop_assert!(holds(&obb, &mesh));
            let tried = rotated_boxes(&mesh);
            prop_assert!(obb.volume() <= tried * 1.001, "{} {}", obb.volume(), tried);
        }

        #[test]
        fn of_flat_thin_and_round_things(pose in pose(), n in 3_u32..20) {
            let ring: Vec<_> = [(2.0, 0.0), (2.0, 1.0), (0.0, 1.0), (0.0, 0.0)].map(|(x, y)| pose * Point3::new(x, y, 0.0)).to_vec();
            let sheet = TriMesh::from_polygons(ring, [[0_u32, 1, 2, 3]]).unwrap();
            let h = sheet.obb().half_extents;
            let mut sides = [h.x, h.y, h.z];
            sides.sort_by(f64::total_cmp);
            prop_assert!(sides[0] < 1e-12 && (sides[1] - 0.5).abs() < 1e-9 && (sides[2] - 1.0).abs() < 1e-9, "{sides:?}");
            let rod = cylinder(0.1, 4.0, 2 * n).unwrap().transformed(&pose);
            let exact = rod.transformed(&pose.inverse()).obb().volume();
            prop_assert!(holds(&rod.obb(), &rod) && rod.obb().volume() < 1.0001 * exact && exact <= 0.16 + 1e-12);
            let t = tetrahedron(1.0).unwrap().transformed(&pose);
            prop_assert!((t.obb().volume() - 0.125_f64.sqrt()).abs() < 1e-9, "{}", t.obb().volume());
        }
    }

    #[test]
    fn of_a_point_and_a_segment() {
        let p = Point3::new(1.0, 2.0, 3.0);
        let obb = TriMesh::from_soup(&[[p; 3]]).unwrap().obb();
        assert_eq!((obb.center(), obb.half_extents), (p, Vector3::zeros()));
        let q = p + Vector3::new(2.0, 2.0, 1.0);
        let obb = TriMesh::from_soup(&[[p, q, q]]).unwrap().obb();
        assert!((obb.half_extents.amax() - 1.5).abs() < 1e-12 && obb.volume() < 1e-20);
        assert_eq!(obb.corners().len(), 8);
    }

    #[test]
    fn of_a_large_flat_prism() {
        let star: Vec<_> = (0..10)
            .map(|k| {
                let (s, c) = mp_math::sin_cos(std::f64::consts::TAU * f64::from(k) / 10.0);
                Point2::new(c, s) * if k % 2 == 0 { 1.0 } else { 0.4 }
            })
            .collect();
        let mesh = prism(&star, 0.0, 0.1).unwrap();
        let turned = mesh.transformed(&pose_from_six([1e4, 0.0, -1e4, 1.0, 2.0, 3.0])).obb();
        assert!((turned.volume() - mesh.obb().volume()).abs() < 1e-9);
    }
}
