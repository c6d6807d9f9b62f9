//! The words on the window's widgets that are drawn in several places, or by which tests and the
//! gallery find widgets; others stand where they are drawn.
//!
//! Labels of the solver's parameters stand in [`crate::solve::PARAMETERS`] instead, which
//! [`parameter`] reads.

pub use crate::read::matrix::{FULLY_VISIBLE, HIDDEN, NOT_TESTED, PARTLY_VISIBLE};
use crate::solve::{PARAMETERS, ParameterId};

/// The label of a parameter of the solver.
pub fn parameter(id: ParameterId) -> &'static str {
    PARAMETERS.iter().find(|parameter| parameter.id == id).map_or("", |parameter| parameter.label)
}

/// Defines constants with their texts.
macro_rules! words {
    ($($(#[$doc:meta])* $name:ident = $text:literal;)*) => {
        $($(#[$doc])* pub const $name: &str = $text;)*
    };
}

words! {
    /// Section of the scene's file.
    SCENE = "Scene";
    /// Section of lamps and materials.
    LIGHT = "Light";
    /// Section of the target error and of running, pausing and stepping.
    QUALITY = "Quality";
    /// Fold of the paper's parameters.
    METHOD = "Method";
    /// First lines of [`METHOD`]: where its sections are.
    PAPER = "After M. Stamminger, W. Nitsch, Ph. Slusallek and H.-P. Seidel, “Isotropic Clustering for Hierarchical Radiosity – Implementation and Experiences”; sections below are of this paper.";
    /// Section of exposure, readings and overlays; also the row that chooses what surfaces show.
    DISPLAY = "Display";
    /// Section of the comparison with a reference.
    ACCURACY = "Accuracy";
    /// Section of counts and times.
    STATISTICS = "Statistics";
    /// Section of theme and scale.
    APPEARANCE = "Appearance";
    /// Section and list of keys.
    MOUSE_AND_KEYS = "Mouse and keys";

    /// Empty window: heading.
    OPEN_A_ROOM = "Open a room to light";
    /// Field of a scene's path.
    SCENE_PATH = "Scene path";
    /// Opens the path that was typed.
    OPEN = "Open";
    /// Writes the settings file beside the scene.
    SAVE_SCENE_SETTINGS = "Save scene settings";
    /// Answer to a question whether a file is replaced.
    OVERWRITE = "Overwrite";
    /// Answer that changes nothing.
    CANCEL = "Cancel";
    /// Takes a message away.
    DISMISS = "Dismiss";

    /// The coarsest quality.
    DRAFT = "Draft";
    /// Pauses the solver.
    PAUSE = "Pause";
    /// Lets a paused solver go on.
    RUN = "Run";
    /// Lets the solver go on until a wave ends.
    STEP_ONE_WAVE = "Step one wave";
    /// Opens all that shows how the method works, and replays the solve.
    STUDY = "Study the method";
    /// Over the view: the first step of a solve.
    STEP_SELF_LINK = "One link joins the whole scene, as a single cluster, to itself. A link says how much of the light of its source reaches its receiver: this one stands for all light, so it is refined.";
    /// Choice of *Stop at*: the paper's ε.
    STOP_AT_THRESHOLD = "link threshold ε";

    /// Status while stored and new links are tested.
    TESTING_LINKS = "Testing links";
    /// Status of the final gather.
    FINAL_GATHER = "Final gather";
    /// Status of a solve that kept the target error.
    TARGET_REACHED = "Target reached";
    /// Status of a solve by ε that has nothing left to refine.
    LINKS_SETTLED = "Links settled";
    /// Status while the timeline shows a step before the last.
    FORMER_STEP = "Former step";
    /// Status of a solve that ended before its target.
    STOPPED = "Stopped";
    /// Text behind [`LINKS_SETTLED`] while the error is not known.
    ERROR_NOT_MEASURED = "error not measured";
    /// Text behind a status where the error is known, before the figure.
    SURFACES_WITHIN = "9 of 10 surfaces within";
    /// Status of a scene without a lamp.
    NOTHING_EMITS = "Nothing emits light";
    /// Over the view of such a scene.
    NO_LIGHT_YET = "This scene has no light yet: its surfaces are shown in their own colours.";
    /// Over a view that the scene's light does not reach.
    NO_LIGHT_HERE = "Next to no light of this scene reaches what is seen here.";
    /// In the status bar beside the result of a solve, of such a view.
    NOTHING_SEEN_IS_LIT = "nothing in view is lit";
    /// Button beside either: adds a square luminaire.
    HANG_UP_A_LAMP = "Hang up a lamp";
    /// Name of the bar that tells how far a solve is.
    PROGRESS = "Progress";

    /// Row: gathered picture or mesh.
    PICTURE = "Picture";
    /// Choice of [`PICTURE`].
    GATHERED = "gathered";
    /// Choice of [`PICTURE`].
    MESH = "mesh";
    /// Choice of [`DISPLAY`]: the light.
    LIT = "lit";
    /// Choice of [`DISPLAY`]: E in lx. What is shown has the name that its legend has.
    ILLUMINANCE = "false colours: illuminance E";
    /// Choice of [`DISPLAY`]: E over that of open ground.
    DAYLIGHT_FACTOR = "false colours: daylight factor D";
    /// Button of a scene that is dark and has openings.
    LET_DAYLIGHT_IN = "Let daylight in";
    /// Preset: neither sky nor sun.
    NO_DAYLIGHT = "None";
    /// Preset: the CIE's overcast sky.
    OVERCAST_SKY = "Overcast";
    /// Preset: a sky of the same radiance everywhere.
    UNIFORM_SKY = "Uniform";
    /// Preset: the CIE's clear sky, with the sun.
    CLEAR_SKY = "Clear sky";
    /// Preset: a clear sky with the sun low in the west.
    LOW_SUN = "Low sun";
    /// List: how the sky's light is spread.
    SKY_TYPE = "Sky type";
    /// Slider: horizontal illuminance by the sky.
    SKY_ILLUMINANCE = "Sky";
    /// Plan of the sky on which the sun is dragged.
    SKY_PLAN = "Plan of the sky";
    /// Row: how the place of the sun is given.
    SUN_PLACE = "Sun's place";
    /// Choice of [`SUN_PLACE`].
    SUN_BY_DATE = "date and place";
    /// Row: hours and minutes.
    TIME = "Time";
    /// Remark on a sun that does not shine.
    SUN_IS_DOWN = "The sun is below the horizon.";
    /// Lines of equal value.
    ISOLUX_LINES = "Isolux lines";
    /// Field of their values.
    LINES_AT = "Lines at";
    /// Keeps the range of false colours.
    LOCK_RANGE = "Lock the range";
    /// Unit of readings.
    UNIT = "Unit";
    /// Spacing of false colours.
    SCALE = "Scale";
    /// Keeps the exposure as it is.
    LOCK_EXPOSURE = "Lock exposure";
    /// Slider of the exposure, stops.
    EXPOSURE = "Exposure";
    /// Outlines of leaf elements.
    ELEMENT_OUTLINES = "Element outlines";
    /// Boxes of clusters.
    CLUSTER_BOXES = "Cluster boxes";
    /// Row: whose links are drawn.
    SHOW_LINKS = "Show links";
    /// Choice of [`SHOW_LINKS`].
    LINKS_NONE = "none";
    /// Choice of [`SHOW_LINKS`].
    LINKS_AT_LEVEL = "at level";
    /// Most links that are drawn.
    STRONGEST_LINKS = "Strongest links";
    /// Level of the receivers whose links are drawn.
    RECEIVERS_AT_LEVEL = "Receivers at level";
    /// Links of both of these kinds.
    HIDDEN_OR_NOT_TESTED = "hidden or not tested";
    /// Links between two patches.
    PATCH_PATCH = "patch–patch";
    /// Rims of both ends of links.
    OUTLINES_OF_ENDS = "Outlines of both ends";

    /// Heading of the card.
    SELECTED_ELEMENT = "Selected element";
    /// Heading of the strongest sources in the card.
    TOP_SOURCES = "Top sources (incl. inherited)";
    /// Opens the card from the tag.
    DETAILS = "Details";
    /// Closes the card.
    CLOSE = "Close";
    /// Opens the inspector from the card.
    INSPECT = "Inspect";

    /// Tool: one element and its links.
    INSPECTOR = "Inspector";
    /// Tool: all links as blocks.
    LINK_MATRIX = "Link matrix";
    /// Tool: the tree of clusters.
    CLUSTERS = "Clusters";
    /// Tool: probes and the work plane.
    MEASURE = "Measure";
    /// Tool: two solutions side by side.
    COMPARE = "Compare";
    /// Tool: files.
    EXPORT = "Export";
    /// Menu of the tools where the window is narrow.
    TOOLS = "Tools";
    /// Shows and hides the panels at the left.
    SETTINGS = "Settings";
    /// Menu of the camera.
    CAMERA = "Camera";
    /// Camera: all of the scene from above.
    TOP = "Top view";
    /// Camera: all of the scene from its front.
    FRONT = "Front view";
    /// Camera: all of the scene from its side.
    SIDE = "Side view";
    /// Camera: horizontal field of view.
    FIELD_OF_VIEW = "Field of view";
    /// Camera: keys walk instead of flying.
    WALK = "Walk at eye height";
    /// Over the view while keys walk.
    WALKING = "Walking at eye height: W A S D";
    /// Camera: keeps the present view.
    ADD_BOOKMARK = "Add bookmark";
    /// Camera: a view that was kept; its number follows.
    BOOKMARK = "Bookmark";
    /// Over the view where the eye is outside of a room.
    THROUGH_WALLS = "Nearer walls are looked through";
    /// Closes the open tool.
    CLOSE_TOOL = "Close tool";
    /// Brings the panels back.
    SHOW_PANELS = "Show panels";
    /// Opens the list of keys.
    KEYS = "Keys";

    /// Irradiance of an element before a final gather, W/m².
    E = "E";
    /// Irradiance of an element that the final gather finds, W/m².
    E_BY_GATHER = "E by final gather";
    /// Irradiance of an element that its links bring, W/m².
    E_BY_LINKS = "E by links";
    /// Illuminance of an element, the mean over its area, lx.
    MEAN_ILLUMINANCE = "Illuminance (mean)";
    /// Levels of an element below the root, also the slider of clusters' levels.
    LEVEL = "Level";

    /// Inspector, one direction.
    WHAT_LIGHTS_THIS = "What lights this";
    /// Inspector, the other direction.
    WHAT_THIS_LIGHTS = "What this lights";
    /// Inspector: the element that holds this one.
    UP = "Up";
    /// Inspector: the element that was left last.
    BACK = "Back";

    /// Clusters: surfaces in the colours of their clusters.
    COLOUR_BY_CLUSTER = "Colour by cluster";
    /// Clusters: how far they are pulled apart.
    EXPLODE = "Explode";
    /// Matrix: form factor of the block under the mouse.
    FORM_FACTOR = "Form factor F";
    /// Matrix: power of its strongest channel over ε.
    STRONGEST_CHANNEL = "Strongest channel";
    /// Clusters: the page of groups arranged by hand.
    MANUAL_GROUPS = "Manual groups";
    /// Clusters: groups as the scene's file has them.
    REVERT_TO_FILE = "Revert to file";

    /// Compare: keeps the solution in view.
    KEEP_AS_A = "Keep as A";
    /// Compare: forgets the kept solution.
    DISCARD_A = "Discard A";
    /// Compare: both on either side of a divider.
    A_BESIDE_B = "A | B";
    /// Compare: what was kept.
    A_ALONE = "A alone";
    /// Compare: what is running.
    B_ALONE = "B alone";
    /// Compare: where B is darker or brighter.
    DIFFERENCE = "B − A";

    /// Light: exitance of a material or lamp.
    EXITANCE = "Exitance (strongest channel)";
    /// Light: power of a lamp, a unit of its strength.
    POWER = "Power (sum of channels)";
    /// Light: luminous flux of a lamp, a unit of its strength.
    FLUX = "Luminous flux";
    /// Light: in which unit a lamp is set: exitance, power or flux.
    LAMP_UNIT = "Set light by";
    /// Light: colour of a lamp as the temperature of a black body.
    COLOUR_TEMPERATURE = "Colour temperature";
    /// Light: lets a material emit.
    MAKE_IT_A_LIGHT = "Make it a light";
    /// Light: switches a lamp on.
    SWITCH_ON = "Switch it on";
    /// Light: switches a lamp off.
    SWITCH_OFF = "Switch it off";
    /// Light: measures a relative ε by the present lamps.
    RESCALE_EPSILON = "Rescale ε to current lamps";
    /// Light: adds a square luminaire.
    ADD_SQUARE_LIGHT = "Add square light";
    /// Light: adds a round luminaire.
    ADD_DISC_LIGHT = "Add disc light";
    /// Light: adds a long luminaire.
    ADD_LINE_LIGHT = "Add line light";
    /// Light: takes the selected luminaire away.
    REMOVE_LUMINAIRE = "Remove";
    /// Light: outline of the selected luminaire.
    SHAPE = "Shape";
    /// Light: side of the selected square.
    SIDE_LENGTH = "Side length";
    /// Light: length of the selected line.
    LENGTH = "Length";
    /// Light: where the selected luminaire is along y of the file.
    LUMINAIRE_Y = "Place along y";
    /// Light: where the selected luminaire shines to.
    SHINES = "Shines";
    /// Light: turn of the selected luminaire about where it shines to.
    TURN = "Turn";
    /// View: one of the handles of the selected luminaire.
    MOVE_ALONG_Y = "Move the luminaire along y";
    /// Light: reflectance of a material.
    REFLECTANCE = "Reflectance";

    /// Timeline: plays the steps.
    PLAY = "Play";
    /// Timeline: goes back to the newest step.
    LATEST = "Latest";
    /// Timeline: the track.
    STEP_OF_THE_SOLVE = "Step of the solve";

    /// Undoes a setting.
    UNDO = "Undo";
    /// Does an undone setting again.
    REDO = "Redo";

    /// Accuracy: starts the reference.
    COMPARE_WITH_REFERENCE = "Compare with a reference";
    /// Accuracy: stops the reference.
    STOP_COMPARING = "Stop comparing";

    /// Choice of *Theme*.
    DARK_THEME = "Dark theme";
    /// Choice of *Theme*.
    LIGHT_THEME = "Light theme";
    /// Appearance: size of text and widgets.
    UI_SCALE = "UI scale";
    /// Keys: goes back to the scene's own view.
    RESET_CAMERA = "Reset camera";

    /// Measure: a click places a probe.
    PLACE_PROBES = "Place probes";
    /// Measure: starts the work plane.
    MEASURE_PLANE = "Measure the work plane";
    /// Measure: uniformity.
    UNIFORMITY = "Uniformity U₀";
    /// Measure: average illuminance.
    AVERAGE = "Average Ē";
    /// Measure: average that is to be reached.
    TARGET_AVERAGE = "Target Ē";
    /// Measure: uniformity that is to be reached.
    TARGET_UNIFORMITY = "Target U₀";
    /// Measure: a target is reached.
    PASSED = "Pass";
    /// Measure: a target is not reached.
    FAILED = "Fail";
    /// Measure: height of the work plane.
    PLANE_HEIGHT = "Height";
    /// Measure: lets a drag in the view draw a task area.
    DRAW_TASK_AREA = "Draw a task area";
    /// Measure: corners of the task area.
    TASK_AREA = "Task area";
    /// Measure: measures all of the plane again.
    WHOLE_PLANE = "Whole plane";
    /// Beside a reading of light that the solver has since left behind.
    EARLIER_PICTURE = "earlier picture";
    /// Over points of a work plane of such light, or as it was set up before.
    EARLIER_PLANE = "Work plane of an earlier picture or setting; measured again when the solver rests";
    /// Measure: gives the plane up.
    CLEAR = "Clear";
}

/// Light: heading of the rows about the light of a material or luminaire.
pub fn light_of(name: &str) -> String {
    format!("Light of {name}")
}

/// Measure: field of a corner of the task area, *from* or *to*, along an axis.
pub fn task_area(axis: &str, corner: &str) -> String {
    format!("{TASK_AREA} {axis} {corner}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the list of parameters.
    #[test]
    fn every_parameter_has_a_label_in_sentence_case() {
        for of in &PARAMETERS {
            let label = parameter(of.id);
            assert!(label.chars().next().is_some_and(|first| first.is_uppercase()), "{label}");
        }
    }
}
