//! One run in a world in the plane: plan, finish, write.

use super::files::Files;
use super::options::Options;
use super::progress::Line;
use super::report::Report;
use super::run::begun;
use super::search::word;
use crate::flat::{self, AnyTask, FlatMover, Task};
use crate::output::write;
use miette::Result;
use mp::cspace::{Cancel, Outcome};
use std::time::Instant;

/// One run of `task`, which is that of `any`.
pub(super) fn one_in_the_plane<M: FlatMover>(
    (any, task): (&AnyTask, &Task<M>),
    source: &str,
    options: &Options,
    seed: u64,
    cancel: &Cancel,
    files: &Files,
    quiet: bool,
) -> Result<Report> {
    let name = any.name();
    let mut line = Line::new(name, options.time, !quiet);
    let search = flat::search(task, options, seed, cancel, &mut line)?;
    let mut report = begun(name, source, M::SPACE.to_owned(), options, seed, &search);
    let path = match search.outcome {
        Outcome::Stopped(reason) => {
            report.stopped_by = Some(word(reason));
            line.clear();
            return Ok(report);
        }
        Outcome::Solved(path) => path,
    };
    report.path_length_found = Some(path.length(&task.space));
    line.say("solved; shortening and verifying the path");
    let began = Instant::now();
    let finished = flat::finish(task, &path, options.shorten, seed, cancel)?;
    report.finish_s = began.elapsed().as_secs_f64();
    let Some(finished) = finished else {
        report.stopped_by = Some("verification");
        line.clear();
        return Ok(report);
    };
    (report.solved, report.verified, report.shortened) = (true, true, finished.shortened);
    report.path_length = Some(finished.length);
    report.clearance = Some(finished.clearance);
    let (out, picture) = files.of(name, seed);
    if let Some(file) = out {
        line.say("writing the path");
        let json = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
        let text = if json { finished.file.to_json() } else { finished.file.to_text() };
        write(&file, text.as_bytes())?;
        report.path_file = Some(file.display().to_string());
    }
    if let Some(file) = picture {
        line.say("drawing the picture");
        flat::draw(&file, any, Some(&finished.file), report.caption(), None)?;
        report.picture_file = Some(file.display().to_string());
    }
    report.path = Some(finished.file.configurations);
    line.clear();
    Ok(report)
}
