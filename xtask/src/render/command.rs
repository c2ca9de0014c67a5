//! `render`, and writing pictures.

use super::{Subject, draw};
use crate::cli::Render;
use crate::{output, scenes};
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use mp::io::{PathFile, Problem, SpaceKind};
use nalgebra::Isometry3;
use std::io::Cursor;
use std::path::Path;

/// The size of pictures when none is given, pixels.
pub(crate) const SIZE: (usize, usize) = (1280, 960);

/// Draws a scene, and a path through it.
pub(crate) fn run(args: &Render) -> Result<bool> {
    wanted(&args.picture)?;
    output::writable(&args.picture)?;
    let problem = Problem::load(scenes::find(&args.scene)?)?;
    let path = args.path.as_ref().map(PathFile::read).transpose()?.map(|p| p.poses()).unwrap_or_default();
    let subtitle = match path.len() {
        0 => String::new(),
        n => format!("{n} configurations"),
    };
    let picture = draw(&subject(&problem, path, subtitle), args.size);
    write(&args.picture, &picture)?;
    output::note(&format!("wrote {}", args.picture.display()));
    Ok(true)
}

/// Refuses picture files of formats that cannot be written.
pub(crate) fn wanted(file: &Path) -> Result<()> {
    let ending = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    match ending.as_str() {
        "png" => Ok(()),
        "" => Err(miette!(help = "end its name in .png", "{} has no ending", file.display())),
        _ => Err(miette!(
            help = "pictures are written as .png",
            "cannot write a picture as .{ending}: {}",
            file.display()
        )),
    }
}

/// The picture of `problem` with `path` in it.
pub(crate) fn subject(problem: &Problem, path: Vec<Isometry3<f64>>, subtitle: String) -> Subject<'_> {
    Subject {
        title: problem.name.clone(),
        subtitle,
        planar: problem.space == SpaceKind::Se2,
        robot: &problem.robot.mesh,
        obstacles: problem.obstacles.iter().map(|o| (&o.mesh, o.pose)).collect(),
        start: problem.start,
        goal: problem.goal,
        path,
        bounds: problem.bounds.map(|b| (b.min, b.max)),
    }
}

/// Writes `picture` to `file` as PNG.
pub(crate) fn write(file: &Path, picture: &image::RgbImage) -> Result<()> {
    let mut bytes = Vec::new();
    picture
        .write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png)
        .into_diagnostic()
        .wrap_err("cannot encode the picture")?;
    output::write(file, &bytes)
}
