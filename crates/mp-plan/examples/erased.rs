//! What the pointers of planners by name cost: the same planner, seeds and paths, once made by type and once by name, in
//! turn. `cargo run --release -p mp-plan --example erased`
//!
//! Scenes: RRT-Connect with certified edges until it is solved. Empty space: an RRT grown to so many nodes, without
//! obstacles and checks, so that nothing hides the pointers.

use mp_cspace::erased::{AnyIndex, AnySpace};
use mp_cspace::{
    AsVectors, Cancel, Certified, Configuration, DefaultNn, Goals, Iterations, KnownFree, MotionCheck,
    MotionValidity, Nodes, Outcome, Path, Planner, Problem, Rn, Rng, Se3, StateVector, Stop, Straight,
    Workers, registry::Settings,
};
use mp_plan::{Motion, RigidScene, TypedMotion};
use mp_robot::Spatial;
use mp_tree::{Rrt, RrtConnect, Tuning, erased};
use nalgebra::Isometry3;
use std::error::Error;
use std::io::Write;
use std::sync::Arc;
use std::time::Instant;

/// Rounds of each pair, of which the least time counts.
const ROUNDS: usize = 9;

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "| what | by type, ms | by name, ms | ratio |\n|---|---|---|---|")?;
    for (scene, seeds) in [("cubicles", 40), ("twisty", 20), ("apartment", 4)] {
        let file = mp_scenes::scene(scene).ok_or("no such scene")?;
        let files = mp_io::InMemory(|name: &str| mp_scenes::file(name).map(|file| file.bytes));
        let problem = mp_io::RigidProblem::load_from(&files, std::path::Path::new(file.path))?;
        let scene_of = RigidScene::<Spatial>::new(problem)?;
        let times = in_turn(&|by_name| seeded(seeds, &|seed| solve(&scene_of, seed, by_name)))?;
        report(&mut out, &format!("{scene}, {seeds} seeds"), times)?;
    }
    for nodes in [1_000, 10_000, 100_000] {
        let plane = Rn::<2>::new([0.0; 2], [1.0; 2])?;
        let space = Se3::new([0.0; 3], [1.0; 3])?;
        let times = in_turn(&|by_name| grow(&plane, nodes, by_name))?;
        report(&mut out, &format!("empty R², {nodes} nodes"), times)?;
        let times = in_turn(&|by_name| grow(&space, nodes, by_name))?;
        report(&mut out, &format!("empty SE(3), {nodes} nodes"), times)?;
        let joints = Rn::<6>::new([-3.0; 6], [3.0; 6])?;
        let times = in_turn(&|by_name| grow(&joints, nodes, by_name))?;
        report(&mut out, &format!("empty space of 6 joints, {nodes} nodes"), times)?;
    }
    Ok(())
}

type Timed = Result<f64, Box<dyn Error>>;

/// The least times (ms) of both ways, taken in turn.
fn in_turn(run: &dyn Fn(bool) -> Timed) -> Result<[f64; 2], Box<dyn Error>> {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        for (i, by_name) in [false, true].into_iter().enumerate() {
            least[i] = least[i].min(run(by_name)?);
        }
    }
    Ok(least)
}

fn report(out: &mut impl Write, what: &str, [one, other]: [f64; 2]) -> std::io::Result<()> {
    writeln!(out, "| {what} | {one:.2} | {other:.2} | {:.3} |", other / one)
}

/// The time (ms) of a run for each seed.
fn seeded(seeds: u64, run: &dyn Fn(u64) -> Result<(), Box<dyn Error>>) -> Timed {
    let began = Instant::now();
    (1..=seeds).try_for_each(run)?;
    Ok(1e3 * began.elapsed().as_secs_f64())
}

/// RRT-Connect on a scene, by type or by name.
fn solve(scene: &RigidScene<Spatial>, seed: u64, by_name: bool) -> Result<(), Box<dyn Error>> {
    let (space, robot, verifier) = (scene.space(), scene.robot(), scene.verifier()?);
    let (start, goals) = (scene.start().clone(), scene.goals().to_vec());
    let mut stop = Iterations(20_000).or(Cancel::new());
    let mut rng = Rng::seed(seed);
    let found = match by_name {
        false => {
            let (space, placed) = (&space.0, |q: &Configuration| q.to().ok_or("no placement"));
            let check = Certified::new(space, robot.clone(), scene.tolerance())?;
            let goals = goals.iter().map(placed).collect::<Result<Vec<Isometry3<f64>>, _>>()?;
            let (local, verifier) = (Straight::new(space, check), verifier.inner().clone());
            let problem = Problem::new(space, local, verifier, placed(&start)?, Goals::states(goals))?;
            path_of(RrtConnect::new(problem, Tuning::default())?.solve(&mut rng, &mut stop, &mut ()))
        }
        true => {
            let any = AnySpace::new(space);
            let make = || {
                let check = Certified::new(space, scene.checker().clone(), scene.tolerance());
                let check = check.map_err(|e| mp_cspace::BuildError::Unmade { reason: e.to_string() })?;
                let local = Straight::new(&any, Box::new(check) as _);
                Problem::new(&any, local, verifier.clone(), start.clone(), Goals::states(goals.clone()))
            };
            let (index, settings) = (AnyIndex::of(space), Settings::default());
            let workers = Workers::single();
            let mut planner = erased::build("rrt-connect", Arc::new(make), index, &settings, &workers)?;
            path_of(planner.solve(&mut rng, &mut stop, &mut ()))
        }
    };
    std::hint::black_box(found);
    Ok(())
}

fn path_of<S>(outcome: Outcome<Path<S>>) -> usize {
    match outcome {
        Outcome::Solved(path) => path.states.len(),
        Outcome::Stopped(_) => 0,
    }
}

/// Nothing is in the way.
#[derive(Clone)]
struct Free;

impl<S> MotionValidity<S> for Free {
    fn check_motion(&mut self, _: &S, _: &S) -> MotionCheck {
        MotionCheck::Free { clearance: 0.0 }
    }
    fn check_extension(&mut self, _: &S, _: &S, _: KnownFree) -> MotionCheck {
        MotionCheck::Free { clearance: 0.0 }
    }
}

/// The time (ms) in which an RRT grows to `nodes` nodes in an empty space, toward a goal that it never reaches.
fn grow<C>(space: &C, nodes: usize, by_name: bool) -> Timed
where
    C: DefaultNn<State: StateVector, Nn: Send + Sync + 'static> + Clone + Send + 'static,
    AsVectors<C>: DefaultNn<State = Configuration, Nn: 'static>,
{
    let start = space.sample_uniform(&mut Rng::seed(9));
    let (mut rng, mut stop) = (Rng::seed(1), Nodes(nodes));
    let began = Instant::now();
    match by_name {
        false => {
            let never = Goals::region(|_: &C::State| false);
            let problem = Problem::new(space, Straight::new(space, Free), Free, start, never)?;
            Rrt::new(problem, Tuning::default())?.solve(&mut rng, &mut stop, &mut ());
        }
        true => {
            let (rows, start) = (AsVectors(space.clone()), Configuration::of(&start));
            let any = AnySpace::new(&rows);
            let make = || {
                let local = Straight::new(&any, Box::new(Free) as _);
                Problem::new(&any, local, Free, start.clone(), Goals::region(|_: &Configuration| false))
            };
            let (index, settings) = (AnyIndex::of(&rows), Settings::default());
            let mut planner = erased::build("rrt", Arc::new(make), index, &settings, &Workers::single())?;
            planner.solve(&mut rng, &mut stop, &mut ());
        }
    }
    Ok(1e3 * began.elapsed().as_secs_f64())
}
