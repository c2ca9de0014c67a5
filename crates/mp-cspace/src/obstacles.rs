//! What planners may query about obstacles beside collision: the clearance gradient, hints and geometry.

mod gradient;
mod hints;

pub use gradient::ClearanceGradient;
pub use hints::{BodyFeatures, BodySphere, ObstacleGeometry, ObstacleHints, PointOf};
