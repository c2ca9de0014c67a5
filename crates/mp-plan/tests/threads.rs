//! The same seed gives the same bytes on any number of threads: every planner by name, with every setting.

use mp_plan::{Budget, Cancel, Control, GrownRoadmap, PlannerInfo, Report, Request, Scene, Watch};
use std::collections::BTreeSet;

/// A world in the plane, whose goal is in a closed room, so that planners go on to the end of their budget.
fn room(robot: &str, motion: &str) -> Scene {
    let task = format!(
        "[world]\nwalls = [[0, 0], [4, 3]]\n[robot]\n{robot}\n[motion]\nstart = [0.5, 0.5, 0]\n{motion}\n
        [[obstacle]]\npolygon = [[2.4, 1.4], [3.8, 1.4], [3.8, 2.8], [2.4, 2.8]]
        holes = [[[2.6, 1.6], [3.6, 1.6], [3.6, 2.6], [2.6, 2.6]]]
        [[obstacle]]\nrectangle = [[1, 1], [1.6, 2.6]]\n"
    );
    Scene::parse("room", &task, "".as_ref()).unwrap()
}

/// Without straight motions there must be others.
fn with_needed(request: Request) -> Request {
    let bent = request.settings.get("straight").is_some_and(|value| value == "no");
    if bent && !request.settings.contains_key("turns") { request.set("turns", 1) } else { request }
}

/// Values that a parameter may have: none is its default.
fn values(scene: &Scene, planner: &str, range: &str, name: &str, default: &str) -> Vec<String> {
    let words = range.split(", ").flat_map(|part| part.split(" or ")).map(str::to_owned);
    let numbers = ["0.5", "2", "3", "40", "5%", "0.05"].map(str::to_owned);
    let allowed = |value: &String| {
        let request = with_needed(Request::new(planner).set(name, value).iterations(1));
        value != default && scene.plan(&request).is_ok()
    };
    words.chain(numbers).filter(allowed).take(2).collect()
}

/// The settings to try: each parameter alone, and with trees from the ends where the planner has them. Steps of planners are short, so
/// that a few attempts go through several.
fn settings(scene: &Scene, planner: &PlannerInfo) -> BTreeSet<Vec<(String, String)>> {
    let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    let is_long = |default: &str| default.parse().is_ok_and(|count: u64| (100..=10_000).contains(&count));
    let short: Vec<_> =
        planner.parameters.iter().filter(|p| is_long(p.default)).map(|p| pair(p.name, "40")).collect();
    let ends = planner.parameters.iter().any(|p| p.name == "ends");
    let mut all = BTreeSet::from([short.clone()]);
    for parameter in planner.parameters {
        let found = values(scene, planner.name, parameter.range, parameter.name, parameter.default);
        assert!(!found.is_empty(), "{}: no value of {} is tried", planner.name, parameter.name);
        for value in found {
            let mut one: Vec<_> = short.iter().filter(|(name, _)| name != parameter.name).cloned().collect();
            one.push(pair(parameter.name, &value));
            if ends && parameter.name != "ends" {
                all.insert([one.clone(), vec![pair("ends", "0.5")]].concat());
            }
            all.insert(one);
        }
    }
    all
}

/// Keeps the roadmap.
#[derive(Default)]
struct Kept(Option<GrownRoadmap>);

impl Watch for Kept {
    fn wants_roadmap(&self) -> bool {
        true
    }
    fn roadmap(&mut self, roadmap: GrownRoadmap) {
        self.0 = Some(roadmap);
    }
}

/// All that a run comes to but for its times, and its roadmap, with all digits.
fn bytes(scene: &Scene, request: &Request) -> [String; 2] {
    let mut kept = Kept::default();
    let report = scene.plan_with(request, &mut Control::new(Cancel::new(), &mut kept)).unwrap();
    let timeless = Report { time_s: 0.0, finish_s: 0.0, first_s: None, stages: Vec::new(), ..report };
    [timeless.to_json().unwrap(), format!("{:?}", kept.0)]
}

#[test]
fn every_planner_with_every_setting_gives_the_same_bytes_on_any_number_of_threads() {
    let turning = "polygon = [[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]";
    let driven = format!("{turning}\nkind = \"velocities\"\nspeeds = [1, 1, 1]\nduration = 0.3");
    let scenes = [
        room(turning, "goal = [3.1, 2.1, 0]"),
        room(&driven, "goal = [3.1, 2.1, 0]\ntolerance = 0.1"),
        Scene::find("easy").unwrap(),
    ];
    let mut runs = 0;
    for planner in mp_plan::planners() {
        let can = |scene: &&Scene| scene.plan(&Request::new(planner.name).iterations(1)).is_ok();
        let scene = scenes.iter().find(can).unwrap_or_else(|| panic!("{} cannot plan", planner.name));
        for settings in settings(scene, planner) {
            let budget = Budget { iterations: Some(150), queries: Some(6_000), ..Budget::default() };
            let request =
                Request { budget, settings: settings.into_iter().collect(), ..Request::new(planner.name) };
            let request = with_needed(request);
            let [one, two, three] = [1, 2, 3].map(|threads| bytes(scene, &request.clone().threads(threads)));
            assert!(two == one, "{request:?} on 2 threads:\n{}\n{}", two[0], one[0]);
            assert!(three == one, "{request:?} on 3 threads:\n{}\n{}", three[0], one[0]);
            runs += 1;
        }
    }
    assert!(runs > 200, "{runs}");
}
