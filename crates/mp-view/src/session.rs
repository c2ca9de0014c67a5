//! A session of the viewer: what its page asks for, done by the libraries. docs/formats/session.md describes the messages.

mod files;
mod mesh;
mod messages;
mod run;
#[cfg(all(test, not(target_family = "wasm")))]
mod tests;
#[cfg(not(target_family = "wasm"))]
mod threads;
mod times;
mod worker;
mod workspace;

pub use mesh::{is_mesh, scene_of_mesh};
#[cfg(not(target_family = "wasm"))]
pub use threads::Session;
pub use worker::Worker;
pub(crate) use workspace::Workspace;
pub use workspace::{Opening, Thumbnail};

pub(crate) use messages::{number_of, refusal, text_of};

use crate::message::Message;
use mp_plan::{Error, Request};
use serde_json::Value;

/// What a request about a run asks for.
pub(crate) enum RunRequest {
    /// To begin it: with this request, paused or not.
    Plan { request: Box<Request>, paused: bool },
    /// To give a path times.
    Time(times::Timing),
    /// To change what it does.
    Order(run::Order),
    /// To end it.
    Cancel,
}

impl RunRequest {
    /// The run that a request is about, and what it asks for; `None` when it is about no run.
    pub(crate) fn of(message: &Message) -> Result<Option<(u64, Self)>, Error> {
        let head = &message.head;
        let about = match text_of(head, "do")? {
            "plan" => {
                let value = head.get("request").cloned().unwrap_or_default();
                let request: Request = serde_json::from_value(value.clone()).map_err(|e| {
                    let of = wrong_member(&value).map_or_else(String::new, |name| format!("`{name}`: "));
                    Error::new(format!("this is no request to plan: {of}{e}"))
                })?;
                // A page writes files by `save` alone, into its folder.
                if request.roadmap.is_some() {
                    return Err(Error::new("a page keeps no roadmap in a file")
                        .help("leave `roadmap` out: `mp plan --roadmap` keeps one"));
                }
                let paused = head.get("paused").and_then(Value::as_bool).unwrap_or(false);
                Self::Plan { request: Box::new(request), paused }
            }
            "time" => Self::Time(times::Timing::of(head)?),
            "pause" => Self::Order(run::Order::Pause),
            "resume" => Self::Order(run::Order::Go),
            "step" => Self::Order(run::Order::Step(number_of(head, "iterations")?.max(1))),
            "cancel" => Self::Cancel,
            _ => return Ok(None),
        };
        Ok(Some((number_of(head, "run")?, about)))
    }
}

/// The member without which a value would be a request: serde does not name it.
fn wrong_member(value: &Value) -> Option<&String> {
    let members = value.as_object()?;
    members.keys().find(|name| {
        let others = members.iter().filter(|(other, _)| other != name);
        let others = others.map(|(name, value)| (name.clone(), value.clone())).collect();
        serde_json::from_value::<Request>(Value::Object(others)).is_ok()
    })
}

pub(crate) fn first_order(paused: bool) -> run::Order {
    if paused { run::Order::Pause } else { run::Order::Go }
}
