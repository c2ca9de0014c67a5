//! Everything around the bodies: background, floor grid, outlines and lettering.

use crate::body::Body;
use crate::camera::Camera;
use crate::canvas::{Colour, Layer, Veil, mix, scaled, srgb};
use crate::cutaway::Cutaway;
use crate::palette::{GOAL, INK, OBSTACLES, START, gradient};
use crate::raster::line;
use crate::scene::{Scene, corners};
use crate::text;
use mp_geom::Aabb;
use nalgebra::Point3;

/// Whether a line at `key` lies on or before a surface at `surface`, with some tolerance in favour of the
/// line.
pub(crate) fn nearer(key: f32, surface: f32) -> bool {
    key - 2e-3 * key.abs() < surface
}

/// Fills the layer with a gradient from white at the top to grey at the bottom.
pub(crate) fn background(layer: &mut Layer, (width, height): (usize, usize)) {
    let (top, bottom) = (srgb(0xffffff), srgb(0xe9edf2));
    for (y, row) in layer.colour.chunks_mut(width).enumerate() {
        row.fill(mix(top, bottom, y as f32 / height as f32));
    }
}

/// Lines of fine meshes would cover everything: their strength is less.
fn fineness(edges: &[[u32; 2]]) -> f32 {
    (4000.0 / edges.len().max(1) as f32).clamp(0.25, 1.0)
}

/// Draws dark lines along the edges of a body.
pub(crate) fn outline(layer: &mut Layer, camera: &Camera, body: &Body, strength: f32) {
    let ink = srgb(INK);
    body.model.lines(&body.model.edges, camera, &body.pose_wb, 0.6, |i, key, coverage| {
        if nearer(key, layer.key[i]) {
            layer.colour[i] = mix(layer.colour[i], ink, strength * coverage);
        }
    });
}

/// Draws all edges of a body without its faces. `seen` and `hidden` are the strengths before and behind the
/// surfaces of the layer; edges between faces that meet nearly flat are fainter.
pub(crate) fn wires(
    layer: &mut Layer,
    camera: &Camera,
    body: &Body,
    colour: Colour,
    [seen, hidden]: [f32; 2],
) {
    let model = &body.model;
    let (sharp, flat) = (fineness(&model.edges), 0.3 * fineness(&model.inner));
    let mut draw = |share: f32, i: usize, key: f32, coverage: f32| {
        let strength = if nearer(key, layer.key[i]) { seen } else { hidden };
        layer.colour[i] = mix(layer.colour[i], colour, share * strength * coverage);
    };
    model.lines(&model.inner, camera, &body.pose_wb, 0.6, |i, key, coverage| draw(flat, i, key, coverage));
    model.lines(&model.edges, camera, &body.pose_wb, 0.8, |i, key, coverage| draw(sharp, i, key, coverage));
}

/// Draws the edges of obstacles: dark where they are opaque, faint where `cut` opens them.
pub(crate) fn outlines(
    layer: &mut Layer,
    ghosts: &mut Veil,
    camera: &Camera,
    obstacles: &[Body],
    cut: &Cutaway,
) {
    let ink = srgb(INK);
    for (n, o) in obstacles.iter().enumerate() {
        let strength = 0.5 * fineness(&o.model.edges);
        let faint = scaled(srgb(OBSTACLES[n % OBSTACLES.len()]), 0.4);
        o.model.lines(&o.model.edges, camera, &o.pose_wb, 0.6, |i, key, coverage| {
            if !nearer(key, layer.key[i]) {
                return;
            }
            match cut.at(i, camera.depth(key)) {
                0.0 => layer.colour[i] = mix(layer.colour[i], ink, strength * coverage),
                _ => ghosts.add(i, faint, 0.9 * strength * coverage, 3.0),
            }
        });
    }
}

/// 1, 2 or 5 times a power of ten, at most `length`.
fn round_length(length: f64) -> f64 {
    let power = mp_math::powf(10.0, mp_math::log10(length).floor());
    [5.0, 2.0, 1.0].into_iter().map(|d| d * power).find(|d| *d <= length).unwrap_or(power)
}

/// Draws a grid under the scene.
pub(crate) fn floor(layer: &mut Layer, camera: &Camera, frame: &[Point3<f64>]) {
    let (lo, hi) = corners(frame);
    let size = (hi.x - lo.x).max(hi.y - lo.y);
    // Powers of ten near zero underflow.
    if size < 1e-200 {
        return;
    }
    let cell = round_length(size / 6.0);
    let z = lo.z - 1e-3 * size;
    let cells = |lo: f64, hi: f64| (lo / cell).floor() as i64..=(hi / cell).ceil() as i64;
    let (xs, ys) = (cells(lo.x, hi.x), cells(lo.y, hi.y));
    let at = |i: i64, j: i64| camera.pose_cw * Point3::new(i as f64 * cell, j as f64 * cell, z);
    let mut lines = Vec::new();
    lines.extend(xs.clone().map(|i| (at(i, *ys.start()), at(i, *ys.end()))));
    lines.extend(ys.clone().map(|j| (at(*xs.start(), j), at(*xs.end(), j))));
    let ink = srgb(0x9aa5b3);
    for (a, b) in lines {
        line(camera, &a, &b, 0.6, |i, key, coverage| {
            if key < layer.key[i] {
                layer.colour[i] = mix(layer.colour[i], ink, 0.5 * coverage);
            }
        });
    }
}

/// Draws the bounds of a planar scene.
pub(crate) fn border(layer: &mut Layer, camera: &Camera, bounds: &Aabb) {
    let (lo, hi) = (&bounds.min, &bounds.max);
    let rim = [(lo.x, lo.y), (hi.x, lo.y), (hi.x, hi.y), (lo.x, hi.y)];
    let ink = srgb(0x9aa5b3);
    for k in 0..4 {
        let [a, b] = [rim[k], rim[(k + 1) % 4]].map(|(x, y)| camera.pose_cw * Point3::new(x, y, lo.z));
        line(camera, &a, &b, 1.0, |i, key, coverage| {
            if key < layer.key[i] {
                layer.colour[i] = mix(layer.colour[i], ink, 0.8 * coverage);
            }
        });
    }
}

/// Writes the title at the top and the legend of the colours at the bottom.
pub(crate) fn labels(layer: &mut Layer, size: (usize, usize), scene: &Scene) {
    let (w, h) = (size.0 as f32, size.1 as f32);
    let unit = h / 960.0;
    let mut write = |words: &str, x: f32, y: f32, height: f32, bold: f32, colour| {
        text::write(size, words, (x, y), height, bold, |i, coverage| {
            layer.colour[i] = mix(layer.colour[i], colour, coverage);
        });
    };
    let (ink, grey) = (srgb(INK), srgb(0x66717f));
    write(&scene.title, 28.0 * unit, 44.0 * unit, 19.0 * unit, 1.25, ink);
    write(&scene.subtitle, 28.0 * unit, 70.0 * unit, 11.5 * unit, 1.0, grey);
    if scene.start.is_none() && scene.goal.is_none() {
        return;
    }
    let (y, cap) = (h - 26.0 * unit, 11.5 * unit);
    let bar = 120.0 * unit;
    let has_path = !scene.trace.is_empty();
    let words = [text::width("start", cap), text::width("goal", cap)];
    let gap = 10.0 * unit;
    let total = words[0] + words[1] + 2.0 * gap + bar;
    let left = w - 28.0 * unit - total;
    write("start", left, y, cap, 1.0, ink);
    write("goal", left + words[0] + 2.0 * gap + bar, y, cap, 1.0, ink);
    let x0 = left + words[0] + gap;
    let (top, bottom) = ((y - cap) as usize, y as usize);
    for column in 0..bar as usize {
        let t = column as f32 / bar;
        let colour = match (has_path, t) {
            (true, t) => gradient(t),
            (false, t) if t < 0.15 => srgb(START),
            (false, t) if t > 0.85 => srgb(GOAL),
            _ => continue,
        };
        for row in top..bottom {
            let i = row * size.0 + x0 as usize + column;
            if let Some(c) = layer.colour.get_mut(i) {
                *c = colour;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_rounded_down_to_one_two_or_five() {
        for (given, round) in [(1.0, 1.0), (1.99, 1.0), (2.1, 2.0), (7.0, 5.0), (0.034, 0.02), (640.0, 500.0)]
        {
            assert!((round_length(given) - round).abs() < 1e-12 * round, "{given}");
        }
    }
}
