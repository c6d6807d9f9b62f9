//! A chart of pictures: ꟻLIP or the local error over seconds, both axes logarithmic.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::{PictureChart, PictureKind, PictureRecord};
use crate::base::font::family;
use crate::measure::chart::DrawError;
use crate::measure::chart::axis::LogAxis;
use crate::measure::chart::draw::{COLOURS, Drawn, INK, Plot, axes, headed};

/// Metric that is drawn over the seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureMetric {
    /// Mean ꟻLIP.
    Flip,
    /// The local error of E that 9 of 10 pixels keep.
    Local,
}

impl PictureMetric {
    /// Every metric.
    pub const ALL: [Self; 2] = [Self::Flip, Self::Local];

    /// Name of the metric in file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flip => "flip",
            Self::Local => "local",
        }
    }

    fn axis(self) -> &'static str {
        match self {
            // The bundled font has no ꟻ.
            Self::Flip => "mean FLIP",
            Self::Local => "local error of E, 90th percentile over the pixels, %",
        }
    }

    fn of(self, record: &PictureRecord) -> f64 {
        match self {
            Self::Flip => record.flip,
            Self::Local => 100.0 * record.local.p90,
        }
    }

    /// Part of the metric that is no error of a picture but noise of the converged one.
    fn floor(self, chart: &PictureChart) -> f64 {
        match self {
            Self::Flip => chart.reference.flip_of_halves,
            Self::Local => 100.0 * chart.reference.noise_p90,
        }
    }
}

/// A chart of pictures and the metric that it shows.
#[derive(Clone, Copy, Debug)]
pub struct PictureDrawing<'a> {
    /// The pictures.
    pub chart: &'a PictureChart,
    /// The vertical axis.
    pub metric: PictureMetric,
}

impl Plot for PictureDrawing<'_> {
    fn plot<B: DrawingBackend>(&self, root: &DrawingArea<B, Shift>) -> Result<(), DrawError> {
        let Self { chart, metric } = *self;
        let empty = || DrawError::Empty(chart.scene.clone());
        let x = LogAxis::around(chart.pictures.iter().map(|picture| picture.seconds)).ok_or_else(empty)?;
        let values = chart.pictures.iter().map(|picture| metric.of(picture));
        let y = LogAxis::around(values.chain([metric.floor(chart)])).ok_or_else(empty)?;
        plot(chart, metric, root, (x, y)).map_err(|error| DrawError::Plot(error.to_string()))
    }
}

fn plot<B: DrawingBackend>(
    chart: &PictureChart,
    metric: PictureMetric,
    root: &DrawingArea<B, Shift>,
    (x, y): (LogAxis, LogAxis),
) -> Drawn<B, ()> {
    let text = |size: f64, colour: RGBColor| (family(), size).into_font().color(&colour);
    let title = match metric {
        PictureMetric::Flip => "FLIP",
        PictureMetric::Local => "local error",
    };
    let [width, height] = chart.size;
    let about = format!(
        "{width} × {height} pixels, {} threads; reference: {} samples a pixel",
        chart.threads,
        crate::base::format::count(chart.reference.samples),
    );
    let [area, beside] = headed(root, format!("{}: {title} of pictures over time", chart.scene), about)?;
    let of_axes = ("seconds from the start to the finished picture", metric.axis());
    let mut context = axes(&area, (x, y), of_axes)?;
    let mut legend_y = 30;
    let mut legend = |name: String, style: ShapeStyle| {
        beside.draw(&PathElement::new([(14, legend_y), (54, legend_y)], style))?;
        beside.draw(&Text::new(name, (66, legend_y - 10), text(19.0, INK)))?;
        legend_y += 32;
        Ok(())
    };
    for kind in PictureKind::ALL {
        let of_kind = || chart.pictures.iter().filter(move |picture| picture.kind == kind);
        if of_kind().next().is_none() {
            continue;
        }
        let (colour, stroke) = match kind {
            PictureKind::Mesh => (COLOURS[2], 3),
            PictureKind::Gathered => (COLOURS[0], 3),
            PictureKind::Paths => (INK, 2),
        };
        let places: Vec<(f64, f64)> = of_kind().map(|picture| (picture.seconds, metric.of(picture))).collect();
        context.draw_series(LineSeries::new(places.iter().copied(), colour.stroke_width(stroke)))?;
        context.draw_series(places.iter().map(|place| Circle::new(*place, 5, colour.filled())))?;
        let labels = of_kind().map(|picture| {
            let name = match (picture.error_asked, picture.samples) {
                (Some(error), _) => format!("{} %", crate::base::format::short(100.0 * error)),
                (None, Some(samples)) => samples.to_string(),
                (None, None) => String::new(),
            };
            EmptyElement::at((picture.seconds, metric.of(picture))) + Text::new(name, (8, -18), text(17.0, colour))
        });
        context.draw_series(labels)?;
        let name = match kind {
            PictureKind::Paths => "path tracer, by samples a pixel".to_owned(),
            _ => format!("{}, by target error", kind.name()),
        };
        legend(name, colour.stroke_width(stroke))?;
    }
    let floor = metric.floor(chart);
    if let Some(ends) = chart.pictures.iter().map(|picture| picture.seconds).reduce(f64::max) {
        let first = chart.pictures.iter().map(|picture| picture.seconds).fold(f64::INFINITY, f64::min);
        let line = [(first, floor), (ends, floor)].into_iter().filter(|_| floor > 0.0);
        context.draw_series(DashedLineSeries::new(line, 3, 5, COLOURS[3].stroke_width(2)))?;
        let name = match metric {
            PictureMetric::Flip => "halves of the reference",
            PictureMetric::Local => "error of the reference",
        };
        legend(name.to_owned(), COLOURS[3].stroke_width(2))?;
    }
    root.present()
}
