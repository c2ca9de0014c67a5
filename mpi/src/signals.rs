//! Signals that end the job in good order.

use mp_stop::Cancel;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::time::{Duration, Instant};

/// mpirun and schedulers may send the first signals in a row.
const AT_ONCE: Duration = Duration::from_secs(1);

/// Raises `cancel` on Ctrl-C and when the job is told to end: mpirun and schedulers send SIGTERM to all ranks before they kill. Without it
/// the signal is for another rank, which tells this one. A later signal ends this process at once.
pub(crate) fn listen(cancel: Option<&Cancel>) {
    let cancel = cancel.cloned();
    let mut signals = match Signals::new([SIGINT, SIGTERM]) {
        Ok(signals) => signals,
        Err(e) => {
            crate::output::note(&format!("warning: signals will end the program at once: {e}"));
            return;
        }
    };
    std::thread::spawn(move || {
        let mut first = None;
        for _ in signals.forever() {
            if first.get_or_insert_with(Instant::now).elapsed() > AT_ONCE {
                std::process::exit(130);
            }
            cancel.iter().for_each(Cancel::cancel);
        }
    });
}
