//! Whether a certificate is about a scene: its bodies, where they stand and how they move, what is kept apart, and the ends of its path.

use super::{VERSION, columns};
use crate::finish::check::end_faults;
use crate::finish::trajectory::HAIR;
use crate::path::states;
use crate::{Error, ModelBody, ModelFrame, ModelPart, MotionModel, PathRows, Robot, plain};
use mp_cspace::Space;
use mp_time::range;
use serde::Deserialize;
use std::collections::HashSet;

/// What is compared of a certificate.
#[derive(Deserialize)]
struct Claims {
    columns: Vec<String>,
    model: MotionModel,
    path: Vec<Vec<f64>>,
    #[serde(default)]
    curves: Vec<Vec<[f64; 6]>>,
}

#[derive(Deserialize)]
struct Version {
    certificate: u32,
}

/// In what a certificate differs from a scene, each a sentence that names what and gives the numbers; nothing if it is of the scene.
///
/// # Errors
/// When the text is no certificate, or the kind of robot has no model.
pub(crate) fn differences(kind: &dyn Robot, text: &str) -> Result<Vec<String>, Error> {
    let unread = |e: serde_json::Error| Error::new(format!("the certificate cannot be read: {e}"));
    let Version { certificate } = serde_json::from_str(text).map_err(unread)?;
    if !(VERSION..=VERSION + 1).contains(&certificate) {
        let what = format!(
            "the certificate is of version {certificate}, and this program knows versions {VERSION} and {}",
            VERSION + 1
        );
        return Err(Error::new(what).help("write it anew: `mp check SCENE PATH --certificate FILE`"));
    }
    let claims: Claims = serde_json::from_str(text).map_err(unread)?;
    let mut found = Vec::new();
    let named = columns(kind);
    if claims.columns != named {
        found.push(format!(
            "its numbers are {}, those of the scene are {}",
            claims.columns.join(", "),
            named.join(", ")
        ));
        return Ok(found);
    }
    between(&claims.model, &kind.motion_model()?, &mut found);
    let path = PathRows { format: kind.path_format(), columns: kind.columns(), rows: claims.path };
    let states = states(kind, &path)?;
    found.extend(end_faults(kind, &states).into_iter().map(|fault| format!("its path {fault}")));
    let outside = states.iter().position(|q| !kind.any_space().contains(q));
    found.extend(
        outside.map(|i| format!("configuration {} of its path is {}", i + 1, kind.out_of_bounds(&states[i]))),
    );
    found.extend(kind.row_error(&path.rows).map(|odd| format!("its path is odd: {odd}")));
    let beyond = |(i, curve): (usize, &Vec<[f64; 6]>)| {
        let mut columns = curve.iter().zip(kind.limits()).zip(kind.columns());
        columns.find_map(|((polynomial, limits), column)| {
            let ([low, high], [least, most]) = (limits?, range(polynomial, 0.0, 1.0));
            let within = low - HAIR <= least && most <= high + HAIR;
            (!within).then(|| {
                let [least, most, low, high] = [least, most, low, high].map(plain);
                let name = column.name;
                let ends = format!("configurations {} and {} of its path", i + 1, i + 2);
                format!(
                    "between {ends} {name} is from {least} to {most}, and its limits are {low} and {high}"
                )
            })
        })
    };
    found.extend(claims.curves.iter().enumerate().find_map(beyond));
    if let Some(i) = states.windows(2).position(|ends| !kind.can_move(&ends[0], &ends[1])) {
        found.push(format!("the robot cannot move from configuration {} to {} of its path", i + 1, i + 2));
    }
    Ok(found)
}

/// Adds in what the model of a certificate differs from that of a scene.
fn between(own: &MotionModel, scene: &MotionModel, found: &mut Vec<String>) {
    if own.steps != scene.steps || own.time != scene.time || own.drive != scene.drive {
        found.push(format!(
            "its robot moves by {:?}, time {:?}, inputs {:?}; that of the scene by {:?}, time {:?}, inputs {:?}",
            own.steps, own.time, own.drive, scene.steps, scene.time, scene.drive
        ));
    }
    let missing = |a: &MotionModel, b: &MotionModel| -> Vec<String> {
        let names: HashSet<&str> = b.bodies.iter().map(|body| body.name.as_str()).collect();
        a.bodies.iter().map(|body| body.name.clone()).filter(|name| !names.contains(name.as_str())).collect()
    };
    found.extend(
        missing(scene, own).into_iter().map(|name| format!("it has no body {name}, which the scene has")),
    );
    found.extend(
        missing(own, scene).into_iter().map(|name| format!("it has a body {name}, which the scene has not")),
    );
    if own.bodies.len() != scene.bodies.len() {
        found.push(format!("it has {} bodies, the scene {}", own.bodies.len(), scene.bodies.len()));
        return;
    }
    for (a, b) in own.bodies.iter().zip(&scene.bodies) {
        if a.name == b.name {
            found.extend(body(a, b).map(|what| format!("{}: {what}", a.name)));
            found.extend(place(own, a, scene, b).map(|what| format!("{}: {what}", a.name)));
        } else {
            found.push(format!("it has a body {} where the scene has {}", a.name, b.name));
        }
    }
    let pairs = |model: &MotionModel| -> Vec<[usize; 2]> {
        let each = model.pairs.iter().flat_map(|pair| pair.others.iter().map(|other| [pair.body, *other]));
        each.map(|[a, b]| [a.min(b), a.max(b)]).collect()
    };
    let kept: HashSet<[usize; 2]> = pairs(own).into_iter().collect();
    let name = |i: usize| scene.bodies.get(i).map_or("?", |body| body.name.as_str());
    let open = pairs(scene).into_iter().filter(|pair| !kept.contains(pair));
    found.extend(open.map(|[a, b]| {
        format!("it does not keep {} and {} apart, which the scene compares", name(a), name(b))
    }));
}

/// In what a body differs from that of a scene, by itself.
fn body(own: &ModelBody, scene: &ModelBody) -> Option<String> {
    let solids = |body: &ModelBody| -> usize {
        let solid = |part: &ModelPart| if let ModelPart::Solid(n) = part { *n } else { 0 };
        body.parts.iter().map(solid).sum()
    };
    if own.of_robot != scene.of_robot {
        return Some("it is part of the robot in one of both only".to_owned());
    }
    if own.radius.to_bits() != scene.radius.to_bits() {
        return Some(format!(
            "its radius is {} m, in the scene {} m",
            plain(own.radius),
            plain(scene.radius)
        ));
    }
    if own.radii.iter().map(|r| r.to_bits()).ne(scene.radii.iter().map(|r| r.to_bits())) {
        return Some("the radii of its balls are other ones in the scene".to_owned());
    }
    for (what, a, b) in [
        ("vertices", own.vertices.len(), scene.vertices.len()),
        ("pieces", own.pieces.len(), scene.pieces.len()),
        ("pieces that are solid", solids(own), solids(scene)),
    ] {
        if a != b {
            return Some(format!("it has {a} {what}, in the scene {b}"));
        }
    }
    if let Some(i) = own.vertices.iter().zip(&scene.vertices).position(|(a, b)| a != b) {
        let [a, b] = [own, scene].map(|body| numbers(&body.vertices[i]));
        return Some(format!("vertex {i} is at {a}, in the scene at {b}"));
    }
    if let Some(i) = own.pieces.iter().zip(&scene.pieces).position(|(a, b)| a != b) {
        return Some(format!("piece {i} is {:?}, in the scene {:?}", own.pieces[i], scene.pieces[i]));
    }
    (own.parts != scene.parts)
        .then(|| format!("its parts are {:?}, in the scene {:?}", own.parts, scene.parts))
}

/// In what the place of a body, or how it moves, differs from that in a scene.
fn place(own: &MotionModel, a: &ModelBody, scene: &MotionModel, b: &ModelBody) -> Option<String> {
    let (mut i, mut j) = (Some(a.frame), Some(b.frame));
    // As many frames as there are: those of a certificate may be in a circle.
    for _ in 0..=scene.frames.len() {
        let (Some(a), Some(b)) = (i, j) else { break };
        let (Some(a), Some(b)) = (own.frames.get(a), scene.frames.get(b)) else {
            return Some("it has no frame".to_owned());
        };
        if let Some(what) = frame(a, b) {
            return Some(what);
        }
        (i, j) = (parent(a), parent(b));
    }
    (i.is_some() || j.is_some()).then(|| "it hangs from another frame than in the scene".to_owned())
}

fn parent(frame: &ModelFrame) -> Option<usize> {
    match frame {
        ModelFrame::Fixed { parent, .. } => *parent,
        ModelFrame::Joint { parent, .. } => Some(*parent),
        _ => None,
    }
}

/// In what a frame differs from that of a scene, but for its parent.
fn frame(own: &ModelFrame, scene: &ModelFrame) -> Option<String> {
    use ModelFrame::{Fixed, Joint, Track};
    let differ = |what: &str, a: &[f64], b: &[f64]| {
        (a != b).then(|| format!("{what} {}, in the scene {}", numbers(a), numbers(b)))
    };
    match (own, scene) {
        (Fixed { pose: a, .. }, Fixed { pose: b, .. }) => differ("it stands at", a, b),
        (
            Joint { origin: o, axis: a, slides: s, column: c, factor: f, offset: e, .. },
            Joint { origin, axis, slides, column, factor, offset, .. },
        ) => differ("its joint is at", o, origin)
            .or_else(|| differ("the axis of its joint is", a, axis))
            .or_else(|| differ("the factor and the offset of its joint are", &[*f, *e], &[*factor, *offset]))
            .or_else(|| {
                ((s, c) != (slides, column)).then(|| {
                    let kind = |slides: &bool| if *slides { "slides" } else { "turns" };
                    let by =
                        |column: &Option<usize>| column.map_or("none".to_owned(), |i| format!("{}", i + 1));
                    let [a, b] =
                        [(s, c), (slides, column)].map(|(s, c)| format!("{} by number {}", kind(s), by(c)));
                    format!("its joint {a}, in the scene it {b}")
                })
            }),
        (Track { time: t, poses: a }, Track { time, poses: b }) => {
            if t != time || a.len() != b.len() {
                return Some(format!("it moves by {} poses, in the scene by {}", a.len(), b.len()));
            }
            a.iter().zip(b).find_map(|(a, b)| differ("it moves by way of time and pose", a, b))
        }
        (a, b) => (a != b).then(|| format!("it moves as {a:?}, in the scene as {b:?}")),
    }
}

/// Numbers as they are written, to be compared by eye.
fn numbers(all: &[f64]) -> String {
    format!("({})", all.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
}
