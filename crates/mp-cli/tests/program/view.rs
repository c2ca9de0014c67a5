//! `mp view`: the server with the planner behind it, as a program.

use crate::common::{Dir, Run, finish, mp, start_with};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::Child;
use std::time::{Duration, Instant};

/// The program, which serves until it is ended.
struct View {
    child: Option<Child>,
    host: String,
    token: String,
}

/// A tab: its stream of events, and its session.
struct Tab<'a> {
    view: &'a View,
    events: BufReader<TcpStream>,
    rest: Vec<u8>,
    session: String,
}

impl View {
    fn start(dir: &Dir, args: &[&str]) -> Self {
        Self::start_with(dir, &[&["--no-browser"], args].concat(), &[])
    }

    fn start_with(dir: &Dir, args: &[&str], variables: &[(&str, &str)]) -> Self {
        let mut child = start_with(dir, &[&["view"], args].concat(), variables);
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("http://").and_then(|rest| rest.split_once('/'));
        let Some((host, token)) = address else { panic!("{line}: {:?}", finish(child)) };
        let (host, token) = (host.to_owned(), token.trim_end_matches('/').to_owned());
        Self { child: Some(child), host, token }
    }

    fn ask(&self, method: &str, place: &str, body: &[u8]) -> BufReader<TcpStream> {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let Self { host, token, .. } = self;
        let head = format!("{method} /{token}/{place} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n");
        let head = format!("{head}Content-Length: {}\r\n\r\n", body.len());
        stream.write_all(&[head.as_bytes(), body].concat()).unwrap();
        BufReader::new(stream)
    }

    /// Whole answers: the first line and the body.
    fn answer(&self, method: &str, place: &str, body: &[u8]) -> (String, Vec<u8>) {
        let mut stream = self.ask(method, place, body);
        let head = head(&mut stream);
        let length = head.iter().find_map(|line| line.strip_prefix("content-length: ")).unwrap();
        let mut body = vec![0; length.parse().unwrap()];
        stream.read_exact(&mut body).unwrap();
        (head[0].clone(), body)
    }

    fn tab(&self) -> Tab<'_> {
        let mut events = self.ask("GET", "events", b"");
        assert_eq!(head(&mut events)[0], "HTTP/1.1 200 OK");
        let mut tab = Tab { view: self, events, rest: Vec::new(), session: String::new() };
        tab.session = tab.event()["session"].as_str().unwrap().to_owned();
        tab
    }

    /// What Ctrl-C does.
    fn interrupt(&self) {
        let id = self.child.as_ref().unwrap().id().to_string();
        assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    }

    /// Waits for the end of the program.
    fn wait(mut self) -> Run {
        finish(self.child.take().unwrap())
    }
}

impl Drop for View {
    fn drop(&mut self) {
        if let Some(child) = &mut self.child {
            let _ = child.kill();
        }
    }
}

impl Tab<'_> {
    /// The reply to a request without arrays.
    fn request(&self, request: &Value) -> Value {
        let (status, reply) =
            self.view.answer("POST", &format!("message/{}", self.session), &message(request));
        assert_eq!(status, "HTTP/1.1 200 OK", "{request}");
        head_of(&reply)
    }

    /// The next event.
    fn event(&mut self) -> Value {
        let length = u32::from_le_bytes(self.take(4).try_into().unwrap());
        head_of(&self.take(length as usize))
    }

    fn take(&mut self, count: usize) -> Vec<u8> {
        while self.rest.len() < count {
            let mut size = String::new();
            self.events.read_line(&mut size).unwrap();
            let mut chunk = vec![0; usize::from_str_radix(size.trim(), 16).unwrap() + 2];
            self.events.read_exact(&mut chunk).unwrap();
            self.rest.extend(&chunk[..chunk.len() - 2]);
        }
        let rest = self.rest.split_off(count);
        std::mem::replace(&mut self.rest, rest)
    }

    /// The event that ends a run.
    fn end_of(&mut self, run: u64) -> Value {
        loop {
            let event = self.event();
            if event["run"] == run && (event["event"] == "done" || event["event"] == "failed") {
                return event;
            }
        }
    }
}

/// The lines up to the empty one.
fn head(stream: &mut BufReader<TcpStream>) -> Vec<String> {
    let lines = stream.lines().map(|line| line.unwrap());
    lines.take_while(|line| !line.is_empty()).collect()
}

fn message(head: &Value) -> Vec<u8> {
    let mut text = head.to_string();
    text += &" ".repeat(text.len().next_multiple_of(8) - text.len());
    [b"MPV1", &(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

fn head_of(message: &[u8]) -> Value {
    assert_eq!(&message[..4], b"MPV1");
    let length = u32::from_le_bytes(message[4..8].try_into().unwrap()) as usize;
    serde_json::from_slice(&message[8..8 + length]).unwrap()
}

#[cfg(unix)]
#[test]
fn a_scene_is_shown_planned_saved_and_ended() {
    let dir = Dir::new();
    let made = mp(&dir, &["plan", "window.env", "--json", "--out", "p.txt"]);
    assert_eq!(made.code, 0, "{made:?}");
    let view = View::start(&dir, &["window.env", "p.txt"]);
    let (status, page) = view.answer("GET", "", b"");
    let page = String::from_utf8(page).unwrap();
    assert_eq!(status, "HTTP/1.1 200 OK");
    assert!(page.contains("mp-session") && page.contains("</html>"), "{}", &page[..500]);

    let mut tab = view.tab();
    let hello = tab.request(&json!({"do": "hello"}));
    assert!(hello["planners"].as_array().unwrap().iter().any(|p| p["name"] == "rrt-connect"));
    assert!(hello["opened"]["scene"]["count"].as_u64().unwrap() > 1000, "{hello}");
    let place = std::fs::canonicalize(dir.path("")).unwrap();
    assert_eq!(hello["folder"], place.to_str().unwrap());

    // The same path as that of `mp plan`.
    let plan = json!({"do": "plan", "run": 1, "request": {"planner": "auto", "seed": 1}});
    let reply = tab.request(&plan);
    assert_eq!(reply.get("error"), None, "{reply}");
    let done = tab.end_of(1);
    assert_eq!(done["event"], "done", "{done}");
    assert_eq!(done["report"]["fingerprint"], made.json()["fingerprint"]);

    // It is saved beside the scene, and overwrites nothing unless it is told to.
    let save = json!({"do": "save_path", "rows": done["report"]["path"], "format": "txt", "name": "found"});
    assert_eq!(tab.request(&save)["written"], json!(["found.txt"]));
    assert_eq!(mp(&dir, &["check", "window.env", "found.txt"]).code, 0);
    let before = dir.bytes("found.txt");
    for (name, overwrite) in [("found", false), ("../found", true), ("/tmp/found", true), ("..", true)] {
        let save = json!({"do": "save_path", "rows": [[0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0]], "format": "txt",
                          "name": name, "overwrite": overwrite});
        let reply = tab.request(&save);
        assert!(reply["error"]["message"].is_string(), "{name}: {reply}");
    }
    assert_eq!(dir.bytes("found.txt"), before);

    // Ctrl-C while it plans.
    let second = view.tab();
    let long =
        json!({"do": "plan", "run": 2, "request": {"planner": "rrt-star", "budget": {"time_s": 1000}}});
    let reply = second.request(&long);
    assert_eq!(reply.get("error"), None, "{reply}");
    let begin = Instant::now();
    view.interrupt();
    let Tab { mut events, .. } = second;
    let _ = events.read_to_end(&mut Vec::new());
    drop((tab, events));
    let run = view.wait();
    assert!(begin.elapsed() < Duration::from_secs(3), "{:?}", begin.elapsed());
    assert!(run.code == 0 && run.stderr.contains("Ctrl-C"), "{run:?}");
}

/// Kills views while they save, and checks every time that the file is one of those that were saved, whole.
#[cfg(unix)]
fn kill_views(times: u32) {
    let dir = Dir::new();
    let path = |seed: &str| {
        let made = mp(&dir, &["plan", "window.env", "--seed", seed, "--json", "--out", "p.txt"]);
        assert_eq!(made.code, 0, "{made:?}");
        (made.json()["path"].clone(), dir.bytes("p.txt"))
    };
    let paths = [path("1"), path("2")];
    assert_ne!(paths[0].1, paths[1].1);
    let mut seen = [0, 0];
    for i in 0..times {
        let mut view = View::start(&dir, &["window.env"]);
        let mut child = view.child.take().unwrap();
        let tab = view.tab();
        let opened = tab.request(&json!({"do": "hello"}));
        assert!(opened["folder"].is_string(), "{opened}");
        let save = |rows: &Value| {
            let save =
                json!({"do": "save_path", "rows": rows, "format": "txt", "name": "found", "overwrite": true});
            let mut stream = TcpStream::connect(&view.host).ok()?;
            let body = message(&save);
            let View { host, token, .. } = &view;
            let head = format!(
                "POST /{token}/message/{} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n",
                tab.session
            );
            let head = format!("{head}Content-Length: {}\r\nConnection: close\r\n\r\n", body.len());
            stream.write_all(&[head.as_bytes(), &body].concat()).ok()?;
            let mut reply = Vec::new();
            stream.read_to_end(&mut reply).ok()?;
            (!reply.is_empty()).then_some(())
        };
        // Saves one after the other until it is killed.
        std::thread::scope(|scope| {
            let saving = scope.spawn(|| (0..).take_while(|k| save(&paths[k % 2].0).is_some()).count());
            std::thread::sleep(Duration::from_millis(20 + u64::from(i * 37 % 60)));
            child.kill().unwrap();
            finish(child);
            saving.join().unwrap()
        });
        if dir.exists("found.txt") {
            let found = dir.bytes("found.txt");
            let whole = paths.iter().position(|path| path.1 == found);
            seen[whole.unwrap_or_else(|| panic!("{i}: {}", String::from_utf8_lossy(&found)))] += 1;
        }
    }
    assert!(seen[0] + seen[1] > 0, "nothing was saved");
    // What a killed process leaves behind is swept up by the next one that writes.
    assert_eq!(mp(&dir, &["plan", "window.env", "--json", "--out", "p.txt"]).code, 0);
    let left: Vec<String> = dir.entries(".").into_iter().filter(|name| name.starts_with('.')).collect();
    assert!(left.is_empty(), "{left:?}");
    let _ = writeln!(std::io::stderr(), "{times} views killed, {seen:?} times one path or the other");
}

#[cfg(unix)]
#[test]
fn views_that_are_killed_while_they_save_tear_nothing() {
    kill_views(4);
}

/// As many as a release is tested with: `cargo test -p mp-motion-cli --test program view -- --ignored`.
#[cfg(unix)]
#[test]
#[ignore = "takes a minute"]
fn hundreds_of_views_that_are_killed_while_they_save_tear_nothing() {
    kill_views(250);
}

#[cfg(unix)]
#[test]
fn a_run_ends_with_its_tab_and_cancels_at_once() {
    let dir = Dir::new();
    let view = View::start(&dir, &["closed.env"]);
    let mut tab = view.tab();
    let plan = |run: u64| json!({"do": "plan", "run": run, "request": {"planner": "rrt", "budget": {"time_s": 1000}}});
    assert_eq!(tab.request(&plan(1)).get("error"), None);
    while tab.event()["event"] != "grown" {}
    let begin = Instant::now();
    tab.request(&json!({"do": "cancel", "run": 1}));
    let end = tab.end_of(1);
    assert!(begin.elapsed() < Duration::from_secs(2), "{:?}: {end}", begin.elapsed());
    // The tab is closed while it plans; another one works.
    assert_eq!(tab.request(&plan(2)).get("error"), None);
    let session = tab.session.clone();
    drop(tab);
    let begin = Instant::now();
    while view
        .answer("POST", &format!("message/{session}"), &message(&json!({"do": "hello"})))
        .0
        .contains("200")
    {
        assert!(begin.elapsed() < Duration::from_secs(10), "the session goes on");
    }
    let other = view.tab();
    assert_eq!(other.request(&json!({"do": "hello"})).get("error"), None);
    view.interrupt();
    assert_eq!(view.wait().code, 0);
}

#[cfg(unix)]
#[test]
fn without_a_display_the_address_is_printed_all_the_same() {
    let dir = Dir::empty();
    let no_display = [("DISPLAY", ""), ("WAYLAND_DISPLAY", ""), ("SSH_TTY", "")];
    for (ssh, words) in [("", "no display"), ("10.0.0.1 50000 10.0.0.2 22", "ssh -N -L")] {
        if ssh.is_empty() && !cfg!(target_os = "linux") {
            continue;
        }
        let variables = [&no_display[..], &[("SSH_CONNECTION", ssh)]].concat();
        let view = View::start_with(&dir, &["--gallery"], &variables);
        assert!(
            view.host.starts_with("127.0.0.1:") && view.token.len() == 32,
            "{} {}",
            view.host,
            view.token
        );
        view.interrupt();
        let run = view.wait();
        assert!(run.code == 0 && run.stderr.contains(words), "{run:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn the_browser_gets_an_address_that_works_once() {
    use std::os::unix::fs::PermissionsExt;
    let dir = Dir::empty();
    // In place of the program that opens browsers.
    dir.write("xdg-open", "#!/bin/sh\necho \"$@\" > opened.new && mv opened.new opened\n");
    std::fs::set_permissions(dir.path("xdg-open"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let search = format!("{}:{}", dir.path("").display(), std::env::var("PATH").unwrap());
    let variables = [("PATH", search.as_str()), ("DISPLAY", ":0"), ("SSH_CONNECTION", ""), ("SSH_TTY", "")];
    let view = View::start_with(&dir, &["easy"], &variables);
    let begin = Instant::now();
    while !dir.exists("opened") {
        assert!(begin.elapsed() < Duration::from_secs(20), "no browser was opened");
        std::thread::sleep(Duration::from_millis(10));
    }
    let opened = dir.read("opened");
    let ticket = opened.trim().strip_prefix(&format!("http://{}/", view.host)).unwrap().to_owned();
    assert!(ticket.len() == 32 && ticket != view.token, "{opened}");
    let first = |ticket: &str| {
        let mut stream = TcpStream::connect(&view.host).unwrap();
        write!(stream, "GET /{ticket} HTTP/1.1\r\nHost: {}\r\n\r\n", view.host).unwrap();
        head(&mut BufReader::new(stream))
    };
    let answer = first(&ticket);
    assert!(
        answer[0].contains("303") && answer.contains(&format!("location: /{}/", view.token)),
        "{answer:?}"
    );
    assert!(first(&ticket)[0].contains("403"));
    view.interrupt();
    assert_eq!(view.wait().code, 0);
}

#[test]
fn what_cannot_be_shown_is_an_error() {
    let dir = Dir::new();
    dir.write("other.txt", "2\n0 0 0\n1 1 1\n");
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    for (args, words) in [
        (&["none.env"][..], "none.env"),
        (&["window.env", "none.txt"], "none.txt"),
        (&["window.env", "other.txt"], "other.txt"),
        (&["--folder", "none"], "none is not a folder"),
        (&["--port", &port], port.as_str()),
        (&["--port", "80"], "80"),
        (&["easy", "--gallery"], "--gallery"),
        (&["-", "-"], "standard input"),
    ] {
        let run = mp(&dir, &[&["view", "--no-browser"], args].concat());
        assert!(run.code == 2 && run.stderr.contains(words), "{args:?}: {run:?}");
    }
}
