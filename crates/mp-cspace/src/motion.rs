//! Motion checks: sampled at a resolution, certified by clearance, and a plain one to verify with.

mod certified;
mod discrete;
mod fine;

pub use certified::Certified;
pub use discrete::Discrete;
pub use fine::FineDiscrete;
