//! Scene files made of scenes, paths and reports of `mp-plan`.

use crate::{Area, Body, Configuration, Mesh, PathTrack, Polyline, Role, SceneFile, Shape};
use mp_plan::{BodyShape, Error, PathRows, Report, Scene, Track};
use nalgebra::{Isometry3, Point3, Translation3, Vector3};

/// How many times its size a scene must be away from the origin to be far: numbers of 32 bits are wrong by up to 6e-8 of their size.
const FAR: f64 = 1000.0;

/// The colour of obstacles that move.
const MOVING: [u8; 3] = [0x8d, 0x99, 0xae];

impl SceneFile {
    /// The bodies of `scene`, its start and its goals.
    ///
    /// # Errors
    /// Never for the scenes of `mp-plan`; a kind of robot of your own may refuse its own start or goals.
    pub fn of(scene: &Scene) -> Result<Self, Error> {
        Self::about(scene, Vector3::zeros())
    }

    /// As [`of`](Self::of), for a file or a page without a planner: where the scene is so far from the origin that numbers of 32 bits
    /// would move its bodies, as in coordinates of surveys, places are relative to its middle, which becomes the `origin` of the file.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn for_file(scene: &Scene) -> Result<Self, Error> {
        let file = Self::of(scene)?;
        file.far().map_or(Ok(file), |middle| Self::about(scene, middle))
    }

    /// The middle of the scene, where it is too far from the origin for numbers of 32 bits.
    pub(crate) fn far(&self) -> Option<Vector3<f64>> {
        let [low, high] = self.bounds.map(Vector3::from);
        let middle = (low + high) / 2.0;
        (middle.amax() > FAR * (high - low).amax()).then_some(middle)
    }

    fn about(scene: &Scene, origin: Vector3<f64>) -> Result<Self, Error> {
        let mut file = Self {
            name: scene.name().to_owned(),
            space: scene.space(),
            planar: scene.is_planar(),
            columns: scene.columns(),
            limits: scene.limits(),
            bounds: [[0.0; 3]; 2],
            origin: origin.into(),
            meshes: Vec::new(),
            areas: Vec::new(),
            lines: Vec::new(),
            bodies: Vec::new(),
            start: configuration(scene, scene.start(), &origin)?,
            goals: scene
                .goals()
                .into_iter()
                .map(|row| configuration(scene, row, &origin))
                .collect::<Result<_, _>>()?,
            paths: Vec::new(),
            trees: Vec::new(),
            roadmap: None,
            report: None,
        };
        let mut bounds = Bounds::default();
        let mut ends = Vec::new();
        for row in scene.goals().into_iter().chain([scene.start()]) {
            ends.push(poses(scene, &row, &origin)?);
        }
        // Obstacles that move have poses along the path, as the robot has, and the colour of obstacles.
        let bodies = scene.bodies();
        let own = bodies.iter().filter(|body| body.pose.is_none()).count() - scene.moving_obstacles();
        let mut robots = 0;
        for body in bodies {
            let points = corners(&body.shape);
            let moved = body.pose.map(|pose| Translation3::from(-origin) * pose);
            match &moved {
                Some(pose) => bounds.add(points.iter().map(|p| pose * p)),
                None => {
                    // What moves by itself may go far away: it is enough where it begins, at the start, which is the last.
                    let shown = if robots < own { &ends[..] } else { &ends[ends.len() - 1..] };
                    let poses = shown.iter().filter_map(|poses| poses.get(robots));
                    poses.for_each(|pose| bounds.add(points.iter().map(|p| pose * p)));
                    robots += 1;
                }
            }
            // The points of a shape are written with 32 bits too: about their middle, if that is far away.
            let middle = moved.filter(|_| origin != Vector3::zeros()).map(|_| middle_of(&points));
            let middle = middle.unwrap_or_default();
            let pose = moved.map(|pose| seven(&(pose * Translation3::from(middle))));
            let name = body.name;
            let role = match pose {
                Some(_) => Role::Obstacle,
                None if robots > own => Role::Moving,
                None => Role::Robot,
            };
            let shape = file.add_shape(&body.shape, middle);
            let color = (role == Role::Moving).then_some(MOVING);
            file.bodies.push(Body { name, role, shape, pose, color });
        }
        file.bounds = bounds.get();
        Ok(file)
    }

    /// Adds a path of the scene, called `name`. The scene's verifier says whether it is verified.
    ///
    /// # Errors
    /// When the path is of another robot.
    pub fn add_path(&mut self, scene: &Scene, name: &str, path: &PathRows) -> Result<(), Error> {
        let verdict = scene.check(path)?;
        self.add_judged_path(scene, name, path, verdict.free, verdict.path_length)
    }

    /// As [`add_path`](Self::add_path), for a path of this length whose verdict is known.
    ///
    /// # Errors
    /// As [`add_path`](Self::add_path).
    pub fn add_judged_path(
        &mut self,
        scene: &Scene,
        name: &str,
        path: &PathRows,
        verified: bool,
        length: f64,
    ) -> Result<(), Error> {
        let (mut track, origin) = (scene.track(path)?, Vector3::from(self.origin));
        track.poses.iter_mut().flatten().for_each(|pose| pose.translation.vector -= origin);
        track.trace.iter_mut().for_each(|p| *p -= origin);
        self.paths.push(PathTrack::of(name, verified, Some(length), track));
        Ok(())
    }

    /// Adds the report of a run, and its path if it has one. The scene's verifier checks the path again, because a report
    /// may come from a file.
    ///
    /// # Errors
    /// When the path is of another robot.
    pub fn add_report(&mut self, scene: &Scene, report: &Report) -> Result<(), Error> {
        let verdict = path_of(scene, report).map(|path| scene.check(&path)).transpose()?;
        self.put_report(scene, report, verdict.map(|verdict| (verdict.free, verdict.path_length)))
    }

    /// As [`add_report`](Self::add_report), of a run of this program: its path was verified, and is not checked again.
    ///
    /// # Errors
    /// When the path is of another robot.
    pub fn add_run(&mut self, scene: &Scene, report: &Report) -> Result<(), Error> {
        self.put_report(scene, report, report.path_length.map(|length| (report.verified, length)))
    }

    fn put_report(
        &mut self,
        scene: &Scene,
        report: &Report,
        judged: Option<(bool, f64)>,
    ) -> Result<(), Error> {
        let mut written = serde_json::to_value(report).ok();
        if let (Some(path), Some((verified, length))) = (path_of(scene, report), judged) {
            self.add_judged_path(scene, &report.planner, &path, verified, length)?;
            // A path that is too long to be shown whole is too long to be written here whole.
            let shown = self.paths.last().map_or(0, |track| track.travel.as_ref().map_or(0, Vec::len));
            if shown < path.rows.len() {
                written.iter_mut().for_each(|report| report["path"] = serde_json::Value::Null);
            }
        }
        self.report = written;
        Ok(())
    }

    /// Adds the points of a shape, relative to one in its frame.
    fn add_shape(&mut self, shape: &BodyShape, middle: Vector3<f64>) -> Shape {
        let flat = |p: &nalgebra::Point2<f64>| [(p.x - middle.x) as f32, (p.y - middle.y) as f32];
        match shape {
            BodyShape::Mesh(mesh) => {
                self.meshes.push(Mesh {
                    positions: mesh
                        .vertices()
                        .iter()
                        .map(|p| p - middle)
                        .flat_map(|p| [p.x as f32, p.y as f32, p.z as f32])
                        .collect(),
                    triangles: mesh.triangles().iter().flatten().copied().collect(),
                });
                Shape::Mesh(self.meshes.len() - 1)
            }
            BodyShape::Area(rings) => {
                let ring = |ring: &Vec<nalgebra::Point2<f64>>| ring.iter().flat_map(flat).collect();
                self.areas.push(Area { rings: rings.iter().map(ring).collect() });
                Shape::Area(self.areas.len() - 1)
            }
            BodyShape::Lines(lines) => {
                let first = self.lines.len();
                let line = |line: &Vec<nalgebra::Point2<f64>>| Polyline {
                    points: line.iter().map(flat).flat_map(|[x, y]| [x, y, 0.0]).collect(),
                };
                self.lines.extend(lines.iter().map(line));
                Shape::Lines((first..self.lines.len()).collect())
            }
        }
    }
}

impl PathTrack {
    /// The track of a path of this length in the metric of the space.
    #[must_use]
    pub fn of(name: &str, verified: bool, length: Option<f64>, track: Track) -> Self {
        Self {
            name: name.to_owned(),
            verified,
            length,
            rows: track.rows.into_iter().flatten().collect(),
            poses: track.poses.iter().flatten().flat_map(seven).map(|x| x as f32).collect(),
            trace: track.trace.iter().flat_map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect(),
            clearance: Some(track.clearance.into_iter().map(|c| c as f32).collect()),
            travel: Some(track.travel.into_iter().map(|s| s as f32).collect()),
            corners: (!track.corners.is_empty()).then(|| track.corners.iter().map(|&i| i as u32).collect()),
        }
    }
}

fn path_of(scene: &Scene, report: &Report) -> Option<PathRows> {
    let rows = report.path.clone()?;
    Some(PathRows { format: scene.path_format(), columns: report.columns.clone(), rows })
}

/// A configuration with the poses of the robot's bodies relative to `origin`.
fn configuration(scene: &Scene, row: Vec<f64>, origin: &Vector3<f64>) -> Result<Configuration, Error> {
    let poses = poses(scene, &row, origin)?.iter().flat_map(seven).collect();
    Ok(Configuration { row, poses })
}

/// The poses of the robot's bodies relative to `origin`.
fn poses(scene: &Scene, row: &[f64], origin: &Vector3<f64>) -> Result<Vec<Isometry3<f64>>, Error> {
    let mut poses = scene.poses(row)?;
    poses.iter_mut().for_each(|pose| pose.translation.vector -= origin);
    Ok(poses)
}

/// The middle of the box around points.
fn middle_of(points: &[Point3<f64>]) -> Vector3<f64> {
    let mut bounds = Bounds::default();
    bounds.add(points.iter().copied());
    let [low, high] = bounds.get().map(Vector3::from);
    (low + high) / 2.0
}

/// x y z, and the unit quaternion x y z w.
pub(crate) fn seven(pose: &Isometry3<f64>) -> [f64; 7] {
    let (t, q) = (pose.translation.vector, pose.rotation.coords);
    [t.x, t.y, t.z, q.x, q.y, q.z, q.w]
}

/// The points of a shape that bound it, in its own frame.
fn corners(shape: &BodyShape) -> Vec<Point3<f64>> {
    match shape {
        BodyShape::Mesh(mesh) => mesh.vertices().to_vec(),
        BodyShape::Area(lines) | BodyShape::Lines(lines) => {
            lines.iter().flatten().map(|p| Point3::new(p.x, p.y, 0.0)).collect()
        }
    }
}

/// The box around points.
#[derive(Default)]
struct Bounds(Option<[Point3<f64>; 2]>);

impl Bounds {
    fn add(&mut self, points: impl Iterator<Item = Point3<f64>>) {
        for p in points {
            let [low, high] = self.0.unwrap_or([p, p]);
            self.0 = Some([low.inf(&p), high.sup(&p)]);
        }
    }

    /// Its least and greatest corner; a unit box where there is no point.
    fn get(self) -> [[f64; 3]; 2] {
        self.0.map_or([[-0.5; 3], [0.5; 3]], |[low, high]| [low.into(), high.into()])
    }
}
