//! A server that runs in a thread, with sessions that do what their requests say, and a client of plain
//! connections.

#![allow(dead_code, reason = "each test file uses a part of this")]

use mp_serve::{Limits, ServeError, Server, Session, Stop, Wake};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// What the tests see of the sessions.
#[derive(Debug, Default)]
pub(crate) struct Seen {
    pub(crate) opened: AtomicUsize,
    pub(crate) ended: AtomicUsize,
    pub(crate) requests: AtomicUsize,
    pub(crate) events: AtomicUsize,
}

/// A session that does what its requests say:
/// - `note TEXT`: replies with all notes so far;
/// - `event TEXT`: has one event more;
/// - `flood`: always has another event, of 64 KiB;
/// - `sleep MS`: replies after this time;
/// - `panic`;
/// - anything else: replies with its length.
struct Scripted {
    seen: Arc<Seen>,
    wake: Wake,
    notes: Mutex<String>,
    events: Mutex<Vec<Vec<u8>>>,
    flood: Mutex<bool>,
}

impl Session for Scripted {
    fn handle(&self, request: &[u8]) -> Vec<u8> {
        self.seen.requests.fetch_add(1, Ordering::SeqCst);
        let text = String::from_utf8_lossy(&request[..request.len().min(100)]).into_owned();
        match text.split_once(' ').unwrap_or((&text, "")) {
            ("note", note) => {
                let mut notes = self.notes.lock().unwrap();
                notes.push_str(note);
                notes.clone().into_bytes()
            }
            ("event", event) => {
                self.events.lock().unwrap().push(event.as_bytes().to_vec());
                self.wake.wake();
                Vec::new()
            }
            ("flood", _) => {
                *self.flood.lock().unwrap() = true;
                self.wake.wake();
                Vec::new()
            }
            ("sleep", time) => {
                std::thread::sleep(Duration::from_millis(time.parse().unwrap()));
                b"awake".to_vec()
            }
            ("panic", _) => panic!("as the test says"),
            _ => request.len().to_string().into_bytes(),
        }
    }

    fn take_event(&self) -> Option<Vec<u8>> {
        let event = match *self.flood.lock().unwrap() {
            true => Some(vec![b'x'; 64 << 10]),
            false => Some(self.events.lock().unwrap()).filter(|e| !e.is_empty()).map(|mut e| e.remove(0)),
        };
        self.seen.events.fetch_add(usize::from(event.is_some()), Ordering::SeqCst);
        event
    }
}

impl Drop for Scripted {
    fn drop(&mut self) {
        self.seen.ended.fetch_add(1, Ordering::SeqCst);
    }
}

/// Limits that tests can reach.
pub(crate) fn limits() -> Limits {
    Limits {
        head_time: Duration::from_millis(600),
        body_pause: Duration::from_millis(600),
        body_bytes: 4 << 20,
        ..Limits::default()
    }
}

pub(crate) const PAGE: &str = "<!doctype html><title>The page</title>";

/// A server that runs until it is dropped.
#[derive(Debug)]
pub(crate) struct Served {
    pub(crate) port: u16,
    pub(crate) token: String,
    pub(crate) ticket: String,
    pub(crate) seen: Arc<Seen>,
    stop: Stop,
    thread: Option<JoinHandle<Result<(), ServeError>>>,
}

pub(crate) fn serve(limits: Limits) -> Served {
    let seen = Arc::new(Seen::default());
    let shared = Arc::clone(&seen);
    let open = move |wake| -> Box<dyn Session> {
        shared.opened.fetch_add(1, Ordering::SeqCst);
        let seen = Arc::clone(&shared);
        Box::new(Scripted {
            seen,
            wake,
            notes: Mutex::default(),
            events: Mutex::default(),
            flood: Mutex::default(),
        })
    };
    let server = Server::bind(0, PAGE, limits, open).unwrap();
    let (port, stop) = (server.port(), server.stop());
    let address = server.address();
    let token = address.strip_prefix(&format!("http://127.0.0.1:{port}/")).unwrap().trim_end_matches('/');
    let token = token.to_owned();
    let ticket = server.ticket().rsplit('/').next().unwrap().to_owned();
    let thread = Some(std::thread::spawn(move || server.run()));
    Served { port, token, ticket, seen, stop, thread }
}

impl Served {
    /// Ends the server, and says how long it took.
    pub(crate) fn end(&mut self) -> Duration {
        let begin = Instant::now();
        self.stop.stop();
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap().unwrap();
        }
        begin.elapsed()
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        stream.set_write_timeout(Some(Duration::from_secs(20))).unwrap();
        stream
    }

    /// The first lines of a request to a place below the token.
    pub(crate) fn head(&self, method: &str, place: &str) -> String {
        format!("{method} /{}/{place} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n", self.token, self.port)
    }

    /// What the server answers to these bytes.
    pub(crate) fn raw(&self, bytes: impl AsRef<[u8]>) -> Answer {
        let mut stream = self.connect();
        stream.write_all(bytes.as_ref()).unwrap();
        Answer::read(&mut stream)
    }

    pub(crate) fn get(&self, place: &str) -> Answer {
        self.raw(self.head("GET", place) + "\r\n")
    }

    /// Sends a message, and returns the answer.
    pub(crate) fn post(&self, session: &str, message: &[u8]) -> Answer {
        let head = self.head("POST", &format!("message/{session}"));
        let head = format!("{head}Content-Length: {}\r\n\r\n", message.len());
        self.raw([head.as_bytes(), message].concat())
    }

    /// Opens a session, as a tab does.
    pub(crate) fn tab(&self) -> Tab {
        self.try_tab().unwrap_or_else(|answer| panic!("{answer:?}"))
    }

    pub(crate) fn try_tab(&self) -> Result<Tab, Answer> {
        let mut stream = self.connect();
        stream.write_all((self.head("GET", "events") + "\r\n").as_bytes()).unwrap();
        let head = read_head(&mut stream);
        if !head.starts_with("HTTP/1.1 200") {
            return Err(Answer::after(head, &mut stream));
        }
        let mut tab = Tab { stream, rest: Vec::new(), session: String::new() };
        let hello = tab.event();
        assert_eq!(&hello[..4], b"MPV1");
        let length = u32::from_le_bytes(hello[4..8].try_into().unwrap()) as usize;
        assert!(length.is_multiple_of(8) && hello.len() == 8 + length, "{hello:?}");
        let text = std::str::from_utf8(&hello[8..]).unwrap();
        let inner = text.trim_end().strip_prefix("{\"event\":\"hello\",\"session\":\"").unwrap();
        tab.session = inner.strip_suffix("\"}").unwrap().to_owned();
        Ok(tab)
    }

    /// That the server still does all it should: page, session, message, event.
    pub(crate) fn goes_on(&self) {
        assert_eq!(self.get("").body, PAGE.as_bytes());
        let mut tab = self.tab();
        assert_eq!(self.post(&tab.session, b"hello").body, b"5");
        self.post(&tab.session, b"event one");
        assert_eq!(tab.event(), b"one");
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.stop();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// An answer: its first line and headers, and its body.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    /// Reads an answer with a known length. One without any bytes is empty.
    pub(crate) fn read(stream: &mut TcpStream) -> Self {
        let head = read_head(stream);
        Self::after(head, stream)
    }

    fn after(head: String, stream: &mut TcpStream) -> Self {
        let length = head.lines().find_map(|l| l.strip_prefix("content-length: "));
        let mut body = vec![0; length.map_or(0, |l| l.trim().parse().unwrap())];
        stream.read_exact(&mut body).unwrap();
        Self { head, body }
    }

    /// The status, or 0 when there was no answer.
    pub(crate) fn status(&self) -> u16 {
        self.head.split(' ').nth(1).map_or(0, |s| s.parse().unwrap())
    }

    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        let mut lines = self.head.lines().filter_map(|line| line.split_once(": "));
        lines.find(|(given, _)| *given == name).map(|(_, value)| value)
    }
}

/// The bytes up to the empty line, or up to the end.
fn read_head(stream: &mut TcpStream) -> String {
    let mut head = Vec::new();
    let mut byte = [0];
    while !head.ends_with(b"\r\n\r\n") {
        match stream.read(&mut byte) {
            Ok(1) => head.push(byte[0]),
            Ok(_) => break,
            Err(e) if e.kind() == std::io::ErrorKind::ConnectionReset => break,
            Err(e) => panic!("{e}: {:?}", String::from_utf8_lossy(&head)),
        }
    }
    String::from_utf8(head).unwrap()
}

/// An open stream of events.
#[derive(Debug)]
pub(crate) struct Tab {
    pub(crate) stream: TcpStream,
    rest: Vec<u8>,
    pub(crate) session: String,
}

impl Tab {
    /// The next event.
    pub(crate) fn event(&mut self) -> Vec<u8> {
        let length = u32::from_le_bytes(self.bytes(4).try_into().unwrap());
        self.bytes(length as usize)
    }

    fn bytes(&mut self, count: usize) -> Vec<u8> {
        while self.rest.len() < count {
            let chunk = self.chunk();
            self.rest.extend(chunk);
        }
        let rest = self.rest.split_off(count);
        std::mem::replace(&mut self.rest, rest)
    }

    /// A chunk of the body, as HTTP sends bodies whose length is not known.
    fn chunk(&mut self) -> Vec<u8> {
        let mut line = Vec::new();
        while !line.ends_with(b"\r\n") {
            let mut byte = [0];
            self.stream.read_exact(&mut byte).unwrap();
            line.push(byte[0]);
        }
        let length = usize::from_str_radix(std::str::from_utf8(&line).unwrap().trim(), 16).unwrap();
        let mut chunk = vec![0; length + 2];
        self.stream.read_exact(&mut chunk).unwrap();
        chunk.truncate(length);
        chunk
    }
}

/// Waits until this is so, at most ten seconds.
pub(crate) fn until(what: &str, mut so: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !so() {
        assert!(begin.elapsed() < Duration::from_secs(10), "not within 10 s: {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}
