//! Bounding volume hierarchies: trees of oriented boxes with eight children, and eight triangles to a leaf.

#![allow(clippy::needless_range_loop)] // Coordinates and axes are indices here, several arrays at a time.

pub(crate) mod build;
mod collapse;
mod fit;
pub(crate) mod frames;
pub(crate) mod root_box;
mod split;

use crate::triangle::Triangle;
use nalgebra::Point3;
use root_box::RootBox;

/// Boxes and triangles per node, and lanes per vector.
pub(crate) const WIDTH: usize = 8;

/// Set in a reference to a leaf; the other bits are its index.
pub(crate) const LEAF: u32 = 1 << 31;

pub(crate) type Lane = [f32; WIDTH];

/// The box of one node or leaf, in the centred frame of its tree. 64 bytes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct NodeBox {
    /// `frame[d]`: coordinate `d` of the centre, then of the three axes.
    pub(crate) frame: [[f32; 4]; 3],
    pub(crate) half: [f32; 3],
    /// The larger of two boxes is opened first.
    pub(crate) size: f32,
}

impl NodeBox {
    pub(crate) fn new(frame: [[f32; 4]; 3], half: [f32; 3]) -> Self {
        Self { frame, half, size: half[0] * half[0] + half[1] * half[1] + half[2] * half[2] }
    }
}

/// The boxes of up to eight children, each with its own orientation. 512 bytes.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) center: [Lane; 3],
    /// Negative in unused lanes, so that nothing touches them.
    pub(crate) half: [Lane; 3],
    /// `axes[k][d]`: coordinate `d` of axis `k`.
    pub(crate) axes: [[Lane; 3]; 3],
    pub(crate) child: [u32; WIDTH],
}

impl Node {
    /// Without children.
    pub(crate) const EMPTY: Self = Self {
        center: [[0.0; WIDTH]; 3],
        half: [[-1e30; WIDTH]; 3],
        axes: [[[0.0; WIDTH]; 3]; 3],
        child: [0; WIDTH],
    };

    pub(crate) fn set(&mut self, lane: usize, child: u32, obb: &NodeBox) {
        self.child[lane] = child;
        for d in 0..3 {
            self.center[d][lane] = obb.frame[d][0];
            self.half[d][lane] = obb.half[d];
            for k in 0..3 {
                self.axes[k][d][lane] = obb.frame[d][k + 1];
            }
        }
    }

    /// The children, from lane 0 on.
    pub(crate) fn children(&self) -> impl Iterator<Item = u32> {
        // A lane with NaN is used: its box is too large for `f32`.
        let used = self.half[0].iter().take_while(|half| half.is_nan() || **half >= 0.0).count();
        self.child[..used].iter().copied()
    }
}

/// Up to eight triangles, relative to a centre of their own. 384 bytes.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Leaf {
    /// `corner[k][d]`: coordinate `d` of corner `k`. Unused lanes repeat the last triangle.
    pub(crate) corner: [[Lane; 3]; 3],
    /// The centre, in the frame of the mesh.
    pub(crate) center: [f64; 3],
    /// The largest coordinate of a corner in magnitude.
    pub(crate) magnitude: f32,
    /// The longest edge.
    pub(crate) edge: f32,
    /// The first triangle's position in [`Tree::triangles`], and how many.
    pub(crate) first: u32,
    pub(crate) count: u32,
}

impl Leaf {
    /// A bit for every triangle.
    #[inline(always)]
    pub(crate) fn all(&self) -> u32 {
        (1 << self.count) - 1
    }
}

/// The tree of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) nodes: Vec<Node>,
    pub(crate) leaves: Vec<Leaf>,
    /// The box around each node and around each leaf.
    pub(crate) node_boxes: Vec<NodeBox>,
    pub(crate) leaf_boxes: Vec<NodeBox>,
    pub(crate) root: u32,
    /// The box around everything, in `f64`, in the frame of the mesh.
    pub(crate) bounding: RootBox,
    /// In the order of the leaves.
    pub(crate) triangles: Vec<Triangle>,
    /// The index of each triangle in the mesh it came from.
    pub(crate) ids: Vec<u32>,
    /// The origin of boxes, in the frame of the mesh.
    pub(crate) center: Point3<f64>,
    /// The largest distance of a corner from `center`, rounded up.
    pub(crate) radius_center: f64,
    /// The largest distance of a corner from the origin of the mesh, rounded up.
    pub(crate) radius: f64,
}

impl Tree {
    /// The box around a node or leaf.
    #[inline(always)]
    pub(crate) fn own(&self, reference: u32) -> &NodeBox {
        if reference & LEAF != 0 {
            &self.leaf_boxes[(reference & !LEAF) as usize]
        } else {
            &self.node_boxes[reference as usize]
        }
    }

    /// Whether the tree is too large for the caches near the core, so that prefetching pays.
    pub(crate) fn is_large(&self) -> bool {
        size_of_val(&self.nodes[..]) + size_of_val(&self.leaves[..]) > 1 << 18
    }

    pub(crate) fn memory(&self) -> usize {
        size_of_val(&self.nodes[..])
            + size_of_val(&self.leaves[..])
            + size_of_val(&self.node_boxes[..])
            + size_of_val(&self.leaf_boxes[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.ids[..])
    }
}
