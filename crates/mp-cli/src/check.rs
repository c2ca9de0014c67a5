//! `check`: verifies a path with the checker that shares no code with that of the planners.

use crate::cli::Check;
use crate::input::{Given, refuse_two_standard_inputs, scene};
use crate::output::{Claims, in_time, note, print, print_json, write};
use crate::{input, interrupt};
use mp_plan::{Error, Interrupt, Scene, brief, plain};
use std::cell::LazyCell;
use std::path::Path;

/// Verifies paths, or explains a configuration. True when the paths or the configuration are free.
pub(crate) fn run(args: &Check) -> Result<bool, Error> {
    args.paths.iter().try_for_each(|path| refuse_two_standard_inputs(&args.scene, Some(path)))?;
    let scene = scene(&args.scene, &args.changes.of_problem())?.keeping(args.clearance.unwrap_or(0.0))?;
    if let Some(numbers) = &args.at {
        return explain(&scene, numbers, args.json);
    }
    let (parts, given) = (1 + scene.parts_left(), args.paths.len());
    if given > parts {
        let message = format!(
            "{given} paths are given, and the motion has {parts} part{}",
            if parts == 1 { "" } else { "s" }
        );
        return Err(Error::new(message).help("name one path, or those of the parts of the motion in order"));
    }
    if let Some(certificate) = &args.certificate {
        if given > 1 {
            return Err(Error::new("--certificate: there are several paths").help("name one path"));
        }
        let mut claims = Claims::default();
        scene.inputs_on_disk().iter().for_each(|file| claims.input(file));
        args.paths.iter().for_each(|file| claims.input(file));
        claims.output("--certificate", certificate)?;
    }
    let (mut scene, mut free) = (scene, true);
    // Ctrl-C is only listened to by what hears of it.
    let stop = LazyCell::new((|| Interrupt::new(interrupt::flag())) as fn() -> Interrupt);
    for (i, file) in args.paths.iter().enumerate() {
        let read = input::given(&scene, file, args.curve)?;
        free &= one(args, &scene, (file, &read), &stop)?;
        let rows = match &read {
            Given::Path(path) => &path.rows,
            Given::Timed(trajectory) => &trajectory.knots().positions,
        };
        if i + 1 < given
            && let Some(end) = rows.last()
            && let Some(next) = scene.next_part(end, &stop)?
        {
            scene = next;
        }
    }
    if given < parts {
        let were = if given == 1 { "the first was".to_owned() } else { format!("the first {given} were") };
        note(&format!("the motion has {parts} parts: only {were} checked"));
    }
    Ok(free)
}

/// Verifies one path or trajectory. True when it is free, and the certificate that was asked for is made.
fn one(args: &Check, scene: &Scene, (file, read): (&Path, &Given), stop: &Interrupt) -> Result<bool, Error> {
    let mut verdict = match read {
        Given::Path(rows) => scene.check(rows)?,
        Given::Timed(trajectory) => scene.check_trajectory(trajectory, stop)?,
    };
    let mut complete = true;
    if let (Some(file), true) = (&args.certificate, verdict.free) {
        let clearance = verdict.clearance;
        let made = match read {
            Given::Path(rows) => scene.certificate(rows, clearance, stop),
            Given::Timed(trajectory) => scene.certificate_of_trajectory(trajectory, clearance, stop),
        };
        match in_time(made, stop, file)? {
            Some(certificate) => write(file, certificate.to_json().as_bytes())?,
            None => complete = false,
        }
    }
    (verdict.scene, verdict.path) = (shown(scene, &args.scene), file.display().to_string());
    match args.json {
        true => print_json(&verdict)?,
        false => {
            verdict.warnings.iter().for_each(|odd| note(&format!("warning: {odd}")));
            print(&verdict.summary())?;
        }
    }
    Ok(verdict.free && complete)
}

/// The name of a scene in answers: its file.
fn shown(scene: &Scene, given: &Path) -> String {
    scene.file().unwrap_or(given).display().to_string()
}

/// Says whether a configuration is free, and why not.
fn explain(scene: &Scene, numbers: &str, as_json: bool) -> Result<bool, Error> {
    let explanation = scene.explain(&crate::input::numbers(numbers)?)?;
    if as_json {
        print_json(&explanation)?;
        return Ok(explanation.free);
    }
    explanation.warnings.iter().for_each(|odd| note(&format!("warning: {odd}")));
    let what = explanation.fault.clone().unwrap_or_else(|| "free".to_owned());
    print(&format!("the configuration is {what}"))?;
    if explanation.in_bounds {
        print(&format!("  clearance  {} m", brief(explanation.clearance)))?;
    }
    if let Some(free) = &explanation.nearest_free {
        let numbers: Vec<_> = free.iter().map(|v| plain(*v)).collect();
        print(&format!("  the nearest free configuration found is {}", numbers.join(" ")))?;
    }
    Ok(explanation.free)
}
