//! A request made ready for a robot: the space, an index, a verifier, and problems made of them.

use crate::counted::{Counted, QueryBudget};
use crate::{Error, Length, Measured, MotionValidator, Request, RobotKind};
use mp_cspace::erased::{AnyCheck, AnyIndex, AnySpace};
use mp_cspace::{
    AnyProblem, BuildError, Cancel, Certified, Deadline, Discrete, Goals, Iterations, Nodes, ParameterError,
    Problem, Resolution, Stop, Straight,
};
use std::sync::atomic::AtomicU64;
use std::time::{Duration, Instant};

/// What problems of one request are made of.
pub(crate) struct Prepared<'k, K: RobotKind> {
    kind: &'k K,
    motion: MotionValidator,
    /// The space under the metric of the request.
    pub(crate) space: AnySpace<'k, K::State>,
    /// An empty index of it.
    pub(crate) index: AnyIndex<K::State>,
    verifier: K::Verifier<'k>,
    /// The queries that checkers were asked, all together.
    pub(crate) queries: AtomicU64,
}

impl<'k, K: RobotKind> Prepared<'k, K> {
    pub(crate) fn new(kind: &'k K, request: &Request) -> Result<Self, Error> {
        let Measured { space, index } = kind.measured(request.metric)?;
        let (verifier, queries) = (kind.verifier()?, AtomicU64::new(0));
        Ok(Self { kind, motion: request.motion, space, index, verifier, queries })
    }

    /// The problem of the scene: as often as there are threads.
    pub(crate) fn problem(&self) -> Result<AnyProblem<'_, K::State>, BuildError> {
        let kind = self.kind;
        let counted = || Counted::new(kind.checker().clone(), &self.queries);
        let check: AnyCheck<'_, K::State> = match self.motion {
            MotionValidator::Certified => {
                Box::new(unmade(Certified::new(kind.space(), counted(), kind.tolerance()))?)
            }
            MotionValidator::Discrete(length) => {
                Box::new(unmade(Discrete::new(&self.space, counted(), resolution(length)))?)
            }
        };
        let goals = Goals::states(kind.goals().iter().cloned());
        let local = Straight::new(&self.space, check);
        let verifier: AnyCheck<'_, K::State> = Box::new(self.verifier.clone());
        let problem = Problem::new(&self.space, local, verifier, kind.start().clone(), goals)?;
        Ok(problem.with_obstacles(kind.obstacles(&counted)))
    }

    /// When a run that began at `began` stops: by `cancel`, or by the budget of the request.
    pub(crate) fn stop(&self, request: &Request, began: Instant, cancel: Cancel) -> impl Stop {
        let budget = request.budget;
        let deadline = budget.time_s.and_then(|s| Duration::try_from_secs_f64(s).ok());
        cancel
            .or(budget.iterations.map(Iterations))
            .or(budget.nodes.map(Nodes))
            .or(deadline.and_then(|time| began.checked_add(time)).map(Deadline::at))
            .or(budget.queries.map(|most| QueryBudget { queries: &self.queries, most }))
    }
}

fn unmade<T>(made: Result<T, ParameterError>) -> Result<T, BuildError> {
    made.map_err(|e| BuildError::Unmade { reason: e.to_string() })
}

fn resolution(length: Length) -> Resolution {
    match length {
        Length::Absolute(v) => Resolution::Length(v),
        Length::Fraction(f) => Resolution::Fraction(f),
    }
}
