//! A fuzzer for one target, guided by coverage: `cargo xtask fuzz` builds it for each, with the target's name in
//! `MP_FUZZ_TARGET`, and starts it.
//!
//! It ends as libFuzzer does, with the input in a file, when the target panics, takes too long or takes memory out of
//! proportion to the input.

#![no_main]

mod certificate;
mod memory;
mod tree;

use memory::Bounded;

#[global_allocator]
static MEMORY: Bounded = Bounded;

/// A target of one of the crates, whose errors have different types.
enum Target {
    Io(mp_io::fuzz::Target),
    Plan(mp_plan::fuzz::Target),
    Batch(mp_batch::fuzz::Target),
    View(mp_view::fuzz::Target),
    Tree(tree::Target),
    Certificate(certificate::Target),
}

/// The target of this program. Known when it is compiled, so that it holds no code, and counts no coverage, of others.
const TARGET: Target = {
    const NAME: &str = env!("MP_FUZZ_TARGET");
    if let Some(target) = find(&mp_io::fuzz::TARGETS, NAME) {
        Target::Io(target)
    } else if let Some(target) = find(&mp_plan::fuzz::TARGETS, NAME) {
        Target::Plan(target)
    } else if let Some(target) = find(&mp_batch::fuzz::TARGETS, NAME) {
        Target::Batch(target)
    } else if let Some(target) = find(&mp_view::fuzz::TARGETS, NAME) {
        Target::View(target)
    } else if let Some(target) = find(&tree::TARGETS, NAME) {
        Target::Tree(target)
    } else if let Some(target) = find(&certificate::TARGETS, NAME) {
        Target::Certificate(target)
    } else {
        panic!("MP_FUZZ_TARGET names no target")
    }
};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    memory::begin();
    // Whether the bytes are refused does not matter, only that the target returns.
    match TARGET {
        Target::Io(target) => drop(target(bytes)),
        Target::Plan(target) => drop(target(bytes)),
        Target::Batch(target) => drop(target(bytes).inspect_err(mp_plan::fuzz::check_error)),
        Target::View(target) => drop(target(bytes)),
        Target::Tree(target) => drop(target(bytes)),
        Target::Certificate(target) => drop(target(bytes)),
    }
});

const fn find<T: Copy>(targets: &[(&str, T)], name: &str) -> Option<T> {
    let mut i = 0;
    while i < targets.len() {
        if same(targets[i].0.as_bytes(), name.as_bytes()) {
            return Some(targets[i].1);
        }
        i += 1;
    }
    None
}

const fn same(a: &[u8], b: &[u8]) -> bool {
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}
