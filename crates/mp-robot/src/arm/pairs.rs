//! The pairs of links that are tested against each other.

use super::kinematics::Kinematics;
use super::robot::LinkBody;
use super::{ArmError, ArmModel};
use mp_collide::Query;
use mp_cspace::{Halton, Interrupt, Joints, Rng, Sampler};
use nalgebra::DVector;
use std::collections::BTreeSet;

/// Two bodies that must not touch. `steps` is how many joints of each chain are between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinkPair {
    pub(super) bodies: [usize; 2],
    pub(super) steps: [usize; 2],
}

/// A pair that touches in this many configurations is taken for one that always touches.
const SAMPLES: usize = 100;

/// All pairs, except those that never move relative to each other, those joined by a joint, and those that may touch.
pub(super) fn pairs(
    kinematics: &Kinematics,
    bodies: &[LinkBody],
    model: &ArmModel,
    interrupt: &Interrupt,
) -> Result<Vec<LinkPair>, ArmError> {
    let mut interrupt = interrupt.clone();
    let key = |a: usize, b: usize| (a.min(b), a.max(b));
    let mut allowed: BTreeSet<_> = kinematics.joined.iter().map(|[a, b]| key(*a, *b)).collect();
    for (first, second) in model.may_touch.iter().flatten() {
        interrupt.go_on()?;
        let find = |name: &String| {
            kinematics.links().position(|link| link == name).ok_or_else(|| ArmError::UnknownPair {
                first: first.clone(),
                second: second.clone(),
                missing: name.clone(),
            })
        };
        allowed.insert(key(find(first)?, find(second)?));
    }
    let on = |body: &LinkBody| body.chain.steps.iter().rev().map(|step| step.frame).collect();
    let above: Vec<Vec<usize>> = bodies.iter().map(on).collect();
    let mut out = Vec::new();
    for (j, b) in bodies.iter().enumerate() {
        for (i, a) in bodies.iter().enumerate().take(j) {
            interrupt.go_on()?;
            if a.frame != b.frame && !allowed.contains(&key(a.link, b.link)) {
                out.push(LinkPair { bodies: [i, j], steps: between(&above[i], &above[j]) });
            }
        }
    }
    if model.may_touch.is_none() {
        leave_out_what_always_touches(kinematics, bodies, &mut out, &mut interrupt)?;
    }
    Ok(out)
}

/// For each of two chains, given by the frames of their joints from the base on, the number of joints below the frame where both meet.
fn between(a: &[usize], b: &[usize]) -> [usize; 2] {
    let common = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    [a.len() - common, b.len() - common]
}

/// Removes the pairs that touch at the neutral configuration and at points of the Halton sequence. The same arm always
/// gives the same pairs.
fn leave_out_what_always_touches(
    kinematics: &Kinematics,
    bodies: &[LinkBody],
    pairs: &mut Vec<LinkPair>,
    interrupt: &mut Interrupt,
) -> Result<(), ArmError> {
    let space: Joints<DVector<f64>> = kinematics.joints()?;
    let (mut halton, mut rng) = (Halton::new(&space), Rng::seed(0));
    let (mut query, mut frames) = (Query::default(), Vec::new());
    let mut always = vec![true; pairs.len()];
    let mut q = DVector::from(kinematics.neutral());
    for _ in 0..SAMPLES {
        if !always.contains(&true) {
            break;
        }
        kinematics.frames_from(&kinematics.base, q.as_slice(), &mut frames);
        for (pair, always) in pairs.iter().zip(&mut always) {
            interrupt.go_on()?;
            let [a, b] = pair.bodies.map(|i| &bodies[i]);
            *always = *always && query.intersects(&a.tree, &frames[a.frame], &b.tree, &frames[b.frame]);
        }
        q = halton.sample(&mut rng);
    }
    let mut always = always.into_iter();
    pairs.retain(|_| !always.next().unwrap_or(false));
    Ok(())
}
