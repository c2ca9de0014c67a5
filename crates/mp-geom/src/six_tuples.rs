//! Paths as six-tuples, close enough together for players that interpolate the six numbers.

use crate::{pose_from_six, six_from_pose};
use nalgebra::Isometry3;
use std::f64::consts::{PI, TAU};

/// Between two tuples no point of the robot moves farther than this many times the robot's radius.
const SPACING: f64 = 0.25;
/// A player that interpolates the six numbers puts no point of the robot farther off than this many radii.
const DEVIATION: f64 = 0.01;
/// A segment is split into at most 2 to the power of this many parts.
const DEPTH: u32 = 10;

/// Six-tuples (x, y, z, α, β, γ) along the motion through `segments + 1` poses, where `at(i, t)` is the pose
/// at fraction `t` of segment `i`. Angles are continuous along the path, so they may leave (-π, π]. `radius`
/// is the distance of the robot's farthest point from its origin.
#[must_use]
pub fn six_tuples(segments: usize, radius: f64, at: impl Fn(usize, f64) -> Isometry3<f64>) -> Vec<[f64; 6]> {
    // Adding zero removes the sign of negative zeros.
    let six = |pose: &Isometry3<f64>| six_from_pose(pose).map(|v| v + 0.0);
    let mut out = vec![six(&at(0, 0.0))];
    for i in 0..segments {
        let mut todo = vec![(0.0, 1.0, 0)];
        while let Some((from, to, depth)) = todo.pop() {
            let last = out[out.len() - 1];
            let (a, b) = (at(i, from), at(i, to));
            let next = continued_six(&last, &six(&b));
            let middle = 0.5 * (from + to);
            let played = pose_from_six(std::array::from_fn(|k| 0.5 * (last[k] + next[k])));
            let fine = displacement_bound(&a, &b, radius) <= SPACING * radius
                && displacement_bound(&played, &at(i, middle), radius) <= DEVIATION * radius;
            if fine || depth == DEPTH {
                out.push(next);
            } else {
                todo.push((middle, to, depth + 1));
                todo.push((from, middle, depth + 1));
            }
        }
    }
    out
}

/// An upper bound on how far any point within `radius` of the origin moves from `a` to `b`.
#[must_use]
pub fn displacement_bound(a: &Isometry3<f64>, b: &Isometry3<f64>, radius: f64) -> f64 {
    (a.translation.vector - b.translation.vector).norm() + radius * a.rotation.angle_to(&b.rotation)
}

/// The six-tuple of the same pose as `six` whose angles differ least from those of `last`: they may leave
/// (-π, π].
#[must_use]
pub fn continued_six(last: &[f64; 6], six: &[f64; 6]) -> [f64; 6] {
    let [x, y, z, a, b, g] = *six;
    // The same rotation has two triples of angles, each up to whole turns.
    let near = |angle: f64, k: usize| angle + TAU * ((last[k] - angle) / TAU).round() + 0.0;
    let write = |a, b, g| [x, y, z, near(a, 3), near(b, 4), near(g, 5)];
    let (one, other) = (write(a, b, g), write(a + PI, PI - b, g + PI));
    let change = |s: &[f64; 6]| (3..6).map(|k| (s[k] - last[k]).abs()).sum::<f64>();
    if change(&other) + 1e-9 < change(&one) { other } else { one }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion, Vector3};
    use proptest::prelude::*;

    fn pose(x: f64, axis: [f64; 3]) -> Isometry3<f64> {
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(axis));
        Isometry3::from_parts(Translation3::new(x, 0.0, 0.0), rotation)
    }

    proptest! {
        #[test]
        fn tuples_stay_on_the_motion_and_close_together(
            a in prop::array::uniform3(-2.0..2.0f64),
            b in prop::array::uniform3(-2.0..2.0f64),
            x in -3.0..3.0f64,
        ) {
            let (from, to) = (pose(0.0, a), pose(x, b));
            let Some(_) = from.try_lerp_slerp(&to, 0.5, 1e-9) else { return Ok(()) };
            let at = |_: usize, t: f64| from.try_lerp_slerp(&to, t, 1e-9).unwrap_or(from);
            let tuples = six_tuples(1, 1.0, at);
            prop_assert!(displacement_bound(&pose_from_six(tuples[0]), &from, 1.0) < 1e-7);
            prop_assert!(displacement_bound(&pose_from_six(tuples[tuples.len() - 1]), &to, 1.0) < 1e-7);
            let mut far = 0;
            for w in tuples.windows(2) {
                let step = displacement_bound(&pose_from_six(w[0]), &pose_from_six(w[1]), 1.0);
                prop_assert!(step <= SPACING + 1e-6, "{step}");
                // Only at the singularity of the angles may they jump.
                far += usize::from((3..6).any(|k| (w[0][k] - w[1][k]).abs() > 1.0));
            }
            prop_assert!(far <= 2, "{far} jumps in {}", tuples.len());
        }
    }

    #[test]
    fn turning_round_and_round_keeps_counting() {
        let at = |i: usize, t: f64| pose_from_six([0.0, 0.0, 0.0, 2.0 * (i as f64 + t), 0.0, 0.0]);
        let tuples = six_tuples(6, 1.0, at);
        assert!((tuples[tuples.len() - 1][3] - 12.0).abs() < 1e-9);
        assert!(tuples.windows(2).all(|w| w[1][3] > w[0][3]));
    }
}
