//! An oracle for paths, which shares no code with the planners: its own description of the problem,
//! kinematics, interpolation and distances. It uses the standard library, nalgebra, and parry3d for distances
//! of cylinders.
//!
//! From the crates of the project it takes only the text of a path. Each edge is halved until the distance of
//! each pair of bodies exceeds the length by which they can approach each other within the part. A part that
//! moves no body by more than a billionth of the size of the problem is decided by whether the bodies touch
//! there. So a path passes only if it is free all along, but for contacts smaller than that.

#![expect(
    clippy::disallowed_methods,
    reason = "it shares no code with the crates it judges, not even their sine"
)]

mod distance;
mod ends;
mod flat;
mod judge;
mod moment;
mod text;

pub use distance::Piece;
pub use judge::{Fault, Judged};
pub use moment::{Ask, Drive, DriveKind, Joint, Moves, Tree};
pub use text::rows_of;

use nalgebra::{Isometry3, Point3};

/// The shape of a body, in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Pieces in space: a surface of triangles, or solid pieces.
    Pieces(Vec<Piece>),
    /// Closed rings in the plane: if `filled`, what an odd number of rings goes around is inside.
    Rings {
        /// The corners of each ring, metres.
        rings: Vec<Vec<[f64; 2]>>,
        /// Whether the rings have an inside.
        filled: bool,
    },
    /// A disc in the plane.
    Disc {
        /// Its middle, metres.
        middle: [f64; 2],
        /// Its radius, metres.
        radius: f64,
    },
}

/// A body of the robot, or an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its name in messages.
    pub name: String,
    /// Its geometry, in the frame it belongs to.
    pub shape: Shape,
    /// Which frame it belongs to. Of a robot: 0 is the root, `i + 1` the frame behind joint `i`. Obstacles
    /// that stand still are in the frame of the world.
    pub frame: usize,
    /// The radius (m) of a ball about the origin of its frame that holds it.
    pub reach: f64,
}

impl Body {
    /// A body in a [frame](Self::frame), with its [reach](Self::reach).
    #[must_use]
    pub fn new(name: impl Into<String>, shape: Shape, frame: usize) -> Self {
        let reach = match &shape {
            Shape::Pieces(pieces) => pieces.iter().map(Piece::reach).fold(0.0, f64::max),
            Shape::Rings { rings, .. } => {
                rings.iter().flatten().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max)
            }
            Shape::Disc { middle: [x, y], radius } => x.hypot(*y) + radius,
        };
        Self { name: name.into(), shape, frame, reach }
    }
}

/// The triangles of a box with these sides about the origin, moved by `pose`.
#[must_use]
pub fn box_pieces(sides: [f64; 3], pose: &Isometry3<f64>) -> Vec<Piece> {
    let corner = |i: usize| {
        let part = |k: usize| if i >> k & 1 == 1 { 0.5 * sides[k] } else { -0.5 * sides[k] };
        pose * Point3::new(part(0), part(1), part(2))
    };
    let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let halves = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    halves.map(|triangle| Piece::Triangle(triangle.map(corner))).collect()
}

/// An obstacle that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Mover {
    /// What moves, in the frame that its rows move.
    pub body: Body,
    /// Rows of time (s) and pose. Between two rows it goes straight and turns the shorter way, evenly.
    pub rows: Vec<(f64, Isometry3<f64>)>,
}

/// When a robot among obstacles that move may be where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// The greatest speed (m/s; a radian counts as half a metre); none where inputs bound it.
    pub speed: Option<f64>,
    /// When the robot is at the start (s).
    pub start: f64,
    /// The earliest and the latest arrival at the goal (s).
    pub goal: [f64; 2],
}

/// A problem, as the oracle knows it.
#[derive(Clone, Debug)]
pub struct Case {
    /// How the numbers of a configuration place the robot.
    pub moves: Moves,
    /// The bodies of the robot; `moves` places them.
    pub robot: Vec<Body>,
    /// Pairs of bodies of the robot that must not touch.
    pub pairs: Vec<[usize; 2]>,
    /// Obstacles that stand still.
    pub still: Vec<Body>,
    /// Obstacles that move.
    pub moving: Vec<Mover>,
    /// The times; `None` unless obstacles move.
    pub timing: Option<Timing>,
    /// The inputs; `None` for robots that move straight.
    pub drive: Option<Drive>,
    /// The least and the greatest value of each number of a configuration; `None` for an angle without
    /// limits.
    pub limits: Vec<Option<[f64; 2]>>,
    /// The start: a configuration, then velocities if they are part of the state.
    pub start: Vec<f64>,
    /// Each goal: what it asks of each number of a configuration, then of each velocity.
    pub goals: Vec<Vec<Ask>>,
    /// The size of the place where the robot moves (m).
    pub extent: f64,
    /// The greatest coordinate of anything (m): what rounding is compared with.
    pub far: f64,
}

impl Case {
    /// A robot of these bodies and limits in a place of the size `extent` (m), without obstacles, start and
    /// goals.
    #[must_use]
    pub fn new(moves: Moves, robot: Vec<Body>, limits: Vec<Option<[f64; 2]>>, extent: f64) -> Self {
        Self {
            moves,
            robot,
            pairs: Vec::new(),
            still: Vec::new(),
            moving: Vec::new(),
            timing: None,
            drive: None,
            limits,
            start: Vec::new(),
            goals: Vec::new(),
            extent,
            far: extent,
        }
    }
}
