//! Capsules: all points near a segment of the axis Z.

use super::{Primitive, SEGMENTS, grown};

/// The radius, and the length of the segment: the capsule is longer by two radii.
pub(super) const KIND: Primitive = Primitive {
    name: "capsule",
    lengths: &["radius", "length"],
    // Flat faces in both directions.
    mesh: |lengths| {
        crate::primitives::capsule(lengths[0] * grown() * grown(), lengths[1], SEGMENTS, SEGMENTS / 4)
    },
};
