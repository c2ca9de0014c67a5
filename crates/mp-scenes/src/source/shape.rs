//! The solids of which the scenes consist, beyond the primitives of `mp-geom`. All are closed, oriented
//! manifolds with outward normals.

use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Coordinates are written to this many parts of a metre.
const GRID: f64 = 1e4;

/// `x` rounded to the grid on which assets are written.
///
/// Sines differ in the last bits between machines. The offset moves the rounding boundaries away from the
/// round numbers that most coordinates are, so that the files are the same everywhere.
pub(super) fn on_grid(x: f64) -> f64 {
    (x * GRID + 0.5 + 1e-3).floor() / GRID
}

/// The same for configurations of paths through passages that are not much wider than the grid of meshes.
pub(super) fn on_fine_grid(x: f64) -> f64 {
    on_grid(x * GRID) / GRID
}

/// A mesh made of constants, which are always valid.
pub(super) fn mesh(vertices: Vec<Point3<f64>>, triangles: Vec<[u32; 3]>) -> TriMesh {
    TriMesh::new(vertices, triangles).expect("assets are built from valid constants")
}

/// Several solids in one mesh.
pub(super) fn union(parts: impl IntoIterator<Item = TriMesh>) -> TriMesh {
    let parts: Vec<_> = parts.into_iter().collect();
    TriMesh::merged(&parts).expect("at least one part")
}

/// `mesh` moved by a vector.
pub(super) fn shifted(mesh: &TriMesh, by: [f64; 3]) -> TriMesh {
    mesh.transformed(&Isometry3::translation(by[0], by[1], by[2]))
}

/// `mesh` with every vertex moved by `f`, which must preserve orientation.
pub(super) fn mapped(m: &TriMesh, f: impl Fn(&Point3<f64>) -> [f64; 3]) -> TriMesh {
    mesh(m.vertices().iter().map(|p| Point3::from(f(p))).collect(), m.triangles().to_vec())
}

/// The box between two corners.
pub(super) fn block(low: [f64; 3], high: [f64; 3]) -> TriMesh {
    cells(&[low[0], high[0]], &[low[1], high[1]], &[low[2], high[2]], |_, _, _| true)
}

/// The union of the cells of a grid of planes for which `solid(i, j, k)` is true, as one conforming surface.
///
/// Solid cells should not touch only along an edge or at a corner: the surface is not a manifold there.
pub(super) fn cells(
    xs: &[f64],
    ys: &[f64],
    zs: &[f64],
    solid: impl Fn(usize, usize, usize) -> bool,
) -> TriMesh {
    let count = [xs.len() - 1, ys.len() - 1, zs.len() - 1];
    let inside = |c: [usize; 3]| (0..3).all(|a| c[a] < count[a]) && solid(c[0], c[1], c[2]);
    let mut index = vec![u32::MAX; xs.len() * ys.len() * zs.len()];
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let mut vertex = |c: [usize; 3]| {
        let slot = &mut index[(c[2] * ys.len() + c[1]) * xs.len() + c[0]];
        if *slot == u32::MAX {
            *slot = vertices.len() as u32;
            vertices.push(Point3::new(xs[c[0]], ys[c[1]], zs[c[2]]));
        }
        *slot
    };
    for k in 0..count[2] {
        for j in 0..count[1] {
            for i in 0..count[0] {
                let cell = [i, j, k];
                if !inside(cell) {
                    continue;
                }
                for axis in 0..3 {
                    for far in [false, true] {
                        let mut beyond = cell;
                        beyond[axis] = if far { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
                        if inside(beyond) {
                            continue;
                        }
                        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                        let corner = |du: usize, dv: usize| {
                            let mut c = cell;
                            c[axis] += usize::from(far);
                            c[u] += du;
                            c[v] += dv;
                            c
                        };
                        let mut q = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)].map(&mut vertex);
                        if !far {
                            q.reverse();
                        }
                        triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
                    }
                }
            }
        }
    }
    mesh(vertices, triangles)
}

/// The solid from z = `low` to `high` whose floor plan is drawn in rows of characters, first row at the largest y;
/// `#` is solid. The widths of columns and the heights of rows (bottom row first) are given by grid lines.
pub(super) fn plan(rows: &[&str], xs: &[f64], ys: &[f64], low: f64, high: f64) -> TriMesh {
    let n = rows.len();
    assert!(n + 1 == ys.len() && rows.iter().all(|r| r.len() + 1 == xs.len()), "plan and grid lines differ");
    cells(xs, ys, &[low, high], |i, j, _| rows[n - 1 - j].as_bytes()[i] == b'#')
}

/// The surface swept by turning `profile`, points (radius, z), about the z axis in `sides` steps.
///
/// The profile runs counter-clockwise in the (radius, z) half-plane: upwards on the outside. Either its
/// first and last points lie on the axis, or it is closed and stays off the axis (a ring).
pub(super) fn lathe(profile: &[[f64; 2]], sides: u32) -> TriMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let mut rings: Vec<(u32, bool)> = Vec::new();
    for &[r, z] in profile {
        rings.push((vertices.len() as u32, r == 0.0));
        if r == 0.0 {
            vertices.push(Point3::new(0.0, 0.0, z));
        } else {
            vertices.extend((0..sides).map(|i| {
                let (s, c) = mp_math::sin_cos(TAU * f64::from(i) / f64::from(sides));
                Point3::new(r * c, r * s, z)
            }));
        }
    }
    let closed = !rings[0].1;
    let steps = rings.len() - usize::from(!closed);
    for k in 0..steps {
        let ((a, a_pole), (b, b_pole)) = (rings[k], rings[(k + 1) % rings.len()]);
        for i in 0..sides {
            let j = (i + 1) % sides;
            match (a_pole, b_pole) {
                (true, _) => triangles.push([a, b + j, b + i]),
                (_, true) => triangles.push([a + i, a + j, b]),
                _ => triangles.extend([[a + i, a + j, b + j], [a + i, b + j, b + i]]),
            }
        }
    }
    mesh(vertices, triangles)
}

/// An upright cylinder with the centre of its base at the origin.
pub(super) fn cylinder(radius: f64, height: f64, sides: u32) -> TriMesh {
    lathe(&[[0.0, 0.0], [radius, 0.0], [radius, height], [0.0, height]], sides)
}

/// A sphere about the origin with `rows` bands.
pub(super) fn ball(radius: f64, sides: u32, rows: u32) -> TriMesh {
    let profile: Vec<_> = (0..=rows)
        .map(|i| match i {
            0 => [0.0, -radius],
            i if i == rows => [0.0, radius],
            i => {
                let (s, c) = mp_math::sin_cos(PI * f64::from(i) / f64::from(rows) - FRAC_PI_2);
                [radius * c, radius * s]
            }
        })
        .collect();
    lathe(&profile, sides)
}

/// A tube of the given radii along a polyline, with flat ends. Each cross section follows from the previous one by the least
/// rotation; `up` is a hint for the first one.
pub(super) fn tube(
    line: &[Point3<f64>],
    radius: impl Fn(usize) -> f64,
    sides: u32,
    up: Vector3<f64>,
) -> TriMesh {
    let mut side = up;
    tube_facing(line, radius, sides, |t| {
        side = (side - t * t.dot(&side)).normalize();
        side
    })
}

/// A tube of which each cross section has its first corner where `facing` says for the tangent there: across it, of length 1.
pub(super) fn tube_facing(
    line: &[Point3<f64>],
    radius: impl Fn(usize) -> f64,
    sides: u32,
    mut facing: impl FnMut(Vector3<f64>) -> Vector3<f64>,
) -> TriMesh {
    let n = line.len();
    let tangent = |i: usize| (line[(i + 1).min(n - 1)] - line[i.saturating_sub(1)]).normalize();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for (i, p) in line.iter().enumerate() {
        let t = tangent(i);
        let side = facing(t);
        let other = t.cross(&side);
        vertices.extend((0..sides).map(|k| {
            let (s, c) = mp_math::sin_cos(TAU * f64::from(k) / f64::from(sides));
            p + (side * c + other * s) * radius(i)
        }));
    }
    for i in 0..n as u32 - 1 {
        for k in 0..sides {
            let (a, b) = (i * sides + k, i * sides + (k + 1) % sides);
            triangles.extend([[a, b, b + sides], [a, b + sides, a + sides]]);
        }
    }
    let (first, last) = (vertices.len() as u32, vertices.len() as u32 + 1);
    vertices.extend([line[0], line[n - 1]]);
    for k in 0..sides {
        let next = (k + 1) % sides;
        let base = (n as u32 - 1) * sides;
        triangles.extend([[first, next, k], [last, base + k, base + next]]);
    }
    mesh(vertices, triangles)
}

/// A box with edges and corners rounded by `radius`, in `m` steps a quarter turn: cushions, mattresses.
/// Each half extent must exceed `radius`.
pub(super) fn cushion(half: [f64; 3], radius: f64, m: u32) -> TriMesh {
    let core = half.map(|h| h - radius);
    let ring = 4 * (m + 1);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let corner = |q: u32| [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][q as usize];
    // Latitudes from south to north, without the poles.
    let rows: Vec<(f64, f64)> = (1..=m)
        .map(|i| (FRAC_PI_2 * (f64::from(i) / f64::from(m) - 1.0), -1.0))
        .chain((0..m).map(|i| (FRAC_PI_2 * f64::from(i) / f64::from(m), 1.0)))
        .collect();
    for sign in [-1.0, 1.0] {
        vertices.extend(
            (0..4).map(|q| Point3::new(corner(q)[0] * core[0], corner(q)[1] * core[1], sign * half[2])),
        );
    }
    for &(latitude, sign) in &rows {
        let (up, out) = mp_math::sin_cos(latitude);
        for q in 0..4 {
            for i in 0..=m {
                let (s, c) = mp_math::sin_cos(FRAC_PI_2 * (f64::from(q) + f64::from(i) / f64::from(m)));
                vertices.push(Point3::new(
                    corner(q)[0] * core[0] + radius * out * c,
                    corner(q)[1] * core[1] + radius * out * s,
                    sign * core[2] + radius * up,
                ));
            }
        }
    }
    let at = |row: u32, k: u32| 8 + row * ring + k % ring;
    for row in 0..rows.len() as u32 - 1 {
        for k in 0..ring {
            let (a, b, c, d) = (at(row, k), at(row, k + 1), at(row + 1, k + 1), at(row + 1, k));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let top = rows.len() as u32 - 1;
    for q in 0..4 {
        let (next, start) = ((q + 1) % 4, q * (m + 1));
        for i in 0..m {
            triangles.push([q, at(0, start + i + 1), at(0, start + i)]);
            triangles.push([4 + q, at(top, start + i), at(top, start + i + 1)]);
        }
        let (a, b) = (start + m, start + m + 1);
        triangles.extend([[q, next, at(0, b)], [q, at(0, b), at(0, a)]]);
        triangles.extend([[4 + q, at(top, a), at(top, b)], [4 + q, at(top, b), 4 + next]]);
    }
    triangles.extend([[0, 3, 2], [0, 2, 1], [4, 5, 6], [4, 6, 7]]);
    mesh(vertices, triangles)
}

/// A wall of `thickness` along a polyline in the plane, from z = `low` to `high`, with mitred bends.
pub(super) fn ribbon(line: &[[f64; 2]], thickness: f64, low: f64, high: f64) -> TriMesh {
    let n = line.len();
    let unit = |a: [f64; 2], b: [f64; 2]| {
        let (x, y) = (b[0] - a[0], b[1] - a[1]);
        let l = (x * x + y * y).sqrt();
        [x / l, y / l]
    };
    let mut vertices = Vec::new();
    for i in 0..n {
        let before = unit(line[i.saturating_sub(1).min(n - 2)], line[i.max(1)]);
        let after = unit(line[i.min(n - 2)], line[(i + 1).min(n - 1)]);
        let normal = [-(before[1] + after[1]), before[0] + after[0]];
        let scale = thickness / (1.0 + before[0] * after[0] + before[1] * after[1]) / 2.0;
        for side in [1.0, -1.0] {
            let (x, y) = (line[i][0] + side * scale * normal[0], line[i][1] + side * scale * normal[1]);
            vertices.extend([Point3::new(x, y, low), Point3::new(x, y, high)]);
        }
    }
    // Section i: left low, left high, right low, right high.
    let mut triangles = Vec::new();
    let mut quad = |a: u32, b: u32, c: u32, d: u32| triangles.extend([[a, b, c], [a, c, d]]);
    for i in 0..n as u32 - 1 {
        let (p, q) = (4 * i, 4 * i + 4);
        quad(p, p + 1, q + 1, q);
        quad(p + 2, q + 2, q + 3, p + 3);
        quad(p + 1, p + 3, q + 3, q + 1);
        quad(p, q, q + 2, p + 2);
    }
    let e = 4 * (n as u32 - 1);
    quad(0, 2, 3, 1);
    quad(e, e + 1, e + 3, e + 2);
    mesh(vertices, triangles)
}
