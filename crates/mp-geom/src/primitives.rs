//! Closed solids with outward triangles, in metres: what is inside belongs to them ([`TriMesh::solids`]).
//!
//! All are centred on the origin with their axis along Z, except [`prism`] and [`tetrahedron_of`], whose
//! corners are given. Curved ones are inscribed: vertices lie on the surface, the mesh inside it.

use crate::{
    MeshError, TriMesh,
    triangulate::{is_simple, triangulate_ccw},
};
use nalgebra::{Point2, Point3, Vector3};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, TAU};
use thiserror::Error;

/// The most segments around a curved primitive.
pub const MAX_SEGMENTS: u32 = 4096;
/// The most subdivisions of [`sphere`]: 1.3 million triangles.
pub const MAX_SUBDIVISIONS: u32 = 8;

/// Why a primitive could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PrimitiveError {
    /// A length that must be positive and finite is not.
    #[error("the {what} must be positive and finite, not {value}")]
    NotPositive {
        /// Which length.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// A count is out of its range.
    #[error("the number of {what} must be {min} to {max}, not {value}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// Least.
        min: u32,
        /// Most.
        max: u32,
        /// What was given.
        value: u32,
    },
    /// The tube of a torus must be thinner than its ring.
    #[error("the tube radius {tube} of a torus must be smaller than its ring radius {ring}")]
    FatTorus {
        /// Ring radius.
        ring: f64,
        /// Tube radius.
        tube: f64,
    },
    /// A prism needs `z_min < z_max`.
    #[error("the prism has no height: z from {z_min} to {z_max}")]
    NoHeight {
        /// Bottom.
        z_min: f64,
        /// Top.
        z_max: f64,
    },
    /// The polygon has fewer than three corners, repeats a point, or touches or crosses itself.
    #[error("the polygon of a prism must be simple: three corners or more, touching itself nowhere")]
    NotSimple,
    /// The four corners are in one plane.
    #[error("the corners of the tetrahedron are in one plane")]
    Flat,
    /// There is no inside.
    #[error("{what} has no inside")]
    NoInside {
        /// What was to be a solid.
        what: &'static str,
    },
    /// The resulting mesh is invalid, such as by overflow.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

type Made = Result<TriMesh, PrimitiveError>;

/// `value`, if it is positive and finite.
///
/// # Errors
/// [`PrimitiveError::NotPositive`], which names it `what`.
pub fn positive(what: &'static str, value: f64) -> Result<f64, PrimitiveError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(PrimitiveError::NotPositive { what, value })
    }
}

fn count(what: &'static str, value: u32, min: u32, max: u32) -> Result<u32, PrimitiveError> {
    if (min..=max).contains(&value) {
        Ok(value)
    } else {
        Err(PrimitiveError::Count { what, min, max, value })
    }
}

/// A box with sides of length `x`, `y`, `z`: 12 triangles.
///
/// # Errors
/// [`PrimitiveError::NotPositive`].
pub fn cuboid(x: f64, y: f64, z: f64) -> Made {
    let half = [positive("length in x", x)?, positive("length in y", y)?, positive("length in z", z)?]
        .map(|s| s * 0.5);
    let vertices = (0..8)
        .map(|k| Point3::from(Vector3::from_fn(|i, _| if k >> i & 1 == 1 { half[i] } else { -half[i] })))
        .collect();
    let quads: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Ok(TriMesh::new(vertices, triangles)?.trusted_solid())
}

/// A sphere: an icosahedron whose triangles are split in four `subdivisions` times (0 to
/// [`MAX_SUBDIVISIONS`]), 20·4ⁿ triangles.
///
/// # Errors
/// [`PrimitiveError::NotPositive`] or [`PrimitiveError::Count`].
pub fn sphere(radius: f64, subdivisions: u32) -> Made {
    positive("radius", radius)?;
    count("subdivisions", subdivisions, 0, MAX_SUBDIVISIONS)?;
    let golden = (1.0 + 5.0_f64.sqrt()) * 0.5;
    let mut directions = Vec::new();
    for [a, b] in [[-1.0, golden], [1.0, golden], [-1.0, -golden], [1.0, -golden]] {
        directions.push(Vector3::new(a, b, 0.0).normalize());
    }
    for k in [1, 2] {
        for i in 0..4 {
            let v = directions[i];
            // The same four, with the axes turned round.
            directions.push(Vector3::from_fn(|r, _| v[(r + 3 - k) % 3]));
        }
    }
    // Every three vertices an edge apart, oriented outward.
    let edge = 2.0 / (1.0 + golden * golden).sqrt() + 1e-6;
    let near = |a: usize, b: usize| (directions[a] - directions[b]).norm() < edge;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let out = directions[a].cross(&directions[b]).dot(&directions[c]) > 0.0;
                    triangles.push(if out { [a, b, c] } else { [a, c, b] }.map(|i| i as u32));
                }
            }
        }
    }
    for _ in 0..subdivisions {
        let mut middles = HashMap::new();
        let mut split = Vec::with_capacity(triangles.len() * 4);
        for &[a, b, c] in &triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    directions.push((directions[p as usize] + directions[q as usize]).normalize());
                    directions.len() as u32 - 1
                })
            });
            split.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = split;
    }
    let vertices = directions.iter().map(|d| Point3::from(d * radius)).collect();
    Ok(TriMesh::new(vertices, triangles)?.trusted_solid())
}

/// A cone of `height` over a disc of `radius`, apex up.
///
/// # Errors
/// [`PrimitiveError::NotPositive`] or [`PrimitiveError::Count`] (3 to [`MAX_SEGMENTS`] segments).
pub fn cone(radius: f64, height: f64, segments: u32) -> Made {
    let (r, h) = (positive("radius", radius)?, positive("height", height)? * 0.5);
    revolve(&[(0.0, -h), (r, -h), (0.0, h)], segments)
}

/// A cylinder.
///
/// # Errors
/// As [`cone`].
pub fn cylinder(radius: f64, height: f64, segments: u32) -> Made {
    let (r, h) = (positive("radius", radius)?, positive("height", height)? * 0.5);
    revolve(&[(0.0, -h), (r, -h), (r, h), (0.0, h)], segments)
}

/// All points within `radius` of a segment of `length` along Z, with `rings` bands of triangles on each
/// half sphere. Its height is `length + 2·radius`.
///
/// # Errors
/// As [`cone`]; 1 to [`MAX_SEGMENTS`] rings.
pub fn capsule(radius: f64, length: f64, segments: u32, rings: u32) -> Made {
    let (r, h) = (positive("radius", radius)?, positive("length", length)? * 0.5);
    count("rings", rings, 1, MAX_SEGMENTS)?;
    let mut profile = vec![(0.0, -h - r)];
    for k in 1..=rings {
        let (s, c) = mp_math::sin_cos(FRAC_PI_2 * f64::from(k) / f64::from(rings));
        profile.push(if k == rings { (r, -h) } else { (r * s, -h - r * c) });
    }
    profile.extend(profile.clone().into_iter().rev().map(|(r, z)| (r, -z)));
    revolve(&profile, segments)
}

/// A torus about Z: a tube of radius `tube` around a circle of radius `ring`.
///
/// # Errors
/// As [`cone`], and [`PrimitiveError::FatTorus`] unless `tube < ring`.
pub fn torus(ring: f64, tube: f64, segments: u32, tube_segments: u32) -> Made {
    positive("ring radius", ring)?;
    positive("tube radius", tube)?;
    if tube >= ring {
        return Err(PrimitiveError::FatTorus { ring, tube });
    }
    let n = count("segments", segments, 3, MAX_SEGMENTS)?;
    let m = count("tube segments", tube_segments, 3, MAX_SEGMENTS)?;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..n {
        let around = circle_point(i, n);
        for j in 0..m {
            let (s, c) = mp_math::sin_cos(TAU * f64::from(j) / f64::from(m));
            let r = ring + tube * c;
            vertices.push(Point3::new(r * around.x, r * around.y, tube * s));
            let at = |i: u32, j: u32| (i % n) * m + j % m;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Ok(TriMesh::new(vertices, triangles)?.trusted_solid())
}

/// A regular tetrahedron centred on the origin with edges of length `edge`, one corner up.
///
/// # Errors
/// [`PrimitiveError::NotPositive`].
pub fn tetrahedron(edge: f64) -> Made {
    let a = positive("edge", edge)?;
    let (r, low) = (a / 3.0_f64.sqrt(), -a / 24.0_f64.sqrt());
    let base = |k: u32| {
        let p = circle_point(k, 3) * r;
        Point3::new(p.x, p.y, low)
    };
    tetrahedron_of([base(0), base(1), base(2), Point3::new(0.0, 0.0, -3.0 * low)])
}

/// The tetrahedron of four corners, in any order.
///
/// # Errors
/// [`PrimitiveError::Flat`] when they are in one plane, as far as rounding tells.
pub fn tetrahedron_of(corners: [Point3<f64>; 4]) -> Made {
    let [a, b, c, d] = corners;
    let (u, v, w) = (b - a, c - a, d - a);
    let volume = u.cross(&v).dot(&w);
    let scale = u.norm().max(v.norm()).max(w.norm());
    // NaN passes here: the mesh reports it.
    if volume.abs() <= 1e-14 * mp_math::powi(scale, 3) {
        return Err(PrimitiveError::Flat);
    }
    let mut mesh = TriMesh::new(corners.to_vec(), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
    if volume < 0.0 {
        mesh = mesh.reversed();
    }
    Ok(mesh.trusted_solid())
}

/// The prism over a simple polygon, possibly concave, in either direction, from `z_min` to `z_max`.
///
/// # Errors
/// [`PrimitiveError::NotSimple`], [`PrimitiveError::NoHeight`], or [`PrimitiveError::Mesh`] for coordinates
/// that are not finite.
pub fn prism(polygon: &[Point2<f64>], z_min: f64, z_max: f64) -> Made {
    if !(z_min < z_max && (z_max - z_min).is_finite()) {
        return Err(PrimitiveError::NoHeight { z_min, z_max });
    }
    if polygon.iter().all(|p| p.iter().all(|c| c.is_finite())) && !is_simple(polygon) {
        return Err(PrimitiveError::NotSimple);
    }
    let n = polygon.len();
    let origin = polygon.first().copied().unwrap_or_else(Point2::origin);
    let doubled_area: f64 =
        (0..n).map(|i| (polygon[i] - origin).perp(&(polygon[(i + 1) % n] - origin))).sum();
    let mut corners = polygon.to_vec();
    if doubled_area < 0.0 {
        corners.reverse();
    }
    let level = |z: f64| corners.iter().map(move |p| Point3::new(p.x, p.y, z));
    let vertices: Vec<_> = level(z_min).chain(level(z_max)).collect();
    // Checks coordinates before the predicates see them.
    TriMesh::new(vertices.clone(), vec![[0; 3]])?;
    let mut triangles = Vec::with_capacity(4 * n);
    for t in triangulate_ccw(&corners) {
        let [a, b, c] = t.map(|i| i as u32);
        let up = n as u32;
        triangles.extend([[a, c, b], [a + up, b + up, c + up]]);
    }
    for i in 0..n {
        let [a, b, c, d] = [i, (i + 1) % n, (i + 1) % n + n, i + n].map(|i| i as u32);
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    Ok(TriMesh::new(vertices, triangles)?.trusted_solid())
}

/// Point `k` of `n` on the unit circle.
fn circle_point(k: u32, n: u32) -> Vector3<f64> {
    let (s, c) = mp_math::sin_cos(TAU * f64::from(k) / f64::from(n));
    Vector3::new(c, s, 0.0)
}

/// The solid swept by turning a profile of (distance from Z, height), from its lower pole to its upper
/// one, about Z. Distance 0 is a pole: a single vertex.
fn revolve(profile: &[(f64, f64)], segments: u32) -> Made {
    let n = count("segments", segments, 3, MAX_SEGMENTS)?;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    let mut below: Option<(u32, bool)> = None;
    for &(r, z) in profile {
        let (first, pole) = (vertices.len() as u32, r == 0.0);
        if pole {
            vertices.push(Point3::new(0.0, 0.0, z));
        } else {
            vertices.extend((0..n).map(|k| {
                let p = circle_point(k, n) * r;
                Point3::new(p.x, p.y, z)
            }));
        }
        if let Some((base, base_pole)) = below {
            for k in 0..n {
                let at = |start: u32, pole: bool, k: u32| if pole { start } else { start + k % n };
                let (a, b) = (at(base, base_pole, k), at(base, base_pole, k + 1));
                let (c, d) = (at(first, pole, k + 1), at(first, pole, k));
                if a != b {
                    triangles.push([a, b, c]);
                }
                if c != d {
                    triangles.push([a, c, d]);
                }
            }
        }
        below = Some((first, pole));
    }
    Ok(TriMesh::new(vertices, triangles)?.trusted_solid())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Six times the signed volume.
    fn volume(mesh: &TriMesh) -> f64 {
        let tri = |i| mesh.triangle(i).map(|p| p.coords);
        (0..mesh.triangles().len()).map(tri).map(|[a, b, c]| a.cross(&b).dot(&c)).sum::<f64>() / 6.0
    }

    fn check_solid(mesh: &TriMesh, euler: i64, exact_volume: f64) -> Result<(), TestCaseError> {
        let t = mesh.topology();
        prop_assert!(t.is_solid(), "{:?}", t);
        prop_assert!(t.degenerate.is_empty() && t.duplicates.is_empty());
        prop_assert_eq!((t.components, t.euler_characteristic()), (1, euler));
        prop_assert_eq!(t.vertices, mesh.vertices().len(), "no vertex unused or repeated");
        prop_assert!(t.neighbours.iter().flatten().all(Option::is_some));
        let volume = volume(mesh);
        prop_assert!((volume - exact_volume).abs() <= 1e-9 * exact_volume, "{} {}", volume, exact_volume);
        Ok(())
    }

    /// Area of the regular n-gon in the unit circle.
    fn disc(n: u32) -> f64 {
        0.5 * f64::from(n) * mp_math::sin(TAU / f64::from(n))
    }

    proptest! {
        #[test]
        fn primitives_are_solid(r in 0.01..10.0_f64, h in 0.01..10.0_f64, n in 3_u32..24, m in 1_u32..8) {
            check_solid(&cuboid(r, h, 2.0).unwrap(), 2, r * h * 2.0)?;
            check_solid(&cone(r, h, n).unwrap(), 2, disc(n) * r * r * h / 3.0)?;
            check_solid(&cylinder(r, h, n).unwrap(), 2, disc(n) * r * r * h)?;
            check_solid(&tetrahedron(r).unwrap(), 2, mp_math::powi(r, 3) / (6.0 * 2.0_f64.sqrt()))?;
            let c = capsule(r, h, n, m).unwrap();
            // Each half sphere is a stack of frusta over similar n-gons.
            let ring = |k: u32| mp_math::sin_cos(FRAC_PI_2 * f64::from(k) / f64::from(m));
            let half: f64 = (0..m).map(|k| {
                let ((s0, c0), (s1, c1)) = (ring(k), ring(k + 1));
                (c0 - c1) * (s0 * s0 + s0 * s1 + s1 * s1) / 3.0
            }).sum();
            check_solid(&c, 2, disc(n) * r * r * (h + 2.0 * half * r))?;
            prop_assert!((c.aabb().max.z - (0.5 * h + r)).abs() < 1e-12);
            let tube = r * 0.4;
            // Pappus: area of the tube's n-gon times the way of its centroid, along a polygon.
            let exact = disc(m + 2) * tube * tube * disc(n) * 2.0 * r;
            check_solid(&torus(r, tube, n, m + 2).unwrap(), 0, exact)?;
        }

        #[test]
        fn prisms_over_concave_polygons(radii in prop::collection::vec(0.05..1.0_f64, 3..20), z in -5.0..5.0_f64, h in 0.01..3.0_f64, reverse in any::<bool>()) {
            let n = radii.len();
            let mut polygon: Vec<_> = (0..n).map(|i| {
                let p = circle_point(i as u32, n as u32) * radii[i];
                Point2::new(p.x, p.y)
            }).collect();
            if reverse {
                polygon.reverse();
            }
            let wedges: f64 = (0..n).map(|i| radii[i] * radii[(i + 1) % n]).sum();
            check_solid(&prism(&polygon, z, z + h).unwrap(), 2, 0.5 * mp_math::sin(TAU / n as f64) * wedges * h)?;
        }

        #[test]
        fn tetrahedra_of_corners_in_any_order(c in prop::array::uniform4(prop::array::uniform3(-1.0..1.0_f64))) {
            let corners = c.map(Point3::from);
            let exact = ((corners[1] - corners[0]).cross(&(corners[2] - corners[0]))).dot(&(corners[3] - corners[0])).abs() / 6.0;
            prop_assume!(exact > 1e-6);
            check_solid(&tetrahedron_of(corners).unwrap(), 2, exact)?;
        }
    }

    #[test]
    fn spheres_grow_toward_the_ball() {
        for s in 0..5 {
            let mesh = sphere(2.0, s).unwrap();
            check_solid(&mesh, 2, volume(&mesh)).unwrap();
            assert_eq!(mesh.triangles().len(), 20 << (2 * s));
            assert!(mesh.vertices().iter().all(|p| (p.coords.norm() - 2.0).abs() < 1e-14));
            let missing = 1.0 - volume(&mesh) / (TAU * 16.0 / 3.0);
            assert!(missing > 0.0 && missing < 0.6 / f64::from(1 << (2 * s)), "{s}: {missing}");
        }
    }

    #[test]
    fn bad_parameters() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for made in [
                cuboid(1.0, bad, 1.0),
                sphere(bad, 1),
                cone(bad, 1.0, 8),
                cylinder(1.0, bad, 8),
                capsule(1.0, bad, 8, 2),
                torus(bad, 0.1, 8, 8),
                tetrahedron(bad),
            ] {
                assert!(matches!(made, Err(PrimitiveError::NotPositive { .. })), "{made:?}");
            }
        }
        for made in [
            sphere(1.0, 9),
            cone(1.0, 1.0, 2),
            cylinder(1.0, 1.0, 5000),
            capsule(1.0, 1.0, 8, 0),
            torus(1.0, 0.1, 8, 2),
        ] {
            assert!(matches!(made, Err(PrimitiveError::Count { .. })), "{made:?}");
        }
        assert_eq!(torus(1.0, 1.0, 8, 8), Err(PrimitiveError::FatTorus { ring: 1.0, tube: 1.0 }));
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
        assert_eq!(prism(&square, 1.0, 1.0), Err(PrimitiveError::NoHeight { z_min: 1.0, z_max: 1.0 }));
        assert!(matches!(prism(&square, f64::NAN, 1.0), Err(PrimitiveError::NoHeight { .. })));
        let bow_tie = [square[0], square[2], square[1], square[3]];
        assert_eq!(prism(&bow_tie, 0.0, 1.0), Err(PrimitiveError::NotSimple));
        assert_eq!(prism(&[], 0.0, 1.0), Err(PrimitiveError::NotSimple));
        let nan = [square[0], square[1], Point2::new(f64::NAN, 0.0)];
        assert!(matches!(prism(&nan, 0.0, 1.0), Err(PrimitiveError::Mesh(MeshError::NotFinite { .. }))));
        assert_eq!(tetrahedron_of([Point3::origin(); 4]), Err(PrimitiveError::Flat));
    }
}
