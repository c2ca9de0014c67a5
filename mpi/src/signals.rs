//! Signals that end the job in good order.

use mp_stop::{Cancel, signals};
use std::time::Duration;

/// mpirun and schedulers may send the first signals in a row.
const IN_A_ROW: Duration = Duration::from_secs(1);

/// Raises `cancel` on Ctrl-C and when the job is told to end: mpirun and schedulers send SIGTERM to all ranks before they kill. Without it
/// the signal is for another rank, which tells this one. A later signal ends this process at once.
pub(crate) fn listen(cancel: Option<&Cancel>) {
    let cancel = cancel.cloned();
    if let Err(e) = signals::on_first(IN_A_ROW, move || cancel.iter().for_each(Cancel::cancel)) {
        crate::output::note(&format!("warning: signals will end the program at once: {e}"));
    }
}
