//! Compiles a model, whose links and joints refer to each other by name, to a checked kinematic tree.

use super::kinematics::{AttachedLink, BASE_NUMBERS, Coordinate, JointFrame, Kinematics, is_pose, range};
use super::{ArmError, ArmModel, Joint, JointKind};
use mp_cspace::{JointRange, Se3};
use mp_geom::Aabb;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion};
use std::collections::HashMap;

/// The largest coordinate of an origin, and the largest limit.
pub(crate) const MAX_LENGTH: f64 = 1e70;

/// What gives a joint its value.
#[derive(Clone, Copy)]
enum Value {
    /// A fixed joint has no value.
    Fixed,
    /// The limits of the joint are equal, or those of the joint that it mimics.
    Held(f64),
    /// A coordinate gives the value.
    Follows(Source),
}

/// The coordinate that gives a joint its value: coordinate times `scale` plus `offset`.
#[derive(Clone, Copy)]
struct Source {
    coordinate: usize,
    scale: f64,
    offset: f64,
}

pub(crate) fn kinematics(model: &ArmModel) -> Result<Kinematics, ArmError> {
    if !is_pose(&model.base, MAX_LENGTH) {
        return Err(ArmError::Origin { what: "base", name: String::new(), max: MAX_LENGTH });
    }
    let links = numbered("link", model.links.iter().map(|link| link.name.as_str()))?;
    let joints = numbered("joint", model.joints.iter().map(|joint| joint.name.as_str()))?;
    model.joints.iter().try_for_each(check)?;
    let tree = Tree::new(model, &links)?;
    let (coordinates, values) = coordinates(model, &joints)?;
    let floating = match &model.floating {
        Some(bounds) => Some(floating(bounds, &coordinates)?),
        None => None,
    };

    let mut out = Kinematics {
        base: model.base,
        floating,
        frames: Vec::new(),
        coordinates,
        attached: Vec::new(),
        joined: tree.ends.clone(),
    };
    let mut attached: Vec<Option<AttachedLink>> = vec![None; model.links.len()];
    let name = |link: usize| model.links[link].name.clone();
    attached[tree.root] = Some(AttachedLink { name: name(tree.root), frame: 0, pose: Isometry3::identity() });
    // Breadth first: every joint comes after the joint above its parent link.
    let mut next = vec![tree.root];
    let mut at = 0;
    while at < next.len() {
        let link = next[at];
        at += 1;
        let Some(AttachedLink { frame, pose, .. }) = attached[link].clone() else { continue };
        for &j in &tree.below[link] {
            let (joint, child) = (&model.joints[j], tree.ends[j][1]);
            let origin = pose * joint.origin;
            let (frame, pose) = match values[j] {
                Value::Fixed => (frame, origin),
                Value::Held(value) => (frame, origin * motion(joint, value)),
                Value::Follows(source) => {
                    out.frames.push(frame_of(joint, frame, origin, source, &out.coordinates));
                    (out.frames.len(), Isometry3::identity())
                }
            };
            attached[child] = Some(AttachedLink { name: name(child), frame, pose });
            next.push(child);
        }
    }
    out.attached = attached.into_iter().flatten().collect();
    Ok(out)
}

/// The space of a root that floats.
fn floating(bounds: &Aabb, coordinates: &[Coordinate]) -> Result<Se3, ArmError> {
    let taken = coordinates.iter().find(|c| BASE_NUMBERS.contains(&c.name.as_str()));
    if let Some(Coordinate { name, .. }) = taken {
        return Err(ArmError::BaseName { joint: name.clone(), taken: BASE_NUMBERS.join(", ") });
    }
    let far = bounds.min.coords.amax().max(bounds.max.coords.amax());
    // Written so that NaN is refused.
    let near = far <= MAX_LENGTH;
    if !near {
        return Err(ArmError::Origin { what: "bounds", name: "of the base".to_owned(), max: MAX_LENGTH });
    }
    Ok(Se3::new(bounds.min.coords, bounds.max.coords)?)
}

/// The index of each name.
fn numbered<'a>(
    what: &'static str,
    names: impl Iterator<Item = &'a str>,
) -> Result<HashMap<&'a str, usize>, ArmError> {
    let mut numbers = HashMap::new();
    for (i, name) in names.enumerate() {
        if numbers.insert(name, i).is_some() {
            return Err(ArmError::Duplicate { what, name: name.to_owned() });
        }
    }
    Ok(numbers)
}

/// Checks a joint without regard to the others.
fn check(joint: &Joint) -> Result<(), ArmError> {
    let name = || joint.name.clone();
    if !is_pose(&joint.origin, MAX_LENGTH) {
        return Err(ArmError::Origin { what: "joint", name: name(), max: MAX_LENGTH });
    }
    let Some(range) = range(joint.kind) else { return Ok(()) };
    let [x, y, z] = joint.axis.into();
    let finite = joint.axis.iter().all(|c| c.is_finite());
    if !(finite && (1.0 / MAX_LENGTH..=MAX_LENGTH).contains(&joint.axis.amax())) {
        return Err(ArmError::Axis { joint: name(), x, y, z });
    }
    match range {
        JointRange::Interval { low, high }
            if !(low <= high && low.abs() <= MAX_LENGTH && high.abs() <= MAX_LENGTH) =>
        {
            Err(ArmError::Limits { joint: name(), low, high })
        }
        _ => Ok(()),
    }
}

/// The tree of links.
struct Tree {
    root: usize,
    /// The joints below each link, in the order of the model.
    below: Vec<Vec<usize>>,
    /// Parent and child of each joint.
    ends: Vec<[usize; 2]>,
}

impl Tree {
    fn new(model: &ArmModel, links: &HashMap<&str, usize>) -> Result<Self, ArmError> {
        let mut below = vec![Vec::new(); model.links.len()];
        let mut above: Vec<Option<usize>> = vec![None; model.links.len()];
        let mut ends = Vec::new();
        for (j, joint) in model.joints.iter().enumerate() {
            let find = |role: &'static str, name: &String| {
                links.get(name.as_str()).copied().ok_or_else(|| ArmError::UnknownLink {
                    joint: joint.name.clone(),
                    role,
                    link: name.clone(),
                })
            };
            let (parent, child) = (find("parent", &joint.parent)?, find("child", &joint.child)?);
            if let Some(first) = above[child].replace(j) {
                return Err(ArmError::TwoParents {
                    link: joint.child.clone(),
                    first: model.joints[first].name.clone(),
                    second: joint.name.clone(),
                });
            }
            below[parent].push(j);
            ends.push([parent, child]);
        }
        let name = |link: usize| model.links[link].name.clone();
        let mut roots = (0..model.links.len()).filter(|&link| above[link].is_none());
        let looped = |link: usize| ArmError::Loop {
            link: name(link),
            joint: above[link].map_or_else(String::new, |j| model.joints[j].name.clone()),
        };
        let root = match (roots.next(), roots.next()) {
            (Some(root), None) => root,
            (Some(first), Some(second)) => {
                return Err(ArmError::TwoRoots { first: name(first), second: name(second) });
            }
            (None, _) => return Err(if model.links.is_empty() { ArmError::NoLinks } else { looped(0) }),
        };
        // Links that cannot be reached from the root are in a loop.
        let mut reached = vec![false; model.links.len()];
        let mut stack = vec![root];
        while let Some(link) = stack.pop() {
            reached[link] = true;
            stack.extend(below[link].iter().map(|&j| ends[j][1]));
        }
        match reached.iter().position(|reached| !reached) {
            Some(link) => Err(looped(link)),
            None => Ok(Self { root, below, ends }),
        }
    }
}

/// The coordinates, and what gives each joint its value.
fn coordinates(
    model: &ArmModel,
    joints: &HashMap<&str, usize>,
) -> Result<(Vec<Coordinate>, Vec<Value>), ArmError> {
    let mut all = Vec::new();
    let mut own = vec![None; model.joints.len()];
    for (j, joint) in model.joints.iter().enumerate() {
        if let (Some(range), None, None) = (range(joint.kind), &joint.mimic, joint.kind.held()) {
            own[j] = Some(all.len());
            all.push(Coordinate { name: joint.name.clone(), range });
        }
    }
    let mut values = Vec::new();
    for (j, joint) in model.joints.iter().enumerate() {
        if joint.kind == JointKind::Fixed {
            values.push(Value::Fixed);
            continue;
        }
        let value = follow(model, joints, &own, j)?;
        match (value, joint.kind.limits()) {
            (Value::Follows(source), _) => narrow(joint, source, &mut all[source.coordinate])?,
            (Value::Held(value), Some([low, high])) if !(low..=high).contains(&value) => {
                let of = joint.mimic.as_ref().map_or_else(String::new, |mimic| mimic.joint.clone());
                let why = "that joint does not move, and its value is outside of the limits of this one";
                return Err(ArmError::Mimic { joint: joint.name.clone(), of, why });
            }
            _ => {}
        }
        values.push(value);
    }
    if !all.is_empty() {
        return Ok((all, values));
    }
    let held = model.joints.iter().filter(|joint| joint.kind.held().is_some());
    match held.map(|joint| format!("\"{}\"", joint.name)).collect::<Vec<_>>() {
        none if none.is_empty() => Err(ArmError::NothingMoves),
        held => Err(ArmError::AllHeld { joints: held.join(", ") }),
    }
}

/// The value of the joint `start`: follows mimics from joint to joint until one mimics no other.
fn follow(
    model: &ArmModel,
    joints: &HashMap<&str, usize>,
    own: &[Option<usize>],
    start: usize,
) -> Result<Value, ArmError> {
    let (mut j, mut scale, mut offset) = (start, 1.0, 0.0);
    for _ in 0..=model.joints.len() {
        if let Some(coordinate) = own[j] {
            return Ok(Value::Follows(Source { coordinate, scale, offset }));
        }
        let joint = &model.joints[j];
        if let (Some(value), None) = (joint.kind.held(), &joint.mimic) {
            return Ok(Value::Held(value * scale + offset));
        }
        let Some(mimic) = &joint.mimic else {
            let (joint, of) = (model.joints[start].name.clone(), joint.name.clone());
            return Err(ArmError::Mimic {
                joint,
                of,
                why: "that joint is fixed, so there is nothing to follow",
            });
        };
        let wrong = |why| ArmError::Mimic { joint: joint.name.clone(), of: mimic.joint.clone(), why };
        let usable = |x: f64| x.abs() <= MAX_LENGTH;
        if !(usable(mimic.multiplier) && usable(mimic.offset)) {
            return Err(wrong("multiplier and offset must be finite numbers"));
        }
        j = *joints.get(mimic.joint.as_str()).ok_or_else(|| wrong("there is no joint of that name"))?;
        offset += scale * mimic.offset;
        scale *= mimic.multiplier;
    }
    let joint = &model.joints[start];
    let of = joint.mimic.as_ref().map_or_else(String::new, |mimic| mimic.joint.clone());
    Err(ArmError::Mimic { joint: joint.name.clone(), of, why: "that leads back to itself" })
}

/// Narrows the range of a coordinate to the limits of a joint that follows it.
fn narrow(joint: &Joint, source: Source, coordinate: &mut Coordinate) -> Result<(), ArmError> {
    let Some(mimic) = &joint.mimic else { return Ok(()) };
    let wrong = |why| ArmError::Mimic { joint: joint.name.clone(), of: mimic.joint.clone(), why };
    let Source { scale, offset, .. } = source;
    if scale == 0.0 {
        let inside = joint.kind.limits().is_none_or(|[low, high]| (low..=high).contains(&offset));
        return if inside { Ok(()) } else { Err(wrong("its offset is outside of its limits")) };
    }
    match (joint.kind, &mut coordinate.range) {
        (JointKind::Continuous, JointRange::Circle) if scale.fract() == 0.0 => Ok(()),
        (_, JointRange::Circle) => Err(wrong(
            "that joint turns without end, so what follows it must be continuous too, by a whole multiplier; \
             or give that joint limits and make it revolute",
        )),
        (JointKind::Continuous | JointKind::Fixed, _) => Ok(()),
        (
            JointKind::Revolute { low, high } | JointKind::Prismatic { low, high },
            JointRange::Interval { low: own_low, high: own_high },
        ) => {
            let ends = [(low - offset) / scale, (high - offset) / scale];
            *own_low = own_low.max(ends[0].min(ends[1]));
            *own_high = own_high.min(ends[0].max(ends[1]));
            if *own_low < *own_high { Ok(()) } else { Err(wrong("the limits of both leave no room to move")) }
        }
    }
}

fn motion(joint: &Joint, value: f64) -> Isometry3<f64> {
    let axis = Unit::new_normalize(joint.axis);
    match joint.kind {
        JointKind::Prismatic { .. } => Translation3::from(axis.into_inner() * value).into(),
        _ => Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&axis, value)),
    }
}

fn frame_of(
    joint: &Joint,
    parent: usize,
    origin: Isometry3<f64>,
    source: Source,
    coordinates: &[Coordinate],
) -> JointFrame {
    let Source { coordinate, scale, offset } = source;
    let slides = matches!(joint.kind, JointKind::Prismatic { .. });
    let slide = match coordinates[coordinate].range {
        JointRange::Interval { low, high } if slides => {
            (low * scale + offset).abs().max((high * scale + offset).abs())
        }
        // What follows a joint without end can only slide if it stays.
        JointRange::Circle if slides => offset.abs(),
        _ => 0.0,
    };
    let axis = Unit::new_normalize(joint.axis);
    JointFrame { parent, origin, axis, slides, coordinate, scale, offset, slide }
}
