//! The path: copies of the robot along it, and the line along which a point of the robot moves.

use crate::body::Body;
use crate::camera::Camera;
use crate::canvas::{Colour, Layer, Veil, mix, scaled, srgb};
use crate::decorate::nearer;
use crate::lights::Lights;
use crate::model::Model;
use crate::palette::{INK, gradient};
use crate::raster::line;
use mp_geom::evenly;
use nalgebra::{Isometry3, Point3};

/// Opacity of one copy.
const COPY: f32 = 0.42;

/// An upper bound of how far a point of the robot moves between two poses, metres.
fn travel(robot: &Model, a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.translation.vector - b.translation.vector).norm() + robot.radius * a.rotation.angle_to(&b.rotation)
}

impl Body {
    /// Copies of the body along `path`, poses in the world, evenly spaced by how far the body moves; its own
    /// pose does not matter. There are none on a path that does not move.
    #[must_use]
    pub fn along(&self, path: &[Isometry3<f64>]) -> Vec<Body> {
        let lengths: Vec<f64> = path.windows(2).map(|w| travel(&self.model, &w[0], &w[1])).collect();
        let places = evenly(&lengths, 0.55 * self.radius()).into_iter();
        places
            .map(|(segment, t)| {
                let (a, b) = (&path[segment], &path[segment + 1]);
                self.at(a.try_lerp_slerp(b, t, 1e-12).unwrap_or(if t < 0.5 { *a } else { *b }))
            })
            .collect()
    }
}

/// The copies of the robot along the path, with their colours.
pub(crate) fn coloured(copies: &[Body]) -> Vec<(&Body, Colour)> {
    let colour = |n: usize| gradient((n + 1) as f32 / (copies.len() + 1) as f32);
    copies.iter().enumerate().map(|(n, body)| (body, colour(n))).collect()
}

/// Draws translucent copies over `layer`.
pub(crate) fn draw_copies(layer: &mut Layer, camera: &Camera, lights: &Lights, copies: &[(&Body, Colour)]) {
    let samples = layer.key.len();
    let mut veil = Veil::new(samples);
    // One copy at a time, so that only the visible surface of each counts.
    let mut one = Layer::new(samples);
    let mut touched: Vec<u32> = Vec::new();
    for &(Body { model: robot, pose_wb }, colour) in copies {
        robot.faces(camera, pose_wb, lights, |i, key, light| {
            if one.key[i] == f32::INFINITY {
                touched.push(i as u32);
            }
            one.put(i, key, scaled(colour, light));
        });
        robot.lines(&robot.edges, camera, pose_wb, 0.7, |i, key, coverage| {
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

/// Draws the line of a point of the robot; faint where something hides it.
pub(crate) fn draw_trace(layer: &mut Layer, camera: &Camera, path: &[Point3<f64>]) {
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
    use mp_geom::TriMesh;

    #[test]
    fn copies_are_evenly_spread() {
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point3::from).to_vec();
        let mesh = TriMesh::new(corners, vec![[0, 1, 2]]).unwrap();
        let robot = Body::new(&mesh, Isometry3::identity());
        let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
        let copies = robot.along(&[at(0.0), at(1.0), at(1.0), at(10.0)]);
        assert_eq!(copies.len(), 17);
        let first = copies[0].pose().translation.x;
        for (i, c) in copies.iter().enumerate() {
            assert!((c.pose().translation.x - (i + 1) as f64 * first).abs() < 1e-9);
        }
        assert!(robot.along(&[at(1.0), at(1.0)]).is_empty());
        assert!(robot.along(&[]).is_empty());
    }
}
