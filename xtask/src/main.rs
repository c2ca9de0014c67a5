//! The runner: plan, check, info, render, bench, assets and ci on the command line.
//!
//! Exit code: 0 solved or true, 1 not solved within the budget or false, 2 bad input.

mod arm;
mod assets;
mod bench;
mod check;
mod ci;
mod cli;
mod flat;
mod info;
mod names;
mod output;
mod plan;
mod render;
mod scenes;

use clap::Parser;
use cli::{Cli, Command};
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    tracing_subscriber::fmt()
        .with_env_filter(tracing_subscriber::EnvFilter::from_default_env())
        .with_writer(std::io::stderr)
        .init();
    let outcome = match &cli.command {
        Command::Assets(args) => assets::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Ci(args) => ci::run(args),
        Command::Plan(args) => plan::run(args),
        Command::Check(args) => check::run(args),
        Command::Info(args) => info::run(args),
        Command::Render(args) => render::run(args),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(report) => {
            output::note(&format!("{report:?}"));
            ExitCode::from(2)
        }
    }
}
