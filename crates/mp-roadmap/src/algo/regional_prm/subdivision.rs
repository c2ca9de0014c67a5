//! A space that is cut into regions.

use super::Regions;
use mp_cspace::{BuildError, Rng, Space};
use rand::RngExt;
use std::ops::Range;

/// A number of the states that runs straight from a lower to an upper bound.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis {
    /// Its place in the unit cube, and in velocities.
    coordinate: usize,
    /// How far it is from its lower to its upper bound, in its own unit.
    width: f64,
    /// The same in the metric.
    length: f64,
    cells: u32,
    /// By how much the numbers of two regions differ that are neighbours along this axis.
    stride: u32,
}

/// A space that is cut into a grid of regions of equal measure.
///
/// The regions are those of the unit cube, which [`Space::unit_cube_to_state`] maps to the space. So they
/// tile the space, whatever it is. Along which numbers it can be cut is found with [`Space::velocity_into`]:
/// a space without velocities is one region.
#[derive(Clone, Debug, PartialEq)]
pub struct Subdivision<S> {
    dim: usize,
    /// All numbers at their lower bounds.
    origin: S,
    axes: Vec<Axis>,
    overlap: f64,
    regions: u32,
    pairs: Vec<[u32; 2]>,
}

/// Differences below this part of the width of an axis are due to rounding.
const ROUNDING: f64 = 1e-6;

impl<S: Clone> Subdivision<S> {
    /// The space cut into this number of regions, which are sampled beyond their faces by a part `overlap` of
    /// their widths. One region, if it cannot be cut.
    ///
    /// # Errors
    /// When there are no regions, or more than 10⁶, or the part is not in \[0, 1\].
    pub fn new<C: Space<State = S>>(space: &C, regions: usize, overlap: f64) -> Result<Self, BuildError> {
        let Regions { regions, overlap, .. } = Regions { regions, overlap, ..Regions::default() }.check()?;
        let dim = space.dim();
        let mut axes: Vec<Axis> =
            (0..dim).filter_map(|coordinate| straight_axis(space, coordinate)).collect();
        // Each factor, the largest first, cuts the regions where they are longest, the first of axes of the
        // same length.
        for factor in factors(regions as u32).into_iter().rev() {
            let longer = |best: Option<usize>, i: usize| {
                let length = |i: usize| axes[i].length / f64::from(axes[i].cells);
                Some(best.filter(|&best| length(best) >= length(i)).unwrap_or(i))
            };
            if let Some(longest) = (0..axes.len()).fold(None, longer) {
                axes[longest].cells *= factor;
            }
        }
        let mut regions = 1;
        for axis in &mut axes {
            axis.stride = regions;
            regions *= axis.cells;
        }
        axes.retain(|axis| axis.cells > 1);
        let along = |region: u32, axis: &Axis| {
            (cell(axis, region) + 1 < axis.cells).then_some([region, region + axis.stride])
        };
        let pairs = (0..regions).flat_map(|region| axes.iter().filter_map(move |axis| along(region, axis)));
        let (pairs, origin) = (pairs.collect(), space.unit_cube_to_state(&vec![0.0; dim]));
        Ok(Self { dim, origin, axes, overlap, regions, pairs })
    }

    /// How many regions there are; their numbers are those below.
    #[must_use]
    pub fn regions(&self) -> u32 {
        self.regions
    }

    /// All pairs of adjacent regions, in order, the lower region first.
    #[must_use]
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// The region that holds a state; a state on a border belongs to the upper one.
    pub fn region_of<C: Space<State = S>>(&self, space: &C, q: &S) -> u32 {
        let cell = |(axis, x): (&Axis, f64)| {
            let cell = (x * f64::from(axis.cells)).floor().clamp(0.0, f64::from(axis.cells - 1));
            cell as u32 * axis.stride
        };
        self.axes.iter().zip(self.coordinates(space, q)).map(cell).sum()
    }

    /// A sample of a region and the overlap around it, uniform in both.
    pub fn sample<C: Space<State = S>>(&self, space: &C, region: u32, rng: &mut Rng) -> S {
        let mut u: Vec<f64> = (0..self.dim).map(|_| rng.random()).collect();
        for axis in &self.axes {
            let Range { start, end } = self.range(axis, region);
            let x = &mut u[axis.coordinate];
            *x = (start + (end - start) * *x).min(1.0 - f64::EPSILON);
        }
        space.unit_cube_to_state(&u)
    }

    /// Whether a state is in a region or its overlap, up to rounding.
    pub(super) fn holds<C: Space<State = S>>(&self, space: &C, region: u32, q: &S) -> bool {
        let within = |(axis, x): (&Axis, f64)| {
            let Range { start, end } = self.range(axis, region);
            (start - ROUNDING..=end + ROUNDING).contains(&x)
        };
        region < self.regions && self.axes.iter().zip(self.coordinates(space, q)).all(within)
    }

    /// The range of a region and its overlap along an axis, in the unit cube.
    fn range(&self, axis: &Axis, region: u32) -> Range<f64> {
        let (cell, cells) = (f64::from(cell(axis, region)), f64::from(axis.cells));
        ((cell - self.overlap) / cells).max(0.0)..((cell + 1.0 + self.overlap) / cells).min(1.0)
    }

    /// Where a state is along each axis, from 0 to 1.
    fn coordinates<C: Space<State = S>>(&self, space: &C, q: &S) -> impl Iterator<Item = f64> {
        let mut velocity = vec![0.0; self.dim];
        space.velocity_into(&self.origin, q, &mut velocity);
        self.axes.iter().map(move |axis| velocity[axis.coordinate] / axis.width)
    }
}

/// The place of a region along an axis.
fn cell(axis: &Axis, region: u32) -> u32 {
    region / axis.stride % axis.cells
}

/// The axis of a coordinate of the unit cube along which states move straight, alone and in proportion: not a
/// rotation.
fn straight_axis<C: Space>(space: &C, coordinate: usize) -> Option<Axis> {
    let mut velocity = vec![0.0; space.dim()];
    let state = |others: f64, x: f64| {
        let mut u = vec![others; space.dim()];
        u[coordinate] = x;
        space.unit_cube_to_state(&u)
    };
    if !space.velocity_into(&state(0.0, 0.0), &state(0.0, 0.5), &mut velocity) {
        return None;
    }
    let width = 2.0 * velocity[coordinate];
    let straight = [0.0, 0.6].into_iter().all(|others| {
        [0.25, 0.5, 0.75, 0.95].into_iter().all(|x| {
            let wanted = |i: usize| if i == coordinate { x * width } else { 0.0 };
            space.velocity_into(&state(others, 0.0), &state(others, x), &mut velocity)
                && velocity.iter().enumerate().all(|(i, v)| (v - wanted(i)).abs() <= ROUNDING * width)
        })
    });
    let length = 2.0 * space.distance(&state(0.0, 0.0), &state(0.0, 0.5));
    let axis = Axis { coordinate, width, length, cells: 1, stride: 1 };
    (width > 0.0 && width.is_finite() && straight).then_some(axis)
}

/// The prime factors of a number, the smallest first.
fn factors(mut number: u32) -> Vec<u32> {
    let (mut factors, mut factor) = (Vec::new(), 2);
    while factor * factor <= number {
        while number.is_multiple_of(factor) {
            factors.push(factor);
            number /= factor;
        }
        factor += 1;
    }
    factors.extend((number > 1).then_some(number));
    factors
}
