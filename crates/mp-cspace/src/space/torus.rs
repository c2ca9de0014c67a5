//! Tori: several independent angles.

use super::so2::{angle_at, angle_lerp, arc};
use super::{Factored, Metric, Space, TrueMetric, wrap_angle};
use crate::Rng;
use nalgebra::SVector;
use rand::RngExt;
use std::f64::consts::PI;

/// The torus of `N` angles, each in (-π, π] rad, with the Euclidean norm of the shorter arcs.
///
/// The space of a planar arm with `N` unlimited joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Torus<const N: usize>;

impl<const N: usize> Metric<SVector<f64, N>> for Torus<N> {
    #[inline]
    fn distance(&self, from: &SVector<f64, N>, to: &SVector<f64, N>) -> f64 {
        let mut sum = 0.0;
        for i in 0..N {
            let d = arc(from[i], to[i]);
            sum += d * d;
        }
        sum.sqrt()
    }
}
impl<const N: usize> TrueMetric<SVector<f64, N>> for Torus<N> {}

impl<const N: usize> Space for Torus<N> {
    type State = SVector<f64, N>;

    #[inline]
    fn dim(&self) -> usize {
        N
    }
    #[inline]
    fn extent(&self) -> f64 {
        PI * (N as f64).sqrt()
    }
    #[inline]
    fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State) {
        for i in 0..N {
            out[i] = angle_lerp(from[i], to[i], t);
        }
    }
    #[inline]
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
        SVector::from_fn(|i, _| angle_at(u[i]))
    }
    #[inline]
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
        SVector::from_fn(|_, _| angle_at(rng.random()))
    }
    #[inline]
    fn contains(&self, q: &Self::State) -> bool {
        q.iter().all(|&a| -PI < a && a <= PI)
    }
    #[inline]
    fn moved(&self, from: &Self::State, velocity: &[f64], time: f64) -> Option<Self::State> {
        let turned = |i: usize| wrap_angle(from[i] + velocity[i] * time);
        (velocity.len() == N).then(|| SVector::from_fn(|i, _| turned(i)))
    }
    #[inline]
    fn velocity_into(&self, from: &Self::State, to: &Self::State, out: &mut [f64]) -> bool {
        if out.len() == N {
            (0..N).for_each(|i| out[i] = arc(from[i], to[i]));
        }
        out.len() == N
    }
}

impl<const N: usize> Factored for Torus<N> {
    fn factors(&self) -> usize {
        N
    }
    #[inline]
    fn each_factor(&self, from: &Self::State, to: &Self::State, f: &mut impl FnMut(usize, f64)) {
        for i in 0..N {
            f(i, arc(from[i], to[i]).abs());
        }
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        if factor < N { PI } else { 0.0 }
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Self::State,
        to: &Self::State,
        t: f64,
        out: &mut Self::State,
    ) {
        if factor < N {
            out[factor] = angle_lerp(from[factor], to[factor], t);
        }
    }
}
