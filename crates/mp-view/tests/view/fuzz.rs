//! The corpora of the fuzzer for the viewer's files and requests, and damaged copies of them: docs/fuzzing.md.

#[path = "../../../../fuzz/damage.rs"]
mod damage;

use mp_view::fuzz::TARGETS;

#[test]
fn damaged_requests_are_answered_or_refused() {
    for (name, target) in TARGETS {
        damage::all_are_read_or_refused(name, 400, |bytes| target(bytes).is_ok());
    }
}
