//! `bench`: the suites of `mp-bench`.

use crate::output::note;
use mp_bench::{Options, run_on};
use mp_plan::Error;
use mp_ranks::Link;
use mp_stop::Cancel;
use std::rc::Rc;

/// Runs a suite. True when it was measured completely.
pub(crate) fn run(options: &Options, link: Rc<dyn Link>, cancel: &Cancel) -> Result<bool, Error> {
    let ran = run_on(options, link.clone(), cancel)?;
    if link.is_master() {
        note(&format!("{} (seconds of processor time, or counted)", ran.shares));
    }
    Ok(ran.complete)
}
