//! Erased problems are planned as generic ones, to the bit.

use crate::common::*;
use mp_cspace::erased::AnySpace;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::{DVector, SVector};
use std::fmt::Debug;
use std::sync::Arc;

/// A robot as planners by name may want one.
trait Robot<S>: Clearance<S> + MotionBound<S> + Validity<S> + ObstacleHints<S> + Clone + Send + Sync {}
impl<S, V: Clearance<S> + MotionBound<S> + Validity<S> + ObstacleHints<S> + Clone + Send + Sync> Robot<S>
    for V
{
}

type Made<'c, P, S> = Problem<'c, P, Straight<'c, P, erased::AnyCheck<'c, S>>>;

/// A problem in `planned`, which is `space` or its erasure.
fn problem<'c, C: Space, P: Space<State = C::State>, V: Robot<C::State> + 'c>(
    space: &'c C,
    planned: &'c P,
    robot: &V,
    [start, goal]: &[C::State; 2],
) -> Result<Made<'c, P, C::State>, BuildError> {
    let check = Certified::new(space, robot.clone(), 1e-3).unwrap();
    let fine = FineDiscrete::new(space, robot.clone(), Resolution::Fraction(1e-3)).unwrap();
    let local = Straight::new(planned, Box::new(check) as erased::AnyCheck<'c, C::State>);
    let problem = Problem::new(planned, local, fine, start.clone(), goal.clone())?;
    Ok(problem.with_obstacles(knowledge(space, robot)))
}

fn same<C, V>(space: &C, robot: V, ends: [C::State; 2], names: &[String])
where
    C: DefaultNn<State: TreeState + Debug, Nn: Send + Sync + 'static> + Clone + Send + 'static,
    V: Robot<C::State>,
{
    let erased = AnySpace::new(space);
    let (settings, workers) = (Settings::parse(["step=10%"]).unwrap(), Workers::alone());
    for name in names {
        let make = || problem(space, space, &robot, &ends);
        let mut generic = build_from(name, make, C::Nn::default(), &settings, &workers).unwrap();
        let make: ProblemFactory<'_, C::State> = Arc::new(|| problem(space, &erased, &robot, &ends));
        let mut any = C::State::tree_planner(name, make, AnyIndex::of(space), &settings, &workers).unwrap();
        for seed in 1..3 {
            let found = [&mut generic, &mut any].map(|planner| {
                let stop = &mut Iterations(planner.progress().iterations + 1_500);
                let outcome = planner.solve(&mut Rng::seed(seed), stop, &mut ());
                (outcome, planner.progress())
            });
            assert_eq!(found[0], found[1], "{name} seed {seed}");
        }
    }
}

/// The planners, and each wrapper once.
fn names() -> Vec<String> {
    let wrapped = ["or-rrt", "shared-rrt", "shared-rrs", "restart-rrs-connect", "or-restart-rrt-connect"];
    planners().iter().map(|info| info.name).chain(wrapped).map(str::to_owned).collect()
}

#[test]
fn a_point_is_planned_the_same() {
    let ends = [SVector::from([0.1, 0.2]), SVector::from([0.9, 0.2])];
    same(&square(), slit(0.1, 0.8, 0.1), ends, &names());
}

#[test]
fn a_rod_is_planned_the_same() {
    let rod = Rod { boxes: slit(0.05, 0.5, 0.15), half_length: 0.1, radius: 0.01 };
    let ends = [Se2State::new(0.2, 0.3, 1.0), Se2State::new(0.8, 0.3, -1.0)];
    same(&Se2::new([0.0; 2], [1.0; 2]).unwrap(), rod, ends, &names());
}

/// States without a size at compile time, and names that are refused in the same words.
#[test]
fn joints_are_planned_the_same() {
    let space = RnDyn::new(vec![0.0; 2], vec![1.0; 2]).unwrap();
    let wall = slit(0.1, 0.8, 0.1);
    let ends = [DVector::from_vec(vec![0.1, 0.2]), DVector::from_vec(vec![0.9, 0.2])];
    same(&space, Joints(wall), ends, &["rrt-connect".to_owned(), "rrt-star".to_owned(), "rrs".to_owned()]);
}

/// A point in the plane by a state of any length.
#[derive(Clone, Debug)]
struct Joints(Boxes<2>);

fn plane(q: &DVector<f64>) -> SVector<f64, 2> {
    SVector::from([q[0], q[1]])
}

impl Validity<DVector<f64>> for Joints {
    fn is_valid(&mut self, q: &DVector<f64>) -> bool {
        self.0.is_valid(&plane(q))
    }
}
impl Clearance<DVector<f64>> for Joints {
    fn clearance(&mut self, q: &DVector<f64>, enough: f64) -> f64 {
        self.0.clearance(&plane(q), enough)
    }
}
impl MotionBound<DVector<f64>> for Joints {
    fn motion_bound(&self, from: &DVector<f64>, to: &DVector<f64>) -> f64 {
        (to - from).norm()
    }
}
impl ObstacleHints<DVector<f64>> for Joints {
    fn touches(&mut self, q: &DVector<f64>) -> bool {
        !self.is_valid(q)
    }
    fn along(
        &mut self,
        _: &DVector<f64>,
        _: &DVector<f64>,
        _: Option<&DVector<f64>>,
        _: &mut Rng,
    ) -> Option<DVector<f64>> {
        None
    }
    fn turned(&self, position: &DVector<f64>, _: &DVector<f64>) -> DVector<f64> {
        position.clone()
    }
    fn carried(&self, q: &DVector<f64>, from: &DVector<f64>, to: &DVector<f64>) -> DVector<f64> {
        q + (to - from)
    }
}
