//! `render`: a picture of a scene, and of a path through it.

use crate::check::{path, scene};
use crate::cli::Render;
use crate::output::{note, writable, write};
use mp_plan::Error;

/// Draws a scene, and a path through it. A path that is not free is drawn, and said not to be. True when there is no
/// path, or it is free.
pub(crate) fn run(args: &Render) -> Result<bool, Error> {
    let scene = scene(&args.scene)?;
    let kind = scene.picture_kind(&args.picture)?;
    writable(&args.picture)?;
    if let Some(input) = scene.input_at(&args.picture) {
        let message =
            format!("{} would overwrite {}, which is read", args.picture.display(), input.display());
        return Err(Error::new(message).help("name another file"));
    }
    let path = args.path.as_ref().map(|file| path(&scene, file)).transpose()?;
    let (mut caption, mut free) = (String::new(), true);
    if let Some(path) = &path {
        let verdict = scene.check(path)?;
        free = verdict.free;
        caption = mp_plan::count(path.rows.len(), "configuration");
        if !free {
            caption += ", not free";
            note(&format!("warning: the path is not free: {}", verdict.faults.join("; ")));
        }
    }
    write(&args.picture, &scene.picture(path.as_ref(), &caption, kind, args.size)?)?;
    note(&format!("wrote {}", args.picture.display()));
    Ok(free)
}
