//! Four scenes in the spirit of the four samples of GEMPA (Benitez and Mugarte 2009): a tetrahedron, a
//! cube, an angular robot in a narrow corridor, and a bar among several narrow corridors.
//!
//! Each mixes meshes in `.txt` and `.off`.

use super::scene::{Files, HOME, QUARTER, Scene};
use super::shape::{ball, block, cells, cylinder, lathe, mesh, plan};
use mp_geom::TriMesh;
use nalgebra::Point3;

/// Adds the four scenes.
pub(super) fn add(files: &mut Files) {
    tetrahedron(files);
    cube(files);
    corridor(files);
    laminas(files);
}

fn regular_tetrahedron(edge: f64) -> TriMesh {
    let a = edge / 8f64.sqrt();
    let corners = [[a, a, a], [a, -a, -a], [-a, a, -a], [-a, -a, a]];
    mesh(corners.map(Point3::from).to_vec(), vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
}

/// A tetrahedron flies through a garden of columns, cones and spheres.
fn tetrahedron(files: &mut Files) {
    let base = block([-6.2, -4.2, -0.4], [6.2, 4.2, 0.0]);
    let column = cylinder(0.55, 5.0, 24);
    let cone = lathe(&[[0.0, 0.0], [1.5, 0.0], [0.0, 4.4]], 32);
    let ball = ball(1.25, 32, 16);
    let beam = block([-0.35, -3.6, -0.35], [0.35, 3.6, 0.35]);
    Scene::new(
        "gempa-1",
        [[-5.5, -3.5, 0.0], [5.5, 3.5, 5.0]],
        "gempa/tetrahedron.txt",
        &regular_tetrahedron(1.9),
    )
    .query([-4.6, -2.2, 1.2, 0.0, 0.0, 0.0], [4.6, 2.2, 1.2, 2.1, 0.6, 1.2])
    .obstacle("gempa/base.txt", &base, &[HOME])
    .obstacle(
        "gempa/column.off",
        &column,
        &[
            [-2.6, 2.4, 0.0, 0.0, 0.0, 0.0],
            [-2.6, -0.4, 0.0, 0.0, 0.0, 0.0],
            [-2.6, -3.2, 0.0, 0.0, 0.0, 0.0],
            [2.6, 3.2, 0.0, 0.0, 0.0, 0.0],
            [2.6, 0.4, 0.0, 0.0, 0.0, 0.0],
            [2.6, -2.4, 0.0, 0.0, 0.0, 0.0],
        ],
    )
    .obstacle("gempa/cone.off", &cone, &[[0.0, -2.2, 0.0, 0.0, 0.0, 0.0], [0.0, 2.2, 0.0, 0.0, 0.0, 0.0]])
    .obstacle(
        "gempa/ball.txt",
        &ball,
        &[[0.0, 0.0, 3.4, 0.0, 0.0, 0.0], [4.6, -1.8, 1.6, 0.0, 0.0, 0.0], [-4.6, 1.8, 2.6, 0.0, 0.0, 0.0]],
    )
    .obstacle("gempa/beam.txt", &beam, &[[-2.6, 0.0, 4.9, 0.0, 0.0, 0.0], [2.6, 0.0, 4.9, 0.0, 0.0, 0.0]])
    .finish(files);
}

/// A cube passes the openings of three walls, each too small to pass when turned.
fn cube(files: &mut Files) {
    let h = 0.5;
    let window = |y: f64, z: f64, w: f64| {
        cells(&[-0.15, 0.15], &[-4.5, y - w, y + w, 4.5], &[0.0, z - w, z + w, 5.0], |_, j, k| {
            j != 1 || k != 1
        })
    };
    let floor = block([-7.0, -4.5, -0.3], [7.0, 4.5, 0.0]);
    Scene::new("gempa-2", [[-6.0, -3.5, 0.0], [6.0, 3.5, 4.4]], "gempa/cube.txt", &block([-h; 3], [h; 3]))
        .query([-5.2, 0.0, 1.2, 0.0, 0.0, 0.0], [5.2, 0.0, 3.0, 0.8, 0.0, 0.0])
        .obstacle("gempa/floor.txt", &floor, &[HOME])
        .obstacle("gempa/window_low.off", &window(-2.4, 1.4, 0.95), &[[-3.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
        .obstacle("gempa/window_high.off", &window(2.2, 3.3, 0.9), &[HOME])
        .obstacle("gempa/window_middle.off", &window(-1.2, 1.8, 0.85), &[[3.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
        .finish(files);
}

/// An angular robot finds its way through a narrow corridor with a bend.
fn corridor(files: &mut Files) {
    // Arms of 2.0 and 1.2; the origin lies inside the bend.
    let robot = cells(&[-0.2, 0.2, 1.8], &[-0.2, 0.2, 1.0], &[-0.2, 0.2], |i, j, _| i == 0 || j == 0);
    let width = 1.0;
    let upper = block([-5.0, 0.5 * width, 0.0], [1.0, 4.0, 3.0]);
    let lower = plan(&[".#", "##"], &[-1.0, 1.0 + width, 5.0], &[-4.0, -0.5 * width, 1.4], 0.0, 3.0);
    let tray = block([-5.2, -4.2, -0.3], [5.2, 4.2, 0.0]);
    Scene::new("gempa-3", [[-4.8, -3.8, 0.0], [4.8, 3.8, 2.8]], "gempa/robot_angular.txt", &robot)
        .query([-4.0, -2.6, 0.8, 0.0, 0.0, 0.0], [3.4, 2.6, 0.8, QUARTER, 0.0, 0.0])
        .obstacle("gempa/tray.txt", &tray, &[HOME])
        .obstacle("gempa/corridor_upper.txt", &upper, &[HOME])
        .obstacle("gempa/corridor_lower.off", &lower, &[HOME])
        .finish(files);
}

/// A slab winds its way between thin, long laminas.
fn laminas(files: &mut Files) {
    let robot = block([-0.6, -0.15, -0.4], [0.6, 0.15, 0.4]);
    let lamina = block([-3.1, -0.05, 0.0], [3.1, 0.05, 3.0]);
    let tray = cells(&[-4.8, -4.6, 4.6, 4.8], &[-4.4, 4.4], &[-0.3, 0.0, 3.0], |i, _, k| k == 0 || i != 1);
    let gap = 1.3;
    let rows: Vec<_> = (0..4)
        .map(|i| [if i % 2 == 0 { -1.5 } else { 1.5 }, gap * (f64::from(i) - 1.5), 0.0, 0.0, 0.0, 0.0])
        .collect();
    Scene::new("gempa-4", [[-4.4, -4.0, 0.0], [4.4, 4.0, 2.8]], "gempa/robot_slab.txt", &robot)
        .query([-2.0, -3.2, 1.0, 0.0, 0.0, 0.0], [2.0, 3.2, 1.8, QUARTER, 0.0, QUARTER])
        .obstacle("gempa/bench.off", &tray, &[HOME])
        .obstacle("gempa/bench_lamina.txt", &lamina, &rows)
        .finish(files);
}
