//! Convex hulls, by quickhull on exact predicates (Barber, Dobkin and Huhdanpaa, *The quickhull algorithm for convex hulls*,
//! 1996).
//!
//! parry's own hull is not used: it treats points as flat whose thickness is below a thousandth of their extent, such as
//! a metal sheet, and for points of a rotated grid it sometimes makes a surface that is not convex.

use std::collections::HashMap;

use mp_geom::TriMesh;
use nalgebra::Point3;
use robust::{Coord3D, orient3d};

use super::ParryError;

/// Points whose extent is thinner than this fraction of their length count as flat.
const FLAT: f64 = 1e-9;

/// The convex hull of the surface of `mesh`: closed, outward, its vertices some of the mesh's own to the bit. It is convex
/// and has every vertex of the mesh inside or on it *exactly*, as in real arithmetic. The same mesh gives the same hull. In
/// practice O(n log n) for n vertices.
///
/// ```
/// let torus = mp_geom::primitives::torus(1.0, 0.25, 32, 16)?;
/// let hull = mp_collide::parry::convex_hull(&torus)?;
/// assert!(hull.topology().is_solid() && hull.signed_volume() > torus.signed_volume());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ParryError::Flat`], [`ParryError::TooClose`].
pub fn convex_hull(mesh: &TriMesh) -> Result<TriMesh, ParryError> {
    let mut used = vec![false; mesh.vertices().len()];
    for i in mesh.triangles().iter().flatten() {
        used[*i as usize] = true;
    }
    let points: Vec<_> =
        mesh.vertices().iter().zip(used).filter(|(_, used)| *used).map(|(p, _)| *p).collect();
    hull_of(&points)
}

/// The convex hull of finite points, at most `u32::MAX` of them.
pub(super) fn hull_of(points: &[Point3<f64>]) -> Result<TriMesh, ParryError> {
    let scaled = power_of_two(points);
    let mut hull = Hull::around_four(&scaled)?;
    while let Some(facet) = hull.next() {
        hull.grow(facet)?;
    }
    let facets: Vec<[usize; 3]> = hull.facets.iter().filter(|f| f.alive).map(|f| f.corners).collect();
    let mut corners: Vec<usize> = facets.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    let number: HashMap<usize, u32> = corners.iter().copied().zip(0..).collect();
    let triangles = facets.iter().map(|f| f.map(|i| number[&i])).collect();
    Ok(TriMesh::new(corners.iter().map(|&i| points[i]).collect(), triangles)?)
}

/// The points times a power of two, so that no product of coordinates overflows, and none that matters underflows.
fn power_of_two(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let size = points.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    let scale = mp_math::exp2((-mp_math::log2(size).floor()).clamp(-1000.0, 1000.0));
    points.iter().map(|p| p * scale).collect()
}

/// A triangle of the hull.
#[derive(Clone, Debug)]
struct Facet {
    /// Counter-clockwise seen from outside.
    corners: [usize; 3],
    /// The facets across its edges: corner 0–1, 1–2, 2–0.
    across: [usize; 3],
    /// Points it can be seen from; each point belongs to one facet only.
    outside: Vec<usize>,
    /// Whether it is still part of the hull.
    alive: bool,
}

/// The hull of some of the points.
struct Hull<'a> {
    points: &'a [Point3<f64>],
    facets: Vec<Facet>,
    /// Facets that have, or once had, points outside.
    open: Vec<usize>,
}

impl<'a> Hull<'a> {
    /// The tetrahedron of four points far apart.
    fn around_four(points: &'a [Point3<f64>]) -> Result<Self, ParryError> {
        let farthest = |far: &dyn Fn(&Point3<f64>) -> f64| {
            (0..points.len())
                .map(|i| (far(&points[i]), i))
                .max_by(|x, y| x.0.total_cmp(&y.0))
                .ok_or(ParryError::Flat)
        };
        let (_, a) = farthest(&|p| -p.x)?;
        let (length, b) = farthest(&|p| (p - points[a]).norm())?;
        let along = points[b] - points[a];
        let (area, c) = farthest(&|p| along.cross(&(p - points[a])).norm())?;
        let height = |p: &Point3<f64>| orient([&points[a], &points[b], &points[c]], p);
        let (volume, d) = farthest(&|p| height(p).abs())?;
        // Area and volume of a parallelogram and a parallelepiped; false for NaN too.
        let thick = area > FLAT * length * length && volume > FLAT * length * area;
        if !thick {
            return Err(ParryError::Flat);
        }
        let [b, c] = if height(&points[d]) < 0.0 { [b, c] } else { [c, b] };
        // The fourth is below a, b, c; each of the others has the three beside it across.
        let facet = |corners, across| Facet { corners, across, outside: Vec::new(), alive: true };
        let facets = vec![
            facet([a, b, c], [1, 2, 3]),
            facet([b, a, d], [0, 3, 2]),
            facet([c, b, d], [0, 1, 3]),
            facet([a, c, d], [0, 2, 1]),
        ];
        let mut hull = Self { points, facets, open: vec![0, 1, 2, 3] };
        hull.assign(0..points.len(), 0);
        Ok(hull)
    }

    /// The height of a point over a facet: above 0 when the facet can be seen from there, 0 in its plane, with exact sign.
    fn height(&self, facet: usize, point: usize) -> f64 {
        orient(self.facets[facet].corners.map(|i| &self.points[i]), &self.points[point])
    }

    /// Gives each of the points to a facet, from number `first` on, that can be seen from there.
    fn assign(&mut self, points: impl IntoIterator<Item = usize>, first: usize) {
        for point in points {
            if let Some(facet) = (first..self.facets.len()).find(|&facet| self.height(facet, point) > 0.0) {
                self.facets[facet].outside.push(point);
            }
        }
    }

    /// A facet with points outside.
    fn next(&mut self) -> Option<usize> {
        while let Some(facet) = self.open.pop() {
            if self.facets[facet].alive && !self.facets[facet].outside.is_empty() {
                return Some(facet);
            }
        }
        None
    }

    /// Takes in the farthest point outside of a facet.
    fn grow(&mut self, facet: usize) -> Result<(), ParryError> {
        let outside = self.facets[facet].outside.iter();
        let heights = outside.map(|&point| (self.height(facet, point), point));
        let Some((_, apex)) = heights.max_by(|x, y| x.0.total_cmp(&y.0)) else { return Ok(()) };
        // The facets that can be seen from it are connected; facets in one plane with it stay.
        let (mut horizon, mut seen) = (Vec::new(), vec![facet]);
        self.facets[facet].alive = false;
        let mut next = 0;
        while let Some(&visible) = seen.get(next) {
            next += 1;
            let Facet { corners, across, .. } = self.facets[visible];
            for k in 0..3 {
                let other = across[k];
                if !self.facets[other].alive {
                    continue;
                }
                if self.height(other, apex) > 0.0 {
                    self.facets[other].alive = false;
                    seen.push(other);
                } else {
                    horizon.push((corners[k], corners[(k + 1) % 3], other));
                }
            }
        }
        // A fan from the edges of the horizon to the point. The horizon is a closed loop: one edge starts at each corner.
        let first = self.facets.len();
        let number = |i: usize| first + i;
        let from: HashMap<usize, usize> =
            horizon.iter().enumerate().map(|(i, edge)| (edge.0, number(i))).collect();
        let to: HashMap<usize, usize> =
            horizon.iter().enumerate().map(|(i, edge)| (edge.1, number(i))).collect();
        for (i, &(a, b, hidden)) in horizon.iter().enumerate() {
            let (Some(&next), Some(&previous)) = (from.get(&b), to.get(&a)) else {
                return Err(ParryError::TooClose);
            };
            let across = [hidden, next, previous];
            self.facets.push(Facet { corners: [a, b, apex], across, outside: Vec::new(), alive: true });
            let back = &mut self.facets[hidden];
            let Some(k) = (0..3).find(|&k| back.corners[k] == b && back.corners[(k + 1) % 3] == a) else {
                return Err(ParryError::TooClose);
            };
            back.across[k] = number(i);
        }
        for visible in seen {
            let outside = std::mem::take(&mut self.facets[visible].outside);
            self.assign(outside, first);
        }
        self.open.extend(first..self.facets.len());
        Ok(())
    }
}

/// Six times the volume of a triangle and a point: above 0 when the corners run counter-clockwise seen from there. The sign
/// is exact.
fn orient(triangle: [&Point3<f64>; 3], p: &Point3<f64>) -> f64 {
    let coord = |p: &Point3<f64>| Coord3D { x: p.x, y: p.y, z: p.z };
    let [a, b, c] = triangle.map(coord);
    -orient3d(a, b, c, coord(p))
}
