//! Clearance and its gradient, by which motions bend away from obstacles.

/// The clearance of a state, and the direction of the space in which it grows.
///
/// Answers only guide: no motion is accepted by them, so they may be rough (an image, a blurred map, a
/// formula of the user). Closures implement it.
///
/// ```
/// use mp_cspace::obstacles::ClearanceGradient;
/// use nalgebra::Vector2;
/// // A point, one metre or more from the origin.
/// let mut field = |q: &Vector2<f64>, _reach: f64, gradient: &mut [f64]| {
///     let distance = q.norm();
///     gradient.copy_from_slice((q / distance).as_slice());
///     distance - 1.0
/// };
/// let mut gradient = [0.0; 2];
/// let clearance = field.clearance_gradient(&Vector2::new(3.0, 4.0), f64::INFINITY, &mut gradient);
/// assert_eq!((clearance, gradient), (4.0, [0.6, 0.8]));
/// ```
pub trait ClearanceGradient<S> {
    /// The signed clearance (m) of `q`, and its gradient.
    ///
    /// - Free: the distance to the nearest obstacle. For a state at least `reach` (m) away, any number of at
    ///   least `reach` will do, with a gradient of zeros: the caller ignores obstacles that far.
    /// - In collision: zero or less, minus the depth where depth is known. The gradient then should point
    ///   out of the obstacle; zeros where that direction is not known.
    /// - `gradient` has one number per degree of freedom, in the order of the velocities of
    ///   [`Space::moved`](crate::Space::moved): translations (m/m) before rotations (m/rad), about world
    ///   axes. So the clearance after moving at velocity `v` for a short time `t` is
    ///   `clearance + t·gradient·v`. Every entry is written, and is finite; where the clearance has a kink,
    ///   any of the adjacent gradients will do.
    fn clearance_gradient(&mut self, q: &S, reach: f64, gradient: &mut [f64]) -> f64;
}

impl<S, F: FnMut(&S, f64, &mut [f64]) -> f64> ClearanceGradient<S> for F {
    #[inline]
    fn clearance_gradient(&mut self, q: &S, reach: f64, gradient: &mut [f64]) -> f64 {
        self(q, reach, gradient)
    }
}
