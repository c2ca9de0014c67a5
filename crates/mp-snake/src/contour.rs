//! The contour of Baizid et al., step 6, from coarse to fine.
//!
//! Few nodes decide together to which side of an obstacle they go; many would be pushed to both. So a contour
//! begins with few and gets more where that does not suffice, as in the multiresolution contours of F.
//! Leymarie and M. Levine, *Tracking deformable objects in the plane using an active contour model*, PAMI
//! 15, 1993. Smooth steps do the same: they lower the same energy, but in another metric of displacements (G.
//! Sundaramoorthi, A. Yezzi and A. Mennucci, *Sobolev active contours*, IJCV 73, 2007).

use crate::bend::{GAIN, PATIENCE, pays};
use crate::snake::Manner;
use crate::{Field, Rest, Snake};
use mp_cspace::{KnownFree, MotionValidity, Space};

/// How one attempt moves a contour: its first spacing and its pace, in those of the parameters, and the
/// smoothness of its steps.
struct Attempt {
    coarse: f64,
    pace: f64,
    smoothing: f64,
}

/// The attempts, one after the other.
const ATTEMPTS: [Attempt; 3] = [
    Attempt { coarse: 4.0, pace: 4.0, smoothing: 1.0 },
    Attempt { coarse: 2.0, pace: 4.0, smoothing: 4.0 },
    Attempt { coarse: 2.0, pace: 1.0, smoothing: 0.0 },
];

/// How often an attempt splits its pieces.
const SPLITS: u32 = 2;

/// A contour need only keep this part of the clearance wanted at its nodes to be taken when it is free; it
/// keeps more where it [relaxes on](keep_away).
const ENOUGH: f64 = 0.2;

/// The spacing of the nodes of a contour that is free, in that of the parameters, and its most steps.
const FINE: f64 = 0.5;
const FINE_STEPS: u32 = 8;

/// Bends a straight `curve` until every piece of it is free. Returns whether it is, and the number of steps.
pub(crate) fn freed<C: Space>(
    snake: &mut Snake<'_, C>,
    curve: &mut Vec<C::State>,
    field: &mut impl Field<C::State>,
    check: &mut impl MotionValidity<C::State>,
) -> (bool, u32) {
    let Some((from, to)) = curve.first().cloned().zip(curve.last().cloned()) else { return (false, 0) };
    let (own, clearance, most) = {
        let params = snake.params();
        (Manner::of(params), params.clearance, params.iterations)
    };
    let (mut all, mut free, mut last) = (0, false, 0);
    'attempts: for (number, attempt) in ATTEMPTS.iter().enumerate() {
        if number > 0 && !pays(snake.further) {
            break;
        }
        last = number;
        let Attempt { coarse, pace, smoothing } = *attempt;
        let mut manner = Manner { spacing: coarse * own.spacing, pace: pace * own.pace, smoothing };
        snake.spread_into(&from, &to, manner.spacing, 2, curve);
        for level in 0..=SPLITS {
            if level > 0 {
                manner.spacing *= 0.5;
                snake.split(curve);
            }
            snake.move_by(manner);
            let (done, steps) = relaxed(snake, curve, field, check, ENOUGH * clearance, most);
            all += steps;
            if done {
                free = true;
                all += keep_away(snake, curve, field, check, manner.spacing);
                break 'attempts;
            }
        }
    }
    if last > 0 {
        snake.further[usize::from(!free)] += 1;
    }
    snake.move_by(own);
    (free, all)
}

/// Lets a free curve, whose nodes are `spacing` (m) apart, relax on with more of them, and keeps what is
/// free. Returns the number of steps.
fn keep_away<C: Space>(
    snake: &mut Snake<'_, C>,
    curve: &mut Vec<C::State>,
    field: &mut impl Field<C::State>,
    check: &mut impl MotionValidity<C::State>,
    spacing: f64,
) -> u32 {
    let (own, clearance) = (Manner::of(snake.params()), snake.params().clearance);
    let most = FINE_STEPS.min(snake.params().iterations);
    let mut manner = Manner { spacing, ..own };
    let mut next = std::mem::take(&mut snake.spare[0]);
    next.clone_from(curve);
    while manner.spacing > FINE * own.spacing {
        manner.spacing *= 0.5;
        snake.split(&mut next);
    }
    snake.move_by(manner);
    let (free, steps) = relaxed(snake, &mut next, field, check, clearance, most);
    if free {
        std::mem::swap(curve, &mut next);
    }
    snake.spare[0] = next;
    steps
}

/// Lets a curve relax for at most `most` steps, until it is free and its nodes have the clearance `wanted`
/// (m), or it comes to rest, or it is hopeless. Returns whether it is free, and the number of steps.
fn relaxed<C: Space>(
    snake: &mut Snake<'_, C>,
    curve: &mut [C::State],
    field: &mut impl Field<C::State>,
    check: &mut impl MotionValidity<C::State>,
    wanted: f64,
    most: u32,
) -> (bool, u32) {
    let gain = GAIN * snake.params().clearance;
    let (mut free, mut clear, mut steps, mut best) = (false, false, 0, (0, f64::NEG_INFINITY));
    // The piece that was blocked last.
    let mut blocked = curve.len() / 2;
    let mut interrupted = false;
    let rest = snake.deform(curve, field, |moment| {
        steps = moment.iteration;
        if moment.clearance > best.1 + gain {
            best = (steps, moment.clearance);
        }
        clear = moment.clearance > 0.0;
        free = steps > 0 && moment.clearance >= wanted && all_free(check, moment.curve, &mut blocked);
        interrupted = check.is_interrupted();
        free || (!clear && steps >= best.0 + PATIENCE) || steps >= most || interrupted
    });
    let at_rest = rest != Rest::Stopped || steps >= most;
    (free || at_rest && clear && !interrupted && all_free(check, curve, &mut blocked), steps)
}

/// Whether every piece is free. Checks first the piece `first`, which becomes the one that is blocked.
fn all_free<S>(check: &mut impl MotionValidity<S>, curve: &[S], first: &mut usize) -> bool {
    let begin = (*first).min(curve.len() - 2);
    let mut free = |i: usize, known| {
        *first = i;
        check.check_extension(&curve[i], &curve[i + 1], known).is_free()
    };
    free(begin, KnownFree::Neither)
        && (begin + 1..curve.len() - 1).all(|i| free(i, KnownFree::From))
        && (0..begin).rev().all(|i| free(i, KnownFree::To))
}
