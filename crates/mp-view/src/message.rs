//! Messages of a session: a JSON head and arrays, laid out as scene files are. docs/formats/session.md describes them.

use crate::ViewError;
use crate::arrays::{ArrayRef, Entry, append, extract};
use crate::bytes::{frame, unframe};
use serde_json::{Map, Value};

/// A message: members, and the arrays that they name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Message {
    pub(crate) head: Map<String, Value>,
    pub(crate) data: Vec<u8>,
}

impl Message {
    /// An event of this kind, or of this run.
    pub(crate) fn event(event: &str, run: u64) -> Self {
        Self::default().with("event", event).with("run", run)
    }

    /// Adds a member.
    pub(crate) fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.set(name, value);
        self
    }

    /// Sets a member.
    pub(crate) fn set(&mut self, name: &str, value: impl Into<Value>) {
        self.head.insert(name.to_owned(), value.into());
    }

    /// Adds an array, and returns what names it.
    pub(crate) fn array<T: Entry>(&mut self, entries: &[T]) -> Value {
        json(&append(&mut self.data, entries))
    }

    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        frame(serde_json::to_vec(&self.head).unwrap_or_default(), &self.data)
    }

    /// Reads a message.
    ///
    /// # Errors
    /// When the bytes are no message.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, ViewError> {
        let (head, data) = unframe(bytes)?;
        let head = serde_json::from_slice(head).map_err(|e| ViewError::Head { reason: e.to_string() })?;
        Ok(Self { head, data: data.to_vec() })
    }

    /// The bytes of an array that a value names. `what` is its name in errors.
    ///
    /// # Errors
    /// When it names no array of bytes, or one that is not within the message.
    pub(crate) fn bytes(&self, value: &Value, what: &str) -> Result<Vec<u8>, ViewError> {
        let array: ArrayRef = serde_json::from_value(value.clone())
            .map_err(|_| ViewError::Array { what: what.to_owned(), problem: "is missing" })?;
        self.entries(&array, what)
    }

    /// The entries of an array. `what` is its name in errors.
    ///
    /// # Errors
    /// When it has entries of another type, or is not within the message.
    pub(crate) fn entries<T: Entry>(&self, array: &ArrayRef, what: &str) -> Result<Vec<T>, ViewError> {
        extract(&self.data, array, what)
    }
}

pub(crate) fn json(value: &impl serde::Serialize) -> Value {
    // What is written here has only text as names of members.
    serde_json::to_value(value).unwrap_or_default()
}
