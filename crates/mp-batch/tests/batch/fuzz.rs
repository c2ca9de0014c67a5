//! The corpora of the fuzzer for lists and results, and damaged copies of them: docs/fuzzing.md.

#[path = "../../../../fuzz/damage.rs"]
mod damage;

use mp_batch::fuzz::TARGETS;
use mp_plan::fuzz::check_error;

#[test]
fn damaged_files_are_read_or_refused() {
    for (name, target) in TARGETS {
        damage::all_are_read_or_refused(name, 400, |bytes| target(bytes).inspect_err(check_error).is_ok());
    }
}
