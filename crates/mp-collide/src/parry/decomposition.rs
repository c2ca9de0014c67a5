//! Convex decompositions: cuts by parry's V-HACD, hulls of the exact pieces.
//!
//! V-HACD cuts along planes of its voxels, so the voxels of a part fill a box, except for voxels outside of the mesh. The
//! hull of the part is that of the triangles clipped to the box and of the corners of the box that are inside the mesh.
//! (Hulls of voxels would be up to a voxel larger; those that parry makes of clipped triangles miss such corners.)

use std::collections::HashSet;

use mp_geom::TriMesh;
use nalgebra::{Point3, Vector3};
use parry3d_f64::transformation::vhacd::{VHACD, VHACDParameters};
use parry3d_f64::transformation::voxelization::VoxelSet;

use super::hull::{convex_hull, hull_of};
use super::{ParryError, guarded, point_from_parry, point_to_parry};
use crate::mesh::CollisionMesh;
use crate::query::Query;

/// How finely [`convex_decomposition`] cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decomposition {
    /// Voxels along the longest side of the mesh's box, 8 to 256: features thinner than a voxel are not cut. Time and memory
    /// grow with its cube.
    pub resolution: u32,
    /// The volume by which the hull of a part may exceed the part, by its voxels, as a fraction of the volume of the hull
    /// of the mesh, 0 to 1. Parts are cut no further when there are `max_parts`.
    pub concavity: f64,
    /// The largest number of parts, 4 to 4096; rounded down to a power of two.
    pub max_parts: u32,
}

impl Default for Decomposition {
    /// 64 voxels, 1%, 64 parts.
    fn default() -> Self {
        Self { resolution: 64, concavity: 0.01, max_parts: 64 }
    }
}

/// Convex meshes that together cover `mesh`: its triangles and, when it [bounds a solid](mp_geom::Topology::is_solid), the
/// inside, up to rounding at the cuts, about 1e-15 of its size. They cover more where pieces are not convex, and where a
/// part is flat, which is thickened by half a voxel on all sides. The inside of a mesh that is not closed is what its
/// voxels enclose. A mesh that is convex (to `concavity`) is one part, its [hull](convex_hull). The
/// same mesh and parameters give the same parts.
///
/// V-HACD (Mamou, *Volumetric hierarchical approximate convex decomposition*, in *Game Engine Gems 3*, 2016) by parry: some
/// tenths of a second at 64 voxels, and O(n) for each part in the number of triangles.
///
/// ```
/// use mp_collide::parry::{Decomposition, convex_decomposition};
///
/// let ring = mp_geom::primitives::torus(1.0, 0.25, 16, 8)?;
/// let parts = convex_decomposition(&ring, &Decomposition { resolution: 24, ..Decomposition::default() })?;
/// assert!(parts.len() > 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ParryError::Parameter`], [`ParryError::Flat`] when the mesh is a point, [`ParryError::TooClose`],
/// [`ParryError::Failed`].
pub fn convex_decomposition(mesh: &TriMesh, params: &Decomposition) -> Result<Vec<TriMesh>, ParryError> {
    let parameters = checked(params)?;
    // Without the vertices that no triangle uses.
    let triangles: Vec<_> = (0..mesh.triangles().len()).map(|i| mesh.triangle(i)).collect();
    let mesh = TriMesh::from_soup(&triangles)?;
    let (low, high) = bounds(mesh.vertices()).ok_or(ParryError::Flat)?;
    // Scaled so that squares and cubes in parry do not overflow; powers of two change no digits.
    let size = low.coords.amax().max(high.coords.amax());
    let scale = mp_math::exp2(mp_math::log2(size).floor().clamp(-1000.0, 1000.0));
    if (high - low).amax() / scale <= f64::EPSILON {
        return Err(ParryError::Flat);
    }
    let scaled = resized(&mesh, 1.0 / scale)?;
    let mut part_points = PartPoints::new(&scaled);
    // Voxels would turn convex but slanted surfaces into steps.
    if part_points.solid
        && let Ok(hull) = convex_hull(&scaled)
        && hull.signed_volume() - scaled.signed_volume() <= params.concavity * hull.signed_volume()
    {
        return Ok(vec![resized(&hull, scale)?]);
    }
    let points: Vec<_> = scaled.vertices().iter().map(point_to_parry).collect();
    let cut = || VHACD::decompose(&parameters, &points, scaled.triangles(), false);
    let cuts = guarded("convex decomposition", cut)?;

    let mut parts = Vec::new();
    for voxels in cuts.voxel_parts() {
        let points = part_points.points(voxels);
        if points.is_empty() {
            continue;
        }
        let hull = hull_of(&points).or_else(|_| hull_of(&thickened(&points, 0.5 * voxels.scale)))?;
        parts.push(resized(&hull, scale)?);
    }
    Ok(parts)
}

/// The mesh `scale` times as large.
fn resized(mesh: &TriMesh, scale: f64) -> Result<TriMesh, ParryError> {
    Ok(TriMesh::new(mesh.vertices().iter().map(|p| p * scale).collect(), mesh.triangles().to_vec())?)
}

/// parry's parameters, when ours are in range.
fn checked(params: &Decomposition) -> Result<VHACDParameters, ParryError> {
    let &Decomposition { resolution, concavity, max_parts } = params;
    let wrong = |name, value, range| Err(ParryError::Parameter { name, value, range });
    if !(8..=256).contains(&resolution) {
        return wrong("the resolution of a decomposition", f64::from(resolution), "8 to 256");
    }
    if !(0.0..=1.0).contains(&concavity) {
        return wrong("the concavity of a decomposition", concavity, "0 to 1");
    }
    if !(4..=4096).contains(&max_parts) {
        return wrong("the largest number of parts", f64::from(max_parts), "4 to 4096");
    }
    // parry halves once more than this number of hulls asks for, and does not merge afterwards.
    let max_convex_hulls = 1 << (max_parts.ilog2() - 1);
    // Hulls of all voxels: with downsampling parry finds even a cube concave.
    let convex_hull_downsampling = 1;
    let others = VHACDParameters::default();
    Ok(VHACDParameters { resolution, concavity, max_convex_hulls, convex_hull_downsampling, ..others })
}

/// Finds the points whose hulls are the parts.
struct PartPoints<'a> {
    mesh: &'a TriMesh,
    tree: CollisionMesh,
    query: Query,
    /// Whether the surface bounds a solid; otherwise voxels decide what is inside.
    solid: bool,
}

impl<'a> PartPoints<'a> {
    fn new(mesh: &'a TriMesh) -> Self {
        let solid = mesh.topology().is_solid() && mesh.signed_volume() > 0.0;
        Self { mesh, tree: CollisionMesh::new(mesh), query: Query::default(), solid }
    }

    /// Points whose hull is that of the mesh within the box of a part.
    fn points(&mut self, voxels: &VoxelSet) -> Vec<Point3<f64>> {
        let cells = voxels.voxels().iter().map(|voxel| voxel.coords.to_array());
        let Some([first, last]) = cells.clone().fold(None, |range: Option<[[i64; 3]; 2]>, cell| {
            let [low, high] = range.unwrap_or([cell; 2]);
            let with = |by: fn(i64, i64) -> i64, end: [i64; 3]| [0, 1, 2].map(|k| by(end[k], cell[k]));
            Some([with(i64::min, low), with(i64::max, high)])
        }) else {
            return Vec::new();
        };
        let origin = point_from_parry(voxels.origin);
        let side =
            |cell: [i64; 3], half| origin + Vector3::from(cell.map(|c| (c as f64 + half) * voxels.scale));
        let (low, high) = (side(first, -0.5), side(last, 0.5));
        let mut points = Vec::new();
        for i in 0..self.mesh.triangles().len() {
            clip(self.mesh.triangle(i), &low, &high, &mut points);
        }
        let occupied: HashSet<[i64; 3]> = if self.solid { HashSet::new() } else { cells.collect() };
        for corner in 0..8 {
            let up = |k: usize| corner >> k & 1 == 1;
            let p = Point3::from(Vector3::from_fn(|k, _| if up(k) { high[k] } else { low[k] }));
            let inside = if self.solid {
                let (stack, counters) = (&mut self.query.stack, &mut self.query.counters);
                self.tree.tree().winding(&p, &[0..u32::MAX], stack, counters).is_none_or(|turns| turns > 0)
            } else {
                occupied.contains(&[0, 1, 2].map(|k| if up(k) { last[k] } else { first[k] }))
            };
            if inside {
                points.push(p);
            }
        }
        points
    }
}

/// Adds the corners of a triangle clipped to a box (Sutherland and Hodgman, *Reentrant polygon clipping*, 1974).
fn clip(triangle: [Point3<f64>; 3], low: &Point3<f64>, high: &Point3<f64>, points: &mut Vec<Point3<f64>>) {
    let mut polygon = triangle.to_vec();
    for k in 0..3 {
        for (sign, limit) in [(1.0, low[k]), (-1.0, high[k])] {
            let depth = |p: &Point3<f64>| sign * (p[k] - limit);
            if polygon.iter().all(|p| depth(p) >= 0.0) {
                continue;
            }
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for (i, p) in polygon.iter().enumerate() {
                let next = &polygon[(i + 1) % polygon.len()];
                let (here, there) = (depth(p), depth(next));
                if here >= 0.0 {
                    kept.push(*p);
                }
                if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
                    let mut cut = p + (next - p) * (here / (here - there));
                    cut[k] = limit;
                    kept.push(cut);
                }
            }
            polygon = kept;
        }
    }
    points.extend(polygon);
}

/// The corners of cubes of this half edge about points.
fn thickened(points: &[Point3<f64>], half: f64) -> Vec<Point3<f64>> {
    let shift = |corner: usize| Vector3::from_fn(|k, _| if corner >> k & 1 == 1 { half } else { -half });
    points.iter().flat_map(|p| (0..8).map(move |corner| p + shift(corner))).collect()
}

/// The box around points.
fn bounds(points: &[Point3<f64>]) -> Option<(Point3<f64>, Point3<f64>)> {
    let first = *points.first()?;
    Some(points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p))))
}
