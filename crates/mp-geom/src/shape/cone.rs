//! Cones about Z, apex up.

use super::{Primitive, SEGMENTS, grown};

/// The radius of the base, and the height.
pub(super) const KIND: Primitive = Primitive {
    name: "cone",
    lengths: &["radius", "height"],
    // The faces touch the cone: each contains a line from the base to the apex.
    mesh: |lengths| crate::primitives::cone(lengths[0] * grown(), lengths[1], SEGMENTS),
};
