//! A search over a cloud and a mesh, or another cloud: pairs of their nodes that are near each other.

use super::{Cloud, LEAF};
use crate::bvh::{self, Tree};
use crate::counters::Counters;
use crate::pose::Relative;
use crate::triangle::closest_to_point;
use nalgebra::Point3;

/// The axes of boxes are orthonormal to rounding in `f32`: distances measured along them are wrong by less than this part.
const SKEW: f64 = 2e-6;

/// A place of a mesh and a point of a cloud that are near each other, in the frame of the mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    /// Their distance (m), and how much smaller their balls are than the largest of each cloud: what is left when the radii of the clouds
    /// are taken away is the distance of the balls.
    pub(crate) distance: f64,
    /// The place on the other.
    pub(crate) on: Point3<f64>,
    pub(crate) point: Point3<f64>,
    /// The number of the triangle, or of the point of the other cloud.
    pub(crate) part: usize,
    /// The number of the point of the cloud.
    pub(crate) id: usize,
}

/// What a search is after.
pub(crate) trait Reach {
    /// Points as far as this (m) from what is in a ball of the other, or farther, are of no interest.
    fn of(&self, center: &Point3<f64>, radius: f64) -> f64;
    /// Takes a pair nearer than that. Returns whether the search is over.
    fn take(&mut self, found: Found) -> bool;
}

/// What a cloud is compared with.
trait Other {
    fn root(&self) -> u32;
    /// The ball around a node.
    fn ball(&self, node: u32) -> (Point3<f64>, f64);
    /// A lower bound on the distance of a point from what is in a node.
    fn bound(&self, node: u32, p: &Point3<f64>) -> f64;
    /// Calls `visit` with each child, and returns `true`; `false` for a leaf.
    fn children(&self, node: u32, visit: impl FnMut(u32)) -> bool;
    /// Calls `visit` with each place in a leaf that is nearest to a point, its number, and how much smaller its ball is than the largest.
    fn nearest(&self, leaf: u32, p: &Point3<f64>, visit: impl FnMut(Point3<f64>, usize, f64));
}

impl Other for Tree {
    fn root(&self) -> u32 {
        self.root
    }

    fn ball(&self, node: u32) -> (Point3<f64>, f64) {
        let own = self.own(node);
        let center =
            Point3::from(self.center.coords + nalgebra::Vector3::from(own.frame.map(|row| row[0].into())));
        (center, f64::from(own.size).sqrt() * (1.0 + SKEW))
    }

    fn bound(&self, node: u32, p: &Point3<f64>) -> f64 {
        let own = self.own(node);
        let from: [f64; 3] = std::array::from_fn(|d| p[d] - self.center[d] - f64::from(own.frame[d][0]));
        let mut squared = 0.0;
        for k in 0..3 {
            let along: f64 = (0..3).map(|d| from[d] * f64::from(own.frame[d][k + 1])).sum();
            let beyond = (along.abs() - f64::from(own.half[k])).max(0.0);
            squared += beyond * beyond;
        }
        squared.sqrt() * (1.0 - SKEW)
    }

    fn children(&self, node: u32, visit: impl FnMut(u32)) -> bool {
        let inner = node & bvh::LEAF == 0;
        if inner {
            self.nodes[node as usize].children().for_each(visit);
        }
        inner
    }

    fn nearest(&self, leaf: u32, p: &Point3<f64>, mut visit: impl FnMut(Point3<f64>, usize, f64)) {
        let leaf = &self.leaves[(leaf & !bvh::LEAF) as usize];
        for i in leaf.first as usize..(leaf.first + leaf.count) as usize {
            visit(closest_to_point(&self.triangles[i], p), self.ids[i] as usize, 0.0);
        }
    }
}

impl Other for Cloud {
    fn root(&self) -> u32 {
        0
    }

    fn ball(&self, node: u32) -> (Point3<f64>, f64) {
        let node = &self.nodes[node as usize];
        (node.center, node.radius)
    }

    fn bound(&self, node: u32, p: &Point3<f64>) -> f64 {
        let node = &self.nodes[node as usize];
        (p - node.center).norm() - node.reach
    }

    fn children(&self, node: u32, mut visit: impl FnMut(u32)) -> bool {
        let second = self.nodes[node as usize].second;
        if second > 0 {
            visit(node + 1);
            visit(second);
        }
        second > 0
    }

    fn nearest(&self, leaf: u32, _: &Point3<f64>, mut visit: impl FnMut(Point3<f64>, usize, f64)) {
        let node = &self.nodes[leaf as usize];
        let own = node.first as usize..(node.first + node.count) as usize;
        own.for_each(|i| visit(self.points[i], self.ids[i] as usize, self.smaller(i)));
    }
}

impl Cloud {
    /// Searches the points near a mesh; `relative` takes points of the cloud into the frame of the mesh. Boxes are used if `boxes`, or else
    /// all pairs are compared. Returns whether `reach` ended it.
    pub(crate) fn near_mesh(
        &self,
        mesh: &Tree,
        relative: &Relative,
        boxes: bool,
        reach: &mut impl Reach,
        counters: &mut Counters,
    ) -> bool {
        if boxes {
            return Search { other: mesh, cloud: self, relative, reach, counters }.run();
        }
        self.points.iter().zip(&self.ids).enumerate().any(|(i, (p, id))| {
            let point = relative.point(p);
            let mut triangles = mesh.triangles.iter().zip(&mesh.ids);
            triangles.any(|(triangle, part)| {
                let on = closest_to_point(triangle, &point);
                let distance = (on - point).norm() + self.smaller(i);
                let found = Found { distance, on, point, part: *part as usize, id: *id as usize };
                distance < reach.of(&mesh.center, mesh.radius_center) && reach.take(found)
            })
        })
    }

    /// Searches the points near those of another cloud.
    pub(crate) fn near_cloud(
        &self,
        other: &Cloud,
        relative: &Relative,
        reach: &mut impl Reach,
        counters: &mut Counters,
    ) -> bool {
        Search { other, cloud: self, relative, reach, counters }.run()
    }
}

struct Search<'s, O, R> {
    other: &'s O,
    cloud: &'s Cloud,
    relative: &'s Relative,
    reach: &'s mut R,
    counters: &'s mut Counters,
}

/// A node of the cloud, its centre in the frame of the other.
#[derive(Clone, Copy)]
struct Placed {
    node: u32,
    center: Point3<f64>,
}

impl<O: Other, R: Reach> Search<'_, O, R> {
    fn run(&mut self) -> bool {
        let (other, cloud) = (self.other.root(), self.placed(0));
        self.bound(other, cloud).is_some() && self.visit(other, cloud)
    }

    fn placed(&self, node: u32) -> Placed {
        Placed { node, center: self.relative.point(&self.cloud.nodes[node as usize].center) }
    }

    /// A lower bound on the distance of what is in two nodes, if that is of interest.
    fn bound(&mut self, other: u32, cloud: Placed) -> Option<f64> {
        self.counters.box_tests += 1;
        let reach = self.cloud.nodes[cloud.node as usize].reach;
        let bound = self.other.bound(other, &cloud.center) - reach - self.relative.slack;
        let (center, around) = self.other.ball(other);
        (bound < self.reach.of(&center, around)).then_some(bound)
    }

    /// Compares what is in two nodes, the nearest first. Returns whether the search is over.
    fn visit(&mut self, other: u32, cloud: Placed) -> bool {
        let node = self.cloud.nodes[cloud.node as usize];
        let (mut parts, mut count) = ([(0.0, 0, cloud); bvh::WIDTH], 0);
        let mut open = |search: &mut Self, other: u32, cloud: Placed| {
            if let Some(bound) = search.bound(other, cloud) {
                parts[count] = (bound, other, cloud);
                count += 1;
            }
        };
        let split_other = node.second == 0 || self.other.ball(other).1 > node.radius;
        let (mut list, mut listed) = ([0; bvh::WIDTH], 0);
        let inner = split_other
            && self.other.children(other, |child| {
                list[listed] = child;
                listed += 1;
            });
        if inner {
            for child in &list[..listed] {
                open(self, *child, cloud);
            }
        } else if node.second > 0 {
            for child in [cloud.node + 1, node.second] {
                let child = self.placed(child);
                open(self, other, child);
            }
        } else {
            return self.compare(other, node.first as usize, node.count as usize);
        }
        let parts = &mut parts[..count];
        parts.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2.node).cmp(&(y.1, y.2.node))));
        parts.iter().any(|&(bound, other, cloud)| {
            let (center, around) = self.other.ball(other);
            bound < self.reach.of(&center, around) && self.visit(other, cloud)
        })
    }

    /// Compares the points of a leaf with what is in a leaf of the other.
    fn compare(&mut self, other: u32, first: usize, count: usize) -> bool {
        debug_assert!(count <= LEAF);
        let (center, around) = self.other.ball(other);
        let slack = self.relative.slack;
        for i in first..first + count {
            let (point, smaller) = (self.relative.point(&self.cloud.points[i]), self.cloud.smaller(i));
            if self.other.bound(other, &point) + smaller - slack >= self.reach.of(&center, around) {
                continue;
            }
            let (mut best, mut tests): (Option<(f64, Point3<f64>, usize)>, _) = (None, 0);
            self.other.nearest(other, &point, |on, part, less| {
                tests += 1;
                let mut squared = (on - point).norm_squared();
                if less > 0.0 {
                    let distance = squared.sqrt() + less;
                    squared = distance * distance;
                }
                if best.is_none_or(|(least, ..)| squared < least) {
                    best = Some((squared, on, part));
                }
            });
            self.counters.triangle_tests += tests;
            let Some((squared, on, part)) = best else { continue };
            let distance = squared.sqrt() + smaller;
            let found = Found { distance, on, point, part, id: self.cloud.ids[i] as usize };
            if found.distance < self.reach.of(&center, around) && self.reach.take(found) {
                return true;
            }
        }
        false
    }
}
