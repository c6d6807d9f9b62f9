//! How the picture is shown; kept from one run to the next.

use serde::{Deserialize, Serialize};

use crate::render::{Exposure, LinkFilter, LinkStyle, Marks, Overlay, ReadingSettings};

/// How the picture is shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DisplaySettings {
    /// Whether the exposure follows the picture.
    pub auto_exposure: bool,
    /// Correction of the automatic exposure, stops.
    pub auto_stops: f32,
    /// Exposure by hand, stops; 0 shows 1 W/m² as 1.
    pub manual_stops: f32,
    /// Whether light is gathered at every pixel once the camera stands still; otherwise the mesh is
    /// shown.
    pub is_gathered: bool,
    /// Outlines of the leaf elements.
    pub show_elements: bool,
    /// Boxes of one level of clusters.
    pub show_clusters: bool,
    /// That level, the root being 0.
    pub cluster_level: u16,
    /// Links over the view.
    pub links: LinkOverlay,
    /// Readings off the surfaces.
    pub reading: ReadingSettings,
    /// Values of isolux lines as they were typed, in the unit shown; empty for round ones.
    pub isolux_text: String,
}

/// Which links are drawn over the view, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LinkOverlay {
    pub of: LinksOf,
    /// Level of the receivers below the root.
    pub level: u16,
    pub filter: LinkFilter,
    pub style: LinkStyle,
}

/// Whose links are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LinksOf {
    /// Nobody's.
    #[default]
    Nothing,
    /// Those of the picked element.
    Picked,
    /// Those whose receiver lies at a level of the hierarchy.
    Level,
}

impl Default for LinkOverlay {
    fn default() -> Self {
        let style = LinkStyle { ends: false, ..LinkStyle::default() };
        Self { of: LinksOf::default(), level: 2, filter: LinkFilter::default(), style }
    }
}

impl Default for DisplaySettings {
    fn default() -> Self {
        Self {
            auto_exposure: true,
            auto_stops: 0.0,
            manual_stops: 0.0,
            is_gathered: true,
            show_elements: false,
            show_clusters: false,
            cluster_level: 2,
            links: LinkOverlay::default(),
            reading: ReadingSettings::default(),
            isolux_text: String::new(),
        }
    }
}

impl DisplaySettings {
    /// The factor on radiosities, m²/W, of a view for which the meter says `metered`.
    pub fn exposure(&self, metered: f32) -> f32 {
        let exposure = match self.auto_exposure {
            true => Exposure::Auto { stops: self.auto_stops },
            false => Exposure::Manual { stops: self.manual_stops },
        };
        exposure.factor(metered)
    }

    /// As the renderer wants it; cluster levels beyond the deepest show the deepest. What is shown
    /// without light would be black in black, so that nothing could be chosen in it: it is drawn
    /// with outlines.
    pub fn overlay(&self, deepest_level: u16, is_dark: bool, marks: Marks) -> Overlay {
        Overlay {
            elements: self.show_elements || is_dark,
            clusters: self.show_clusters.then_some(self.cluster_level.min(deepest_level)),
            marks,
        }
    }
}
