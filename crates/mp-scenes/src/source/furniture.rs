//! Furniture of the apartment. Each piece stands on z = 0 at the z axis and faces -y.

use super::shape::{block, cells, cushion, cylinder, lathe, mapped, shifted, tube, union};
use mp_geom::TriMesh;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A turned wooden leg of the given height and greatest radius.
fn leg(radius: f64, height: f64, sides: u32) -> TriMesh {
    let shape = [
        (0.45, 0.0),
        (0.6, 0.03),
        (0.45, 0.08),
        (0.55, 0.3),
        (0.75, 0.52),
        (0.5, 0.58),
        (0.9, 0.64),
        (0.5, 0.7),
        (1.0, 0.76),
        (1.0, 1.0),
    ];
    let ring = shape.iter().map(|&(r, z)| [r * radius, z * height]);
    let profile: Vec<_> = std::iter::once([0.0, 0.0]).chain(ring).chain([[0.0, height]]).collect();
    lathe(&profile, sides)
}

/// `part` at the four corners (±x, ±y).
fn four(part: &TriMesh, x: f64, y: f64) -> [TriMesh; 4] {
    [[x, y], [-x, y], [-x, -y], [x, -y]].map(|[x, y]| shifted(part, [x, y, 0.0]))
}

/// A sofa with `seats` seats of 0.62; one seat makes an armchair.
pub(super) fn sofa(seats: u32) -> TriMesh {
    let half = 0.31 * f64::from(seats);
    let mut parts = vec![shifted(&cushion([half + 0.16, 0.42, 0.1], 0.05, 4), [0.0, 0.0, 0.2])];
    for i in 0..seats {
        let x = 0.62 * f64::from(i) - half + 0.31;
        parts.push(shifted(&cushion([0.3, 0.33, 0.085], 0.07, 5), [x, -0.08, 0.37]));
        let back = cushion([0.29, 0.1, 0.24], 0.09, 5);
        let leaning = mapped(&back, |p| [p.x, p.y + 0.25 * p.z, p.z]);
        parts.push(shifted(&leaning, [x, 0.24, 0.62]));
    }
    parts.push(shifted(&cushion([half + 0.14, 0.08, 0.36], 0.07, 4), [0.0, 0.4, 0.45]));
    for side in [-1.0, 1.0] {
        parts.push(shifted(&cushion([0.1, 0.42, 0.22], 0.09, 5), [side * (half + 0.1), -0.02, 0.38]));
    }
    parts.extend(four(&cylinder(0.03, 0.14, 12), half, 0.32));
    union(parts)
}

/// A chair with turned legs and a back of bent slats.
pub(super) fn chair() -> TriMesh {
    let mut parts = vec![shifted(&cushion([0.22, 0.21, 0.035], 0.03, 4), [0.0, 0.0, 0.45])];
    parts.extend(four(&leg(0.03, 0.43, 16), 0.17, 0.16));
    let curve = |x: f64, z: f64| Point3::new(x, 0.17 + 0.22 * (z - 0.42) * (z - 0.42), z);
    for (x, radius) in [(-0.19, 0.02), (-0.09, 0.011), (0.0, 0.011), (0.09, 0.011), (0.19, 0.02)] {
        let line: Vec<_> = (0..=6).map(|i| curve(x, 0.42 + 0.08 * f64::from(i))).collect();
        parts.push(tube(&line, |_| radius, 10, Vector3::x()));
    }
    parts.push(shifted(&cushion([0.23, 0.022, 0.05], 0.02, 3), [0.0, 0.222, 0.9]));
    union(parts)
}

/// A dining table with a rounded top on four turned legs.
pub(super) fn table(half_x: f64, half_y: f64) -> TriMesh {
    let mut parts = vec![
        shifted(&cushion([half_x, half_y, 0.025], 0.02, 6), [0.0, 0.0, 0.735]),
        block([-half_x + 0.12, -half_y + 0.12, 0.62], [half_x - 0.12, half_y - 0.12, 0.72]),
    ];
    parts.extend(four(&leg(0.055, 0.7, 24), half_x - 0.11, half_y - 0.11));
    union(parts)
}

/// A low round table on a turned pillar.
pub(super) fn round_table() -> TriMesh {
    lathe(
        &[
            [0.0, 0.0],
            [0.24, 0.0],
            [0.25, 0.02],
            [0.2, 0.04],
            [0.08, 0.06],
            [0.045, 0.12],
            [0.06, 0.2],
            [0.04, 0.27],
            [0.05, 0.34],
            [0.12, 0.385],
            [0.4, 0.4],
            [0.42, 0.41],
            [0.42, 0.43],
            [0.4, 0.44],
            [0.0, 0.44],
        ],
        48,
    )
}

/// A standing lamp with a thin shade.
pub(super) fn lamp() -> TriMesh {
    let stand = lathe(
        &[
            [0.0, 0.0],
            [0.15, 0.0],
            [0.16, 0.01],
            [0.15, 0.025],
            [0.05, 0.04],
            [0.02, 0.07],
            [0.013, 0.3],
            [0.022, 0.32],
            [0.013, 0.34],
            [0.013, 1.3],
            [0.02, 1.34],
            [0.02, 1.4],
            [0.045, 1.44],
            [0.05, 1.49],
            [0.03, 1.54],
            [0.0, 1.56],
        ],
        32,
    );
    let shade = lathe(
        &[
            [0.2, 1.35],
            [0.21, 1.35],
            [0.19, 1.45],
            [0.16, 1.55],
            [0.12, 1.65],
            [0.11, 1.65],
            [0.15, 1.55],
            [0.18, 1.45],
        ],
        40,
    );
    union([stand, shade])
}

/// An aloe in a pot.
pub(super) fn plant() -> TriMesh {
    let pot = lathe(
        &[
            [0.0, 0.0],
            [0.13, 0.0],
            [0.16, 0.1],
            [0.18, 0.24],
            [0.2, 0.25],
            [0.2, 0.29],
            [0.17, 0.29],
            [0.16, 0.25],
            [0.0, 0.25],
        ],
        32,
    );
    let mut parts = vec![pot];
    for i in 0..16u32 {
        // Successive leaves stand at the golden angle.
        let (s, c) = mp_math::sin_cos(TAU * 0.381966 * f64::from(i));
        let spread = 0.12 + 0.028 * f64::from(i);
        let height = 0.95 - 0.04 * f64::from(i);
        let line: Vec<_> = (0..=9)
            .map(|k| {
                let t = f64::from(k) / 9.0;
                let r = 0.02 + spread * t * (0.4 + 0.6 * t);
                Point3::new(r * c, r * s, 0.23 + height * t * (1.35 - 0.6 * t))
            })
            .collect();
        let width = |k: usize| {
            let t = k as f64 / 9.0;
            0.005 + 0.11 * (1.0 - t) * (0.15 + t) * (1.0 - 0.4 * t)
        };
        parts.push(tube(&line, |k| 0.6 * width(k), 8, Vector3::new(-s, c, 0.0)));
    }
    union(parts)
}

/// A double bed.
pub(super) fn bed() -> TriMesh {
    let mut parts = vec![
        block([-0.82, -1.02, 0.16], [0.82, 1.02, 0.3]),
        shifted(&cushion([0.8, 1.0, 0.13], 0.08, 6), [0.0, 0.0, 0.4]),
        shifted(&cushion([0.84, 0.05, 0.35], 0.04, 6), [0.0, 1.06, 0.62]),
    ];
    for x in [-0.4, 0.4] {
        let pillow = mapped(&cushion([0.34, 0.22, 0.09], 0.085, 6), |p| {
            let thin = (1.0 - 0.6 * (p.x / 0.34) * (p.x / 0.34)) * (1.0 - 0.5 * (p.y / 0.22) * (p.y / 0.22));
            [p.x, p.y, p.z * (0.25 + 0.75 * thin)]
        });
        parts.push(shifted(&pillow, [x, 0.7, 0.57]));
    }
    parts.extend(four(&leg(0.05, 0.2, 20), 0.74, 0.94));
    union(parts)
}

/// A bath tub.
pub(super) fn bath() -> TriMesh {
    let round = lathe(
        &[
            [0.0, 0.0],
            [0.26, 0.0],
            [0.3, 0.04],
            [0.34, 0.2],
            [0.37, 0.42],
            [0.41, 0.48],
            [0.42, 0.51],
            [0.41, 0.54],
            [0.37, 0.54],
            [0.34, 0.5],
            [0.31, 0.36],
            [0.27, 0.18],
            [0.2, 0.1],
            [0.0, 0.08],
        ],
        56,
    );
    let long = mapped(&round, |p| [2.0 * p.x, p.y, p.z]);
    let arch = |i: u32| {
        let (s, c) = mp_math::sin_cos(std::f64::consts::PI * f64::from(i) / 12.0);
        Point3::new(0.72 - 0.09 * (1.0 - c), 0.0, 0.68 + 0.09 * s)
    };
    let spout: Vec<_> = std::iter::once(Point3::new(0.72, 0.0, 0.45)).chain((0..=12).map(arch)).collect();
    union([long, tube(&spout, |_| 0.018, 12, Vector3::y())])
}

/// A wash basin on its pillar.
pub(super) fn basin() -> TriMesh {
    lathe(
        &[
            [0.0, 0.0],
            [0.13, 0.0],
            [0.12, 0.05],
            [0.08, 0.15],
            [0.07, 0.5],
            [0.1, 0.65],
            [0.2, 0.74],
            [0.26, 0.82],
            [0.28, 0.85],
            [0.26, 0.87],
            [0.23, 0.85],
            [0.18, 0.78],
            [0.1, 0.74],
            [0.0, 0.73],
        ],
        44,
    )
}

/// A water closet.
pub(super) fn closet() -> TriMesh {
    let bowl = lathe(
        &[
            [0.0, 0.0],
            [0.12, 0.0],
            [0.11, 0.1],
            [0.12, 0.2],
            [0.18, 0.34],
            [0.19, 0.4],
            [0.17, 0.42],
            [0.14, 0.4],
            [0.11, 0.3],
            [0.05, 0.24],
            [0.0, 0.23],
        ],
        40,
    );
    let oval = mapped(&bowl, |p| [p.x, 1.3 * p.y, p.z]);
    union([oval, shifted(&cushion([0.2, 0.09, 0.19], 0.04, 4), [0.0, 0.3, 0.58])])
}

/// A book case with three shelves of books.
pub(super) fn shelves() -> TriMesh {
    let zs = [0.0, 0.08, 0.1, 0.52, 0.54, 0.96, 0.98, 1.4, 1.42, 1.84, 1.86];
    let case =
        cells(&[-0.5, -0.48, 0.48, 0.5], &[-0.15, 0.13, 0.15], &zs, |i, j, k| k % 2 == 1 || i != 1 || j == 1);
    let mut parts = vec![case];
    for (shelf, &z) in zs.iter().enumerate().skip(2).step_by(2).take(4) {
        let mut x = -0.46;
        let mut i = shelf as u32;
        while x < 0.36 {
            // Widths and heights that repeat after seven and five books.
            let width = 0.024 + 0.005 * f64::from(i * 3 % 7);
            let height = 0.24 + 0.025 * f64::from(i * 2 % 5);
            parts.push(block([x, -0.12, z + 0.002], [x + width, 0.08, z + height]));
            x += width + 0.004;
            i += 1;
        }
    }
    union(parts)
}

/// A wardrobe with two doors and knobs.
pub(super) fn wardrobe() -> TriMesh {
    let knob =
        lathe(&[[0.0, -0.02], [0.012, -0.02], [0.01, 0.0], [0.02, 0.015], [0.02, 0.03], [0.0, 0.04]], 20);
    // The knob's axis along -y.
    let knob = mapped(&knob, |p| [p.x, -p.z, p.y]);
    union([
        block([-0.8, -0.29, 0.0], [0.8, 0.3, 1.95]),
        block([-0.78, -0.31, 0.08], [-0.005, -0.28, 1.9]),
        block([0.005, -0.31, 0.08], [0.78, -0.28, 1.9]),
        shifted(&knob, [-0.06, -0.315, 1.0]),
        shifted(&knob, [0.06, -0.315, 1.0]),
    ])
}

/// A kitchen counter with a hob and a tap.
pub(super) fn counter() -> TriMesh {
    let mut parts = vec![
        block([-1.6, -0.3, 0.0], [1.6, 0.3, 0.86]),
        shifted(&cushion([1.62, 0.32, 0.025], 0.02, 4), [0.0, 0.0, 0.88]),
    ];
    for (x, y) in [(-1.1, -0.13), (-1.1, 0.13), (-0.75, -0.13), (-0.75, 0.13)] {
        parts.push(shifted(&cylinder(0.09, 0.03, 32), [x, y, 0.89]));
    }
    let line: Vec<_> = (0..=12)
        .map(|i| {
            let (s, c) = mp_math::sin_cos(FRAC_PI_2 * 2.0 * f64::from(i) / 12.0);
            Point3::new(0.6, 0.2 - 0.1 * (1.0 - c), 1.1 + 0.1 * s)
        })
        .collect();
    let tap: Vec<_> = std::iter::once(Point3::new(0.6, 0.2, 0.88)).chain(line).collect();
    parts.push(tube(&tap, |_| 0.014, 12, Vector3::x()));
    union(parts)
}

pub(super) fn refrigerator() -> TriMesh {
    let handle: Vec<_> = [(-0.31, 1.0), (-0.36, 1.02), (-0.37, 1.2), (-0.36, 1.38), (-0.31, 1.4)]
        .iter()
        .map(|&(y, z)| Point3::new(-0.2, y, z))
        .collect();
    union([
        shifted(&cushion([0.32, 0.32, 0.9], 0.05, 5), [0.0, 0.0, 0.92]),
        tube(&handle, |_| 0.013, 12, Vector3::x()),
    ])
}

/// A stool for the piano.
pub(super) fn stool() -> TriMesh {
    let mut parts = vec![shifted(&cushion([0.3, 0.17, 0.045], 0.04, 4), [0.0, 0.0, 0.44])];
    parts.extend(four(&leg(0.03, 0.42, 16), 0.24, 0.11));
    union(parts)
}
