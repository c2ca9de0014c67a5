//! What the engine promises.

use crate::common::*;
use mp_cspace::erased::{AnyCheck, AnyIndex, AnySpace};
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_roadmap::*;
use nalgebra::Vector2;

type Point = Vector2<f64>;
type Local<'c> = Straight<'c, Rn<2>, Box<dyn MotionValidity<Point> + Send + 'c>>;

/// A point among boxes with an exact check of motions, or one that believes everything.
pub(crate) fn problem<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    ends: [[f64; 2]; 2],
    gullible: bool,
) -> Problem<'c, Rn<2>, Local<'c>> {
    let check: Box<dyn MotionValidity<Point> + Send> = match gullible {
        true => Box::new(FineDiscrete::new(space, |_: &Point| true, Length::Absolute(1.0)).unwrap()),
        false => Box::new(Exact(boxes.clone())),
    };
    let [start, goal] = ends.map(Point::from);
    Problem::new(space, Straight::new(space, check), Exact(boxes.clone()), start, goal).unwrap()
}

pub(crate) const ENDS: [[f64; 2]; 2] = [[0.1, 0.2], [0.9, 0.2]];

/// The square in rows: planners of these are compiled in the library already.
pub(crate) struct Rows {
    space: AsVectors<Rn<2>>,
    erased: AnySpace<'static, Configuration>,
}

impl Rows {
    pub(crate) fn new() -> Self {
        let space = AsVectors(square());
        Self { erased: AnySpace::new(&space), space }
    }

    /// A planner by its name, of a point among boxes with an exact check of motions.
    pub(crate) fn build<'c>(
        &'c self,
        name: &str,
        boxes: &Boxes<2>,
        start: [f64; 2],
        goals: impl Into<Goals<'c, Configuration>>,
        settings: &Settings,
    ) -> Result<AnyPlanner<'c, Configuration, ()>, BuildError> {
        let exact = || OnVectors::<_, Point>::new(Exact(boxes.clone()));
        let check: AnyCheck<'_, Configuration> = Box::new(exact());
        let local = Straight::new(&self.erased, check);
        let problem = Problem::new(&self.erased, local, exact(), start.into(), goals).unwrap();
        mp_roadmap::erased::build(name, problem.into(), AnyIndex::of(&self.space), settings)
    }
}

pub(crate) fn prm<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    gullible: bool,
) -> Prm<'c, Rn<2>, Local<'c>, KdTree<2>> {
    let reach = Reachable { neighbours: 8, radius: 0.4, cycles: false };
    let learning = Learning { learn: 60, ..Learning::default() };
    Prm::new(problem(space, boxes, ENDS, gullible), reach, learning).unwrap()
}

#[test]
fn what_the_verifier_refuses_is_blocked_and_never_returned() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let mut planner = prm(&space, &boxes, true);
    let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(20_000), &mut ());
    let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
    assert!(path.states.windows(2).all(|pair| !boxes.hit(&pair[0], &pair[1])));
    let blocked = planner.map().all_edges().filter(|(_, _, link)| link.state == LinkState::Blocked);
    assert_eq!(blocked.count() as u64, planner.progress().rejected);
    assert!(planner.progress().rejected > 0);
}

#[test]
fn without_cycles_the_roadmap_is_a_forest() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let mut builder = prm(&space, &boxes, false).into_builder();
    assert_eq!(builder.build(&mut Rng::seed(2), &mut Nodes(500), &mut ()), StopReason::Nodes);
    let map = builder.map_mut();
    assert_eq!(map.edges() + map.components(), map.len());
    let sizes = map.component_sizes();
    assert_eq!((sizes.len(), sizes.iter().sum::<usize>()), (map.components(), map.len()));
    let near = map.all_edges().all(|(_, [a, b], _)| {
        space.distance(map.state(a), map.state(b)) <= 0.4 && !boxes.hit(map.state(a), map.state(b))
    });
    assert!(near);
    let expanded = (0..500).filter(|&id| map.tag(id).kind == MilestoneKind::Expanded).count();
    assert!((100..250).contains(&expanded), "{expanded} of 500 by expansion");
}

/// Expansion goes where connecting fails: about the slit, and little elsewhere.
#[test]
fn expansion_is_where_it_is_difficult() {
    let (space, boxes) = (square(), slit(0.1, 0.5, 0.05));
    let mut builder = prm(&space, &boxes, false).into_builder();
    builder.build(&mut Rng::seed(3), &mut Nodes(3_000), &mut ());
    let map = builder.map();
    let near = |kind: MilestoneKind| {
        let of = (0..map.len() as NodeId).filter(|&id| map.tag(id).kind == kind);
        let (all, near) = of.fold((0, 0), |(all, near), id| {
            (all + 1, near + usize::from((map.state(id).x - 0.5).abs() < 0.15))
        });
        f64::from(near as u32) / f64::from(all)
    };
    assert!(
        near(MilestoneKind::Expanded) > 1.5 * near(MilestoneKind::Plain),
        "{} {}",
        near(MilestoneKind::Expanded),
        near(MilestoneKind::Plain)
    );
}

#[test]
fn the_same_seed_gives_the_same_and_stopping_changes_nothing() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.04));
    let run = |slices: &[u64]| {
        let mut planner = prm(&space, &boxes, false);
        let mut rng = Rng::seed(5);
        let mut path = None;
        for &slice in slices {
            let outcome = planner.solve(&mut rng, &mut Iterations(slice), &mut ());
            if let Outcome::Solved(found) = outcome {
                path = Some(found);
                break;
            }
        }
        (path, planner.map().states().to_vec())
    };
    let whole = run(&[20_000]);
    assert!(whole.0.is_some());
    assert_eq!(whole, run(&[1, 7, 50, 20_000]));
}

#[test]
fn goals_may_be_regions_or_sampled() {
    let (rows, boxes) = (Rows::new(), slit(0.2, 0.8, 0.1));
    let beyond = |q: &Configuration| q[0] > 0.8;
    for sampled in [false, true] {
        let corner = Ball::new(&rows.space, [0.9, 0.2].into(), 0.05).unwrap();
        let goals = match sampled {
            true => Goals::sampled(corner),
            false => Goals::region(beyond),
        };
        let mut planner = rows.build("prm", &boxes, ENDS[0], goals, &Settings::default()).unwrap();
        let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(5_000), &mut ());
        let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
        assert_eq!(path.states[0], ENDS[0].into());
        assert!(beyond(path.states.last().unwrap()));
    }
}

#[test]
fn a_start_in_the_goal_is_a_path() {
    let (rows, here) = (Rows::new(), Configuration::from([0.3; 2]));
    let mut planner =
        rows.build("prm", &Boxes::default(), [0.3; 2], here.clone(), &Settings::default()).unwrap();
    let path = planner.step(&mut Rng::seed(1), &mut ()).unwrap();
    assert_eq!(path.states, [here]);
}

#[test]
fn bad_settings_are_refused() {
    let rows = Rows::new();
    let build = |name: &str, settings: &Settings| {
        rows.build(name, &Boxes::default(), ENDS[0], Configuration::from(ENDS[1]), settings)
    };
    for (text, part) in [
        ("neighbours=0", "neighbours is 0"),
        ("radius=-1", "above zero"),
        ("radius=3", "extent"),
        ("cycles=maybe", "yes or no"),
        ("learn=0", "learn is 0"),
        ("expand=11", "expand is 11"),
        ("bounces=0", "bounces is 0"),
        ("walk=0", "above zero"),
        ("neighbors=3", "did you mean `neighbours`"),
    ] {
        let settings = Settings::parse([text]).unwrap();
        let error = build("prm", &settings).err().unwrap().to_string();
        assert!(error.contains(part), "{text}: {error}");
    }
    let error = planner("prn").err().unwrap().to_string();
    assert!(error.contains("did you mean `prm`"), "{error}");
    for info in crate::blind() {
        let defaults = info.parameters.iter().map(|p| format!("{}={}", p.name, p.default));
        let settings = Settings::parse(defaults).unwrap();
        assert!(build(info.name, &settings).is_ok(), "{}", info.name);
    }
}

#[test]
fn guards_do_not_see_each_other_and_connections_join_components() {
    let (space, boxes) = (square(), slit(0.1, 0.5, 0.1));
    for seed in 0..5 {
        let mut builder =
            VisibilityPrm::new(problem(&space, &boxes, ENDS, false), 500).unwrap().into_builder();
        let reason = builder.build(&mut Rng::seed(seed), &mut Iterations(100_000), &mut ());
        assert_eq!((reason, builder.connector().failures()), (StopReason::Exhausted, 500));
        let map = builder.map_mut();
        let (guards, others): (Vec<NodeId>, Vec<NodeId>) =
            (0..map.len() as NodeId).partition(|&id| map.tag(id).kind == MilestoneKind::Guard);
        assert!(guards.len() >= 2, "both sides of the wall have one");
        for (i, &a) in guards.iter().enumerate() {
            assert!(guards[..i].iter().all(|&b| boxes.hit(map.state(a), map.state(b))));
        }
        for &id in &others {
            assert_eq!(map.tag(id).kind, MilestoneKind::Connection);
            let ends: Vec<NodeId> = map.links(id).map(|(_, end, _)| end).collect();
            assert!(ends.len() >= 2 && ends.iter().all(|end| guards.contains(end)));
        }
        // Each connection joined what was apart, so there is no cycle.
        assert_eq!(map.edges() + map.components(), map.len());
    }
}

#[test]
fn trees_grow_from_the_ends() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.0));
    let growth = EndGrowth::new(&space, 0.25, Length::Fraction(0.03)).unwrap();
    let learning = Learning { expand: 0.0, ..Learning::default() };
    let reach = Reachable { neighbours: 8, radius: 0.4, cycles: false };
    let mut planner =
        Prm::new(problem(&space, &boxes, ENDS, false), reach, learning).unwrap().growing_ends(growth);
    let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(1_000), &mut ());
    assert!(matches!(outcome, Outcome::Stopped(StopReason::Iterations)), "{outcome:?}");
    let map = planner.map_mut();
    let grown: Vec<NodeId> =
        (0..map.len() as NodeId).filter(|&id| map.tag(id).kind == MilestoneKind::Expanded).collect();
    // A quarter of the attempts; a step may be blocked.
    assert!((100..=250).contains(&grown.len()), "{}", grown.len());
    let [start, goal] = [0, 1];
    assert!(!map.connected(start, goal));
    for end in [start, goal] {
        assert!(grown.iter().filter(|&&id| map.connected(end, id)).count() > 50);
    }
    assert!(grown.iter().all(|&id| map.connected(start, id) || map.connected(goal, id)));
    let step = 0.03 * space.extent() * (1.0 + 1e-9);
    let near = |id: NodeId| map.links(id).any(|(_, _, link)| link.length <= step);
    assert!(grown.iter().all(|&id| near(id)));
    for wrong in [1.0, -0.1, f64::NAN] {
        assert!(EndGrowth::new(&space, wrong, Length::Fraction(0.03)).is_err());
    }
}

#[test]
fn lazily_few_motions_are_checked_and_none_of_the_path_is_unchecked() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let reach = Reachable { neighbours: 10, radius: 0.3, cycles: true };
    let pace = Pace { first: 200, more: 50 };
    let mut planner = LazyPrm::new(problem(&space, &boxes, ENDS, false), reach, pace).unwrap();
    let outcome = planner.solve(&mut Rng::seed(4), &mut Iterations(20_000), &mut ());
    let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
    assert!(path.states.windows(2).all(|pair| !boxes.hit(&pair[0], &pair[1])));
    let states = planner.map().all_edges().map(|(_, _, link)| link.state);
    let unchecked = states.filter(|state| *state == LinkState::Unchecked).count();
    assert!(planner.progress().motions < unchecked as u64 / 2, "{:?}", planner.progress());
    assert_eq!(planner.progress().rejected, 0);
}

#[test]
fn more_nodes_make_shorter_paths() {
    let (space, boxes) = (square(), Boxes(vec![([0.4, -1.0], [0.6, 0.7])]));
    let mut planner = PrmStar::new(problem(&space, &boxes, ENDS, false), 1.1).unwrap();
    let mut rng = Rng::seed(1);
    let mut lengths = Vec::new();
    while planner.progress().nodes < 3_000 {
        lengths.extend(planner.step(&mut rng, &mut ()).map(|path| path.length(&space)));
    }
    // Over both corners of the block.
    let least = 2.0 * (mp_math::powi(0.3, 2) + mp_math::powi(0.5, 2)).sqrt() + 0.2;
    assert!(lengths.is_sorted_by(|a, b| a > b) && lengths.len() > 3, "{lengths:?}");
    assert!((least..1.02 * least).contains(lengths.last().unwrap()), "{lengths:?}");
}
