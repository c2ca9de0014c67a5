//! Paths with rounded corners.
//!
//! At each corner a parabola leads from one straight line to the next (Kunz and Stilman 2012 take arcs of circles). Its derivative goes
//! evenly from one direction to the other, so that accelerations along it are bounded at its ends.

use crate::TimeError;
use mp_cspace::Curve;

/// A path of straight lines, whose corners are rounded by parabolas. Its parameter is the length of the straight path, the Euclidean norm of all
/// joints.
#[derive(Clone, Debug)]
pub struct BlendedPath {
    points: Vec<Vec<f64>>,
    /// Which of the points that were given each of them is.
    indices: Vec<usize>,
    /// The direction of each line, of unit length.
    directions: Vec<Vec<f64>>,
    lengths: Vec<f64>,
    /// How far before and behind each corner its parabola begins and ends; zero where the robot stops.
    reaches: Vec<f64>,
    /// How far corners may be cut.
    allowed: f64,
}

/// A corner whose directions differ by less is none: the robot need not slow down there.
const STRAIGHT: f64 = 1e-9;
/// Points nearer to each other, as a part of the whole length, are one: they would be passed in a few nanoseconds, and times are rounded to those.
const ONE: f64 = 1e-8;

/// A part of a [`BlendedPath`], with two derivatives by its parameter at each end.
pub(crate) struct Part {
    pub(crate) length: f64,
    /// The corner that is rounded, or to which a line leads.
    pub(crate) corner: Option<usize>,
    pub(crate) rounds: bool,
    /// Where it begins: a point of the path.
    pub(crate) from: Vec<f64>,
    pub(crate) first: [Vec<f64>; 2],
    pub(crate) second: Vec<f64>,
    /// Whether the robot stops at its end.
    pub(crate) stops: bool,
}

impl BlendedPath {
    /// The path through `points`, whose corners are cut by no more than `deviation` (the Euclidean norm of all joints), and by no more than
    /// half of the lines that meet there. Points that repeat the one before, to a hundred-millionth of the whole, are left out; angles must not jump.
    ///
    /// # Errors
    /// When there are no two different points, they have different lengths, or a number is not finite.
    pub fn new(points: &[Vec<f64>], deviation: f64) -> Result<Self, TimeError> {
        let joints = points.first().map_or(0, Vec::len);
        for (point, q) in points.iter().enumerate() {
            if q.len() != joints {
                return Err(TimeError::Count {
                    what: "numbers of a point",
                    expected: joints,
                    found: q.len(),
                });
            }
            if !q.iter().all(|x| x.is_finite()) {
                return Err(TimeError::NotFinite { point });
            }
        }
        let least = ONE * points.windows(2).map(|w| distance(&w[0], &w[1])).sum::<f64>();
        let mut indices: Vec<usize> = Vec::new();
        for i in 0..points.len() {
            if indices.last().is_none_or(|last| distance(&points[*last], &points[i]) > least) {
                indices.push(i);
            }
        }
        if let [_, .., end] = indices.as_mut_slice() {
            *end = points.len() - 1;
        }
        let kept: Vec<Vec<f64>> = indices.iter().map(|i| points[*i].clone()).collect();
        if kept.len() < 2 {
            return Err(TimeError::TooFew { found: kept.len(), least: 2 });
        }
        let lengths: Vec<f64> = kept.windows(2).map(|w| distance(&w[0], &w[1])).collect();
        let direction = |(w, length): (&[Vec<f64>], &f64)| {
            w[0].iter().zip(&w[1]).map(|(a, b)| (b - a) / length).collect()
        };
        let directions: Vec<Vec<f64>> = kept.windows(2).zip(&lengths).map(direction).collect();
        let reach = |i: usize| {
            // The middle of the parabola is a quarter of its change of direction from the corner.
            let turn = distance(&directions[i], &directions[i + 1]);
            (0.5 * lengths[i].min(lengths[i + 1])).min(4.0 * deviation.max(0.0) / turn.max(STRAIGHT))
        };
        let reaches = (0..kept.len() - 2).map(reach).collect();
        Ok(Self { points: kept, indices, directions, lengths, reaches, allowed: deviation.max(0.0) })
    }

    /// How many corners there are: all points but the ends.
    #[must_use]
    pub fn corners(&self) -> usize {
        self.reaches.len()
    }

    /// The point at a corner.
    #[must_use]
    pub fn corner(&self, corner: usize) -> &[f64] {
        &self.points[corner + 1]
    }

    /// Which of the points that were given is at a corner.
    #[must_use]
    pub fn index(&self, corner: usize) -> usize {
        self.indices[corner + 1]
    }

    /// By how much corners may be cut (the Euclidean norm of all joints).
    pub(crate) fn allowed(&self) -> f64 {
        self.allowed
    }

    /// Whether the robot stops at a corner.
    #[must_use]
    pub fn stops(&self, corner: usize) -> bool {
        self.reaches[corner] == 0.0 && self.turn(corner) > STRAIGHT
    }

    /// How far the rounded path is from a corner: the Euclidean norm of all joints.
    #[must_use]
    pub fn deviation(&self, corner: usize) -> f64 {
        0.25 * self.reaches[corner] * self.turn(corner)
    }

    fn turn(&self, corner: usize) -> f64 {
        distance(&self.directions[corner], &self.directions[corner + 1])
    }

    /// Rounds a corner less: `factor` times as far from it, from 0 to 1. Zero makes the robot stop there, as do what is less and NaN.
    pub fn tighten(&mut self, corner: usize, factor: f64) {
        self.reaches[corner] *= if factor > 0.0 { factor.min(1.0) } else { 0.0 };
    }

    /// The curve around a corner; `None` where the robot stops.
    #[must_use]
    pub fn blend(&self, corner: usize) -> Option<Blend> {
        let reach = self.reaches[corner];
        let [before, after] = [&self.directions[corner], &self.directions[corner + 1]];
        let row = |((q, a), b): ((&f64, &f64), &f64)| [q - reach * a, 2.0 * reach * a, reach * (b - a)];
        (reach > 0.0)
            .then(|| Blend { rows: self.corner(corner).iter().zip(before).zip(after).map(row).collect() })
    }

    /// The parts, in order. Lines of no length are left out.
    pub(crate) fn parts(&self) -> Vec<Part> {
        let mut parts = Vec::new();
        let reach = |corner: Option<usize>| corner.and_then(|i| self.reaches.get(i)).copied().unwrap_or(0.0);
        for (i, (direction, length)) in self.directions.iter().zip(&self.lengths).enumerate() {
            let (before, after) = (reach(i.checked_sub(1)), reach(Some(i)));
            let corner = (i < self.corners()).then_some(i);
            let at =
                |s: f64| self.points[i].iter().zip(direction).map(|(q, d)| q + s * d).collect::<Vec<_>>();
            let straight = length - before - after;
            // What rounding leaves of lines between corners that are rounded as far as can be.
            if straight > 1e-12 * length {
                parts.push(Part {
                    length: straight,
                    corner,
                    rounds: false,
                    from: at(before),
                    first: [direction.clone(), direction.clone()],
                    second: vec![0.0; direction.len()],
                    stops: corner.is_some_and(|corner| self.stops(corner)),
                });
            }
            if let Some(corner) = corner.filter(|_| after > 0.0) {
                let next = &self.directions[i + 1];
                parts.push(Part {
                    length: 2.0 * after,
                    corner: Some(corner),
                    rounds: true,
                    from: at(length - after),
                    first: [direction.clone(), next.clone()],
                    second: direction.iter().zip(next).map(|(a, b)| (b - a) / (2.0 * after)).collect(),
                    stops: false,
                });
            }
        }
        parts
    }
}

/// The parabola around a corner: a [`Curve`] of one piece.
#[derive(Clone, Debug)]
pub struct Blend {
    rows: Vec<[f64; 3]>,
}

impl Curve for Blend {
    fn pieces(&self) -> usize {
        1
    }

    fn polynomial(&self, _: usize, coordinate: usize) -> [f64; 6] {
        let [a, b, c] = self.rows[coordinate];
        [a, b, c, 0.0, 0.0, 0.0]
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (b - a) * (b - a)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_cut_within_the_bound() {
        let points = [vec![0.0, 0.0], vec![2.0, 0.0], vec![2.0, 0.0], vec![2.0, 1.0], vec![0.0, 1.0]];
        let mut path = BlendedPath::new(&points, 0.1).unwrap();
        assert_eq!(path.corners(), 2);
        for corner in 0..2 {
            assert!((path.deviation(corner) - 0.1).abs() < 1e-12);
            let blend = path.blend(corner).unwrap();
            let at = |u: f64| {
                let c = [0, 1].map(|j| blend.polynomial(0, j));
                c.map(|c| c[0] + u * (c[1] + u * c[2]))
            };
            let nearest = (0..=1000).map(|i| distance(&at(f64::from(i) / 1000.0), path.corner(corner)));
            assert!((nearest.fold(9.0, f64::min) - 0.1).abs() < 1e-6);
        }
        // Each part begins where the one before ends.
        let parts = path.parts();
        assert_eq!(parts.len(), 5);
        for w in parts.windows(2) {
            let Part { length: s, from, first: [a, _], second, .. } = &w[0];
            let end: Vec<_> = (0..2).map(|j| from[j] + s * (a[j] + 0.5 * s * second[j])).collect();
            assert!(distance(&end, &w[1].from) < 1e-12);
        }
        path.tighten(0, 0.5);
        assert!((path.deviation(0) - 0.05).abs() < 1e-12);
        path.tighten(0, 0.0);
        assert!(path.stops(0) && path.blend(0).is_none() && path.parts().len() == 4 && path.parts()[0].stops);
        // Never more, and nothing of the path is left out.
        for (factor, stops) in [(9.0, false), (-1.0, true), (f64::NAN, true)] {
            let mut path = BlendedPath::new(&points, 0.1).unwrap();
            path.tighten(1, factor);
            assert_eq!((path.stops(1), path.deviation(1) <= 0.1 + 1e-12), (stops, true), "{factor}");
        }
        // No more than half of the lines, whatever is allowed.
        let wide = BlendedPath::new(&points, 10.0).unwrap();
        assert_eq!(wide.parts().len(), 4);
        assert!(BlendedPath::new(&points[1..3], 0.1).is_err());
        assert_eq!([path.index(0), path.index(1)], [1, 3]);
    }

    #[test]
    fn points_that_are_nearly_one_are_one() {
        let points = [0.0, 1e-13, 1.0, 1.0 + 1e-13, 2.0, 1.0, 1.0 + 1e-13].map(|x| vec![x, 0.0]);
        let path = BlendedPath::new(&points, 0.1).unwrap();
        assert_eq!(path.points, [0.0, 1.0, 2.0, 1.0 + 1e-13].map(|x| vec![x, 0.0]));
        assert_eq!([path.index(0), path.index(1)], [2, 4]);
        // Of a small path all points count.
        let small = points.map(|q| vec![1e-12 * q[0], 0.0]);
        assert_eq!(BlendedPath::new(&small, 0.1).unwrap().corners(), 2);
    }
}
