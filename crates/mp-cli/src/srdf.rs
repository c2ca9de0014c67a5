//! `srdf`: which links of a robot may touch, as a file.

use crate::input::is_standard;
use crate::output::{Claims, note, print, write};
use crate::{cli, interrupt};
use mp_plan::{Error, Interrupt, RobotPairs, TouchReason, count};

/// Makes the SRDF. False when it was interrupted; bad files are errors.
pub(crate) fn run(args: &cli::Srdf) -> Result<bool, Error> {
    if let Some(out) = args.out.as_ref().filter(|out| out.exists() && !is_standard(out) && !args.replace) {
        return Err(Error::new(format!("{} is there already", out.display()))
            .help("name another file by --out, or replace it by --replace"));
    }
    let interrupt = Interrupt::new(interrupt::flag());
    let made = match RobotPairs::sampled(&args.robot, &interrupt) {
        Err(_) if interrupt.raised().is_some() => {
            note("interrupted: nothing was written");
            return Ok(false);
        }
        made => made?,
    };
    if let Some(out) = args.out.as_ref().filter(|out| !is_standard(out)) {
        let mut claims = Claims::default();
        made.inputs.iter().for_each(|file| claims.input(file));
        claims.output("--out", out)?;
    }
    let text = made.srdf(!args.check_never);
    match &args.out {
        Some(out) => write(out, text.as_bytes())?,
        None => print(text.trim_end())?,
    }
    let of = |reason| made.pairs.count(reason);
    let compared = made.pairs.pairs.iter().filter(|pair| pair.reason.is_none());
    note(&format!(
        "{} configurations looked at. Links that may touch: {} adjacent, {} at the neutral configuration, {} always, {} never seen to{}",
        made.pairs.samples,
        of(TouchReason::Adjacent),
        of(TouchReason::Default),
        of(TouchReason::Always),
        of(TouchReason::Never),
        if args.check_never { ", which go on being compared" } else { "" },
    ));
    for pair in compared.clone().take(SHOWN) {
        let [a, b] = &pair.links;
        note(&format!("compared: {a} and {b}, which touch in {:.1}% of them", 100.0 * pair.share));
    }
    match compared.count().saturating_sub(SHOWN) {
        0 => {}
        more => note(&format!("compared: {}", count(more, "more pair"))),
    }
    Ok(true)
}

/// How many pairs are named.
const SHOWN: usize = 8;
