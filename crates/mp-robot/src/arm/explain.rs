//! Answers for people: which link hits what, and where the arm would be free.

use super::Arm;
use mp_cspace::{Clearance, Coordinates, Rng, Space};
use rand::RngExt;

/// A link in contact.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmContact {
    /// The link.
    pub link: String,
    /// What it touches: an obstacle or another link.
    pub other: String,
    /// Whether that is a link of the arm.
    pub with_itself: bool,
    /// An estimate of how deep (m).
    pub depth: f64,
}

/// The first shell of the search, relative to the extent of the space; each is larger than the last by [`GROWTH`].
const FIRST_SHELL: f64 = 1e-4;
const GROWTH: f64 = 1.3;
const MAX_SHELLS: usize = 60;
/// Directions tried in each shell besides those along one coordinate.
const DIRECTIONS: usize = 60;
/// How often the way back to the start of the search is halved.
const HALVINGS: usize = 24;

impl Arm {
    /// What the arm touches at `q`: links and obstacles in the order of the links, then pairs of links. Empty when
    /// it is free, and when `q` is no configuration. Slow: for messages.
    pub fn explain(&mut self, q: &[f64]) -> Vec<ArmContact> {
        let Self { robot, world, query, scratch, .. } = self;
        let mut contacts = Vec::new();
        if !robot.kinematics.is_configuration(q) {
            return contacts;
        }
        robot.kinematics.frames_into(q, &mut scratch.frames);
        let frames = &scratch.frames;
        for (i, body) in robot.bodies.iter().enumerate().filter(|(_, body)| body.frame > 0) {
            for found in world.scene.contacts(query, &body.tree, &frames[body.frame]) {
                contacts.push(ArmContact {
                    link: robot.name(i).to_owned(),
                    other: found.name,
                    with_itself: false,
                    depth: found.depth,
                });
            }
        }
        for pair in &robot.pairs {
            let [a, b] = pair.bodies.map(|i| &robot.bodies[i]);
            let poses = [a, b].map(|body| &frames[body.frame]);
            if query.intersects(&a.tree, poses[0], &b.tree, poses[1]) {
                let [link, other] = pair.bodies.map(|i| robot.name(i).to_owned());
                let depth = query.depth(&a.tree, poses[0], &b.tree, poses[1]);
                contacts.push(ArmContact { link, other, with_itself: true, depth });
            }
        }
        contacts
    }

    /// A configuration of `space` near `q` with a clearance of at least `margin` (m; the
    /// [tolerance](Arm::tolerance) is a good one): `q` itself when it has that, else the nearest found, or `None`.
    ///
    /// Searches outward in shells, along each coordinate and in many other directions, then back toward `q`. The
    /// same input finds the same. Some thousands of clearance queries: for messages.
    pub fn nearest_free<C>(&mut self, q: &C::State, space: &C, margin: f64) -> Option<C::State>
    where
        C: Space,
        C::State: Coordinates,
    {
        let start = q.as_slice();
        if !self.kinematics().is_configuration(start) || space.dim() != start.len() {
            return None;
        }
        let margin = margin.max(f64::MIN_POSITIVE);
        let mut suits = |p: &C::State| space.contains(p) && self.clearance(p, margin) >= margin;
        if suits(q) {
            return Some(q.clone());
        }
        let mut rng = Rng::seed(0);
        let mut reach = FIRST_SHELL * space.extent();
        for _ in 0..MAX_SHELLS {
            let mut best: Option<(f64, C::State)> = None;
            let along = (0..2 * start.len()).map(|k| {
                let mut direction = vec![0.0; start.len()];
                direction[k / 2] = if k % 2 == 0 { 1.0 } else { -1.0 };
                direction
            });
            let others = (0..DIRECTIONS).map(|_| {
                let direction: Vec<f64> = start.iter().map(|_| rng.random_range(-1.0..1.0)).collect();
                let norm = direction.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-9);
                direction.into_iter().map(|x| x / norm).collect()
            });
            for direction in along.chain(others) {
                let p = C::State::from_fn(start.len(), |i| start[i] + reach * direction[i]);
                let distance = space.distance(q, &p);
                if best.as_ref().is_none_or(|(d, _)| distance < *d) && suits(&p) {
                    best = Some((distance, p));
                }
            }
            if let Some((_, found)) = best {
                // Back toward q, as far as it stays free.
                let (mut free, mut hit, mut best) = (1.0, 0.0, found.clone());
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (free + hit);
                    let p = space.interpolate(q, &found, middle);
                    if suits(&p) {
                        (free, best) = (middle, p);
                    } else {
                        hit = middle;
                    }
                }
                return Some(best);
            }
            if reach > space.extent() {
                return None;
            }
            reach *= GROWTH;
        }
        None
    }
}
