//! Queries in which one mesh, or both, are balls.

use nalgebra::{Isometry3, Point3, Vector3};

use crate::bvh::frames::Frames;
use crate::cloud::{Found, Reach};
use crate::mesh::{CollisionMesh, PosedMesh};
use crate::pose::{LIMIT, Relative, to_world};
use crate::query::Query;
use crate::query::interval::{IntervalCheck, RigidMotion};
use crate::separation::Separation;

/// The nearest pair below a distance, or any one.
struct Nearest {
    below: f64,
    found: Option<Found>,
    any: bool,
}

impl Reach for Nearest {
    fn of(&self, _: &Point3<f64>, _: f64) -> f64 {
        self.below
    }

    fn take(&mut self, found: Found) -> bool {
        self.below = found.distance;
        self.found = Some(found);
        self.any
    }
}

/// Pairs that may come nearer to each other than `wanted` during an interval of a motion of the mesh.
struct During {
    wanted: f64,
    /// In the frame of the mesh.
    shift: Vector3<f64>,
    turn: Vector3<f64>,
    angle: f64,
    most: f64,
    found: Option<Found>,
}

impl Reach for During {
    /// A point p goes from the middle by at most `‖shift + turn × p‖`, and leaves that line by at most `angle²/2·‖p‖`.
    fn of(&self, center: &Point3<f64>, radius: f64) -> f64 {
        let line = (self.shift + self.turn.cross(&center.coords)).norm() + self.angle * radius;
        let bend = 0.5 * self.angle * self.angle * (center.coords.norm() + radius);
        self.wanted + ((line + bend) * (1.0 + 1e-9)).min(self.most)
    }

    fn take(&mut self, found: Found) -> bool {
        self.found = Some(found);
        true
    }
}

/// All points of a cloud nearer than `below`.
struct All {
    below: f64,
    ids: Vec<usize>,
}

impl Reach for All {
    fn of(&self, _: &Point3<f64>, _: f64) -> f64 {
        self.below
    }

    fn take(&mut self, found: Found) -> bool {
        self.ids.push(found.id);
        false
    }
}

impl Query {
    /// The balls of `cloud` that are at most `reach` (metres) from a mesh of triangles, or inside of it if it is closed: their numbers, ascending. All
    /// of them for bad input.
    pub fn balls_near(
        &mut self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        cloud: &CollisionMesh,
        pose_wc: &Isometry3<f64>,
        reach: f64,
    ) -> Vec<usize> {
        let (Some(pair), Some(balls)) = (Pair::new((mesh, pose_wm), (cloud, pose_wc)), &cloud.cloud) else {
            return (0..cloud.triangle_count()).collect();
        };
        let mut all = All { below: (reach.max(0.0) + pair.radius).next_up(), ids: Vec::new() };
        pair.search(self, &mut all);
        for (id, p) in balls.centers().iter().enumerate() {
            let p = pair.relative.point(p);
            let bounds = &mesh.tree().bounding;
            let inside = !bounds.is_beyond(&(p - bounds.center), pair.relative.slack)
                && self.winding(mesh, &p).is_none_or(|turns| turns > 0);
            all.ids.extend(inside.then_some(id));
        }
        all.ids.sort_unstable();
        all.ids.dedup();
        all.ids
    }
}

/// Two bodies, of which one at least is a cloud: the cloud `b`, and what it is compared with, in whose frame the search is.
struct Pair<'q> {
    a: PosedMesh<'q>,
    b: PosedMesh<'q>,
    /// Whether they were given the other way round.
    swapped: bool,
    relative: Relative,
    /// The sum of the radii of balls.
    radius: f64,
}

impl<'q> Pair<'q> {
    /// `None` when pose or size are beyond the limits.
    fn new(a: PosedMesh<'q>, b: PosedMesh<'q>) -> Option<Self> {
        let swapped = b.0.cloud.is_none();
        let (a, b) = if swapped { (b, a) } else { (a, b) };
        let radius = a.0.rounding() + b.0.rounding();
        Some(Self { a, b, swapped, relative: Relative::of(a, b)?, radius })
    }

    fn search(&self, query: &mut Query, reach: &mut impl Reach) {
        let (counters, relative) = (&mut query.counters, &self.relative);
        let Some(cloud) = &self.b.0.cloud else { return };
        match &self.a.0.cloud {
            Some(other) => cloud.near_cloud(other, relative, reach, counters),
            None => {
                let (a, b) = (self.a.0.tree(), self.b.0.tree());
                let boxes = Frames::new(a, b, relative).fits_f32(a, b);
                cloud.near_mesh(a, relative, boxes, reach, counters)
            }
        };
    }

    /// The nearest place and point, or any, if their distance is below `below`.
    fn nearest(&self, query: &mut Query, below: f64, any: bool) -> Option<Found> {
        let mut nearest = Nearest { below, found: None, any };
        self.search(query, &mut nearest);
        nearest.found
    }

    /// The numbers of what is near each other, in the order given.
    fn numbers(&self, found: &Found) -> (usize, usize) {
        if self.swapped { (found.id, found.part) } else { (found.part, found.id) }
    }
}

/// The clearance of two bodies, and the number of what is nearest on the second.
pub(super) fn clearance(
    query: &mut Query,
    a: PosedMesh<'_>,
    b: PosedMesh<'_>,
    enough: f64,
) -> (f64, Option<usize>) {
    let Some(pair) = Pair::new(a, b) else { return (0.0, Some(0)) };
    let enough = if enough.is_nan() { f64::INFINITY } else { enough.max(0.0) };
    // A little more, so that touching is found.
    let below = (enough + pair.radius).next_up();
    match pair.nearest(query, below, false) {
        Some(found) => ((found.distance - pair.radius).max(0.0), Some(pair.numbers(&found).1)),
        None => (enough.max(f64::MIN_POSITIVE), None),
    }
}

/// Whether the distance of two bodies is at most `tolerance`.
pub(super) fn within(query: &mut Query, a: PosedMesh<'_>, b: PosedMesh<'_>, tolerance: f64) -> bool {
    let Some(pair) = Pair::new(a, b) else { return true };
    let tolerance = if tolerance.is_nan() { f64::INFINITY } else { tolerance.max(0.0) };
    pair.nearest(query, (tolerance + pair.radius).next_up(), true).is_some()
}

/// What intersects of two bodies; (0, 0) for bad input.
pub(super) fn intersecting(query: &mut Query, a: PosedMesh<'_>, b: PosedMesh<'_>) -> Option<(usize, usize)> {
    let Some(pair) = Pair::new(a, b) else { return Some((0, 0)) };
    let found = pair.nearest(query, pair.radius.next_up(), true)?;
    Some(pair.numbers(&found))
}

/// The distance of two bodies.
pub(super) fn distance(query: &mut Query, a: PosedMesh<'_>, b: PosedMesh<'_>) -> Separation {
    let nowhere = Separation { distance: 0.0, point_a: Point3::origin(), point_b: Point3::origin() };
    let Some(pair) = Pair::new(a, b) else { return nowhere };
    let Some(Found { distance, on, point, part, id }) = pair.nearest(query, f64::INFINITY, false) else {
        return nowhere;
    };
    // From the places found to the surfaces of the balls.
    let radius = |mesh: &CollisionMesh, i| mesh.cloud.as_ref().map_or(0.0, |cloud| cloud.radius_of(i));
    let (own, other) = (radius(pair.a.0, part), radius(pair.b.0, id));
    let (from, to) = match distance > pair.radius {
        true => {
            let way = (point - on).normalize();
            (on + way * own, point - way * other)
        }
        // A place on the line between, within both.
        false => (on, on),
    };
    let [from, to] = [from, to].map(|p| to_world(pair.a.1, &p));
    let (point_a, point_b) = if pair.swapped { (to, from) } else { (from, to) };
    Separation { distance: (distance - pair.radius).max(0.0), point_a, point_b }
}

/// Whether `a` keeps a margin from `b` along an interval.
pub(super) fn check_interval(
    query: &mut Query,
    a: PosedMesh<'_>,
    motion: &RigidMotion,
    b: PosedMesh<'_>,
    margin: f64,
) -> IntervalCheck {
    let Some(pair) = Pair::new(a, b).filter(|_| motion.is_usable() && margin.abs() <= LIMIT) else {
        return IntervalCheck::Unproven;
    };
    let wanted = pair.radius + margin.max(0.0);
    // Where the moving body is the cloud, its parts are not told apart.
    let back = pair.a.1.rotation.inverse();
    let (shift, turn) = match pair.swapped {
        false => (back * motion.shift, back * motion.turn),
        true => (Vector3::repeat(motion.most), Vector3::zeros()),
    };
    let most = motion.most;
    let mut during = During { wanted: wanted.next_up(), shift, turn, angle: turn.norm(), most, found: None };
    pair.search(query, &mut during);
    match during.found {
        None => IntervalCheck::Free,
        Some(found) if found.distance <= pair.radius => IntervalCheck::Collision { at: 0.0 },
        Some(found) if found.distance < wanted => IntervalCheck::TooClose { at: 0.0 },
        Some(_) => IntervalCheck::Unproven,
    }
}

/// The first of some poses at which two bodies intersect.
pub(super) fn first_collision(
    query: &mut Query,
    a: &CollisionMesh,
    poses_wa: &[Isometry3<f64>],
    b: PosedMesh<'_>,
) -> Option<usize> {
    query.counters.queries += poses_wa.len() as u64;
    poses_wa.iter().position(|pose| within(query, (a, pose), b, 0.0))
}
