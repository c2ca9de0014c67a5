//! Shortens paths.

use crate::motion::{By, Counting, motions};
use crate::possible::Possible;
use crate::{Error, Robot};
use mp_cspace::erased::{AnyCheck, AnySpace};
use mp_cspace::shorten::{Effort, loosen, reduce, shortcut, simplified, simplify};
use mp_cspace::{Configuration, Interrupt, Length, MotionCheck, MotionValidity, Path, Rng};
use std::collections::HashMap;
use std::sync::atomic::AtomicU64;

/// The stream of random numbers for shortening. Planning uses another one.
const STREAM: u64 = 1;

/// In passages too narrow for the clearance of shortcuts they keep this part of it.
const NARROW: f64 = 0.1;

/// Where a path leads through narrow passages, plain shortcuts are tried too. Their path replaces the one that keeps more clearance elsewhere
/// only if it is shorter than this part of its length.
const FAR_SHORTER: f64 = 0.8;

/// Motions of robots that are sampled are tested at a resolution this many times finer than that of planning: the coarser it is, the deeper
/// short paths dip into what they graze.
const FINER: f64 = 4.0;

/// Shortens a path. Every edge of the result keeps the [clearance of shortcuts](crate::Motion::shortcut_clearance), or leads through a
/// passage where the given path does not keep it: there they keep a tenth of it, or are edges of the given path; so does all of it where the
/// way is far shorter then. The same seed gives the same path, unless `interrupt` ends it early: then the path is what it is after the last
/// change.
///
/// The motions of a robot that is sampled are tested at fewer states than its verifier tests. In the end the verifier tests the path, which is made
/// [looser](loosen) where it is refused. If that does not help, the given path is shortened once more, and the verifier tests each motion of it: that
/// takes many times as many states.
///
/// Returns the path, and whether the verifier has found each of its edges free.
///
/// # Errors
/// When the tolerance of the robot is not valid.
pub fn shorten(
    kind: &dyn Robot,
    path: &Path<Configuration>,
    seed: u64,
    interrupt: &Interrupt,
) -> Result<(Path<Configuration>, bool), Error> {
    let _span = tracing::info_span!("shorten").entered();
    let mut rng = Rng::stream(seed, STREAM);
    match kind.sampled() {
        Some(resolution) => shorten_by_samples(kind, path, resolution, &mut rng, interrupt),
        None => Ok((shorten_by_certificates(kind, path, &mut rng, interrupt)?, false)),
    }
}

fn shorten_by_samples(
    kind: &dyn Robot,
    path: &Path<Configuration>,
    resolution: Length,
    rng: &mut Rng,
    interrupt: &Interrupt,
) -> Result<(Path<Configuration>, bool), Error> {
    let (factors, unused) = (kind.any_space(), AtomicU64::new(0));
    let (space, counting) = (AnySpace::new(&factors), Counting::new(&unused, interrupt.clone()));
    let resolution = resolution.resolution_in(&factors)?;
    let samples = |resolution| motions(kind, &space, By::States(Length::Absolute(resolution)), &counting);
    let verifier = || Ok::<_, Error>(Box::new(kind.any_verifier()?));
    let each = || Ok::<_, Error>(Box::new(Both { check: samples(resolution)?, verifier: verifier()? }));
    let mut check = possible(kind, interrupt, each()?);
    if let Some(short) = kind.shortened(path, &mut check, kind.effort(), rng) {
        return Ok((short, false));
    }
    // A path pulled taut is hardly shorter here, and the verifier refuses one in ten of them even when it is loose.
    let effort = Effort { taut: 0, ..kind.effort() };
    let fine = resolution / FINER;
    let mut verifier = possible(kind, interrupt, verifier()?);
    for mut check in [possible(kind, interrupt, samples(fine)?), check] {
        let draft = simplified(&factors, &mut check, path, effort, rng);
        if let Some(loose) = loosen(&factors, &mut verifier, path, &draft, fine / 2.0) {
            return Ok((loose, true));
        }
        if verifier.is_interrupted() {
            return Ok((draft.path(), false));
        }
    }
    tracing::info!("the verifier refuses each shorter path");
    Ok((path.clone(), false))
}

fn shorten_by_certificates(
    kind: &dyn Robot,
    path: &Path<Configuration>,
    rng: &mut Rng,
    interrupt: &Interrupt,
) -> Result<Path<Configuration>, Error> {
    let (space, unused) = (AnySpace::new(&kind.any_space()), AtomicU64::new(0));
    let counting = Counting::new(&unused, interrupt.clone());
    let wide = kind.shortcut_clearance();
    let narrow = (NARROW * wide).max(kind.tolerance());
    // A clearance that was asked for is enough.
    let has_wide = kind.kept() == 0.0;
    let tolerance = if has_wide { wide } else { narrow };
    let certified = |tolerance| motions(kind, &space, By::Certificates(tolerance), &counting);
    let mut check = possible(kind, interrupt, certified(tolerance)?);
    let effort = kind.effort();
    if let Some(short) = kind.shortened(path, &mut check, effort, rng) {
        return Ok(short);
    }
    let factors = kind.any_space();
    let draft = simplified(&factors, &mut check, path, effort, rng);
    let known = draft.free.clone();
    let short = draft.path();
    if !has_wide {
        return Ok(short);
    }
    let edges = short.states.windows(2).zip(known);
    let roomy: Vec<bool> =
        edges.map(|(w, known)| known || check.check_motion(&w[0], &w[1]).is_free()).collect();
    if roomy.iter().all(|roomy| *roomy) {
        return Ok(short);
    }
    let mut narrow = possible(kind, interrupt, certified(narrow)?);
    let mut states: Vec<Configuration> = short.states.first().cloned().into_iter().collect();
    let mut first = 0;
    for passage in roomy.chunk_by(|a, b| a == b) {
        let edges = &short.states[first..=first + passage.len()];
        first += passage.len();
        match passage[0] || passage.len() == 1 {
            true => states.extend_from_slice(&edges[1..]),
            false => {
                let part = simplify(&factors, &mut narrow, &Path::straight(edges.to_vec()), effort, rng);
                states.extend(part.states.into_iter().skip(1));
            }
        }
    }
    let short = Path::straight(states);
    // There are passages where little is kept: a far shorter way may lead through others.
    let other = reduce(&factors, &mut narrow, &short);
    let other = shortcut(&factors, &mut narrow, &other, effort, rng);
    let is_far_shorter = other.length(&space) < FAR_SHORTER * short.length(&space);
    Ok(if is_far_shorter { simplify(&factors, &mut narrow, &other, effort, rng) } else { short })
}

/// `check`, which finds no motion free that the robot cannot make, and is asked for each motion once.
fn possible<'k>(
    kind: &'k dyn Robot,
    interrupt: &Interrupt,
    check: AnyCheck<'k, Configuration>,
) -> AnyCheck<'k, Configuration> {
    let check = Box::new(Remembered { check, known: HashMap::new() });
    Box::new(Possible { kind, check, interrupt: interrupt.clone(), deadlines: None })
}

/// A sampled check, and the verifier of what it finds free.
struct Both<'a> {
    check: AnyCheck<'a, Configuration>,
    verifier: AnyCheck<'a, Configuration>,
}

impl MotionValidity<Configuration> for Both<'_> {
    fn check_motion(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        match self.check.check_motion(from, to) {
            MotionCheck::Free { .. } => self.verifier.check_motion(from, to),
            hit => hit,
        }
    }
}

/// A check that remembers its answers. A third of the motions that shortening asks about were asked about before, and a robot of one's own
/// may take long to answer.
struct Remembered<'a> {
    check: AnyCheck<'a, Configuration>,
    /// By the bits of both ends.
    known: HashMap<Box<[u64]>, MotionCheck>,
}

impl MotionValidity<Configuration> for Remembered<'_> {
    fn check_motion(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        let key: Box<[u64]> = from.iter().chain(to.iter()).map(|x| x.to_bits()).collect();
        *self.known.entry(key).or_insert_with(|| self.check.check_motion(from, to))
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.check.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.check.is_interrupted()
    }
}
