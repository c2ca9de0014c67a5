//! Errors in inputs and flows.

use mp_cspace::{ParameterError, SpaceError};
use thiserror::Error;

/// Why an input set, a system or an input planner could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum InputError {
    /// There is no input, or an input has no entries.
    #[error("{what} must not be empty")]
    Empty {
        /// What is empty.
        what: &'static str,
    },
    /// An entry of an input is NaN or infinite.
    #[error("input {index} must be finite, found {input}")]
    NotFinite {
        /// The index of the input, counted from 0.
        index: usize,
        /// The input, as `Debug` prints it.
        input: String,
    },
    /// A number is out of its range, such as a duration of zero.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Limits do not fit the space, for instance in number.
    #[error(transparent)]
    Space(#[from] SpaceError),
    /// The space has no [velocities](mp_cspace::Space::moved), or inputs do not have one entry for each of
    /// its degrees of freedom.
    #[error("an input of {entries} entries moves no state of the space, which has {dim} degrees of freedom")]
    NoMotion {
        /// How many numbers the input has.
        entries: usize,
        /// Degrees of freedom of the space.
        dim: usize,
    },
    /// The flow leads to a state that is not finite.
    #[error("the flow leads to a state that is not finite: input {index} from {from}")]
    FlowNotFinite {
        /// The index of the input, counted from 0.
        index: usize,
        /// The state it is applied to, as `Debug` prints it.
        from: String,
    },
    /// From every state tried, each input leads back to that state or out of the space.
    #[error(
        "no input leads from any of {states} sampled states to another state of the space: \
         the duration may be too long, or the inputs too large"
    )]
    LeavesSpace {
        /// How many states were tried.
        states: usize,
    },
}

impl From<InputError> for mp_cspace::BuildError {
    fn from(error: InputError) -> Self {
        Self::Inputs { reason: error.to_string() }
    }
}
