//! Ctrl-C and SIGTERM: the first one ends the work in good order, the next one ends the program at once.

use mp_plan::Cancel;
use mp_stop::signals;
use std::time::Duration;

/// Does this at the first signal. The next one ends the program at once.
pub(crate) fn on_first(action: impl Fn() + Send + 'static) {
    if let Err(e) = signals::on_first(Duration::ZERO, action) {
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
