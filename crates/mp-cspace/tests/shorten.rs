//! Shortening never leaves free space, never lengthens, and repeats itself.

use mp_cspace::shorten::{
    Draft, Effort, bspline, bypass, loosen, partial_shortcut, reduce, shortcut, simplified,
    simplified_by_samples, simplify, tauten,
};
use mp_cspace::*;
use nalgebra::Vector2;

/// A segment robot of length 0.4 in a square with a disc in the middle, checked at points.
fn free(q: &Se2State) -> bool {
    (0..=8).all(|i| {
        let p = q.transform_point(&[f64::from(i) * 0.05 - 0.2, 0.0].into());
        p.coords.norm() > 1.0
    })
}

fn space() -> Se2 {
    Se2::new([-3.0, -3.0], [3.0, 3.0]).unwrap()
}

/// A detour around the disc with much idle turning, by random steps kept free.
fn rambling(space: &Se2, seed: u64) -> Path<Se2State> {
    let mut rng = Rng::seed(seed);
    let mut check = Discrete::new(space, free, Length::Absolute(0.01)).unwrap();
    let mut states = vec![Se2State::new(-2.0, 0.0, 0.0)];
    for i in 1..=12 {
        let around = std::f64::consts::PI * (1.0 - f64::from(i) / 12.0);
        let wished = Se2State::new(2.2 * mp_math::cos(around), 2.2 * mp_math::sin(around), 0.0);
        let last = states[states.len() - 1];
        for _ in 0..100 {
            let noise = space.sample_uniform(&mut rng);
            let q = Se2State::new(
                wished.translation.x + 0.1 * noise.translation.x,
                wished.translation.y + 0.1 * noise.translation.y,
                noise.angle,
            );
            if check.check_motion(&last, &q).is_free() {
                states.push(q);
                break;
            }
        }
    }
    Path::straight(states)
}

fn all_free(space: &Se2, path: &Path<Se2State>) {
    let mut check = FineDiscrete::new(space, free, Length::Absolute(0.005)).unwrap();
    let report = verify_path(space, path, &mut check);
    assert!(report.is_free(), "{:?}", report.fault);
}

#[test]
fn every_kind_stays_free_and_does_not_lengthen() {
    let space = space();
    let effort = Effort { attempts: 300, patience: 100, least_gain: 0.0, taut: 5, rounds: 3 };
    for seed in 0..10 {
        let path = rambling(&space, seed);
        let mut check = FineDiscrete::new(&space, free, Length::Absolute(0.005)).unwrap();
        let before = path.length(&space);
        all_free(&space, &path);
        let results = [
            reduce(&space, &mut check, &path),
            shortcut(&space, &mut check, &path, effort, &mut Rng::seed(seed)),
            partial_shortcut(&space, &mut check, &path, effort, &mut Rng::seed(seed)),
            bspline(&space, &mut check, &path, 3),
            simplify(&space, &mut check, &path, effort, &mut Rng::seed(seed)),
            tauten(&space, &mut check, &path, effort),
        ];
        for result in &results {
            all_free(&space, result);
            assert_eq!(result.states.first(), path.states.first());
            assert_eq!(result.states.last(), path.states.last());
            assert!(result.length(&space) <= before * (1.0 + 1e-12));
        }
        let lengths = results.map(|r| r.length(&space));
        assert!(
            lengths[1] < 0.8 * before && lengths[2] < 0.9 * before && lengths[4] < 0.7 * before,
            "{before} to {lengths:?}"
        );
        let again = simplify(&space, &mut check, &path, effort, &mut Rng::seed(seed));
        assert_eq!(again.length(&space), lengths[4]);
    }
}

/// Corners in free space are rounded: the sharpest turn gets flatter.
#[test]
fn bspline_rounds_corners() {
    let space = Rn::<2>::new([0.0, 0.0], [4.0, 4.0]).unwrap();
    let path = Path::straight([(0.0, 0.0), (2.0, 2.0), (4.0, 0.0)].map(|(x, y)| Vector2::new(x, y)).to_vec());
    let sharpest = |path: &Path<Vector2<f64>>| {
        let turn = |w: &[Vector2<f64>]| (w[1] - w[0]).angle(&(w[2] - w[1]));
        path.states.windows(3).map(turn).fold(0.0, f64::max)
    };
    let valid = |q: &Vector2<f64>| q.y < 1.9 || (q.x - 2.0).abs() < 0.1;
    let mut check = FineDiscrete::new(&space, valid, Length::Absolute(0.01)).unwrap();
    let rounded = bspline(&space, &mut check, &path, 4);
    assert!(sharpest(&rounded) < 0.3 * sharpest(&path));
    assert!(rounded.length(&space) < path.length(&space));
    let mut never = |_: &Vector2<f64>| false;
    let mut check = FineDiscrete::new(&space, &mut never, Length::Absolute(0.1)).unwrap();
    assert_eq!(bspline(&space, &mut check, &path, 4), path);
}

/// The shortest way round a disc is two tangents and an arc. Leaving out states finds corners of the path only.
#[test]
fn a_taut_path_follows_what_it_leads_round() {
    let space = Rn::<2>::new([-3.0, -3.0], [3.0, 3.0]).unwrap();
    let outside = |q: &Vector2<f64>| q.norm() > 1.0;
    let mut check = FineDiscrete::new(&space, outside, Length::Absolute(1e-3)).unwrap();
    let corners = [(-2.0, 0.0), (-2.0, 2.0), (0.0, 2.5), (2.0, 2.0), (2.0, 0.0)];
    let path = Path::straight(corners.map(|(x, y)| Vector2::new(x, y)).to_vec());
    let shortest = 2.0 * 3.0_f64.sqrt() + std::f64::consts::PI / 3.0;
    let effort = Effort { taut: 5, ..Effort::default() };
    let taut = tauten(&space, &mut check, &path, effort);
    assert!(verify_path(&space, &taut, &mut check).is_free());
    let part = |path: &Path<_>| path.length(&space) / shortest;
    assert!(part(&taut) < 1.02 && part(&reduce(&space, &mut check, &path)) > 1.2, "{}", part(&taut));
    // Without any attempt corners are cut, but no states are joined.
    let none = Effort { attempts: 0, ..effort };
    assert!(part(&tauten(&space, &mut check, &path, none)) > part(&taut));
}

#[test]
fn reduction_takes_the_straight_way() {
    let space = Rn::<2>::new([0.0, 0.0], [4.0, 4.0]).unwrap();
    let zigzag = (0..41).map(|i| Vector2::new(f64::from(i) * 0.1, f64::from(i % 2) * 0.1));
    let path = Path::straight(zigzag.collect());
    let mut check = FineDiscrete::new(&space, |_: &Vector2<f64>| true, Length::Absolute(0.1)).unwrap();
    assert_eq!(reduce(&space, &mut check, &path).states.len(), 2);
}

#[test]
fn degenerate_paths_are_left_alone() {
    let space = space();
    let mut check = FineDiscrete::new(&space, free, Length::Absolute(0.01)).unwrap();
    let q = Se2State::new(2.0, 2.0, 0.0);
    for n in 0..4 {
        let path = Path::straight(vec![q; n]);
        let out = simplify(&space, &mut check, &path, Effort::default(), &mut Rng::seed(1));
        assert_eq!(out.states.first(), path.states.first());
        assert_eq!(out.length(&space), 0.0);
        assert!(out.states.len() <= n);
    }
}

/// Each shortcut of one factor adds states. They do not pile up where there is room to leave them out.
#[test]
fn states_do_not_pile_up() {
    let (space, effort) =
        (space(), Effort { attempts: 300, patience: 300, least_gain: 0.0, taut: 0, rounds: 0 });
    for seed in 0..10 {
        let path = rambling(&space, seed);
        let mut open = Discrete::new(&space, |_: &Se2State| true, Length::Absolute(0.5)).unwrap();
        let short = partial_shortcut(&space, &mut open, &path, effort, &mut Rng::seed(seed));
        assert!(
            short.states.len() <= 4 * path.states.len(),
            "{} of {}",
            short.states.len(),
            path.states.len()
        );
    }
}

/// What a coarser check made short is mostly refused by a finer one; once it is loosened it mostly passes, and is hardly longer.
#[test]
fn loose_paths_pass_a_finer_check() {
    let space = Rn::<2>::new([0.0, 0.0], [4.0, 4.0]).unwrap();
    let free = |q: &Vector2<f64>| !((1.9..=2.1).contains(&q.x) && q.y <= 3.0);
    let given = [(1.0, 1.0), (0.5, 3.5), (1.5, 3.9), (3.0, 3.4), (3.0, 1.0)];
    let path = Path::straight(given.map(|(x, y)| Vector2::new(x, y)).to_vec());
    // As near to the wall as it goes.
    let effort = Effort { taut: 5, ..Effort::default() };
    let mut passed = [0, 0];
    for seed in 0..100 {
        let mut check = Discrete::new(&space, free, Length::Fraction(0.0025)).unwrap();
        let draft = simplified(&space, &mut check, &path, effort, &mut Rng::seed(seed));
        let mut fine = FineDiscrete::new(&space, free, Length::Fraction(0.0005)).unwrap();
        let (loose, refused) = loosen(&space, &mut fine, &path, &draft, 0.005);
        let tight = draft.path();
        passed[0] += u32::from(verify_path(&space, &tight, &mut fine).is_free());
        if refused.is_empty() {
            passed[1] += 1;
            assert!(verify_path(&space, &loose, &mut fine).is_free(), "seed {seed}");
            assert!(loose.length(&space) < 1.05 * tight.length(&space), "seed {seed}");
        }
    }
    assert!(passed[0] < 50 && passed[1] > 95, "{passed:?}");
}

/// The straight way from start to goal has no state that could be moved: it stays refused.
#[test]
fn loosening_says_which_edges_stay_refused() {
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
    let [a, b, c] = [[0.0, 0.0], [0.5, 0.5], [1.0, 0.0]].map(Vector2::from);
    let given = Path::straight(vec![a, b, c]);
    let mut coarse = |_: &Vector2<f64>| true;
    let mut coarse = Discrete::new(&space, &mut coarse, Length::Absolute(0.1)).unwrap();
    let draft = simplified(&space, &mut coarse, &given, Effort::default(), &mut Rng::seed(1));
    assert_eq!(draft.states, [a, c]);
    let low = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || q.y > 0.2;
    let mut fine = Discrete::new(&space, low, Length::Absolute(0.01)).unwrap();
    let (path, refused) = loosen(&space, &mut fine, &given, &draft, 0.05);
    assert_eq!((path.states, refused), (vec![a, c], vec![0]));
}

/// Beside the shortening that tests each shortcut as it comes, and must do so more finely as it follows obstacles more closely: few tests, and paths
/// as short.
#[test]
fn chosen_shortcuts_take_few_tests() {
    let space = Rn::<2>::new([0.0, 0.0], [4.0, 4.0]).unwrap();
    let free = |q: &Vector2<f64>| !((1.9..=2.1).contains(&q.x) && q.y <= 3.0);
    let given = [(1.0, 1.0), (0.5, 3.5), (1.5, 3.9), (3.0, 3.4), (3.0, 1.0)];
    let path = Path::straight(given.map(|(x, y)| Vector2::new(x, y)).to_vec());
    let effort = Effort::default();
    let (mut tests, mut lengths) = ([0_u32; 2], [0.0; 2]);
    for seed in 0..40 {
        let counted = |q: &Vector2<f64>| {
            tests[0] += 1;
            free(q)
        };
        let mut check = Discrete::new(&space, counted, Length::Fraction(0.0025)).unwrap();
        let draft = simplified(&space, &mut check, &path, effort, &mut Rng::seed(seed));
        lengths[0] += draft.path().length(&space);
        let short = |tests: &mut u32| {
            let counted = |q: &Vector2<f64>| {
                *tests += 1;
                free(q)
            };
            let mut check = CoarseToFine::new(&space, counted, Length::Fraction(0.0005), 4).unwrap();
            let effort = Effort { patience: 30, rounds: 1, ..effort };
            simplified_by_samples(&space, &mut check, &path, 0.05, effort, &mut Rng::seed(seed))
        };
        let draft = short(&mut tests[1]);
        assert_eq!((draft.states.len(), draft.states.len()), (draft.free.len() + 1, draft.origin.len()));
        assert_eq!((draft.states.first(), draft.states.last()), (path.states.first(), path.states.last()));
        assert!(draft.origin.is_sorted(), "seed {seed}");
        assert_eq!(draft.states, short(&mut 0).states, "seed {seed}");
        let short = draft.path();
        assert!(short.length(&space) < path.length(&space));
        // An edge is free, or a part of one that was, at states no farther apart than this.
        let mut check = Discrete::new(&space, free, Length::Fraction(0.008)).unwrap();
        let hit = |w: &[Vector2<f64>]| check.check_motion(&w[0], &w[1]).failed_at();
        assert!(short.states.windows(2).filter_map(hit).count() <= 2, "seed {seed}");
        lengths[1] += short.length(&space);
    }
    assert!(5 * tests[1] < tests[0], "{tests:?}");
    assert!(lengths[1] < 1.02 * lengths[0], "{lengths:?}");
}

/// The given path goes through a corner, as its planner has tested only its ends.
#[test]
fn what_given_paths_hit_is_led_round() {
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
    let [a, b, c] = [[0.1, 0.6], [0.45, 0.55], [0.55, 0.45]].map(Vector2::from);
    let given = Path::straight(vec![a, b, c, [0.9, 0.45].into()]);
    let free = |q: &Vector2<f64>| q.x <= 0.49 || q.y <= 0.49;
    let fine = &mut Discrete::new(&space, free, Length::Absolute(0.001)).unwrap();
    let (loose, refused) = loosen(&space, fine, &given, &Draft::of(&space, &given), 0.01);
    assert_eq!(refused, [1]);
    let mut draft = Draft { states: loose.states, ..Draft::of(&space, &given) };
    let far = bypass(&space, fine, &mut draft.clone(), &refused, 1e-3, &mut Rng::seed(1));
    assert!(!far, "it must go farther");
    assert!(bypass(&space, fine, &mut draft, &refused, 0.1, &mut Rng::seed(1)));
    assert_eq!((draft.states.len(), draft.free.len(), draft.origin.len()), (5, 4, 5));
    assert!((draft.states[2] - (b + c) / 2.0).norm() <= 0.1 && draft.origin.is_sorted());
    assert!(verify_path(&space, &draft.path(), fine).is_free());
}
