//! The pairs of links that are tested against each other.

use super::kinematics::Kinematics;
use super::robot::{LinkBody, are_nested};
use super::{ArmError, ArmModel};
use mp_collide::Query;
use mp_cspace::{Configuration, Halton, Interrupt, Joints, Rng, Sampler};
use std::collections::BTreeSet;

/// Two bodies that must not touch. `steps` is how many joints of each chain are between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinkPair {
    pub(super) bodies: [usize; 2],
    pub(super) steps: [usize; 2],
}

/// In this many configurations pairs are looked at to find those that are always close.
const SAMPLES: usize = 100;

/// All pairs, except those that never move relative to each other, those of two rigid bodies that a joint connects, those that
/// may touch, and those that are closer than `close` (m) in every configuration tried. Also what is to be said about them.
///
/// Links joined by fixed joints are one rigid body. Only of a body that stands still, which may carry walls and tables, the
/// link of the joint alone is meant, or the first one above it with a shape if it has none; its other links are left out if
/// they touch what the joint moves at the neutral configuration and no pairs are given.
pub(super) fn pairs(
    kinematics: &Kinematics,
    bodies: &[LinkBody],
    model: &ArmModel,
    close: f64,
    interrupt: &Interrupt,
) -> Result<(Vec<LinkPair>, Vec<String>), ArmError> {
    let mut interrupt = interrupt.clone();
    let key = |a: usize, b: usize| (a.min(b), a.max(b));
    let mut keys = |pairs: &[(String, String)]| {
        let found = pairs.iter().map(|(first, second)| {
            interrupt.go_on()?;
            let find = |name: &String| {
                kinematics.links().position(|link| link == name).ok_or_else(|| ArmError::UnknownPair {
                    first: first.clone(),
                    second: second.clone(),
                    missing: name.clone(),
                })
            };
            Ok(key(find(first)?, find(second)?))
        });
        found.collect::<Result<BTreeSet<_>, ArmError>>()
    };
    let mut allowed = keys(model.may_touch.as_deref().unwrap_or_default())?;
    allowed.append(&mut keys(&model.may_also_touch)?);
    let kept = keys(&model.kept_apart)?;
    let on = |body: &LinkBody| body.chain.steps.iter().rev().map(|step| step.frame).collect();
    let above: Vec<Vec<usize>> = bodies.iter().map(on).collect();
    let mut found = Vec::new();
    for (j, b) in bodies.iter().enumerate() {
        for (i, a) in bodies.iter().enumerate().take(j) {
            interrupt.go_on()?;
            let links = key(a.link, b.link);
            let joined = joined(kinematics, bodies, a, b);
            let is_kept = kept.contains(&links);
            if a.frame != b.frame && (is_kept || !(joined == Joined::Yes || allowed.contains(&links))) {
                let beside = joined == Joined::Beside && model.may_touch.is_none();
                let fate = if is_kept { Fate::Kept } else { Fate::Close { least: f64::INFINITY, most: 0.0 } };
                let pair = LinkPair { bodies: [i, j], steps: between(&above[i], &above[j]) };
                found.push(Candidate { pair, beside, fate });
            }
        }
    }
    look_at(kinematics, bodies, &mut found, close, &mut interrupt)?;
    let mut notes = Vec::new();
    found.retain(|Candidate { pair, fate, .. }| {
        let why = match *fate {
            Fate::Kept => return true,
            // Given pairs say which links may touch.
            Fate::Close { least: 0.0, .. } if model.may_touch.is_some() => return true,
            Fate::Close { most: 0.0, .. } => return false,
            Fate::Close { most, .. } => format!("they were never farther apart than {most:.1e} m"),
            Fate::TouchAtNeutral => "they touch at the neutral configuration".to_owned(),
        };
        let [a, b] = pair.bodies.map(|i| &kinematics.attached[bodies[i].link].name);
        notes.push(format!("the links \"{a}\" and \"{b}\" are not compared: {why}"));
        false
    });
    Ok((found.into_iter().map(|candidate| candidate.pair).collect(), notes))
}

/// Whether a joint connects the rigid bodies of two links.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Joined {
    No,
    /// One link is fixed to a body that stands still, but is not the link of the joint.
    Beside,
    Yes,
}

pub(super) fn joined(kinematics: &Kinematics, bodies: &[LinkBody], a: &LinkBody, b: &LinkBody) -> Joined {
    let moves = |child: &LinkBody, parent: &LinkBody| {
        child.frame > 0 && kinematics.frames[child.frame - 1].parent == parent.frame
    };
    let (child, parent) = match (moves(a, b), moves(b, a)) {
        (true, _) => (a, b),
        (_, true) => (b, a),
        _ => return Joined::No,
    };
    let frame_of = |link: usize| kinematics.attached[link].frame;
    // A link without a shape stands for the one that it is fixed to.
    let solid = |mut link: usize| {
        while !bodies.iter().any(|body| body.link == link)
            && let Some([above, _]) = kinematics.joined.iter().find(|[_, below]| *below == link)
        {
            link = *above;
        }
        link
    };
    let at_joint = |[above, below]: &[usize; 2]| {
        frame_of(*above) == parent.frame && frame_of(*below) == child.frame && solid(*above) == parent.link
    };
    match parent.frame > 0 || kinematics.floats() || kinematics.joined.iter().any(at_joint) {
        true => Joined::Yes,
        false => Joined::Beside,
    }
}

/// A pair that may be left out.
struct Candidate {
    pair: LinkPair,
    /// Whether it is [`Joined::Beside`], and left out if it touches at the neutral configuration.
    beside: bool,
    fate: Fate,
}

/// What is known of a pair.
enum Fate {
    /// It is compared.
    Kept,
    /// Its least and its largest distance (m) so far: it is close in every configuration looked at.
    Close { least: f64, most: f64 },
    /// It is left out for touching at the neutral configuration.
    TouchAtNeutral,
}

/// For each of two chains, given by the frames of their joints from the base on, the number of joints below the frame where both meet.
fn between(a: &[usize], b: &[usize]) -> [usize; 2] {
    let common = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    [a.len() - common, b.len() - common]
}

/// Measures the pairs at the neutral configuration and at points of the Halton sequence, until they are `close` (m) apart. The same
/// arm always gives the same distances.
fn look_at(
    kinematics: &Kinematics,
    bodies: &[LinkBody],
    pairs: &mut [Candidate],
    close: f64,
    interrupt: &mut Interrupt,
) -> Result<(), ArmError> {
    let space: Joints<Configuration> = kinematics.joints()?;
    let (mut halton, mut rng) = (Halton::new(&space), Rng::seed(0));
    let (mut query, mut frames) = (Query::default(), Vec::new());
    let mut q = Configuration::from(kinematics.neutral());
    for i in 0..SAMPLES {
        let mut left = false;
        kinematics.frames_from(&kinematics.base, q.as_slice(), &mut frames);
        for Candidate { pair, beside, fate } in pairs.iter_mut() {
            let Fate::Close { least, most } = *fate else { continue };
            interrupt.go_on()?;
            let [a, b] = pair.bodies.map(|i| &bodies[i]);
            let distance = query.clearance(&a.tree, &frames[a.frame], &b.tree, &frames[b.frame], close);
            let is_inside = distance > 0.0 && are_nested(&mut query, [a, b], &frames);
            *fate = match if is_inside { 0.0 } else { distance } {
                0.0 if *beside && i == 0 => Fate::TouchAtNeutral,
                d if d < close => Fate::Close { least: least.min(d), most: most.max(d) },
                _ => Fate::Kept,
            };
            left |= matches!(fate, Fate::Close { .. });
        }
        if !left {
            break;
        }
        q = halton.sample(&mut rng);
    }
    Ok(())
}
