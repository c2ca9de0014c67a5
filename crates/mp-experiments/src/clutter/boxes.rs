//! Worlds of random boxes: the first n obstacles of an instance are those of its problem with n obstacles.

use crate::Result;
use mp_cspace::{Rng, So3, Space};
use mp_geom::{TriMesh, primitives::cuboid};
use nalgebra::{Isometry3, Translation3, Vector3};
use rand::RngExt;

/// A named box, in the frame of its pose in the world.
pub type Obstacle = (String, TriMesh, Isometry3<f64>);

/// Numbers of obstacles (§4).
pub const LEVELS: [usize; 9] = [2, 4, 8, 16, 32, 64, 128, 256, 512];

/// The region and the sizes of the boxes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    /// Corners of the region of their centres, metres.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    /// Least and greatest length of a side, metres.
    pub(super) sides: (f64, f64),
}

/// `count` boxes, each of uniform rotation, position and sides; those that `allowed` refuses, such as boxes
/// at the start, are drawn again.
pub(super) fn boxes(
    region: &Region,
    count: usize,
    instance: u64,
    mut allowed: impl FnMut(&Obstacle) -> Result<bool>,
) -> Result<Vec<Obstacle>> {
    let mut rng = Rng::stream(2008, instance);
    let mut all = Vec::with_capacity(count);
    while all.len() < count {
        let sides = [(); 3].map(|()| rng.random_range(region.sides.0..=region.sides.1));
        let place = Vector3::from_fn(|i, _| rng.random_range(region.low[i]..=region.high[i]));
        let rotation = So3.sample_uniform(&mut rng);
        let mesh = cuboid(sides[0], sides[1], sides[2])?;
        let pose = Isometry3::from_parts(Translation3::from(place), rotation);
        let obstacle = (format!("box {}", all.len() + 1), mesh, pose);
        if allowed(&obstacle)? {
            all.push(obstacle);
        }
    }
    Ok(all)
}
