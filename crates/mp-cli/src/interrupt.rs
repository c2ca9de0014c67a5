//! Ctrl-C and SIGTERM: the first one ends the work in good order, the next one ends the program at once.

use mp_plan::{Cancel, Error, Interrupt};
use mp_stop::signals;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How often work is asked whether it is done.
const MOMENT: Duration = Duration::from_millis(20);
/// How long loading may go on after it was told to end.
pub(crate) const PATIENCE: Duration = Duration::from_millis(200);
/// The stack of a thread that works, bytes: as the first thread of a program has it.
const STACK: usize = 8 << 20;

/// Does this at the first signal. The next one ends the program at once.
pub(crate) fn on_first(action: impl Fn() + Send + 'static) {
    if let Err(e) = signals::on_first(signals::BY_HAND, action) {
        tracing::warn!("Ctrl-C will end the program at once: {e}");
    }
}

/// A flag that is set by the first signal. The next one ends the program at once.
pub(crate) fn flag() -> Cancel {
    let cancel = Cancel::new();
    let raised = cancel.clone();
    on_first(move || raised.cancel());
    cancel
}

/// Does `work` in a thread of its own. `None` when it goes on for longer than `patience` after `interrupt` said to end: standard input may say
/// nothing, and what others have written does not ask. Such work ends with the program.
///
/// # Errors
/// When the system gives no thread.
pub(crate) fn within<T: Send + 'static>(
    interrupt: &Interrupt,
    patience: Duration,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<Option<T>, Error> {
    let (sender, done) = channel();
    let work = move || {
        let _ = sender.send(work());
    };
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(work);
    let thread = thread.map_err(|e| Error::new(format!("cannot start a thread: {e}")))?;
    let (mut interrupt, mut left) = (interrupt.clone(), patience);
    loop {
        match done.recv_timeout(MOMENT) {
            Ok(made) => return Ok(Some(made)),
            Err(RecvTimeoutError::Timeout) if !interrupt.ask() => {}
            Err(RecvTimeoutError::Timeout) if left.is_zero() => return Ok(None),
            Err(RecvTimeoutError::Timeout) => left = left.saturating_sub(MOMENT),
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => std::panic::resume_unwind(panic),
                Ok(()) => return Ok(None),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

    #[test]
    fn work_that_does_not_ask_is_not_waited_for() {
        let (cancel, second) = (Cancel::new(), Duration::from_secs(1));
        assert_eq!(within(&Interrupt::new(cancel.clone()), second, || 1).unwrap(), Some(1));
        cancel.cancel();
        let told = Interrupt::new(cancel);
        let began = Instant::now();
        assert_eq!(within(&told, MOMENT, || std::thread::sleep(60 * Duration::from_secs(1))).unwrap(), None);
        assert!(began.elapsed() < 30 * second);
        // What is ready soon is kept.
        let soon = || std::thread::sleep(MOMENT);
        assert_eq!(within(&told, 30 * second, soon).unwrap(), Some(()));
    }
}
