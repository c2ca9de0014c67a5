//! Natural expansion (Jouandeau et al. 2008, §2.4, Figures 1–4): the Delaunay triangles of the nodes of an
//! RRT that grows in a free square, and of its corners.
//!
//! With the root alone there are four triangles of a quarter of the square each; n nodes make 2n + 2
//! triangles, so the mean area is known; the measurement is how far the largest, the smallest and the
//! deviation are from it.

use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Table, bootstrap, mean, sections};
use crate::plot::{Axis, ChartCurve, Labels, chart};
use mp_control::{InputPlanner, InputSet, Kinematic, LocalFlowCheck};
use mp_cspace::{KnownFree, MotionCheck, MotionValidity, Planner, Rn, Rng, Straight};
use mp_render::{Drawing, Item};
use mp_tree::{Goals, Length, Problem, Rrt, RrtInputs, Tuning};
use nalgebra::Vector2;
use spade::{DelaunayTriangulation, Point2, Triangulation};

/// How the tree is extended, in units of the side. The paper does not say how its tree is extended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Moves {
    /// Straight toward the sample, at most this far.
    Straight(f64),
    /// By one of four inputs (ALG. 4): this part of the side along an axis. The nodes are on a lattice, which
    /// fills up.
    Axes(u32),
}

impl std::fmt::Display for Moves {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Straight(step) => write!(f, "straight, step {step}"),
            Self::Axes(parts) => write!(f, "four inputs, step 1/{parts}"),
        }
    }
}

const MOVES: [Moves; 10] = [
    Moves::Straight(0.02),
    Moves::Straight(0.05),
    Moves::Straight(0.1),
    Moves::Straight(0.2),
    Moves::Axes(16),
    Moves::Axes(18),
    LIKE_THE_PAPER,
    Moves::Axes(22),
    Moves::Axes(24),
    Moves::Axes(32),
];
/// The moves with which the paper's numbers agree best: its trees are drawn.
const LIKE_THE_PAPER: Moves = Moves::Axes(20);
const IN_CHARTS: [Moves; 5] =
    [Moves::Straight(0.05), Moves::Straight(0.2), Moves::Axes(16), LIKE_THE_PAPER, Moves::Axes(24)];
/// The moves that are started elsewhere as well.
const STARTED: [Moves; 2] = [Moves::Straight(0.05), LIKE_THE_PAPER];
const CENTRE: [f64; 2] = [0.5, 0.5];
/// Other starts: on the lattice around the centre, between its lines, at a side and at a corner.
const STARTS: [[f64; 2]; 4] = [[0.25, 0.25], [0.37, 0.61], [0.5, 0.05], [0.05, 0.05]];
/// The number of nodes from which on, in the paper, the largest triangle falls from 8.15 times the mean.
const THRESHOLD: usize = 353;
/// The most nodes; the paper's figures end below this.
const NODES: usize = 3_000;
/// Samples of Figure 1, and nodes of Figure 2.
const SAMPLES_DRAWN: [usize; 3] = [100, 500, 1_500];
const NODES_DRAWN: [usize; 3] = [25, 275, 775];

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

/// A tree that grew, with its triangles at every number of nodes.
#[derive(Clone, Debug, PartialEq)]
struct GrownTree {
    areas: Vec<Areas>,
    /// Each node, with that of its parent.
    nodes: Vec<(Vector2<f64>, Vector2<f64>)>,
    /// The number of nodes after each sample.
    after: Vec<usize>,
}

/// Grows one tree and measures it at every number of nodes up to `nodes`, or until it is full.
fn grow(moves: Moves, start: [f64; 2], nodes: usize, seed: u64) -> Result<GrownTree> {
    // In units of an input, so that the nodes are exactly on the lattice and reach the sides.
    let side = match moves {
        Moves::Straight(_) => 1.0,
        Moves::Axes(parts) => f64::from(parts),
    };
    let added = |states: &[Vector2<f64>], parent: &dyn Fn(usize) -> Option<u32>, known: usize| {
        let state = |id: usize| states[id] / side;
        let of = |id: usize| (state(id), parent(id).map_or(state(id), |p| state(p as usize)));
        (known..states.len()).map(of).collect::<Vec<_>>()
    };
    let space = Rn::<2>::new([0.0; 2], [side; 2]).into_error()?;
    let start = Vector2::from(start) * side;
    let nowhere = Goals::region(|_: &Vector2<f64>| false);
    let straight = Straight::new(&space, Free);
    match moves {
        Moves::Straight(step) => {
            let problem = Problem::new(&space, straight, Free, start, nowhere).into_error()?;
            let tuning = Tuning { step: Length::Absolute(step), ..Tuning::default() };
            let mut planner = Rrt::new(problem, tuning).into_error()?;
            follow(nodes, seed, |rng, known| {
                planner.step(rng, &mut ());
                added(planner.tree().states(), &|id| planner.tree().parent(id as u32), known)
            })
        }
        Moves::Axes(_) => {
            let flow = Kinematic::new(&space).into_error()?;
            let inputs = InputSet::axes([1.0; 2]).into_error()?;
            let local =
                InputPlanner::new(&space, flow, inputs, 1.0, LocalFlowCheck(straight)).into_error()?;
            let problem = Problem::new(&space, local, Free, start, nowhere).into_error()?;
            let mut planner = RrtInputs::new(problem, Tuning::default()).into_error()?;
            follow(nodes, seed, |rng, known| {
                planner.step(rng, &mut ());
                added(planner.tree().states(), &|id| planner.tree().parent(id as u32), known)
            })
        }
    }
}

/// Iterations without a new node after which a tree counts as full.
const PATIENCE: usize = 5_000;

type Triangles = DelaunayTriangulation<Point2<f64>>;

fn insert(q: Vector2<f64>, triangles: &mut Triangles) -> Result<()> {
    triangles.insert(Point2::new(q.x, q.y)).map(|_| ()).doing(|| "cannot triangulate".to_owned())
}

/// The two triangles of the square.
fn square() -> Result<Triangles> {
    let mut triangles = Triangles::new();
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
        insert(Vector2::new(x, y), &mut triangles)?;
    }
    Ok(triangles)
}

/// Triangulates the new nodes that each `step` returns, with their parents; `step` takes the number of nodes
/// so far.
fn follow(
    nodes: usize,
    seed: u64,
    mut step: impl FnMut(&mut Rng, usize) -> Vec<(Vector2<f64>, Vector2<f64>)>,
) -> Result<GrownTree> {
    let mut triangles = square()?;
    let mut tree = GrownTree { areas: Vec::new(), nodes: Vec::new(), after: Vec::new() };
    let (mut rng, mut idle) = (Rng::seed(seed), 0);
    while tree.nodes.len() < nodes && idle < PATIENCE {
        idle += 1;
        for new in step(&mut rng, tree.nodes.len()) {
            insert(new.0, &mut triangles)?;
            tree.nodes.push(new);
            tree.areas.push(areas(tree.nodes.len(), &triangles));
            idle = 0;
        }
        tree.after.push(tree.nodes.len());
    }
    tree.areas.truncate(nodes);
    Ok(tree)
}

/// Figure 1: the tree after some samples.
fn tree_drawing(tree: &GrownTree, samples: usize) -> Drawing {
    let count = tree.after[samples.min(tree.after.len()) - 1];
    let point = |q: &Vector2<f64>| nalgebra::Point2::new(q.x, q.y);
    let edges = tree.nodes[..count].iter().map(|(q, parent)| vec![point(parent), point(q)]).collect();
    drawing(Item::lines(edges, 0x1f77b4, 1.0), tree, format!("{samples} samples"), format!("{count} nodes"))
}

/// Figure 2: the triangulation of the first nodes, each of which an expansion has added.
fn triangles_drawing(tree: &GrownTree, nodes: usize) -> Result<Drawing> {
    let count = nodes.min(tree.nodes.len());
    let mut triangles = square()?;
    tree.nodes[..count].iter().try_for_each(|(q, _)| insert(*q, &mut triangles))?;
    let edges = triangles
        .undirected_edges()
        .map(|edge| edge.positions().iter().map(|p| nalgebra::Point2::new(p.x, p.y)).collect());
    let words = format!("{} triangles", triangles.num_inner_faces());
    Ok(drawing(Item::lines(edges.collect(), 0x555555, 1.0), tree, format!("{count} nodes"), words))
}

/// A drawing of the square with the start.
fn drawing(item: Item, tree: &GrownTree, title: String, subtitle: String) -> Drawing {
    let around = |angle: f64| {
        let (sin, cos) = mp_math::sin_cos(angle);
        let start = tree.nodes[0].0;
        nalgebra::Point2::new(start.x + 0.012 * cos, start.y + 0.012 * sin)
    };
    let start = (0..=24).map(|i| around(std::f64::consts::TAU * f64::from(i) / 24.0)).collect();
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]].map(nalgebra::Point2::from);
    let frame = Item::lines(vec![corners.to_vec()], 0x222222, 2.0);
    let [low, high] = [nalgebra::Point2::new(0.0, 0.0), nalgebra::Point2::new(1.0, 1.0)];
    Drawing { title, subtitle, low, high, items: vec![item, frame, Item::area(vec![start], 0xd62728)] }
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
    let elsewhere = STARTED.iter().flat_map(|&moves| STARTS.map(|start| (moves, start)));
    let kinds: Vec<(Moves, [f64; 2])> =
        MOVES.map(|moves| (moves, CENTRE)).into_iter().chain(elsewhere).collect();
    let jobs: Vec<((Moves, [f64; 2]), u64)> =
        kinds.iter().flat_map(|&kind| (0..seeds).map(move |s| (kind, seed + s))).collect();
    let grown =
        lab.all("expansion", &jobs, |&((moves, start), seed)| Ok(Some(grow(moves, start, nodes, seed)?)))?;
    let Some(grown) = grown else { return Ok(false) };
    if let Some(drawn) = kinds.iter().position(|kind| kind.0 == LIKE_THE_PAPER) {
        let drawn = &grown[drawn * seeds as usize];
        let save = |name: String, drawing: &Drawing| {
            lab.write(&format!("rsrt-expansion-{name}.svg"), &drawing.svg((360, 420)).into_error()?)
        };
        for samples in SAMPLES_DRAWN {
            save(format!("tree-{samples}"), &tree_drawing(drawn, samples))?;
        }
        for count in NODES_DRAWN {
            save(format!("triangles-{count}"), &triangles_drawing(drawn, count)?)?;
        }
    }
    let grown: Vec<Vec<Areas>> = grown.into_iter().map(|tree| tree.areas).collect();
    let shown = |a: &&Areas| [25, 100, THRESHOLD, 775, NODES].contains(&a.nodes);
    let each = Table::of(
        jobs.iter().zip(&grown).flat_map(|(job, run)| run.iter().filter(shown).map(move |a| (job, a))),
        &[
            ("moves", &|(((moves, _), _), _)| moves.to_string()),
            ("start", &|(((_, start), _), _)| format!("{} {}", start[0], start[1])),
            ("seed", &|((_, seed), _)| seed.to_string()),
            ("nodes", &|(_, a)| a.nodes.to_string()),
            ("mean", &|(_, a)| format!("{:.3e}", a.mean)),
            ("least", &|(_, a)| format!("{:.3e}", a.least)),
            ("most", &|(_, a)| format!("{:.3e}", a.most)),
            ("deviation", &|(_, a)| format!("{:.3e}", a.deviation)),
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
    let shown = by_moves().filter(|(moves, _)| IN_CHARTS.contains(moves));
    for (i, (moves, runs)) in shown.enumerate() {
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
    size.push(ChartCurve::new("mean", 5, means).pattern(1));
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
    let mut starts = Table::new(["moves, of the side", "start"]);
    let counts = [25, 100, THRESHOLD, 775];
    starts.head.extend(counts.map(|n| format!("most / mean at {n}")));
    for (kind, runs) in
        kinds.iter().zip(grown.chunks(seeds as usize)).filter(|(kind, _)| STARTED.contains(&kind.0))
    {
        let cells = counts.map(|n| {
            let at = |i: usize| over(&runs[i..=i], n, &|a| a.most / a.mean);
            let (low, high) =
                bootstrap(runs.len(), |drawn| mean(drawn.iter().map(|&i| at(i))).unwrap_or(f64::NAN));
            format!("{} ({low:.2} – {high:.2})", ratio(runs, n))
        });
        let names = [kind.0.to_string(), format!("({}, {})", kind.1[0], kind.1[1])];
        starts.rows.push(names.into_iter().chain(cells).collect());
    }
    let text =
        sections(3, &[("By step, from the centre", summary), ("By start, with 95% intervals", starts)]);
    lab.report("rsrt-expansion", &text, &each)?;
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_alone_makes_four_quarters() {
        let tree = grow(Moves::Straight(0.1), CENTRE, 50, 1).unwrap();
        let all = &tree.areas;
        let first = Areas { nodes: 1, mean: 0.25, least: 0.25, most: 0.25, deviation: 0.0 };
        assert_eq!(all[0], first);
        for a in all {
            assert!((a.mean * (2 * a.nodes + 2) as f64 - 1.0).abs() < 1e-9, "{a:?}");
            assert!(a.least <= a.mean && a.mean <= a.most);
        }
        assert_eq!(grow(Moves::Straight(0.1), CENTRE, 50, 1).unwrap(), tree);
        assert!(
            tree.nodes.iter().skip(1).all(|(q, parent)| (0.0..=0.1 + 1e-12).contains(&(q - parent).norm()))
        );
        let svg = tree_drawing(&tree, 20).svg((300, 360)).unwrap();
        assert!(svg.contains("20 samples") && svg.contains("21 nodes"), "{svg}");
        let svg = triangles_drawing(&tree, 30).unwrap().svg((300, 360)).unwrap();
        assert!(svg.contains("30 nodes") && svg.contains("62 triangles"), "{svg}");
    }

    /// Seventeen by seventeen nodes, half a cell each triangle.
    #[test]
    fn a_lattice_fills_up() {
        for (parts, nodes) in [(16, 289), (20, 441)] {
            let all = grow(Moves::Axes(parts), CENTRE, 1_000, 1).unwrap().areas;
            let last = all[all.len() - 1];
            let area = 0.5 / f64::from(parts * parts);
            assert_eq!(last.nodes, nodes);
            assert!(
                (last.least / area - 1.0).abs() < 1e-9 && (last.most / area - 1.0).abs() < 1e-9,
                "{last:?}"
            );
        }
    }
}
