//! The pairs of links that are tested against each other.

use super::kinematics::Kinematics;
use super::planar_base::PLANAR_NUMBERS;
use super::robot::LinkBody;
use super::{ArmError, ArmModel, JointKind};
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

/// The frame of the base of the robot, which may stand, float, or move in the plane by the first three joints.
pub(super) fn base_frame(model: &ArmModel, kinematics: &Kinematics) -> usize {
    let last = model.joints.get(PLANAR_NUMBERS.len() - 1).filter(|_| model.has_planar_base());
    let body = last.and_then(|joint| kinematics.attached.iter().find(|link| link.name == joint.child));
    body.map_or(0, |link| link.frame)
}

/// Which links are compared.
#[derive(Debug, Default)]
pub(super) struct Compared {
    /// Pairs that move relative to each other.
    pub(super) pairs: Vec<LinkPair>,
    /// Pairs that do not, for the joints between them are held.
    pub(super) still_pairs: Vec<[usize; 2]>,
    /// Bodies that stand still for joints that are held or have equal limits: they are compared with obstacles all the same.
    pub(super) still_bodies: Vec<usize>,
    /// What is to be said about them.
    pub(super) notes: Vec<String>,
}

/// The tree of a robot as it was described: no joint is held, and limits are its own.
fn described(model: &ArmModel, kinematics: &Kinematics) -> Kinematics {
    let described = model.as_described().and_then(|described| Kinematics::new(&described).ok());
    described.unwrap_or_else(|| kinematics.clone())
}

/// All pairs, except those that never move relative to each other, those that a joint connects, those that may touch, and those that are closer
/// than `close` (m) in every configuration tried. None of this depends on which joints are held, or on limits that the robot was given later.
///
/// A joint connects its two links; a link without a shape stands for the one that it is fixed to. If no pairs are given, links that are fixed to
/// one of them count as part of it. Only those of the base, which may carry walls and tables, are compared with what the joint moves, unless they
/// touch it at the neutral configuration.
pub(super) fn compared(
    kinematics: &Kinematics,
    bodies: &[LinkBody],
    model: &ArmModel,
    close: f64,
    interrupt: &Interrupt,
) -> Result<Compared, ArmError> {
    let free = described(model, kinematics);
    let frame_of = |body: &LinkBody| free.attached[body.link].frame;
    let base = base_frame(model, &free);
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
            let joined = joined(&free, bodies, base, a, b);
            let is_kept = kept.contains(&links);
            let guessed = model.may_touch.is_none();
            let left_out = joined == Joined::Yes || (joined == Joined::Welded && guessed);
            if frame_of(a) != frame_of(b) && (is_kept || !(left_out || allowed.contains(&links))) {
                let beside = joined == Joined::Beside && guessed;
                let fate = if is_kept { Fate::Kept } else { Fate::Close { least: f64::INFINITY, most: 0.0 } };
                let pair = LinkPair { bodies: [i, j], steps: between(&above[i], &above[j]) };
                found.push(Candidate { pair, beside, fate });
            }
        }
    }
    look_at([&free, kinematics], bodies, &mut found, close, &mut interrupt)?;
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
    let (mut pairs, mut still_pairs) = (Vec::new(), Vec::new());
    for Candidate { pair, .. } in found {
        let [a, b] = pair.bodies.map(|i| bodies[i].frame);
        if a == b { still_pairs.push(pair.bodies) } else { pairs.push(pair) }
    }
    let fixed = fixed_links(model, kinematics);
    let stands = |i: &usize| bodies[*i].frame == 0 && !kinematics.floats() && !fixed[bodies[*i].link];
    let still_bodies = (0..bodies.len()).filter(stands).collect();
    Ok(Compared { pairs, still_pairs, still_bodies, notes })
}

/// For each link, whether all joints between the base and it are fixed. Joints whose limits are equal do not count as fixed.
pub(super) fn fixed_links(model: &ArmModel, kinematics: &Kinematics) -> Vec<bool> {
    let mut above = vec![None; kinematics.attached.len()];
    for ([parent, child], joint) in kinematics.joined.iter().zip(&model.joints) {
        above[*child] = Some((*parent, joint.kind == JointKind::Fixed));
    }
    let is_fixed = |mut link: usize| {
        while let Some((parent, true)) = above[link] {
            link = parent;
        }
        above[link].is_none()
    };
    (0..above.len()).map(is_fixed).collect()
}

/// Whether a joint connects two links.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Joined {
    No,
    /// It connects what they are fixed to, which is the base on one side, and not the link of the joint there.
    Beside,
    /// It connects what they are fixed to.
    Welded,
    Yes,
}

pub(super) fn joined(
    kinematics: &Kinematics,
    bodies: &[LinkBody],
    base: usize,
    a: &LinkBody,
    b: &LinkBody,
) -> Joined {
    let frame_of = |link: usize| kinematics.attached[link].frame;
    let moves = |child: &LinkBody, parent: &LinkBody| {
        let child = frame_of(child.link);
        child > 0 && kinematics.frames[child - 1].parent == frame_of(parent.link)
    };
    let (child, parent) = match (moves(a, b), moves(b, a)) {
        (true, _) => (a.link, b.link),
        (_, true) => (b.link, a.link),
        _ => return Joined::No,
    };
    let has_shape = |link: usize| bodies.iter().any(|body| body.link == link);
    let above =
        |link: usize| kinematics.joined.iter().find(|[_, below]| *below == link).map(|[above, _]| *above);
    // Whether nothing with a shape is between the link `top` and `link`, which is fixed to it or the same.
    let stands_for = |top: usize, mut link: usize| {
        while link != top {
            match above(link) {
                Some(next) if next == top || !has_shape(next) => link = next,
                _ => return false,
            }
        }
        true
    };
    let connects =
        |[upper, _]: &&[usize; 2]| *upper == parent || (!has_shape(*upper) && stands_for(parent, *upper));
    let is_between = |[upper, lower]: &&[usize; 2]| {
        frame_of(*upper) == frame_of(parent) && frame_of(*lower) == frame_of(child)
    };
    let joint = kinematics.joined.iter().filter(is_between).find(connects);
    match joint {
        Some([_, lower]) if *lower == child || (!has_shape(*lower) && stands_for(*lower, child)) => {
            Joined::Yes
        }
        None if frame_of(parent) == base => Joined::Beside,
        _ => Joined::Welded,
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

/// Measures the pairs at the neutral configuration of the first tree and at points of the Halton sequence, until they are `close` (m) apart. The
/// same arm always gives the same distances. Bodies are in the frames of the second tree.
fn look_at(
    [kinematics, own]: [&Kinematics; 2],
    bodies: &[LinkBody],
    pairs: &mut [Candidate],
    close: f64,
    interrupt: &mut Interrupt,
) -> Result<(), ArmError> {
    let space: Joints<Configuration> = kinematics.joints()?;
    let (mut halton, mut rng) = (Halton::new(&space), Rng::seed(0));
    let (mut query, mut frames) = (Query::default(), Vec::new());
    let mut q = Configuration::from(kinematics.neutral());
    let places: Vec<_> = bodies
        .iter()
        .map(|body| {
            let [there, here] = [kinematics, own].map(|tree| &tree.attached[body.link]);
            let same = there.pose == here.pose;
            (there.frame, (!same).then(|| there.pose * here.pose.inverse()))
        })
        .collect();
    for i in 0..SAMPLES {
        let mut left = false;
        kinematics.frames_from(&kinematics.base, q.as_slice(), &mut frames);
        for Candidate { pair, beside, fate } in pairs.iter_mut() {
            let Fate::Close { least, most } = *fate else { continue };
            interrupt.go_on()?;
            let [a, b] = pair.bodies.map(|i| &bodies[i].tree);
            let [at_a, at_b] = pair.bodies.map(|i| {
                let (frame, place) = &places[i];
                place.map_or(frames[*frame], |place| frames[*frame] * place)
            });
            let distance = query.clearance(a, &at_a, b, &at_b, close);
            let is_inside =
                distance > 0.0 && (a.is_filled() || b.is_filled()) && query.nested(a, &at_a, b, &at_b);
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
