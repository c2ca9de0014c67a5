//! OMPL.app: its problem files, and problems exported for other planners. See `docs/formats/ompl-app.md`.

mod config;
mod export;
mod load;
#[cfg(test)]
mod tests;

pub use config::{OmplProblem, OmplState};
pub use export::{OmplExport, export_ompl, exported_files};
pub(crate) use load::load;

/// The page that describes the format.
pub(crate) const GUIDE: &str = "ompl-app.md";
