//! `mp-bench`: measurements on the command line.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    mp_bench::program(&mp_bench::Options::parse()).into()
}
