//! The links of a solution as CSV, one row a link.

use std::io::{self, Write};

use rayon::prelude::*;

use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::transport::{Link, SolutionView, VisibilitySource};

/// The columns; [`LinkRow`] says what they hold.
const COLUMNS: &str = "receiver,receiver_kind,receiver_polygon,receiver_area_m2,source,source_kind,source_polygon,source_area_m2,\
    form_factor,visibility,rays,power_w";

/// One link as a row of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkRow {
    /// The end that receives.
    pub receiver: LinkEnd,
    /// The end that sends.
    pub source: LinkEnd,
    /// F(r←s) without occlusion.
    pub form_factor: f32,
    /// V, 0..1.
    pub visibility: f32,
    /// Rays that V is from, where the link was looked at by its own power.
    pub rays: Option<u16>,
    /// Power that it carries to the whole receiver, E·A_r, W (largest colour).
    pub power: f32,
}

/// One end of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkEnd {
    /// The element's number.
    pub element: ElementId,
    /// The scene's polygon of which a patch is a part; `None` for a cluster and for the outside.
    pub polygon: Option<u32>,
    /// Whether it is a part of the sky, or the sun.
    pub is_outside: bool,
    /// Area, m²; of a cluster, the sum of its polygons'.
    pub area: f32,
}

/// The links of a state of a solution, by receiver; those that wait to be judged, with neither rays
/// nor a verdict, lie among them.
pub fn rows(solution_view: &SolutionView) -> Vec<LinkRow> {
    let hierarchy = solution_view.hierarchy();
    let row = |receiver: ElementId, link: &Link| {
        let source = link.source();
        let irradiance = link.irradiance(solution_view.radiosity(source), solution_view.emitted(source));
        LinkRow {
            receiver: LinkEnd::of(hierarchy, receiver),
            source: LinkEnd::of(hierarchy, source),
            form_factor: link.form_factor,
            visibility: link.visibility(),
            rays: match link.visibility_source() {
                VisibilitySource::Rays(rays) | VisibilitySource::Clear(rays) => Some(rays),
                VisibilitySource::None | VisibilitySource::Inherited => None,
            },
            power: irradiance.max_element() * hierarchy.element(receiver).area,
        }
    };
    let receivers: Vec<ElementId> = hierarchy.ids().take(solution_view.links().receivers()).collect();
    let of = |receiver: &ElementId| {
        let links = solution_view.links().of(*receiver);
        links.iter().map(|link| row(*receiver, link)).collect::<Vec<_>>()
    };
    receivers.par_iter().flat_map_iter(of).collect()
}

/// Writes rows with a header.
///
/// # Errors
/// Whatever the writer says.
pub fn write(writer: &mut impl Write, rows: &[LinkRow]) -> io::Result<()> {
    writeln!(writer, "{COLUMNS}")?;
    for row in rows {
        write_end(writer, &row.receiver)?;
        write_end(writer, &row.source)?;
        let rays = row.rays.map_or(String::new(), |rays| rays.to_string());
        writeln!(writer, "{},{},{rays},{}", row.form_factor, row.visibility, row.power)?;
    }
    Ok(())
}

fn write_end(writer: &mut impl Write, end: &LinkEnd) -> io::Result<()> {
    match end.polygon {
        None if end.is_outside => write!(writer, "{},outside,,{},", end.element.0, end.area),
        Some(polygon) => write!(writer, "{},patch,{polygon},{},", end.element.0, end.area),
        None => write!(writer, "{},cluster,,{},", end.element.0, end.area),
    }
}

impl LinkEnd {
    fn of(hierarchy: &Hierarchy, element: ElementId) -> Self {
        let at = hierarchy.element(element);
        let polygon = match &at.shape {
            Shape::Patch(patch) => Some(patch.polygon),
            Shape::Cluster(_) | Shape::Sky(_) => None,
        };
        Self { element, polygon, is_outside: at.is_sky(), area: at.area }
    }
}
