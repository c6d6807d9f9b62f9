//! The links of a solution as CSV, one row a link.

use std::fmt::Write as _;
use std::io::{self, Write};

use rayon::prelude::*;

use crate::hierarchy::{ElementId, Shape};
use crate::transport::{SolutionView, VisibilitySource};

/// The columns. An end of a link has a number, a kind, the scene's polygon if it is a patch, and
/// its area, m²; of a cluster, the sum of its polygons'. Then F without occlusion, V, the rays that
/// V is from where the link was looked at by its own power, and the power that it carries to the
/// whole receiver, E·A_r, W (largest colour).
const COLUMNS: &str = "receiver,receiver_kind,receiver_polygon,receiver_area_m2,source,source_kind,source_polygon,source_area_m2,\
    form_factor,visibility,rays,power_w";

/// Receivers whose rows are held in memory at once.
const RECEIVERS_AT_ONCE: usize = 1 << 14;

/// Writes the links of a state of a solution, by receiver, with a header; those that wait to be
/// judged, with neither rays nor a verdict, lie among them.
///
/// # Errors
/// Whatever the writer says.
pub fn write(writer: &mut impl Write, solution_view: &SolutionView) -> io::Result<()> {
    writeln!(writer, "{COLUMNS}")?;
    let receivers = solution_view.hierarchy().ids().take(solution_view.links().receivers());
    for part in receivers.collect::<Vec<_>>().chunks(RECEIVERS_AT_ONCE) {
        let rows: Vec<String> = part.par_iter().map(|receiver| rows(solution_view, *receiver)).collect();
        rows.iter().try_for_each(|rows| writer.write_all(rows.as_bytes()))?;
    }
    Ok(())
}

fn rows(solution_view: &SolutionView, receiver: ElementId) -> String {
    let mut text = String::new();
    for link in solution_view.links().of(receiver) {
        let source = link.source();
        let irradiance = link.irradiance(solution_view.radiosity(source), solution_view.emitted(source));
        let power = irradiance.max_element() * solution_view.hierarchy().element(receiver).area;
        let rays = match link.visibility_source() {
            VisibilitySource::Rays(rays) | VisibilitySource::Clear(rays) => rays.to_string(),
            VisibilitySource::None | VisibilitySource::Inherited => String::new(),
        };
        let (receiver, source) = (end(solution_view, receiver), end(solution_view, source));
        // A String takes any text.
        let _ = writeln!(text, "{receiver},{source},{},{},{rays},{power}", link.form_factor, link.visibility());
    }
    text
}

/// The columns of one end of a link.
fn end(solution_view: &SolutionView, id: ElementId) -> String {
    let element = solution_view.hierarchy().element(id);
    match &element.shape {
        Shape::Patch(patch) => format!("{},patch,{},{}", id.0, patch.polygon, element.area),
        _ if element.is_sky() => format!("{},outside,,{}", id.0, element.area),
        _ => format!("{},cluster,,{}", id.0, element.area),
    }
}
