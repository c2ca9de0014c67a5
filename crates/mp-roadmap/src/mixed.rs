//! What the generators that look for obstacles have in common: most attempts look, some are uniform.

use crate::settings::length;
use crate::{Candidate, Kind, Steer};
use mp_cspace::{BuildError, LocalPlanner, Parameter, Reversible, Rng, Settings, Space, Step};
use rand::RngExt;

/// How far apart the states of a pair are, and how often none is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixing {
    /// Standard deviation of the distance, in (0, extent of the space].
    pub sigma: Step,
    /// Part of the attempts that are uniform samples instead, in \[0, 1\]: where there is nothing to be near to,
    /// only these find anything.
    pub uniform: f64,
}

impl Mixing {
    pub(crate) fn checked<C: Space>(&self, space: &C) -> Result<(f64, f64), BuildError> {
        Ok((length(&sigma(""), self.sigma, space)?, part(UNIFORM, self.uniform)?))
    }

    pub(crate) fn read(self, settings: &Settings) -> Result<Self, BuildError> {
        Ok(Self {
            sigma: settings.step(SIGMA)?.unwrap_or(self.sigma),
            uniform: settings.number(UNIFORM)?.unwrap_or(self.uniform),
        })
    }
}

const SIGMA: &str = "sigma";
const UNIFORM: &str = "uniform";

pub(crate) const fn sigma(default: &'static str) -> Parameter {
    Parameter {
        name: SIGMA,
        range: "in (0, extent of the space], or with % in (0%, 100%] of the extent",
        default,
        doc: "standard deviation of the distance between the states of a pair",
    }
}

pub(crate) const fn uniform(default: &'static str) -> Parameter {
    Parameter {
        name: UNIFORM,
        range: "in [0, 1]",
        default,
        doc: "part of the attempts that are uniform samples instead",
    }
}

/// `value` if it is in \[0, 1\].
pub(crate) fn part(name: &'static str, value: f64) -> Result<f64, BuildError> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(BuildError::OutOfRange { name, value, range: "in [0, 1]".to_owned() })
}

/// Whether this attempt is to be a uniform sample; if so, and it is free, it goes into `out`.
pub(crate) fn drew_uniform<C, L>(
    probability: f64,
    steer: &mut Steer<'_, C, L>,
    rng: &mut Rng,
    out: &mut Vec<Candidate<C::State, L::Edge>>,
) -> bool
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    let draw = rng.random::<f64>() < probability;
    if draw {
        let q = steer.space().sample_uniform(rng);
        if steer.admits(&q) {
            out.push(Candidate::new(q, Kind::Plain));
        }
    }
    draw
}
