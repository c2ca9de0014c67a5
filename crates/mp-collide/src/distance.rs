//! Distance, clearance and tolerance queries: nearest boxes first.

use nalgebra::{Isometry3, Point3};

use crate::mesh::CollisionMesh;
use crate::pose::{Relative, to_world};
use crate::query::{Query, Separation};
use crate::tree::Tree;
use crate::triangle::{Closest, closest_within, crossing};

/// Two nodes whose boxes are at least `bound` apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    bound: f64,
    a: u32,
    b: u32,
}

/// What a search found.
pub(crate) struct Nearest {
    /// The nearest points (in the frame of `a`) and triangles (positions in the trees), if near enough.
    pub(crate) witness: Option<(Closest, usize, usize)>,
    /// Everything not looked at is at least this far away.
    skipped: f64,
}

impl Query {
    /// The distance of the meshes with nearest points, in the world.
    ///
    /// For input that counts as in collision with everything (see the crate docs) the points are the
    /// origin.
    pub fn distance(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> Separation {
        self.counters.queries += 1;
        let Some(relative) = Relative::between(pose_wa, a.radius(), pose_wb, b.radius()) else {
            return Separation { distance: 0.0, point_a: Point3::origin(), point_b: Point3::origin() };
        };
        if let Some((i, j)) = self.colliding_pair(a.tree(), b.tree(), &relative) {
            let triangle_b = relative.triangle(&b.tree().triangles[j]);
            let point = to_world(pose_wa, &crossing(&a.tree().triangles[i], &triangle_b));
            return Separation { distance: 0.0, point_a: point, point_b: point };
        }
        let nearest = self.nearest(a.tree(), b.tree(), &relative, f64::INFINITY, 0.0);
        let closest = nearest.witness.map_or(Closest::NONE, |(closest, ..)| closest);
        Separation {
            distance: positive(closest.squared.sqrt()),
            point_a: to_world(pose_wa, &closest.on_a),
            point_b: to_world(pose_wa, &closest.on_b),
        }
    }

    /// A lower bound on the distance of the meshes that is exact when below `enough` (metres) and some
    /// value of at least `enough` otherwise; 0 exactly when they intersect.
    ///
    /// The smaller `enough`, the sooner the search ends. The value returned beyond `enough` is the best
    /// bound that came for free. NaN counts as infinity.
    pub fn clearance(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
        enough: f64,
    ) -> f64 {
        self.counters.queries += 1;
        let Some(relative) = Relative::between(pose_wa, a.radius(), pose_wb, b.radius()) else { return 0.0 };
        self.clearance_with(a.tree(), b.tree(), &relative, enough).0
    }

    /// Whether the distance of the meshes is at most `tolerance` (metres), to rounding.
    ///
    /// A negative tolerance counts as 0, and then this is [`Query::intersects`]; NaN as infinity, for
    /// which the answer is `true`.
    pub fn within(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
        tolerance: f64,
    ) -> bool {
        self.counters.queries += 1;
        let Some(relative) = Relative::between(pose_wa, a.radius(), pose_wb, b.radius()) else { return true };
        let tolerance = if tolerance.is_nan() { f64::INFINITY } else { tolerance.max(0.0) };
        if tolerance == f64::INFINITY {
            return true;
        }
        let (a, b) = (a.tree(), b.tree());
        if self.bound(a, b, &relative) > tolerance {
            return false;
        }
        if self.colliding_pair(a, b, &relative).is_some() {
            return true;
        }
        tolerance > 0.0 && self.nearest(a, b, &relative, tolerance.next_up(), tolerance).witness.is_some()
    }

    /// [`Query::clearance`], and the triangle of `b` (its position in the tree) that is nearest, if looked
    /// at.
    pub(crate) fn clearance_with(
        &mut self,
        a: &Tree,
        b: &Tree,
        relative: &Relative,
        enough: f64,
    ) -> (f64, Option<usize>) {
        let enough = if enough.is_nan() { f64::INFINITY } else { enough };
        let bound = self.bound(a, b, relative);
        if bound > 0.0 && bound >= enough {
            return (bound, None);
        }
        if let Some((_, j)) = self.colliding_pair(a, b, relative) {
            return (0.0, Some(j));
        }
        let nearest = self.nearest(a, b, relative, enough, 0.0);
        match nearest.witness {
            Some((closest, _, j)) => (positive(closest.squared.sqrt()), Some(j)),
            None => (positive(nearest.skipped.max(enough)), None),
        }
    }

    /// A lower bound on the distance from the boxes at the roots.
    fn bound(&mut self, a: &Tree, b: &Tree, relative: &Relative) -> f64 {
        self.counters.box_tests += 1;
        a.nodes[0].obb.distance_bound(&relative.obb(&b.nodes[0].obb), relative.slack)
    }

    /// The nearest points of meshes that do not intersect, when nearer than `enough`. The search may end
    /// with any points no further apart than `accept`.
    pub(crate) fn nearest(
        &mut self,
        a: &Tree,
        b: &Tree,
        relative: &Relative,
        enough: f64,
        accept: f64,
    ) -> Nearest {
        let slack = relative.slack;
        let mut best = enough.max(0.0);
        let mut result = Nearest { witness: None, skipped: f64::INFINITY };
        let root = Pair { bound: self.bound(a, b, relative), a: 0, b: 0 };
        self.pairs.clear();
        self.pairs.push(root);
        while let Some(pair) = self.pairs.pop() {
            if pair.bound >= best {
                result.skipped = result.skipped.min(pair.bound);
                continue;
            }
            let (node_a, node_b) = (&a.nodes[pair.a as usize], &b.nodes[pair.b as usize]);
            if node_a.is_leaf() && node_b.is_leaf() {
                for l in node_b.triangles() {
                    let triangle_b = relative.triangle(&b.triangles[l]);
                    for k in node_a.triangles() {
                        self.counters.triangle_tests += 1;
                        if let Some(closest) = closest_within(&a.triangles[k], &triangle_b, best * best) {
                            best = closest.squared.sqrt();
                            result.witness = Some((closest, k, l));
                            if best <= accept {
                                return result;
                            }
                        }
                    }
                }
                result.skipped = result.skipped.min(best);
                continue;
            }
            self.counters.box_tests += 2;
            let children =
                if node_b.is_leaf() || (!node_a.is_leaf() && node_a.obb.size() >= node_b.obb.size()) {
                    let obb_b = relative.obb(&node_b.obb);
                    [node_a.first, node_a.first + 1].map(|child| Pair {
                        bound: a.nodes[child as usize].obb.distance_bound(&obb_b, slack),
                        a: child,
                        b: pair.b,
                    })
                } else {
                    [node_b.first, node_b.first + 1].map(|child| Pair {
                        bound: node_a.obb.distance_bound(&relative.obb(&b.nodes[child as usize].obb), slack),
                        a: pair.a,
                        b: child,
                    })
                };
            // The nearer on top of the stack.
            let [near, far] =
                if children[0].bound <= children[1].bound { children } else { [children[1], children[0]] };
            for child in [far, near] {
                if child.bound < best {
                    self.pairs.push(child);
                } else {
                    result.skipped = result.skipped.min(child.bound);
                }
            }
        }
        result
    }
}

/// Meshes that do not intersect are never at distance 0, whatever rounding says.
fn positive(distance: f64) -> f64 {
    distance.max(f64::MIN_POSITIVE)
}
