//! How a blocked motion is bent: the strategies of [`SnakePlanner`](crate::SnakePlanner).

use crate::{Bulged, Field, Rest, Snake, contour};
use mp_cspace::{KnownFree, MotionValidity, Space};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// What made a motion free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bent {
    /// Nothing: the curve is not free.
    Not,
    /// A bulge, as it was laid.
    Bulge,
    /// A snake that began on a free bulge, and now keeps farther away from obstacles.
    RelaxedBulge,
    /// A snake; no bulge was free, or none was laid.
    Snake,
}

/// A strategy to bend blocked motions. [`Bending`] has those of this crate; implement it for your own.
pub trait Bend<C: Space> {
    /// Bends `curve` until every piece of it has been found free by `check`. Returns what made it free, and
    /// the number of steps that snakes took.
    ///
    /// At first the curve is a straight motion in forward time, with nodes as [`Snake::between`] lays them;
    /// its ends are free and stay. It may get more or fewer nodes between them. The field only guides.
    fn bend(
        &mut self,
        snake: &mut Snake<'_, C>,
        curve: &mut Vec<C::State>,
        field: &mut impl Field<C::State>,
        check: &mut impl MotionValidity<C::State>,
    ) -> (Bent, u32);
}

/// How a blocked motion is bent around obstacles.
///
/// A snake in collision stops early when for 6 steps it has not come nearer to freedom. It is done as soon as
/// it is free and its nodes have the [clearance](crate::Params::clearance) wanted; if it comes to rest
/// before, it only has to be free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Bending {
    /// The active contour of Baizid et al., step 6: it starts on the straight motion and relaxes in the
    /// field, from few nodes to many. As soon as it is free it relaxes once more, with nodes half the spacing
    /// apart, to keep the clearance wanted.
    ///
    /// Where it stays blocked, two further attempts start on the straight motion, while at most 8 motions
    /// that they do not free come to each that they free, and 32 more. All lower the same energy, in steps of
    /// other lengths and smoothness.
    #[default]
    Snake,
    /// Ours, not the paper's: all of the motion moves to one side at once ([`Snake::bulge`]). Nothing
    /// relaxes. It is the fastest way to bend one motion, and keeps the least clearance.
    Bulge,
    /// Ours, not the paper's: a [bulge](Snake::bulge) is the initial contour, and relaxes. Where that does
    /// not become free, the bulge is taken as it was laid, if it is free; otherwise a snake starts on the
    /// straight motion.
    ///
    /// Where no bulge is free, snakes must pay: they are tried while at most 8 of them fail for each one that
    /// becomes free, and 32 more. In a maze of long walls they never do.
    Hybrid,
}

/// Snakes that may fail where no bulge is free: for each one that becomes free, and besides.
const FAILURES_PER_SUCCESS: u64 = 8;
const FREE_FAILURES: u64 = 32;

/// Whether what became free so often, and did not so often, is tried again.
pub(crate) fn pays([freed, failed]: [u64; 2]) -> bool {
    failed <= FREE_FAILURES + FAILURES_PER_SUCCESS * freed
}

/// A snake in collision is abandoned when for this many steps its depth has not shrunk by this part of the
/// clearance wanted.
pub(crate) const PATIENCE: u32 = 6;
pub(crate) const GAIN: f64 = 0.1;

impl Bending {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Snake, Self::Bulge, Self::Hybrid];

    /// Its name: `snake`, `bulge` or `hybrid`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Snake => "snake",
            Self::Bulge => "bulge",
            Self::Hybrid => "hybrid",
        }
    }
}

impl fmt::Display for Bending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is not the name of a [`Bending`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{name}` is no way to bend a motion: expected snake, bulge or hybrid")]
pub struct UnknownBending {
    /// The name that was asked for.
    pub name: String,
}

impl FromStr for Bending {
    type Err = UnknownBending;

    fn from_str(name: &str) -> Result<Self, UnknownBending> {
        let known = Self::ALL.into_iter().find(|bending| bending.name() == name);
        known.ok_or_else(|| UnknownBending { name: name.into() })
    }
}

impl<C: Space> Bend<C> for Bending {
    fn bend(
        &mut self,
        snake: &mut Snake<'_, C>,
        curve: &mut Vec<C::State>,
        field: &mut impl Field<C::State>,
        check: &mut impl MotionValidity<C::State>,
    ) -> (Bent, u32) {
        match self {
            Self::Snake => named(contour::freed(snake, curve, field, check)),
            Self::Bulge => match bulged(snake, curve, field, check) {
                Bulged::Fits => (Bent::Bulge, 0),
                Bulged::Laid | Bulged::Nowhere => (Bent::Not, 0),
            },
            Self::Hybrid => {
                let [mut laid, mut contour] = std::mem::take(&mut snake.spare);
                laid.clone_from(curve);
                let bent = match bulged(snake, &mut laid, field, check) {
                    Bulged::Fits => {
                        snake.resample(&laid, &mut contour);
                        let (free, steps) = relaxed(snake, &mut contour, field, check);
                        std::mem::swap(curve, if free { &mut contour } else { &mut laid });
                        (if free { Bent::RelaxedBulge } else { Bent::Bulge }, steps)
                    }
                    bulged => {
                        let laid = (bulged == Bulged::Laid).then_some(&mut laid);
                        named(without_bulge(snake, curve, laid, field, check))
                    }
                };
                snake.spare = [laid, contour];
                bent
            }
        }
    }
}

fn named((free, steps): (bool, u32)) -> (Bent, u32) {
    (if free { Bent::Snake } else { Bent::Not }, steps)
}

/// Where no bulge is free: relaxes the bulge that was laid, if there is one, and then the straight curve.
fn without_bulge<C: Space>(
    snake: &mut Snake<'_, C>,
    curve: &mut Vec<C::State>,
    laid: Option<&mut Vec<C::State>>,
    field: &mut impl Field<C::State>,
    check: &mut impl MotionValidity<C::State>,
) -> (bool, u32) {
    if !pays(snake.without_bulge) {
        return (false, 0);
    }
    let (mut free, mut steps) = (false, 0);
    if let Some(laid) = laid {
        (free, steps) = relaxed(snake, laid, field, check);
        if free {
            std::mem::swap(curve, laid);
        }
    }
    if !free {
        let (straight, more) = relaxed(snake, curve, field, check);
        (free, steps) = (straight, steps + more);
    }
    snake.without_bulge[usize::from(!free)] += 1;
    (free, steps)
}

fn bulged<C: Space>(
    snake: &mut Snake<'_, C>,
    curve: &mut Vec<C::State>,
    field: &mut impl Field<C::State>,
    check: &mut impl MotionValidity<C::State>,
) -> Bulged {
    let wanted = snake.params().clearance;
    snake.bulge(curve, field, wanted, |a, b, known| check.check_extension(a, b, known).failed_at())
}

/// Lets a curve relax until it is free with the clearance wanted, or comes to rest. Returns whether it is
/// free, and the number of steps.
fn relaxed<C: Space>(
    snake: &mut Snake<'_, C>,
    curve: &mut [C::State],
    field: &mut impl Field<C::State>,
    check: &mut impl MotionValidity<C::State>,
) -> (bool, u32) {
    let wanted = snake.params().clearance;
    let (mut free, mut steps, mut best) = (false, 0, (0, f64::NEG_INFINITY));
    let rest = snake.deform(curve, field, |moment| {
        steps = moment.iteration;
        if moment.clearance > best.1 + GAIN * wanted {
            best = (steps, moment.clearance);
        }
        free = steps > 0 && moment.clearance >= wanted && all_free(check, moment.curve);
        free || (moment.clearance <= 0.0 && steps >= best.0 + PATIENCE) || check.is_interrupted()
    });
    (free || rest != Rest::Stopped && all_free(check, curve), steps)
}

/// Whether every piece is free. Checks the middle first, where a snake is closest to the obstacle.
fn all_free<S>(check: &mut impl MotionValidity<S>, curve: &[S]) -> bool {
    let middle = curve.len() / 2;
    let mut free = |i: usize, known| check.check_extension(&curve[i], &curve[i + 1], known).is_free();
    free(middle, KnownFree::Neither)
        && (middle + 1..curve.len() - 1).all(|i| free(i, KnownFree::From))
        && (0..middle).rev().all(|i| free(i, KnownFree::To))
}
