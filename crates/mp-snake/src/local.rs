//! The local planner whose edges bend around obstacles.

use crate::snake::NODES;
use crate::{Bulged, Params, Repulsion, Rest, Snake, SnakeError};
use mp_cspace::{
    Direction, Extension, KnownFree, LocalPlanner, Motion, MotionCheck, MotionValidity, PolylineEdge, Reach,
    Space, obstacles::ClearanceGradient,
};

/// Counts of what a [`SnakePlanner`] has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SnakeCounters {
    /// Motions that were free when straight.
    pub straight: u64,
    /// Motions that were bent until they were free.
    pub bent: u64,
    /// Motions that were not bent: their end is not free, they are too long, or too many failed before.
    pub not_tried: u64,
    /// Motions that could not be bent free.
    pub not_bent: u64,
    /// Of these, the motions for which a snake relaxed.
    pub relaxed_in_vain: u64,
    /// Steps of all snakes.
    pub iterations: u64,
}

impl SnakeCounters {
    /// The number of all motions.
    #[must_use]
    pub fn motions(&self) -> u64 {
        self.straight + self.bent + self.not_tried + self.not_bent
    }
}

/// A local planner of straight motions that bends blocked ones around obstacles.
///
/// A motion whose end is not free fails at once. Otherwise a blocked motion is [bulged](Snake::bulge): where a bulge is
/// free it is the edge, with one to five states between the ends. Where the bulge is not free, but its top is clear, a
/// snake relaxes from there for a few steps (not if it begins deep in an obstacle). That costs many times as much and
/// saves few motions: it is done for the first motion without a free bulge, and then only while at most one snake has
/// relaxed in vain per fifty bent motions. Where bending mostly fails it is tried less: at most a third of all motions,
/// and sixteen more, fail after bending was tried.
///
/// A motion ends where the straight one would. Each piece of a bent motion has been found free by `check`; the field only
/// guides. Its cost is its length in the metric of the space. Motions of more than 24 nodes are not bent.
/// [`Path::flattened`](mp_cspace::Path::flattened) turns paths of such edges into straight ones.
#[derive(Clone, Debug)]
pub struct SnakePlanner<'c, C: Space, M, F> {
    /// The motion check: discrete, certified or your own.
    pub check: M,
    /// The field that pushes.
    pub field: Repulsion<F>,
    snake: Snake<'c, C>,
    wanted: f64,
    counters: SnakeCounters,
    /// The motion that is being bent.
    curve: Vec<C::State>,
}

/// A snake is checked as soon as all its nodes are this part of the range away from obstacles, and abandoned when a node
/// is as deep inside an obstacle: few of those become free.
const WANTED: f64 = 0.5;

/// A snake in collision is abandoned when for this many steps its depth does not shrink by this part of the range.
const PATIENCE: u32 = 3;
const GAIN: f64 = 0.05;

/// One snake may relax in vain per this many motions that were bent.
const BENT_PER_VAIN_RELAXATION: u64 = 50;

/// Bending may fail for one motion in this many, and for this many more.
const MOTIONS_PER_FAILURE: u64 = 3;
const FREE_FAILURES: u64 = 16;

/// Motions that take more nodes are not bent.
const LONGEST: f64 = 24.0;

impl<'c, C, M, F> SnakePlanner<'c, C, M, F>
where
    C: Space,
    M: MotionValidity<C::State>,
    F: ClearanceGradient<C::State>,
{
    /// Motions in `space`, checked by `check` and bent by the clearance gradient `field` of obstacles that repel within
    /// `range` (m), with the [parameters](Params::for_edges) for edges of that range.
    ///
    /// # Errors
    /// When the range is not positive and finite, or the space knows no velocities.
    pub fn new(space: &'c C, check: M, field: F, range: f64) -> Result<Self, SnakeError> {
        Self::with_params(space, check, Repulsion::new(field, range)?, Params::for_edges(range)?)
    }

    /// The same with your own parameters.
    ///
    /// # Errors
    /// When one is out of range, or the space knows no velocities.
    pub fn with_params(
        space: &'c C,
        check: M,
        field: Repulsion<F>,
        params: Params,
    ) -> Result<Self, SnakeError> {
        let wanted = WANTED * field.range();
        let snake = Snake::new(space, params)?;
        Ok(Self {
            check,
            field,
            snake,
            wanted,
            counters: SnakeCounters::default(),
            curve: Vec::with_capacity(NODES),
        })
    }

    /// The counts so far.
    #[must_use]
    pub fn counters(&self) -> SnakeCounters {
        self.counters
    }

    /// Bends a motion. Returns whether `curve` is now a free curve in forward time, with its ends, every piece checked.
    fn bend(&mut self, from: &C::State, to: &C::State) -> bool {
        let Self { check, field, snake, wanted, counters, curve } = self;
        snake.between_into(from, to, curve);
        let free = |a: &C::State, b: &C::State, known| match check.check_extension(a, b, known) {
            MotionCheck::Free { .. } => None,
            MotionCheck::Collision { at } | MotionCheck::Unproven { at } => Some(at),
        };
        match snake.bulge(curve, field, *wanted, free) {
            Bulged::Fits => return true,
            Bulged::Nowhere => return false,
            Bulged::Laid => {}
        }
        if counters.relaxed_in_vain > counters.bent / BENT_PER_VAIN_RELAXATION {
            return false;
        }
        let gain = GAIN * field.range();
        let (mut passed, mut iterations, mut best) = (false, 0, (0, f64::NEG_INFINITY));
        let rest = snake.deform(curve, field, |moment| {
            iterations = moment.iteration;
            if moment.clearance < -*wanted {
                return true;
            }
            if moment.clearance > best.1 + gain {
                best = (iterations, moment.clearance);
            }
            passed = moment.clearance >= *wanted && all_free(check, moment.curve);
            passed || (moment.clearance <= 0.0 && iterations >= best.0 + PATIENCE)
        });
        counters.iterations += u64::from(iterations);
        passed = passed || rest != Rest::Stopped && all_free(check, curve);
        counters.relaxed_in_vain += u64::from(!passed);
        passed
    }
}

/// Whether every piece is free. Checks the middle first, where a snake is closest to the obstacle.
fn all_free<S>(check: &mut impl MotionValidity<S>, curve: &[S]) -> bool {
    let middle = curve.len() / 2;
    let mut free = |i: usize, known| check.check_extension(&curve[i], &curve[i + 1], known).is_free();
    free(middle, KnownFree::Neither)
        && (middle + 1..curve.len() - 1).all(|i| free(i, KnownFree::From))
        && (0..middle).rev().all(|i| free(i, KnownFree::To))
}

impl<C, M, F> LocalPlanner<C::State> for SnakePlanner<'_, C, M, F>
where
    C: Space,
    M: MotionValidity<C::State>,
    F: ClearanceGradient<C::State>,
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
        let (end, length, reached) = match reach {
            Reach::Step(step) if step < distance => {
                (space.interpolate(from, toward, step / distance), step, false)
            }
            _ => (toward.clone(), distance, true),
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
        if length <= 0.0
            || long
            || self.counters.not_bent > FREE_FAILURES + self.counters.motions() / MOTIONS_PER_FAILURE
        {
            self.counters.not_tried += 1;
            return Extension::Trapped;
        }
        if !self.bend(a, b) {
            self.counters.not_bent += 1;
            return Extension::Trapped;
        }
        self.counters.bent += 1;
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
