//! Tori about Z.

use super::{Primitive, SEGMENTS, grown};
use crate::PrimitiveError;
use crate::primitives::positive;
use std::f64::consts::PI;

/// Sides of the tube.
const TUBE_SEGMENTS: u32 = SEGMENTS / 2;

/// The radius of the ring, and that of the tube, which is smaller.
pub(super) const KIND: Primitive = Primitive {
    name: "torus",
    lengths: &["ring radius", "tube radius"],
    mesh: |lengths| {
        let (ring, tube) = (positive("ring radius", lengths[0])?, positive("tube radius", lengths[1])?);
        if tube >= ring {
            return Err(PrimitiveError::FatTorus { ring, tube });
        }
        // Between two of its vertices a segment of the ring is nearer to the axis, by so much at most.
        let sag = (ring + tube) * (grown() - 1.0);
        let around = (tube + sag) / mp_math::cos(PI / f64::from(TUBE_SEGMENTS));
        // The hole of one that is almost as fat as its ring is left open by rounding alone.
        crate::primitives::torus(ring.max(around * (1.0 + 1e-9)), around, SEGMENTS, TUBE_SEGMENTS)
    },
};
