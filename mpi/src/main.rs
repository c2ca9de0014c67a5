//! The program `mp-mpi`: lists of problems and experiments over the ranks of an MPI job. All ranks run it with the same options; the
//! first one hands out the work, and alone writes and prints.
//!
//! Each command is a file of its own. Exit code, on all ranks: 0 done, 1 interrupted or not complete, 2 bad input.

mod bench;
mod link;
mod many;
mod output;
mod portfolio;
mod request;
mod roadmap;
mod signals;

use clap::{Parser, Subcommand};
use link::MpiLink;
use mp_plan::Error;
use mp_ranks::Link;
use mp_stop::Cancel;
use std::process::ExitCode;
use std::rc::Rc;
use std::time::Duration;

/// Work of `mp` over the ranks of an MPI job: start it by mpirun or srun. The files written are the same for any number of ranks.
#[derive(Debug, Parser)]
#[command(name = "mp-mpi", version, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Plan the problems of a list, as `mp many` does.
    Many(many::Many),
    /// Run a suite of measurements, as `mp-bench` does.
    Bench(Box<mp_bench::Options>),
    /// Race many runs of one request, as `mp plan --portfolio` does.
    Portfolio(portfolio::Race),
    /// Build a roadmap by regions, as `mp plan --planner regional-prm` does.
    Roadmap(roadmap::Regions),
}

impl Command {
    /// Whether others know when the first rank ends early, and end. Otherwise they may wait for it.
    fn tells_others(&self) -> bool {
        !matches!(self, Self::Bench(_))
    }
}

fn main() -> ExitCode {
    let Some(link) = MpiLink::new() else {
        output::note("error: MPI cannot be begun, or has no threads\n  help: see README.md of mp-mpi");
        return ExitCode::from(2);
    };
    let link = Rc::new(link);
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(e) => {
            if link.is_master() {
                let _ = e.print();
            }
            return ExitCode::from(if e.use_stderr() { 2 } else { 0 });
        }
    };
    let cancel = Cancel::new();
    signals::listen(link.is_master().then_some(&cancel));
    match run(&cli.command, link.clone(), &cancel) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) if link.is_master() && !cli.command.tells_others() => link.abort(1),
        Ok(false) => ExitCode::from(1),
        Err(e) if link.is_master() => {
            output::note(&e.report());
            if cli.command.tells_others() && !link.is_broken() {
                return ExitCode::from(2);
            }
            link.abort(2)
        }
        Err(e) => {
            // If this is an error of all ranks, the first one tells it, and ends this one.
            std::thread::sleep(Duration::from_secs(5));
            output::note(&format!("rank {}: {}", link.rank(), e.report()));
            link.abort(2)
        }
    }
}

/// True when everything is done.
fn run(command: &Command, link: Rc<MpiLink>, cancel: &Cancel) -> Result<bool, Error> {
    match command {
        Command::Many(args) => many::run(args, &*link, cancel),
        Command::Bench(args) => bench::run(args, link, cancel),
        Command::Portfolio(args) => portfolio::run(args, &*link, cancel),
        Command::Roadmap(args) => roadmap::run(args, &*link, cancel),
    }
}
