//! The program `mp`: plan, many, merge, check, time, info, render, view on the command line.
//!
//! Exit code: 0 solved or true, 1 not solved within the budget or false, 2 bad input, 141 when the reader of standard output has
//! gone.

mod browser;
mod check;
mod cli;
mod examples;
mod files;
mod ik;
mod info;
mod input;
mod interrupt;
mod log;
mod many;
mod memory;
mod output;
mod page_planner;
mod picture;
mod plan;
mod programs;
mod progress;
mod render;
mod request;
mod robots;
mod srdf;
mod text;
mod time;
mod view;

use clap::{CommandFactory, Parser};
use cli::{Cli, Command};
use mp_plan::Error;
use std::io::IsTerminal as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    log::init();
    let outcome = match &cli.command {
        Command::Plan(args) => plan::run(args),
        Command::Many(args) => many::run(args),
        Command::Merge(args) => many::merge(args),
        Command::Check(args) => check::run(args),
        Command::Time(args) => time::run(args),
        Command::Info(args) => info::run(args),
        Command::Srdf(args) => srdf::run(args),
        Command::Ik(args) => ik::run(args),
        Command::Render(args) => render::run(args),
        Command::View(args) => view::run(args),
        Command::Scenes => scenes(),
        Command::Robots(args) => robots::run(args),
        Command::Bench(args) => programs::turn_into(programs::BENCH, args),
        Command::VerifyCertificate(args) => programs::verify_certificate(args),
        Command::Completions { shell } => completions(*shell),
        Command::Man => man(),
    };
    match outcome {
        Ok(_) if output::is_closed() => ExitCode::from(output::CLOSED_CODE),
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            output::note(&error.report());
            ExitCode::from(2)
        }
    }
}

/// Prints the shipped scenes: for a person in groups, with a sentence about each; for programs their names.
fn scenes() -> Result<bool, Error> {
    if !std::io::stdout().is_terminal() {
        output::print(&mp_plan::Scene::shipped().join("\n"))?;
        return Ok(true);
    }
    let group = |(title, scenes): (&str, Vec<(&str, &str)>)| {
        let scenes: String = scenes.iter().map(|(name, about)| format!("\n  {name:<16} {about}")).collect();
        format!("{title}{scenes}")
    };
    output::print(&mp_plan::Scene::gallery().into_iter().map(group).collect::<Vec<_>>().join("\n\n"))?;
    Ok(true)
}

fn completions(shell: clap_complete::Shell) -> Result<bool, Error> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "mp", &mut text);
    output::print(String::from_utf8_lossy(&text).trim_end())?;
    Ok(true)
}

fn man() -> Result<bool, Error> {
    let mut text = Vec::new();
    let page = |command: clap::Command, out: &mut Vec<u8>| clap_mangen::Man::new(command).render(out);
    let mut command = Cli::command();
    command.build();
    let mut pages = vec![command.clone()];
    pages.extend(command.get_subcommands().filter(|c| c.get_name() != "help").cloned());
    for one in pages {
        page(one, &mut text).map_err(|e| Error::new(format!("cannot make the manual page: {e}")))?;
    }
    // What follows the options of a command has no heading of its own there.
    let text = String::from_utf8_lossy(&text).replace(".SH EXTRA\nExamples:\n", ".SH EXAMPLES\n.nf\n");
    output::print(text.trim_end())?;
    Ok(true)
}
