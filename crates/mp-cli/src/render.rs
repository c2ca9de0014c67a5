//! `render`: draws a scene, and a path through it, as a picture, a film, a page for the browser, or meshes.

use crate::cli::Render;
use crate::input::{judged_path, refuse_two_standard_inputs, scene};
use crate::interrupt;
use crate::output::{Claims, note, write};
use crate::picture::{Picture, Shown};
use crate::progress::Line;
use mp_plan::{Cancel, Error, RelaxField};

/// Draws a scene, and a path through it. A path that does not pass verification is drawn as well, with a
/// warning.
pub(crate) fn run(args: &Render) -> Result<bool, Error> {
    refuse_two_standard_inputs(&args.scene, args.path.as_deref())?;
    let scene = scene(&args.scene, &args.changes.of_problem())?;
    let picture = Picture::of(&scene, &args.picture, &args.drawing, args.path.is_some())?;
    let mut claims = Claims::default();
    scene.inputs_on_disk().iter().chain(&args.path).for_each(|file| claims.input(file));
    if let Some(RelaxField::Image(file)) = &args.drawing.field {
        claims.input(file);
    }
    claims.output("--picture", &args.picture)?;
    let judged = args.path.as_ref().map(|file| judged_path(&scene, file)).transpose()?;
    let mut caption = String::new();
    if let Some((path, verdict)) = &judged {
        caption = mp_plan::count(path.rows.len(), "configuration");
        if let Some(fault) = verdict.faults.first() {
            // The place is in the warning.
            let what = fault.split(" between ").next().unwrap_or(fault);
            caption += &format!(", NOT A VALID PATH: {}", mp_io::shortened(what, 80));
        }
    }
    let (path, verdict) = judged.as_ref().map(|(path, verdict)| (path, verdict)).unzip();
    let shown = Shown { scene: &scene, path, verdict, report: None, caption: &caption };
    let cancel = if picture.takes_long() { interrupt::flag() } else { Cancel::new() };
    let line = Line::new(scene.name(), None, true);
    let Some(bytes) = picture.bytes(&shown, None, &cancel, &line)? else {
        drop(line);
        note(&format!("interrupted: {} was not written", args.picture.display()));
        return Ok(false);
    };
    drop(line);
    write(&args.picture, &bytes)?;
    note(&format!("wrote {}", args.picture.display()));
    Ok(true)
}
