//! `render`: draws a scene, and a path through it, as a picture or as a page for the browser.

use crate::cli::Render;
use crate::input::{judged_path, refuse_two_standard_inputs, scene};
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
    let judged = args.path.as_ref().map(|file| judged_path(&scene, file)).transpose()?;
    let mut caption = String::new();
    if let Some((path, free)) = &judged {
        caption = mp_plan::count(path.rows.len(), "configuration");
        if !free {
            caption += ", not verified";
        }
    }
    let path = judged.as_ref().map(|(path, _)| path);
    write(&args.picture, &picture.bytes(&scene, path, None, &caption, args.size)?)?;
    note(&format!("wrote {}", args.picture.display()));
    Ok(true)
}
