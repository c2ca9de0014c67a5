//! Input sets: the inputs that a system may get.

use crate::{Input, InputError};
use mp_cspace::{Configuration, Halton, Joints, ParameterError, Rng, Sampler, Space, SpaceError};
use nalgebra::{DVector, SVector};
use std::f64::consts::TAU;

/// A list of inputs: not empty, and all finite. Ties between successors go to the input listed first.
///
/// ```
/// use mp_control::InputSet;
/// // A disc that moves at 1 m/s along x or y: four inputs.
/// assert_eq!(InputSet::axes([1.0, 1.0])?.len(), 4);
/// // All combinations of three values per axis, except standing still: eight.
/// assert_eq!(InputSet::grid([1.0, 1.0], 3)?.len(), 8);
/// assert!(InputSet::<f64>::new([]).is_err());
/// # Ok::<(), mp_control::InputError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct InputSet<U> {
    inputs: Vec<U>,
}

/// The most inputs of a grid.
const MAX_GRID: usize = 1 << 20;

impl<U: Input> InputSet<U> {
    /// The set of these inputs.
    ///
    /// # Errors
    /// When there is no input, an input has no entries, or an entry is not finite.
    pub fn new(inputs: impl IntoIterator<Item = U>) -> Result<Self, InputError> {
        let inputs: Vec<U> = inputs.into_iter().collect();
        if inputs.is_empty() {
            return Err(InputError::Empty { what: "the set of inputs" });
        }
        for (index, input) in inputs.iter().enumerate() {
            if input.entries().is_empty() {
                return Err(InputError::Empty { what: "an input" });
            }
            if !input.entries().iter().all(|x| x.is_finite()) {
                return Err(InputError::NotFinite { index, input: format!("{input:?}") });
            }
        }
        Ok(Self { inputs })
    }

    /// The inputs, in order.
    #[must_use]
    pub fn inputs(&self) -> &[U] {
        &self.inputs
    }

    /// How many there are, at least one.
    #[must_use]
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.inputs.len()
    }

    /// These and the inputs of `other` after them.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        self.inputs.extend(other.inputs);
        self
    }
}

/// Uniform sets: `limits` holds the greatest magnitude of each entry.
impl<const N: usize> InputSet<SVector<f64, N>> {
    /// Each entry alone at its limit, positive and negative: `2N` inputs.
    ///
    /// # Errors
    /// When `N` is zero or a limit is not positive and finite.
    pub fn axes(limits: impl Into<SVector<f64, N>>) -> Result<Self, InputError> {
        let limits = limits.into();
        let vectors = axes(limits.as_slice())?;
        Self::new(vectors.iter().map(|v| SVector::from_column_slice(v)))
    }

    /// All combinations of `levels` evenly spaced values of each entry from the negative to the positive
    /// limit, except all zero.
    ///
    /// # Errors
    /// As [`axes`](Self::axes), or when there are fewer than two levels or more than 2²⁰ combinations.
    pub fn grid(limits: impl Into<SVector<f64, N>>, levels: usize) -> Result<Self, InputError> {
        let limits = limits.into();
        let vectors = grid(limits.as_slice(), levels)?;
        Self::new(vectors.iter().map(|v| SVector::from_column_slice(v)))
    }

    /// `count` directions spread evenly, each scaled to the ellipsoid whose half axes are the limits.
    ///
    /// # Errors
    /// As [`axes`](Self::axes), or when the count is zero.
    pub fn spread(limits: impl Into<SVector<f64, N>>, count: usize) -> Result<Self, InputError> {
        let limits = limits.into();
        let vectors = spread(limits.as_slice(), count)?;
        Self::new(vectors.iter().map(|v| SVector::from_column_slice(v)))
    }

    /// The first `count` directions of a sequence that begins with the [`axes`](Self::axes) and goes on
    /// with those of [`spread`](Self::spread); with fewer directions than the axes have, `spread` alone.
    /// A larger set contains every smaller one that has all axes, so a comparison of sets of different
    /// sizes varies nothing but how densely they cover the directions.
    ///
    /// # Errors
    /// As [`spread`](Self::spread).
    pub fn directions(limits: impl Into<SVector<f64, N>>, count: usize) -> Result<Self, InputError> {
        let limits = limits.into();
        let vectors = directions(limits.as_slice(), count)?;
        Self::new(vectors.iter().map(|v| SVector::from_column_slice(v)))
    }
}

/// Uniform sets of inputs whose number of entries is known at run time.
impl InputSet<DVector<f64>> {
    /// As [`axes`](InputSet::axes) of fixed size.
    ///
    /// # Errors
    /// Those of [`axes`](InputSet::axes).
    pub fn axes_dyn(limits: &[f64]) -> Result<Self, InputError> {
        Self::new(axes(limits)?.into_iter().map(DVector::from_vec))
    }

    /// As [`grid`](InputSet::grid) of fixed size.
    ///
    /// # Errors
    /// Those of [`grid`](InputSet::grid).
    pub fn grid_dyn(limits: &[f64], levels: usize) -> Result<Self, InputError> {
        Self::new(grid(limits, levels)?.into_iter().map(DVector::from_vec))
    }

    /// As [`spread`](InputSet::spread) of fixed size.
    ///
    /// # Errors
    /// Those of [`spread`](InputSet::spread).
    pub fn spread_dyn(limits: &[f64], count: usize) -> Result<Self, InputError> {
        Self::new(spread(limits, count)?.into_iter().map(DVector::from_vec))
    }

    /// As [`directions`](InputSet::directions) of fixed size.
    ///
    /// # Errors
    /// Those of [`directions`](InputSet::directions).
    pub fn directions_dyn(limits: &[f64], count: usize) -> Result<Self, InputError> {
        Self::new(directions(limits, count)?.into_iter().map(DVector::from_vec))
    }
}

impl InputSet<Vec<f64>> {
    /// Velocities that move states of `space` by `reach` in one second, in its metric: spread evenly over its
    /// degrees of freedom, translation and rotation alike. `directions` is the number of
    /// [directions](InputSet::directions), zero for both ways along each degree of freedom; `levels` the
    /// number of magnitudes of each, every one a quarter of the one before. Turns are limited to about half a
    /// turn. Levels beyond the hundredth have the magnitude of the hundredth.
    ///
    /// # Errors
    /// When the space has no velocities, `reach` is not positive and finite, or there is no level.
    pub fn uniform<C: Space>(
        space: &C,
        reach: f64,
        directions: usize,
        levels: u32,
    ) -> Result<Self, InputError> {
        if levels == 0 {
            return Err(InputError::Empty { what: "the list of levels" });
        }
        let limits = reaches(space, reach)?;
        let vectors = if directions == 0 { axes(&limits)? } else { self::directions(&limits, directions)? };
        let scaled = |level: u32| {
            let factor = mp_math::powi(0.25, level.min(99) as i32);
            vectors.iter().map(move |v| v.iter().map(|x| x * factor).collect())
        };
        Self::new((0..levels).flat_map(scaled))
    }
}

/// For each degree of freedom, the velocity that moves the middle of the space by `reach` in one second.
fn reaches<C: Space>(space: &C, reach: f64) -> Result<Vec<f64>, InputError> {
    let dim = space.dim();
    let middle = space.unit_cube_to_state(&vec![0.5; dim]);
    let moved = |axis: usize, speed: f64| {
        let mut velocity = vec![0.0; dim];
        velocity[axis] = speed;
        let to = space.moved(&middle, &velocity, 1.0).ok_or(InputError::NoMotion { entries: dim, dim })?;
        Ok::<f64, InputError>(space.distance(&middle, &to))
    };
    let limit = |axis: usize| {
        let little = 1e-4;
        let rate = moved(axis, little)? / little;
        let mut speed = reach / rate;
        // A rotation beyond half a turn comes round: its distance is less than the angle turned.
        for _ in 0..64 {
            let far = moved(axis, speed)? >= 0.6 * speed * rate;
            if far {
                break;
            }
            speed *= 0.5;
        }
        Ok(speed)
    };
    (0..dim).map(limit).collect()
}

fn checked(limits: &[f64]) -> Result<(), InputError> {
    if limits.is_empty() {
        return Err(InputError::Empty { what: "the list of limits" });
    }
    for &value in limits {
        if !(value > 0.0 && value.is_finite()) {
            return Err(SpaceError::Weight { name: "the limit of an input", value }.into());
        }
    }
    Ok(())
}

fn axes(limits: &[f64]) -> Result<Vec<Vec<f64>>, InputError> {
    checked(limits)?;
    let along = |i: usize, sign: f64| {
        let mut v = vec![0.0; limits.len()];
        v[i] = sign * limits[i];
        v
    };
    Ok((0..limits.len()).flat_map(|i| [along(i, 1.0), along(i, -1.0)]).collect())
}

fn grid(limits: &[f64], levels: usize) -> Result<Vec<Vec<f64>>, InputError> {
    checked(limits)?;
    let count = u32::try_from(limits.len()).ok().and_then(|n| levels.checked_pow(n));
    let Some(count) = count.filter(|&count| levels >= 2 && count <= MAX_GRID) else {
        return Err(ParameterError {
            name: "the number of levels",
            expected: "at least 2, and such that there are at most 2^20 combinations",
            value: levels as f64,
        }
        .into());
    };
    let value = |level: usize| 2.0 * level as f64 / (levels - 1) as f64 - 1.0;
    let input = |mut number: usize| -> Vec<f64> {
        limits
            .iter()
            .map(|limit| {
                let level = number % levels;
                number /= levels;
                limit * value(level)
            })
            .collect()
    };
    Ok((0..count).map(input).filter(|v| v.iter().any(|x| *x != 0.0)).collect())
}

/// The axes and then spread directions, `count` in all; spread directions alone if there are fewer than axes.
fn directions(limits: &[f64], count: usize) -> Result<Vec<Vec<f64>>, InputError> {
    let mut all = axes(limits)?;
    match count.checked_sub(all.len()) {
        None => spread(limits, count),
        Some(0) => Ok(all),
        Some(more) => {
            all.extend(spread(limits, more)?);
            Ok(all)
        }
    }
}

/// Directions on the ellipsoid of the limits, each followed by its opposite: points of a Halton sequence made
/// normal (Box and Muller 1958), of unit length, and scaled.
fn spread(limits: &[f64], count: usize) -> Result<Vec<Vec<f64>>, InputError> {
    checked(limits)?;
    if count == 0 {
        return Err(InputError::Empty { what: "the list of directions" });
    }
    let n = limits.len();
    let even = 2 * n.div_ceil(2);
    let cube = Joints::<Configuration>::intervals(&vec![0.0; even], &vec![1.0; even])?;
    // The sequence draws nothing from the generator.
    let (mut halton, mut rng) = (Halton::new(&cube), Rng::seed(0));
    let mut direction = || -> Vec<f64> {
        let u = halton.sample(&mut rng);
        let normal = |d: usize| {
            let (radius, angle) = ((-2.0 * mp_math::ln(1.0 - u[d & !1])).sqrt(), TAU * u[d | 1]);
            radius * if d.is_multiple_of(2) { mp_math::cos(angle) } else { mp_math::sin(angle) }
        };
        let v: Vec<f64> = (0..n).map(normal).collect();
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.iter().zip(limits).map(|(x, limit)| limit * x / length).collect()
    };
    let mut directions = Vec::with_capacity(count + 1);
    while directions.len() < count {
        let next = direction();
        let opposite = next.iter().map(|x| -x).collect();
        directions.extend([next, opposite]);
    }
    directions.truncate(count);
    Ok(directions)
}
