//! The arm of a robot problem, from its URDF and SRDF.

use super::named::{NamedValues, resolve};
use super::{HAIR, LinkedScene, LinkedSpace};
use crate::{Error, brief, count, plain};
use mp_cspace::{FloatingJoints, Interrupt, JointRange};
use mp_geom::{Aabb, TriMesh};
use mp_io::{Files, MovingJoints, RobotPart, RobotProblem};
use mp_robot::{Arm, ArmError, ArmModel, Kinematics, UrdfError};

/// The robot of a problem, without what its SRDF says.
pub(crate) fn model_of(files: &dyn Files, problem: &RobotProblem) -> Result<ArmModel, Error> {
    let mut mesh = |name: &str| problem.mesh_from(files, name);
    let mut model = from_urdf(problem, &mut mesh, &files.interrupt())?;
    model.base = problem.base();
    model.floating = problem.file.floating.map(|[low, high]| Aabb::new(low.into(), high.into()));
    for (i, (joint, [low, high])) in problem.file.limits.iter().enumerate() {
        model = model.with_limits(joint, *low, *high).map_err(|e| {
            problem.file.fault(RobotPart::Limits(i), &e.to_string(), "name joints as the URDF does")
        })?;
    }
    Ok(model)
}

/// The model with what the SRDF of the problem says. Notes say what was found and what is not read.
fn with_srdf(model: ArmModel, problem: &RobotProblem) -> Result<ArmModel, Error> {
    let Some(srdf) = &problem.srdf else { return Ok(model) };
    let before = model.notes.len();
    let mut model = model.with_srdf(srdf).map_err(|e| srdf_fault(problem, &e))?;
    let name = srdf_name(problem);
    model.notes[before..].iter_mut().for_each(|note| *note = format!("{name}: {note}"));
    if problem.srdf_found.is_some() {
        let pairs = count(model.may_touch.as_ref().map_or(0, Vec::len), "pair");
        let note = format!(
            "{name} was found: it lets {pairs} of links touch. A robot problem names another by `srdf`, or says `srdf = false`"
        );
        model.notes.insert(before, note);
    }
    Ok(model)
}

/// The model of which only those joints move that the problem lets move. Notes say which others are held, and where.
fn with_moving(mut model: ArmModel, problem: &RobotProblem, named: &NamedValues) -> Result<ArmModel, Error> {
    let file = &problem.file;
    for (i, (joint, value)) in file.hold.iter().enumerate() {
        let held = model.holding(joint, *value);
        model =
            held.map_err(|e| file.fault(RobotPart::Hold(i), &e.to_string(), "name joints as the URDF does"))?;
    }
    let wrong = |message: String| {
        let help = "name a group of the SRDF, or joints that move by themselves: `joints = [\"joint1\", \"joint2\"]`";
        Error::from(file.fault(RobotPart::Moving, &message, help))
    };
    let joints = match &file.moving {
        None => return Ok(model),
        Some(MovingJoints::Listed(joints)) => joints.clone(),
        Some(MovingJoints::Group(group)) => named.groups().joints(&model, group).map_err(wrong)?,
    };
    let (mut model, held) =
        model.with_only(&joints, |joint| named.value(joint)).map_err(|e| wrong(e.to_string()))?;
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
        model = attached.map_err(|e| {
            problem.file.fault(RobotPart::Attached(i), &e.to_string(), "name links as the URDF does")
        })?;
    }
    Ok(model)
}

impl<C: LinkedSpace> LinkedScene<C> {
    /// The arm of a problem among its obstacles, and what decides which joints move and which links may touch. The start and the goals
    /// of the problem that are given by names are numbers then.
    pub(super) fn arm_of(files: &dyn Files, problem: &mut RobotProblem) -> Result<(Arm, Vec<String>), Error> {
        let model = model_of(files, problem)?;
        let of_urdf = model.notes.len();
        let named = NamedValues::of(problem)?;
        let mut model = with_moving(model, problem, &named)?;
        if let Some([low, high]) = problem.file.planar {
            let moved = model.with_planar_base(low, high);
            model = moved.map_err(|e| {
                problem.file.fault(
                    RobotPart::Base,
                    &e.to_string(),
                    "give that joint of the URDF another name",
                )
            })?;
        }
        let mut model = with_attached(with_srdf(model, problem)?, problem)?;
        let in_urdf = |problem: &RobotProblem, e: ArmError| {
            let line = e.element().and_then(|(element, name)| line_of(&problem.urdf, element, name));
            in_urdf(problem, line, e.to_string(), "correct the links and joints of the URDF")
        };
        let kinematics = Kinematics::new(&model).map_err(|e| in_urdf(problem, e))?;
        let resolved = resolve(problem, &named, &kinematics, &model)?;
        model.notes.extend(resolved);
        if problem.file.limit_tolerance > 0.0 {
            model = with_start(model, &kinematics, problem).map_err(|e| in_urdf(problem, e))?;
        }
        let bodies = problem.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
        let arm = Arm::new_until(&model, bodies, &files.interrupt()).map_err(|e| in_urdf(problem, e))?;
        let notes = &arm.model().notes;
        for note in notes {
            tracing::info!("{}: {note}", problem.urdf_file.display());
        }
        let said = notes[of_urdf..].to_vec();
        Ok((arm, said))
    }
}

/// The model with wider limits where the start is beyond them by no more than the problem allows. Notes say so.
fn with_start(
    mut model: ArmModel,
    kinematics: &Kinematics,
    problem: &RobotProblem,
) -> Result<ArmModel, ArmError> {
    let base = if kinematics.floats() { <FloatingJoints as LinkedSpace>::BASE.len() } else { 0 };
    for (coordinate, x) in kinematics.coordinates().iter().zip(problem.file.start.row().iter().skip(base)) {
        let JointRange::Interval { low, high } = coordinate.range else { continue };
        let limit = x.clamp(low, high);
        let beyond = (x - limit).abs();
        if beyond > HAIR && beyond <= problem.file.limit_tolerance + HAIR {
            let (name, beyond) = (&coordinate.name, brief(beyond));
            model.notes.push(format!(
                "the start has \"{name}\" {beyond} beyond its limit {}: paths may go that far",
                plain(limit)
            ));
            model = model.with_limits(name, low.min(*x), high.max(*x))?;
        }
    }
    Ok(model)
}

/// What fails when the robot of a problem cannot be made.
pub(super) fn what(problem: &RobotProblem) -> String {
    format!("cannot make a robot of {}", problem.urdf_file.display())
}

/// The name of the SRDF of a problem, in messages.
fn srdf_name(problem: &RobotProblem) -> String {
    match (&problem.file.srdf, &problem.srdf_found) {
        (Some(name), _) => name.clone(),
        (None, Some(found)) => found.display().to_string(),
        (None, None) => String::new(),
    }
}

/// The error of an SRDF that cannot be used: where the problem names it, or in the file itself.
pub(super) fn srdf_fault(problem: &RobotProblem, e: &UrdfError) -> Error {
    let help = "name an SRDF of this robot by `srdf` in a robot problem, or say `srdf = false`";
    match (&problem.srdf_found, &problem.srdf) {
        (Some(found), Some(text)) => {
            let kind = mp_io::ErrorKind::Content;
            let error = match e.line() {
                Some(line) => mp_io::Error::in_line(kind, found.display(), text, line as usize, e.message()),
                None => mp_io::Error::new(kind, found.display(), e.message()),
            };
            error.help(help).into()
        }
        _ => problem.file.fault(RobotPart::Srdf, &e.to_string(), help).into(),
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
    if problem.srdf.is_some() {
        return format!("{in_srdf} {}", srdf_name(problem));
    }
    let urdf = problem.urdf_file.display();
    let made = format!(
        "`mp srdf {urdf} --out {}` makes one from samples",
        problem.urdf_file.with_extension("srdf").display()
    );
    match &problem.srdf_beside {
        Some(beside) => format!(
            "{in_srdf} an SRDF: `srdf = \"{beside}\"` in a robot problem takes the one beside the URDF; {made}"
        ),
        None => format!("{in_srdf} an SRDF: there is none near the URDF, and {made}"),
    }
}

/// The model of a URDF. `mesh` finds its meshes.
fn from_urdf(
    problem: &RobotProblem,
    mesh: impl FnMut(&str) -> Result<TriMesh, String>,
    interrupt: &Interrupt,
) -> Result<ArmModel, Error> {
    ArmModel::from_urdf_until(&problem.urdf, mesh, interrupt)
        .map_err(|e| in_urdf(problem, e.line().map(|line| line as usize), e.message(), e.remedy()))
}

/// An error in the URDF of a problem, in a line if that is known.
fn in_urdf(problem: &RobotProblem, line: Option<usize>, message: String, remedy: &str) -> Error {
    let (kind, file) = (mp_io::ErrorKind::Content, problem.urdf_file.display());
    let error = match line {
        Some(line) => mp_io::Error::in_line(kind, file, &problem.urdf, line, message),
        None => mp_io::Error::new(kind, file, message),
    };
    error.help(remedy).into()
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
