//! The path: copies of the robot along it, and the line its origin traces.

use super::camera::Camera;
use super::canvas::{Layer, Veil, mix, scaled, srgb};
use super::decorate::nearer;
use super::model::{Lights, Model};
use super::raster::line;
use super::{INK, Shown, gradient};
use nalgebra::{Isometry3, Point3};

/// Opacity of one copy.
const COPY: f32 = 0.42;

/// How far a point of the robot may move between two poses, metres.
fn travel(robot: &Model, a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.translation.vector - b.translation.vector).norm() + robot.radius * a.rotation.angle_to(&b.rotation)
}

/// Places spread evenly along edges of these lengths, about `spacing` apart: the index of an edge and a fraction
/// of it. None on a path that stays put.
pub(crate) fn evenly(lengths: &[f64], spacing: f64) -> Vec<(usize, f64)> {
    let mut at = vec![0.0];
    for length in lengths {
        at.push(at[at.len() - 1] + length);
    }
    let total = at[at.len() - 1];
    if lengths.is_empty() || total.is_nan() || total <= 0.0 {
        return Vec::new();
    }
    let n = (total / spacing.max(1e-9)).clamp(12.0, 70.0) as usize;
    let mut segment = 0;
    let place = |i: usize| {
        let s = total * i as f64 / n as f64;
        while segment + 2 < at.len() && at[segment + 1] < s {
            segment += 1;
        }
        let length = at[segment + 1] - at[segment];
        let t = if length > 0.0 { ((s - at[segment]) / length).clamp(0.0, 1.0) } else { 0.0 };
        (segment, t)
    };
    (1..n).map(place).collect()
}

/// A rigid robot on its way along `path`, spread evenly by how far it moves.
pub(super) fn copies(robot: &Shown, path: &[Isometry3<f64>]) -> Vec<Shown> {
    let lengths: Vec<f64> = path.windows(2).map(|w| travel(&robot.model, &w[0], &w[1])).collect();
    let places = evenly(&lengths, 0.55 * robot.model.radius).into_iter();
    places
        .map(|(segment, t)| {
            let (a, b) = (&path[segment], &path[segment + 1]);
            robot.at(a.try_lerp_slerp(b, t, 1e-12).unwrap_or(if t < 0.5 { *a } else { *b }))
        })
        .collect()
}

/// Draws the copies as a veil over `layer`.
pub(crate) fn draw(layer: &mut Layer, camera: &Camera, lights: &Lights, copies: &[Shown]) {
    let samples = layer.key.len();
    let mut veil = Veil::new(samples);
    // One copy at a time, so that of each only the surface seen counts.
    let mut one = Layer::new(samples);
    let mut touched: Vec<u32> = Vec::new();
    for (n, Shown { model: robot, pose }) in copies.iter().enumerate() {
        let colour = gradient((n + 1) as f32 / (copies.len() + 1) as f32);
        robot.faces(camera, pose, lights, |i, key, light| {
            if one.key[i] == f32::INFINITY {
                touched.push(i as u32);
            }
            one.put(i, key, scaled(colour, light));
        });
        robot.edges(camera, pose, 0.7, |i, key, coverage| {
            if one.key[i] < f32::INFINITY && nearer(key, one.key[i]) {
                one.colour[i] = mix(one.colour[i], scaled(colour, 0.15), 0.9 * coverage);
            }
        });
        for i in touched.drain(..).map(|i| i as usize) {
            if one.key[i] < layer.key[i] {
                // Nearer copies count for more.
                veil.add(i, one.colour[i], COPY, camera.prominence(one.key[i]));
            }
            one.key[i] = f32::INFINITY;
        }
    }
    veil.over(&mut layer.colour, 0.88);
}

/// Draws the way of a point of the robot; faint where something hides it.
pub(crate) fn trace(layer: &mut Layer, camera: &Camera, path: &[Point3<f64>]) {
    let mut strength = vec![0.0f32; layer.key.len()];
    for w in path.windows(2) {
        let [a, b] = [&w[0], &w[1]].map(|p| camera.pose_cw * p);
        line(camera, &a, &b, 1.8, |i, key, coverage| {
            let seen = if nearer(key, layer.key[i]) { 0.95 } else { 0.3 };
            strength[i] = strength[i].max(seen * coverage);
        });
    }
    let ink = srgb(INK);
    for (c, s) in layer.colour.iter_mut().zip(strength) {
        *c = mix(*c, ink, s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp::geom::TriMesh;

    #[test]
    fn copies_are_evenly_spread() {
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point3::from).to_vec();
        let mesh = TriMesh::new(corners, vec![[0, 1, 2]]).unwrap();
        let robot = Shown::new(Some(&mesh), Isometry3::identity());
        let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
        let copies = copies(&robot, &[at(0.0), at(1.0), at(1.0), at(10.0)]);
        assert_eq!(copies.len(), 17);
        let first = copies[0].pose.translation.x;
        for (i, c) in copies.iter().enumerate() {
            assert!((c.pose.translation.x - (i + 1) as f64 * first).abs() < 1e-9);
        }
        assert!(super::copies(&robot, &[at(1.0), at(1.0)]).is_empty());
        assert!(super::copies(&robot, &[]).is_empty());
    }
}
