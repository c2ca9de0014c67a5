//! What happens is told by `tracing`, by this crate and by those below.

use mp_plan::{RelaxField, Request, Scene};
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

/// Does something, and looks for what it tells.
fn told(wanted: &[&str], run: impl FnOnce()) {
    let kept = Kept::default();
    tracing::subscriber::with_default(kept.clone(), run);
    let told = kept.0.lock().unwrap();
    for wanted in wanted {
        assert!(told.contains(*wanted), "{wanted} is not among {told:?}");
    }
}

#[test]
fn a_run_is_told_from_loading_to_verifying() {
    let folder = tempfile::tempdir().unwrap();
    let map = folder.path().join("map");
    let wanted = [
        "mp_plan load",
        "mp_formats: mesh",
        "mp_io: problem",
        "mp_robot build",
        "mp_collide build",
        "mp_plan plan",
        "mp_tree: made",
        "mp_cspace: solved",
        "mp_kinds shorten",
        "mp_cspace: simplified",
        "mp_plan verify",
        "mp_cspace: verified",
        "mp_plan roadmap",
        "mp_roadmap: built",
        "mp_store: written",
    ];
    told(&wanted, || {
        let scene = Scene::find("easy").unwrap();
        assert!(scene.plan(&Request::new("rrt-connect").seed(7)).unwrap().solved);
        let request = Request { roadmap: Some(map), ..Request::new("prm").nodes(20) };
        scene.roadmap(&request).unwrap();
    });
}

#[test]
fn arms_searches_and_snakes_are_told() {
    let plan = |scene: &str, request: Request| Scene::find(scene).unwrap().plan(&request).unwrap();
    told(&["mp_io: problem", "mp_robot urdf", "mp_robot build", "mp_robot: arm", "mp_tree: won"], || {
        plan("arm", Request::new("or-rrt-connect").seed(1));
    });
    told(&["mp_tree: made", "mp_tree: restarted"], || {
        plan("rrs-high", Request::new("restart-rrt").seed(1).set("unit", 2));
    });
    told(&["mp_tree: improved", "mp_cspace: stopped"], || {
        plan("rrs-high", Request::new("rrt-star").seed(1).iterations(2000));
    });
    told(&["mp_snake map", "mp_snake risk", "mp_snake: relaxed"], || {
        plan("rrs-follow", Request::new("rrt").seed(1).relax(RelaxField::Risk(1.0)));
    });
}
