//! `shelf`: a shelf with boxes and cans in it, as a scan has it: a hundred thousand points on their surfaces.

use super::scene::Files;
use super::shape::on_grid;
use mp_math::sin_cos;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// The greatest distance (m) of neighbours on a surface.
const PITCH: f64 = 0.009;

/// Corners (m) of the boards of the shelf, and of the boxes in it, the least first.
const BLOCKS: [[[f64; 3]; 2]; 14] = [
    [[0.52, -0.45, 0.04], [0.86, 0.45, 0.06]],
    [[0.52, -0.45, 0.39], [0.86, 0.45, 0.41]],
    [[0.52, -0.45, 0.74], [0.86, 0.45, 0.76]],
    [[0.52, -0.45, 1.09], [0.86, 0.45, 1.11]],
    [[0.52, -0.47, 0.0], [0.86, -0.45, 1.11]],
    [[0.52, 0.45, 0.0], [0.86, 0.47, 1.11]],
    [[0.86, -0.47, 0.0], [0.87, 0.47, 1.11]],
    [[0.6, 0.02, 0.06], [0.84, 0.1, 0.31]],
    [[0.64, -0.43, 0.06], [0.84, -0.31, 0.21]],
    [[0.62, -0.1, 0.41], [0.84, 0.06, 0.53]],
    [[0.6, 0.36, 0.41], [0.82, 0.44, 0.67]],
    [[0.7, -0.42, 0.41], [0.84, -0.3, 0.61]],
    [[0.6, -0.3, 0.76], [0.84, -0.06, 0.84]],
    [[0.65, 0.2, 0.76], [0.84, 0.42, 0.98]],
];

/// Where cans stand (m): the middle of the bottom of each; their radius and height.
const CANS: [[f64; 3]; 6] = [
    [0.66, 0.2, 0.06],
    [0.7, 0.36, 0.06],
    [0.6, -0.08, 0.06],
    [0.72, 0.14, 0.41],
    [0.64, -0.36, 0.76],
    [0.7, 0.05, 0.76],
];
const CAN: [f64; 2] = [0.04, 0.12];

/// Adds the scan.
pub(super) fn add(files: &mut Files) {
    let mut points = Vec::new();
    BLOCKS.iter().for_each(|block| block_surface(block, &mut points));
    CANS.iter().for_each(|can| can_surface(*can, &mut points));
    files.insert("meshes/shelf/scan.pcd".into(), pcd(&points));
}

/// The middles of as many equal parts of an interval as keep them close enough.
fn middles(from: f64, to: f64) -> impl Iterator<Item = f64> + Clone {
    let parts = ((to - from) / PITCH).ceil();
    (0..parts as u32).map(move |i| from + (f64::from(i) + 0.5) * (to - from) / parts)
}

fn block_surface([low, high]: &[[f64; 3]; 2], points: &mut Vec<[f64; 3]>) {
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for end in [low, high] {
            for a in middles(low[u], high[u]) {
                for b in middles(low[v], high[v]) {
                    let mut point = [end[axis]; 3];
                    (point[u], point[v]) = (a, b);
                    points.push(point);
                }
            }
        }
    }
}

fn can_surface([x, y, z]: [f64; 3], points: &mut Vec<[f64; 3]>) {
    let mut ring = |radius: f64, height: &mut dyn Iterator<Item = f64>| {
        let heights: Vec<f64> = height.collect();
        for turn in middles(0.0, TAU * radius) {
            let (sin, cos) = sin_cos(turn / radius);
            points.extend(heights.iter().map(|h| [x + radius * cos, y + radius * sin, z + h]));
        }
    };
    ring(CAN[0], &mut middles(0.0, CAN[1]));
    middles(0.0, CAN[0]).for_each(|radius| ring(radius, &mut [CAN[1]].into_iter()));
}

/// A file of PCL with these points.
fn pcd(points: &[[f64; 3]]) -> Vec<u8> {
    let column = |axis: usize| points.iter().flat_map(move |p| (on_grid(p[axis]) as f32).to_le_bytes());
    let fields: Vec<u8> = (0..3).flat_map(column).collect();
    let (packed, n) = (lzf(&fields), points.len());
    let head = format!(
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {n}\nHEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {n}\nDATA binary_compressed\n"
    );
    let sizes = [packed.len(), fields.len()].map(|size| (size as u32).to_le_bytes()).concat();
    [head.into_bytes(), sizes, packed].concat()
}

/// `bytes`, compressed by LZF: up to 32 bytes as they are, or a copy of 3 to 264 bytes that begin at most 8192 bytes before.
fn lzf(bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let plain = |out: &mut Vec<u8>, run: &[u8]| {
        for run in run.chunks(32) {
            out.push(run.len() as u8 - 1);
            out.extend(run);
        }
    };
    let mut seen: HashMap<&[u8], usize> = HashMap::new();
    let (mut at, mut begun) = (0, 0);
    while at + 3 <= bytes.len() {
        let before = seen.insert(&bytes[at..at + 3], at).filter(|before| at - before <= 8192);
        let Some(before) = before else {
            at += 1;
            continue;
        };
        let same = bytes[at..].iter().zip(&bytes[before..]).take(264).take_while(|(a, b)| a == b).count();
        plain(&mut out, &bytes[begun..at]);
        let (back, length) = (at - before - 1, same - 2);
        out.push((length.min(7) << 5 | back >> 8) as u8);
        out.extend((length >= 7).then(|| (length - 7) as u8));
        out.push(back as u8);
        (at, begun) = (at + same, at + same);
    }
    plain(&mut out, &bytes[begun..]);
    out
}
