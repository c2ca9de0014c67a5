//! The experiment of §6: trials, tables and pictures.

use super::tables::interval;
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Table, wilson};
use crate::options::Common;
use crate::plot::save_drawing;
use mp_experiments::rrs::{Followed, Following, KINDS, MARGIN, planned_and_followed};
use mp_render::{Drawing, Item};
use mp_scenes::source::disc_scenes::{DiscScene, RADIUS, tight};
use nalgebra::Point2;
use serde::{Deserialize, Serialize};

/// The numbers of trials in full and short runs.
const TRIALS: u32 = 300;
const QUICK: u32 = 10;
const COLOURS: [u32; 6] = [0xb0598a, 0xb0598a, 0xb0598a, 0x1f77b4, 0x1f77b4, 0x1f77b4];

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    path: String,
    trial: u64,
}

/// Plans and follows paths of each kind. False when it was interrupted.
pub(super) fn run(lab: &Lab, common: &Common) -> Result<bool> {
    let trials = u64::from(common.runs_or(QUICK, TRIALS));
    let scene = tight();
    let name = lab.name("rrs-follow");
    let mut log = lab.log(&name, MARGIN)?;
    let cases: Vec<Case> = (KINDS.iter())
        .flat_map(|kind| (0..trials).map(|trial| Case { path: (*kind).to_owned(), trial }))
        .collect();
    let complete = lab.measure(&mut log, "rrs, following", &cases, |case| {
        let followed = planned_and_followed(&scene, &case.path, case.trial).into_error()?;
        Ok(Some(followed.map_or(Following::default(), |f| f.run)))
    })?;
    if !complete {
        return Ok(false);
    }
    let found = || log.each(&cases).filter(|(_, run)| run.found);
    let centimetres = |all: &[&Following], value: fn(&Following) -> f64| {
        let values: Vec<f64> = all.iter().map(|run| 100.0 * value(run)).collect();
        interval(&values)
    };
    let groups = KINDS.map(|kind| {
        let runs = found().filter(|(case, _)| case.path == kind).map(|(_, run)| run).collect::<Vec<_>>();
        (kind, runs)
    });
    let summary = Table::of(
        groups,
        &[
            ("path", &|(kind, _): &(&str, Vec<&Following>)| (*kind).to_owned()),
            ("followed", &|(_, all)| all.len().to_string()),
            ("collisions, %", &|(_, all)| {
                let hits = all.iter().filter(|run| run.executed <= 0.0).count();
                let (low, high) = wilson(hits, all.len().max(1));
                let part = 100.0 * hits as f64 / all.len().max(1) as f64;
                format!("{part:.1} ({:.1} – {:.1})", 100.0 * low, 100.0 * high)
            }),
            ("arrived", &|(_, all)| all.iter().filter(|run| run.arrived).count().to_string()),
            ("length, cm", &|(_, all)| centimetres(all, |run| run.length)),
            ("clearance planned, cm", &|(_, all)| centimetres(all, |run| run.planned)),
            // Below zero where the robot hit something: as deep.
            ("driven, cm", &|(_, all)| centimetres(all, |run| run.executed)),
            ("tracking error, cm", &|(_, all)| centimetres(all, |run| run.error)),
            ("uncertainty at the end, of those that arrived, cm", &|(_, all)| {
                let arrived: Vec<&Following> = all.iter().copied().filter(|run| run.arrived).collect();
                centimetres(&arrived, |run| run.uncertainty)
            }),
        ],
    );
    lab.report(&name, &summary.markdown(), &log.table(&cases)?)?;
    // The first trial in which all paths were found.
    let all = |trial: &u64| found().filter(|(case, _)| case.trial == *trial).count() == KINDS.len();
    if let Some(trial) = (0..trials).find(all) {
        for (kind, colour) in KINDS.iter().zip(COLOURS) {
            let Some(followed) = planned_and_followed(&scene, kind, trial).into_error()? else { continue };
            let drawing = picture(&scene, kind, &followed, colour)?;
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
        100.0 * followed.run.planned,
        100.0 * followed.run.executed
    );
    let title = format!("A robot follows a path of {}", kind.to_uppercase());
    let corners = [[0.0; 2], scene.size].map(Point2::from);
    let mut drawing = Drawing::of_world(robot.world(), corners, title, subtitle);
    for place in followed.driven.iter().step_by(15) {
        let corner = |i: u32| {
            let (s, c) = mp_math::sin_cos(f64::from(i) * std::f64::consts::TAU / 40.0);
            place + nalgebra::Vector2::new(c, s) * RADIUS
        };
        drawing.items.push(Item::area(vec![(0..40).map(corner).collect()], colour).faint(0.12));
    }
    drawing.items.push(Item::lines(vec![followed.path.clone()], 0x2b3440, 2.0));
    drawing.items.push(Item::lines(vec![followed.driven.clone()], colour, 2.5));
    Ok(drawing)
}
