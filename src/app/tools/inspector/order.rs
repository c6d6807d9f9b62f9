//! The order of the table's rows: by any column, either way.

use std::cmp::Ordering;

use crate::app::state::inspection::{Direction, Inspection};
use crate::app::tools::inspector::Subject;
use crate::app::tools::inspector::bars::{brought, in_one};
use crate::transport::{LinkView, VisibilitySource};

/// A column of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    Name,
    Level,
    Brought,
    FormFactor,
    Visibility,
    Rays,
    Power,
    OverEpsilon,
    Error,
}

/// By which column rows are sorted, and the order that came of it.
pub struct Order {
    pub by: Column,
    pub is_ascending: bool,
    made_of: Option<(u64, Column, bool)>,
    rows: Vec<u32>,
}

impl Default for Order {
    fn default() -> Self {
        Self { by: Column::Brought, is_ascending: false, made_of: None, rows: Vec::new() }
    }
}

impl Order {
    /// Sorts by a column: names upwards, numbers downwards at first, the other way when asked
    /// again.
    pub fn choose(&mut self, column: Column) {
        self.is_ascending = if self.by == column { !self.is_ascending } else { column == Column::Name };
        self.by = column;
    }

    /// The links as indices, in order; made anew only when links or order changed.
    pub fn rows(&mut self, subject: &Subject<'_>, inspection: &mut Inspection, direction: Direction) -> &[u32] {
        let now = Some((inspection.stamp, self.by, self.is_ascending));
        if self.made_of != now {
            self.rows = sorted(subject, inspection, direction, self.by, self.is_ascending);
            self.made_of = now;
        }
        &self.rows
    }
}

fn sorted(
    subject: &Subject<'_>,
    inspection: &mut Inspection,
    direction: Direction,
    by: Column,
    is_ascending: bool,
) -> Vec<u32> {
    let count = inspection.links.len();
    let mut rows: Vec<u32> = (0..count as u32).collect();
    let turned = |order: Ordering| if is_ascending { order } else { order.reverse() };
    if by == Column::Name {
        let far: Vec<_> = inspection.links.iter().map(|link| direction.far_end(link)).collect();
        let names: Vec<String> = far.into_iter().map(|id| inspection.names.full(id).to_owned()).collect();
        // Equals stay as they are: what brings most first.
        rows.sort_by(|&a, &b| turned(names[a as usize].cmp(&names[b as usize])));
        return rows;
    }
    let values: Vec<f32> = inspection.links.iter().map(|link| value(subject, link, direction, by)).collect();
    rows.sort_by(|&a, &b| turned(values[a as usize].total_cmp(&values[b as usize])));
    rows
}

/// The number of a column.
pub fn value(subject: &Subject<'_>, link: &LinkView, direction: Direction, column: Column) -> f32 {
    match column {
        Column::Name => 0.0,
        Column::Level => subject.solution_view.depth(direction.far_end(link)).into(),
        Column::Brought => in_one(brought(subject, link, direction), direction),
        Column::FormFactor => link.form_factor,
        Column::Visibility => link.visibility,
        Column::Rays => rays(link).map_or(-1.0, f32::from),
        Column::Power => link.power.element_sum(),
        Column::OverEpsilon => over_epsilon(subject, link),
        Column::Error => subject.solution_view.error(link).total(),
    }
}

/// Rays that tell of a link's visibility; `None` where it is inherited or nobody looked.
pub fn rays(link: &LinkView) -> Option<u16> {
    match link.visibility_source {
        VisibilitySource::Rays(rays) | VisibilitySource::Clear(rays) => Some(rays),
        VisibilitySource::Inherited | VisibilitySource::None => None,
    }
}

/// Power of a link's strongest channel, which ε bounds, as a share of ε.
pub fn over_epsilon(subject: &Subject<'_>, link: &LinkView) -> f32 {
    let power = link.power.max_element();
    match subject.solution_view.epsilon_watts() {
        epsilon if epsilon > 0.0 => (f64::from(power) / epsilon) as f32,
        _ => 0.0,
    }
}
