//! Regular tetrahedra, a corner up.

use super::Primitive;

/// The length of the edges.
pub(super) const KIND: Primitive = Primitive {
    name: "tetrahedron",
    lengths: &["edge"],
    mesh: |lengths| crate::primitives::tetrahedron(lengths[0]),
};
