//! Relaxation of whole paths.

use crate::{Field, Params, Snake, SnakeError};
use mp_cspace::{MotionValidity, Path, Space};

/// The result of relaxing a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxed<S> {
    /// The relaxed path, or the original one when nothing better was found.
    pub path: Path<S>,
    /// The length of this path and of the original, in the metric of the space.
    pub length: [f64; 2],
    /// The energy of both as snakes.
    pub energy: [f64; 2],
    /// Steps of the snake.
    pub iterations: u32,
}

impl<S> Relaxed<S> {
    /// Whether the path is better than the original.
    #[must_use]
    pub fn is_better(&self) -> bool {
        self.energy[0] < self.energy[1]
    }
}

/// Lays a snake along a whole path and lets it relax: away from obstacles, and straighter (Fig. 2 d of the
/// paper).
///
/// The result has the same ends, and is either the path itself, or a path such that
/// - every piece of it has been found free by `check`, and
/// - it has less energy than the original: it is safer, smoother or shorter, and
/// - its length is at most that of the original times `stretch` (at least 1): with 1 it never gets longer.
///
/// After each step of the snake, the ends of every piece that is not free move back to where they were. So
/// the curve is always free, and only nodes in tight places stay behind. A step that gains nothing is tried
/// again at a quarter of the pace, since a field that changes over short distances needs short steps; the
/// pace grows again while steps succeed. It ends when a step at a thousandth of the pace gains nothing. A
/// path that needs more than ten thousand nodes is returned unchanged. Use a `check` you trust, as nothing
/// else is checked. Each step costs one check per piece that moved, and three evaluations of the field per
/// node. When `check` is [interrupted](MotionValidity::interrupt_by), the path of the last whole step is
/// returned.
///
/// # Errors
/// When a parameter is out of range, or the space knows no velocities.
pub fn relax<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    field: &mut impl Field<C::State>,
    path: &Path<C::State>,
    params: Params,
    stretch: f64,
) -> Result<Relaxed<C::State>, SnakeError> {
    crate::params::within("the stretch", stretch, 1.0, f64::MAX, "at least 1 and finite")?;
    let mut snake = Snake::new(space, Params { iterations: 1, ..params })?;
    params.checked()?;
    let before = path.length(space);
    let mut best = Relaxed { path: path.clone(), length: [before; 2], energy: [0.0; 2], iterations: 0 };
    if before > 1e4 * params.spacing {
        return Ok(best);
    }
    let mut curve = path.resampled(space, params.spacing)?.states;
    let first = snake.energy(&curve, field).total();
    best.energy = [first; 2];
    if !curve.windows(2).all(|w| check.check_motion(&w[0], &w[1]).is_free()) {
        return Ok(best);
    }
    let mut energy = first;
    let mut next = curve.clone();
    let (mut pace, mut successes) = (params.pace, 0);
    for iterations in 1..=params.iterations {
        next.clone_from(&curve);
        snake.deform(&mut next, field, |_| false);
        go_back_where_blocked(check, &curve, &mut next);
        let gained = energy - snake.energy(&next, field).total();
        if check.is_interrupted() {
            break;
        }
        // A shorter step gains less.
        if gained.is_nan() || gained <= LEAST_GAIN * energy * (pace / params.pace) {
            if pace <= LEAST_PACE * params.pace {
                break;
            }
            (pace, successes) = (0.25 * pace, 0);
            snake.set_pace(pace);
            continue;
        }
        successes += 1;
        if successes >= SUCCESSES && pace < params.pace {
            (pace, successes) = (2.0 * pace, 0);
            snake.set_pace(pace);
        }
        energy -= gained;
        std::mem::swap(&mut curve, &mut next);
        let length: f64 = curve.windows(2).map(|w| space.distance(&w[0], &w[1])).sum();
        if energy < best.energy[0] && length <= stretch * before {
            let path = Path::straight(curve.clone());
            best = Relaxed { path, length: [length, before], energy: [energy, first], iterations };
        }
    }
    relaxed(curve.len(), best.iterations, best.energy);
    Ok(best)
}

/// Logs the end. Not generic, so that it is compiled once.
fn relaxed(nodes: usize, iterations: u32, energy: [f64; 2]) {
    tracing::debug!(nodes, iterations, from = energy[1], to = energy[0], "relaxed");
}

/// A step that lowers the energy by less than this part of it gains nothing.
const LEAST_GAIN: f64 = 1e-6;
/// The shortest pace that is tried, as a part of the one that was given.
const LEAST_PACE: f64 = 1e-3;
/// After this number of successful steps in a row the pace is doubled, up to the one that was given.
const SUCCESSES: u32 = 4;

/// Moves the ends of each piece of `next` that is not free back to where they were in `curve`, until all
/// pieces are free, as those of `curve` are.
fn go_back_where_blocked<S: Clone + PartialEq>(
    check: &mut impl MotionValidity<S>,
    curve: &[S],
    next: &mut [S],
) {
    let mut i = 0;
    while i + 1 < next.len() {
        let as_before = (i..=i + 1).all(|k| next[k] == curve[k]);
        if as_before || check.check_motion(&next[i], &next[i + 1]).is_free() {
            i += 1;
            continue;
        }
        next[i..=i + 1].clone_from_slice(&curve[i..=i + 1]);
        // The piece before has another end now.
        i = i.saturating_sub(1);
    }
}
