//! The loop with two trees, grown from the start and from the goal.

use super::tree_pair::TreePair;
use super::{Extender, Grown, Inserter, Purpose, Selector, TargetSampler, Tree, TreePlannerParts};
use mp_cspace::{
    BuildError, Direction, Event, LocalPlanner, NodeId, Observer, PathOf, Planner, Problem, Progress, Rng,
    Space,
};

/// A planner that grows one tree from the start and one from the goal until they meet.
///
/// The first iteration tries a straight motion from the start to each listed goal state, unless one of the
/// extenders [declines](Extender::allows_direct). Each iteration then grows one tree toward a sampled target,
/// and the other toward the node that was added; the trees take turns, unless the larger one is to
/// [wait](crate::Tuning::balance). Where they meet, the path is verified. The goal tree has a root for each
/// listed goal state; where goals come from a sampler, a root is added with probability
/// [`goal_bias`](crate::Tuning::goal_bias) per iteration, and in every iteration until there is one. Stepping
/// on after a solution continues with the same trees.
#[derive(Debug)]
pub struct TwoTrees<'c, C: Space, L: LocalPlanner<C::State>, P, Se, GA, GB, A> {
    pair: TreePair<'c, C, L, Se, A>,
    target_sampler: P,
    explore: GA,
    join: GB,
}

impl<'c, C, L, P, Se, GA, GB, A> TwoTrees<'c, C, L, P, Se, GA, GB, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: TargetSampler<C>,
    Se: Selector<C>,
    GA: Extender<C, L>,
    GB: Extender<C, L>,
    A: Inserter<C, L>,
{
    /// A planner for a problem. `planner` is its name in errors.
    ///
    /// # Errors
    /// When a parameter is out of range, or there is no state to root the goal tree at.
    pub fn assemble(
        planner: &'static str,
        problem: Problem<'c, C, L>,
        parts: TreePlannerParts<P, Se, (GA, GB), A>,
    ) -> Result<Self, BuildError>
    where
        Se: Clone,
        A: Clone,
    {
        Ok(Self {
            pair: TreePair::new(planner, problem, &parts.tuning, (parts.selector, parts.inserter))?,
            target_sampler: parts.target_sampler,
            explore: parts.extender.0,
            join: parts.extender.1,
        })
    }

    /// The trees from the start and from the goal; empty before the first step.
    #[must_use]
    pub fn trees(&self) -> [&Tree<C::State, L::Edge>; 2] {
        [self.pair.trees[0].nodes(), self.pair.trees[1].nodes()]
    }
}

impl<C, L, P, Se, GA, GB, A> Planner<C::State> for TwoTrees<'_, C, L, P, Se, GA, GB, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: TargetSampler<C>,
    Se: Selector<C>,
    GA: Extender<C, L>,
    GB: Extender<C, L>,
    A: Inserter<C, L>,
{
    type Edge = L::Edge;

    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        let Self { pair, target_sampler, explore, join } = self;
        let may_connect = explore.allows_direct() && join.allows_direct();
        if let Some(path) = pair.begin(may_connect, rng, observer, &mut both::<C, L>(explore, join)) {
            return Some(path);
        }
        let turn = pair.next_turn();
        let (checker, [forward, backward]) = (&mut pair.core.checker, &mut pair.trees);
        let (a, b) = if turn == 0 { (forward, backward) } else { (backward, forward) };
        let (points, selector) = a.parts();
        let target = target_sampler.next_target(rng, checker.space(), points, selector);
        observer.on(Event::Sampled(&target));
        let i = a.toward(&target, Purpose::Explore, checker, explore, rng, observer).node()?;
        let joined = b.toward(a.nodes().state(i), Purpose::Join, checker, join, rng, observer);
        let Grown::Reached(j) = joined else { return None };
        let meeting = if turn == 0 { [i, j] } else { [j, i] };
        pair.candidate(meeting, observer, &mut both::<C, L>(explore, join))
    }

    fn progress(&self) -> Progress {
        self.pair.progress()
    }
}

/// Tells both extenders which nodes of a tree remain.
fn both<C: Space, L: LocalPlanner<C::State>>(
    explore: &mut impl Extender<C, L>,
    join: &mut impl Extender<C, L>,
) -> impl FnMut(Direction, &[NodeId]) {
    |direction, survivors| {
        explore.pruned(direction, survivors);
        join.pruned(direction, survivors);
    }
}
