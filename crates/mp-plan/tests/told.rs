//! What happens is told by `tracing`, by this crate and by those below.

use mp_plan::{Request, Scene};
use std::collections::BTreeSet;
use std::fmt::{Debug, Write};
use std::sync::{Arc, Mutex};
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

/// Keeps the names of spans, and the messages of events with their targets.
#[derive(Clone, Default)]
struct Kept(Arc<Mutex<BTreeSet<String>>>);

struct Message(String);

impl Visit for Message {
    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        if field.name() == "message" {
            let _ = write!(self.0, "{value:?}");
        }
    }
}

impl Subscriber for Kept {
    fn enabled(&self, _: &Metadata<'_>) -> bool {
        true
    }
    fn new_span(&self, span: &Attributes<'_>) -> Id {
        let metadata = span.metadata();
        let of = metadata.target().split("::").next().unwrap_or_default();
        self.0.lock().unwrap().insert(format!("{of} {}", metadata.name()));
        Id::from_u64(1)
    }
    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn event(&self, event: &Event<'_>) {
        let mut message = Message(String::new());
        event.record(&mut message);
        let of = event.metadata().target().split("::").next().unwrap_or_default();
        self.0.lock().unwrap().insert(format!("{of}: {}", message.0));
    }
    fn enter(&self, _: &Id) {}
    fn exit(&self, _: &Id) {}
}

#[test]
fn a_run_is_told_from_loading_to_verifying() {
    let kept = Kept::default();
    let folder = tempfile::tempdir().unwrap();
    let map = folder.path().join("map");
    tracing::subscriber::with_default(kept.clone(), || {
        let scene = Scene::find("easy").unwrap();
        assert!(scene.plan(&Request::new("rrt-connect").seed(7)).unwrap().solved);
        let request = Request { roadmap: Some(map), ..Request::new("prm").nodes(20) };
        scene.roadmap(&request).unwrap();
    });
    let told = kept.0.lock().unwrap();
    for wanted in [
        "mp_plan load",
        "mp_collide build",
        "mp_plan plan",
        "mp_cspace: solved",
        "mp_plan shorten",
        "mp_cspace: simplified",
        "mp_plan verify",
        "mp_cspace: verified",
        "mp_plan roadmap",
        "mp_roadmap: built",
        "mp_store: written",
    ] {
        assert!(told.contains(wanted), "{wanted} is not among {told:?}");
    }
}
