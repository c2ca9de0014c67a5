//! Convex hulls.

use super::{Made, finite};
use crate::{PrimitiveError, TriMesh};
use nalgebra::Point3;
use robust::{Coord3D, orient3d};
use std::collections::{HashMap, HashSet};

/// The most points: seconds.
const MAX_POINTS: u32 = 10_000;

/// The convex hull of points, with triangles that face outward. Signs of volumes are exact, so that every
/// point is inside or on it.
///
/// The incremental algorithm (Preparata and Shamos 1985, section 3.4.2; de Berg et al. 2008, chapter 11):
/// each point that sees faces from outside replaces them by faces to the edges around them. O(n·f) for n
/// points and f faces of the hull.
///
/// # Errors
/// When a coordinate is not finite, all points are in one plane, or there are more than 10,000.
pub fn convex_hull(points: &[Point3<f64>]) -> Made {
    finite(points)?;
    let [min, max] = [4, MAX_POINTS];
    if points.len() > max as usize {
        return Err(PrimitiveError::Count { what: "points of a hull", min, max, value: points.len() as u32 });
    }
    let mut faces = first_faces(points)
        .ok_or(PrimitiveError::NoInside { what: "a convex hull of points that are all in one plane" })?;
    let (mut seen, mut border) = (Vec::new(), HashSet::new());
    for (i, p) in points.iter().enumerate() {
        seen.clear();
        faces.retain(|face| {
            let sees = above(points, face, p);
            seen.extend(sees.then_some(*face));
            !sees
        });
        let edges = || seen.iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]);
        border.clear();
        border.extend(edges());
        // In the order of faces, so that the hull does not depend on the hash.
        let around = edges().filter(|(a, b)| !border.contains(&(*b, *a)));
        faces.extend(around.map(|(a, b)| [a, b, i as u32]));
    }
    // Only the vertices that are used, in their order.
    let mut used: Vec<u32> = faces.concat();
    used.sort_unstable();
    used.dedup();
    let place: HashMap<u32, u32> = used.iter().zip(0..).map(|(v, i)| (*v, i)).collect();
    let vertices = used.iter().map(|v| points[*v as usize]).collect();
    let triangles = faces.into_iter().map(|face| face.map(|v| place[&v])).collect();
    Ok(TriMesh::new(vertices, triangles)?.trusted_solid())
}

/// Whether `p` is strictly on the outer side of a face.
fn above(points: &[Point3<f64>], face: &[u32; 3], p: &Point3<f64>) -> bool {
    let [a, b, c] = face.map(|v| &points[v as usize]);
    volume(a, b, c, p) < 0.0
}

/// Of the sign of the volume of a tetrahedron, exactly: positive when `p` is below the triangle, which is
/// seen counterclockwise from above.
fn volume(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>, p: &Point3<f64>) -> f64 {
    let [a, b, c, p] = [a, b, c, p].map(|p| Coord3D { x: p.x, y: p.y, z: p.z });
    orient3d(a, b, c, p)
}

/// The faces of a tetrahedron of four of the points; `None` when all points are in one plane.
fn first_faces(points: &[Point3<f64>]) -> Option<Vec<[u32; 3]>> {
    let a = points.first()?;
    let farthest = |measure: &dyn Fn(&Point3<f64>) -> f64| {
        let measured = points.iter().enumerate().map(|(i, p)| (measure(p), i));
        measured.reduce(|best, next| if next.0 > best.0 { next } else { best }).map_or(0, |(_, i)| i)
    };
    let b = &points[farthest(&|p| (p - a).norm())];
    let c = &points[farthest(&|p| (p - a).cross(&(b - a)).norm())];
    let d = &points[farthest(&|p| volume(a, b, c, p).abs())];
    let number = |q: &Point3<f64>| points.iter().position(|p| p == q).map(|i| i as u32);
    let [a, mut b, mut c, d] = [number(a)?, number(b)?, number(c)?, number(d)?];
    let [pa, pb, pc, pd] = [a, b, c, d].map(|v| &points[v as usize]);
    let side = volume(pa, pb, pc, pd);
    if side < 0.0 {
        std::mem::swap(&mut b, &mut c);
    }
    (side != 0.0).then(|| vec![[a, b, c], [a, d, b], [b, d, c], [c, d, a]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::{cuboid, sphere, torus};
    use proptest::prelude::*;

    fn check(points: &[Point3<f64>]) -> TriMesh {
        let mesh = convex_hull(points).unwrap();
        let found = mesh.topology();
        assert!(found.is_solid() && found.components == 1 && found.degenerate.is_empty(), "{found:?}");
        for t in mesh.triangles() {
            assert!(points.iter().all(|p| !above(mesh.vertices(), t, p)));
        }
        mesh
    }

    #[test]
    fn hulls_of_convex_bodies_are_these() {
        let cube = cuboid(1.0, 2.0, 3.0).unwrap();
        // Points inside, on faces and on edges add nothing.
        let mut points = cube.vertices().to_vec();
        points.extend([[0.0, 0.0, 0.0], [0.5, 0.3, 0.2], [0.5, 1.0, 0.7], [0.5, 1.0, 1.5]].map(Point3::from));
        points.rotate_left(5);
        let hull = check(&points);
        // Those on edges may be corners, if they come first.
        assert!(hull.signed_volume() == 6.0 && (8..12).contains(&hull.vertices().len()));
        for body in [sphere(1.0, 2).unwrap(), torus(1.0, 0.4, 16, 8).unwrap()] {
            let hull = check(body.vertices());
            assert!(hull.signed_volume() > 0.999 * body.signed_volume());
        }
    }

    #[test]
    fn points_in_a_plane_have_no_hull() {
        let flat: Vec<_> = (0..9).map(|i| Point3::new(f64::from(i % 3), f64::from(i / 3), 0.0)).collect();
        assert!(matches!(convex_hull(&flat), Err(PrimitiveError::NoInside { .. })));
        assert!(convex_hull(&[Point3::origin(); 5]).is_err());
        assert!(convex_hull(&[]).is_err());
        assert!(convex_hull(&[Point3::new(0.0, f64::INFINITY, 0.0)]).is_err());
    }

    proptest! {
        #[test]
        fn all_points_are_in_their_hull(grid in prop::collection::vec(prop::array::uniform3(-3_i32..4), 4..60)) {
            // Small whole numbers: many points in common planes.
            let points: Vec<_> = grid.iter().map(|p| Point3::from(p.map(f64::from))).collect();
            if first_faces(&points).is_some() {
                check(&points);
            }
        }
    }
}
