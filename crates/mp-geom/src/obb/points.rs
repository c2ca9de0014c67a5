//! Points by their coordinates, so that loops over them work on several at a time.

use nalgebra::{Matrix3, Vector3};

/// How many numbers are compared at a time.
pub(super) const LANES: usize = 8;
/// Fewer points than these are worked on one by one: lanes would not be faster.
pub(super) const FEW: usize = 100;
/// The least and the largest of no numbers.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Points, metres.
#[derive(Clone, Debug, Default)]
pub(super) struct Points([Vec<f64>; 3]);

impl FromIterator<Vector3<f64>> for Points {
    fn from_iter<I: IntoIterator<Item = Vector3<f64>>>(points: I) -> Self {
        let mut all = Self::default();
        for p in points {
            all.0.iter_mut().zip(p.iter()).for_each(|(axis, v)| axis.push(*v));
        }
        all
    }
}

impl Points {
    pub(super) fn len(&self) -> usize {
        self.0[0].len()
    }

    pub(super) fn get(&self, i: usize) -> Vector3<f64> {
        Vector3::from_fn(|k, _| self.0[k][i])
    }

    /// The largest coordinate, without its sign.
    pub(super) fn largest(&self) -> f64 {
        self.0.iter().flatten().fold(0.0, |most, v| most.max(v.abs()))
    }

    /// The coordinate of each point along `d`.
    pub(super) fn along(&self, d: Vector3<f64>) -> impl Iterator<Item = f64> {
        let [x, y, z] = &self.0;
        x.iter().zip(y).zip(z).map(move |((x, y), z)| x * d.x + y * d.y + z * d.z)
    }

    /// The least and the largest coordinates along the columns of `frame`.
    pub(super) fn extents(&self, frame: &Matrix3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let mut lanes = Vec::new();
        let [x, y, z] = [0, 1, 2].map(|k| {
            let along = self.along(frame.column(k).into_owned());
            if self.len() < FEW {
                return along.fold(NOTHING, |[low, high], v| [low.min(v), high.max(v)]);
            }
            lanes.clear();
            lanes.extend(along);
            range(&lanes)
        });
        (Vector3::new(x[0], y[0], z[0]), Vector3::new(x[1], y[1], z[1]))
    }
}

/// The least and the largest of some numbers; [`NOTHING`] of none.
fn range(values: &[f64]) -> [f64; 2] {
    let [mut low, mut high] = NOTHING.map(|v| [v; LANES]);
    let (whole, rest) = values.as_chunks::<LANES>();
    for v in whole {
        for k in 0..LANES {
            low[k] = if v[k] < low[k] { v[k] } else { low[k] };
            high[k] = if v[k] > high[k] { v[k] } else { high[k] };
        }
    }
    let all = |of: [f64; LANES]| of.into_iter().chain(rest.iter().copied());
    [all(low).fold(NOTHING[0], f64::min), all(high).fold(NOTHING[1], f64::max)]
}

/// The first of the least, and the first of the largest of some numbers.
pub(super) fn extremes(values: &[f64]) -> [usize; 2] {
    range(values).map(|extreme| values.iter().position(|v| *v == extreme).unwrap_or(0))
}
