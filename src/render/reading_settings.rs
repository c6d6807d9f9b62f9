//! Settings of readings off the surfaces; with a snapshot it becomes a [`Reading`].

use serde::{Deserialize, Serialize};

use super::reading::{ColourScale, Isolines, Reading, Spacing};
use crate::base::format;
use crate::base::photometry::{Quantity, ShownIn, Unit};
use crate::read::ramp::Ramp;
use crate::solve::snapshot::Snapshot;

/// Meaning of the colours of surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Show {
    /// The light, as an eye or a camera sees it.
    #[default]
    Lit,
    /// False colours of what arrives.
    Irradiance,
    /// False colours of what leaves.
    Radiosity,
    /// False colours of what arrives as a share of what reaches open ground under the same sky.
    DaylightFactor,
}

impl Show {
    /// Every choice.
    pub const ALL: [Self; 4] = [Self::Lit, Self::Irradiance, Self::Radiosity, Self::DaylightFactor];

    /// Quantity that is read; over the lit picture, light that arrives.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Lit | Self::Irradiance | Self::DaylightFactor => Quantity::Irradiance,
            Self::Radiosity => Quantity::Radiosity,
        }
    }
}

/// Which lines of equal value are drawn.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum IsolinesWanted {
    /// None.
    #[default]
    None,
    /// At round values inside the range.
    Round,
    /// At these values, W/m², or shares of the light on open ground where the daylight factor is
    /// shown.
    At(Vec<f32>),
}

/// Settings of readings off the surfaces.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ReadingSettings {
    /// Meaning of the colours of surfaces.
    pub show: Show,
    /// Unit of the values.
    pub unit: Unit,
    /// Spacing of values between the ends of the range.
    pub spacing: Spacing,
    /// The colours.
    pub ramp: Ramp,
    /// The range, W/m², or shares of the light on open ground where the daylight factor is shown;
    /// without one it follows the snapshot.
    pub range: Option<[f32; 2]>,
    /// Lines of equal value.
    pub isolines: IsolinesWanted,
}

impl ReadingSettings {
    /// Reading of a snapshot that is to be drawn; none where the lit picture is all, or where the
    /// daylight factor is asked for and not known. `open_ground` is the irradiance of open
    /// horizontal ground where the sky alone shines, W/m², weighted as the eye does.
    pub fn reading(&self, snapshot: &Snapshot, open_ground: Option<f32>) -> Option<Reading> {
        if self.show == Show::Lit && self.isolines == IsolinesWanted::None {
            return None;
        }
        let quantity = self.show.quantity();
        let Self { unit, spacing, ramp, .. } = *self;
        let (shown_in, watts) = match self.show {
            Show::DaylightFactor => (ShownIn::DaylightFactor { open_ground: open_ground? }, open_ground?),
            Show::Lit | Show::Irradiance | Show::Radiosity => (ShownIn::Unit(unit), 1.0),
        };
        let scale = match self.range {
            Some([low, high]) => ColourScale { low: watts * low, high: watts * high, spacing, ramp },
            None => ColourScale::automatic(snapshot, quantity, spacing, shown_in, ramp),
        };
        let isolines = match &self.isolines {
            IsolinesWanted::None => Isolines::default(),
            IsolinesWanted::Round => Isolines::of_scale(&scale, shown_in),
            IsolinesWanted::At(values) => Isolines::at(values.iter().map(|value| watts * value)),
        };
        Some(Reading { quantity, shown_in, scale, fills: self.show != Show::Lit, isolines })
    }

    /// Factor and sign that the values of range and lines are shown with: a value times the first,
    /// with the second behind it.
    pub fn factor_and_sign(&self) -> (f32, &'static str) {
        match self.show {
            Show::DaylightFactor => (100.0, "%"),
            show @ (Show::Lit | Show::Irradiance | Show::Radiosity) => {
                (self.unit.per_watt(), self.unit.sign(show.quantity()))
            }
        }
    }
}

/// A mark beside the ramp of a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Place of the mark on the ramp, 0..=1.
    pub along: f32,
    /// Value of the mark, in the unit shown.
    pub label: String,
    /// Whether a line of equal value is drawn there.
    pub is_line: bool,
}

impl Reading {
    /// Marks of a legend: the ends of the range, and lines of equal value or round numbers between
    /// them.
    pub fn marks(&self) -> Vec<Mark> {
        let ends = [self.scale.low, self.scale.high].map(|value| (value, false));
        let lines: Vec<_> = self.isolines.values().iter().map(|&value| (value, true)).collect();
        let between = match lines.is_empty() {
            true => self.scale.ticks(self.shown_in).into_iter().map(|value| (value, false)).collect(),
            false => lines,
        };
        let mark = |(value, is_line): (f32, bool)| {
            let label = format::short((self.shown_in.per_watt() * value).into());
            Mark { along: self.scale.along(value), label, is_line }
        };
        let mut marks: Vec<Mark> = between.into_iter().chain(ends).map(mark).collect();
        marks.retain(|mark| (-1e-3..=1.001).contains(&mark.along));
        marks.sort_by(|a, b| a.along.total_cmp(&b.along).then(b.is_line.cmp(&a.is_line)));
        marks.dedup_by(|later, first| (later.along - first.along).abs() < 2e-3);
        // What is brighter has the last colour as well.
        if let Some(last) = marks.last_mut().filter(|last| last.along > 0.999) {
            last.label.insert_str(0, "≥ ");
        }
        marks
    }

    /// Quantity and unit of the legend: "illuminance E, lx".
    pub fn title(&self) -> String {
        format!("{}, {}", self.shown_in.name(self.quantity), self.shown_in.sign(self.quantity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Written out by hand: 179 lm are 1 W.
    #[test]
    fn legends_tell_round_numbers_and_lines() {
        let scale = ColourScale { low: 0.0, high: 500.0 / 179.0, spacing: Spacing::Linear, ramp: Ramp::Viridis };
        let isolines = Isolines::default();
        let shown_in = ShownIn::Unit(Unit::Lumens);
        let reading = Reading { quantity: Quantity::Irradiance, shown_in, scale, fills: true, isolines };
        let labels =
            |reading: &Reading| -> Vec<String> { reading.marks().into_iter().map(|mark| mark.label).collect() };
        assert_eq!(labels(&reading), ["0", "100", "200", "300", "400", "≥ 500"]);
        let reading = Reading { isolines: Isolines::at([300.0 / 179.0, 750.0 / 179.0]), ..reading };
        assert_eq!(labels(&reading), ["0", "300", "≥ 500"]);
        assert_eq!(reading.title(), "illuminance E, lx");
        // A hundredth of 50 W/m² is 1 %.
        let shown_in = ShownIn::DaylightFactor { open_ground: 50.0 };
        let scale = ColourScale { high: 2.0, ..scale };
        let reading = Reading { shown_in, scale, isolines: Isolines::at([0.5]), ..reading };
        assert_eq!(
            (labels(&reading), reading.title()),
            (["0", "1", "≥ 4"].map(String::from).into(), "daylight factor D, %".into())
        );
    }
}
