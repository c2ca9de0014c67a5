//! Summaries and tables of runs, for people.

use mp_plan::{Report, StageTime, StoppedBy, at_least, brief, count, medians};

/// A summary of one run, a few lines.
pub(crate) fn summary(report: &Report) -> String {
    let mut lines = Vec::new();
    let by = format!("{}, seed {}", report.planner, report.seed);
    match report.stopped_by {
        None => lines.push(format!("{}: solved in {} by {by}", report.scene, seconds(report.time_s))),
        Some(reason) if report.is_not_begun() => {
            let (by, all) = (explained(reason), reason == StoppedBy::Time);
            let when = if all { ": loading took all of it" } else { " while the scene was loaded" };
            lines.push(format!("{}: not planned: {by}{when}", report.scene));
            lines.push(format!("  {:<11}{}", "stages", stages(report)));
            return lines.join("\n");
        }
        Some(reason) => lines.push(format!(
            "{}: not solved in {} by {by}: {}",
            report.scene,
            seconds(report.time_s),
            explained(reason)
        )),
    }
    let mut row = |name: &str, text: String| lines.push(format!("  {name:<11}{text}"));
    if let Some(runs) = &report.portfolio {
        let won = runs.winner.map(|run| format!("run {} won, ", grouped(run))).unwrap_or_default();
        let [begun, needed] = [grouped(runs.begun), grouped(runs.iterations)];
        row("portfolio", format!("{won}{begun} runs with {needed} iterations in all"));
    }
    if let Some(won) = report.won.as_ref().filter(|_| report.portfolio.is_none()) {
        row("found by", won.clone());
    }
    row("iterations", grouped(report.iterations));
    row("nodes", grouped(report.nodes as u64));
    if let (Some(edges), Some(components)) = (report.edges, report.components) {
        let parts = if components == 1 { "component" } else { "components" };
        row("roadmap", format!("{} edges, {components} {parts}", grouped(edges as u64)));
    }
    row(
        "checks",
        format!(
            "{} collision queries for {} motions ({})",
            grouped(report.collision_checks),
            grouped(report.motion_checks),
            report.motion
        ),
    );
    match report.rejected {
        0 => {}
        1 => row("rejected", "1 candidate path, by the verifier".into()),
        n => row("rejected", format!("{} candidate paths, by the verifier", grouped(n))),
    }
    if let (Some(time), Some(length)) = (report.first_s, report.first_length) {
        row("first path", format!("after {}, length {}", seconds(time), brief(length)));
    }
    if let (Some(found), Some(length)) = (report.path_length_found, report.path_length) {
        let how = if report.shortened { "shortened" } else { "not shortened" };
        let length =
            if report.shortened { format!("{} → {}", brief(found), brief(length)) } else { brief(length) };
        row("length", format!("{length}, {how} and verified in {}", seconds(report.finish_s)));
    }
    if let Some(clearance) = report.clearance {
        let text = match clearance.is_finite() {
            true if report.clearance_kept > 0.0 => {
                format!(
                    "at least {} m, {} m from obstacles asked for",
                    at_least(clearance),
                    brief(report.clearance_kept)
                )
            }
            true => format!("at least {} m", at_least(clearance)),
            false => "there is nothing to hit".to_owned(),
        };
        row("clearance", text);
    }
    if let Some(cost) = report.cost {
        row("cost", brief(cost));
    }
    if report.stages.iter().any(|stage| stage.ended_by.is_some()) {
        row("stages", stages(report));
    }
    if let (Some(file), Some(path)) = (&report.path_file, &report.path) {
        row("path", format!("{file}, {}", count(path.len(), "configuration")));
    }
    if let Some(file) = &report.picture_file {
        row("picture", file.clone());
    }
    if let Some(file) = &report.certificate_file {
        row("proof", file.clone());
    }
    lines.join("\n")
}

/// What was done when, and what ended it.
fn stages(report: &Report) -> String {
    let stage = |stage: &StageTime| {
        let ended = stage.ended_by.map(|by| format!(" until {}", until(by))).unwrap_or_default();
        format!("{} {}{ended}", stage.stage, seconds(stage.time_s))
    };
    report.stages.iter().map(stage).collect::<Vec<_>>().join(", ")
}

/// What ended a stage, after the word "until".
fn until(by: StoppedBy) -> &'static str {
    match by {
        StoppedBy::Time => "the time was up",
        StoppedBy::Memory => "the memory was used up",
        StoppedBy::Interrupted => "it was interrupted",
        StoppedBy::Exhausted => "all was tried",
        _ => "the budget was used up",
    }
}

/// The caption of the picture.
pub(crate) fn caption(report: &Report) -> String {
    let length = report.path_length.map(|l| format!(", length {}", brief(l))).unwrap_or_default();
    format!("{}, seed {}: {} nodes{length}", report.planner, report.seed, grouped(report.nodes as u64))
}

/// Why a run stopped, with the option that sets the limit.
fn explained(reason: StoppedBy) -> String {
    let option = match reason {
        StoppedBy::Time | StoppedBy::Unverified => " (--time)",
        StoppedBy::Iterations => " (--iterations)",
        StoppedBy::Memory => " (--memory)",
        StoppedBy::Schedule => " (--portfolio, --unit)",
        _ => "",
    };
    format!("{reason}{option}")
}

/// A time: `12.3 ms`, `0.50 s`, `60.0 s`.
fn seconds(s: f64) -> String {
    match s {
        s if s < 0.1 => format!("{:.1} ms", 1e3 * s),
        s if s < 10.0 => format!("{s:.2} s"),
        s => format!("{s:.1} s"),
    }
}

/// A number with its digits in groups of three: `12 345`.
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, d) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) && digits.len() > 4 {
            out.push(' ');
        }
        out.push(d);
    }
    out
}

/// All runs as a table, with a line of medians for each scene.
pub(crate) fn table(reports: &[Report]) -> String {
    const HEAD: [&str; 9] =
        ["scene", "seed", "", "time", "iterations", "nodes", "checks", "length", "clearance"];
    let cell = |v: Option<f64>| v.map_or_else(|| "–".to_owned(), brief);
    let bound = |v: Option<f64>| v.map_or_else(|| "–".to_owned(), at_least);
    let count = |v: Option<f64>| v.map_or_else(|| "–".to_owned(), |v| grouped(v.round() as u64));
    let mut rows = vec![HEAD.map(str::to_owned)];
    for m in medians(reports) {
        for r in reports.iter().filter(|r| (&r.scene, &r.scene_file) == (&m.scene, &m.scene_file)) {
            rows.push([
                r.scene.clone(),
                r.seed.to_string(),
                r.stopped_by.map_or("solved", StoppedBy::word).to_owned(),
                seconds(r.time_s),
                grouped(r.iterations),
                grouped(r.nodes as u64),
                grouped(r.collision_checks),
                cell(r.path_length),
                bound(r.clearance),
            ]);
        }
        rows.push([
            m.scene,
            "median".into(),
            format!("{}/{}", m.solved, m.runs),
            m.time_s.map_or_else(|| "–".into(), seconds),
            count(m.iterations),
            count(m.nodes),
            count(m.collision_checks),
            cell(m.path_length),
            bound(m.clearance),
        ]);
    }
    let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0);
    let widths: [usize; 9] = std::array::from_fn(width);
    let line = |row: &[String; 9]| {
        let cells = row.iter().zip(widths).enumerate().map(|(k, (cell, w))| {
            if k == 0 || k == 2 { format!("{cell:<w$}") } else { format!("{cell:>w$}") }
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(scene: &str, seed: u64, time: Option<f64>) -> Report {
        Report {
            scene: scene.into(),
            scene_file: Some(format!("{scene}.env")),
            space: "SE3".into(),
            solved: time.is_some(),
            verified: time.is_some(),
            stopped_by: if time.is_some() { None } else { Some(StoppedBy::Time) },
            why: None,
            version: 1,
            first_path: None,
            fingerprint: None,
            columns: Vec::new(),
            planner: "rrt-connect".into(),
            metric: "default".into(),
            motion: "certified".into(),
            seed,
            iterations: 1234,
            nodes: 98765,
            edges: None,
            components: None,
            portfolio: None,
            won: None,
            motion_checks: 5000,
            collision_checks: 1_000_000,
            rejected: 0,
            time_s: time.unwrap_or(60.0),
            finish_s: 0.5,
            stages: Vec::new(),
            first_s: None,
            first_length: None,
            path_length_found: time.map(|_| 20.0),
            path_length: time.map(|_| 12.5),
            clearance: time.map(|_| 0.01),
            clearance_kept: 0.0,
            cost: None,
            shortened: true,
            path_file: None,
            picture_file: None,
            certificate_file: None,
            roadmap_error: None,
            path: time.map(|_| vec![vec![0.0; 6]]),
        }
    }

    #[test]
    fn tables_and_summaries_read_well() {
        let runs = [report("easy", 1, Some(0.0123)), report("easy", 2, None)];
        let table = [
            "scene    seed             time  iterations   nodes     checks  length  clearance",
            "easy        1  solved  12.3 ms        1234  98 765  1 000 000    12.5       0.01",
            "easy        2  time     60.0 s        1234  98 765  1 000 000       –          –",
            "easy   median  1/2     12.3 ms        1234  98 765  1 000 000    12.5       0.01",
        ];
        assert_eq!(super::table(&runs).lines().collect::<Vec<_>>(), table);
        let solved = [
            "easy: solved in 12.3 ms by rrt-connect, seed 1",
            "  iterations 1234",
            "  nodes      98 765",
            "  checks     1 000 000 collision queries for 5000 motions (certified)",
            "  length     20 → 12.5, shortened and verified in 0.50 s",
            "  clearance  at least 0.01 m",
        ];
        assert_eq!(summary(&runs[0]).lines().collect::<Vec<_>>(), solved);
        let not = summary(&runs[1]);
        assert!(
            not.starts_with("easy: not solved in 60.0 s by rrt-connect, seed 2: the time is up"),
            "{not}"
        );
    }

    #[test]
    fn scenes_of_one_name_are_apart() {
        let other = Report { scene_file: Some("other/easy.env".into()), ..report("easy", 1, Some(0.3)) };
        let table = super::table(&[report("easy", 1, Some(0.1)), other]);
        let times = ["0.10 s", "0.10 s", "0.30 s", "0.30 s"];
        assert!(table.lines().skip(1).zip(times).all(|(line, time)| line.contains(time)), "{table}");
    }

    #[test]
    fn clearances_in_tables_are_not_rounded_up() {
        let run = Report { clearance: Some(0.0096), ..report("easy", 1, Some(0.1)) };
        assert_eq!(super::table(&[run]).matches("0.009\n").count(), 1);
    }

    #[test]
    fn long_numbers_are_grouped() {
        for (n, text) in [(0, "0"), (999, "999"), (1234, "1234"), (12345, "12 345"), (1_000_000, "1 000 000")]
        {
            assert_eq!(grouped(n), text);
        }
    }
}
