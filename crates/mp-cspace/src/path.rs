//! Paths, and their independent verification.

pub(crate) mod clearance;
mod verify;

pub use clearance::{Tightest, least_clearance};
pub use verify::{PathFault, PathReport, verify_path};

use crate::{MotionCheck, MotionValidity, ParameterError, Space};
use thiserror::Error;

/// A sequence of states and the edges between them (`edges.len() + 1 == states.len()`).
///
/// Between the states of a `Path<S>`, whose edges are `()`, the space interpolates.
///
/// With the feature `serde` it is written as an object with the members `states` and `edges`. Reading refuses
/// a path whose numbers of states and edges do not fit. The file does not say whether the path is free:
/// verify it after reading.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Written<S, E>")
)]
pub struct Path<S, E = ()> {
    /// The states, start first.
    pub states: Vec<S>,
    /// `edges[i]` leads from `states[i]` to `states[i + 1]`.
    pub edges: Vec<E>,
}

/// A path as read, before the numbers of its states and edges are checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Written<S, E> {
    states: Vec<S>,
    edges: Vec<E>,
}

#[cfg(feature = "serde")]
impl<S, E> TryFrom<Written<S, E>> for Path<S, E> {
    type Error = String;
    fn try_from(Written { states, edges }: Written<S, E>) -> Result<Self, String> {
        match (states.len(), edges.len()) {
            (0, 0) => Ok(Self { states, edges }),
            (n, m) if n == m + 1 => Ok(Self { states, edges }),
            (n, m) => Err(format!("a path of {n} states has {m} edges, not {}", n.saturating_sub(1))),
        }
    }
}

/// Why two paths cannot be joined.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the second path starts at a distance of {distance} from where the first ends")]
pub struct GapError {
    /// The distance between the end of the first and the start of the second; infinite when one
    /// of them is empty.
    pub distance: f64,
}

impl<S> Path<S> {
    /// The path through `states`, straight between them.
    #[must_use]
    pub fn straight(states: Vec<S>) -> Self {
        let edges = vec![(); states.len().saturating_sub(1)];
        Self { states, edges }
    }

    /// The same path backwards.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        self.states.reverse();
        self
    }

    /// Its length in the metric of the space.
    pub fn length<C: Space<State = S>>(&self, space: &C) -> f64 {
        // The sum of no numbers is −0.
        0.0 + self.states.windows(2).map(|w| space.distance(&w[0], &w[1])).sum::<f64>()
    }

    /// A lower bound (m) on the clearance along the path, or `None` when some edge is not found
    /// free. As sharp as that of `check`; [`least_clearance`] gives a sharp one.
    pub fn clearance(&self, check: &mut impl MotionValidity<S>) -> Option<f64> {
        if let [only] = self.states.as_slice() {
            return free_clearance(check.check_motion(only, only));
        }
        self.states.windows(2).try_fold(f64::INFINITY, |least, w| {
            free_clearance(check.check_motion(&w[0], &w[1])).map(|c| c.min(least))
        })
    }

    /// The state at arc length `s` from the start, clamped to the path; `None` on the empty path.
    pub fn at<C: Space<State = S>>(&self, space: &C, s: f64) -> Option<S>
    where
        S: Clone,
    {
        let mut left = s;
        for w in self.states.windows(2) {
            let length = space.distance(&w[0], &w[1]);
            if left < length {
                return Some(space.interpolate(&w[0], &w[1], (left / length).max(0.0)));
            }
            left -= length;
        }
        self.states.last().cloned()
    }

    /// The same path with states added on its edges, so that no two neighbours are farther apart than
    /// `spacing`. All its states remain.
    ///
    /// # Errors
    /// When `spacing` is not positive and finite, or so small that it takes over 10⁷ states.
    pub fn resampled<C: Space<State = S>>(&self, space: &C, spacing: f64) -> Result<Self, ParameterError>
    where
        S: Clone,
    {
        let spacing = ParameterError::positive("the spacing", spacing)?;
        let mut states: Vec<S> = self.states.first().cloned().into_iter().collect();
        for w in self.states.windows(2) {
            let parts = (space.distance(&w[0], &w[1]) / spacing).ceil();
            if states.len() as f64 + parts > 1e7 {
                let expected = "large enough for at most ten million states";
                return Err(ParameterError { name: "the spacing", expected, value: spacing });
            }
            let parts = parts as u32;
            let between = (1..parts).map(|i| f64::from(i) / f64::from(parts));
            states.extend(between.map(|t| space.interpolate(&w[0], &w[1], t)));
            states.push(w[1].clone());
        }
        Ok(Self::straight(states))
    }

    /// This path followed by `next`, which starts where this one ends.
    ///
    /// # Errors
    /// When there is a gap between them or one is empty.
    pub fn then<C: Space<State = S>>(mut self, next: Self, space: &C) -> Result<Self, GapError> {
        let distance = match (self.states.last(), next.states.first()) {
            (Some(a), Some(b)) => space.distance(a, b),
            _ => f64::INFINITY,
        };
        if distance != 0.0 {
            return Err(GapError { distance });
        }
        self.states.extend(next.states.into_iter().skip(1));
        Ok(Self::straight(self.states))
    }
}

fn free_clearance(check: MotionCheck) -> Option<f64> {
    match check {
        MotionCheck::Free { clearance } => Some(clearance),
        MotionCheck::Collision { .. } | MotionCheck::Unproven { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rn;
    use nalgebra::Vector2;

    fn corner() -> (Rn<2>, Path<Vector2<f64>>) {
        let space = Rn::new([0.0, 0.0], [10.0, 10.0]).unwrap();
        let states = [(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)].map(|(x, y)| Vector2::new(x, y));
        (space, Path::straight(states.to_vec()))
    }

    #[cfg(feature = "serde")]
    #[test]
    fn paths_are_written_and_read() {
        let (_, path) = corner();
        let text = serde_json::to_string(&path).unwrap();
        assert_eq!(text, r#"{"states":[[0.0,0.0],[3.0,0.0],[3.0,4.0]],"edges":[null,null]}"#);
        assert_eq!(serde_json::from_str::<Path<Vector2<f64>>>(&text).unwrap(), path);
        let short = r#"{"states": [[0.0, 0.0]], "edges": [null]}"#;
        let error = serde_json::from_str::<Path<Vector2<f64>>>(short).unwrap_err().to_string();
        assert!(error.contains("a path of 1 states has 1 edges, not 0"), "{error}");
        let pose = crate::Se2State::new(1.0, 2.0, 0.5);
        let text = serde_json::to_string(&pose).unwrap();
        assert_eq!(serde_json::from_str::<crate::Se2State>(&text).unwrap(), pose);
    }

    #[test]
    fn lengths_and_states_by_arc_length() {
        let (space, path) = corner();
        assert_eq!(path.length(&space), 7.0);
        assert!(Path::straight(vec![path.states[0]]).length(&space).is_sign_positive());
        for (s, x, y) in
            [(-1.0, 0.0, 0.0), (1.5, 1.5, 0.0), (3.0, 3.0, 0.0), (5.0, 3.0, 2.0), (9.0, 3.0, 4.0)]
        {
            assert_eq!(path.at(&space, s), Some(Vector2::new(x, y)));
        }
        assert_eq!(Path::straight(vec![]).at(&space, 1.0), None);
        assert_eq!(path.clone().reversed().at(&space, 4.0), Some(Vector2::new(3.0, 0.0)));
    }

    #[test]
    fn resampling_keeps_states_and_length() {
        let (space, path) = corner();
        let fine = path.resampled(&space, 0.3).unwrap();
        assert!(fine.states.windows(2).all(|w| (w[1] - w[0]).norm() <= 0.3 + 1e-12));
        assert!(path.states.iter().all(|q| fine.states.contains(q)));
        assert!((fine.length(&space) - 7.0).abs() < 1e-12);
        assert_eq!(fine.edges.len() + 1, fine.states.len());
        assert_eq!(path.resampled(&space, 100.0).unwrap(), path);
        assert!(path.resampled(&space, 0.0).is_err() && path.resampled(&space, 1e-9).is_err());
    }

    #[test]
    fn joining_needs_a_common_state() {
        let (space, path) = corner();
        let back = path.clone().reversed();
        let there_and_back = path.clone().then(back, &space).unwrap();
        assert_eq!(there_and_back.states.len(), 5);
        assert_eq!(there_and_back.length(&space), 14.0);
        assert_eq!(path.clone().then(path.clone(), &space), Err(GapError { distance: 5.0 }));
        assert!(path.then(Path::straight(vec![]), &space).is_err());
    }
}
