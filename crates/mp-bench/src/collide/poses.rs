//! The poses at which the pairs are measured: uniform, near contact, and along edges.

use super::pairs::Pair;
use crate::error::{IntoError, Result};
use mp_collide::{CollisionMesh, Query};
use mp_cspace::{Rng, Se3, Space};
use mp_plan::Error;
use nalgebra::Isometry3;

/// Poses of one edge.
pub(crate) const EDGE: usize = 40;
/// The most that a point of the robot moves from one pose of an edge to the next, in radii of the robot.
pub(crate) const STEP: f64 = 0.02;
/// The distances of near poses from the border between free and colliding, in radii of the robot, each for
/// half of them.
pub(crate) const WIDTHS: [f64; 2] = [1e-2, 1e-4];
/// At most this number of uniform poses are drawn to find a free one, or one that collides.
const DRAWS: usize = 1_000_000;

/// The most bisections: after these, the interval is empty in `f64`.
const HALVINGS: usize = 100;

/// The numbers of poses and edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) uniform: usize,
    pub(crate) near: usize,
    pub(crate) edges: usize,
}

impl Counts {
    /// The counts that other programs expect.
    pub(crate) const FULL: Self = Self { uniform: 10_000, near: 10_000, edges: 500 };
}

/// The poses of the robot at which a pair is measured.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct QueryPoses {
    /// Uniform in the bounds.
    pub(crate) uniform: Vec<Isometry3<f64>>,
    /// Nearer to the border between free and colliding than [`WIDTHS`], half on either side.
    pub(crate) near: Vec<Isometry3<f64>>,
    /// [`EDGE`] poses each, [`STEP`] apart, straight from a free uniform pose towards another uniform one.
    pub(crate) edges: Vec<Isometry3<f64>>,
}

impl QueryPoses {
    /// The poses of `pair` that `seed` gives.
    ///
    /// # Errors
    /// When nearly every pose of the pair is free, or nearly every pose collides.
    pub(crate) fn new(pair: &Pair, meshes: &Meshes, counts: Counts, seed: u64) -> Result<Self> {
        let space = Se3::new(pair.bounds.min.coords, pair.bounds.max.coords).into_error()?;
        let mut rng = Rng::stream(seed, 0);
        let uniform = (0..counts.uniform).map(|_| space.sample_uniform(&mut rng)).collect();
        let mut border = Border::new(pair, meshes, Rng::stream(seed, 1))?;
        let near = (0..counts.near)
            .map(|i| {
                let ends = border.bisected(&[WIDTHS[i % 2] * border.radius])?;
                Ok(ends[0][i / 2 % 2])
            })
            .collect::<Result<_>>()?;
        border.rng = Rng::stream(seed, 2);
        let mut edges = Vec::with_capacity(EDGE * counts.edges);
        for _ in 0..counts.edges {
            edges.extend(border.edge()?);
        }
        Ok(Self { uniform, near, edges })
    }
}

/// The trees of a pair.
#[derive(Clone, Debug)]
pub(crate) struct Meshes {
    pub(crate) a: CollisionMesh,
    pub(crate) b: CollisionMesh,
}

impl Meshes {
    pub(crate) fn new(pair: &Pair) -> Self {
        Self { a: CollisionMesh::new(&pair.a), b: CollisionMesh::new(&pair.b) }
    }

    /// Whether the robot at `pose` collides.
    pub(crate) fn collide(&self, query: &mut Query, pose: &Isometry3<f64>) -> bool {
        query.intersects(&self.a, &Isometry3::identity(), &self.b, pose)
    }
}

/// Finds poses at the border between free and colliding.
pub(crate) struct Border<'p> {
    pair: &'p Pair,
    /// Of the robot, metres.
    radius: f64,
    meshes: &'p Meshes,
    space: Se3,
    query: Query,
    rng: Rng,
}

impl<'p> Border<'p> {
    /// A search that draws from `rng`.
    pub(crate) fn new(pair: &'p Pair, meshes: &'p Meshes, rng: Rng) -> Result<Self> {
        let space = Se3::new(pair.bounds.min.coords, pair.bounds.max.coords).into_error()?;
        Ok(Self { pair, radius: pair.radius(), meshes, space, query: Query::default(), rng })
    }

    /// A free and a colliding pose on a random line for each of `widths` (metres, descending): between the
    /// two no point of the robot moves by more than that width, or they are as near as `f64` allows.
    pub(crate) fn bisected(&mut self, widths: &[f64]) -> Result<Vec<[Isometry3<f64>; 2]>> {
        let mut ends = [self.draw(false)?, self.draw(true)?];
        let (mut found, mut widths) = (Vec::with_capacity(widths.len()), widths.iter().peekable());
        let mut halvings = 0;
        while let Some(&&width) = widths.peek() {
            if self.travel(&ends[0], &ends[1]) <= width || halvings == HALVINGS {
                found.push(ends);
                widths.next();
                continue;
            }
            let middle = between(&ends[0], &ends[1], 0.5);
            let side = usize::from(self.meshes.collide(&mut self.query, &middle));
            ends[side] = middle;
            halvings += 1;
        }
        Ok(found)
    }

    fn edge(&mut self) -> Result<[Isometry3<f64>; EDGE]> {
        let (from, towards) = (self.draw(false)?, self.space.sample_uniform(&mut self.rng));
        let step = STEP * self.radius / self.travel(&from, &towards);
        Ok(std::array::from_fn(|k| between(&from, &towards, k as f64 * step)))
    }

    /// An upper bound of how far a point of the robot moves between two poses.
    fn travel(&self, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
        let straight = (to.translation.vector - from.translation.vector).norm();
        straight + from.rotation.angle_to(&to.rotation) * self.radius
    }

    /// A uniform pose that collides, or is free.
    fn draw(&mut self, colliding: bool) -> Result<Isometry3<f64>> {
        for _ in 0..DRAWS {
            let pose = self.space.sample_uniform(&mut self.rng);
            if self.meshes.collide(&mut self.query, &pose) == colliding {
                return Ok(pose);
            }
        }
        let state = if colliding { "collides" } else { "is free" };
        Err(Error::new(format!("of {DRAWS} uniform poses of {}, none {state}", self.pair.name)))
    }
}

/// The pose at `t` on the straight motion between two poses. The rotation is normalized, as interpolation of
/// nearly equal rotations may change its norm.
fn between(from: &Isometry3<f64>, to: &Isometry3<f64>, t: f64) -> Isometry3<f64> {
    let mut pose = from.lerp_slerp(to, t);
    pose.rotation.renormalize();
    pose
}

#[cfg(test)]
mod tests {
    use super::super::pairs::tori;
    use super::*;

    const FEW: Counts = Counts { uniform: 100, near: 80, edges: 10 };

    #[test]
    fn poses_are_where_they_should_be() {
        let pair = tori("tori", 16).unwrap();
        let meshes = Meshes::new(&pair);
        let poses = QueryPoses::new(&pair, &meshes, FEW, 3).unwrap();
        assert_eq!(poses, QueryPoses::new(&pair, &meshes, FEW, 3).unwrap());
        assert_ne!(poses, QueryPoses::new(&pair, &meshes, FEW, 4).unwrap());
        let mut query = Query::default();
        let mut hits = |of: &[Isometry3<f64>]| of.iter().filter(|p| meshes.collide(&mut query, p)).count();
        assert_eq!(hits(&poses.near), FEW.near / 2);
        assert!((10..90).contains(&hits(&poses.uniform)));
        assert!(poses.uniform.iter().all(|p| pair.bounds.contains(&p.translation.vector.into())));
        for edge in poses.edges.chunks(EDGE) {
            assert_eq!(hits(&edge[..1]), 0);
            for two in edge.windows(2) {
                let moved = pair.b.vertices().iter().map(|v| (two[0] * v - two[1] * v).norm());
                assert!(moved.fold(0.0, f64::max) <= (STEP + 1e-9) * pair.radius());
            }
        }
    }

    #[test]
    fn near_poses_are_as_near_as_they_say() {
        let pair = tori("tori", 16).unwrap();
        let meshes = Meshes::new(&pair);
        let mut border = Border::new(&pair, &meshes, Rng::seed(5)).unwrap();
        let widths = [1e-2, 1e-4, 1e-9, 0.0];
        let mut query = Query::default();
        for (width, [free, colliding]) in widths.iter().zip(border.bisected(&widths).unwrap()) {
            assert!(!meshes.collide(&mut query, &free) && meshes.collide(&mut query, &colliding));
            assert!(border.travel(&free, &colliding) <= width.max(1e-14), "{width}");
            for pose in [free, colliding] {
                assert!((pose.rotation.norm() - 1.0).abs() < 1e-15);
            }
        }
    }
}
