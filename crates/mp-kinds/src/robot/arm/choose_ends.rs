//! Arms alone: the ends of a problem that has none are chosen here.

use super::named::NamedValues;
use super::read::{srdf_help, what};
use super::self_filter::filtered;
use super::{ArmScene, Configuration, slides, within};
use crate::robot::Counted;
use crate::{Error, brief};
use mp_cspace::{Certified, Clearance, Halton, JointRange, Joints, MotionValidity, Rng, Sampler, Space};
use mp_io::{Files, GoalEntry, RobotProblem, StartEntry};
use mp_robot::{Arm, Coordinate};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::atomic::{AtomicU64, Ordering};

impl ArmScene {
    /// The scene of a problem that leaves its start, its goals or both open, and what was chosen, in sentences.
    ///
    /// The start is the free configuration nearest to zero within the limits; the goal has each joint half way from there to
    /// its farther limit, or is a configuration near that to which the straight motion from the start is free.
    ///
    /// # Errors
    /// As [`from_problem`](Self::from_problem), and when no free configuration is found.
    pub fn with_chosen_ends(
        files: &dyn Files,
        mut problem: RobotProblem,
    ) -> Result<(Self, Vec<String>), Error> {
        let named = NamedValues::of(&problem)?;
        let (arm, said, of_ends) = Self::arm_of(files, &mut problem, &named)?;
        let space = arm.space()?;
        let wanted = Configuration::from(arm.kinematics().neutral());
        let none = |problem: &RobotProblem| {
            let message = format!(
                "no configuration was found in which the links do not touch: {}",
                at_zero(&arm, &wanted)
            );
            Error::new(message).help(srdf_help(problem, &[])).context(what(problem))
        };
        let interrupt = files.interrupt();
        // Points that may be on the robot say nothing of where it starts.
        let others = problem.file.obstacles.iter().zip(&problem.obstacles);
        let others = others.filter(|(entry, _)| entry.self_filter.is_none());
        let others = others.map(|(_, o)| (o.name.clone(), o.mesh.clone(), o.pose));
        let search = arm.clone().among_until(others, &interrupt)?.with_interrupt(interrupt.clone());
        let mut chosen = Vec::new();
        let given = problem.file.start.row().len() == arm.dof();
        let start = match given {
            true => space.wrapped(&within(space.ranges(), problem.file.start.row()).into()),
            false if problem.file.start.row().is_empty() => {
                free_near(&search, &space, &wanted).ok_or_else(|| none(&problem))?
            }
            // It is refused below.
            false => wanted.clone(),
        };
        if problem.file.start.row().is_empty() {
            let nearest = match start == wanted {
                true => "",
                false => ", or rather the nearest configuration found at which no links touch",
            };
            let file = problem
                .robots
                .first()
                .and_then(|robot| robot.urdf_file.file_name())
                .map(|name| name.to_string_lossy().into_owned());
            chosen.push(format!(
                "{} is a robot alone. Every joint starts at zero, or at the limit nearest to zero{nearest}",
                file.unwrap_or_default(),
            ));
            problem.file.start = StartEntry::All(start.as_slice().to_vec());
        }
        let (arm, said) = filtered(arm.clone(), &mut problem, &start, said, &interrupt)?;
        let search = arm.clone().with_interrupt(interrupt.clone());
        let open = |goal: &GoalEntry| matches!(goal, GoalEntry::All(values) if values.is_empty());
        if problem.file.goals.iter().any(open) {
            // No farther than half a turn, or the length of the robot: joints may slide or turn without end.
            let most = |joint: &Coordinate| if slides(&arm, &joint.name) { arm.length() } else { PI };
            let most: Vec<f64> = arm.coordinates().iter().map(most).collect();
            let half_way = |((joint, at), &most): ((&Coordinate, &f64), &f64)| match joint.range {
                JointRange::Interval { low, high } if high - at >= at - low => {
                    at + most.min(0.5 * (high - at))
                }
                JointRange::Interval { low, .. } => at - most.min(0.5 * (at - low)),
                JointRange::Circle => at + FRAC_PI_2,
            };
            let far: Vec<f64> = arm.coordinates().iter().zip(start.iter()).zip(&most).map(half_way).collect();
            let far = space.wrapped(&Configuration::from(far));
            let goal = seen_near(&search, &space, [&start, &far], &most);
            // A start that is given may be what is in the way.
            let goal = goal.or_else(|| given.then(|| far.clone())).ok_or_else(|| none(&problem))?;
            chosen.push(format!(
                "the goal is half way from there to the farther limit of each joint{}. A robot problem sets these, and \
                 obstacles: docs/formats/robot-problem.md",
                match goal == far {
                    true => "",
                    false => ", or rather a configuration near that to which the straight motion is free",
                }
            ));
            problem.file.goals = vec![GoalEntry::All(goal.as_slice().to_vec())];
        }
        if interrupt.raised().is_some() {
            return Err(Error::new("the search for free configurations was ended").context(what(&problem)));
        }
        let held = named.beside(&Self::names(&arm));
        let scene = Self::with_ends_of(problem, arm, [said, of_ends], held, &interrupt)?;
        let notes = scene.said().into_iter().chain(chosen).collect();
        Ok((scene, notes))
    }
}

/// How many pairs of links a message names.
const NAMED: usize = 4;

/// Which links touch at `zero`, the deepest first, or else which are nearest to each other.
fn at_zero(arm: &Arm, zero: &Configuration) -> String {
    let mut arm = arm.clone();
    let mut contacts = arm.explain(zero.as_slice());
    contacts.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    let named =
        contacts.iter().take(NAMED).map(|c| format!("{} in {} ({} m deep)", c.link, c.other, brief(c.depth)));
    let more = match contacts.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more pairs"),
    };
    match (contacts.is_empty(), arm.closest(zero.as_slice())) {
        (true, Some(gap)) => format!(
            "with all joints at zero, {} and {} are {} m apart, and at least {} m is needed",
            gap.link,
            gap.other,
            brief(gap.distance),
            brief(arm.tolerance())
        ),
        (true, None) => "a joint has no room".to_owned(),
        _ => format!("with all joints at zero, {}{more}", named.collect::<Vec<_>>().join(", ")),
    }
}

/// How many samples are tried where no free configuration is found near the one that is wanted.
const TRIED: usize = 2_000;

/// How many queries may be spent on a goal that the start sees.
const QUERIES: u64 = 20_000;

/// A configuration near `far` to which the straight motion from `start` is free: the free one nearest to `far`, else the nearest of
/// some samples, of which no joint is farther than `most` (rad or m), else one on the way to `far`. The same every time.
fn seen_near(
    arm: &Arm,
    space: &Joints<Configuration>,
    [start, far]: [&Configuration; 2],
    most: &[f64],
) -> Option<Configuration> {
    let queries = AtomicU64::new(0);
    let mut checker = Counted::new(arm.clone(), &queries).exactly();
    let mut motions = Certified::new(space, checker.clone(), arm.tolerance()).ok()?;
    let margin = 2.0 * arm.tolerance();
    let mut is_seen = |q: &Configuration| {
        checker.clearance(q, margin) >= margin && motions.check_motion(start, q).is_free()
    };
    if let Some(nearest) = arm.clone().nearest_free(far, space, margin)
        && is_seen(&nearest)
    {
        return Some(nearest);
    }
    let (mut halton, mut rng) = (Halton::new(space), Rng::seed(0));
    let mut sample = || {
        let mut q = halton.sample(&mut rng);
        for ((x, from), most) in q.iter_mut().zip(start.iter()).zip(most) {
            *x = x.clamp(from - most, from + most);
        }
        q
    };
    // Half way from there at random, too: what is nearer is seen more often.
    let mut samples: Vec<_> =
        (0..TRIED).map(|i| space.interpolate(start, &sample(), if i % 2 == 0 { 1.0 } else { 0.5 })).collect();
    samples.sort_by(|a, b| space.distance(far, a).total_cmp(&space.distance(far, b)));
    let tried = samples.into_iter().take_while(|_| queries.load(Ordering::Relaxed) < QUERIES);
    let on_the_way = (1..=20).map(|k| space.interpolate(start, far, mp_math::powi(0.5, k)));
    tried.chain(on_the_way).find(|q| is_seen(q))
}

/// The free configuration nearest to `q` that is found: `q` itself, else one of those around it, else the nearest of some
/// thousand samples. The same every time.
fn free_near(arm: &Arm, space: &Joints<Configuration>, q: &Configuration) -> Option<Configuration> {
    let (mut arm, margin) = (arm.clone(), 2.0 * arm.tolerance());
    let near = arm.nearest_free(q, space, margin);
    near.or_else(|| {
        let (mut halton, mut rng) = (Halton::new(space), Rng::seed(0));
        let samples = (0..TRIED).map(|_| halton.sample(&mut rng));
        let free = samples.filter(|p| arm.clearance(p, margin) >= margin);
        free.min_by(|a, b| space.distance(q, a).total_cmp(&space.distance(q, b)))
    })
}
