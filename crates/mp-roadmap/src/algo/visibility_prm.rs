//! Visib-PRM: the visibility roadmap, of guards and connections only.
//!
//! J.-P. Laumond and T. Siméon, *Notes on visibility roadmaps and path planning*, WAFR 2000, and T. Siméon,
//! J.-P. Laumond and C. Nissoux, *Visibility-based probabilistic roadmaps for motion planning*, Advanced
//! Robotics 14, 2000. The pseudo-code is that of §3.3 of A. Benitez, I. Huitzil, D. Vallejo, J. de la
//! Calleja and M. A. Medina, *Key elements for motion planning algorithms*, 2010.
//!
//! q sees g when the local planner has a motion between them. With Guard, Connection empty and ntry = 0,
//! while ntry < M:
//! 1. draw a free sample q, uniform in the space; g_vis is none;
//! 2. for every component G_i of Guard, try its nodes g until one sees q; the first such of all components
//!    is g_vis, in G_vis;
//! 3. when a further component has one, q is a connection: add it to Connection with edges to g and to
//!    g_vis, and merge G_vis and G_i;
//! 4. when none saw q, it is a guard: add it to Guard, and set ntry to 0;
//! 5. otherwise add 1 to ntry, whether q is a connection or of no use.
//!
//! (The paper does not say in which order the nodes of a component are tried: here by distance.) After M
//! samples in a row that are no guards, the guards see an estimated part 1 − 1/M of the free space:
//! [`Visibility::coverage`]. The planner then stops as exhausted.
//!
//! Start and goal must be nodes: each is a guard if no guard sees it; otherwise it gets an edge to a guard
//! of each component that sees it.
//!
//! **When to use it.** For a small roadmap: it has far fewer nodes than that of PRM and an estimate of its
//! coverage. It tries many motions to get there. A narrow passage needs a sample that sees both sides.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `failures`: M, samples in a row that are no guards | 1, 2, … 10⁹ | 1000 |
//!
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Problem, Length, Rn, Rng, StopReason, Straight};
//! use mp_roadmap::{MilestoneKind, VisibilityPrm};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let problem = Problem::new(&space, local, verifier, Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5))?;
//!
//! let mut builder = VisibilityPrm::new(problem, 200)?.into_builder();
//! let reason = builder.build(&mut Rng::seed(1), &mut mp_cspace::Iterations(100_000), &mut ());
//! assert_eq!((reason, builder.connector().coverage()), (StopReason::Exhausted, 1.0 - 1.0 / 200.0));
//! let map = builder.map();
//! let guards = (0..map.len() as u32).filter(|&id| map.tag(id).kind == MilestoneKind::Guard).count();
//! assert!((2..10).contains(&guards) && map.len() < 20);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::settings::UNDIRECTED;
use crate::{
    AStar, Candidate, Connector, Free, Growing, MilestoneKind, Roadmap, RoadmapPlanner, RoadmapPlannerParts,
};
use mp_cspace::{
    BuildError, LocalPlanner, Motion, NearestNeighbors, NodeId, Reversible, Space, Uniform,
    registry::{Parameter, PlannerInfo},
};

const FAILURES: Parameter = Parameter {
    name: "failures",
    range: "a whole number, 1 to 10⁹",
    default: "1000",
    doc: "samples in a row that are no guards, after which it ends (M)",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "visibility-prm",
    summary: "a small roadmap of guards that do not see each other, and connections; estimates its coverage",
    citation: "Laumond and Siméon 2000",
    parameters: &[FAILURES],
    aliases: &["visib-prm"],
    cannot: UNDIRECTED,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let parts = parts(args.space, args.settings.count_of(&FAILURES)?)?;
    args.build(parts)
}

/// Only guards and connections become nodes: the connector of Visib-PRM.
#[derive(Clone, Debug)]
pub struct Visibility {
    /// M.
    most: u64,
    /// ntry.
    failures: u64,
    /// The guards of each component, the components in the order of their first guards.
    components: Vec<Vec<NodeId>>,
    /// How many edges were blocked when the components were computed.
    blocked: Option<usize>,
}

/// A guard that sees a candidate, the number of its component, and the motion from it.
type Seen<S, E> = (usize, NodeId, Motion<S, E>);

impl Visibility {
    /// Ends after `failures` samples in a row that were no guards.
    ///
    /// # Errors
    /// When that is not from 1 to 10⁹.
    pub fn new(failures: u64) -> Result<Self, BuildError> {
        let most = BuildError::count_within(FAILURES.name, failures, 1, 1_000_000_000)?;
        Ok(Self { most, failures: 0, components: Vec::new(), blocked: Some(0) })
    }

    /// An estimate of the part of the free space that the guards see: 1 − 1/ntry, where the last ntry samples
    /// were no guards; 0 before there is such a sample.
    #[must_use]
    pub fn coverage(&self) -> f64 {
        1.0 - 1.0 / self.failures.max(1) as f64
    }

    /// How many samples in a row were no guards.
    #[must_use]
    pub fn failures(&self) -> u64 {
        self.failures
    }

    /// Recomputes the components of guards if edges were blocked.
    fn regroup<S, E>(&mut self, map: &mut Roadmap<S, E>) {
        if self.blocked == Some(map.blocked()) {
            return;
        }
        self.blocked = Some(map.blocked());
        let mut guards: Vec<NodeId> = std::mem::take(&mut self.components).concat();
        guards.sort_unstable();
        let mut names: Vec<NodeId> = Vec::new();
        for guard in guards {
            let name = map.component(guard);
            match names.iter().position(|known| *known == name) {
                Some(component) => self.components[component].push(guard),
                None => {
                    names.push(name);
                    self.components.push(vec![guard]);
                }
            }
        }
    }

    /// For every component the first guard found that sees the candidate.
    fn seen<C, L, N>(
        &mut self,
        q: &C::State,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> Vec<Seen<C::State, L::Edge>>
    where
        C: Space,
        L: LocalPlanner<C::State, Edge: Reversible>,
        N: NearestNeighbors<C>,
    {
        self.regroup(growing.map());
        let mut order: Vec<(f64, NodeId)> = Vec::new();
        let mut seen = Vec::new();
        for (component, guards) in self.components.iter().enumerate() {
            let space = growing.space();
            let map = growing.map();
            order.clear();
            order.extend(guards.iter().map(|&g| (space.distance(map.state(g), q), g)));
            order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let found = order.iter().find_map(|&(_, g)| Some((component, g, growing.reach(g, q)?)));
            seen.extend(found);
        }
        seen
    }

    /// Adds a node with edges to the guards that see it, and merges their components; a guard if none does.
    fn insert<C, L, N>(
        &mut self,
        mut candidate: Candidate<C::State, L::Edge>,
        seen: Vec<Seen<C::State, L::Edge>>,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> NodeId
    where
        C: Space,
        L: LocalPlanner<C::State, Edge: Reversible>,
        N: NearestNeighbors<C>,
    {
        let Some(first) = seen.first().map(|(component, ..)| *component) else {
            candidate.kind = MilestoneKind::Guard;
            let id = growing.add(candidate);
            self.components.push(vec![id]);
            return id;
        };
        let id = growing.add(candidate);
        let mut merged = Vec::new();
        for (component, guard, motion) in seen {
            growing.link(guard, id, motion);
            if component != first {
                merged.push(component);
            }
        }
        for &component in merged.iter().rev() {
            let guards = self.components.remove(component);
            self.components[first].extend(guards);
        }
        id
    }
}

impl<C, L> Connector<C, L> for Visibility
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    fn connect<N: NearestNeighbors<C>>(
        &mut self,
        candidate: Candidate<C::State, L::Edge>,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> Option<NodeId> {
        let seen = self.seen(&candidate.state, growing);
        self.failures = if seen.is_empty() { 0 } else { self.failures + 1 };
        let connection = Candidate { kind: MilestoneKind::Connection, ..candidate };
        (seen.len() != 1).then(|| self.insert(connection, seen, growing))
    }

    fn adopt<N: NearestNeighbors<C>>(
        &mut self,
        candidate: Candidate<C::State, L::Edge>,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> NodeId {
        let seen = self.seen(&candidate.state, growing);
        self.insert(candidate, seen, growing)
    }

    fn resumed(&mut self, map: &Roadmap<C::State, L::Edge>) {
        let guards = (0..map.len() as NodeId).filter(|&id| map.tag(id).kind == MilestoneKind::Guard);
        (self.components, self.blocked, self.failures) = (vec![guards.collect()], None, 0);
    }

    fn exhausted(&self) -> bool {
        self.failures >= self.most
    }
}

/// Visib-PRM: see the [module](self).
pub type VisibilityPrm<'c, C, L, N> = RoadmapPlanner<'c, C, L, Free<Uniform<'c, C>>, Visibility, AStar, N>;

constructors! {
    "Visib-PRM, which ends after `failures` samples in a row that are no guards," VisibilityPrm<C, L, N>,
    |space, failures: u64| parts(space, failures)
}

/// The parts of Visib-PRM.
///
/// # Errors
/// When the number of failures is not from 1 to 10⁹.
pub fn parts<C: Space>(
    space: &C,
    failures: u64,
) -> Result<RoadmapPlannerParts<Free<Uniform<'_, C>>, Visibility, AStar>, BuildError> {
    Ok(RoadmapPlannerParts::new(Free::uniform(space), Visibility::new(failures)?))
}
