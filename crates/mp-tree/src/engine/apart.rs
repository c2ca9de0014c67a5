//! Slot: motions that only join the tree where nothing is yet.

use super::{Inserted, Inserter, Selector, Tree};
use mp_cspace::{BuildError, EdgeChecker, Hit, LocalPlanner, Motion, NodeId, Space};

/// Under the node it came from, unless another node of the tree is there already: up to rounding, or
/// within a radius.
///
/// For motions by finitely many inputs: one way and back again, or the same two in another order,
/// leads to the same state but for rounding, and *similar* states must not be stacked on each other
/// (Jouandeau, Touati and Ali Cherif 2008, §2.3). Asks the index once per motion.
#[derive(Clone, Debug, Default)]
pub struct AppendApart {
    radius: Option<f64>,
    near: Vec<Hit>,
}

impl AppendApart {
    /// Takes states no farther apart than `radius`, in the metric of the space, for the same.
    ///
    /// # Errors
    /// When it is negative or not finite.
    pub fn within(radius: f64) -> Result<Self, BuildError> {
        if radius >= 0.0 && radius.is_finite() {
            return Ok(Self { radius: Some(radius), near: Vec::new() });
        }
        let range = "not negative and finite, a distance".to_owned();
        Err(BuildError::OutOfRange { name: "apart", value: radius, range })
    }
}

/// States this part of the extent of the space apart, or less, are similar.
const SIMILAR: f64 = 1e-9;

impl<C: Space, L: LocalPlanner<C::State>> Inserter<C, L> for AppendApart {
    fn attach<Se: Selector<C>>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        tree: &mut Tree<C::State, L::Edge>,
        select: &mut Se,
        from: NodeId,
        motion: Motion<C::State, L::Edge>,
    ) -> Inserted {
        let radius = self.radius.unwrap_or(SIMILAR * checker.space().extent());
        select.near(checker.space(), tree.states(), &motion.end, radius, &mut self.near);
        let same = |hit: &&Hit| *tree.state(hit.id) == motion.end;
        // A motion to a state similar to where it began is as short as it is meant to be.
        let similar = |hit: &&Hit| hit.id != from;
        match self.near.iter().find(same).or_else(|| self.near.iter().find(similar)) {
            Some(hit) => Inserted::Known(hit.id),
            None => Inserted::New(tree.push(from, motion)),
        }
    }
}
