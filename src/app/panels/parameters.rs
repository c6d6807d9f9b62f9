//! One widget for each of [`PARAMETERS`], made from its kind, range, unit and hint.

use egui::{ComboBox, Slider, Ui};

use crate::app::panels::costs;
use crate::app::widgets::{rows, theme};
use crate::app::{format, words};
use crate::base::memory::MemoryBudget;
use crate::solve::{
    ClusteringMode, Epsilon, PARAMETERS, Parameter, ParameterId, SolverParams, Stats, USUAL_ERROR, ValueKind,
};

/// ε as it stands, in both measures.
#[derive(Clone, Copy)]
struct EpsilonMeasures {
    relative: f64,
    watts: f64,
}

impl EpsilonMeasures {
    /// The measure that a person did not set follows from the emitted power: that of now, or for an
    /// ε that is in force already that by which it was set.
    fn new(epsilon: Epsilon, stats: Option<&Stats>) -> Self {
        let power = stats.map_or(0.0, |stats| stats.power_watts);
        match epsilon {
            Epsilon::Relative(relative) => {
                let in_force = |stats: &&Stats| {
                    (relative * stats.anchor_watts - stats.epsilon_watts).abs() <= 1e-9 * stats.epsilon_watts
                };
                let watts = stats.filter(in_force).map_or(relative * power, |stats| stats.epsilon_watts);
                Self { relative, watts }
            }
            Epsilon::Watts(watts) => Self { relative: if power > 0.0 { watts / power } else { 0.0 }, watts },
        }
    }
}

/// Draws one parameter that is set outside of the method's fold.
pub fn show_one(ui: &mut Ui, id: ParameterId, params: &mut SolverParams, stats: Option<&Stats>) {
    if let Some(parameter) = PARAMETERS.iter().find(|parameter| parameter.id == id) {
        show_row(ui, parameter, params, stats);
    }
}

/// Draws the method's parameters, each with its sentence; true when one was changed.
pub fn show_method(ui: &mut Ui, params: &mut SolverParams, stats: Option<&Stats>) -> bool {
    let before = *params;
    rows::sentence(ui, theme::weak(words::PAPER).small());
    ui.add_space(3.0);
    show_what_ends_a_solve(ui, params);
    let of_method = |parameter: &&Parameter| !matches!(parameter.id, ParameterId::Error | ParameterId::Memory);
    for parameter in PARAMETERS.iter().filter(of_method) {
        let reason = show_row(ui, parameter, params, stats);
        let sentence = reason.unwrap_or(parameter.hint);
        rows::sentence(ui, theme::weak(sentence).small());
        ui.add_space(3.0);
    }
    if ui.button("Reset to defaults").clicked() {
        *params = SolverParams::usual();
    }
    *params != before
}

/// Why a parameter changes nothing at present.
fn reason_of_no_effect(id: ParameterId, params: &SolverParams, stats: Option<&Stats>) -> Option<&'static str> {
    let by_error = params.error.is_some();
    match id {
        ParameterId::Error if !by_error => Some("Used with the choice Stop at: target error."),
        ParameterId::Epsilon | ParameterId::EpsilonWatts if by_error => {
            Some("Chosen by the solver for the target error; used with the choice Stop at: link threshold ε.")
        }
        ParameterId::Reconstruct if by_error => {
            Some("A target error needs the final gather; used with the choice Stop at: link threshold ε.")
        }
        // Without light there are no watts to measure by.
        ParameterId::EpsilonWatts if EpsilonMeasures::new(params.threshold(), stats).watts <= 0.0 => {
            Some("Nothing in the scene emits light, so there are no watts to measure by.")
        }
        ParameterId::OctreeDepth if params.clustering != ClusteringMode::Octree => {
            Some("Used with the choice Clustering: octree.")
        }
        _ => None,
    }
}

/// The choice what ends a solve: the certified error, for which the solver chooses ε, or ε itself.
fn show_what_ends_a_solve(ui: &mut Ui, params: &mut SolverParams) {
    rows::row(ui, "Stop at", |ui| {
        let response = ui.horizontal_wrapped(|ui| {
            let by_error = ui.selectable_label(params.error.is_some(), "target error");
            if by_error.clicked() && params.error.is_none() {
                params.error = Some(USUAL_ERROR);
            }
            if ui.selectable_label(params.error.is_none(), words::STOP_AT_THRESHOLD).clicked() {
                params.error = None;
            }
        });
        response.response
    })
    .on_hover_text(
        "At a target error the solver refines no further than it must; at a threshold ε it refines as the paper does",
    );
}

/// The row of a parameter; why it has no effect, where it has none.
fn show_row(
    ui: &mut Ui,
    parameter: &Parameter,
    params: &mut SolverParams,
    stats: Option<&Stats>,
) -> Option<&'static str> {
    let reason = reason_of_no_effect(parameter.id, params, stats);
    ui.add_enabled_ui(reason.is_none(), |ui| {
        let row = rows::row(ui, parameter.label, |ui| show_widget(ui, parameter, params, stats));
        costs::show_mark(ui, row.rect, parameter);
        let row = row.on_hover_ui(|ui| {
            ui.set_max_width(ui.spacing().tooltip_width);
            ui.label(parameter.hint);
            ui.label(theme::weak(costs::sentence(parameter)));
        });
        row.on_disabled_hover_text(reason.unwrap_or_default());
    });
    reason
}

fn show_widget(ui: &mut Ui, parameter: &Parameter, params: &mut SolverParams, stats: Option<&Stats>) -> egui::Response {
    match &parameter.kind {
        ValueKind::Real { range, logarithmic } => {
            let id = parameter.id;
            let epsilon = EpsilonMeasures::new(params.threshold(), stats);
            let mut value = real(params, id, epsilon);
            let slider = Slider::new(&mut value, range.clone())
                .logarithmic(*logarithmic)
                // What came from the command line may lie outside of what the slider offers, and
                // stays.
                .clamping(egui::SliderClamping::Edits)
                .smart_aim(false)
                .custom_formatter(move |value, _| real_text(id, value))
                .custom_parser(move |text| real_value(id, text))
                .suffix(suffix(parameter.unit));
            let response = ui.add(slider);
            if response.changed() {
                params.set_real(parameter.id, value);
            }
            response
        }
        ValueKind::Whole { range } => {
            let id = parameter.id;
            let mut value = params.whole(id).unwrap_or_default();
            let suffix = suffix_of(value, parameter.unit);
            let slider = Slider::new(&mut value, range.clone())
                .clamping(egui::SliderClamping::Edits)
                .logarithmic(*range.end() > 100)
                .custom_formatter(move |value, _| whole_text(id, value))
                .custom_parser(move |text| whole_value(id, text))
                .suffix(suffix);
            let response = ui.add(slider);
            if response.changed() {
                set_whole(params, parameter.id, value);
            }
            response
        }
        ValueKind::Choice { names } => show_choice(ui, parameter.id, names, params),
    }
}

fn show_choice(
    ui: &mut Ui,
    id: ParameterId,
    names: &[(&'static str, &'static str)],
    params: &mut SolverParams,
) -> egui::Response {
    let in_window = |shown: &str| shown.replace('-', " ");
    let in_force = SolverParams { reconstruct: params.shown_by(), ..*params }.choice(id);
    let chosen = names.iter().find(|(name, _)| Some(*name) == in_force.as_deref());
    let text = chosen.map_or(AS_THE_SCENE_SAYS.to_owned(), |(_, shown)| in_window(shown));
    let mut newly = None;
    let combo = ComboBox::from_id_salt(("choice", text.len(), id as usize)).selected_text(text);
    let inner = combo.show_ui(ui, |ui| {
        if id == ParameterId::Sides && ui.selectable_label(chosen.is_none(), AS_THE_SCENE_SAYS).clicked() {
            newly = Some(None);
        }
        for (name, shown) in names {
            if ui.selectable_label(chosen.is_some_and(|(chosen, _)| chosen == name), in_window(shown)).clicked() {
                newly = Some(Some(*name));
            }
        }
    });
    if let Some(name) = newly {
        params.choose(id, name);
    }
    inner.response
}

/// The choice of sides that leaves it to the file.
const AS_THE_SCENE_SAYS: &str = "as the scene says";

fn suffix(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// The unit of so many things: one level has no s.
fn suffix_of(count: u64, unit: &str) -> String {
    suffix(if count == 1 { unit.trim_end_matches('s') } else { unit })
}

/// Words for 0 threads.
const ALL_CORES: &str = "all cores";

/// An error is shown in percent.
fn real_text(id: ParameterId, value: f64) -> String {
    match id {
        ParameterId::Error => format!("{} %", format::short(100.0 * value)),
        ParameterId::Memory => format::bytes(MemoryBudget::Share(value).bytes() as usize),
        _ => format::number(value),
    }
}

fn real_value(id: ParameterId, text: &str) -> Option<f64> {
    match id {
        ParameterId::Error => text.replace('%', "").trim().parse::<f64>().ok().map(|percent| percent / 100.0),
        ParameterId::Memory => text.parse::<MemoryBudget>().ok().map(MemoryBudget::share),
        _ => text.trim().parse().ok(),
    }
}

fn whole_text(id: ParameterId, value: f64) -> String {
    match id {
        ParameterId::Threads if value == 0.0 => ALL_CORES.to_owned(),
        _ => format::count(value.round() as u64),
    }
}

fn whole_value(id: ParameterId, text: &str) -> Option<f64> {
    match id {
        ParameterId::Threads if text.trim() == ALL_CORES => Some(0.0),
        _ => text.replace(',', "").trim().parse().ok(),
    }
}

fn real(params: &SolverParams, id: ParameterId, epsilon: EpsilonMeasures) -> f64 {
    match id {
        ParameterId::Epsilon => epsilon.relative,
        ParameterId::EpsilonWatts => epsilon.watts,
        // No other is missing than an error that is not asked for.
        _ => params.real(id).unwrap_or(USUAL_ERROR),
    }
}

fn set_whole(params: &mut SolverParams, id: ParameterId, value: u64) {
    params.set_whole(id, value);
    // Each bound pushes the other along, so that a drag never asks for what cannot be.
    match id {
        ParameterId::RaysMin => params.rays_max = params.rays_max.max(params.rays_min),
        ParameterId::RaysMax => params.rays_min = params.rays_min.min(params.rays_max),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Sides;
    use crate::transport::ClusterModel;

    /// Truth: setting what was read changes nothing, setting something else changes it, for every
    /// parameter of the table.
    #[test]
    fn every_parameter_can_be_read_and_set() {
        let stats = Stats { power_watts: 500.0, anchor_watts: 500.0, epsilon_watts: 0.05, ..Stats::default() };
        for parameter in &PARAMETERS {
            // No choice is the last of its kind.
            let before = SolverParams {
                clustering: ClusteringMode::Octree,
                cluster_model: ClusterModel::Isotropic,
                sides: Some(Sides::Front),
                ..Default::default()
            };
            let mut after = before;
            match &parameter.kind {
                ValueKind::Real { range, .. } => {
                    let middle = (range.start() * range.end()).sqrt() * 1.1;
                    after.set_real(parameter.id, middle);
                    let epsilon = EpsilonMeasures::new(after.epsilon, Some(&stats));
                    assert_eq!(real(&after, parameter.id, epsilon), middle, "{}", parameter.flag);
                }
                ValueKind::Whole { range } => {
                    set_whole(&mut after, parameter.id, *range.end());
                    assert_eq!(after.whole(parameter.id), Some(*range.end()), "{}", parameter.flag);
                }
                ValueKind::Choice { names } => {
                    for (name, _) in *names {
                        after.choose(parameter.id, Some(name));
                        assert_eq!(after.choice(parameter.id).as_deref(), Some(*name), "{}", parameter.flag);
                    }
                }
            }
            assert_ne!(before, after, "{}", parameter.flag);
            assert_eq!(after.validate(), Ok(()), "{}", parameter.flag);
        }
    }

    /// Truth: ε in watts does not follow a dimmed lamp, and what is set anew is measured by the
    /// power of now.
    #[test]
    fn a_dimmed_lamp_leaves_watts_as_they_were() {
        let stats = Stats { power_watts: 250.0, anchor_watts: 500.0, epsilon_watts: 0.05, ..Stats::default() };
        let of = |epsilon| EpsilonMeasures::new(epsilon, Some(&stats));
        assert_eq!(of(Epsilon::Relative(1e-4)).watts, 0.05);
        assert_eq!(of(Epsilon::Relative(1e-3)).watts, 0.25);
        assert_eq!(of(Epsilon::Watts(0.05)).relative, 2e-4);
    }

    /// Truth: what is shown can be typed again.
    #[test]
    fn whole_numbers_are_shown_as_people_write_them() {
        for (id, value, text) in [
            (ParameterId::RaysMax, 11_174.0, "11,174"),
            (ParameterId::Threads, 0.0, "all cores"),
            (ParameterId::Threads, 2.0, "2"),
        ] {
            assert_eq!(whole_text(id, value), text);
            assert_eq!(whole_value(id, text), Some(value));
        }
        assert_eq!(whole_value(ParameterId::Threads, "0"), Some(0.0));
        assert_eq!([0, 1, 2].map(|count| suffix_of(count, "levels")), [" levels", " level", " levels"]);
        assert_eq!(suffix_of(1, ""), "");
    }
}
