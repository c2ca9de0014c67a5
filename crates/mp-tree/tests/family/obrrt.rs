//! Obstacle-based RRT: with hints it solves what can be solved, and nothing else.

use crate::common::*;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::{SVector, Vector2};
use std::f64::consts::FRAC_PI_2;

/// G0 and one other method, half and half.
fn with(method: usize) -> GrowthWeights {
    let mut weights = [0.0; 8];
    (weights[0], weights[method]) = (0.5, 0.5);
    GrowthWeights(weights)
}

fn step(length: f64) -> Tuning {
    Tuning { step: Length::Absolute(length), ..Tuning::default() }
}

fn point_problem<'c, const N: usize>(
    space: &'c Rn<N>,
    boxes: &Boxes<N>,
    ends: [[f64; N]; 2],
) -> Problem<'c, Rn<N>, Checked<'c, Rn<N>>> {
    let local = certified(space, boxes.clone(), 1e-3);
    Problem::new(space, local, Exact(boxes.clone()), ends[0].into(), SVector::from(ends[1])).unwrap()
}

/// Solved over twenty seeds by the default weights, and over three by each method beside G0.
fn solves<C: Space>(
    space: &C,
    ends: [C::State; 2],
    mut valid: impl FnMut(&C::State) -> bool,
    mut solve: impl FnMut(GrowthWeights, &mut Rng) -> Outcome<Path<C::State>>,
) {
    let all = (0..20).map(|seed| (seed, GrowthWeights::default()));
    for (seed, weights) in all.chain((1..8).flat_map(|method| (0..3).map(move |seed| (seed, with(method))))) {
        let outcome = solve(weights, &mut Rng::seed(seed));
        let Outcome::Solved(path) = outcome else { panic!("{weights:?} seed {seed}: {outcome:?}") };
        assert_path(space, &path, &ends[0], |q| *q == ends[1], &mut valid);
    }
}

fn point<const N: usize>(space: &Rn<N>, boxes: &Boxes<N>, ends: [[f64; N]; 2], length: f64)
where
    Rn<N>: DefaultNn<State = SVector<f64, N>>,
{
    let free = |q: &SVector<f64, N>| boxes.distance(q) > 0.0;
    solves(space, ends.map(SVector::from), free, |weights, rng| {
        let problem = point_problem(space, boxes, ends);
        let mut planner = Obrrt::new(problem, boxes.clone(), step(length), weights).unwrap();
        let outcome = planner.solve(rng, &mut Iterations(40_000), &mut ());
        let mut distinct: Vec<_> = planner.tree().states().iter().map(|q| format!("{q:?}")).collect();
        distinct.sort();
        distinct.dedup();
        assert_eq!(distinct.len(), planner.tree().len(), "a state twice");
        assert!(planner.tree().states().iter().all(|q| space.contains(q)));
        if let Outcome::Solved(path) = &outcome {
            assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
        }
        outcome
    });
}

#[test]
fn narrow_passages() {
    point(&square(), &slit(0.2, 0.8, 0.04), [[0.1, 0.2], [0.9, 0.2]], 0.1);
    point(&cube(), &slit(0.1, 0.7, 0.15), [[0.1; 3], [0.9, 0.1, 0.1]], 0.2);
}

#[test]
fn bug_traps() {
    point(&square(), &hollow([0.4, 0.5], 0.2, 0.05, 0.03), [[0.4, 0.5], [0.05, 0.5]], 0.1);
    point(&cube(), &hollow([0.4; 3], 0.2, 0.05, 0.08), [[0.4; 3], [0.05, 0.4, 0.4]], 0.2);
}

#[test]
fn a_rod_turns_to_pass_a_gap() {
    let space = Se2::new([0.0; 2], [1.0; 2]).unwrap();
    let rod = Rod { boxes: slit(0.05, 0.5, 0.1), half_length: 0.1, radius: 0.01 };
    let ends = [Se2State::new(0.2, 0.3, FRAC_PI_2), Se2State::new(0.8, 0.3, -FRAC_PI_2)];
    let mut valid = rod.clone();
    solves(
        &space,
        ends,
        |q| valid.is_valid(q),
        |weights, rng| {
            let local = certified(&space, rod.clone(), 1e-3);
            let fine = FineDiscrete::new(&space, rod.clone(), Length::Fraction(5e-4)).unwrap();
            let problem = Problem::new(&space, local, fine, ends[0], ends[1]).unwrap();
            let mut planner = Obrrt::new(problem, rod.clone(), step(0.3), weights).unwrap();
            planner.solve(rng, &mut Iterations(40_000), &mut ())
        },
    );
}

/// The growth methods in the loop of RRT-Connect.
#[test]
fn two_trees_grow_along_obstacles() {
    let (space, boxes) = (square(), hollow([0.4, 0.5], 0.2, 0.05, 0.03));
    for seed in 0..20 {
        let problem = point_problem(&space, &boxes, [[0.4, 0.5], [0.05, 0.5]]);
        let mut planner =
            ObrrtConnect::new(problem, boxes.clone(), step(0.1), GrowthWeights::default()).unwrap();
        let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(20_000), &mut ());
        let Outcome::Solved(path) = outcome else { panic!("seed {seed}: {outcome:?}") };
        assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
    }
}

#[test]
fn a_closed_box_is_never_entered() {
    let (space, boxes) = (square(), hollow([0.7, 0.5], 0.1, 1e-3, 0.0));
    for method in 0..8 {
        let problem = point_problem(&space, &boxes, [[0.1, 0.5], [0.7, 0.5]]);
        let mut planner = Obrrt::new(problem, boxes.clone(), step(0.2), with(method)).unwrap();
        let outcome = planner.solve(&mut Rng::seed(3), &mut Iterations(4_000), &mut ());
        assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations), "G{method}");
    }
}

/// Proposes one state.
struct Always(Vector2<f64>);

impl TargetSampler<Rn<2>> for Always {
    fn next_target<Se: Selector<Rn<2>>>(
        &mut self,
        _: &mut Rng,
        _: &Rn<2>,
        _: &[Vector2<f64>],
        _: &mut Se,
    ) -> Vector2<f64> {
        self.0
    }
}

/// Before a wall, toward what is straight behind it: only methods that follow obstacles get on, and those
/// that follow what they hit by one axis at a time.
#[test]
fn methods_do_as_they_say() {
    let (space, wall) = (square(), Boxes(vec![([0.5, -1.0], [0.6, 2.0])]));
    for method in 0..8 {
        let only = GrowthWeights(std::array::from_fn(|i| f64::from(u8::from(i == method))));
        let parts = TreePlannerParts {
            target_sampler: Always([0.9, 0.5].into()),
            selector: NearestSelector(Linear::new()),
            extender: ObstacleGuided::new(wall.clone(), only).unwrap(),
            inserter: AppendDistinct::default(),
            tuning: Tuning { goal_bias: 0.0, ..step(0.1) },
        };
        let problem = point_problem(&space, &wall, [[0.45, 0.5], [0.9, 0.5]]);
        let mut planner = SingleTree::assemble(problem, parts).unwrap();
        let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(50), &mut ());
        assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations));
        let tree = planner.tree();
        assert_eq!(tree.len() > 1, ![0, 1, 4].contains(&method), "G{method}");
        if method < 7 {
            for id in 1..tree.len() as NodeId {
                let way = tree.state(id) - tree.state(tree.parent(id).unwrap());
                assert!(way.x == 0.0 || way.y == 0.0, "G{method}: {way:?}");
            }
        }
    }
}

#[test]
fn bad_weights_are_refused() {
    let (space, boxes) = (square(), Boxes::default());
    let cases = [0.0, -0.1, f64::NAN, f64::INFINITY, 1e308];
    for (i, value) in cases.into_iter().enumerate() {
        let mut weights = [0.0; 8];
        weights[i % 8] = value;
        if value == 1e308 {
            weights = [value; 8];
        }
        let problem = point_problem(&space, &boxes, [[0.1, 0.5], [0.9, 0.5]]);
        let error =
            Obrrt::new(problem, boxes.clone(), step(0.2), GrowthWeights(weights)).map(drop).unwrap_err();
        assert!(matches!(error, BuildError::OutOfRange { name: "weights", .. }), "{error}");
    }
}
