//! Which request gets which answer.

use crate::answer::{self, Answer, refused};
use crate::session::{Running, Sessions};
use crate::token::Token;
use crate::{Limits, body, caller, events};
use hyper::body::{Bytes, Incoming};
use hyper::header::{ALLOW, HeaderValue, LOCATION};
use hyper::{Method, Request, StatusCode};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::task::spawn_blocking;

/// Bodies above this many bytes are read and handled one after the other in each session, so that memory is
/// bounded. Smaller ones do not wait for them.
const LARGE: u64 = 1 << 20;

/// What all connections share.
pub(crate) struct Service {
    pub(crate) port: u16,
    pub(crate) token: Token,
    /// Leads to the page once.
    pub(crate) ticket: Mutex<Option<Token>>,
    pub(crate) page: Bytes,
    pub(crate) limits: Limits,
    pub(crate) sessions: Arc<Sessions>,
}

impl Service {
    /// The answer to a request. Nothing of its body is read before it is known to come from the page.
    pub(crate) async fn answer(&self, mut request: Request<Incoming>) -> Answer {
        if request.uri().authority().is_some() {
            return refused(StatusCode::BAD_REQUEST, "This server is not a proxy.");
        }
        if let Some(sentence) = caller::refusal(request.headers(), self.port) {
            return refused(StatusCode::FORBIDDEN, sentence);
        }
        let path = request.uri().path().to_owned();
        let mut parts = path.strip_prefix('/').unwrap_or_default().splitn(2, '/');
        let token = parts.next().unwrap_or_default();
        if self.redeem(token) {
            return self.moved(StatusCode::SEE_OTHER);
        }
        if !self.token.is(token) {
            let sentence =
                "The address has not the token of this server: open the address that `mp view` printed last.";
            return refused(StatusCode::FORBIDDEN, sentence);
        }
        match parts.next() {
            None => self.moved(StatusCode::PERMANENT_REDIRECT),
            Some("") => match request.method() {
                &Method::GET => answer::page(self.page.clone()),
                _ => only("GET"),
            },
            Some("events") => match request.method() {
                &Method::GET => self.events().await,
                _ => only("GET"),
            },
            Some(place) => match (place.strip_prefix("message/"), request.method()) {
                (None, _) => refused(StatusCode::NOT_FOUND, "There is nothing at this address."),
                (Some(session), &Method::POST) => match self.sessions.find(session) {
                    Some(running) => self.message(running, request.body_mut()).await,
                    None => refused(StatusCode::NOT_FOUND, "The session has ended: load the page again."),
                },
                _ => only("POST"),
            },
        }
    }

    /// Whether this is the ticket, which is used up by it.
    fn redeem(&self, given: &str) -> bool {
        let mut ticket = self.ticket.lock().unwrap_or_else(PoisonError::into_inner);
        ticket.take_if(|ticket| ticket.is(given)).is_some()
    }

    /// To the address of the page.
    fn moved(&self, status: StatusCode) -> Answer {
        let mut answer = refused(status, "The page has another address.");
        if let Ok(place) = HeaderValue::from_str(&format!("/{}/", self.token.text())) {
            answer.headers_mut().insert(LOCATION, place);
        }
        answer
    }

    async fn events(&self) -> Answer {
        match events::stream(Arc::clone(&self.sessions)).await {
            Ok(Some(events)) => answer::stream(events),
            Ok(None) => {
                let sentence = format!(
                    "The page is open in {} tabs, which is all that browsers allow: close one of them.",
                    self.limits.sessions
                );
                refused(StatusCode::SERVICE_UNAVAILABLE, sentence)
            }
            Err(e) => refused(StatusCode::INTERNAL_SERVER_ERROR, format!("Cannot open a session: {e}.")),
        }
    }

    async fn message(&self, running: Arc<Running>, body: &mut Incoming) -> Answer {
        let _large = match body::announced(body, &self.limits) {
            Ok(Some(..=LARGE)) => None,
            Ok(_) => Some(running.large.lock().await),
            Err((status, sentence)) => return refused(status, sentence),
        };
        let request = match body::read(body, &self.limits).await {
            Ok(request) => request,
            Err((status, sentence)) => return refused(status, sentence),
        };
        let handling = Arc::clone(&running);
        match spawn_blocking(move || handling.session.handle(&request)).await {
            Ok(reply) => answer::message(reply),
            Err(e) => {
                tracing::error!("a session failed at a request: {e}");
                let sentence = "The program failed at this request: save your work and load the page again.";
                refused(StatusCode::INTERNAL_SERVER_ERROR, sentence)
            }
        }
    }
}

/// The refusal of a method other than the `allowed` one.
fn only(allowed: &'static str) -> Answer {
    let mut answer = refused(StatusCode::METHOD_NOT_ALLOWED, format!("Only {allowed} is answered here."));
    answer.headers_mut().insert(ALLOW, HeaderValue::from_static(allowed));
    answer
}
