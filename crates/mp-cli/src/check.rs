//! `check`: verifies a path with the checker that shares no code with that of the planners.

use crate::cli::Check;
use crate::input::{path, refuse_two_standard_inputs, scene};
use crate::interrupt;
use crate::output::{Claims, note, print, print_json, write};
use mp_plan::{Error, Interrupt, Scene, brief, plain};
use std::path::Path;

/// Verifies a path, or explains a configuration. True when the path or configuration is free.
pub(crate) fn run(args: &Check) -> Result<bool, Error> {
    refuse_two_standard_inputs(&args.scene, args.path.as_deref())?;
    let scene = scene(&args.scene, &args.changes.of_problem())?.keeping(args.clearance.unwrap_or(0.0))?;
    if let Some(numbers) = &args.at {
        return explain(&scene, numbers, args.json);
    }
    let Some(file) = &args.path else { return Err(Error::new("name a path")) };
    if let Some(certificate) = &args.certificate {
        let mut claims = Claims::default();
        scene.inputs_on_disk().iter().for_each(|file| claims.input(file));
        claims.input(file);
        claims.output("--certificate", certificate)?;
    }
    let rows = path(&scene, file)?;
    let mut verdict = scene.check(&rows)?;
    if let (Some(file), true) = (&args.certificate, verdict.free) {
        let certificate = scene.certificate(&rows, verdict.clearance, &Interrupt::new(interrupt::flag()))?;
        write(file, certificate.to_json().as_bytes())?;
    }
    (verdict.scene, verdict.path) = (shown(&scene, &args.scene), file.display().to_string());
    match args.json {
        true => print_json(&verdict)?,
        false => {
            verdict.warnings.iter().for_each(|odd| note(&format!("warning: {odd}")));
            print(&verdict.summary())?;
        }
    }
    Ok(verdict.free)
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
