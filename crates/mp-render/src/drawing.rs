//! Drawings of the plane: areas and lines, as SVG or as pixels.

use crate::canvas::{Colour, mix, resolve, srgb};
use crate::error::{RenderError, check_range, check_size};
use crate::palette::{INK, OBSTACLE};
use crate::picture::Picture;
use crate::text;
use mp_geom::planar::PlanarWorld;
use nalgebra::Point2;
use std::fmt::Write as _;

/// Samples per pixel in each direction.
const SUPERSAMPLING: usize = 3;
/// The margins on the left, top, right and bottom, pixels.
const MARGINS: [f64; 4] = [24.0, 72.0, 24.0, 24.0];
/// Pictures with a side shorter than this have smaller margins, pixels.
const SMALL: f64 = 192.0;

/// The number of shades of a map, and the colour of the strongest.
const SHADES: usize = 24;
const HOT: [f64; 3] = [178.0, 24.0, 43.0];

/// An area or lines, drawn over earlier items.
#[derive(Clone, Debug)]
pub struct Item {
    /// Lines, or the rings of an area, filled by the even-odd rule; metres.
    points: Vec<Vec<Point2<f64>>>,
    colour: u32,
    /// The width of lines, pixels; `None` for areas.
    width: Option<f64>,
    opacity: f64,
}

impl Item {
    /// An area filled with `colour` (`0xRRGGBB`): all points that an odd number of `rings` encloses, metres.
    #[must_use]
    pub fn area(rings: Vec<Vec<Point2<f64>>>, colour: u32) -> Self {
        Self { points: rings, colour, width: None, opacity: 1.0 }
    }

    /// Lines through `points`, metres, of `colour` (`0xRRGGBB`) and `width` pixels.
    #[must_use]
    pub fn lines(points: Vec<Vec<Point2<f64>>>, colour: u32, width: f64) -> Self {
        Self { points, colour, width: Some(width), opacity: 1.0 }
    }

    /// A map of numbers, from white for 0 to red for 1, as areas of one shade each. `corner` is the lower
    /// left corner of the first of its square cells of `cell` metres; `parts` has the numbers, `width` to a
    /// row, row after row from the lowest. Where a number rounds to 0 there is no item.
    #[must_use]
    pub fn shades(corner: Point2<f64>, cell: f64, width: usize, parts: &[f64]) -> Vec<Self> {
        let shade = |part: &f64| (part.clamp(0.0, 1.0) * SHADES as f64).round() as usize;
        let at = |column: usize, row: usize| {
            Point2::new(corner.x + column as f64 * cell, corner.y + row as f64 * cell)
        };
        let mut rings = vec![Vec::new(); SHADES + 1];
        for (row, parts) in parts.chunks_exact(width.max(1)).enumerate() {
            let mut begin = 0;
            for run in parts.chunk_by(|a, b| shade(a) == shade(b)) {
                let (low, high) = (at(begin, row), at(begin + run.len(), row + 1));
                rings[shade(&run[0])].push(vec![
                    low,
                    Point2::new(high.x, low.y),
                    high,
                    Point2::new(low.x, high.y),
                ]);
                begin += run.len();
            }
        }
        let colour = |shade: usize| {
            let part = shade as f64 / SHADES as f64;
            HOT.iter().fold(0, |rgb, c| rgb << 8 | (255.0 + (c - 255.0) * part) as u32)
        };
        let shades = rings.into_iter().enumerate().skip(1).filter(|(_, rings)| !rings.is_empty());
        shades.map(|(shade, rings)| Self::area(rings, colour(shade))).collect()
    }

    /// The same item, translucent; at an opacity of 1 it hides everything behind it.
    #[must_use]
    pub fn faint(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// A drawing of a rectangle of the plane.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// The title, in large letters.
    pub title: String,
    /// The subtitle, in small letters below the title.
    pub subtitle: String,
    /// The lower left corner of the rectangle, metres.
    pub low: Point2<f64>,
    /// The upper right corner of the rectangle, metres.
    pub high: Point2<f64>,
    /// The items, the last on top.
    pub items: Vec<Item>,
}

/// The transform from the world to pixels.
#[derive(Clone, Copy)]
struct WorldToPixels {
    low: Point2<f64>,
    at: [f64; 2],
    scale: f64,
}

impl WorldToPixels {
    fn map(&self, p: &Point2<f64>) -> [f64; 2] {
        [self.at[0] + (p.x - self.low.x) * self.scale, self.at[1] - (p.y - self.low.y) * self.scale]
    }
}

impl Drawing {
    /// The obstacles and walls of `world`, in a rectangle that contains `low`, `high` (metres) and the walls.
    #[must_use]
    pub fn of_world(
        world: &PlanarWorld,
        [low, high]: [Point2<f64>; 2],
        title: impl Into<String>,
        subtitle: impl Into<String>,
    ) -> Self {
        let [low, high] = world.walls().map_or([low, high], |[l, h]| [l.inf(&low), h.sup(&high)]);
        let mut items: Vec<Item> =
            world.polygons().iter().map(|p| Item::area(p.rings().to_vec(), OBSTACLE)).collect();
        let corners = |[l, h]: [Point2<f64>; 2]| vec![l, Point2::new(h.x, l.y), h, Point2::new(l.x, h.y), l];
        items.push(match world.walls() {
            Some(walls) => Item::lines(vec![corners(walls)], INK, 4.0),
            None => Item::lines(vec![corners([low, high])], OBSTACLE, 1.0),
        });
        Self { title: title.into(), subtitle: subtitle.into(), low, high, items }
    }

    /// Refuses sizes and coordinates that cannot be drawn.
    fn check(&self, size: (usize, usize)) -> Result<(), RenderError> {
        check_size(size)?;
        check_range([self.low, self.high].iter().flat_map(|p| [p.x, p.y]), || "the corners".into())?;
        let extent = self.high - self.low;
        if extent.min() < 0.0 || extent.max() <= 0.0 {
            return Err(RenderError::Corners { low: self.low, high: self.high });
        }
        for (n, item) in self.items.iter().enumerate() {
            let points = item.points.iter().flatten().flat_map(|p| [p.x, p.y]);
            check_range(points, || format!("item {}", n + 1))?;
        }
        Ok(())
    }

    fn world_to_pixels(&self, (width, height): (usize, usize)) -> WorldToPixels {
        // Small pictures have smaller margins.
        let share = (width.min(height) as f64 / SMALL).min(1.0);
        let [left, top, right, bottom] = MARGINS.map(|margin| margin * share);
        let (w, h) = (width as f64 - left - right, height as f64 - top - bottom);
        let extent = self.high - self.low;
        let scale = (w / extent.x).min(h / extent.y);
        let at = [left + 0.5 * (w - extent.x * scale), top + 0.5 * (h + extent.y * scale)];
        WorldToPixels { low: self.low, at, scale }
    }

    /// The drawing as SVG, of `size` pixels at its natural size.
    ///
    /// # Errors
    /// When a side is not from 1 to [`MAX_SIDE`](crate::MAX_SIDE) pixels, the rectangle is empty, or a
    /// coordinate is not finite or beyond 10⁶⁰ m.
    pub fn svg(&self, size: (usize, usize)) -> Result<String, RenderError> {
        self.check(size)?;
        let to_pixels = self.world_to_pixels(size);
        let (w, h) = size;
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n"
        );
        for item in &self.items {
            let mut d = String::new();
            for part in &item.points {
                for (i, p) in part.iter().enumerate() {
                    let [x, y] = to_pixels.map(p);
                    let _ = write!(d, "{}{x:.2} {y:.2}", if i == 0 { "M" } else { "L" });
                }
                if item.width.is_none() {
                    d.push('Z');
                }
            }
            let (colour, opacity) = (item.colour, item.opacity);
            let _ = match item.width {
                Some(width) => writeln!(
                    out,
                    "<path d=\"{d}\" fill=\"none\" stroke=\"#{colour:06x}\" stroke-width=\"{width}\" stroke-linejoin=\"round\" \
                     stroke-linecap=\"round\" stroke-opacity=\"{opacity}\"/>"
                ),
                None => writeln!(
                    out,
                    "<path d=\"{d}\" fill=\"#{colour:06x}\" fill-rule=\"evenodd\" fill-opacity=\"{opacity}\"/>"
                ),
            };
        }
        for (words, y, height) in [(&self.title, 34, 20), (&self.subtitle, 58, 13)] {
            let words = words.replace('&', "&amp;").replace('<', "&lt;");
            let _ = writeln!(
                out,
                "<text x=\"24\" y=\"{y}\" font-family=\"sans-serif\" font-size=\"{height}\" fill=\"#{INK:06x}\">{words}</text>"
            );
        }
        Ok(out + "</svg>\n")
    }

    /// The drawing as a picture of `size` pixels.
    ///
    /// # Errors
    /// As [`svg`](Self::svg).
    pub fn pixels(&self, size: (usize, usize)) -> Result<Picture, RenderError> {
        self.check(size)?;
        let fine = (size.0 * SUPERSAMPLING, size.1 * SUPERSAMPLING);
        let factor = SUPERSAMPLING as f64;
        let to_pixels = self.world_to_pixels(size);
        let mut samples = vec![[1.0; 3]; fine.0 * fine.1];
        let put = |p: &Point2<f64>| to_pixels.map(p).map(|v| v * factor);
        for item in &self.items {
            let (colour, opacity) = (srgb(item.colour), item.opacity as f32);
            let Some(width) = item.width else {
                let rings: Vec<Vec<[f64; 2]>> =
                    item.points.iter().map(|r| r.iter().map(put).collect()).collect();
                fill(&rings, fine, |i| samples[i] = mix(samples[i], colour, opacity));
                continue;
            };
            // Samples that several segments cover are drawn once.
            let mut covered = Vec::new();
            for part in &item.points {
                let points: Vec<[f64; 2]> = part.iter().map(put).collect();
                for w in points.windows(2) {
                    fill(&[capsule(w[0], w[1], 0.5 * width * factor)], fine, |i| covered.push(i));
                }
            }
            covered.sort_unstable();
            covered.dedup();
            for i in covered {
                samples[i] = mix(samples[i], colour, opacity);
            }
        }
        let ink: Colour = srgb(INK);
        for (words, y, height, bold) in [(&self.title, 34.0, 15.0, 1.3), (&self.subtitle, 58.0, 9.0, 1.0)] {
            let at = (MARGINS[0] as f32 * factor as f32, y * factor as f32);
            text::write(fine, words, at, height * factor as f32, bold, |i, coverage| {
                samples[i] = mix(samples[i], ink, coverage.clamp(0.0, 1.0));
            });
        }
        Ok(resolve(&samples, fine, SUPERSAMPLING))
    }
}

/// The outline of a thick line with round ends.
fn capsule(a: [f64; 2], b: [f64; 2], half: f64) -> Vec<[f64; 2]> {
    let along = mp_math::atan2(b[1] - a[1], b[0] - a[0]);
    let end = |p: [f64; 2], from: f64| {
        (0..=6).map(move |i| {
            let (s, c) = mp_math::sin_cos(from + f64::from(i) * std::f64::consts::PI / 6.0);
            [p[0] + half * c, p[1] + half * s]
        })
    };
    let right = std::f64::consts::FRAC_PI_2;
    end(b, along - right).chain(end(a, along + right)).collect()
}

/// Calls `fragment` once for each sample whose centre an odd number of rings encloses.
fn fill(rings: &[Vec<[f64; 2]>], (width, height): (usize, usize), mut fragment: impl FnMut(usize)) {
    let ys = rings.iter().flatten().map(|p| p[1]);
    let (low, high) = ys.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y), h.max(y)));
    let first = |v: f64, limit: usize| (v - 0.5).ceil().clamp(0.0, limit as f64) as usize;
    let mut crossings = Vec::new();
    for row in first(low, height)..first(high, height) {
        let y = row as f64 + 0.5;
        crossings.clear();
        for ring in rings {
            for (a, b) in ring.iter().zip(ring.iter().skip(1).chain(ring.first())) {
                if (a[1] > y) != (b[1] > y) {
                    crossings.push(a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]));
                }
            }
        }
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            for column in first(pair[0], width)..first(pair[1], width) {
                fragment(row * width + column);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_show_areas_and_lines() {
        let p = |x: f64, y: f64| Point2::new(x, y);
        let square = |r: f64| vec![p(-r, -r), p(r, -r), p(r, r), p(-r, r)];
        let frame = Item::area(vec![square(2.0), square(1.0)], 0x0000ff);
        let line = Item::lines(vec![vec![p(-3.0, 0.0), p(0.0, 0.0)]], 0xff0000, 4.0).faint(0.5);
        let drawing = Drawing {
            title: "A < B".into(),
            subtitle: String::new(),
            low: p(-4.0, -4.0),
            high: p(4.0, 4.0),
            items: vec![frame, line],
        };
        let svg = drawing.svg((400, 400)).unwrap();
        assert!(
            svg.contains("evenodd") && svg.contains("A &lt; B") && svg.contains("stroke-opacity=\"0.5\"")
        );
        let picture = drawing.pixels((400, 400)).unwrap();
        let to_pixels = drawing.world_to_pixels((400, 400));
        let at = |x: f64, y: f64| {
            let [x, y] = to_pixels.map(&p(x, y));
            picture.pixel(x as usize, y as usize).unwrap()
        };
        assert_eq!(at(0.0, 1.5), [0, 0, 255], "the frame");
        assert_eq!(at(0.5, 0.5), [255, 255, 255], "its hole");
        assert_eq!(at(3.0, 3.0), [255, 255, 255], "outside");
        let [r, g, b] = at(-0.5, 0.0);
        assert!(r == 255 && g == b && (150..220).contains(&g), "half of the line is seen: {r} {g} {b}");
    }

    #[test]
    fn what_cannot_be_drawn_is_said() {
        let p = |x: f64, y: f64| Point2::new(x, y);
        let drawing = |low, high, points| Drawing {
            title: String::new(),
            subtitle: String::new(),
            low,
            high,
            items: vec![Item::lines(vec![points], 0, 1.0)],
        };
        for (low, high, x, words) in [
            (p(0.0, 0.0), p(0.0, 0.0), 0.0, "lower left"),
            (p(1.0, 0.0), p(0.0, 1.0), 0.0, "lower left"),
            (p(0.0, f64::NAN), p(1.0, 1.0), 0.0, "the corners"),
            (p(0.0, 0.0), p(1.0, 1.0), f64::INFINITY, "item 1"),
        ] {
            let drawing = drawing(low, high, vec![p(0.0, 0.0), p(x, 0.0)]);
            let error = drawing.svg((64, 64)).unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
            assert_eq!(drawing.pixels((64, 64)), Err(error));
        }
        let flat = drawing(p(0.0, 0.0), p(1.0, 0.0), vec![p(0.0, 0.0), p(1e60, -1e60)]);
        for size in [(1, 1), (64, 3), (3, 64), (64, 64)] {
            assert!(flat.svg(size).is_ok() && flat.pixels(size).is_ok());
        }
        assert!(flat.pixels((0, 1)).is_err() && flat.svg((9000, 1)).is_err());
    }

    /// Up is up, however small the picture.
    #[test]
    fn small_drawings_have_room_for_the_world() {
        let p = |x: f64, y: f64| Point2::new(x, y);
        let (title, subtitle) = (String::new(), String::new());
        let drawing = Drawing { title, subtitle, low: p(0.0, 0.0), high: p(1.0, 1.0), items: Vec::new() };
        for size in [(1, 1), (64, 64), (96, 64), (128, 96), (192, 192), (640, 480)] {
            let to_pixels = drawing.world_to_pixels(size);
            let ([x0, y0], [x1, y1]) = (to_pixels.map(&drawing.low), to_pixels.map(&drawing.high));
            assert!(0.0 <= x0 && x0 < x1 && x1 <= size.0 as f64, "{size:?}: {x0} {x1}");
            assert!(0.0 <= y1 && y1 < y0 && y0 <= size.1 as f64, "{size:?}: {y1} {y0}");
        }
    }

    #[test]
    fn a_world_has_its_obstacles_and_walls() {
        use mp_geom::planar::Polygon;
        let obstacle = Polygon::rectangle([0.5, 0.5], [1.0, 1.0]).unwrap();
        let world = PlanarWorld::new(vec![obstacle], Some([[0.0; 2], [2.0; 2]])).unwrap();
        let drawing = Drawing::of_world(&world, [Point2::new(0.5, 0.5), Point2::new(3.0, 1.5)], "a", "b");
        assert_eq!((drawing.low, drawing.high), (Point2::new(0.0, 0.0), Point2::new(3.0, 2.0)));
        assert_eq!(drawing.items.len(), 2);
    }
}
