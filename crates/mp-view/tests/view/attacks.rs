//! Whatever a page says, its session writes into its folder only, and reads no file at all.

use mp_view::{Opening, Session};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// A message: docs/formats/session.md.
fn message(mut head: Value, file: Option<(&str, &[u8])>) -> Vec<u8> {
    let data = file.map_or(&[][..], |(_, bytes)| bytes);
    if let Some((name, bytes)) = file {
        head["files"] = json!([{"name": name, "bytes": {"type": "u8", "offset": 0, "count": bytes.len()}}]);
    }
    let mut head = head.to_string().into_bytes();
    head.resize(head.len().next_multiple_of(8), b' ');
    [b"MPV1".as_slice(), &u32::try_from(head.len()).unwrap().to_le_bytes(), &head, data].concat()
}

/// The head of the reply to a request.
fn reply(session: &Session, head: Value, file: Option<(&str, &[u8])>) -> Map<String, Value> {
    let reply = session.handle(&message(head, file));
    let length = usize::try_from(u32::from_le_bytes(reply[4..8].try_into().unwrap())).unwrap();
    serde_json::from_slice(&reply[8..8 + length]).unwrap()
}

/// The head of a reply that is no error.
fn asked(session: &Session, head: Value) -> Map<String, Value> {
    let reply = reply(session, head, None);
    assert!(!reply.contains_key("error"), "{reply:?}");
    reply
}

fn session(folder: &Path) -> Session {
    let session = Session::new(Opening { folder: Some(folder.into()), ..Opening::default() }, || {});
    asked(&session, json!({"do": "edit", "document": document()}));
    session
}

fn document() -> Value {
    json!({
        "version": 1, "name": "built", "space": "SE3", "bounds": [[-4, -4, -4], [4, 4, 4]],
        "robot": {"name": "stick", "shape": {"cube": {"size": [0.5, 0.1, 0.1]}}},
        "start": [-3, 0, 0, 0, 0, 0], "goal": [3, 0, 0, 0.5, 0, 0],
        "obstacles": [
            {"name": "ball", "shape": {"sphere": {"radius": 0.7}}, "pose": [0, 0, 0, 0, 0, 0]},
            {"name": "ring", "shape": {"torus": {"ring": 1, "tube": 0.2}}, "pose": [1, 0, 0, 0, 0.3, 0]},
        ],
    })
}

/// All files below a folder, with their content; links as where they lead.
fn tree(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.to_string_lossy().into_owned();
        match (path.is_symlink(), path.is_dir()) {
            (true, _) => drop(
                all.insert(name, std::fs::read_link(&path).unwrap().to_string_lossy().into_owned().into()),
            ),
            (_, true) => {
                all.insert(name, b"a folder".to_vec());
                all.extend(tree(&path));
            }
            _ => drop(all.insert(name, std::fs::read(&path).unwrap())),
        }
    }
    all
}

/// Twenty-seven texts that would lead elsewhere, in the place of every name and format of every request that writes, with and without
/// leave to overwrite.
#[test]
fn nothing_is_written_outside_of_the_folder() {
    let home = tempfile::tempdir().unwrap();
    let at = |name: &str| home.path().join(name);
    std::fs::create_dir_all(at("folder/below")).unwrap();
    for victim in ["victim.txt", "victim.mp.json", "victim.env", "victim.html", "folder/below/victim.txt"] {
        std::fs::write(at(victim), "precious").unwrap();
    }
    let endings = ["txt", "json", "csv", "mp.json", "env", "html", "mpv"];
    #[cfg(unix)]
    {
        for ending in endings {
            std::os::unix::fs::symlink(at("victim.txt"), at("folder").join(format!("link.{ending}")))
                .unwrap();
            std::os::unix::fs::symlink(at("missing"), at("folder").join(format!("dangling.{ending}")))
                .unwrap();
        }
        std::os::unix::fs::symlink(home.path(), at("folder/up")).unwrap();
    }
    let before = tree(home.path());
    let page = session(&at("folder"));

    let absolute = at("victim").to_string_lossy().into_owned();
    let long = "a/".repeat(200) + &"x".repeat(300);
    let attacks: [&str; 27] = [
        "../victim",
        "x/../../victim.txt",
        "below/../../victim",
        "below/victim",
        "./../victim",
        &absolute,
        "/",
        "..",
        ".",
        "up/victim",
        "..\\victim",
        "below\\..\\..\\victim.txt",
        "\\\\?\\C:\\victim",
        "C:victim",
        "victim.txt:stream",
        "%2e%2e%2fvictim",
        "..%c0%afvictim",
        "\u{ff0e}\u{ff0e}\u{ff0f}victim",
        "..\u{2215}victim",
        "victim\0.txt",
        "victim\n../victim",
        "\u{202e}txt.victim",
        "~/victim",
        "CON",
        "lpt1.txt",
        &long,
        "victim . ",
    ];
    // The requests that write, with the formats that they know.
    let rows = [[-3.0, 0.0, 0.0, 0.0, 0.0, 0.0], [-3.1, 0.0, 0.0, 0.0, 0.0, 0.0]];
    let verbs: [(Value, &[&str]); 3] = [
        (json!({"do": "save", "document": document()}), &["own", "gempa"]),
        (json!({"do": "save_path", "rows": rows}), &["txt", "json", "csv"]),
        (json!({"do": "export", "paths": [{"name": "one", "rows": rows}]}), &["html", "mpv"]),
    ];
    let mut refused = 0;
    for (attack, (request, formats)) in
        attacks.iter().flat_map(|attack| verbs.iter().map(move |verb| (attack, verb)))
    {
        let mut tried = |name: &str, format: &str, overwrite: bool| {
            let mut request = request.clone();
            (request["name"], request["format"], request["overwrite"]) =
                (json!(name), json!(format), json!(overwrite));
            let reply = reply(&page, request, None);
            assert!(reply["error"]["message"].is_string(), "{name:?} {format:?}: {reply:?}");
            assert!(!reply.contains_key("written"), "{reply:?}");
            refused += 1;
        };
        for overwrite in [false, true] {
            for format in *formats {
                tried(attack, format, overwrite);
                // An attack behind a good name, and behind a good format.
                tried(&format!("a{attack}"), "nothing", overwrite);
                tried("a", &format!("{format}/{attack}"), overwrite);
                tried("link", format, true);
                tried("dangling", format, overwrite);
            }
            tried("a", attack, overwrite);
        }
    }
    assert!(refused >= 27 * 2 * (7 + 3), "{refused}");
    assert_eq!(tree(home.path()), before, "nothing has changed");

    // Names within documents: of bodies, of scenes and of meshes. What is written then has names of its own.
    let mesh = b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    for (number, attack) in attacks.iter().enumerate() {
        let opened = reply(&page, json!({"do": "mesh"}), Some((attack, mesh)));
        // What is no name of a mesh file is refused; others are kept in memory.
        let file = opened.get("file").and_then(Value::as_str).unwrap_or("none").to_owned();
        let mut changed = document();
        (changed["name"], changed["robot"]["name"]) = (json!(attack), json!(attack));
        changed["obstacles"][0]["name"] = json!(attack);
        if file != "none" {
            changed["obstacles"][1]["shape"] = json!({"mesh": {"file": file}});
        }
        for format in ["own", "gempa"] {
            let name = format!("s{number}");
            let saved =
                asked(&page, json!({"do": "save", "document": changed, "format": format, "name": name}));
            for written in saved["written"].as_array().unwrap() {
                let written = written.as_str().unwrap();
                assert!(written.starts_with(&name) && mp_store::check_name(written).is_ok(), "{written}");
                assert!(at("folder").join(written).is_file());
            }
        }
        // Nothing is read from the disk either.
        let scene = json!({"do": "open", "scene": attack});
        assert!(reply(&page, scene, None).contains_key("error"));
        let environment = format!("Robot\n{attack}\n0 0 0 0 0 0\n1 0 0 0 0 0\nEnd\n");
        let named = reply(&page, json!({"do": "open"}), Some(("a.env", environment.as_bytes())));
        assert!(named.contains_key("error"), "{named:?}");
    }
    let after = tree(home.path());
    let outside: Vec<&String> = after.keys().filter(|name| !before.contains_key(*name)).collect();
    let folder = at("folder").join("s").to_string_lossy().into_owned();
    assert!(outside.len() > 27 * 4 && outside.iter().all(|name| name.starts_with(&folder)), "{outside:?}");
    assert!(before.iter().all(|(name, content)| after[name] == *content));

    // Good names and formats go on to work.
    for (request, formats) in &verbs {
        for format in *formats {
            let mut request = request.clone();
            (request["name"], request["format"]) = (json!("Gärten 2 (neu)"), json!(format));
            assert!(asked(&page, request)["written"].as_array().is_some_and(|names| !names.is_empty()));
        }
    }
}

/// A scene of several files, one of which cannot be written: the scene that was there is as it was, with its meshes.
#[test]
fn a_scene_that_cannot_be_saved_whole_is_not_saved_at_all() {
    let dir = tempfile::tempdir().unwrap();
    let page = session(dir.path());
    let save = |document: &Value| json!({"do": "save", "document": document, "format": "gempa", "name": "room", "overwrite": true});
    let written = asked(&page, save(&document()))["written"].clone();
    assert_eq!(written, json!(["room.env", "room_stick.txt", "room_ball.txt", "room_ring.txt"]));
    let before = tree(dir.path());
    let mut changed = document();
    changed["robot"]["shape"]["cube"]["size"] = json!([0.25, 0.25, 0.25]);
    changed["obstacles"][0]["name"] = "bowl".into();
    std::fs::create_dir(dir.path().join("room_bowl.txt")).unwrap();
    let reply = reply(&page, save(&changed), None);
    assert!(reply["error"]["message"].as_str().unwrap().contains("this is a folder"), "{reply:?}");
    std::fs::remove_dir(dir.path().join("room_bowl.txt")).unwrap();
    assert_eq!(tree(dir.path()), before);
    asked(&page, save(&changed));
    assert_ne!(tree(dir.path()), before);
}
