//! Charts of curves, as SVG.

use crate::error::{IntoError, Result};
use crate::experiment::Median;
use crate::output::note;
use mp_plan::{Error, write_file};
use mp_render::Drawing;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use std::ops::Range;
use std::path::Path;

/// A named curve of a chart, with ranges around some of its points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ChartCurve {
    pub(crate) name: String,
    /// The index of its colour; curves of the same kind have the same one in all charts.
    pub(crate) colour: usize,
    /// x and y of each point; points that the axes cannot show are left out.
    pub(crate) points: Vec<(f64, f64)>,
    /// The x of a point, and the lower and upper end of the range of its y: drawn as a band along the curve.
    pub(crate) ranges: Vec<(f64, f64, f64)>,
    /// Whether it is drawn thin, as a companion of another curve.
    pub(crate) thin: bool,
    /// The index of its dashes and markers, which tell it from curves of the same colour.
    pub(crate) pattern: usize,
}

impl ChartCurve {
    /// A curve without ranges.
    pub(crate) fn new(name: impl Into<String>, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), colour, points, ranges: Vec::new(), thin: false, pattern: 0 }
    }

    /// A curve of medians, with their intervals up to `most`.
    pub(crate) fn of_medians(
        name: impl Into<String>,
        colour: usize,
        medians: &[(f64, Median)],
        most: f64,
    ) -> Self {
        let points = medians.iter().map(|(x, m)| (*x, m.median)).collect();
        let ranges = medians.iter().map(|(x, m)| (*x, m.low, m.high.min(most))).collect();
        Self { ranges, ..Self::new(name, colour, points) }
    }

    /// The same curve, drawn thin.
    pub(crate) fn thin(self) -> Self {
        Self { thin: true, ..self }
    }

    /// The same curve with other dashes and markers: solid with discs, dashed with triangles, dotted with
    /// crosses, and long dashes with rings.
    pub(crate) fn pattern(self, pattern: usize) -> Self {
        Self { pattern, ..self }
    }
}

/// Lengths of dashes and of the gaps between them, pixels; the first is a solid line.
const DASHES: [Option<(u32, u32)>; 4] = [None, Some((7, 4)), Some((2, 4)), Some((14, 5))];

/// The title of a chart, and the labels of its axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Labels<'a> {
    pub(crate) title: &'a str,
    pub(crate) x: &'a str,
    pub(crate) y: &'a str,
}

/// Width of a chart, and the part of it for the names of the curves, pixels.
const WIDTH: u32 = 1100;
const LEGEND: u32 = 250;

/// Most curves that one can tell apart in a chart.
pub(crate) const MOST_CURVES: usize = 6;

/// From dark to light, so that they differ without colours too.
const COLOURS: [RGBColor; MOST_CURVES] = [
    RGBColor(0x10, 0x18, 0x20),
    RGBColor(0x4b, 0x2a, 0x8a),
    RGBColor(0xc2, 0x27, 0x2d),
    RGBColor(0x2a, 0x9d, 0x8f),
    RGBColor(0xe8, 0x96, 0x1f),
    RGBColor(0x9b, 0xd0, 0xf0),
];

/// The scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Axis<'a> {
    /// Logarithmic, with automatic marks.
    Log,
    /// Logarithmic, with marks at these values if it is the x axis.
    LogAt(&'a [f64]),
    /// Linear, over the range of the curves.
    Even,
    /// Linear, from zero to this value, or to the greatest of the curves.
    FromZero(Option<f64>),
}

impl Axis<'_> {
    fn shows(&self, v: f64) -> bool {
        v.is_finite() && (v > 0.0 || !matches!(self, Self::Log | Self::LogAt(_)))
    }

    /// The range of the axis for these values; a logarithmic axis extends it by the factors `below` and
    /// `above`.
    fn range(&self, values: impl Iterator<Item = f64>, [below, above]: [f64; 2]) -> Range<f64> {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |b, v| (b.0.min(v), b.1.max(v)));
        let side = if high > low { 0.02 * (high - low) } else { 1.0 };
        match self {
            Self::Log | Self::LogAt(_) => low * below..high * above,
            Self::Even => low - side..high + side,
            Self::FromZero(Some(top)) => 0.0..*top,
            Self::FromZero(None) if high > 0.0 => 0.0..1.05 * high,
            Self::FromZero(None) => 0.0..1.0,
        }
    }
}

/// Charts of any number of curves, each with a suffix for its name: one with all of them, or several, which
/// all have the first curve.
pub(crate) fn charts(
    labels: Labels<'_>,
    axes: [Axis<'_>; 2],
    curves: Vec<ChartCurve>,
) -> Vec<(String, Result<String>)> {
    if curves.len() <= MOST_CURVES {
        return vec![(String::new(), chart(labels, axes, &curves))];
    }
    let parts: Vec<_> = curves[1..].chunks(MOST_CURVES - 1).enumerate().collect();
    let part = |(i, others): (usize, &[ChartCurve])| {
        let own = others.iter().enumerate().map(|(k, curve)| ChartCurve { colour: k + 1, ..curve.clone() });
        let curves: Vec<_> = std::iter::once(curves[0].clone()).chain(own).collect();
        let title = format!("{} ({} of {})", labels.title, i + 1, parts.len());
        (format!("-{}", i + 1), chart(Labels { title: &title, ..labels }, axes, &curves))
    };
    parts.iter().copied().map(part).collect()
}

/// A chart as SVG.
///
/// # Errors
/// When no curve has a point that the axes show, and when there are more than [`MOST_CURVES`], not counting
/// thin companions.
pub(crate) fn chart(labels: Labels<'_>, [x, y]: [Axis<'_>; 2], curves: &[ChartCurve]) -> Result<String> {
    let count = curves.iter().filter(|curve| !curve.thin).count();
    if count > MOST_CURVES {
        return Err(Error::new(format!(
            "the chart `{}` has {count} curves, more than {MOST_CURVES}",
            labels.title
        )));
    }
    let shown = |p: &(f64, f64)| x.shows(p.0) && y.shows(p.1);
    let ends = |c: &ChartCurve| {
        c.ranges.iter().flat_map(|&(x, low, high)| [(x, low), (x, high)]).collect::<Vec<_>>()
    };
    let points: Vec<(f64, f64)> =
        curves.iter().flat_map(|c| c.points.iter().copied().chain(ends(c))).filter(shown).collect();
    if points.is_empty() {
        return Err(Error::new(format!("nothing to draw in the chart `{}`", labels.title)));
    }
    let (xs, ys) =
        (x.range(points.iter().map(|p| p.0), [0.95, 1.05]), y.range(points.iter().map(|p| p.1), [0.8, 1.25]));
    let log = |range: &Range<f64>| range.clone().log_scale();
    let at = |marks: &[f64]| log(&xs).with_key_points(marks.to_vec());
    match (x, y) {
        (Axis::LogAt(marks), Axis::Log | Axis::LogAt(_)) => {
            drawn(labels, 600, (at(marks), log(&ys)), curves, shown)
        }
        (Axis::LogAt(marks), _) => drawn(labels, 480, (at(marks), ys), curves, shown),
        (Axis::Log, Axis::Log | Axis::LogAt(_)) => drawn(labels, 600, (log(&xs), log(&ys)), curves, shown),
        (Axis::Log, _) => drawn(labels, 480, (log(&xs), ys), curves, shown),
        (_, Axis::Log | Axis::LogAt(_)) => drawn(labels, 480, (xs, log(&ys)), curves, shown),
        _ => drawn(labels, 480, (xs, ys), curves, shown),
    }
}

/// Draws curves over axes of any kind.
fn drawn<X, Y>(
    labels: Labels<'_>,
    height: u32,
    (xs, ys): (X, Y),
    curves: &[ChartCurve],
    shown: impl Fn(&(f64, f64)) -> bool,
) -> Result<String>
where
    X: AsRangedCoord<Value = f64, CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>>,
    Y: AsRangedCoord<Value = f64, CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>>,
{
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        let drawn = || -> std::result::Result<(), DrawingAreaErrorKind<_>> {
            area.fill(&WHITE)?;
            let mut chart = builder(&area, labels).build_cartesian_2d(xs, ys)?;
            fill(&area, &mut chart, labels, curves, shown)?;
            area.present()
        };
        drawn().doing(|| format!("cannot draw the chart `{}`", labels.title))?;
    }
    Ok(text)
}

/// A chart with space for its labels and the names of its curves.
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

/// Draws the marker of a curve in the legend and at its points.
macro_rules! marked {
    ($area:ident, $chart:ident, $legend:ident, $points:ident, |$p:ident| $marker:expr) => {{
        let $p = $legend;
        $area.draw(&$marker)?;
        $chart.draw_series($points.iter().map(|&$p| $marker))?;
    }};
}

/// Draws the grid, the curves and their names.
fn fill<DB, X, Y>(
    area: &DrawingArea<DB, plotters::coord::Shift>,
    chart: &mut ChartContext<'_, DB, Cartesian2d<X, Y>>,
    labels: Labels<'_>,
    curves: &[ChartCurve],
    shown: impl Fn(&(f64, f64)) -> bool,
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
    // Bands are below all curves.
    for curve in curves {
        let ranges: Vec<_> =
            curve.ranges.iter().filter(|r| shown(&(r.0, r.1)) && shown(&(r.0, r.2))).collect();
        let upper = ranges.iter().map(|&&(x, _, high)| (x, high));
        let band: Vec<_> = upper.chain(ranges.iter().rev().map(|&&(x, low, _)| (x, low))).collect();
        chart.draw_series([Polygon::new(band, COLOURS[curve.colour % COLOURS.len()].mix(0.15).filled())])?;
    }
    for (i, curve) in curves.iter().enumerate() {
        let colour = COLOURS[curve.colour % COLOURS.len()];
        let style = colour.stroke_width(if curve.thin { 1 } else { 2 });
        let points: Vec<_> = curve.points.iter().copied().filter(&shown).collect();
        let pattern = curve.pattern % DASHES.len();
        match DASHES[pattern] {
            None => chart.draw_series(LineSeries::new(points.iter().copied(), style))?,
            Some((dash, gap)) => {
                chart.draw_series(DashedLineSeries::new(points.iter().copied(), dash, gap, style))?
            }
        };
        // The legend is to the right of the curves and hides none.
        let (x, y) = (WIDTH as i32 - LEGEND as i32 + 12, 56 + 20 * i as i32);
        match DASHES[pattern] {
            None => area.draw(&PathElement::new([(x, y), (x + 24, y)], style))?,
            Some((dash, gap)) => {
                area.draw(&DashedPathElement::new([(x, y), (x + 24, y)], dash, gap, style))?;
            }
        }
        area.draw(&Text::new(curve.name.clone(), (x + 30, y - 6), ("sans-serif", 12)))?;
        if points.len() <= 40 && !curve.thin {
            let legend = (x + 12, y);
            match pattern {
                0 => marked!(area, chart, legend, points, |p| Circle::new(p, 3, colour.filled())),
                1 => marked!(area, chart, legend, points, |p| TriangleMarker::new(p, 5, colour.filled())),
                2 => marked!(area, chart, legend, points, |p| Cross::new(p, 4, colour.stroke_width(2))),
                _ => marked!(area, chart, legend, points, |p| Circle::new(p, 4, colour.stroke_width(1))),
            }
        }
    }
    Ok(())
}

/// Bars of a kind, one for each group of a chart.
#[derive(Clone, Debug)]
pub(crate) struct Bars {
    pub(crate) name: String,
    /// The height of each bar, and the lower and upper end of its range.
    pub(crate) heights: Vec<(f64, f64, f64)>,
}

/// A chart of bars side by side, in groups with these names, as SVG. The x axis has no label.
///
/// # Errors
/// When there is no height to show.
pub(crate) fn bars(labels: Labels<'_>, groups: &[&str], all: &[Bars]) -> Result<String> {
    let highest = all.iter().flat_map(|bars| &bars.heights).map(|h| h.2).filter(|h| h.is_finite());
    let highest = highest.fold(0.0, f64::max);
    if highest == 0.0 {
        return Err(Error::new(format!("nothing to draw in the chart `{}`", labels.title)));
    }
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, 480)).into_drawing_area();
        let drawn = || -> std::result::Result<(), DrawingAreaErrorKind<_>> {
            area.fill(&WHITE)?;
            let (xs, ys) = (0.0..groups.len() as f64, 0.0..1.05 * highest);
            let mut chart = builder(&area, labels).build_cartesian_2d(xs, ys)?;
            // Names are between the marks: each group is one wide.
            let group = |x: &f64| match (x.fract() - 0.5).abs() < 1e-6 {
                true => groups[*x as usize].to_owned(),
                false => String::new(),
            };
            let marks = 2 * groups.len() + 1;
            let mut mesh = chart.configure_mesh();
            mesh.disable_x_mesh().x_labels(marks).x_label_formatter(&group);
            mesh.light_line_style(WHITE).bold_line_style(RGBColor(0xdd, 0xe1, 0xe6));
            mesh.y_desc(labels.y).y_label_formatter(&|v| number(*v)).draw()?;
            let width = 0.8 / all.len() as f64;
            for (i, bars) in all.iter().enumerate() {
                let colour = COLOURS[i % COLOURS.len()];
                for (k, &(height, low, high)) in bars.heights.iter().enumerate() {
                    let left = k as f64 + 0.1 + i as f64 * width;
                    let bar = Rectangle::new([(left, 0.0), (left + 0.92 * width, height)], colour.filled());
                    chart.draw_series([bar])?;
                    let middle = left + 0.46 * width;
                    let range = PathElement::new([(middle, low), (middle, high)], BLACK.stroke_width(1));
                    chart.draw_series([range])?;
                }
                let (x, y) = (WIDTH as i32 - LEGEND as i32 + 12, 56 + 20 * i as i32);
                area.draw(&Rectangle::new([(x, y - 6), (x + 24, y + 6)], colour.filled()))?;
                area.draw(&Text::new(bars.name.clone(), (x + 30, y - 6), ("sans-serif", 12)))?;
            }
            area.present()
        };
        drawn().doing(|| format!("cannot draw the chart `{}`", labels.title))?;
    }
    Ok(text)
}

/// Writes a drawing as SVG and as PNG.
pub(crate) fn save_drawing(stem: &Path, drawing: &Drawing, size: (usize, usize)) -> Result<()> {
    write_file(&stem.with_extension("svg"), drawing.svg(size).into_error()?.as_bytes())?;
    write_file(&stem.with_extension("png"), &drawing.pixels(size).into_error()?.to_png())?;
    note(&format!("written: {}.svg and .png", stem.display()));
    Ok(())
}

/// The number with three digits, or as a power of ten when it is very large or small.
fn number(v: f64) -> String {
    if v == 0.0 {
        return "0".into();
    }
    if (1e-3..1e5).contains(&v) {
        let digits = (2 - mp_math::log10(v).floor() as i32).max(0) as usize;
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

    /// The lightness of colours in grey, CIE L*.
    #[test]
    fn colours_differ_in_grey() {
        let linear = |c: u8| mp_math::powf((f64::from(c) / 255.0 + 0.055) / 1.055, 2.4);
        let lightness = |c: &RGBColor| {
            let y = 0.2126 * linear(c.0) + 0.7152 * linear(c.1) + 0.0722 * linear(c.2);
            116.0 * mp_math::cbrt(y) - 16.0
        };
        let all: Vec<f64> = COLOURS.iter().map(lightness).collect();
        assert!(all.windows(2).all(|pair| pair[0] + 10.0 < pair[1]) && all[5] < 85.0, "{all:?}");
    }

    #[test]
    fn many_curves_are_in_several_charts() {
        let curve = |i: usize| ChartCurve::new(format!("curve {i}"), i, vec![(1.0, 1.0), (2.0, 3.0)]);
        let labels = Labels { title: "Time", x: "obstacles", y: "s" };
        let of = |n: usize| charts(labels, [Axis::Even; 2], (0..n).map(curve).collect());
        assert_eq!(of(6)[0].0, "");
        let [(first, a), (second, b)] = &of(8)[..] else { panic!("not two charts") };
        assert_eq!((first.as_str(), second.as_str()), ("-1", "-2"));
        let (a, b) = (a.as_ref().unwrap(), b.as_ref().unwrap());
        assert!(a.contains("curve 0") && a.contains("curve 5") && !a.contains("curve 6"));
        assert!(b.contains("curve 0") && !b.contains("curve 5") && b.contains("curve 7"));
        assert!(chart(labels, [Axis::Even; 2], &(0..7).map(curve).collect::<Vec<_>>()).is_err());
    }

    #[test]
    fn bars_have_groups_and_names() {
        let of = |name: &str, height| Bars {
            name: name.into(),
            heights: vec![(height, 0.5, 2.0), (1.0, 0.9, 1.1)],
        };
        let labels = Labels { title: "Safety", x: "", y: "cm" };
        let text = bars(labels, &["maze", "high"], &[of("RRT", 1.0), of("RRS", 1.5)]).unwrap();
        assert!(["maze", "high", "RRT", "RRS", "cm"].iter().all(|word| text.contains(word)), "{text}");
        assert!(bars(labels, &["maze"], &[]).is_err());
    }

    #[test]
    fn charts_have_curves_and_names() {
        let curve = ChartCurve {
            ranges: vec![(2.0, 0.5, 4.0), (4.0, 0.0, 1.0)],
            ..ChartCurve::new("RSRT", 0, vec![(2.0, 1.0), (4.0, 8.0), (8.0, f64::INFINITY)])
        };
        let labels = Labels { title: "Time", x: "obstacles", y: "s" };
        let text = chart(labels, [Axis::LogAt(&[2.0, 4.0]), Axis::Log], &[curve]).unwrap();
        assert!(text.contains("RSRT") && text.contains("obstacles") && text.contains("<polyline"));
        assert!(chart(labels, [Axis::Log; 2], &[]).is_err());
        let text = chart(
            labels,
            [Axis::Even, Axis::FromZero(None)],
            &[ChartCurve::new("RRS", 1, vec![(30.0, 0.0), (60.0, 2.0)])],
        )
        .unwrap();
        assert!(text.contains("RRS") && text.contains("<polyline"));
        assert!(chart(labels, [Axis::Even, Axis::FromZero(None)], &[]).is_err());
    }
}
