//! Divides edges into parts of which each is proved free by one distance.

mod motion;

use crate::{Error, ModelBody, ModelFrame, MotionModel, brief};
use motion::Motion;
use mp_collide::reference::RefMesh;
use mp_cspace::Interrupt;
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3};
use std::rc::Rc;

/// Parts shorter than this are not divided.
const SHORTEST: f64 = 1e-9;

/// How far a pose of the model may be from that of the robot: rounding, as a fraction of the coordinates.
const ROUNDING: f64 = 1e-9;

/// What is proved free of what.
struct Shapes {
    body: Rc<RefMesh>,
    /// The others: at once, in the world, if they stand still there.
    others: Rc<RefMesh>,
    /// The frame of the other, if it moves.
    frame: Option<usize>,
}

/// Proves the edges of a path, each pair of bodies by itself.
#[allow(missing_debug_implementations, reason = "meshes for searches have nothing to print")]
pub struct Prover<'m> {
    model: &'m MotionModel,
    shapes: Vec<Shapes>,
    /// The clearance (m) to prove.
    margin: f64,
    interrupt: Interrupt,
}

impl<'m> Prover<'m> {
    /// A prover of edges of a robot with this model, which keep the clearance `margin` (m), unless `interrupt` says to end.
    ///
    /// # Errors
    /// When the bodies are too large to compute with.
    pub fn new(model: &'m MotionModel, margin: f64, interrupt: &Interrupt) -> Result<Self, String> {
        let mut meshes: Vec<(Vec<usize>, Rc<RefMesh>)> = Vec::new();
        let mut mesh = |bodies: &[usize], in_world: bool| {
            if let Some((_, mesh)) = meshes.iter().find(|(of, _)| of == bodies) {
                return Ok::<_, String>(Rc::clone(mesh));
            }
            let of = bodies.iter().map(|i| &model.bodies[*i]);
            let mesh = Rc::new(merged(model, of, in_world)?);
            meshes.push((bodies.to_vec(), Rc::clone(&mesh)));
            Ok(mesh)
        };
        let shapes = model.pairs.iter().map(|pair| {
            let frame = pair.others.first().map(|i| model.bodies[*i].frame);
            let frame = frame.filter(|frame| still(model, *frame).is_none());
            Ok(Shapes {
                body: mesh(&[pair.body], false)?,
                others: mesh(&pair.others, frame.is_none())?,
                frame,
            })
        });
        let shapes = shapes.collect::<Result<_, String>>()?;
        Ok(Self { model, shapes, margin, interrupt: interrupt.clone() })
    }

    /// The parts of an edge, for each pair: where each ends, and the distance in its middle that proves it.
    ///
    /// # Errors
    /// Why the edge is not proved.
    pub fn edge(&mut self, from: &[f64], to: &[f64]) -> Result<Vec<Vec<[f64; 2]>>, String> {
        self.motion(&Motion::new(self.model, from, to)?)
    }

    /// The same of a curve: for each column the coefficients of its polynomial from 0 to 1, the constant first.
    ///
    /// # Errors
    /// Why it is not proved; also when the robot has degrees of freedom that are no single numbers, moves by inputs or with time.
    pub fn curve(&mut self, from: &[f64], curve: &[[f64; 6]]) -> Result<Vec<Vec<[f64; 2]>>, String> {
        self.motion(&Motion::along(self.model, from, curve)?)
    }

    fn motion(&mut self, motion: &Motion<'_>) -> Result<Vec<Vec<[f64; 2]>>, String> {
        (0..self.shapes.len()).map(|pair| self.pair(motion, pair)).collect()
    }

    fn pair(&mut self, motion: &Motion<'_>, index: usize) -> Result<Vec<[f64; 2]>, String> {
        let (pair, shapes) = (&self.model.pairs[index], &self.shapes[index]);
        let body = &self.model.bodies[pair.body];
        let others = || pair.others.iter().map(|i| &self.model.bodies[*i]);
        // All that stand still are as far from the body as they come near.
        let moving = others().take(1);
        let mut open = vec![[0.0, 1.0]];
        let mut parts = Vec::new();
        while let Some([begin, end]) = open.pop() {
            if self.interrupt.ask() {
                return Err("there was no time left to prove it".to_owned());
            }
            let at = 0.5 * (begin + end);
            let frames = motion.frames(at).ok_or("the robot has no pose there")?;
            let moved = moving.clone().map(|other| motion.bound(body, other, &frames, [begin, end]));
            // A little more than is asked for: other programs round in other ways.
            let needed = (moved.fold(0.0, f64::max) + self.margin) * (1.0 + 1e-9);
            let pose = shapes.frame.map_or_else(Isometry3::identity, |frame| frames[frame]);
            match shapes.body.at_least(&frames[body.frame], &shapes.others, &pose, needed * (1.0 + 1e-9)) {
                Ok(_) => parts.push([end, needed]),
                Err(found) if found <= 0.0 => {
                    let names: Vec<&str> = others().map(|other| other.name.as_str()).take(4).collect();
                    return Err(format!("{} hits something of {}", body.name, names.join(", ")));
                }
                Err(found) if found < self.margin || end - begin < SHORTEST => {
                    return Err(format!("{} comes too near to contact", body.name));
                }
                Err(_) => open.extend([[at, end], [begin, at]]),
            }
        }
        Ok(parts)
    }
}

/// The pose of a frame that stands still in the world.
fn still(model: &MotionModel, frame: usize) -> Option<Isometry3<f64>> {
    match model.frames.get(frame)? {
        ModelFrame::Fixed { parent: None, pose: [x, y, z, i, j, k, w] } => {
            let turn = nalgebra::Quaternion::new(*w, *i, *j, *k);
            let turn = nalgebra::UnitQuaternion::new_normalize(turn);
            Some(Isometry3::from_parts(nalgebra::Translation3::new(*x, *y, *z), turn))
        }
        _ => None,
    }
}

/// The pieces of bodies as triangles, of which some have no area, and as balls; in the world, or in the frame of the only one.
///
/// # Errors
/// Where that makes no mesh, or a body with a radius has other pieces than points.
fn merged<'b>(
    model: &MotionModel,
    bodies: impl Iterator<Item = &'b ModelBody>,
    in_world: bool,
) -> Result<RefMesh, String> {
    let (mut vertices, mut triangles, mut clouds) = (Vec::new(), Vec::new(), Vec::new());
    for body in bodies {
        let pose = still(model, body.frame).filter(|_| in_world).unwrap_or_else(Isometry3::identity);
        if body.radius > 0.0 {
            let is_point = |piece: &Vec<u32>| piece.iter().all(|corner| *corner == piece[0]);
            if !body.pieces.iter().all(is_point) {
                return Err(format!("{} is rounded, but no balls", body.name));
            }
            let center = |piece: &Vec<u32>| pose * Point3::from(body.vertices[piece[0] as usize]);
            if body.radii.is_empty() {
                let points = body.pieces.iter().map(center).collect();
                clouds.push(TriMesh::of_balls(points, body.radius).map_err(|e| e.to_string())?);
            }
            for (piece, radius) in body.pieces.iter().zip(&body.radii) {
                clouds.push(TriMesh::of_balls(vec![center(piece)], *radius).map_err(|e| e.to_string())?);
            }
            continue;
        }
        let first = u32::try_from(vertices.len()).unwrap_or(u32::MAX);
        vertices.extend(body.vertices.iter().map(|v| pose * Point3::from(*v)));
        triangles.extend(body.pieces.iter().filter_map(|piece| {
            let last = *piece.last()?;
            Some(std::array::from_fn(|i| first.saturating_add(piece.get(i).copied().unwrap_or(last))))
        }));
    }
    if !triangles.is_empty() || clouds.is_empty() {
        clouds.push(TriMesh::new(vertices, triangles).map_err(|e| e.to_string())?);
    }
    let mesh = TriMesh::merged(&clouds).ok_or("the bodies have too many triangles")?;
    Ok(RefMesh::new(&mesh))
}

/// Checks that the model places the bodies of the robot where the robot has them at a row of numbers.
///
/// # Errors
/// When it does not.
pub fn agrees(model: &MotionModel, row: &[f64], poses: &[Isometry3<f64>]) -> Result<(), Error> {
    let placed = Motion::new(model, row, row)
        .map_err(Error::new)?
        .poses(0.0)
        .ok_or_else(|| Error::new("the model of the robot has no pose here"))?;
    let robots = model.bodies.iter().zip(placed).filter(|(body, _)| body.of_robot);
    for ((body, at), pose) in robots.zip(poses) {
        let off = body.vertices.iter().map(|v| {
            let v = Point3::from(*v);
            let (p, q) = (at * v, pose * v);
            (p - q).norm() / (1.0 + q.coords.norm())
        });
        let off = off.fold(0.0, f64::max);
        if off > ROUNDING {
            let message = format!("the model of {} is {} off", body.name, brief(off));
            return Err(Error::new(message).help("this is a fault of the program: please report it"));
        }
    }
    Ok(())
}
