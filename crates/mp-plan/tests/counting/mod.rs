//! A point that moves among discs, whose space, check and verifier count what they do.

use mp_cspace::nn::Linear;
use mp_cspace::{
    Clearance, Configuration, DefaultNn, Factored, Interrupt, JointRange, Joints, MotionCheck,
    MotionClearance, MotionValidity, Rng, Space, Validity, nn::Layout,
};
use mp_plan::{
    Appearance, Body, BodyShape, Column, Contact, Description, Error, Measured, MetricName, Motion, Queries,
    TypedMotion,
};
use nalgebra::{Isometry3, Point2};
use std::sync::atomic::{AtomicU64, Ordering};

/// Distances, samples, interpolations, checks and verified pieces so far.
pub(crate) static WORK: AtomicU64 = AtomicU64::new(0);

fn count() {
    WORK.fetch_add(1, Ordering::SeqCst);
}

/// The unit square, which counts.
#[derive(Clone, Debug)]
pub(crate) struct Square(Joints<Configuration>);

impl Space for Square {
    type State = Configuration;
    fn distance(&self, from: &Configuration, to: &Configuration) -> f64 {
        count();
        self.0.distance(from, to)
    }
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn extent(&self) -> f64 {
        self.0.extent()
    }
    fn interpolate_into(&self, from: &Configuration, to: &Configuration, t: f64, out: &mut Configuration) {
        count();
        self.0.interpolate_into(from, to, t, out);
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> Configuration {
        self.0.unit_cube_to_state(u)
    }
    fn sample_uniform(&self, rng: &mut Rng) -> Configuration {
        count();
        self.0.sample_uniform(rng)
    }
    fn contains(&self, q: &Configuration) -> bool {
        self.0.contains(q)
    }
    fn moved(&self, from: &Configuration, velocity: &[f64], time: f64) -> Option<Configuration> {
        count();
        self.0.moved(from, velocity, time)
    }
    fn velocity_into(&self, from: &Configuration, to: &Configuration, out: &mut [f64]) -> bool {
        self.0.velocity_into(from, to, out)
    }
}

impl Factored for Square {
    fn factors(&self) -> usize {
        self.0.factors()
    }
    fn each_factor(&self, from: &Configuration, to: &Configuration, f: &mut impl FnMut(usize, f64)) {
        self.0.each_factor(from, to, f);
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        self.0.factor_extent(factor)
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Configuration,
        to: &Configuration,
        t: f64,
        out: &mut Configuration,
    ) {
        count();
        self.0.interpolate_factor(factor, from, to, t, out);
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        self.0.factor_layouts()
    }
    fn embed_factors(&self, state: &Configuration, put: &mut impl FnMut(usize, f64)) {
        self.0.embed_factors(state, put);
    }
}

impl DefaultNn for Square {
    type Nn = Linear;
}

/// The discs, and how many queries were made.
#[derive(Clone, Debug)]
pub(crate) struct Discs {
    discs: Vec<([f64; 2], f64)>,
    queries: u64,
}

impl Validity<Configuration> for Discs {
    fn is_valid(&mut self, q: &Configuration) -> bool {
        self.clearance(q, f64::MIN_POSITIVE) > 0.0
    }
}
impl Clearance<Configuration> for Discs {
    fn clearance(&mut self, q: &Configuration, _: f64) -> f64 {
        count();
        self.queries += 1;
        clearance(&self.discs, q)
    }
}
impl MotionClearance<Configuration> for Discs {
    fn motion_bound(&self, from: &Configuration, to: &Configuration) -> f64 {
        mp_math::hypot(to[0] - from[0], to[1] - from[1])
    }
}
impl Queries for Discs {
    fn queries(&self) -> u64 {
        self.queries
    }
}

fn clearance(discs: &[([f64; 2], f64)], q: &Configuration) -> f64 {
    discs.iter().map(|([x, y], r)| mp_math::hypot(q[0] - x, q[1] - y) - r).fold(f64::INFINITY, f64::min)
}

/// The verifier: fine steps.
#[derive(Clone)]
pub(crate) struct Steps<'c>(&'c Counting, Interrupt);

impl MotionValidity<Configuration> for Steps<'_> {
    fn check_motion(&mut self, a: &Configuration, b: &Configuration) -> MotionCheck {
        let mut least = f64::INFINITY;
        let parts = if a == b { 1 } else { 200 };
        for i in 0..=parts {
            let at = f64::from(i) / f64::from(parts);
            if self.1.ask() {
                return MotionCheck::Unproven { at };
            }
            count();
            let clear = clearance(&self.0.check.discs, &self.0.space.0.interpolate(a, b, at));
            least = least.min(clear);
            if clear <= 0.0 {
                return MotionCheck::Collision { at };
            }
        }
        MotionCheck::Free { clearance: least }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.1 = interrupt.clone();
    }
    fn is_interrupted(&mut self) -> bool {
        self.1.ask()
    }
}

/// The robot.
#[derive(Clone, Debug)]
pub(crate) struct Counting {
    space: Square,
    ends: [Configuration; 2],
    check: Discs,
}

impl Counting {
    pub(crate) fn new() -> Self {
        let side = || JointRange::Interval { low: 0.0, high: 1.0 };
        let wall = (0..9).map(|i| ([0.5, 0.125 * f64::from(i)], 0.07));
        Self {
            space: Square(Joints::new([side(), side()]).unwrap()),
            ends: [[0.1, 0.5], [0.9, 0.5]].map(|q| Configuration::from(q.to_vec())),
            // A wall without a gap: no planner comes to an end by itself.
            check: Discs { discs: wall.collect(), queries: 0 },
        }
    }
}

impl TypedMotion for Counting {
    type Space = Square;
    type Checker = Discs;
    type Verifier<'c> = Steps<'c>;
    fn space(&self) -> &Square {
        &self.space
    }
    fn checker(&self) -> &Discs {
        &self.check
    }
    fn verifier(&self) -> Result<Steps<'_>, Error> {
        Ok(Steps(self, Interrupt::never()))
    }
}

impl Motion for Counting {
    fn start(&self) -> &Configuration {
        &self.ends[0]
    }
    fn goals(&self) -> &[Configuration] {
        &self.ends[1..]
    }
    fn tolerance(&self) -> f64 {
        1e-3
    }
    fn measured(&self, _: MetricName) -> Result<Measured<'_>, Error> {
        Ok(Measured::new(&self.space))
    }
    fn nearest_free(&self, _: &Configuration) -> Option<Configuration> {
        None
    }
}

impl Description for Counting {
    fn name(&self) -> &str {
        "counting"
    }
    fn space_name(&self) -> String {
        "square".to_owned()
    }
    fn touching(&self, _: &Configuration) -> Vec<Contact> {
        Vec::new()
    }
    fn columns(&self) -> Vec<Column> {
        vec![Column::new("x", "m"), Column::new("y", "m")]
    }
    fn limits(&self) -> Vec<Option<[f64; 2]>> {
        vec![Some([0.0, 1.0]); 2]
    }
    fn row(&self, q: &Configuration) -> Vec<f64> {
        q.as_slice().to_vec()
    }
    fn state(&self, row: &[f64]) -> Configuration {
        Configuration::from(row)
    }
}

impl Appearance for Counting {
    fn bodies(&self) -> Vec<Body> {
        let corners = [(0.0, 0.0), (0.01, 0.0), (0.0, 0.01)].map(|(x, y)| Point2::new(x, y)).to_vec();
        vec![Body { name: "point".into(), shape: BodyShape::Area(vec![corners]), pose: None }]
    }
    fn poses(&self, q: &Configuration) -> Vec<Isometry3<f64>> {
        vec![Isometry3::translation(q[0], q[1], 0.0)]
    }
    fn picture_spacing(&self) -> f64 {
        0.1
    }
}
