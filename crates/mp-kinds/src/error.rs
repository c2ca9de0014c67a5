//! The error type of this crate: what is wrong, where, and what to do about it.

use crate::End;
use mp_cspace::{BuildError, Endpoint};
use std::fmt;

/// The most characters of a message: it may cite what somebody gave.
const MAX_MESSAGE: usize = 400;

/// An error about bad input: what is wrong, in which scene or file, and what to do.
///
/// [`Display`](fmt::Display) gives one line. [`report`](Self::report) gives a few lines for a person, with the line of the
/// file, if there is one.
///
/// ```
/// use mp_kinds::{Error, ErrorKind};
/// let error = Error::new("there is no planner `rrt-conect`").help("take rrt-connect").of_kind(ErrorKind::Planner);
/// assert_eq!(error.context("cannot plan in cubicles").report(),
///     "error: cannot plan in cubicles\n  there is no planner `rrt-conect`\n  help: take rrt-connect");
/// ```
#[derive(Debug)]
pub struct Error(Box<Inner>);

/// What an error is about, for programs that decide by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// An end of the problem is in collision, too near to an obstacle, or out of bounds.
    NotFree(End),
    /// There is no planner of this name, or it cannot plan for the robot.
    Planner,
    /// A setting, a budget or another part of a request is not valid.
    Request,
    /// A file cannot be read or written, or its content is not valid: [`Error::file`] says where.
    File,
    /// There is no such file or scene.
    Missing,
    /// Anything else.
    Other,
}

impl ErrorKind {
    /// Its name: `start-not-free`, `goal-not-free`, `planner`, `request`, `file`, `missing`, `other`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NotFree(End::Start) => "start-not-free",
            Self::NotFree(End::Goal(_)) => "goal-not-free",
            Self::Planner => "planner",
            Self::Request => "request",
            Self::File => "file",
            Self::Missing => "missing",
            Self::Other => "other",
        }
    }
}

#[derive(Debug)]
struct Inner {
    kind: ErrorKind,
    context: Vec<String>,
    message: String,
    help: Option<String>,
    file: Option<mp_io::Error>,
}

impl Error {
    /// An error with this message: lower case, no full stop.
    pub fn new(message: impl Into<String>) -> Self {
        let message = mp_io::one_line(&message.into(), MAX_MESSAGE);
        Self(Box::new(Inner { kind: ErrorKind::Other, context: Vec::new(), message, help: None, file: None }))
    }

    /// Adds what to do about it.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.0.help = Some(help.into());
        self
    }

    /// Adds what failed because of it, such as "cannot plan in cubicles".
    #[must_use]
    pub fn context(mut self, what: impl Into<String>) -> Self {
        self.0.context.insert(0, what.into());
        self
    }

    /// Says what it is about.
    #[must_use]
    pub fn of_kind(mut self, kind: ErrorKind) -> Self {
        self.0.kind = kind;
        self
    }

    /// What it is about.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// What is wrong, without context, location and remedy.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> Option<&str> {
        self.0.help.as_deref().or_else(|| self.0.file.as_ref().and_then(mp_io::Error::remedy))
    }

    /// The error in a file, with line and column, if the error is in a file.
    #[must_use]
    pub fn file(&self) -> Option<&mp_io::Error> {
        self.0.file.as_ref()
    }

    /// A few lines for a person: the context, what is wrong, the line of the file, and what to do. They end without a
    /// line break.
    #[must_use]
    pub fn report(&self) -> String {
        let mut text = match (self.0.context.as_slice(), &self.0.file) {
            ([], Some(file)) => return format!("error: {}", file.report()),
            ([], None) => format!("error: {}", self.0.message),
            (context, file) => {
                let what = file.as_ref().map_or_else(|| self.0.message.clone(), mp_io::Error::report);
                format!("error: {}\n  {what}", context.join(": "))
            }
        };
        if let (Some(help), None) = (&self.0.help, &self.0.file) {
            text += &format!("\n  help: {help}");
        }
        text
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.context.iter().try_for_each(|what| write!(f, "{what}: "))?;
        match &self.0.file {
            Some(file) => file.fmt(f),
            None => f.write_str(&self.0.message),
        }
    }
}

impl std::error::Error for Error {}

impl From<mp_time::TimeError> for Error {
    fn from(e: mp_time::TimeError) -> Self {
        Self::new(e.to_string())
    }
}

impl From<mp_io::Error> for Error {
    fn from(file: mp_io::Error) -> Self {
        let message = file.message().to_owned();
        let kind = ErrorKind::File;
        Self(Box::new(Inner { kind, context: Vec::new(), message, help: None, file: Some(file) }))
    }
}

impl From<mp_store::Error> for Error {
    fn from(file: mp_store::Error) -> Self {
        let missing = file.kind() == mp_store::ErrorKind::Missing;
        let error = Self::from(mp_io::Error::from(file));
        if missing { error.of_kind(ErrorKind::Missing) } else { error }
    }
}

impl From<BuildError> for Error {
    fn from(error: BuildError) -> Self {
        let kind = match &error {
            BuildError::Outside { endpoint, .. }
            | BuildError::NotFree { endpoint, .. }
            | BuildError::Refused { endpoint, .. } => ErrorKind::NotFree(match endpoint {
                Endpoint::Start => End::Start,
                Endpoint::Goal(i) => End::Goal(*i),
            }),
            BuildError::OutOfRange { .. }
            | BuildError::Malformed { .. }
            | BuildError::Parameter(_)
            | BuildError::UnknownParameter { .. } => ErrorKind::Request,
            _ => ErrorKind::Planner,
        };
        let made = Self::new(error.to_string()).of_kind(kind);
        match error {
            BuildError::Inputs { .. } => {
                made.help("change what moves the robot, in the table `[robot]` of its file: a shorter `duration`, or smaller speeds")
            }
            _ => made,
        }
    }
}

macro_rules! plain {
    ($($error:ty),*) => {
        $(impl From<$error> for Error {
            fn from(error: $error) -> Self {
                Self::new(error.to_string())
            }
        })*
    };
}
plain!(
    mp_cspace::LengthError,
    mp_cspace::ParameterError,
    mp_cspace::SpaceError,
    mp_robot::ArmError,
    mp_robot::RobotError,
    mp_snake::SnakeError
);

/// `TryFrom<String>` and `Into<String>` of a type that is read and written as text, for serde.
#[macro_export]
macro_rules! as_text {
    ($type:ty) => {
        impl TryFrom<String> for $type {
            type Error = $crate::Error;
            fn try_from(text: String) -> Result<Self, $crate::Error> {
                text.parse()
            }
        }
        impl From<$type> for String {
            fn from(value: $type) -> Self {
                value.to_string()
            }
        }
    };
}
