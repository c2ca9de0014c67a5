//! `render`: draws a scene, and a path through it, as a picture or as a page for the browser.

use crate::cli::Render;
use crate::input::{path, refuse_two_standard_inputs, scene};
use crate::output::{note, writable, write};
use crate::picture::Picture;
use mp_plan::Error;

/// Draws a scene, and a path through it. A path that does not pass verification is drawn as well, with a
/// warning.
pub(crate) fn run(args: &Render) -> Result<bool, Error> {
    refuse_two_standard_inputs(&args.scene, args.path.as_deref())?;
    let scene = scene(&args.scene)?;
    let picture = Picture::of(&scene, &args.picture)?;
    writable(&args.picture)?;
    if let Some(input) = scene.input_at(&args.picture) {
        let message = format!("{} would overwrite the input {}", args.picture.display(), input.display());
        return Err(Error::new(message).help("name another file"));
    }
    let path = args.path.as_ref().map(|file| path(&scene, file)).transpose()?;
    let mut caption = String::new();
    if let Some(path) = &path {
        let verdict = scene.check(path)?;
        caption = mp_plan::count(path.rows.len(), "configuration");
        if !verdict.free {
            caption += ", not verified";
            note(&format!("warning: this path would not pass `mp check`: {}", verdict.faults.join("; ")));
        }
    }
    write(&args.picture, &picture.bytes(&scene, path.as_ref(), None, &caption, args.size)?)?;
    note(&format!("wrote {}", args.picture.display()));
    Ok(true)
}
