//! Many problems, lists of them, portfolios and roadmaps by regions: the same bytes on any number of threads,
//! in any number of shards, and after any end.
#![cfg(not(target_family = "wasm"))]

mod fuzz;
mod lists;
mod many;
mod portfolios;
mod ranks;
#[cfg(feature = "roadmaps")]
mod regions;
mod runs;
mod shards;

use mp_batch::{ListResults, ListedProblems, ManyOptions, ManyOutcome, ProblemList, merge_results};
use mp_plan::{Cancel, Error, Interrupt};
use std::path::PathBuf;

/// A scene of the folder of the list: a stick before a wall.
const SCENE: &str = "Robot\nstick.off\n-1 0 0 0 0 0\n1 0 0 0 0 0\nObstacle #1\nwall.off\n0 0 0 0 0 0\nEnd\n\
                     Bounds -2 -2 -2 2 2 2\n";
const STICK: &str = "OFF\n4 4 6\n0 0 0\n0.3 0 0\n0 0.1 0\n0 0 0.1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const WALL: &str = "OFF\n4 4 6\n0 -1 -1\n0.1 -1 -1\n0 1 -1\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

/// Solved ones, one without a path, one with an end in collision, one with ends of another robot, one without
/// a planner.
const LIST: &str = r#"{"scene": "easy", "seeds": {"from": 5, "count": 7}}
{"scene": "wall", "seeds": [3, 1], "request": {"budget": {"iterations": 20000}}}

{"scene": "easy", "request": {"budget": {"iterations": 1}, "seed": 9}}
{"scene": "wall.env", "goal": [0.01, 0, 0, 0, 0, 0]}
{"scene": "wall.env", "start": [0, 0]}
{"scene": "easy", "request": {"planner": "no-such-planner"}}
{"scene": "wall", "start": [-1, 0.5, 0, 0, 0, 0], "goals": [[1, 1, 1, 0, 0, 0], [1, -1, 0, 0, 0, 0]]}
"#;

struct Dir(tempfile::TempDir);

impl Dir {
    fn new() -> Self {
        let dir = Self(tempfile::tempdir().unwrap());
        for (name, text) in
            [("wall.env", SCENE), ("stick.off", STICK), ("wall.off", WALL), ("problems.jsonl", LIST)]
        {
            dir.write(name, text);
        }
        dir
    }
    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.at(name), text).unwrap();
    }
    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.at(name)).unwrap()
    }
    fn problems(&self) -> ListedProblems {
        let list = ProblemList::load(self.at("problems.jsonl")).unwrap();
        list.with_scenes(&Interrupt::never()).unwrap()
    }
    fn run(&self, out: &str, options: &ManyOptions) -> Result<ManyOutcome, Error> {
        self.problems().run(&self.at(out), options, &Cancel::new(), |_| ())
    }
    /// Which items of a file have a report, and the error at its end.
    fn items(&self, file: &str, partial: bool) -> (Vec<(u64, bool)>, Option<Error>) {
        let results = ListResults::open(&self.at(file)).unwrap();
        let mut results = if partial { results.partial() } else { results };
        let mut error = None;
        let items = results.by_ref().map_while(|item| item.map_err(|e| error = Some(e)).ok());
        let items = items.map(|item| (item.item, item.report.is_some())).collect();
        assert!(results.next().is_none());
        (items, error)
    }
    fn shard(&self, out: &str, shard: &str) -> ManyOutcome {
        self.run(out, &ManyOptions { shard: shard.parse().unwrap(), ..ManyOptions::default() }).unwrap()
    }
    fn merge(&self, out: &str, shards: &[&str]) -> Result<mp_batch::Tally, Error> {
        let shards: Vec<_> = shards.iter().map(|name| self.at(name)).collect();
        merge_results(&self.at(out), &shards)
    }
}

fn whole() -> ManyOptions {
    ManyOptions::default()
}
