//! The cost of certified checks of a planner's edges, against discrete checks.

use super::pairs::scene;
use crate::clock::nanoseconds;
use crate::error::{IntoError, Result};
use crate::experiment::Table;
use crate::scenes::Rigid;
use mp_cspace::{Certified, Configuration, Discrete, KnownFree, Length, MotionValidity, Rng, Space};
use mp_plan::{Motion, TypedMotion};

/// The pairs in whose scenes edges are checked.
pub(crate) const CHECKED: [&str; 2] = ["cubicles", "piano"];
/// The longest steps of the trees that make the edges, and the resolution of discrete checks, as fractions of
/// the extent.
const LONGEST: [f64; 2] = [0.2, 0.05];
const RESOLUTION: f64 = 0.01;
/// The most steps of the greedy tree toward a sample.
const STEPS: usize = 5;

/// The costs of the edges of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Costs {
    scene: &'static str,
    /// The longest step, as a fraction of the extent.
    step: f64,
    discrete: Checked,
    certified: Checked,
}

/// The results of one kind of check of all edges.
#[derive(Clone, Debug)]
struct Checked {
    /// Microseconds per edge, the fastest pass.
    each: f64,
    free: Vec<bool>,
}

type Edge = (Configuration, Configuration);

impl Costs {
    /// Checks `count` edges that a greedy RRT makes in the scene of a pair with steps of each length,
    /// `passes` times in turn; empty for a pair without a scene in space.
    pub(crate) fn measure(pair: &str, count: usize, passes: usize) -> Result<Vec<Self>> {
        let Some(scene) = scene(pair) else { return Ok(Vec::new()) };
        let Rigid::Space(setting) = Rigid::load(scene)? else {
            return Ok(Vec::new());
        };
        let (space, robot) = (setting.space(), setting.checker());
        let resolution = Length::Fraction(RESOLUTION);
        let mut discrete = Discrete::new(space, robot.clone(), resolution).into_error()?;
        let mut certified = Certified::new(space, robot.clone(), setting.tolerance()).into_error()?;
        let measure = |step| {
            let edges = edges(
                space,
                &mut discrete,
                [setting.start().clone(), setting.goals()[0].clone()],
                step,
                count,
            );
            let mut costs = Self { scene, step, discrete: Checked::none(), certified: Checked::none() };
            for _ in 0..passes {
                costs.discrete.pass(&edges, &mut discrete);
                costs.certified.pass(&edges, &mut certified);
            }
            costs
        };
        Ok(LONGEST.map(measure).into())
    }

    /// Whether the discrete check found no collision in any certified edge.
    pub(crate) fn consistent(&self) -> bool {
        let mut both = self.certified.free.iter().zip(&self.discrete.free);
        both.all(|(certified, discrete)| !certified || *discrete)
    }
}

impl Checked {
    fn none() -> Self {
        Self { each: f64::INFINITY, free: Vec::new() }
    }

    fn pass(&mut self, edges: &[Edge], check: &mut impl MotionValidity<Configuration>) {
        let begin = nanoseconds();
        let free = edges.iter().map(|(a, b)| check.check_extension(a, b, KnownFree::From).is_free());
        self.free = free.collect();
        self.each = self.each.min((nanoseconds() - begin) * 1e-3 / edges.len().max(1) as f64);
    }
}

/// Edges of a tree with two roots that grows toward samples, step by step until a step is blocked; blocked
/// ones included.
fn edges<C: Space<State = Configuration>>(
    space: &C,
    check: &mut impl MotionValidity<Configuration>,
    roots: [Configuration; 2],
    step: f64,
    count: usize,
) -> Vec<Edge> {
    let (mut rng, mut edges, mut nodes) = (Rng::seed(1), Vec::new(), roots.to_vec());
    let step = step * space.extent();
    while edges.len() < count {
        let to = space.sample_uniform(&mut rng);
        let away = |q: &Configuration| space.distance(q, &to);
        let nearest = nodes.iter().min_by(|x, y| away(x).total_cmp(&away(y)));
        let mut at = nearest.unwrap_or(&to).clone();
        for _ in 0..STEPS {
            let distance = space.distance(&at, &to);
            if distance <= 0.0 || edges.len() == count {
                break;
            }
            let end =
                if distance <= step { to.clone() } else { space.interpolate(&at, &to, step / distance) };
            edges.push((at.clone(), end.clone()));
            if !check.check_extension(&at, &end, KnownFree::From).is_free() {
                break;
            }
            nodes.push(end.clone());
            at = end;
        }
    }
    edges
}

/// A row for each scene.
pub(crate) fn table(all: &[Costs]) -> Table {
    let free = |checked: &Checked| checked.free.iter().filter(|free| **free).count().to_string();
    Table::of(
        all,
        &[
            ("scene", &|c| c.scene.to_owned()),
            ("step", &|c| format!("{:.0}%", 100.0 * c.step)),
            ("edges", &|c| c.discrete.free.len().to_string()),
            ("free by discrete checks", &|c| free(&c.discrete)),
            ("certified free", &|c| free(&c.certified)),
            ("discrete, µs", &|c| format!("{:.1}", c.discrete.each)),
            ("certified, µs", &|c| format!("{:.1}", c.certified.each)),
            ("ratio", &|c| format!("{:.2}", c.certified.each / c.discrete.each)),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_made_and_checked_both_ways() {
        let all = Costs::measure("cubicles", 60, 1).unwrap();
        for (costs, step) in all.iter().zip(["20%", "5%"]) {
            assert!(costs.consistent());
            let row = &table(std::slice::from_ref(costs)).rows[0];
            assert_eq!(row[..3], ["cubicles", step, "60"]);
            let free = costs.discrete.free.iter().filter(|free| **free).count();
            assert!((1..60).contains(&free), "{free}");
        }
        assert_eq!(all.len(), 2);
        let mut wrong = all[0].clone();
        wrong.certified.free = wrong.discrete.free.iter().map(|free| !free).collect();
        assert!(!wrong.consistent());
        assert!(Costs::measure("large", 1, 1).unwrap().is_empty());
    }
}
