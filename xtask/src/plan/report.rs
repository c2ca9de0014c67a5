//! What is said about a run: a summary for a person, an object for a program.

use crate::info::brief;
use serde::Serialize;

/// The outcome of one run.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) scene: String,
    pub(crate) scene_file: String,
    pub(crate) space: String,
    pub(crate) solved: bool,
    /// The path passed the independent verifier.
    pub(crate) verified: bool,
    /// What ended an unsolved run: `time`, `iterations`, `interrupted` or `verification`.
    pub(crate) stopped_by: Option<&'static str>,
    pub(crate) planner: String,
    pub(crate) metric: String,
    pub(crate) motion: String,
    pub(crate) seed: u64,
    pub(crate) iterations: u64,
    pub(crate) nodes: usize,
    /// Of a roadmap.
    pub(crate) edges: Option<usize>,
    pub(crate) components: Option<usize>,
    pub(crate) motion_checks: u64,
    pub(crate) collision_checks: u64,
    /// Candidate paths that the verifier did not pass.
    pub(crate) rejected: u64,
    /// Planning alone, seconds.
    pub(crate) time_s: f64,
    /// Shortening and verifying, seconds.
    pub(crate) finish_s: f64,
    /// Of a planner that goes on for better paths: when it found the first, seconds.
    pub(crate) first_s: Option<f64>,
    /// And how long that was, in the metric.
    pub(crate) first_length: Option<f64>,
    /// In the metric, as the planner found it.
    pub(crate) path_length_found: Option<f64>,
    /// In the metric, as it is written.
    pub(crate) path_length: Option<f64>,
    /// A lower bound all along the path, metres.
    pub(crate) clearance: Option<f64>,
    pub(crate) shortened: bool,
    pub(crate) path_file: Option<String>,
    pub(crate) picture_file: Option<String>,
    pub(crate) path: Option<Vec<Vec<f64>>>,
}

/// What the runs on one scene came to. Medians are over the solved runs.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Medians {
    pub(crate) scene: String,
    pub(crate) runs: usize,
    pub(crate) solved: usize,
    pub(crate) time_s: Option<f64>,
    pub(crate) iterations: Option<f64>,
    pub(crate) nodes: Option<f64>,
    pub(crate) collision_checks: Option<f64>,
    pub(crate) path_length: Option<f64>,
    pub(crate) clearance: Option<f64>,
}

/// Several runs.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Runs<'a> {
    pub(crate) solved: usize,
    pub(crate) medians: Vec<Medians>,
    pub(crate) runs: &'a [Report],
}

impl Report {
    /// A few lines for a person.
    pub(crate) fn summary(&self) -> String {
        let mut lines = Vec::new();
        let by = format!("{}, seed {}", self.planner, self.seed);
        match self.stopped_by {
            None => lines.push(format!("{}: solved in {} by {by}", self.scene, seconds(self.time_s))),
            Some(reason) => lines.push(format!(
                "{}: not solved in {} by {by}: {}",
                self.scene,
                seconds(self.time_s),
                explained(reason)
            )),
        }
        let mut row = |name: &str, text: String| lines.push(format!("  {name:<11}{text}"));
        row("iterations", grouped(self.iterations));
        row("nodes", grouped(self.nodes as u64));
        if let (Some(edges), Some(components)) = (self.edges, self.components) {
            let parts = if components == 1 { "component" } else { "components" };
            row("roadmap", format!("{} edges, {components} {parts}", grouped(edges as u64)));
        }
        row(
            "checks",
            format!(
                "{} collision queries for {} motions ({})",
                grouped(self.collision_checks),
                grouped(self.motion_checks),
                self.motion
            ),
        );
        match self.rejected {
            0 => {}
            1 => row("rejected", "1 candidate path that the verifier did not pass".into()),
            n => row("rejected", format!("{} candidate paths that the verifier did not pass", grouped(n))),
        }
        if let (Some(time), Some(length)) = (self.first_s, self.first_length) {
            row("first path", format!("after {}, length {}", seconds(time), brief(length)));
        }
        if let (Some(found), Some(length)) = (self.path_length_found, self.path_length) {
            let how = if self.shortened { "shortened" } else { "not shortened" };
            let length = if self.shortened {
                format!("{} → {}", brief(found), brief(length))
            } else {
                brief(length)
            };
            row("length", format!("{length}, {how} and verified in {}", seconds(self.finish_s)));
        }
        if let Some(clearance) = self.clearance {
            row("clearance", format!("at least {} m", brief(clearance)));
        }
        if let (Some(file), Some(path)) = (&self.path_file, &self.path) {
            row("path", format!("{file}, {} configurations", path.len()));
        }
        if let Some(file) = &self.picture_file {
            row("picture", file.clone());
        }
        lines.join("\n")
    }

    /// One line for the picture.
    pub(crate) fn caption(&self) -> String {
        let length = self.path_length.map(|l| format!(", length {}", brief(l))).unwrap_or_default();
        format!("{}, seed {}: {} nodes{length}", self.planner, self.seed, grouped(self.nodes as u64))
    }
}

fn explained(reason: &str) -> &'static str {
    match reason {
        "time" => "the time is up (--time)",
        "iterations" => "the iterations are used up (--iterations)",
        "interrupted" => "interrupted",
        "verification" => "the path found touches something when written down: try another seed",
        _ => "the budget is used up",
    }
}

/// `0.0123 s`, `12.3 s`.
pub(crate) fn seconds(s: f64) -> String {
    match s {
        s if s < 0.1 => format!("{:.1} ms", 1e3 * s),
        s if s < 10.0 => format!("{s:.2} s"),
        s => format!("{s:.1} s"),
    }
}

/// `12 345`.
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

/// The middle value; the mean of the two middle ones when there is an even number. `None` of nothing.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let n = values.len();
    match (n, n % 2) {
        (0, _) => None,
        (_, 1) => Some(values[n / 2]),
        _ => Some(0.5 * (values[n / 2 - 1] + values[n / 2])),
    }
}

/// The medians of each scene, in order of appearance.
pub(crate) fn medians(reports: &[Report]) -> Vec<Medians> {
    let mut scenes: Vec<&str> = Vec::new();
    for r in reports {
        if !scenes.contains(&r.scene.as_str()) {
            scenes.push(&r.scene);
        }
    }
    let of = |scene: &str| {
        let runs = reports.iter().filter(|r| r.scene == scene).count();
        let solved: Vec<&Report> = reports.iter().filter(|r| r.scene == scene && r.solved).collect();
        let over = |f: fn(&Report) -> Option<f64>| median(solved.iter().filter_map(|r| f(r)));
        Medians {
            scene: scene.to_owned(),
            runs,
            solved: solved.len(),
            time_s: over(|r| Some(r.time_s)),
            iterations: over(|r| Some(r.iterations as f64)),
            nodes: over(|r| Some(r.nodes as f64)),
            collision_checks: over(|r| Some(r.collision_checks as f64)),
            path_length: over(|r| r.path_length),
            clearance: over(|r| r.clearance),
        }
    };
    scenes.into_iter().map(of).collect()
}

/// All runs as a table, with a line of medians for each scene.
pub(crate) fn table(reports: &[Report]) -> String {
    const HEAD: [&str; 9] =
        ["scene", "seed", "", "time", "iterations", "nodes", "checks", "length", "clearance"];
    let cell = |v: Option<f64>| v.map_or_else(|| "–".to_owned(), brief);
    let count = |v: Option<f64>| v.map_or_else(|| "–".to_owned(), |v| grouped(v.round() as u64));
    let mut rows = vec![HEAD.map(str::to_owned)];
    for m in medians(reports) {
        for r in reports.iter().filter(|r| r.scene == m.scene) {
            rows.push([
                r.scene.clone(),
                r.seed.to_string(),
                r.stopped_by.unwrap_or("solved").to_owned(),
                seconds(r.time_s),
                grouped(r.iterations),
                grouped(r.nodes as u64),
                grouped(r.collision_checks),
                cell(r.path_length),
                cell(r.clearance),
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
            cell(m.clearance),
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
            scene_file: format!("{scene}.env"),
            space: "SE3".into(),
            solved: time.is_some(),
            verified: time.is_some(),
            stopped_by: if time.is_some() { None } else { Some("time") },
            planner: "rrt-connect".into(),
            metric: "default".into(),
            motion: "certified".into(),
            seed,
            iterations: 1234,
            nodes: 98765,
            edges: None,
            components: None,
            motion_checks: 5000,
            collision_checks: 1_000_000,
            rejected: 0,
            time_s: time.unwrap_or(60.0),
            finish_s: 0.5,
            first_s: None,
            first_length: None,
            path_length_found: time.map(|_| 20.0),
            path_length: time.map(|_| 12.5),
            clearance: time.map(|_| 0.01),
            shortened: true,
            path_file: None,
            picture_file: None,
            path: time.map(|_| vec![vec![0.0; 6]]),
        }
    }

    #[test]
    fn medians_are_of_the_solved() {
        assert_eq!(median([3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median([]), None);
        let runs = [
            report("a", 1, Some(1.0)),
            report("a", 2, None),
            report("b", 1, None),
            report("a", 3, Some(3.0)),
        ];
        let m = medians(&runs);
        assert_eq!((m[0].runs, m[0].solved, m[0].time_s), (3, 2, Some(2.0)));
        assert_eq!((m[1].runs, m[1].solved, m[1].time_s), (1, 0, None));
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
        assert_eq!(runs[0].summary().lines().collect::<Vec<_>>(), solved);
        let not = runs[1].summary();
        assert!(
            not.starts_with("easy: not solved in 60.0 s by rrt-connect, seed 2: the time is up"),
            "{not}"
        );
    }

    #[test]
    fn long_numbers_are_grouped() {
        for (n, text) in [(0, "0"), (999, "999"), (1234, "1234"), (12345, "12 345"), (1_000_000, "1 000 000")]
        {
            assert_eq!(grouped(n), text);
        }
    }
}
