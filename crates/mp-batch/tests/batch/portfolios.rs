//! Portfolios: the same report on any number of ranks and threads, the true winner, early stops, checkpoints.

use mp_batch::{Portfolio, PortfolioOptions, PortfolioOutcome};
use mp_plan::{
    Cancel, Control, Error, PathRows, PortfolioCounts, PortfolioSchedule, Progress, Report, Request, Scene,
    StoppedBy, Watch,
};
use std::path::Path;

/// Plans on so many ranks, with so many threads each.
fn on(
    ranks: usize,
    threads: usize,
    scene: &Scene,
    request: &Request,
    portfolio: &Portfolio,
) -> PortfolioOutcome {
    let options = PortfolioOptions { threads, checkpoint: None };
    let one = |link: mp_ranks::ThreadLink| {
        portfolio.plan_on(&link, scene, request, &options, &mut Control::default()).unwrap()
    };
    std::thread::scope(|scope| {
        let mut links = mp_ranks::threads(ranks).into_iter();
        let master = links.next().unwrap();
        let others: Vec<_> = links.map(|link| scope.spawn(move || one(link))).collect();
        let outcome = one(master).unwrap();
        others.into_iter().for_each(|other| assert_eq!(other.join().unwrap(), None));
        outcome
    })
}

fn alone(scene: &Scene, request: &Request, portfolio: &Portfolio) -> Report {
    let outcome =
        portfolio.plan(scene, request, &PortfolioOptions::default(), &mut Control::default()).unwrap();
    outcome.report.without_times()
}

fn counts(report: &Report) -> &PortfolioCounts {
    report.portfolio.as_ref().unwrap()
}

/// A scene whose run lengths have a heavy tail.
fn twisty() -> (Scene, Request) {
    (Scene::find("twisty").unwrap(), Request { seed: 4, ..Request::new("rrt-connect") })
}

fn luby(runs: u64, unit: u64, round: u64) -> Portfolio {
    Portfolio { runs, schedule: PortfolioSchedule::Luby, unit, round }
}

#[test]
fn reports_do_not_depend_on_ranks_and_threads() {
    let easy = Scene::find("easy").unwrap();
    let (twisty, heavy) = twisty();
    let tight = Request::new("rrt-connect").iterations(3);
    let cases = [
        (&easy, Request::new("rrt-connect").seed(9), Portfolio::new(20)),
        (&easy, Request::new("rrt-star").seed(2), luby(30, 40, 8)),
        (&easy, Request::new("prm").iterations(300), Portfolio::new(5)),
        (&easy, tight, Portfolio { round: 4, ..Portfolio::new(10) }),
        (&twisty, heavy, luby(40, 60, 8)),
    ];
    for (scene, request, portfolio) in cases {
        let text = |outcome: PortfolioOutcome| outcome.report.without_times().to_json().unwrap();
        let one = text(on(1, 1, scene, &request, &portfolio));
        for (ranks, threads) in [(1, 2), (1, 7), (2, 1), (3, 2), (4, 1), (7, 1)] {
            assert_eq!(text(on(ranks, threads, scene, &request, &portfolio)), one, "{ranks} × {threads}");
        }
        assert_eq!(Report::from_json(&one).unwrap().to_json().unwrap(), one);
    }
}

/// The winner has m iterations: nobody has a path in m − 1, and no run before the winner in m.
#[test]
fn the_winner_has_the_fewest_iterations_and_then_the_least_number() {
    let scene = Scene::find("easy").unwrap();
    let mut before = 0;
    for seed in 1..=12 {
        let request = Request::new("rrt-connect").seed(seed);
        let report = alone(&scene, &request, &Portfolio::new(24));
        let (winner, most) = (counts(&report).winner.unwrap(), report.iterations);
        assert!(report.solved && report.verified && counts(&report).iterations <= 24 * most);
        let path = PathRows {
            format: scene.path_format(),
            columns: scene.columns(),
            rows: report.path.clone().unwrap(),
        };
        assert!(scene.check(&path).unwrap().free);
        if most > 1 {
            let fewer = alone(&scene, &request.clone().iterations(most - 1), &Portfolio::new(24));
            assert_eq!((fewer.solved, fewer.stopped_by), (false, Some(StoppedBy::Iterations)));
            assert_eq!((fewer.iterations, counts(&fewer).iterations), (24 * (most - 1), 24 * (most - 1)));
        }
        if winner > 1 {
            before += 1;
            let others = Portfolio::new(winner - 1);
            assert!(!alone(&scene, &request.clone().iterations(most), &others).solved, "seed {seed}");
        }
        // The run itself, without the others behind it, and with a cap that it just needs.
        let again = alone(&scene, &request.clone().iterations(most), &Portfolio::new(winner));
        assert_eq!((again.fingerprint, again.nodes), (report.fingerprint, report.nodes));
    }
    assert!(before > 6, "the first run wins nearly always: {before}");
}

#[test]
fn rounds_follow_until_one_has_a_path() {
    let (scene, request) = twisty();
    let portfolio = luby(400, 30, 8);
    let report = alone(&scene, &request, &portfolio);
    let (winner, begun) = (counts(&report).winner.unwrap(), counts(&report).begun);
    assert!(report.solved && begun > 8 && begun.is_multiple_of(8) && (begun - 7..=begun).contains(&winner));
    // The rounds before have none, and cost all of their caps.
    let limited = request.clone().iterations(1 << 40);
    let before = alone(&scene, &limited, &Portfolio { runs: begun - 8, ..portfolio });
    assert_eq!((before.solved, counts(&before).begun), (false, begun - 8));
    let lengths = [1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8, 1, 1, 2, 1, 1, 2, 4, 1, 1];
    let caps: u64 = lengths.iter().cycle().take((begun - 8) as usize).sum();
    if begun <= 32 {
        assert_eq!(before.iterations, 30 * caps);
    }
    assert!(counts(&report).iterations > before.iterations);
    // All in one round: another winner, as runs behind have a chance.
    let at_once = alone(&scene, &request, &Portfolio { runs: begun, round: begun, ..portfolio });
    assert!(at_once.iterations <= report.iterations);
    for schedule in PortfolioSchedule::ALL {
        let capped = Portfolio { schedule, runs: 6, unit: 7, round: 6 };
        let report = alone(&scene, &request.clone().iterations(25), &capped);
        let caps: [u64; 6] = match schedule {
            PortfolioSchedule::None => [25; 6],
            PortfolioSchedule::Luby => [7, 7, 14, 7, 7, 14],
            PortfolioSchedule::Counter => [7, 7, 7, 7, 14, 7],
            PortfolioSchedule::Wide => [25, 21, 14, 7, 7, 7],
            // Drawn at random.
            PortfolioSchedule::Zeta => {
                assert!((42..=150).contains(&report.iterations));
                continue;
            }
        };
        assert!(!report.solved);
        assert_eq!(report.iterations, caps.iter().sum::<u64>(), "{schedule}");
    }
}

/// What ends a portfolio whose runs all reach their caps: nothing, unless a budget was given; then it is
/// named.
#[test]
fn a_schedule_goes_on_unless_a_budget_says_otherwise() {
    let (scene, request) = twisty();
    for (schedule, runs, round) in [
        (PortfolioSchedule::Luby, 3, 2),
        (PortfolioSchedule::Luby, 8, 64),
        (PortfolioSchedule::Counter, 5, 3),
        (PortfolioSchedule::Zeta, 4, 4),
        (PortfolioSchedule::Wide, 4, 1),
    ] {
        let portfolio = Portfolio { runs, schedule, unit: 10, round };
        let report = alone(&scene, &request, &portfolio);
        let winner = counts(&report).winner.unwrap();
        assert!(report.solved && report.verified && winner > runs, "{schedule}: run {winner}");
        assert!((winner..winner + round.min(runs)).contains(&counts(&report).begun));
        for (ranks, threads) in [(1, 2), (3, 1)] {
            let again = on(ranks, threads, &scene, &request, &portfolio).report.without_times();
            assert_eq!(again, report, "{schedule} on {ranks} × {threads}");
        }
        // Budgets that no run reaches.
        for limited in [
            request.clone().iterations(1 << 40),
            Request { budget: mp_plan::Budget { nodes: Some(1 << 40), ..request.budget }, ..request.clone() },
        ] {
            let ended = alone(&scene, &limited, &portfolio);
            assert_eq!(
                (ended.stopped_by, counts(&ended).begun),
                (Some(StoppedBy::Schedule), runs),
                "{schedule}"
            );
            assert!(ended.why.as_ref().is_some_and(|why| why.contains("schedule")), "{:?}", ended.why);
            assert!(ended.stages.iter().all(|stage| stage.ended_by == Some(StoppedBy::Schedule)));
        }
        // One that some reach is what ends it.
        let few = alone(&scene, &request.clone().iterations(7), &portfolio);
        assert_eq!((few.stopped_by, few.iterations), (Some(StoppedBy::Iterations), 7 * runs), "{schedule}");
        // Time ends it, and is named.
        let walled =
            Request { settings: [("step".to_owned(), "0.01%".to_owned())].into(), ..request.clone() };
        let ended = alone(&scene, &walled.time(0.2), &portfolio);
        assert_eq!((ended.solved, ended.stopped_by), (false, Some(StoppedBy::Time)), "{schedule}");
    }
}

#[test]
fn runs_that_cannot_win_stop() {
    let (scene, request) = twisty();
    let outcome = on(1, 1, &scene, &request, &Portfolio::new(12));
    let [needed, done] = [counts(&outcome.report).iterations, outcome.work[0].iterations];
    // Those that would go on longest, alone.
    let longest = (1..=4).map(|seed| scene.plan(&request.clone().seed(seed)).unwrap().iterations).max();
    let most = outcome.report.iterations;
    assert!(longest > Some(4 * most), "the lengths have no heavy tail: {most} and {longest:?}");
    assert_eq!(needed, 12 * most);
    assert!(needed <= done && done <= needed + 12 * (16 + most / 8), "{needed} of {done}");
    let queries = outcome.work[0].queries;
    assert!(outcome.report.collision_checks < queries && outcome.work[0].runs == 12);
    // On several ranks each run is done by one of them.
    let outcome = on(3, 1, &scene, &request, &Portfolio::new(12));
    assert_eq!(outcome.work.iter().map(|work| work.runs).collect::<Vec<_>>(), [4; 3]);
    assert!(outcome.work.iter().map(|work| work.iterations).sum::<u64>() >= needed);
    assert!(outcome.efficiency() > 0.0 && outcome.efficiency() <= 1.0);
}

/// Cancels after the first results.
struct Impatient(Cancel);

impl Watch for Impatient {
    fn progress(&mut self, _: &Progress) {
        self.0.cancel();
    }
}

fn kept(
    scene: &Scene,
    request: &Request,
    portfolio: &Portfolio,
    (file, threads): (&Path, usize),
    control: &mut Control<'_>,
) -> Result<PortfolioOutcome, Error> {
    let options = PortfolioOptions { threads, checkpoint: Some(file.to_owned()) };
    portfolio.plan(scene, request, &options, control)
}

#[test]
fn what_was_cancelled_goes_on_from_its_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("kept");
    let (scene, request) = twisty();
    let portfolio = luby(400, 30, 8);
    let whole = alone(&scene, &request, &portfolio);
    let mut known = Vec::new();
    let report = loop {
        let cancel = Cancel::new();
        let mut watch = Impatient(cancel.clone());
        let threads = 1 + known.len() % 3;
        let mut control = Control::new(cancel, &mut watch);
        let outcome = kept(&scene, &request, &portfolio, (&file, threads), &mut control).unwrap();
        known.push(outcome.known);
        let path = outcome.report.path.is_some();
        if outcome.report.stages.iter().all(|stage| stage.ended_by.is_none()) {
            break outcome.report.without_times();
        }
        let ended = outcome.report.stages.iter().find_map(|stage| stage.ended_by);
        assert_eq!(ended, Some(StoppedBy::Interrupted));
        // A path of the last round may come too late to be verified.
        let interrupted = [Some(StoppedBy::Interrupted), Some(StoppedBy::Unverified)];
        assert!(path || interrupted.contains(&outcome.report.stopped_by));
        assert!(file.exists() && known.len() < 100);
    };
    assert_eq!(report, whole);
    assert!(known.len() > 2 && known.is_sorted() && known[0] == 0 && known[1] > 0, "{known:?}");
    assert!(!file.exists(), "it is done");
}

#[test]
fn checkpoints_of_anything_else_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("kept");
    let (scene, request) = twisty();
    let run = |request: &Request, portfolio: Portfolio| {
        let cancel = Cancel::new();
        let mut watch = Impatient(cancel.clone());
        kept(&scene, request, &portfolio, (&file, 1), &mut Control::new(cancel, &mut watch))
    };
    run(&request, luby(400, 30, 8)).unwrap();
    for refused in [
        run(&request.clone().seed(5), luby(400, 30, 8)),
        run(&request, luby(400, 31, 8)),
        run(&request.clone().iterations(70), luby(400, 30, 8)),
    ] {
        let e = refused.unwrap_err();
        assert!(e.to_string().contains("another job") && e.remedy().is_some(), "{e}");
    }
    // More time does not matter.
    assert!(run(&request.clone().time(90.0), luby(400, 30, 8)).unwrap().known > 0);
}

#[test]
fn bad_input_is_refused_with_a_remedy() {
    let (scene, request) = twisty();
    let plan = |request: &Request, portfolio: Portfolio| {
        portfolio.plan(&scene, request, &PortfolioOptions::default(), &mut Control::default())
    };
    for (words, refused) in [
        ("number of runs 0", plan(&request, Portfolio::new(0))),
        ("rounds of 0", plan(&request, Portfolio { round: 0, ..Portfolio::new(3) })),
        ("the unit 0", plan(&request, Portfolio { unit: 0, ..Portfolio::new(3) })),
        ("no roadmap", plan(&Request { roadmap: Some("map".into()), ..request.clone() }, Portfolio::new(3))),
        ("no-such-planner", plan(&Request::new("no-such-planner"), Portfolio::new(3))),
        ("goal-bias", plan(&request.clone().set("goal-bias", "7"), Portfolio::new(3))),
        ("schedule `fast`", "fast".parse::<PortfolioSchedule>().map(|_| unreachable!())),
    ] {
        let e = refused.unwrap_err();
        assert!(e.to_string().contains(words) && (words == "goal-bias" || e.remedy().is_some()), "{e}");
    }
    // Ranks that were started with different requests.
    let mut links = mp_ranks::threads(2);
    let (other, master) = (links.pop().unwrap(), links.pop().unwrap());
    let on = |link: mp_ranks::ThreadLink, seed: u64| {
        let (request, options) = (request.clone().seed(seed), PortfolioOptions::default());
        Portfolio::new(4).plan_on(&link, &scene, &request, &options, &mut Control::default())
    };
    let e = std::thread::scope(|scope| {
        let different = scope.spawn(|| on(other, 2));
        let e = on(master, 1).unwrap_err();
        assert_eq!(different.join().unwrap().unwrap_err().to_string(), e.to_string());
        e
    });
    assert!(e.to_string().contains("rank 1 has another scene, request or portfolio"), "{e}");
}

#[test]
fn time_ends_the_whole_portfolio() {
    let (scene, request) = twisty();
    let walled = Request { settings: [("step".to_owned(), "0.01%".to_owned())].into(), ..request }.time(0.05);
    let report = alone(&scene, &walled, &Portfolio { runs: 1000, round: 3, ..Portfolio::new(1000) });
    assert_eq!((report.solved, report.stopped_by), (false, Some(StoppedBy::Time)));
    assert_eq!(counts(&report).begun, 3, "there is no time for another round");
}
