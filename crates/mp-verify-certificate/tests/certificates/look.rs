//! A look at a certificate that is independent of the program that replays it: other kinematics (inputs are integrated step by step),
//! many configurations in place of bounds, segments and triangles that meet in place of distances, and rays in place of winding numbers.

use nalgebra::{Isometry3, Point3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use serde_json::Value;
use std::collections::HashMap;

/// So many configurations of each edge are looked at.
const MOMENTS: usize = 16;
/// Inputs are integrated in so many steps from one to the next.
const STEPS: usize = 8;
/// What bodies may jump where a path has rounding, metres.
const JUMP: f64 = 2e-6;

type Corner = Point3<f64>;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn index(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

fn maybe(value: &Value) -> Option<usize> {
    value.as_u64().map(|i| usize::try_from(i).unwrap())
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

fn pose_of(p: &[f64]) -> Isometry3<f64> {
    let turn = UnitQuaternion::new_normalize(Quaternion::new(p[6], p[3], p[4], p[5]));
    Isometry3::from_parts(Translation3::new(p[0], p[1], p[2]), turn)
}

fn six(p: &[f64]) -> Isometry3<f64> {
    let turn = Rotation3::from_euler_angles(p[5], p[4], p[3]);
    Isometry3::from_parts(Translation3::new(p[0], p[1], p[2]), turn.into())
}

/// A body, its pieces as corners, and which of them are solids.
struct Shape {
    name: String,
    frame: usize,
    of_robot: bool,
    radius: f64,
    pieces: Vec<Vec<Corner>>,
    solids: Vec<std::ops::Range<usize>>,
}

pub(super) struct Look<'c> {
    model: &'c Value,
    path: Vec<Vec<f64>>,
    shapes: Vec<Shape>,
    /// All pairs of a body of the robot and an obstacle, and those of the certificate.
    pairs: Vec<[usize; 2]>,
}

impl<'c> Look<'c> {
    pub(super) fn at(certificate: &'c Value) -> Self {
        let model = &certificate["model"];
        let shape = |body: &Value| {
            let vertices: Vec<Corner> = list(&body["vertices"])
                .iter()
                .map(|v| Corner::from(<[f64; 3]>::try_from(numbers(v)).unwrap()))
                .collect();
            let pieces: Vec<Vec<Corner>> = list(&body["pieces"])
                .iter()
                .map(|p| list(p).iter().map(|v| vertices[index(v)]).collect())
                .collect();
            let (mut at, mut solids) = (0, Vec::new());
            for part in list(&body["parts"]) {
                let (kind, count) = part.as_object().unwrap().iter().next().unwrap();
                let range = at..at + index(count);
                at = range.end;
                if kind == "solid" {
                    solids.push(range);
                }
            }
            Shape {
                name: body["name"].as_str().unwrap().to_owned(),
                frame: index(&body["frame"]),
                of_robot: body["of_robot"].as_bool().unwrap(),
                radius: body["radius"].as_f64().unwrap(),
                pieces,
                solids,
            }
        };
        let shapes: Vec<Shape> = list(&model["bodies"]).iter().map(shape).collect();
        let mut look = Self {
            model,
            path: list(&certificate["path"]).iter().map(numbers).collect(),
            shapes,
            pairs: Vec::new(),
        };
        look.pairs = look.listed_pairs();
        for (i, j) in (0..look.shapes.len()).flat_map(|i| (0..look.shapes.len()).map(move |j| (i, j))) {
            if look.shapes[i].of_robot && !look.shapes[j].of_robot && look.moves(look.shapes[i].frame) {
                look.pairs.push([i, j]);
            }
        }
        look.pairs.iter_mut().for_each(|pair| pair.sort_unstable());
        look.pairs.sort_unstable();
        look.pairs.dedup();
        look
    }

    pub(super) fn listed_pairs(&self) -> Vec<[usize; 2]> {
        let of = |pair: &Value| -> Vec<[usize; 2]> {
            list(&pair["others"]).iter().map(|other| [index(&pair["body"]), index(other)]).collect()
        };
        list(&self.model["pairs"]).iter().flat_map(of).collect()
    }

    /// What must stay apart besides: pairs of the certificate before it was changed.
    pub(super) fn also(mut self, pairs: Vec<[usize; 2]>) -> Self {
        self.pairs.extend(pairs);
        self
    }

    fn frame(&self, i: usize) -> (&str, &Value) {
        let (kind, frame) = self.model["frames"][i].as_object().unwrap().iter().next().unwrap();
        (kind, frame)
    }

    /// A frame and those above it.
    fn above(&self, frame: usize) -> Vec<usize> {
        let mut all = vec![frame];
        while let Some(parent) = maybe(&self.frame(all[all.len() - 1]).1["parent"]) {
            all.push(parent);
        }
        all
    }

    /// Whether a frame moves as the path says.
    fn moves(&self, frame: usize) -> bool {
        self.above(frame).into_iter().any(|i| match self.frame(i) {
            ("joint", joint) => !joint["column"].is_null(),
            (kind, _) => kind == "pose" || kind == "plane",
        })
    }

    /// What is wrong with the world, by itself.
    pub(super) fn world(&self) -> Result<(), String> {
        let flat = self.shapes.iter().flat_map(|s| &s.pieces).any(|p| p.len() < 3);
        for shape in &self.shapes {
            let name = &shape.name;
            if !shape.of_robot && self.moves(shape.frame) {
                return Err(format!("the obstacle {name} moves with the robot"));
            }
            let track = self.above(shape.frame).into_iter().any(|i| self.frame(i).0 == "track");
            if shape.of_robot && track {
                return Err(format!("{name} of the robot moves with an obstacle"));
            }
            if flat && shape.pieces.iter().flatten().any(|c| c.z != 0.0) {
                return Err(format!("{name} is not in the plane"));
            }
            if shape.radius.is_nan() || shape.radius < 0.0 {
                return Err(format!("{name} has no size"));
            }
            // Outlines are closed, whether what they enclose counts or not.
            let outlines = std::iter::once(0..shape.pieces.len()).filter(|_| flat);
            for solid in shape.solids.iter().cloned().chain(outlines) {
                let key = |c: &Corner| [c.x, c.y, c.z].map(|x| (x + 0.0).to_bits());
                let mut open: HashMap<Vec<[u64; 3]>, i32> = HashMap::new();
                for piece in &shape.pieces[solid] {
                    match piece.as_slice() {
                        [a, b] => [a, b].iter().for_each(|c| *open.entry(vec![key(c)]).or_default() ^= 1),
                        [a, b, c] => [[a, b], [b, c], [c, a]].iter().for_each(|[a, b]| {
                            *open.entry(vec![key(a), key(b)]).or_default() += 1;
                            *open.entry(vec![key(b), key(a)]).or_default() -= 1;
                        }),
                        _ => {}
                    }
                }
                if open.values().any(|n| *n != 0) {
                    return Err(format!("{name} has an outline that is not closed"));
                }
            }
        }
        if !self.shapes.iter().any(|s| s.of_robot && self.moves(s.frame)) {
            return Err("nothing of the robot moves".to_owned());
        }
        Ok(())
    }

    /// What the robot hits on its way.
    pub(super) fn motion(&self) -> Result<(), String> {
        let last = self.path.len() - 1;
        for (i, from) in self.path.iter().enumerate().take(last.max(1)) {
            let to = &self.path[(i + 1).min(last)];
            let frames = self.edge(from, to)?;
            for (k, at) in frames.iter().enumerate() {
                let placed: Vec<Placed> =
                    self.shapes.iter().map(|shape| Placed::at(shape, &at[shape.frame])).collect();
                for &[a, b] in &self.pairs {
                    if let Some(how) = meet(&placed[a], &placed[b]) {
                        let (a, b) = (&self.shapes[a].name, &self.shapes[b].name);
                        return Err(format!("{a} and {b} {how} on edge {i} at {k} of {MOMENTS}"));
                    }
                }
            }
            // Where it arrives is where it goes on.
            let there = &self.edge(to, to).unwrap_or_default();
            if let (Some(arrived), Some(there)) = (frames.last(), there.first()) {
                for shape in self.shapes.iter().filter(|s| s.of_robot) {
                    let off = shape
                        .pieces
                        .iter()
                        .flatten()
                        .map(|c| (arrived[shape.frame] * c - there[shape.frame] * c).norm());
                    let off = off.fold(0.0, f64::max);
                    if off > JUMP {
                        return Err(format!("{} jumps by {off} after edge {i}", shape.name));
                    }
                }
            }
        }
        Ok(())
    }

    /// The poses of all frames in the world, at moments of an edge from its beginning to its end.
    fn edge(&self, from: &[f64], to: &[f64]) -> Result<Vec<Vec<Isometry3<f64>>>, String> {
        let (time, drive) = (maybe(&self.model["time"]), &self.model["drive"]);
        let duration = match (drive.is_null(), time) {
            (false, _) => {
                if from == to {
                    0.0
                } else {
                    to[index(&drive["duration"])]
                }
            }
            (true, Some(time)) => to[time] - from[time],
            (true, None) => 0.0,
        };
        if duration < 0.0 {
            return Err("time goes back".to_owned());
        }
        let mut poses: HashMap<usize, Isometry3<f64>> = HashMap::new();
        let (mut row, mut out) = (from.to_vec(), Vec::new());
        for step in list(&self.model["steps"]).iter().filter_map(|s| maybe(&s["pose"])) {
            poses.insert(step, six(&from[step..]));
        }
        let start = poses.clone();
        for k in 0..=MOMENTS {
            let t = k as f64 / MOMENTS as f64;
            if k > 0 && !drive.is_null() {
                let dt = duration / (MOMENTS * STEPS) as f64;
                for j in 0..STEPS {
                    let now = ((k - 1) * STEPS + j) as f64 * dt;
                    self.integrate(&mut row, &mut poses, [from, to], now, dt);
                }
            }
            if let Some(time) = time {
                row[time] = from[time] + t * duration;
            }
            if drive.is_null() {
                for step in list(&self.model["steps"]) {
                    let (kind, column) = step.as_object().unwrap().iter().next().unwrap();
                    let i = index(column);
                    let by = to.get(i).map_or(0.0, |b| b - from[i]);
                    match kind.as_str() {
                        "line" => row[i] = from[i] + t * by,
                        "circle" => row[i] = from[i] + t * mp_math::atan2(mp_math::sin(by), mp_math::cos(by)),
                        _ => {
                            let (a, b) = (start[&i], six(&to[i..]));
                            let place = a.translation.vector.lerp(&b.translation.vector, t);
                            let turn = a.rotation.try_slerp(&b.rotation, t, 0.0).ok_or("half a turn")?;
                            poses.insert(i, Isometry3::from_parts(place.into(), turn));
                        }
                    }
                }
            }
            out.push(self.frames(&row, &poses));
        }
        Ok(out)
    }

    /// Moves a robot with inputs a little, by the rates in the middle of the step.
    fn integrate(
        &self,
        row: &mut [f64],
        poses: &mut HashMap<usize, Isometry3<f64>>,
        [from, to]: [&[f64]; 2],
        now: f64,
        dt: f64,
    ) {
        let drive = &self.model["drive"];
        let (input, velocities) = (&to[index(&drive["inputs"])..], &from[index(&drive["velocities"])..]);
        let wheelbase = drive["by"]["car"]["wheelbase"].as_f64();
        if wheelbase.is_some() || drive["by"] == "unicycle" {
            let rate = wheelbase.map_or(input[1], |l| input[0] * mp_math::tan(input[1]) / l);
            let yaw = row[2] + 0.5 * dt * rate;
            row[0] += dt * input[0] * mp_math::cos(yaw);
            row[1] += dt * input[0] * mp_math::sin(yaw);
            row[2] += dt * rate;
            return;
        }
        let accelerates = drive["by"] == "accelerations";
        let rate =
            |i: usize| if accelerates { velocities[i] + input[i] * (now + 0.5 * dt) } else { input[i] };
        let mut degree = 0;
        for step in list(&self.model["steps"]) {
            if let Some(first) = maybe(&step["pose"]) {
                let pose = poses.get_mut(&first).unwrap();
                pose.translation.vector += Vector3::from_fn(|i, _| dt * rate(degree + i));
                // The format says that the turns of an edge are summed, and made at once.
                let all = Vector3::from_fn(|i, _| {
                    let (t, v) = (now + dt, degree + 3 + i);
                    if accelerates { velocities[v] * t + 0.5 * input[v] * t * t } else { input[v] * t }
                });
                pose.rotation = UnitQuaternion::from_scaled_axis(all) * six(&from[first..]).rotation;
                degree += 6;
            } else {
                let i = maybe(&step["line"]).or(maybe(&step["circle"])).unwrap();
                row[i] += dt * rate(degree);
                degree += 1;
            }
        }
    }

    fn frames(&self, row: &[f64], poses: &HashMap<usize, Isometry3<f64>>) -> Vec<Isometry3<f64>> {
        let mut out: Vec<Isometry3<f64>> = Vec::new();
        for i in 0..list(&self.model["frames"]).len() {
            let (kind, frame) = self.frame(i);
            let above = maybe(&frame["parent"]).map_or(Isometry3::identity(), |p| out[p]);
            out.push(match kind {
                "fixed" => above * pose_of(&numbers(&frame["pose"])),
                "pose" => poses[&index(&frame["first"])],
                "plane" => {
                    let first = index(&frame["first"]);
                    let yaw = maybe(&frame["yaw"]).map_or(0.0, |yaw| row[yaw]);
                    Isometry3::new(Vector3::new(row[first], row[first + 1], 0.0), Vector3::z() * yaw)
                }
                "joint" => {
                    let number = |name: &str| frame[name].as_f64().unwrap();
                    let value = maybe(&frame["column"]).map_or(0.0, |c| row[c]);
                    let by = Vector3::from_vec(numbers(&frame["axis"]))
                        * (value * number("factor") + number("offset"));
                    let slides = frame["slides"].as_bool().unwrap();
                    let moved = if slides {
                        Isometry3::new(by, Vector3::zeros())
                    } else {
                        Isometry3::new(Vector3::zeros(), by)
                    };
                    above * pose_of(&numbers(&frame["origin"])) * moved
                }
                _ => {
                    let now = row[index(&frame["time"])];
                    let rows: Vec<Vec<f64>> = list(&frame["poses"]).iter().map(numbers).collect();
                    let next = rows.iter().position(|r| r[0] > now).unwrap_or(rows.len());
                    let (a, b) = (&rows[next.saturating_sub(1)], &rows[next.min(rows.len() - 1)]);
                    let t = if b[0] > a[0] { (now - a[0]) / (b[0] - a[0]) } else { 0.0 };
                    let (a, b) = (pose_of(&a[1..]), pose_of(&b[1..]));
                    let turn = a.rotation.try_slerp(&b.rotation, t, 0.0).unwrap_or(a.rotation);
                    Isometry3::from_parts(a.translation.vector.lerp(&b.translation.vector, t).into(), turn)
                }
            });
        }
        out
    }
}

/// A body where it is at a moment.
struct Placed<'s> {
    shape: &'s Shape,
    pieces: Vec<Vec<Corner>>,
    low: Corner,
    high: Corner,
}

impl<'s> Placed<'s> {
    fn at(shape: &'s Shape, pose: &Isometry3<f64>) -> Self {
        let pieces: Vec<Vec<Corner>> =
            shape.pieces.iter().map(|p| p.iter().map(|c| pose * c).collect()).collect();
        let first = pieces[0][0];
        let (low, high) = pieces.iter().flatten().fold((first, first), |(l, h), c| (l.inf(c), h.sup(c)));
        Self { shape, pieces, low, high }
    }

    /// Whether the box around it comes as near to that of another as `radius`: so does what meets, or is inside.
    fn is_near(&self, other: &Self, radius: f64) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] + radius && other.low[k] <= self.high[k] + radius)
    }
}

/// How two bodies meet, if they do.
fn meet(a: &Placed<'_>, b: &Placed<'_>) -> Option<&'static str> {
    let radius = a.shape.radius + b.shape.radius;
    if !a.is_near(b, radius) {
        return None;
    }
    if a.pieces.iter().any(|p| b.pieces.iter().any(|q| pieces_meet(p, q, radius))) {
        return Some("meet");
    }
    let inside = |outer: &Placed<'_>, inner: &Placed<'_>| {
        let solids = outer.shape.solids.iter();
        solids.into_iter().any(|s| inner.pieces.iter().flatten().any(|c| holds(&outer.pieces[s.clone()], c)))
    };
    (inside(a, b) || inside(b, a)).then_some("are inside of each other")
}

/// Whether two points, segments or triangles come as near as `radius`; triangles have none.
fn pieces_meet(p: &[Corner], q: &[Corner], radius: f64) -> bool {
    let bounds = |p: &[Corner]| p.iter().fold((p[0], p[0]), |(l, h), c| (l.inf(c), h.sup(c)));
    let ((l, h), (m, n)) = (bounds(p), bounds(q));
    if (0..3).any(|k| l[k] > n[k] + radius || m[k] > h[k] + radius) {
        return false;
    }
    if p.len() == 3 || q.len() == 3 {
        let sides = |t: &[Corner]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        return sides(p).iter().any(|s| crosses(s, q)) || sides(q).iter().any(|s| crosses(s, p));
    }
    // In the plane: the nearest points of segments that do not cross are ends.
    let ends = |p: &[Corner]| [p[0], p[p.len() - 1]];
    let (p, q) = (ends(p), ends(q));
    let side =
        |a: Corner, b: Corner, c: Corner| ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)).signum();
    let cross = side(p[0], p[1], q[0]) * side(p[0], p[1], q[1]) < 0.0
        && side(q[0], q[1], p[0]) * side(q[0], q[1], p[1]) < 0.0;
    let off = |c: Corner, [a, b]: [Corner; 2]| {
        let along = b - a;
        let t = if along.norm() > 0.0 {
            ((c - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (c - (a + along * t)).norm()
    };
    cross || p.iter().any(|c| off(*c, q) <= radius) || q.iter().any(|c| off(*c, p) <= radius)
}

/// Whether a segment goes through a triangle.
fn crosses([a, b]: &[Corner; 2], t: &[Corner]) -> bool {
    let (u, v, along) = (t[1] - t[0], t[2] - t[0], b - a);
    let cross = along.cross(&v);
    let scale = u.dot(&cross);
    if scale == 0.0 {
        return false;
    }
    let from = a - t[0];
    let (x, second) = (from.dot(&cross) / scale, from.cross(&u));
    let (y, s) = (along.dot(&second) / scale, v.dot(&second) / scale);
    x >= 0.0 && y >= 0.0 && x + y <= 1.0 && (0.0..=1.0).contains(&s)
}

/// Whether a ray from a point goes out of closed pieces an odd number of times.
fn holds(pieces: &[Vec<Corner>], p: &Corner) -> bool {
    let flat = pieces[0].len() == 2;
    let far = *p + Vector3::new(0.534_781, 0.698_127, if flat { 0.0 } else { 0.476_263 }) * 1e4;
    let through = |piece: &&Vec<Corner>| match piece.len() {
        2 => {
            // A wall on the segment.
            let up = Vector3::z();
            crosses(&[*p, far], &[piece[0] - up, piece[1] - up, piece[1] + up])
                || crosses(&[*p, far], &[piece[0] - up, piece[1] + up, piece[0] + up])
        }
        _ => crosses(&[*p, far], piece),
    };
    pieces.iter().filter(through).count() % 2 == 1
}
