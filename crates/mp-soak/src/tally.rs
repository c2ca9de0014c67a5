//! What became of many problems: counts by kind of world and by planner.

use crate::trial::{Outcome, Trial, Wanted};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The version of the form in which tallies are written.
const VERSION: u32 = 2;

/// Counts of problems.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Problems that were drawn, whatever came of them.
    pub problems: u64,
    /// Those with a path.
    pub solved: u64,
    /// Those without a path within the budget.
    pub unsolved: u64,
    /// Those whose start or goal was refused.
    pub ends_refused: u64,
    /// Those in which nothing was planned.
    pub refused: u64,
    /// Requests that were refused before one suited the robot.
    pub requests_refused: u64,
    /// Edges that the oracle has shown free.
    pub edges: u64,
    /// Comparisons of two bodies by the oracle.
    pub tests: u64,
    /// Paths that took the oracle too long.
    pub unfinished: u64,
    /// Problems that the clock ended.
    pub out_of_time: u64,
    /// Damaged paths that the oracle refused, and that the verifier was asked to refuse too.
    pub damaged: u64,
    /// Paths whose certificate was made and replayed.
    pub certified: u64,
    /// What was found wrong with the program, or with the oracle.
    pub findings: u64,
    /// The least distance of two bodies that the oracle saw on a path, as a part of the size of the world.
    pub least: Option<f64>,
    /// Seconds that all of it took, the oracle included. The only number here that another run would not
    /// repeat.
    pub seconds: f64,
}

impl Counts {
    fn add(&mut self, trial: &Trial, extent: f64, seconds: f64) {
        self.problems += 1;
        match trial.outcome {
            Outcome::Solved => self.solved += 1,
            Outcome::Unsolved => self.unsolved += 1,
            Outcome::EndRefused => self.ends_refused += 1,
            Outcome::Refused => self.refused += 1,
        }
        self.requests_refused += trial.refused_requests;
        self.damaged += trial.damaged;
        self.certified += u64::from(trial.certified);
        self.out_of_time += u64::from(trial.out_of_time);
        self.findings += trial.findings.len() as u64;
        self.seconds += seconds;
        if let Some(judged) = &trial.judged {
            self.edges += judged.edges;
            self.tests += judged.tests;
            self.unfinished += u64::from(!judged.finished && judged.fault.is_none());
            let least = judged.least / extent;
            if least.is_finite() {
                self.least = Some(self.least.map_or(least, |before| before.min(least)));
            }
        }
    }

    fn row(&self, name: &str) -> String {
        let Self { problems, solved, unsolved, ends_refused, edges, damaged, certified, findings, .. } = self;
        let least = self.least.map_or("–".to_owned(), |least| format!("{least:.0e}"));
        let numbers = [*problems, *solved, *unsolved, *ends_refused, *edges, *damaged, *certified, *findings]
            .map(grouped);
        format!("| {name} | {} | {least} |\n", numbers.join(" | "))
    }
}

/// A whole number with commas between thousands.
#[must_use]
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// The head of a table.
const HEAD: &str = "problems | solved | unsolved | ends refused | edges shown free | damaged paths refused | certificates replayed | findings | least distance / size |
|---|---|---|---|---|---|---|---|---|---|";

/// The counts of a run, and where it goes on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    version: u32,
    /// The seed of the problems.
    pub seed: u64,
    /// Which problems were wanted.
    #[serde(flatten)]
    pub wanted: Wanted,
    /// The number of the first problem that is not counted yet.
    pub next: u64,
    /// All problems.
    pub all: Counts,
    /// By kind of world.
    pub kinds: BTreeMap<String, Counts>,
    /// By planner, without meta-planners; and by meta-planner, with `…` after its prefix.
    pub planners: BTreeMap<String, Counts>,
    /// How many findings there are of each kind.
    pub findings: BTreeMap<String, u64>,
}

impl Tally {
    /// A tally of no problems.
    #[must_use]
    pub fn new(seed: u64, wanted: Wanted) -> Self {
        Self {
            version: VERSION,
            seed,
            wanted,
            next: 0,
            all: Counts::default(),
            kinds: BTreeMap::new(),
            planners: BTreeMap::new(),
            findings: BTreeMap::new(),
        }
    }

    /// Reads a tally back.
    ///
    /// # Errors
    /// When the text is not a tally of this version.
    pub fn from_json(text: &[u8]) -> Result<Self, String> {
        let tally: Self = serde_json::from_slice(text).map_err(|e| format!("not a tally: {e}"))?;
        match tally.version {
            VERSION => Ok(tally),
            other => Err(format!("the tally has version {other}, not {VERSION}")),
        }
    }

    /// The tally as text.
    #[must_use]
    pub fn to_json(&self) -> String {
        // All keys are text and all numbers finite, so this cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Counts a problem in a world of this extent (m), which took `seconds`.
    pub fn add(&mut self, trial: &Trial, extent: f64, seconds: f64) {
        self.all.add(trial, extent, seconds);
        self.kinds.entry(trial.kind.to_owned()).or_default().add(trial, extent, seconds);
        let mut rest = trial.planner.as_str();
        while let Some((prefix, inner)) = mp_plan::meta_planners()
            .iter()
            .find_map(|meta| Some((meta.prefix, rest.strip_prefix(meta.prefix)?)))
        {
            self.planners.entry(format!("{prefix}…")).or_default().add(trial, extent, seconds);
            rest = inner;
        }
        if !rest.is_empty() {
            self.planners.entry(rest.to_owned()).or_default().add(trial, extent, seconds);
        }
        for finding in &trial.findings {
            *self.findings.entry(finding.sort.to_owned()).or_default() += 1;
        }
    }

    /// The tables of docs/results/soak.md.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let mut text = format!("| kind of world | {HEAD}\n");
        self.kinds.iter().for_each(|(name, counts)| text += &counts.row(name));
        text += &self.all.row("**all**");
        // Writing to a String does not fail.
        let _ = write!(text, "\n| planner | {HEAD}\n");
        self.planners.iter().for_each(|(name, counts)| text += &counts.row(&format!("`{name}`")));
        let found: Vec<_> = self.findings.iter().map(|(sort, count)| format!("{sort}: {count}")).collect();
        let found = if found.is_empty() { "none".to_owned() } else { found.join(", ") };
        let Counts { tests, unfinished, requests_refused, refused, out_of_time, .. } = &self.all;
        let numbers = [*tests, *unfinished, *requests_refused, *refused, *out_of_time].map(grouped);
        let [tests, unfinished, requests, refused, late] = numbers;
        let _ = write!(
            text,
            "\nSeed {}, problems 0 to {}. The oracle compared two bodies {tests} times; {unfinished} paths took it too long. \
             {requests} requests did not suit the robot and were made simpler; in {refused} problems nothing was planned, and {late} were ended by the clock. \
             Findings: {found}.\n",
            self.seed,
            self.next.saturating_sub(1),
        );
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Problem;

    #[test]
    fn tallies_are_read_back() {
        let wanted = Wanted { kind: Some("disc".to_owned()), planner: None };
        let mut tally = Tally::new(5, wanted.clone());
        for i in 0..20 {
            let problem = Problem::new(5, i, &wanted);
            tally.add(&problem.run(&wanted), problem.world.case.extent, 0.25);
            tally.next += 1;
        }
        assert!(
            tally.all.solved > 5 && tally.all.edges > 5 && tally.kinds["disc"].problems == 20,
            "{tally:?}"
        );
        assert_eq!(Tally::from_json(tally.to_json().as_bytes()).unwrap(), tally);
        assert!(Tally::from_json(b"{}").is_err());
        assert!(tally.to_markdown().contains("| disc | 20 |"), "{}", tally.to_markdown());
        assert_eq!(grouped(1_234_567), "1,234,567");
    }
}
