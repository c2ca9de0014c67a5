//! `bench rrs --follow`: the tables and the picture of §6.

use super::follow::{Followed, KINDS, planned_and_followed};
use crate::assets::courses::{Course, RADIUS, follow};
use crate::bench::{Table, report};
use crate::cli;
use crate::output::{note, write};
use crate::plan::progress;
use crate::render;
use miette::{IntoDiagnostic, Result};
use mp::render::{Drawing, Item};
use nalgebra::Point2;
use rayon::prelude::*;

/// Trials, and those of a short run.
const TRIALS: u32 = 100;
const QUICK: u32 = 10;
const COLOURS: [u32; 3] = [0xb0598a, 0x1f77b4, 0x2c8a2c];

/// Plans and follows paths of each kind. True.
pub(super) fn run(args: &cli::Bench) -> Result<bool> {
    let trials = args.runs.unwrap_or(if args.quick { QUICK } else { TRIALS });
    let threads = args.rsrt.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().into_diagnostic()?;
    let course = follow();
    let jobs: Vec<(usize, u64)> =
        (0..KINDS.len()).flat_map(|k| (0..u64::from(trials)).map(move |t| (k, t))).collect();
    let bar = progress::runs(jobs.len(), true);
    let done: Vec<Result<Option<Followed>>> = pool.install(|| {
        let job = |&(kind, trial): &(usize, u64)| {
            let done = planned_and_followed(&course, KINDS[kind], trial);
            bar.inc(1);
            done
        };
        jobs.par_iter().with_max_len(1).map(job).collect()
    });
    bar.finish_and_clear();
    let done = done.into_iter().collect::<Result<Vec<_>>>()?;
    let of = |kind: usize| &done[kind * trials as usize..(kind + 1) * trials as usize];
    let mut summary = Table::new([
        "path",
        "followed",
        "collisions",
        "arrived",
        "length, cm",
        "clearance planned, cm",
        "executed, cm",
        "least tenth below, cm",
    ]);
    let mut each = Table::new(["path", "trial", "arrived", "length_m", "planned_m", "executed_m"]);
    for (k, kind) in KINDS.iter().enumerate() {
        let all: Vec<&Followed> = of(k).iter().flatten().collect();
        for (trial, one) in of(k).iter().enumerate() {
            let Some(f) = one else { continue };
            let numbers = [f.length, f.planned, f.executed].map(|v| format!("{v:.4}"));
            let head = [(*kind).to_owned(), trial.to_string(), u8::from(f.arrived).to_string()];
            each.rows.push(head.into_iter().chain(numbers).collect());
        }
        summary.rows.push(row(kind, &all));
    }
    let name = if args.quick { "rrs-follow-quick" } else { "rrs-follow" };
    report(args, name, &summary, &each)?;
    // The first trial of which all paths were found.
    let shown = (0..trials as usize).find(|&t| (0..KINDS.len()).all(|k| of(k)[t].is_some()));
    if let Some(trial) = shown {
        for (k, kind) in KINDS.iter().enumerate() {
            let Some(followed) = &of(k)[trial] else { continue };
            let drawing = picture(&course, kind, followed, COLOURS[k])?;
            let stem = args.out.join(format!("{name}-{}", kind.replace(' ', "-")));
            write(&stem.with_extension("svg"), drawing.svg((1100, 520)).into_diagnostic()?.as_bytes())?;
            render::write(&stem.with_extension("png"), &drawing.pixels((1100, 520)).into_diagnostic()?)?;
            note(&format!("written: {}.svg and .png", stem.display()));
        }
    }
    Ok(true)
}

fn row(kind: &str, all: &[&Followed]) -> Vec<String> {
    let n = all.len().max(1) as f64;
    let mean = |of: &dyn Fn(&Followed) -> f64| all.iter().map(|f| of(f)).sum::<f64>() / n;
    let mut executed: Vec<f64> = all.iter().map(|f| f.executed).collect();
    executed.sort_by(f64::total_cmp);
    let tenth = executed.get(executed.len() / 10).copied().unwrap_or(f64::NAN);
    let count = |of: &dyn Fn(&Followed) -> bool| all.iter().filter(|f| of(f)).count().to_string();
    let numbers = [mean(&|f| f.length), mean(&|f| f.planned), mean(&|f| f.executed.max(0.0)), tenth.max(0.0)];
    [kind.to_owned(), all.len().to_string(), count(&|f| f.executed <= 0.0), count(&|f| f.arrived)]
        .into_iter()
        .chain(numbers.map(|v| format!("{:.2}", 100.0 * v)))
        .collect()
}

/// The path, dark, and where the robot went, with the robot at places.
fn picture(course: &Course, kind: &str, followed: &Followed, colour: u32) -> Result<Drawing> {
    let robot = course.robot()?;
    let subtitle = format!(
        "least distance from an obstacle: {:.1} cm planned, {:.1} cm driven",
        100.0 * followed.planned,
        100.0 * followed.executed.max(0.0)
    );
    let title = format!("A robot follows a path of {}", kind.to_uppercase());
    let corners = [[0.0; 2], course.size].map(Point2::from);
    let mut drawing = Drawing::of_world(robot.world(), corners, title, subtitle);
    for place in followed.driven.iter().step_by(15) {
        let corner = |i: u32| {
            let (s, c) = (f64::from(i) * std::f64::consts::TAU / 40.0).sin_cos();
            place + nalgebra::Vector2::new(c, s) * RADIUS
        };
        drawing.items.push(Item::area(vec![(0..40).map(corner).collect()], colour).faint(0.12));
    }
    drawing.items.push(Item::lines(vec![followed.path.clone()], 0x2b3440, 2.0));
    drawing.items.push(Item::lines(vec![followed.driven.clone()], colour, 2.5));
    Ok(drawing)
}
