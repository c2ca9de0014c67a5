//! Roadmaps that are built once: queries, files, merging.

use crate::common::*;
use crate::engine::{ENDS, Rows, prm};
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_roadmap::*;
use nalgebra::Vector2;

type Point = Vector2<f64>;
type Map = Roadmap<Point>;
type Local<'c> = Straight<'c, Rn<2>, mp_cspace::erased::AnyCheck<'c, Point>>;

const PRINT: u64 = 0x1234;

fn checker<'c>(space: &'c Rn<2>, boxes: &Boxes<2>) -> EdgeChecker<'c, Rn<2>, Local<'c>> {
    EdgeChecker::new(
        space,
        Straight::new(space, Box::new(Exact(boxes.clone()))),
        Exact(boxes.clone()),
        PATIENCE,
    )
}

fn answers<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    map: Map,
) -> RoadmapQueries<'c, Rn<2>, Local<'c>, KdTree<2>> {
    RoadmapQueries::new(checker(space, boxes), map, KdTree::new(), 10).unwrap()
}

/// A roadmap with cycles, of `nodes` nodes.
fn map(space: &Rn<2>, boxes: &Boxes<2>, nodes: usize, seed: u64) -> Map {
    let connector = Star::new(2, 1.1).unwrap();
    let mut builder =
        Builder::new(checker(space, boxes), Free::uniform(space), connector, KdTree::<2>::new());
    builder.build(&mut Rng::seed(seed), &mut Nodes(nodes), &mut ());
    builder.into_map()
}

/// Pairs of free points.
fn queries(space: &Rn<2>, boxes: &Boxes<2>, count: usize) -> Vec<[Point; 2]> {
    let mut rng = Rng::seed(77);
    let mut boxes = boxes.clone();
    let mut free = || loop {
        let q = space.sample_uniform(&mut rng);
        if boxes.is_valid(&q) {
            return q;
        }
    };
    (0..count).map(|_| [free(), free()]).collect()
}

#[test]
fn a_roadmap_answers_many_queries() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let mut answers = answers(&space, &boxes, map(&space, &boxes, 500, 1));
    let mut seen = 0;
    for [start, goal] in queries(&space, &boxes, 200) {
        let Ok(path) = answers.answer(&start, &goal) else { continue };
        assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
        assert_eq!(path.states.len(), path.edges.len() + 1);
        assert!(path.states.windows(2).all(|pair| !boxes.hit(&pair[0], &pair[1])));
        // As short as another search says.
        let lengths = answers.alternatives(&start, &goal, 1).map(|paths| paths[0].1);
        let length = path.length(&space);
        assert!(lengths.is_ok_and(|least| path.states.len() == 2 || (least - length).abs() < 1e-9));
        seen += 1;
    }
    assert!(seen > 195, "{seen} of 200");
    assert_eq!(answers.map().len(), 500, "it does not grow");
    let here = Point::new(0.1, 0.1);
    assert_eq!(
        answers.answer(&here, &here),
        Ok(Path { states: vec![here], edges: vec![] }),
        "as planners do"
    );
}

#[test]
fn unanswered_queries_say_why() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.0));
    let mut answers = answers(&space, &boxes, map(&space, &boxes, 300, 1));
    let ask = |answers: &mut RoadmapQueries<'_, _, _, _>, a: [f64; 2], b: [f64; 2]| {
        answers.answer(&Point::from(a), &Point::from(b)).unwrap_err()
    };
    assert_eq!(ask(&mut answers, [0.1, 0.1], [0.9, 0.1]), Unanswered::Apart);
    assert_eq!(ask(&mut answers, [0.1, 1.1], [0.9, 0.1]), Unanswered::Outside(Endpoint::Start));
    assert_eq!(ask(&mut answers, [0.1, 0.1], [0.5, 0.1]), Unanswered::NotFree(Endpoint::Goal(0)));
    let mut none = self::answers(&space, &boxes, Map::new());
    assert_eq!(ask(&mut none, [0.1, 0.1], [0.9, 0.1]), Unanswered::Unreached(Endpoint::Start));
    let small = Rn::<2>::new([0.0; 2], [0.5; 2]).unwrap();
    let foreign = map(&space, &boxes, 50, 1);
    assert!(RoadmapQueries::new(checker(&small, &boxes), foreign, KdTree::<2>::new(), 10).is_err());
}

#[test]
fn several_paths_go_both_ways_round() {
    let (space, boxes) = (square(), Boxes(vec![([0.3, 0.3], [0.7, 0.7])]));
    let mut answers = answers(&space, &boxes, map(&space, &boxes, 60, 3));
    let paths = answers.alternatives(&Point::new(0.1, 0.5), &Point::new(0.9, 0.5), 40).unwrap();
    assert_eq!(paths.len(), 40);
    assert!(paths.is_sorted_by(|a, b| a.1 <= b.1));
    for (i, (path, length)) in paths.iter().enumerate() {
        assert!((path.length(&space) - length).abs() < 1e-9);
        assert!(path.states.windows(2).all(|pair| !boxes.hit(&pair[0], &pair[1])));
        assert!(paths[..i].iter().all(|(other, _)| other != path));
    }
}

/// Edges that only the local planner believes in are never part of an answer.
#[test]
fn what_the_verifier_refuses_is_no_answer() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let believed = map(&space, &Boxes::default(), 400, 2);
    let mut answers = answers(&space, &boxes, believed);
    let mut seen = 0;
    for [start, goal] in queries(&space, &boxes, 50) {
        if let Ok(path) = answers.answer(&start, &goal) {
            assert!(path.states.windows(2).all(|pair| !boxes.hit(&pair[0], &pair[1])));
            seen += 1;
        }
    }
    assert!(seen > 40 && answers.map().blocked() > 0);
}

/// All edges at once: those that are refused are blocked, and queries have nothing left to block.
#[test]
fn edges_can_be_verified_beforehand() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let mut answers = answers(&space, &boxes, map(&space, &Boxes::default(), 400, 2));
    let refused = {
        let map = answers.map();
        let hit = |[a, b]: [NodeId; 2]| boxes.hit(map.state(a), map.state(b));
        map.all_edges().filter(|(_, ends, _)| hit(*ends)).count()
    };
    assert!(refused > 0);
    assert_eq!((answers.verify(), answers.map().blocked()), (refused, refused));
    assert_eq!(answers.verify(), 0);
    let solved = queries(&space, &boxes, 50).iter().filter(|[a, b]| answers.answer(a, b).is_ok()).count();
    assert!(solved > 40);
    assert_eq!(answers.map().blocked(), refused);
}

#[test]
fn saved_and_loaded_it_gives_identical_paths() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let mut builder = prm(&space, &boxes, false).into_builder();
    builder.build(&mut Rng::seed(2), &mut Nodes(300), &mut ());
    let built = builder.into_map();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("slit.roadmap");
    built.save(&file, PRINT).unwrap();
    let loaded = Map::load(&file, PRINT).unwrap();
    assert_eq!(loaded.to_bytes(PRINT), built.to_bytes(PRINT));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");
    let (mut before, mut after) = (answers(&space, &boxes, built), answers(&space, &boxes, loaded));
    for [start, goal] in queries(&space, &boxes, 100) {
        assert_eq!(before.answer(&start, &goal), after.answer(&start, &goal));
    }
}

#[test]
fn files_of_other_scenes_or_damaged_are_refused() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let bytes = map(&space, &boxes, 30, 1).to_bytes(PRINT);
    let read = |bytes: &[u8], print| Map::from_bytes(bytes, print).map(|map| map.len());
    assert_eq!(read(&bytes, PRINT).unwrap(), 30);
    let error = read(&bytes, PRINT + 1).unwrap_err();
    assert!(matches!(error, RoadmapError::OtherScene { expected, found: PRINT } if expected == PRINT + 1));
    assert!(error.to_string().contains("another scene or robot"), "{error}");
    for end in 0..bytes.len() {
        assert!(read(&bytes[..end], PRINT).is_err(), "cut off at {end}");
    }
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        assert!(read(&damaged, PRINT).is_err(), "changed at {at}");
    }
    // A file of states of another kind, well-formed in itself.
    let other = Roadmap::<f64>::from_bytes(&bytes, PRINT).map(|map| map.len()).unwrap_err();
    assert!(matches!(other, RoadmapError::Invalid { .. }), "{other}");
    let missing = Map::load("no/such/file", PRINT).unwrap_err().to_string();
    assert!(missing.starts_with("no/such/file: "), "{missing}");
}

/// A file is refused by its beginning and its checksum before memory is taken for it, however large it is.
#[test]
fn loading_takes_no_memory_for_what_is_no_roadmap() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.roadmap");
    let load = || Map::load(&path, PRINT).map(|map| map.len()).map_err(|e| e.error);
    let file = std::fs::File::create(&path).unwrap();
    assert!(matches!(load(), Err(RoadmapError::NotARoadmap)), "an empty file");
    // Sparse: it takes no room on the disk.
    file.set_len(6 << 30).unwrap();
    assert!(matches!(load(), Err(RoadmapError::NotARoadmap)));
    file.set_len(mp_roadmap::MAX_ROADMAP_BYTES + 1).unwrap();
    assert!(matches!(load(), Err(RoadmapError::File(_))));
    // Sizes around the pieces in which the checksum is computed.
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let bytes = map(&space, &boxes, 30, 1).to_bytes(PRINT);
    std::fs::write(&path, &bytes).unwrap();
    assert_eq!(load().unwrap(), 30);
    for extra in [1, 7, 8, 9, (1 << 20) - bytes.len(), (1 << 20) + 3 - bytes.len(), 1 << 20, (2 << 20) + 5] {
        std::fs::write(&path, [bytes.as_slice(), &vec![0; extra]].concat()).unwrap();
        assert!(matches!(load(), Err(RoadmapError::Damaged { .. })), "{extra}");
    }
    #[cfg(unix)]
    if std::process::Command::new("mkfifo")
        .arg(folder.path().join("pipe"))
        .status()
        .is_ok_and(|s| s.success())
    {
        let e = Map::load(folder.path().join("pipe"), PRINT).unwrap_err().to_string();
        assert!(e.contains("not a regular file"), "{e}");
    }
}

#[test]
fn roadmaps_of_several_megabytes_are_read_back() {
    let mut large = Map::new();
    for i in 0..60_000 {
        large.add([0.1, f64::from(i)].into(), Default::default());
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.roadmap");
    large.save(&path, PRINT).unwrap();
    assert_eq!(Map::load(&path, PRINT).unwrap().to_bytes(PRINT), large.to_bytes(PRINT));
}

#[test]
fn states_that_no_planner_makes_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, -1.1e75] {
        let mut map = Map::new();
        map.add([0.5, bad].into(), Default::default());
        let e = Map::from_bytes(&map.to_bytes(PRINT), PRINT).unwrap_err();
        assert!(matches!(e, RoadmapError::Invalid { .. }), "{bad}: {e}");
    }
}

#[test]
fn two_roadmaps_become_one() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let half = |left: bool, seed| {
        let bounds = if left { ([0.0; 2], [0.5, 1.0]) } else { ([0.5, 0.0], [1.0; 2]) };
        map(&Rn::new(bounds.0, bounds.1).unwrap(), &boxes, 150, seed)
    };
    let (left, right) = (half(true, 1), half(false, 2));
    let connector = Star::new(2, 1.1).unwrap();
    let mut builder =
        Builder::new(checker(&space, &boxes), Free::uniform(&space), connector, KdTree::<2>::new())
            .resume(left.clone())
            .unwrap();
    builder.merge(&right, 10, &mut ()).unwrap();
    let edges = left.edges() + right.edges();
    let mut apart = [left, right].map(|mut map| map.components());
    apart.sort_unstable();
    let map = builder.map_mut();
    assert_eq!(map.len(), 300);
    assert!(map.edges() > edges, "they are joined");
    let mut answers = builder.into_answers(10);
    let [start, goal] = ENDS.map(Point::from);
    assert!(answers.answer(&start, &goal).is_ok());
}

#[test]
fn exported_for_other_programs() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let map = map(&space, &boxes, 20, 1);
    let text = map.to_graphml();
    assert_eq!(text.matches("<node ").count(), 20);
    assert_eq!(text.matches("<edge ").count(), map.edges());
    let [q, ends] = [map.state(3), &map.ends(EdgeId(0)).map(f64::from).into()];
    assert!(text.contains(&format!("<node id=\"n3\"><data key=\"state\">{} {}</data>", q.x, q.y)));
    assert!(text.contains(&format!("<edge source=\"n{}\" target=\"n{}\">", ends.x, ends.y)));
    let dot = map.to_dot();
    assert!(dot.starts_with("graph {") && dot.trim_end().ends_with('}'));
    assert_eq!(dot.matches(" -- ").count(), map.edges());
    assert!(dot.contains(&format!("state=\"{} {}\"", q.x, q.y)), "{dot}");
}

/// The same bytes on any number of threads, with any number of hands, and as without.
#[test]
fn threads_change_nothing() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    fn built<'c, K>(
        space: &'c Rn<2>,
        boxes: &Boxes<2>,
        connector: K,
        checkers: usize,
        threads: usize,
    ) -> (Vec<u8>, Progress)
    where
        K: Connector<Rn<2>, Local<'c>> + Sync,
    {
        let learning = Learning { learn: 150, ..Learning::default() };
        let generator = Learn::new(space, learning).unwrap();
        let mut builder = Builder::new(checker(space, boxes), generator, connector, KdTree::<2>::new());
        if checkers > 0 {
            let checkers = (0..checkers).map(|_| checker(space, boxes));
            builder = builder.on(Workers::new(threads).unwrap(), checkers);
        }
        let mut rng = Rng::seed(4);
        for nodes in [37, 600] {
            builder.build(&mut rng, &mut Nodes(nodes), &mut ());
        }
        (builder.map().to_bytes(PRINT), builder.progress())
    }
    let reach = Reachable { neighbours: 8, radius: 0.3, cycles: false };
    let nearest = || NearestConnector::new(reach).unwrap();
    let star = || Star::new(2, 1.1).unwrap();
    let alone = (built(&space, &boxes, nearest(), 0, 1), built(&space, &boxes, star(), 0, 1));
    for (checkers, threads) in [(1, 1), (2, 2), (5, 3)] {
        assert!(built(&space, &boxes, nearest(), checkers, threads) == alone.0, "{checkers} {threads}");
        assert!(built(&space, &boxes, star(), checkers, threads) == alone.1, "{checkers} {threads}");
    }
}

/// A planner goes on with what another has built: the second query finds its way at once.
#[test]
fn planners_go_on_with_a_roadmap() {
    let (rows, boxes) = (Rows::new(), slit(0.2, 0.8, 0.1));
    for info in crate::blind() {
        let planner = || {
            let goal = Configuration::from(ENDS[1]);
            rows.build(info.name, &boxes, ENDS[0], goal, &Settings::default()).unwrap()
        };
        let mut first = planner();
        let outcome = first.solve(&mut Rng::seed(1), &mut Iterations(5_000), &mut ());
        assert!(matches!(outcome, Outcome::Solved(_)), "{}", info.name);
        let mut second = planner();
        second.resume(first.map().clone()).unwrap();
        let outcome = second.solve(&mut Rng::seed(2), &mut Iterations(1), &mut ());
        assert!(matches!(outcome, Outcome::Solved(_)), "{}", info.name);
        assert!(second.map_mut().components() <= first.map_mut().components() + 2);
    }
}
