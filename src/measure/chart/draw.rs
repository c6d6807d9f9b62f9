//! Charts as pictures: error over time, links or rays with bars of its standard error, both axes
//! logarithmic.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::series::DashedLineSeries;

use super::axis::LogAxis;
use super::pareto::front;
use super::record::{Chart, PathTracerRecord, RunRecord};
use crate::base::font::family;
use crate::measure::accuracy::SolutionError;
use crate::transport::Push;

/// Size of a picture, pixels.
const SIZE: (u32, u32) = (1200, 800);

/// Colours that people with any colour vision tell apart \[Okabe, Ito 2008\].
pub(super) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(230, 159, 0),
    RGBColor(213, 94, 0),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(120, 100, 60),
];
/// Pixels at the right that the legend takes.
const LEGEND_WIDTH: u32 = 300;

pub(super) const INK: RGBColor = RGBColor(40, 40, 40);
const FAINT: RGBColor = RGBColor(225, 225, 225);
const FRONT: RGBColor = RGBColor(255, 236, 170);

/// Horizontal axis of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Against {
    /// Seconds, the path tracer beside.
    Seconds,
    /// Links.
    Links,
    /// Visibility rays.
    Rays,
}

/// Which error is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The local error of E that 9 of 10 surfaces keep: the main figure.
    Local,
    /// RMS of B over the area, which few bright places can rule.
    Rms,
}

impl Shown {
    /// Name of the error in a heading, and its definition for the axis.
    pub fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Local => ("local error", "local error of E, 90th percentile of |ΔE|/(E + E0), %"),
            Self::Rms => ("RMS error", "RMS of ΔB over the RMS of B, %"),
        }
    }

    fn of_run(self, error: &SolutionError) -> Uncertain {
        match self {
            Self::Local => Uncertain { error: error.local.p90, noise: error.local.p90_noise },
            Self::Rms => Uncertain { error: error.displayed.rms, noise: error.displayed.rms_noise },
        }
    }

    fn of_path_tracer(self, record: &PathTracerRecord) -> Uncertain {
        match self {
            Self::Local => Uncertain { error: record.local.p90, noise: record.local.p90_noise },
            Self::Rms => Uncertain { error: record.error, noise: record.error_noise },
        }
    }
}

/// An error and its standard error, shares.
#[derive(Clone, Copy)]
struct Uncertain {
    error: f64,
    noise: f64,
}

/// A mark in a chart.
#[derive(Clone, Copy)]
struct Point {
    cost: f64,
    error: Uncertain,
}

impl Point {
    /// Where it lies, the error in per cent.
    fn place(&self) -> (f64, f64) {
        (self.cost, 100.0 * self.error.error)
    }

    /// One standard error below and above, per cent.
    fn ends(&self) -> [f64; 2] {
        [-1.0, 1.0].map(|sign| 100.0 * (self.error.error + sign * self.error.noise))
    }
}

/// A chart with its two axes.
#[derive(Clone, Copy, Debug)]
pub struct Drawing<'a> {
    /// The runs.
    pub chart: &'a Chart,
    /// The horizontal axis.
    pub against: Against,
    /// The vertical axis.
    pub shown: Shown,
}

/// Why a chart cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// No run finished.
    #[error("no run of {0} finished, so there is nothing to draw: give more --seconds or a coarser --epsilons")]
    Empty(String),
    /// The drawing library failed.
    #[error("the chart cannot be drawn ({0})")]
    Plot(String),
}

/// A chart that any backend of the drawing library can draw.
pub trait Plot {
    /// Draws it.
    ///
    /// # Errors
    /// There is nothing to draw.
    fn plot<B: DrawingBackend>(&self, root: &DrawingArea<B, Shift>) -> Result<(), DrawError>;
}

/// A chart as RGB pixels of 1200 × 800, row by row.
///
/// # Errors
/// There is nothing to draw.
pub fn draw_png(chart: &impl Plot) -> Result<image::RgbImage, DrawError> {
    let mut pixels = vec![0; (3 * SIZE.0 * SIZE.1) as usize];
    chart.plot(&BitMapBackend::with_buffer(&mut pixels, SIZE).into_drawing_area())?;
    Ok(image::RgbImage::from_raw(SIZE.0, SIZE.1, pixels).expect("three bytes for each pixel"))
}

/// A chart as SVG.
///
/// # Errors
/// There is nothing to draw.
pub fn draw_svg(chart: &impl Plot) -> Result<String, DrawError> {
    let mut text = String::new();
    chart.plot(&SVGBackend::with_string(&mut text, SIZE).into_drawing_area())?;
    Ok(text)
}

/// A setting's line.
struct Curve<'a> {
    name: &'a str,
    colour: RGBColor,
    /// Deferred push: dashed, with open marks.
    open: bool,
    points: Vec<Point>,
    runs: Vec<&'a RunRecord>,
}

impl Plot for Drawing<'_> {
    fn plot<B: DrawingBackend>(&self, root: &DrawingArea<B, Shift>) -> Result<(), DrawError> {
        let (drawing, chart) = (*self, self.chart);
        let curves = curves(drawing);
        let of_record =
            |record: &PathTracerRecord| Point { cost: record.seconds, error: drawing.shown.of_path_tracer(record) };
        let path_tracer: Vec<Point> = match drawing.against {
            Against::Seconds => chart.path_tracer.iter().map(of_record).collect(),
            Against::Links | Against::Rays => Vec::new(),
        };
        if curves.is_empty() {
            return Err(DrawError::Empty(chart.scene.clone()));
        }
        let empty = || DrawError::Empty(chart.scene.clone());
        let every = || curves.iter().flat_map(|curve| &curve.points).chain(&path_tracer);
        let x = LogAxis::around(every().map(|point| point.cost)).ok_or_else(empty)?;
        // Bars are seen as far as twice the error and half of it; what is longer ends at the axis.
        let tall = |point: &Point| {
            let (_, error) = point.place();
            let [low, high] = point.ends();
            [error, low.max(0.5 * error), high.min(2.0 * error)]
        };
        let y = LogAxis::around(every().flat_map(tall)).ok_or_else(empty)?;
        plot(drawing, root, &curves, &path_tracer, (x, y)).map_err(|error| DrawError::Plot(error.to_string()))
    }
}

fn plot<B: DrawingBackend>(
    drawing: Drawing,
    root: &DrawingArea<B, Shift>,
    curves: &[Curve],
    path_tracer: &[Point],
    (x, y): (LogAxis, LogAxis),
) -> Drawn<B, ()> {
    let chart = drawing.chart;
    let text = |size: f64, colour: RGBColor| (family(), size).into_font().color(&colour);
    let (measure, of_measure) = drawing.shown.names();
    let (title, unit) = match drawing.against {
        Against::Seconds => ("time", "seconds of solving"),
        Against::Links => ("links", "links"),
        Against::Rays => ("rays", "visibility rays"),
    };
    let [area, beside] = headed(root, format!("{}: {measure} over {title}", chart.scene), subtitle(chart))?;
    let mut context = axes(&area, (x, y), (unit, of_measure))?;

    let mut best: Vec<(f64, f64)> = best_of(curves);
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    context.draw_series(LineSeries::new(best, FRONT.stroke_width(16)))?;
    // Beneath all lines and marks.
    let groups = curves.iter().map(|curve| (curve.colour, &curve.points[..])).chain([(INK, path_tracer)]);
    for (colour, points) in groups {
        let bar = |point: &Point| {
            let [low, high] = point.ends();
            let (low, high) = y.clip(low, high)?;
            Some(PathElement::new([(point.cost, low), (point.cost, high)], colour.stroke_width(1)))
        };
        context.draw_series(points.iter().filter_map(bar))?;
    }
    if !path_tracer.is_empty() {
        let line: Vec<(f64, f64)> = path_tracer.iter().map(Point::place).collect();
        context.draw_series(DashedLineSeries::new(line.iter().copied(), 3, 5, INK.stroke_width(2)))?;
        context.draw_series(line.iter().map(|point| Cross::new(*point, 4, INK.stroke_width(2))))?;
    }
    for curve in curves {
        let line: Vec<(f64, f64)> = curve.points.iter().map(Point::place).collect();
        let (colour, open) = (curve.colour, curve.open);
        if open {
            context.draw_series(DashedLineSeries::new(line.iter().copied(), 9, 6, colour.stroke_width(2)))?;
            context.draw_series(line.iter().map(|point| Circle::new(*point, 5, WHITE.filled())))?;
            context.draw_series(line.iter().map(|point| Circle::new(*point, 5, colour.stroke_width(2))))?;
        } else {
            context.draw_series(LineSeries::new(line.iter().copied(), colour.stroke_width(3)))?;
            context.draw_series(line.iter().map(|point| Circle::new(*point, 5, colour.filled())))?;
        }
    }
    if let Some(curve) = curves.first() {
        let labels = curve.points.iter().zip(&curve.runs).map(|(point, run)| {
            let style = text(17.0, curve.colour);
            EmptyElement::at(point.place()) + Text::new(format!("ε {:.0e}", run.epsilon_relative), (-62, 10), style)
        });
        context.draw_series(labels)?;
    }
    legend(chart, curves, !path_tracer.is_empty(), &beside)?;
    root.present()
}

/// Names of the curves, one below the other.
fn legend<B: DrawingBackend>(
    chart: &Chart,
    curves: &[Curve],
    has_path_tracer: bool,
    area: &DrawingArea<B, Shift>,
) -> Drawn<B, ()> {
    let mut y = 30;
    let name = |text: &str, y: i32| {
        let style = (family(), 19.0).into_font().color(&INK);
        area.draw(&Text::new(text.to_owned(), (66, y - 10), style))
    };
    let line =
        |from: i32, to: i32, y: i32, style: ShapeStyle| area.draw(&PathElement::new([(from, y), (to, y)], style));
    for curve in curves {
        let (colour, width) = (curve.colour, if curve.open { 2 } else { 3 });
        let gap = if curve.open { 10 } else { 20 };
        line(14, 14 + gap, y, colour.stroke_width(width))?;
        line(54 - gap, 54, y, colour.stroke_width(width))?;
        let dot = if curve.open { colour.stroke_width(2) } else { colour.filled() };
        area.draw(&Circle::new((34, y), 5, dot))?;
        name(curve.name, y)?;
        y += 32;
    }
    if has_path_tracer {
        for from in [14, 22, 42, 50] {
            line(from, from + 4, y, INK.stroke_width(2))?;
        }
        area.draw(&Cross::new((34, y), 4, INK.stroke_width(2)))?;
        name(&format!("path tracer at {} points", crate::base::format::count(path_tracer_points(chart))), y)?;
        y += 32;
    }
    line(14, 54, y, FRONT.stroke_width(16))?;
    name("Pareto front", y)?;
    y += 32;
    area.draw(&PathElement::new([(34, y - 11), (34, y + 11)], INK.stroke_width(1)))?;
    name("±1 standard error", y)
}

fn curves(drawing: Drawing<'_>) -> Vec<Curve<'_>> {
    let mut curves: Vec<Curve> = Vec::new();
    let mut modes = Vec::new();
    for run in drawing.chart.runs.iter().filter(|run| run.converged) {
        let cost = match drawing.against {
            Against::Seconds => run.seconds.total,
            Against::Links => run.links as f64,
            Against::Rays => run.rays as f64,
        };
        let error = drawing.shown.of_run(&run.error);
        if !(cost > 0.0 && error.error > 0.0) {
            continue;
        }
        if curves.last().is_none_or(|curve| curve.name != run.setting) {
            // A clustering keeps its colour for either push; a setting that differs in something
            // else gets its own.
            let open = run.params.push == Push::Deferred;
            let taken = curves.iter().any(|curve| {
                let other = &curve.runs[0].params;
                (other.clustering, other.push) == (run.params.clustering, run.params.push)
            });
            let mode = (run.params.clustering, taken.then(|| run.setting.clone()));
            let index = modes.iter().position(|known| *known == mode).unwrap_or_else(|| {
                modes.push(mode);
                modes.len() - 1
            });
            let colour = COLOURS[index % COLOURS.len()];
            curves.push(Curve { name: &run.setting, colour, open, points: Vec::new(), runs: Vec::new() });
        }
        if let Some(curve) = curves.last_mut() {
            curve.points.push(Point { cost, error });
            curve.runs.push(run);
        }
    }
    curves
}

fn best_of(curves: &[Curve]) -> Vec<(f64, f64)> {
    let points: Vec<(f64, f64)> = curves.iter().flat_map(|curve| &curve.points).map(Point::place).collect();
    let marks = front(&points);
    points.into_iter().zip(marks).filter(|(_, is_best)| *is_best).map(|(point, _)| point).collect()
}

fn subtitle(chart: &Chart) -> String {
    let reference = &chart.reference;
    format!(
        "{} polygons, {} threads; reference: {} points weighted by area, noise {:.1} %, subtracted; E0: a tenth of the median E",
        crate::base::format::count(chart.polygons),
        chart.threads,
        crate::base::format::count(reference.points),
        100.0 * reference.noise
    )
}

fn path_tracer_points(chart: &Chart) -> usize {
    chart.path_tracer.first().map_or(0, |record| record.points)
}

/// Result of drawing a part of a chart.
pub(super) type Drawn<B, T> = Result<T, DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// Writes the headings of a chart; gives the area of its plot and, beside it, that of its legend:
/// no corner of the plot is free in every chart.
pub(super) fn headed<B: DrawingBackend>(
    root: &DrawingArea<B, Shift>,
    title: String,
    about: String,
) -> Drawn<B, [DrawingArea<B, Shift>; 2]> {
    let text = |size: f64, colour: RGBColor| (family(), size).into_font().color(&colour);
    root.fill(&WHITE)?;
    root.draw(&Text::new(title, (90, 22), text(32.0, INK)))?;
    root.draw(&Text::new(about, (90, 62), text(19.0, RGBColor(110, 110, 110))))?;
    let (_, area) = root.split_vertically(92);
    Ok(area.split_horizontally(SIZE.0 - LEGEND_WIDTH).into())
}

/// A chart whose axes are both logarithmic.
type LogContext<'a, B> = ChartContext<'a, B, Cartesian2d<LogAxis, LogAxis>>;

/// Both axes with their names and numbers, and the lines across.
pub(super) fn axes<'a, B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    (x, y): (LogAxis, LogAxis),
    (along, upwards): (&str, &str),
) -> Drawn<B, LogContext<'a, B>> {
    let text = |size: f64| (family(), size).into_font().color(&INK);
    let mut context = ChartBuilder::on(area)
        .margin_right(28)
        .margin_left(26)
        .margin_bottom(12)
        .x_label_area_size(64)
        .y_label_area_size(74)
        .build_cartesian_2d(x, y)?;
    context
        .configure_mesh()
        .x_desc(along)
        .y_desc(upwards)
        .x_labels(11)
        .y_labels(9)
        .x_label_formatter(&|value| tick(*value))
        .y_label_formatter(&|value| tick(*value))
        .bold_line_style(FAINT)
        .light_line_style(TRANSPARENT)
        .axis_style(RGBColor(150, 150, 150))
        .label_style(text(20.0))
        .axis_desc_style(text(22.0))
        .draw()?;
    Ok(context)
}

/// A number at an axis: 0.05, 20, 1 M.
fn tick(value: f64) -> String {
    let scaled = |value: f64, unit: &str| format!("{}{unit}", (1e3 * value).round() / 1e3);
    match value {
        value if value >= 0.9e6 => scaled(value / 1e6, " M"),
        value if value >= 0.9e3 => scaled(value / 1e3, " k"),
        value if value >= 0.9e-3 => scaled(value, ""),
        _ => format!("{value:.0e}"),
    }
}
