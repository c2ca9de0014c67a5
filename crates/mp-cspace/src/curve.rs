//! Curves through spaces of coordinates.

/// A curve made of polynomials, such as what a controller runs between the knots of a trajectory.
///
/// Coordinates are those of a configuration. Angles do not jump: on circles they may leave (-π, π].
pub trait Curve {
    /// How many pieces there are, one after the other.
    fn pieces(&self) -> usize;

    /// The polynomial of a coordinate over a piece: its coefficients, the constant first, where the variable is the fraction of the
    /// piece in \[0, 1\].
    fn polynomial(&self, piece: usize, coordinate: usize) -> [f64; 6];
}
