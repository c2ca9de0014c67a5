//! Problems: what to plan, checked before a planner gets it.

mod error;
mod goals;
mod verify;
mod workers;

pub use error::{BuildError, Endpoint};
pub use goals::Goals;
pub use verify::Verify;
pub use workers::Workers;

use crate::erased::{AnyEnergy, AnyGeometry, AnyGradient, AnyObjective, AnySpace, AnyStraight};
use crate::{Interrupt, LocalPlanner, Space, obstacles::ObstacleHints};
use std::fmt;
use std::sync::Arc;

/// A space, the local planner that moves in it, the verifier of finished paths, a start and
/// goals.
pub struct Problem<'c, C: Space, L: LocalPlanner<C::State>> {
    space: &'c C,
    local: L,
    verify: BoxedVerify<'c, C, L>,
    start: C::State,
    goals: Goals<'c, C::State>,
    obstacles: ObstacleKnowledge<'c, C::State>,
    inputs: Option<InputSystem<'c, C::State>>,
    objective: Option<AnyObjective<'c, C::State>>,
    interrupt: Interrupt,
}

/// How an input, applied for a while (s), moves a state, behind a pointer: for planners by name.
pub type AnyFlow<'c, S> = Arc<dyn Fn(&S, &[f64], f64) -> S + Send + Sync + 'c>;

/// How a robot moves by inputs, for planners by name that do so. The local planner of the problem checks the
/// motion from a state to the state that an input leads to.
#[derive(Clone)]
pub struct InputSystem<'c, S> {
    /// How an input moves a state.
    pub flow: AnyFlow<'c, S>,
    /// The inputs. The first number is that of directions, 0 for the robot's own choice; the second that of
    /// magnitudes.
    pub inputs: Arc<dyn Fn(usize, u32) -> Vec<Vec<f64>> + Send + Sync + 'c>,
    /// How long an input is held, seconds.
    pub duration: f64,
}

impl<S> fmt::Debug for InputSystem<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("InputSystem").field("duration", &self.duration).finish_non_exhaustive()
    }
}

/// A problem of an erased space, with straight edges.
pub type AnyProblem<'c, S> = Problem<'c, AnySpace<'c, S>, AnyStraight<'c, S>>;

/// What planners by name may query about obstacles, beside whether a motion is free. Each field is optional;
/// a planner that needs a missing one returns an error.
pub struct ObstacleKnowledge<'c, S> {
    /// States along obstacles: for planners that grow along them.
    pub hints: Option<BoxedHints<'c, S>>,
    /// The clearance and its gradient: for edges bent by snakes, and for costs of being near obstacles.
    pub gradient: Option<AnyGradient<'c, S>>,
    /// The geometry of obstacles: for planners that place the robot at them.
    pub geometry: Option<AnyGeometry<'c, S>>,
    /// A field of choice, for edges bent by snakes: it pushes in place of the clearance, or beside it.
    pub field: Option<PushingField<'c, S>>,
}

/// An energy of states, which edges bent by snakes lower.
pub struct PushingField<'c, S> {
    /// The energy (no unit) at a state, and its gradient. Both finite.
    pub energy: AnyEnergy<'c, S>,
    /// Whether it pushes alone, without the repulsion of obstacles.
    pub alone: bool,
}

impl<S> fmt::Debug for PushingField<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PushingField").field("alone", &self.alone).finish_non_exhaustive()
    }
}

/// Nothing is known.
impl<S> Default for ObstacleKnowledge<'_, S> {
    fn default() -> Self {
        Self { hints: None, gradient: None, geometry: None, field: None }
    }
}

impl<S> fmt::Debug for ObstacleKnowledge<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ObstacleKnowledge")
            .field("hints", &self.hints.is_some())
            .field("gradient", &self.gradient.is_some())
            .field("geometry", &self.geometry)
            .field("field", &self.field)
            .finish()
    }
}

/// Obstacle hints behind a pointer.
pub type BoxedHints<'c, S> = Box<dyn ObstacleHints<S> + Send + 'c>;

/// The verifier of a local planner's paths, behind a pointer.
pub type BoxedVerify<'c, C, L> =
    Box<dyn Verify<<C as Space>::State, <L as LocalPlanner<<C as Space>::State>>::Edge> + Send + 'c>;

/// What a [`Problem`] consists of, for planners: [`Problem::into_parts`].
#[allow(missing_debug_implementations)] // verifiers need not implement `Debug`
pub struct ProblemParts<'c, C: Space, L: LocalPlanner<C::State>> {
    /// Where configurations live, and how far apart they are.
    pub space: &'c C,
    /// How to move in it.
    pub local: L,
    /// The independent check of paths.
    pub verify: BoxedVerify<'c, C, L>,
    /// Where paths begin.
    pub start: C::State,
    /// Where they end.
    pub goals: Goals<'c, C::State>,
    /// What the planner asks whether to end within an iteration.
    pub interrupt: Interrupt,
}

impl<'c, C: Space, L: LocalPlanner<C::State>> Problem<'c, C, L> {
    /// A problem whose start and listed goals are in the space, free by the verifier, and
    /// admitted by the local planner. Goal states that are not are left out as long as another
    /// goal remains.
    ///
    /// `verifier` should share no code with the check inside `local`: a path that it does not find free
    /// is not returned. Pass `&mut` values to read their counters afterwards.
    ///
    /// # Errors
    /// When the start, or every goal given, is outside the space, not free or refused; when the
    /// distance between them is not finite; when there is no goal at all.
    pub fn new(
        space: &'c C,
        local: L,
        verifier: impl Verify<C::State, L::Edge> + Send + 'c,
        start: C::State,
        goal: impl Into<Goals<'c, C::State>>,
    ) -> Result<Self, BuildError> {
        Self::checked(space, local, Box::new(verifier), start, goal.into())
    }

    /// As [`new`](Self::new): compiled once for all verifiers.
    fn checked(
        space: &'c C,
        mut local: L,
        mut verify: BoxedVerify<'c, C, L>,
        start: C::State,
        mut goals: Goals<'c, C::State>,
    ) -> Result<Self, BuildError> {
        if goals.is_empty() {
            return Err(BuildError::NoGoal);
        }
        let mut check = |endpoint, q: &C::State| {
            let state = || format!("{q:?}");
            if !space.contains(q) {
                return Err(BuildError::Outside { endpoint, state: state() });
            }
            let check = verify.verify_state(q);
            if !check.is_free() {
                return Err(BuildError::NotFree { endpoint, state: state(), check });
            }
            if !local.admits(q) {
                return Err(BuildError::Refused { endpoint, state: state() });
            }
            Ok(())
        };
        check(Endpoint::Start, &start)?;
        let (mut bad, mut number) = (None, 0);
        goals.listed_mut().retain(|q| {
            let distance = space.distance(&start, q);
            let verdict = check(Endpoint::Goal(number), q).and(match distance.is_finite() {
                true => Ok(()),
                false => Err(BuildError::Distance { distance }),
            });
            let keep = verdict.is_ok();
            bad = bad.take().or(verdict.err());
            number += 1;
            keep
        });
        match bad {
            Some(error) if goals.is_empty() => Err(error),
            _ => Ok(Self {
                space,
                local,
                verify,
                start,
                goals,
                obstacles: ObstacleKnowledge::default(),
                inputs: None,
                objective: None,
                interrupt: Interrupt::never(),
            }),
        }
    }
}

impl<'c, C: Space, L: LocalPlanner<C::State>> Problem<'c, C, L> {
    /// The space in which start, goals and paths are.
    #[must_use]
    pub fn space(&self) -> &'c C {
        self.space
    }

    /// What proposes and checks motions between two states.
    #[must_use]
    pub fn local(&self) -> &L {
        &self.local
    }

    /// The local planner, to set it up.
    pub fn local_mut(&mut self) -> &mut L {
        &mut self.local
    }

    /// Where paths begin.
    #[must_use]
    pub fn start(&self) -> &C::State {
        &self.start
    }

    /// Where they end.
    #[must_use]
    pub fn goals(&self) -> &Goals<'c, C::State> {
        &self.goals
    }

    /// The parts of the problem, for planners; drops the obstacle knowledge.
    #[must_use]
    pub fn into_parts(self) -> ProblemParts<'c, C, L> {
        let Self { space, local, verify, start, goals, interrupt, .. } = self;
        ProblemParts { space, local, verify, start, goals, interrupt }
    }

    /// The same problem with this obstacle knowledge, for planners by name that need it.
    #[must_use]
    pub fn with_obstacles(self, obstacles: ObstacleKnowledge<'c, C::State>) -> Self {
        Self { obstacles, ..self }
    }

    /// The same problem for a robot that moves by inputs, for planners by name.
    #[must_use]
    pub fn with_inputs(self, inputs: InputSystem<'c, C::State>) -> Self {
        Self { inputs: Some(inputs), ..self }
    }

    /// The same problem, for planners that look for the path that costs least by this objective. Others leave
    /// it aside.
    #[must_use]
    pub fn with_objective(self, objective: AnyObjective<'c, C::State>) -> Self {
        Self { objective: Some(objective), ..self }
    }

    /// The same problem, whose planner asks `interrupt` whether to end also within an iteration.
    ///
    /// A planner that was interrupted has done part of an iteration. So the iteration counts for nothing, and
    /// the planner is of no further use: a path found before is what there is.
    /// [`Planner::solve`](crate::Planner::solve) keeps to this when its stop contains a clone of `interrupt`.
    #[must_use]
    pub fn with_interrupt(self, interrupt: Interrupt) -> Self {
        Self { interrupt, ..self }
    }

    /// What the planner asks whether to end within an iteration; by default it never does.
    #[must_use]
    pub fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// How the robot moves by inputs, if it can move in no other way.
    #[must_use]
    pub fn inputs(&self) -> Option<&InputSystem<'c, C::State>> {
        self.inputs.as_ref()
    }

    /// Takes the obstacle knowledge out of the problem.
    pub fn take_obstacles(&mut self) -> ObstacleKnowledge<'c, C::State> {
        std::mem::take(&mut self.obstacles)
    }

    /// Takes the objective out of the problem; `None` for the length.
    pub fn take_objective(&mut self) -> Option<AnyObjective<'c, C::State>> {
        self.objective.take()
    }

    /// The same problem with a local planner made from its present one, for instance a wrapper of it.
    /// Start and goals are not checked again.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn try_map_local<M: LocalPlanner<C::State, Edge = L::Edge>, E>(
        self,
        make: impl FnOnce(L) -> Result<M, E>,
    ) -> Result<Problem<'c, C, M>, E> {
        let Self { space, local, verify, start, goals, obstacles, inputs, objective, interrupt } = self;
        let local = make(local)?;
        Ok(Problem { space, local, verify, start, goals, obstacles, inputs, objective, interrupt })
    }
}

impl<C: Space, L: LocalPlanner<C::State>> fmt::Debug for Problem<'_, C, L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Problem")
            .field("start", &self.start)
            .field("goals", &self.goals)
            .finish_non_exhaustive()
    }
}
