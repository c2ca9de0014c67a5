//! The tree of bodies and joints.

use super::document::{Classes, Element, MAX_DEPTH, Model, Said, too_deep};
use super::geom::{GeomShape, MeshAsset, assets};
use super::pairs::{Bits, Couplings, PairedGeoms};
use super::pose::{Compiler, turned};
use mp_formats::error::Error;
use mp_formats::files::Files;
use mp_geom::TriMesh;
use mp_stop::Interrupt;
use nalgebra::{Isometry3, Point3, Translation3, Unit, Vector3};
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// The most bodies and joints.
const MAX_BODIES: usize = 5000;
/// How far (m) a joint slides each way that has no limits.
const SLIDE: f64 = 10.0;

/// A link: a body, or what is between two joints of a body.
pub(super) struct MjLink<'m> {
    pub(super) name: String,
    pub(super) node: Element<'m>,
    pub(super) shapes: Vec<GeomShape<'m>>,
    /// What its shapes may touch.
    pub(super) bits: Bits,
    /// The first link of the rigid body that it is of, and that of the rigid body that the joints of its body are on.
    pub(super) weld: usize,
    pub(super) above: usize,
    /// Whether it moves freely in MuJoCo. Here it stands.
    pub(super) free: bool,
}

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Moves {
    Fixed,
    Turns,
    Slides,
}

/// A joint of the URDF.
pub(super) struct MjJoint<'m> {
    pub(super) name: String,
    pub(super) node: Element<'m>,
    pub(super) parent: usize,
    pub(super) child: usize,
    pub(super) origin: Isometry3<f64>,
    pub(super) axis: Vector3<f64>,
    pub(super) moves: Moves,
    pub(super) range: Option<[f64; 2]>,
    /// The value (rad or m) at which the model is as it is written.
    pub(super) reference: f64,
}

/// What numbers of a keyframe belong to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Numbers {
    /// One to this joint.
    One(usize),
    /// Four to this joint and the next two.
    Ball(usize),
    /// Seven to a body that moves freely.
    Free,
}

impl Numbers {
    pub(super) fn count(&self) -> usize {
        match self {
            Self::One(_) => 1,
            Self::Ball(_) => 4,
            Self::Free => 7,
        }
    }
}

/// An element, and the pose and the class of the frames around it in the body.
#[derive(Clone, Copy)]
pub(super) struct Inside<'m> {
    pub(super) node: Element<'m>,
    pub(super) pose: Isometry3<f64>,
    pub(super) class: usize,
}

/// What is read of a model.
pub(super) struct Reader<'a, 'm> {
    pub(super) model: &'a Model<'m>,
    pub(super) classes: &'a Classes<'m>,
    pub(super) compiler: Compiler<'m>,
    pub(super) meshes: BTreeMap<String, MeshAsset>,
    pub(super) paired: PairedGeoms<'m>,
    pub(super) couplings: Couplings<'m>,
    pub(super) links: Vec<MjLink<'m>>,
    pub(super) joints: Vec<MjJoint<'m>>,
    pub(super) numbers: Vec<Numbers>,
    pub(super) made: BTreeMap<String, TriMesh>,
    pub(super) files: &'a dyn Files,
    /// What is passed over, and where.
    left_out: BTreeMap<&'static str, BTreeSet<String>>,
    names: HashSet<String>,
    /// How many bodies there are so far, with the world.
    bodies: usize,
    interrupt: Interrupt,
}

impl<'a, 'm> Reader<'a, 'm> {
    pub(super) fn new(
        model: &'a Model<'m>,
        classes: &'a Classes<'m>,
        files: &'a dyn Files,
    ) -> Result<Self, Error> {
        let mut read = Self {
            model,
            classes,
            compiler: Compiler::of(model)?,
            meshes: BTreeMap::new(),
            paired: PairedGeoms::of(model)?,
            couplings: Couplings::of(model, classes)?,
            links: Vec::new(),
            joints: Vec::new(),
            numbers: Vec::new(),
            made: BTreeMap::new(),
            left_out: BTreeMap::new(),
            names: HashSet::new(),
            bodies: 1,
            files,
            interrupt: files.interrupt(),
        };
        read.meshes = assets(&mut read)?;
        Ok(read)
    }

    /// Reads all that the world holds.
    pub(super) fn world(&mut self) -> Result<(), Error> {
        let root = self.model.documents[0].root_element();
        let sections = self.model.sections("worldbody");
        let Some(&first) = sections.first() else {
            let message = "there is no <worldbody>: the model has no bodies";
            return Err(self
                .model
                .error(root, message)
                .help("name the file of the whole model, which includes this one"));
        };
        let world = self.add_link(first, "world", None)?;
        for section in sections {
            let inside = Inside { node: section, pose: Isometry3::identity(), class: 0 };
            let inside = self.contents(inside)?;
            self.geoms(world, &inside)?;
            self.bodies(world, &inside, 1)?;
        }
        for name in std::mem::take(&mut self.couplings.unread) {
            self.left_out(
                "equalities other than of joints in proportion are not read: joints move without them",
                name,
            );
        }
        for (name, what) in [
            ("tendon", "tendons are not read: joints move without them"),
            ("deformable", "deformable things are not read"),
        ] {
            for node in self.model.inside(name) {
                self.left_out(what, node.attribute("name").unwrap_or(node.tag_name().name()));
            }
        }
        Ok(())
    }

    pub(super) fn said(&self, at: &Inside<'m>) -> Result<Said<'a, 'm>, Error> {
        Said::of(self.model, self.classes, at.node, at.class)
    }

    /// The bodies with shapes that stay where they are when the base of the robot moves: the world, and if bodies with joints move freely, all that does
    /// not hang on one of these.
    pub(super) fn scenery(&self) -> Vec<String> {
        let mut above = vec![None; self.links.len()];
        self.joints.iter().for_each(|joint| above[joint.child] = Some(joint.parent));
        let upward = |link: usize| std::iter::successors(Some(link), |link| above[*link]);
        let moving = self.joints.iter().filter(|joint| joint.moves != Moves::Fixed);
        let bases: BTreeSet<usize> =
            moving.flat_map(|joint| upward(joint.child)).filter(|link| self.links[*link].free).collect();
        let stays = |link: &usize| match bases.is_empty() {
            true => *link == 0,
            false => !upward(*link).any(|link| bases.contains(&link)),
        };
        let seen = (0..self.links.len()).filter(|link| !self.links[*link].shapes.is_empty());
        seen.filter(stays).map(|link| self.links[link].name.clone()).collect()
    }

    /// Notes that something is not read.
    pub(super) fn left_out(&mut self, what: &'static str, name: &str) {
        self.left_out.entry(what).or_default().insert(name.to_owned());
    }

    /// What is to be said of what was read.
    pub(super) fn notes(&self) -> Vec<String> {
        let shown = |(what, names): (&&str, &BTreeSet<String>)| {
            let first: Vec<_> = names.iter().take(4).map(String::as_str).collect();
            let more = names.len() - first.len();
            let more = if more == 0 { String::new() } else { format!(" and {more} more") };
            format!("{what}: {}{more}", first.join(", "))
        };
        self.left_out.iter().map(shown).collect()
    }

    /// What is in a body, frames opened.
    fn contents(&mut self, at: Inside<'m>) -> Result<Vec<Inside<'m>>, Error> {
        let (mut found, mut stack) = (Vec::new(), vec![(at, 0)]);
        while let Some((at, depth)) = stack.pop() {
            let is_frame = at.node.has_tag_name("frame");
            if depth > 0 && !is_frame {
                found.push(at);
                continue;
            }
            if depth > MAX_DEPTH {
                return Err(too_deep(self.model, at.node));
            }
            let class = match at.node.attribute("childclass") {
                Some(name) => self.classes.number(self.model, at.node, name)?,
                None => at.class,
            };
            let pose = if is_frame { at.pose * self.compiler.pose(&self.said(&at)?)? } else { at.pose };
            let inner = self.model.children(at.node).into_iter().rev();
            stack.extend(inner.map(|node| (Inside { node, pose, class }, depth + 1)));
        }
        Ok(found)
    }

    /// Adds a link, welded to what is `above` it unless a joint is between.
    fn add_link(&mut self, node: Element<'m>, name: &str, above: Option<usize>) -> Result<usize, Error> {
        if self.interrupt.ask() {
            return Err(Error::interrupted(self.model.sources[0].file.display()));
        }
        if self.links.len() >= MAX_BODIES {
            let message = format!("the model has more than {MAX_BODIES} bodies and joints");
            return Err(self.model.too_large(node, message));
        }
        if !self.names.insert(format!("link {name}")) {
            let message = format!("there are two bodies named \"{}\"", mp_formats::text::clipped(name));
            return Err(self.model.error(node, message).help("give each a name of its own"));
        }
        let number = self.links.len();
        let (weld, above) =
            above.map_or((number, number), |above| (self.links[above].weld, self.links[above].above));
        let (name, shapes, bits) = (name.to_owned(), Vec::new(), Bits::default());
        self.links.push(MjLink { name, node, shapes, bits, weld, above, free: false });
        Ok(number)
    }

    fn add_joint(&mut self, mut joint: MjJoint<'m>) -> Result<(), Error> {
        let taken = !self.names.insert(format!("joint {}", joint.name));
        if taken && joint.node.has_attribute("name") && joint.moves != Moves::Fixed {
            let message =
                format!("there are two joints named \"{}\"", mp_formats::text::clipped(&joint.name));
            return Err(self.model.error(joint.node, message).help("give each a name of its own"));
        }
        if taken {
            joint.name = format!("{}#{}", joint.name, self.joints.len());
            self.names.insert(format!("joint {}", joint.name));
        }
        self.joints.push(joint);
        Ok(())
    }

    fn bodies(&mut self, link: usize, inside: &[Inside<'m>], depth: usize) -> Result<(), Error> {
        for at in inside {
            match at.node.tag_name().name() {
                "body" if depth > MAX_DEPTH => return Err(too_deep(self.model, at.node)),
                "body" => self.body(link, at, depth)?,
                "replicate" | "attach" => {
                    let message = format!("<{}> is not read", at.node.tag_name().name());
                    return Err(self.model.error(at.node, message).help(
                        "load the model by MuJoCo, and save what it makes of it: `mujoco.mj_saveLastXML(\"robot.xml\", model)` in Python",
                    ));
                }
                "composite" | "flexcomp" => self.left_out(
                    "parts that MuJoCo makes of many bodies are not read",
                    at.node.tag_name().name(),
                ),
                _ => {}
            }
        }
        Ok(())
    }

    fn body(&mut self, parent: usize, at: &Inside<'m>, depth: usize) -> Result<(), Error> {
        let pose = at.pose * self.compiler.pose(&self.said(at)?)?;
        let name = at.node.attribute("name").map_or_else(|| format!("body {}", self.bodies), str::to_owned);
        self.bodies += 1;
        let inside = self.contents(Inside { pose: Isometry3::identity(), ..*at })?;
        self.joints(parent, pose, &name, at.node, &inside)?;
        let link = self.links.len() - 1;
        self.geoms(link, &inside)?;
        self.bodies(link, &inside, depth + 1)
    }

    /// Adds a body, the last link, and the joints by which it hangs on `parent`, one after the other: between them are links without shapes.
    fn joints(
        &mut self,
        parent: usize,
        mut at: Isometry3<f64>,
        body: &str,
        node: Element<'m>,
        inside: &[Inside<'m>],
    ) -> Result<(), Error> {
        let mut from = parent;
        let all: Vec<_> =
            inside.iter().filter(|at| matches!(at.node.tag_name().name(), "joint" | "freejoint")).collect();
        for (i, inner) in all.iter().enumerate() {
            let said = self.said(inner)?;
            let kind = if inner.node.has_tag_name("freejoint") {
                "free"
            } else {
                said.text("type").unwrap_or("hinge")
            };
            let name =
                inner.node.attribute("name").map_or_else(|| format!("{body}/joint{}", i + 1), str::to_owned);
            let place = inner.pose * Point3::from(said.numbers::<3>("pos")?.unwrap_or_default());
            let place = Translation3::from(place.coords);
            let turns = kind != "slide";
            let (axis, reference, range) = match kind {
                "free" => {
                    self.numbers.push(Numbers::Free);
                    self.left_out("these bodies, which move freely in MuJoCo, stand where they are", body);
                    continue;
                }
                "ball" => {
                    self.numbers.push(Numbers::Ball(self.joints.len()));
                    self.left_out(
                        "these balls are three hinges each, about x, y and z one after the other",
                        &name,
                    );
                    (None, 0.0, self.range(&said, true)?.map(|[_, high]| [-high, high]))
                }
                "hinge" | "slide" => {
                    self.numbers.push(Numbers::One(self.joints.len()));
                    let axis = Vector3::from(said.numbers::<3>("axis")?.unwrap_or([0.0, 0.0, 1.0]));
                    let axis = Unit::try_new(axis, 1e-10)
                        .ok_or_else(|| said.wrong("axis", "a vector that has a direction"))?;
                    let axis = inner.pose.rotation * axis;
                    let unit = if turns { self.compiler.angle } else { 1.0 };
                    (Some(axis), unit * said.number("ref", 0.0)?, self.range(&said, turns)?)
                }
                _ => return Err(said.wrong("type", "hinge, slide, ball or free")),
            };
            let parts = match axis {
                Some(axis) => vec![(axis, name)],
                None => [(Vector3::x_axis(), "x"), (Vector3::y_axis(), "y"), (Vector3::z_axis(), "z")]
                    .map(|(axis, letter)| (axis, format!("{name}/{letter}")))
                    .into(),
            };
            let last = i + 1 == all.len() && (!turns || place.vector == Vector3::zeros());
            let count = parts.len();
            for (k, (axis, name)) in parts.into_iter().enumerate() {
                let before: Isometry3<f64> = match (turns, k) {
                    (true, 0) => place * turned(axis, -reference),
                    (true, _) => Isometry3::identity(),
                    (false, _) => Translation3::from(-reference * axis.into_inner()).into(),
                };
                let ends = last && k + 1 == count;
                let link = if ends { body.to_owned() } else { format!("{body}/{name}") };
                let child = self.add_link(if ends { node } else { inner.node }, &link, Some(from))?;
                (self.links[child].weld, self.links[child].above) = (child, self.links[parent].weld);
                let (moves, range) = match (turns, range) {
                    (true, range) => (Moves::Turns, range),
                    (false, Some(range)) => (Moves::Slides, Some(range)),
                    (false, None) => {
                        self.left_out("these joints slide without limits: they go 10 m each way, unless `limits` of a robot problem say how far", &name);
                        (Moves::Slides, Some([reference - SLIDE, reference + SLIDE]))
                    }
                };
                let axis = axis.into_inner();
                let joint = MjJoint {
                    name,
                    node: inner.node,
                    parent: from,
                    child,
                    origin: at * before,
                    axis,
                    moves,
                    range,
                    reference,
                };
                self.add_joint(joint)?;
                (from, at) = (child, Isometry3::identity());
            }
            if turns {
                at = place.inverse().into();
            }
            if last {
                return Ok(());
            }
        }
        let child = self.add_link(node, body, Some(from))?;
        if !all.is_empty() && matches!(self.numbers.last(), Some(Numbers::Free)) {
            let above = self.links[parent].weld;
            let link = &mut self.links[child];
            (link.weld, link.above, link.free) = (child, above, true);
        }
        let (name, axis) = (format!("{body}/fixed"), Vector3::z());
        let joint = MjJoint {
            name,
            node,
            parent: from,
            child,
            origin: at,
            axis,
            moves: Moves::Fixed,
            range: None,
            reference: 0.0,
        };
        self.add_joint(joint)
    }

    /// The limits of a joint, if it has any.
    fn range(&self, said: &Said<'_, 'm>, turns: bool) -> Result<Option<[f64; 2]>, Error> {
        let range = said.numbers::<2>("range")?.filter(|range| *range != [0.0, 0.0]);
        let limited = match said.text("limited") {
            Some("true") => true,
            Some("false") => false,
            Some("auto") | None => range.is_some() && self.compiler.auto_limits,
            Some(_) => return Err(said.wrong("limited", "true, false or auto")),
        };
        let unit = if turns { self.compiler.angle } else { 1.0 };
        match range {
            _ if !limited => Ok(None),
            Some([low, high]) if low < high => Ok(Some([low * unit, high * unit])),
            _ => Err(said.wrong("range", "two numbers, the lower one first, as the joint is limited")),
        }
    }
}
