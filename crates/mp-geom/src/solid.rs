//! Meshes as solids: which triangles have an inside.

use crate::mesh::check_finite;
use crate::{MeshError, TriMesh};
use nalgebra::Point3;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;
use thiserror::Error;

/// At most this many parts of a mesh count as few.
const FEW: usize = 32;

/// Why a mesh is no solid.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SolidError {
    /// An edge has an odd number of triangles.
    #[error("the surface is not closed: {edges} edges have a triangle on one side only")]
    Open {
        /// Edges with an odd number of triangles.
        edges: usize,
    },
    /// Neighbouring triangles have opposite orientations.
    #[error("the surface is not oriented: the triangles at {edges} edges are turned against each other")]
    NotOriented {
        /// Edges whose two triangles run the same way along them.
        edges: usize,
    },
    /// It encloses no volume.
    #[error("the surface encloses no volume")]
    Flat,
    /// Some components face outward, and one that is not inside of them inward.
    #[error("one component of the surface faces inward, others outward, and it is no cavity of these")]
    Mixed,
    /// The triangles of some components are there once for each side, those of others are not.
    #[error(
        "the triangles of one component are there once for each side, those of others are not: nothing says what is inside"
    )]
    TwoSided,
}

/// Whether the surface is that of a solid: closed, oriented and around a volume.
fn bounds_volume(mesh: &TriMesh) -> bool {
    mesh.is_closed_and_oriented() && mesh.encloses_volume()
}

/// A winding number of at least this is taken for that of a component with others around it, which it may
/// touch.
const AROUND: f64 = 0.1;

/// Whether a component is a cavity is asked at corners of at most this many of its triangles: one that crosses others is none.
const LOOKED_AT: usize = 16;

impl TriMesh {
    /// The solids: the triangles of each, ascending. The triangles of a solid are a closed surface that faces
    /// outward; the solid is that surface and the points around which it winds. Solids may overlap. Triangles
    /// that belong to no solid are surfaces.
    #[must_use]
    pub fn solids(&self) -> &[Range<u32>] {
        &self.solids
    }

    /// The mesh as a solid. A mesh that faces inward is reversed, and one whose triangles are all there for both sides keeps
    /// one of them. Components that face inward inside of others are cavities.
    ///
    /// # Errors
    /// [`SolidError`] when it is not closed or not consistently oriented, vertices in one place counting as
    /// one, or encloses no volume, or a component faces inward that is no cavity, or only some components are there for both sides.
    pub fn into_solid(self) -> Result<Self, SolidError> {
        if !self.is_closed_and_oriented() {
            let found = self.topology();
            return Err(match found.misoriented_edges.len() {
                edges if found.closed => SolidError::NotOriented { edges },
                _ if found.edges == 0 => SolidError::Flat,
                _ => SolidError::Open { edges: found.boundary_edges.len().max(1) },
            });
        }
        if !self.encloses_volume() {
            return match self.one_side().filter(bounds_volume) {
                Some(side) => side.into_solid(),
                None if self.parts().iter().any(Self::encloses_volume) => Err(SolidError::Mixed),
                None => Err(SolidError::Flat),
            };
        }
        let mesh = if self.signed_volume() < 0.0 { self.reversed() } else { self };
        let parts: Vec<_> = mesh.parts().into_iter().map(|part| (part.aabb(), part)).collect();
        let is_inside = |i: usize, corner: Point3<f64>| {
            let around =
                parts.iter().enumerate().filter(|(j, (bounds, _))| *j != i && bounds.contains(&corner));
            around.map(|(_, (_, part))| part.winding_number(&corner)).sum::<f64>() > AROUND
        };
        let is_cavity = |i: usize| {
            let part = &parts[i].1;
            let count = part.triangles().len();
            let mut some = (0..count).step_by(count.div_ceil(LOOKED_AT)).flat_map(|k| part.triangle(k));
            some.all(|corner| is_inside(i, corner))
        };
        for (i, (_, part)) in parts.iter().enumerate() {
            // A flat part has no inside, wherever it is.
            if !part.encloses_volume() {
                if part.one_side().is_some_and(|side| bounds_volume(&side)) {
                    return Err(SolidError::TwoSided);
                }
            } else if part.signed_volume() < 0.0 && !is_cavity(i) {
                return Err(SolidError::Mixed);
            }
        }
        Ok(mesh.trusted_solid())
    }

    /// One triangle of each two that are the same but for their sides; `None` unless all triangles come in such pairs.
    #[must_use]
    pub fn one_side(&self) -> Option<Self> {
        /// The corners from the least on, which keeps the side.
        fn turned(corners: [[u64; 3]; 3]) -> [[u64; 3]; 3] {
            let [a, b, c] = corners;
            [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap_or(corners)
        }
        let bits = |i: u32| -> [u64; 3] {
            let v = self.vertices()[i as usize];
            // Zeros of both signs are the same place.
            [v.x, v.y, v.z].map(|x| (x + 0.0).to_bits())
        };
        let mut unpaired: HashMap<_, Vec<u32>> = HashMap::new();
        let mut side = Vec::new();
        for (i, triangle) in (0..).zip(self.triangles()) {
            let [a, b, c] = triangle.map(bits);
            match unpaired.get_mut(&turned([a, c, b])).and_then(Vec::pop) {
                Some(first) => side.push(self.triangles()[first as usize]),
                None => unpaired.entry(turned([a, b, c])).or_default().push(i),
            }
        }
        let paired = !side.is_empty() && unpaired.values().all(Vec::is_empty);
        if paired { Self::new(self.vertices().to_vec(), side).ok() } else { None }
    }

    /// The mesh as a surface: it has no inside.
    #[must_use]
    pub fn into_surface(self) -> Self {
        Self { solids: Arc::default(), ..self }
    }

    /// The mesh, which is closed and faces outward, as a solid.
    pub(crate) fn trusted_solid(self) -> Self {
        Self { solids: Arc::new(vec![0..self.triangles.len() as u32]), ..self }
    }

    /// The mesh, which is `count` equally large closed meshes, one after the other, that face outward: each
    /// is a solid.
    pub(crate) fn trusted_solids(self, count: u32) -> Self {
        let each = self.triangles.len() as u32 / count;
        Self { solids: Arc::new((0..count).map(|i| each * i..each * (i + 1)).collect()), ..self }
    }

    /// The mesh with coordinates scaled about the origin, and the same solids; balls that factors of unequal size make
    /// ellipsoids become [facets](Self::faceted). An odd number of negative factors reverses the triangles, so that
    /// outside stays outside.
    ///
    /// # Errors
    /// When a coordinate is no longer finite.
    pub fn scaled(&self, [x, y, z]: [f64; 3]) -> Result<Self, MeshError> {
        if !self.balls.is_empty() && [y, z].iter().any(|s| s.abs() != x.abs()) {
            return self.faceted().scaled([x, y, z]);
        }
        let vertices: Vec<_> = self.vertices.iter().map(|p| Point3::new(x * p.x, y * p.y, z * p.z)).collect();
        check_finite(&vertices)?;
        let mut scaled = Self { vertices: vertices.into(), ..self.clone() };
        Arc::make_mut(&mut scaled.balls).iter_mut().for_each(|(_, radius)| *radius *= x.abs());
        if [x, y, z].iter().filter(|s| **s < 0.0).count() % 2 == 1 {
            Arc::make_mut(&mut scaled.triangles).iter_mut().for_each(|t| t.swap(1, 2));
        }
        Ok(scaled)
    }

    /// How often the surface winds around `p`: the solid angle of the surface seen from `p`, over 4π, summed
    /// over triangles as in A. van Oosterom and J. Strackee, "The solid angle of a plane triangle", 1983. A
    /// whole number, up to rounding, where the surface is closed and `p` not on it.
    #[must_use]
    pub fn winding_number(&self, p: &Point3<f64>) -> f64 {
        self.winding_number_of(0..self.triangles.len() as u32, p)
    }

    /// [`winding_number`](Self::winding_number) of some of the triangles.
    ///
    /// # Panics
    /// When `triangles` is out of range.
    #[must_use]
    pub fn winding_number_of(&self, triangles: Range<u32>, p: &Point3<f64>) -> f64 {
        let angle: f64 = triangles
            .map(|i| {
                let [a, b, c] = self.triangle(i as usize).map(|v| v - p);
                let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
                let scale = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
                2.0 * mp_math::atan2(a.dot(&b.cross(&c)), scale)
            })
            .sum();
        angle / (4.0 * PI)
    }

    /// A vertex of each connected component, in the order of their first triangles. Triangles that share a
    /// place are connected.
    #[must_use]
    pub fn component_vertices(&self) -> Vec<Point3<f64>> {
        self.first_of_components(&self.names())
    }

    /// A vertex of each part of the mesh whose triangles are connected by shared vertices, where there are few such parts; places are not
    /// compared. So each [component](Self::component_vertices) has at least one. O(n).
    #[must_use]
    pub fn vertices_of_few_parts(&self) -> Option<Vec<Point3<f64>>> {
        let by_number: Vec<u32> = (0..self.vertices.len() as u32).collect();
        Some(self.first_of_components(&by_number)).filter(|found| found.len() <= FEW)
    }

    /// A vertex of each connected component, where vertices of the same name count as one.
    fn first_of_components(&self, names: &[u32]) -> Vec<Point3<f64>> {
        let mut above: Vec<u32> = (0..names.len() as u32).collect();
        let root = |above: &mut Vec<u32>, v: u32| {
            let mut i = names[v as usize];
            while above[i as usize] != i {
                above[i as usize] = above[above[i as usize] as usize];
                i = above[i as usize];
            }
            i
        };
        for t in self.triangles() {
            let [a, b, c] = t.map(|v| root(&mut above, v));
            // `b` and `c` may have one root.
            above[b as usize] = a;
            let c = root(&mut above, c);
            above[c as usize] = a;
        }
        let mut known = vec![false; names.len()];
        let first = self.triangles().iter().filter(|t| {
            let root = root(&mut above, t[0]) as usize;
            !std::mem::replace(&mut known[root], true)
        });
        first.map(|t| self.vertices[t[0] as usize]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::{capsule, cone, cuboid, cylinder, prism, sphere, tetrahedron, torus};
    use nalgebra::{Isometry3, Point2, Vector3};
    use proptest::prelude::*;

    fn cube(side: f64) -> TriMesh {
        cuboid(side, side, side).unwrap()
    }

    fn at(mesh: &TriMesh, x: f64) -> TriMesh {
        mesh.transformed(&Isometry3::translation(x, 0.0, 0.0))
    }

    /// How many solids `p` is inside of.
    fn inside(mesh: &TriMesh, p: [f64; 3]) -> usize {
        let around = |solid: &&Range<u32>| mesh.winding_number_of((*solid).clone(), &p.into()) > 0.5;
        mesh.solids().iter().filter(around).count()
    }

    #[test]
    fn primitives_are_solids_and_meshes_are_not() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Point2::from);
        for made in [
            cuboid(1.0, 2.0, 3.0),
            sphere(1.0, 2),
            cylinder(1.0, 1.0, 8),
            cone(1.0, 1.0, 8),
            capsule(1.0, 1.0, 8, 3),
            torus(2.0, 0.5, 8, 6),
            tetrahedron(1.0),
            prism(&square, 0.0, 1.0),
        ] {
            let made = made.unwrap();
            assert_eq!(made.solids(), std::slice::from_ref(&(0..made.triangles().len() as u32)));
            let read = TriMesh::new(made.vertices().to_vec(), made.triangles().to_vec()).unwrap();
            assert!(read.solids().is_empty() && read != made && read == made.clone().into_surface());
            assert_eq!(read.into_solid().unwrap(), made);
        }
    }

    #[test]
    fn solids_stay_solids() {
        let both = TriMesh::merged([&cube(1.0).into_surface(), &at(&cube(2.0), 3.0), &at(&cube(2.0), 4.0)]);
        let both = both.unwrap();
        assert_eq!(both.solids(), [12..24, 24..36]);
        for (x, count) in [(0.0, 0), (2.5, 1), (3.5, 2), (4.5, 1), (5.5, 0)] {
            assert_eq!(inside(&both, [x, 0.1, 0.2]), count, "{x}");
            assert_eq!(inside(&both.welded(), [x, 0.1, 0.2]), count, "{x}");
            assert_eq!(inside(&both.scaled([-2.0, 1.0, 1.0]).unwrap(), [-2.0 * x, 0.1, 0.2]), count, "{x}");
            assert_eq!(inside(&both.scaled([-2.0, 1.0, -1.0]).unwrap(), [-2.0 * x, 0.1, 0.2]), count, "{x}");
            assert_eq!(inside(&at(&both, 7.0), [x + 7.0, 0.1, 0.2]), count, "{x}");
        }
        assert!(both.reversed().solids().is_empty());
        assert!(both.scaled([1.0, f64::INFINITY, 1.0]).is_err());
    }

    #[test]
    fn what_becomes_a_solid() {
        let surface = |mesh: &TriMesh| mesh.clone().into_surface();
        let inward = cube(1.0).reversed();
        assert_eq!(surface(&inward).into_solid().unwrap(), cube(1.0));
        let hollow = TriMesh::merged([&surface(&cube(3.0)), &inward]).unwrap();
        let hollow = hollow.into_solid().unwrap();
        assert_eq!((inside(&hollow, [0.1, 0.2, 0.0]), inside(&hollow, [1.1, 0.2, 0.0])), (0, 1));
        // The shell of the same, turned inside out.
        assert_eq!(hollow.reversed().into_solid().unwrap(), hollow);

        let open = TriMesh::new(cube(1.0).vertices().to_vec(), cube(1.0).triangles()[..10].to_vec());
        assert_eq!(open.unwrap().into_solid(), Err(SolidError::Open { edges: 4 }));
        let mut turned = cube(1.0).triangles().to_vec();
        turned[0].swap(0, 1);
        let turned = TriMesh::new(cube(1.0).vertices().to_vec(), turned).unwrap();
        assert_eq!(turned.into_solid(), Err(SolidError::NotOriented { edges: 3 }));
        let mixed = TriMesh::merged([&cube(3.0), &at(&inward, 9.0)]).unwrap();
        assert_eq!(mixed.into_solid(), Err(SolidError::Mixed));
        for x in [-1.2, 1.2] {
            let crossing = TriMesh::merged([&surface(&cube(3.0)), &at(&inward, x)]).unwrap();
            assert_eq!(crossing.into_solid(), Err(SolidError::Mixed));
        }
        let even = TriMesh::merged([&surface(&cube(1.0)), &at(&inward, 9.0)]).unwrap();
        assert_eq!(even.into_solid(), Err(SolidError::Mixed));
        // As SketchUp writes surfaces: all triangles once for each side.
        for side in [surface(&cube(1.0)), inward.clone()] {
            let both = TriMesh::merged([&side, &side.reversed()]).unwrap().into_solid().unwrap();
            assert_eq!((inside(&both, [0.1, 0.2, 0.0]), both.triangles().len()), (1, 12));
        }
        for x in [0.0, 0.1, 9.0] {
            let some = TriMesh::merged([&inward, &surface(&cube(1.0)), &surface(&at(&cube(2.0), x + 3.0))]);
            assert_eq!(some.unwrap().into_solid(), Err(SolidError::TwoSided));
        }
        let open = TriMesh::new(cube(1.0).vertices().to_vec(), cube(1.0).triangles()[..10].to_vec()).unwrap();
        let open = TriMesh::merged([&open, &open.reversed()]).unwrap();
        assert_eq!(open.into_solid(), Err(SolidError::Flat));

        let sheet = cube(1.0).scaled([1.0, 1.0, 0.0]).unwrap();
        assert_eq!(sheet.into_solid(), Err(SolidError::Flat));
        let point = TriMesh::from_soup(&[[Point3::origin(); 3]]).unwrap();
        assert_eq!(point.into_solid(), Err(SolidError::Flat));
    }

    #[test]
    fn components_have_a_vertex_each() {
        // Two cubes that touch in a corner count as one component.
        let corner = cube(1.0).transformed(&Isometry3::translation(1.0, 1.0, 1.0));
        let meshes = [cube(1.0), at(&sphere(0.5, 2).unwrap(), 4.0), corner, at(&cube(1.0), 9.0)];
        let merged = TriMesh::merged(&meshes).unwrap();
        let soup: Vec<_> = (0..merged.triangles().len()).map(|i| merged.triangle(i)).collect();
        let indices = (0..soup.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let unwelded = TriMesh::new(soup.concat(), indices).unwrap();
        let of_all = meshes.each_ref().map(|mesh| mesh.triangle(0)[0]);
        assert_eq!(merged.vertices_of_few_parts().unwrap(), of_all, "those that touch too");
        assert_eq!(unwelded.vertices_of_few_parts(), None);
        for mesh in [&merged, &unwelded] {
            let firsts = [0, 1, 3].map(|i: usize| meshes[i].triangle(0)[0]);
            assert_eq!(mesh.component_vertices(), firsts);
        }
    }

    proptest! {
        #[test]
        fn inside_a_torus_is_known_by_its_equation(p in prop::array::uniform3(-3.0..3.0_f64)) {
            let torus = torus(2.0, 0.7, 96, 48).unwrap();
            let from_tube = mp_math::hypot(mp_math::hypot(p[0], p[1]) - 2.0, p[2]);
            // The mesh is inscribed.
            prop_assume!(!(0.69..=0.7).contains(&from_tube));
            let winding = torus.winding_number(&Point3::from(p));
            prop_assert!((winding - f64::from(u8::from(from_tube < 0.7))).abs() < 1e-6);
        }

        /// Scaled and moved, a solid keeps the points that are scaled and moved with it.
        #[test]
        fn scales_keep_what_is_inside(p in prop::array::uniform3(-0.49..0.49_f64), s in prop::array::uniform3(0.2..3.0_f64), signs in 0_usize..8) {
            let s: [f64; 3] = std::array::from_fn(|k| if signs >> k & 1 == 1 { -s[k] } else { s[k] });
            let pose = Isometry3::new(Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.3, 0.9, -0.4));
            let moved = cube(1.0).scaled(s).unwrap().transformed(&pose);
            let q = pose * Point3::new(s[0] * p[0], s[1] * p[1], s[2] * p[2]);
            prop_assert_eq!(inside(&moved, q.into()), 1);
        }
    }
}
