//! Runs: what they write, and how they go on.

use crate::{Dir, LIST, STICK, WALL, whole};
use mp_batch::{ItemResult, ListResults, ManyOptions, ManyOutcome, ProblemList, Shard};
use mp_plan::{Cancel, Interrupt, Report};
use serde_json::Value;

#[test]
fn results_are_lines_in_order() {
    let dir = Dir::new();
    let mut steps = Vec::new();
    let outcome =
        dir.problems().run(&dir.at("r.jsonl"), &whole(), &Cancel::new(), |now| steps.push(*now)).unwrap();
    assert_eq!((outcome.items, outcome.before, outcome.is_complete()), (14, 0, true));
    assert_eq!(steps.iter().map(|step| step.tally.items).collect::<Vec<_>>(), (0..=14).collect::<Vec<_>>());
    let tally = outcome.tally;
    assert_eq!([tally.items, tally.solved, tally.unsolved, tally.failed, tally.timed], [14, 10, 1, 3, 0]);

    let text = dir.read("r.jsonl");
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let (header, items, end) = (&lines[0], &lines[1..15], &lines[15]);
    assert_eq!(
        (&header["format"], &header["items"], &header["shard"]),
        (&"mp-many".into(), &14.into(), &"1/1".into())
    );
    assert_eq!(header["list"], "problems.jsonl");
    let files: Vec<_> = header["scenes"].as_array().unwrap().iter().map(|scene| &scene["file"]).collect();
    assert_eq!(files[1..], ["wall.env", "wall.env"]);
    assert_eq!(end["end"]["solved"], 10);
    for (i, item) in items.iter().enumerate() {
        assert_eq!(item["item"], i);
        let Some(report) = item.get("report") else { continue };
        let report = Report::from_json(&report.to_string()).unwrap();
        assert_eq!((report.time_s, report.finish_s, report.first_s), (0.0, 0.0, None));
        assert!(!report.stages.is_empty() && report.stages.iter().all(|stage| stage.time_s == 0.0));
    }
    let seeds: Vec<_> = items.iter().map(|item| item["report"]["seed"].as_u64()).collect();
    let expected = [5, 6, 7, 8, 9, 10, 11, 3, 1, 9].map(Some);
    assert_eq!(seeds, [&expected[..], &[None, None, None, Some(1)]].concat());
    assert_eq!(items[9]["report"]["stopped_by"], "iterations");
    for (item, words) in
        [(10, "the goal is in collision"), (11, "has 6 finite numbers"), (12, "no-such-planner")]
    {
        let error = &items[item]["error"];
        assert!(error["message"].as_str().unwrap().contains(words) && error["help"].is_string(), "{error}");
    }

    // The same as without a list.
    let scene = mp_plan::Scene::find("easy").unwrap();
    let report = scene.plan(&mp_plan::Request::new("auto").seed(8)).unwrap();
    assert_eq!(items[3]["report"]["fingerprint"].as_str(), report.fingerprint.as_deref());
}

#[test]
fn results_are_read_item_by_item() {
    let dir = Dir::new();
    dir.run("r.jsonl", &whole()).unwrap();
    let (all, none) = dir.items("r.jsonl", false);
    assert!(none.is_none());
    assert_eq!(all, (0..14).map(|item| (item, !(10..13).contains(&item))).collect::<Vec<_>>());
    let results = ListResults::open(&dir.at("r.jsonl")).unwrap();
    assert_eq!((results.header().items, results.header().list.as_str()), (14, "problems.jsonl"));
    let lines: Vec<ItemResult> =
        dir.read("r.jsonl").lines().skip(1).filter_map(|line| serde_json::from_str(line).ok()).collect();
    assert_eq!(results.collect::<Result<Vec<_>, _>>().unwrap(), lines);
    assert_eq!(lines[0].clone().into_result().unwrap().seed, 5);
    let error = lines[10].clone().into_result().unwrap_err();
    assert!(error.message().contains("the goal is in collision") && error.remedy().is_some());

    // Of a shard, the numbers are those in the list.
    dir.shard("2.jsonl", "2/5");
    assert_eq!(dir.items("2.jsonl", false).0, [(1, true), (6, true), (11, false)]);

    // One that was cut off, also within a line, and one that was changed.
    let text = dir.read("r.jsonl");
    let sixth = text.match_indices('\n').nth(6).unwrap().0;
    for cut in [sixth + 1, sixth + 30] {
        dir.write("cut.jsonl", &text[..cut]);
        let (items, error) = dir.items("cut.jsonl", false);
        let error = error.unwrap();
        assert!(error.message().contains("it has 6 of 14 items"), "{error}");
        assert!(error.remedy().unwrap().contains("mp many problems.jsonl"), "{error}");
        assert_eq!(items, all[..6]);
        let (partial, error) = dir.items("cut.jsonl", true);
        assert!(partial == items && error.is_none());
    }
    dir.write("bad.jsonl", text.replacen("\"item\":3", "\"item\":4", 1));
    let (items, error) = dir.items("bad.jsonl", true);
    assert!(items.len() == 3 && error.unwrap().message().contains("line 5"));
    dir.write("bad.jsonl", "{}\n");
    assert!(ListResults::open(&dir.at("bad.jsonl")).unwrap_err().message().contains("is no file of results"));
}

/// What is wrong with a scene is said at its items, in the same words wherever the list is, and the others
/// are planned.
#[test]
fn scenes_that_cannot_be_loaded_fail_at_their_items() {
    let list = r#"{"scene": "broken.env"}
{"scene": "easy", "seeds": [1, 2]}
{"scene": "torn.env", "seeds": [3, 4]}
{"scene": "wall"}
{"scene": "problems.jsonl"}
"#;
    let written = || {
        let dir = Dir::new();
        dir.write("problems.jsonl", list);
        dir.write("broken.env", crate::SCENE.replace("wall.off", "missing.off"));
        dir.write("torn.env", crate::SCENE.replace("wall.off", "torn.off"));
        dir.write("torn.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n");
        dir
    };
    let (one, other) = (written(), written());
    let tally = one.run("r.jsonl", &whole()).unwrap().tally;
    assert_eq!([tally.items, tally.solved, tally.failed], [7, 3, 4]);
    other.run("r.jsonl", &ManyOptions { threads: 3, ..whole() }).unwrap();
    assert_eq!(one.read("r.jsonl"), other.read("r.jsonl"));
    let lines: Vec<Value> =
        one.read("r.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for (item, words) in [(0, "missing.off"), (3, "torn.off"), (4, "torn.off"), (6, "problems.jsonl")] {
        let message = lines[1 + item]["error"]["message"].as_str().unwrap();
        assert!(message.contains(words) && !message.contains("/"), "{message}");
    }
    // Another byte of a file that is there now, and of one that was not.
    let begun: String = one.read("r.jsonl").lines().take(3).map(|line| format!("{line}\n")).collect();
    for (name, text) in [("torn.off", "OFF\n"), ("missing.off", WALL)] {
        let dir = written();
        dir.write("r.jsonl", &begun);
        dir.write(name, text);
        assert!(dir.run("r.jsonl", &whole()).unwrap_err().message().contains("a file has changed"), "{name}");
    }
}

/// Motions of several parts have several paths: one report cannot say that they are solved.
#[test]
fn motions_of_several_parts_fail_at_their_items() {
    let dir = Dir::new();
    dir.write(
        "problems.jsonl",
        r#"{"scene": "carry"}
{"scene": "carry", "start": [0, 0.3, 1.2, 0, 1, 0], "goal": [0.1, 0.3, 1.2, 0, 1, 0]}
"#,
    );
    let tally = dir.run("r.jsonl", &whole()).unwrap().tally;
    assert_eq!([tally.solved, tally.failed], [1, 1], "{}", dir.read("r.jsonl"));
    assert!(dir.read("r.jsonl").contains("the motion of carry has several parts"));
}

/// A file that changes after the list was read ends the run: its items would not be those of the header.
#[test]
fn a_file_that_changes_meanwhile_ends_the_run() {
    let dir = Dir::new();
    let srdf = "<robot name=\"r\"><disable_collisions link1=\"a\" link2=\"b\"/></robot>";
    let joint = "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"1 0 0\"/>\
                 <limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint>";
    dir.write("r.urdf", format!("<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>{joint}</robot>"));
    dir.write("arm.toml", "[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [0]\ngoal = [1]\n");
    dir.write("r.srdf", srdf);
    for (scene, file, text) in [
        ("wall", "wall.off", WALL.replace("0.1 -1 -1", "0.2 -1 -1")),
        ("wall", "wall.env", crate::SCENE.to_owned() + "\n"),
        ("wall", "wall.off", String::new()),
        // One that is found beside another one.
        ("arm.toml", "r.srdf", String::new()),
    ] {
        dir.write("problems.jsonl", format!("{{\"scene\": \"easy\"}}\n{{\"scene\": \"{scene}\"}}\n"));
        let (problems, out) = (dir.problems(), dir.at("r.jsonl"));
        let mut now = 0;
        let change = |outcome: &ManyOutcome| {
            now = outcome.tally.items;
            if now == 1 {
                match text.is_empty() {
                    true => drop(std::fs::remove_file(dir.at(file))),
                    false => dir.write(file, &text),
                }
            }
        };
        let e = problems.run(&out, &whole(), &Cancel::new(), change).unwrap_err();
        assert!(now == 1 && e.message().contains("has changed since the list was read"), "{file}: {e}");
        std::fs::remove_file(&out).unwrap();
        dir.write("wall.off", WALL);
        dir.write("wall.env", crate::SCENE);
        dir.write("r.srdf", srdf);
    }
}

/// Scenes come when they are needed, few are there at a time, and each is let go after its last item; robots
/// are shared. What is there needs its files no longer.
#[test]
fn few_of_many_scenes_are_there_at_a_time() {
    let dir = Dir::new();
    let joint = "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"1 0 0\"/>\
                 <limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint>";
    let shape = "<collision><geometry><mesh filename=\"stick.off\"/></geometry></collision>";
    let urdf = format!("<robot name=\"r\"><link name=\"a\"/><link name=\"b\">{shape}</link>{joint}</robot>");
    let mut list = String::new();
    for i in 0..40 {
        let motion = "[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [-1]\ngoal = [1]\n[[obstacle]]\n";
        dir.write(
            &format!("s{i}.toml"),
            format!("{motion}box = [0.2, 0.2, 0.2]\npose = [{i}, 2, 0, 0, 0, 0]\n"),
        );
        list += &format!("{{\"scene\": \"s{i}\", \"seeds\": [1, 2]}}\n");
    }
    dir.write("problems.jsonl", &list);
    dir.write("r.urdf", &urdf);
    let gone = |name: &str| std::fs::remove_file(dir.at(name)).unwrap();

    let (problems, untouched) = (dir.problems(), dir.problems());
    let loads = |item| problems.problem(item, None).is_ok();
    assert!(loads(0));
    // The robot has been read.
    gone("stick.off");
    assert!(untouched.problem(0, None).is_err());
    for i in 0..20 {
        assert!(loads(2 * i), "{i}");
        gone(&format!("s{i}.toml"));
    }
    // Of these twenty the last sixteen are there; the last item lets them go.
    for i in 0..20 {
        assert_eq!(loads(2 * i), i >= 4, "{i}");
        assert_eq!((loads(2 * i + 1), loads(2 * i + 1)), (i >= 4, false), "{i}");
    }
    assert!(loads(79) && loads(79));
    assert_eq!(problems.problem(60, None).unwrap().0.inputs().len(), 3, "also the files of the robot");

    // Alone, each comes to the same.
    dir.write("stick.off", STICK);
    for i in 0..20 {
        let text = std::fs::read_to_string(dir.at("s30.toml")).unwrap();
        dir.write(&format!("s{i}.toml"), text.replace("[30,", &format!("[{i},")));
    }
    dir.run("r.jsonl", &whole()).unwrap();
    let lines: Vec<Value> =
        dir.read("r.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for item in [0, 17, 79_usize] {
        let scene = mp_plan::Scene::load(dir.at(&format!("s{}.toml", item / 2))).unwrap();
        let request = mp_plan::Request::new("rrt-connect").seed(item as u64 % 2 + 1);
        let fingerprint = scene.plan(&request).unwrap().fingerprint;
        assert_eq!(lines[1 + item]["report"]["fingerprint"].as_str(), fingerprint.as_deref());
    }
}

/// A robot of which some joints move is shared where the start holds the others at the same values, and made anew where it does not.
#[test]
fn robots_with_held_joints_are_shared() {
    let dir = Dir::new();
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/><axis xyz=\"1 0 0\"/>\
             <limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint>"
        )
    };
    let shape = "<collision><geometry><mesh filename=\"stick.off\"/></geometry></collision>";
    let joints = [joint("j", "a", "b"), joint("k", "b", "c")].concat();
    let urdf = format!(
        "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\">{shape}</link>{joints}</robot>"
    );
    dir.write("r.urdf", urdf);
    let (held, mut list) = ([0.25, 0.25, 0.5, 0.5, 0.0], String::new());
    for (i, k) in held.iter().enumerate() {
        let k = if *k == 0.0 { String::new() } else { format!(", k = {k}") };
        let motion = format!("[motion]\nstart = {{ j = -1{k} }}\ngoal = {{ j = 1 }}\n");
        let robot = "[robot]\nurdf = \"r.urdf\"\njoints = [\"j\"]\n";
        let obstacle = format!("[[obstacle]]\nbox = [0.2, 0.2, 0.2]\npose = [0.{i}, 2, 0, 0, 0, 0]\n");
        dir.write(&format!("s{i}.toml"), format!("{robot}{motion}{obstacle}"));
        list += &format!("{{\"scene\": \"s{i}\"}}\n");
    }
    dir.write("problems.jsonl", &list);
    dir.run("r.jsonl", &whole()).unwrap();
    let written = dir.read("r.jsonl");
    let lines = written.lines().skip(1).map(|line| serde_json::from_str::<Value>(line).unwrap());
    for (i, line) in lines.take(held.len()).enumerate() {
        let scene = mp_plan::Scene::load(dir.at(&format!("s{i}.toml"))).unwrap();
        let fingerprint = scene.plan(&mp_plan::Request::default()).unwrap().fingerprint;
        assert!(fingerprint.is_some());
        assert_eq!(line["report"]["fingerprint"].as_str(), fingerprint.as_deref(), "{i}");
    }

    let problems = dir.problems();
    let load = |item| problems.problem(item, None).map(|(scene, _)| scene);
    let [first, other] = [load(0).unwrap(), load(2).unwrap()];
    assert!(
        first.notes() != other.notes() && format!("{:?}", other.notes()).contains("k at 0.5"),
        "{:?}",
        other.notes()
    );
    // The robot of the last one has been read.
    std::fs::remove_file(dir.at("stick.off")).unwrap();
    assert!(load(3).is_ok() && load(1).is_err() && load(4).is_err());
}

#[test]
fn threads_do_not_matter() {
    let dir = Dir::new();
    for threads in 1..=3 {
        dir.run(&format!("{threads}.jsonl"), &ManyOptions { threads, ..whole() }).unwrap();
    }
    assert!(dir.read("1.jsonl") == dir.read("2.jsonl") && dir.read("1.jsonl") == dir.read("3.jsonl"));
}

/// The list is named in another way, from another folder.
#[test]
fn folders_do_not_matter() {
    let (one, other) = (Dir::new(), Dir::new());
    one.run("r.jsonl", &whole()).unwrap();
    std::fs::create_dir(other.at("in")).unwrap();
    let list = ProblemList::load(other.at("in/../problems.jsonl")).unwrap();
    let problems = list.with_scenes(&Interrupt::never()).unwrap();
    problems.run(&other.at("deep/er/r.jsonl"), &whole(), &Cancel::new(), |_| ()).unwrap();
    assert_eq!(one.read("r.jsonl"), other.read("deep/er/r.jsonl"));
    let inputs: Vec<_> = problems.inputs().iter().map(|file| mp_store::FileId::of(file)).collect();
    for name in ["problems.jsonl", "wall.env", "wall.off", "stick.off"] {
        assert!(inputs.contains(&mp_store::FileId::of(&other.at(name))), "{name}");
    }
}

/// All places at which a run can be cut off.
#[test]
fn what_was_cut_off_goes_on() {
    let dir = Dir::new();
    dir.run("all.jsonl", &whole()).unwrap();
    let all = dir.read("all.jsonl");
    let header = all.find('\n').unwrap() + 1;
    let ends: Vec<usize> = all.match_indices('\n').map(|(at, _)| at + 1).collect();
    // Each line whole, without its line break, with a byte of it, with half of it.
    let mut cuts = ends.clone();
    cuts.extend(ends.iter().flat_map(|end| [end - 1, end + 1]));
    cuts.extend(ends.windows(2).map(|pair| pair[0].midpoint(pair[1])));
    cuts.retain(|cut| (header..=all.len()).contains(cut));
    assert_eq!(cuts.len(), 15 + 1 + 15 + 15 + 15);
    let (problems, options) = (dir.problems(), ManyOptions { threads: 2, ..whole() });
    for cut in cuts {
        dir.write("cut.jsonl", &all[..cut]);
        let outcome = problems.run(&dir.at("cut.jsonl"), &options, &Cancel::new(), |_| ()).unwrap();
        let lines = ends.iter().filter(|end| **end <= cut).count();
        assert_eq!(outcome.before, (lines as u64 - 1).min(14), "{cut}");
        assert!(outcome.is_complete() && dir.read("cut.jsonl") == all, "cut after {cut} bytes");
    }
    dir.write("cut.jsonl", "");
    assert_eq!(dir.run("cut.jsonl", &whole()).unwrap().before, 0);
    assert_eq!(dir.read("cut.jsonl"), all);
}

/// Items that were at work when they were interrupted leave nothing.
#[test]
fn a_cancelled_run_goes_on() {
    let dir = Dir::new();
    dir.run("all.jsonl", &whole()).unwrap();
    for threads in [1, 3] {
        for after in [0, 1, 4, 13] {
            let cancel = Cancel::new();
            let out = format!("{threads}-{after}.jsonl");
            let options = ManyOptions { threads, ..whole() };
            let stop = |now: &ManyOutcome| {
                if now.tally.items == after {
                    cancel.cancel();
                }
            };
            let outcome = dir.problems().run(&dir.at(&out), &options, &cancel, stop).unwrap();
            // Other threads may have done what is left by then.
            assert!(threads > 1 && after > 0 || !outcome.is_complete(), "{outcome:?}");
            assert!(outcome.tally.items >= after, "{outcome:?}");
            let begun = dir.read(&out);
            assert!(dir.read("all.jsonl").starts_with(&begun), "{begun}");
            let outcome = dir.run(&out, &options).unwrap();
            assert!(outcome.before >= after && outcome.is_complete(), "{outcome:?}");
            assert!(dir.read("all.jsonl") == dir.read(&out));
        }
    }
}

#[test]
fn times_are_there_when_they_are_asked_for() {
    let dir = Dir::new();
    dir.write("problems.jsonl", r#"{"scene": "easy", "seeds": [1, 2]}"#);
    dir.run("r.jsonl", &ManyOptions { times: true, ..whole() }).unwrap();
    for line in dir.read("r.jsonl").lines().skip(1).take(2) {
        let line: Value = serde_json::from_str(line).unwrap();
        assert!(line["report"]["time_s"].as_f64().unwrap() > 0.0, "{line}");
    }
    // A header that says that there are none is wrong.
    let lie = dir.read("r.jsonl").replacen("\"times\":true", "\"times\":false", 1);
    dir.write("lie.jsonl", &lie);
    let e = dir.merge("out.jsonl", &["lie.jsonl"]).unwrap_err();
    assert!(e.message().contains("line 2: it has times"), "{e}");
}

/// A budget of time for problems that name none; those that it ends are counted.
#[test]
fn a_budget_of_time_is_for_those_without() {
    let dir = Dir::new();
    dir.write(
        "problems.jsonl",
        r#"{"scene": "easy"}
{"scene": "easy", "request": {"budget": {"time_s": 50}}}
{"scene": "easy", "request": {"budget": {"time_s": null}}}
{"scene": "crossing"}"#,
    );
    let problems = dir.problems();
    let time = |item| problems.problem(item, Some(1e-9)).unwrap().1.budget.time_s;
    assert_eq!([0, 1, 2].map(time), [Some(1e-9), Some(50.0), None]);
    assert_eq!(problems.problem(0, None).unwrap().1.budget.time_s, Some(60.0));
    assert_eq!(problems.problem(3, None).unwrap().1.planner, "rrt");
    assert!(problems.problem(4, None).is_err());
    let tally = dir.run("r.jsonl", &ManyOptions { time_s: Some(1e-9), ..whole() }).unwrap().tally;
    assert_eq!([tally.solved, tally.unsolved, tally.timed], [2, 2, 2]);
}

#[test]
fn other_results_are_not_gone_on_with() {
    let dir = Dir::new();
    dir.run("r.jsonl", &whole()).unwrap();
    let whole_text = dir.read("r.jsonl");
    let half = &whole_text[..whole_text.len() / 2];
    let refuse = |options: &ManyOptions, words: &str| {
        for text in [half, &whole_text] {
            dir.write("r.jsonl", text);
            let e = dir.run("r.jsonl", options).unwrap_err();
            assert!(e.message().contains("cannot be gone on with") && e.message().contains(words), "{e}");
            assert!(e.remedy().unwrap().contains("delete it"), "{e}");
            assert_eq!(dir.read("r.jsonl"), text);
        }
    };
    refuse(&ManyOptions { shard: Shard::new(2, 3).unwrap(), ..whole() }, "shard 1/1, not 2/3");
    refuse(&ManyOptions { times: true, ..whole() }, "without --times, not with --times");
    refuse(&ManyOptions { time_s: Some(5.0), ..whole() }, "no --time, not --time 5");
    // Another byte of a mesh, and of the list.
    dir.write("wall.off", WALL.replace("0.1 -1 -1", "0.2 -1 -1"));
    refuse(&whole(), "another scene wall: a file has changed");
    dir.write("wall.off", WALL);
    dir.write("problems.jsonl", LIST.replace("20000", "20001"));
    refuse(&whole(), "the list has changed");
    dir.write("problems.jsonl", LIST);
    let other =
        half.replacen(&format!("\"program\":\"{}\"", env!("CARGO_PKG_VERSION")), "\"program\":\"9.9.9\"", 1);
    dir.write("r.jsonl", &other);
    assert!(dir.run("r.jsonl", &whole()).unwrap_err().message().contains("version 9.9.9 of the program"));
    dir.write("r.jsonl", half.replacen("\"version\":1", "\"version\":2", 1));
    assert!(dir.run("r.jsonl", &whole()).unwrap_err().message().contains("version 2 of results"));
    for text in ["hello\n", "hello", "{}\n", "\n", "{\"format\":\"mp-many\"}\n"] {
        dir.write("r.jsonl", text);
        let e = dir.run("r.jsonl", &whole()).unwrap_err();
        assert!(e.message().contains("is no file of results"), "{e}");
        assert_eq!(dir.read("r.jsonl"), text);
    }
}

#[test]
fn one_process_at_a_time_writes_results() {
    let dir = Dir::new();
    let _lock = mp_store::Lock::of_file(&dir.at("r.jsonl")).unwrap();
    assert!(dir.run("r.jsonl", &whole()).unwrap_err().to_string().contains("in use"));
    assert!(!dir.at("r.jsonl").exists());
}
