//! Axioms of spaces.

use super::check_metric;
use crate::{Rng, Space};
use rand::RngExt;
use std::fmt::Debug;

/// Checks the axioms of a [`Space`].
///
/// Dimension and extent are positive. The space contains its samples, and the images of the unit cube with
/// its faces. Uniform sampling is deterministic and agrees with the map from the unit cube. Distances satisfy
/// [`check_metric`] and do not exceed the extent. Interpolation is exact at both ends, stays inside, has
/// constant speed, and does not depend on what the output held. A part of a motion is the motion between the
/// ends of the part. Constant velocities, where the space has them, lead along the interpolation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceKit {
    samples: usize,
    seed: u64,
    tolerance: f64,
    constant_speed: bool,
}

impl Default for SpaceKit {
    fn default() -> Self {
        Self::new()
    }
}

impl SpaceKit {
    /// A kit with 300 samples, seed 1, a tolerance of 10⁻⁹ of the extent, and constant speed required.
    #[must_use]
    pub fn new() -> Self {
        Self { samples: 300, seed: 1, tolerance: 1e-9, constant_speed: true }
    }

    /// The same with this many samples.
    #[must_use]
    pub fn samples(self, samples: usize) -> Self {
        Self { samples, ..self }
    }

    /// The same with this seed.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// The same with this tolerance of distances, as a fraction of the extent.
    #[must_use]
    pub fn tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// The same without requiring constant speed, for a space under a metric that lacks it.
    #[must_use]
    pub fn any_speed(self) -> Self {
        Self { constant_speed: false, ..self }
    }

    /// Checks `space`.
    ///
    /// # Panics
    /// When an axiom is violated, naming it and the states.
    pub fn run<C: Space>(&self, space: &C) {
        self.check(space);
    }

    /// As [`run`](Self::run): the methods of each space are compiled once.
    fn check<S: Clone + Debug + PartialEq + Send + Sync>(&self, space: &dyn Space<State = S>) {
        let (dim, extent) = (space.dim(), space.extent());
        assert!(dim > 0, "space: the dimension is positive, violated: {dim}");
        assert!(
            extent > 0.0 && extent.is_finite(),
            "space: the extent is positive and finite, violated: {extent}"
        );
        let slack = self.tolerance * extent;
        let mut rng = Rng::seed(self.seed);
        let states = self.states(space, &mut rng);
        check_metric(space, &states[..states.len().min(100)]);
        self.sampling(space, &mut rng);
        for pair in states.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            let d = space.distance(a, b);
            assert!(
                d <= extent + slack,
                "space: no distance exceeds the extent {extent}, violated: {d}\n  from {a:?}\n  to   {b:?}"
            );
            self.interpolation(space, a, b, rng.random(), rng.random());
            self.velocities(space, a, &mut rng);
        }
    }

    /// Contained states: samples, and images of the faces of the cube.
    fn states<C: Space + ?Sized>(&self, space: &C, rng: &mut Rng) -> Vec<C::State> {
        let below_one = 1.0 - f64::EPSILON;
        let mut states: Vec<C::State> = Vec::with_capacity(self.samples);
        for i in 0..self.samples.max(2) {
            let q = if i % 3 == 0 {
                let u: Vec<f64> = (0..space.dim())
                    .map(|_| match rng.random_range(0..4) {
                        0 => 0.0,
                        1 => 0.5,
                        2 => below_one,
                        _ => rng.random(),
                    })
                    .collect();
                let q = space.unit_cube_to_state(&u);
                assert!(
                    space.contains(&q),
                    "space: images of the unit cube are contained, violated by {q:?} of {u:?}"
                );
                q
            } else {
                let q = space.sample_uniform(rng);
                assert!(space.contains(&q), "space: uniform samples are contained, violated by {q:?}");
                q
            };
            states.push(q);
        }
        states
    }

    /// Uniform sampling is reproducible, and distributed as the map from the unit cube: mean
    /// distances to a few states agree within five standard errors.
    fn sampling<C: Space + ?Sized>(&self, space: &C, rng: &mut Rng) {
        let again = |rng: &Rng| space.sample_uniform(&mut rng.clone());
        assert!(
            again(rng) == again(rng),
            "space: the same seed gives the same sample, violated: {:?}",
            again(rng)
        );
        let n = 4000;
        for _ in 0..3 {
            let center = space.sample_uniform(rng);
            let mut moments = [[0.0_f64; 2]; 2];
            for _ in 0..n {
                let u: Vec<f64> = (0..space.dim()).map(|_| rng.random()).collect();
                for (m, q) in
                    moments.iter_mut().zip([space.sample_uniform(rng), space.unit_cube_to_state(&u)])
                {
                    let d = space.distance(&center, &q);
                    m[0] += d / f64::from(n);
                    m[1] += d * d / f64::from(n);
                }
            }
            let [uniform, cube] = moments;
            let variance = |m: [f64; 2]| (m[1] - m[0] * m[0]).max(0.0);
            let error = ((variance(uniform) + variance(cube)) / f64::from(n)).sqrt();
            assert!(
                (uniform[0] - cube[0]).abs() <= 5.0 * error + self.tolerance * space.extent(),
                "space: uniform samples and images of the unit cube are distributed alike, violated: mean distance {} and {} from {center:?}",
                uniform[0],
                cube[0]
            );
        }
    }

    /// A constant velocity leads along the interpolation, where the space has velocities.
    fn velocities<C: Space + ?Sized>(&self, space: &C, a: &C::State, rng: &mut Rng) {
        let slack = self.tolerance * space.extent();
        // Less than half a turn about all axes together.
        let velocity: Vec<f64> = (0..space.dim()).map(|_| rng.random_range(-1.0..1.0)).collect();
        let Some(b) = space.moved(a, &velocity, 1.0) else { return };
        for t in [0.0, rng.random(), 1.0] {
            let (q, expected) = (space.moved(a, &velocity, t), space.interpolate(a, &b, t));
            let gap = q.map_or(f64::INFINITY, |q| space.distance(&q, &expected));
            assert!(
                gap <= slack,
                "space: a velocity leads along the interpolation, violated by {gap} at {t}\n  from {a:?} at {velocity:?}"
            );
        }
        let mut back = vec![f64::NAN; velocity.len()];
        if space.velocity_into(a, &b, &mut back) {
            let gap = space.moved(a, &back, 1.0).map_or(f64::INFINITY, |q| space.distance(&q, &b));
            assert!(
                gap <= slack,
                "space: the velocity to a state leads there, violated by {gap}\n  from {a:?} to {b:?} at {back:?}"
            );
        }
        assert!(
            space.moved(a, &[&velocity[..], &[1.0]].concat(), 1.0).is_none(),
            "space: a velocity has one number per degree of freedom, violated by one of {}",
            velocity.len() + 1
        );
    }

    fn interpolation<C: Space + ?Sized>(&self, space: &C, a: &C::State, b: &C::State, t: f64, part: f64) {
        let slack = self.tolerance * space.extent();
        for (t, end) in [(0.0, a), (1.0, b)] {
            let q = space.interpolate(a, b, t);
            assert!(
                q == *end,
                "space: interpolation at {t} is exactly the end, violated\n  by {q:?}\n  of {end:?}"
            );
        }
        let q = space.interpolate(a, b, t);
        assert!(
            space.contains(&q),
            "space: what lies between contained states is contained, violated at {t}\n  by   {q:?}\n  from {a:?}\n  to   {b:?}"
        );
        let mut other = b.clone();
        space.interpolate_into(a, b, t, &mut other);
        assert!(
            q == other,
            "space: interpolation does not depend on what the output held, violated at {t}\n  {q:?}\n  {other:?}"
        );
        if self.constant_speed {
            let (d, expected) = (space.distance(a, &q), t * space.distance(a, b));
            assert!(
                (d - expected).abs() <= slack,
                "space: constant speed violated: at {t} the distance is {d}, expected {expected}\n  from {a:?}\n  to   {b:?}"
            );
        }
        let (direct, within) = (space.interpolate(a, b, part * t), space.interpolate(a, &q, part));
        let gap = space.distance(&direct, &within);
        assert!(
            gap <= slack,
            "space: a part of a motion is the motion between its ends, violated by {gap} at {part} of {t}\n  from {a:?}\n  to   {b:?}"
        );
        let still = space.distance(a, &space.interpolate(a, a, t));
        assert!(
            still <= slack,
            "space: interpolation from a state to itself stays there, violated by {still} at {t}\n  for {a:?}"
        );
    }
}
