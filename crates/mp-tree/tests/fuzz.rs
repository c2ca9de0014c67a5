//! The corpus of the fuzzer for saved trees, and damaged copies of it: docs/fuzzing.md.

#[path = "../../../fuzz/damage.rs"]
mod damage;
#[path = "../../../fuzz/src/tree.rs"]
mod tree;

#[test]
fn damaged_trees_are_read_or_refused() {
    for (name, target) in tree::TARGETS {
        damage::all_are_read_or_refused(name, 4000, |bytes| target(bytes).is_ok());
    }
}
