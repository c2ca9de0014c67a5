//! Random bodies in space, as files have them and as the oracle has them.

use super::list;
use crate::draw::Draw;
use crate::oracle::{Body, Piece, Shape, box_pieces};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion};
use std::collections::BTreeMap;

/// A triangle by its corners.
pub(super) type Triangle = [[f64; 3]; 3];

/// The shape of a body.
#[derive(Clone, Debug)]
pub(super) enum Form {
    Box([f64; 3]),
    Ball(f64),
    /// Radius and height, about Z.
    Cylinder([f64; 2]),
    /// Triangles, in a file of this name.
    Mesh(Vec<Triangle>, String),
}

/// The pose of six numbers.
pub(super) fn pose(six: [f64; 6]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_euler_angles(six[5], six[4], six[3]);
    Isometry3::from_parts(Translation3::new(six[0], six[1], six[2]), turn)
}

impl Form {
    /// The pieces of the shape moved by `pose`, as the oracle has it.
    pub(super) fn pieces(&self, pose: &Isometry3<f64>) -> Vec<Piece> {
        match self {
            Self::Box(sides) => box_pieces(*sides, pose),
            Self::Ball(radius) => {
                let middle = Point3::from(pose.translation.vector);
                vec![Piece::Capsule { a: middle, b: middle, radius: *radius }]
            }
            Self::Cylinder([radius, height]) => {
                vec![Piece::Cylinder { pose: *pose, radius: *radius, half: 0.5 * height }]
            }
            Self::Mesh(triangles, _) => {
                triangles.iter().map(|t| Piece::Triangle(t.map(|p| pose * Point3::from(p)))).collect()
            }
        }
    }

    /// As a body of the oracle.
    pub(super) fn body(&self, name: &str, pose: &Isometry3<f64>, frame: usize) -> Body {
        Body::new(name, Shape::Pieces(self.pieces(pose)), frame)
    }

    /// Its key and value in TOML.
    pub(super) fn toml(&self) -> String {
        match self {
            Self::Box(sides) => format!("box = {}", list(sides)),
            Self::Ball(radius) => format!("sphere = {radius:?}"),
            Self::Cylinder(sizes) => format!("cylinder = {}", list(sizes)),
            Self::Mesh(_, file) => format!("mesh = \"{file}\""),
        }
    }

    /// Puts its file among `files`, if it has one.
    pub(super) fn write(&self, files: &mut BTreeMap<String, Vec<u8>>) {
        if let Self::Mesh(triangles, file) = self {
            files.insert(file.clone(), mesh_text(triangles, file).into_bytes());
        }
    }

    /// The radius (m) of the round shape, which files turn into a mesh around it.
    pub(super) fn round(&self) -> f64 {
        match self {
            Self::Ball(radius) => *radius,
            Self::Cylinder([radius, _]) => *radius,
            Self::Box(_) | Self::Mesh(..) => 0.0,
        }
    }

    /// The same shape as a mesh, if it is one already or is a box.
    pub(super) fn meshed(self, file: String) -> Self {
        match self {
            Self::Box(sides) => Self::Mesh(corners(&box_pieces(sides, &Isometry3::identity())), file),
            Self::Ball(radius) => Self::Mesh(octahedron(radius), file),
            Self::Cylinder([radius, height]) => Self::Mesh(octahedron(radius.min(0.5 * height)), file),
            Self::Mesh(triangles, _) => Self::Mesh(triangles, file),
        }
    }
}

/// The triangles among pieces.
fn corners(pieces: &[Piece]) -> Vec<Triangle> {
    let corners = |piece: &Piece| match piece {
        Piece::Triangle(corners) => Some(corners.map(|p| [p.x, p.y, p.z])),
        _ => None,
    };
    pieces.iter().filter_map(corners).collect()
}

/// The faces of an octahedron with corners at this distance from its middle.
fn octahedron(radius: f64) -> Vec<Triangle> {
    let mut faces = Vec::new();
    for x in [radius, -radius] {
        for y in [radius, -radius] {
            for z in [radius, -radius] {
                let (a, b, c) = ([x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]);
                faces.push(if x * y * z > 0.0 { [a, b, c] } else { [a, c, b] });
            }
        }
    }
    faces
}

/// A mesh in the format that the ending of its name says.
fn mesh_text(triangles: &[Triangle], file: &str) -> String {
    let row = |p: &[f64; 3]| format!("{:?} {:?} {:?}", p[0], p[1], p[2]);
    let mut text = String::new();
    match file.rsplit_once('.').map(|(_, ending)| ending) {
        Some("txt") => {
            text += &format!("{}\n", triangles.len());
            for t in triangles {
                text += &format!("{}  {}  {}\n", row(&t[0]), row(&t[1]), row(&t[2]));
            }
        }
        Some("stl") => {
            text += "solid x\n";
            for t in triangles {
                text += "facet normal 0 0 0\nouter loop\n";
                t.iter().for_each(|p| text += &format!("vertex {}\n", row(p)));
                text += "endloop\nendfacet\n";
            }
            text += "endsolid x\n";
        }
        Some("obj") => {
            triangles.iter().flatten().for_each(|p| text += &format!("v {}\n", row(p)));
            (0..triangles.len())
                .for_each(|i| text += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3));
        }
        _ => {
            text += &format!("OFF\n{} {} 0\n", 3 * triangles.len(), triangles.len());
            triangles.iter().flatten().for_each(|p| text += &format!("{}\n", row(p)));
            (0..triangles.len()).for_each(|i| text += &format!("3 {} {} {}\n", 3 * i, 3 * i + 1, 3 * i + 2));
        }
    }
    text
}

/// The name of a mesh file in one of the formats.
pub(super) fn mesh_file(draw: &mut Draw, name: &str) -> String {
    format!("{name}.{}", draw.one(&["off", "txt", "stl", "obj"]))
}

/// A random form of about this size (m).
pub(super) fn form(draw: &mut Draw, size: f64, name: &str) -> Form {
    let mut side = || size * draw.within(0.15, 1.0);
    let sides = [side(), side(), side()];
    match draw.below(8) {
        0 => Form::Ball(0.5 * sides[0]),
        1 => Form::Cylinder([0.4 * sides[0], sides[1]]),
        // A thin plate.
        2 => Form::Box([size, sides[1], size * draw.logarithmic(1e-4, 0.1)]),
        3 => {
            let file = mesh_file(draw, name);
            Form::Box(sides).meshed(file)
        }
        4 => Form::Mesh(angle(size, sides), mesh_file(draw, name)),
        5 => {
            let count = draw.count(1, 6);
            Form::Mesh(loose(draw, count, 0.5 * size), mesh_file(draw, name))
        }
        _ => Form::Box(sides),
    }
}

/// Two boxes that form an L.
fn angle(size: f64, sides: [f64; 3]) -> Vec<Triangle> {
    let wide = 0.3 * size.min(sides[2]);
    let one = box_pieces([size, wide, wide], &Isometry3::translation(0.0, -0.3 * size, 0.0));
    let other = box_pieces([wide, 0.8 * size, wide], &Isometry3::translation(-0.35 * size, 0.0, 0.0));
    [corners(&one), corners(&other)].concat()
}

/// Loose triangles within `half` of the origin: wild ones, slivers, coplanar ones and ones that touch.
pub(super) fn loose(draw: &mut Draw, count: usize, half: f64) -> Vec<Triangle> {
    let mut all: Vec<Triangle> = Vec::new();
    let point = |draw: &mut Draw| [0; 3].map(|_| draw.within(-half, half));
    // Corners on a grid are shared, and their planes too.
    let on_grid = |draw: &mut Draw| [0; 3].map(|_| half * (draw.count(0, 4) as f64 / 2.0 - 1.0));
    while all.len() < count {
        let a = point(draw);
        let near = |draw: &mut Draw, p: [f64; 3], by: f64| {
            let off = [0; 3].map(|_| by * half * draw.within(-1.0, 1.0));
            [p[0] + off[0], p[1] + off[1], p[2] + off[2]]
        };
        let made = match draw.below(6) {
            0 => {
                let by = draw.logarithmic(1e-12, 1e-2);
                [a, near(draw, a, by), point(draw)]
            }
            1 => [on_grid(draw), on_grid(draw), on_grid(draw)],
            2 => match all.last() {
                Some([p, q, _]) => [*q, *p, a],
                None => [a, point(draw), point(draw)],
            },
            // Almost the one before.
            3 => match all.last().copied() {
                Some(last) => {
                    let by = draw.logarithmic(1e-12, 1e-2);
                    last.map(|p| near(draw, p, by))
                }
                None => [a, point(draw), point(draw)],
            },
            _ => [a, near(draw, a, 0.5), near(draw, a, 0.5)],
        };
        // Files do not keep triangles without an area.
        if area(&made) > 0.0 {
            all.push(made);
        }
    }
    all
}

/// Twice the area of a triangle, squared.
fn area([a, b, c]: &Triangle) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Point3::from(*p));
    (b - a).cross(&(c - a)).norm_squared()
}
