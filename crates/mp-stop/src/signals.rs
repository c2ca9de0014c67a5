//! Signals that end the work of a program in good order.

use std::io;
use std::time::Duration;

/// How long after the first Ctrl-C another one is the same, sent again by `timeout`: nobody presses it twice in this time.
pub const BY_HAND: Duration = Duration::from_millis(100);

/// Does `action` at the first Ctrl-C, in a thread of its own. On Unix also at the first SIGTERM, which schedulers, containers and `timeout`
/// send before they kill. The next signal ends the program at once, with 128 and the number of the signal as exit code.
///
/// One signal may arrive several times: `timeout` sends its signal to a process and to its group, `mpirun` repeats what it gets. So another
/// SIGTERM counts from one second after the first signal on, and another Ctrl-C from `in_a_row` on, such as [`BY_HAND`].
///
/// Call it once in a program.
///
/// # Errors
/// When the system does not let the program listen.
pub fn on_first(in_a_row: Duration, action: impl Fn() + Send + 'static) -> io::Result<()> {
    listen(in_a_row, action)
}

#[cfg(unix)]
fn listen(in_a_row: Duration, action: impl Fn() + Send + 'static) -> io::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use std::time::Instant;

    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    let heed = move || {
        let mut first: Option<Instant> = None;
        for signal in signals.forever() {
            let one = if signal == SIGTERM { Duration::from_secs(1) } else { in_a_row };
            match first {
                None => {
                    first = Some(Instant::now());
                    action();
                }
                Some(first) if first.elapsed() < one => {}
                Some(_) => std::process::exit(128 + signal),
            }
        }
    };
    std::thread::Builder::new().name("signals".into()).spawn(heed).map(drop)
}

#[cfg(windows)]
fn listen(in_a_row: Duration, action: impl Fn() + Send + 'static) -> io::Result<()> {
    use std::sync::OnceLock;
    use std::time::Instant;

    let first = OnceLock::new();
    let heed = move || match first.set(Instant::now()) {
        Ok(()) => action(),
        Err(_) if first.get().is_some_and(|first| first.elapsed() < in_a_row) => {}
        Err(_) => std::process::exit(130),
    };
    ctrlc::set_handler(heed).map_err(io::Error::other)
}

#[cfg(not(any(unix, windows)))]
fn listen(_: Duration, _: impl Fn() + Send + 'static) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
