//! Worlds of random boxes: the first n obstacles of an instance are those of its problem with n obstacles.

use crate::error::{IntoError, Result};
use mp_cspace::{Rng, So3, Space};
use mp_geom::{TriMesh, primitives::cuboid};
use nalgebra::{Isometry3, Translation3, Vector3};
use rand::RngExt;

/// A named box, in the frame of its pose in the world.
pub(super) type Obstacle = (String, TriMesh, Isometry3<f64>);

/// Numbers of obstacles (§4).
pub(super) const LEVELS: [usize; 9] = [2, 4, 8, 16, 32, 64, 128, 256, 512];

/// The region and the sizes of the boxes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    /// Corners of the region of their centres, metres.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    /// Least and greatest length of a side, metres.
    pub(super) sides: (f64, f64),
}

/// `count` boxes, each of uniform rotation, position and sides; those that `allowed` refuses, such as boxes at
/// the start, are drawn again.
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
        let mesh = cuboid(sides[0], sides[1], sides[2]).into_error()?;
        let pose = Isometry3::from_parts(Translation3::from(place), rotation);
        let obstacle = (format!("box {}", all.len() + 1), mesh, pose);
        if allowed(&obstacle)? {
            all.push(obstacle);
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_obstacles_are_the_same_and_some() {
        let region = Region { low: [0.0; 3], high: [10.0; 3], sides: (0.2, 0.8) };
        let far = |o: &Obstacle| Ok(o.2.translation.vector.norm() > 2.0);
        let (few, many) = (boxes(&region, 4, 7, far).unwrap(), boxes(&region, 32, 7, far).unwrap());
        assert_eq!(few.as_slice(), &many[..4]);
        assert!(many.iter().all(|o| o.2.translation.vector.norm() > 2.0));
        assert_ne!(few, boxes(&region, 4, 8, far).unwrap());
    }
}
