//! Curves over a logarithmic axis.

use crate::camera::Projected;
use crate::canvas::{Colour, mix, resolve, srgb};
use crate::error::{RenderError, check_size};
use crate::palette::INK;
use crate::picture::Picture;
use crate::raster::stroke;
use crate::scene::SUPERSAMPLING;
use crate::text;

/// A named curve.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// Its points from left to right: x is above 0, y at least 0.
    pub points: Vec<(f64, f64)>,
}

const COLOURS: [u32; 6] = [0x1f77b4, 0xd62728, 0x2ca02c, 0x9467bd, 0xe08214, 0x555555];
const GRID: u32 = 0xdde1e6;
const GREY: u32 = 0x66717f;

/// Draws `series` with x on a logarithmic and y on a linear axis from 0, so that logarithmic growth is a
/// straight line; `axes` are the names of both. The picture is blank when there are no points.
///
/// # Errors
/// When a side is not from 1 to [`MAX_SIDE`](crate::MAX_SIDE) pixels, or a point is not on the axes.
pub fn plot(
    title: &str,
    axes: [&str; 2],
    series: &[Series],
    (width, height): (usize, usize),
) -> Result<Picture, RenderError> {
    check_size((width, height))?;
    for s in series {
        let bad = |p: &&(f64, f64)| !(p.0 > 0.0 && p.0.is_finite() && p.1 >= 0.0 && p.1.is_finite());
        if let Some(&(x, y)) = s.points.iter().find(bad) {
            return Err(RenderError::Point { name: s.name.clone(), x, y });
        }
    }
    let size = (width * SUPERSAMPLING, height * SUPERSAMPLING);
    let mut sheet = Sheet { size, colour: vec![[1.0; 3]; size.0 * size.1], unit: size.1 as f32 / 600.0 };
    let points = || series.iter().flat_map(|s| &s.points);
    let decades =
        |edge: fn(f64, f64) -> f64, start: f64| points().map(|p| mp_math::log10(p.0)).fold(start, edge);
    let (low, high) = (decades(f64::min, f64::INFINITY), decades(f64::max, f64::NEG_INFINITY));
    if low > high {
        return Ok(resolve(&sheet.colour, size, SUPERSAMPLING));
    }
    // Points slightly beyond a decade do not need another one.
    let low = (low + 0.05).floor();
    let high = (high - 0.05).ceil().max(low + 1.0);
    let step = nice(points().map(|p| p.1).fold(0.0, f64::max) / 5.0);
    let top = step * (points().map(|p| p.1).fold(0.0, f64::max) / step).ceil().max(1.0);

    let u = sheet.unit;
    let (left, right) = (70.0 * u, size.0 as f32 - 30.0 * u);
    let (up, down) = (80.0 * u, size.1 as f32 - 60.0 * u);
    let at = |x: f64, y: f64| {
        let (x, y) = ((mp_math::log10(x) - low) / (high - low), y / top);
        Projected { x: left + x as f32 * (right - left), y: down - y as f32 * (down - up), key: 0.0 }
    };
    sheet.write(title, (left, 36.0 * u), 13.0, 1.2, INK);
    sheet.write(axes[1], (left, 62.0 * u), 9.5, 1.0, GREY);
    sheet.write_right(axes[0], (right, size.1 as f32 - 14.0 * u), 9.5, GREY);
    for decade in low as i32..=high as i32 {
        let x = mp_math::powi(10.0, decade);
        sheet.line([at(x, 0.0), at(x, top)], 0.6, GRID);
        sheet.write(&short(x), (at(x, 0.0).x - 8.0 * u, down + 20.0 * u), 9.5, 1.0, GREY);
    }
    for i in 0..=(top / step).round() as i32 {
        let y = f64::from(i) * step;
        sheet.line([at(mp_math::powf(10.0, low), y), at(mp_math::powf(10.0, high), y)], 0.6, GRID);
        sheet.write_right(&short(y), (left - 8.0 * u, at(1.0, y).y + 4.0 * u), 9.5, GREY);
    }
    for (i, s) in series.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        for two in s.points.windows(2) {
            sheet.line([at(two[0].0, two[0].1), at(two[1].0, two[1].1)], 1.2, colour);
        }
        for p in &s.points {
            sheet.line([at(p.0, p.1), at(p.0, p.1)], 3.0, colour);
        }
        sheet.write(&s.name, (left + 16.0 * u, up + (16.0 + 20.0 * i as f32) * u), 10.0, 1.2, colour);
    }
    Ok(resolve(&sheet.colour, size, SUPERSAMPLING))
}

/// The samples of the plot.
struct Sheet {
    size: (usize, usize),
    colour: Vec<Colour>,
    /// The unit of lengths: a six-hundredth of the height, samples.
    unit: f32,
}

impl Sheet {
    fn line(&mut self, [from, to]: [Projected; 2], half: f32, colour: u32) {
        let colour = srgb(colour);
        stroke(self.size, from, to, half * self.unit, |i, _, coverage| {
            self.colour[i] = mix(self.colour[i], colour, coverage);
        });
    }

    fn write(&mut self, words: &str, at: (f32, f32), height: f32, bold: f32, colour: u32) {
        let colour = srgb(colour);
        text::write(self.size, words, at, height * self.unit, bold, |i, coverage| {
            self.colour[i] = mix(self.colour[i], colour, coverage);
        });
    }

    fn write_right(&mut self, words: &str, (x, y): (f32, f32), height: f32, colour: u32) {
        let width = text::width(words, height * self.unit);
        self.write(words, (x - width, y), height, 1.0, colour);
    }
}

/// 1, 2 or 5 times a power of ten, at least `step`.
fn nice(step: f64) -> f64 {
    let power = mp_math::powf(10.0, mp_math::log10(step.max(1e-300)).floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|v| *v >= step * (1.0 - 1e-9)).unwrap_or(power)
}

/// The number with k and M for thousands and millions.
fn short(v: f64) -> String {
    let (v, suffix) = if v >= 1e6 {
        (v / 1e6, "M")
    } else if v >= 1e3 {
        (v / 1e3, "k")
    } else {
        (v, "")
    };
    format!("{}{suffix}", (v * 1e6).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_steps_round() {
        assert_eq!([0.2, 5.0, 1e3, 1e6].map(short), ["0.2", "5", "1k", "1M"]);
        for (given, round) in [(0.9, 1.0), (1.0, 1.0), (1.1, 2.0), (23.0, 50.0), (0.07, 0.1)] {
            assert!((nice(given) / round - 1.0).abs() < 1e-9, "{given} {}", nice(given));
        }
    }

    #[test]
    fn curves_leave_ink_and_nothing_leaves_none() {
        let series = Series { name: "a".into(), points: vec![(1e3, 1.0), (1e4, 2.0), (1e6, 3.0)] };
        let ink = |series: &[Series]| {
            let picture = plot("title", ["x", "y"], series, (320, 240)).unwrap();
            assert_eq!((picture.width(), picture.height()), (320, 240));
            picture.rgb().chunks(3).filter(|p| *p != [255; 3]).count()
        };
        assert_eq!(ink(&[]), 0);
        assert!(ink(&[series]) > 1_000);
    }

    #[test]
    fn what_is_on_no_axis_is_refused() {
        let of = |points: &[(f64, f64)]| {
            let series = [Series { name: "a".into(), points: points.to_vec() }];
            plot("title", ["x", "y"], &series, (64, 64)).map(|_| ())
        };
        for point in [(0.0, 1.0), (-1.0, 1.0), (1.0, f64::NAN), (f64::INFINITY, 1.0), (1.0, -1.0)] {
            let error = of(&[(1.0, 1.0), point]).unwrap_err().to_string();
            assert!(error.contains("curve `a`") && error.contains("expected"), "{error}");
        }
        // Far apart, or all in one place.
        for points in [[(1e-300, 0.0), (1e300, 1e300)], [(1.0, 0.0), (1.0, 0.0)], [(1.0, 1e-300), (2.0, 0.0)]]
        {
            assert_eq!(of(&points), Ok(()));
        }
        assert!(plot("title", ["x", "y"], &[], (0, 64)).is_err());
    }
}
