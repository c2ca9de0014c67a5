//! Graded scenes as tables and charts.

use super::{Case, Plan, Run};
use crate::error::Result;
use crate::experiment::{
    Log, Median, Table, bootstrap, ratio, restricted_mean, seconds, survival, wilson, wilson_percent,
};
use crate::plot::{Axis, ChartCurve, Labels, charts};
use mp_scenes::puzzle;

/// The planner with which `auto` is compared.
const PLAIN: &str = "rrt-connect";
/// Times at which curves have intervals, as parts of the longest.
const MARKS: [f64; 6] = [0.001, 0.005, 0.02, 0.1, 0.3, 1.0];

/// The runs, for summaries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Results<'a> {
    pub(super) log: &'a Log<Case, Run>,
    pub(super) plan: &'a Plan,
}

impl Results<'_> {
    /// The times of the runs, and whether they ended then or were cut short.
    fn times(&self, scene: &str, planner: &str) -> Vec<(f64, bool)> {
        let runs = self.log.runs(self.plan.runs(scene, planner));
        runs.iter().map(|run| (run.seconds.min(self.plan.cap), run.solved)).collect()
    }

    fn median(&self, scene: &str, planner: &str) -> Option<Median> {
        let times = self.times(scene, planner);
        Median::of(times.into_iter().map(|(time, ended)| if ended { time } else { f64::INFINITY }))
    }

    /// All tables with their titles.
    pub(super) fn tables(&self) -> Vec<(&'static str, Table)> {
        vec![("Solved runs and median times, s", self.by_scene()), ("By grade", self.by_grade())]
    }

    /// For each scene, how many runs each planner has solved, and its median time with an interval.
    fn by_scene(&self) -> Table {
        let cap = format!("> {}", self.plan.cap);
        let cell = |scene: &str, planner: &String| {
            let times = self.times(scene, planner);
            let solved = times.iter().filter(|time| time.1).count();
            let median = self.median(scene, planner).map_or("–".into(), |m| m.cell(&cap, seconds));
            format!("{solved}/{}, {median}", times.len())
        };
        let head = ["scene", "grade", "room, % of the radius"].map(str::to_owned);
        let last = format!("auto : {PLAIN}");
        let mut table = Table::new(head.into_iter().chain(self.plan.planners.iter().cloned()).chain([last]));
        for scene in &self.plan.scenes {
            let known = puzzle(scene);
            let grade = known.map_or("–".into(), |known| known.grade.to_string());
            let room = known.map_or("–".into(), |known| seconds(100.0 * known.room));
            let compared = self.median(scene, "auto").zip(self.median(scene, PLAIN));
            let compared = compared.map_or("–".into(), |(a, b)| ratio(&a, &b, self.plan.cap));
            let cells = self.plan.planners.iter().map(|planner| cell(scene, planner));
            table
                .rows
                .push([scene.clone(), grade, room].into_iter().chain(cells).chain([compared]).collect());
        }
        table
    }

    /// For each grade and planner: scenes that all runs solve, runs solved, and the mean time, where a run
    /// that was cut short counts with its time.
    fn by_grade(&self) -> Table {
        let mut table =
            Table::new(["grade", "planner", "scenes always solved", "runs solved", "95%", "mean s"]);
        let grade_of = |scene: &String| puzzle(scene).map(|known| known.grade);
        let mut grades: Vec<u8> = self.plan.scenes.iter().filter_map(grade_of).collect();
        grades.sort_unstable();
        grades.dedup();
        for grade in grades {
            let scenes = || self.plan.scenes.iter().filter(|scene| grade_of(scene) == Some(grade));
            for planner in &self.plan.planners {
                let of_scenes: Vec<_> = scenes().map(|scene| self.times(scene, planner)).collect();
                let always = of_scenes.iter().filter(|times| times.iter().all(|time| time.1)).count();
                let times = of_scenes.concat();
                let solved = times.iter().filter(|time| time.1).count();
                if times.is_empty() {
                    continue;
                }
                let mean = |drawn: &[usize]| restricted_mean(drawn.iter().map(|&i| times[i]), self.plan.cap);
                let (low, high) = bootstrap(times.len(), mean);
                let at_least = if solved == times.len() { "" } else { "≥ " };
                let mean = seconds(mean(&(0..times.len()).collect::<Vec<_>>()));
                table.rows.push(vec![
                    grade.to_string(),
                    planner.clone(),
                    format!("{always}/{}", of_scenes.len()),
                    format!("{solved}/{}", times.len()),
                    wilson_percent(solved, times.len()),
                    format!("{at_least}{mean} ({} – {})", seconds(low), seconds(high)),
                ]);
            }
        }
        table
    }

    /// For each scene, the share of runs that are still going on, against time, with 95% intervals.
    pub(super) fn charts(&self) -> Vec<(String, Result<String>)> {
        let of = |scene: &String| -> Vec<(String, Result<String>)> {
            let curves = self.plan.planners.iter().enumerate().map(|(i, planner)| {
                let times = self.times(scene, planner);
                let interval = |part: f64| {
                    let time = part * self.plan.cap;
                    let going = times.iter().filter(|(end, ended)| !ended || *end > time).count();
                    let (low, high) = wilson(going, times.len());
                    (time, low, high)
                };
                let ranges = MARKS.map(interval).to_vec();
                ChartCurve { ranges, ..ChartCurve::new(planner, i, survival(times)).pattern(i % 4) }
            });
            let title = format!("{scene}: runs that still go on, with 95% intervals");
            let labels = Labels { title: &title, x: "s of processor time", y: "share of runs" };
            let all = charts(labels, [Axis::Log, Axis::FromZero(Some(1.0))], curves.collect());
            all.into_iter().map(|(part, chart)| (format!("{scene}{part}"), chart)).collect()
        };
        self.plan.scenes.iter().flat_map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_and_grades_are_summed_up() {
        let mut log = Log::in_memory(60.0);
        let [one, three] =
            [1, 3].map(|grade| mp_scenes::PUZZLES.iter().find(|p| p.grade == grade).unwrap().scene);
        let plan = Plan {
            scenes: [one, three].map(str::to_owned).to_vec(),
            planners: ["auto", PLAIN].map(str::to_owned).to_vec(),
            seeds: 20,
            cap: 60.0,
        };
        for case in plan.cases() {
            // RRT-Connect never solves the hard one, and `auto` three quarters of its runs.
            let lost = case.scene == three && (case.planner == PLAIN || case.seed % 4 == 0);
            let seconds = if case.planner == PLAIN { 0.5 } else { 0.7 };
            let seconds = if lost { 60.01 } else { seconds };
            log.learn([(case, Run { solved: !lost, seconds, ..Run::default() })]);
        }
        let results = Results { log: &log, plan: &plan };
        let rows = results.by_scene().rows;
        assert_eq!(rows[0][3..], ["20/20, 0.700 (0.700 – 0.700)", "20/20, 0.500 (0.500 – 0.500)", "1.40"]);
        assert_eq!(rows[1][3..], ["15/20, 0.700 (0.700 – 0.700)", "0/20, > 60 (> 60 – > 60)", "< 0.01"]);
        let rows = results.by_grade().rows;
        assert_eq!(rows[0][..4], ["1", "auto", "1/1", "20/20"]);
        // Five of twenty runs of 60 s.
        assert!(rows[2][5].starts_with("≥ 15.5 ("), "{}", rows[2][5]);
        assert_eq!(rows[3][2..4], ["0/1", "0/20"]);
        let charts = results.charts();
        assert!(charts.iter().all(|(_, chart)| chart.as_ref().is_ok_and(|c| c.contains("rrt-connect"))));
    }
}
