//! Whole paths relaxed.

use crate::{Energy, Params, Repulsion, Rest, Snake, SnakeError};
use mp_cspace::{ClearanceGradient, MotionValidity, Path, Space};

/// A path that was relaxed.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxed<S> {
    /// The path; as it was when nothing better was found.
    pub path: Path<S>,
    /// Its length and that of the path it was made of, in the metric of the space.
    pub length: [f64; 2],
    /// The energy of both, of the snake.
    pub energy: [f64; 2],
    /// Steps of the snake.
    pub iterations: u32,
}

impl<S> Relaxed<S> {
    /// Whether it is another path.
    #[must_use]
    pub fn is_better(&self) -> bool {
        self.energy[0] < self.energy[1]
    }
}

/// Lays a snake along a whole path and lets it relax: away from obstacles, and straighter (Fig. 2 d of the
/// paper).
///
/// What comes back has the same ends, and either is the path itself or
/// - every piece of it has been found free by `check`, and
/// - it has less energy than the path, which says that it is safer, smoother or shorter, and
/// - it is no longer than the path times `stretch` (at least 1): at 1 safety is only taken where it costs no length.
///
/// The snake is looked at after 1, 2, 4, … steps and at the end; the last curve that meets all this is taken, and at
/// the first in collision the snake is stopped. A path that takes more than ten thousand nodes stays as it is. Give a
/// `check` you trust: nothing else is asked.
///
/// # Errors
/// When a parameter is out of range, or the space knows no velocities.
pub fn relax<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    field: &mut Repulsion<impl ClearanceGradient<C::State>>,
    path: &Path<C::State>,
    params: Params,
    stretch: f64,
) -> Result<Relaxed<C::State>, SnakeError> {
    crate::error::within("the stretch", stretch, 1.0, f64::MAX, "at least 1 and finite")?;
    let mut snake = Snake::new(space, params)?;
    let before = path.length(space);
    let as_it_was = Relaxed { path: path.clone(), length: [before; 2], energy: [0.0; 2], iterations: 0 };
    if before > 1e4 * params.spacing {
        return Ok(as_it_was);
    }
    let mut curve = path.resampled(space, params.spacing)?.states;
    let first = snake.energy(&curve, field).total();
    let mut best = Relaxed { energy: [first; 2], ..as_it_was };
    // Whether the curve is free; the better of it and the best.
    let mut look = |states: &[C::State], energy: f64, iterations: u32| {
        let free = states.windows(2).all(|w| check.check_motion(&w[0], &w[1]).is_free());
        let length: f64 = states.windows(2).map(|w| space.distance(&w[0], &w[1])).sum();
        if free && energy < best.energy[0] && length <= stretch * before {
            let path = Path::straight(states.to_vec());
            best = Relaxed { path, length: [length, before], energy: [energy, first], iterations };
        }
        free
    };
    let mut done = 0;
    let rest = snake.deform(&mut curve, field, |moment| {
        done = moment.iteration;
        done.is_power_of_two() && !look(moment.curve, moment.energy.total(), done)
    });
    if rest != Rest::Stopped {
        let last = snake.trace().last().map_or(first, Energy::total);
        look(&curve, last, done);
    }
    Ok(best)
}
