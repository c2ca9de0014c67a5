//! Ctrl-C: the first one cancels the run, the second one ends the program at once.

use mp_plan::Cancel;

/// A flag that is set by the first Ctrl-C. The second one ends the program at once.
pub(crate) fn flag() -> Cancel {
    let cancel = Cancel::new();
    let raised = cancel.clone();
    let handler = ctrlc::set_handler(move || {
        if raised.0.swap(true, std::sync::atomic::Ordering::SeqCst) {
            std::process::exit(130);
        }
    });
    if let Err(e) = handler {
        tracing::warn!("Ctrl-C will end the program at once: {e}");
    }
    cancel
}
