//! The picture, and what is drawn and dragged over it.

pub mod best;
pub mod camera_menu;
pub mod cluster_view;
pub mod colour_bar;
pub mod divider;
pub mod eye;
pub mod first_view;
pub mod gathering;
pub mod gizmo;
pub mod highlight;
pub mod line_labels;
pub mod marks;
pub mod measure_marks;
pub mod metering;
pub mod overlays;
pub mod own_colours;
pub mod paint;
pub mod viewport;
pub mod walk;

use best::BestPicture;
use cluster_view::ClusterScene;
use gathering::{Gathering, Painted};
use highlight::Pointing;
use marks::MarksOverView;
use metering::Metering;
use overlays::Overlays;
use own_colours::OwnColours;
use viewport::Viewport;

use crate::app::Wake;
use crate::app::state::readings::ReadingInView;

/// The picture, and what lies over it.
pub struct View {
    /// The camera, and what the mouse does to it.
    pub viewport: Viewport,
    /// The best picture so far.
    pub best: BestPicture,
    /// Makes gathered pictures.
    pub gathering: Gathering,
    /// The gathered picture in view.
    pub painted: Option<Painted>,
    /// Meters the exposure.
    pub metering: Metering,
    /// The metered exposure, m²/W.
    pub exposure: f32,
    /// Clusters pulled apart.
    pub clusters: ClusterScene,
    /// A scene that nothing lights.
    pub own_colours: OwnColours,
    /// Marks of elements and links.
    pub marks: MarksOverView,
    /// Things that the mouse is over, in a panel or in the view.
    pub pointing: Pointing,
    /// Cards, legends and notes over the view.
    pub overlays: Overlays,
    /// Reading of the surfaces in view.
    pub reading: ReadingInView,
}

impl View {
    /// Nothing is in view yet.
    pub fn new(wake: &Wake) -> Self {
        Self {
            viewport: Viewport::default(),
            best: BestPicture::default(),
            gathering: Gathering::start(wake),
            painted: None,
            metering: Metering::default(),
            exposure: 1.0,
            clusters: ClusterScene::default(),
            own_colours: OwnColours::default(),
            marks: MarksOverView::default(),
            pointing: Pointing::default(),
            overlays: Overlays::default(),
            reading: ReadingInView::default(),
        }
    }
}
