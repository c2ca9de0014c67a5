//! Cylinders about Z.

use super::{Primitive, SEGMENTS, grown};

/// Radius and height.
pub(super) const KIND: Primitive = Primitive {
    name: "cylinder",
    lengths: &["radius", "height"],
    mesh: |lengths| crate::primitives::cylinder(lengths[0] * grown(), lengths[1], SEGMENTS),
};
