//! Goals that are places of a link: the configurations that reach them.

use crate::{Error, Interrupt, brief, count};
use mp_cspace::{Clearance, Configuration, Joints, Space};
use mp_geom::pose_from_six;
use mp_io::{FreeTurns, GoalEntry, PoseEntry};
use mp_robot::{Arm, FreeTurn, InverseKinematics, PoseGoal};
use nalgebra::{Isometry3, Vector3};
use serde::Serialize;

/// How many starts are tried, and how many free solutions are enough.
const STARTS: u64 = 400;
const ENOUGH: usize = 32;
/// How many starts are tried where nothing was found: out of reach, as far as can be told.
const AT_LEAST: u64 = 100;
/// How far a link may be from a place where it is to be: rad, and m or lengths of the arm, whichever is less. Files often have only four digits.
const NEAR: f64 = 1e-3;

/// A configuration that reaches a place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reached {
    /// The values of the joints.
    pub row: Vec<f64>,
    /// Whether the configuration is free of collisions.
    pub free: bool,
}

/// The goal as the solver takes it.
fn goal_of(entry: &PoseEntry) -> PoseGoal {
    let free = match entry.free {
        FreeTurns::None => FreeTurn::None,
        FreeTurns::About(axis) => FreeTurn::About(Vector3::ith_axis(axis)),
        FreeTurns::All => FreeTurn::All,
    };
    PoseGoal { within: entry.within, free, ..PoseGoal::new(&entry.link, pose_from_six(entry.pose)) }
}

/// The error of a search that was interrupted.
fn ended() -> [String; 2] {
    ["the search for goals was ended".to_owned(), "give more time".to_owned()]
}

/// The configurations of `arm` that reach `entry` and whether each is free, from searches that begin at `from`: up to `enough` free ones,
/// or all that are found. The free ones come first, each part by its distance from there.
///
/// # Errors
/// What is wrong, and what to do: there is no such link, nothing moves it, it is out of reach or beyond limits, or the work was
/// interrupted.
pub(super) fn reaching(
    arm: &Arm,
    space: &Joints<Configuration>,
    entry: &PoseEntry,
    from: &Configuration,
    enough: usize,
    interrupt: &Interrupt,
) -> Result<Vec<(Configuration, bool)>, [String; 2]> {
    let kinematics = arm.kinematics();
    let link = &entry.link;
    if !kinematics.links().any(|name| name == link) {
        let names: Vec<&str> = kinematics.links().collect();
        return Err([format!("there is no link \"{link}\""), format!("the links are {}", names.join(", "))]);
    }
    if !(entry.pose.iter().all(|x| x.is_finite()) && entry.within.iter().all(|x| x.is_finite() && *x >= 0.0))
    {
        let message = format!("the place for \"{link}\" is not valid");
        return Err([message, "give finite numbers, and tolerances that are not below zero".to_owned()]);
    }
    let Some(solver) = InverseKinematics::new(kinematics, goal_of(entry)) else {
        let message = format!("no joint moves the link \"{link}\", or the base floats");
        return Err([message, "name a link that joints move, of a robot whose base stands still".to_owned()]);
    };
    let mut solver = solver.beginning_at(from);
    let (mut arm, margin, mut interrupt) = (arm.clone(), 2.0 * arm.tolerance(), interrupt.clone());
    let mut all: Vec<(Configuration, bool)> = Vec::new();
    let mut free = 0;
    for start in 0..STARTS {
        if interrupt.ask() {
            return Err(ended());
        }
        if (start >= AT_LEAST && all.is_empty()) || free >= enough {
            break;
        }
        let Some(q) = solver.next_solution() else { continue };
        let is_free = arm.clearance(&q, margin) >= margin;
        free += usize::from(is_free);
        all.push((q, is_free));
    }
    if all.is_empty() {
        let [distance, reach] = solver.reach();
        return Err(match distance > reach + entry.within.iter().fold(0.0, |a, b| f64::max(a, *b)) {
            true => [
                format!(
                    "\"{link}\" cannot get there: the place is {} m from the first joint, and the arm reaches {} m",
                    brief(distance),
                    brief(reach)
                ),
                "move the goal or the base".to_owned(),
            ],
            false => [
                format!(
                    "no configuration within the limits of the joints places \"{link}\" there, as far as {AT_LEAST} searches tell"
                ),
                "move the goal, leave a turn free (`free = \"z\"`), give a `position_tolerance`, or a position alone".to_owned(),
            ],
        });
    }
    all.sort_by(|(a, a_free), (b, b_free)| {
        b_free.cmp(a_free).then(space.distance(from, a).total_cmp(&space.distance(from, b)))
    });
    Ok(all)
}

/// The free configurations that reach a goal of a problem, and a sentence about them.
///
/// # Errors
/// As [`reaching`], and where all of them are in collision: by which bodies.
pub(super) fn goals(
    arm: &Arm,
    space: &Joints<Configuration>,
    entry: &PoseEntry,
    from: &Configuration,
    interrupt: &Interrupt,
) -> Result<(Vec<Configuration>, String), [String; 2]> {
    let found = reaching(arm, space, entry, from, ENOUGH, interrupt)?;
    let free: Vec<_> = found.iter().filter(|(_, free)| *free).map(|(q, _)| q.clone()).collect();
    if free.is_empty() {
        let (mut arm, mut interrupt) = (arm.clone(), interrupt.clone());
        let mut explained = Vec::new();
        for (q, _) in &found {
            if interrupt.ask() {
                return Err(ended());
            }
            explained.push(arm.explain(q.as_slice()));
        }
        let deepest =
            |contacts: &Vec<mp_robot::ArmContact>| contacts.iter().map(|c| c.depth).fold(0.0, f64::max);
        let least =
            explained.into_iter().min_by(|a, b| deepest(a).total_cmp(&deepest(b))).unwrap_or_default();
        let named =
            least.iter().take(3).map(|c| format!("{} in {} ({} m deep)", c.link, c.other, brief(c.depth)));
        let named: Vec<_> = named.collect();
        let what = count(found.len(), "configuration");
        let by = match named.is_empty() {
            true => "closer to something than can be proved".to_owned(),
            false => format!("in collision; the least of them has {}", named.join(", ")),
        };
        let message = format!("{what} place \"{}\" there, and all are {by}", entry.link);
        return Err([
            message,
            "move the goal, or what is in the way, or leave a turn free (`free = \"z\"`)".to_owned(),
        ]);
    }
    let said = format!(
        "the goal is a place of \"{}\": {} of {} that reach it are free; a path ends at any of them",
        entry.link,
        free.len(),
        count(found.len(), "configuration")
    );
    Ok((free, said))
}

impl<C: super::LinkedSpace> super::LinkedScene<C> {
    /// See [`Description::reaches_place`](crate::Description::reaches_place).
    pub(super) fn is_at_place(&self, q: &Configuration) -> bool {
        let goals = self.source.iter().flat_map(|problem| &problem.file.goals);
        let nears = |goal: &GoalEntry| {
            let GoalEntry::Pose(entry) = goal else { return false };
            let goal = goal_of(entry);
            let solver = InverseKinematics::new(self.arm.kinematics(), goal.clone());
            solver.is_some_and(|mut solver| {
                let (place, turn) = goal.error(&solver.pose_at(q.as_slice()));
                place.norm() <= NEAR * self.arm.length().min(1.0) && turn.norm() <= NEAR
            })
        };
        goals.into_iter().any(nears)
    }
}

impl super::ArmScene {
    /// Configurations that place a link: different ones, the free ones first, each part from the nearest to the start on. At most
    /// `enough` free ones. The same every time.
    ///
    /// # Errors
    /// When there is no such link, nothing moves it, or no configuration within the limits is found that reaches the place; and when it was
    /// interrupted.
    pub fn reaching(
        &self,
        entry: &PoseEntry,
        enough: usize,
        interrupt: &Interrupt,
    ) -> Result<Vec<Reached>, Error> {
        let found = reaching(&self.arm, &self.space, entry, &self.start, enough, interrupt);
        let found = found.map_err(|[message, help]| Error::new(message).help(help))?;
        let reached = |(q, free): (Configuration, bool)| Reached { row: q.as_slice().to_vec(), free };
        Ok(found.into_iter().map(reached).collect())
    }

    /// See `Scene::reaching_from` of mp-plan.
    pub fn reaching_from(
        &self,
        body: usize,
        pose: &Isometry3<f64>,
        from: &Configuration,
    ) -> Option<Configuration> {
        let link = self.arm.model().links.iter().filter(|link| !link.shapes.is_empty()).nth(body)?;
        let exact = PoseGoal::new(&link.name, *pose);
        let placed = |goal: PoseGoal| InverseKinematics::new(self.arm.kinematics(), goal)?.from(from);
        placed(exact.clone()).or_else(|| placed(PoseGoal { free: FreeTurn::All, ..exact }))
    }
}
