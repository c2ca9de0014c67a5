//! The same results for any number of ranks, whoever is fast or slow; cancelled and gone on with; failing.

use mp_ranks::{
    Checkpoint, Error, ItemContext, Items, Job, JobEnd, Link, Options, Pace, Policy, Work, broadcast, run,
    simulate, threads,
};
use mp_stop::Cancel;
use proptest::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Runs a job on so many ranks; the master's answer.
fn on(ranks: usize, options: &Options, job: &mut (dyn Job + Send), work: &Work<'_>) -> Result<JobEnd, Error> {
    std::thread::scope(|scope| {
        let mut links = threads(ranks).into_iter();
        let master = links.next().unwrap();
        for link in links {
            // Of their own: they hear of a cancel from the master.
            let options = Options { cancel: Cancel::new(), ..options.clone() };
            scope.spawn(move || run(&link, &options, None, work).unwrap());
        }
        run(&master, options, Some(job), work)
    })
}

/// Takes longer for some items, which differ from rank to rank and time to time.
fn square(item: u64, _: &ItemContext) -> Result<Vec<u8>, String> {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    let call = CALLS.fetch_add(1, Ordering::Relaxed);
    std::thread::sleep(Duration::from_micros(200 * (call % 7)));
    Ok((item * item).to_le_bytes().to_vec())
}

#[test]
fn results_do_not_depend_on_ranks_and_threads() {
    for ranks in [1, 2, 3, 4, 7] {
        for threads in [1, 3] {
            let mut results = vec![None; 200];
            let mut of_rank = vec![0; ranks];
            let mut job = Items::dearest_first(
                0..200,
                |item| (item % 5) as f64,
                |item, rank, result| {
                    of_rank[rank] += 1;
                    assert!(results[item as usize].replace(result).is_none(), "{item} twice");
                    Ok(())
                },
            );
            let options = Options { threads, ..Options::default() };
            let ran = on(ranks, &options, &mut job, &square).unwrap();
            assert_eq!((ran.cancelled, &ran.items), (false, &of_rank));
            assert!(ranks * threads > 60 || of_rank.iter().all(|items| *items > 0), "{of_rank:?}");
            for (item, result) in results.into_iter().enumerate() {
                assert_eq!(result, Some(((item * item) as u64).to_le_bytes().to_vec()));
            }
        }
    }
}

#[test]
fn what_was_cancelled_goes_on_from_its_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("squares");
    let done = AtomicU64::new(0);
    let work = |item: u64, context: &ItemContext| {
        done.fetch_add(1, Ordering::Relaxed);
        square(item, context)
    };
    let mut results = std::collections::BTreeMap::new();
    for stop_at in [30, 70, 1000] {
        let checkpoint = Checkpoint::open(&file, "100 squares").unwrap();
        results.extend(checkpoint.known().clone());
        let open: Vec<u64> = (0..100).filter(|item| !checkpoint.known().contains_key(item)).collect();
        let options = Options::default();
        let mut job = Items::new(open, |item, _, result: Vec<u8>| {
            checkpoint.keep(item, &result).map_err(|e| e.to_string())?;
            results.insert(item, result);
            if results.len() == stop_at {
                options.cancel.cancel();
            }
            Ok(())
        });
        let ran = on(3, &options, &mut job, &work).unwrap();
        assert_eq!(ran.cancelled, stop_at < 100);
    }
    assert!(results.iter().map(|(item, result)| (*item, result)).eq((0..100).map(|i| (i, &results[&i]))));
    // Those that were worked on when it was cancelled are done again.
    assert!(done.load(Ordering::Relaxed) <= 100 + 2 * 6);
}

/// Waits until it is cancelled.
fn wait(context: &ItemContext) -> Result<Vec<u8>, String> {
    while !context.cancel.is_raised() {
        std::thread::sleep(Duration::from_millis(1));
    }
    Ok(Vec::new())
}

#[test]
fn long_items_hear_of_a_cancel() {
    // Again and again: the cancel comes at any moment of the master's loop.
    for _ in 0..100 {
        let options = Options::default();
        let waits = |_: u64, context: &ItemContext| {
            options.cancel.cancel();
            wait(context)
        };
        let ran = on(3, &options, &mut Items::new(0..10, |_, _, _| Ok(())), &waits).unwrap();
        assert!(ran.cancelled && ran.items == [0, 0, 0]);
    }
}

#[test]
fn a_cancel_on_any_rank_ends_the_job() {
    // An item that fails because it was cancelled is no failure.
    let cancelled_on_its_rank = |item: u64, context: &ItemContext| match item {
        5 => {
            context.cancel.cancel();
            Err("no time".to_owned())
        }
        _ => wait(context),
    };
    let options = Options { threads: 2, ..Options::default() };
    let ran = on(3, &options, &mut Items::new(0..20, |_, _, _| Ok(())), &cancelled_on_its_rank).unwrap();
    assert!(ran.cancelled && ran.items == [0, 0, 0]);
}

#[test]
fn an_item_that_fails_is_named_and_ends_all_ranks() {
    for bad in [0, 17, 49] {
        let fails = |item: u64, context: &ItemContext| match item == bad {
            true => Err("no map".to_owned()),
            false => square(item, context),
        };
        let e = on(3, &Options::default(), &mut Items::new(0..50, |_, _, _| Ok(())), &fails).unwrap_err();
        assert!(
            matches!(&e, Error::Item { item, message, .. } if *item == bad && message == "no map"),
            "{e}"
        );
        let panics = |item: u64, context: &ItemContext| {
            assert!(item != bad, "a fault");
            square(item, context)
        };
        let e = on(2, &Options::default(), &mut Items::new(0..50, |_, _, _| Ok(())), &panics).unwrap_err();
        assert!(e.to_string().contains("a fault"), "{e}");
        let mut untaken = Items::new(0..50, |item, _, _| (item != bad).then_some(()).ok_or("odd".to_owned()));
        let e = on(2, &Options::default(), &mut untaken, &square).unwrap_err();
        assert!(e.to_string().contains(&format!("item {bad},")), "{e}");
    }
}

/// A search of the least number, which ends others that are worse already.
struct Least {
    next: u64,
    best: u64,
}

impl Job for Least {
    fn next(&mut self) -> Option<u64> {
        self.next += 1;
        (self.next <= 40).then_some(self.next)
    }
    fn left(&self) -> u64 {
        40 - self.next.min(40)
    }
    fn take(&mut self, _: u64, _: usize, result: Vec<u8>) -> Result<(), String> {
        let value = u64::from_le_bytes(result.try_into().map_err(|_| "eight bytes")?);
        self.best = self.best.min(value);
        Ok(())
    }
    fn bound(&self) -> u64 {
        self.best
    }
}

#[test]
fn the_bound_reaches_those_that_work() {
    for ranks in [1, 3] {
        let ended_early = AtomicU64::new(0);
        // Item 2 counts to 2, the others never end by themselves.
        let counts = |item: u64, context: &ItemContext| {
            let mut n = 0_u64;
            while n < if item == 2 { 2 } else { u64::MAX } {
                if n > context.bound() {
                    ended_early.fetch_add(1, Ordering::Relaxed);
                    return Ok(u64::MAX.to_le_bytes().to_vec());
                }
                n += 1;
                std::thread::sleep(Duration::from_micros(100));
            }
            Ok(n.to_le_bytes().to_vec())
        };
        let mut job = Least { next: 0, best: u64::MAX };
        on(ranks, &Options { threads: 2, ..Options::default() }, &mut job, &counts).unwrap();
        assert_eq!((job.best, ended_early.into_inner()), (2, 39));
    }
}

#[test]
fn several_jobs_one_after_the_other_with_what_all_must_know() {
    let sum_of = |link: &dyn Link, cancel: &Cancel| {
        let (mut total, options) = (0, Options { cancel: cancel.clone(), ..Options::default() });
        for round in 0..5_u64 {
            let work = move |item: u64, _: &ItemContext| Ok((item + round).to_le_bytes().to_vec());
            let mut sum = total;
            let mut job = Items::new(0..20, |_, _, result: Vec<u8>| {
                sum += u64::from_le_bytes(result.try_into().map_err(|_| "eight bytes")?);
                Ok(())
            });
            let job: Option<&mut dyn Job> = if link.is_master() { Some(&mut job) } else { None };
            run(link, &options, job, &work).unwrap();
            let bytes = broadcast(link, sum.to_le_bytes().to_vec()).unwrap();
            total = u64::from_le_bytes(bytes.try_into().unwrap());
        }
        total
    };
    let cancel = Cancel::new();
    std::thread::scope(|scope| {
        let all: Vec<_> =
            threads(4).into_iter().map(|link| scope.spawn(|| (link, &cancel)).join().unwrap()).collect();
        let all: Vec<_> =
            all.into_iter().map(|(link, cancel)| scope.spawn(move || sum_of(&link, cancel))).collect();
        for rank in all {
            assert_eq!(rank.join().unwrap(), 5 * 190 + 20 * 10);
        }
    });
}

proptest! {
    /// Nothing takes longer than one rank, or less than its share; nothing gets lost.
    #[test]
    fn simulated_jobs_are_possible(costs in prop::collection::vec(0.001..10.0_f64, 1..300), ranks in 1_usize..40) {
        let total: f64 = costs.iter().sum();
        let longest = costs.iter().copied().fold(0.0, f64::max);
        for policy in [Policy::Blocks, Policy::Shards, Policy::InOrder, Policy::DearestFirst] {
            let s = simulate(&costs, policy, ranks, 1e-5, 1e-6);
            prop_assert!(s.makespan_s >= longest.max(total / ranks as f64) * (1.0 - 1e-9), "{policy:?} {s:?}");
            prop_assert!(s.makespan_s <= total + 1e-3 * costs.len() as f64, "{policy:?} {s:?}");
            prop_assert!(s.efficiency <= 1.0 + 1e-9 && s.master_load < 0.5, "{policy:?} {s:?}");
        }
        // Graham 1969: items handed out in any order end within twice the best, and the dearest first within
        // four thirds. With one more item in hand than is worked on, that holds for the items without.
        let best = longest.max(total / ranks as f64);
        let in_order = simulate(&costs, Policy::InOrder, ranks, 0.0, 0.0).makespan_s;
        prop_assert!(in_order <= 2.0 * best + longest + 1e-9, "{in_order} {best}");
    }
}

#[test]
fn simulated_jobs_are_those_done_by_hand() {
    let last = |costs: &[f64], policy, ranks| simulate(costs, policy, ranks, 0.0, 0.0).makespan_s;
    let costs = [1.0, 1.0, 1.0, 5.0];
    assert_eq!(last(&costs, Policy::Blocks, 2), 6.0);
    assert_eq!(last(&costs, Policy::Shards, 2), 6.0);
    assert_eq!(last(&costs, Policy::InOrder, 2), 6.0);
    assert_eq!(last(&costs, Policy::DearestFirst, 2), 5.0);
    let slow = simulate(&[1.0; 4], Policy::InOrder, 2, 0.5, 0.25);
    // Sent at 0.25 and 0.5, there at 0.75 and 1, done at 1.75 and 2, known at 2.25 and 2.5, the next ones
    // sent at 2.5 and 2.75 …
    assert_eq!((slow.makespan_s, slow.master_load), (4.25, 1.0 / 4.25));
}

/// Items that race, all at a time. Each calls `wait` at each step; `most` is how far it may then be, when the
/// last is so far.
fn race(
    [ranks, threads]: [usize; 2],
    steps: u64,
    wait: &(dyn Fn(&mut Pace, &ItemContext, u64, u64) + Sync),
    most: &(dyn Fn(u64) -> u64 + Sync),
) {
    let items = (ranks * threads) as u64;
    let far: Vec<AtomicU64> = (0..items).map(|_| AtomicU64::new(0)).collect();
    let work = |item: u64, context: &ItemContext| {
        let mut pace = Pace::new(item);
        for reached in 0..steps {
            far[item as usize].store(reached, Ordering::SeqCst);
            wait(&mut pace, context, item, reached);
            // What is known is older than what is.
            let least = far.iter().map(|far| far.load(Ordering::SeqCst)).min().unwrap();
            assert!(reached <= most(least), "{reached}, and one is at {least}");
        }
        far[item as usize].store(u64::MAX, Ordering::SeqCst);
        Ok(Vec::new())
    };
    let options = Options { threads, ..Options::default() };
    let ran = on(ranks, &options, &mut Items::new(0..items, |_, _, _| Ok(())), &work).unwrap();
    assert_eq!(ran.items.iter().sum::<u64>(), items);
}

#[test]
fn items_hear_how_far_the_last_of_them_is() {
    const LEAD: u64 = 10;
    let wait = |_: &mut Pace, context: &ItemContext, item, reached| {
        context.reached(item, reached);
        while reached > context.least_reached() + LEAD {
            std::thread::sleep(Duration::from_micros(100));
        }
    };
    for on in [[1, 1], [1, 4], [3, 1], [3, 2]] {
        race(on, 100, &wait, &|least| least + LEAD);
    }
}

#[test]
fn those_who_race_keep_pace() {
    // The steps of the clock, microseconds: with long ones nothing is too new to count; with short ones most
    // reports are left out.
    for step in [1000, 30] {
        for on in [[1, 4], [3, 1], [3, 2]] {
            let clock = AtomicU64::new(0);
            let now = || Duration::from_micros(clock.fetch_add(step, Ordering::SeqCst));
            let wait = |pace: &mut Pace, context: &ItemContext, _, reached| {
                pace.keep(context, reached, now, || false)
            };
            let most = |least: u64| if step < 200 { u64::MAX } else { least + (least / 8).max(4) };
            race(on, 400, &wait, &most);
        }
    }
}

#[test]
fn nobody_waits_without_having_said_how_far_it_is() {
    let work = |item: u64, context: &ItemContext| {
        if item == 0 {
            let mut pace = Pace::new(0);
            pace.keep(context, 10, || Duration::ZERO, || false);
            // So soon after, 20 is not reported; then time passes, and it is too far ahead of 15.
            let asked = AtomicU64::new(0);
            let now =
                || Duration::from_micros([10, 1000][usize::from(asked.fetch_add(1, Ordering::SeqCst) > 0)]);
            pace.keep(context, 20, now, || false);
        } else {
            context.reached(1, 15);
            context.wait_while(Duration::from_millis(1), || context.least_reached() < 15);
            context.reached(1, 100);
        }
        Ok(Vec::new())
    };
    let options = Options { threads: 2, ..Options::default() };
    let ran = on(1, &options, &mut Items::new(0..2, |_, _, _| Ok(())), &work).unwrap();
    assert_eq!(ran.items, [2]);
}

#[test]
fn news_wake_those_who_wait() {
    let (waits, day) = (AtomicU64::new(0), Duration::from_secs(24 * 60 * 60));
    let work = |item: u64, context: &ItemContext| {
        if item == 0 {
            context.reached(0, 2);
            context.wait_while(day, || {
                waits.store(1, Ordering::SeqCst);
                context.least_reached() < 1
            });
        } else {
            while waits.load(Ordering::SeqCst) == 0 {
                std::thread::yield_now();
            }
            context.reached(item, 1);
            context.wait_while(day, || context.least_reached() < 1);
        }
        Ok(Vec::new())
    };
    for _ in 0..100 {
        waits.store(0, Ordering::SeqCst);
        let ran = on(2, &Options::default(), &mut Items::new(0..2, |_, _, _| Ok(())), &work).unwrap();
        assert_eq!(ran.items, [1, 1]);
    }
}
