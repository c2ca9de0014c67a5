//! Judges paths: each edge is halved until all of it is shown free.

use super::distance;
use super::flat::{self, Flat};
use super::moment::{Edge, Moment, Row};
use super::{Body, Case, Piece, Shape};
use nalgebra::{Isometry3, Point3, Vector3};

/// Parts of an edge that move no body farther than this part of the extent are decided by whether bodies
/// touch in their middle.
const SMALLEST: f64 = 1e-9;
/// Distances below this part of the greatest coordinate are contact: rounding.
const TOUCHING: f64 = 1e-13;
/// The oracle gives up after this many comparisons of two bodies.
const MOST_TESTS: u64 = 20_000_000;
/// At this many places along a curved edge it is looked at whether the robot is within its limits.
const PLACES: usize = 16;

/// What is wrong with a path.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// Two bodies touch, or are nearer than what is to be kept.
    Contact {
        /// The index of the edge, from 0.
        edge: usize,
        /// Which part of the edge, 0 to 1.
        at: f64,
        /// The two bodies.
        between: String,
    },
    /// It does not begin at the start or end at a goal.
    Ends(String),
    /// It leaves its limits, or goes as the robot cannot.
    Invalid(String),
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Contact { edge, at, between } => {
                write!(f, "{between} touch between rows {} and {}, {at} of the way", edge + 1, edge + 2)
            }
            Self::Ends(what) | Self::Invalid(what) => f.write_str(what),
        }
    }
}

/// What the oracle says of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// What is wrong; `None` for a free path from the start to a goal.
    pub fault: Option<Fault>,
    /// Whether all edges were looked at; not after a fault, nor when it took too many tests.
    pub finished: bool,
    /// How many edges were shown free.
    pub edges: u64,
    /// How many times two bodies were compared.
    pub tests: u64,
    /// The least distance (m) of two bodies that was seen.
    pub least: f64,
    /// An upper bound (m) on how far the points of the robot moved in all.
    pub travel: f64,
}

/// A body made ready: with balls around it and its pieces.
struct Ready<'c> {
    body: &'c Body,
    middle: Point3<f64>,
    radius: f64,
    pieces: Vec<(Piece, Point3<f64>, f64)>,
}

impl<'c> Ready<'c> {
    fn new(body: &'c Body) -> Self {
        let (points, pieces): (Vec<Point3<f64>>, Vec<_>) = match &body.shape {
            Shape::Pieces(pieces) => {
                let balls = pieces.iter().map(|piece| (piece.clone(), piece.ball()));
                let ready: Vec<_> = balls.map(|(piece, (middle, radius))| (piece, middle, radius)).collect();
                (ready.iter().map(|(_, middle, _)| *middle).collect(), ready)
            }
            Shape::Rings { rings, .. } => {
                (rings.iter().flatten().map(|[x, y]| Point3::new(*x, *y, 0.0)).collect(), Vec::new())
            }
            Shape::Disc { middle: [x, y], .. } => (vec![Point3::new(*x, *y, 0.0)], Vec::new()),
        };
        let sum: Vector3<f64> = points.iter().map(|p| p.coords).sum();
        let middle = Point3::from(sum / points.len().max(1) as f64);
        let out = |p: &Point3<f64>, radius: f64| (p - middle).norm() + radius;
        let radius = match &body.shape {
            Shape::Disc { radius, .. } => *radius,
            Shape::Pieces(_) => pieces.iter().map(|(_, p, r)| out(p, *r)).fold(0.0, f64::max),
            Shape::Rings { .. } => points.iter().map(|p| out(p, 0.0)).fold(0.0, f64::max),
        };
        Self { body, middle, radius, pieces }
    }

    /// The shape in the plane, moved.
    fn flat(&self, pose: &Isometry3<f64>) -> Option<Flat> {
        let moved = |p: &[f64; 2]| {
            let p = pose * Point3::new(p[0], p[1], 0.0);
            [p.x, p.y]
        };
        match &self.body.shape {
            Shape::Pieces(_) => None,
            Shape::Rings { rings, filled } => {
                let rings = rings.iter().map(|ring| ring.iter().map(moved).collect()).collect();
                Some(Flat::Rings { rings, filled: *filled })
            }
            Shape::Disc { middle, radius } => Some(Flat::Disc { middle: moved(middle), radius: *radius }),
        }
    }

    /// The distance to another body if it is at most `than`; otherwise a lower bound on it, more than `than`.
    fn distance(&self, own: &Isometry3<f64>, other: &Self, pose: &Isometry3<f64>, than: f64) -> f64 {
        let apart = (own * self.middle - pose * other.middle).norm() - self.radius - other.radius;
        if apart > than {
            return apart;
        }
        if let (Some(a), Some(b)) = (self.flat(own), other.flat(pose)) {
            return flat::between(&a, &b);
        }
        // In the frame of the other body.
        let relative = pose.inverse() * own;
        let mut least = f64::INFINITY;
        for (piece, middle, radius) in &self.pieces {
            let middle = relative * middle;
            if (middle - other.middle).norm() - radius - other.radius > than {
                least = least.min((middle - other.middle).norm() - radius - other.radius);
                continue;
            }
            let piece = piece.moved(&relative);
            for (theirs, center, size) in &other.pieces {
                let apart = (middle - center).norm() - radius - size;
                least = least.min(if apart > than { apart } else { distance::between(&piece, theirs) });
                if least.is_nan() {
                    return least;
                }
            }
        }
        least
    }

    /// Whether a ray from a point crosses its triangles an odd number of times.
    fn encloses(&self, point: &Point3<f64>) -> bool {
        let far =
            point + Vector3::new(0.577, 0.211, 0.789) * (4.0 * self.radius + (point - self.middle).norm());
        let crossed = |(piece, ..): &&(Piece, Point3<f64>, f64)| match piece {
            Piece::Triangle(_) => {
                distance::between(piece, &Piece::Capsule { a: *point, b: far, radius: 0.0 }) == 0.0
            }
            _ => false,
        };
        self.pieces.iter().filter(crossed).count() % 2 == 1
    }

    /// Whether one of its pieces is inside of another body, if they do not touch.
    fn inside_of(&self, own: &Isometry3<f64>, other: &Self, pose: &Isometry3<f64>) -> bool {
        let relative = pose.inverse() * own;
        let mut points = self.pieces.iter().map(|(_, middle, _)| relative * middle);
        points.any(|p| (p - other.middle).norm() <= other.radius && other.encloses(&p))
    }
}

/// All that is compared.
struct Bodies<'c> {
    case: &'c Case,
    robot: Vec<Ready<'c>>,
    still: Vec<Ready<'c>>,
    moving: Vec<Ready<'c>>,
    pairs: Vec<Pair>,
    /// The clearance (m) to keep from what is no part of the robot.
    kept: f64,
}

/// Two bodies that must not touch.
#[derive(Clone, Copy, Debug)]
enum Pair {
    Still(usize, usize),
    Moving(usize, usize),
    Own(usize, usize),
}

impl<'c> Bodies<'c> {
    fn new(case: &'c Case, kept: f64) -> Self {
        let ready = |bodies: &'c [Body]| bodies.iter().map(Ready::new).collect::<Vec<_>>();
        let moving: Vec<_> = case.moving.iter().map(|mover| Ready::new(&mover.body)).collect();
        let mut pairs: Vec<Pair> = case.pairs.iter().map(|[i, j]| Pair::Own(*i, *j)).collect();
        for (i, body) in case.robot.iter().enumerate() {
            // Links that stand still are not compared with obstacles.
            if !case.stands(body.frame) {
                pairs.extend((0..case.still.len()).map(|j| Pair::Still(i, j)));
                pairs.extend((0..moving.len()).map(|j| Pair::Moving(i, j)));
            }
        }
        Self { case, robot: ready(&case.robot), still: ready(&case.still), moving, pairs, kept }
    }

    /// The two bodies of a pair, each with its pose.
    fn placed(&self, pair: Pair, frames: &[Isometry3<f64>]) -> [(&Ready<'c>, Isometry3<f64>); 2] {
        let own = |i: usize| (&self.robot[i], frames[self.robot[i].body.frame]);
        match pair {
            Pair::Still(i, j) => [own(i), (&self.still[j], Isometry3::identity())],
            Pair::Moving(i, j) => [own(i), (&self.moving[j], frames[frames.len() - self.moving.len() + j])],
            Pair::Own(i, j) => [own(i), own(j)],
        }
    }

    fn distance(&self, pair: Pair, frames: &[Isometry3<f64>], than: f64) -> f64 {
        let [(a, at), (b, to)] = self.placed(pair, frames);
        let kept = if matches!(pair, Pair::Own(..)) { 0.0 } else { self.kept };
        a.distance(&at, b, &to, than + kept) - kept
    }

    fn names(&self, pair: Pair) -> String {
        let (a, b) = match pair {
            Pair::Still(i, j) => (&self.robot[i], &self.still[j]),
            Pair::Moving(i, j) => (&self.robot[i], &self.moving[j]),
            Pair::Own(i, j) => (&self.robot[i], &self.robot[j]),
        };
        format!("{} and {}", a.body.name, b.body.name)
    }

    /// How far the two bodies of a pair can come nearer in the whole edge (m).
    fn travel(&self, pair: Pair, edge: &Edge<'_>, from: &Moment) -> f64 {
        match pair {
            Pair::Still(i, _) => edge.travel(i),
            Pair::Own(i, j) => edge.travel(i) + edge.travel(j),
            Pair::Moving(i, j) => {
                edge.travel(i) + self.case.moving[j].travel(from.time, from.time + edge.duration)
            }
        }
    }

    /// Looks at one edge. Returns a contact: the part of the way and the bodies.
    fn contact(&self, edge: &Edge<'_>, from: &Moment, judged: &mut Judged) -> Option<(f64, String)> {
        let (smallest, touching) = (SMALLEST * self.case.extent, TOUCHING * self.case.far);
        let travels: Vec<(Pair, f64)> =
            self.pairs.iter().map(|pair| (*pair, self.travel(*pair, edge, from) * (1.0 + 1e-9))).collect();
        let mut open = vec![(0.0, 1.0, travels)];
        while let Some((begin, end, pairs)) = open.pop() {
            let (middle, half) = (0.5 * (begin + end), 0.5 * (end - begin));
            let frames = self.case.frames(&edge.at(middle));
            let mut left = Vec::new();
            for (pair, travel) in pairs {
                judged.tests += 1;
                let near = half * travel;
                let apart = self.distance(pair, &frames, near + touching);
                judged.least = judged.least.min(apart);
                if apart.is_nan() || apart <= touching {
                    return Some((middle, self.names(pair)));
                }
                if apart <= near + touching && near > smallest {
                    left.push((pair, travel));
                }
            }
            if judged.tests > MOST_TESTS {
                judged.finished = false;
                return None;
            }
            if !left.is_empty() {
                open.push((middle, end, left.clone()));
                open.push((begin, middle, left));
            }
        }
        None
    }
}

impl Case {
    /// Whether a frame of the robot never moves, and no joint that is held keeps it from moving.
    fn stands(&self, mut frame: usize) -> bool {
        let super::Moves::Tree(tree) = &self.moves else { return false };
        while frame > 0 {
            if tree.joints[frame - 1].is_joint() {
                return false;
            }
            frame = tree.joints[frame - 1].above;
        }
        !tree.floats
    }

    /// Judges a path: whether it is free all along, leads from the start to a goal, and goes as the robot
    /// can.
    #[must_use]
    pub fn judge(&self, rows: &[Vec<f64>]) -> Judged {
        self.judge_keeping(rows, 0.0)
    }

    /// As [`judge`](Self::judge), where what comes nearer to an obstacle than `kept` (m) counts as touching
    /// it.
    #[must_use]
    pub fn judge_keeping(&self, rows: &[Vec<f64>], kept: f64) -> Judged {
        let mut judged =
            Judged { fault: None, finished: true, edges: 0, tests: 0, least: f64::INFINITY, travel: 0.0 };
        let rows: Result<Vec<Row<'_>>, String> = rows.iter().map(|row| self.row(row)).collect();
        let rows = match rows.map_err(Fault::Invalid).and_then(|rows| self.check_rows(&rows).map(|()| rows)) {
            Ok(rows) => rows,
            Err(fault) => {
                judged.fault = Some(fault);
                return judged;
            }
        };
        let bodies = Bodies::new(self, kept);
        // A path of one row stands still.
        let to = rows.iter().skip(usize::from(rows.len() > 1));
        for (i, (from, to)) in rows.iter().zip(to).enumerate() {
            let from = &from.moment;
            let edge = Edge::new(self, from, to, false);
            let fault = match self.check_edge(&edge, from, to, PLACES) {
                Err(what) => Some(Fault::Invalid(format!("between rows {} and {}, {what}", i + 1, i + 2))),
                Ok(()) => {
                    let mut contact = bodies.contact(&edge, from, &mut judged);
                    if contact.is_some() && edge.ambiguous {
                        contact = bodies.contact(&Edge::new(self, from, to, true), from, &mut judged);
                    }
                    contact.map(|(at, between)| Fault::Contact { edge: i, at, between })
                }
            };
            judged.travel += (0..self.robot.len()).map(|body| edge.travel(body)).fold(0.0, f64::max);
            if fault.is_some() || !judged.finished {
                judged.fault = fault;
                judged.finished = false;
                break;
            }
            judged.edges += 1;
        }
        judged
    }

    /// The least distance (m) of two bodies that must not touch, at a row of a configuration, with the time
    /// if obstacles move and velocities if there are any. What is wholly inside of something else counts as
    /// touching it.
    ///
    /// # Errors
    /// When the row has another length, or is beyond the limits: what is wrong.
    pub fn clearance_at(&self, row: &[f64]) -> Result<f64, String> {
        let inputs = self.drive.as_ref().map_or(0, |drive| drive.limits.len() + 1);
        let row: Vec<f64> = row.iter().copied().chain(std::iter::repeat_n(0.0, inputs)).collect();
        let row = self.row(&row)?;
        self.check_limits(&row)?;
        let bodies = Bodies::new(self, 0.0);
        let frames = self.frames(&row.moment);
        let mut least = f64::INFINITY;
        for pair in &bodies.pairs {
            least = least.min(bodies.distance(*pair, &frames, f64::INFINITY));
            let [a, b] = bodies.placed(*pair, &frames);
            if a.0.inside_of(&a.1, b.0, &b.1) || b.0.inside_of(&b.1, a.0, &a.1) {
                return Ok(0.0);
            }
        }
        Ok(least)
    }
}
