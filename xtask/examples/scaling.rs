//! Tree growth, measured: `cargo run --release -p xtask --example scaling -- [SPACE…] [SIZE…] [--repeats=N] [--cap=S] [--csv]`
#![allow(clippy::print_stdout, clippy::print_stderr)] // an example talks

#[path = "../src/bench/scaling.rs"]
mod scaling;

use scaling::{Options, csv, markdown, measure};

fn main() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let (mut spaces, mut sizes) = (Vec::new(), Vec::new());
    let (mut options, mut as_csv) = (Options::default(), false);
    for argument in std::env::args().skip(1) {
        match (argument.strip_prefix("--").map(|a| a.split_once('=').unwrap_or((a, ""))), argument.parse()) {
            (Some(("repeats", n)), _) => options.repeats = n.parse()?,
            (Some(("cap", s)), _) => options.cap = s.parse()?,
            (Some(("csv", _)), _) => as_csv = true,
            (Some(_), _) => return Err(format!("no option {argument}").into()),
            (None, Ok(size)) => sizes.push(size),
            (None, Err(_)) => spaces.push(argument),
        }
    }
    if !spaces.is_empty() {
        options.spaces = spaces;
    }
    if !sizes.is_empty() {
        options.sizes = sizes;
    }
    let rows = measure(&options, |row| eprintln!("{} {}: {:.0} nodes/s", row.space, row.nodes, row.rate()))?;
    print!("{}", if as_csv { csv(&rows) } else { markdown(&rows) });
    Ok(())
}
