//! `nut-3`, `nut-6`: a nut comes off a bolt with a thread of three turns, or of six and with half the play.

use super::scene::{Files, HOME, Scene, Six};
use super::shape::{cylinder, mesh, shifted, union};
use mp_geom::TriMesh;
use nalgebra::Point3;
use std::f64::consts::TAU;

/// Radius of the bolt below its thread, depth and pitch of the thread.
const CORE: f64 = 0.5;
const DEPTH: f64 = 0.15;
const PITCH: f64 = 0.4;
/// Corners of a turn, and levels of a pitch: ridges run along diagonals.
const STEPS: u32 = 16;
/// Levels of the nut.
const NUT: u32 = 24;
/// Half the width of the nut.
const HALF: f64 = 0.8;

/// Adds both scenes: the turns of the bolt, and the distances between the threads, outwards and along.
pub(super) fn add(files: &mut Files) {
    let height = |levels: u32| PITCH * f64::from(levels) / f64::from(STEPS);
    let head = shifted(&cylinder(1.1, 0.45, STEPS), [0.0, 0.0, -0.4]);
    let half = 0.5 * height(NUT);
    let on_thread = |z: f64| -> Six { [0.0, 0.0, z, TAU * z / PITCH, 0.0, 0.0] };
    let end: Six = [2.5, 1.0, 4.0, 0.5, 1.0, 0.2];
    for (name, turns, out, along) in [("nut-3", 3, 0.1, 0.08), ("nut-6", 6, 0.05, 0.04)] {
        let bolt = solid_of_turns(turns * STEPS, 0.0, |_, u| thread(u, 0.0), None);
        let steps = (0..=8 * turns + 12).map(|i| on_thread(half + 0.15 + 0.05 * f64::from(i)));
        let path: Vec<Six> = steps.chain([end]).collect();
        let inside = |u: f64| thread(u, along) + out;
        let nut = solid_of_turns(NUT, -half, |angle, _| outside(angle), Some(&inside));
        Scene::new(name, [[-4.0, -4.0, -1.5], [4.0, 4.0, 5.5]], &format!("nut/{name}.off"), &nut)
            .solved_by(&path)
            .obstacle(&format!("nut/bolt-{turns}.off"), &union([bolt, head.clone()]), &[HOME])
            .finish(files);
    }
}

/// The radius of a thread at a part of the pitch from the middle of its ridge, which is `wider` to both sides.
fn thread(u: f64, wider: f64) -> f64 {
    let from_middle = (u - (u + 0.5).floor()).abs() - wider / PITCH;
    CORE + DEPTH * (2.0 - 8.0 * from_middle).clamp(0.0, 1.0)
}

/// The radius of a square nut.
fn outside(angle: f64) -> f64 {
    let (s, c) = mp_math::sin_cos(angle);
    HALF / s.abs().max(c.abs())
}

/// A solid about the z axis from `low` upwards: a radius outside, at an angle and a part of the pitch, and one inside if it is hollow.
fn solid_of_turns(
    levels: u32,
    low: f64,
    outside: impl Fn(f64, f64) -> f64,
    inside: Option<&dyn Fn(f64) -> f64>,
) -> TriMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let mut surface = |radius: &dyn Fn(f64, f64) -> f64| {
        for level in 0..=levels {
            let z = low + PITCH * f64::from(level) / f64::from(STEPS);
            for k in 0..STEPS {
                let part = f64::from(k) / f64::from(STEPS);
                let r = radius(TAU * part, z / PITCH - part);
                let (s, c) = mp_math::sin_cos(TAU * part);
                vertices.push(Point3::new(r * c, r * s, z));
            }
        }
    };
    surface(&outside);
    if let Some(inside) = inside {
        surface(&|_, u| inside(u));
    }
    let far = (levels + 1) * STEPS;
    let axis = vertices.len() as u32;
    if inside.is_none() {
        vertices.extend(
            [low, low + PITCH * f64::from(levels) / f64::from(STEPS)].map(|z| Point3::new(0.0, 0.0, z)),
        );
    }
    for k in 0..STEPS {
        let next = (k + 1) % STEPS;
        for level in 0..levels {
            let [a, b] = [k, next].map(|k| level * STEPS + k);
            let [c, d] = [a, b].map(|v| v + STEPS);
            triangles.extend([[a, b, d], [a, d, c]]);
            if inside.is_some() {
                triangles.extend([[a, d, b], [a, c, d]].map(|t| t.map(|v| v + far)));
            }
        }
        let [top, top_next] = [k, next].map(|k| levels * STEPS + k);
        match inside {
            None => triangles.extend([[axis, next, k], [axis + 1, top, top_next]]),
            Some(_) => triangles.extend([
                [k, k + far, next + far],
                [k, next + far, next],
                [top, top_next, top_next + far],
                [top, top_next + far, top + far],
            ]),
        }
    }
    mesh(vertices, triangles)
}
