//! `ik`: inverse kinematics.

use crate::input::{numbers, scene};
use crate::output::{note, print, print_json};
use crate::{cli, interrupt};
use mp_io::ProblemChanges;
use mp_plan::{Error, FreeTurns, Interrupt, PoseEntry, count};

/// Prints the configurations that place a link. True when there is a free one, or any if all are asked for.
pub(crate) fn run(args: &cli::Ik) -> Result<bool, Error> {
    let (place, free) = match (&args.pose, &args.position) {
        (Some(pose), _) => (numbers(pose)?, args.free),
        (None, Some(position)) => (numbers(position)?, FreeTurns::All),
        (None, None) => return Err(Error::new("say where the link is to be").help("by --pose or --position")),
    };
    let (wanted, what) = if args.pose.is_some() { (6, "pose") } else { (3, "position") };
    if place.len() != wanted {
        return Err(Error::new(format!("the {what} has {}", count(place.len(), "number"))).help(
            "a pose is \"x y z α β γ\": metres, then radians about Z, Y and X; a position is \"x y z\"",
        ));
    }
    let entry = PoseEntry {
        link: args.link.clone(),
        pose: std::array::from_fn(|i| place.get(i).copied().unwrap_or(0.0)),
        within: [args.within.unwrap_or(0.0); 3],
        free,
    };
    let changes = ProblemChanges {
        from: args.from.clone(),
        obstacles: args.obstacle.clone(),
        ..ProblemChanges::default()
    };
    let scene = scene(&args.scene, &changes)?;
    let mut found = scene.reaching(&entry, args.most.into(), &Interrupt::new(interrupt::flag()))?;
    let in_all = found.len();
    if !args.all {
        found.retain(|reached| reached.free);
    }
    if args.json {
        print_json(&found)?;
        return Ok(!found.is_empty());
    }
    for reached in &found {
        let row: Vec<String> = reached.row.iter().map(f64::to_string).collect();
        print(&row.join(" "))?;
    }
    let names: Vec<String> = scene.columns().into_iter().map(|column| column.name).collect();
    note(&format!(
        "{} found, of which {} free; columns: {}",
        count(in_all, "configuration"),
        found.iter().filter(|reached| reached.free).count(),
        names.join(" ")
    ));
    Ok(!found.is_empty())
}
