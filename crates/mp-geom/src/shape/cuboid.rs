//! Boxes.

use super::Primitive;

/// The lengths of the sides.
pub(super) const KIND: Primitive = Primitive {
    name: "box",
    lengths: &["length in x", "length in y", "length in z"],
    mesh: |sides| crate::primitives::cuboid(sides[0], sides[1], sides[2]),
};
