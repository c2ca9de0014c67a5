use super::*;
use crate::SceneFile;
use mp_cspace::Clock;
use mp_plan::Scene;
use serde_json::{Value, json};
use std::sync::mpsc;
use std::time::Duration;

/// A page: sends requests, reads replies, waits for events.
struct Page {
    session: Session,
    woken: mpsc::Receiver<()>,
}

impl Page {
    fn new(opening: Opening) -> Self {
        let (wake, woken) = mpsc::channel();
        Self { session: Session::new(opening, move || wake.send(()).unwrap_or(())), woken }
    }

    fn reply(&self, request: Message) -> Message {
        Message::parse(&self.session.handle(&request.to_bytes())).unwrap()
    }

    fn ask(&self, request: Value) -> Message {
        let reply = self.reply(message(request));
        assert!(!reply.head.contains_key("error"), "{:?}", reply.head);
        reply
    }

    fn refused(&self, request: Value) -> String {
        self.reply(message(request)).head["error"]["message"].as_str().unwrap().to_owned()
    }

    /// The next event.
    fn event(&self) -> Message {
        loop {
            if let Some(event) = self.session.take_event() {
                return Message::parse(&event).unwrap();
            }
            self.woken.recv_timeout(Duration::from_secs(60)).expect("an event comes");
        }
    }

    /// Events until one of this kind.
    fn until(&self, kind: &str) -> Vec<Message> {
        let mut events = Vec::new();
        while events.last().is_none_or(|event: &Message| event.head["event"] != kind) {
            events.push(self.event());
        }
        events
    }
}

fn message(head: Value) -> Message {
    let Value::Object(head) = head else { panic!("a head is an object") };
    Message { head, data: Vec::new() }
}

fn with_files(mut request: Value, files: &[(&str, &[u8])]) -> Message {
    let mut message = Message::default();
    let list: Vec<_> =
        files.iter().map(|(name, bytes)| json!({"name": name, "bytes": message.array(bytes)})).collect();
    request["files"] = list.into();
    let Value::Object(head) = request else { panic!("a head is an object") };
    message.head = head;
    message
}

fn scene_of(reply: &Message) -> SceneFile {
    SceneFile::parse(&reply.bytes(&reply.head["scene"], "scene").unwrap()).unwrap()
}

fn files_of(reply: &Message) -> Vec<(String, Vec<u8>)> {
    let list = reply.head["files"].as_array().unwrap();
    let file =
        |f: &Value| (f["name"].as_str().unwrap().to_owned(), reply.bytes(&f["bytes"], "bytes").unwrap());
    list.iter().map(file).collect()
}

fn opened(name: &str) -> Page {
    Page::new(Opening { scene: Some(Scene::find(name).unwrap()), ..Opening::default() })
}

#[test]
fn says_what_there_is() {
    let reply = opened("easy").ask(json!({"do": "hello"}));
    let planners = reply.head["planners"].as_array().unwrap();
    assert_eq!(planners.len(), mp_plan::planners().count());
    assert!(planners.iter().any(|p| p["name"] == "prm" && p["family"] == "roadmap"));
    assert!(planners.iter().any(|p| p["name"] == "rsrt" && p["family"] == "tree"));
    assert!(reply.head["scenes"].as_array().unwrap().iter().any(|s| s == "cubicles"));
    let endings = reply.head["endings"].as_array().unwrap();
    let place = |ending: &str, kind: &str| endings.iter().position(|e| *e == json!([ending, kind])).unwrap();
    // A scene as the page saves it is that, beside its form for GEMPA; a text may be a mesh that a scene names.
    let scenes =
        [place(".mp.json", "scene"), place(".env", "scene"), place(".toml", "scene"), place(".txt", "text")];
    assert!(scenes.is_sorted() && scenes[3] < place(".urdf", "scene"), "{endings:?}");
    assert!(
        place(".urdf", "scene") < place(".yaml", "scene") && place(".yaml", "scene") < place(".png", "scene")
    );
    assert!(place(".stl", "mesh") > 0 && place(".csv", "path") > 0 && place(".mpv", "viewer") > 0);
    assert!(endings.iter().all(|e| e[0] != ".svg" && e[0] != ".xacro"), "{endings:?}");
    let scene = reply.bytes(&reply.head["opened"]["scene"], "scene").unwrap();
    assert_eq!(SceneFile::parse(&scene).unwrap().name, "easy");
}

#[test]
fn names_planners_for_the_robot() {
    let page = Page::new(Opening::default());
    let car = page.ask(json!({"do": "open", "scene": "parking"})).head;
    assert_eq!(car["planner"], "rsrt");
    let cannot = car["cannot"].as_array().unwrap();
    let why = cannot.iter().find(|pair| pair[0] == "rrt-connect").map(|pair| pair[1].as_str().unwrap());
    assert!(why.is_some_and(|why| why.len() > 10), "{why:?}");
    assert!(cannot.iter().all(|pair| pair[0] != "rsrt"));
    let rigid = page.ask(json!({"do": "open", "scene": "easy"})).head;
    assert_eq!((&rigid["planner"], &rigid["cannot"]), (&json!("auto"), &json!([])));
}

#[test]
fn explains_configurations() {
    let page = Page::new(Opening::default());
    assert!(page.refused(json!({"do": "check", "row": [0.0]})).contains("no scene is open"));
    let opened = page.ask(json!({"do": "open", "scene": "easy"}));
    let file = scene_of(&opened);
    let free = page.ask(json!({"do": "check", "row": file.start.row}));
    assert_eq!(free.head["free"], true);
    assert_eq!(free.head["poses"].as_array().unwrap().len(), file.start.poses.len());
    let robots = file.bodies.iter().filter(|b| b.pose.is_none()).count();
    let inside = &file.bodies[robots].pose.unwrap();
    let mut row = file.start.row.clone();
    row[..3].copy_from_slice(&inside[..3]);
    let touching = page.ask(json!({"do": "check", "row": row}));
    assert_eq!(touching.head["free"], false);
    assert!(!touching.head["touching"].as_array().unwrap().is_empty() || touching.head["in_bounds"] == false);
    assert!(page.refused(json!({"do": "check", "row": [1, 2]})).contains("finite numbers"));
    let half = json!({"do": "plan", "run": 1, "request": {"seed": 0.5, "planner": "rrt"}});
    assert!(page.refused(half).contains("`seed`: invalid type: floating point"));
}

/// Of a configuration out of bounds the nearest free one within them is offered.
#[test]
fn out_of_bounds_there_is_a_place_within() {
    for name in ["easy", "arm", "rrs-low", "parking", "warehouse", "crossing"] {
        let page = opened(name);
        let file = SceneFile::of(&Scene::find(name).unwrap()).unwrap();
        let row: Vec<f64> = file.goals[0].row.iter().map(|number| number + 1000.0).collect();
        let outside = page.ask(json!({"do": "check", "row": row}));
        assert_eq!(outside.head["in_bounds"], false, "{name}");
        let within = page.ask(json!({"do": "check", "row": outside.head["nearest_free"]}));
        assert_eq!(within.head["free"], true, "{name}: {:?}", outside.head);
    }
}

/// What is wrong with start and goals is told apart from what is only odd.
#[test]
fn what_must_be_changed_is_a_warning() {
    let page = opened("easy");
    let mut document = document();
    let obstacles = document["obstacles"].take();
    document["obstacles"] = json!([]);
    let odd = page.ask(json!({"do": "edit", "document": document}));
    assert_eq!((&odd.head["warnings"], &odd.head["notes"]), (&json!([]), &json!(["there are no obstacles"])));
    document["obstacles"] = obstacles;
    document["goal"] = json!([0, 0, 0, 0, 0, 0]);
    let wrong = page.ask(json!({"do": "edit", "document": document}));
    assert!(wrong.head["warnings"].to_string().contains("the goal is"), "{:?}", wrong.head);
}

/// The body of an arm reaches a place; the path of a motion's part leads to the next part.
#[test]
fn bodies_of_arms_reach_places_and_motions_have_parts() {
    let page = Page::new(Opening::default());
    let opened = page.ask(json!({"do": "open", "scene": "carry"}));
    assert_eq!(opened.head["links"], true);
    let left = opened.head["parts_left"].as_u64().unwrap();
    let (start, goal) = (scene_of(&opened).start, scene_of(&opened).goals.remove(0));
    let body = start.poses.len() / 7 - 1;
    let last = |poses: &[f64]| poses[7 * body..].to_vec();
    // Four centimetres to the side.
    let mut pose = last(&start.poses);
    pose[1] += 0.04;
    let reached = page.ask(json!({"do": "reach", "row": start.row, "body": body, "pose": pose})).head;
    let poses: Vec<f64> = serde_json::from_value(reached["poses"].clone()).unwrap();
    assert!(last(&poses).iter().zip(&pose).all(|(a, b)| (a - b).abs() < 1e-6), "{poses:?} {pose:?}");
    assert_ne!(reached["row"], json!(start.row));
    pose[0] += 100.0;
    let far = page.ask(json!({"do": "reach", "row": start.row, "body": body, "pose": pose})).head;
    assert!(far["row"].is_null(), "{far:?}");
    assert!(
        page.refused(json!({"do": "reach", "row": start.row, "body": 0, "pose": [0, 0, 0, 0, 0, 0, 0]}))
            .contains("pose")
    );

    let next = page.ask(json!({"do": "next", "row": goal.row}));
    assert_eq!(next.head["parts_left"], left - 1);
    assert_eq!(scene_of(&next).start.row, goal.row);
    page.ask(json!({"do": "open", "scene": "easy"}));
    assert!(page.refused(json!({"do": "next", "row": [0, 0, 0, 0, 0, 0]})).contains("last part"));
}

/// The events of a run give the tree of its report, and the result is that of planning without a session.
#[test]
fn plans_as_the_library_does() {
    for (scene, planner) in [("easy", "rrt-connect"), ("rrs-low", "prm"), ("arm", "rrt-connect")] {
        let page = opened(scene);
        let request = mp_plan::Request::new(planner).seed(4).iterations(20_000);
        let asked = json!({"do": "plan", "run": 7, "request": request});
        page.ask(asked);
        let events = page.until("done");
        let done = events.last().unwrap();
        assert_eq!(done.head["run"], 7);
        let mut alone = Scene::find(scene).unwrap().plan(&request).unwrap();
        let report: mp_plan::Report = serde_json::from_value(done.head["report"].clone()).unwrap();
        (alone.time_s, alone.finish_s, alone.first_s) = (report.time_s, report.finish_s, report.first_s);
        // A session has loaded the scene before.
        assert_eq!(alone.stages.len(), report.stages.len() + 1);
        alone.stages.clone_from(&report.stages);
        assert_eq!(report, alone);
        assert!(report.solved && done.head["path"]["verified"] == true);
        let grown = events.iter().filter(|e| e.head["event"] == "grown");
        let count = |value: &Value| value["count"].as_u64().unwrap() as usize / 3;
        let nodes: usize = grown
            .map(|e| {
                let trees: usize =
                    e.head["trees"].as_array().unwrap().iter().map(|t| count(&t["nodes"])).sum();
                trees + e.head["roadmap"].as_object().map_or(0, |map| count(&map["nodes"]))
            })
            .sum();
        assert_eq!(nodes, report.nodes, "{scene} {planner}");
    }
}

fn numbers_of<T: crate::arrays::Entry>(event: &Message, array: &Value) -> Vec<T> {
    let array: crate::arrays::ArrayRef = serde_json::from_value(array.clone()).unwrap();
    crate::arrays::extract(&event.data, &array, "array").unwrap()
}

fn file_of_run(scene: &Scene, request: &mp_plan::Request) -> SceneFile {
    let mut grown = crate::GrownTrees::new(scene, request);
    scene.plan_with(request, &mut mp_plan::Control::new(mp_cspace::Cancel::default(), &mut grown)).unwrap();
    let mut file = SceneFile::of(scene).unwrap();
    grown.add_to(&mut file);
    file
}

/// Edges that snakes bend are drawn as they are: in a world of the plane the drawn points are the configurations, so the whole path
/// as found is made of edges of the events.
#[test]
fn events_have_bent_edges() {
    for planner in ["rrs", "rrs-connect"] {
        let page = opened("rrs-high");
        let request = json!({"planner": planner, "seed": 2, "finish": "as-found", "settings": {"step": "1"}});
        page.ask(json!({"do": "plan", "run": 1, "request": request}));
        let events = page.until("done");
        let (mut bent, mut lines) = (0, Vec::new());
        let mut nodes = vec![Vec::<[f32; 3]>::new(); 2];
        for event in events.iter().filter(|e| e.head["event"] == "grown") {
            for tree in event.head["trees"].as_array().unwrap() {
                let own = &mut nodes[tree["tree"].as_u64().unwrap() as usize];
                let from = own.len();
                own.extend(numbers_of::<f32>(event, &tree["nodes"]).as_chunks::<3>().0);
                let bends: Vec<u32> = numbers_of(event, &tree["bent"]);
                let through: Vec<f32> = numbers_of(event, &tree["through"]);
                let (mut through, mut bends) = (through.as_chunks::<3>().0.iter(), bends.into_iter());
                let mut next = bends.next();
                for (id, &parent) in (from..).zip(&numbers_of::<i32>(event, &tree["parents"])) {
                    let Ok(parent) = usize::try_from(parent) else { continue };
                    let mut line = vec![own[parent]];
                    if next == Some(id as u32) {
                        line.extend(through.by_ref().take(bends.next().unwrap() as usize));
                        (bent, next) = (bent + 1, bends.next());
                    }
                    line.push(own[id]);
                    lines.push(line);
                }
                assert!(next.is_none() && through.next().is_none());
            }
        }
        assert!(bent > 5, "{planner}: {bent} edges bend");
        // A file of the same run has them too.
        let (scene, request) = (Scene::find("rrs-high").unwrap(), serde_json::from_value(request).unwrap());
        let file = file_of_run(&scene, &request);
        assert_eq!(file.trees.iter().map(|tree| tree.bends.nodes.len() / 2).sum::<usize>(), bent);
        assert_eq!(SceneFile::parse(&file.to_bytes()).unwrap(), file);
        let done = events.last().unwrap();
        let path: Vec<Vec<f64>> = serde_json::from_value(done.head["report"]["path"].clone()).unwrap();
        let near = |p: &[f32; 3], q: &[f64]| (0..2).all(|k| (f64::from(p[k]) - q[k]).abs() < 1e-5);
        let pieces: Vec<_> = lines.iter().flat_map(|line| line.windows(2)).collect();
        for ends in path.windows(2) {
            let is =
                |a: &[f64], b: &[f64]| pieces.iter().any(|piece| near(&piece[0], a) && near(&piece[1], b));
            assert!(
                is(&ends[0], &ends[1]) || is(&ends[1], &ends[0]),
                "{planner}: {ends:?} is no piece of an edge"
            );
        }
    }
}

/// Events say what the milestones are, as the roadmap of the run says at its end.
#[test]
fn events_have_kinds_of_milestones() {
    let page = opened("rrs-low");
    let request = mp_plan::Request::new("visibility-prm").seed(4).iterations(20_000);
    page.ask(json!({"do": "plan", "run": 1, "request": request}));
    let mut kinds = Vec::<u8>::new();
    for event in page.until("done").iter().filter(|e| e.head.get("roadmap").is_some_and(Value::is_object)) {
        kinds.extend(numbers_of::<u8>(event, &event.head["roadmap"]["kind"]));
    }
    let scene = Scene::find("rrs-low").unwrap();
    let file = file_of_run(&scene, &request);
    assert_eq!(kinds, file.roadmap.unwrap().kind);
    for kind in [1, 2] {
        assert!(kinds.contains(&kind), "{kind}");
    }
}

/// Edges of a lazy roadmap that turn out to be blocked are taken away: what is left is the roadmap of the run at its end.
#[test]
fn events_take_blocked_edges_away() {
    let page = opened("rrs-high");
    let request = mp_plan::Request::new("lazy-prm").seed(4).iterations(20_000);
    page.ask(json!({"do": "plan", "run": 1, "request": request}));
    let (mut edges, mut gone) = (Vec::<[u32; 2]>::new(), 0);
    for event in page.until("done").iter().filter(|e| e.head.get("roadmap").is_some_and(Value::is_object)) {
        let map = &event.head["roadmap"];
        edges.extend(numbers_of::<u32>(event, &map["edges"]).as_chunks::<2>().0);
        for ends in numbers_of::<u32>(event, &map["unlinked"]).as_chunks::<2>().0 {
            edges.remove(edges.iter().position(|edge| edge == ends).expect("the page has this edge"));
            gone += 1;
        }
    }
    assert!(gone > 10, "{gone}");
    let scene = Scene::find("rrs-high").unwrap();
    let file = file_of_run(&scene, &request);
    let mut kept: Vec<_> = file.roadmap.unwrap().edges.as_chunks::<2>().0.to_vec();
    kept.sort_unstable();
    edges.sort_unstable();
    assert_eq!(edges, kept);
}

/// The path as found is told before it is finished, and a session checks it: a page that loses its planner keeps the path.
#[test]
fn paths_as_found_are_told_and_checked() {
    for scene in ["easy", "arm", "rrs-low"] {
        let mut worker = Worker::new(Clock::default());
        let mut ask = |request: Value| {
            worker.send(&message(request).to_bytes());
            Message::parse(&worker.take().unwrap()).unwrap()
        };
        ask(json!({"do": "open", "scene": scene}));
        let request = mp_plan::Request::new("rrt-connect").seed(5).iterations(100_000);
        assert!(ask(json!({"do": "plan", "run": 1, "request": request})).head.is_empty());
        let (mut found, mut finishing) = (None, false);
        while worker.advance(Duration::from_millis(5)) && !finishing {
            while let Some(event) = worker.take().map(|event| Message::parse(&event).unwrap()) {
                finishing |= event.head.get("state").is_some_and(|state| state == "finishing");
                if event.head["event"] == "found" {
                    found = Some(event);
                }
            }
        }
        // What is told by now is all that a page has when it ends its worker here.
        let found = found.expect("a path is told before finishing begins");
        let opened = Scene::find(scene).unwrap();
        let rows: Vec<f64> = numbers_of(&found, &found.head["rows"]);
        let rows: Vec<_> = rows.chunks(opened.columns().len()).collect();
        let as_found = mp_plan::Request { finish: mp_plan::Finish::AsFound, ..request };
        assert_eq!(json!(opened.plan(&as_found).unwrap().path.unwrap().len()), rows.len());
        let page = Page::new(Opening { scene: Some(opened), ..Opening::default() });
        let checked = page.ask(json!({"do": "path", "name": "as found", "rows": rows}));
        assert_eq!((&checked.head["faults"], &checked.head["path"]["verified"]), (&json!([]), &json!(true)));
        assert_eq!(checked.head["written"].as_array().unwrap().len(), rows.len());
        // A path from other ends is one only with these ends.
        let backward: Vec<_> = rows.iter().rev().collect();
        let request = json!({"do": "path", "name": "back", "rows": backward});
        assert_eq!(page.ask(request.clone()).head["path"]["verified"], false);
        let mut with_ends = request;
        (with_ends["start"], with_ends["goals"]) = (json!(backward[0]), json!([backward[rows.len() - 1]]));
        assert_eq!(page.ask(with_ends).head["faults"], json!([]), "{scene}");
        let refused = page.refused(json!({"do": "path", "name": "short", "rows": [[1]]}));
        assert!(refused.contains("finite numbers"), "{refused}");
    }
}

/// A path gets times as in the library, with or without threads, and its trajectory is written as it is.
#[test]
fn paths_get_times() {
    let scene = Scene::find("arm-6").unwrap();
    let rows = scene.plan(&mp_plan::Request::default()).unwrap().path.unwrap();
    let path = mp_plan::PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    let page = opened("arm-6");
    let mut durations = Vec::new();
    for (run, part) in [(7, 1.0), (8, 0.25)] {
        let request = json!({"do": "time", "run": run, "rows": path.rows, "velocity": part});
        let pace = mp_plan::Pace { velocity: part, ..mp_plan::Pace::default() };
        let trajectory = scene.time(&path, &pace, &mp_plan::Interrupt::never()).unwrap().trajectory;
        page.ask(request.clone());
        let timed = page.until("timed").pop().unwrap();
        let mut worker = Worker::new(Clock::default());
        worker.send(&message(json!({"do": "open", "scene": "arm-6"})).to_bytes());
        worker.send(&message(request).to_bytes());
        assert!(!worker.advance(Duration::from_millis(5)));
        let told: Vec<_> = std::iter::from_fn(|| worker.take()).collect();
        assert_eq!(Message::parse(told.last().unwrap()).unwrap(), timed);

        let knots = &timed.head["knots"];
        assert_eq!(numbers_of::<f64>(&timed, &knots["times"]), trajectory.knots().times);
        assert_eq!(numbers_of::<f64>(&timed, &knots["positions"]), trajectory.knots().positions.concat());
        let duration = timed.head["duration"].as_f64().unwrap();
        assert_eq!((duration, &timed.head["curve"]), (trajectory.duration(), &json!("cubic")));
        // Fifty times a second, within limits, and as fast as one of them allows.
        let velocities: Vec<f64> = numbers_of(&timed, &timed.head["velocities"]);
        assert_eq!(velocities.len(), 6 * ((duration * 50.0).ceil() as usize + 1));
        assert_eq!(numbers_of::<f64>(&timed, &timed.head["path"]["rows"]).len(), velocities.len());
        let limits: Vec<[f64; 2]> = serde_json::from_value(timed.head["limits"].clone()).unwrap();
        let accelerations: Vec<f64> = numbers_of(&timed, &timed.head["accelerations"]);
        let most = |all: &[f64], of: usize| {
            (0..all.len()).map(|i| all[i].abs() / limits[i % 6][of]).fold(0.0, f64::max)
        };
        let [fastest, hardest] = [most(&velocities, 0) / part, most(&accelerations, 1)];
        assert!(fastest.max(hardest) <= 1.001 && fastest.max(hardest) > 0.9, "{fastest} {hardest}");
        durations.push(duration);

        for format in ["csv", "json", "yaml", "mcap"] {
            let request = json!({"do": "save_trajectory", "format": format, "name": "t", "knots": knots});
            let Value::Object(head) = request else { unreachable!() };
            let saved = files_of(&page.reply(Message { head, data: timed.data.clone() }));
            let (name, bytes) = &saved[0];
            let kind = mp_plan::TrajectoryKind::of(std::path::Path::new(name)).unwrap();
            assert_eq!(scene.parse_trajectory(name, bytes, kind, None).unwrap().as_ref(), Some(&trajectory));
        }
    }
    assert!(durations[1] > 1.2 * durations[0], "{durations:?}");

    // What cannot be timed is said by an event, as of other runs.
    let mut run = 10;
    let mut failed = |page: &Page, rows: Value, part: f64| {
        run += 1;
        page.ask(json!({"do": "time", "run": run, "rows": rows, "velocity": part}));
        page.until("failed").pop().unwrap().head["message"].as_str().unwrap().to_owned()
    };
    assert!(failed(&page, json!([]), 1.0).contains("no configurations"));
    assert!(failed(&page, json!([[1.0]]), 1.0).contains("1 number"));
    assert!(failed(&page, json!(path.rows), 0.0).contains("velocity"));
    let through = failed(&page, json!([scene.start(), scene.goals()[0]]), 1.0);
    assert!(through.contains("not free"), "{through}");
    let easy = Scene::find("easy").unwrap();
    assert!(failed(&opened("easy"), json!([easy.start()]), 1.0).contains("no trajectories"));
    let none = page.refused(json!({"do": "save_trajectory", "format": "csv", "name": "t"}));
    assert!(none.contains("no array `times`"), "{none}");
    // A cancel ends it, if it has not ended.
    page.ask(json!({"do": "time", "run": 2, "rows": path.rows}));
    page.ask(json!({"do": "cancel", "run": 2}));
    let last = page.event().head;
    assert!(last["event"] == "timed" || last["message"].as_str().unwrap().contains("in time"), "{last:?}");
}

/// The field is that of the library.
#[test]
fn fields_are_sent() {
    let page = opened("rrs-low");
    let reply = page.ask(json!({"do": "field", "cells": 50, "range": "5%"}));
    let scene = Scene::find("rrs-low").unwrap();
    let image = scene.field(&mp_plan::RelaxField::Clearance, &scene.start(), None, Some("5%"), 50).unwrap();
    let energy: Vec<f32> = numbers_of(&reply, &reply.head["energy"]);
    assert!(energy.iter().zip(&image.energy).all(|(a, b)| *a == *b as f32));
    assert_eq!((energy.len(), &reply.head["width"]), (image.energy.len(), &json!(image.width)));
    assert_eq!(reply.head["range"], json!(image.range));
    assert!(page.refused(json!({"do": "field", "cells": 50, "range": "much"})).contains("much"));
    // Other fields, that of risk along a path.
    let mut risk = json!({"do": "field", "cells": 50, "range": "5%", "field": "risk"});
    assert!(page.refused(risk.clone()).contains("that of a path"));
    risk["path"] = json!([scene.start(), scene.goals()[0]]);
    let reply = page.ask(risk);
    let risk: Vec<f32> = numbers_of(&reply, &reply.head["energy"]);
    assert!(risk.iter().zip(&energy).all(|(with, without)| with >= without));
    assert!(risk.iter().zip(&energy).any(|(with, without)| *with > without + 0.1));
    assert!(page.refused(json!({"do": "field", "cells": 50, "field": "wind"})).contains("no field `wind`"));
    assert!(opened("easy").refused(json!({"do": "field", "cells": 50})).contains("not drawn"));
}

/// A run waits, does as many iterations as it is told, goes on, and gives the same result.
#[test]
fn runs_are_paused_stepped_and_resumed() {
    let page = opened("cubicles");
    let request = mp_plan::Request::new("rrt-connect").seed(3).iterations(100_000);
    page.ask(json!({"do": "plan", "run": 1, "request": request, "paused": true}));
    for step in 1..=3 {
        page.ask(json!({"do": "step", "run": 1, "iterations": 5}));
        let paused = loop {
            let event = page.event();
            // While it waits, and nothing was done since the event before, no counts are told.
            let counts = event.head.contains_key("iterations");
            if event.head["event"] == "progress" && event.head["state"] == "paused" && counts {
                break event;
            }
        };
        assert_eq!(paused.head["iterations"], 5 * step);
    }
    assert!(page.refused(json!({"do": "plan", "run": 1, "request": request})).contains("already"));
    page.ask(json!({"do": "resume", "run": 1}));
    let report = page.until("done").pop().unwrap().head["report"].clone();
    let alone = Scene::find("cubicles").unwrap().plan(&request).unwrap();
    assert_eq!(report["fingerprint"], json!(alone.fingerprint));
    // Orders to a run that has ended do nothing.
    page.ask(json!({"do": "cancel", "run": 1}));
}

#[test]
fn runs_are_cancelled() {
    let page = opened("cubicles");
    // It would go on for a minute.
    let request = json!({"planner": "rrt-star", "seed": 1, "budget": {"time_s": 60.0}});
    page.ask(json!({"do": "plan", "run": 1, "request": request}));
    page.until("progress");
    page.ask(json!({"do": "cancel", "run": 1}));
    let done = page.until("done").pop().unwrap();
    let report = &done.head["report"];
    assert!(report["solved"] == true || report["stopped_by"] == "interrupted", "{report}");
    // A session that is dropped ends its runs: this test would not end otherwise.
    page.ask(json!({"do": "plan", "run": 2, "request": request}));
    page.ask(json!({"do": "plan", "run": 3, "request": request, "paused": true}));
}

#[test]
fn start_and_goal_of_a_request_are_taken() {
    let page = opened("easy");
    let scene = Scene::find("easy").unwrap();
    let (start, goal) = (scene.start(), scene.goals().remove(0));
    let request = mp_plan::Request::new("rrt-connect");
    page.ask(json!({"do": "plan", "run": 1, "request": request, "start": goal, "goals": [start]}));
    let done = page.until("done").pop().unwrap();
    let path = done.head["report"]["path"].as_array().unwrap().clone();
    let first: Vec<f64> = serde_json::from_value(path[0].clone()).unwrap();
    assert!(first.iter().zip(&goal).all(|(a, b)| (a - b).abs() < 1e-9));
    let refused =
        page.refused(json!({"do": "plan", "run": 2, "request": request, "start": [1e6, 0, 0, 0, 0, 0]}));
    assert!(refused.contains("the start is out of bounds"), "{refused}");
    assert!(
        page.refused(json!({"do": "plan", "run": 2, "request": request, "goals": []})).contains("no goal")
    );
    let file = std::env::temp_dir().join("mp-session-roadmap");
    let request = json!({"planner": "prm", "roadmap": file});
    let refused = page.refused(json!({"do": "plan", "run": 2, "request": request}));
    assert!(refused.contains("no roadmap in a file") && !file.exists(), "{refused}");
    let refused = page.refused(json!({"do": "plan", "run": 2, "request": {"planner": "rrtt"}}));
    assert!(refused.contains("no planner"), "{refused}");
}

fn document() -> Value {
    json!({
        "version": 1, "name": "built", "space": "SE3", "bounds": [[-4, -4, -4], [4, 4, 4]],
        "robot": {"name": "stick", "shape": {"cube": {"size": [0.5, 0.1, 0.1]}}},
        "start": [-3, 0, 0, 0, 0, 0], "goal": [3, 0, 0, 0.5, 0, 0],
        "obstacles": [
            {"name": "ball", "color": "#ff8000", "shape": {"sphere": {"radius": 0.7}}, "pose": [0, 0, 0, 0, 0, 0]},
            {"name": "ring", "shape": {"torus": {"ring": 1, "tube": 0.2}}, "scale": [1, 1, 3], "pose": [1, 0, 0, 0, 0.3, 0]},
        ],
    })
}

/// A scene that is built, saved in both formats and opened again is the same.
#[test]
fn documents_are_edited_and_saved() {
    let page = Page::new(Opening::default());
    let edited = page.ask(json!({"do": "edit", "document": document()}));
    let file = scene_of(&edited);
    assert_eq!(file.bodies[1].color, Some([0xff, 0x80, 0]));
    let tetrahedron = b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    let mesh = page.reply(with_files(json!({"do": "mesh"}), &[("four.off", tetrahedron)]));
    assert_eq!((&mesh.head["file"], &mesh.head["triangles"]), (&json!("four.off"), &json!(4)));
    let mut many = with_files(json!({"do": "mesh"}), &[("four.off", tetrahedron)]);
    let file = many.head["files"][0].clone();
    many.set("files", vec![file; 1000]);
    assert!(page.reply(many).head["error"]["message"].as_str().unwrap().contains("overlap"));
    let mut changed = document();
    let four = json!({"name": "four", "shape": {"mesh": {"file": "four.off"}}, "pose": [0, 3, 0, 0, 0, 0]});
    changed["obstacles"].as_array_mut().unwrap().push(four);
    let before = page.ask(json!({"do": "edit", "document": changed}));
    let own = page.ask(json!({"do": "save", "document": null, "format": "own", "name": "built"}));
    let gempa = page.ask(json!({"do": "save", "document": null, "format": "gempa", "name": "built"}));
    for (saved, same) in [(own, true), (gempa, false)] {
        let files = files_of(&saved);
        let given: Vec<(&str, &[u8])> = files.iter().map(|f| (f.0.as_str(), f.1.as_slice())).collect();
        let again = Page::new(Opening::default()).reply(with_files(json!({"do": "open"}), &given));
        let (file, known) = (scene_of(&again), scene_of(&before));
        let corners = |file: &SceneFile| -> Vec<_> {
            let mesh = |m: &crate::Mesh| -> Vec<f32> {
                m.triangles.iter().flat_map(|&v| m.positions[3 * v as usize..][..3].to_vec()).collect()
            };
            file.meshes.iter().map(mesh).collect()
        };
        assert_eq!(corners(&file), corners(&known));
        let poses = |file: &SceneFile| file.bodies.iter().map(|b| b.pose).collect::<Vec<_>>();
        assert_eq!(poses(&file), poses(&known));
        assert_eq!((&file.start, &file.goals, &file.limits), (&known.start, &known.goals, &known.limits));
        if same {
            assert_eq!(file, known);
            assert_eq!(again.head["document"], before.head["document"]);
        }
    }
    let refused = page.refused(json!({"do": "edit", "document": {"version": 1}}));
    assert!(refused.contains("missing field"), "{refused}");
    changed["obstacles"][2]["shape"]["mesh"]["file"] = "other.off".into();
    assert!(page.refused(json!({"do": "edit", "document": changed})).contains("not been opened"));
    // What was open stays.
    page.ask(json!({"do": "check", "row": [0, 2, 0, 0, 0, 0]}));
}

/// Edits keep what did not change; the scene is as if the document were opened alone.
#[test]
fn edited_scenes_are_as_scenes_made_anew() {
    let page = Page::new(Opening::default());
    let mut edited = document();
    let changes: [fn(&mut Value); 7] = [
        |_| {},
        |d| d["obstacles"][0]["color"] = "#010203".into(),
        |d| d["start"][2] = 0.25.into(),
        |d| d["obstacles"][1]["pose"][0] = 0.75.into(),
        |d| d["robot"]["scale"] = json!([1, 2, 1]),
        |d| d["obstacles"].as_array_mut().unwrap().swap(0, 1),
        |d| d["obstacles"][1]["name"] = "other".into(),
    ];
    for (number, change) in changes.into_iter().enumerate() {
        change(&mut edited);
        let request = json!({"do": "edit", "document": edited});
        let alone = Page::new(Opening::default());
        let (kept, anew) = (page.ask(request.clone()), alone.ask(request));
        assert_eq!((&kept.head, &kept.data), (&anew.head, &anew.data));
        let run = json!({"do": "plan", "run": number, "request": mp_plan::Request::new("rrt-connect").iterations(2000)});
        let reports = [&page, &alone].map(|page| {
            page.ask(run.clone());
            let mut done = page.until("done").pop().unwrap();
            let report = done.head["report"].as_object_mut().unwrap();
            report.retain(|name, _| !name.ends_with("_s") && name != "stages");
            done
        });
        assert_eq!((&reports[0].head, &reports[0].data), (&reports[1].head, &reports[1].data));
    }
}

/// Obstacles of a world in the plane are shown where the document puts them, and saved as a problem.
#[test]
fn problems_are_edited_and_saved() {
    let page = Page::new(Opening::default());
    let opened = page.ask(json!({"do": "open", "scene": "rrs-low"}));
    assert_eq!(opened.head["unedited"], Value::Null);
    let mut document = opened.head["document"].clone();
    assert!(document["plane"] == true && document.get("robot").is_none());
    let count = document["obstacles"].as_array().unwrap().len();
    let bar = json!({"name": "bar", "shape": {"rectangle": {"size": [0.4, 0.1]}}, "scale": [2, 1, 1], "pose": [1, 2, 0, 0.5, 0, 0]});
    document["obstacles"].as_array_mut().unwrap().push(bar);
    let edited = page.ask(json!({"do": "edit", "document": document}));
    assert_eq!(edited.head["document"]["obstacles"][count]["name"], "bar");
    let file = scene_of(&edited);
    let drawn = file.bodies.iter().find(|body| body.name == "bar").unwrap();
    let crate::Shape::Area(area) = drawn.shape else { panic!("an area") };
    assert_eq!(file.areas[area].rings[0].iter().copied().fold(0.0, f32::max), 0.4);
    assert_eq!(drawn.pose.map(|pose| [pose[0], pose[1]]), Some([1.0, 2.0]));
    let saved = page.ask(json!({"do": "save", "document": null, "format": "own", "name": "with-bar"}));
    assert_eq!(saved.head["note"], Value::Null);
    let files = files_of(&saved);
    let given: Vec<(&str, &[u8])> = files.iter().map(|f| (f.0.as_str(), f.1.as_slice())).collect();
    let again = Page::new(Opening::default()).reply(with_files(json!({"do": "open"}), &given));
    assert_eq!(
        again.head["document"]["obstacles"][count]["shape"]["polygon"]["rings"][0].as_array().unwrap().len(),
        4
    );
    let refused = page.refused(json!({"do": "save", "document": null, "format": "gempa", "name": "g"}));
    assert!(refused.contains("rigid bodies only"), "{refused}");
    document["obstacles"][count]["shape"] = json!({"circle": {"radius": 0}});
    assert!(page.refused(json!({"do": "edit", "document": document})).contains("bar"));
    let none = Page::new(Opening::default());
    assert!(none.refused(json!({"do": "edit", "document": document})).contains("no scene is open"));
    none.ask(json!({"do": "open", "scene": "easy"}));
    assert!(none.refused(json!({"do": "edit", "document": document})).contains("of a problem in a file"));
}

#[test]
fn meshes_and_scene_files_are_opened() {
    let page = Page::new(Opening::default());
    let mesh = b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    let opened = page.reply(with_files(json!({"do": "open"}), &[("four.off", mesh)]));
    let file = scene_of(&opened);
    assert_eq!((file.name.as_str(), file.bodies.len(), file.meshes[0].triangles.len()), ("four", 1, 12));
    assert_eq!(opened.head["document"]["robot"]["shape"]["mesh"]["file"], "four.off");
    let page = Page::new(Opening { shown: Some(file.clone()), ..Opening::default() });
    let hello = page.ask(json!({"do": "hello"}));
    let shown = hello.bytes(&hello.head["opened"]["scene"], "scene").unwrap();
    assert_eq!(SceneFile::parse(&shown).unwrap(), file);
    assert!(page.refused(json!({"do": "plan", "run": 1, "request": {}})).contains("no scene is open"));
}

#[test]
fn files_go_into_the_folder_and_nowhere_else() {
    let dir = tempfile::tempdir().unwrap();
    let page = Page::new(Opening { folder: Some(dir.path().into()), ..Opening::default() });
    page.ask(json!({"do": "edit", "document": document()}));
    let save = |name: &str, overwrite: bool| {
        message(json!({"do": "save", "format": "own", "name": name, "overwrite": overwrite}))
    };
    assert_eq!(page.reply(save("a", false)).head["written"], json!(["a.mp.json"]));
    let refused =
        |request: Message| page.reply(request).head["error"]["message"].as_str().unwrap().to_owned();
    assert!(refused(save("a", false)).contains("exists already"));
    page.reply(save("a", true));
    let content = json!({"do": "save", "format": "own", "name": "content", "content": true});
    assert_eq!(files_of(&page.reply(message(content)))[0].0, "content.mp.json");
    for name in ["../a", "/a", "", ".a", "a/b", "a\\b", "a\0", "CON", &"x".repeat(300)] {
        assert!(refused(save(name, true)).contains("no name"), "{name}");
    }
    #[cfg(unix)]
    {
        let outside = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink(outside.path().join("f"), dir.path().join("link.mp.json")).unwrap();
        assert!(refused(save("link", true)).contains("is a link"));
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), if cfg!(unix) { 2 } else { 1 });
}

#[test]
fn paths_are_read_saved_and_exported() {
    let page = opened("easy");
    let report = Scene::find("easy").unwrap().plan(&mp_plan::Request::new("rrt-connect")).unwrap();
    let rows = report.path.unwrap();
    for format in ["txt", "json", "csv"] {
        let saved = page.ask(json!({"do": "save_path", "rows": rows, "format": format, "name": "p"}));
        let [(name, bytes)] = &files_of(&saved)[..] else { panic!("one file") };
        let read = page.reply(with_files(json!({"do": "path"}), &[(name, bytes)]));
        assert_eq!(read.head["path"]["verified"], true, "{format}: {:?}", read.head);
    }
    let paths = json!([{"name": "one", "rows": rows}]);
    let exported = page.ask(json!({"do": "export", "format": "mpv", "name": "p", "paths": paths}));
    let path = &SceneFile::parse(&files_of(&exported)[0].1).unwrap().paths[0];
    let corners = path.corners.as_ref().unwrap();
    assert_eq!((path.name.as_str(), corners.len()), ("one", rows.len()));
    for (corner, row) in corners.iter().zip(&rows) {
        let own = path.rows.chunks(row.len()).nth(*corner as usize).unwrap();
        assert!(own.iter().zip(row).all(|(a, b)| (a - b).abs() < 1e-9), "{own:?} {row:?}");
    }
    let exported = page.ask(json!({"do": "export", "format": "glb", "name": "p", "paths": paths}));
    assert_eq!(&files_of(&exported)[0].1[..4], b"glTF");
    assert!(page.refused(json!({"do": "save_path", "rows": [[1]], "format": "txt"})).contains("1 number"));
}

#[test]
fn files_that_are_missing_or_none_are_said() {
    let page = Page::new(Opening::default());
    let refused = |request: Message| page.reply(request).head["error"].clone();
    let env = b"Robot\nr.off\n0 0 0 0 0 0\n1 0 0 0 0 0\nEnd\n";
    let error = refused(with_files(json!({"do": "open"}), &[("a.env", env)]));
    assert!(error["message"].as_str().unwrap().contains("not opened together"), "{error}");
    assert!(error["help"].as_str().unwrap().contains("at once"), "{error}");
    let tetrahedron = b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    let open = |files: &[(&str, &[u8])]| with_files(json!({"do": "open"}), files);
    let tied = open(&[("a.env", env), ("a/r.off", tetrahedron), ("b/r.off", b"OFF")]);
    let error = refused(tied);
    assert!(error["message"].as_str().unwrap().contains("a/r.off or b/r.off"), "{error}");
    for second in [("b/r.off", &tetrahedron[..]), ("r.off", &tetrahedron[..]), ("b/s.off", b"OFF")] {
        let given = open(&[("a.env", env), ("a/r.off", tetrahedron), second]);
        assert!(!page.reply(given).head.contains_key("error"), "{second:?}");
    }
    let error = refused(with_files(json!({"do": "open"}), &[("a.off", b"OFF"), ("b.off", b"OFF")]));
    assert!(error["message"].as_str().unwrap().contains("none of these files is a scene"));
    assert!(refused(with_files(json!({"do": "open"}), &[("a.env", b"")])).is_object());
    assert!(refused(message(json!({"do": "open", "files": []}))).is_object());
    assert!(refused(message(json!({"do": "open", "scene": "../../etc/passwd"}))).is_object());
    let cut =
        json!({"do": "open", "files": [{"name": "a.env", "bytes": {"type": "u8", "offset": 0, "count": 9}}]});
    assert!(refused(message(cut)).is_object());
    assert!(refused(message(json!({"do": "dance"}))).is_object());
    assert!(refused(message(json!({"did": 1}))).is_object());
    for bytes in [&b""[..], b"MPV1", b"MPV1\xff\xff\xff\xff{}", b"MPV1\x02\0\0\0[]", b"hello"] {
        let reply = Message::parse(&page.session.handle(bytes)).unwrap();
        assert!(reply.head["error"]["message"].is_string());
    }
}

/// A worker without threads gives the same result, in pieces.
#[test]
fn workers_plan_the_same() {
    let mut worker = Worker::new(Clock::default());
    let reply = |worker: &mut Worker, request: Value| {
        worker.send(&message(request).to_bytes());
        Message::parse(&worker.take().unwrap()).unwrap()
    };
    reply(&mut worker, json!({"do": "open", "scene": "cubicles"}));
    let request = mp_plan::Request::new("rrt-connect").seed(5).iterations(100_000);
    let begun = reply(&mut worker, json!({"do": "plan", "run": 1, "request": request, "paused": true}));
    assert!(begun.head.is_empty());
    assert!(!worker.advance(Duration::from_millis(1)));
    reply(&mut worker, json!({"do": "step", "run": 1, "iterations": 3}));
    assert!(!worker.advance(Duration::from_secs(10)));
    reply(&mut worker, json!({"do": "resume", "run": 1}));
    while worker.advance(Duration::from_micros(200)) {}
    let mut events = Vec::new();
    while let Some(event) = worker.take() {
        events.push(Message::parse(&event).unwrap());
    }
    let done = events.pop().unwrap();
    let alone = Scene::find("cubicles").unwrap().plan(&request).unwrap();
    assert_eq!(done.head["report"]["fingerprint"], json!(alone.fingerprint));
    assert_eq!(done.head["report"]["iterations"], json!(alone.iterations));
}

/// A robot or a map alone becomes a scene, and the page is told what was chosen.
#[test]
fn robots_and_maps_alone_are_opened() {
    let page = Page::new(Opening::default());
    let urdf = "<robot name=\"one\"><link name=\"base\"/>\n<link name=\"arm\"><collision><geometry>\
                <mesh filename=\"package://kit/meshes/bar.off\"/></geometry></collision></link>\n\
                <joint name=\"turn\" type=\"revolute\"><parent link=\"base\"/><child link=\"arm\"/>\
                <limit lower=\"-1\" upper=\"2\"/></joint></robot>";
    let bar = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    let files: [(&str, &[u8]); 2] = [("bar.off", bar.as_bytes()), ("one.urdf", urdf.as_bytes())];
    let reply = page.reply(with_files(json!({"do": "open"}), &files));
    let notes = reply.head["notes"].to_string();
    assert!(notes.contains("one.urdf is a robot alone"), "{:?}", reply.head);
    let scene = scene_of(&reply);
    assert_eq!((&*scene.start.row, &*scene.goals[0].row), (&[0.0][..], &[1.0][..]));

    let map = "image: room.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n";
    let room = "P2\n4 3\n255\n0 0 0 0\n0 254 254 0\n0 0 0 0\n";
    let files: [(&str, &[u8]); 2] = [("room.pgm", room.as_bytes()), ("room.yaml", map.as_bytes())];
    let reply = page.reply(with_files(json!({"do": "open"}), &files));
    let notes = reply.head["notes"].to_string();
    assert!(notes.contains("room.yaml is a map alone") && !notes.contains("32 bits"), "{notes}");
    let scene = scene_of(&reply);
    assert!((scene.goals[0].row[0] - scene.start.row[0]).abs() > 0.4, "{:?}", scene.start.row);
    // Coordinates of a survey are too large for the numbers that the page draws with.
    let far = map.replace("[0, 0, 0]", "[500000, 4500000, 0]");
    let files: [(&str, &[u8]); 2] = [("room.pgm", room.as_bytes()), ("room.yaml", far.as_bytes())];
    let reply = page.reply(with_files(json!({"do": "open"}), &files));
    assert!(reply.head["notes"].to_string().contains("up to 0.536 m off"), "{:?}", reply.head);
    // An image without its map says what is missing.
    let alone: [(&str, &[u8]); 1] = [("room.pgm", room.as_bytes())];
    let refused = page.reply(with_files(json!({"do": "open"}), &alone));
    assert!(refused.head["error"]["help"].as_str().unwrap().contains("room.yaml"), "{:?}", refused.head);
}
