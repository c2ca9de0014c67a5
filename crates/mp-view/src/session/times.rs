//! Trajectories: a path gets times as a run does, and what it got is written to files.

use super::number_of;
use super::workspace::rows_of;
use crate::PathTrack;
use crate::arrays::ArrayRef;
use crate::bytes::path_head;
use crate::message::{Message, json};
use mp_plan::{Error, Interrupt, Knots, MOMENTS, Pace, PathRows, Scene, Trajectory};
use serde_json::{Map, Value, json};

/// A path that gets times.
pub(crate) struct Timing {
    run: u64,
    rows: Vec<Vec<f64>>,
    pace: Pace,
}

impl Timing {
    /// That of a request.
    pub(crate) fn of(head: &Map<String, Value>) -> Result<Self, Error> {
        let part = |name: &str| head.get(name).and_then(Value::as_f64).unwrap_or(1.0);
        let [velocity, acceleration, jerk] = ["velocity", "acceleration", "jerk"].map(part);
        let pace = Pace { velocity, acceleration, jerk, ..Pace::default() };
        Ok(Self { run: number_of(head, "run")?, rows: rows_of(head, "rows")?, pace })
    }

    /// The event that tells its trajectory.
    pub(crate) fn timed(self, scene: &Scene, interrupt: &Interrupt) -> Result<Message, Error> {
        let Self { run, rows, pace } = self;
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        let timed = scene.time(&path, &pace, interrupt)?;
        let trajectory = &timed.trajectory;
        let track = scene.track_in_time(trajectory, MOMENTS);
        let first = trajectory.span()[0];
        let (mut velocities, mut accelerations) = (Vec::new(), Vec::new());
        for time in &track.travel {
            let sample = trajectory.at(first + time);
            velocities.extend(sample.velocity);
            accelerations.extend(sample.acceleration);
        }
        let mut event = Message::event("timed", run);
        let path = json(&path_head(&PathTrack::of("", true, None, track), &mut event.data));
        let Knots { times, positions, velocities: v, accelerations: a } = trajectory.knots();
        let knots = json!({
            "times": event.array(times), "positions": event.array(&positions.concat()),
            "velocities": event.array(&v.concat()), "accelerations": event.array(&a.concat()),
        });
        let (velocities, accelerations) = (event.array(&velocities), event.array(&accelerations));
        Ok(event
            .with("path", path)
            .with("velocities", velocities)
            .with("accelerations", accelerations)
            .with("duration", trajectory.duration())
            .with("limits", json(&scene.rate_limits()))
            .with("curve", trajectory.interpolation().to_string())
            .with("knots", knots)
            .with("summary", timed.summary())
            .with("notes", timed.notes))
    }
}

/// The trajectory whose points a request has.
pub(crate) fn trajectory_of(scene: &Scene, request: &Message) -> Result<Trajectory, Error> {
    let columns = scene.columns();
    let numbers = |name: &str| {
        let array = request.head.get("knots").and_then(|knots| knots.get(name)).cloned().unwrap_or_default();
        let array: ArrayRef = serde_json::from_value(array)
            .map_err(|_| Error::new(format!("the request has no array `{name}` of `knots`")))?;
        request.entries::<f64>(&array, name).map_err(|e| Error::new(e.to_string()))
    };
    let rows = |name: &str| -> Result<Vec<Vec<f64>>, Error> {
        Ok(numbers(name)?.chunks(columns.len().max(1)).map(<[f64]>::to_vec).collect())
    };
    let knots = Knots {
        times: numbers("times")?,
        positions: rows("positions")?,
        velocities: rows("velocities")?,
        accelerations: rows("accelerations")?,
    };
    let joints = columns.iter().map(|column| (column.name.as_str(), column.unit.as_str()));
    Ok(Trajectory::of_controller(joints, knots)?)
}
