//! The setting `field` of planners whose edges snakes bend.

use mp_cspace::{Certified, Iterations, Length, Outcome, Planner, Rn, Rng, Validity};
use mp_geom::planar::PlanarWorld;
use mp_io::{PlanarFile, PlanarShape};
use mp_plan::{Control, Finish, Report, Request, Scene};
use mp_robot::{DiscRobot, DiscVerifier};
use mp_snake::plane::{occupancy, paper_energy, risk_energy};
use mp_snake::{Bending, Field, Params, Repulsion, SnakePlanner, With};
use mp_tree::{Problem, Rrs, Tuning};
use nalgebra::Vector2;
use std::sync::Arc;

type Point = Vector2<f64>;

const RANGE: f64 = 0.15;
const STEP: f64 = 0.9;

/// What a planner by name finds with these settings.
fn by_name(scene: &str, planner: &str, settings: &[(&str, &str)], seed: u64) -> Report {
    let request = Request::new(planner).seed(seed).iterations(5000);
    let request = settings.iter().fold(request, |request, (name, value)| request.set(*name, value));
    let request = Request { finish: Finish::AsFound, ..request };
    Scene::find(scene).unwrap().plan_with(&request, &mut Control::default()).unwrap()
}

/// The world `rrs-high`, by types.
struct World {
    bounds: [[f64; 2]; 2],
    robot: DiscRobot,
    ends: [Point; 2],
}

impl World {
    fn high() -> Self {
        let text = include_bytes!("../../../mp-scenes/assets/scenes/rrs-high.toml");
        let file = PlanarFile::parse("rrs-high.toml", text).unwrap();
        let polygons = file.obstacles.iter().map(|o| o.polygon.clone()).collect();
        let world = Arc::new(PlanarWorld::new(polygons, file.walls).unwrap());
        let PlanarShape::Disc(radius) = file.robot else { panic!("the robot is a disc") };
        let robot = DiscRobot::new(world, radius).unwrap();
        Self { bounds: file.walls.unwrap(), robot, ends: [Point::new(0.25, 0.25), Point::new(6.75, 3.75)] }
    }

    /// The nodes of the path that RRS finds in `field`, and its iterations.
    fn solved(&self, field: impl Field<Point>, seed: u64) -> (Vec<Vec<f64>>, u64) {
        let space = Rn::<2>::new(self.bounds[0], self.bounds[1]).unwrap();
        let check = Certified::new(&space, self.robot.clone(), self.robot.tolerance()).unwrap();
        let params = Params::for_edges(RANGE).unwrap();
        let local = SnakePlanner::with_bend(&space, check, field, params, Bending::Snake).unwrap();
        let [start, goal] = self.ends;
        let problem = Problem::new(&space, local, DiscVerifier::new(&self.robot), start, goal).unwrap();
        let tuning = Tuning { step: Length::Absolute(STEP), ..Tuning::default() };
        let mut planner = Rrs::new(problem, tuning).unwrap();
        let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(5000), &mut ());
        let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
        let rows = path.flattened().states.iter().map(|q| q.as_slice().to_vec()).collect();
        (rows, planner.progress().iterations)
    }
}

/// A field by name bends what the same field by type bends, to the bit.
#[test]
fn fields_by_name_are_those_by_type() {
    let world = World::high();
    let [low, high] = world.bounds;
    let mut checker = world.robot.clone();
    let touches = |p: Point| !checker.is_valid(&p);
    let occupied = occupancy([[low[0], high[0]], [low[1], high[1]]], RANGE, touches).unwrap();
    let repulsion = || Repulsion::new(world.robot.clone(), RANGE).unwrap();
    let mut all = Vec::new();
    for seed in 1..=3 {
        let risk =
            |factor| With::new(repulsion(), risk_energy(&occupied, RANGE, factor).unwrap(), 1.0).unwrap();
        let by_type = [
            ("clearance", world.solved(repulsion(), seed)),
            ("paper", world.solved(paper_energy(&occupied, RANGE).unwrap(), seed)),
            ("risk", world.solved(risk(1.0), seed)),
            ("risk:3", world.solved(risk(3.0), seed)),
        ];
        for (field, (rows, iterations)) in by_type {
            let settings = [("step", "0.9"), ("range", "0.15"), ("field", field)];
            let report = by_name("rrs-high", "rrs", &settings, seed);
            assert!(report.solved && report.verified);
            assert_eq!(
                (report.path.as_ref(), report.iterations),
                (Some(&rows), iterations),
                "{field}, {seed}"
            );
            all.push(rows);
        }
    }
    // No field does what another does.
    assert!((1..all.len()).all(|i| !all[..i].contains(&all[i])));
}

/// Polygons in the plane take fields too, both planners do, and dark pixels push.
#[test]
fn fields_push_polygons_and_both_planners() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("left.pgm");
    let row = [vec!["0"; 30], vec!["255"; 30]].concat().join(" ");
    std::fs::write(&file, format!("P2 60 40 255\n{}\n", vec![row; 40].join("\n"))).unwrap();
    let image = format!("image:{}", file.display());
    for planner in ["rrs", "rrs-connect", "or-rrs", "restart-rrs"] {
        let found = |field: &str| {
            let of_seed = |seed| by_name("docks", planner, &[("step", "30%"), ("field", field)], seed);
            let reports: Vec<Report> = (1..=8).map(of_seed).collect();
            assert!(reports.iter().all(|report| report.solved && report.verified), "{planner}, {field}");
            reports.into_iter().map(|report| report.path).collect::<Vec<_>>()
        };
        let plain = found("clearance");
        assert!(["paper", "risk", &image].into_iter().any(|field| found(field) != plain), "{planner}");
    }
}

#[test]
fn what_does_not_suit_is_refused() {
    let refused = |scene: &str, planner: &str, field: &str| {
        let request = Request::new(planner).set("field", field).iterations(1);
        let error = Scene::find(scene).unwrap().plan(&request).unwrap_err();
        error.to_string()
    };
    for (scene, field, words) in [
        ("cubicles", "paper", "for discs and polygons in worlds, not for SE3"),
        ("arm", "risk", "for discs and polygons in worlds"),
        ("wrench", "image:nowhere.png", "for discs and polygons in worlds"),
        ("rrs-low", "wind", "there is no field `wind`"),
        ("rrs-low", "risk:-1", "the factor of the noise"),
        ("rrs-low", "image:nowhere.png", "nowhere.png"),
    ] {
        let error = refused(scene, "rrs", field);
        assert!(error.contains(words), "{scene}, {field}: {error}");
    }
    // Planners without snakes have no such setting.
    assert!(refused("rrs-low", "rrt", "paper").contains("field"));
    assert!(Request::new("rrs").set("field", "wind").check().is_err());
}
