//! Display section: what colours the surfaces, in which range, and lines of equal value.

use egui::{ComboBox, DragValue, TextEdit, Ui};

use crate::app::state::settings::DisplaySettings;
use crate::app::widgets::{rows, theme};
use crate::app::words;
use crate::base::photometry::{CONVENTION, Unit};
use crate::read::daylight_factor::NoDaylightFactor;
use crate::render::{IsolinesWanted, MOST_ISOLINES, Ramp, Reading, Show, Spacing};

/// Width of the field of one end of a range, points.
const END_WIDTH: f32 = 112.0;
/// Width of the list of what surfaces can show, points.
const LIST_WIDTH: f32 = 224.0;

/// Draws the controls; `reading` is what the view shows, `none` why there is no daylight factor.
pub fn show(ui: &mut Ui, display: &mut DisplaySettings, reading: Option<&Reading>, none: Option<NoDaylightFactor>) {
    choose_show(ui, display, none);
    show_isolines(ui, display);
    let Some(reading) = reading else { return };
    let settings = &mut display.reading;
    if settings.show != Show::DaylightFactor {
        rows::choice(ui, words::UNIT, &mut settings.unit, [Unit::Lumens, Unit::Watts], |unit| match unit {
            Unit::Lumens => "lux (lm/m²)",
            Unit::Watts => "W/m²",
        })
        .on_hover_text(format!("{CONVENTION}; W/m² is the mean of the three colours by the same weights"));
    }
    let spacings = [Spacing::Linear, Spacing::Logarithmic];
    rows::choice(ui, words::SCALE, &mut settings.spacing, spacings, |spacing| match spacing {
        Spacing::Linear => "linear",
        Spacing::Logarithmic => "logarithmic",
    })
    .on_hover_text("Whether equal differences or equal ratios look alike");
    let name = |ramp: &Ramp| Ramp::ALL.iter().find(|(other, _)| other == ramp).map_or("", |(_, name)| name);
    rows::choice(ui, "Colours", &mut settings.ramp, Ramp::ALL.map(|(ramp, _)| ramp), name)
        .on_hover_text("Both can be read by people who do not tell red from green");
    show_range(ui, display, reading);
}

/// Chooses the quantity that colours the surfaces; the daylight factor is offered where it is
/// known, and says else why not.
fn choose_show(ui: &mut Ui, display: &mut DisplaySettings, none: Option<NoDaylightFactor>) {
    let (before, unit) = (display.reading.show, display.reading.unit);
    let show = &mut display.reading.show;
    let hint = "The lit picture, or false colours of the light that arrives at (E) or leaves (B) each point, or of the daylight factor";
    rows::row(ui, words::DISPLAY, |ui| {
        let list = ComboBox::from_id_salt(words::DISPLAY).selected_text(name_of_show(*show, unit)).truncate();
        let list = list.width(ui.available_width().min(LIST_WIDTH));
        let choices = |ui: &mut Ui| {
            for choice in Show::ALL {
                let missing = none.filter(|_| choice == Show::DaylightFactor);
                ui.add_enabled_ui(missing.is_none(), |ui| {
                    let label = ui.selectable_value(show, choice, name_of_show(choice, unit));
                    if let Some(missing) = missing {
                        label.on_disabled_hover_text(sentence(missing));
                    }
                });
            }
            if let Some(missing) = none {
                ui.set_max_width(LIST_WIDTH);
                let why = sentence(missing);
                rows::sentence(ui, theme::weak(why).small());
            }
        };
        list.show_ui(ui, choices).response
    })
    .on_hover_text(hint);
    if (before == Show::DaylightFactor) != (*show == Show::DaylightFactor) {
        // Ends and lines in lux are none in percent.
        display.reading.range = None;
        display.isolux_text.clear();
        if display.reading.isolines != IsolinesWanted::None {
            display.reading.isolines = IsolinesWanted::Round;
        }
    }
    if display.reading.show == Show::DaylightFactor
        && let Some(missing) = none
    {
        rows::notice(ui, sentence(missing));
    }
}

/// Why there is none, as a sentence.
fn sentence(missing: NoDaylightFactor) -> String {
    format!("{}.", missing.to_string().replacen("no", "No", 1))
}

fn name_of_show(show: Show, unit: Unit) -> &'static str {
    match (show, unit) {
        (Show::Lit, _) => words::LIT,
        (Show::Irradiance, Unit::Lumens) => words::ILLUMINANCE,
        (Show::Irradiance, Unit::Watts) => "false colours: irradiance E",
        (Show::Radiosity, Unit::Lumens) => "false colours: luminous exitance B",
        (Show::Radiosity, Unit::Watts) => "false colours: radiosity B",
        (Show::DaylightFactor, _) => words::DAYLIGHT_FACTOR,
    }
}

fn show_isolines(ui: &mut Ui, display: &mut DisplaySettings) {
    let mut are_on = display.reading.isolines != IsolinesWanted::None;
    let hint = "Lines of equal value over the surfaces: of E over the lit picture, else of what is shown";
    if ui.checkbox(&mut are_on, words::ISOLUX_LINES).on_hover_text(hint).changed() {
        display.reading.isolines = if are_on { wanted(display) } else { IsolinesWanted::None };
    }
    if !are_on {
        return;
    }
    let is_good = values_of(&display.isolux_text).is_some();
    let (_, sign) = display.reading.factor_and_sign();
    rows::row(ui, words::LINES_AT, |ui| {
        let field = TextEdit::singleline(&mut display.isolux_text)
            .desired_width(ui.available_width() - 8.0)
            .hint_text("round values")
            .text_color_opt((!is_good).then_some(theme::ERROR));
        ui.add(field).on_hover_text(format!(
            "Up to {MOST_ISOLINES} values in {sign}, with commas between; empty for round values inside the range"
        ))
    });
    // The numbers typed are of the unit shown, whichever it is now.
    display.reading.isolines = wanted(display);
}

/// The lines that the field asks for; what cannot be read changes nothing.
fn wanted(display: &DisplaySettings) -> IsolinesWanted {
    match values_of(&display.isolux_text) {
        Some(values) if values.is_empty() => IsolinesWanted::Round,
        Some(values) => {
            let (factor, _) = display.reading.factor_and_sign();
            IsolinesWanted::At(values.into_iter().map(|value| value / factor).collect())
        }
        None => match &display.reading.isolines {
            IsolinesWanted::None => IsolinesWanted::Round,
            lines => lines.clone(),
        },
    }
}

/// Numbers above 0 with commas or blanks between; `None` where there is anything else, or too many.
fn values_of(text: &str) -> Option<Vec<f32>> {
    let parts = text.split([',', ' ', ';']).map(str::trim).filter(|part| !part.is_empty());
    let values: Vec<f32> = parts.map(|part| part.parse::<f32>().ok()).collect::<Option<_>>()?;
    let are_good = values.iter().all(|value| *value > 0.0 && value.is_finite()) && values.len() <= MOST_ISOLINES;
    are_good.then_some(values)
}

fn show_range(ui: &mut Ui, display: &mut DisplaySettings, reading: &Reading) {
    let settings = &mut display.reading;
    let (factor, sign) = settings.factor_and_sign();
    let present = [reading.scale.low, reading.scale.high].map(|value| reading.shown_in.per_watt() / factor * value);
    let mut is_locked = settings.range.is_some();
    let hint = "Keeps the range while the light or the scene changes, so that pictures can be compared; otherwise round numbers around \
                97 % of the area";
    if ui.checkbox(&mut is_locked, words::LOCK_RANGE).on_hover_text(hint).changed() {
        settings.range = is_locked.then_some(present);
    }
    let mut ends = settings.range.unwrap_or(present).map(|value| factor * value);
    let least = if settings.spacing == Spacing::Logarithmic { 1e-6 } else { 0.0 };
    let mut changed = false;
    for (end, label) in [(0, "Range from"), (1, "Range to")] {
        rows::row(ui, label, |ui| {
            ui.add_enabled_ui(is_locked, |ui| {
                let speed = (0.005 * ends[1]).max(1e-4);
                let bounds = if end == 0 { least..=ends[1] } else { ends[0].max(1e-6)..=1e9 };
                let field = DragValue::new(&mut ends[end])
                    .speed(speed)
                    .range(bounds)
                    .max_decimals(3)
                    .suffix(format!(" {sign}"));
                let response = ui.add_sized([END_WIDTH, 20.0], field);
                changed |= response.changed();
                response
            })
            .inner
        });
    }
    if changed && is_locked {
        settings.range = Some(ends.map(|value| value / factor));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::photometry::ShownIn;

    /// Truth: the legend's own words.
    #[test]
    fn what_is_shown_has_the_name_of_its_legend() {
        for unit in [Unit::Lumens, Unit::Watts] {
            for show in [Show::Irradiance, Show::Radiosity] {
                let legend = ShownIn::Unit(unit).name(show.quantity());
                assert_eq!(name_of_show(show, unit), format!("false colours: {legend}"));
            }
            let legend = ShownIn::DaylightFactor { open_ground: 1.0 }.name(Show::DaylightFactor.quantity());
            assert_eq!(name_of_show(Show::DaylightFactor, unit), format!("false colours: {legend}"));
        }
    }

    #[test]
    fn values_are_read_as_people_write_them() {
        assert_eq!(values_of(" 100, 200;300  500 "), Some(vec![100.0, 200.0, 300.0, 500.0]));
        assert_eq!(values_of(""), Some(Vec::new()));
        for text in ["x", "1,-2", "0", "1,2,3,4,5,6,7,8,9", "inf"] {
            assert_eq!(values_of(text), None, "{text}");
        }
    }
}
