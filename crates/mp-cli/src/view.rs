//! `view`: the viewer in the browser, with the planner behind it.

use crate::browser::{self, Screen};
use crate::cli::View;
use crate::interrupt;
use crate::output::{note, print};
use mp_plan::Error;
use mp_serve::{Limits, Server, Session, Wake};

/// A request may hold the largest mesh file, and what is said about it.
const BODY_BYTES: u64 = mp_io::MAX_MESH_BYTES + (1 << 20);

/// Serves the page until Ctrl-C.
pub(crate) fn run(args: &View) -> Result<bool, Error> {
    let limits = Limits { body_bytes: BODY_BYTES, ..Limits::default() };
    struct Tmp(#[allow(dead_code)] Wake);
    impl Session for Tmp {
        fn handle(&self, request: &[u8]) -> Vec<u8> { request.to_vec() }
        fn take_event(&self) -> Option<Vec<u8>> { None }
    }
    let server = Server::bind(args.port.unwrap_or(0), "", limits, |wake| Box::new(Tmp(wake)));
    let server = server.map_err(|e| Error::new(e.to_string()).help("name another port by --port"))?;
    let stop = server.stop();
    interrupt::on_first(move || stop.stop());
    print(&server.address())?;
    let port = server.port();
    match Screen::find() {
        _ if args.no_browser => {}
        Screen::Here => {
            if let Err(e) = browser::open(&server.ticket()) {
                note(&format!("{e}; open the address above"));
            }
        }
        Screen::OverSsh => note(&format!(
            "this is an ssh session: on your own machine run `ssh -N -L {port}:127.0.0.1:{port} HOST`, with the host of this \
             session, and open the address there"
        )),
        Screen::None => note("there is no display: open the address in a browser of this machine"),
    }
    note("Ctrl-C ends it");
    server.run().map_err(|e| Error::new(e.to_string()))?;
    Ok(true)
}
