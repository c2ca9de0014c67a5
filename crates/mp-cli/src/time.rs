//! `time`: gives a path times.

use crate::input::{is_standard, path, refuse_two_standard_inputs, scene};
use crate::output::{Claims, note, print, write};
use crate::{cli, interrupt};
use mp_plan::{Error, Interrupt, TimedPath, TrajectoryKind};
use std::path::Path;

/// Times a path. Always true, as one that cannot be timed is an error.
pub(crate) fn run(args: &cli::Time) -> Result<bool, Error> {
    refuse_two_standard_inputs(&args.scene, Some(&args.path))?;
    let scene = scene(&args.scene, &args.changes.of_problem())?;
    let kind = args.out.as_deref().map_or(Ok(TrajectoryKind::Csv), kind_of)?;
    if let Some(out) = args.out.as_ref().filter(|out| !is_standard(out)) {
        let mut claims = Claims::default();
        scene.inputs_on_disk().iter().chain([&args.path]).for_each(|file| claims.input(file));
        claims.output("--out", out)?;
    }
    let (rows, interrupt) = (path(&scene, &args.path)?, Interrupt::new(interrupt::flag()));
    let pace = args.pace.pace();
    let timed = scene.time(&rows, &pace, &interrupt)?;
    let trajectory = match args.rate {
        None => timed.trajectory.clone(),
        Some(rate) => {
            let (sampled, faults) = scene.at_rate(&timed.trajectory, rate, &pace, &interrupt)?;
            // Those of its ends are those of the path.
            let faults = faults.iter().filter(|fault| !timed.ends.contains(fault));
            faults.for_each(|fault| note(&format!("warning: at {rate} Hz {fault}")));
            sampled
        }
    };
    let bytes = scene.trajectory_bytes(&trajectory, kind)?;
    match &args.out {
        Some(out) => write(out, &bytes)?,
        None => print(String::from_utf8_lossy(&bytes).trim_end())?,
    }
    say(&timed);
    Ok(true)
}

/// The kind of a file for a trajectory, by the ending of its name.
pub(crate) fn kind_of(file: &Path) -> Result<TrajectoryKind, Error> {
    TrajectoryKind::of(file).ok_or_else(|| {
        Error::new(format!("{}: no format for trajectories is called so", file.display()))
            .help("name a file that ends in .csv, .json, .yaml or .mcap")
    })
}

/// Says what a trajectory is like to the person watching.
pub(crate) fn say(timed: &TimedPath) {
    timed.ends.iter().for_each(|fault| note(&format!("warning: the path {fault}")));
    timed.notes.iter().for_each(|line| note(&format!("note: {line}")));
    note(&format!("trajectory: {}", timed.summary()));
}
