//! Audit of a finished solution's links: sums of rows, columns, reciprocity and bounds.

use glam::Vec3;

use super::solution::LinkSolution;
use crate::base::cancel::CancelToken;
use crate::hierarchy::{Element, ElementId};

/// Sums over the links of a solution, with what hangs on them.
#[derive(Clone, Debug, Default)]
pub struct Audit {
    /// For each leaf Σ F(r←s)·V over its own links and its ancestors', after rows were limited; in
    /// a closed room of which all is seen each is 1.
    pub rows: Vec<f64>,
    /// For each leaf Σ A_r·F(r←s)·V / A_s over the links of which it or an ancestor is the source:
    /// the share of its light that arrives somewhere.
    pub columns: Vec<f64>,
    /// Area of each of these leaves, m².
    pub areas: Vec<f64>,
    /// Largest radiosity of any leaf, over the bound max B_e/(1−ρ_max) of its colour.
    pub largest_radiosity: f64,
    /// Power Σ A·B over the bound Φ/(1−ρ_max), by the colour where it is largest.
    pub power: f64,
}

/// Audits the stored links and their light.
pub fn audit(solution: &LinkSolution) -> Audit {
    let hierarchy = &solution.hierarchy;
    let elements = hierarchy.elements();
    let never = CancelToken::new();
    let mut light = solution.light.clone();
    let gatherer = solution.gatherer(&solution.links, false);
    // Nobody cancels.
    gatherer.enforce_closure(&mut light, &never);
    let rows = gatherer.rows(&never).unwrap_or_default();
    let rows: Vec<f64> = rows.iter().zip(&light.row_scale).map(|(row, scale)| f64::from(row * scale)).collect();
    // What an element receives of a unit of irradiance, once its leaves' rows are limited, as a
    // mean over its area.
    let mut kept: Vec<f64> = light.row_scale.iter().map(|scale| f64::from(*scale)).collect();
    for (index, element) in elements.iter().enumerate().rev().filter(|(_, element)| !element.is_leaf()) {
        let power: f64 =
            element.children().map(|child| f64::from(hierarchy.element(child).area) * kept[child.index()]).sum();
        kept[index] = if element.area > 0.0 { power / f64::from(element.area) } else { 0.0 };
    }
    let mut columns = vec![0.0; elements.len()];
    for receiver in hierarchy.ids() {
        let area = f64::from(hierarchy.element(receiver).area) * kept[receiver.index()];
        for link in solution.links.of(receiver) {
            columns[link.source().index()] += area * f64::from(link.transfer());
        }
    }
    // What all of an element sends, its parts send alike.
    for (index, element) in elements.iter().enumerate() {
        let from_above = element.parent().map_or(0.0, |parent| columns[parent.index()]);
        columns[index] = from_above + if element.area > 0.0 { columns[index] / f64::from(element.area) } else { 0.0 };
    }
    let is_leaf = |element: &Element| element.is_leaf() && element.is_patch() && element.area > 0.0;
    let leaves: Vec<ElementId> = hierarchy.ids().filter(|id| is_leaf(hierarchy.element(*id))).collect();
    let of = |values: &[f64]| leaves.iter().map(|leaf| values[leaf.index()]).collect();
    let areas: Vec<f64> = leaves.iter().map(|leaf| f64::from(hierarchy.element(*leaf).area)).collect();
    let (mut largest, mut power) = (Vec3::ZERO, glam::DVec3::ZERO);
    for (leaf, area) in leaves.iter().zip(&areas) {
        let radiosity = solution.light.radiosity[leaf.index()];
        largest = largest.max(radiosity);
        power += *area * radiosity.as_dvec3();
    }
    let share = |value: f64, bound: f64| if value > 0.0 { value / bound } else { 0.0 };
    let (bound, gain) = (solution.radiosity_bound(), solution.largest_gain());
    let emitted = solution.scene.emitted_power();
    Audit {
        rows: of(&rows),
        columns: of(&columns),
        areas,
        largest_radiosity: (0..3)
            .map(|colour| share(f64::from(largest[colour]), f64::from(bound[colour])))
            .fold(0.0, f64::max),
        power: (0..3).map(|colour| share(power[colour], f64::from(emitted[colour] * gain[colour]))).fold(0.0, f64::max),
    }
}

impl Audit {
    /// Largest value and the mean by area.
    pub fn largest_and_mean(&self, values: &[f64]) -> (f64, f64) {
        let area: f64 = self.areas.iter().sum();
        let sum: f64 = self.areas.iter().zip(values).map(|(area, value)| area * value).sum();
        (values.iter().copied().fold(0.0, f64::max), if area > 0.0 { sum / area } else { 0.0 })
    }
}
