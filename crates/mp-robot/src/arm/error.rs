//! Errors of arms, and of the texts that they are read from.

use mp_collide::SceneError;
use mp_cspace::{Interrupted, SpaceError};
use mp_geom::MeshError;
use thiserror::Error;

/// Why an arm could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ArmError {
    /// Two links or two joints have the same name.
    #[error("there are two {what}s named \"{name}\": give each a name of its own")]
    Duplicate {
        /// "link" or "joint".
        what: &'static str,
        /// The name that both have.
        name: String,
    },
    /// A joint names a link that does not exist.
    #[error("joint \"{joint}\" has the {role} link \"{link}\", but there is no link of that name")]
    UnknownLink {
        /// The name of the joint.
        joint: String,
        /// "parent" or "child".
        role: &'static str,
        /// The link it names.
        link: String,
    },
    /// A pair that may touch names a link that does not exist.
    #[error(
        "the links \"{first}\" and \"{second}\" shall be allowed to touch, but there is no link \"{missing}\""
    )]
    UnknownPair {
        /// One link of the pair.
        first: String,
        /// The other.
        second: String,
        /// The name that no link has.
        missing: String,
    },
    /// The work was interrupted.
    #[error("preparing the robot was ended")]
    Interrupted,
    /// There are no links.
    #[error("an arm needs at least one link and one joint that moves; this one has no links")]
    NoLinks,
    /// No joint moves.
    #[error(
        "no joint of this arm moves by itself: at least one revolute, continuous or prismatic joint is needed"
    )]
    NothingMoves,
    /// No joint moves, because the limits of all joints that could move are equal.
    #[error(
        "no joint of this arm moves by itself: give one of {joints}, whose limits are equal, room to move"
    )]
    AllHeld {
        /// The names of the joints whose limits are equal.
        joints: String,
    },
    /// A joint of a robot whose base moves is called like a number of the pose of the base.
    #[error(
        "joint \"{joint}\" is called like a number of the pose of the base, which moves: {taken} are taken, so give the joint \
         another name"
    )]
    BaseName {
        /// The name of the joint.
        joint: String,
        /// The names of those numbers.
        taken: String,
    },
    /// The space of the joints alone was asked for, but the base floats.
    #[error("the base of this robot floats: its space is that of `Arm::floating_space`")]
    Floats,
    /// The space of a floating base was asked for, but the base stands still.
    #[error("the base of this robot stands still: its space is that of `Arm::space`")]
    StandsStill,
    /// A link is the child of two joints.
    #[error(
        "link \"{link}\" is the child of joint \"{first}\" and of joint \"{second}\": chains must be trees, so \
         a closed chain has to be cut at one of them"
    )]
    TwoParents {
        /// The name of the link.
        link: String,
        /// The first joint.
        first: String,
        /// The second joint.
        second: String,
    },
    /// Links form a loop.
    #[error(
        "the joints form a loop through link \"{link}\" (by joint \"{joint}\"): chains must be trees that begin \
         at one link with no parent"
    )]
    Loop {
        /// A link of the loop.
        link: String,
        /// The joint that closes it.
        joint: String,
    },
    /// Two links have no parent.
    #[error(
        "the links \"{first}\" and \"{second}\" both have no parent: join them by a joint, if only a fixed one"
    )]
    TwoRoots {
        /// One of them.
        first: String,
        /// Another.
        second: String,
    },
    /// The axis of a joint that moves has no direction.
    #[error("the axis of joint \"{joint}\" is {x} {y} {z}: it must have a direction")]
    Axis {
        /// The name of the joint.
        joint: String,
        /// Its axis.
        x: f64,
        /// Its axis.
        y: f64,
        /// Its axis.
        z: f64,
    },
    /// A pose is not valid.
    #[error("the origin of {what} \"{name}\" is no pose: its numbers must be finite and below {max:e} m")]
    Origin {
        /// "joint" or "link" or "base".
        what: &'static str,
        /// The name of the joint or link; empty for the base.
        name: String,
        /// The largest possible.
        max: f64,
    },
    /// The limits of a joint are not valid.
    #[error(
        "joint \"{joint}\" may move from {low} to {high}: the lower limit must not be above the upper and \
         both finite; make the joint continuous if it turns without end"
    )]
    Limits {
        /// The name of the joint.
        joint: String,
        /// Its lower limit (rad or m).
        low: f64,
        /// Its upper limit.
        high: f64,
    },
    /// Limits were given for a joint that takes none.
    #[error("there is no joint \"{joint}\" with limits of its own: {why}")]
    NoSuchCoordinate {
        /// The name asked for.
        joint: String,
        /// Why the joint takes no limits, or which joints there are.
        why: String,
    },
    /// A joint shall be held where it cannot be.
    #[error("joint \"{joint}\" shall be held at {value}, but may be from {low} to {high}")]
    Held {
        /// The name of the joint.
        joint: String,
        /// Where it shall be held (rad or m).
        value: f64,
        /// Its lower limit.
        low: f64,
        /// Its upper limit.
        high: f64,
    },
    /// Something shall be attached to a link that does not exist, or under a name that is taken.
    #[error("\"{name}\" cannot be attached to the link \"{link}\": {why}")]
    Attached {
        /// What shall be attached.
        name: String,
        /// The name of the link that should carry it.
        link: String,
        /// Why it cannot be.
        why: String,
    },
    /// A joint cannot mimic another.
    #[error("joint \"{joint}\" mimics \"{of}\": {why}")]
    Mimic {
        /// The name of the joint that mimics.
        joint: String,
        /// The one it names.
        of: String,
        /// What is wrong.
        why: &'static str,
    },
    /// A link is too large to compute with.
    #[error("link \"{link}\" is too large or too far away: {radius:e} m; at most {max:e} m can be handled")]
    TooLarge {
        /// The name of the link.
        link: String,
        /// Its size.
        radius: f64,
        /// The largest possible.
        max: f64,
    },
    /// There are more triangles than can be handled.
    #[error("arm and obstacles have {count} triangles; at most {max} can be handled")]
    TooManyTriangles {
        /// How many there are.
        count: usize,
        /// How many there may be.
        max: usize,
    },
    /// The pose of an obstacle is not valid, or its mesh is too large.
    #[error("cannot place an obstacle: {0}")]
    Obstacle(#[from] SceneError),
    /// A mesh is not valid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The ranges of the joints do not form a space.
    #[error(transparent)]
    Space(#[from] SpaceError),
}

impl From<Interrupted> for ArmError {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

/// Why a URDF or SRDF could not be read as an arm.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// The text is not XML, or not a URDF or SRDF.
    #[error("this is not {what}: {}{message}", .line.map_or_else(String::new, |line| format!("line {line}: ")))]
    Syntax {
        /// "a URDF" or "an SRDF".
        what: &'static str,
        /// Where it is in the text, if it is at one place.
        line: Option<u32>,
        /// What is wrong.
        message: String,
    },
    /// The text is XML of another format.
    #[error("line {line}: this is {format}, not {what}")]
    Other {
        /// "a URDF" or "an SRDF".
        what: &'static str,
        /// Where its first element is.
        line: u32,
        /// The other format, as messages call it.
        format: &'static str,
        /// What to do about it.
        remedy: &'static str,
    },
    /// The reader was interrupted.
    #[error("the time was up, or the work interrupted, while the robot was read")]
    Interrupted,
    /// A joint has a kind that is not handled.
    #[error(
        "line {line}: joint \"{joint}\" is {kind}: only revolute, continuous, prismatic, planar and fixed joints are handled, and \
         one that floats between the world, a link without shapes, and all of the robot; for a base that floats make it such a one, \
         or fixed, and write `base = \"floating\"` in the robot problem"
    )]
    Kind {
        /// Where it is in the text.
        line: u32,
        /// The name of the joint.
        joint: String,
        /// The type that the file gives it.
        kind: &'static str,
    },
    /// A collision shape is not valid.
    #[error("line {line}: collision shape {number} of link \"{link}\": {message}")]
    Shape {
        /// Where it is in the text.
        line: u32,
        /// The name of the link.
        link: String,
        /// The number of the shape in the link, counted from 1.
        number: usize,
        /// What is wrong.
        message: String,
    },
    /// The text was read, but does not describe a valid arm.
    #[error(transparent)]
    Arm(#[from] ArmError),
}

impl ArmError {
    /// The element of a URDF that is wrong, "joint" or "link", and its name, if the error is about one.
    #[must_use]
    pub fn element(&self) -> Option<(&'static str, &str)> {
        match self {
            Self::Duplicate { what, name } | Self::Origin { what, name, .. } => Some((what, name)),
            Self::UnknownLink { joint, .. }
            | Self::BaseName { joint, .. }
            | Self::Loop { joint, .. }
            | Self::Axis { joint, .. }
            | Self::Limits { joint, .. }
            | Self::NoSuchCoordinate { joint, .. }
            | Self::Held { joint, .. }
            | Self::Mimic { joint, .. } => Some(("joint", joint)),
            Self::TwoParents { second, .. } => Some(("joint", second)),
            Self::TwoRoots { second, .. } => Some(("link", second)),
            Self::TooLarge { link, .. } => Some(("link", link)),
            _ => None,
        }
    }
}

impl UrdfError {
    /// The line of the text, counted from 1, if the error is at one place.
    #[must_use]
    pub fn line(&self) -> Option<u32> {
        match self {
            Self::Syntax { line, .. } => *line,
            Self::Other { line, .. } | Self::Kind { line, .. } | Self::Shape { line, .. } => Some(*line),
            Self::Arm(_) | Self::Interrupted => None,
        }
    }

    /// What is wrong, without the line.
    #[must_use]
    pub fn message(&self) -> String {
        let text = self.to_string();
        match self.line() {
            Some(line) => text.replacen(&format!("line {line}: "), "", 1),
            None => text,
        }
    }

    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Syntax { .. } => {
                "correct this place, or export the robot again; xacro files must be expanded by xacro first"
            }
            Self::Interrupted => "give more time, or simplify the file",
            Self::Other { remedy, .. } => remedy,
            Self::Kind { .. } => "change the type of the joint",
            Self::Shape { .. } => "correct the shape, or remove this <collision> if nothing can touch it",
            Self::Arm(_) => "correct the links and joints of the URDF",
        }
    }
}
