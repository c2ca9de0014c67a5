//! Pictures of roadmaps, as SVG: the coverage of whole scenes; what each algorithm needed to get through a corridor; and
//! where around an obstacle the configurations of obstacle-geometry PRM and OBPRM are.

use super::drawing::{Drawing, View};
use super::queries::{Local, steer};
use super::world::CORRIDORS;
use crate::cli::Motion;
use crate::output::{note, write};
use crate::plan::mover::Mover;
use crate::plan::progress::Line;
use crate::plan::setting::Setting;
use crate::plan::task::Task;
use crate::plan::{Options, Ready};
use crate::scenes;
use miette::{IntoDiagnostic, Result, miette};
use mp::cspace::{Cancel, DefaultNn, Iterations, Nodes, ObstacleGeometry, Outcome, Rng, Stop};
use mp::geom::Aabb;
use mp::geom::primitives::cuboid;
use mp::io::{Body, PlacedBody, Problem, SpaceKind};
use mp::roadmap::algo::{prm, visibility_prm};
use mp::roadmap::{
    AroundObstacles, Builder, ByGeometry, Candidate, Connector, Kind, Learning, LinkState, NodeGenerator,
    OnObstacles, OnSurfaces, Reachable, Roadmap, Strategy,
};
use nalgebra::{Isometry3, Point3, Vector3};
use petgraph::visit::EdgeRef;
use std::path::{Path, PathBuf};

const SCENES: [&str; 3] = ["maze", "planar-bugtrap", "gempa-3"];
/// Nodes of PRM's.
const NODES: usize = 400;
/// The corridor of the small pictures: which of the planar ones.
const CORRIDOR: usize = 0;

const OBSTACLE: &str = "#b4bdc9";
const GREEN: &str = "#2f9e6e";
const BLUE: &str = "#2c6fb0";
const RED: &str = "#d1495b";
const PURPLE: &str = "#8f5bb8";
const ORANGE: &str = "#e6892d";

/// The colour of nodes; black and white of guards and connections.
fn colour(kind: Kind) -> &'static str {
    match kind {
        Kind::Guard | Kind::End => "#000",
        Kind::Connection => "#fff",
        Kind::Expanded => ORANGE,
        Kind::Near | Kind::Contact => RED,
        Kind::Far => GREEN,
        Kind::Salvaged => PURPLE,
        _ => BLUE,
    }
}

/// Draws all of them into `folder`.
pub(super) fn draw(folder: &Path) -> Result<()> {
    for name in SCENES {
        match Ready::load(&scenes::find(Path::new(name))?)? {
            Ready::Space(setting) => covered(&setting, folder)?,
            Ready::Plane(setting) => covered(&setting, folder)?,
        }
    }
    let (_, ready) = CORRIDORS[0].ready()?.swap_remove(CORRIDOR);
    let Ready::Plane(corridor) = ready else { return Err(miette!("the corridor is not in the plane")) };
    for info in mp::roadmap::planners().iter() {
        passed(&corridor, info.name, folder)?;
    }
    let Ready::Space(pillar) = Ready::of(pillar()?)? else {
        return Err(miette!("the pillar is in the plane"));
    };
    around(&pillar, folder)
}

fn save(drawing: Drawing, folder: &Path, name: &str) -> Result<()> {
    let file = folder.join(format!("roadmap-{name}.svg"));
    write(&file, drawing.finish().as_bytes())?;
    note(&format!("drawn: {}", file.display()));
    Ok(())
}

/// PRM's and Visib-PRM's roadmaps of a whole scene.
fn covered<M: Mover>(setting: &Setting<M>, folder: &Path) -> Result<()> {
    let (space, name) = (&setting.space, &setting.problem.name);
    let reach = Reachable { neighbours: 15, radius: f64::INFINITY, cycles: false };
    let learning = Learning { learn: NODES * 2 / 3, ..Learning::default() };
    let recipe = prm::recipe(space, reach, learning).into_diagnostic()?;
    let prm = built(setting, recipe.generate, recipe.connect, Nodes(NODES))?;
    let recipe = visibility_prm::recipe(space, 1_000).into_diagnostic()?;
    let visible = built(setting, recipe.generate, recipe.connect, Iterations(1_000_000))?;
    for (planner, map) in [("prm", prm), ("visibility-prm", visible)] {
        let mut drawing = Drawing::new(&setting.problem.position_bounds(), View::Above, 900.0, &[]);
        obstacles(&mut drawing, &setting.problem);
        roadmap::<M>(&mut drawing, &map, 3.0);
        save(drawing, folder, &format!("{name}-{planner}"))?;
    }
    Ok(())
}

fn built<'c, M: Mover, G, K>(
    setting: &'c Setting<M>,
    generate: G,
    connect: K,
    mut stop: impl Stop,
) -> Result<Roadmap<M::State>>
where
    G: NodeGenerator<M::Space, Local<'c, M>>,
    K: Connector<M::Space, Local<'c, M>>,
{
    let index = <M::Space as DefaultNn>::Nn::default();
    let mut builder = Builder::new(steer(setting, setting.verifier()?)?, generate, connect, index);
    builder.build(&mut Rng::seed(1), &mut stop, &mut ());
    Ok(builder.into_map())
}

fn obstacles(drawing: &mut Drawing, problem: &Problem) {
    drawing.silhouette(problem.obstacles.iter().map(|o| (&o.mesh, o.pose)), OBSTACLE, 0.6);
}

fn place<M: Mover>(q: &M::State) -> Point3<f64> {
    Point3::from(M::pose(q).translation.vector)
}

/// Edges, those not checked lighter; and nodes of this radius, pixels.
fn roadmap<M: Mover>(drawing: &mut Drawing, map: &Roadmap<M::State>, radius: f64) {
    for (state, colour) in [(LinkState::Unchecked, "#d5dde8"), (LinkState::Free, "#5b7fa8")] {
        let edges = map.graph().edge_references().filter(|edge| edge.weight().state == state);
        let ends = edges.map(|e| [e.source(), e.target()].map(|end| place::<M>(&map.states()[end.index()])));
        drawing.lines(ends, colour, 0.8);
    }
    for kind in Kind::ALL {
        let tagged = map.states().iter().zip(map.graph().node_weights());
        let places: Vec<_> = tagged.filter(|(_, tag)| tag.kind == kind).map(|(q, _)| place::<M>(q)).collect();
        let radius = if matches!(kind, Kind::Guard | Kind::Connection) { radius * 1.7 } else { radius };
        if !places.is_empty() {
            drawing.dots(places.iter().copied(), "#000", radius + 0.7);
            drawing.dots(places, colour(kind), radius);
        }
    }
}

/// The roadmap of a planner when it had found a path, and the path.
fn passed<M: Mover>(setting: &Setting<M>, planner: &str, folder: &Path) -> Result<()> {
    let options =
        Options { queries: Some(1_000_000), ..Options::comparable(planner, Motion::Certified, 1e9)? };
    let mut line = Line::new(planner, options.time, false);
    let done = setting.search(&options, 1, &Cancel::new(), &mut line)?;
    let (Some(map), Outcome::Solved(path)) = (done.roadmap, done.outcome) else {
        return Err(miette!("{planner} did not get through the corridor of the picture"));
    };
    let caption = format!("{planner}: {} nodes, {} queries", map.len(), done.queries);
    let mut drawing = Drawing::new(&setting.problem.position_bounds(), View::Above, 480.0, &[caption]);
    obstacles(&mut drawing, &setting.problem);
    roadmap::<M>(&mut drawing, &map, 2.0);
    let robot = &setting.problem.robot.mesh;
    let steps = path.resampled(&setting.space, 0.02 * path.length(&setting.space)).into_diagnostic()?;
    drawing.silhouette(steps.states.iter().map(|q| (robot, M::pose(q))), ORANGE, 0.25);
    drawing.silhouette(path.states.iter().map(|q| (robot, M::pose(q))), ORANGE, 0.8);
    save(drawing, folder, &format!("corridor-{planner}"))
}

/// One long block, and a rod about it.
fn pillar() -> Result<Problem> {
    let mesh = cuboid(1.4, 0.45, 0.45).into_diagnostic()?;
    let rod = cuboid(0.5, 0.06, 0.06).into_diagnostic()?;
    let high = Point3::new(1.5, 1.3, 1.1);
    Ok(Problem {
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

/// The configurations that obstacle-geometry PRM and OBPRM propose around one obstacle.
fn around<M: Mover>(setting: &Setting<M>, folder: &Path) -> Result<()> {
    let robot = &setting.robot;
    let Some(block) = robot.obstacles().first().copied() else { return Err(miette!("no obstacle")) };
    let along = |q: &M::State| {
        let axis: Vector3<f64> = M::pose(q).rotation * robot.robot().axis;
        axis.dot(&block.axis).abs() > 0.9
    };
    let geometry = |far| AroundObstacles::new(robot.clone(), ByGeometry { far, bands: 20 }).into_diagnostic();
    let far = candidates(setting, geometry(1_000)?, 0..60)?;
    let near = candidates(setting, geometry(0)?, 0..60)?;
    let near: Vec<_> = near.into_iter().filter(|c| c.kind == Kind::Near).collect();
    let (parallel, across): (Vec<_>, Vec<_>) = near.into_iter().map(|c| c.state).partition(along);
    let far = far.into_iter().map(|c| c.state).collect::<Vec<_>>();
    let caption = format!("far, by spheres alone: {} green; near, by the elastic band:", far.len());
    let more = format!("{} parallel, blue; {} perpendicular, orange", parallel.len(), across.len());
    shown(
        setting,
        [(&far, GREEN), (&parallel, BLUE), (&across, ORANGE)],
        [caption, more],
        (folder, "far-and-near"),
    )?;

    let on = |strategy| {
        let with = OnSurfaces {
            strategy,
            uniform: 0.0,
            gap: mp::cspace::Step::Length(0.25),
            ..OnSurfaces::default()
        };
        let all = candidates(
            setting,
            OnObstacles::new(&setting.space, robot.clone(), with).into_diagnostic()?,
            0..45,
        )?;
        Ok::<_, miette::Report>(all.into_iter().map(|c| c.state).collect::<Vec<_>>())
    };
    let (contact, free) = (on(Strategy::Contact)?, on(Strategy::Free)?);
    let caption = format!("OBPRM: {} contact configurations, red;", contact.len());
    let more = format!("{} free ones near contact, green", free.len());
    shown(
        setting,
        [(&contact, RED), (&free, GREEN), (&vec![], BLUE)],
        [caption, more],
        (folder, "obprm-contact"),
    )
}

fn candidates<'c, M: Mover, G: NodeGenerator<M::Space, Local<'c, M>>>(
    setting: &'c Setting<M>,
    mut generate: G,
    attempts: std::ops::Range<u64>,
) -> Result<Vec<Candidate<M::State, ()>>> {
    let mut steer = steer(setting, setting.verifier()?)?;
    let (map, mut all, mut out) = (Roadmap::new(), Vec::new(), Vec::new());
    for attempt in attempts {
        generate.generate(attempt, &map, &mut steer, &mut Rng::stream(1, attempt), &mut out);
        all.append(&mut out);
    }
    Ok(all)
}

/// Robots in their colours around the obstacles, with the spheres around these.
fn shown<M: Mover>(
    setting: &Setting<M>,
    robots: [(&Vec<M::State>, &str); 3],
    captions: [String; 2],
    (folder, name): (&Path, &str),
) -> Result<()> {
    let problem = &setting.problem;
    let mut drawing = Drawing::new(&problem.position_bounds(), View::Aslant, 620.0, &captions);
    for outline in setting.robot.obstacles() {
        drawing.sphere(&Point3::from(outline.center), outline.radius, "#8a94a3");
    }
    let bodies = problem.obstacles.iter().map(|o| (&o.mesh, o.pose, OBSTACLE));
    let placed = robots
        .into_iter()
        .flat_map(|(states, colour)| states.iter().map(move |q| (&problem.robot.mesh, M::pose(q), colour)));
    drawing.solids(bodies.chain(placed));
    save(drawing, folder, name)
}
