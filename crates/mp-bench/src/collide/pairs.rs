//! The pairs of meshes that are measured.

use crate::error::{IntoError, Result};
use crate::scenes::problem;
use mp_geom::{Aabb, TriMesh};
use mp_plan::Error;
use nalgebra::Point3;
use std::f64::consts::TAU;

/// The names of the pairs.
pub(crate) const PAIRS: [&str; 5] = ["cubicles", "twisty", "alpha", "piano", "large"];

/// Bumps of the first and of the second torus: amplitude (of the minor radius), waves around the ring, waves
/// around the tube.
const BUMPS_A: [[f64; 3]; 3] = [[0.10, 9.0, 7.0], [0.05, 23.0, 5.0], [0.02, -17.0, 41.0]];
const BUMPS_B: [[f64; 3]; 3] = [[0.12, 7.0, 5.0], [0.04, -19.0, 8.0], [0.02, 31.0, 29.0]];

/// An obstacle fixed in the world, and a robot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) name: String,
    /// All obstacles in one mesh, in the world frame.
    pub(crate) a: TriMesh,
    /// The robot, in its own frame.
    pub(crate) b: TriMesh,
    /// The box in which the origin of the robot may be.
    pub(crate) bounds: Aabb,
}

impl Pair {
    /// The pair called `name`, of [`PAIRS`].
    ///
    /// # Errors
    /// When there is no such pair, or its scene cannot be read.
    pub(crate) fn load(name: &str) -> Result<Self> {
        if name == "large" {
            return tori(name, 224);
        }
        let scene = scene(name).ok_or_else(|| {
            Error::new(format!("there is no pair `{name}`; there are: {}", PAIRS.join(", ")))
        })?;
        let problem = problem(scene)?;
        let placed: Vec<TriMesh> = problem.obstacles.iter().map(|o| o.mesh.transformed(&o.pose)).collect();
        let a = TriMesh::merged(&placed).ok_or_else(|| Error::new(format!("{scene} has no obstacles")))?;
        let bounds = problem.position_bounds();
        Ok(Self { name: name.to_owned(), a, b: problem.robot.mesh, bounds })
    }

    /// The largest distance of a point of the robot from its origin, metres.
    pub(crate) fn radius(&self) -> f64 {
        self.b.vertices().iter().map(|p| p.coords.norm()).fold(0.0, f64::max)
    }
}

/// The scene from which the pair called `name` comes.
pub(crate) fn scene(name: &str) -> Option<&'static str> {
    match name {
        "alpha" => Some("alpha-1.0"),
        "cubicles" => Some("cubicles"),
        "twisty" => Some("twisty"),
        "piano" => Some("apartment"),
        _ => None,
    }
}

/// Two bumpy tori of 2·n² triangles each, the second smaller, among and around the first.
pub(crate) fn tori(name: &str, n: usize) -> Result<Pair> {
    tori_with(name, n, &BUMPS_A, &BUMPS_B)
}

/// As [`tori`], without bumps.
pub(crate) fn smooth_tori(name: &str, n: usize) -> Result<Pair> {
    tori_with(name, n, &[], &[])
}

fn tori_with(name: &str, n: usize, bumps_a: &[[f64; 3]], bumps_b: &[[f64; 3]]) -> Result<Pair> {
    let a = torus(n, 1.0, 0.35, bumps_a)?;
    let b = torus(n, 0.7, 0.25, bumps_b)?;
    let mut pair = Pair { name: name.to_owned(), bounds: a.aabb(), a, b };
    pair.bounds = pair.bounds.enlarged(pair.radius());
    Ok(pair)
}

/// A torus about Z with waves on it, 2·n² triangles.
fn torus(n: usize, ring: f64, tube: f64, bumps: &[[f64; 3]]) -> Result<TriMesh> {
    let angle = |i: usize| i as f64 * TAU / n as f64;
    let point = |i: usize, j: usize| {
        let (u, v) = (angle(i), angle(j));
        let waves: f64 = bumps.iter().map(|[height, p, q]| height * mp_math::sin(p * u + q * v)).sum();
        let r = tube * (1.0 + waves);
        let from_axis = ring + r * mp_math::cos(v);
        Point3::new(from_axis * mp_math::cos(u), from_axis * mp_math::sin(u), r * mp_math::sin(v))
    };
    let vertices = (0..n).flat_map(|i| (0..n).map(move |j| point(i, j))).collect();
    let index = |i: usize, j: usize| (i % n * n + j % n) as u32;
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let (a, b, c, d) = (index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1));
        [[a, b, c], [a, c, d]]
    });
    TriMesh::new(vertices, triangles.collect()).into_error()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_can_be_had_and_is_always_the_same() {
        for name in PAIRS {
            let pair = Pair::load(name).unwrap();
            assert!(pair.radius() > 0.0 && pair.bounds.volume() > 0.0, "{name}");
            assert_eq!(pair, Pair::load(name).unwrap());
        }
        assert!(Pair::load("beta").unwrap_err().to_string().contains("alpha"));
    }

    #[test]
    fn tori_are_closed_and_of_the_size_asked_for() {
        let pair = tori("t", 20).unwrap();
        for mesh in [&pair.a, &pair.b] {
            assert_eq!(mesh.triangles().len(), 800);
            assert!(mesh.topology().is_solid());
        }
    }
}
