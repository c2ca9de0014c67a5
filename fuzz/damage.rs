//! The corpora of the fuzzer, and damaged copies of them, for the tests `fuzz` of the crates with targets: none may panic, hang or
//! be misread. Deterministic, and bounded by a count: `MP_FUZZ_ITERATIONS` for each target.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::fs;
use std::path::{Path, PathBuf};

/// Words that formats treat specially, or that are hard to treat.
const WORDS: [&str; 40] = [
    "0",
    "-1",
    "1",
    "3",
    "255",
    "256",
    "65536",
    "4294967295",
    "4294967296",
    "18446744073709551616",
    "1e308",
    "1e999",
    "-0",
    "NaN",
    "inf",
    "1,5",
    "0x10",
    ".",
    "-",
    "#",
    "\n",
    "\r\n",
    "\r",
    "\t",
    "\0",
    "\u{feff}",
    "\u{e9}",
    "\u{2028}",
    "OFF",
    "BINARY",
    "Robot",
    "Obstacle #1",
    "End",
    "Bounds",
    "solid",
    "endsolid",
    "v",
    "f",
    "\"",
    "</p>",
];

fn mutated(rng: &mut Pcg64, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut out = seeds[rng.random_range(0..seeds.len())].clone();
    for _ in 0..rng.random_range(1..6) {
        let len = out.len();
        let at = rng.random_range(0..=len);
        let end = (at + rng.random_range(0..12_usize)).min(len);
        match rng.random_range(0..8) {
            0 if at < len => out[at] = rng.random(),
            1 if at < len => out[at] ^= 1 << rng.random_range(0..8),
            2 => drop(out.drain(at..end)),
            3 => out.truncate(at),
            4 => {
                let copy = out[at..end].to_vec();
                let to = rng.random_range(0..=len);
                out.splice(to..to, copy);
            }
            5 => {
                // One word for another.
                let start = out[..at].iter().rposition(u8::is_ascii_whitespace).map_or(0, |i| i + 1);
                let stop = out[at..].iter().position(u8::is_ascii_whitespace).map_or(len, |i| at + i);
                out.splice(start..stop, WORDS[rng.random_range(0..WORDS.len())].bytes());
            }
            6 => {
                let word = WORDS[rng.random_range(0..WORDS.len())];
                out.splice(at..at, word.bytes());
            }
            _ => {
                let other = &seeds[rng.random_range(0..seeds.len())];
                let from = rng.random_range(0..=other.len());
                out.truncate(at);
                out.extend(&other[from..]);
            }
        }
        out.truncate(1 << 16);
    }
    out
}

/// The inputs of a target by name: valid examples (`good-…`), and what the fuzzer found.
fn corpus(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(target);
    let entries = fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    paths.iter().map(|path| (name(path), fs::read(path).unwrap())).collect()
}

/// Gives a target its corpus and damaged copies of it, `iterations` unless `MP_FUZZ_ITERATIONS` says otherwise. `read`
/// returns whether the input was valid.
pub(crate) fn all_are_read_or_refused(target: &str, iterations: u64, read: impl Fn(&[u8]) -> bool) {
    let iterations = match std::env::var("MP_FUZZ_ITERATIONS") {
        Ok(n) => n.parse().expect("MP_FUZZ_ITERATIONS is a count"),
        Err(_) => iterations,
    };
    let call = |input: &[u8]| {
        let called = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| read(input)));
        called.unwrap_or_else(|_| panic!("{target} panics on {}", input.escape_ascii()))
    };
    let corpus = corpus(target);
    let refused: Vec<&String> =
        corpus.iter().filter(|(_, input)| !call(input)).map(|(name, _)| name).collect();
    let refused: Vec<_> = refused.into_iter().filter(|name| name.starts_with("good-")).collect();
    assert!(refused.is_empty(), "{target}: valid examples are refused: {refused:?}");
    let good: Vec<Vec<u8>> =
        corpus.iter().filter(|(name, _)| name.starts_with("good-")).map(|(_, input)| input.clone()).collect();
    let all: Vec<Vec<u8>> = corpus.into_iter().map(|(_, input)| input).collect();
    assert!(!good.is_empty(), "{target} has valid examples");
    let mut rng =
        Pcg64::seed_from_u64(target.bytes().fold(0, |seed: u64, b| seed.wrapping_mul(31) + u64::from(b)));
    let valid = (0..iterations)
        .filter(|i| call(&mutated(&mut rng, if i % 2 == 0 { &good } else { &all })))
        .count() as u64;
    // Both outcomes must be met, or the test tests little.
    assert!(iterations < 1000 || (valid > 0 && valid < iterations), "{target}: {valid} were valid");
}
