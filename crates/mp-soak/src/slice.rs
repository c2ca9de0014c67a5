//! A slice of the soak: all kinds of worlds and all planners, and the loop around them.

#![cfg(test)]

use crate::draw::Draw;
use crate::oracle::{Fault, rows_of};
use crate::soak::{Options, read_tally, run, write_problem};
use crate::tally::Tally;
use crate::trial::{Outcome, Problem, Wanted, damage};
use crate::worlds::KINDS;
use mp_plan::{Cancel, PathFileKind, PathRows, Scene};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Problems of each kind.
const EACH: u64 = 16;

fn of_kind(kind: &str) -> Wanted {
    Wanted { kind: Some(kind.to_owned()), planner: None }
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("mp-soak-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

#[test]
fn no_problem_of_any_kind_has_a_finding() {
    for kind in KINDS {
        let wanted = of_kind(kind.name);
        let mut solved = 0;
        for number in 0..EACH {
            let trial = Problem::new(7, number, &wanted).run(&wanted);
            assert!(trial.findings.is_empty(), "{} {number}: {:?}", kind.name, trial.findings);
            assert!(trial.judged.is_none_or(|judged| judged.finished), "{} {number}", kind.name);
            assert_eq!(trial.certified, trial.outcome == Outcome::Solved, "{} {number}", kind.name);
            solved += u64::from(trial.certified);
        }
        // Hard ones are among them, but a slice in which little is solved would show little.
        assert!(solved >= 2, "{}: {solved}", kind.name);
    }
}

#[test]
fn every_planner_solves_problems_that_the_oracle_accepts() {
    for info in mp_plan::planners() {
        let mut solved = 0;
        for kind in ["polygon", "space", "driven", "disc"] {
            let wanted = Wanted { kind: Some(kind.to_owned()), planner: Some(info.name.to_owned()) };
            for number in 100..104 {
                let trial = Problem::new(7, number, &wanted).run(&wanted);
                assert!(trial.findings.is_empty(), "{} {kind} {number}: {:?}", info.name, trial.findings);
                assert!(trial.planner == info.name || trial.planner.is_empty());
                solved += u32::from(trial.outcome == Outcome::Solved);
            }
        }
        assert!(solved > 0, "{} solves none", info.name);
    }
}

#[test]
fn the_oracle_refuses_damaged_paths_in_worlds_of_every_kind() {
    for kind in KINDS {
        let wanted = of_kind(kind.name);
        // Of these an input leads nowhere near a row that was moved; tests of thin walls are about their
        // collisions.
        let by_inputs = ["flyer", "driven", "driven-moving"].contains(&kind.name);
        let (mut contacts, mut refused, mut paths) = (0, 0, 0);
        for number in 0..60 {
            let problem = Problem::new(9, number, &wanted);
            let Some(text) = problem.run(&wanted).path else { continue };
            let case = &problem.world.case;
            let rows = rows_of(&text).unwrap();
            assert_eq!(case.judge(&rows).fault, None);
            paths += 1;
            let mut draw = Draw::new(4, number);
            for _ in 0..20 {
                let mut damaged = rows.clone();
                damage(&mut damaged, case.extent, &mut draw);
                match case.judge(&damaged).fault {
                    Some(Fault::Contact { .. }) => contacts += 1,
                    Some(_) => refused += 1,
                    None => {}
                }
            }
            if paths >= 4 && if by_inputs { refused > 0 } else { contacts > 0 } {
                break;
            }
        }
        assert!(
            if by_inputs { refused > 0 } else { contacts > 0 },
            "{}: {contacts} {refused} {paths}",
            kind.name
        );
    }
}

/// A tally without what another run would not repeat.
fn repeatable(mut tally: Tally) -> Tally {
    let all = tally.kinds.values_mut().chain(tally.planners.values_mut());
    all.for_each(|counts| counts.seconds = 0.0);
    tally.all.seconds = 0.0;
    tally
}

#[test]
fn a_run_goes_on_where_it_was_interrupted() {
    let options = |name: &str, problems, threads| Options {
        out: folder(name),
        problems,
        seed: 11,
        threads,
        wanted: of_kind("disc"),
    };
    let (go, stop) = (Cancel::new(), Cancel::new());
    stop.cancel();
    let whole = options("whole", 230, 1);
    let at_once = run(&whole, &go, &mut |_| {}).unwrap();
    let parts = options("parts", 120, 3);
    assert_eq!(run(&parts, &stop, &mut |_| {}).unwrap().next, 0);
    assert_eq!(run(&parts, &go, &mut |_| {}).unwrap().next, 120);
    let mut told = 0;
    let on = Options { problems: 230, ..parts.clone() };
    let in_parts = run(&on, &go, &mut |tally| told = tally.next).unwrap();
    assert_eq!((told, in_parts.next), (230, 230));
    assert_eq!(repeatable(in_parts.clone()), repeatable(at_once));
    assert_eq!(read_tally(&on.out).unwrap(), Some(in_parts));
    // Other problems do not go into the same folder.
    assert!(
        run(&Options { seed: 12, ..on.clone() }, &go, &mut |_| {}).unwrap_err().contains("another folder")
    );
    for out in [whole.out, on.out] {
        std::fs::remove_dir_all(out).unwrap();
    }
}

#[test]
fn problems_depend_on_seed_and_number_only() {
    let wanted = Wanted::default();
    let mut seen = BTreeMap::new();
    for number in 0..40 {
        let [a, b] = [0; 2].map(|_| Problem::new(5, number, &wanted));
        assert_eq!(a.world.files, b.world.files);
        let [one, other] = [a, b].map(|problem| problem.run(&wanted));
        assert_eq!(one.path, other.path);
        *seen.entry(one.kind).or_insert(0) += 1;
    }
    assert!(seen.len() > 8, "{seen:?}");
}

#[test]
fn a_written_problem_is_repeated_from_its_files() {
    let wanted = of_kind("space");
    let options =
        Options { out: folder("written"), problems: 0, seed: 13, threads: 1, wanted: wanted.clone() };
    let mut repeated = 0;
    for number in 0..12 {
        let problem = Problem::new(13, number, &wanted);
        let trial = problem.run(&wanted);
        let (Some(path), Some(request)) = (&trial.path, &trial.request) else { continue };
        let folder = options.out.join(number.to_string());
        write_problem(&problem, &trial, &folder, &options, number).unwrap();
        let scene = Scene::load(folder.join(&problem.world.main)).unwrap();
        let report = scene.plan(request).unwrap();
        let rows = PathRows { format: scene.path_format(), columns: Vec::new(), rows: report.path.unwrap() };
        assert_eq!(rows.to_file(PathFileKind::Text), *path);
        assert_eq!(std::fs::read_to_string(folder.join("path.txt")).unwrap(), *path);
        let said = std::fs::read_to_string(folder.join("finding.txt")).unwrap();
        assert!(said.contains(&format!("--seed 13 --problem {number} --only space")), "{said}");
        repeated += 1;
    }
    assert!(repeated > 4);
    std::fs::remove_dir_all(options.out).unwrap();
}
