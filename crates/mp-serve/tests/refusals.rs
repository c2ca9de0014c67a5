//! Hostile and broken clients: each is refused, and the server goes on.

mod client;

use client::{Answer, PAGE, limits, serve};
use mp_serve::Limits;
use std::io::{Read, Write};
use std::net::Shutdown;
use std::sync::atomic::Ordering::SeqCst;
use std::time::{Duration, Instant};

#[test]
fn only_requests_with_the_token_from_the_page_are_answered() {
    let server = serve(limits());
    let tab = server.tab();
    let (token, port, session) = (&server.token, server.port, &tab.session);
    let wrong = "0123456789abcdef0123456789abcdef";
    let own = format!("Host: 127.0.0.1:{port}\r\n");
    let message = format!("message/{session}");
    let refused = [
        // Without the token, or with another one.
        (403, format!("GET / HTTP/1.1\r\n{own}\r\n")),
        (403, format!("GET /events HTTP/1.1\r\n{own}\r\n")),
        (403, format!("GET /{wrong}/ HTTP/1.1\r\n{own}\r\n")),
        (403, format!("GET /{}/ HTTP/1.1\r\n{own}\r\n", &token[..31])),
        (403, format!("GET /{token}0/ HTTP/1.1\r\n{own}\r\n")),
        (403, format!("GET //{token}/ HTTP/1.1\r\n{own}\r\n")),
        (403, format!("GET /?{token} HTTP/1.1\r\n{own}\r\n")),
        (403, format!("POST /{wrong}/{message} HTTP/1.1\r\n{own}Content-Length: 1\r\n\r\nx")),
        (403, format!("POST /{message} HTTP/1.1\r\n{own}Content-Length: 1\r\n\r\nx")),
        // Another host, as when a name of somebody else points here.
        (403, format!("GET /{token}/ HTTP/1.1\r\nHost: evil.example:{port}\r\n\r\n")),
        (403, format!("GET /{token}/ HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")),
        (403, format!("GET /{token}/ HTTP/1.1\r\n\r\n")),
        (403, format!("GET /{token}/ HTTP/1.0\r\n\r\n")),
        (403, format!("GET /{token}/ HTTP/1.1\r\n{own}Host: evil.example\r\n\r\n")),
        (400, format!("GET http://evil.example/{token}/ HTTP/1.1\r\n{own}\r\n")),
        (400, format!("GET http://127.0.0.1:{port}/{token}/ HTTP/1.1\r\n{own}\r\n")),
        // Another page.
        (403, server.head("GET", "events") + "Origin: http://evil.example\r\n\r\n"),
        (403, server.head("POST", &message) + "Origin: null\r\nContent-Length: 1\r\n\r\nx"),
        (403, server.head("POST", &message) + "Origin: http://127.0.0.1:1\r\nContent-Length: 1\r\n\r\nx"),
        // Other places and methods.
        (404, server.head("GET", "../../etc/passwd") + "\r\n"),
        (404, server.head("GET", "%2e%2e/%2e%2e/etc/passwd") + "\r\n"),
        (404, server.head("GET", "..\\..\\etc\\passwd") + "\r\n"),
        (404, server.head("GET", "index.html") + "\r\n"),
        (403, format!("GET /../{token}/ HTTP/1.1\r\n{own}\r\n")),
        (405, server.head("POST", "") + "Content-Length: 1\r\n\r\nx"),
        (405, server.head("POST", "events") + "Content-Length: 1\r\n\r\nx"),
        (405, server.head("GET", &message) + "\r\n"),
        // Unknown sessions.
        (404, server.head("POST", "message/") + "Content-Length: 1\r\n\r\nx"),
        (404, server.head("POST", &format!("message/{wrong}")) + "Content-Length: 1\r\n\r\nx"),
        (404, server.head("POST", &format!("message/../message/{session}")) + "Content-Length: 1\r\n\r\nx"),
    ];
    for (status, request) in refused {
        let answer = server.raw(&request);
        assert_eq!(answer.status(), status, "{request}\n{answer:?}");
        assert!(answer.body.len() > 10 && answer.body.ends_with(b"\n"), "{answer:?}");
        assert_eq!(answer.header("x-content-type-options"), Some("nosniff"), "{answer:?}");
        let text = format!("{}{}", answer.head, String::from_utf8_lossy(&answer.body));
        assert!(!text.contains(token.as_str()), "{request}\n{text}");
    }
    assert_eq!(server.seen.requests.load(SeqCst), 0);
    assert_eq!(server.seen.opened.load(SeqCst), 1);
    server.goes_on();
}

#[test]
fn a_ticket_leads_to_the_page_once() {
    let server = serve(limits());
    let (ticket, token, port) = (&server.ticket, &server.token, server.port);
    assert_ne!(ticket, token);
    let evil = server.raw(format!("GET /{ticket} HTTP/1.1\r\nHost: evil.example:{port}\r\n\r\n"));
    assert_eq!(evil.status(), 403, "{evil:?}");
    let request = format!("GET /{ticket} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n");
    let first = server.raw(&request);
    assert_eq!((first.status(), first.header("location")), (303, Some(format!("/{token}/").as_str())));
    assert_eq!(server.raw(&request).status(), 403);
    server.goes_on();
}

#[test]
fn a_body_above_the_limit_is_refused_before_it_is_read() {
    let server = serve(limits());
    let tab = server.tab();
    let limit = limits().body_bytes as usize;
    let head = server.head("POST", &format!("message/{}", tab.session));
    // By its announced length: nothing of it is sent.
    for length in [format!("{}", limit + 1), format!("{}", 1_u64 << 60)] {
        let answer = server.raw(format!("{head}Content-Length: {length}\r\n\r\n"));
        assert_eq!(answer.status(), 413, "{answer:?}");
    }
    // All of it is sent first: the refusal is read all the same.
    let mut stream = server.connect();
    stream.write_all(format!("{head}Content-Length: {}\r\n\r\n", 8 * limit).as_bytes()).unwrap();
    stream.write_all(&vec![b'x'; 8 * limit]).unwrap();
    assert_eq!(Answer::read(&mut stream).status(), 413);
    // Lengths that make no sense, or contradict each other.
    for length in ["-1", "x", "99999999999999999999999", "1\r\nContent-Length: 2"] {
        let answer = server.raw(format!("{head}Content-Length: {length}\r\n\r\n"));
        assert_eq!(answer.status(), 400, "{length}: {answer:?}");
    }
    // In chunks, without a length.
    let mut stream = server.connect();
    stream.write_all(format!("{head}Transfer-Encoding: chunked\r\n\r\n").as_bytes()).unwrap();
    let chunk = [b"10000\r\n".as_slice(), &[b'x'; 0x10000], b"\r\n"].concat();
    for _ in 0..=limit / 0x10000 {
        stream.write_all(&chunk).unwrap();
    }
    assert_eq!(Answer::read(&mut stream).status(), 413);
    assert_eq!(server.seen.requests.load(SeqCst), 0);
    // The limit itself is allowed, in both ways.
    let whole = vec![b'x'; limit];
    assert_eq!(server.post(&tab.session, &whole).body, limit.to_string().as_bytes());
    let chunks = chunk.repeat(limit / 0x10000);
    let all =
        [format!("{head}Transfer-Encoding: chunked\r\n\r\n").as_bytes(), &chunks, b"0\r\n\r\n"].concat();
    assert_eq!(server.raw(all).body, limit.to_string().as_bytes());
    server.goes_on();
}

#[test]
fn an_endless_head_is_refused() {
    let server = serve(limits());
    let mut stream = server.connect();
    stream.write_all(server.head("GET", "").as_bytes()).unwrap();
    let mut sent = 0;
    while sent < 4 << 20 && stream.write_all(b"X-More: 0123456789012345678901234567890123456789\r\n").is_ok()
    {
        sent += 50;
    }
    // 431, or the connection is gone before that could be read.
    assert!(matches!(Answer::read(&mut stream).status(), 431 | 0));
    let long = format!("GET /{}/{} HTTP/1.1\r\n", server.token, "x".repeat(100_000));
    let mut stream = server.connect();
    let _ = stream.write_all(long.as_bytes());
    assert!(matches!(Answer::read(&mut stream).status(), 414 | 431 | 0));
    server.goes_on();
}

#[test]
fn slow_clients_are_not_waited_for() {
    let server = serve(limits());
    let tab = server.tab();
    // A head that never ends, a byte now and then.
    let begin = Instant::now();
    let mut stream = server.connect();
    let head = server.head("GET", "");
    for byte in head.bytes() {
        if stream.write_all(&[byte]).is_err() || begin.elapsed() > Duration::from_secs(5) {
            break;
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    assert!(begin.elapsed() < Duration::from_secs(5), "the server waited");
    // A connection that sends nothing at all, and one that rests after an answer.
    let mut silent = server.connect();
    let mut rests = server.connect();
    rests.write_all((server.head("GET", "") + "\r\n").as_bytes()).unwrap();
    assert_eq!(Answer::read(&mut rests).body, PAGE.as_bytes());
    for stream in [&mut silent, &mut rests] {
        assert_eq!(stream.read(&mut [0; 1]).unwrap(), 0);
    }
    assert!(begin.elapsed() < Duration::from_secs(10));
    // A body that does not go on.
    let head = server.head("POST", &format!("message/{}", tab.session));
    let answer = server.raw(format!("{head}Content-Length: 100\r\n\r\nonly this"));
    assert_eq!(answer.status(), 408, "{answer:?}");
    let answer = server.raw(format!("{head}Transfer-Encoding: chunked\r\n\r\n5\r\nonly"));
    assert_eq!(answer.status(), 408, "{answer:?}");
    assert_eq!(server.seen.requests.load(SeqCst), 0);
    server.goes_on();
}

#[test]
fn a_slow_body_that_goes_on_is_waited_for() {
    let server = serve(limits());
    let tab = server.tab();
    let mut stream = server.connect();
    let head = server.head("POST", &format!("message/{}", tab.session));
    stream.write_all(format!("{head}Content-Length: 8\r\n\r\n").as_bytes()).unwrap();
    for _ in 0..8 {
        std::thread::sleep(Duration::from_millis(200));
        stream.write_all(b"x").unwrap();
    }
    assert_eq!(Answer::read(&mut stream).body, b"8");
}

#[test]
fn broken_requests_end_their_connection_only() {
    let server = serve(limits());
    let tab = server.tab();
    let head = server.head("POST", &format!("message/{}", tab.session));
    let broken = [
        String::new(),
        "GET /".into(),
        server.head("GET", ""),
        format!("{head}Content-Length: 100\r\n\r\nhalf"),
        format!("{head}Transfer-Encoding: chunked\r\n\r\n"),
    ];
    for request in broken {
        let mut stream = server.connect();
        stream.write_all(request.as_bytes()).unwrap();
        drop(stream);
        let mut stream = server.connect();
        stream.write_all(request.as_bytes()).unwrap();
        stream.shutdown(Shutdown::Write).unwrap();
        let _ = stream.read_to_end(&mut Vec::new());
    }
    let mut bytes = 1_u64;
    let garbage: Vec<u8> = std::iter::repeat_with(|| {
        bytes = bytes.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (bytes >> 56) as u8
    })
    .take(100_000)
    .collect();
    let wrong_chunks = format!("{head}Transfer-Encoding: chunked\r\n\r\nzz\r\nx");
    let tls = b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03".as_slice();
    let all = [
        garbage.as_slice(),
        tls,
        b"\r\n\r\n\r\n\r\n",
        b"GET\0/ HTTP/1.1\r\n\r\n",
        b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        wrong_chunks.as_bytes(),
    ];
    for bytes in all {
        let mut stream = server.connect();
        let _ = stream.write_all(bytes);
        let _ = stream.shutdown(Shutdown::Write);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        assert!(!answer.starts_with(b"HTTP/1.1 200"), "{}", String::from_utf8_lossy(&answer));
    }
    assert_eq!(server.seen.requests.load(SeqCst), 0);
    server.goes_on();
}

#[test]
fn two_hundred_connections_at_once() {
    let server = serve(Limits { head_time: Duration::from_secs(20), ..limits() });
    let idle: Vec<_> = (0..200).map(|_| server.connect()).collect();
    server.goes_on();
    let tab = server.tab();
    let message = server.head("POST", &format!("message/{}", tab.session)) + "Content-Length: 4\r\n\r\nfour";
    for mut stream in &idle {
        stream.write_all(message.as_bytes()).unwrap();
    }
    for mut stream in idle {
        assert_eq!(Answer::read(&mut stream).body, b"4");
    }
}

#[test]
fn connections_above_the_limit_wait() {
    let server = serve(Limits { connections: 3, ..limits() });
    let idle: Vec<_> = (0..10).map(|_| server.connect()).collect();
    let begin = Instant::now();
    server.goes_on();
    assert!(begin.elapsed() > limits().head_time / 2, "nothing had to wait");
    drop(idle);
}
