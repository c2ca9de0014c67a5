//! Adjacency of triangles, and the defects of a mesh.

use crate::TriMesh;

/// Adjacency of a mesh and a report on its defects.
///
/// Vertices at identical coordinates count as one, named by the first of them, so a mesh whose file
/// repeats points is judged by its shape. Triangles with two corners in one place are not counted at edges.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Topology {
    /// Per triangle, the triangle across each of its edges (corner 0–1, 1–2, 2–0); `None` at a boundary or
    /// where more than two triangles meet.
    pub neighbours: Vec<[Option<u32>; 3]>,
    /// Per triangle, which connected component (through shared edges) it is in, counted from 0.
    pub component: Vec<u32>,
    /// Number of connected components.
    pub components: usize,
    /// Edges of exactly one triangle.
    pub boundary_edges: Vec<[u32; 2]>,
    /// Edges of more than two triangles.
    pub crowded_edges: Vec<[u32; 2]>,
    /// Edges along which neighbours have opposite orientations.
    pub misoriented_edges: Vec<[u32; 2]>,
    /// Vertices whose triangles do not form one fan (surfaces touching in a point).
    pub pinched_vertices: Vec<u32>,
    /// Triangles without area: repeated or collinear corners.
    pub degenerate: Vec<u32>,
    /// Triangles with the same three corners as an earlier one, in any order: (earlier, this).
    pub duplicates: Vec<(u32, u32)>,
    /// Number of distinct vertices used by triangles.
    pub vertices: usize,
    /// Number of distinct edges.
    pub edges: usize,
    /// Every edge has an even number of triangles, and there are edges.
    pub closed: bool,
    /// No crowded edge and no pinched vertex: the surface is locally a disc or half disc.
    pub manifold: bool,
    /// Every edge shared by triangles is used as often in one direction as in the other.
    pub oriented: bool,
}

impl Topology {
    /// Closed, manifold and consistently oriented: bounds a solid, if it does not cross itself.
    #[must_use]
    pub fn is_solid(&self) -> bool {
        self.closed && self.manifold && self.oriented
    }

    /// V − E + F, counting triangles with three distinct corners: 2 per component for spheres, 0 for a torus.
    #[must_use]
    pub fn euler_characteristic(&self) -> i64 {
        let faces = self.component.iter().filter(|&&c| c != NO_COMPONENT).count();
        self.vertices as i64 - self.edges as i64 + faces as i64
    }
}

/// No corner of a triangle: see [`TriMesh::topology`].
const NO_CORNER: usize = usize::MAX;

/// The value in [`Topology::component`] of a triangle with two corners in one place.
pub const NO_COMPONENT: u32 = u32::MAX;

/// A triangle of at most this height, relative to its longest edge, has no area.
const FLAT: f64 = 1e-14;

/// One use of an edge: the triangle, which of its edges, and whether from the lower to the higher vertex.
type Use = (u32, u8, bool);

impl TriMesh {
    /// Adjacency and defects. O(n log n) in the number of triangles.
    #[must_use]
    pub fn topology(&self) -> Topology {
        let names = self.names();
        let triangles: Vec<_> = self.triangles().iter().map(|t| t.map(|v| names[v as usize])).collect();
        let mut uses: Vec<([u32; 2], Use)> = Vec::with_capacity(3 * triangles.len());
        for (i, t) in triangles.iter().enumerate().filter(|(_, t)| is_whole(t)) {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                uses.push(([a.min(b), a.max(b)], (i as u32, k as u8, a < b)));
            }
        }
        uses.sort_unstable();

        let mut out = Topology {
            neighbours: vec![[None; 3]; triangles.len()],
            component: vec![NO_COMPONENT; triangles.len()],
            components: 0,
            boundary_edges: Vec::new(),
            crowded_edges: Vec::new(),
            misoriented_edges: Vec::new(),
            pinched_vertices: Vec::new(),
            degenerate: Vec::new(),
            duplicates: Vec::new(),
            vertices: 0,
            edges: 0,
            closed: true,
            manifold: true,
            oriented: true,
        };
        // Triangles linked through edges, crowded ones included.
        let mut linked = DisjointSets::new(triangles.len());
        // Corners (3·triangle + k) linked around vertices.
        let mut fans = DisjointSets::new(3 * triangles.len());
        for group in uses.chunk_by(|a, b| a.0 == b.0) {
            let edge = group[0].0;
            out.edges += 1;
            out.closed &= group.len() % 2 == 0;
            let forward = group.iter().filter(|(_, u)| u.2).count();
            if group.len() > 1 && 2 * forward != group.len() {
                out.misoriented_edges.push(edge);
            }
            match group {
                [_] => out.boundary_edges.push(edge),
                [(_, a), (_, b)] => {
                    out.neighbours[a.0 as usize][usize::from(a.1)] = Some(b.0);
                    out.neighbours[b.0 as usize][usize::from(b.1)] = Some(a.0);
                }
                _ => out.crowded_edges.push(edge),
            }
            for pair in group.windows(2) {
                let (a, b) = (pair[0].1, pair[1].1);
                linked.join(a.0 as usize, b.0 as usize);
                for v in edge {
                    let corner = |t: u32| 3 * t as usize + position(&triangles[t as usize], v);
                    fans.join(corner(a.0), corner(b.0));
                }
            }
        }
        drop(uses);
        out.closed &= out.edges > 0;
        out.oriented = out.misoriented_edges.is_empty();
        out.duplicates = duplicates(&triangles);

        // The number of the component of a root, and a corner at a vertex.
        let mut number = vec![NO_COMPONENT; triangles.len()];
        let mut fan_of_vertex = vec![NO_CORNER; self.vertices().len()];
        for (i, t) in triangles.iter().enumerate() {
            if !is_whole(t) || self.is_flat(i) {
                out.degenerate.push(i as u32);
            }
            if is_whole(t) {
                let number = &mut number[linked.root(i)];
                if *number == NO_COMPONENT {
                    *number = out.components as u32;
                    out.components += 1;
                }
                out.component[i] = *number;
                for (k, v) in t.iter().enumerate() {
                    let fan = fans.root(3 * i + k);
                    let known = &mut fan_of_vertex[*v as usize];
                    if *known == NO_CORNER {
                        *known = fan;
                        out.vertices += 1;
                    } else if *known != fan {
                        out.pinched_vertices.push(*v);
                    }
                }
            }
        }
        out.pinched_vertices.sort_unstable();
        out.pinched_vertices.dedup();
        out.manifold = out.crowded_edges.is_empty() && out.pinched_vertices.is_empty();
        out
    }

    /// Whether the surface is [closed](Topology::closed) and [consistently oriented](Topology::oriented): the
    /// same as of its [topology](TriMesh::topology), with a tenth of the memory.
    #[must_use]
    pub fn is_closed_and_oriented(&self) -> bool {
        // Each edge is used as often in one direction as in the other, and so an even number of times.
        let names = self.names();
        let triangles = || self.triangles().iter().map(|t| t.map(|v| names[v as usize])).filter(is_whole);
        let edges = || triangles().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
        let upward = edges().filter(|[a, b]| a < b).count();
        if upward == 0 || 2 * upward != edges().count() {
            return false;
        }
        // Some at a time: lists of all take more memory than the mesh.
        let groups = u32::try_from(upward.div_ceil(1 << 21)).unwrap_or(u32::MAX);
        let (mut up, mut down) = (Vec::new(), Vec::new());
        (0..groups).all(|group| {
            up.clear();
            down.clear();
            for [a, b] in edges().filter(|[a, b]| a.min(b) % groups == group) {
                if a < b { up.push([a, b]) } else { down.push([b, a]) }
            }
            up.sort_unstable();
            down.sort_unstable();
            up == down
        })
    }

    /// The components connected through edges, as surfaces, each with only its own vertices, in the order of
    /// their first triangles. Triangles with two corners in one place belong to none; a mesh of only such
    /// triangles is one part.
    #[must_use]
    pub fn parts(&self) -> Vec<TriMesh> {
        let topology = self.topology();
        if topology.components < 2 {
            return vec![self.clone().into_surface()];
        }
        let mut vertices = vec![Vec::new(); topology.components];
        let mut triangles = vec![Vec::new(); topology.components];
        // The part a vertex was last given to, and its number there: parts may share vertices.
        let mut given = vec![(NO_COMPONENT, 0_u32); self.vertices().len()];
        let mut order: Vec<usize> = (0..self.triangles().len()).collect();
        order.sort_by_key(|&t| topology.component[t]);
        for t in order {
            let component = topology.component[t];
            let Some(vertices) = vertices.get_mut(component as usize) else { continue };
            triangles[component as usize].push(self.triangles()[t].map(|v| {
                let slot = &mut given[v as usize];
                if slot.0 != component {
                    *slot = (component, vertices.len() as u32);
                    vertices.push(self.vertices()[v as usize]);
                }
                slot.1
            }));
        }
        vertices.into_iter().zip(triangles).filter_map(|(v, t)| TriMesh::new(v, t).ok()).collect()
    }

    /// For every vertex the first one at its position.
    pub(crate) fn names(&self) -> Vec<u32> {
        // 0 and −0 are the same place.
        let place = |i: u32| <[f64; 3]>::from(self.vertices()[i as usize]).map(|c| (c + 0.0).to_bits());
        let count = self.vertices().len() as u32;
        let mut order: Vec<u32> = (0..count).collect();
        order.sort_unstable_by_key(|&i| (place(i), i));
        let mut names: Vec<u32> = (0..count).collect();
        for same in order.chunk_by(|&i, &j| place(i) == place(j)) {
            same.iter().for_each(|&i| names[i as usize] = same[0]);
        }
        names
    }

    fn is_flat(&self, i: usize) -> bool {
        let [a, b, c] = self.triangle(i);
        let (u, v, w) = (b - a, c - b, a - c);
        let longest = u.norm_squared().max(v.norm_squared()).max(w.norm_squared());
        u.cross(&v).norm() <= FLAT * longest
    }
}

/// Whether no two corners are in one place.
fn is_whole(t: &[u32; 3]) -> bool {
    t[0] != t[1] && t[1] != t[2] && t[2] != t[0]
}

/// [`Topology::duplicates`].
fn duplicates(triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let corners = |i: u32| {
        let mut t = triangles[i as usize];
        t.sort_unstable();
        t
    };
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (corners(i), i));
    let same = order.chunk_by(|&i, &j| corners(i) == corners(j));
    let mut found: Vec<_> = same.flat_map(|same| same[1..].iter().map(|&i| (same[0], i))).collect();
    found.sort_unstable_by_key(|&(_, i)| i);
    found
}

fn position(t: &[u32; 3], v: u32) -> usize {
    if t[0] == v { 0 } else { 1 + usize::from(t[1] != v) }
}

/// Union–find with path halving; the smallest member is the root.
struct DisjointSets(Vec<usize>);

impl DisjointSets {
    fn new(n: usize) -> Self {
        Self((0..n).collect())
    }
    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_from_six;
    use crate::primitives::{cuboid, sphere, torus};
    use nalgebra::Isometry3;
    use proptest::prelude::*;

    fn cube() -> TriMesh {
        cuboid(1.0, 1.0, 1.0).unwrap()
    }

    fn edited(mesh: &TriMesh, edit: impl FnOnce(&mut Vec<[u32; 3]>)) -> Topology {
        let mut triangles = mesh.triangles().to_vec();
        edit(&mut triangles);
        TriMesh::new(mesh.vertices().to_vec(), triangles).unwrap().topology()
    }

    #[test]
    fn a_cube() {
        let t = cube().topology();
        assert!(t.is_solid() && t.degenerate.is_empty() && t.duplicates.is_empty());
        assert_eq!((t.vertices, t.edges, t.components, t.euler_characteristic()), (8, 18, 1, 2));
        let back = |i: u32, j: u32| t.neighbours[j as usize].contains(&Some(i));
        for (i, n) in t.neighbours.iter().enumerate() {
            assert!(n.iter().all(|j| back(i as u32, j.unwrap())));
        }
    }

    #[test]
    fn a_missing_triangle_opens_three_edges() {
        let t = edited(&cube(), |t| t.truncate(11));
        assert!(!t.closed && t.manifold && t.oriented && !t.is_solid());
        assert_eq!(t.boundary_edges, [[1, 5], [1, 7], [5, 7]]);
        assert_eq!(t.neighbours.iter().flatten().filter(|n| n.is_none()).count(), 3);
    }

    #[test]
    fn a_turned_triangle_is_against_its_neighbours() {
        let t = edited(&cube(), |t| t[0].swap(0, 1));
        assert!(t.closed && t.manifold && !t.oriented);
        assert_eq!(t.misoriented_edges.len(), 3);
    }

    #[test]
    fn degenerate_and_duplicate_triangles() {
        let t = edited(&cube(), |t| {
            let [a, b, c] = t[3];
            t.push([b, c, a]);
            t.push([a, a, b]);
        });
        assert_eq!(t.duplicates, [(3, 12)]);
        assert_eq!(t.degenerate, [13]);
        assert_eq!((t.component[13], t.crowded_edges.len()), (NO_COMPONENT, 3));
        assert!(!t.manifold && !t.closed);
        let line = [0.0, 1.0, 2.0].map(|x| nalgebra::Point3::new(x, 2.0 * x, -x));
        assert_eq!(TriMesh::from_soup(&[line]).unwrap().topology().degenerate, [0]);
    }

    #[test]
    fn solids_touching_in_a_vertex_or_an_edge() {
        let at = |x, y, z| cube().transformed(&Isometry3::translation(x, y, z));
        let in_vertex = TriMesh::merged([&cube(), &at(1.0, 1.0, 1.0)]).unwrap().topology();
        assert!(in_vertex.closed && in_vertex.oriented && !in_vertex.manifold);
        assert_eq!((in_vertex.components, in_vertex.pinched_vertices.len()), (2, 1));
        let in_edge = TriMesh::merged([&cube(), &at(1.0, 1.0, 0.0)]).unwrap().topology();
        assert!(in_edge.closed && in_edge.oriented && !in_edge.manifold);
        assert_eq!((in_edge.components, in_edge.crowded_edges.len()), (1, 1));
        let apart = TriMesh::merged([&cube(), &at(5.0, 0.0, 0.0)]).unwrap().topology();
        assert!(apart.is_solid());
        assert_eq!(apart.components, 2);
    }

    #[test]
    fn parts_are_taken_apart_again() {
        let whole = [
            cuboid(1.0, 1.0, 1.0).unwrap(),
            sphere(0.5, 2).unwrap().transformed(&pose_from_six([4.0, 0.0, 0.0, 0.0, 0.0, 0.0])),
            // Touches the first in one corner, which they do not share.
            cuboid(1.0, 1.0, 1.0).unwrap().transformed(&pose_from_six([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])),
        ];
        let merged = TriMesh::merged(&whole).unwrap();
        let soup = |m: &TriMesh| (0..m.triangles().len()).map(|i| m.triangle(i)).collect::<Vec<_>>();
        assert!(merged.parts().iter().map(soup).eq(whole.iter().map(soup)));
        assert_eq!(merged.welded().parts().len(), 3, "a shared corner joins nothing");
        assert_eq!(whole[0].parts(), [whole[0].clone().into_surface()]);
        let volume: f64 = merged.parts().iter().map(|p| p.features().volume).sum();
        assert!((volume - merged.signed_volume()).abs() < 1e-12);
        // Triangles in turn from one part and the other.
        let mut mixed = merged.triangles().to_vec();
        mixed.sort_by_key(|t| t[0] % 7);
        let mixed = TriMesh::new(merged.vertices().to_vec(), mixed).unwrap();
        let areas = |parts: Vec<TriMesh>| {
            let mut areas: Vec<f64> = parts.iter().map(TriMesh::area).collect();
            areas.sort_by(f64::total_cmp);
            areas
        };
        for (a, b) in areas(mixed.parts()).into_iter().zip(areas(whole.to_vec())) {
            assert!((a - b).abs() < 1e-12);
        }
    }
    proptest! {
        #[test]
        fn a_soup_in_any_order_is_judged_the_same(shuffle in Just((0..96_usize).collect::<Vec<_>>()).prop_shuffle(), gone in 0_usize..4) {
            let torus = torus(2.0, 0.5, 8, 6).unwrap();
            // Unwelded: every triangle with vertices of its own, turned to start at another corner.
            let soup: Vec<_> = shuffle.iter().skip(gone).map(|&i| {
                let mut t = torus.triangle(i);
                t.rotate_left(i % 3);
                t
            }).collect();
            let unwelded = TriMesh::new(soup.concat(), (0..soup.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap();
            let (a, b) = (unwelded.topology(), unwelded.welded().topology());
            prop_assert_eq!(a.is_solid(), gone == 0);
            prop_assert_eq!(unwelded.is_closed_and_oriented(), gone == 0);
            prop_assert_eq!((a.edges, a.components, a.boundary_edges.len(), a.closed), (b.edges, b.components, b.boundary_edges.len(), b.closed));
            prop_assert_eq!(a.neighbours, b.neighbours);
            // An edge of a missing triangle is a boundary unless both of its triangles are missing.
            let missing = &shuffle[..gone];
            let full = torus.topology();
            let expected = missing.iter().flat_map(|&i| full.neighbours[i]).filter(|n| !missing.contains(&(n.unwrap() as usize))).count();
            prop_assert_eq!(a.boundary_edges.len(), expected);
        }
    }

    proptest! {
        /// Few vertices, some of them in one place, so that all defects come up.
        #[test]
        fn closed_and_oriented_is_known_without_the_topology(
            triangles in prop::collection::vec(prop::array::uniform3(0_u32..6), 1..12),
            turned in prop::collection::vec(any::<bool>(), 12),
            doubled in any::<bool>(),
        ) {
            let places = [[0.0, 0.0, 0.0], [-0.0, 0.0, -0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
            let mut all = triangles.clone();
            if doubled {
                // Every triangle twice, from both sides or not.
                let sides = triangles.iter().zip(&turned);
                all.extend(sides.map(|(&[a, b, c], &turned)| if turned { [c, b, a] } else { [b, c, a] }));
            }
            let mesh = TriMesh::new(places.map(nalgebra::Point3::from).to_vec(), all).unwrap();
            let topology = mesh.topology();
            prop_assert_eq!(mesh.is_closed_and_oriented(), topology.closed && topology.oriented);
        }
    }

    #[test]
    fn closed_and_oriented_surfaces() {
        let rest = |mesh: &TriMesh, n: usize| {
            TriMesh::new(mesh.vertices().to_vec(), mesh.triangles()[..n].to_vec()).unwrap()
        };
        let cube = cube();
        assert!(cube.is_closed_and_oriented() && cube.reversed().is_closed_and_oriented());
        // Without one triangle, and without two: as many edges are used in one direction as in the other.
        for n in 1..12 {
            let part = rest(&cube, n);
            let topology = part.topology();
            assert_eq!(part.is_closed_and_oriented(), topology.closed && topology.oriented, "{n}");
        }
        let both = TriMesh::merged([&cube, &cube.reversed()]).unwrap();
        assert!(both.is_closed_and_oriented());
        let mut turned = cube.triangles().to_vec();
        turned[0].swap(0, 1);
        assert!(!TriMesh::new(cube.vertices().to_vec(), turned).unwrap().is_closed_and_oriented());
    }
}
