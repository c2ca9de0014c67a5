//! Trajectories of a scene: paths that get times, the check of curves, and their files.

use crate::finish::certificate::certificate;
use crate::finish::trajectory::{UNKNOWN, check, time};
use crate::sweep::track_in_time;
use crate::{Body, BodyShape, Certificate, Error, Pace, PathRows, Scene, TimedPath, Track, Verdict, plain};
use mp_cspace::Interrupt;
use mp_io::{Column, KnownJoints, RecordedBody, RecordedShape, Recording, TrajectoryFile, TrajectoryKind};
use mp_time::{Interpolation, Knots, Trajectory};
use nalgebra::Point2;
use std::f64::consts::TAU;
use std::path::Path;

impl Scene {
    /// Whether the robot has trajectories: an arm does whose base stands still or moves in the plane.
    #[must_use]
    pub fn has_trajectories(&self) -> bool {
        self.robot.rates().is_some()
    }

    /// The limits of velocity (rad/s or m/s) and acceleration (per s²) of each column that [`time`](Self::time) keeps to: 1 where none is known.
    /// `None` for robots without [trajectories](Self::has_trajectories).
    #[must_use]
    pub fn rate_limits(&self) -> Option<Vec<[f64; 2]>> {
        let known = self.robot.rates()?;
        Some(known.into_iter().map(|[v, a, _]| [v, a].map(|limit| limit.unwrap_or(UNKNOWN))).collect())
    }

    /// Samples a trajectory for an animation, at equal intervals of time: `rate` samples per second, or fewer where these would be
    /// thousands. [`travel`](Track::travel) has the seconds from its first point.
    #[must_use]
    pub fn track_in_time(&self, trajectory: &Trajectory, rate: f64) -> Track {
        track_in_time(&*self.robot, trajectory, rate)
    }

    /// Gives a path times: goes along it as fast as the limits of velocity, acceleration and jerk allow, with rounded corners (TOPP-RA), and proves the
    /// curve that a controller runs between the points of the trajectory. The same path and pace give the same trajectory.
    ///
    /// ```
    /// use mp_plan::{Interrupt, Pace, PathRows, Request, Scene};
    /// let scene = Scene::find("arm-6")?;
    /// let report = scene.plan(&Request::default())?;
    /// let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows: report.path.unwrap_or_default() };
    /// let timed = scene.time(&path, &Pace { velocity: 0.5, ..Pace::default() }, &Interrupt::never())?;
    /// assert!(timed.trajectory.fastest(0).amount <= 0.5 * 3.1416);
    /// # Ok::<(), mp_plan::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the robot is no arm whose base stands still or moves in the plane; when the path is not free, or its curve is not proved before
    /// `interrupt` says to end; and when the pace is not valid.
    pub fn time(&self, path: &PathRows, pace: &Pace, interrupt: &Interrupt) -> Result<TimedPath, Error> {
        time(&*self.robot, path, pace, interrupt)
    }

    /// Verifies the curve of a trajectory from the start to a goal: that it is free, and within the limits of position, velocity, acceleration
    /// and jerk that are known. Its joints must be those of [`columns`](Self::columns), in this order.
    ///
    /// # Errors
    /// When the trajectory is of another robot, or the robot has none, or `interrupt` ends the proof. One that is not free is no error: see [`Verdict::free`].
    pub fn check_trajectory(&self, trajectory: &Trajectory, interrupt: &Interrupt) -> Result<Verdict, Error> {
        check(&*self.robot, trajectory, None, interrupt)
    }

    /// A [timed](Self::time) trajectory with points `rate` times a second, whose curve between those is proved free, and what else is
    /// wrong with it, in sentences: limits at this pace that it exceeds, and ends.
    ///
    /// # Errors
    /// When the curve is not free, or is not proved before `interrupt` says to end; and when there would be too many points.
    pub fn at_rate(
        &self,
        trajectory: &Trajectory,
        rate: f64,
        pace: &Pace,
        interrupt: &Interrupt,
    ) -> Result<(Trajectory, Vec<String>), Error> {
        let sampled = trajectory.resampled(rate)?.in_nanoseconds()?;
        let verdict = check(&*self.robot, &sampled, Some(pace), interrupt)?;
        match verdict.trajectory.is_none_or(|t| t.collides_at.is_some()) {
            true => {
                Err(Error::new(format!("at {rate} Hz the curve is not free: {}", verdict.faults.join("; ")))
                    .help("take a higher rate"))
            }
            false => Ok((sampled, verdict.faults)),
        }
    }

    /// The certificate of a trajectory, of the curve between its points: as that [of a path](Self::certificate).
    ///
    /// # Errors
    /// As there.
    pub fn certificate_of_trajectory(
        &self,
        trajectory: &Trajectory,
        clearance: f64,
        interrupt: &Interrupt,
    ) -> Result<Certificate, Error> {
        let rows = trajectory.knots().positions.clone();
        let path = PathRows { format: self.path_format(), columns: self.columns(), rows };
        certificate(&*self.robot, &path, Some(trajectory), clearance, interrupt)
    }

    /// Reads a trajectory of the robot from a file: `.csv`, `.json`, `.yaml` or `.mcap`. The curve between its points is `curve`, or what
    /// `joint_trajectory_controller` of ROS runs. `None` if the file has no times: then it is a path, or something else.
    ///
    /// # Errors
    /// When the file cannot be read, its columns are not those of the robot, or it is no trajectory: with file, line and column.
    pub fn read_trajectory(
        &self,
        file: impl AsRef<Path>,
        curve: Option<Interpolation>,
    ) -> Result<Option<Trajectory>, Error> {
        let Some(kind) = TrajectoryKind::of(file.as_ref()) else { return Ok(None) };
        let (name, bytes) = mp_io::read_text(file.as_ref())?;
        self.parse_trajectory(&name, &bytes, kind, curve)
    }

    /// As [`read_trajectory`](Self::read_trajectory), from the content of a file that errors call `name`.
    ///
    /// # Errors
    /// As there.
    pub fn parse_trajectory(
        &self,
        name: &str,
        bytes: &[u8],
        kind: TrajectoryKind,
        curve: Option<Interpolation>,
    ) -> Result<Option<Trajectory>, Error> {
        if !self.has_trajectories() {
            return Ok(None);
        }
        let columns = self.columns();
        let turns = columns
            .iter()
            .zip(self.limits())
            .map(|(column, limits)| limits.is_none() && column.unit == "rad");
        let endless: Vec<_> = turns.collect();
        let followers = self.robot.followers();
        let known = KnownJoints { endless: &endless, followers: &followers };
        let read = TrajectoryFile::parse_of(name, bytes, kind, &columns, known)?;
        let Some(read) = read else { return Ok(None) };
        self.begins_as(name, &read)?;
        let TrajectoryFile { joints, times, positions, velocities, accelerations, .. } = read;
        let joints = joints.iter().map(|joint| (joint.name.as_str(), joint.unit.as_str()));
        let knots = Knots { times, positions, velocities, accelerations };
        let made = match curve {
            Some(curve) => Trajectory::new(joints, knots, curve),
            None => Trajectory::of_controller(joints, knots),
        };
        made.map(Some).map_err(|e| Error::from(e).context(name.to_owned()))
    }

    /// Whether the state before the trajectory, if the file has it, is that of the scene: joints that are held, and what is attached.
    fn begins_as(&self, name: &str, read: &TrajectoryFile) -> Result<(), Error> {
        let wrong = |message: String, expected: &str| {
            Err(Error::from(mp_io::Error::new(mp_io::ErrorKind::Content, name, message).expected(expected)))
        };
        for (joint, at, turns) in self.robot.held() {
            let off = |there: &f64| {
                let whole = if turns { ((there - at) / TAU).round() * TAU } else { 0.0 };
                (there - at - whole).abs() > TrajectoryFile::START
            };
            let there = read.start.iter().find(|(known, _)| *known == joint).map(|(_, there)| *there);
            if let Some(there) = there.filter(off) {
                let message = format!(
                    "`trajectory_start` has {joint} at {}, and the scene holds it at {}",
                    plain(there),
                    plain(at)
                );
                return wrong(message, "the same: say where it is held by `hold` in the problem file");
            }
        }
        let bodies = self.bodies();
        match read
            .attached
            .iter()
            .find(|id| bodies.iter().all(|body| body.pose.is_some() || body.name != **id))
        {
            None => Ok(()),
            Some(id) => wrong(
                format!("the robot carries \"{id}\" in `trajectory_start`, and not in the scene"),
                "the same: `[[attached]]` in the problem file fixes things to a link",
            ),
        }
    }

    /// The content of a file of this kind with a trajectory of the robot. Its curve reads back to the same bits if its times are
    /// [whole nanoseconds](Trajectory::in_nanoseconds). A recording shows the robot among its obstacles too, [`MOMENTS`] times a second.
    ///
    /// # Errors
    /// When the trajectory is of another robot.
    pub fn trajectory_bytes(&self, trajectory: &Trajectory, kind: TrajectoryKind) -> Result<Vec<u8>, Error> {
        let file = of_knots(trajectory, trajectory.knots().clone());
        if kind != TrajectoryKind::Mcap {
            return Ok(file.to_bytes(kind));
        }
        let moments = trajectory.resampled(MOMENTS)?.in_nanoseconds()?;
        let sampled = of_knots(trajectory, Knots { accelerations: Vec::new(), ..moments.knots().clone() });
        let poses = sampled.positions.iter().map(|row| self.poses(row)).collect::<Result<_, _>>()?;
        let bodies = self.bodies().into_iter().map(recorded).collect();
        Ok(Recording { trajectory: file, sampled, bodies, poses }.to_mcap())
    }
}

/// How many times a second recordings and the page have the joints and the bodies.
pub const MOMENTS: f64 = 50.0;

fn of_knots(trajectory: &Trajectory, knots: Knots) -> TrajectoryFile {
    let Knots { times, positions, velocities, accelerations } = knots;
    let joints = trajectory.joints().map(|(name, unit)| Column::new(name, unit)).collect();
    TrajectoryFile { joints, times, positions, velocities, accelerations, ..TrajectoryFile::default() }
}

/// A body as recordings have it: the robot blue, obstacles grey.
fn recorded(body: Body) -> RecordedBody {
    let color = if body.pose.is_some() { [0.6, 0.6, 0.6, 1.0] } else { [0.27, 0.47, 0.67, 1.0] };
    let flat = |p: &Point2<f64>| [p.x, p.y, 0.0];
    let ends = |all: &[Vec<Point2<f64>>], closed: bool| {
        let line = |line: &Vec<Point2<f64>>| {
            let next = line.iter().skip(1).chain(line.iter().take(usize::from(closed)));
            line.iter().zip(next).flat_map(|(a, b)| [flat(a), flat(b)]).collect::<Vec<_>>()
        };
        RecordedShape::Lines(all.iter().flat_map(line).collect())
    };
    let shape = match &body.shape {
        BodyShape::Mesh(mesh) => {
            let corners = mesh.triangles().iter().flatten().map(|i| mesh.vertices()[*i as usize].into());
            RecordedShape::Triangles(corners.collect())
        }
        BodyShape::Area(rings) => ends(rings, true),
        BodyShape::Lines(lines) => ends(lines, false),
    };
    RecordedBody { name: body.name, shape, pose: body.pose.unwrap_or_default(), color }
}
