//! The experiment of §6: trials, tables and pictures.

use super::follow::{Followed, KINDS, planned_and_followed};
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Table, bit, mean};
use crate::options::Common;
use crate::plot::save_drawing;
use mp_render::{Drawing, Item};
use mp_scenes::source::disc_scenes::{DiscScene, RADIUS, follow};
use nalgebra::Point2;

/// The numbers of trials in full and short runs.
const TRIALS: u32 = 100;
const QUICK: u32 = 10;
const COLOURS: [u32; 3] = [0xb0598a, 0x1f77b4, 0x2c8a2c];

/// Plans and follows paths of each kind. False when it was interrupted.
pub(super) fn run(lab: &Lab, common: &Common) -> Result<bool> {
    let trials = common.runs_or(QUICK, TRIALS);
    let scene = follow();
    let jobs: Vec<(&str, u64)> =
        KINDS.iter().flat_map(|kind| (0..u64::from(trials)).map(move |trial| (*kind, trial))).collect();
    let done = lab.all("rrs, following", &jobs, |&(kind, trial)| {
        Ok(Some(planned_and_followed(&scene, kind, trial)?))
    })?;
    let Some(done) = done else { return Ok(false) };
    let of = |kind: usize| &done[kind * trials as usize..(kind + 1) * trials as usize];
    let trial = |i: usize| (KINDS[i / trials as usize], i % trials as usize);
    let each = Table::of(
        done.iter().enumerate().filter_map(|(i, f)| Some((trial(i), f.as_ref()?))),
        &[
            ("path", &|((kind, _), _)| (*kind).to_owned()),
            ("trial", &|((_, trial), _)| trial.to_string()),
            ("arrived", &|(_, f)| bit(f.arrived)),
            ("length_m", &|(_, f)| format!("{:.4}", f.length)),
            ("planned_m", &|(_, f)| format!("{:.4}", f.planned)),
            ("executed_m", &|(_, f)| format!("{:.4}", f.executed)),
        ],
    );
    let centimetres = |all: &[&Followed], value: fn(&Followed) -> f64| {
        format!("{:.2}", 100.0 * mean(all.iter().map(|f| value(f))).unwrap_or(0.0))
    };
    let summary = Table::of(
        KINDS.iter().enumerate().map(|(k, kind)| (*kind, of(k).iter().flatten().collect())),
        &[
            ("path", &|(kind, _): &(&str, Vec<&Followed>)| (*kind).to_owned()),
            ("followed", &|(_, all)| all.len().to_string()),
            ("collisions", &|(_, all)| all.iter().filter(|f| f.executed <= 0.0).count().to_string()),
            ("arrived", &|(_, all)| all.iter().filter(|f| f.arrived).count().to_string()),
            ("length, cm", &|(_, all)| centimetres(all, |f| f.length)),
            ("clearance planned, cm", &|(_, all)| centimetres(all, |f| f.planned)),
            ("executed, cm", &|(_, all)| centimetres(all, |f| f.executed.max(0.0))),
            ("least tenth below, cm", &|(_, all)| {
                let mut executed: Vec<f64> = all.iter().map(|f| f.executed).collect();
                executed.sort_by(f64::total_cmp);
                let tenth = executed.get(executed.len() / 10).copied().unwrap_or(f64::NAN);
                format!("{:.2}", 100.0 * tenth.max(0.0))
            }),
        ],
    );
    let name = lab.name("rrs-follow");
    lab.report(&name, &summary, &each)?;
    // The first trial in which all paths were found.
    let shown = (0..trials as usize).find(|&t| (0..KINDS.len()).all(|k| of(k)[t].is_some()));
    if let Some(trial) = shown {
        for (k, kind) in KINDS.iter().enumerate() {
            let Some(followed) = &of(k)[trial] else { continue };
            let drawing = picture(&scene, kind, followed, COLOURS[k])?;
            let stem = lab.file(&format!("{name}-{}", kind.replace(' ', "-")));
            save_drawing(&stem, &drawing, (1100, 520))?;
        }
    }
    Ok(true)
}

/// A drawing of the path, dark, and of the line the robot drove, with the robot at some of its positions.
fn picture(scene: &DiscScene, kind: &str, followed: &Followed, colour: u32) -> Result<Drawing> {
    let robot = scene.robot().into_error()?;
    let subtitle = format!(
        "least distance from an obstacle: {:.1} cm planned, {:.1} cm driven",
        100.0 * followed.planned,
        100.0 * followed.executed.max(0.0)
    );
    let title = format!("A robot follows a path of {}", kind.to_uppercase());
    let corners = [[0.0; 2], scene.size].map(Point2::from);
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
