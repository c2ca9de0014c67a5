//! Shortens paths.

use crate::motion::{AnyChecker, By, Counting, motions, motions_of};
use crate::possible::Possible;
use crate::{Error, ObjectiveName, Robot, VERIFIED_FINER};
use mp_cspace::erased::{AnyCheck, AnySpace};
use mp_cspace::shorten::{
    Draft, Effort, bypass, cheapen, loosen, reduce, shortcut, simplified, simplified_by_samples, simplify,
};
use mp_cspace::{
    CoarseToFine, Configuration, Interrupt, Length, MotionCheck, MotionClearance, MotionValidity, Objective,
    Path, Rng, Space,
};
use std::collections::HashMap;
use std::sync::atomic::AtomicU64;

/// The stream of random numbers for shortening. Planning uses another one.
const STREAM: u64 = 1;

/// In passages too narrow for the clearance of shortcuts they keep this part of it.
const NARROW: f64 = 0.1;

/// Where a path leads through narrow passages, plain shortcuts are tried too. Their path replaces the one that keeps more clearance elsewhere
/// only if it is shorter than this part of its length.
const FAR_SHORTER: f64 = 0.8;

/// How far points of a robot that tests many states at once travel between two of these while its path is made short, as a multiple of the
/// clearance of shortcuts.
const SPACING: f64 = 25.0;

/// Which part of the clearance of shortcuts the parts of such a robot keep from each other.
const OWN: f64 = 0.25;

/// How far states of such a path are moved back first where a certificate refuses an edge, as a part of the extent of the space.
const LOOSENED: f64 = 5e-4;

/// Motions of robots that are sampled are tested at every 16th of the states that the verifier tests, somewhat finer than while planning: the coarser
/// that is, the deeper short paths dip into what they graze.
const LEVEL: u32 = 4;

/// How far states of such a path are moved back first where a finer test refuses an edge, as a part of the resolution.
const FIRST_MOVE: f64 = 0.125;

/// Shortens a path. Every edge of the result keeps half of the [clearance of shortcuts](crate::Motion::shortcut_clearance), or leads through a
/// passage where the given path does not keep it: there they keep a twentieth of it, or are edges of the given path; so does all of it where the
/// way is far shorter then. The same seed gives the same path, unless `interrupt` ends it early: then the path is what it is after the last
/// change.
///
/// Robots that test many states at once are tested at a few states of each motion while the path is made short, for all of that clearance from
/// obstacles. Only the motions of the short path are certified, and made [looser](loosen) where that fails.
///
/// The motions of a robot that is sampled are tested at [few](simplified_by_samples) of the states that its verifier tests. Then the path is tested at
/// twice as many, four and eight times, and in the end by the verifier at all of them, and made [looser](loosen) where it is refused, or [led round](bypass) what it hits. If that
/// does not help, the given path is shortened once more, and the verifier tests each motion of it: that takes many times as many states.
///
/// Where the objective is not the length, the given path and the one made shorter are both made [cheaper](cheapen), by shortcuts that keep the clearance
/// of shortcuts, or leave a passage as it is; the cheapest of the four is returned. Of a robot that moves by inputs it is one of the two.
///
/// Returns the path, and whether the verifier has found each of its edges free.
///
/// # Errors
/// When the tolerance of the robot is not valid.
pub fn shorten(
    kind: &dyn Robot,
    path: &Path<Configuration>,
    seed: u64,
    objective: ObjectiveName,
    interrupt: &Interrupt,
) -> Result<(Path<Configuration>, bool), Error> {
    let _span = tracing::info_span!("shorten").entered();
    let mut rng = Rng::stream(seed, STREAM);
    if let Some(resolution) = kind.sampled() {
        return shorten_by_samples(kind, path, resolution, &mut rng, interrupt);
    }
    let short = shorten_by_certificates(kind, path, &mut rng, interrupt)?;
    let path = match objective {
        ObjectiveName::Length => short,
        _ => cheaper(kind, [&short, path], objective, &mut rng, interrupt)?,
    };
    Ok((path, false))
}

/// The cheapest of some paths, after each was made cheaper, the cheaper one first.
fn cheaper(
    kind: &dyn Robot,
    mut paths: [&Path<Configuration>; 2],
    objective: ObjectiveName,
    rng: &mut Rng,
    interrupt: &Interrupt,
) -> Result<Path<Configuration>, Error> {
    let (factors, unused) = (kind.any_space(), AtomicU64::new(0));
    let space = AnySpace::new(&factors);
    let counting = Counting::new(&unused, interrupt.clone());
    let by = By::Certificates(kept_by_shortcuts(kind)[0]);
    let mut check = possible(kind, interrupt, motions(kind, &space, by, &counting)?);
    // It goes on to answer when the work is interrupted: what it says decides.
    let mut objective = objective.make(kind, &space, &Counting::new(&unused, Interrupt::never()))?;
    let mut known = HashMap::new();
    let mut cost = |from: &Configuration, to: &Configuration| {
        let priced = || objective.as_mut().map_or_else(|| space.distance(from, to), |o| o.cost(from, to));
        *known.entry(bits(from, to)).or_insert_with(priced)
    };
    if cost.path_cost(paths[1]) < cost.path_cost(paths[0]) {
        paths.swap(0, 1);
    }
    // What moves by inputs cannot make a part of a motion, or another one, as it likes.
    let made: Vec<_> = match kind.input_system() {
        Some(_) => Vec::new(),
        None => paths.map(|path| cheapen(&factors, &mut check, &mut cost, path, kind.effort(), rng)).into(),
    };
    let mut best = (f64::INFINITY, paths[0]);
    for path in made.iter().chain(paths) {
        let cost = cost.path_cost(path);
        if cost < best.0 {
            best = (cost, path);
        }
    }
    Ok(best.1.clone())
}

/// The clearances (m) that shortcuts keep where there is room, and in passages.
fn kept_by_shortcuts(kind: &dyn Robot) -> [f64; 2] {
    let wide = kind.shortcut_clearance();
    let least = (NARROW * wide).max(kind.tolerance());
    // A clearance that was asked for is enough.
    [if kind.kept() == 0.0 { wide } else { least }, least]
}

/// How many pieces a path of average length is cut into where it may be joined to others.
const PIECES: f64 = 64.0;

/// The cheapest way over pieces of several paths and free motions between them, which keep half of the clearance of shortcuts. `None` for a
/// robot that moves by inputs, which cannot go over from one path to another.
///
/// # Errors
/// When the tolerance of the robot is not valid.
pub fn hybridized(
    kind: &dyn Robot,
    paths: &[Path<Configuration>],
    objective: ObjectiveName,
    interrupt: &Interrupt,
) -> Result<Option<Path<Configuration>>, Error> {
    if kind.input_system().is_some() {
        return Ok(None);
    }
    let (space, unused) = (AnySpace::new(&kind.any_space()), AtomicU64::new(0));
    let by = match kind.sampled() {
        Some(resolution) => By::States(resolution),
        None => By::Certificates(kept_by_shortcuts(kind)[0]),
    };
    let counting = Counting::new(&unused, interrupt.clone());
    let mut check = possible(kind, interrupt, motions(kind, &space, by, &counting)?);
    let mut objective = objective.make(kind, &space, &Counting::new(&unused, Interrupt::never()))?;
    let mut cost = |from: &Configuration, to: &Configuration| match &mut objective {
        Some(objective) => objective.cost(from, to),
        None => space.distance(from, to),
    };
    let mean = paths.iter().map(|path| path.length(&space)).sum::<f64>() / paths.len() as f64;
    Ok(mp_cspace::shorten::hybridized(&space, &mut check, &mut cost, paths, mean / PIECES))
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
    let verifier = || Ok::<_, Error>(possible(kind, interrupt, Box::new(kind.any_verifier()?)));
    let samples = motions(kind, &space, By::States(Length::Absolute(resolution)), &counting)?;
    let mut both = possible(kind, interrupt, Box::new(Both { check: samples, verifier: verifier()? }));
    if let Some(short) = kind.shortened(path, &mut both, kind.effort(), rng) {
        return Ok((short, false));
    }
    // With more patience and more rounds paths are hardly shorter here.
    let effort = kind.effort();
    let effort = Effort { patience: effort.patience / 2, rounds: effort.rounds.min(1), ..effort };
    let mut whole = verifier()?;
    for proves in [false, false, true] {
        let mut each = verifier()?;
        let also = move |from: &Configuration, to: &Configuration| {
            kind.can_move(from, to) && (!proves || each.check_motion(from, to).is_free())
        };
        let step = Length::Absolute(resolution / VERIFIED_FINER);
        let mut check = CoarseToFine::new(&factors, counting.of(kind.any_checker()), step, LEVEL)?.and(also);
        check.interrupt_by(interrupt);
        let mut draft = simplified_by_samples(&factors, &mut check, path, resolution, effort, rng);
        let free = (0..LEVEL).rev().all(|level| {
            check.set_level(level);
            let finer: &mut dyn MotionValidity<_> = if level == 0 { &mut whole } else { &mut check };
            let (loose, refused) = loosen(&factors, &mut &mut *finer, path, &draft, FIRST_MOVE * resolution);
            draft.states = loose.states;
            bypass(&factors, &mut &mut *finer, &mut draft, &refused, resolution, rng)
        });
        if free || whole.is_interrupted() {
            return Ok((draft.path(), free));
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
    let [tolerance, least] = kept_by_shortcuts(kind);
    let has_wide = kind.kept() == 0.0;
    let certified = |tolerance| motions(kind, &space, By::Certificates(tolerance), &counting);
    let mut check = possible(kind, interrupt, certified(tolerance)?);
    let effort = kind.effort();
    if let Some(short) = kind.shortened(path, &mut check, effort, rng) {
        return Ok(short);
    }
    let factors = kind.any_space();
    let mut narrow = possible(kind, interrupt, certified(least)?);
    let spaced = spaced(kind, tolerance, &|checker, by| {
        Ok(possible(kind, interrupt, motions_of(checker, kind, &space, by, &counting)?))
    })?;
    let by_spaces = spaced.and_then(|[mut spaced, mut check]| {
        let draft = simplified(&factors, &mut spaced, path, effort, rng);
        certified_part_by_part(&factors, [&mut check, &mut narrow], path, &draft)
    });
    let (short, roomy) = by_spaces.unwrap_or_else(|| {
        let draft = simplified(&factors, &mut check, path, effort, rng);
        let edges = draft.states.windows(2).zip(&draft.free);
        let roomy = edges.map(|(w, known)| *known || check.check_motion(&w[0], &w[1]).is_free()).collect();
        (draft.path(), roomy)
    });
    if !has_wide {
        return Ok(short);
    }
    if roomy.iter().all(|roomy| *roomy) {
        return Ok(short);
    }
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

/// For robots that test many states at once, checks made by `make`: one that tests a few states of a motion for the clearance `wide` (m) from
/// obstacles, and one that certifies half of it. Parts of the robot need a [quarter](OWN) from each other: some never have more than half.
fn spaced<'c>(
    kind: &dyn Robot,
    wide: f64,
    make: &dyn Fn(AnyChecker, By) -> Result<AnyCheck<'c, Configuration>, Error>,
) -> Result<Option<[AnyCheck<'c, Configuration>; 2]>, Error> {
    if kind.any_checker().intervals_at_once() == 1 {
        return Ok(None);
    }
    let own = OWN * wide;
    let keeping = |kept: f64| kind.any_checker_keeping(kind.kept() + kept);
    let (Some(testing), Some(certifying)) = (keeping(wide - own), keeping(0.5 * (wide - own))) else {
        return Ok(None);
    };
    let spaces = By::Spaces { clearance: own, step: SPACING * wide };
    Ok(Some([make(testing, spaces)?, make(certifying, By::Certificates(own))?]))
}

/// Makes certified what a sampled check found free: each part of the `draft` between edges of the `given` path is [loosened](loosen) until `check`
/// finds it free, or `narrow` those of its edges that are left. Returns the path, and of each edge whether `check` finds it free; `None` where
/// `narrow` does not find an edge free.
fn certified_part_by_part(
    space: &impl Space<State = Configuration>,
    [check, narrow]: [&mut AnyCheck<'_, Configuration>; 2],
    given: &Path<Configuration>,
    draft: &Draft<Configuration>,
) -> Option<(Path<Configuration>, Vec<bool>)> {
    let step = LOOSENED * space.extent();
    let mut states: Vec<Configuration> = draft.states.first().cloned().into_iter().collect();
    let mut roomy = Vec::new();
    let mut first = 0;
    for part in draft.free.chunk_by(|a, b| a == b) {
        let (edges, ends) = (first..first + part.len(), first..first + part.len() + 1);
        first += part.len();
        let part = Draft {
            states: draft.states[ends.clone()].to_vec(),
            free: part.to_vec(),
            origin: draft.origin[ends].to_vec(),
        };
        if !part.free[0] {
            roomy.extend(edges.map(|i| check.check_motion(&draft.states[i], &draft.states[i + 1]).is_free()));
            states.extend(part.states.into_iter().skip(1));
            continue;
        }
        let (loose, refused) = loosen(space, check, given, &part, step);
        let is_free = |i: &usize| narrow.check_motion(&loose.states[*i], &loose.states[i + 1]).is_free();
        if !refused.iter().all(is_free) {
            return None;
        }
        roomy.extend((0..edges.len()).map(|i| !refused.contains(&i)));
        states.extend(loose.states.into_iter().skip(1));
    }
    Some((Path::straight(states), roomy))
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

/// A motion as a key.
fn bits(from: &Configuration, to: &Configuration) -> Box<[u64]> {
    from.iter().chain(to.iter()).map(|x| x.to_bits()).collect()
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
        *self.known.entry(bits(from, to)).or_insert_with(|| self.check.check_motion(from, to))
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.check.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.check.is_interrupted()
    }
}
