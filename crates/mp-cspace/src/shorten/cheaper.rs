//! Paths that cost less by an objective.

use super::{Draft, Effort, random, reduced, taut};
use crate::{Factored, MotionValidity, Objective, Path, Rng, Space};
use rand::RngExt;

/// How often edges are halved, so that states between can move.
const HALVINGS: usize = 3;

/// A place of a path moves by at most this part of the length of the piece around it.
const REACH: f64 = 0.5;

/// Lowers what the path costs: leaves out states, takes shortcuts, also of one factor at a time, halves the edges and moves random
/// places of the path; each only where `check` finds the motions free and `objective` finds them cheaper.
///
/// The cost does not increase; the length may. Moving places is what Şucan, Moll and Kavraki 2012, *The Open Motion Planning
/// Library*, call perturbing.
pub fn cheapen<C: Factored>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    objective: &mut impl Objective<C::State>,
    path: &Path<C::State>,
    effort: Effort,
    rng: &mut Rng,
) -> Path<C::State> {
    let mut draft = Draft::of(space, path);
    for round in 0..=HALVINGS {
        draft = reduced(check, objective, draft);
        draft = random::straightened(space, check, objective, draft, effort, rng);
        draft = random::straightened_by_factor(space, check, objective, draft, effort, rng);
        if round < HALVINGS {
            draft = moved(space, check, objective, taut::halved(space, &draft), effort, rng);
        }
    }
    reduced(check, objective, draft).path()
}

/// Moves random places of the path in random directions, wherever that is free and costs less.
fn moved<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    objective: &mut impl Objective<C::State>,
    path: Draft<C::State>,
    effort: Effort,
    rng: &mut Rng,
) -> Draft<C::State> {
    random::improve(space, check, objective, path, effort, rng, |_, _, piece, rng| {
        let (middle, other) = (space.interpolate(&piece.from, &piece.to, 0.5), space.sample_uniform(rng));
        let reach = REACH * (piece.s.1 - piece.s.0) * rng.random::<f64>();
        let part = (reach / space.distance(&middle, &other)).min(1.0);
        vec![piece.from, space.interpolate(&middle, &other, part), piece.to]
    })
}
