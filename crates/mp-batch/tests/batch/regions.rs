//! Roadmaps by regions: the same bytes on any number of ranks and threads, and after any end.

use mp_batch::build_regions;
use mp_plan::{Cancel, Interrupt, Request, Scene, SceneRoadmap};
use mp_ranks::{Checkpoint, Options, threads};

/// A roadmap by regions, on so many ranks, which here are threads; the ranks' own answers are `None`.
fn on_ranks(
    scene: &Scene,
    request: &Request,
    ranks: usize,
    checkpoint: Option<&Checkpoint>,
) -> Option<SceneRoadmap> {
    std::thread::scope(|scope| {
        let mut links = threads(ranks).into_iter();
        let master = links.next().unwrap();
        let others: Vec<_> = links
            .map(|link| {
                scope.spawn(move || {
                    build_regions(&scene.regions(request).unwrap(), &link, &Options::default(), None)
                })
            })
            .collect();
        let options = Options { threads: 1 + ranks % 2, ..Options::default() };
        let made = build_regions(&scene.regions(request).unwrap(), &master, &options, checkpoint).unwrap();
        others.into_iter().for_each(|other| assert!(other.join().unwrap().unwrap().is_none()));
        made
    })
}

#[test]
fn a_roadmap_by_regions_is_the_same_on_any_number_of_ranks_and_threads() {
    let folder = tempfile::tempdir().unwrap();
    for (name, regions, samples) in [("easy", 8, 60), ("planar-bugtrap", 9, 80)] {
        let scene = Scene::find(name).unwrap();
        let request = Request::new("regional-prm")
            .seed(4)
            .set("regions", regions)
            .set("samples", samples)
            .set("cycles", "yes");
        let file = folder.path().join(name);
        let bytes = |roadmap: &SceneRoadmap| {
            roadmap.save(&file).unwrap();
            std::fs::read(&file).unwrap()
        };
        let mut alone = on_ranks(&scene, &request, 1, None).unwrap();
        let whole = bytes(&alone);
        assert!(alone.nodes() > regions * 10 && alone.edges() > alone.nodes(), "{alone:?}");
        for ranks in [2, 3, 4, 7] {
            assert!(
                bytes(&on_ranks(&scene, &request, ranks, None).unwrap()) == whole,
                "{name}, {ranks} ranks"
            );
        }
        // The same as in one process, on any number of threads.
        let items = scene.regions(&request).unwrap().items();
        for threads in 1..=3 {
            let built = scene.roadmap(&request.clone().iterations(items).threads(threads)).unwrap();
            assert!(bytes(&built) == whole, "{name}, {threads} threads");
        }
        // All edges are free, as code says that found none of them.
        assert_eq!(alone.verify().unwrap(), 0, "{name}");
        // The file is one that a planner goes on with: start and goal, and no more nodes than it must.
        let kept = Request { roadmap: Some(file.clone()), ..request.clone() };
        let report = scene.plan(&kept).unwrap();
        assert!(report.solved && report.nodes >= alone.nodes() + 2, "{name}: {}", report.nodes);
    }
}

#[test]
fn a_roadmap_by_regions_goes_on_from_its_checkpoint() {
    let scene = Scene::find("easy").unwrap();
    let request = Request::new("regional-prm").seed(4).set("regions", 6).set("samples", 40);
    let folder = tempfile::tempdir().unwrap();
    let (file, map) = (folder.path().join("checkpoint"), folder.path().join("map"));
    let bytes = |roadmap: SceneRoadmap| {
        roadmap.save(&map).unwrap();
        std::fs::read(&map).unwrap()
    };
    let whole = bytes(on_ranks(&scene, &request, 1, None).unwrap());
    let work = scene.regions(&request).unwrap();
    let never = Interrupt::never();
    // Ended in the first phase, then in the second.
    let mut left = work.items();
    for known in [2, work.regions() + 2] {
        let checkpoint = Checkpoint::open(&file, "a roadmap").unwrap();
        for item in 0..known {
            let built = |region: u64| work.build(region, &never).unwrap();
            let result = match work.pair(item) {
                None => built(item),
                Some(pair) => {
                    let [one, other] = pair.map(built);
                    work.connect(item, [&one, &other], &never).unwrap()
                }
            };
            checkpoint.keep(item, &result).unwrap();
        }
        drop(checkpoint);
        let checkpoint = Checkpoint::open(&file, "a roadmap").unwrap();
        assert!(bytes(on_ranks(&scene, &request, 3, Some(&checkpoint)).unwrap()) == whole);
        left = left.min(work.items() - known);
        // All that was made is in it now: nothing is done again.
        drop(checkpoint);
        let all = Checkpoint::open(&file, "a roadmap").unwrap();
        assert_eq!(all.known().len() as u64, work.items());
        std::fs::remove_file(&file).unwrap();
    }
    assert!(left > 0);
    // Cancelled before it begins: no roadmap, and nobody waits for ever.
    let cancel = Cancel::new();
    cancel.cancel();
    let mut links = threads(2);
    let (other, scene, request) = (links.remove(1), &scene, &request);
    std::thread::scope(|scope| {
        let waiting = scope.spawn(move || {
            build_regions(&scene.regions(request).unwrap(), &other, &Options::default(), None).unwrap()
        });
        let options = Options { cancel, ..Options::default() };
        assert!(build_regions(&work, &links[0], &options, None).unwrap().is_none());
        assert!(waiting.join().unwrap().is_none());
    });
}
