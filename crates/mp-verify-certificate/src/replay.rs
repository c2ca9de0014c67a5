//! Replays a proof: every part of every edge, every pair of bodies.

use crate::file::{Body, Certificate, Frame, Model};
use crate::motion::{Ball, Edge};
use crate::shape::Shape;
use crate::solid::{Solid, solids, witnesses};
use parry3d_f64::math::Vec3;

/// What a certificate proves.
#[derive(Clone, Debug, PartialEq)]
pub struct Proved {
    /// The name of the scene, as the certificate gives it.
    pub scene: String,
    /// How many configurations the path has.
    pub configurations: usize,
    /// How many motions between two configurations were proved.
    pub edges: usize,
    /// Of how many parts the proof consists.
    pub parts: usize,
    /// How many pairs of bodies are kept apart.
    pub pairs: usize,
    /// How many pairs of bodies of the robot there are that may touch.
    pub may_touch: usize,
    /// The clearance (m) all along the path; `None` where there is nothing to hit.
    pub clearance: Option<f64>,
}

/// Replays the proof.
pub(crate) fn replay(file: &Certificate) -> Result<Proved, String> {
    let model = &file.model;
    covers(model)?;
    let of_body = |body: &Body| solids(body).map_err(|why| format!("the body {} is odd: {why}", body.name));
    let inside: Vec<Vec<Solid>> = model.bodies.iter().map(of_body).collect::<Result<_, _>>()?;
    let shapes: Vec<Shape> = model.bodies.iter().map(Shape::new).collect();
    let balls: Vec<Ball> = model.bodies.iter().map(Ball::new).collect();
    let clearance = file.clearance.unwrap_or(0.0);
    let mut parts = 0;
    for (i, proof) in file.edges.iter().enumerate() {
        let (from, to) = (&file.path[i], &file.path[(i + 1).min(file.path.len() - 1)]);
        let place = |why: String| format!("between configurations {} and {}: {why}", i + 1, i + 2);
        let curve = file.curves.as_ref().map(|curves| curves[i].as_slice());
        let edge = Edge::new(model, from, to, curve).map_err(place)?;
        if i == 0 {
            begins_outside(model, &inside, &edge)?;
        }
        let jump = edge.jump();
        // What jumps less far than it is clear of everything crosses nothing.
        let crosses_nothing = jump <= 1e-6 && jump <= clearance;
        if !(crosses_nothing || model.pairs.is_empty()) {
            return Err(place(format!("it leads {jump} m away from the next configuration")));
        }
        for (pair, proof) in model.pairs.iter().zip(proof) {
            let body = &model.bodies[pair.body];
            let mut begin = 0.0;
            for &[end, distance] in proof {
                if !(end > begin && end <= 1.0) {
                    return Err(place(format!("the parts of {} are out of order", body.name)));
                }
                let frames = edge.frames(0.5 * (begin + end));
                for &k in &pair.others {
                    let (other, shape) = (&model.bodies[k], &shapes[k]);
                    let nearing = edge.nearing(&balls[pair.body], &balls[k], &frames, [begin, end]);
                    let nearing = nearing * (1.0 + 1e-9);
                    let what = || format!("{} and {} at {}", body.name, other.name, 0.5 * (begin + end));
                    let enough = distance >= nearing + clearance;
                    if !enough {
                        return Err(place(format!(
                            "{} may come {nearing} m nearer, and {distance} m do not leave {clearance} m",
                            what()
                        )));
                    }
                    let [at, other_at] = [frames[body.frame], frames[other.frame]];
                    if !shapes[pair.body].apart(&at, shape, &other_at, distance) {
                        return Err(place(format!("{} are not {distance} m apart", what())));
                    }
                }
                (begin, parts) = (end, parts + 1);
            }
            if begin < 1.0 {
                return Err(place(format!("the proof of {} ends at {begin}", body.name)));
            }
        }
    }
    let robots = model.bodies.iter().filter(|body| body.of_robot).count();
    let kept =
        model.pairs.iter().flat_map(|pair| &pair.others).filter(|i| model.bodies[**i].of_robot).count();
    Ok(Proved {
        scene: file.scene.clone(),
        configurations: file.path.len(),
        edges: file.path.len() - 1,
        parts,
        pairs: model.pairs.iter().map(|pair| pair.others.len()).sum(),
        may_touch: (robots * robots.saturating_sub(1) / 2).saturating_sub(kept),
        clearance: file.clearance,
    })
}

/// Whether a frame moves as the robot does.
fn moves(model: &Model, frame: usize) -> bool {
    std::iter::successors(Some(frame), |i| model.frames[*i].parent()).any(|i| match &model.frames[i] {
        Frame::Fixed { .. } | Frame::Track { .. } => false,
        Frame::Joint { column, .. } => column.is_some(),
        Frame::Pose { .. } | Frame::Plane { .. } => true,
    })
}

/// Every body of the robot that moves must be kept from every obstacle.
fn covers(model: &Model) -> Result<(), String> {
    for (i, body) in model.bodies.iter().enumerate().filter(|(_, body)| body.of_robot) {
        for (j, other) in model.bodies.iter().enumerate().filter(|(_, other)| !other.of_robot) {
            let still =
                !moves(model, body.frame) && !matches!(model.frames[other.frame], Frame::Track { .. });
            let kept = model.pairs.iter().any(|pair| pair.body == i && pair.others.contains(&j));
            if !(still || kept) {
                return Err(format!("nothing is said of {} and {}", body.name, other.name));
            }
        }
    }
    Ok(())
}

/// Whether nothing of a body is inside of another where the path begins. Nothing can get there later: it
/// would have to cross a boundary.
fn begins_outside(model: &Model, solids: &[Vec<Solid>], edge: &Edge<'_>) -> Result<(), String> {
    let frames = edge.frames(0.0);
    let corners: Vec<Vec<Vec3>> = model.bodies.iter().map(witnesses).collect();
    for pair in &model.pairs {
        for other in &pair.others {
            for (outer, inner) in [(*other, pair.body), (pair.body, *other)] {
                let (a, b) = (&model.bodies[outer], &model.bodies[inner]);
                let pose = frames[a.frame].inverse() * frames[b.frame];
                let held =
                    |corner: &Vec3| solids[outer].iter().any(|s| s.holds(pose.transform_point(*corner)));
                if corners[inner].iter().any(held) {
                    return Err(format!("the path begins with {} inside of {}", b.name, a.name));
                }
            }
        }
    }
    Ok(())
}
