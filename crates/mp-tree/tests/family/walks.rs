//! Steps that go on as the tree came.

use mp_cspace::*;
use mp_tree::*;
use nalgebra::Vector4;

/// How many iterations it takes through a thin corridor with a bend, if this share of the steps are walkers'.
fn iterations(share: f64, seed: u64) -> u64 {
    let space = Rn::<4>::new([0.0; 4], [1.0; 4]).unwrap();
    let along = |t: f64| {
        let bent = 0.5 - (t - 0.5).abs();
        Vector4::new(t, bent, t, 1.0 - bent)
    };
    let free = |q: &Vector4<f64>| (q - along(0.5 * (q.x + q.z))).norm() < 0.01;
    let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.001)).unwrap());
    let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.000_5)).unwrap();
    let problem = Problem::new(&space, local, verifier, along(0.02), along(0.98)).unwrap();
    let parts = TreePlannerParts {
        target_sampler: Samples(Uniform(&space)),
        selector: NearestSelector(Linear::default()),
        extender: (Walks::new(Extend, share).unwrap(), Connect::default()),
        inserter: Append,
        tuning: Tuning::default(),
    };
    let mut planner = TwoTrees::assemble("walks", problem, parts).unwrap();
    let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(30_000), &mut ());
    if let Outcome::Solved(path) = &outcome {
        assert!(path.states.iter().all(free));
    }
    planner.progress().iterations
}

#[test]
fn walkers_go_on_along_a_thin_corridor() {
    let of = |share| (0..5).map(|seed| iterations(share, seed)).sum::<u64>();
    let (with, without) = (of(0.5), of(0.0));
    assert!(10 * with < without, "{with} iterations with walkers, {without} without");
}

#[test]
fn a_share_is_a_part() {
    for share in [-0.1, 1.1, f64::NAN] {
        assert!(matches!(Walks::new(Extend, share), Err(BuildError::OutOfRange { name: "walks", .. })));
    }
}
