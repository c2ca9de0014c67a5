//! The snake: a curve that minimizes its energy.

use crate::bulge::Blockage;
use crate::params::scale;
use crate::{Band, Field, Params, SnakeError};
use mp_cspace::Space;

/// The energy of a curve, in three parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Of the curve itself: `½·∫(α·|v'|² + β·|v''|²) ds`.
    pub internal: f64,
    /// Of the field along it: `∫P ds`.
    pub external: f64,
    /// `γ` times its length.
    pub optimal: f64,
}

impl Energy {
    /// The sum of the parts.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.internal + self.external + self.optimal
    }
}

/// Why a snake stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rest {
    /// The last step was shorter than the tolerance.
    Converged,
    /// No step along the forces lowers the energy.
    Stagnated,
    /// It has taken the most steps allowed.
    Iterations,
    /// The `watch` function stopped it.
    Stopped,
}

/// The state of a snake between two steps.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a, S> {
    /// Its nodes, both ends included.
    pub curve: &'a [S],
    /// The least clearance (m) at a node between the ends, by the field; infinite if the field has none.
    pub clearance: f64,
    /// Its energy.
    pub energy: Energy,
    /// Steps done.
    pub iteration: u32,
}

/// An open active contour with fixed ends, in any space with velocities.
///
/// M. Kass, A. Witkin and D. Terzopoulos, *Snakes: active contour models*, IJCV 1, 1988, as modified by K. Baizid et
/// al., *RRS: rapidly-exploring random snakes* (eq. 1 to 4). For a curve `v` of nodes `h` apart the energy is
///
/// `E = α/2h·Σ|vᵢ₊₁ − vᵢ|² + β/2h³·Σ|vᵢ₋₁ − 2vᵢ + vᵢ₊₁|² + h·ΣP(vᵢ) + γ·Σ|vᵢ₊₁ − vᵢ|`
///
/// with differences in the metric of the space: velocities from node to node, each degree of freedom
/// weighted by the length that it travels. Where the paper differs:
/// - Eq. 2 prints `|v|²` and `|v'|²`; membrane and plate are `|v'|²` and `|v''|²` as in Kass et al.
/// - Eq. 4 sums forces `γ·n̄` along the normal. The energy of which this is the direction of descent is the length;
///   its force is `γ·κ·n̄`, towards the inside of each bend and zero where the curve is straight.
/// - The field acts across the curve only: a force along the curve would move nodes, but not the curve.
///
/// One step is semi-implicit: `(I + a·T + b·T²)·δ = −τ/h·∇E`, the stiff part by a [`Band`] that is factorised
/// once for each number of nodes. The step is halved until the energy does not rise, so it never does. In spaces
/// with rotations, differences about neighbouring nodes are taken as if in one tangent space.
///
/// A step takes O(n·d) operations and one evaluation of the field per node, for n nodes and d degrees of freedom.
///
/// ```
/// use mp_cspace::Rn;
/// use mp_snake::{Params, Repulsion, Rest, Snake};
/// use nalgebra::Vector2;
/// let space = Rn::<2>::new([-2.0; 2], [2.0; 2])?;
/// // A disc of radius 0.3, a little below the middle of a straight line.
/// let disc = |q: &Vector2<f64>, _: f64, gradient: &mut [f64]| {
///     let from = q - Vector2::new(0.0, -0.1);
///     gradient.copy_from_slice((from / from.norm()).as_slice());
///     from.norm() - 0.3
/// };
/// let mut snake = Snake::new(&space, Params::for_range(0.2)?)?;
/// let mut curve = snake.between(&Vector2::new(-1.0, 0.0), &Vector2::new(1.0, 0.0));
/// snake.deform(&mut curve, &mut Repulsion::new(disc, 0.2)?, |_| false);
/// let clear = |q: &Vector2<f64>| (q - Vector2::new(0.0, -0.1)).norm() > 0.3;
/// assert!(curve.iter().all(clear));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Snake<'c, C: Space> {
    pub(crate) space: &'c C,
    params: Params,
    pub(crate) scale: Vec<f64>,
    /// By the number of nodes that move.
    bands: Vec<Option<Band>>,
    now: CurveMeasurement,
    trial: CurveMeasurement,
    /// The displacements of the nodes between the ends.
    step: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    /// A buffer for gradients that are not used.
    pub(crate) unused: Vec<f64>,
    /// The buffers of bulges.
    pub(crate) blockage: Blockage,
    pub(crate) next: Vec<C::State>,
    trace: Vec<Energy>,
}

/// A curve measured: its energy and the forces on it. Numbers are scaled: lengths in the metric.
#[derive(Clone, Debug, Default)]
pub(crate) struct CurveMeasurement {
    pub(crate) energy: Energy,
    /// The vectors from each node to the next.
    pub(crate) segments: Vec<f64>,
    /// Their lengths.
    lengths: Vec<f64>,
    /// The gradient of the field at each node between the ends, across the curve.
    pub(crate) gradients: Vec<f64>,
    /// The clearance of those nodes.
    pub(crate) clearances: Vec<f64>,
}

impl CurveMeasurement {
    fn with_room(dim: usize) -> Self {
        Self {
            energy: Energy::default(),
            segments: Vec::with_capacity(NODES * dim),
            lengths: Vec::with_capacity(NODES),
            gradients: Vec::with_capacity(NODES * dim),
            clearances: Vec::with_capacity(NODES),
        }
    }

    /// The least clearance of a node between the ends.
    pub(crate) fn clearance(&self) -> f64 {
        self.clearances.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Buffers have room for this many nodes from the beginning: as many as edges need.
pub(crate) const NODES: usize = 32;

/// Most nodes of a curve.
const MOST_NODES: usize = 10_000;

/// How often a step is halved before it fails.
const HALVINGS: u32 = 3;

/// A step that lowers the energy by less than this part of it ends the deformation.
const LEAST_GAIN: f64 = 1e-7;

impl<'c, C: Space> Snake<'c, C> {
    /// Snakes with these parameters in `space`.
    ///
    /// # Errors
    /// When a parameter is out of range, or the space has no velocities.
    pub fn new(space: &'c C, params: Params) -> Result<Self, SnakeError> {
        let dim = space.dim();
        Ok(Self {
            space,
            params: params.checked()?,
            scale: scale(space)?,
            bands: Vec::new(),
            now: CurveMeasurement::with_room(dim),
            trial: CurveMeasurement::with_room(dim),
            step: Vec::with_capacity(NODES * dim),
            velocity: Vec::with_capacity(dim),
            unused: Vec::with_capacity(dim),
            blockage: Blockage::with_room(dim),
            next: Vec::with_capacity(NODES),
            trace: Vec::new(),
        })
    }

    /// Its parameters.
    #[must_use]
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// The space.
    #[must_use]
    pub fn space(&self) -> &'c C {
        self.space
    }

    /// The energies of the curve deformed last: before the first step and after each step.
    #[must_use]
    pub fn trace(&self) -> &[Energy] {
        &self.trace
    }

    /// The straight curve from one state to another, with as many nodes as the spacing needs, at least five and at most
    /// ten thousand.
    pub fn between(&self, from: &C::State, to: &C::State) -> Vec<C::State> {
        let mut curve = Vec::new();
        self.between_into(from, to, &mut curve);
        curve
    }

    /// As [`between`](Self::between), into `curve`, which is cleared first.
    pub fn between_into(&self, from: &C::State, to: &C::State, curve: &mut Vec<C::State>) {
        let wanted = (self.space.distance(from, to) / self.params.spacing).ceil();
        let parts = wanted.clamp(4.0, (MOST_NODES - 1) as f64) as usize;
        curve.clear();
        let part = 1.0 / parts as f64;
        curve.push(from.clone());
        curve.extend((1..parts).map(|i| self.space.interpolate(from, to, i as f64 * part)));
        curve.push(to.clone());
    }

    /// The energy of a curve.
    pub fn energy(&mut self, curve: &[C::State], field: &mut impl Field<C::State>) -> Energy {
        let mut measured = std::mem::take(&mut self.trial);
        self.measure(curve, field, &mut measured);
        self.trial = measured;
        self.trial.energy
    }

    /// Moves the nodes between the ends until the energy is least, or until `watch` returns true; it is called before the
    /// first step and after each. A curve of less than three nodes stays as it is, and nodes do not leave the bounds of
    /// the space.
    ///
    /// The energy never rises from one step to the next, but for rounding.
    pub fn deform(
        &mut self,
        curve: &mut [C::State],
        field: &mut impl Field<C::State>,
        mut watch: impl FnMut(Moment<'_, C::State>) -> bool,
    ) -> Rest {
        self.trace.clear();
        let mut now = std::mem::take(&mut self.now);
        self.measure(curve, field, &mut now);
        self.trace.push(now.energy);
        let mut iteration = 0;
        let rest = loop {
            if watch(Moment { curve, clearance: now.clearance(), energy: now.energy, iteration }) {
                break Rest::Stopped;
            }
            if iteration == self.params.iterations {
                break Rest::Iterations;
            }
            if curve.len() < 3 {
                break Rest::Converged;
            }
            iteration += 1;
            self.aim(&now);
            let before = now.energy.total();
            let Some(part) = self.advance(curve, field, &mut now) else { break Rest::Stagnated };
            self.trace.push(now.energy);
            let dim = self.space.dim();
            let farthest = self.step.chunks_exact(dim).map(norm).fold(0.0, f64::max) * part;
            if farthest <= self.params.tolerance * self.params.spacing {
                break Rest::Converged;
            }
            if before - now.energy.total() <= LEAST_GAIN * before.abs() {
                break Rest::Stagnated;
            }
        };
        self.now = now;
        rest
    }

    /// Measures a curve: its energy, its segments and the forces on it.
    fn measure(
        &mut self,
        curve: &[C::State],
        field: &mut impl Field<C::State>,
        measured: &mut CurveMeasurement,
    ) {
        let (dim, h) = (self.space.dim(), self.params.spacing);
        let parts = curve.len().saturating_sub(1);
        measured.segments.resize(parts * dim, 0.0);
        measured.lengths.clear();
        for (pair, segment) in curve.windows(2).zip(measured.segments.chunks_exact_mut(dim)) {
            self.space.velocity_into(&pair[0], &pair[1], segment);
            segment.iter_mut().zip(&self.scale).for_each(|(x, s)| *x *= s);
            measured.lengths.push(norm(segment));
        }
        let segments = &measured.segments;
        let bends: f64 = segments
            .iter()
            .zip(segments.iter().skip(dim))
            .map(|(incoming, outgoing)| (outgoing - incoming).powi(2))
            .sum();
        let stretched: f64 = segments.iter().map(|x| x * x).sum();
        let length: f64 = measured.lengths.iter().sum();
        let Params { membrane, plate, straighten, .. } = self.params;
        measured.energy.internal = 0.5 * (membrane * stretched / h + plate * bends / (h * h * h));
        measured.energy.optimal = straighten * length;
        measured.energy.external = 0.0;
        let inner = parts.saturating_sub(1);
        measured.gradients.resize(inner * dim, 0.0);
        measured.clearances.clear();
        let pairs = measured.segments.chunks_exact(dim).zip(measured.segments.chunks_exact(dim).skip(1));
        let gradients = measured.gradients.chunks_exact_mut(dim);
        for (q, (push, (incoming, outgoing))) in curve.iter().skip(1).zip(gradients.zip(pairs)) {
            measured.energy.external += h * field.energy(q, push);
            measured.clearances.push(field.clearance().unwrap_or(f64::INFINITY));
            push.iter_mut().zip(&self.scale).for_each(|(x, s)| *x /= s);
            across(push, incoming, outgoing);
        }
    }

    /// Computes the implicit step of all nodes, from the forces on the curve.
    fn aim(&mut self, measured: &CurveMeasurement) {
        let (dim, parts) = (self.space.dim(), measured.lengths.len());
        let Params { membrane, plate, straighten, spacing: h, pace, .. } = self.params;
        let bent = |i: usize, k: usize| {
            if i == 0 || i >= parts { 0.0 } else { bend(&measured.segments, dim, i, k) }
        };
        self.step.clear();
        for i in 1..parts {
            let [before, after] = [i - 1, i].map(|j| (j * dim, straighten / measured.lengths[j].max(1e-300)));
            for k in 0..dim {
                let (incoming, outgoing) = (measured.segments[before.0 + k], measured.segments[after.0 + k]);
                let stretch = membrane / h * (incoming - outgoing);
                let curl = plate / (h * h * h) * (bent(i - 1, k) - 2.0 * bent(i, k) + bent(i + 1, k));
                let slack = before.1 * incoming - after.1 * outgoing;
                let push = h * measured.gradients[(i - 1) * dim + k];
                self.step.push(-pace / h * (stretch + curl + slack + push));
            }
        }
        let rows = parts - 1;
        if self.bands.len() <= rows {
            self.bands.resize(rows + 1, None);
        }
        let [a, b] = self.params.stiffness();
        self.bands[rows].get_or_insert_with(|| Band::new(rows, a, b)).solve(&mut self.step, dim);
    }

    /// Takes the largest part of the step that does not raise the energy. Returns that part, or `None` when there is none.
    fn advance(
        &mut self,
        curve: &mut [C::State],
        field: &mut impl Field<C::State>,
        now: &mut CurveMeasurement,
    ) -> Option<f64> {
        let most = now.energy.total() * (1.0 + 1e-12) + 1e-300;
        let mut next = std::mem::take(&mut self.next);
        let mut trial = std::mem::take(&mut self.trial);
        let mut part = 1.0;
        let mut gone = None;
        for _ in 0..=HALVINGS {
            self.displaced(curve, part, &mut next);
            self.measure(&next, field, &mut trial);
            if trial.energy.total() <= most {
                curve.clone_from_slice(&next);
                std::mem::swap(now, &mut trial);
                gone = Some(part);
                break;
            }
            part *= 0.5;
        }
        (self.next, self.trial) = (next, trial);
        gone
    }

    /// The curve with each node between the ends moved by a part of the step.
    fn displaced(&mut self, curve: &[C::State], part: f64, out: &mut Vec<C::State>) {
        out.clear();
        out.extend_from_slice(curve);
        let dim = self.space.dim();
        for (step, q) in self.step.chunks_exact(dim).zip(&mut out[1..]) {
            self.velocity.clear();
            self.velocity.extend(step.iter().zip(&self.scale).map(|(x, s)| x / s));
            match self.space.moved(q, &self.velocity, part) {
                Some(moved) if self.space.contains(&moved) => *q = moved,
                _ => {}
            }
        }
    }

    /// The number of degrees of freedom.
    pub(crate) fn dim(&self) -> usize {
        self.space.dim()
    }
}

/// The second difference of a curve at node `i`.
#[inline]
fn bend(segments: &[f64], dim: usize, i: usize, k: usize) -> f64 {
    segments[i * dim + k] - segments[(i - 1) * dim + k]
}

#[inline]
pub(crate) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Removes from `push` its component along the curve, which is the sum of the segments before and after the node.
#[inline]
fn across(push: &mut [f64], incoming: &[f64], outgoing: &[f64]) {
    let along = || incoming.iter().zip(outgoing).map(|(c, g)| c + g);
    let square: f64 = along().map(|a| a * a).sum();
    if square > 0.0 {
        let part: f64 = push.iter().zip(along()).map(|(p, a)| p * a).sum::<f64>() / square;
        push.iter_mut().zip(along()).for_each(|(p, a)| *p -= part * a);
    }
}
