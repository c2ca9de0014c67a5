//! Motion checks: sampled at a resolution, certified by clearance, and a plain one to verify with.

mod certified;
mod coarse_to_fine;
mod discrete;
mod fine;
mod spaced;

pub use certified::Certified;
pub use coarse_to_fine::CoarseToFine;
pub use discrete::Discrete;
pub use fine::FineDiscrete;
pub use spaced::Spaced;
