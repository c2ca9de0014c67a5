//! Trajectories as comma-separated values.

use super::{GUIDE, TrajectoryFile};
use mp_formats::columns::{Column, Fault, HELP, Matching, bracketed, factor, find, is_index};
use mp_formats::csv::csv_text;
use mp_formats::error::{Error, ErrorKind};
use mp_formats::text::{Text, Token};

/// What columns of times are called.
const TIMES: [&str; 6] = ["time", "t", "time_from_start", "timestamp", "stamp", "seconds"];

/// What stands before or behind the name of a joint where a column has its position, its velocity or its acceleration.
const KINDS: [&[&str]; 3] = [
    &["position", "pos", "q"],
    &["velocity", "vel", "v", "qd"],
    &["acceleration", "accel", "acc", "a", "qdd"],
];

/// What a column is.
enum Is {
    /// The time: what it is multiplied with and divided by to be in seconds.
    Time(f64, f64),
    /// A number of a joint: the index of its kind, and its name with its unit.
    Number(usize, String),
}

/// What the column with this name is; `None` if that is not known.
fn column(name: &str, wanted: &[Column]) -> Option<Result<Is, String>> {
    if find(name, wanted).is_some() {
        return Some(Ok(Is::Number(0, name.to_owned())));
    }
    let suffixed = name.trim().rsplit_once('_').filter(|(_, unit)| factor(Some(unit), "s").is_some());
    let is_time = |stem: &str| TIMES.contains(&stem.trim().to_lowercase().as_str());
    let readings = [Some((name, "")), bracketed(name), suffixed];
    if let Some((_, unit)) = readings.into_iter().flatten().find(|(stem, _)| is_time(stem)) {
        let wrong = || format!("`{}` cannot be converted to seconds", mp_formats::text::clipped(name));
        let converted = factor(Some(unit), "s").map(|(times, over)| Is::Time(times, over));
        return Some(converted.ok_or_else(wrong));
    }
    let (stem, unit) = bracketed(name).unwrap_or((name, ""));
    let (stem, lower) = (stem.trim(), stem.trim().to_lowercase());
    KINDS.iter().enumerate().find_map(|(kind, words)| {
        words.iter().find_map(|word| {
            let before = ["_", ".", " ", "/"].iter().find_map(|between| {
                lower.starts_with(&format!("{word}{between}")).then(|| stem.get(word.len() + 1..))?
            });
            let behind = ["_", ".", " ", "/"].iter().find_map(|between| {
                lower
                    .ends_with(&format!("{between}{word}"))
                    .then(|| stem.get(..stem.len() - word.len() - 1))?
            });
            let own = [before, behind].into_iter().flatten().find(|own| find(own, wanted).is_some())?;
            let own = if unit.is_empty() { own.to_owned() } else { format!("{own} [{unit}]") };
            Some(Ok(Is::Number(kind, own)))
        })
    })
}

/// As [`TrajectoryFile::parse`].
pub(super) fn parse(file: &str, bytes: &[u8], wanted: &[Column]) -> Result<Option<TrajectoryFile>, Error> {
    let text = Text::new(file, bytes, GUIDE)?;
    let mut lines = text.lines();
    let Some(head) = lines.next() else { return Ok(None) };
    let separator = head.separator();
    let cells: Vec<Token<'_>> = head.cells_between(separator).collect();
    let mut names: Vec<String> = cells.iter().map(|cell| cell.text.replace("\"\"", "\"")).collect();
    // Tools of Python write the names as a comment.
    if let Some(first) = names[0].strip_prefix('#') {
        names[0] = first.trim().to_owned();
    }
    let first = usize::from(is_index(&names, wanted));
    let known: Vec<_> = names.iter().map(|name| column(name, wanted)).collect();
    if !known[first..].iter().flatten().any(|is| matches!(is, Ok(Is::Time(..)) | Err(_))) {
        return Ok(None);
    }
    let listed = || wanted.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let mut time = None;
    let mut groups: [Vec<(usize, String)>; 3] = Default::default();
    for (i, is) in known.into_iter().enumerate().skip(first) {
        let error =
            |message: String, expected: String| text.error(cells[i], message).expected(expected).help(HELP);
        match is {
            Some(Ok(Is::Time(times, over))) => match time.replace((i, times, over)) {
                None => {}
                Some((other, ..)) => {
                    let message = format!("`{}` and `{}` are both times", names[other], names[i]);
                    return Err(error(message, "one column of times".to_owned()));
                }
            },
            Some(Ok(Is::Number(kind, own))) => groups[kind].push((i, own)),
            Some(Err(message)) => return Err(error(message, "s, ms, us, ns, min".to_owned())),
            None => {
                let shown = mp_formats::text::clipped(&names[i]);
                let message = format!("`{shown}` is no number of a configuration here, nor of its motion");
                return Err(error(message, format!("time, and {}", listed())));
            }
        }
    }
    let Some((time, times, over)) = time else { return Ok(None) };
    let mut matched = Vec::new();
    for (group, per) in groups.iter().zip(["", "/s", "/s²"]) {
        if group.is_empty() && !per.is_empty() {
            matched.push(None);
            continue;
        }
        let names: Vec<String> = group.iter().map(|(_, name)| name.clone()).collect();
        let wanted: Vec<_> =
            wanted.iter().map(|column| Column::new(&*column.name, format!("{}{per}", column.unit))).collect();
        let matching =
            Matching::new(&names, &wanted).map_err(|fault| faulty(&text, head, &cells, group, fault))?;
        matched.push(Some(matching));
    }
    let mut read = TrajectoryFile { joints: wanted.to_vec(), ..TrajectoryFile::default() };
    for line in lines {
        let row: Vec<Token<'_>> = line.cells_between(separator).collect();
        if row.len() != names.len() {
            let message = format!("point {} has {} cells", read.times.len() + 1, row.len());
            return Err(text.error(line, message).expected(format!("{}, as in the first line", names.len())));
        }
        let number = |i: usize| text.number(row[i], "a number");
        let value = number(time)?;
        let seconds = if times == over { value } else { value * times / over };
        if !seconds.is_finite() {
            return Err(text
                .error(row[time], "the time is too large")
                .expected("a finite number of seconds"));
        }
        read.times.push(seconds);
        let rows = [&mut read.positions, &mut read.velocities, &mut read.accelerations];
        for ((matching, group), rows) in matched.iter().zip(&groups).zip(rows) {
            let Some(matching) = matching else { continue };
            let numbers = group.iter().map(|(i, _)| number(*i)).collect::<Result<Vec<_>, _>>()?;
            let made = matching.configuration(&numbers);
            rows.push(made.map_err(|fault| faulty(&text, line, &row, group, fault))?);
        }
    }
    match read.times.is_empty() {
        true => {
            Err(text.error_at_end("one point: numbers separated by commas").with_kind(ErrorKind::Content))
        }
        false => Ok(Some(read)),
    }
}

/// The error about a column of a group, in the cell of a line.
fn faulty(
    text: &Text<'_>,
    line: Token<'_>,
    cells: &[Token<'_>],
    group: &[(usize, String)],
    fault: Fault,
) -> Error {
    let cell = fault.at.and_then(|at| group.get(at)).and_then(|(i, _)| cells.get(*i));
    text.error(*cell.unwrap_or(&line), fault.message).expected(fault.expected).help(HELP)
}

/// As [`TrajectoryFile::to_text`].
pub(super) fn text(trajectory: &TrajectoryFile) -> String {
    let TrajectoryFile { joints, times, positions, velocities, accelerations, .. } = trajectory;
    let mut names = vec!["time [s]".to_owned()];
    names.extend(joints.iter().map(ToString::to_string));
    let groups = [("velocity", "/s", velocities), ("acceleration", "/s²", accelerations)];
    for (what, per, rows) in groups {
        if !rows.is_empty() {
            names.extend(joints.iter().map(|j| format!("{}_{what} [{}{per}]", j.name, j.unit)));
        }
    }
    let row = |i: usize| {
        let rows = [positions.get(i), velocities.get(i), accelerations.get(i)];
        std::iter::once(times[i]).chain(rows.into_iter().flatten().flatten().copied()).collect()
    };
    csv_text(&names, &(0..times.len()).map(row).collect::<Vec<_>>())
}
