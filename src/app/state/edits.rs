//! Settings of a person: parameters, display, lamps and materials, with their history.

use crate::app::panels::light::LightEditor;
use crate::app::state::settings::DisplaySettings;
use crate::app::state::undo::History;
use crate::solve::SolverParams;

/// Settings of the window, and their history.
pub struct Edits {
    /// The solver's parameters as the panel shows them; ahead of the worker's while a slider is
    /// dragged.
    pub params: SolverParams,
    /// How the light is shown.
    pub display: DisplaySettings,
    /// Lamps and materials.
    pub light: LightEditor,
    /// Former settings, and those that were undone.
    pub history: History,
}

impl Edits {
    /// Nothing was set yet but these.
    pub fn new(params: SolverParams, display: DisplaySettings) -> Self {
        Self { params, display, light: LightEditor::default(), history: History::default() }
    }
}
