//! What a robot may tell planners of its obstacles, beside whether it touches one.

mod gradient;
mod hints;

pub use gradient::ClearanceGradient;
pub use hints::{BodyFeatures, ObstacleGeometry, ObstacleHints, PointOf};
