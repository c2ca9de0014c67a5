//! More paths than one, to be merged into a shorter one.

use crate::run::plan::left;
use crate::run::search::{Search, search_within};
use crate::{Budget, Control, Error, Request, Robot};
use mp_cspace::Outcome;

/// The part of the time left that more searches may take in all.
const PART: f64 = 0.5;
/// A search is given up after this many times the iterations of the first, or this many where that took few: some seeds take for ever.
const TIMES: u64 = 20;
const AT_LEAST: u64 = 100_000;

/// Searches again with the next seeds where a path was found and [more are asked for](Request::hybridize). Their counts and times are added to
/// those of the first.
pub(crate) fn find_more_paths(
    kind: &dyn Robot,
    request: &Request,
    control: &Control<'_>,
    found: &mut Search,
) -> Result<(), Error> {
    let more = request.hybridize.saturating_sub(1) as u64;
    if !matches!(found.outcome, Outcome::Solved(_)) {
        return Ok(());
    }
    let iterations = (TIMES.saturating_mul(found.progress.iterations)).max(AT_LEAST);
    let iterations = request.budget.iterations.map_or(iterations, |given| given.min(iterations));
    let time_s = left(request, control, found).map(|left| PART * left.as_secs_f64() / more as f64);
    for next in 1..=more {
        if control.cancel.is_raised() || time_s.is_some_and(|time| time <= 0.0) {
            break;
        }
        let again = Request {
            budget: Budget { time_s, iterations: Some(iterations), ..request.budget },
            seed: request.seed.wrapping_add(next),
            first_only: true,
            roadmap: None,
            ..request.clone()
        };
        let mut control =
            Control { cancel: control.cancel.clone(), clock: control.clock, ..Control::default() };
        let other = search_within(kind, &again, &mut control, 1.0, true)?;
        found.time += other.time;
        found.queries += other.queries;
        found.progress.iterations += other.progress.iterations;
        found.progress.nodes += other.progress.nodes;
        found.progress.motions += other.progress.motions;
        found.progress.rejected += other.progress.rejected;
        if let Outcome::Solved(path) = other.outcome {
            found.others.push((path, again.seed));
        }
    }
    Ok(())
}
