//! The server: it listens, takes connections, and ends.

use crate::service::Service;
use crate::session::Sessions;
use crate::token::Token;
use crate::{Limits, ServeError, Session, Wake};
use hyper::Request;
use hyper::body::{Bytes, Incoming};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use std::convert::Infallible;
use std::fmt;
use std::future::poll_fn;
use std::net::{Ipv4Addr, TcpListener};
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::io::AsyncWrite;
use tokio::net::TcpStream;
use tokio::sync::{Notify, Semaphore};
use tokio::task::JoinSet;
use tokio::time::{sleep, timeout};

/// How long the rest of a request that was refused is thrown away, so that the client reads the refusal.
const REST: Duration = Duration::from_secs(5);

/// A server that listens on 127.0.0.1.
pub struct Server {
    listener: TcpListener,
    service: Service,
    stop: Stop,
}

/// Ends a server, from any thread.
#[derive(Clone, Default)]
pub struct Stop(Arc<Notify>);

impl Stop {
    /// Ends the server: its sessions are dropped and [`Server::run`] returns. Returns at once.
    pub fn stop(&self) {
        self.0.notify_one();
    }
}

impl Server {
    /// A server on `port` of 127.0.0.1; 0 means any free port. It gives `page` to browsers, and opens a
    /// session by `open` for each tab that asks for events. `open` runs in a thread of its own and may take
    /// long.
    ///
    /// # Errors
    /// When the port is in use or not allowed, or the system gives no random numbers.
    pub fn bind(
        port: u16,
        page: impl Into<Vec<u8>>,
        limits: Limits,
        open: impl Fn(Wake) -> Box<dyn Session> + Send + Sync + 'static,
    ) -> Result<Self, ServeError> {
        let failed = |source| ServeError::Listen { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let port = listener.local_addr().map_err(failed)?.port();
        let sessions = Arc::new(Sessions::new(open, limits.sessions));
        let page = Bytes::from(page.into());
        let ticket = Mutex::new(Some(Token::random()?));
        let service = Service { port, token: Token::random()?, ticket, page, limits, sessions };
        Ok(Self { listener, service, stop: Stop::default() })
    }

    /// The address of the page, with the token: `http://127.0.0.1:PORT/TOKEN/`. Whoever has it can use the
    /// sessions.
    #[must_use]
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.service.port, self.service.token.text())
    }

    /// An address that leads to the page once, for the program that opens a browser: other users of this
    /// machine can read the arguments of programs, and must not find the token there.
    #[must_use]
    pub fn ticket(&self) -> String {
        let ticket = self.service.ticket.lock().unwrap_or_else(PoisonError::into_inner);
        let ticket = ticket.as_ref().map_or("", Token::text);
        format!("http://127.0.0.1:{}/{ticket}", self.service.port)
    }

    /// The port it listens on.
    #[must_use]
    pub fn port(&self) -> u16 {
        self.service.port
    }

    /// What ends it.
    #[must_use]
    pub fn stop(&self) -> Stop {
        self.stop.clone()
    }

    /// Answers requests until [`Stop::stop`]. Then connections are closed and sessions dropped.
    ///
    /// # Errors
    /// When the system has no means to wait for connections.
    pub fn run(self) -> Result<(), ServeError> {
        let Self { listener, service, stop } = self;
        let limits = service.limits.clone();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let done: Result<(), ServeError> = runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            let sessions = Arc::clone(&service.sessions);
            let mut connections = JoinSet::new();
            crate::events::first(accept(listener, service, &mut connections), stop.0.notified()).await;
            connections.shutdown().await;
            // Without a reader, each session ends.
            let all = u32::try_from(limits.sessions).unwrap_or(u32::MAX);
            let _ = timeout(limits.stop_time, sessions.places.acquire_many(all)).await;
            Ok(())
        });
        runtime.shutdown_timeout(limits.stop_time);
        done
    }
}

/// Accepts connections without end.
async fn accept(listener: tokio::net::TcpListener, service: Service, connections: &mut JoinSet<()>) {
    let places = Arc::new(Semaphore::new(service.limits.connections));
    let service = Arc::new(service);
    while let Ok(place) = Arc::clone(&places).acquire_owned().await {
        match listener.accept().await {
            Ok((stream, _)) => {
                let service = Arc::clone(&service);
                connections.spawn(async move {
                    serve(stream, service).await;
                    drop(place);
                });
            }
            Err(e) => {
                // As when the process has too many open files: wait for some to be closed.
                tracing::warn!("cannot accept a connection: {e}");
                sleep(Duration::from_millis(100)).await;
            }
        }
        while connections.try_join_next().is_some() {}
    }
}

/// Answers the requests of one connection.
async fn serve(stream: TcpStream, service: Arc<Service>) {
    let limits = service.limits.clone();
    let answer = service_fn(move |request: Request<Incoming>| {
        let service = Arc::clone(&service);
        async move { Ok::<_, Infallible>(service.answer(request).await) }
    });
    // Events are small and must not wait for each other.
    let _ = stream.set_nodelay(true);
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(limits.head_time)
        .max_buf_size(limits.head_bytes.max(8192))
        .serve_connection(TokioIo::new(stream), answer);
    match connection.without_shutdown().await {
        Ok(parts) => {
            let _ = timeout(REST, discard(parts.io.into_inner())).await;
        }
        Err(e) => tracing::debug!("a connection failed: {e}"),
    }
}

/// Ends the own side, and reads what the other side still sends: a connection that is closed with unread
/// bytes is reset, and the client might lose the answer.
async fn discard(mut stream: TcpStream) -> std::io::Result<()> {
    poll_fn(|context| Pin::new(&mut stream).poll_shutdown(context)).await?;
    let mut rest = vec![0; 64 << 10];
    loop {
        stream.readable().await?;
        match stream.try_read(&mut rest) {
            Ok(0) => return Ok(()),
            Err(e) if e.kind() != std::io::ErrorKind::WouldBlock => return Err(e),
            _ => {}
        }
    }
}

/// Without the token.
impl fmt::Debug for Server {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Server").field("port", &self.service.port).finish_non_exhaustive()
    }
}

impl fmt::Debug for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Stop")
    }
}
