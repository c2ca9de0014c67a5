//! Shards: merged they are the whole, or are refused.

use crate::{Dir, LIST, WALL, whole};
use mp_batch::{ManyOptions, Shard};
use mp_plan::Cancel;

#[test]
fn merged_shards_are_the_whole() {
    let dir = Dir::new();
    let all = dir.shard("all.jsonl", "1/1").tally;
    for n in [1, 2, 3, 5, 20] {
        let mut names: Vec<String> = (1..=n).map(|i| format!("{i}-{n}.jsonl")).collect();
        let items: Vec<u64> =
            (1..=n).map(|i| dir.shard(&names[i - 1], &format!("{i}/{n}")).tally.items).collect();
        assert_eq!(items.iter().sum::<u64>(), 14, "{items:?}");
        for turn in 0..n.min(5) {
            names.rotate_left(1);
            if turn == 1 {
                names.reverse();
            }
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            assert_eq!(dir.merge("merged.jsonl", &names).unwrap(), all);
            assert!(dir.read("merged.jsonl") == dir.read("all.jsonl"), "{names:?}");
        }
    }
}

#[test]
fn shards_that_are_not_a_whole_are_refused() {
    let dir = Dir::new();
    for i in 1..=3 {
        dir.shard(&format!("{i}.jsonl"), &format!("{i}/3"));
    }
    dir.write("out.jsonl", "before");
    let refuse = |names: &[&str], words: &[&str]| {
        let e = dir.merge("out.jsonl", names).unwrap_err();
        let report = e.report();
        assert!(words.iter().all(|word| report.contains(word)), "{words:?}: {report}");
        assert_eq!(dir.read("out.jsonl"), "before");
    };
    let make = |shard: &str, file: &str| format!("mp many problems.jsonl --out {file} --shard {shard}");
    let at = |name: &str| dir.at(name).display().to_string();
    let again = |i: u32| make(&format!("{i}/3"), &at(&format!("{i}.jsonl")));

    refuse(&[], &["no shard"]);
    refuse(&["1.jsonl", "3.jsonl"], &["shard 2/3 is missing", &make("2/3", "shard-2-of-3.jsonl")]);
    refuse(&["1.jsonl", "2.jsonl", "3.jsonl", "2.jsonl"], &["shard 2/3 is there twice", "leave one out"]);
    std::fs::copy(dir.at("2.jsonl"), dir.at("copy.jsonl")).unwrap();
    let twice = ["shard 2/3 is there twice", "2.jsonl", "copy.jsonl", &make("3/3", "shard-3-of-3.jsonl")];
    refuse(&["2.jsonl", "1.jsonl", "copy.jsonl"], &twice);

    let good = dir.read("2.jsonl");
    let lines: Vec<&str> = good.lines().collect();
    assert_eq!(lines.len(), 1 + 5 + 1);
    let all = ["1.jsonl", "2.jsonl", "3.jsonl"];
    let damaged = |text: &str, words: &[&str]| {
        dir.write("2.jsonl", text);
        refuse(&all, &[words, &["2.jsonl", &again(2)]].concat());
    };
    // Cut off: within a line, after one, before the end.
    let incomplete = |text: &str, items: &str| damaged(text, &["not complete", items, "go on with it"]);
    incomplete(&good[..good.len() - 1], "it has 5 of 5 items");
    incomplete(&format!("{}\n", lines[..6].join("\n")), "5 of 5 items");
    incomplete(&lines[..3].join("\n"), "1 of 5 items");
    incomplete(&format!("{}\n", lines[0]), "0 of 5 items");
    // Items that the header does not say.
    let with = |lines: &[&str]| lines.join("\n") + "\n";
    let without = with(&[&lines[..2], &lines[3..]].concat());
    damaged(&without, &["line 3", "item 7, and that of shard 2/3 is 4", "delete it"]);
    damaged(&with(&[&lines[..2], &lines[1..]].concat()), &["line 3: it is of item 1"]);
    damaged(&with(&[&lines[..5], &lines[6..]].concat()), &["line 6: the end, after 4 of 5 items"]);
    damaged(&good.replacen("\"solved\":", "\"sol\":", 1), &["line 2", "missing field `solved`"]);
    damaged(&good.replacen("\"report\":", "\"error\":", 1), &["line 2"]);
    damaged(&good.replacen("{\"item\":1,", "[\"item\":1,", 1), &["line 2", "column"]);
    damaged(
        &good.replacen("\"scene_file\":\"", "\"scene_file\":\"x", 1),
        &["line 2", "not one of the header"],
    );
    // The end.
    damaged(&good.replacen("\"end\":{\"items\":5", "\"end\":{\"items\":6", 1), &["line 7", "counts"]);
    damaged(&good.replacen("\"iterations\":", "\"iterations\":1", 1), &["line 7", "checksum", "some byte"]);
    damaged(&format!("{good}\n"), &["behind the end"]);
    damaged(&format!("{good}{}\n", lines[1]), &["behind the end"]);
    // The header of another shard.
    dir.write("2.jsonl", good.replacen("2/3", "1/3", 1));
    refuse(&all, &["shard 1/3 is there twice", &make("2/3", "shard-2-of-3.jsonl")]);
    refuse(&["2.jsonl", "3.jsonl"], &["shard 2/3 is missing"]);
    dir.write("2.jsonl", good.replacen("\"items\":14", "\"items\":15", 1));
    refuse(&all, &["does not fit", "the list has changed"]);
    dir.write("2.jsonl", good.replacen("\"items\":14", "\"items\":18446744073709551615", 1));
    refuse(&all, &["2^30 items"]);

    // Of other things.
    let other = |options: &ManyOptions, words: &[&str]| {
        std::fs::remove_file(dir.at("2.jsonl")).unwrap();
        dir.run("2.jsonl", options).unwrap();
        refuse(&all, &[words, &["2.jsonl does not fit to", "1.jsonl", "delete it", &again(2)]].concat());
    };
    let second = ManyOptions { shard: Shard::new(2, 3).unwrap(), ..whole() };
    other(&ManyOptions { shard: Shard::new(2, 4).unwrap(), ..whole() }, &["it is of 4 shards, not 3"]);
    other(&ManyOptions { times: true, ..second.clone() }, &["with --times, not without"]);
    other(&ManyOptions { time_s: Some(9.0), ..second.clone() }, &["--time 9, not no --time"]);
    dir.write("wall.off", WALL.replace("0.1 -1 -1", "0.2 -1 -1"));
    other(&second, &["another scene wall"]);
    dir.write("wall.off", WALL);
    dir.write("problems.jsonl", LIST.replace("20000", "20001"));
    other(&second, &["the list has changed"]);
    dir.write("problems.jsonl", LIST);
    let version = format!("\"program\":\"{}\"", env!("CARGO_PKG_VERSION"));
    dir.write("2.jsonl", good.replacen(&version, "\"program\":\"9.9.9\"", 1));
    refuse(&all, &["version 9.9.9 of the program", &again(2)]);
    dir.write("2.jsonl", "0 0 0\n");
    refuse(&all, &["2.jsonl is no file of results"]);
    std::fs::remove_file(dir.at("2.jsonl")).unwrap();
    refuse(&all, &["no such file"]);
}

/// A checksum covers every byte.
#[test]
fn no_byte_of_a_shard_can_change_unseen() {
    let dir = Dir::new();
    dir.write(
        "problems.jsonl",
        "{\"scene\": \"easy\", \"seeds\": [1, 2]}\n{\"scene\": \"easy\", \"goal\": [0]}",
    );
    dir.shard("r.jsonl", "1/1");
    let good = std::fs::read(dir.at("r.jsonl")).unwrap();
    assert!(dir.merge("out.jsonl", &["r.jsonl"]).is_ok());
    let problems = dir.problems();
    for at in (0..good.len()).step_by(37).chain(good.len() - 200..good.len()) {
        for bit in [0, 5, 7] {
            let mut bad = good.clone();
            bad[at] ^= 1 << bit;
            dir.write("bad.jsonl", &bad);
            let refused = dir.merge("out.jsonl", &["bad.jsonl"]);
            assert!(refused.is_err(), "bit {bit} of byte {at}");
            // Going on is refused, or comes to an end that is refused; it never panics.
            let _ = problems.run(&dir.at("bad.jsonl"), &whole(), &Cancel::new(), |_| ());
        }
    }
    assert_eq!(std::fs::read(dir.at("out.jsonl")).unwrap(), good);
}

/// A joint with limits that mean none goes so far to each side of the start: an item after another one has the limits of its own start.
#[test]
fn limits_about_the_start_are_those_of_each_item() {
    let dir = Dir::new();
    let urdf = r#"<robot name="r"><link name="base"/><link name="a"><collision><geometry><box size="0.8 0.1 0.1"/></geometry></collision></link>
        <joint name="x" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/><limit lower="-1e8" upper="1e8"/></joint></robot>"#;
    dir.write("r.urdf", urdf);
    for start in [0, 50_000] {
        let goal = start + 10;
        let scene = format!("[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [{start}]\ngoal = [{goal}]\n");
        dir.write(&format!("s{start}.toml"), scene);
    }
    dir.write("problems.jsonl", "{\"scene\": \"s0.toml\"}\n{\"scene\": \"s50000.toml\"}\n");
    dir.run("all.jsonl", &whole()).unwrap();
    assert_eq!(dir.items("all.jsonl", false).0, [(0, true), (1, true)], "{}", dir.read("all.jsonl"));
    for (shard, out) in [("1/2", "1.jsonl"), ("2/2", "2.jsonl")] {
        dir.shard(out, shard);
    }
    dir.merge("merged.jsonl", &["1.jsonl", "2.jsonl"]).unwrap();
    assert_eq!(dir.read("merged.jsonl"), dir.read("all.jsonl"));
}
