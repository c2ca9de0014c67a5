//! Pictures of roadmaps, as SVG: the coverage of whole scenes; the roadmap with which each algorithm solved a
//! corridor; and the configurations around an obstacle that obstacle-geometry PRM and OBPRM propose.

use super::queries::{Local, SpaceOf, checker, prm_builder};
use super::scenes::CORRIDORS;
use super::svg_drawing::{Projection, SvgDrawing};
use crate::error::{IntoError, Result};
use crate::experiment::Lab;
use crate::output::note;
use crate::scenes::{Rigid, bare, either};
use mp_cspace::{Configuration, Iterations, KdTree, Nodes, Outcome, Rng, obstacles::ObstacleGeometry};
use mp_geom::Aabb;
use mp_geom::primitives::cuboid;
use mp_io::{Body, PlacedBody, RigidProblem, SpaceKind};
use mp_plan::{Control, Error, RigidScene, RigidSpace, TypedMotion, search};
use mp_roadmap::algo::visibility_prm;
use mp_roadmap::{
    AroundObstacles, Builder, ByGeometry, Candidate, Learning, LinkState, MilestoneKind, NodeGenerator,
    OnObstacles, OnSurfaces, Roadmap, Strategy,
};
use mp_robot::Spatial;
use nalgebra::{Isometry3, Point3, Vector3};
use std::path::PathBuf;

const SCENES: [&str; 3] = ["maze", "planar-bugtrap", "gempa-3"];
/// The nodes of PRM's roadmap.
const NODES: usize = 400;
/// The index of the planar corridor in the small pictures.
const CORRIDOR: usize = 0;

const OBSTACLE: &str = "#b4bdc9";
const GREEN: &str = "#2f9e6e";
const BLUE: &str = "#2c6fb0";
const RED: &str = "#d1495b";
const PURPLE: &str = "#8f5bb8";
const ORANGE: &str = "#e6892d";

/// The colour of nodes of a kind; guards are black and connections white.
fn colour(kind: MilestoneKind) -> &'static str {
    match kind {
        MilestoneKind::Guard | MilestoneKind::End => "#000",
        MilestoneKind::Connection => "#fff",
        MilestoneKind::Expanded => ORANGE,
        MilestoneKind::Near | MilestoneKind::Contact => RED,
        MilestoneKind::Far => GREEN,
        MilestoneKind::Salvaged => PURPLE,
        _ => BLUE,
    }
}

/// Draws all pictures.
pub(super) fn draw(lab: &Lab) -> Result<()> {
    for name in SCENES {
        either!(Rigid::load(name)?, scene => covered(&scene, lab)?);
    }
    let (_, rigid) = CORRIDORS[0].ready()?.swap_remove(CORRIDOR);
    for info in mp_roadmap::planners() {
        either!(&rigid, scene => passed(scene, info.name, lab)?);
    }
    around(&RigidScene::<Spatial>::new(pillar()?)?, lab)
}

fn save(drawing: SvgDrawing, lab: &Lab, name: &str) -> Result<()> {
    let name = format!("roadmap-{name}.svg");
    lab.write(&name, &drawing.finish())?;
    note(&format!("drawn: {}", lab.file(&name).display()));
    Ok(())
}

/// Draws the roadmaps of PRM and Visib-PRM in a whole scene.
fn covered<M: RigidSpace>(scene: &RigidScene<M>, lab: &Lab) -> Result<()> {
    let (space, name) = (scene.space(), &scene.problem().name);
    let mut prm = prm_builder(scene, Learning { learn: NODES * 2 / 3, ..Learning::default() })?;
    prm.build(&mut Rng::seed(1), &mut Nodes(NODES), &mut ());
    let parts = visibility_prm::parts(space, 1_000).into_error()?;
    let checker = checker(scene, scene.verifier()?)?;
    let mut visible = Builder::new(checker, parts.generator, parts.connector, <KdTree>::default());
    visible.build(&mut Rng::seed(1), &mut Iterations(1_000_000), &mut ());
    for (planner, map) in [("prm", prm.into_map()), ("visibility-prm", visible.into_map())] {
        let mut drawing = SvgDrawing::new(&scene.problem().position_bounds(), Projection::Above, 900.0, &[]);
        obstacles(&mut drawing, scene.problem());
        roadmap::<M>(&mut drawing, &map, 3.0);
        save(drawing, lab, &format!("{name}-{planner}"))?;
    }
    Ok(())
}

fn obstacles(drawing: &mut SvgDrawing, problem: &RigidProblem) {
    drawing.silhouette(problem.obstacles.iter().map(|o| (&o.mesh, o.pose)), OBSTACLE, 0.6);
}

fn pose<M: RigidSpace>(q: &Configuration) -> Isometry3<f64> {
    q.to().map_or_else(Isometry3::identity, |q| M::pose(&q))
}

fn place<M: RigidSpace>(q: &Configuration) -> Point3<f64> {
    Point3::from(pose::<M>(q).translation.vector)
}

/// Draws edges, the unchecked ones lighter, and nodes of this radius, pixels.
fn roadmap<M: RigidSpace>(drawing: &mut SvgDrawing, map: &Roadmap<Configuration>, radius: f64) {
    for (state, colour) in [(LinkState::Unchecked, "#d5dde8"), (LinkState::Free, "#5b7fa8")] {
        let edges = map.all_edges().filter(|(_, _, link)| link.state == state);
        let ends = edges.map(|(_, ends, _)| ends.map(|end| place::<M>(map.state(end))));
        drawing.lines(ends, colour, 0.8);
    }
    for kind in MilestoneKind::ALL {
        let tagged = map.states().iter().zip(map.tags());
        let places: Vec<_> = tagged.filter(|(_, tag)| tag.kind == kind).map(|(q, _)| place::<M>(q)).collect();
        let radius = if matches!(kind, MilestoneKind::Guard | MilestoneKind::Connection) {
            radius * 1.7
        } else {
            radius
        };
        if !places.is_empty() {
            drawing.dots(places.iter().copied(), "#000", radius + 0.7);
            drawing.dots(places, colour(kind), radius);
        }
    }
}

/// Draws the roadmap with which a planner found a path, and the path.
fn passed<M: RigidSpace>(scene: &RigidScene<M>, planner: &str, lab: &Lab) -> Result<()> {
    let mut request = bare(planner);
    request.budget.queries = Some(1_000_000);
    let done = search(scene, &request, &mut Control { keep_roadmap: true, ..Control::default() })?;
    let (Some(map), Outcome::Solved(path)) = (done.roadmap, done.outcome) else {
        let what = format!("{planner} did not get through the corridor of the picture");
        return Err(Error::new(what));
    };
    let caption = format!("{planner}: {} nodes, {} queries", map.len(), done.queries);
    let mut drawing =
        SvgDrawing::new(&scene.problem().position_bounds(), Projection::Above, 480.0, &[caption]);
    obstacles(&mut drawing, scene.problem());
    roadmap::<M>(&mut drawing, &map, 2.0);
    let robot = &scene.problem().robot.mesh;
    let steps = path.resampled(scene.space(), 0.02 * path.length(scene.space())).into_error()?;
    drawing.silhouette(steps.states.iter().map(|q| (robot, pose::<M>(q))), ORANGE, 0.25);
    drawing.silhouette(path.states.iter().map(|q| (robot, pose::<M>(q))), ORANGE, 0.8);
    save(drawing, lab, &format!("corridor-{planner}"))
}

/// A rod near one long block.
fn pillar() -> Result<RigidProblem> {
    let mesh = cuboid(1.4, 0.45, 0.45).into_error()?;
    let rod = cuboid(0.5, 0.06, 0.06).into_error()?;
    let high = Point3::new(1.5, 1.3, 1.1);
    Ok(RigidProblem {
        name: "pillar".to_owned(),
        space: SpaceKind::Se3,
        robot: Body { name: "rod".to_owned(), file: PathBuf::new(), mesh: rod },
        obstacles: vec![PlacedBody {
            name: "block".to_owned(),
            file: PathBuf::new(),
            mesh,
            pose: Isometry3::identity(),
        }],
        start: Isometry3::translation(-1.2, 0.0, 0.0),
        goal: Isometry3::translation(1.2, 0.0, 0.0),
        bounds: Some(Aabb { min: -high, max: high }),
    })
}

/// Draws the configurations that obstacle-geometry PRM and OBPRM propose around one obstacle.
fn around<M: RigidSpace>(scene: &RigidScene<M>, lab: &Lab) -> Result<()> {
    let robot = scene.checker();
    let Some(block) = robot.obstacle_features(0) else { return Err(Error::new("no obstacle")) };
    let along = |q: &Configuration| {
        let axis: Vector3<f64> = pose::<M>(q).rotation * robot.robot_features().axis;
        axis.dot(&block.axis).abs() > 0.9
    };
    let geometry =
        |far| AroundObstacles::new(robot.clone(), ByGeometry { far, ..ByGeometry::default() }).into_error();
    let far = candidates(scene, geometry(1_000)?, 0..60)?;
    let near = candidates(scene, geometry(0)?, 0..60)?;
    let near: Vec<_> = near.into_iter().filter(|c| c.kind == MilestoneKind::Near).collect();
    let (parallel, across): (Vec<_>, Vec<_>) = near.into_iter().map(|c| c.state).partition(along);
    let far = far.into_iter().map(|c| c.state).collect::<Vec<_>>();
    let caption = format!("far, by spheres alone: {} green; near, by the elastic band:", far.len());
    let more = format!("{} parallel, blue; {} perpendicular, orange", parallel.len(), across.len());
    shown(
        scene,
        [(&far, GREEN), (&parallel, BLUE), (&across, ORANGE)],
        [caption, more],
        (lab, "far-and-near"),
    )?;

    let on = |strategy| {
        let with = OnSurfaces {
            strategy,
            uniform: 0.0,
            gap: mp_cspace::Length::Absolute(0.25),
            ..OnSurfaces::default()
        };
        let all =
            candidates(scene, OnObstacles::new(scene.space(), robot.clone(), with).into_error()?, 0..45)?;
        Ok::<_, Error>(all.into_iter().map(|c| c.state).collect::<Vec<_>>())
    };
    let (contact, free) = (on(Strategy::Contact)?, on(Strategy::Free)?);
    let caption = format!("OBPRM: {} contact configurations, red;", contact.len());
    let more = format!("{} free ones near contact, green", free.len());
    shown(scene, [(&contact, RED), (&free, GREEN), (&vec![], BLUE)], [caption, more], (lab, "obprm-contact"))
}

fn candidates<'c, M: RigidSpace, G: NodeGenerator<SpaceOf<M>, Local<'c, M>>>(
    scene: &'c RigidScene<M>,
    mut generator: G,
    attempts: std::ops::Range<u64>,
) -> Result<Vec<Candidate<Configuration, ()>>> {
    let mut checker = checker(scene, scene.verifier()?)?;
    let (map, mut all, mut out) = (Roadmap::new(), Vec::new(), Vec::new());
    for attempt in attempts {
        generator.generate(attempt, &map, &mut checker, &mut Rng::stream(1, attempt), &mut out);
        all.append(&mut out);
    }
    Ok(all)
}

/// Draws robots in their colours, the obstacles, and the spheres around the obstacles.
fn shown<M: RigidSpace>(
    scene: &RigidScene<M>,
    robots: [(&Vec<Configuration>, &str); 3],
    captions: [String; 2],
    (lab, name): (&Lab, &str),
) -> Result<()> {
    let problem = scene.problem();
    let mut drawing = SvgDrawing::new(&problem.position_bounds(), Projection::Aslant, 620.0, &captions);
    for outline in scene.robot().obstacles() {
        drawing.sphere(&Point3::from(outline.center), outline.radius, "#8a94a3");
    }
    let bodies = problem.obstacles.iter().map(|o| (&o.mesh, o.pose, OBSTACLE));
    let placed = robots
        .into_iter()
        .flat_map(|(states, colour)| states.iter().map(move |q| (&problem.robot.mesh, pose::<M>(q), colour)));
    drawing.solids(bodies.chain(placed));
    save(drawing, lab, name)
}
