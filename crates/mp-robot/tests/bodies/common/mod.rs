//! Scenes the tests share.

use mp_geom::{TriMesh, pose_from_six, primitives};
use nalgebra::Isometry3;

pub(crate) type Obstacle = (String, TriMesh, Isometry3<f64>);

pub(crate) fn obstacle(name: &str, mesh: TriMesh, six: [f64; 6]) -> Obstacle {
    (name.to_owned(), mesh, pose_from_six(six))
}

/// A wall across x = 0, wider than the space.
pub(crate) fn wall(thickness: f64) -> Obstacle {
    obstacle("wall", primitives::cuboid(thickness, 40.0, 40.0).unwrap(), [0.0; 6])
}

/// Various things in a box of ±2, one of them an open sheet.
pub(crate) fn clutter() -> Vec<Obstacle> {
    let sheet = primitives::cuboid(1.5, 1.5, 1.0).unwrap();
    let sheet = TriMesh::new(sheet.vertices().to_vec(), sheet.triangles()[..2].to_vec()).unwrap();
    vec![
        obstacle("box", primitives::cuboid(1.0, 0.5, 2.0).unwrap(), [1.0, 0.2, 0.0, 0.3, 0.1, 0.0]),
        obstacle("ring", primitives::torus(0.8, 0.2, 16, 8).unwrap(), [-0.9, 0.4, 0.1, 0.0, 1.2, 0.4]),
        obstacle("cone", primitives::cone(0.5, 1.2, 12).unwrap(), [0.2, -1.2, 0.0, 0.0, 0.0, 0.5]),
        obstacle("sheet", sheet, [-0.2, 1.4, 0.3, 0.5, 0.6, 0.0]),
    ]
}

/// A bent body whose origin is off its centre.
pub(crate) fn robot() -> TriMesh {
    let l = [(0.0, 0.0), (0.5, 0.0), (0.5, 0.1), (0.1, 0.1), (0.1, 0.4), (0.0, 0.4)];
    primitives::prism(&l.map(|(x, y)| nalgebra::Point2::new(x, y)), -0.1, 0.1).unwrap()
}
