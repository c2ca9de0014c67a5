//! The space of the states of a robot that moves by inputs.

use super::ROUND_UP;
use super::drivable::Drivable;
use super::system::{Parts, System};
use crate::numbers::rounding;
use mp_cspace::erased::AnyFactored;
use mp_cspace::nn::Layout;
use mp_cspace::{Configuration, Embed, Factored, Rng, Space};
use rand::RngExt;
use std::sync::Arc;

/// The states of a robot that moves by inputs. Its interpolation follows the input that led to a state.
///
/// Distance: that of the configurations; with velocities, the square root of the sum of its square and that of the distance of
/// the velocities, which are weighted so that their extent is that of the configurations.
#[derive(Clone, Debug)]
pub struct DrivenSpace {
    robot: Arc<dyn Drivable>,
    pub(super) system: Arc<System>,
    /// Seconds: what a velocity counts as a distance.
    pub(super) weight: f64,
}

impl DrivenSpace {
    pub(super) fn new(robot: Arc<dyn Drivable>, system: System) -> Self {
        let across = 2.0 * system.velocity_limits().iter().map(|v| v * v).sum::<f64>().sqrt();
        let weight = if across > 0.0 { robot.any_space().extent() / across } else { 0.0 };
        Self { robot, system: Arc::new(system), weight }
    }

    /// The space of the configurations of the robot, without what drives it.
    pub(super) fn positions(&self) -> AnyFactored<'_, Configuration> {
        self.robot.any_space()
    }

    pub(super) fn parts(&self, q: &Configuration) -> Option<Parts> {
        self.system.parts(q)
    }

    /// How far the state `to` is from where its input leads from `from`; infinite when it has no input, or one beyond its limits.
    pub(super) fn off_course(&self, from: &Parts, to: &Parts) -> f64 {
        let held = to.duration > 0.0 && to.duration <= self.system.duration * ROUND_UP;
        if !(held && self.system.allows(&to.input)) {
            return f64::INFINITY;
        }
        self.apart(&self.system.flow(&self.positions(), from, &to.input, to.duration), to)
    }

    pub(super) fn apart(&self, from: &Parts, to: &Parts) -> f64 {
        self.between((&from.q, &from.velocity), (&to.q, &to.velocity))
    }

    /// The distance of two configurations with their velocities.
    fn between(&self, from: (&Configuration, &[f64]), to: (&Configuration, &[f64])) -> f64 {
        let of_position = self.positions().distance(from.0, to.0);
        if from.1.is_empty() {
            of_position
        } else {
            let of_velocity = from.1.iter().zip(to.1).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            mp_math::hypot(of_position, self.weight * of_velocity.sqrt())
        }
    }

    /// Whether the input of `to` leads there from `from`.
    pub(super) fn follows(&self, from: &Parts, to: &Parts) -> bool {
        self.off_course(from, to) <= rounding(self.extent())
    }

    pub(super) fn at_rest(&self, q: Configuration) -> Parts {
        let system = &self.system;
        Parts { q, velocity: vec![0.0; system.velocities], input: vec![0.0; system.inputs], duration: 0.0 }
    }
}

impl Space for DrivenSpace {
    type State = Configuration;

    fn distance(&self, from: &Configuration, to: &Configuration) -> f64 {
        // Asked for each node that may be the nearest: without what else a state has.
        match (self.system.split(from), self.system.split(to)) {
            (Some((from, v, _)), Some((to, w, _))) => self.between((&from, v), (&to, w)),
            _ => f64::INFINITY,
        }
    }
    fn dim(&self) -> usize {
        self.positions().dim() + self.system.velocities
    }
    fn extent(&self) -> f64 {
        let extent = self.positions().extent();
        if self.system.velocities == 0 { extent } else { mp_math::hypot(extent, extent) }
    }
    fn interpolate_into(&self, from: &Configuration, to: &Configuration, t: f64, out: &mut Configuration) {
        let ends = [from, to].map(|q| self.parts(q));
        *out = match ends {
            _ if t <= 0.0 || from == to => from.clone(),
            _ if t >= 1.0 => to.clone(),
            [Some(a), Some(b)] if self.follows(&a, &b) => {
                self.system.vector(&self.system.flow(&self.positions(), &a, &b.input, t * b.duration))
            }
            [Some(a), Some(b)] => {
                let mut straight = self.at_rest(self.positions().interpolate(&a.q, &b.q, t));
                let between = a.velocity.iter().zip(&b.velocity).map(|(v, w)| v + (w - v) * t);
                straight.velocity = between.collect();
                self.system.vector(&straight)
            }
            _ => {
                if t < 0.5 {
                    from.clone()
                } else {
                    to.clone()
                }
            }
        };
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> Configuration {
        let n = self.positions().dim();
        let mut state = self.at_rest(self.positions().unit_cube_to_state(&u[..n]));
        let limits = self.system.velocity_limits();
        state.velocity = limits.iter().zip(&u[n..]).map(|(limit, u)| limit * (2.0 * u - 1.0)).collect();
        self.system.vector(&state)
    }
    fn sample_uniform(&self, rng: &mut Rng) -> Configuration {
        let mut state = self.at_rest(self.positions().sample_uniform(rng));
        let limits = self.system.velocity_limits();
        state.velocity = limits.iter().map(|limit| limit * (2.0 * rng.random::<f64>() - 1.0)).collect();
        self.system.vector(&state)
    }
    fn contains(&self, q: &Configuration) -> bool {
        let Some(parts) = self.parts(q) else { return false };
        let slow = |(v, limit): (&f64, &f64)| v.abs() <= limit * ROUND_UP;
        self.positions().contains(&parts.q)
            && parts.velocity.iter().zip(self.system.velocity_limits()).all(slow)
            && parts.input.iter().chain([&parts.duration]).all(|x| x.is_finite())
    }
}

/// Factors: those of the configurations, then the velocities.
impl Factored for DrivenSpace {
    fn factors(&self) -> usize {
        self.positions().factors() + self.system.velocities
    }
    fn each_factor(&self, from: &Configuration, to: &Configuration, f: &mut impl FnMut(usize, f64)) {
        let [Some(from), Some(to)] = [from, to].map(|q| self.parts(q)) else { return };
        self.positions().each_factor(&from.q, &to.q, f);
        let first = self.positions().factors();
        for (i, (a, b)) in from.velocity.iter().zip(&to.velocity).enumerate() {
            f(first + i, (b - a).abs());
        }
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        match factor.checked_sub(self.positions().factors()) {
            None => self.positions().factor_extent(factor),
            Some(i) => self.system.velocity_limits().get(i).map_or(0.0, |limit| 2.0 * limit),
        }
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Configuration,
        to: &Configuration,
        t: f64,
        out: &mut Configuration,
    ) {
        let [Some(from), Some(to), Some(mut q)] = [from, to, &*out].map(|q| self.parts(q)) else { return };
        match factor.checked_sub(self.positions().factors()) {
            None => self.positions().interpolate_factor(factor, &from.q, &to.q, t, &mut q.q),
            Some(i) => {
                if let (Some(v), Some(a), Some(b)) =
                    (q.velocity.get_mut(i), from.velocity.get(i), to.velocity.get(i))
                {
                    *v = a + (b - a) * t;
                }
            }
        }
        *out = self.system.vector(&q);
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        let velocities = std::iter::repeat_n(Layout::euclidean(1), self.system.velocities);
        self.positions().factor_layouts().into_iter().chain(velocities).collect()
    }
    fn embed_factors(&self, state: &Configuration, put: &mut impl FnMut(usize, f64)) {
        let Some((q, velocity, _)) = self.system.split(state) else { return };
        self.positions().embed_factors(&q, put);
        let first = self.positions().factors();
        velocity.iter().enumerate().for_each(|(i, v)| put(first + i, *v));
    }
}

impl Embed for DrivenSpace {
    fn layout(&self) -> Layout {
        match self.system.velocities {
            0 => self.robot.layout(),
            n => self.robot.layout().beside(Layout::euclidean(n)),
        }
    }
    fn embed(&self, state: &Configuration, out: &mut [f64]) -> usize {
        let Some((q, velocity, _)) = self.system.split(state) else { return self.layout().dim() };
        let n = self.robot.embed(&q, out);
        velocity.iter().zip(&mut out[n..]).for_each(|(v, x)| *x = self.weight * v);
        n + velocity.len()
    }
}
