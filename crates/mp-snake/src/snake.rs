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
    /// What the contour costs as it is now.
    pub energy: Energy,
    /// Steps done.
    pub iteration: u32,
}

/// An open active contour with fixed ends, in any space with velocities.
///
/// M. Kass, A. Witkin and D. Terzopoulos, *Snakes: active contour models*, IJCV 1, 1988, as modified by K.
/// Baizid et al., *RRS: rapidly-exploring random snakes* (eq. 1 to 4). For a curve `v` of nodes `h` apart the
/// energy is
///
/// `E = α/2h·Σ|vᵢ₊₁ − vᵢ|² + β/2h³·Σ|vᵢ₋₁ − 2vᵢ + vᵢ₊₁|² + h·ΣP(vᵢ) + γ·Σ|vᵢ₊₁ − vᵢ|`
///
/// with differences in the metric of the space: velocities from node to node, each degree of freedom
/// weighted by the length that it travels. Where the paper differs:
/// - Eq. 2 prints `|v|²` and `|v'|²`; membrane and plate are `|v'|²` and `|v''|²` as in Kass et al.
/// - Eq. 4 sums forces `γ·n̄` along the normal. The energy of which this is the direction of descent is the
///   length; its force is `γ·κ·n̄`, towards the inside of each bend and zero where the curve is straight.
/// - The field acts across the curve only: a force along the curve would move nodes, but not the curve.
///
/// One step is semi-implicit: `(I + a·T + b·T²)·δ = −τ/h·∇E`, the stiff part by a [`Band`] that is factorised
/// once for each number of nodes. The step is halved until the energy does not rise, so it never does. In
/// spaces with rotations, differences about neighbouring nodes are taken as if in one tangent space.
///
/// A step takes O(n·d) operations and one evaluation of the field per node, for n nodes and d degrees of
/// freedom.
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
    /// How it moves now, and the bands of each manner so far, by the number of nodes that move.
    manner: Manner,
    bands: Vec<(Manner, Vec<Option<Band>>)>,
    /// The place of this manner among them.
    used: usize,
    pub(crate) scale: Vec<f64>,
    /// 1 / scale.
    pub(crate) unscale: Vec<f64>,
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
    /// The buffers of strategies: a bulge, and a contour that begins there.
    pub(crate) spare: [Vec<C::State>; 2],
    trace: Vec<Energy>,
    /// Contours without a free bulge to begin with: how many became free, and how many did not.
    pub(crate) without_bulge: [u64; 2],
    /// Contours that further attempts made free, and those that none did.
    pub(crate) further: [u64; 2],
}

/// How a snake moves: what may differ from one attempt to lower the same energy to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Manner {
    /// Distance between nodes (m).
    pub(crate) spacing: f64,
    /// Length of an implicit step (m²).
    pub(crate) pace: f64,
    /// How much alike neighbouring nodes move: added to the first coefficient of the [matrix](Band) of a
    /// step, as if the curve were that stiff, but not to its energy.
    pub(crate) smoothing: f64,
}

impl Manner {
    /// That of the parameters.
    pub(crate) fn of(params: &Params) -> Self {
        Self { spacing: params.spacing, pace: params.pace, smoothing: 0.0 }
    }
}

/// A curve measured: its energy and the forces on it. Numbers are scaled: lengths in the metric.
#[derive(Clone, Debug, Default)]
pub(crate) struct CurveMeasurement {
    pub(crate) energy: Energy,
    /// The vectors from each node to the next.
    pub(crate) segments: Vec<f64>,
    /// Their lengths.
    lengths: Vec<f64>,
    /// The second differences: at each node the segment after it less the one before, and zero at both ends.
    bends: Vec<f64>,
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
            bends: Vec::with_capacity(NODES * dim),
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
        let scale = scale(space)?;
        let unscale = scale.iter().map(|s| 1.0 / s).collect();
        Ok(Self {
            space,
            params: params.checked()?,
            manner: Manner::of(&params),
            bands: vec![(Manner::of(&params), Vec::new())],
            used: 0,
            scale,
            unscale,
            now: CurveMeasurement::with_room(dim),
            trial: CurveMeasurement::with_room(dim),
            step: Vec::with_capacity(NODES * dim),
            velocity: Vec::with_capacity(dim),
            unused: Vec::with_capacity(dim),
            blockage: Blockage::with_room(dim),
            next: Vec::with_capacity(NODES),
            spare: [const { Vec::new() }; 2],
            trace: Vec::new(),
            without_bulge: [0; 2],
            further: [0; 2],
        })
    }

    /// How stiff it is, how hard the field pushes, and when it ends.
    #[must_use]
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// Makes steps of another length (m²).
    pub(crate) fn set_pace(&mut self, pace: f64) {
        self.move_by(Manner { pace, ..self.manner });
    }

    /// Moves in this manner from now on.
    pub(crate) fn move_by(&mut self, manner: Manner) {
        self.manner = manner;
        let known = self.bands.iter().position(|(known, _)| *known == manner);
        self.used = known.unwrap_or(self.bands.len());
        if known.is_none() {
            self.bands.push((manner, Vec::new()));
        }
    }

    /// The space in which its nodes move.
    #[must_use]
    pub fn space(&self) -> &'c C {
        self.space
    }

    /// The energies of the curve deformed last: before the first step and after each step.
    #[must_use]
    pub fn trace(&self) -> &[Energy] {
        &self.trace
    }

    /// The straight curve from one state to another, with as many nodes as the spacing needs, at least five
    /// and at most ten thousand.
    pub fn between(&self, from: &C::State, to: &C::State) -> Vec<C::State> {
        let mut curve = Vec::new();
        self.between_into(from, to, &mut curve);
        curve
    }

    /// As [`between`](Self::between), into `curve`, which is cleared first.
    pub fn between_into(&self, from: &C::State, to: &C::State, curve: &mut Vec<C::State>) {
        self.spread_into(from, to, self.params.spacing, 4, curve);
    }

    /// Replaces `curve` by a straight one: its nodes are at most `spacing` (m) apart, and it has at least
    /// `pieces` pieces.
    pub(crate) fn spread_into(
        &self,
        from: &C::State,
        to: &C::State,
        spacing: f64,
        pieces: u32,
        curve: &mut Vec<C::State>,
    ) {
        let wanted = (self.space.distance(from, to) / spacing).ceil();
        let parts = wanted.clamp(f64::from(pieces), (MOST_NODES - 1) as f64) as usize;
        curve.clear();
        let part = 1.0 / parts as f64;
        curve.push(from.clone());
        curve.extend((1..parts).map(|i| self.space.interpolate(from, to, i as f64 * part)));
        curve.push(to.clone());
    }

    /// Puts a node into the middle of each piece.
    pub(crate) fn split(&mut self, curve: &mut Vec<C::State>) {
        self.next.clear();
        for pair in curve.windows(2) {
            let middle = self.space.interpolate(&pair[0], &pair[1], 0.5);
            self.next.extend([pair[0].clone(), middle]);
        }
        self.next.extend(curve.last().cloned());
        std::mem::swap(curve, &mut self.next);
    }

    /// Lays nodes along a polyline into `curve`, which is cleared first: at its corners, and between them at
    /// most the spacing apart.
    pub(crate) fn resample(&self, corners: &[C::State], curve: &mut Vec<C::State>) {
        curve.clear();
        for pair in corners.windows(2) {
            let parts = (self.space.distance(&pair[0], &pair[1]) / self.params.spacing).ceil().max(1.0);
            let inside = |i: usize| self.space.interpolate(&pair[0], &pair[1], i as f64 / parts);
            curve.extend((0..parts as usize).map(inside));
        }
        curve.extend(corners.last().cloned());
    }

    /// What a curve costs: its tension and rigidity, its length, and the field along it.
    pub fn energy(&mut self, curve: &[C::State], field: &mut impl Field<C::State>) -> Energy {
        let mut measured = std::mem::take(&mut self.trial);
        self.measure(curve, field, &mut measured);
        self.trial = measured;
        self.trial.energy
    }

    /// Moves the nodes between the ends until the energy is least, or until `watch` returns true; it is
    /// called before the first step and after each. A curve of less than three nodes stays as it is, and
    /// nodes do not leave the bounds of the space.
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
            let dim = self.space.dim();
            let least = self.params.tolerance * self.manner.spacing;
            let farthest = self.step.chunks_exact(dim).map(norm).fold(0.0, f64::max);
            if farthest <= least {
                break Rest::Converged;
            }
            let before = now.energy.total();
            let Some(part) = self.advance(curve, field, &mut now) else { break Rest::Stagnated };
            self.trace.push(now.energy);
            if farthest * part <= least {
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
        let (dim, h) = (self.space.dim(), self.manner.spacing);
        let parts = curve.len().saturating_sub(1);
        let inner = parts.saturating_sub(1);
        if measured.lengths.len() != parts {
            measured.segments.resize(parts * dim, 0.0);
            measured.lengths.resize(parts, 0.0);
            measured.bends.clear();
            measured.bends.resize((inner + 2) * dim, 0.0);
            measured.gradients.resize(inner * dim, 0.0);
            measured.clearances.resize(inner, 0.0);
        }
        let [mut stretched, mut curled, mut length, mut external] = [0.0; 4];
        let [scale, unscale] = [&self.scale[..dim], &self.unscale[..dim]];
        let segments = measured.segments.chunks_exact_mut(dim).zip(&mut measured.lengths);
        for (pair, (segment, far)) in curve.windows(2).zip(segments) {
            self.space.velocity_into(&pair[0], &pair[1], segment);
            let mut square = 0.0;
            for (x, s) in segment.iter_mut().zip(scale) {
                *x *= s;
                square += *x * *x;
            }
            *far = square.sqrt();
            stretched += square;
            length += *far;
        }
        let outgoing = measured.segments.get(dim..).unwrap_or_default();
        let pairs = measured.segments.chunks_exact(dim).zip(outgoing.chunks_exact(dim));
        let bends = measured.bends.get_mut(dim..).unwrap_or_default().chunks_exact_mut(dim);
        let nodes = curve.iter().skip(1).zip(&mut measured.clearances).zip(bends);
        for (((q, clearance), bend), (push, (incoming, outgoing))) in
            nodes.zip(measured.gradients.chunks_exact_mut(dim).zip(pairs))
        {
            let energy = field.energy(q, push);
            *clearance = field.clearance().unwrap_or(f64::INFINITY);
            external += energy;
            for ((bend, c), g) in bend.iter_mut().zip(incoming).zip(outgoing) {
                *bend = g - c;
                curled += *bend * *bend;
            }
            if energy == 0.0 {
                continue;
            }
            // The part of the push along the curve, the sum of both segments, does not move the curve: it is
            // removed.
            let [mut along, mut part] = [0.0; 2];
            for (((c, g), push), s) in incoming.iter().zip(outgoing).zip(push.iter_mut()).zip(unscale) {
                *push *= s;
                along += (c + g) * (c + g);
                part += *push * (c + g);
            }
            if along > 0.0 {
                part /= along;
                for ((c, g), push) in incoming.iter().zip(outgoing).zip(push) {
                    *push -= part * (c + g);
                }
            }
        }
        let Params { membrane, plate, straighten, .. } = self.params;
        measured.energy.internal = 0.5 * (membrane * stretched / h + plate * curled / (h * h * h));
        measured.energy.optimal = straighten * length;
        measured.energy.external = h * external;
    }

    /// Computes the implicit step of all nodes, from the forces on the curve.
    fn aim(&mut self, measured: &CurveMeasurement) {
        let (dim, parts) = (self.space.dim(), measured.lengths.len());
        let Params { membrane, plate, straighten, .. } = self.params;
        let Manner { spacing: h, pace, smoothing } = self.manner;
        // Forces: β/h³ times the fourth difference, with ends that are free to turn, and the rest.
        let (curl, stretch) = (plate / (h * h * h), membrane / h);
        self.step.resize((parts - 1) * dim, 0.0);
        let pairs = measured.segments.windows(2 * dim).step_by(dim).zip(measured.lengths.windows(2));
        let forces = measured.bends.windows(3 * dim).step_by(dim).zip(measured.gradients.chunks_exact(dim));
        for (step, ((pair, lengths), (bends, push))) in self.step.chunks_exact_mut(dim).zip(pairs.zip(forces))
        {
            let [before, after] =
                [lengths[0], lengths[1]].map(|length| stretch + straighten / length.max(1e-300));
            for k in 0..dim {
                let curl = curl * (bends[k] - 2.0 * bends[k + dim] + bends[k + 2 * dim]);
                let inner = before * pair[k] - after * pair[k + dim] + curl;
                step[k] = -pace * (inner / h + push[k]);
            }
        }
        let rows = parts - 1;
        let [a, b] = self.params.stiffness(self.manner);
        let bands = &mut self.bands[self.used].1;
        if bands.len() <= rows {
            bands.resize(rows + 1, None);
        }
        bands[rows].get_or_insert_with(|| Band::new(rows, a + smoothing, b)).solve(&mut self.step, dim);
    }

    /// Takes the largest part of the step that does not raise the energy. Returns that part, or `None` when
    /// there is none.
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
        let dim = self.space.dim();
        let Self { space, step, velocity, unscale, .. } = self;
        velocity.resize(dim, 0.0);
        out.clear();
        out.extend(curve.first().cloned());
        for (step, q) in step.chunks_exact(dim).zip(&curve[1..]) {
            for ((v, x), s) in velocity.iter_mut().zip(step).zip(unscale.iter()) {
                *v = x * s;
            }
            let moved = space.moved(q, velocity, part).filter(|moved| space.contains(moved));
            out.push(moved.unwrap_or_else(|| q.clone()));
        }
        out.extend(curve.last().cloned());
    }

    /// The number of degrees of freedom.
    pub(crate) fn dim(&self) -> usize {
        self.space.dim()
    }
}

#[inline]
pub(crate) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
