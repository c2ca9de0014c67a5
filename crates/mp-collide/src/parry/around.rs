//! Meshes around a solid.

use mp_geom::{TriMesh, primitives};
use std::f64::consts::{FRAC_PI_2, PI};

use super::ParryError;
use crate::solid::{Dimensions, Solid};

/// A mesh that contains the solid and extends nowhere more than `excess` beyond it.
pub(super) fn mesh(solid: &Solid, excess: f64) -> Result<TriMesh, ParryError> {
    if excess.is_nan() || excess <= 0.0 {
        return Err(out_of_range(excess));
    }
    // The meshes of `primitives` are inscribed: they are enlarged until their faces touch the solid from outside.
    match solid.dimensions() {
        Dimensions::Cuboid { half } => Ok(primitives::cuboid(2.0 * half.x, 2.0 * half.y, 2.0 * half.z)?),
        Dimensions::Cylinder { radius, half } => {
            let (n, larger) = segments(radius, excess)?;
            Ok(primitives::cylinder(radius * larger, 2.0 * half, n)?)
        }
        Dimensions::Cone { radius, half } => {
            let (n, larger) = segments(radius, excess)?;
            Ok(primitives::cone(radius * larger, 2.0 * half, n)?)
        }
        Dimensions::Capsule { radius, half } => {
            // A little less than half for the circles about the axis and for those through the poles: the factors multiply.
            let (n, larger) = segments(radius, 0.45 * excess)?;
            let rings = n.div_ceil(4);
            let bands = 1.0 / mp_math::cos(0.5 * FRAC_PI_2 / f64::from(rings));
            Ok(primitives::capsule(radius * larger * bands, 2.0 * half, n, rings)?)
        }
        Dimensions::Ball { radius } => {
            for subdivisions in 0..=primitives::MAX_SUBDIVISIONS {
                let unit = primitives::sphere(1.0, subdivisions)?;
                let planes = (0..unit.triangles().len()).map(|i| {
                    let [a, b, c] = unit.triangle(i);
                    (b - a).cross(&(c - a)).normalize().dot(&a.coords)
                });
                let larger = 1.0 / planes.fold(1.0, f64::min);
                if radius * (larger - 1.0) <= excess {
                    return Ok(primitives::sphere(radius * larger, subdivisions)?);
                }
            }
            Err(out_of_range(excess))
        }
        Dimensions::HalfSpace => Err(ParryError::Unbounded),
    }
}

/// The number of segments, a multiple of four, of a polygon around a circle that extends nowhere more than `excess` beyond
/// it, and the factor by which the polygon is larger than the circle.
fn segments(radius: f64, excess: f64) -> Result<(u32, f64), ParryError> {
    let angle = mp_math::acos(radius / (radius + excess));
    let wanted = (PI / angle / 4.0).ceil() * 4.0;
    if wanted.is_nan() || wanted > f64::from(primitives::MAX_SEGMENTS) {
        return Err(out_of_range(excess));
    }
    let n = (wanted as u32).max(8);
    Ok((n, 1.0 / mp_math::cos(PI / f64::from(n))))
}

fn out_of_range(value: f64) -> ParryError {
    let range = "positive, and no smaller than some millionths of the radius";
    ParryError::Parameter { name: "how far a mesh may be beyond a solid (metres)", value, range }
}
