//! The body of a request, within limits.

use crate::Limits;
use hyper::StatusCode;
use hyper::body::{Body, Incoming};
use std::future::poll_fn;
use std::pin::Pin;
use tokio::time::timeout;

/// Why a body is not read: a status and a sentence.
pub(crate) type Refusal = (StatusCode, String);

/// The length that a request announces, or `None` when it comes in chunks.
///
/// # Errors
/// When it is above the limit: then nothing of it need be read.
pub(crate) fn announced(body: &Incoming, limits: &Limits) -> Result<Option<u64>, Refusal> {
    let length = body.size_hint().exact();
    match length {
        Some(length) if length > limits.body_bytes => Err(too_large(limits)),
        _ => Ok(length),
    }
}

/// The whole body.
///
/// # Errors
/// When it is larger than the limit, comes too slowly, or the connection breaks.
pub(crate) async fn read(body: &mut Incoming, limits: &Limits) -> Result<Vec<u8>, Refusal> {
    let mut bytes = Vec::new();
    if let Some(length) = announced(body, limits)? {
        let room = usize::try_from(length).ok().filter(|length| bytes.try_reserve_exact(*length).is_ok());
        room.ok_or_else(|| {
            (StatusCode::INSUFFICIENT_STORAGE, "There is no memory for the request.".to_owned())
        })?;
    }
    loop {
        let next = poll_fn(|context| Pin::new(&mut *body).poll_frame(context));
        let frame = match timeout(limits.body_pause, next).await {
            Ok(Some(Ok(frame))) => frame,
            Ok(None) => return Ok(bytes),
            Ok(Some(Err(e))) => {
                return Err((StatusCode::BAD_REQUEST, format!("The request is broken: {e}.")));
            }
            Err(_) => {
                return Err((StatusCode::REQUEST_TIMEOUT, "The request did not come to its end.".into()));
            }
        };
        let Some(data) = frame.data_ref() else { continue };
        if (bytes.len() + data.len()) as u64 > limits.body_bytes {
            return Err(too_large(limits));
        }
        bytes.extend_from_slice(data);
    }
}

fn too_large(limits: &Limits) -> Refusal {
    (StatusCode::PAYLOAD_TOO_LARGE, format!("The request has more than {} bytes.", limits.body_bytes))
}
