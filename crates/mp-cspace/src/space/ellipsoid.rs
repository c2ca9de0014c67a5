//! Uniform samples of an ellipsoid.

use crate::Rng;
use rand::RngExt;

/// Fills `out` with a point uniform among those whose Euclidean distances to `from` and to `to` add
/// up to at most `sum` (Gammell, Srinivasa and Barfoot 2014). Where there is none, a point between
/// the two.
pub(super) fn sample(from: &[f64], to: &[f64], sum: f64, rng: &mut Rng, out: &mut [f64]) {
    let n = out.len();
    let between = from.iter().zip(to).map(|(a, b)| (b - a) * (b - a)).sum::<f64>().sqrt();
    // A point of the unit ball: a direction by normal deviates, a radius by its volume.
    let mut norm = 0.0;
    for x in out.iter_mut() {
        *x = rng.normal();
        norm += *x * *x;
    }
    let radius = mp_math::powf(rng.random::<f64>(), 1.0 / n as f64) / norm.sqrt().max(f64::MIN_POSITIVE);
    let sum = sum.max(between);
    let across = 0.5 * (sum * sum - between * between).max(0.0).sqrt();
    for (i, x) in out.iter_mut().enumerate() {
        *x *= radius * if i == 0 { 0.5 * sum } else { across };
    }
    // A reflection takes the first axis to the direction from `from` to `to`. It serves as well as a
    // rotation, as a ball stretched along one axis is its own mirror image.
    let axis = |i: usize| if between > 0.0 { (to[i] - from[i]) / between } else { f64::from(i == 0) };
    let mirror = |i: usize| f64::from(i == 0) - axis(i);
    let square: f64 = (0..n).map(|i| mirror(i) * mirror(i)).sum();
    if square > 0.0 {
        let along: f64 = (0..n).map(|i| mirror(i) * out[i]).sum();
        for (i, x) in out.iter_mut().enumerate() {
            *x -= 2.0 * along / square * mirror(i);
        }
    }
    for (i, x) in out.iter_mut().enumerate() {
        *x += 0.5 * (from[i] + to[i]);
    }
}

#[cfg(test)]
mod tests {
    use crate::{Rn, Rng, Space};
    use nalgebra::{SVector, Vector3};

    /// Where the box cuts nothing off, the counts in parts of known volume agree with the volumes.
    #[test]
    fn the_ellipsoid_is_filled_evenly() {
        let space = Rn::<3>::new([-9.0; 3], [9.0; 3]).unwrap();
        let (a, b) = (Vector3::new(1.0, -0.5, 0.3), Vector3::new(-0.4, 1.1, 0.9));
        let between = space.distance(&a, &b);
        let mut rng = Rng::seed(1);
        let n = 20_000;
        let (mut inner, mut near_a, mut above) = (0, 0, 0);
        let sum = 1.5 * between;
        let axis = (b - a) / between;
        for _ in 0..n {
            let q = space.sample_between(&a, &b, sum, &mut rng).unwrap();
            assert!(space.distance(&a, &q) + space.distance(&q, &b) <= sum * (1.0 + 1e-12));
            // The same shape at half the size is an eighth of the volume.
            let middle = (q - 0.5 * (a + b)) * 2.0 + 0.5 * (a + b);
            inner += usize::from(space.distance(&a, &middle) + space.distance(&middle, &b) <= sum);
            near_a += usize::from((q - 0.5 * (a + b)).dot(&axis) < 0.0);
            above += usize::from((q - 0.5 * (a + b)).dot(&axis.cross(&Vector3::x())) > 0.0);
        }
        let close = |count: usize, part: f64| (count as f64 / f64::from(n) - part).abs() < 0.012;
        assert!(close(inner, 0.125) && close(near_a, 0.5) && close(above, 0.5), "{inner} {near_a} {above}");
    }

    #[test]
    fn samples_stay_in_the_box_and_between_when_there_is_no_room() {
        let space = Rn::<2>::new([0.0; 2], [1.0; 2]).unwrap();
        let (a, b) = (SVector::from([0.0, 0.5]), SVector::from([1.0, 0.5]));
        let mut rng = Rng::seed(2);
        for sum in [0.5, 1.0, 1.1, 3.0] {
            for _ in 0..500 {
                let s = space.sample_between(&a, &b, sum, &mut rng).unwrap();
                assert!(space.contains(&s));
                assert!(sum > 1.0 || (s.y - 0.5).abs() < 1e-12, "{s}");
            }
        }
        let same = space.sample_between(&a, &a, 0.2, &mut rng).unwrap();
        assert!((same - a).norm() <= 0.1 + 1e-12);
        assert_eq!(space.sample_between(&a, &a, -0.2, &mut rng), Some(a));
    }
}
