//! Paths that are merged from several.

use mp_plan::{Finish, PathRows, Request, Scene};

/// No longer than the shortest of the single paths but for the random numbers of shortening, shorter than the first; verified, and the
/// same each time.
#[test]
fn merged_paths_are_no_longer_than_single_ones() {
    for name in ["cubicles", "apartment", "arm", "rrs-high", "planar-bugtrap"] {
        let scene = Scene::find(name).unwrap();
        let request = Request::new("rrt-connect").seed(1);
        let single = |seed: u64| scene.plan(&request.clone().seed(seed)).unwrap();
        let singles: Vec<_> = (1..=4).map(single).collect();
        let least = singles.iter().filter_map(|run| run.path_length).fold(f64::INFINITY, f64::min);
        let merged = scene.plan(&request.clone().hybridize(4)).unwrap();
        let length = merged.path_length.unwrap();
        assert!(length <= least * (1.0 + 1e-6), "{name}: {length}, {least}");
        assert_eq!(merged.iterations, singles.iter().map(|run| run.iterations).sum::<u64>(), "{name}");
        let rows = merged.path.clone().unwrap();
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        assert!(scene.check(&path).unwrap().free, "{name}");
        assert_eq!(scene.plan(&request.hybridize(4)).unwrap().fingerprint, merged.fingerprint, "{name}");
    }
}

/// Where a path leads from nothing else than the inputs before it, the shortest is taken.
#[test]
fn paths_by_inputs_are_compared() {
    let scene = Scene::find("velocities").unwrap();
    let request = Request::new("rsrt").seed(1);
    let lengths = [1, 2, 3].map(|seed| scene.plan(&request.clone().seed(seed)).unwrap().path_length.unwrap());
    let merged = scene.plan(&request.hybridize(3)).unwrap();
    assert_eq!(merged.path_length.unwrap(), lengths.into_iter().fold(f64::INFINITY, f64::min));
}

#[test]
fn what_cannot_be_merged_is_refused() {
    for (request, word) in [
        (Request::default().hybridize(0), "1 to 100"),
        (Request::default().hybridize(101), "1 to 100"),
        (Request::default().hybridize(2).finish(Finish::AsFound), "shortened"),
    ] {
        let fault = format!("{:#}", request.check().unwrap_err());
        let help = format!("{:?}", request.check().unwrap_err());
        assert!(fault.contains(word) || help.contains(word), "{fault} {help}");
    }
}
