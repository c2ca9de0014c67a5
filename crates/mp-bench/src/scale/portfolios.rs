//! Portfolios: measured on a few ranks, and replayed for more.

use super::problems::{Case, Costs, measured_as};
use super::{LATENCY_S, RANKS};
use crate::error::Result;
use crate::experiment::{Lab, Table, mean, seconds, short};
use crate::options::Common;
use crate::scenes::bare;
use mp_batch::{Portfolio, PortfolioOptions};
use mp_cspace::Rng;
use mp_plan::{Cancel, Control, Error, PortfolioSchedule, Request, Scene};
use mp_tree::Schedule;
use serde::{Deserialize, Serialize};

/// Problems whose run lengths have heavy tails: scene and planner, and the settings of the planner.
const PROBLEMS: [(&str, &[(&str, &str)]); 2] =
    [("twisty, rrt-connect", &[]), ("easy, rsrt", &[("inputs", "12"), ("levels", "1")])];
/// A unit of the schedule of Luby et al., iterations.
const UNIT: u64 = 250;
/// The number of runs for each rank in a round with that schedule.
const RUNS_OF_A_RANK: u64 = 4;
/// The runs of the portfolios that are measured.
const RUNS: u64 = 32;

/// The request of a problem of this experiment.
fn request(problem: &str, seed: u64) -> Result<Request> {
    let settings = PROBLEMS.iter().find(|(name, _)| *name == problem);
    let (_, settings) =
        settings.ok_or_else(|| Error::new(format!("there is no problem `{problem}` here")))?;
    let planner = problem.rsplit(' ').next().unwrap_or_default();
    let request = settings.iter().fold(bare(planner), |request, (name, value)| request.set(*name, value));
    Ok(request.seed(seed))
}

/// The lengths of single runs; `None` when the measurement was interrupted.
pub(super) fn lengths(lab: &Lab, common: &Common) -> Result<Option<Costs>> {
    let seeds = u64::from(common.runs_or(5, 400));
    let of = |(problem, _): &(&str, _)| {
        let problem = (*problem).to_owned();
        (1..=seeds).map(move |seed| Case { problem: problem.clone(), seed })
    };
    let cases: Vec<Case> = PROBLEMS.iter().flat_map(of).collect();
    measured_as(lab, common, "lengths", &cases, |_, case| request(&case.problem, case.seed))
}

/// A portfolio on some ranks, here threads.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct OnThreads {
    problem: String,
    schedule: PortfolioSchedule,
    ranks: usize,
    seed: u64,
}

/// What it did.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Worked {
    /// Iterations that the result needs, those of the busiest rank, and those of all.
    needed: u64,
    most: u64,
    all: u64,
}

/// Portfolios on 1, 2 and 4 ranks; `None` when the measurement was interrupted.
pub(super) fn on_threads(lab: &Lab, common: &Common) -> Result<Option<Vec<(OnThreads, Worked)>>> {
    let seeds = u64::from(common.runs_or(1, 20));
    let mut cases = Vec::new();
    for (problem, _) in PROBLEMS {
        for schedule in [PortfolioSchedule::None, PortfolioSchedule::Luby] {
            for ranks in [1, 2, 4] {
                let case = |seed| OnThreads { problem: problem.to_owned(), schedule, ranks, seed };
                cases.extend((1..=seeds).map(case));
            }
        }
    }
    let mut log = lab.log("scale-portfolios", common.time)?;
    let complete = lab.measure_in(
        &mut log,
        "scale, portfolios",
        &cases,
        |a: &OnThreads, b: &OnThreads| a.problem == b.problem,
        |case| Scene::find(case.problem.split(',').next().unwrap_or_default()),
        |scene, case| worked(scene, case, &lab.cancel),
    )?;
    Ok(complete.then(|| log.each(&cases).map(|(case, worked)| (case.clone(), *worked)).collect()))
}

/// Plans by a portfolio; `None` when it was interrupted.
fn worked(scene: &Scene, case: &OnThreads, cancel: &Cancel) -> Result<Option<Worked>> {
    let request = request(&case.problem, case.seed)?;
    let portfolio = Portfolio { schedule: case.schedule, unit: UNIT, round: RUNS, ..Portfolio::new(1 << 20) };
    let one = |link: mp_ranks::ThreadLink| {
        let mut control = Control { cancel: cancel.clone(), ..Control::default() };
        portfolio.plan_on(&link, scene, &request, &PortfolioOptions::default(), &mut control)
    };
    let outcome = std::thread::scope(|scope| {
        let mut links = mp_ranks::threads(case.ranks).into_iter();
        let master = links.next();
        let one = &one;
        links.for_each(|link| drop(scope.spawn(move || one(link).map(drop))));
        master.map(one).transpose()
    })?;
    let Some(outcome) = outcome.flatten().filter(|_| !cancel.is_raised()) else { return Ok(None) };
    let iterations = outcome.work.iter().map(|work| work.iterations);
    Ok(Some(Worked {
        needed: outcome.report.portfolio.as_ref().map_or(0, |counts| counts.iterations),
        most: iterations.clone().max().unwrap_or(0),
        all: iterations.sum(),
    }))
}

/// The tables.
pub(super) fn text(on_threads: &[(OnThreads, Worked)], lengths: &Costs) -> Result<String> {
    let mut measured =
        Table::new(["problem", "schedule", "ranks", "efficiency", "work beyond what the result needs"]);
    let key = |case: &OnThreads| (case.problem.clone(), case.schedule, case.ranks);
    for group in on_threads.chunk_by(|(a, _), (b, _)| key(a) == key(b)) {
        let sum = |of: fn(&Worked) -> u64| group.iter().map(|(_, worked)| of(worked)).sum::<u64>() as f64;
        let (case, _) = &group[0];
        let [needed, most, all] = [sum(|w| w.needed), sum(|w| w.most), sum(|w| w.all)];
        measured.rows.push(vec![
            case.problem.clone(),
            case.schedule.to_string(),
            case.ranks.to_string(),
            format!("{:.3}", needed / (case.ranks as f64 * most)),
            format!("{:.1} %", 100.0 * (all / needed - 1.0)),
        ]);
    }
    let mut parts = vec![measured.markdown()];
    for (problem, _) in PROBLEMS {
        let runs = lengths.runs.iter().filter(|(case, _)| case.problem == problem);
        let runs: Vec<(u64, f64)> = runs.map(|(_, cost)| (cost.iterations, cost.seconds)).collect();
        let alone = mean(runs.iter().map(|(_, seconds)| *seconds)).unwrap_or(0.0);
        parts.push(format!("**{problem}**: {} runs measured, mean {}", runs.len(), seconds(alone)));
        parts.push(replayed(&runs)?.markdown());
    }
    Ok(parts.join("\n\n"))
}

/// Portfolios of drawn lengths, for each number of ranks.
fn replayed(runs: &[(u64, f64)]) -> Result<Table> {
    const DRAWS: u64 = 200;
    let iterations: u64 = runs.iter().map(|(iterations, _)| iterations).sum();
    let took: f64 = runs.iter().map(|(_, seconds)| seconds).sum();
    let of_iteration = took / (iterations as f64).max(1.0);
    let alone = took / runs.len().max(1) as f64;
    let mut table =
        Table::new(["ranks", "race: time", "speed-up", "efficiency", "Luby: time", "speed-up", "efficiency"]);
    for ranks in RANKS {
        let mut row = vec![ranks.to_string()];
        for luby in [false, true] {
            let (mut time, mut needed, mut most) = (0.0, 0.0, 0.0);
            for draw in 0..DRAWS {
                let replay = Replay::of(runs, ranks, luby, &mut Rng::stream(1, draw))?;
                time += replay.most * of_iteration + replay.rounds * 2.0 * LATENCY_S;
                needed += replay.needed;
                most += replay.most;
            }
            let time = time / DRAWS as f64;
            row.extend([
                seconds(time),
                short(alone / time),
                format!("{:.3}", needed / (ranks as f64 * most)),
            ]);
        }
        table.rows.push(row);
    }
    Ok(table)
}

/// A portfolio of drawn lengths.
#[derive(Clone, Copy, Debug, Default)]
struct Replay {
    /// Iterations that the result needs, and those of the busiest rank, summed over the rounds.
    needed: f64,
    most: f64,
    rounds: f64,
}

impl Replay {
    /// One run of each rank races, or some of each rank in rounds with caps; a run that cannot win makes a
    /// sixteenth too much.
    fn of(runs: &[(u64, f64)], ranks: usize, luby: bool, rng: &mut Rng) -> Result<Self> {
        let mut replay = Self::default();
        let mut caps =
            Schedule::Luby.lengths(Rng::seed(0)).map(|units| if luby { UNIT * units } else { u64::MAX });
        let of_round = ranks as u64 * if luby { RUNS_OF_A_RANK } else { 1 };
        loop {
            let mut length =
                || runs.get((rng.unit() * runs.len() as f64) as usize).map(|(length, _)| *length);
            let round: Option<Vec<(u64, u64)>> =
                (0..of_round).map(|_| Some((length()?, caps.next().unwrap_or(u64::MAX)))).collect();
            let mut round = round.ok_or_else(|| Error::new("there are no measured lengths"))?;
            round.sort_by_key(|(_, cap)| std::cmp::Reverse(*cap));
            let best = round.iter().filter(|(length, cap)| length <= cap).map(|(length, _)| *length).min();
            let made = |(length, cap): &(u64, u64), most: u64| (*length).min(*cap).min(most) as f64;
            let bound = best.unwrap_or(u64::MAX);
            let reach = best.map_or(u64::MAX, |best| best + (best / 16).max(4));
            // The largest caps first, there and back again.
            let lane = |lane: usize| {
                let turns = round.chunks(ranks).enumerate();
                let of = |(turn, runs): (usize, &[(u64, u64)])| {
                    runs.get(if turn % 2 == 0 { lane } else { ranks - 1 - lane }).map(|run| made(run, reach))
                };
                turns.filter_map(of).sum()
            };
            replay.needed += round.iter().map(|run| made(run, bound)).sum::<f64>();
            replay.most += (0..ranks).map(lane).fold(0.0, f64::max);
            replay.rounds += 1.0;
            if best.is_some() {
                return Ok(replay);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replays_count_what_runs_make() {
        let runs = [(1000, 1.0)];
        for ranks in [1, 4, 100] {
            let race = Replay::of(&runs, ranks, false, &mut Rng::seed(1)).unwrap();
            assert_eq!((race.needed, race.most, race.rounds), (1000.0 * ranks as f64, 1000.0, 1.0));
        }
        // With one rank, rounds of four: the caps 250, 250, 500, 250; 250, 500, 1000 and 250 have a run that
        // is long enough.
        let luby = Replay::of(&runs, 1, true, &mut Rng::seed(1)).unwrap();
        assert_eq!((luby.needed, luby.most, luby.rounds), (1250.0 + 2000.0, 1250.0 + 2000.0, 2.0));
        assert!(Replay::of(&[], 1, false, &mut Rng::seed(1)).is_err());
    }

    #[test]
    fn portfolios_are_measured_on_ranks() {
        let scene = Scene::find("easy").unwrap();
        let (problem, schedule) = ("easy, rsrt".to_owned(), PortfolioSchedule::Luby);
        let needed = [1, 2].map(|ranks| {
            let case = OnThreads { problem: problem.clone(), schedule, ranks, seed: 3 };
            let worked = worked(&scene, &case, &Cancel::new()).unwrap().unwrap();
            assert!(worked.needed <= worked.all && worked.all <= ranks as u64 * worked.most);
            worked.needed
        });
        assert_eq!(needed[0], needed[1]);
    }
}
