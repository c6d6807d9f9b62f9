//! Settings of readings off the surfaces; with a snapshot it becomes a [`Reading`].

use serde::{Deserialize, Serialize};

use super::reading::{ColourScale, Isolines, Reading, Spacing};
use crate::base::format;
use crate::base::photometry::{Quantity, Unit};
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
}

impl Show {
    /// Every choice.
    pub const ALL: [Self; 3] = [Self::Lit, Self::Irradiance, Self::Radiosity];

    /// Quantity that is read; over the lit picture, light that arrives.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Lit | Self::Irradiance => Quantity::Irradiance,
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
    /// At these values, W/m².
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
    /// The range, W/m²; without one it follows the snapshot.
    pub range: Option<[f32; 2]>,
    /// Lines of equal value.
    pub isolines: IsolinesWanted,
}

impl ReadingSettings {
    /// Reading of a snapshot that is to be drawn; none where the lit picture is all.
    pub fn reading(&self, snapshot: &Snapshot) -> Option<Reading> {
        if self.show == Show::Lit && self.isolines == IsolinesWanted::None {
            return None;
        }
        let quantity = self.show.quantity();
        let Self { unit, spacing, ramp, .. } = *self;
        let scale = match self.range {
            Some([low, high]) => ColourScale { low, high, spacing, ramp },
            None => ColourScale::automatic(snapshot, quantity, spacing, unit, ramp),
        };
        let isolines = match &self.isolines {
            IsolinesWanted::None => Isolines::default(),
            IsolinesWanted::Round => Isolines::of_scale(&scale, unit),
            IsolinesWanted::At(values) => Isolines::at(values.iter().copied()),
        };
        Some(Reading { quantity, scale, fills: self.show != Show::Lit, isolines })
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
    /// Marks of a legend: the ends of the range, and lines of equal value or round numbers between them.
    pub fn marks(&self, unit: Unit) -> Vec<Mark> {
        let ends = [self.scale.low, self.scale.high].map(|value| (value, false));
        let lines: Vec<_> = self.isolines.values().iter().map(|&value| (value, true)).collect();
        let between = match lines.is_empty() {
            true => self.scale.ticks(unit).into_iter().map(|value| (value, false)).collect(),
            false => lines,
        };
        let mark = |(value, is_line): (f32, bool)| {
            let label = format::short((unit.per_watt() * value).into());
            Mark { along: self.scale.along(value), label, is_line }
        };
        let mut marks: Vec<Mark> = between.into_iter().chain(ends).map(mark).collect();
        marks.retain(|mark| (-1e-3..=1.001).contains(&mark.along));
        marks.sort_by(|a, b| a.along.total_cmp(&b.along).then(b.is_line.cmp(&a.is_line)));
        marks.dedup_by(|later, first| (later.along - first.along).abs() < 2e-3);
        marks
    }

    /// Quantity and unit of the legend: "illuminance E, lx".
    pub fn title(&self, unit: Unit) -> String {
        format!("{}, {}", self.quantity.name_in(unit), unit.sign(self.quantity))
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
        let reading = Reading { quantity: Quantity::Irradiance, scale, fills: true, isolines };
        let labels = |reading: &Reading| -> Vec<String> {
            reading.marks(Unit::Lumens).into_iter().map(|mark| mark.label).collect()
        };
        assert_eq!(labels(&reading), ["0", "100", "200", "300", "400", "500"]);
        let reading = Reading { isolines: Isolines::at([300.0 / 179.0, 750.0 / 179.0]), ..reading };
        assert_eq!(labels(&reading), ["0", "300", "500"]);
        assert_eq!(reading.title(Unit::Lumens), "illuminance E, lx");
    }
}
