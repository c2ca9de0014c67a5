//! Natural expansion (Jouandeau et al. 2008, §2.4, Figures 1–4): the Delaunay triangles of the nodes of an RRT
//! that grows in a free square, and of its corners.
//!
//! With the root alone there are four triangles of a quarter of the square each; n nodes make 2n + 2
//! triangles, so the mean area is known; the measurement is how far the largest, the smallest and the
//! deviation are from it.

use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Table, mean};
use crate::plot::{Axis, ChartCurve, Labels, chart};
use mp_control::{InputPlanner, InputSet, Kinematic, LocalFlowCheck};
use mp_cspace::{KnownFree, MotionCheck, MotionValidity, Planner, Rn, Rng, Straight};
use mp_tree::{Goals, Problem, Rrt, RrtInputs, Step, Tuning};
use nalgebra::Vector2;
use spade::{DelaunayTriangulation, Point2, Triangulation};

/// How the tree is extended, in units of the side. The paper does not say how its tree is extended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Moves {
    /// Straight toward the sample, at most this far.
    Straight(f64),
    /// By one of four inputs (ALG. 4): this far along an axis. The nodes are on a lattice, which fills up.
    Axes(f64),
}

impl std::fmt::Display for Moves {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Straight(step) => write!(f, "straight, step {step}"),
            Self::Axes(step) => write!(f, "four inputs, step {step}"),
        }
    }
}

const MOVES: [Moves; 6] = [
    Moves::Straight(0.02),
    Moves::Straight(0.05),
    Moves::Straight(0.1),
    Moves::Straight(0.2),
    Moves::Axes(1.0 / 16.0),
    Moves::Axes(1.0 / 32.0),
];
/// The number of nodes from which on, in the paper, the largest triangle falls from 8.15 times the mean.
const THRESHOLD: usize = 353;
/// The most nodes; the paper's figures end below this.
const NODES: usize = 3_000;

/// Areas of the triangles at one number of nodes, as fractions of the square.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Areas {
    nodes: usize,
    mean: f64,
    least: f64,
    most: f64,
    deviation: f64,
}

/// A motion check for which every motion is free.
#[derive(Clone, Copy, Debug)]
struct Free;

impl MotionValidity<Vector2<f64>> for Free {
    fn check_motion(&mut self, _: &Vector2<f64>, _: &Vector2<f64>) -> MotionCheck {
        MotionCheck::Free { clearance: 0.0 }
    }
    fn check_extension(&mut self, a: &Vector2<f64>, b: &Vector2<f64>, _: KnownFree) -> MotionCheck {
        self.check_motion(a, b)
    }
}

/// Grows one tree and measures it at every number of nodes up to `nodes`, or until it is full.
fn grow(moves: Moves, nodes: usize, seed: u64) -> Result<Vec<Areas>> {
    let space = Rn::<2>::new([0.0; 2], [1.0; 2]).into_error()?;
    let start = Vector2::new(0.5, 0.5);
    let nowhere = Goals::region(|_: &Vector2<f64>| false);
    let straight = Straight::new(&space, Free);
    match moves {
        Moves::Straight(step) => {
            let problem = Problem::new(&space, straight, Free, start, nowhere).into_error()?;
            let tuning = Tuning { step: Step::Length(step), ..Tuning::default() };
            let mut planner = Rrt::new(problem, tuning).into_error()?;
            follow(nodes, seed, |rng, known| {
                planner.step(rng, &mut ());
                planner.tree().states()[known..].to_vec()
            })
        }
        Moves::Axes(step) => {
            let flow = Kinematic::new(&space).into_error()?;
            let inputs = InputSet::axes([step; 2]).into_error()?;
            let local =
                InputPlanner::new(&space, flow, inputs, 1.0, LocalFlowCheck(straight)).into_error()?;
            let problem = Problem::new(&space, local, Free, start, nowhere).into_error()?;
            let mut planner = RrtInputs::new(problem, Tuning::default()).into_error()?;
            follow(nodes, seed, |rng, known| {
                planner.step(rng, &mut ());
                planner.tree().states()[known..].to_vec()
            })
        }
    }
}

/// Iterations without a new node after which a tree counts as full.
const PATIENCE: usize = 5_000;

/// Triangulates the new nodes that each `step` returns; `step` takes the number of nodes so far.
fn follow(
    nodes: usize,
    seed: u64,
    mut step: impl FnMut(&mut Rng, usize) -> Vec<Vector2<f64>>,
) -> Result<Vec<Areas>> {
    let mut triangles = DelaunayTriangulation::<Point2<f64>>::new();
    let insert = |x: f64, y: f64, triangles: &mut DelaunayTriangulation<_>| {
        triangles.insert(Point2::new(x, y)).map(|_| ()).doing(|| "cannot triangulate".to_owned())
    };
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
        insert(x, y, &mut triangles)?;
    }
    let (mut rng, mut all, mut idle) = (Rng::seed(seed), Vec::new(), 0);
    while all.len() < nodes && idle < PATIENCE {
        idle += 1;
        for q in step(&mut rng, all.len()) {
            insert(q.x, q.y, &mut triangles)?;
            all.push(areas(all.len() + 1, &triangles));
            idle = 0;
        }
    }
    all.truncate(nodes);
    Ok(all)
}

/// The areas of the present triangles.
fn areas(nodes: usize, triangles: &DelaunayTriangulation<Point2<f64>>) -> Areas {
    let (mut sum, mut squares, mut least, mut most) = (0.0, 0.0, f64::INFINITY, 0.0_f64);
    for face in triangles.inner_faces() {
        let area = face.area();
        sum += area;
        squares += area * area;
        least = least.min(area);
        most = most.max(area);
    }
    let count = triangles.num_inner_faces().max(1) as f64;
    let mean = sum / count;
    Areas { nodes, mean, least, most, deviation: (squares / count - mean * mean).max(0.0).sqrt() }
}

/// The mean over all runs at a number of nodes. A full tree stays as it is.
fn over(runs: &[Vec<Areas>], nodes: usize, of: &dyn Fn(&Areas) -> f64) -> f64 {
    mean(runs.iter().map(|run| of(&run[nodes.min(run.len()) - 1]))).unwrap_or(f64::NAN)
}

/// Measures and reports. False when it was interrupted. The same seed gives the same numbers.
pub(super) fn run(lab: &Lab, quick: bool, seed: u64) -> Result<bool> {
    let seeds = if quick { 5 } else { 20 };
    let nodes = if quick { 1_000 } else { NODES };
    let jobs: Vec<(Moves, u64)> =
        MOVES.iter().flat_map(|&moves| (0..seeds).map(move |s| (moves, seed + s))).collect();
    let grown = lab.all("expansion", &jobs, |&(moves, seed)| Ok(Some(grow(moves, nodes, seed)?)))?;
    let Some(grown) = grown else { return Ok(false) };
    let shown = |a: &&Areas| a.nodes < 30 || a.nodes.is_multiple_of(25) || a.nodes == THRESHOLD;
    let each = Table::of(
        jobs.iter().zip(&grown).flat_map(|(job, run)| run.iter().filter(shown).map(move |a| (job, a))),
        &[
            ("moves", &|((moves, _), _)| moves.to_string()),
            ("seed", &|((_, seed), _)| seed.to_string()),
            ("nodes", &|(_, a)| a.nodes.to_string()),
            ("mean", &|(_, a)| format!("{:e}", a.mean)),
            ("least", &|(_, a)| format!("{:e}", a.least)),
            ("most", &|(_, a)| format!("{:e}", a.most)),
            ("deviation", &|(_, a)| format!("{:e}", a.deviation)),
        ],
    );
    let by_moves = || MOVES.iter().zip(grown.chunks(seeds as usize));
    let ratio = |runs: &[Vec<Areas>], n: usize| format!("{:.2}", over(runs, n, &|a| a.most / a.mean));
    let relative = |runs: &[Vec<Areas>], n: usize| format!("{:.2}", over(runs, n, &|a| a.deviation / a.mean));
    let [at_threshold, at_end, deviation_at_end] = [
        format!("at {THRESHOLD} (paper: 8.15 until there)"),
        format!("at {nodes} (paper: about 2)"),
        format!("at {nodes}"),
    ];
    let summary = Table::of(
        by_moves(),
        &[
            ("moves, of the side", &|(moves, _)| moves.to_string()),
            ("most / mean at 25", &|(_, runs)| ratio(runs, 25)),
            (&at_threshold, &|(_, runs)| ratio(runs, THRESHOLD)),
            ("at 775", &|(_, runs)| ratio(runs, 775)),
            (&at_end, &|(_, runs)| ratio(runs, nodes)),
            ("deviation / mean at 353", &|(_, runs)| relative(runs, THRESHOLD)),
            (&deviation_at_end, &|(_, runs)| relative(runs, nodes)),
        ],
    );
    let (mut size, mut spread) = (Vec::new(), Vec::new());
    for (i, (moves, runs)) in by_moves().enumerate() {
        let full = runs.iter().map(Vec::len).max().unwrap_or(1);
        let curve = |name: String, of: &dyn Fn(&Areas) -> f64| {
            let points = (1..=full).filter(|n| *n < 40 || n.is_multiple_of(10) || *n == full);
            ChartCurve::new(name, i, points.map(|n| (n as f64, over(runs, n, of))).collect())
        };
        size.push(curve(format!("largest, {moves}"), &|a| 100.0 * a.most));
        size.push(curve(format!("smallest, {moves}"), &|a| 100.0 * a.least).thin());
        spread.push(curve(moves.to_string(), &|a| 100.0 * a.deviation));
    }
    let points = (1..=nodes).filter(|n| *n < 40 || n.is_multiple_of(10));
    let means = points.map(|n| (n as f64, 100.0 / (2 * n + 2) as f64)).collect();
    size.push(ChartCurve::new("mean", 6, means));
    let marks = [1.0, 10.0, 25.0, 100.0, 353.0, 1_000.0, 3_000.0];
    let labels = Labels {
        title: "Delaunay triangles of an RRT in a free square: areas",
        x: "configurations",
        y: "% of the square",
    };
    let axes = [Axis::LogAt(&marks), Axis::Log];
    lab.write("rsrt-expansion-area.svg", &chart(labels, axes, &size)?)?;
    let labels = Labels { title: "Delaunay triangles of an RRT in a free square: deviation", ..labels };
    lab.write("rsrt-expansion-deviation.svg", &chart(labels, axes, &spread)?)?;
    lab.report("rsrt-expansion", &summary, &each)?;
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_alone_makes_four_quarters() {
        let all = grow(Moves::Straight(0.1), 50, 1).unwrap();
        let first = Areas { nodes: 1, mean: 0.25, least: 0.25, most: 0.25, deviation: 0.0 };
        assert_eq!(all[0], first);
        for a in &all {
            assert!((a.mean * (2 * a.nodes + 2) as f64 - 1.0).abs() < 1e-9, "{a:?}");
            assert!(a.least <= a.mean && a.mean <= a.most);
        }
        assert_eq!(grow(Moves::Straight(0.1), 50, 1).unwrap(), all);
    }

    /// Seventeen by seventeen nodes, half a cell each triangle.
    #[test]
    fn a_lattice_fills_up() {
        let all = grow(Moves::Axes(1.0 / 16.0), 1_000, 1).unwrap();
        let last = all[all.len() - 1];
        assert_eq!((last.nodes, last.least, last.most), (289, 1.0 / 512.0, 1.0 / 512.0));
    }
}
