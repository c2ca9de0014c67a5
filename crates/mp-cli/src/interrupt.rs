//! Ctrl-C: the first one ends the work in good order, the second one ends the program at once.

use mp_plan::Cancel;
use std::sync::atomic::{AtomicBool, Ordering};

/// Does this on the first Ctrl-C. The second one ends the program at once.
pub(crate) fn on_first(action: impl Fn() + Send + 'static) {
    let asked = AtomicBool::new(false);
    let handler = ctrlc::set_handler(move || {
        if asked.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
        action();
    });
    if let Err(e) = handler {
        tracing::warn!("Ctrl-C will end the program at once: {e}");
    }
}

/// A flag that is set by the first Ctrl-C. The second one ends the program at once.
pub(crate) fn flag() -> Cancel {
    let cancel = Cancel::new();
    let raised = cancel.clone();
    on_first(move || raised.cancel());
    cancel
}
