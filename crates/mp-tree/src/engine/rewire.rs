//! Slot: insertion by the cheapest parent, which turns RRT into RRT*.

use super::{Inserted, Inserter, Selector, Tree};
use mp_cspace::{BuildError, Direction, EdgeChecker, Hit, LocalPlanner, Motion, NodeId, Space};

/// Which nodes of a tree of n nodes, in a space of dimension d, count as near a new one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Near {
    /// The k nearest, k = ⌈factor · e · (1 + 1/d) · ln n⌉; with any factor above 1 the best path converges to
    /// an optimal one (k-nearest RRT*).
    KNearest {
        /// In (0, 1000]; usually 1.1.
        factor: f64,
    },
    /// All within r = min(γ · (ln n / n)^(1/d), step). Convergence needs
    /// γ > 2 · ((1 + 1/d) · μ / ζ)^(1/d), where μ is the volume of the free space and ζ that of the
    /// unit ball.
    Radius {
        /// Above zero, in the unit of the metric.
        gamma: f64,
    },
}

impl Default for Near {
    fn default() -> Self {
        Self::KNearest { factor: 1.1 }
    }
}

impl Near {
    fn find<C: Space, Se: Selector<C>>(
        self,
        (space, step): (&C, f64),
        points: &[C::State],
        selector: &Se,
        q: &C::State,
        out: &mut Vec<Hit>,
    ) {
        let (n, d) = (points.len() as f64 + 1.0, space.dim() as f64);
        match self {
            Self::KNearest { factor } => {
                let k = (factor * std::f64::consts::E * (1.0 + 1.0 / d) * mp_math::ln(n)).ceil();
                selector.k_nearest(space, points, q, k as usize, out);
            }
            Self::Radius { gamma } => {
                let radius = (gamma * mp_math::powf(mp_math::ln(n) / n, 1.0 / d)).min(step);
                selector.near(space, points, q, radius, out);
            }
        }
    }
}

/// Adds the end of a motion under the near node that gives it the least cost from the root; then makes it the
/// parent of every near node that costs less through it (Karaman and Frazzoli 2011).
///
/// Candidate parents are tried in order of a lower bound of the cost: that of the near node plus the
/// distance. The first motion found free is taken, so few are checked. Costs are those of the local planner,
/// which must be able to reach a state exactly, and whose costs should be no less than the distance; where it
/// cannot reach one, this inserts as [`Append`](crate::Append).
#[derive(Clone, Debug, Default)]
pub struct Rewire {
    near: Near,
    hits: Vec<Hit>,
    promises: Vec<(f64, NodeId)>,
    rewired: Vec<NodeId>,
}

impl Rewire {
    /// Rewires the nodes that count as `near`.
    ///
    /// # Errors
    /// When a number in `near` is out of range.
    pub fn new(near: Near) -> Result<Self, BuildError> {
        let (name, value, most) = match near {
            Near::KNearest { factor } => ("near", factor, 1000.0),
            Near::Radius { gamma } => ("gamma", gamma, f64::MAX),
        };
        if value > 0.0 && value <= most {
            return Ok(Self { near, ..Self::default() });
        }
        let range = match near {
            Near::KNearest { .. } => "in (0, 1000]",
            Near::Radius { .. } => "a finite number above zero",
        };
        Err(BuildError::OutOfRange { name, value, range: range.to_owned() })
    }
}

/// The distance in forward time between a state nearer to the root (`upper`) and one farther from it
/// (`lower`).
fn distance<C: Space>(space: &C, direction: Direction, upper: &C::State, lower: &C::State) -> f64 {
    match direction {
        Direction::Forward => space.distance(upper, lower),
        Direction::Backward => space.distance(lower, upper),
    }
}

impl<C: Space, L: LocalPlanner<C::State>> Inserter<C, L> for Rewire {
    fn insert<Se: Selector<C>>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        tree: &mut Tree<C::State, L::Edge>,
        selector: &mut Se,
        from: NodeId,
        motion: Motion<C::State, L::Edge>,
    ) -> Inserted {
        self.rewired.clear();
        if motion.end == *tree.state(from) {
            return Inserted::Known(from);
        }
        let (space, direction) = (checker.space(), tree.direction());
        self.near.find((space, checker.step()), tree.states(), selector, &motion.end, &mut self.hits);
        if let Some(hit) = self.hits.iter().find(|hit| *tree.state(hit.id) == motion.end) {
            return Inserted::Known(hit.id);
        }

        // The user's code runs first, so that a panic leaves the tree unchanged.
        let mut best = (from, motion);
        let mut cost = tree.cost(from) + best.1.cost;
        self.promises.clear();
        for &Hit { id, .. } in &self.hits {
            let promise = tree.cost(id) + distance(space, direction, tree.state(id), &best.1.end);
            if id != from && promise < cost {
                self.promises.push((promise, id));
            }
        }
        self.promises.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for &(promise, id) in &self.promises {
            if promise >= cost {
                break;
            }
            let Some(other) = checker.reach(tree.state(id), &best.1.end, direction) else { continue };
            if tree.cost(id) + other.cost < cost {
                cost = tree.cost(id) + other.cost;
                best = (id, other);
            }
        }
        let (parent, motion) = best;
        let verified = checker.distrusts();
        let mut better = Vec::new();
        for &Hit { id, .. } in &self.hits {
            let promise = cost + distance(space, direction, &motion.end, tree.state(id));
            if id != parent
                && promise < tree.cost(id)
                && let Some(other) = checker.reach(&motion.end, tree.state(id), direction)
            {
                better.push((id, other));
            }
        }

        let new = tree.push(parent, motion);
        if verified {
            tree.set_verified(new);
        }
        for (id, other) in better {
            // A node rewired before may have made this one cheaper already.
            if cost + other.cost < tree.cost(id) && tree.reparent(id, new, other.edge, other.cost) {
                self.rewired.push(id);
                if verified {
                    tree.set_verified(id);
                }
            }
        }
        Inserted::New(new)
    }

    fn rewired(&self) -> &[NodeId] {
        &self.rewired
    }
}
