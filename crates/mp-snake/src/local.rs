//! The local planner whose edges bend around obstacles.

use crate::snake::NODES;
use crate::{Bend, Bending, Bent, Field, Params, Repulsion, Snake, SnakeError};
use mp_cspace::{
    Direction, Extension, KnownFree, LocalPlanner, Motion, MotionValidity, PolylineEdge, Reach, Space,
    obstacles::ClearanceGradient,
};

/// Counts of what a [`SnakePlanner`] has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SnakeCounters {
    /// Motions that were free when straight.
    pub straight: u64,
    /// Motions that a bulge bent, as it was laid.
    pub bulged: u64,
    /// Motions that a bulge bent, and a snake relaxed from there.
    pub relaxed: u64,
    /// Motions that only a snake bent: no bulge was free, or none was laid.
    pub by_snake: u64,
    /// Motions that were not bent: their end is not free, or they are too long.
    pub not_tried: u64,
    /// Motions that could not be bent free.
    pub not_bent: u64,
    /// Steps of all snakes.
    pub iterations: u64,
}

impl SnakeCounters {
    /// The number of motions that were bent until they were free.
    #[must_use]
    pub fn bent(&self) -> u64 {
        self.bulged + self.relaxed + self.by_snake
    }

    /// Motions asked for, however they were answered.
    #[must_use]
    pub fn motions(&self) -> u64 {
        self.straight + self.bent() + self.not_tried + self.not_bent
    }
}

/// A local planner of straight motions that bends blocked ones around obstacles.
///
/// A motion ends where the straight one would. One whose end is not free fails at once. Otherwise, where it
/// is blocked, it is bent by a strategy `B`: [`Bending`] or your own [`Bend`]. Any [`Field`] may push;
/// [`Repulsion`] knows the clearance, so that snakes can stop early and bulges can be laid. Each piece of a
/// bent motion has been found free by `check`; the field only guides. Its cost is its length in the metric of
/// the space. Motions of more than 24 nodes are not bent. [`Path::flattened`](mp_cspace::Path::flattened)
/// turns paths of such edges into straight ones.
#[derive(Clone, Debug)]
pub struct SnakePlanner<'c, C: Space, M, F, B = Bending> {
    /// The motion check: discrete, certified or your own.
    pub check: M,
    /// The field that pushes.
    pub field: F,
    /// How blocked motions are bent.
    pub bend: B,
    snake: Snake<'c, C>,
    counters: SnakeCounters,
    /// The motion that is being bent.
    curve: Vec<C::State>,
}

/// Motions that take more nodes are not bent.
const LONGEST: f64 = 24.0;

impl<'c, C, M, G> SnakePlanner<'c, C, M, Repulsion<G>>
where
    C: Space,
    M: MotionValidity<C::State>,
    G: ClearanceGradient<C::State>,
{
    /// Motions in `space`, checked by `check` and bent by the clearance gradient `gradient` of obstacles that
    /// repel within `range` (m), with the [parameters](Params::for_edges) for edges of that range, in the way
    /// that is the [default](Bending).
    ///
    /// # Errors
    /// When the range is not positive and finite, or the space knows no velocities.
    pub fn new(space: &'c C, check: M, gradient: G, range: f64) -> Result<Self, SnakeError> {
        let (field, params) = (Repulsion::new(gradient, range)?, Params::for_edges(range)?);
        Self::with_bend(space, check, field, params, Bending::default())
    }
}

impl<'c, C, M, F, B> SnakePlanner<'c, C, M, F, B>
where
    C: Space,
    M: MotionValidity<C::State>,
    F: Field<C::State>,
    B: Bend<C>,
{
    /// Motions bent by any field, with your own parameters, in the way `bend`.
    ///
    /// # Errors
    /// When a parameter is out of range, or the space knows no velocities.
    pub fn with_bend(space: &'c C, check: M, field: F, params: Params, bend: B) -> Result<Self, SnakeError> {
        let snake = Snake::new(space, params)?;
        let (counters, curve) = (SnakeCounters::default(), Vec::with_capacity(NODES));
        Ok(Self { check, field, bend, snake, counters, curve })
    }

    /// The counts so far.
    #[must_use]
    pub fn counters(&self) -> SnakeCounters {
        self.counters
    }

    /// Bends a motion in forward time into `curve`.
    fn bend(&mut self, from: &C::State, to: &C::State) -> Bent {
        let Self { check, field, snake, bend, counters, curve } = self;
        snake.between_into(from, to, curve);
        let (bent, steps) = bend.bend(snake, curve, field, check);
        counters.iterations += u64::from(steps);
        bent
    }
}

impl<C, M, F, B> LocalPlanner<C::State> for SnakePlanner<'_, C, M, F, B>
where
    C: Space,
    M: MotionValidity<C::State>,
    F: Field<C::State>,
    B: Bend<C>,
{
    type Edge = PolylineEdge<C::State>;

    fn extend(
        &mut self,
        from: &C::State,
        toward: &C::State,
        direction: Direction,
        reach: Reach,
    ) -> Extension<C::State, PolylineEdge<C::State>> {
        let space = self.snake.space();
        let distance = space.distance(from, toward);
        // A metric need not be symmetric.
        let whole = match direction {
            Direction::Forward => distance,
            Direction::Backward => space.distance(toward, from),
        };
        let (end, length, reached) = match reach {
            Reach::Step(step) if step < distance => {
                (space.interpolate(from, toward, step / distance), step * (whole / distance), false)
            }
            _ => (toward.clone(), whole, true),
        };
        let found = |edge, cost| {
            let motion = Motion { end: end.clone(), edge, cost };
            if reached { Extension::Reached(motion) } else { Extension::Advanced(motion) }
        };
        let (a, b, known) = match direction {
            Direction::Forward => (from, &end, KnownFree::From),
            Direction::Backward => (&end, from, KnownFree::To),
        };
        // The end first: one check, and bending cannot help if it is not free.
        if !self.check.check_motion(&end, &end).is_free() {
            self.counters.not_tried += 1;
            return Extension::Trapped;
        }
        if self.check.check_extension(a, b, known).is_free() {
            self.counters.straight += 1;
            return found(PolylineEdge::straight(), length);
        }
        let long = length > LONGEST * self.snake.params().spacing;
        if length <= 0.0 || long {
            self.counters.not_tried += 1;
            return Extension::Trapped;
        }
        let counter = match self.bend(a, b) {
            Bent::Not => {
                self.counters.not_bent += 1;
                return Extension::Trapped;
            }
            Bent::Bulge => &mut self.counters.bulged,
            Bent::RelaxedBulge => &mut self.counters.relaxed,
            Bent::Snake => &mut self.counters.by_snake,
        };
        *counter += 1;
        let curve = &self.curve;
        let cost = curve.windows(2).map(|w| space.distance(&w[0], &w[1])).sum();
        found(PolylineEdge::through(&curve[1..curve.len() - 1]), cost)
    }

    fn admits(&mut self, q: &C::State) -> bool {
        self.check.check_motion(q, q).is_free()
    }
    fn vertices<'e>(&self, edge: &'e PolylineEdge<C::State>) -> &'e [C::State]
    where
        C::State: 'e,
    {
        edge.vertices()
    }
}
