//! The planner inside pages of the viewer: `mp_view::Worker` behind plain exports, without a bindings generator. The exports are
//! described in docs/formats/session.md, "In a worker".
//!
//! There is no unsafe block: a page writes into a buffer of this module, and reads from another one, by their addresses.
//! Only the names of the exports, and the clock that the page passes in, must be declared `unsafe`.
#![cfg(target_family = "wasm")]
#![expect(unsafe_code, reason = "names of exports and the imported clock")]

use mp_cspace::Clock;
use mp_view::Worker;
use std::cell::RefCell;
use std::time::Duration;

mod host {
    #[link(wasm_import_module = "env")]
    unsafe extern "C" {
        /// Milliseconds since a fixed moment.
        pub(crate) safe fn now() -> f64;
    }
}

thread_local! {
    static WORKER: RefCell<Worker> = RefCell::new(Worker::new(Clock::new(|| duration(host::now()))));
    static REQUEST: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static MESSAGE: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Milliseconds as a duration; none for a number that is not one.
fn duration(milliseconds: f64) -> Duration {
    Duration::try_from_secs_f64(milliseconds / 1e3).unwrap_or_default()
}

/// The address of a buffer of `length` bytes, into which the page writes a request.
#[unsafe(no_mangle)]
pub extern "C" fn reserve(length: usize) -> *const u8 {
    REQUEST.with_borrow_mut(|request| {
        request.clear();
        request.resize(length, 0);
        request.as_ptr()
    })
}

/// Handles the request in the buffer, `length` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn send(length: usize) {
    let request = REQUEST.take();
    WORKER.with_borrow_mut(|worker| worker.send(&request[..length.min(request.len())]));
}

/// Plans for about this many milliseconds. Returns 1 while a run goes on that is not paused.
#[unsafe(no_mangle)]
pub extern "C" fn advance(milliseconds: f64) -> u32 {
    WORKER.with_borrow_mut(|worker| worker.advance(duration(milliseconds)).into())
}

/// The length of the next message to the page, or 0.
#[unsafe(no_mangle)]
pub extern "C" fn take() -> usize {
    let message = WORKER.with_borrow_mut(Worker::take).unwrap_or_default();
    let length = message.len();
    MESSAGE.set(message);
    length
}

/// The address of the message that was taken last.
#[unsafe(no_mangle)]
pub extern "C" fn taken() -> *const u8 {
    MESSAGE.with_borrow(|message| message.as_ptr())
}
