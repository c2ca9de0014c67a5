//! `render`, and writing pictures.

use crate::arm::{self, Task};
use crate::cli::Render;
use crate::flat::{self, AnyTask, either};
use crate::{output, scenes};
use miette::{IntoDiagnostic, Result, miette};
use mp::io::{FlatProblem, JointPath, PathFile, Problem, RobotProblem, SpaceKind};
use mp::render::{Body, Picture, Scene};
use nalgebra::{Isometry3, Point3};
use std::path::Path;

/// The size of pictures when none is given, pixels.
pub(crate) const SIZE: (usize, usize) = (1280, 960);

/// Draws a scene, and a path through it.
pub(crate) fn run(args: &Render) -> Result<bool> {
    let scene = scenes::find(&args.scene)?;
    let flat = FlatProblem::is_one(&scene);
    wanted(&args.picture, flat)?;
    output::writable(&args.picture)?;
    let subtitle = |configurations: usize| match configurations {
        0 => String::new(),
        n => format!("{n} configurations"),
    };
    if flat {
        let task = AnyTask::load(&scene)?;
        let path = args.path.as_ref().map(JointPath::read).transpose()?;
        let subtitle = subtitle(path.as_ref().map_or(0, |p| p.configurations.len()));
        either!(&task, task => flat::draw(&args.picture, task, path.as_ref(), subtitle, Some(args.size)))?;
        output::note(&format!("wrote {}", args.picture.display()));
        return Ok(true);
    }
    let drawn = if RobotProblem::is_named(&scene) {
        let task = Task::load(&scene)?;
        let states = match &args.path {
            Some(path) => task.path(&JointPath::read(path)?)?,
            None => Vec::new(),
        };
        arm::scene(&task, &states, subtitle(states.len()))
    } else {
        let problem = Problem::load(scene)?;
        let path = args.path.as_ref().map(PathFile::read).transpose()?.map(|p| p.poses()).unwrap_or_default();
        let subtitle = subtitle(path.len());
        rigid(&problem, &path, subtitle)
    };
    write(&args.picture, &drawn.draw(args.size).into_diagnostic()?)?;
    output::note(&format!("wrote {}", args.picture.display()));
    Ok(true)
}

/// Refuses picture files of formats that cannot be written; only scenes that are `flat` are drawn as SVG.
pub(crate) fn wanted(file: &Path, flat: bool) -> Result<()> {
    let ending = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    match ending.as_str() {
        "png" => Ok(()),
        "svg" if flat => Ok(()),
        "svg" => Err(miette!(
            help = "end its name in .png",
            "only worlds in the plane are drawn as .svg, not for {}",
            file.display()
        )),
        "" => Err(miette!(help = "end its name in .png", "{} has no ending", file.display())),
        _ => Err(miette!(
            help = "pictures are written as .png",
            "cannot write a picture as .{ending}: {}",
            file.display()
        )),
    }
}

/// What is drawn of `problem` with `path` in it.
pub(crate) fn rigid(problem: &Problem, path: &[Isometry3<f64>], subtitle: String) -> Scene {
    let start = Body::new(&problem.robot.mesh, problem.start);
    Scene {
        title: problem.name.clone(),
        subtitle,
        planar: problem.space == SpaceKind::Se2,
        obstacles: problem.obstacles.iter().map(|o| Body::new(&o.mesh, o.pose)).collect(),
        goal: Some(start.at(problem.goal)),
        copies: start.along(path),
        trace: path.iter().map(|pose| Point3::from(pose.translation.vector)).collect(),
        start: Some(start),
        bounds: problem.bounds,
    }
}

/// Writes `picture` to `file` as PNG.
pub(crate) fn write(file: &Path, picture: &Picture) -> Result<()> {
    output::write(file, &picture.to_png())
}
