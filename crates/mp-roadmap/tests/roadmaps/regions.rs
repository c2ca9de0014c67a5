//! Roadmaps by regions: regions tile the space, and pieces made anywhere give the same roadmap.

use crate::common::*;
use crate::engine::{ENDS, problem};
use mp_cspace::erased::AnyCheck;
use mp_cspace::*;
use mp_roadmap::*;
use nalgebra::Vector2;
use std::collections::BTreeSet;
use std::f64::consts::PI;

type Point = Vector2<f64>;
type Local<'c> = Straight<'c, Rn<2>, AnyCheck<'c, Point>>;

/// Each state is in one region, as large as the others; two regions that a motion passes one after the other
/// are adjacent, and all adjacent ones are passed so. Samples of a region are in it, or beyond its faces by
/// no more than the overlap.
fn tiles<C: Space>(space: &C, regions: usize, cut: u32) {
    let whole = Subdivision::new(space, regions, 0.0).unwrap();
    let what = format!("{regions} regions of {} numbers", space.dim());
    assert_eq!(whole.regions(), cut, "{what}");
    let mut rng = Rng::seed(regions as u64);
    let mut counts = vec![0_u32; cut as usize];
    let samples = 200 * cut;
    for _ in 0..samples {
        counts[whole.region_of(space, &space.sample_uniform(&mut rng)) as usize] += 1;
    }
    // Binomial, of mean 200: six standard deviations.
    assert!(counts.iter().all(|count| (115..=285).contains(count)), "{what}: {counts:?}");
    let pairs: BTreeSet<[u32; 2]> = whole.pairs().iter().copied().collect();
    assert!(whole.pairs().is_sorted() && pairs.len() == whole.pairs().len());
    assert!(pairs.iter().all(|[a, b]| a < b && *b < cut));
    let mut passed = BTreeSet::new();
    for _ in 0..40 * cut.max(10) {
        let [from, to] = [(); 2].map(|()| space.sample_uniform(&mut rng));
        let at = |t: f64| whole.region_of(space, &space.interpolate(&from, &to, t));
        let mut open = vec![(0.0, 1.0)];
        while let Some((a, b)) = open.pop() {
            let (before, after, middle) = (at(a), at(b), 0.5 * (a + b));
            if b - a > 1e-9 && (before != after || b - a > 0.02) {
                open.extend([(a, middle), (middle, b)]);
            } else if before != after {
                passed.insert([before.min(after), before.max(after)]);
            }
        }
    }
    assert_eq!(passed, pairs, "{what}");
    for overlap in [0.0, 0.1, 1.0] {
        let wide = Subdivision::new(space, regions, overlap).unwrap();
        assert_eq!(wide.pairs(), whole.pairs());
        for region in 0..cut {
            let mut within = 0;
            for _ in 0..50 {
                let q = wide.sample(space, region, &mut rng);
                assert!(space.contains(&q));
                within += u32::from(whole.region_of(space, &q) == region);
            }
            // With an overlap of all of its width, one of 81 samples is in a region that is cut along four
            // numbers.
            let least = if overlap == 0.0 { 50 } else { u32::from(overlap < 1.0) };
            assert!(within >= least, "{what}, {overlap}: {within}");
        }
    }
}

#[test]
fn regions_tile_every_space() {
    for (regions, cut) in [(1, 1), (2, 2), (7, 7), (12, 12), (16, 16)] {
        tiles(&square(), regions, cut);
        tiles(&cube(), regions, cut);
        tiles(&Se2::new([0.0, 2.0], [3.0, 5.0]).unwrap(), regions, cut);
        tiles(&Se3::new([-1.0; 3], [1.0, 2.0, 3.0]).unwrap(), regions, cut);
        let hinge = JointRange::Interval { low: -1.0, high: 2.0 };
        let arm = Joints::<Configuration>::new([hinge, JointRange::Circle, hinge]).unwrap();
        tiles(&arm, regions, cut);
        let base = Se3::new([0.0; 3], [4.0; 3]).unwrap();
        tiles(&FloatingJoints::new(base, arm).unwrap(), regions, cut);
    }
    // Rotations alone are not cut, and a metric changes nothing.
    tiles(&So3, 16, 1);
    tiles(&Joints::<Configuration>::new([JointRange::Circle; 3]).unwrap(), 8, 1);
    let turns = WithMetric::new(Se2::new([0.0; 2], [1.0; 2]).unwrap(), Manhattan);
    tiles(&turns, 6, 6);
}

#[test]
fn regions_are_compact_and_long_sides_are_cut() {
    let pairs = |high: [f64; 3], regions| {
        Subdivision::new(&Rn::<3>::new([0.0; 3], high).unwrap(), regions, 0.0).unwrap().pairs().len()
    };
    assert_eq!(pairs([1.0; 3], 27), 3 * 2 * 9);
    assert_eq!(pairs([1.0; 3], 64), 3 * 3 * 16);
    assert_eq!(pairs([8.0, 1.0, 1.0], 8), 7);
    assert_eq!(pairs([2.0, 2.0, 0.1], 4), 4);
    let space = Se2::new([0.0; 2], [1.0; 2]).unwrap();
    let quarters = Subdivision::new(&space, 4, 0.0).unwrap();
    let of = |x, y| quarters.region_of(&space, &Se2State::new(x, y, PI));
    assert_eq!([of(0.1, 0.1), of(0.9, 0.1), of(0.1, 0.9), of(0.9, 0.9)], [0, 1, 2, 3]);
    for (regions, overlap) in [(0, 0.1), (1_000_001, 0.1), (4, -0.1), (4, 1.1), (4, f64::NAN)] {
        assert!(Subdivision::new(&space, regions, overlap).is_err(), "{regions} {overlap}");
    }
}

const REACH: Reachable = Reachable { neighbours: 8, radius: 0.4, cycles: false };
const REGIONS: Regions = Regions { regions: 12, samples: 25, overlap: 0.1, connections: 20 };

fn planner<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    gullible: bool,
) -> RegionalPrm<'c, Rn<2>, Local<'c>, KdTree<2>> {
    RegionalPrm::new(problem(space, boxes, ENDS, gullible), REGIONS, REACH).unwrap()
}

/// The checkers of `threads` threads.
fn checkers<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    gullible: bool,
    count: usize,
) -> Vec<EdgeChecker<'c, Rn<2>, Local<'c>>> {
    (0..count).map(|_| EdgeChecker::of(problem(space, boxes, ENDS, gullible), PATIENCE).0).collect()
}

/// Pieces that are made one by one, each from what it needs, in any order, and sent as bytes.
#[test]
fn pieces_made_alone_give_the_roadmap_of_the_planner() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let mut builder = planner(&space, &boxes, false).into_builder();
    let regions = InRegions::new(&space, KdTree::<2>::new(), REGIONS, REACH).unwrap();
    builder.build(&mut Rng::seed(9), &mut Iterations(regions.items()), &mut ());
    let whole = builder.map().to_bytes(1);
    assert!(builder.progress().motions > 200 && builder.progress().nodes > 150);

    let seed = rand::RngExt::random(&mut Rng::seed(9));
    let mut checker = checkers(&space, &boxes, false, 1).remove(0);
    let count = u64::from(regions.subdivision().regions());
    let mut motions = 0;
    let mut piece = |item: u64, map: &Roadmap<Point>| {
        let piece = regions.piece_of(item, map, &mut checker, seed);
        motions += piece.motions();
        piece.to_bytes()
    };
    let mut built: Vec<Vec<u8>> = (0..count).rev().map(|region| piece(region, &Roadmap::new())).collect();
    built.reverse();
    let add = |map: &mut Roadmap<Point>, bytes: &[u8], members| {
        let before = map.len() as NodeId;
        let piece = Piece::from_bytes(bytes, members).unwrap();
        assert_eq!(piece.to_bytes(), bytes);
        piece.insert(map, |_, _, _| true);
        before..map.len() as NodeId
    };
    let mut connected: Vec<Vec<u8>> = (count..regions.items())
        .rev()
        .map(|item| {
            let mut two = Roadmap::new();
            for region in regions.pair(item).unwrap() {
                add(&mut two, &built[region as usize], Vec::new());
            }
            piece(item, &two)
        })
        .collect();
    connected.reverse();
    let mut map = Roadmap::new();
    let ids: Vec<_> = built.iter().map(|bytes| add(&mut map, bytes, Vec::new())).collect();
    for (item, bytes) in (count..).zip(&connected) {
        let [one, other] = regions.pair(item).unwrap().map(|region| ids[region as usize].clone());
        add(&mut map, bytes, one.chain(other).collect());
    }
    assert!(map.to_bytes(1) == whole);
    assert_eq!(motions, builder.progress().motions);
    // All edges are free, and regions are connected where they can be: the two sides of the wall by its
    // passage alone.
    assert!(map.all_edges().all(|(_, [a, b], _)| !boxes.hit(map.state(a), map.state(b))));
    assert!(map.component_sizes()[0] * 10 > map.len() * 4, "{:?}", map.component_sizes());
    // Damaged bytes are refused, or are another piece; none is a fault.
    for bytes in [&built[3], &connected[3]] {
        let members = || {
            let count = u32::from_le_bytes(bytes[8..12].try_into().unwrap());
            (0..count).collect::<Vec<NodeId>>()
        };
        assert!(
            (0..bytes.len()).all(|end| Piece::<Point, ()>::from_bytes(&bytes[..end], members()).is_err())
        );
        assert!(Piece::<Point, ()>::from_bytes(bytes, vec![0; members().len() + 1]).is_err());
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x41;
            if let Ok(piece) = Piece::<Point, ()>::from_bytes(&damaged, members()) {
                let mut map = Roadmap::new();
                for _ in members() {
                    map.add(Point::zeros(), Tag::default());
                }
                piece.insert(&mut map, |_, _, _| true);
            }
        }
    }
}

/// The same bytes, counts and path on any number of threads; also where the verifier refuses what the local
/// planner believes, until each new edge is verified.
#[test]
fn threads_change_nothing() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.05));
    for gullible in [false, true] {
        let run = |threads: usize| {
            let checkers = checkers(&space, &boxes, gullible, threads);
            let mut planner = planner(&space, &boxes, gullible);
            if threads > 0 {
                planner = planner.on(Workers::new(threads).unwrap(), checkers);
            }
            let mut rng = Rng::seed(3);
            let outcome = planner.solve(&mut rng, &mut Iterations(2_000), &mut ());
            let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
            assert!(path.states.windows(2).all(|pair| !boxes.hit(&pair[0], &pair[1])));
            (planner.map().to_bytes(1), planner.progress(), path)
        };
        let alone = run(0);
        assert_eq!(alone.1.rejected >= PATIENCE, gullible, "{:?}", alone.1);
        for threads in [1, 2, 3] {
            assert!(run(threads) == alone, "{threads} threads, {gullible}");
        }
    }
}

/// Later rounds make each region denser, and nodes stay with the region that made them; a roadmap that is
/// gone on with too.
#[test]
fn rounds_make_it_denser_everywhere() {
    let (space, boxes) = (square(), Boxes::<2>::default());
    let regions = InRegions::new(&space, KdTree::<2>::new(), REGIONS, REACH).unwrap();
    let mut builder = planner(&space, &boxes, false).into_builder();
    let mut rng = Rng::seed(2);
    for round in 1..=4 {
        builder.build(&mut rng, &mut Iterations(round * regions.items()), &mut ());
        let mut counts = vec![0; 12];
        builder.map().tags().for_each(|tag| counts[tag.obstacle.unwrap() as usize] += 1);
        assert_eq!(counts, vec![25 * round; 12]);
        assert_eq!(builder.map_mut().components(), 1);
    }
    let before = builder.map().len();
    let mut next = planner(&space, &boxes, false).into_builder().resume(builder.into_map()).unwrap();
    next.build(&mut Rng::seed(5), &mut Iterations(regions.items()), &mut ());
    assert_eq!((next.map().len(), next.map_mut().components()), (before + 300, 1));
}
