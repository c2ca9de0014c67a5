//! Answers for people: what each link touches, and where the arm would be free.

use super::Arm;
use crate::shells::{Shells, search_shells};
use crate::solid_obstacle::is_solid;
use mp_cspace::{Clearance, Coordinates, Rng, Space};
#[cfg(doc)]
use mp_geom::TriMesh;
use rand::RngExt;

/// A link in contact.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmContact {
    /// The name of the link.
    pub link: String,
    /// What it touches: an obstacle or another link.
    pub other: String,
    /// Whether `other` is a link of the arm.
    pub with_itself: bool,
    /// An estimate of the depth (m).
    pub depth: f64,
}

/// What is nearest to each other at a configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmGap {
    /// The name of the link.
    pub link: String,
    /// What it is near: an obstacle or another link.
    pub other: String,
    /// How far apart they are (m).
    pub distance: f64,
}

/// The radius of the first shell of a search, as a part of the extent of the space.
const FIRST_SHELL: f64 = 1e-4;
/// Beyond this (rad or m) the extent of the space has no part in it: joints may slide without end.
const FAR: f64 = 100.0;
/// How many times as large each shell is as the last.
const GROWTH: f64 = 1.3;
const MAX_SHELLS: usize = 60;
/// Directions tried in each shell besides those along one coordinate.
const DIRECTIONS: usize = 60;

impl Arm {
    /// The contacts at `q`: of links with obstacles in the order of the links, then of links with links. Empty when `q` is
    /// free, or not a configuration. Slow: meant for messages.
    pub fn explain(&mut self, q: &[f64]) -> Vec<ArmContact> {
        let Self { robot, obstacles, query, scratch, .. } = self;
        let mut contacts = Vec::new();
        if !robot.kinematics.is_configuration(q) {
            return contacts;
        }
        robot.kinematics.frames_into(q, &mut scratch.frames);
        let frames = &scratch.frames;
        for (i, body) in robot.numbered_compared() {
            for found in obstacles.scene.contacts(query, &body.tree, &frames[body.frame]) {
                contacts.push(ArmContact {
                    link: robot.name(i).to_owned(),
                    other: found.name,
                    with_itself: false,
                    depth: found.depth,
                });
            }
        }
        for pair in robot.all_pairs() {
            let [a, b] = pair.map(|i| &robot.bodies[i]);
            let poses = [a, b].map(|body| &frames[body.frame]);
            if query.meets(&a.tree, poses[0], &b.tree, poses[1]) {
                let [link, other] = pair.map(|i| robot.name(i).to_owned());
                let depth = query.depth(&a.tree, poses[0], &b.tree, poses[1]);
                contacts.push(ArmContact { link, other, with_itself: true, depth });
            }
        }
        contacts
    }

    /// The link and the obstacle, or the two links, that are nearest to each other at `q`: of those that must not touch. Where a clearance
    /// is [kept](Arm::keeping), that is what obstacles count beyond. `None` when there are none, or `q` is not a configuration.
    pub fn closest(&mut self, q: &[f64]) -> Option<ArmGap> {
        let Self { robot, obstacles, query, scratch, kept, .. } = self;
        if !robot.kinematics.is_configuration(q) {
            return None;
        }
        robot.kinematics.frames_into(q, &mut scratch.frames);
        let frames = &scratch.frames;
        let (mut closest, mut least) = (None, f64::INFINITY);
        for (_, body) in robot.numbered_compared() {
            let found = obstacles.scene.clearance(query, &body.tree, &frames[body.frame], least + *kept);
            if let (distance, Some(other)) = found
                && distance - *kept < least
            {
                (closest, least) = (Some((body.link, Err(other), distance)), distance - *kept);
            }
        }
        for pair in robot.all_pairs() {
            let [a, b] = pair.map(|i| &robot.bodies[i]);
            let distance = query.clearance(&a.tree, &frames[a.frame], &b.tree, &frames[b.frame], least);
            if distance < least {
                (closest, least) = (Some((a.link, Ok(b.link), distance)), distance);
            }
        }
        let link = |link: usize| robot.kinematics.attached[link].name.clone();
        let obstacle = |id| obstacles.scene.body(id).map_or_else(String::new, |body| body.name().to_owned());
        closest.map(|(a, b, distance)| ArmGap {
            link: link(a),
            other: b.map_or_else(obstacle, link),
            distance,
        })
    }
    /// What is inside of what, where nothing touches at `q`: pairs of names, the inner one first, of links and obstacles, or links and
    /// links that must not touch. The outer ones are closed surfaces that face outward and are no [solids](TriMesh::solids); what is
    /// inside counts as free, but can never leave: worth a warning.
    pub fn enclosures(&mut self, q: &[f64]) -> Vec<[String; 2]> {
        if !self.kinematics().is_configuration(q) || self.collides(q) {
            return Vec::new();
        }
        let Self { robot, obstacles, query, scratch, .. } = self;
        let frames = &scratch.frames;
        let mut found = Vec::new();
        for (i, body) in robot.numbered_compared() {
            let (pose, link) = (&frames[body.frame], || robot.name(i).to_owned());
            let around = obstacles.around(query, pose * body.mesh.vertices()[0]);
            found.extend(around.map(|name| [link(), name.to_owned()]));
            if body.mesh.solids().is_empty() {
                let inside: Vec<_> = obstacles.inside(query, &body.tree, pose).map(str::to_owned).collect();
                if !inside.is_empty() && is_solid(&body.mesh) {
                    found.extend(inside.into_iter().map(|name| [name, link()]));
                }
            }
        }
        for [a, b] in robot.all_pairs() {
            for [i, j] in [[a, b], [b, a]] {
                let [inner, outer] = [i, j].map(|k| &robot.bodies[k]);
                let p = frames[outer.frame].inv_mul(&frames[inner.frame]) * inner.mesh.vertices()[0];
                if outer.mesh.solids().is_empty()
                    && query.winding(&outer.tree, &p).is_some_and(|n| n > 0)
                    && is_solid(&outer.mesh)
                {
                    found.push([i, j].map(|k| robot.name(k).to_owned()));
                }
            }
        }
        found
    }

    /// A configuration of `space` near `q` with a clearance of at least `margin` (m; the
    /// [tolerance](Arm::tolerance) is a good value): `q` itself if it has that clearance, else the nearest found, or `None`.
    ///
    /// The search moves along each degree of freedom and in many other directions by growing amounts, then goes back toward
    /// `q`.
    /// The same input gives the same result, unless the arm is [interrupted](Arm::with_interrupt): then the result is any configuration. Some
    /// thousands of clearance queries: meant for messages.
    pub fn nearest_free<C>(&mut self, q: &C::State, space: &C, margin: f64) -> Option<C::State>
    where
        C: Space,
        C::State: Coordinates,
    {
        let start = q.as_slice();
        let dim = self.kinematics().dof();
        if !self.kinematics().is_configuration(start) || space.dim() != dim {
            return None;
        }
        let margin = margin.max(f64::MIN_POSITIVE);
        let shells =
            Shells { first: FIRST_SHELL * space.extent().min(FAR), growth: GROWTH, most: MAX_SHELLS };
        let mut rng = Rng::seed(0);
        let candidates = |_, radius: f64| {
            let along = (0..2 * dim).map(|k| {
                let mut direction = vec![0.0; dim];
                direction[k / 2] = if k % 2 == 0 { 1.0 } else { -1.0 };
                direction
            });
            let others = (0..DIRECTIONS).map(|_| {
                let direction: Vec<f64> = (0..dim).map(|_| rng.random_range(-1.0..1.0)).collect();
                let norm = direction.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-9);
                direction.into_iter().map(|x| x / norm).collect()
            });
            let moved = |direction: Vec<f64>| space.moved(q, &direction, radius);
            along.chain(others).filter_map(moved).collect()
        };
        // Told to end, it ends with any answer.
        let mut told = self.interrupt.clone();
        let suits = |p: &C::State| told.ask() || (space.contains(p) && self.clearance(p, margin) >= margin);
        search_shells(space, q, &shells, candidates, suits)
    }
}
