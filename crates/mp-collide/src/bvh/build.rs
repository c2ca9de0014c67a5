//! Building: a binary tree by the surface-area heuristic, collapsed to eight children where dynamic
//! programming finds it cheapest.

use mp_stop::Interrupted;
use nalgebra::{Point3, Vector3};

use crate::bvh::collapse::{Choice, children, choose};
use crate::bvh::root_box::RootBox;
use crate::bvh::split::{BinaryNode, BuildTriangle, split_all};
use crate::bvh::{LEAF, Leaf, Node, NodeBox, Tree, WIDTH};
use crate::triangle::Triangle;

/// Up to this number of triangles building is optimised for speed, above it for memory.
pub(crate) const SMALL: usize = 1 << 20;

impl Tree {
    /// The tree of `count` triangles, at least one and at most `u32::MAX`, as [`mp_geom::TriMesh`] ensures.
    ///
    /// Triangles of which there are more than a million take at most 200 bytes each meanwhile, with those of the finished tree.
    ///
    /// # Errors
    /// When `go_on` says so, which is called after each pass over all triangles, and for each node.
    pub(crate) fn build(
        count: usize,
        triangle: &dyn Fn(usize) -> Triangle,
        go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
    ) -> Result<Self, Interrupted> {
        let all = || (0..count).map(triangle);
        let corners = || all().flatten();
        let (mut lo, mut hi) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for p in corners() {
            lo = lo.inf(&p.coords);
            hi = hi.sup(&p.coords);
        }
        go_on()?;
        let center = Point3::from(lo * 0.5 + hi * 0.5);
        let up = 1.0 + 1e-15;
        // A mesh moved by a pose that is not finite has NaN coordinates: they count as infinitely far away.
        let farthest = |far: f64, r: f64| if r.is_nan() { f64::INFINITY } else { far.max(r) };
        let radius = corners().map(|p| p.coords.norm()).fold(0.0, farthest) * up;
        go_on()?;
        let radius_center = corners().map(|p| (p - center).norm()).fold(0.0, farthest) * up;
        go_on()?;
        // Meshes so small that this overflows are not decided by boxes (`Frames::fits_f32`).
        let scale = Some(radius_center.recip()).filter(|s| s.is_finite()).unwrap_or(1.0);
        let in_unit = |p: Point3<f64>| {
            let p = (p - center) * scale;
            [p.x as f32, p.y as f32, p.z as f32]
        };
        let items = all().enumerate().map(|(i, t)| BuildTriangle { corners: t.map(in_unit), id: i as u32 });
        let mut items: Vec<BuildTriangle> = items.collect();
        let binary = split_all(&mut items, go_on)?;
        let choices = choose(&binary);
        go_on()?;
        let leaves = binary.iter().filter(|b| b.children() == 0).count();
        let mut tree = Self {
            nodes: Vec::new(),
            leaves: Vec::with_capacity(leaves),
            node_boxes: Vec::new(),
            leaf_boxes: Vec::with_capacity(leaves),
            root: 0,
            bounding: RootBox::fit(all(), go_on)?,
            triangles: Vec::new(),
            ids: Vec::new(),
            center,
            radius_center,
            radius,
        };
        let obb = binary[0].obb(&items, radius_center);
        // Beside all the rest only where they are not too many.
        let in_order = |i: &BuildTriangle| triangle(i.id as usize);
        if count <= SMALL {
            tree.triangles = items.iter().map(in_order).collect();
        }
        tree.root = tree.emit(triangle, &items, &binary, &choices, 0, obb, go_on)?;
        drop((binary, choices));
        tree.nodes.shrink_to_fit();
        tree.node_boxes.shrink_to_fit();
        tree.ids = items.iter().map(|i| i.id).collect();
        drop(items);
        if count > SMALL {
            tree.triangles = tree.ids.iter().map(|id| triangle(*id as usize)).collect();
        }
        Ok(tree)
    }

    /// Adds binary node `n`, whose box is `obb`, and all below; returns the reference to it.
    #[expect(clippy::too_many_arguments, reason = "it calls itself with all of them but two")]
    fn emit(
        &mut self,
        triangle: &dyn Fn(usize) -> Triangle,
        items: &[BuildTriangle],
        binary: &[BinaryNode],
        choices: &[Choice],
        n: usize,
        obb: NodeBox,
        go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
    ) -> Result<u32, Interrupted> {
        go_on()?;
        let b = &binary[n];
        if b.children() == 0 {
            let own = b.range().map(|i| match self.triangles.get(i) {
                Some(own) => *own,
                None => triangle(items[i].id as usize),
            });
            let leaf = leaf(own, b.range().start, &self.center, &obb);
            self.leaves.push(leaf);
            self.leaf_boxes.push(obb);
            return Ok(LEAF | (self.leaves.len() - 1) as u32);
        }
        let me = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        self.node_boxes.push(obb);
        for (lane, &root) in children(binary, choices, n).iter().enumerate() {
            let obb = binary[root].obb(items, self.radius_center);
            let child = self.emit(triangle, items, binary, choices, root, obb, go_on)?;
            self.nodes[me].set(lane, child, &obb);
        }
        Ok(me as u32)
    }
}

/// The leaf of one to eight triangles, of which the first is the triangle `first` of the tree, with the box around them.
pub(crate) fn leaf(
    triangles: impl Iterator<Item = Triangle>,
    first: usize,
    center: &Point3<f64>,
    obb: &NodeBox,
) -> Leaf {
    let (mut own, mut count) = ([[Point3::origin(); 3]; WIDTH], 0);
    for (slot, triangle) in own.iter_mut().zip(triangles) {
        *slot = triangle;
        count += 1;
    }
    let middle: [f64; 3] = std::array::from_fn(|d| center[d] + f64::from(obb.frame[d][0]));
    let mut leaf = Leaf {
        corner: [[[0.0; WIDTH]; 3]; 3],
        center: middle,
        magnitude: 0.0,
        edge: 0.0,
        first: first as u32,
        count: count as u32,
    };
    let mut edge: f64 = 0.0;
    for lane in 0..WIDTH {
        let t = &own[lane.min(count - 1)];
        for k in 0..3 {
            for d in 0..3 {
                let x = (t[k][d] - middle[d]) as f32;
                leaf.corner[k][d][lane] = x;
                leaf.magnitude = leaf.magnitude.max(x.abs());
            }
            edge = edge.max((t[(k + 1) % 3] - t[k]).norm_squared());
        }
    }
    leaf.edge = (edge.sqrt() * (1.0 + 1e-6)) as f32;
    leaf
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives;

    /// The triangles under `reference`, which its box must hold.
    fn below(tree: &Tree, reference: u32) -> Vec<usize> {
        let at = (reference & !LEAF) as usize;
        let triangles: Vec<usize> = if reference & LEAF == 0 {
            tree.nodes[at].children().flat_map(|child| below(tree, child)).collect()
        } else {
            let leaf = &tree.leaves[at];
            (leaf.first as usize..(leaf.first + leaf.count) as usize).collect()
        };
        let obb = tree.own(reference);
        for p in triangles.iter().flat_map(|&i| tree.triangles[i]) {
            for k in 0..3 {
                let along = |d: usize| {
                    f64::from(obb.frame[d][k + 1]) * (p[d] - tree.center[d] - f64::from(obb.frame[d][0]))
                };
                let along = along(0) + along(1) + along(2);
                assert!(along.abs() <= f64::from(obb.half[k]), "{along} {:?}", obb.half);
            }
        }
        triangles
    }

    /// However large the mesh: between two questions no triangle is looked at more often than a few times, and after the last one none.
    #[test]
    fn building_ends_when_it_is_told_to() {
        let mesh = primitives::torus(1.0, 0.3, 120, 60).unwrap();
        let count = mesh.triangles().len();
        let (looked, mut asked) = (std::cell::Cell::new(0_usize), 0_usize);
        let triangle = |i: usize| {
            looked.set(looked.get() + 1);
            mesh.triangle(i)
        };
        let mut last = 0;
        let all = Tree::build(count, &triangle, &mut || {
            assert!(looked.get() - last <= 2 * count, "{} after {asked} questions", looked.get() - last);
            (last, asked) = (looked.get(), asked + 1);
            Ok(())
        });
        assert!(all.is_ok() && asked * 8 > count, "{asked}");
        for end in [1, 2, 3, 4, 5, 8, asked / 3, asked / 2, asked - 10, asked] {
            let (mut questions, mut last) = (0, 0);
            let ended = Tree::build(count, &triangle, &mut || {
                (questions, last) = (questions + 1, looked.get());
                if questions == end { Err(Interrupted) } else { Ok(()) }
            });
            assert!(ended.is_err() && questions == end && looked.get() == last, "{end}");
        }
    }

    #[test]
    fn boxes_hold_what_lies_below() {
        for scale in [1e-6, 1.0, 1e6] {
            for far in [0.0, 1e3] {
                for mesh in [
                    primitives::torus(1.0, 0.3, 60, 30).unwrap(),
                    primitives::sphere(0.7, 3).unwrap(),
                    primitives::cuboid(1.0, 1e-3, 0.3).unwrap(),
                ] {
                    let turn = nalgebra::Rotation3::from_scaled_axis(Vector3::new(0.3, 0.5, -0.4));
                    let place = |p: Point3<f64>| (turn * p * scale) + Vector3::repeat(far * scale);
                    let triangles: Vec<Triangle> =
                        (0..mesh.triangles().len()).map(|i| mesh.triangle(i).map(place)).collect();
                    let tree = Tree::build(triangles.len(), &|i| triangles[i], &mut || Ok(())).unwrap();
                    assert_eq!(below(&tree, tree.root).len(), triangles.len());
                }
            }
        }
    }
}
