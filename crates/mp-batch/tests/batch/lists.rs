//! Lists that are refused before anything runs.

use crate::{Dir, SCENE};
use mp_batch::ProblemList;
use mp_plan::{Error, Interrupt};
use std::path::Path;

/// The error of a list with this line after a good one.
fn refused_line(line: &str) -> Error {
    let text = format!("{{\"scene\": \"easy\"}}\n\n{line}\n");
    ProblemList::parse("p.jsonl", text.as_bytes()).unwrap_err()
}

#[test]
fn lists_that_are_not_valid_are_refused_with_their_line() {
    for (line, words) in [
        ("{", "EOF"),
        ("[]", "invalid"),
        ("{}", "missing field `scene`"),
        (r#"{"scene": ""}"#, "no name"),
        (r#"{"scene": 5}"#, "expected a string"),
        (r#"{"scene": "easy", "scene": "maze"}"#, "duplicate field"),
        (r#"{"scene": "easy", "goals": [[0]], "goal": [0]}"#, "both `goal` and `goals`"),
        (r#"{"scene": "easy", "start": [1e999]}"#, "out of range"),
        (r#"{"scene": "easy", "seeds": []}"#, "no seed"),
        (r#"{"scene": "easy", "seeds": {"from": 1, "count": 0}}"#, "no seed"),
        (r#"{"scene": "easy", "seeds": {"from": 1}}"#, "expected seeds as a list"),
        (r#"{"scene": "easy", "seeds": [-1]}"#, "expected seeds as a list"),
        (r#"{"scene": "easy", "seeds": {"from": 18446744073709551615, "count": 2}}"#, "too large"),
        (r#"{"scene": "easy", "seeds": {"from": 0, "count": 1073741824}}"#, "more than 2^30 items"),
        (r#"{"scene": "easy", "seeds": {"from": 0, "count": 18446744073709551615}}"#, "2^30 items"),
        (r#"{"scene": "easy", "seeds": [1], "request": {"seed": 1}}"#, "both `seeds` and a `seed`"),
        (r#"{"scene": "easy", "request": {"speed": 1}}"#, "unknown field `speed`"),
        (r#"{"scene": "easy", "request": {"roadmap": "map"}}"#, "no roadmap"),
        (r#"{"scene": "easy", "request": {"finish": "relax", "field": "image:a.png"}}"#, "no image"),
        (
            r#"{"scene": "easy", "request": {"planner": "rrs", "settings": {"field": "image:a.png"}}}"#,
            "no image",
        ),
        (r#"{"scene": "easy", "sede": 1}"#, "unknown field `sede`"),
    ] {
        let e = refused_line(line);
        let file = e.file().unwrap();
        assert!(file.message().contains(words), "{line}: {e}");
        assert!(
            file.line() == Some(3) && file.remedy().is_some() && e.to_string().starts_with("p.jsonl:3:"),
            "{e}"
        );
    }
    let e = ProblemList::parse("p.jsonl", b"{\"scene\": \"easy\"}\n\xff\n").unwrap_err();
    assert!(e.to_string().contains("line 2"), "{e}");
    assert!(ProblemList::parse("p.jsonl", b" \n\n").unwrap_err().to_string().contains("no problem"));
    assert_eq!(ProblemList::parse("p", b"\xef\xbb\xbf{\"scene\":\"easy\"}\r\n").unwrap().items(), 1);
    assert!(ProblemList::load("no-such-file").is_err());
}

#[test]
fn scenes_that_are_not_there_are_refused_with_their_line() {
    let dir = Dir::new();
    for (scene, words) in [("wal", "wall"), ("../easy", "")] {
        dir.write("problems.jsonl", format!("{{\"scene\": \"easy\"}}\n{{\"scene\": \"{scene}\"}}\n"));
        let list = ProblemList::load(dir.at("problems.jsonl")).unwrap();
        let report = list.with_scenes(&Interrupt::never()).unwrap_err().report();
        assert!(report.contains("problems.jsonl, line 2") && report.contains(words), "{report}");
    }
    // A file of the folder of the list comes before a shipped scene.
    dir.write("easy.env", SCENE);
    dir.write("problems.jsonl", "{\"scene\": \"easy\"}");
    assert_eq!(dir.problems().problem(0, None).unwrap().0.file(), Some(Path::new("easy.env")));
}
