//! Sessions: one for each tab, from the opening of its events to their end.

mod client;

use client::{PAGE, limits, serve, until};
use mp_serve::{Limits, ServeError, Server};
use std::io::Write;
use std::sync::atomic::Ordering::SeqCst;
use std::time::{Duration, Instant};

#[test]
fn the_page_has_a_policy() {
    let server = serve(limits());
    let page = server.get("");
    assert_eq!((page.status(), page.body.as_slice()), (200, PAGE.as_bytes()));
    assert_eq!(page.header("content-type"), Some("text/html; charset=utf-8"));
    assert_eq!(page.header("cache-control"), Some("no-store"));
    assert_eq!(page.header("referrer-policy"), Some("no-referrer"));
    let policy = page.header("content-security-policy").unwrap();
    for part in ["default-src 'none'", "connect-src 'self'", "frame-ancestors 'none'"] {
        assert!(policy.contains(part), "{policy}");
    }
    let (token, port) = (&server.token, server.port);
    let moved = server.raw(format!("GET /{token} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n"));
    assert_eq!((moved.status(), moved.header("location")), (308, Some(format!("/{token}/").as_str())));
}

#[test]
fn two_tabs_have_a_session_each() {
    let server = serve(limits());
    let (mut one, mut two) = (server.tab(), server.tab());
    assert_ne!(one.session, two.session);
    server.post(&one.session, b"note a");
    server.post(&two.session, b"note b");
    assert_eq!(server.post(&one.session, b"note c").body, b"ac");
    assert_eq!(server.post(&two.session, b"note d").body, b"bd");
    server.post(&two.session, b"event two");
    server.post(&one.session, b"event one");
    server.post(&one.session, b"event more");
    assert_eq!((one.event(), one.event(), two.event()), (b"one".into(), b"more".into(), b"two".into()));
    drop(one);
    until("the first session has ended", || server.seen.ended.load(SeqCst) == 1);
    assert_eq!(server.post(&two.session, b"note e").body, b"bde");
}

#[test]
fn a_session_ends_with_its_tab() {
    let server = serve(limits());
    let tab = server.tab();
    let session = tab.session.clone();
    // While it works, and has events that nobody reads.
    server.post(&session, b"flood");
    let mut working = server.connect();
    let head = server.head("POST", &format!("message/{session}"));
    working.write_all(format!("{head}Content-Length: 9\r\n\r\nsleep 300").as_bytes()).unwrap();
    until("it works", || server.seen.requests.load(SeqCst) == 2);
    drop((tab, working));
    until("the session has ended", || server.seen.ended.load(SeqCst) == 1);
    let answer = server.post(&session, b"note a");
    assert_eq!(answer.status(), 404, "{answer:?}");
    server.goes_on();
}

#[test]
fn events_that_nobody_reads_are_not_taken() {
    let server = serve(limits());
    let mut tab = server.tab();
    server.post(&tab.session, b"flood");
    // The connection has room for some; then there must be no more.
    let taken = || server.seen.events.load(SeqCst);
    let mut before = 0;
    until("the connection is full", || {
        std::thread::sleep(Duration::from_millis(300));
        std::mem::replace(&mut before, taken()) == taken() && before > 0
    });
    let full = taken();
    assert!(full < 300, "{full} events of 64 KiB were taken");
    // Requests are answered meanwhile, and events go on when they are read.
    assert_eq!(server.post(&tab.session, b"note a").body, b"a");
    for _ in 0..full + 100 {
        assert_eq!(tab.event().len(), 64 << 10);
    }
    assert!(taken() >= full + 100);
}

#[test]
fn long_and_large_requests_hold_up_nobody() {
    let server = serve(Limits { body_pause: Duration::from_secs(20), ..limits() });
    let tab = server.tab();
    let head = server.head("POST", &format!("message/{}", tab.session));
    let (mut long, mut large) = (server.connect(), server.connect());
    long.write_all(format!("{head}Content-Length: 10\r\n\r\nsleep 3000").as_bytes()).unwrap();
    large.write_all(format!("{head}Content-Length: 3000000\r\n\r\n").as_bytes()).unwrap();
    until("the long one has begun", || server.seen.requests.load(SeqCst) == 1);
    let begin = Instant::now();
    assert_eq!(server.post(&tab.session, b"note a").body, b"a");
    server.goes_on();
    assert!(begin.elapsed() < Duration::from_secs(2), "{:?}", begin.elapsed());
    large.write_all(&vec![b'x'; 3_000_000]).unwrap();
    assert_eq!(client::Answer::read(&mut large).body, b"3000000");
    assert_eq!(client::Answer::read(&mut long).body, b"awake");
}

#[test]
fn a_session_that_panics_is_no_end() {
    let server = serve(limits());
    let tab = server.tab();
    let answer = server.post(&tab.session, b"panic");
    assert_eq!(answer.status(), 500, "{answer:?}");
    assert_eq!(server.post(&tab.session, b"note a").body, b"a");
    server.goes_on();
}

#[test]
fn the_number_of_tabs_is_bounded() {
    let server = serve(Limits { sessions: 2, ..limits() });
    let (one, _two) = (server.tab(), server.tab());
    let answer = server.try_tab().unwrap_err();
    assert_eq!(answer.status(), 503, "{answer:?}");
    assert!(String::from_utf8(answer.body).unwrap().contains("2 tabs"));
    // As when a page is loaded again: the old one has just been closed.
    drop(one);
    server.tab();
}

#[test]
fn stopping_ends_everything() {
    let mut server = serve(Limits { stop_time: Duration::from_millis(500), ..limits() });
    let tabs = [server.tab(), server.tab()];
    server.post(&tabs[0].session, b"flood");
    let idle = server.connect();
    let mut working = server.connect();
    let head = server.head("POST", &format!("message/{}", tabs[1].session));
    working.write_all(format!("{head}Content-Length: 10\r\n\r\nsleep 1000").as_bytes()).unwrap();
    until("it works", || server.seen.requests.load(SeqCst) == 2);
    let time = server.end();
    assert!(time < Duration::from_millis(1900), "{time:?}");
    until("all sessions have ended", || server.seen.ended.load(SeqCst) == 2);
    assert!(std::net::TcpStream::connect(("127.0.0.1", server.port)).is_err());
    drop(idle);
}

#[test]
fn a_port_that_is_taken_is_an_error() {
    let server = serve(limits());
    let open = |_| -> Box<dyn mp_serve::Session> { unreachable!() };
    let error = Server::bind(server.port, PAGE, limits(), open).unwrap_err();
    assert!(matches!(error, ServeError::Listen { port, .. } if port == server.port), "{error}");
    assert!(error.to_string().contains(&server.port.to_string()), "{error}");
}
