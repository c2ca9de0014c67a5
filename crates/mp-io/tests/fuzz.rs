//! The corpora of the fuzzer for every format, and damaged copies of them: docs/fuzzing.md.

#[path = "../../../fuzz/damage.rs"]
mod damage;

use mp_io::fuzz::{TARGETS, check_error};

#[test]
fn damaged_files_are_read_or_refused() {
    for (name, target) in TARGETS {
        damage::all_are_read_or_refused(name, 4000, |bytes| target(bytes).inspect_err(check_error).is_ok());
    }
}
