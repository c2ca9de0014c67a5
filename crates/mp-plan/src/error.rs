//! The error type of this crate: what is wrong, where, and what to do about it.

use std::fmt;

/// A message has at most so many characters: it may cite what somebody gave.
const MAX_MESSAGE: usize = 400;

/// An error about bad input: what is wrong, in which scene or file, and what to do.
///
/// [`Display`](fmt::Display) gives one line. [`report`](Self::report) gives a few lines for a person, with the line of the
/// file, if there is one.
#[derive(Debug)]
pub struct Error(Box<Inner>);

#[derive(Debug)]
struct Inner {
    context: Vec<String>,
    message: String,
    help: Option<String>,
    file: Option<mp_io::Error>,
}

impl Error {
    /// An error with this message: lower case, no full stop.
    pub fn new(message: impl Into<String>) -> Self {
        let message = mp_io::one_line(&message.into(), MAX_MESSAGE);
        Self(Box::new(Inner { context: Vec::new(), message, help: None, file: None }))
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

impl From<mp_io::Error> for Error {
    fn from(file: mp_io::Error) -> Self {
        let message = file.message().to_owned();
        Self(Box::new(Inner { context: Vec::new(), message, help: None, file: Some(file) }))
    }
}

impl From<mp_store::Error> for Error {
    fn from(file: mp_store::Error) -> Self {
        mp_io::Error::from(file).into()
    }
}

#[cfg(feature = "ranks")]
impl From<mp_ranks::Error> for Error {
    fn from(error: mp_ranks::Error) -> Self {
        match error {
            mp_ranks::Error::Checkpoint { file, message, remedy } => {
                Self::new(format!("{file}: {message}")).help(remedy)
            }
            other => Self::new(other.to_string()),
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
    mp_cspace::BuildError,
    mp_cspace::ParameterError,
    mp_cspace::SpaceError,
    mp_robot::ArmError,
    mp_robot::RobotError,
    mp_snake::SnakeError
);
