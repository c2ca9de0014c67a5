//! The arm of a robot problem, from its URDF and SRDF.

use super::{HAIR, LinkedScene, LinkedSpace};
use crate::{Error, brief, plain};
use mp_cspace::{FloatingJoints, Interrupt, JointRange};
use mp_geom::{Aabb, TriMesh};
use mp_io::{Files, RobotPart, RobotProblem};
use mp_robot::{Arm, ArmError, ArmModel, Kinematics};

impl<C: LinkedSpace> LinkedScene<C> {
    /// The arm of a problem among its obstacles, and what decides which links may touch.
    pub(super) fn arm_of(files: &dyn Files, problem: &RobotProblem) -> Result<(Arm, Vec<String>), Error> {
        let mut mesh = |name: &str| problem.mesh_from(files, name);
        let mut model = from_urdf(problem, &mut mesh, &files.interrupt())?;
        let of_urdf = model.notes.len();
        model.base = problem.base();
        model.floating = problem.file.floating.map(|[low, high]| Aabb::new(low.into(), high.into()));
        if let Some(srdf) = &problem.srdf {
            model = model.with_srdf(srdf).map_err(|e| {
                problem.file.fault(RobotPart::Srdf, &e.to_string(), "name an SRDF of this robot, or none")
            })?;
            let name = problem.file.srdf.as_deref().unwrap_or_default();
            model.notes[of_urdf..].iter_mut().for_each(|note| *note = format!("{name}: {note}"));
        }
        for (i, (joint, [low, high])) in problem.file.limits.iter().enumerate() {
            model = model.with_limits(joint, *low, *high).map_err(|e| {
                problem.file.fault(RobotPart::Limits(i), &e.to_string(), "name joints as the URDF does")
            })?;
        }
        let in_urdf = |e: ArmError| {
            let line = e.element().and_then(|(element, name)| line_of(&problem.urdf, element, name));
            in_urdf(problem, line, e.to_string(), "correct the links and joints of the URDF")
        };
        if problem.file.limit_tolerance > 0.0 {
            model = with_start(model, problem).map_err(in_urdf)?;
        }
        let bodies = problem.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
        let arm = Arm::new_until(&model, bodies, &files.interrupt()).map_err(in_urdf)?;
        let notes = &arm.model().notes;
        for note in notes {
            tracing::info!("{}: {note}", problem.urdf_file.display());
        }
        let said = notes[of_urdf..].to_vec();
        Ok((arm, said))
    }
}

/// The model with wider limits where the start is beyond them by no more than the problem allows. Notes say so.
fn with_start(mut model: ArmModel, problem: &RobotProblem) -> Result<ArmModel, ArmError> {
    let kinematics = Kinematics::new(&model)?;
    let first = problem.file.start.len().min(if kinematics.floats() {
        <FloatingJoints as LinkedSpace>::BASE.len()
    } else {
        0
    });
    for (coordinate, x) in kinematics.coordinates().iter().zip(&problem.file.start[first..]) {
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

/// What to do about links that touch though they may.
pub(super) fn srdf_help(problem: &RobotProblem) -> String {
    let in_srdf = "if these links may touch, say so by <disable_collisions> in";
    match (&problem.file.srdf, &problem.srdf_beside) {
        (Some(srdf), _) => format!("{in_srdf} {srdf}"),
        (None, Some(beside)) => {
            format!(
                "{in_srdf} an SRDF: `srdf = \"{beside}\"` in a robot problem takes the one beside the URDF"
            )
        }
        (None, None) => {
            format!("{in_srdf} an SRDF, named by `srdf` in a robot problem: there is none beside the URDF")
        }
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
