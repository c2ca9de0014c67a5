//! Nearest neighbours: every index agrees with the linear scan, to the bit, on friendly and on
//! unfriendly data, and does little work on either.

use mp_cspace::erased::{AnyIndex, AnySpace, CompiledIndex};
use mp_cspace::testkit::check_nearest_neighbors;
use mp_cspace::{
    AsVectors, Configuration, DefaultNn, Euclidean, FloatingJoints, Hit, JointRange, Joints, KdTree, Linear,
    Manhattan, MaxDisplacement, Metric, MetricFn, MetricTree, NearestNeighbors, Product, Rn, Rng,
    ScaledEuclidean, Se2, Se3, So3, Space, StateVector, TrueMetric, WithMetric,
    angle::rotation_angle,
    nn::{Embed, Layout},
};
use nalgebra::{Point2, Point3, SVector, UnitQuaternion, Vector2};
use proptest::prelude::*;
use rand::RngExt;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// The torus of `N` angles.
fn circles<const N: usize>() -> Joints<SVector<f64, N>> {
    Joints::circles(N).unwrap()
}

/// A true metric of a user's own.
struct OwnAngle;
impl Metric<So3> for OwnAngle {
    type Nn = MetricTree;
    fn distance(&self, _: &So3, a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
        2.0 * rotation_angle(a, b)
    }
    fn extent(&self, _: &So3) -> f64 {
        7.0
    }
}
impl TrueMetric<So3> for OwnAngle {}

fn agrees_on<C: DefaultNn>(space: C) {
    check_nearest_neighbors(&space, &mut C::Nn::default(), 500, 1);
}

/// The default index as the library has compiled it.
fn compiled_agrees_on<C: CompiledIndex>(space: C) {
    check_nearest_neighbors(&AnySpace::new(&space), &mut space.compiled_index(), 500, 1);
}

/// An index by the coordinates of the space, compiled in the library for all spaces of rows.
fn agrees_by_coordinates<C: Embed<State = Configuration> + Clone + Send + 'static>(space: C) {
    check_nearest_neighbors(&AnySpace::new(&space), &mut AnyIndex::by_coordinates(&space), 500, 1);
}

/// The same for the rows of other states: indexes of their own would take minutes to compile.
fn rows_agree<C: Embed<State: StateVector> + Clone + Send + 'static>(space: C) {
    agrees_by_coordinates(AsVectors(space));
}

/// An index by distances, compiled in the library for all spaces of rows.
fn rows_agree_by_metric<C: Space<State: StateVector> + TrueMetric + Clone + Send + 'static>(space: C) {
    let rows = AsVectors(space);
    check_nearest_neighbors(&AnySpace::new(&rows), &mut AnyIndex::by_metric(&rows), 500, 1);
}

#[test]
fn default_index_of_every_space() {
    agrees_on(Rn::<1>::new([0.0], [1.0]).unwrap());
    compiled_agrees_on(AsVectors(Rn::<2>::new([0.0; 2], [1.0, 30.0]).unwrap()));
    rows_agree(Rn::<3>::new([1e6; 3], [1e6 + 1.0; 3]).unwrap());
    rows_agree(Rn::<6>::new([-1.0; 6], [1.0; 6]).unwrap());
    agrees_on(Rn::<19>::new([-1.0; 19], [1.0; 19]).unwrap());
    compiled_agrees_on(Joints::<Configuration>::intervals(&[0.0; 5], &[1.0; 5]).unwrap());
    compiled_agrees_on(Joints::<Configuration>::intervals(&[0.0; 20], &[1.0; 20]).unwrap());
    rows_agree(circles::<1>());
    rows_agree(So3);
    rows_agree(circles::<2>());
    rows_agree(circles::<7>());
    let ranges = [JointRange::Interval { low: -6.0, high: 6.0 }, JointRange::Circle, JointRange::Circle];
    rows_agree(Joints::<SVector<f64, 3>>::new(ranges).unwrap());
    compiled_agrees_on(Joints::<Configuration>::new(ranges.repeat(7)).unwrap());
    agrees_by_coordinates(WithMetric::new(Joints::<Configuration>::new(ranges).unwrap(), Manhattan));
    compiled_agrees_on(AsVectors(Se2::new([0.0; 2], [10.0; 2]).unwrap()));
    compiled_agrees_on(AsVectors(Se2::new([0.0; 2], [1.0; 2]).unwrap().with_rotation_weight(3.0).unwrap()));
    compiled_agrees_on(AsVectors(se3()));
    compiled_agrees_on(AsVectors(se3().with_rotation_weight(1e-3).unwrap()));
    agrees_on(Product::new(se3(), 2.0, circles::<2>(), 0.1).unwrap());
    let floating = FloatingJoints::new(se3(), Joints::new(ranges).unwrap()).unwrap();
    agrees_by_coordinates(floating.clone());
    agrees_by_coordinates(WithMetric::new(floating, Manhattan));
    agrees_on(Product::new(So3, 1.0, Product::new(So3, 0.3, circles::<1>(), 2.0).unwrap(), 1.0).unwrap());
}

#[test]
fn default_index_under_other_metrics() {
    rows_agree(WithMetric::new(Rn::<4>::new([0.0; 4], [1.0; 4]).unwrap(), Manhattan));
    rows_agree(WithMetric::new(se3(), Manhattan));
    rows_agree(WithMetric::new(se3(), Euclidean));
    agrees_on(WithMetric::new(Product::new(So3, 1.0, circles::<3>(), 1.0).unwrap(), Euclidean));
    let weights = ScaledEuclidean::new(&se3(), [1.0, 10.0, 0.1, 3.0]).unwrap();
    rows_agree(WithMetric::new(se3(), weights));
    let corners = [[0.3, 0.0, 0.0], [0.0, 0.4, 0.0], [0.0, 0.1, -0.5]].map(Point3::from);
    rows_agree_by_metric(WithMetric::new(se3(), MaxDisplacement::new(corners).unwrap()));
    let rod = MaxDisplacement::planar([Point2::new(-1.0, 0.0), Point2::new(1.0, 0.0)]).unwrap();
    rows_agree_by_metric(WithMetric::new(Se2::new([0.0; 2], [10.0; 2]).unwrap(), rod));
    agrees_on(WithMetric::new(So3, OwnAngle));
    let own = MetricFn::new(|a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>| rotation_angle(a, b), 4.0);
    agrees_on(WithMetric::new(So3, own.unwrap()));
}

#[test]
fn metric_tree_of_every_kind() {
    check_nearest_neighbors(&square(), &mut MetricTree::new(), 500, 1);
    check_nearest_neighbors(&se3(), &mut MetricTree::new(), 500, 2);
    check_nearest_neighbors(&circles::<1>(), &mut MetricTree::new(), 500, 3);
    check_nearest_neighbors(&circles::<5>(), &mut MetricTree::new(), 500, 4);
}

fn square() -> Rn<2> {
    Rn::new([0.0; 2], [1.0; 2]).unwrap()
}

fn se3() -> Se3 {
    Se3::new([0.0; 3], [1.0; 3]).unwrap()
}

/// The linear scan, and how `index` compares with it after each of `states`.
fn agrees_along<C: Space, N: NearestNeighbors<C>>(
    space: &C,
    mut index: N,
    states: &[C::State],
    queries: &[C::State],
) {
    both_agree(space, &mut index, &mut Linear::new(), states, queries);
}

/// As [`agrees_along`]; each method of the indexes is compiled once.
fn both_agree<C: Space>(
    space: &C,
    index: &mut dyn NearestNeighbors<C>,
    linear: &mut dyn NearestNeighbors<C>,
    states: &[C::State],
    queries: &[C::State],
) {
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for n in 1..=states.len() {
        let states = &states[..n];
        index.inserted(space, states, n as u32 - 1);
        linear.inserted(space, states, n as u32 - 1);
        if n > 40 && n % 149 != 0 && n != states.len() {
            continue;
        }
        for q in queries.iter().chain(&states[n.saturating_sub(3)..]) {
            let nearest = index.nearest(space, states, q);
            assert_eq!(nearest, linear.nearest(space, states, q), "{n} states, {q:?}");
            for k in [7, 17, 70, 1, 40] {
                index.k_nearest(space, states, q, k, &mut a);
                linear.k_nearest(space, states, q, k, &mut b);
                assert_eq!(a, b, "{k} nearest of {n} states, {q:?}");
            }
            for radius in [0.0, a.get(a.len() / 3).map_or(1.0, |hit| hit.distance), f64::INFINITY] {
                index.within(space, states, q, radius, &mut a);
                linear.within(space, states, q, radius, &mut b);
                assert_eq!(a, b, "within {radius} of {n} states, {q:?}");
            }
        }
    }
}

type P3 = SVector<f64, 3>;

/// Unfriendly data in R³.
fn unfriendly() -> Vec<(&'static str, Vec<P3>)> {
    let mut rng = Rng::seed(5);
    let mut random = move || P3::from_fn(|_, _| rng.random::<f64>() - 0.5);
    let n = 600;
    let line: Vec<P3> = (0..n).map(|i| P3::new(1.0, 2.0, -1.0) * f64::from(i)).collect();
    let cluster = |scale: f64, random: &mut dyn FnMut() -> P3| -> Vec<P3> {
        (0..n).map(|i| P3::repeat(f64::from(i % 3)) + random() * scale).collect()
    };
    vec![
        ("identical", vec![P3::new(0.1, 0.2, 0.3); n as usize]),
        ("identical but two", {
            let mut all = vec![P3::zeros(); n as usize];
            (all[300], all[500]) = (P3::x(), -P3::y());
            all
        }),
        ("sorted", line.clone()),
        ("sorted backwards", line.iter().rev().copied().collect()),
        ("toward a limit", (0..n).map(|i| P3::repeat(mp_math::powi(0.99, i))).collect()),
        ("from both ends", (0..n).map(|i| P3::x() * f64::from(if i % 2 == 0 { i } else { -i })).collect()),
        ("clustered", cluster(1e-2, &mut random)),
        ("tightly clustered", cluster(1e-9, &mut random)),
        ("clustered to the last bit", cluster(1e-16, &mut random)),
        ("lattice", (0..n).map(|i| P3::new((i % 3).into(), (i / 3 % 3).into(), (i % 7).into())).collect()),
        ("star", (0..n).map(|i| P3::ith(i as usize % 3, f64::from(i / 3))).collect()),
        ("far away", (0..n).map(|_| P3::repeat(1e9) + random()).collect()),
        ("huge", (0..n).map(|_| random() * 1e160).collect()),
        ("tiny", (0..n).map(|_| random() * 1e-100).collect()),
        ("copies", (0..n).map(|i| P3::repeat(0.1) * f64::from(i % 40)).collect()),
    ]
}

fn everywhere() -> Rn<3> {
    Rn::new([-1e3; 3], [1e3; 3]).unwrap()
}

#[test]
fn kd_tree_on_unfriendly_data() {
    on_unfriendly_data(KdTree::<3>::new());
}

#[test]
fn metric_tree_on_unfriendly_data() {
    on_unfriendly_data(MetricTree::new());
}

fn on_unfriendly_data(index: impl NearestNeighbors<Rn<3>> + Clone + std::panic::RefUnwindSafe) {
    for (name, states) in unfriendly() {
        let queries = [P3::zeros(), P3::new(0.3, -0.4, 0.5), states[states.len() / 2] * 1.001];
        let run = || agrees_along(&everywhere(), index.clone(), &states, &queries);
        assert!(std::panic::catch_unwind(run).is_ok(), "on {name} data");
    }
}

#[test]
fn states_that_are_no_numbers_are_never_found() {
    let nan = P3::repeat(f64::NAN);
    let mut states = vec![nan; 40];
    states.extend([P3::repeat(f64::INFINITY), P3::zeros(), nan, P3::x()]);
    states.extend(vec![nan; 40]);
    let queries = [P3::y(), P3::repeat(f64::INFINITY), nan];
    agrees_along(&everywhere(), KdTree::<3>::new(), &states, &queries);
    agrees_along(&everywhere(), MetricTree::new(), &states, &queries);
}

/// By widths that other tests have: each is some seconds of compiling.
#[test]
fn wrong_number_of_coordinates_is_only_slower() {
    check_nearest_neighbors(&se3(), &mut KdTree::<2>::new(), 300, 1);
    check_nearest_neighbors(&se3(), &mut KdTree::<6>::new(), 300, 1);
    check_nearest_neighbors(&se3(), &mut KdTree::<19>::new(), 300, 1);
    check_nearest_neighbors(&circles::<3>(), &mut KdTree::<19>::new(), 300, 1);
}

/// Counts the distances computed.
struct Counting<C> {
    space: C,
    calls: AtomicU64,
}

impl<C: Space> Space for Counting<C> {
    type State = C::State;
    fn distance(&self, from: &C::State, to: &C::State) -> f64 {
        self.calls.fetch_add(1, Relaxed);
        self.space.distance(from, to)
    }
    fn dim(&self) -> usize {
        self.space.dim()
    }
    fn extent(&self) -> f64 {
        self.space.extent()
    }
    fn interpolate_into(&self, from: &C::State, to: &C::State, t: f64, out: &mut C::State) {
        self.space.interpolate_into(from, to, t, out);
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> C::State {
        self.space.unit_cube_to_state(u)
    }
    fn sample_uniform(&self, rng: &mut Rng) -> C::State {
        self.space.sample_uniform(rng)
    }
    fn contains(&self, q: &C::State) -> bool {
        self.space.contains(q)
    }
}
impl<C: TrueMetric> TrueMetric for Counting<C> {}
impl<C: Embed> Embed for Counting<C> {
    fn layout(&self) -> Layout {
        self.space.layout()
    }
    fn embed(&self, state: &C::State, out: &mut [f64]) -> usize {
        self.space.embed(state, out)
    }
}

/// Distances computed per query while `states` are inserted one by one, each searched for first.
fn distances_per_query<C: Space, N: NearestNeighbors<Counting<C>>>(
    space: C,
    mut index: N,
    states: &[C::State],
) -> f64 {
    let space = Counting { space, calls: AtomicU64::new(0) };
    for n in 0..states.len() {
        let _: Option<Hit> = index.nearest(&space, &states[..n], &states[n]);
        index.inserted(&space, &states[..=n], n as u32);
    }
    space.calls.into_inner() as f64 / states.len() as f64
}

#[test]
fn kd_tree_computes_few_distances() {
    let mut rng = Rng::seed(3);
    let uniform: Vec<_> = (0..20_000).map(|_| se3().sample_uniform(&mut rng)).collect();
    let count = distances_per_query(se3(), KdTree::<7>::new(), &uniform);
    assert!(count < 3.0, "{count} distances per query in SE(3)");
    for (name, states) in unfriendly() {
        let count = distances_per_query(everywhere(), KdTree::<3>::new(), &states);
        // Coordinates that differ by their rounding only, or are out of range, cannot be told
        // apart; the metric has to.
        let limit = match name {
            "huge" => 500.0,
            "clustered to the last bit" => 100.0,
            "tightly clustered" | "tiny" => 50.0,
            _ => 12.0,
        };
        assert!(count < limit, "{count} distances per query on {name} data");
    }
}

/// Distances computed per query for the 10 nearest of 5000 random states by a k-d tree.
fn distances_for_ten<C: Embed, const K: usize>(space: C) -> f64 {
    let mut rng = Rng::seed(3);
    let states: Vec<_> = (0..5200).map(|_| space.sample_uniform(&mut rng)).collect();
    let (states, queries) = states.split_at(5000);
    let space = Counting { space, calls: AtomicU64::new(0) };
    let mut index = KdTree::<K>::new();
    (0..states.len()).for_each(|i| index.inserted(&space, states, i as u32));
    let mut out = Vec::new();
    for q in queries {
        index.k_nearest(&space, states, q, 10, &mut out);
        assert_eq!(out.len(), 10);
    }
    space.calls.into_inner() as f64 / queries.len() as f64
}

#[test]
fn k_nearest_computes_hardly_more_distances_than_it_returns() {
    let cube = Rn::<6>::new([0.0; 6], [1.0; 6]).unwrap();
    for (name, limit, count) in [
        ("R^6", 10.1, distances_for_ten::<_, 6>(cube)),
        ("T^3", 10.1, distances_for_ten::<_, 3>(circles::<3>())),
        ("SE(3)", 13.0, distances_for_ten::<_, 7>(se3())),
    ] {
        assert!(count < limit, "{count} distances per query in {name}");
    }
}

/// Distances that are up to `factor` times their bounds, infinite beyond 1.5 along the first axis, and not a
/// number beyond 1.9, in a layout that tells none of it.
#[derive(Clone, Debug)]
struct Stretched {
    space: Rn<2>,
    factor: f64,
}

impl Space for Stretched {
    type State = SVector<f64, 2>;
    fn distance(&self, from: &Self::State, to: &Self::State) -> f64 {
        let along = (from.x - to.x).abs();
        let stretch = 1.0 + (self.factor - 1.0) * (0.5 + 0.5 * mp_math::sin(40.0 * from.y));
        match along {
            a if a > 1.9 => f64::NAN,
            a if a > 1.5 => f64::INFINITY,
            _ => stretch * self.space.distance(from, to),
        }
    }
    fn dim(&self) -> usize {
        2
    }
    fn extent(&self) -> f64 {
        self.space.extent()
    }
    fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State) {
        self.space.interpolate_into(from, to, t, out);
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
        self.space.unit_cube_to_state(u)
    }
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
        self.space.sample_uniform(rng)
    }
    fn contains(&self, q: &Self::State) -> bool {
        self.space.contains(q)
    }
}
impl Embed for Stretched {
    fn layout(&self) -> Layout {
        self.space.layout()
    }
    fn embed(&self, state: &Self::State, out: &mut [f64]) -> usize {
        self.space.embed(state, out)
    }
}

#[test]
fn distances_much_greater_than_their_bounds_are_ranked_right() {
    let mut rng = Rng::seed(11);
    let space = Rn::<2>::new([-1.0; 2], [1.0; 2]).unwrap();
    let states: Vec<_> = (0..400).map(|_| space.sample_uniform(&mut rng)).collect();
    let queries = [Vector2::new(-1.0, 0.2), Vector2::new(1.0, -0.9), Vector2::zeros()];
    for factor in [1.001, 1.05, 3.0] {
        agrees_along(&Stretched { space: space.clone(), factor }, KdTree::<2>::new(), &states, &queries);
    }
}

#[test]
fn metric_tree_computes_few_distances() {
    let mut rng = Rng::seed(3);
    let uniform: Vec<_> = (0..5000).map(|_| se3().sample_uniform(&mut rng)).collect();
    let count = distances_per_query(se3(), MetricTree::new(), &uniform);
    assert!(count < 500.0, "{count} distances per query in SE(3)");
    for (name, states) in unfriendly() {
        let count = distances_per_query(everywhere(), MetricTree::new(), &states);
        let limit = match name {
            "huge" => 500.0,
            "clustered to the last bit" | "tightly clustered" | "tiny" => 120.0,
            _ => 30.0,
        };
        assert!(count < limit, "{count} distances per query on {name} data");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn kd_tree_agrees_on_small_integers(
        points in prop::collection::vec((-3i8..4, -3i8..4), 1..200),
        queries in prop::collection::vec((-4i8..5, -4i8..5), 1..5),
    ) {
        let plane = Rn::<2>::new([-9.0; 2], [9.0; 2]).unwrap();
        let vector = |&(x, y): &(i8, i8)| Vector2::new(f64::from(x), f64::from(y));
        let points: Vec<_> = points.iter().map(vector).collect();
        let queries: Vec<_> = queries.iter().map(vector).collect();
        agrees_along(&plane, KdTree::<2>::new(), &points, &queries);
        agrees_along(&plane, MetricTree::new(), &points, &queries);
        agrees_along(&WithMetric::new(plane, Manhattan), KdTree::<16>::new(), &points, &queries);
    }

    #[test]
    fn kd_tree_agrees_on_any_numbers(
        points in prop::collection::vec(prop::collection::vec(prop::num::f64::ANY, 3), 1..120),
        query in prop::collection::vec(prop::num::f64::ANY, 3),
    ) {
        let space = Joints::<Configuration>::intervals(&[-1.0; 3], &[1.0; 3]).unwrap();
        let points: Vec<_> = points.into_iter().map(Configuration::from).collect();
        let query = [Configuration::from(query)];
        agrees_along(&space, KdTree::<16>::new(), &points, &query);
        agrees_along(&space, MetricTree::new(), &points, &query);
    }
}
