//! Poses that are hard to decide.

use super::Placed;
use crate::collide::pairs::Pair;
use crate::collide::poses::{Border, Meshes};
use crate::error::{IntoError, Result};
use mp_cspace::{Rng, Se3, Space};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use rand::RngExt;

/// The distances from the border to which poses are bisected, in radii of the robot.
const WIDTHS: [f64; 5] = [1e-2, 1e-4, 1e-6, 1e-9, 1e-12];

/// Poses of one kind: the name of the kind, and the poses.
pub(crate) type PoseGroup = (String, Vec<Isometry3<f64>>);

/// About `count` poses: two fifths uniform, half bisected, a tenth touching.
pub(crate) fn pose_groups(pair: &Pair, meshes: &Meshes, count: usize, seed: u64) -> Result<Vec<PoseGroup>> {
    let space = Se3::new(pair.bounds.min.coords, pair.bounds.max.coords).into_error()?;
    let mut rng = Rng::stream(seed, 0);
    let uniform = (0..count * 2 / 5).map(|_| space.sample_uniform(&mut rng)).collect();
    let mut all = vec![("uniform".to_owned(), uniform)];
    all.extend(WIDTHS.map(|width| (format!("bisected to {width:e}"), Vec::new())));
    let mut border = Border::new(pair, meshes, Rng::stream(seed, 1))?;
    let widths = WIDTHS.map(|width| width * pair.radius());
    for _ in 0..count / (4 * WIDTHS.len()) {
        for (ends, (_, poses)) in border.bisected(&widths)?.into_iter().zip(&mut all[1..]) {
            poses.extend(ends);
        }
    }
    let mut rng = Rng::stream(seed, 2);
    let touching = (0..count / 10).map(|_| touching(pair, &space, &mut rng)).collect();
    all.push(("touching".to_owned(), touching));
    Ok(all)
}

/// A pose at which the robot touches the obstacles, up to rounding: a corner, or the middle of an edge, on a
/// corner, the middle of an edge, or a point within a triangle. Half of the rotations are symmetries of the
/// cube, which makes faces and edges of boxes coplanar; a third of the poses are then moved by a tiny
/// distance.
fn touching(pair: &Pair, space: &Se3, rng: &mut Rng) -> Isometry3<f64> {
    let turns = cube_turns();
    let rotation = match rng.random::<bool>() {
        true => turns[rng.random_range(0..turns.len())],
        false => space.sample_uniform(rng).rotation,
    };
    let turned = Placed::new(&Isometry3::from_parts(Translation3::identity(), rotation));
    let triangle = any_triangle(&pair.a, rng);
    let (on_a, normal) =
        (any_point(&triangle, rng), (triangle[1] - triangle[0]).cross(&(triangle[2] - triangle[0])));
    let on_b = match rng.random_range(0..4) {
        // Any point of the robot.
        0 => turned.point(&any_point(&any_triangle(&pair.b, rng), rng)),
        // The corner farthest to one side of the triangle, so that the robot is on the other side.
        side => {
            let outward = if side == 1 { normal } else { -normal };
            let corners = pair.b.vertices().iter().map(|v| turned.point(v));
            let farthest = corners.max_by(|p, q| outward.dot(&p.coords).total_cmp(&outward.dot(&q.coords)));
            farthest.unwrap_or_default()
        }
    };
    let mut translation = on_a - on_b;
    if rng.random_range(0..3) == 0 {
        translation += Vector3::repeat(rng.random_range(-4.0..4.0) * f64::EPSILON * on_a.coords.norm());
    }
    Isometry3::from_parts(translation.into(), rotation)
}

fn any_triangle(mesh: &TriMesh, rng: &mut Rng) -> [Point3<f64>; 3] {
    mesh.triangle(rng.random_range(0..mesh.triangles().len()))
}

/// A corner, the middle of an edge, or an inner point.
fn any_point(t: &[Point3<f64>; 3], rng: &mut Rng) -> Point3<f64> {
    match rng.random_range(0..3) {
        0 => t[0],
        1 => nalgebra::center(&t[0], &t[1]),
        _ => Point3::from(t[0].coords * 0.25 + t[1].coords * 0.5 + t[2].coords * 0.25),
    }
}

/// The 24 rotations that map a cube to itself.
fn cube_turns() -> Vec<UnitQuaternion<f64>> {
    let mut turns = Vec::new();
    for code in 0..81 {
        let [w, x, y, z] = [27, 9, 3, 1].map(|place| f64::from(code / place % 3 - 1));
        let first = [w, x, y, z].into_iter().find(|v| *v != 0.0);
        let q = Quaternion::new(w, x, y, z);
        // Opposite quaternions are the same rotation.
        if first == Some(1.0) && [1.0, 2.0, 4.0].contains(&q.norm_squared()) {
            turns.push(UnitQuaternion::new_normalize(q));
        }
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collide::pairs::tori;

    #[test]
    fn cubes_have_24_turns() {
        let turns = cube_turns();
        assert_eq!(turns.len(), 24);
        for (i, p) in turns.iter().enumerate() {
            let m = p.to_rotation_matrix();
            assert!(m.matrix().iter().all(|v| (v - v.round()).abs() < 1e-15));
            assert!(turns[..i].iter().all(|q| p.angle_to(q) > 1.0));
        }
    }

    #[test]
    fn poses_of_every_kind() {
        let pair = tori("tori", 12).unwrap();
        let meshes = Meshes::new(&pair);
        let groups = pose_groups(&pair, &meshes, 200, 9).unwrap();
        let counts: Vec<usize> = groups.iter().map(|(_, poses)| poses.len()).collect();
        assert_eq!(counts, [80, 20, 20, 20, 20, 20, 20]);
        let mut query = mp_collide::Query::default();
        let here = Isometry3::identity();
        for pose in &groups[6].1 {
            let distance = query.distance(&meshes.a, &here, &meshes.b, pose).distance;
            assert!(distance < 1e-14, "{distance}");
        }
    }
}
