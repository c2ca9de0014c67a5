//! The binary tree of oriented boxes over a triangle soup, built top-down.

use nalgebra::{Point3, Vector3};

use crate::obb::Obb;
use crate::pose::LIMIT;
use crate::triangle::Triangle;

/// At most so many triangles in a leaf.
const LEAF: usize = 2;

/// Below this depth splits are at the median, which bounds the depth whatever the mesh.
const MEDIAN_DEPTH: usize = 40;

/// A box with what is in it, 128 bytes. All boxes are in the frame of the mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) obb: Obb,
    /// The first of two children, which are neighbours; in a leaf, the first triangle.
    pub(crate) first: u32,
    /// How many triangles; 0 in an inner node.
    pub(crate) count: u32,
}

impl Node {
    pub(crate) fn is_leaf(&self) -> bool {
        self.count > 0
    }

    pub(crate) fn triangles(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

#[derive(Debug)]
pub(crate) struct Tree {
    /// The root is node 0.
    pub(crate) nodes: Vec<Node>,
    /// In the order of the leaves.
    pub(crate) triangles: Vec<Triangle>,
    /// The index of each triangle in the mesh it came from.
    pub(crate) ids: Vec<u32>,
    /// The largest distance of a corner from the origin, rounded up.
    pub(crate) radius: f64,
}

impl Tree {
    /// `triangles` is neither empty nor longer than `u32` can count: `TriMesh` has seen to it.
    pub(crate) fn build(triangles: Vec<Triangle>) -> Self {
        let radius = triangles.iter().flatten().map(|p| p.coords.norm()).fold(0.0, f64::max) * (1.0 + 1e-15);
        let count = triangles.len();
        let mut builder = Builder {
            centroids: triangles
                .iter()
                .map(|t| Point3::from((t[0].coords + t[1].coords + t[2].coords) / 3.0))
                .collect(),
            triangles,
            order: (0..count as u32).collect(),
            nodes: Vec::with_capacity(2 * count / LEAF),
        };
        let world = [Vector3::x(), Vector3::y(), Vector3::z()];
        let root = builder.fit(0..count, &world);
        builder.nodes.push(root);
        // Beyond the limit no query looks into the tree.
        if radius <= LIMIT {
            builder.split(0, 0..count, 0);
        }
        builder.nodes.shrink_to_fit();
        let triangles = builder.order.iter().map(|&i| builder.triangles[i as usize]).collect();
        Self { nodes: builder.nodes, triangles, ids: builder.order, radius }
    }

    pub(crate) fn memory(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.triangles[..]) + size_of_val(&self.ids[..])
    }
}

struct Builder {
    triangles: Vec<Triangle>,
    centroids: Vec<Point3<f64>>,
    order: Vec<u32>,
    nodes: Vec<Node>,
}

impl Builder {
    /// A leaf around `range` of the order.
    fn fit(&self, range: std::ops::Range<usize>, parent: &[Vector3<f64>; 3]) -> Node {
        let members = self.order[range.clone()].iter().map(|&i| &self.triangles[i as usize]);
        Node { obb: Obb::fit(members, parent), first: range.start as u32, count: range.len() as u32 }
    }

    /// Splits leaf `node`, which holds `range` of the order, as far as it goes.
    fn split(&mut self, node: usize, range: std::ops::Range<usize>, depth: usize) {
        if range.len() <= LEAF {
            return;
        }
        let obb = self.nodes[node].obb;
        let middle = range.start + self.partition(range.clone(), &obb, depth);
        let first = self.nodes.len();
        for half in [range.start..middle, middle..range.end] {
            let child = self.fit(half, &obb.axes);
            self.nodes.push(child);
        }
        self.nodes[node].first = first as u32;
        self.nodes[node].count = 0;
        self.split(first, range.start..middle, depth + 1);
        self.split(first + 1, middle..range.end, depth + 1);
    }

    /// Reorders `range` in two parts, neither empty, and returns the length of the first: at the mean of
    /// the centroids along the longest axis of the box where that divides them, else at the median.
    fn partition(&mut self, range: std::ops::Range<usize>, obb: &Obb, depth: usize) -> usize {
        let centroids = &self.centroids;
        let order = &mut self.order[range];
        let mut axes = [0, 1, 2];
        axes.sort_by(|&i, &j| obb.half[j].total_cmp(&obb.half[i]));
        if depth < MEDIAN_DEPTH {
            for axis in axes.map(|k| obb.axes[k]) {
                let along = |i: &u32| axis.dot(&centroids[*i as usize].coords);
                let mean = order.iter().map(along).sum::<f64>() / order.len() as f64;
                let low = stable_partition(order, |i| along(i) < mean);
                if low > 0 && low < order.len() {
                    return low;
                }
            }
        }
        let axis = obb.axes[axes[0]];
        let along = |i: &u32| axis.dot(&centroids[*i as usize].coords);
        order.sort_by(|i, j| along(i).total_cmp(&along(j)).then(i.cmp(j)));
        order.len() / 2
    }
}

/// Moves what satisfies `low` to the front, keeping the order within both parts; returns how many do.
fn stable_partition(order: &mut [u32], low: impl Fn(&u32) -> bool) -> usize {
    let (front, back): (Vec<u32>, Vec<u32>) = order.iter().partition(|i| low(i));
    order[..front.len()].copy_from_slice(&front);
    order[front.len()..].copy_from_slice(&back);
    front.len()
}
