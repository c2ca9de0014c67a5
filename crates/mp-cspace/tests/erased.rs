//! Erased spaces and indexes give the same answers as the originals, to the bit.

use mp_cspace::erased::{AnyIndex, AnySpace};
use mp_cspace::{
    DefaultNn, Manhattan, MaxDisplacement, NearestNeighbors, NodeId, Rng, Se2, Se3, Space, WithMetric,
};
use nalgebra::Point2;

fn same<C: DefaultNn<Nn: 'static> + Clone + Send + 'static>(space: &C) {
    let (erased, mut index) = (AnySpace::new(space), C::Nn::default());
    let mut any = AnyIndex::of(space);
    let mut rng = Rng::seed(1);
    let draw = |space: &C, seed| space.sample_uniform(&mut Rng::stream(7, seed));
    let points: Vec<C::State> = (0..500).map(|_| space.sample_uniform(&mut rng)).collect();
    for id in 0..points.len() {
        index.inserted(space, &points[..=id], id as NodeId);
        any.inserted(&erased, &points[..=id], id as NodeId);
    }
    let copy = any.clone();
    let (mut one, mut other) = (Vec::new(), Vec::new());
    for seed in 0..100 {
        let (a, b) = (draw(space, seed), draw(space, seed + 1));
        assert_eq!(erased.sample_uniform(&mut Rng::stream(7, seed)), a);
        assert_eq!(erased.distance(&a, &b).to_bits(), space.distance(&a, &b).to_bits());
        assert_eq!(erased.interpolate(&a, &b, 0.3), space.interpolate(&a, &b, 0.3));
        assert_eq!(erased.contains(&a), space.contains(&a));
        let sum = 1.1 * space.distance(&a, &b);
        let between = erased.sample_between(&a, &b, sum, &mut Rng::seed(seed));
        assert_eq!(between, space.sample_between(&a, &b, sum, &mut Rng::seed(seed)));
        let nearest = index.nearest(space, &points, &a);
        assert_eq!(any.nearest(&erased, &points, &a), nearest);
        assert_eq!(copy.nearest(&erased, &points, &a), nearest);
        index.k_nearest(space, &points, &a, 7, &mut one);
        any.k_nearest(&erased, &points, &a, 7, &mut other);
        assert_eq!(one, other);
        index.within(space, &points, &a, 0.2 * space.extent(), &mut one);
        any.within(&erased, &points, &a, 0.2 * space.extent(), &mut other);
        assert_eq!(one, other);
    }
    assert_eq!((erased.dim(), erased.extent()), (space.dim(), space.extent()));
    any.clear();
    assert_eq!(any.nearest(&erased, &points, &points[0]), None);
}

#[test]
fn nothing_changes_behind_the_pointer() {
    let se2 = Se2::new([0.0; 2], [2.0, 3.0]).unwrap();
    same(&se2);
    same(&Se3::new([0.0; 3], [2.0, 3.0, 4.0]).unwrap());
    same(&WithMetric::new(se2.clone(), Manhattan));
    let corners = MaxDisplacement::planar(vec![Point2::new(0.3, 0.0), Point2::new(-0.1, 0.2)]).unwrap();
    same(&WithMetric::new(se2, corners));
}
