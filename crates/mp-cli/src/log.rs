//! Logs on standard error: `RUST_LOG=info` or `debug`; by default only warnings.

use tracing_subscriber::filter::LevelFilter;

/// Starts logging.
pub(crate) fn init() {
    let level = std::env::var("RUST_LOG").ok();
    // The level of a filter for one crate, such as `mp_plan=debug`, is used for all crates.
    let word = level.as_deref().and_then(|l| l.rsplit(['=', ',']).next()).map(str::trim);
    let level = word.and_then(|word| word.parse().ok()).unwrap_or(LevelFilter::WARN);
    tracing_subscriber::fmt().with_max_level(level).with_writer(std::io::stderr).init();
}
