//! Answers for people: what a rigid body touches, and where it would be free.

use crate::shells::{Shells, search_shells};
use crate::solid_obstacle::is_solid;
use crate::{Placement, RigidBody};
use mp_collide::Contact;
use mp_cspace::{Clearance, Space};
#[cfg(doc)]
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// The radius of the first shell of a search, as a part of the robot's size.
const FIRST_SHELL: f64 = 1e-3;
/// How many times as large each shell is as the last.
const GROWTH: f64 = 1.4;
const MAX_SHELLS: usize = 100;

impl<P: Placement> RigidBody<P> {
    /// The obstacles that the robot touches at `q`, in the order in which they were given, each with an estimate of the
    /// depth (m). Empty when `q` is free. Slow: meant for messages.
    pub fn explain(&mut self, q: &P::State) -> Vec<Contact> {
        let pose = P::pose(q);
        let shared = &*self.shared;
        let mut contacts = shared.obstacles.scene.contacts(&mut self.query, &shared.robot, &pose);
        if shared.radii.radius == 0.0 {
            // The depth of a point inside a solid is its distance from the surface, which it does not touch.
            let p = Point3::from(pose.translation.vector);
            for (body, solid) in shared.solids() {
                let Some(obstacle) = shared.obstacles.scene.body(*body).filter(|_| solid.contains(&p)) else {
                    continue;
                };
                let to_surface = self.query.distance(&shared.robot, &pose, obstacle.mesh(), obstacle.pose());
                if to_surface.distance > 0.0 {
                    let (name, depth) = (obstacle.name().to_owned(), to_surface.distance);
                    contacts.retain(|c| c.body != *body);
                    contacts.push(Contact { body: *body, name, depth });
                }
            }
            contacts.sort_by_key(|c| c.body);
        }
        contacts
    }

    /// The name of the obstacle nearest to the robot at `q`, and its distance (m); `None` when there are no obstacles.
    pub fn closest(&mut self, q: &P::State) -> Option<(String, f64)> {
        let shared = &*self.shared;
        let scene = &shared.obstacles.scene;
        let (distance, id) = scene.clearance(&mut self.query, &shared.robot, &P::pose(q), f64::INFINITY);
        Some((scene.body(id?)?.name().to_owned(), distance))
    }

    /// The names of the solid obstacles (closed, triangles facing outward) that contain the first vertex of the robot at
    /// `q`. A robot inside an obstacle that touches nothing counts as free, but can never leave: worth a warning.
    #[must_use]
    pub fn enclosing(&self, q: &P::State) -> Vec<&str> {
        let vertex = P::pose(q) * self.shared.robot_mesh.vertices()[0];
        let around = self.shared.solids().iter().filter(|(_, solid)| solid.contains(&vertex));
        around.map(|(_, solid)| solid.name.as_str()).collect()
    }

    /// What is inside of what, where nothing touches at `q`: obstacles around the robot, and obstacles in it, each with whether it is
    /// around. All are closed surfaces that face outward and are no [solids](TriMesh::solids); what is inside counts as free, but can
    /// never leave: worth a warning.
    pub fn enclosures(&mut self, q: &P::State) -> Vec<(String, bool)> {
        if self.in_contact(q) {
            return Vec::new();
        }
        let (pose, shared) = (P::pose(q), &*self.shared);
        let (query, obstacles, mesh) = (&mut self.query, &shared.obstacles, &shared.robot_mesh);
        let mut found: Vec<_> =
            obstacles.around(query, pose * mesh.vertices()[0]).map(|name| (name.to_owned(), true)).collect();
        if mesh.solids().is_empty() {
            let inside: Vec<_> = obstacles.inside(query, &shared.robot, &pose).map(str::to_owned).collect();
            if !inside.is_empty() && is_solid(mesh) {
                found.extend(inside.into_iter().map(|name| (name, false)));
            }
        }
        found
    }

    /// A configuration of `space` near `q` with a clearance of at least `margin` (m; the
    /// [tolerance](RigidBody::tolerance) is a good value): `q` itself if it has that clearance, else the nearest
    /// found, or `None`.
    ///
    /// The search moves and turns the robot in many directions by growing amounts, then goes back toward `q`. It looks
    /// outside of solids first, then anywhere. The same input gives the same result. Some thousands of clearance
    /// queries: meant for messages.
    pub fn nearest_free<C: Space<State = P::State>>(
        &mut self,
        q: &P::State,
        space: &C,
        margin: f64,
    ) -> Option<P::State> {
        if !P::pose(q).to_homogeneous().iter().all(|v| v.is_finite()) {
            return None;
        }
        let suits = |robot: &mut Self, p: &P::State, outside: bool| {
            space.contains(p)
                && robot.clearance(p, margin.max(f64::MIN_POSITIVE)) >= margin.max(f64::MIN_POSITIVE)
                && (!outside || robot.enclosing(p).is_empty())
        };
        let pose = P::pose(q);
        let size = if self.radius() > 0.0 { self.radius() } else { 0.01 * space.extent() };
        let shells = Shells { first: FIRST_SHELL * size, growth: GROWTH, most: MAX_SHELLS };
        let candidates = |shell: usize, radius: f64| {
            let angle = (radius / size).min(PI);
            let moved = |(step, turn): (Vector3<f64>, Vector3<f64>)| {
                let rotation = UnitQuaternion::from_scaled_axis(turn * angle) * pose.rotation;
                let translation = Translation3::from(pose.translation.vector + step * radius);
                P::configuration(&Isometry3::from_parts(translation, rotation))
            };
            directions::<P>(shell).into_iter().map(moved).collect()
        };
        [true, false]
            .into_iter()
            .find_map(|outside| search_shells(space, q, &shells, candidates, |p| suits(self, p, outside)))
    }
}

/// Pairs of a step and a turn, each a unit vector or zero, but not both zero. Steps are along and between the axes along
/// which the robot can move, each with a turn either way about each axis about which it can turn. The steps are rotated
/// with every shell, so that further shells try other directions.
fn directions<P: Placement>(shell: usize) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let axes = |free: &[usize]| {
        let mut all = vec![Vector3::zeros()];
        for &axis in free {
            let known = all.clone();
            for sign in [1.0, -1.0] {
                all.extend(known.iter().map(|v: &Vector3<f64>| {
                    let mut v = *v;
                    v[axis] = sign;
                    v
                }));
            }
        }
        all
    };
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    let about = if P::MOVES.contains(&2) { Vector3::new(1.0, 1.0, 1.0).normalize() } else { Vector3::z() };
    let spin = UnitQuaternion::from_scaled_axis(about * (golden_angle * shell as f64));
    let steps = axes(P::MOVES).into_iter().map(|v| v.try_normalize(0.0).map_or(v, |v| spin * v));
    let turns = axes(P::TURNS).into_iter().filter(|v| v.norm_squared() < 1.5);
    let turns: Vec<Vector3<f64>> = turns.collect();
    steps.flat_map(|s| turns.iter().map(move |t| (s, *t)).collect::<Vec<_>>()).skip(1).collect()
}
