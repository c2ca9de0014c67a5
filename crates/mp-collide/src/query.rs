//! Queries between two meshes.

use nalgebra::{Isometry3, Point3};

use crate::mesh::CollisionMesh;
use crate::pose::Relative;
use crate::tree::Tree;
use crate::triangle::intersect;

/// How much work queries have done: the same for the same queries, on any machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Queries answered (each pose of a batch counts).
    pub queries: u64,
    /// Pairs of boxes compared.
    pub box_tests: u64,
    /// Pairs of triangles compared.
    pub triangle_tests: u64,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.queries += other.queries;
        self.box_tests += other.box_tests;
        self.triangle_tests += other.triangle_tests;
    }
}

/// How far two bodies are apart, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// The distance (metres); 0 exactly when they intersect.
    pub distance: f64,
    /// A nearest point of the first, in the world; a common point when they intersect.
    pub point_a: Point3<f64>,
    /// A nearest point of the second, in the world.
    pub point_b: Point3<f64>,
}

/// Scratch and counters of one thread: make one per thread and keep it.
///
/// All queries are between mesh `a` at `pose_wa` and mesh `b` at `pose_wb` (poses in the world); answers
/// depend on nothing else, and nothing is allocated once the scratch has grown. The contract, with what
/// happens to bad input, is in the [crate documentation](crate).
#[derive(Clone, Debug, Default)]
pub struct Query {
    /// What was done so far; set to `Counters::default()` to start over.
    pub counters: Counters,
    pub(crate) stack: Vec<(u32, u32)>,
    pub(crate) pairs: Vec<crate::distance::Pair>,
}

impl Query {
    /// Whether the meshes have a point in common. Touching counts.
    pub fn intersects(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> bool {
        self.counters.queries += 1;
        match Relative::between(pose_wa, a.radius(), pose_wb, b.radius()) {
            Some(relative) => self.colliding_pair(a.tree(), b.tree(), &relative).is_some(),
            None => true,
        }
    }

    /// The indices of two triangles, of `a` and of `b`, that intersect: the first pair found, always the
    /// same one. `None` when the meshes are apart; triangles (0, 0) for a pose that is not finite.
    pub fn intersecting_triangles(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> Option<(usize, usize)> {
        self.counters.queries += 1;
        match Relative::between(pose_wa, a.radius(), pose_wb, b.radius()) {
            Some(relative) => self
                .colliding_pair(a.tree(), b.tree(), &relative)
                .map(|(i, j)| (a.tree().ids[i] as usize, b.tree().ids[j] as usize)),
            None => Some((0, 0)),
        }
    }

    /// The index of the first of `poses_wa` at which `a` collides with `b`; `None` when it never does.
    pub fn first_collision(
        &mut self,
        a: &CollisionMesh,
        poses_wa: &[Isometry3<f64>],
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> Option<usize> {
        poses_wa.iter().position(|pose_wa| self.intersects(a, pose_wa, b, pose_wb))
    }

    /// Two intersecting triangles, as positions in the trees.
    pub(crate) fn colliding_pair(
        &mut self,
        a: &Tree,
        b: &Tree,
        relative: &Relative,
    ) -> Option<(usize, usize)> {
        let slack = relative.slack;
        self.stack.clear();
        self.counters.box_tests += 1;
        if a.nodes[0].obb.disjoint(&relative.obb(&b.nodes[0].obb), slack) {
            return None;
        }
        self.stack.push((0, 0));
        while let Some((i, j)) = self.stack.pop() {
            let (node_a, node_b) = (&a.nodes[i as usize], &b.nodes[j as usize]);
            if node_a.is_leaf() && node_b.is_leaf() {
                for l in node_b.triangles() {
                    let triangle_b = relative.triangle(&b.triangles[l]);
                    for k in node_a.triangles() {
                        self.counters.triangle_tests += 1;
                        if intersect(&a.triangles[k], &triangle_b) {
                            return Some((k, l));
                        }
                    }
                }
                continue;
            }
            self.counters.box_tests += 2;
            if node_b.is_leaf() || (!node_a.is_leaf() && node_a.obb.size() >= node_b.obb.size()) {
                let obb_b = relative.obb(&node_b.obb);
                for child in [node_a.first + 1, node_a.first] {
                    if !a.nodes[child as usize].obb.disjoint(&obb_b, slack) {
                        self.stack.push((child, j));
                    }
                }
            } else {
                for child in [node_b.first + 1, node_b.first] {
                    if !node_a.obb.disjoint(&relative.obb(&b.nodes[child as usize].obb), slack) {
                        self.stack.push((i, child));
                    }
                }
            }
        }
        None
    }
}
