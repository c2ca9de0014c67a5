//! The server of a viewer on this machine: one page, and a session for each tab that shows it.
//!
//! [`Server`] listens on 127.0.0.1 only. Its [`address`](Server::address) begins with a random token, and it
//! refuses what comes without the token, from another page, or under another name of this machine. Each tab
//! that shows the page has a [`Session`] of its own, which ends when the tab is closed. The requests are
//! those of docs/formats/session.md, "Over HTTP".
//!
//! ```
//! use mp_serve::{Limits, Server, Session};
//! struct Echo;
//! impl Session for Echo {
//!     fn handle(&self, request: &[u8]) -> Vec<u8> {
//!         request.to_vec()
//!     }
//!     fn take_event(&self) -> Option<Vec<u8>> {
//!         None
//!     }
//! }
//! let server = Server::bind(0, "<!doctype html>", Limits::default(), |_wake| Box::new(Echo))?;
//! println!("{}", server.address());
//! server.stop().stop(); // or later, from another thread
//! server.run()?;
//! # Ok::<(), mp_serve::ServeError>(())
//! ```

mod answer;
mod body;
mod caller;
mod error;
mod events;
mod limits;
mod server;
mod service;
mod session;
mod token;

pub use error::ServeError;
pub use limits::Limits;
pub use server::{Server, Stop};
pub use session::{Session, Wake};
