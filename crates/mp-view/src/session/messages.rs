//! Replies that are errors, and members of requests.

use crate::message::Message;
use mp_plan::Error;
use serde_json::{Map, Value, json};

/// What is wrong, and what to do.
pub(crate) fn failure(error: &Error) -> (String, Option<String>) {
    (error.to_string(), error.remedy().map(str::to_owned))
}

/// A reply that is an error.
pub(crate) fn refusal(error: &Error) -> Message {
    let (message, help) = failure(error);
    Message::default().with("error", json!({"message": message, "help": help}))
}

/// A text in a request.
pub(crate) fn text_of<'m>(head: &'m Map<String, Value>, name: &str) -> Result<&'m str, Error> {
    head.get(name)
        .and_then(Value::as_str)
        .ok_or_else(|| Error::new(format!("the request has no text `{name}`")))
}

/// A whole number in a request.
pub(crate) fn number_of(head: &Map<String, Value>, name: &str) -> Result<u64, Error> {
    head.get(name)
        .and_then(Value::as_u64)
        .ok_or_else(|| Error::new(format!("the request has no whole number `{name}`")))
}
