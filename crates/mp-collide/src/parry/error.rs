//! Errors of conversions from and to parry.

use mp_geom::{MeshError, PrimitiveError};
use thiserror::Error;

use crate::filled::FillError;

/// Why a shape could not be converted, or a hull or decomposition not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ParryError {
    /// A mesh that parry allows and [`mp_geom::TriMesh`] refuses: no triangles, an index out of range, a coordinate that is not finite.
    #[error("a mesh of parry is not valid here: {0}; repair it first")]
    Mesh(#[from] MeshError),
    /// A length that parry allows and [`Solid`](crate::Solid) refuses: zero, negative or not finite.
    #[error("a shape of parry has no volume: {0}; leave it out or give it a size")]
    Size(#[from] PrimitiveError),
    /// A solid mesh whose surface encloses nothing.
    #[error("a convex polyhedron of parry cannot be filled: {0}")]
    Fill(#[from] FillError),
    /// A rotation that is not of unit length (within 1e-6), or numbers that are not finite.
    #[error("a pose of parry is not a finite rigid motion; normalise its rotation, check its numbers")]
    BadPose,
    /// The normal of a half-space is zero or not finite.
    #[error("the normal ({x}, {y}, {z}) of a half-space has no direction; give it a finite length above 0")]
    BadNormal {
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
        /// Its z.
        z: f64,
    },
    /// A shape with a round border.
    #[error(
        "a {what} with a round border of {border} m cannot be converted; convert its inner shape and ask \
         whether anything is within {border} m of that, or put a larger {what} without border in its place"
    )]
    Round {
        /// What the border is around.
        what: &'static str,
        /// Its radius (metres).
        border: f64,
    },
    /// A shape of the user's own.
    #[error("a custom shape of parry says nothing of its geometry; convert a mesh of it instead")]
    Custom,
    /// A part of a compound could not be converted.
    #[error("part {part} of a compound: {source}")]
    Part {
        /// Which part, counted from 0.
        part: usize,
        /// What is wrong.
        #[source]
        source: Box<ParryError>,
    },
    /// A half-space has no mesh.
    #[error(
        "a half-space is not bounded, so there is no mesh of it; compare with it as a `Solid`, or use a box"
    )]
    Unbounded,
    /// A parameter is out of its range.
    #[error("{name} must be {range}, not {value}")]
    Parameter {
        /// Which.
        name: &'static str,
        /// What it was.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// All points are in a plane (within a billionth of their extent), on a line or in one place.
    #[error("the points are all in one plane, so their hull has no volume; use the mesh as it is")]
    Flat,
    /// Points that nearly coincide, by some 1e-75 of the largest coordinate: too close for exact arithmetic.
    #[error("points that differ by less than some 1e-75 of the largest coordinate; merge them")]
    TooClose,
    /// An algorithm of parry panicked.
    #[error("parry's {what} panicked; merge vertices that nearly coincide, or change its parameters")]
    Failed {
        /// Which algorithm.
        what: &'static str,
    },
}
