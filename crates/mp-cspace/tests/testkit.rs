//! The kits accept correct implementations, and name the axiom that a wrong one violates.

use mp_cspace::testkit::{SpaceKit, check_local_planner, check_nearest_neighbors, check_true_metric};
use mp_cspace::*;
use nalgebra::{SVector, Vector1};

/// The unit interval, or something almost like it.
#[derive(Clone, Copy, Debug, Default)]
struct Interval {
    samples_outside: bool,
    squared_distance: bool,
    misses_the_end: bool,
    eases_in: bool,
    uneven_samples: bool,
    extent: Option<f64>,
    negative: bool,
}

impl TrueMetric for Interval {}
impl Space for Interval {
    type State = Vector1<f64>;
    fn distance(&self, a: &Vector1<f64>, b: &Vector1<f64>) -> f64 {
        let d = (a.x - b.x).abs();
        if self.squared_distance {
            d * d
        } else if self.negative {
            -d
        } else {
            d
        }
    }
    fn dim(&self) -> usize {
        1
    }
    fn extent(&self) -> f64 {
        self.extent.unwrap_or(1.0)
    }
    fn interpolate_into(&self, a: &Self::State, b: &Self::State, t: f64, out: &mut Self::State) {
        let t = if self.eases_in { t * t } else { t };
        let t = if self.misses_the_end { t * 0.999 } else { t };
        out.x = if t == 1.0 { b.x } else { a.x + (b.x - a.x) * t };
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
        Vector1::new(u[0])
    }
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
        let x = rand::RngExt::random::<f64>(rng);
        let x = if self.uneven_samples { x * x } else { x };
        Vector1::new(if self.samples_outside { 2.0 * x } else { x })
    }
    fn contains(&self, q: &Self::State) -> bool {
        (0.0..=1.0).contains(&q.x)
    }
}

/// The message of a kit that fails.
fn verdict(run: impl FnOnce() + std::panic::UnwindSafe) -> String {
    match std::panic::catch_unwind(run) {
        Ok(()) => "passes".into(),
        Err(panic) => *panic.downcast::<String>().unwrap(),
    }
}

#[test]
fn broken_spaces_are_caught_by_name() {
    let right = Interval::default();
    let cases = [
        (right, "passes"),
        (Interval { samples_outside: true, ..right }, "uniform samples are contained"),
        (Interval { squared_distance: true, ..right }, "constant speed"),
        (Interval { misses_the_end: true, ..right }, "exactly the end"),
        (Interval { eases_in: true, ..right }, "constant speed"),
        (Interval { uneven_samples: true, ..right }, "distributed alike"),
        (Interval { extent: Some(0.5), ..right }, "no distance exceeds the extent"),
        (Interval { extent: Some(0.0), ..right }, "the extent is positive"),
        (Interval { negative: true, ..right }, "finite and not negative"),
    ];
    for (space, expected) in cases {
        let said = verdict(|| SpaceKit::new().run(&space));
        assert!(said.contains(expected), "{space:?}: {said}");
    }
    let square = Interval { squared_distance: true, ..right };
    let states: Vec<_> = (0..9).map(|i| Vector1::new(f64::from(i) / 8.0)).collect();
    assert!(verdict(|| check_true_metric(&square, &states, 1e-9)).contains("triangle inequality"));
}

/// Goes half a step too far, or only part of the way where all or nothing is allowed.
#[derive(Debug)]
struct Wrong(u32);
impl LocalPlanner<Vector1<f64>> for Wrong {
    type Edge = ();
    fn extend(
        &mut self,
        from: &Vector1<f64>,
        toward: &Vector1<f64>,
        _: Direction,
        reach: Reach,
    ) -> Extension<Vector1<f64>, ()> {
        let motion = |end| Motion { end, edge: (), cost: 0.1 };
        let middle = (from + toward) * 0.5;
        match (self.0, reach) {
            (0, Reach::Full) => Extension::Advanced(motion(middle)),
            (1, _) => Extension::Reached(motion(middle)),
            (2, Reach::Step(_)) => Extension::Reached(motion(*toward)),
            (3, Reach::Step(_)) => Extension::Advanced(motion(*toward)),
            (4, Reach::Step(_)) => Extension::Advanced(motion(*from)),
            _ => Extension::Trapped,
        }
    }
}

#[test]
fn broken_local_planners_are_caught_by_name() {
    let expected = [
        "all or nothing",
        "exactly the target",
        "nothing beyond the step",
        "stays within the step",
        "an advance is of use",
    ];
    for (i, expected) in (0..).zip(expected) {
        let said = verdict(|| check_local_planner(&Interval::default(), &mut Wrong(i), 0.1, 1));
        assert!(said.contains(expected), "{i}: {said}");
    }
}

type Circle = Joints<Vector1<f64>>;

/// A linear scan that forgets every fourth state.
#[derive(Debug, Default)]
struct Forgetful(Linear);
impl NearestNeighbors<Circle> for Forgetful {
    fn inserted(&mut self, space: &Circle, points: &[Vector1<f64>], id: NodeId) {
        if id % 4 != 3 {
            self.0.inserted(space, points, id);
        }
    }
    fn clear(&mut self) {
        NearestNeighbors::<Circle>::clear(&mut self.0);
    }
    fn nearest(&self, space: &Circle, points: &[Vector1<f64>], q: &Vector1<f64>) -> Option<Hit> {
        self.0.nearest(space, points, q)
    }
    fn k_nearest(
        &self,
        space: &Circle,
        points: &[Vector1<f64>],
        q: &Vector1<f64>,
        k: usize,
        out: &mut Vec<Hit>,
    ) {
        self.0.k_nearest(space, points, q, k, out);
    }
    fn within(
        &self,
        space: &Circle,
        points: &[Vector1<f64>],
        q: &Vector1<f64>,
        radius: f64,
        out: &mut Vec<Hit>,
    ) {
        self.0.within(space, points, q, radius, out);
    }
}

#[test]
fn neighbours_are_compared_with_the_scan() {
    let circle = Circle::circles(1).unwrap();
    check_nearest_neighbors(&circle, &mut Linear::default(), 200, 1);
    check_nearest_neighbors(&Joints::<SVector<f64, 4>>::circles(4).unwrap(), &mut Linear::default(), 100, 2);
    let said = verdict(|| check_nearest_neighbors(&circle, &mut Forgetful::default(), 50, 1));
    assert!(said.contains("agrees with the scan"), "{said}");
}
