//! Many problems at once: the same results, in order, on any number of threads.

use mp_batch::{in_order, plan_many};
use mp_plan::{Cancel, Request, Scene};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Problems, some of which have an end in collision or a planner that does not exist.
fn problems() -> Vec<(Scene, Request)> {
    let (easy, maze) = (Scene::find("easy").unwrap(), Scene::find("alpha-1.2").unwrap());
    let inside = easy.with_ends(&easy.start(), &[vec![0.0; 6]]).unwrap();
    (0..60)
        .map(|i| match i % 6 {
            0 => (inside.clone(), Request::new("rrt-connect").seed(i)),
            1 => (easy.clone(), Request::new("no-such-planner").seed(i)),
            2 => (maze.clone(), Request::new("rrt-connect").seed(i).iterations(50)),
            _ => (easy.clone(), Request::new("rrt-connect").seed(i)),
        })
        .collect()
}

/// What does not depend on time.
fn outcomes(threads: usize) -> Vec<String> {
    let mut outcomes = Vec::new();
    let taken = plan_many(problems(), threads, &Cancel::new(), |number, result| {
        assert_eq!(number, outcomes.len());
        outcomes.push(match result {
            Ok(report) => format!("{:?} {:?} {}", report.fingerprint, report.stopped_by, report.iterations),
            Err(e) => e.report(),
        });
        ControlFlow::Continue(())
    });
    assert_eq!(taken, outcomes.len());
    outcomes
}

#[test]
fn results_do_not_depend_on_threads() {
    let one = outcomes(1);
    assert_eq!(one.len(), 60);
    assert!(one[0].contains("collision") && one[1].contains("no-such-planner"), "{} {}", one[0], one[1]);
    assert!(one[2].contains("Iterations") && one[3].contains("Some"), "{} {}", one[2], one[3]);
    for threads in [2, 7] {
        assert_eq!(outcomes(threads), one, "{threads} threads");
    }
}

#[test]
fn items_are_drawn_when_they_are_needed() {
    let (drawn, taken) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let items = (0..20_000).inspect(|_| {
        let ahead = drawn.fetch_add(1, Ordering::SeqCst) - taken.load(Ordering::SeqCst);
        // A result counts as taken before `take` counts it.
        assert!(ahead <= 3 * 512 + 1, "{ahead} items wait");
    });
    let slow_first = |number: usize, item: usize| {
        if number == 0 {
            while drawn.load(Ordering::SeqCst) < 3 * 512 {
                std::thread::yield_now();
            }
        }
        2 * item
    };
    let mut results = Vec::new();
    in_order(items, 3, &Cancel::new(), slow_first, |_, result| {
        taken.fetch_add(1, Ordering::SeqCst);
        results.push(result);
        ControlFlow::Continue(())
    });
    assert!(results.iter().copied().eq((0..20_000).map(|i| 2 * i)));
}

#[test]
fn what_has_begun_is_given_after_a_cancel() {
    for threads in [1, 4] {
        let cancel = Cancel::new();
        let begun = AtomicUsize::new(0);
        let job = |number, ()| {
            begun.fetch_add(1, Ordering::SeqCst);
            if number == 100 {
                cancel.cancel();
            }
        };
        let taken = in_order(std::iter::repeat(()), threads, &cancel, job, |_, ()| ControlFlow::Continue(()));
        assert_eq!(taken, begun.load(Ordering::SeqCst));
        assert!(taken > 100);
    }
}

#[test]
fn a_taker_can_break_off() {
    for threads in [1, 4] {
        let count = |number, _: usize| match number < 9 {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        };
        assert_eq!(in_order(0.., threads, &Cancel::new(), |_, i| i, count), 10);
    }
}

#[test]
fn a_panic_ends_all_threads() {
    let faults: [&(dyn Fn(&str) + Sync); 3] =
        [&|at| assert!(at != "item", "a fault"), &|at| assert!(at != "job", "a fault"), &|at| {
            assert!(at != "taker", "a fault")
        }];
    for (which, fault) in faults.iter().enumerate() {
        for threads in [1, 3] {
            let items = (0..).inspect(|&i| {
                if i == 3000 {
                    fault("item");
                }
            });
            let job = |number, _: usize| {
                if number == 3000 {
                    fault("job");
                }
            };
            let take = |number, ()| {
                if number == 2000 {
                    fault("taker");
                }
                ControlFlow::Continue(())
            };
            let run = || in_order(items, threads, &Cancel::new(), job, take);
            assert!(
                std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).is_err(),
                "{which} {threads}"
            );
        }
    }
}
