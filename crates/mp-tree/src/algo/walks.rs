//! Random walks that go on as they came, a part of the steps of another extender.
//!
//! Where a passage is long and little wider than the robot, hardly any sample lies in a direction that is free. But the
//! way that the tree has come says where it leads: the nut that has turned a bit on its thread has moved a bit, and goes
//! on by the same screw. Each tree has a walker at one of its nodes, which makes a step in some iterations:
//! 1. mostly straight on, by the velocity (of moving and turning) that has led to its node from one of the
//!    ancestors, drawn so that near and far ones are as likely; what does not lead on averages out over many
//!    edges;
//! 2. otherwise by a normal deviate of the covariance of the last edges, in either direction (S. Carpin and
//!    G. Pillonetto, *Motion planning using adaptive random walks*, IEEE Transactions on Robotics 21(1), 2005);
//! 3. or in the direction of a sample.
//!
//! Lengths are drawn from a step to a thirty-second of it, short ones as likely as long ones, and up to a fifth of
//! that is added in the direction of a sample. After a step that is free the walker is at its end. It begins at a node
//! from which a step of the other extender was blocked, and ends after ten steps in a row that are free, where there is room, or
//! thirty that are blocked.
//!
//! Measured in `docs/results/auto.md`: [two trees of OBRRT](crate::ObrrtConnect), half of whose steps are walkers', take a nut off a
//! thread of six turns in seconds, and a rod out of traps; nothing else here does in a minute.
//!
//! Needs a space with [velocities](Space::moved); in others no walker makes a step.

use crate::{BuildError, Extender, Growing, Grown, Inserter, Parameter, Selector};
use mp_cspace::{Direction, LocalPlanner, NodeId, Rng, Space};
use rand::RngExt;

/// The share of steps that are those of walkers.
pub const WALKS: Parameter = Parameter {
    name: "walks",
    range: "in [0, 1]",
    default: "0",
    doc: "part of the steps that go on as the tree came, for long passages little wider than the robot",
};

/// Most edges back to the ancestor that says where to go on.
const BACK: f64 = 300.0;
/// Edges whose covariance is taken.
const EDGES: usize = 12;
/// The longest and the shortest length differ by this factor.
const SPREAD: f64 = 32.0;
/// The most that is added in the direction of a sample, as a part of the length.
const ASIDE: f64 = 0.2;
/// Free steps in a row, and blocked ones, after which a walker ends.
const FREE: u32 = 10;
const BLOCKED: u32 = 30;

/// Extends as another extender does, but for a share of the steps, which are those of walkers: see the
/// [module](self).
#[derive(Clone, Debug)]
pub struct Walks<G> {
    inner: G,
    share: f64,
    /// Of the forward and of the backward tree.
    walkers: [Option<Walker>; 2],
    /// Room for two velocities.
    velocities: [Vec<f64>; 2],
}

#[derive(Clone, Copy, Debug)]
struct Walker {
    at: NodeId,
    /// How many of its last steps were free, and how many were blocked: one of the two is zero.
    free: u32,
    blocked: u32,
}

/// Where a step goes.
#[derive(Clone, Copy)]
enum Kind {
    /// On from this many edges back.
    On(usize),
    /// By the covariance of the last edges.
    Either,
    /// Toward a sample.
    Any,
}

impl<G> Walks<G> {
    /// Extends as `inner` does, but for this share of the steps.
    ///
    /// # Errors
    /// When the share is not in \[0, 1\].
    pub fn new(inner: G, share: f64) -> Result<Self, BuildError> {
        if !(0.0..=1.0).contains(&share) {
            return Err(BuildError::OutOfRange {
                name: WALKS.name,
                value: share,
                range: WALKS.range.to_owned(),
            });
        }
        Ok(Self { inner, share, walkers: [None, None], velocities: Default::default() })
    }

    /// The next state of a walker at a node, if it is within the space.
    fn next<C, L, Se, A>(
        &mut self,
        at: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Option<C::State>
    where
        C: Space,
        L: LocalPlanner<C::State>,
        Se: Selector<C>,
        A: Inserter<C, L>,
    {
        let (space, step) = (growing.checker().space(), growing.checker().step());
        let [way, velocity] = &mut self.velocities;
        way.clear();
        way.resize(space.dim(), 0.0);
        velocity.resize(space.dim(), 0.0);
        let kind = match growing.rng().random_range(0..5) {
            0 => Kind::Any,
            1 => Kind::Either,
            _ => Kind::On(log_uniform(BACK, growing.rng()) as usize),
        };
        let edges = match kind {
            Kind::On(edges) => edges,
            Kind::Either => EDGES,
            Kind::Any => 0,
        };
        let mut node = at;
        for _ in 0..edges {
            let Some(parent) = growing.tree().parent(node) else { break };
            if !space.velocity_into(growing.tree().state(parent), growing.tree().state(node), velocity) {
                return None;
            }
            let factor = if matches!(kind, Kind::On(_)) { 1.0 } else { normal(growing.rng()) };
            way.iter_mut().zip(&*velocity).for_each(|(w, v)| *w += factor * v);
            node = parent;
        }
        let state = growing.tree().state(at).clone();
        let length = step / log_uniform(SPREAD, growing.rng());
        let leads = scale(space, &state, way, length);
        let sample = space.sample_uniform(growing.rng());
        if !space.velocity_into(&state, &sample, velocity) {
            return None;
        }
        let part = if leads { ASIDE * growing.rng().random::<f64>() } else { 1.0 };
        scale(space, &state, velocity, part * length);
        way.iter_mut().zip(&*velocity).for_each(|(w, v)| *w += v);
        space.moved(&state, way, 1.0).filter(|to| space.contains(to))
    }
}

/// From 1 to `most`, each order of magnitude as likely.
fn log_uniform(most: f64, rng: &mut Rng) -> f64 {
    mp_math::exp(mp_math::ln(most) * rng.random::<f64>())
}

/// About a normal deviate of mean 0 and variance 1.
fn normal(rng: &mut Rng) -> f64 {
    2.0 * ((0..3).map(|_| rng.random::<f64>()).sum::<f64>() - 1.5)
}

/// Scales a velocity so that it leads `length` far in a second; `false` where it leads nowhere.
fn scale<C: Space>(space: &C, from: &C::State, velocity: &mut [f64], length: f64) -> bool {
    let distance = space.moved(from, velocity, 1.0).map_or(0.0, |to| space.distance(from, &to));
    let factor = if distance > 0.0 { length / distance } else { 0.0 };
    velocity.iter_mut().for_each(|v| *v *= factor);
    distance > 0.0
}

fn of(direction: Direction) -> usize {
    usize::from(direction == Direction::Backward)
}

impl<C: Space, L: LocalPlanner<C::State>, G: Extender<C, L>> Extender<C, L> for Walks<G> {
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        if self.share == 0.0 {
            return self.inner.extend(from, growing);
        }
        let tree = of(growing.tree().direction());
        let Some(walker) = self.walkers[tree].filter(|_| growing.rng().random_bool(self.share)) else {
            let grown = self.inner.extend(from, growing);
            if grown == Grown::Trapped {
                self.walkers[tree].get_or_insert(Walker { at: from, free: 0, blocked: 0 });
            }
            return grown;
        };
        let grown = match self.next(walker.at, growing) {
            Some(to) => growing.step_toward(walker.at, &to),
            None => Grown::Trapped,
        };
        let (walker, grown) = match grown {
            Grown::Advanced(at) | Grown::Reached(at) => {
                (Walker { at, free: walker.free + 1, blocked: 0 }, Grown::Advanced(at))
            }
            Grown::Trapped => (Walker { free: 0, blocked: walker.blocked + 1, ..walker }, Grown::Trapped),
        };
        self.walkers[tree] = (walker.free < FREE && walker.blocked < BLOCKED).then_some(walker);
        grown
    }

    fn allows_direct(&self) -> bool {
        self.inner.allows_direct()
    }

    fn pruned(&mut self, direction: Direction, survivors: &[NodeId]) {
        self.walkers[of(direction)] = None;
        self.inner.pruned(direction, survivors);
    }
}
