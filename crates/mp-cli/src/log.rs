//! Logs on standard error: `RUST_LOG=info` or `debug`, none by default but warnings.

use tracing_subscriber::filter::LevelFilter;

/// Begins to write logs.
pub(crate) fn init() {
    let level = std::env::var("RUST_LOG").ok();
    // Of a filter for parts of the program, such as `mp_plan=debug`, the level counts for all.
    let word = level.as_deref().and_then(|l| l.rsplit(['=', ',']).next()).map(str::trim);
    let level = word.and_then(|word| word.parse().ok()).unwrap_or(LevelFilter::WARN);
    tracing_subscriber::fmt().with_max_level(level).with_writer(std::io::stderr).init();
}
