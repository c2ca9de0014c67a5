//! A fuzzer for one target, guided by coverage: `cargo xtask fuzz` builds it for each, with the target's name in
//! `MP_FUZZ_TARGET`, and starts it.
//!
//! It ends as libFuzzer does, with the input in a file, when the target panics, takes too long or takes memory out of
//! proportion to the input.

#![no_main]

mod memory;

use memory::Bounded;
use mp_io::fuzz::Target;

#[global_allocator]
static MEMORY: Bounded = Bounded;

/// The target of this program. Known when it is compiled, so that it holds no code, and counts no coverage, of others.
const TARGET: Target = match find(&mp_io::fuzz::TARGETS, env!("MP_FUZZ_TARGET")) {
    Some(target) => target,
    None => panic!("MP_FUZZ_TARGET names no target"),
};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    memory::begin();
    let _ = TARGET(bytes);
});

/// The target of this name.
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
