//! The model of a robot among its obstacles: all that a proof needs, as numbers.

use mp_geom::TriMesh;
use mp_robot::Trajectory;
use nalgebra::{Isometry3, Point2, Point3};
use serde::{Deserialize, Serialize};

/// A robot among its obstacles, and how they move. It says everything that decides whether a path is free, without a word of how
/// paths are found. docs/formats/certificate.md describes its JSON form.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionModel {
    /// The degrees of freedom, and how each goes from one row of a path to the next unless inputs move them.
    pub steps: Vec<Step>,
    /// The column of the time (s), if obstacles move.
    pub time: Option<usize>,
    /// How inputs move the robot, if it is moved by inputs.
    pub drive: Option<Drive>,
    /// The frames, parents before children.
    pub frames: Vec<ModelFrame>,
    /// The bodies: those of the robot first.
    pub bodies: Vec<ModelBody>,
    /// What must stay apart.
    pub pairs: Vec<ModelPair>,
}

/// How numbers of a row go evenly from one row to the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// Six columns from this one on: x, y, z straight, and α, β, γ by the shortest turn.
    Pose(usize),
    /// A column goes straight.
    Line(usize),
    /// A column is an angle and goes the shorter way round.
    Circle(usize),
}

/// The columns of a robot that is moved by inputs. Those of the configuration come first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// How inputs move it.
    pub by: DriveModel,
    /// The first column of the velocities; one for each degree of freedom, of a robot with accelerations.
    pub velocities: usize,
    /// The first column of the input that led to the row.
    pub inputs: usize,
    /// The column that says for how long it was held (s): the last one.
    pub duration: usize,
}

/// How inputs move a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriveModel {
    /// A car: x, y, yaw; speed (m/s) and steering angle (rad).
    Car {
        /// The distance between the axles, metres.
        wheelbase: f64,
    },
    /// A unicycle: x, y, yaw; speed (m/s) and turning rate (rad/s).
    Unicycle,
    /// Each degree of freedom has a velocity.
    Velocities,
    /// Each degree of freedom has an acceleration.
    Accelerations,
}

/// A frame, and how it moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelFrame {
    /// It stands still in its parent, or in the world: x, y, z, and the quaternion i, j, k, w.
    Fixed {
        /// The parent; the world if there is none.
        parent: Option<usize>,
        /// Its pose there.
        pose: [f64; 7],
    },
    /// Six columns of the row from this one on are its pose in the world: x, y, z, α, β, γ.
    Pose {
        /// The first column.
        first: usize,
    },
    /// Columns of the row are its place in the plane z = 0 and its turn about Z.
    Plane {
        /// The column of x; that of y is the next.
        first: usize,
        /// The column of the angle; it does not turn if there is none.
        yaw: Option<usize>,
    },
    /// It turns about an axis, or slides along it.
    Joint {
        /// The index of the parent frame.
        parent: usize,
        /// Its pose there at value zero.
        origin: [f64; 7],
        /// The axis, of unit length, in its own frame.
        axis: [f64; 3],
        /// Whether the joint slides along its axis; if not, it turns about it.
        slides: bool,
        /// The column of its value; none if it does not move.
        column: Option<usize>,
        /// The value is this times the column …
        factor: f64,
        /// … plus this.
        offset: f64,
    },
    /// It moves in the world as time goes, evenly from pose to pose; it stands still before the first and after the last.
    Track {
        /// The column of the time.
        time: usize,
        /// Time (s), x, y, z, i, j, k, w.
        poses: Vec<[f64; 8]>,
    },
}

/// A body: convex pieces, which are the hulls of some of its vertices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelBody {
    /// What messages call it.
    pub name: String,
    /// The index of the frame that carries it.
    pub frame: usize,
    /// Whether it belongs to the robot; if not, it is an obstacle.
    pub of_robot: bool,
    /// All that is within this distance of its pieces belongs to it, metres.
    pub radius: f64,
    /// The distances for each of its pieces alone, of which `radius` is the largest; none where that is the one of all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub radii: Vec<f64>,
    /// The vertices in its frame, metres.
    pub vertices: Vec<[f64; 3]>,
    /// The vertices of each piece: triangles in space, those of a point thrice; edges in the plane.
    pub pieces: Vec<Vec<u32>>,
    /// What its pieces are, one part after the other: together they have all pieces.
    pub parts: Vec<ModelPart>,
}

/// A run of pieces of a body: how many follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelPart {
    /// They are closed, and what they enclose belongs to the body too: nothing may be inside. Triangles face outward.
    Solid(usize),
    /// Only they belong to the body.
    Surface(usize),
}

impl ModelBody {
    /// A mesh, with its solids; of balls, their centres and radii.
    pub(crate) fn mesh(name: &str, frame: usize, mesh: &TriMesh) -> Self {
        if mesh.is_balls() {
            let radius = mesh.rounding().unwrap_or(0.0);
            let mut radii: Vec<f64> = mesh.each_ball().map(|ball| ball.radius).collect();
            if radii.iter().all(|own| *own == radius) {
                radii.clear();
            }
            return Self { radius, radii, ..Self::mesh(name, frame, &mesh.clone().without_balls()) };
        }
        let mesh = &mesh.faceted();
        Self {
            name: name.to_owned(),
            frame,
            of_robot: false,
            radius: 0.0,
            radii: Vec::new(),
            vertices: mesh.vertices().iter().map(|p| [p.x, p.y, p.z]).collect(),
            pieces: mesh.triangles().iter().map(|t| t.to_vec()).collect(),
            parts: parts(mesh),
        }
    }

    /// Closed lines in the plane z = 0, and the area that they enclose if it is `solid`.
    pub(crate) fn rings<'r>(
        name: &str,
        frame: usize,
        solid: bool,
        rings: impl IntoIterator<Item = &'r Vec<Point2<f64>>>,
    ) -> Self {
        let (mut vertices, mut pieces) = (Vec::new(), Vec::new());
        for ring in rings {
            let (first, n) = (vertices.len(), ring.len());
            vertices.extend(ring.iter().map(|p| [p.x, p.y, 0.0]));
            pieces.extend((0..n).map(|i| vec![index(first + i), index(first + (i + 1) % n)]));
        }
        let parts = vec![ModelPart::Surface(pieces.len())];
        Self {
            name: name.to_owned(),
            frame,
            of_robot: false,
            radius: 0.0,
            radii: Vec::new(),
            vertices,
            pieces,
            parts,
        }
        .solid(solid)
    }

    /// A disc about the origin, in the plane z = 0.
    pub(crate) fn disc(name: &str, frame: usize, radius: f64) -> Self {
        let (vertices, pieces, parts) = (vec![[0.0; 3]], vec![vec![0]], vec![ModelPart::Surface(1)]);
        Self {
            name: name.to_owned(),
            frame,
            of_robot: false,
            radius,
            radii: Vec::new(),
            vertices,
            pieces,
            parts,
        }
    }

    pub(crate) fn robot(mut self) -> Self {
        self.of_robot = true;
        self
    }

    /// All of it is solid, if `solid`.
    pub(crate) fn solid(mut self, solid: bool) -> Self {
        if solid {
            self.parts = vec![ModelPart::Solid(self.pieces.len())];
        }
        self
    }

    /// The middle of the box around the vertices, and the distance from there to the farthest point of the body.
    pub fn ball(&self) -> (Point3<f64>, f64) {
        let points = self.vertices.iter().map(|v| Point3::from(*v));
        let (low, high) = points.clone().fold(
            (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3])),
            |(low, high), p| (low.inf(&p), high.sup(&p)),
        );
        if self.vertices.is_empty() {
            return (Point3::origin(), 0.0);
        }
        let center = nalgebra::center(&low, &high);
        (center, points.map(|p| (p - center).norm()).fold(0.0, f64::max) + self.radius)
    }
}

/// What the triangles of a mesh are.
fn parts(mesh: &TriMesh) -> Vec<ModelPart> {
    let (mut parts, mut done) = (Vec::new(), 0);
    for solid in mesh.solids() {
        let [start, end] = [solid.start, solid.end].map(|i| i as usize);
        parts.extend((start > done).then_some(ModelPart::Surface(start - done)));
        parts.push(ModelPart::Solid(end - start));
        done = end;
    }
    let left = mesh.triangles().len() - done;
    parts.extend((left > 0).then_some(ModelPart::Surface(left)));
    parts
}

/// An index of a vertex. Readers refuse more vertices than it can count.
fn index(i: usize) -> u32 {
    u32::try_from(i).unwrap_or(u32::MAX)
}

/// A body of the robot and the bodies that it must not touch, all of which stand still in the world, or only one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelPair {
    /// The body of the robot.
    pub body: usize,
    /// The indices of the bodies that it must not touch.
    pub others: Vec<usize>,
}

/// The numbers of a pose: x, y, z, i, j, k, w.
pub(crate) fn seven(pose: &Isometry3<f64>) -> [f64; 7] {
    let (p, r) = (&pose.translation.vector, &pose.rotation.as_ref().coords);
    [p.x, p.y, p.z, r.x, r.y, r.z, r.w]
}

impl MotionModel {
    /// Adds a frame that stands still in the world, and gives its index.
    pub(crate) fn still_frame(&mut self, pose: &Isometry3<f64>) -> usize {
        self.frames.push(ModelFrame::Fixed { parent: None, pose: seven(pose) });
        self.frames.len() - 1
    }

    /// Adds a frame that moves as time goes, which is a column, and gives its index.
    pub(crate) fn track_frame(&mut self, time: usize, trajectory: &Trajectory) -> usize {
        let row = |(time, pose): (f64, &Isometry3<f64>)| {
            let [x, y, z, i, j, k, w] = seven(pose);
            [time, x, y, z, i, j, k, w]
        };
        self.frames.push(ModelFrame::Track { time, poses: trajectory.timed_poses().map(row).collect() });
        self.frames.len() - 1
    }

    /// Adds obstacles that all stand still, or one that moves, which must not touch the bodies of `robot`.
    pub(crate) fn add_obstacles(
        &mut self,
        obstacles: Vec<ModelBody>,
        robot: impl IntoIterator<Item = usize>,
    ) {
        let first = self.bodies.len();
        self.bodies.extend(obstacles);
        let others: Vec<usize> = (first..self.bodies.len()).collect();
        if !others.is_empty() {
            self.pairs.extend(robot.into_iter().map(|body| ModelPair { body, others: others.clone() }));
        }
    }

    /// The bodies of the robot.
    pub(crate) fn of_robot(&self) -> Vec<usize> {
        (0..self.bodies.len()).filter(|i| self.bodies[*i].of_robot).collect()
    }
}
