//! The file, and whether it makes sense: docs/formats/certificate.md.

use serde::Deserialize;
use xxhash_rust::xxh3::xxh3_128;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Certificate {
    #[serde(rename = "certificate")]
    version: u32,
    pub(crate) scene: String,
    pub(crate) columns: Vec<String>,
    pub(crate) model: Model,
    pub(crate) path: Vec<Vec<f64>>,
    /// For each edge the polynomial of each column from 0 to 1, the constant first; without them edges are straight.
    pub(crate) curves: Option<Vec<Vec<[f64; 6]>>>,
    pub(crate) clearance: Option<f64>,
    /// For each edge, for each pair: where each part ends, and the distance in its middle.
    pub(crate) edges: Vec<Vec<Vec<[f64; 2]>>>,
    #[serde(rename = "checksum")]
    _checksum: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Model {
    pub(crate) steps: Vec<Step>,
    pub(crate) time: Option<usize>,
    pub(crate) drive: Option<Drive>,
    pub(crate) frames: Vec<Frame>,
    pub(crate) bodies: Vec<Body>,
    pub(crate) pairs: Vec<Pair>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Step {
    Pose(usize),
    Line(usize),
    Circle(usize),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Drive {
    pub(crate) by: By,
    pub(crate) velocities: usize,
    pub(crate) inputs: usize,
    pub(crate) duration: usize,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum By {
    Car { wheelbase: f64 },
    Unicycle,
    Velocities,
    Accelerations,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Frame {
    Fixed {
        parent: Option<usize>,
        pose: [f64; 7],
    },
    Pose {
        first: usize,
    },
    Plane {
        first: usize,
        yaw: Option<usize>,
    },
    Joint {
        parent: usize,
        origin: [f64; 7],
        axis: [f64; 3],
        slides: bool,
        column: Option<usize>,
        factor: f64,
        offset: f64,
    },
    Track {
        time: usize,
        poses: Vec<[f64; 8]>,
    },
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) frame: usize,
    pub(crate) of_robot: bool,
    pub(crate) radius: f64,
    #[serde(default)]
    pub(crate) radii: Vec<f64>,
    pub(crate) vertices: Vec<[f64; 3]>,
    pub(crate) pieces: Vec<Vec<usize>>,
    pub(crate) parts: Vec<Part>,
}

/// A run of pieces of a body: how many follow each other.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Part {
    /// What they enclose belongs to the body too.
    Solid(usize),
    /// Only they do.
    Surface(usize),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Pair {
    pub(crate) body: usize,
    pub(crate) others: Vec<usize>,
}

impl Step {
    /// Its first column.
    fn first(&self) -> usize {
        let (Self::Pose(i) | Self::Line(i) | Self::Circle(i)) = *self;
        i
    }
}

impl Frame {
    pub(crate) fn parent(&self) -> Option<usize> {
        match self {
            Self::Fixed { parent, .. } => *parent,
            Self::Joint { parent, .. } => Some(*parent),
            _ => None,
        }
    }
}

#[derive(Deserialize)]
struct Version {
    certificate: u32,
}

/// Reads a certificate and checks that nobody has changed it, and that it makes sense.
pub(crate) fn read(text: &str) -> Result<Certificate, String> {
    let end =
        text.rfind(",\n\"checksum\":").ok_or("it has no checksum: it is not whole, or no certificate")?;
    let hash = format!(",\n\"checksum\":\"{:032x}\"}}", xxh3_128(&text.as_bytes()[..end]));
    if text[end..].trim_end() != hash {
        return Err("it was changed after it was written: its checksum is another".to_owned());
    }
    let unread = |e: serde_json::Error| format!("it cannot be read: {e}");
    match serde_json::from_str(text).map_err(unread)? {
        Version { certificate: 2 | 3 } => {}
        Version { certificate: 1 } => {
            let old = "it is of version 1, which does not say which bodies are solid, so that one may be inside of another: write it anew";
            return Err(old.to_owned());
        }
        Version { certificate } => {
            return Err(format!("it is of version {certificate}, and this program knows versions 2 and 3"));
        }
    }
    let file: Certificate = serde_json::from_str(text).map_err(unread)?;
    if (file.version == 3) != file.curves.is_some() {
        return Err("curves are what version 3 has, and version 2 has not".to_owned());
    }
    file.check().map(|()| file)
}

impl Certificate {
    /// Whether every index is in range and every number finite.
    pub(crate) fn check(&self) -> Result<(), String> {
        let (columns, model) = (self.columns.len(), &self.model);
        let sound = |holds: bool, what: &str| if holds { Ok(()) } else { Err(what.to_owned()) };
        let finite = |numbers: &[f64]| numbers.iter().all(|x| x.abs() <= 1e75);
        let pose = |p: &[f64]| finite(p) && (p[3..].iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-9;
        sound(self.path.iter().all(|row| row.len() == columns && finite(row)), "a row of the path is odd")?;
        sound(!self.path.is_empty(), "the path is empty")?;
        sound(self.clearance.is_none_or(|c| c > 0.0 && c.is_finite()), "the clearance is not positive")?;
        sound(self.clearance.is_some() || model.pairs.is_empty(), "it proves no clearance")?;
        let mut used = vec![0; columns];
        for step in &model.steps {
            let range = match *step {
                Step::Pose(first) => first..first.saturating_add(6),
                Step::Line(i) | Step::Circle(i) => i..i.saturating_add(1),
            };
            sound(range.end <= columns, "a step has no column")?;
            used[range].iter_mut().for_each(|n| *n += 1);
        }
        let ordered = model.steps.windows(2).all(|pair| pair[0].first() < pair[1].first());
        sound(ordered, "the degrees of freedom are out of order")?;
        model.time.into_iter().for_each(|time| used.get_mut(time).into_iter().for_each(|n| *n += 1));
        let own = model.drive.as_ref().map_or(columns, |drive| drive.velocities);
        sound(used.iter().take(own).all(|n| *n == 1), "a number of the path is without a meaning")?;
        if let Some(drive) = &model.drive {
            let degrees = used.iter().take(own).count() - usize::from(model.time.is_some());
            let (velocities, inputs) = match drive.by {
                By::Car { wheelbase } => {
                    sound(wheelbase > 0.0 && degrees == 3, "it is no car")?;
                    (0, 2)
                }
                By::Unicycle => {
                    sound(degrees == 3, "it is no unicycle")?;
                    (0, 2)
                }
                By::Velocities => (0, degrees),
                By::Accelerations => (degrees, degrees),
            };
            let right = drive.inputs == own + velocities && drive.duration == drive.inputs + inputs;
            sound(right && drive.duration + 1 == columns, "the columns of the inputs are odd")?;
        }
        let single = |i: usize| {
            model.steps.iter().any(|step| matches!(step, Step::Line(j) | Step::Circle(j) if *j == i))
        };
        // What has lines or single points is a world of the plane z = 0.
        let flat = model.bodies.iter().flat_map(|body| &body.pieces).any(|piece| piece.len() < 3);
        let turns_flat = |p: &[f64]| !flat || p[2..5].iter().all(|x| *x == 0.0);
        let wheels = model.drive.as_ref().is_some_and(|d| matches!(d.by, By::Car { .. } | By::Unicycle));
        sound(!wheels || (0..3).all(single), "it has no wheels")?;
        for (i, frame) in model.frames.iter().enumerate() {
            sound(frame.parent().is_none_or(|parent| parent < i), "a frame comes before its parent")?;
            let right = match frame {
                Frame::Fixed { pose: p, .. } => pose(p) && turns_flat(p),
                Frame::Pose { first } => {
                    !flat && model.steps.iter().any(|s| matches!(s, Step::Pose(f) if f == first))
                }
                Frame::Plane { first, yaw } if wheels => *first == 0 && *yaw == Some(2),
                Frame::Plane { first, yaw } => {
                    let apart = yaw.is_none_or(|yaw| single(yaw) && yaw != *first && yaw != first + 1);
                    single(*first) && single(first + 1) && apart
                }
                Frame::Joint { origin, axis, column, factor, offset, .. } => {
                    let length: f64 = axis.iter().map(|x| x * x).sum();
                    let unit = (length - 1.0).abs() < 1e-9;
                    let moves = column.is_none_or(|column| single(column) && !wheels);
                    !flat && unit && pose(origin) && finite(&[*factor, *offset]) && moves
                }
                Frame::Track { time, poses } => {
                    let later = poses.windows(2).all(|pair| pair[0][0] < pair[1][0]);
                    let finite =
                        poses.iter().all(|p| finite(&p[..1]) && pose(&p[1..]) && turns_flat(&p[1..]));
                    model.time == Some(*time) && later && finite && !poses.is_empty()
                }
            };
            sound(right, &format!("frame {i} is odd"))?;
        }
        for step in &model.steps {
            let moved = |frame: &Frame| match (step, frame) {
                (Step::Pose(i), Frame::Pose { first }) => first == i,
                (Step::Line(i) | Step::Circle(i), Frame::Plane { first, yaw }) => {
                    i == first || *i == first + 1 || *yaw == Some(*i)
                }
                (Step::Line(i) | Step::Circle(i), Frame::Joint { column, .. }) => *column == Some(*i),
                _ => false,
            };
            sound(model.frames.iter().any(moved), "a degree of freedom moves nothing")?;
        }
        for body in &model.bodies {
            let corners = |p: &Vec<usize>| {
                let many = if flat { 1..=2 } else { 3..=3 };
                many.contains(&p.len()) && p.iter().all(|v| *v < body.vertices.len())
            };
            let vertex = |v: &[f64; 3]| finite(v) && !(flat && v[2] != 0.0);
            let right = body.pieces.iter().all(corners) && body.vertices.iter().all(vertex);
            let right = right && body.frame < model.frames.len() && !body.pieces.is_empty();
            let right = right && finite(&[body.radius]) && body.radius >= 0.0;
            let right = right && (body.radii.is_empty() || body.radii.len() == body.pieces.len());
            let right = right && body.radii.iter().all(|radius| (0.0..=body.radius).contains(radius));
            sound(right, &format!("the body {} is odd", body.name))?;
        }
        // The robot hangs from one frame, which moves as a whole if any does, and no obstacle is carried by
        // it.
        let root = |frame: usize| {
            std::iter::successors(Some(frame), |i| model.frames[*i].parent()).last().unwrap_or(frame)
        };
        let robot = model.bodies.iter().find(|body| body.of_robot).map(|body| root(body.frame));
        let hangs = |body: &Body| (robot == Some(root(body.frame))) == body.of_robot;
        sound(model.bodies.iter().all(hangs), "a body hangs from another frame than the robot or the world")?;
        let free = |(i, frame): (usize, &Frame)| {
            !matches!(frame, Frame::Pose { .. } | Frame::Plane { .. }) || robot.is_none_or(|robot| robot == i)
        };
        sound(model.frames.iter().enumerate().all(free), "a frame moves, and the robot is not in it")?;
        let known = |i: &usize| *i < model.bodies.len();
        let pairs = model.pairs.iter().all(|p| known(&p.body) && p.others.iter().all(known));
        sound(pairs, "a pair has no body")?;
        let mut seen = std::collections::HashSet::new();
        let each = model.pairs.iter().flat_map(|p| p.others.iter().map(|other| [p.body, *other]));
        let once = each.into_iter().all(|[a, b]| a != b && seen.insert([a.min(b), a.max(b)]));
        sound(once, "a pair is there twice, or is of one body")?;
        sound(self.edges.len() == (self.path.len() - 1).max(1), "there is not a proof for each edge")?;
        if let Some(curves) = &self.curves {
            let alone = model.drive.is_none() && model.time.is_none();
            let single = model.steps.iter().all(|step| !matches!(step, Step::Pose(_)));
            sound(alone && single, "there are no curves of such robots")?;
            sound(curves.len() == self.edges.len(), "there is not a curve for each edge")?;
            for (i, curve) in curves.iter().enumerate() {
                sound(curve.len() == columns && curve.iter().all(|c| finite(c)), "a curve is odd")?;
                let begins = curve.iter().zip(&self.path[i]).all(|(c, x)| c[0] == *x);
                sound(begins, &format!("curve {} does not begin where configuration {} is", i + 1, i + 1))?;
            }
        }
        let proved = self.edges.iter().all(|edge| edge.len() == model.pairs.len());
        sound(proved, "there is not a proof for each pair of bodies")
    }
}
