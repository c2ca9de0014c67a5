//! What the tests share: random meshes and poses, and the same in parry.

use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::shape;
use rand::{RngExt, SeedableRng};
pub(crate) use rand_pcg::Pcg64;

pub(crate) fn rng(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

/// How many of `all` cases a test takes: under valgrind, which takes a hundred times as long, a tenth (`cargo xtask memcheck` says so).
pub(crate) fn cases_of(all: usize) -> usize {
    if std::env::var_os("MP_MEMCHECK").is_some() { all.div_ceil(10) } else { all }
}

pub(crate) fn point(rng: &mut Pcg64, size: f64) -> Point3<f64> {
    Point3::from([0; 3].map(|_| rng.random_range(-size..size)))
}

/// `n` triangles of edge length about `edge` scattered within `size`.
pub(crate) fn soup(rng: &mut Pcg64, n: usize, size: f64, edge: f64) -> TriMesh {
    let mut vertices = Vec::new();
    for _ in 0..n {
        let at = point(rng, size);
        vertices.extend([0; 3].map(|_| at + point(rng, edge).coords));
    }
    TriMesh::new(vertices, (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

/// A bumpy sphere of 2·n·(n − 1) triangles.
pub(crate) fn bumpy(n: usize, radius: f64, bump: f64) -> TriMesh {
    let at = |i: usize, j: usize| {
        let (u, v) =
            (std::f64::consts::PI * i as f64 / n as f64, std::f64::consts::TAU * j as f64 / n as f64);
        let r = radius * (1.0 + bump * mp_math::sin(5.0 * u) * mp_math::cos(7.0 * v));
        Point3::new(
            r * mp_math::sin(u) * mp_math::cos(v),
            r * mp_math::sin(u) * mp_math::sin(v),
            r * mp_math::cos(u),
        )
    };
    let vertices = (0..=n).flat_map(|i| (0..n).map(move |j| at(i, j))).collect();
    let index = |i: usize, j: usize| (i * n + j % n) as u32;
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..n {
            if i > 0 {
                triangles.push([index(i, j), index(i + 1, j), index(i, j + 1)]);
            }
            if i + 1 < n {
                triangles.push([index(i, j + 1), index(i + 1, j), index(i + 1, j + 1)]);
            }
        }
    }
    TriMesh::new(vertices, triangles).unwrap()
}

/// The box from −half to half, 12 triangles.
pub(crate) fn cuboid(half: Vector3<f64>) -> TriMesh {
    let corner = |i: usize| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        Point3::new(half.x * sign(0), half.y * sign(1), half.z * sign(2))
    };
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh::new((0..8).map(corner).collect(), triangles).unwrap()
}

pub(crate) fn rotation(rng: &mut Pcg64) -> UnitQuaternion<f64> {
    loop {
        let q = nalgebra::Quaternion::from([0; 4].map(|_| rng.random_range(-1.0..1.0_f64)));
        if (0.01..1.0).contains(&q.norm_squared()) {
            return UnitQuaternion::from_quaternion(q);
        }
    }
}

pub(crate) fn pose(rng: &mut Pcg64, size: f64) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(point(rng, size).coords), rotation(rng))
}

pub(crate) fn point_to_parry(point: &Point3<f64>) -> Vector {
    Vector::new(point.x, point.y, point.z)
}

/// The same pose, to the bit.
pub(crate) fn pose_to_parry(pose: &Isometry3<f64>) -> Pose {
    let q = pose.rotation.quaternion();
    let rotation = Rotation::from_xyzw(q.i, q.j, q.k, q.w);
    Pose::from_parts(point_to_parry(&pose.translation.vector.into()), rotation)
}

pub(crate) fn mesh_to_parry(mesh: &TriMesh) -> shape::TriMesh {
    let vertices = mesh.vertices().iter().map(point_to_parry).collect();
    shape::TriMesh::new(vertices, mesh.triangles().to_vec()).unwrap()
}
