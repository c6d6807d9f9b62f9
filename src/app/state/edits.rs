//! What a person sets: parameters, display, lamps and materials, with what was set before.

use crate::app::panels::light::LightEditor;
use crate::app::state::settings::DisplaySettings;
use crate::app::state::undo::History;
use crate::solve::SolverParams;

/// Settings of the window, and their history.
pub(in crate::app) struct Edits {
    /// The solver's parameters as the panel shows them; ahead of the worker's while a slider is dragged.
    pub params: SolverParams,
    /// How the light is shown.
    pub display: DisplaySettings,
    /// Lamps and materials.
    pub light: LightEditor,
    /// What was set before, and what was undone.
    pub history: History,
}

impl Edits {
    /// Nothing was set yet but these.
    pub(in crate::app) fn new(params: SolverParams, display: DisplaySettings) -> Self {
        Self { params, display, light: LightEditor::default(), history: History::default() }
    }
}
