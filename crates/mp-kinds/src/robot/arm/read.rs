//! The arm of a robot problem, from its URDF and SRDF.

use super::named::{NamedValues, resolve};
use super::{LinkedScene, LinkedSpace};
use crate::robot::HAIR;
use crate::{Error, brief, count, plain};
use mp_cspace::{FloatingJoints, JointRange};
use mp_geom::Aabb;
use mp_io::{DescribedRobot, Files, MovingJoints, RobotEntry, RobotFilePart, RobotPart, RobotProblem};
use mp_robot::{Arm, ArmError, ArmModel, Joint, JointKind, Kinematics, PLANAR_NUMBERS, Rate, UrdfError};

/// One robot of a problem.
#[derive(Clone, Copy)]
struct One<'a> {
    problem: &'a RobotProblem,
    index: usize,
    entry: &'a RobotEntry,
    described: &'a DescribedRobot,
}

impl One<'_> {
    /// An error about a part of the robot in the file of the problem.
    fn fault(self, part: RobotPart, message: impl ToString, help: &str) -> Error {
        self.problem.file.fault(RobotFilePart::Robot(self.index, part), &message.to_string(), help).into()
    }

    /// Whether a joint is one of those by which the base moves in the plane, which are made last.
    fn is_of_base(self, joint: &str) -> bool {
        self.entry.planar.is_some() && PLANAR_NUMBERS.contains(&joint)
    }
}

fn robots(problem: &RobotProblem) -> impl Iterator<Item = One<'_>> {
    let all = problem.file.robots.iter().zip(&problem.robots).enumerate();
    all.map(move |(index, (entry, described))| One { problem, index, entry, described })
}

/// The robot of a problem that has one, without what its SRDF says.
///
/// # Errors
/// When its URDF or its limits are not valid, or there are several robots.
pub fn model_of(files: &dyn Files, problem: &RobotProblem) -> Result<ArmModel, Error> {
    let mut all = robots(problem);
    match (all.next(), all.next()) {
        (Some(robot), None) => described(files, robot).map(|(model, _)| model),
        _ => {
            Err(Error::new(format!("{} has several robots", problem.name))
                .help("name the URDF of one of them"))
        }
    }
}

/// Reads the meshes of the robots of a problem, and makes no arm of them.
///
/// # Errors
/// When a URDF or the limits of its robot are not valid, or a mesh cannot be read.
pub fn read_robots(files: &dyn Files, problem: &RobotProblem) -> Result<(), Error> {
    robots(problem).try_for_each(|robot| described(files, robot).map(|_| ()))
}

/// The model of the URDF of a robot, at its place and with its limits, and what a `joint_limits.yaml` has changed, in sentences.
fn described(files: &dyn Files, robot: One<'_>) -> Result<(ArmModel, Vec<String>), Error> {
    let One { entry, described, .. } = robot;
    let mesh = |name: &str| described.mesh_from(files, name);
    let mut model = ArmModel::from_urdf_until(&described.urdf, mesh, &files.interrupt())
        .map_err(|e| in_urdf(described, e.line().map(|line| line as usize), e.message(), e.remedy()))?;
    model.base = entry.pose();
    model.floating = entry.floating.map(|[low, high]| Aabb::new(low.into(), high.into()));
    let (model, said) = with_joint_limits(model, described)?;
    Ok((with_limits(model, robot, false)?, said))
}

/// The model with the limits that the problem gives to its joints, or to those of its base in the plane.
fn with_limits(mut model: ArmModel, robot: One<'_>, of_base: bool) -> Result<ArmModel, Error> {
    for (i, (joint, [low, high])) in robot.entry.limits.iter().enumerate() {
        if robot.is_of_base(joint) == of_base {
            let limited = model.with_limits(joint, *low, *high);
            model = limited.map_err(|e| robot.fault(RobotPart::Limits(i), e, NAMES))?;
            // Joints that mimic it go with it, as far as that is.
            model = model.with_room_for(joint, *low).with_room_for(joint, *high);
        }
    }
    Ok(model)
}

/// The same with the joints held that the problem holds.
fn with_held(mut model: ArmModel, robot: One<'_>, of_base: bool) -> Result<ArmModel, Error> {
    for (i, (joint, value)) in robot.entry.hold.iter().enumerate() {
        if robot.is_of_base(joint) == of_base {
            let held = model.holding(joint, *value);
            model = held.map_err(|e| robot.fault(RobotPart::Hold(i), e, NAMES))?;
        }
    }
    Ok(model)
}

/// The model with the limits of the `joint_limits.yaml` beside its SRDF, as MoveIt takes them, and what they change, in sentences. Of joints that
/// the robot does not have nothing is said: the file may be of more of it.
fn with_joint_limits(mut model: ArmModel, robot: &DescribedRobot) -> Result<(ArmModel, Vec<String>), Error> {
    let (mut other, mut without) = (Vec::new(), Vec::new());
    for limits in &robot.joint_limits.joints {
        let (name, is_it) =
            (&limits.joint, |j: &&Joint| j.name == limits.joint && j.kind != JointKind::Fixed);
        let Some(joint) = model.joints.iter().find(is_it) else { continue };
        match (joint.kind, limits.positions) {
            (_, [None, None]) => {}
            (JointKind::Revolute { low, high } | JointKind::Prismatic { low, high }, [from, to])
                if joint.mimic.is_none() =>
            {
                let [from, to] = [from.unwrap_or(low), to.unwrap_or(high)];
                if from > to {
                    let message = format!("\"{name}\" may be from {from} to {to} with what the URDF says");
                    return Err(in_joint_limits(robot, message));
                }
                if [from, to] != [low, high] {
                    other.push(format!("{name} from {} to {}", plain(from), plain(to)));
                    model =
                        model.with_limits(name, from, to)?.with_room_for(name, from).with_room_for(name, to);
                }
            }
            (kind, [from, to]) => {
                let same = kind.limits().is_some_and(|[low, high]| [from, to] == [Some(low), Some(high)]);
                without.extend((!same).then(|| name.clone()));
            }
        }
        for (limit, rate) in limits.rates.iter().zip(Rate::ALL) {
            if let Some(limit) = limit {
                model = model.with_rate(Some(name), rate, *limit)?;
            }
        }
    }
    let file = robot.joint_limits.file.display();
    let mut said = Vec::new();
    if !other.is_empty() {
        said.push(format!("{file} gives joints other limits than the URDF: {}", other.join(", ")));
    }
    if !without.is_empty() {
        let why = "these joints turn without end or mimic others";
        said.push(format!("limits of position in {file} are not taken, for {why}: {}", without.join(", ")));
    }
    let options = ["velocity", "acceleration"].into_iter().zip(robot.joint_limits.parts);
    let options = options
        .filter_map(|(what, part)| Some(format!("`--{what}-scale {}`", part.filter(|part| *part < 1.0)?)));
    let options: Vec<_> = options.collect();
    if !options.is_empty() {
        said.push(format!(
            "MoveIt takes parts of the limits where a request names none, as {file} says; trajectories take the whole limits here, unless {} say otherwise",
            options.join(" and ")
        ));
    }
    Ok((model, said))
}

/// An error in the `joint_limits.yaml` beside the SRDF of a robot.
fn in_joint_limits(robot: &DescribedRobot, message: String) -> Error {
    let error = mp_io::Error::new(mp_io::ErrorKind::Content, robot.joint_limits.file.display(), message);
    error.help("the lower limit must not be above the upper: correct the file, or move it away").into()
}

/// What to do about names that a robot does not have.
const NAMES: &str = "name links and joints as the URDF does";

/// The model with what the SRDF of its robot says. Notes say what was found and what is not read.
fn with_srdf(model: ArmModel, robot: One<'_>) -> Result<ArmModel, Error> {
    let Some(srdf) = &robot.described.srdf else { return Ok(model) };
    let before = model.notes.len();
    let mut model = model.with_srdf(srdf).map_err(|e| srdf_fault(robot.problem, robot.index, &e))?;
    let name = srdf_name(robot.problem, robot.index);
    model.notes[before..].iter_mut().for_each(|note| *note = format!("{name}: {note}"));
    if robot.described.srdf_found.is_some() {
        let pairs = count(model.may_touch.as_ref().map_or(0, Vec::len), "pair");
        let note = format!(
            "{name} was found: it lets {pairs} of links touch. A robot problem names another by `srdf`, or says `srdf = false`"
        );
        model.notes.insert(before, note);
    }
    Ok(model)
}

/// The model of which only those joints move that the problem lets move. Notes say which others are held, and where.
fn with_moving(model: ArmModel, robot: One<'_>, named: &NamedValues) -> Result<ArmModel, Error> {
    let model = with_held(model, robot, false)?;
    let wrong = |message: String| {
        let help = "name a group of the SRDF, or joints that move by themselves: `joints = [\"joint1\", \"joint2\"]`";
        robot.fault(RobotPart::Moving, message, help)
    };
    let joints = match &robot.entry.moving {
        None => return Ok(model),
        Some(MovingJoints::Listed(joints)) => joints.clone(),
        Some(MovingJoints::Group(group)) => named.groups(robot.index).joints(&model, group).map_err(wrong)?,
    };
    let prefix = robot.problem.file.prefix(robot.index);
    let at = |joint: &str| named.value(&format!("{prefix}{joint}"));
    let (mut model, held) = model.with_only(&joints, at).map_err(|e| wrong(e.to_string()))?;
    if !held.is_empty() {
        let listed = held.iter().take(8).map(|(joint, value)| format!("{joint} at {}", plain(*value)));
        let more = held.len().saturating_sub(8);
        let more = if more == 0 { String::new() } else { format!(" and {more} more") };
        let (moving, listed) = (count(joints.len(), "joint"), listed.collect::<Vec<_>>().join(", "));
        model.notes.push(format!("{moving} move; held are {listed}{more}"));
    }
    Ok(model)
}

/// The model with what the problem attaches to its links.
fn with_attached(mut model: ArmModel, problem: &RobotProblem) -> Result<ArmModel, Error> {
    for (i, (entry, body)) in problem.file.attached.iter().zip(&problem.attached).enumerate() {
        let attached = model.attached(&body.name, &body.mesh, &entry.link, &body.pose, &entry.may_touch);
        let wrong = |e: ArmError| problem.file.fault(RobotFilePart::Attached(i), &e.to_string(), NAMES);
        model = attached.map_err(wrong)?;
    }
    Ok(model)
}

/// The robots of a problem as one, and how many of its notes are about what was ignored in URDFs.
fn together(
    files: &dyn Files,
    problem: &RobotProblem,
    named: &NamedValues,
) -> Result<(ArmModel, usize), Error> {
    let (mut all, mut ignored) = (Vec::new(), Vec::new());
    for robot in robots(problem) {
        let (mut model, said) = described(files, robot)?;
        let prefix = problem.file.prefix(robot.index);
        ignored.extend(std::mem::replace(&mut model.notes, said));
        let mut model = with_moving(model, robot, named)?;
        if let Some([low, high]) = robot.entry.planar {
            let help = "give that joint of the URDF another name";
            model = model.with_planar_base(low, high).map_err(|e| robot.fault(RobotPart::Base, e, help))?;
            model = with_held(with_limits(model, robot, true)?, robot, true)?;
        }
        // The joints of the base are there by now.
        for (i, (limits, rate)) in robot.entry.max_rates.iter().zip(Rate::ALL).enumerate() {
            for (joint, limit) in limits {
                let limited = model.with_rate(joint.as_deref(), rate, *limit);
                model = limited.map_err(|e| robot.fault(RobotPart::Rates(i), e, NAMES))?;
            }
        }
        all.push((prefix, with_srdf(model, robot)?));
    }
    let mut model = match (all.pop(), all.is_empty()) {
        (Some((_, only)), true) => only,
        (last, _) => {
            all.extend(last);
            for ((_, model), robot) in all.iter().zip(robots(problem)) {
                Kinematics::new(model).map_err(|e| wrong_model(problem, robot.index, "", &e))?;
            }
            ArmModel::together(all, &files.interrupt()).map_err(|e| wrong_arm(problem, &e))?
        }
    };
    let count = ignored.len();
    model.notes.splice(0..0, ignored);
    Ok((with_attached(model, problem)?, count))
}

/// The error of a model that is not valid, in the URDF that it is of.
fn wrong_arm(problem: &RobotProblem, e: &ArmError) -> Error {
    let (_, name) = e.element().unwrap_or_default();
    let of = |i: &usize| name.starts_with(&problem.file.prefix(*i));
    let index = (0..problem.robots.len()).find(of).unwrap_or_default();
    wrong_model(problem, index, &problem.file.prefix(index), e)
}

/// The same of the robot `index`, of which names begin with `prefix`.
fn wrong_model(problem: &RobotProblem, index: usize, prefix: &str, e: &ArmError) -> Error {
    let robot = &problem.robots[index];
    let line = e
        .element()
        .and_then(|(element, name)| line_of(&robot.urdf, element, name.strip_prefix(prefix).unwrap_or(name)));
    in_urdf(robot, line, e.to_string(), "correct the links and joints of the URDF")
}

impl<C: LinkedSpace> LinkedScene<C> {
    /// The arm of a problem among its obstacles; what decides which joints move and which links may touch; and what was made of ends that are
    /// `named`, which are numbers then.
    pub(super) fn arm_of(
        files: &dyn Files,
        problem: &mut RobotProblem,
        named: &NamedValues,
    ) -> Result<(Arm, Vec<String>, Vec<String>), Error> {
        let (model, ignored) = together(files, problem, named)?;
        let kinematics = Kinematics::new(&model).map_err(|e| wrong_arm(problem, &e))?;
        let of_ends = resolve(problem, named, &kinematics, &model)?;
        let model = with_start(model, &kinematics, problem).map_err(|e| wrong_arm(problem, &e))?;
        let bodies = problem.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
        let arm = Arm::new_until(&model, bodies, &files.interrupt()).map_err(|e| wrong_arm(problem, &e))?;
        for note in arm.notes().chain(&of_ends) {
            tracing::info!("{}: {note}", problem.name);
        }
        let said = arm.notes().skip(ignored).cloned().collect();
        Ok((arm, said, of_ends))
    }
}

/// A prismatic joint whose limits are farther apart than this (m) has none in truth.
const ENDLESS: f64 = 1e6;

/// How far (m) to each side of the start such a joint goes. Over that range a robot of a metre is still checked to a hundredth of a millimetre.
const ROOM: f64 = 1e4;

/// The model with wider limits where the start is beyond them by no more than the problem allows, and narrower ones where those of a
/// joint that slides mean none, unless the problem says them. Notes say so.
fn with_start(
    mut model: ArmModel,
    kinematics: &Kinematics,
    problem: &RobotProblem,
) -> Result<ArmModel, ArmError> {
    let base = if kinematics.floats() { <FloatingJoints as LinkedSpace>::BASE.len() } else { 0 };
    let tolerance = |name: &str| {
        // Of `a` and `a/b` the longer one.
        let all = problem.file.robots.iter().enumerate();
        let own = all.filter(|(i, _)| name.starts_with(&problem.file.prefix(*i)));
        let own = own.max_by_key(|(i, _)| problem.file.prefix(*i).len());
        own.map_or(0.0, |(_, entry)| entry.limit_tolerance)
    };
    for (coordinate, x) in kinematics.coordinates().iter().zip(problem.file.start.row().iter().skip(base)) {
        let JointRange::Interval { low, high } = coordinate.range else { continue };
        let limit = x.clamp(low, high);
        let name = &coordinate.name;
        let slides = |joint: &Joint| joint.name == *name && matches!(joint.kind, JointKind::Prismatic { .. });
        let mut given = problem.file.robots.iter().enumerate().flat_map(|(i, entry)| {
            let planar = entry.planar.iter().flat_map(|_| PLANAR_NUMBERS);
            let names = entry.limits.iter().map(|(joint, _)| joint.as_str()).chain(planar);
            names.map(move |joint| format!("{}{joint}", problem.file.prefix(i)))
        });
        if high - low > ENDLESS && model.joints.iter().any(slides) && !given.any(|given| given == *name) {
            let (low, high) = (low.max(limit - ROOM), high.min(limit + ROOM));
            let [from, to] = [low, high].map(plain);
            model.notes.push(format!(
                "\"{name}\" has limits that mean none: it slides from {from} to {to} m, unless `limits` say otherwise"
            ));
            model = model.with_limits(name, low, high)?;
        }
        let (beyond, tolerance) = ((x - limit).abs(), tolerance(&coordinate.name));
        if tolerance > 0.0 && beyond > HAIR && beyond <= tolerance + HAIR {
            let (name, beyond) = (&coordinate.name, brief(beyond));
            model.notes.push(format!(
                "the start has \"{name}\" {beyond} beyond its limit {}: paths may go that far",
                plain(limit)
            ));
            model = model.with_limits(name, low.min(*x), high.max(*x))?.with_room_for(name, *x);
        }
    }
    Ok(model)
}

/// Whether limits of the robot are [about the start](ROOM).
pub(super) fn depends_on_start(model: &ArmModel) -> bool {
    let is_endless = |kind| matches!(kind, JointKind::Prismatic { low, high } if high - low > ENDLESS);
    model.joints.iter().any(|joint| joint.described.is_some_and(is_endless))
}

/// What fails when the robots of a problem cannot be made.
pub(super) fn what(problem: &RobotProblem) -> String {
    let files: Vec<_> = problem.robots.iter().map(|robot| robot.urdf_file.display().to_string()).collect();
    format!("cannot make a robot of {}", files.join(" and "))
}

/// The name of the SRDF of a robot of a problem, in messages.
fn srdf_name(problem: &RobotProblem, robot: usize) -> String {
    match (&problem.file.robots[robot].srdf, &problem.robots[robot].srdf_found) {
        (Some(name), _) => name.clone(),
        (None, Some(found)) => found.display().to_string(),
        (None, None) => String::new(),
    }
}

/// The error of an SRDF that cannot be used: where the problem names it, or in the file itself.
pub(super) fn srdf_fault(problem: &RobotProblem, robot: usize, e: &UrdfError) -> Error {
    let help = "name an SRDF of this robot by `srdf` in a robot problem, or say `srdf = false`";
    match (&problem.robots[robot].srdf_found, &problem.robots[robot].srdf) {
        (Some(found), Some(text)) => {
            let kind = mp_io::ErrorKind::Content;
            let error = match e.line() {
                Some(line) => mp_io::Error::in_line(kind, found.display(), text, line as usize, e.message()),
                None => mp_io::Error::new(kind, found.display(), e.message()),
            };
            error.help(help).into()
        }
        _ => problem.file.fault(RobotFilePart::Robot(robot, RobotPart::Srdf), &e.to_string(), help).into(),
    }
}

/// What to do about links that touch though they may.
pub(super) fn srdf_help(problem: &RobotProblem, touching: &[[&str; 2]]) -> String {
    let attached = |link: &&str| problem.attached.iter().any(|body| body.name == **link);
    if let Some([thing, link]) = touching.iter().find_map(|[a, b]| match (attached(a), attached(b)) {
        (true, _) => Some([a, b]),
        (_, true) => Some([b, a]),
        _ => None,
    }) {
        return format!("if they may touch, say `may_touch = [\"{link}\"]` where \"{thing}\" is attached");
    }
    let in_srdf = "if these links may touch, say so by <disable_collisions> in";
    // Those of one robot: links of different ones are never allowed to touch.
    let of = |links: &[&str; 2]| {
        (0..problem.robots.len())
            .find(|i| links.iter().all(|link| link.starts_with(&problem.file.prefix(*i))))
    };
    let own = if touching.is_empty() { Some(0) } else { touching.iter().find_map(of) };
    let Some(index) = own else { return "move one of the robots, or its base".to_owned() };
    let robot = &problem.robots[index];
    let urdf = robot.urdf_file.display();
    let made = format!(
        "`mp srdf {urdf} --out {}` makes one from samples",
        robot.urdf_file.with_extension("srdf").display()
    );
    let named = srdf_name(problem, index);
    if robot.srdf.is_some() {
        return match named.is_empty() {
            false => format!("{in_srdf} {named}"),
            true => {
                format!("if these links may touch, say so by <exclude> in the model, or by an SRDF: {made}")
            }
        };
    }
    match &robot.srdf_beside {
        Some(beside) => format!(
            "{in_srdf} an SRDF: `srdf = \"{beside}\"` in a robot problem takes one that is near the URDF, maybe of a robot with another name; {made}"
        ),
        None => format!("{in_srdf} an SRDF: there is none near the URDF, and {made}"),
    }
}

/// An error in the URDF of a robot, in a line if that is known.
fn in_urdf(robot: &DescribedRobot, line: Option<usize>, message: String, remedy: &str) -> Error {
    robot.error(line, message).help(remedy).into()
}

/// The line, counted from 1, in which the URDF begins the last element of this kind and name: the later one of two that have
/// the same name.
fn line_of(urdf: &str, element: &str, name: &str) -> Option<usize> {
    let (start, names) = (format!("<{element}"), [format!("name=\"{name}\""), format!("name='{name}'")]);
    let is_it = |at: &usize| {
        let tag = urdf[*at..].split('>').next().unwrap_or_default();
        names.iter().any(|name| tag.contains(name.as_str()))
    };
    let at = urdf.match_indices(&start).map(|(at, _)| at).filter(is_it).last()?;
    Some(urdf[..at].matches('\n').count() + 1)
}
