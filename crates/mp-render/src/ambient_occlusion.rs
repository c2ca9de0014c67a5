//! Screen-space ambient occlusion: creases and corners are darker.

use crate::camera::Camera;
use crate::canvas::{Layer, scaled};

/// Darkens samples whose neighbours are nearer to the eye; `extent` is the size of the scene, metres.
pub(crate) fn darken_creases(layer: &mut Layer, camera: &Camera, extent: f64) {
    const PAIRS: usize = 6;
    let (w, h) = (camera.width as isize, camera.height as isize);
    let reach = 0.02 * extent as f32;
    // Spirals by the golden angle, turned differently for each of 4 × 4 samples to avoid visible patterns.
    let spirals: Vec<[(f32, f32); PAIRS]> = (0..16)
        .map(|turn| {
            std::array::from_fn(|k| {
                let r = (k as f32 + 0.25 + 0.5 * ((turn * 7 % 16) as f32 / 16.0)) / PAIRS as f32;
                let angle = 2.4 * k as f32 + std::f32::consts::TAU * (turn as f32 / 16.0);
                let (s, c) = mp_math::sin_cos(f64::from(angle));
                (r * c as f32, r * s as f32)
            })
        })
        .collect();
    let (colours, keys) = (&mut layer.colour, &layer.key);
    // How much nearer to the eye than `z` the sample at a place is, as a part of the reach.
    let lift = |z: f32, i: isize| {
        let key = keys[i as usize];
        if key == f32::INFINITY {
            return 0.0;
        }
        let lift = (z - camera.depth(key)) / reach;
        if lift > 2.0 { 0.3 } else { lift.clamp(-1.0, 1.0) }
    };
    for y in 0..h {
        for x in 0..w {
            let i = y * w + x;
            let key = keys[i as usize];
            if key == f32::INFINITY {
                continue;
            }
            let z = camera.depth(key);
            // Larger radii are off the picture.
            let radius = (reach / camera.sample_size(z)).min(1e6);
            let far = radius as isize + 1;
            let is_inside = x >= far && y >= far && x + far < w && y + far < h;
            let lift_at = |dx: isize, dy: isize| {
                let is_there = is_inside || (0..w).contains(&(x + dx)) && (0..h).contains(&(y + dy));
                if is_there { lift(z, i + dy * w + dx) } else { 0.0 }
            };
            let mut sum = 0.0;
            // Opposite samples are added: on a slanted plane they cancel.
            for (dx, dy) in &spirals[((y & 3) * 4 + (x & 3)) as usize] {
                let (dx, dy) = ((dx * radius) as isize, (dy * radius) as isize);
                sum += (lift_at(dx, dy) + lift_at(-dx, -dy)).max(0.0);
            }
            let shade = 1.0 - (0.55 * sum / PAIRS as f32).clamp(0.0, 0.4);
            colours[i as usize] = scaled(colours[i as usize], shade);
        }
    }
}
