//! `cargo xtask golden`: test programs whose results must not depend on the machine, on other processors.

use crate::programs::{name_of, test_programs};
use crate::{bad, note, wasm};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output};
use std::time::Instant;

/// A way of running the test programs.
struct Way {
    name: &'static str,
    shows: &'static str,
    /// What must be installed: how to ask for it, and how to get it.
    needs: &'static [(&'static [&'static str], &'static str)],
    /// The target to compile for, other than that of this machine, and the packages with their tests.
    target: Option<&'static str>,
    tests: &'static [&'static [&'static str]],
    /// The variables of the compiler and of the programs.
    variables: &'static [(&'static str, &'static str)],
    /// What starts a program.
    runner: &'static [&'static str],
}

/// The test programs: bits of functions, results of planners, and a simulated experiment.
const PROGRAMS: [&str; 3] = ["bits", "fingerprints", "experiments"];

/// How they are built.
const TESTS: &[&[&str]] = &[&[
    "--package",
    "mp-math",
    "--package",
    "mp-plan",
    "--package",
    "mp-experiments",
    "--test",
    "bits",
    "--test",
    "fingerprints",
    "--test",
    "experiments",
]];

/// How `cargo test` has built them, with all others.
const BUILT: &[&[&str]] = &[&["--workspace"]];

/// A program for WASI, in node.
const IN_NODE: &str = "\
const { WASI } = require('node:wasi'), { readFileSync } = require('node:fs');
const [program, ...rest] = process.argv.slice(1);
const wasi = new WASI({ version: 'preview1', args: [program, ...rest], env: process.env });
WebAssembly.instantiate(readFileSync(program), wasi.getImportObject())
  .then(({ instance }) => process.exit(wasi.start(instance)));";

const WAYS: [Way; 5] = [
    Way {
        name: "native",
        shows: "this machine",
        needs: &[],
        target: None,
        tests: TESTS,
        variables: &[],
        runner: &[],
    },
    Way {
        name: "no-fma",
        shows: "a C library that uses neither FMA nor AVX2",
        needs: &[],
        target: None,
        tests: TESTS,
        variables: &[("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable,-AVX2,-FMA,-FMA4")],
        runner: &[],
    },
    Way {
        name: "nehalem",
        shows: "a processor of 2008, with SSE4.2 only; a short list",
        needs: &[(&["qemu-x86_64", "--version"], "the package qemu-user")],
        target: None,
        tests: TESTS,
        variables: &[("MP_FINGERPRINTS", "shortest")],
        runner: &["qemu-x86_64", "-cpu", "Nehalem"],
    },
    Way {
        name: "aarch64",
        shows: "another architecture; a short list",
        needs: &[
            (&["qemu-aarch64", "--version"], "the package qemu-user"),
            (&["aarch64-linux-gnu-gcc", "--version"], "the package gcc-aarch64-linux-gnu"),
        ],
        target: Some("aarch64-unknown-linux-gnu"),
        tests: TESTS,
        variables: &[
            ("MP_FINGERPRINTS", "shortest"),
            ("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", "aarch64-linux-gnu-gcc"),
            ("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUSTFLAGS", "-Ctarget-feature=+crt-static"),
        ],
        runner: &["qemu-aarch64"],
    },
    Way {
        name: "wasm32",
        shows: "WebAssembly; a short list without pictures",
        needs: &[(&["node", "--version"], "node")],
        target: Some("wasm32-wasip1"),
        tests: &[
            &[
                "--package",
                "mp-math",
                "--package",
                "mp-experiments",
                "--test",
                "bits",
                "--test",
                "experiments",
            ],
            &[
                "--package",
                "mp-plan",
                "--test",
                "fingerprints",
                "--no-default-features",
                "--features",
                "roadmaps,scenes",
            ],
        ],
        variables: &[("MP_FINGERPRINTS", "short"), ("NODE_NO_WARNINGS", "1")],
        runner: &["node", "--eval", IN_NODE, "--"],
    },
];

/// Tests whose results must not depend on the machine have names with this.
const GOLDEN: &str = "on_every_machine";

/// `cargo xtask golden [--required] [--built] [WAY…]`. What is missing is an error if all is `--required`.
/// The programs are those of an earlier `cargo test` if they are `--built`.
pub(crate) fn run(arguments: &[OsString]) -> ExitCode {
    let mut arguments: Vec<&str> = arguments.iter().filter_map(|a| a.to_str()).collect();
    let [required, built] = ["--required", "--built"].map(|option| arguments.contains(&option));
    arguments.retain(|a| !["--required", "--built"].contains(a));
    if let Some(unknown) = arguments.iter().find(|name| WAYS.iter().all(|way| way.name != **name)) {
        let names: Vec<&str> = WAYS.iter().map(|way| way.name).collect();
        return bad(&format!("there is no way {unknown} of running: take of {}", names.join(", ")));
    }
    let mut failed = Vec::new();
    for way in WAYS.iter().filter(|way| arguments.is_empty() || arguments.contains(&way.name)) {
        note(&format!("{}: {}", way.name, way.shows));
        match way.missing() {
            Some(missing) => {
                note(&format!("  skipped: it needs {missing}"));
                if required {
                    failed.push(way.name);
                }
            }
            None => {
                if let Err(message) = way.run(built) {
                    note(&format!("  FAILED: {message}"));
                    failed.push(way.name);
                }
            }
        }
    }
    if failed.is_empty() {
        return ExitCode::SUCCESS;
    }
    note(&format!("failed: {}", failed.join(", ")));
    ExitCode::FAILURE
}

impl Way {
    /// What is not installed, if anything.
    fn missing(&self) -> Option<String> {
        let starts = |command: &[&str]| Command::new(command[0]).args(&command[1..]).output().is_ok();
        if matches!(self.name, "no-fma" | "nehalem") && !cfg!(all(target_arch = "x86_64", target_env = "gnu"))
        {
            return Some("x86-64 with the C library of GNU".to_owned());
        }
        if let Some((_, package)) = self.needs.iter().find(|(command, _)| !starts(command)) {
            return Some((*package).to_owned());
        }
        let target = self.target?;
        wasm::install(target).err().map(|how| format!("Rust's target {target}: {how}"))
    }

    fn run(&self, built: bool) -> Result<(), String> {
        for tests in if built && self.target.is_none() { BUILT } else { self.tests } {
            // At the same time: an emulated program is slow, and some have one thread.
            let programs = self.build(tests)?;
            if self.target.is_none() && programs.len() != PROGRAMS.len() {
                return Err(format!("of the test programs {PROGRAMS:?} there are only {programs:?}"));
            }
            std::thread::scope(|scope| {
                let start = |program: &PathBuf| self.start(program);
                let running: Vec<_> = programs.iter().map(|p| scope.spawn(move || start(p))).collect();
                running.into_iter().try_for_each(|program| {
                    program.join().unwrap_or_else(|_| Err("a program could not be watched".to_owned()))
                })
            })?;
        }
        Ok(())
    }

    /// The test programs.
    fn build(&self, tests: &[&str]) -> Result<Vec<PathBuf>, String> {
        let target = self.target.iter().flat_map(|target| ["--target", target]);
        let arguments: Vec<&str> = tests.iter().copied().chain(target).collect();
        let compiling = self.variables.iter().filter(|(name, _)| name.starts_with("CARGO"));
        test_programs(&arguments, compiling.copied(), &PROGRAMS)
    }

    fn start(&self, program: &Path) -> Result<(), String> {
        let name = name_of(program);
        let mut words = self.runner.iter().map(OsString::from).chain([program.into()]);
        let mut command = Command::new(words.next().unwrap_or_default());
        command.args(words).args([GOLDEN, "--nocapture"]).envs(self.variables.iter().copied());
        let began = Instant::now();
        let Output { status, stdout, stderr } =
            command.output().map_err(|e| format!("cannot run {name}: {e}"))?;
        let text = String::from_utf8_lossy(&stdout);
        if !status.success() || text.contains("running 0 tests") {
            return Err(format!("{name}\n{text}{}", String::from_utf8_lossy(&stderr)));
        }
        let counted = text.lines().find(|line| line.contains(" cases are ")).unwrap_or("passed");
        note(&format!("  ok     {name}: {counted} ({:.1} s)", began.elapsed().as_secs_f64()));
        Ok(())
    }
}
