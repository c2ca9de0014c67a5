//! SVG drawings of scenes in space, seen from above or from the side.

use mp_geom::{Aabb, TriMesh};
use nalgebra::{Isometry3, Point3, Vector3};
use std::fmt::Write;

/// Pixels for a line of text.
const LINE: f64 = 26.0;

/// Longest edge of a face, metres.
const SMALL: f64 = 0.15;

/// The direction of projection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Projection {
    Above,
    Aslant,
}

/// An SVG drawing of a scene.
#[derive(Clone, Debug)]
pub(super) struct SvgDrawing {
    /// The directions to the right, up, and toward the eye.
    axes: [Vector3<f64>; 3],
    /// The upper left corner, metres along the axes, and pixels per metre.
    corner: [f64; 2],
    scale: f64,
    /// The height without the captions, pixels.
    height: f64,
    captions: Vec<String>,
    text: String,
}

impl SvgDrawing {
    /// A drawing of the box `bounds`, whose longer side has `side` pixels, with captions below.
    pub(super) fn new(bounds: &Aabb, projection: Projection, side: f64, captions: &[String]) -> Self {
        let axes = match projection {
            Projection::Above => [Vector3::x(), Vector3::y(), Vector3::z()],
            Projection::Aslant => {
                let eye = Vector3::new(-0.45, -0.7, 0.55).normalize();
                let right = Vector3::z().cross(&eye).normalize();
                [right, eye.cross(&right), eye]
            }
        };
        let corners = (0..8).map(|i| {
            let of = |k: usize| if i >> k & 1 == 0 { bounds.min[k] } else { bounds.max[k] };
            Vector3::new(of(0), of(1), of(2))
        });
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in corners {
            for k in 0..2 {
                low[k] = low[k].min(corner.dot(&axes[k]));
                high[k] = high[k].max(corner.dot(&axes[k]));
            }
        }
        let size = [high[0] - low[0], high[1] - low[1]];
        let scale = side / size[0].max(size[1]);
        let [width, height] = size.map(|s| s * scale);
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {:.0}\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
            height + LINE * captions.len() as f64
        );
        Self { axes, corner: [low[0], high[1]], scale, height, captions: captions.to_vec(), text }
    }

    /// The position of a point in the drawing, pixels from the left and the top.
    pub(super) fn at(&self, p: &Point3<f64>) -> [f64; 2] {
        let [x, y] = [0, 1].map(|k| p.coords.dot(&self.axes[k]));
        [(x - self.corner[0]) * self.scale, (self.corner[1] - y) * self.scale]
    }

    /// Draws the silhouette of bodies in one colour.
    pub(super) fn silhouette<'a>(
        &mut self,
        bodies: impl IntoIterator<Item = (&'a TriMesh, Isometry3<f64>)>,
        colour: &str,
        opacity: f64,
    ) {
        let _ = write!(self.text, "<path fill=\"{colour}\" fill-opacity=\"{opacity}\" d=\"");
        for (mesh, pose) in bodies {
            for i in 0..mesh.triangles().len() {
                let [a, b, c] = mesh.triangle(i).map(|p| self.at(&(pose * p)));
                // All with the same orientation, so that overlapping triangles do not cancel.
                let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
                let [b, c] = if turn > 0.0 { [b, c] } else { [c, b] };
                if turn.abs() > 0.05 {
                    self.corners(&[a, b, c]);
                }
            }
        }
        self.text.push_str("\"/>\n");
    }

    fn corners(&mut self, points: &[[f64; 2]]) {
        for (i, [x, y]) in points.iter().enumerate() {
            let _ = write!(self.text, "{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' });
        }
        self.text.push('Z');
    }

    /// Draws closed bodies, each in a colour, shaded, from back to front.
    pub(super) fn solids<'a>(
        &mut self,
        bodies: impl IntoIterator<Item = (&'a TriMesh, Isometry3<f64>, &'a str)>,
    ) {
        let light = Vector3::new(-0.2, -0.5, 0.85).normalize();
        let (mut faces, mut small) = (Vec::new(), Vec::new());
        for (mesh, pose, colour) in bodies {
            (0..mesh.triangles().len())
                .for_each(|i| parts(mesh.triangle(i).map(|p| pose * p), SMALL, &mut small));
            for [a, b, c] in small.drain(..) {
                let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { continue };
                if normal.dot(&self.axes[2]) > 0.0 {
                    let depth = (a.coords + b.coords + c.coords).dot(&self.axes[2]);
                    faces.push((
                        depth,
                        [a, b, c].map(|p| self.at(&p)),
                        colour,
                        0.45 * (1.0 - normal.dot(&light)),
                    ));
                }
            }
        }
        faces.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, corners, colour, dark) in faces {
            // The stroke hides the seams between faces.
            for (fill, opacity) in [(colour, 1.0), ("#000", dark)] {
                let _ = write!(
                    self.text,
                    "<path fill=\"{fill}\" stroke=\"{fill}\" stroke-width=\"0.5\" opacity=\"{opacity:.2}\" d=\""
                );
                self.corners(&corners);
                self.text.push_str("\"/>\n");
            }
        }
    }

    /// Draws line segments, of a colour and a width in pixels.
    pub(super) fn lines(
        &mut self,
        lines: impl IntoIterator<Item = [Point3<f64>; 2]>,
        colour: &str,
        width: f64,
    ) {
        let mut drawn = false;
        for (i, line) in lines.into_iter().enumerate() {
            // Viewers are slow with long paths.
            if i.is_multiple_of(100) {
                let end = if i > 0 { "\"/>\n" } else { "" };
                let _ = write!(
                    self.text,
                    "{end}<path fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\" d=\""
                );
            }
            let [a, b] = line.map(|p| self.at(&p));
            let _ = write!(self.text, "M{:.1} {:.1}L{:.1} {:.1}", a[0], a[1], b[0], b[1]);
            drawn = true;
        }
        if drawn {
            self.text.push_str("\"/>\n");
        }
    }

    /// Draws dots, of a colour and a radius in pixels.
    pub(super) fn dots(&mut self, places: impl IntoIterator<Item = Point3<f64>>, colour: &str, radius: f64) {
        self.lines(places.into_iter().map(|p| [p, p]), colour, 2.0 * radius);
    }

    /// Draws the outline of a sphere.
    pub(super) fn sphere(&mut self, center: &Point3<f64>, radius: f64, colour: &str) {
        let [x, y] = self.at(center);
        let _ = writeln!(
            self.text,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" fill=\"none\" stroke=\"{colour}\" stroke-dasharray=\"6 5\"/>",
            radius * self.scale
        );
    }

    /// The text of the drawing. The captions come last, over anything that reaches beyond the bounds.
    pub(super) fn finish(mut self) -> String {
        let below = LINE * self.captions.len() as f64;
        let _ = writeln!(
            self.text,
            "<rect y=\"{:.0}\" width=\"100%\" height=\"{below:.0}\" fill=\"#fff\"/>",
            self.height
        );
        for (i, caption) in self.captions.iter().enumerate() {
            let y = self.height + LINE * (i as f64 + 0.7);
            let _ = writeln!(
                self.text,
                "<text x=\"6\" y=\"{y:.0}\" font-family=\"sans-serif\" font-size=\"16\">{caption}</text>"
            );
        }
        self.text + "</svg>\n"
    }
}

/// Appends to `out` parts of a triangle with no edge longer than `most`: small triangles can be sorted by
/// depth.
fn parts(corners: [Point3<f64>; 3], most: f64, out: &mut Vec<[Point3<f64>; 3]>) {
    let longest = (0..3).max_by(|&i, &j| {
        let length = |i: usize| (corners[(i + 1) % 3] - corners[i]).norm();
        length(i).total_cmp(&length(j))
    });
    let i = longest.unwrap_or(0);
    let [a, b, c] = [corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]];
    if (b - a).norm() <= most {
        return out.push(corners);
    }
    let middle = nalgebra::center(&a, &b);
    parts([a, middle, c], most, out);
    parts([middle, b, c], most, out);
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives::cuboid;

    #[test]
    fn what_is_in_front_is_drawn_last() {
        let bounds = Aabb { min: Point3::new(-1.0, -1.0, -1.0), max: Point3::new(1.0, 1.0, 1.0) };
        let cube = cuboid(0.2, 0.2, 0.2).unwrap();
        let near = Isometry3::translation(-0.4, -0.7, 0.5);
        for order in [[("#111", near), ("#222", near.inverse())], [("#222", near.inverse()), ("#111", near)]]
        {
            let mut drawing = SvgDrawing::new(&bounds, Projection::Aslant, 100.0, &["cubes".to_owned()]);
            drawing.solids(order.map(|(colour, pose)| (&cube, pose, colour)));
            let text = drawing.finish();
            assert!(text.rfind("#111") > text.rfind("#222") && text.find("#111") > text.rfind("#222"));
        }
        let drawing = SvgDrawing::new(&bounds, Projection::Above, 100.0, &[]);
        assert_eq!(drawing.at(&Point3::new(1.0, -1.0, 0.3)), [100.0, 100.0]);
    }
}
