//! The independent check of arm motions.

mod curves;
mod reference_arm;

pub(super) use reference_arm::ReferenceArm;

use super::Arm;
use crate::obstacles::PlacedReference;
use mp_collide::reference::{Drift, Hint, KeptApart, RefMesh};
use mp_cspace::{Coordinates, Curve, Interrupt, MotionCheck, MotionValidity, ParameterError, Space};
use nalgebra::Isometry3;
use reference_arm::{CheckedPair, POSE, Placement, Travels, base_travel};
use std::collections::{HashSet, VecDeque};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Proves motions of an [`Arm`] free of collision, with other code than planners use: its own kinematic tree, built from
/// the names in the model and multiplied out as homogeneous matrices; its own bounds on how far links
/// move; its own subdivision; and the sphere trees of `mp_collide::reference`. It shares with the checker only the space,
/// whose interpolation defines what a motion is, and the list of [pairs of links](Arm::checked_pairs) that must not
/// touch.
///
/// - free means that links keep at least the tolerance from obstacles and from each other all along, and none is inside of a
///   [solid](mp_geom::TriMesh::solids);
/// - a motion with a tested state of less than twice the tolerance is [`Unproven`](MotionCheck::Unproven), as
///   are motions that take more than a million parts, and motions of a million radians or metres.
///
/// A motion is proved in parts, each about its middle as far as what moves uses up the distances there: of links that are balls by the
/// velocity along the shortest way ([`RefMesh::keeps_apart`]), of others by how far their points go.
///
/// Coordinates must go at constant speed, and by no more than a turn, as in [`Arm::space`]; a base that floats as in
/// [`Arm::floating_space`].
#[derive(Clone, Debug)]
pub struct ArmVerifier<'c, C> {
    space: &'c C,
    tree: Arc<ReferenceArm>,
    /// The obstacles and their poses.
    world: Arc<[PlacedReference]>,
    pairs: Vec<CheckedPair>,
    /// For each pair, what the last search left for the next one: of a link and the obstacles, one for each of them. They are forgotten
    /// with each motion, so that an answer depends on that alone.
    hints: Vec<Vec<Hint>>,
    tolerance: f64,
    /// The clearance (m) that the arm keeps from obstacles, to which the tolerance is added.
    kept: f64,
    parts: u64,
    interrupt: Interrupt,
    /// The end of the last motion that was found free, where nothing is inside of anything.
    apart: Option<Vec<f64>>,
}

/// Motions of a coordinate longer than this (rad or m) are refused.
const MAX_TRAVEL: f64 = 1e6;

/// The ways of a coordinate to both ends of a part differ by no more than this share, which the bound on travel has in hand.
const EVEN: f64 = 1e-10;

/// Motions are not cut into more parts than this.
const MAX_PARTS: u64 = 1_000_000;

/// What is found over a part of a motion.
enum PartCheck {
    /// All pairs keep apart.
    Apart,
    /// These pairs come too near to tell.
    Near(Near),
    /// Touching in the middle.
    Collision,
    /// Too near to contact in the middle, or interrupted.
    Unproven,
}

/// Pairs that come too near over a part of a motion.
struct Near {
    /// Before its middle, and after it.
    pairs: [Vec<usize>; 2],
    /// Over which shares of it, before and after the middle, they keep apart if coordinates go at constant speed.
    free: [f64; 2],
    /// The least clearance (m) there.
    clearance: f64,
}

impl<'c, C> ArmVerifier<'c, C>
where
    C: Space,
    C::State: Coordinates,
{
    /// A verifier for `arm` in `space` with a tenth of the arm's [tolerance](Arm::tolerance).
    ///
    /// # Errors
    /// When the tolerance is not positive and finite. The tolerance of an arm always is.
    pub fn new(space: &'c C, arm: &Arm) -> Result<Self, ParameterError> {
        Self::with_tolerance(space, arm, arm.tolerance() * 0.1)
    }

    /// A verifier with the tolerance `tolerance` (m).
    ///
    /// # Errors
    /// When the tolerance is not positive and finite.
    pub fn with_tolerance(space: &'c C, arm: &Arm, tolerance: f64) -> Result<Self, ParameterError> {
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            let (name, expected) = ("the tolerance", "positive and finite");
            return Err(ParameterError { name, expected, value: tolerance });
        }
        let tree = arm.reference();
        let world = arm.obstacles.references();
        let mut pairs = Vec::new();
        let names: HashSet<&str> = arm.compared_with_obstacles().collect();
        let solid = |i: &usize| {
            let link = &tree.links[*i];
            link.mesh.is_some() && (tree.pose > 0 || tree.is_moved(*i) || names.contains(&*link.name))
        };
        for link in (0..tree.links.len()).filter(solid) {
            if !world.is_empty() {
                pairs.push(CheckedPair { link, other: None, meet: None });
            }
        }
        pairs.extend_from_slice(&tree.pairs);
        let hints = pairs.iter().map(|pair| match pair.other {
            Some(_) => vec![Hint::default()],
            None => vec![Hint::default(); world.len()],
        });
        Ok(Self {
            hints: hints.collect(),
            space,
            tree,
            world,
            pairs,
            tolerance,
            kept: arm.kept(),
            parts: 0,
            interrupt: Interrupt::never(),
            apart: None,
        })
    }

    /// The clearance (m) that motions found free keep between links and everything else, beyond what the arm [keeps](Arm::keeping) from
    /// obstacles.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// How many parts of motions have been tested so far.
    #[must_use]
    pub fn parts(&self) -> u64 {
        self.parts
    }

    /// How far at most each coordinate and the base are from the configuration in the middle between these two. Continuous joints turn by the
    /// shorter way.
    fn travels(&self, middle: &C::State, ends: [&C::State; 2]) -> Travels {
        let pose = self.tree.pose;
        let (base, joints) = middle.as_slice().split_at(pose);
        let ways = |(i, endless): (usize, &bool)| {
            ends.map(|end| {
                let d = end.as_slice()[pose + i] - joints[i];
                if *endless && d.abs() > PI { d - (d / TAU).round() * TAU } else { d }
            })
        };
        let ways: Vec<_> = self.tree.coordinates.iter().enumerate().map(ways).collect();
        let base = (pose > 0).then(|| {
            let [[slide, turn], [s, t]] = ends.map(|end| base_travel(base, &end.as_slice()[..pose]));
            [slide.max(s), turn.max(t)]
        });
        // By the contract of the space, up to rounding that is no part of the bound.
        let is_even = |[before, after]: &[f64; 2]| (before + after).abs() <= EVEN * after.abs();
        let ahead = ways.iter().all(is_even).then(|| ways.iter().map(|[_, after]| *after).collect());
        let joints = ways.iter().map(|[before, after]| before.abs().max(after.abs())).collect();
        Travels { joints, ahead, base }
    }

    /// The clearance (m) that the two of a pair keep.
    fn kept_from(&self, pair: &CheckedPair) -> f64 {
        if pair.other.is_none() { self.kept } else { 0.0 }
    }

    /// A lower bound on the distance of pair `i` that is at least `enough`, if possible at least `wanted`; else, as an error, the distance of
    /// two of their triangles that is less.
    fn distance(&mut self, i: usize, placed: &Placement, [enough, wanted]: [f64; 2]) -> Result<f64, f64> {
        let mut hints = std::mem::take(&mut self.hints[i]);
        let found = self.least(&self.pairs[i], placed, enough, |k, [mesh, other], [pose, at], enough| {
            mesh.at_least_from(pose, other, at, [enough, wanted], &mut hints[k])
        });
        self.hints[i] = hints;
        found
    }

    /// Over which part of a motion the links of pair `i`, of which the first is balls, keep the distance `needed` (m).
    fn keeps_apart(&mut self, i: usize, placed: &Placement, drifts: [&Drift; 2], needed: f64) -> KeptApart {
        let mut hints = std::mem::take(&mut self.hints[i]);
        let mut found = KeptApart::new(needed);
        let pair = &self.pairs[i];
        if let Some((balls, pose)) = self.mesh(pair.link, placed) {
            for ((other, at), hint) in self.others(pair, placed).zip(&mut hints) {
                balls.keeps_apart(&pose, other, &at, drifts, hint, &mut found);
            }
        }
        self.hints[i] = hints;
        found
    }

    /// The least of what `bound` says of the link of a pair and each that it must not touch, by its number, unless that is surely at
    /// least `enough`.
    ///
    /// # Errors
    /// That of `bound`.
    fn least(
        &self,
        pair: &CheckedPair,
        placed: &Placement,
        enough: f64,
        mut bound: impl FnMut(usize, [&RefMesh; 2], [&Isometry3<f64>; 2], f64) -> Result<f64, f64>,
    ) -> Result<f64, f64> {
        let Some((mesh, pose)) = self.mesh(pair.link, placed) else { return Ok(f64::INFINITY) };
        if pair.other.is_some() {
            let other = self.others(pair, placed).next();
            return other
                .map_or(Ok(f64::INFINITY), |(other, at)| bound(0, [mesh, other], [&pose, &at], enough));
        }
        // Most obstacles are far from the ball around a link.
        let (center, radius) = mesh.around();
        let center = pose * center;
        let mut least = f64::INFINITY;
        for (k, (obstacle, at)) in self.world.iter().enumerate() {
            let far = obstacle.distance_bound(at, &center, radius);
            let far =
                if far >= enough.min(least) { far } else { bound(k, [mesh, obstacle], [&pose, at], enough)? };
            least = least.min(far);
        }
        Ok(least)
    }

    /// The mesh of a link, and where it is; `None` when it has none.
    fn mesh(&self, link: usize, placed: &Placement) -> Option<(&RefMesh, Isometry3<f64>)> {
        Some((self.tree.links[link].mesh.as_ref()?, placed.frames[link]))
    }

    /// What the link of a pair must not touch, where it is: another link, or all obstacles.
    fn others<'a>(
        &'a self,
        pair: &CheckedPair,
        placed: &Placement,
    ) -> impl Iterator<Item = (&'a RefMesh, Isometry3<f64>)> {
        let world = if pair.other.is_none() { &*self.world } else { &[] };
        let link = pair.other.and_then(|other| self.mesh(other, placed));
        link.into_iter().chain(world.iter().map(|(mesh, pose)| (&**mesh, *pose)))
    }

    /// Whether of any pair one is inside of the other, which is solid, where their surfaces are apart.
    fn is_nested(&self, q: &C::State) -> bool {
        let mut placed = Placement::default();
        self.tree.place(q.as_slice(), &mut placed);
        self.pairs.iter().any(|pair| {
            self.mesh(pair.link, &placed).is_some_and(|(mesh, pose)| {
                self.others(pair, &placed).any(|(other, at)| mesh.is_nested(&pose, other, &at))
            })
        })
    }

    /// How both of a pair move.
    fn drifts(&self, pair: &CheckedPair, travels: &Travels, placed: &Placement) -> [Drift; 2] {
        let drift = |link| self.tree.drift(link, pair.meet, travels, placed);
        [drift(pair.link), pair.other.map_or(Drift::STILL, drift)]
    }

    /// Forgets what searches have left for the next ones.
    fn forget(&mut self) {
        self.hints.iter_mut().flatten().for_each(|hint| *hint = Hint::default());
    }

    /// Proves the motion in parts, longer parts first.
    fn prove(&mut self, from: &C::State, to: &C::State) -> MotionCheck {
        self.forget();
        let mut least = f64::INFINITY;
        let mut placed = Placement::default();
        let all: Vec<usize> = (0..self.pairs.len()).collect();
        let mut open = VecDeque::from([(0.0, 1.0, all)]);
        let limit = self.parts + MAX_PARTS;
        while let Some((a, b, pairs)) = open.pop_front() {
            let at = 0.5 * (a + b);
            self.parts += 1;
            if self.parts > limit {
                return MotionCheck::Unproven { at };
            }
            let [qa, qm, qb] = [a, at, b].map(|t| self.space.interpolate(from, to, t));
            let travels = self.travels(&qm, [&qa, &qb]);
            let near = match self.part(&qm, &travels, &pairs, &mut placed, &mut least) {
                PartCheck::Apart => continue,
                PartCheck::Near(near) => near,
                PartCheck::Collision => return MotionCheck::Collision { at },
                PartCheck::Unproven => return MotionCheck::Unproven { at },
            };
            least = least.min(near.clearance);
            let [before, after] = near.free.map(|free| 0.5 * (b - a) * free);
            let parts = [(a, at - before), (at + after, b)].into_iter().zip(near.pairs);
            open.extend(parts.filter(|(_, pairs)| !pairs.is_empty()).map(|((a, b), pairs)| (a, b, pairs)));
        }
        MotionCheck::Free { clearance: least }
    }

    /// Compares `pairs` over a part of a motion, in which coordinates go no farther than `travels` from the configuration `middle`. `least`
    /// becomes the clearance of those that keep apart, if that is less.
    fn part(
        &mut self,
        middle: &C::State,
        travels: &Travels,
        pairs: &[usize],
        placed: &mut Placement,
        least: &mut f64,
    ) -> PartCheck {
        self.tree.place(middle.as_slice(), placed);
        let mut near = Near { pairs: [Vec::new(), Vec::new()], free: [1.0; 2], clearance: f64::INFINITY };
        for &i in pairs {
            let pair = self.pairs[i];
            let [a, b] = &self.drifts(&pair, travels, placed);
            if self.interrupt.ask() {
                return PartCheck::Unproven;
            }
            let kept = self.kept_from(&pair);
            let needed = kept + 2.0 * self.tolerance;
            let shares = if self.tree.links[pair.link].mesh.as_ref().is_some_and(RefMesh::is_balls) {
                let found = self.keeps_apart(i, placed, [a, b], kept + self.tolerance);
                if found.shares == [1.0; 2] {
                    *least = least.min(found.clearance);
                    continue;
                }
                // What is known of the distance in the middle need not be all of it.
                if found.now < needed && self.distance(i, placed, [needed; 2]).is_err() {
                    let is_free = self.distance(i, placed, [kept; 2]).is_ok();
                    return if is_free { PartCheck::Unproven } else { PartCheck::Collision };
                }
                near.clearance = near.clearance.min(found.clearance);
                found.shares
            } else {
                let approach = a.moved + b.moved;
                let enough = approach + kept + self.tolerance;
                // The first distance of two triangles: of meshes a bound takes longer than it saves.
                if let Ok(found) = self.distance(i, placed, [enough, *least + approach]) {
                    *least = least.min(found - approach);
                    continue;
                }
                if self.distance(i, placed, [needed; 2]).is_err() {
                    let is_free = self.distance(i, placed, [kept; 2]).is_ok();
                    return if is_free { PartCheck::Unproven } else { PartCheck::Collision };
                }
                [0.0; 2]
            };
            for (k, share) in shares.into_iter().enumerate() {
                near.free[k] = near.free[k].min(share);
                if share < 1.0 {
                    near.pairs[k].push(i);
                }
            }
        }
        if near.pairs.iter().all(Vec::is_empty) { PartCheck::Apart } else { PartCheck::Near(near) }
    }

    /// Whether any pair touches at `q`, or is nearer than the clearance that it keeps.
    fn touches(&mut self, q: &C::State) -> bool {
        self.forget();
        let mut placed = Placement::default();
        self.tree.place(q.as_slice(), &mut placed);
        (0..self.pairs.len()).any(|i| {
            let kept = self.kept_from(&self.pairs[i]);
            self.distance(i, &placed, [kept; 2]).is_err()
        })
    }
}

impl<C> MotionValidity<C::State> for ArmVerifier<'_, C>
where
    C: Space,
    C::State: Coordinates,
{
    fn check_motion(&mut self, from: &C::State, to: &C::State) -> MotionCheck {
        let count = self.tree.pose + self.tree.coordinates.len();
        let is_turn = |q: &[f64]| (q[3..POSE].iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-8;
        let is_sound = |q: &[f64]| {
            q.len() == count && q.iter().all(|x| x.is_finite()) && (self.tree.pose == 0 || is_turn(q))
        };
        if !(is_sound(from.as_slice()) && is_sound(to.as_slice())) {
            return MotionCheck::Unproven { at: 0.0 };
        }
        let mut travels = from.as_slice().iter().zip(to.as_slice()).map(|(a, b)| (b - a).abs());
        let provable = travels.all(|travel| travel < MAX_TRAVEL);
        if !provable {
            return MotionCheck::Unproven { at: 0.0 };
        }
        if self.apart.as_deref() != Some(from.as_slice()) && self.is_nested(from) {
            return MotionCheck::Collision { at: 0.0 };
        }
        match self.prove(from, to) {
            MotionCheck::Free { clearance } => {
                self.apart = Some(to.as_slice().to_vec());
                MotionCheck::Free { clearance }
            }
            other if self.interrupt.raised().is_some() => other,
            _ if self.touches(from) => MotionCheck::Collision { at: 0.0 },
            _ if self.touches(to) => MotionCheck::Collision { at: 1.0 },
            other => other,
        }
    }
    fn check_curve(&mut self, curve: &dyn Curve) -> Option<MotionCheck> {
        self.curve(curve)
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.interrupt = interrupt.clone();
    }
    fn is_interrupted(&mut self) -> bool {
        self.interrupt.ask()
    }
}
