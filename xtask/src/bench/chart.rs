//! Charts of curves, as SVG.

use crate::output::write;
use miette::{Result, miette};
use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
use std::path::Path;

/// A named curve, with a range about each point where there is one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    pub(crate) name: String,
    /// Index of its colour: curves of the same kind in several charts have the same.
    pub(crate) colour: usize,
    /// x and y of each point; points that are not positive and finite are left out.
    pub(crate) points: Vec<(f64, f64)>,
    /// The x of a point, and from where to where its y may reach.
    pub(crate) ranges: Vec<(f64, f64, f64)>,
    /// Drawn thin, as a companion of another.
    pub(crate) thin: bool,
}

impl Curve {
    /// A curve without ranges.
    pub(crate) fn new(name: impl Into<String>, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), colour, points, ranges: Vec::new(), thin: false }
    }

    /// Drawn thin.
    pub(crate) fn thin(self) -> Self {
        Self { thin: true, ..self }
    }
}

/// What a chart is called, and what its axes are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Labels<'a> {
    pub(crate) title: &'a str,
    pub(crate) x: &'a str,
    pub(crate) y: &'a str,
}

/// Width of a chart, and what of it is for the names of the curves, pixels.
const WIDTH: u32 = 1100;
const LEGEND: u32 = 250;

const COLOURS: [RGBColor; 10] = [
    RGBColor(0x1f, 0x77, 0xb4),
    RGBColor(0xd6, 0x27, 0x28),
    RGBColor(0x2c, 0xa0, 0x2c),
    RGBColor(0x94, 0x67, 0xbd),
    RGBColor(0xe0, 0x82, 0x14),
    RGBColor(0x55, 0x55, 0x55),
    RGBColor(0x17, 0xa2, 0xb8),
    RGBColor(0xb0, 0x59, 0x8a),
    RGBColor(0x8c, 0x56, 0x4b),
    RGBColor(0xbc, 0xbd, 0x22),
];

/// Draws curves over two logarithmic axes; x has a mark at each of `marks`, or where it suits.
pub(crate) fn log_log(labels: Labels<'_>, marks: &[f64], curves: &[Curve]) -> Result<String> {
    let (mut xs, mut ys) = ((f64::INFINITY, 0.0_f64), (f64::INFINITY, 0.0_f64));
    let shown = |v: f64| v > 0.0 && v.is_finite();
    for (x, y) in curves.iter().flat_map(|c| {
        c.points.iter().copied().chain(c.ranges.iter().flat_map(|&(x, low, high)| [(x, low), (x, high)]))
    }) {
        if shown(x) && shown(y) {
            xs = (xs.0.min(x), xs.1.max(x));
            ys = (ys.0.min(y), ys.1.max(y));
        }
    }
    if xs.1 == 0.0 {
        return Err(miette!("nothing to draw in the chart `{}`", labels.title));
    }
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, 600)).into_drawing_area();
        let drawn = || -> std::result::Result<(), DrawingAreaErrorKind<_>> {
            area.fill(&WHITE)?;
            let mut chart = builder(&area, labels).build_cartesian_2d(
                (xs.0 * 0.95..xs.1 * 1.05).log_scale().with_key_points(marks.to_vec()),
                (ys.0 * 0.8..ys.1 * 1.25).log_scale(),
            )?;
            fill(&area, &mut chart, labels, curves, |p| shown(p.0) && shown(p.1))?;
            area.present()
        };
        drawn().map_err(|e| miette!("cannot draw the chart `{}`: {e}", labels.title))?;
    }
    Ok(text)
}

/// A chart with room for its labels and the names of its curves.
fn builder<'a, 'b, DB: DrawingBackend>(
    area: &'a DrawingArea<DB, plotters::coord::Shift>,
    labels: Labels<'_>,
) -> ChartBuilder<'a, 'b, DB> {
    let mut builder = ChartBuilder::on(area);
    builder
        .caption(labels.title, ("sans-serif", 20))
        .margin(16)
        .margin_right(LEGEND)
        .x_label_area_size(48)
        .y_label_area_size(72);
    builder
}

/// The mesh, the curves and their names.
fn fill<DB, X, Y>(
    area: &DrawingArea<DB, plotters::coord::Shift>,
    chart: &mut ChartContext<'_, DB, Cartesian2d<X, Y>>,
    labels: Labels<'_>,
    curves: &[Curve],
    shown: impl Fn((f64, f64)) -> bool,
) -> std::result::Result<(), DrawingAreaErrorKind<DB::ErrorType>>
where
    DB: DrawingBackend,
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    chart
        .configure_mesh()
        .light_line_style(RGBColor(0xf0, 0xf2, 0xf4))
        .bold_line_style(RGBColor(0xdd, 0xe1, 0xe6))
        .x_desc(labels.x)
        .y_desc(labels.y)
        .x_label_formatter(&|v| number(*v))
        .y_label_formatter(&|v| number(*v))
        .draw()?;
    for (i, curve) in curves.iter().enumerate() {
        let colour = COLOURS[curve.colour % COLOURS.len()];
        let style = colour.stroke_width(if curve.thin { 1 } else { 2 });
        let points: Vec<_> = curve.points.iter().copied().filter(|p| shown(*p)).collect();
        chart.draw_series(LineSeries::new(points.iter().copied(), style))?;
        // Beside the curves, where it hides none.
        let (x, y) = (WIDTH as i32 - LEGEND as i32 + 12, 56 + 20 * i as i32);
        area.draw(&PathElement::new([(x, y), (x + 18, y)], style))?;
        area.draw(&Text::new(curve.name.clone(), (x + 24, y - 6), ("sans-serif", 12)))?;
        if points.len() <= 40 && !curve.thin {
            chart.draw_series(points.iter().map(|p| Circle::new(*p, 3, colour.filled())))?;
        }
        let ranges = curve.ranges.iter().filter(|r| shown((r.0, r.1)) && shown((r.0, r.2)));
        chart.draw_series(ranges.map(|&(x, low, high)| {
            PathElement::new([(x, low), (x, high)], colour.mix(0.5).stroke_width(1))
        }))?;
    }
    Ok(())
}

/// Draws curves over two plain axes; that of y begins at zero.
pub(crate) fn plain(labels: Labels<'_>, curves: &[Curve]) -> Result<String> {
    let finite = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let points: Vec<(f64, f64)> =
        curves.iter().flat_map(|c| c.points.iter().copied()).filter(finite).collect();
    let xs = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |b, p| (b.0.min(p.0), b.1.max(p.0)));
    let top = points.iter().fold(0.0, |top: f64, p| top.max(p.1));
    if points.is_empty() {
        return Err(miette!("nothing to draw in the chart `{}`", labels.title));
    }
    let top = if top > 0.0 { 1.05 * top } else { 1.0 };
    let side = if xs.1 > xs.0 { 0.02 * (xs.1 - xs.0) } else { 1.0 };
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, 480)).into_drawing_area();
        let drawn = || -> std::result::Result<(), DrawingAreaErrorKind<_>> {
            area.fill(&WHITE)?;
            let mut chart = builder(&area, labels).build_cartesian_2d(xs.0 - side..xs.1 + side, 0.0..top)?;
            fill(&area, &mut chart, labels, curves, |p| finite(&p))?;
            area.present()
        };
        drawn().map_err(|e| miette!("cannot draw the chart `{}`: {e}", labels.title))?;
    }
    Ok(text)
}

/// Draws shares, from 0 to 1, over a logarithmic axis.
pub(crate) fn shares(labels: Labels<'_>, curves: &[Curve]) -> Result<String> {
    let shown = |p: &(f64, f64)| p.0 > 0.0 && p.0.is_finite() && p.1.is_finite();
    let points = curves.iter().flat_map(|c| c.points.iter().copied()).filter(shown);
    let xs = points.fold((f64::INFINITY, 0.0_f64), |b, p| (b.0.min(p.0), b.1.max(p.0)));
    if xs.1 == 0.0 {
        return Err(miette!("nothing to draw in the chart `{}`", labels.title));
    }
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, 480)).into_drawing_area();
        let drawn = || -> std::result::Result<(), DrawingAreaErrorKind<_>> {
            area.fill(&WHITE)?;
            let mut chart = builder(&area, labels)
                .build_cartesian_2d((xs.0 * 0.95..xs.1 * 1.05).log_scale(), 0.0..1.02)?;
            fill(&area, &mut chart, labels, curves, |p| shown(&p))?;
            area.present()
        };
        drawn().map_err(|e| miette!("cannot draw the chart `{}`: {e}", labels.title))?;
    }
    Ok(text)
}

/// Writes a chart.
pub(crate) fn save(path: &Path, chart: Result<String>) -> Result<()> {
    write(path, chart?.as_bytes())
}

/// Three digits, or a power of ten when it is far from one.
fn number(v: f64) -> String {
    if v == 0.0 {
        return "0".into();
    }
    if (1e-3..1e5).contains(&v) {
        let digits = (2 - v.log10().floor() as i32).max(0) as usize;
        let text = format!("{v:.digits$}");
        return if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').into()
        } else {
            text
        };
    }
    format!("{v:.0e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [0.25, 8.15, 2.0, 512.0, 0.001, 1e-6, 1e6].map(number),
            ["0.25", "8.15", "2", "512", "0.001", "1e-6", "1e6"]
        );
    }

    #[test]
    fn charts_have_curves_and_names() {
        let curve = Curve {
            ranges: vec![(2.0, 0.5, 4.0), (4.0, 0.0, 1.0)],
            ..Curve::new("RSRT", 0, vec![(2.0, 1.0), (4.0, 8.0), (8.0, f64::INFINITY)])
        };
        let labels = Labels { title: "Time", x: "obstacles", y: "s" };
        let text = log_log(labels, &[2.0, 4.0], &[curve]).unwrap();
        assert!(text.contains("RSRT") && text.contains("obstacles") && text.contains("<polyline"));
        assert!(log_log(labels, &[], &[]).is_err());
        let text = plain(labels, &[Curve::new("RRS", 1, vec![(30.0, 0.0), (60.0, 2.0)])]).unwrap();
        assert!(text.contains("RRS") && text.contains("<polyline"));
        assert!(plain(labels, &[]).is_err());
    }
}
