//! Rotate-at-s: translation, rotation in place, translation.

use super::{Direction, Extension, LocalPlanner, Motion, PolylineEdge, Reach, check_toward};
use crate::{MotionValidity, ParameterError, Space};

/// The states before and after the turn of rotate-at-s from `from` to `to`. `at` in \[0, 1\].
pub fn turn_at<C: Space>(space: &C, from: &C::State, to: &C::State, at: f64) -> [C::State; 2] {
    let middle = space.interpolate(from, to, at);
    [space.with_rotation_of(&middle, from), space.with_rotation_of(&middle, to)]
}

/// The rotate-at-s local planner (Amato, Bayazit, Dale, Jones and Vallejo 1998, *Choosing good distance metrics
/// and local planners for probabilistic roadmap methods*): the straight line in three parts. The robot moves the fraction
/// `s` of the way without turning, turns in place, and moves the rest without turning.
///
/// It may be free where the straight line, which turns while it moves, sweeps into an obstacle. Usual values of `s` are
/// 0, 1/2 and 1. The cost is the length of the three parts; in a metric that adds translation and rotation it equals that
/// of the straight line. Reversed in time it is rotate-at-(1 - s), which backward trees therefore use.
///
/// ```
/// use mp_cspace::{Direction, Discrete, Extension, LocalPlanner, Reach, Length, RotateAtS, Se2, Se2State};
/// let space = Se2::new([0.0; 2], [4.0; 2])?;
/// // Turns only at x = 1.
/// let free = |q: &Se2State| q.angle == 0.0 || q.angle == 1.5 || (q.translation.x - 1.0).abs() < 1e-9;
/// let check = Discrete::new(&space, free, Length::Absolute(0.01))?;
/// let (from, to) = (Se2State::new(0.0, 1.0, 0.0), Se2State::new(4.0, 1.0, 1.5));
/// let mut local = RotateAtS::new(&space, check, 0.25)?;
/// let Extension::Reached(motion) = local.extend(&from, &to, Direction::Forward, Reach::Full) else { panic!() };
/// assert_eq!(motion.edge.vertices(), [Se2State::new(1.0, 1.0, 0.0), Se2State::new(1.0, 1.0, 1.5)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RotateAtS<'c, C, M> {
    /// The space to interpolate in.
    pub space: &'c C,
    /// The motion check: discrete, certified or a user's own.
    pub check: M,
    at: f64,
}

impl<'c, C: Space, M: MotionValidity<C::State>> RotateAtS<'c, C, M> {
    /// Motions in `space` that turn at fraction `at` of the way, checked by `check`.
    ///
    /// # Errors
    /// When `at` is not in \[0, 1\].
    pub fn new(space: &'c C, check: M, at: f64) -> Result<Self, ParameterError> {
        if !(0.0..=1.0).contains(&at) {
            return Err(ParameterError { name: "s, where to rotate", expected: "in [0, 1]", value: at });
        }
        Ok(Self { space, check, at })
    }

    /// The fraction of the way at which it turns.
    #[must_use]
    pub fn at(&self) -> f64 {
        self.at
    }

    /// The vertices after `from`, cut off at the length `most`; the length; and whether the last vertex is
    /// the target.
    fn polyline(&self, from: &C::State, toward: &C::State, at: f64, most: f64) -> (Vec<C::State>, f64, bool) {
        let [before, after] = turn_at(self.space, from, toward, at);
        let (mut vertices, mut covered, mut last) = (Vec::with_capacity(3), 0.0, from);
        let corners = [before, after, toward.clone()];
        for (i, corner) in corners.iter().enumerate() {
            let length = self.space.distance(last, corner);
            if covered + length > most {
                if most > covered {
                    vertices.push(self.space.interpolate(last, corner, (most - covered) / length));
                }
                return (vertices, most, false);
            }
            // Parts of no length are left out, but the target is always a vertex.
            if length > 0.0 || i == 2 {
                vertices.push(corner.clone());
            }
            (covered, last) = (covered + length, corner);
        }
        (vertices, covered, true)
    }
}

impl<C: Space, M: MotionValidity<C::State>> LocalPlanner<C::State> for RotateAtS<'_, C, M> {
    type Edge = PolylineEdge<C::State>;
    fn extend(
        &mut self,
        from: &C::State,
        toward: &C::State,
        direction: Direction,
        reach: Reach,
    ) -> Extension<C::State, Self::Edge> {
        let at = if direction == Direction::Forward { self.at } else { 1.0 - self.at };
        let most = match reach {
            Reach::Step(step) => step,
            Reach::Full => f64::INFINITY,
        };
        let (mut vertices, cost, reached) = self.polyline(from, toward, at, most);
        let mut last = from;
        for next in &vertices {
            if !check_toward(&mut self.check, last, next, direction).is_free() {
                return Extension::Trapped;
            }
            last = next;
        }
        let Some(end) = vertices.pop() else { return Extension::Trapped };
        if direction == Direction::Backward {
            vertices.reverse();
        }
        let motion = Motion { end, edge: PolylineEdge::through(&vertices), cost };
        if reached { Extension::Reached(motion) } else { Extension::Advanced(motion) }
    }
    fn admits(&mut self, q: &C::State) -> bool {
        self.check.check_motion(q, q).is_free()
    }
    fn vertices<'e>(&self, edge: &'e PolylineEdge<C::State>) -> &'e [C::State]
    where
        C::State: 'e,
    {
        edge.vertices()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testkit::check_local_planner;
    use crate::{
        Discrete, FineDiscrete, Length, Path, Reversible, Rng, Straight, Verify, angle::rotation_angle,
    };
    use crate::{Se2, Se2State, Se3};
    use nalgebra::{Isometry3, Point2, Point3, Vector3};

    /// A rod of length 1.6 in a box with a wall across that leaves a gap of 0.5.
    fn rod_is_free(q: &Se2State) -> bool {
        (0..=16).all(|i| {
            let p = q.transform_point(&Point2::new(f64::from(i) / 10.0 - 0.8, 0.0));
            (p.x - 2.0).abs() > 0.1 || (p.y - 2.0).abs() < 0.25
        })
    }

    /// Another check verifies every edge made, in either direction; the cost is the length through the vertices.
    #[test]
    fn edges_are_verified_in_forward_time() {
        let space = Se2::new([0.0; 2], [4.0; 2]).unwrap();
        let mut verifier = FineDiscrete::new(&space, rod_is_free, Length::Absolute(0.004)).unwrap();
        let mut rng = Rng::seed(9);
        let (mut reached, mut more) = (0, 0);
        for i in 0..600 {
            let at = [0.0, 0.3, 0.5, 1.0][i % 4];
            let check = || Discrete::new(&space, rod_is_free, Length::Absolute(0.004)).unwrap();
            let mut local = RotateAtS::new(&space, check(), at).unwrap();
            let (from, to) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            if !(rod_is_free(&from) && rod_is_free(&to)) {
                continue;
            }
            for direction in [Direction::Forward, Direction::Backward] {
                for reach in [Reach::Full, Reach::Step(0.9)] {
                    let found = local.extend(&from, &to, direction, reach);
                    let (Extension::Reached(motion) | Extension::Advanced(motion)) = found else { continue };
                    let ends = match direction {
                        Direction::Forward => [from, motion.end],
                        Direction::Backward => [motion.end, from],
                    };
                    assert!(verifier.verify_edge(&ends[0], &motion.edge, &ends[1]).is_free());
                    assert!(verifier.verify_edge(&ends[1], &motion.edge.reversed(), &ends[0]).is_free());
                    let path = Path { states: ends.to_vec(), edges: vec![motion.edge.clone()] }.flattened();
                    assert!((path.length(&space) - motion.cost).abs() < 1e-9);
                    // No part both moves and turns.
                    for w in path.states.windows(2) {
                        assert!(
                            w[0].translation == w[1].translation || w[0].angle == w[1].angle || {
                                (w[0].angle - w[1].angle).abs() < 1e-12
                                    || (w[0].translation - w[1].translation).norm() < 1e-12
                            }
                        );
                    }
                    reached += 1;
                }
            }
            let mut straight = Straight::new(&space, check());
            let fails = |e: &Extension<_, _>| matches!(e, Extension::Trapped);
            let forward = local.extend(&from, &to, Direction::Forward, Reach::Full);
            let by_line = straight.extend(&from, &to, Direction::Forward, Reach::Full);
            more += usize::from(!matches!(forward, Extension::Trapped) && fails(&by_line));
        }
        assert!(reached > 100 && more > 2, "{reached} {more}");
    }

    #[test]
    fn keeps_the_axioms() {
        let space = Se2::new([0.0; 2], [4.0; 2]).unwrap();
        let check = Discrete::new(&space, rod_is_free, Length::Absolute(0.02)).unwrap();
        check_local_planner(&space, &mut RotateAtS::new(&space, check, 0.5).unwrap(), 0.7, 1);
        let space = Se3::new([-1.0; 3], [1.0; 3]).unwrap();
        let ball = |q: &Isometry3<f64>| (q * Point3::new(0.3, 0.0, 0.0)).coords.norm() > 0.4;
        let check = Discrete::new(&space, ball, Length::Absolute(0.05)).unwrap();
        check_local_planner(&space, &mut RotateAtS::new(&space, check, 0.25).unwrap(), 0.7, 2);
        for at in [-0.1, 1.1, f64::NAN] {
            let check = Discrete::new(&space, ball, Length::Absolute(0.05)).unwrap();
            assert!(RotateAtS::new(&space, check, at).is_err());
        }
    }

    #[test]
    fn turns_in_place_at_s() {
        let space = Se3::new([-9.0; 3], [9.0; 3]).unwrap();
        let from = Isometry3::identity();
        let to = Isometry3::new(Vector3::new(4.0, 0.0, 8.0), Vector3::new(0.0, 1.0, 0.0));
        let [before, after] = turn_at(&space, &from, &to, 0.25);
        assert_eq!(
            (before.translation.vector, after.translation),
            (Vector3::new(1.0, 0.0, 2.0), before.translation)
        );
        assert_eq!((before.rotation, after.rotation), (from.rotation, to.rotation));
        let middle = space.interpolate(&before, &after, 0.5);
        assert!((rotation_angle(&middle.rotation, &from.rotation) - 0.5).abs() < 1e-12);
        let no_edge = Path { states: vec![from], edges: Vec::<PolylineEdge<_>>::new() };
        assert_eq!(no_edge.flattened().states, [from]);
    }
}
