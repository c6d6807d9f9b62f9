//! Readings: a quantity of the surfaces as false colours, and as lines of equal value over these or
//! over the lit picture.
//!
//! The shader colours each pixel by the value interpolated there; what is here tells it how, and
//! tells a legend the same.

use crate::base::photometry::{Quantity, ShownIn, Unit, weighted};
use crate::read::ramp::Ramp;
use crate::solve::snapshot::Snapshot;

/// So many lines of equal value at most.
pub const MOST_ISOLINES: usize = 8;
/// Shares of the area, from the darkest, between which an automatic range lies at most.
const COUNTED_AREA: (f64, f64) = (0.02, 0.99);
/// Values farther above the upper quartile than so many times the distance of the quartiles rule no
/// range: Tukey's outer fence.
const FENCE: f32 = 3.0;
/// An automatic logarithmic range spans factors between these.
const LOG_SPANS: (f32, f32) = (10.0, 1e4);
/// Below this share of the upper end, an automatic linear range starts at 0.
const LINEAR_FROM_ZERO: f32 = 0.5;
/// More leaves than this are sampled evenly.
const MOST_LEAVES: usize = 1 << 14;
/// Marks that a scale wants.
const WANTED_TICKS: f32 = 6.0;

/// A quantity read off the surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Which.
    pub quantity: Quantity,
    /// Unit that the values are shown in.
    pub shown_in: ShownIn,
    /// Colours of the values.
    pub scale: ColourScale,
    /// Whether surfaces have these colours; otherwise they stay lit.
    pub fills: bool,
    /// Lines of equal value.
    pub isolines: Isolines,
}

/// How colours follow values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Spacing {
    /// Equal differences look alike.
    #[default]
    Linear,
    /// Equal ratios look alike.
    Logarithmic,
}

/// A range of values and its colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourScale {
    /// Value at the ramp's start, W/m² (weighted as the eye does).
    pub low: f32,
    /// Value at its end, W/m².
    pub high: f32,
    /// Spacing of the values between the ends.
    pub spacing: Spacing,
    /// The colours.
    pub ramp: Ramp,
}

impl ColourScale {
    /// Where a value lies on the ramp: 0..=1 inside the range.
    pub fn along(&self, value: f32) -> f32 {
        let [low, high] = self.ends();
        (self.bent(value) - low) / (high - low)
    }

    /// The value at a place on the ramp, W/m².
    pub fn value_at(&self, along: f32) -> f32 {
        let [low, high] = self.ends();
        let bent = low + along * (high - low);
        match self.spacing {
            Spacing::Linear => bent,
            Spacing::Logarithmic => bent.exp2(),
        }
    }

    /// The colour of a value; gamma-encoded.
    pub fn colour(&self, value: f32) -> [u8; 3] {
        self.ramp.at(self.along(value))
    }

    /// The range's ends as the ramp sees them: logarithms to base 2 where it is logarithmic. The
    /// upper one is the larger, by a hair at least.
    pub(super) fn ends(&self) -> [f32; 2] {
        let low = self.bent(self.low);
        [low, self.bent(self.high).max(low + 1e-6 * low.abs().max(f32::MIN_POSITIVE))]
    }

    fn bent(&self, value: f32) -> f32 {
        match self.spacing {
            Spacing::Linear => value,
            Spacing::Logarithmic => value.max(f32::MIN_POSITIVE).log2(),
        }
    }

    /// A range that suits a snapshot: round numbers as they are shown around all but the darkest
    /// and brightest leaves, lamps aside.
    pub fn automatic(snapshot: &Snapshot, quantity: Quantity, spacing: Spacing, shown_in: ShownIn, ramp: Ramp) -> Self {
        let shown = |value: f32| shown_in.per_watt() * value;
        let (low, high) = match counted_range(snapshot, quantity) {
            None => (0.1, 1.0),
            Some((low, high)) => {
                let high = round_up(shown(high));
                let low = shown(low);
                match spacing {
                    Spacing::Linear if low < LINEAR_FROM_ZERO * high => (0.0, high),
                    Spacing::Linear => (round_down(low), high),
                    Spacing::Logarithmic => (round_down(low.clamp(high / LOG_SPANS.1, high / LOG_SPANS.0)), high),
                }
            }
        };
        Self { low: low / shown_in.per_watt(), high: high / shown_in.per_watt(), spacing, ramp }
    }

    /// The scale from 0 up to a round number in lx.
    pub fn rounded(self) -> Self {
        let per_watt = Unit::Lumens.per_watt();
        Self { high: round_up(per_watt * self.high) / per_watt, ..self }
    }

    /// Round values inside the range, its ends among them where they are round, W/m².
    pub fn ticks(&self, shown_in: ShownIn) -> Vec<f32> {
        let (low, high) = (shown_in.per_watt() * self.low, shown_in.per_watt() * self.high);
        let is_inside = |value: &f32| (low * 0.999..=high * 1.001).contains(value);
        let values: Vec<f32> = match self.spacing {
            Spacing::Linear => {
                let step = round_step((high - low) / WANTED_TICKS);
                let first = (low / step - 1e-3).ceil();
                (0..=2 * WANTED_TICKS as i32).map(|tick| (first + tick as f32) * step).filter(is_inside).collect()
            }
            Spacing::Logarithmic => {
                let decades = (high / low.max(f32::MIN_POSITIVE)).log10();
                let within: &[f32] = match decades {
                    ..1.05 => &[1.0, 2.0, 3.0, 5.0],
                    ..2.05 => &[1.0, 2.0, 5.0],
                    ..3.05 => &[1.0, 3.0],
                    _ => &[1.0],
                };
                let first = low.max(f32::MIN_POSITIVE).log10().floor() as i32;
                let decade = |power: i32| within.iter().map(move |digit| digit * 10_f32.powi(power));
                (first..=first + decades.ceil() as i32).flat_map(decade).filter(is_inside).collect()
            }
        };
        values.into_iter().map(|value| value / shown_in.per_watt()).collect()
    }
}

/// Values of lines, ascending, W/m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Isolines {
    values: [f32; MOST_ISOLINES],
    count: usize,
}

impl Isolines {
    /// Lines at the lowest of these values that are above 0.
    pub fn at(values: impl IntoIterator<Item = f32>) -> Self {
        let mut wanted: Vec<f32> = values.into_iter().filter(|value| *value > 0.0 && value.is_finite()).collect();
        wanted.sort_by(f32::total_cmp);
        wanted.dedup();
        let count = wanted.len().min(MOST_ISOLINES);
        let mut values = [0.0; MOST_ISOLINES];
        values[..count].copy_from_slice(&wanted[..count]);
        Self { values, count }
    }

    /// Lines at the round values strictly inside a scale.
    pub fn of_scale(scale: &ColourScale, shown_in: ShownIn) -> Self {
        let inside = |value: &f32| (0.01..0.99).contains(&scale.along(*value));
        Self::at(scale.ticks(shown_in).into_iter().filter(inside))
    }

    /// Their values, W/m².
    pub fn values(&self) -> &[f32] {
        &self.values[..self.count]
    }
}

/// The colour of a line of equal value; gamma-encoded.
pub(super) fn line_colour(reading: &Reading, value: f32) -> [u8; 3] {
    let colour = reading.scale.colour(value);
    if reading.fills { contrast(colour) } else { paler(colour) }
}

/// A colour that can be seen on lit surfaces, dark ones too.
fn paler(colour: [u8; 3]) -> [u8; 3] {
    colour.map(|channel| channel + (255 - channel) / 3)
}

/// Black or white, whichever can be seen on a colour.
fn contrast([r, g, b]: [u8; 3]) -> [u8; 3] {
    let brightness = 2 * u32::from(r) + 7 * u32::from(g) + u32::from(b);
    if brightness > 1100 { [16, 16, 20] } else { [250, 250, 250] }
}

/// The quantity at each vertex, W/m², weighted as the eye does.
pub(super) fn at_vertices(snapshot: &Snapshot, quantity: Quantity) -> Vec<f32> {
    let light = match quantity {
        Quantity::Irradiance => &snapshot.vertex_irradiance,
        Quantity::Radiosity => &snapshot.vertex_radiosity,
    };
    let mut values: Vec<f32> = light.iter().map(|light| weighted(*light)).collect();
    values.resize(snapshot.mesh.positions.len(), 0.0);
    values
}

/// Between which values most of the area lies; `None` where nothing is lit.
fn counted_range(snapshot: &Snapshot, quantity: Quantity) -> Option<(f32, f32)> {
    let step = snapshot.leaf_radiosity.len().div_ceil(MOST_LEAVES).max(1);
    let leaves = snapshot.mesh.leaves.iter().zip(&snapshot.leaf_irradiance).zip(&snapshot.leaf_radiosity);
    let read = |((leaf, &irradiance), &radiosity): ((&crate::solve::snapshot::Leaf, &[f32; 3]), &[f32; 3])| {
        let (received, sent) = (weighted(irradiance), weighted(radiosity));
        let value = if quantity == Quantity::Irradiance { received } else { sent };
        // What sends out more than it receives is a lamp.
        (value, f64::from(leaf.reachable_area), sent > received)
    };
    let is_lit =
        |(value, area, _): &(f32, f64, bool)| *value > 0.0 && value.is_finite() && *area > 0.0 && area.is_finite();
    let mut lit: Vec<(f32, f64, bool)> = leaves.step_by(step).map(read).filter(is_lit).collect();
    if lit.iter().any(|(.., is_lamp)| !is_lamp) {
        lit.retain(|(.., is_lamp)| !is_lamp);
    }
    let mut values: Vec<(f32, f64)> = lit.into_iter().map(|(value, area, _)| (value, area)).collect();
    let high = upper_end(&mut values, COUNTED_AREA.1)?;
    Some((quantile(&values, COUNTED_AREA.0)?, high))
}

/// The upper end of a range of values, each with its weight: the largest below this share of the
/// weight that is no outlier, for one place right under a lamp is not to rule it. Sorts them;
/// `None` where there are none.
pub fn upper_end(values: &mut [(f32, f64)], share: f64) -> Option<f32> {
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let (lower, upper) = (quantile(values, 0.25)?, quantile(values, 0.75)?);
    let fence = upper + FENCE * (upper - lower);
    let (inside, _) = values.iter().rev().find(|(value, _)| *value <= fence)?;
    Some(inside.min(quantile(values, share)?))
}

/// The value below which this share of the weight of sorted values lies.
fn quantile(values: &[(f32, f64)], share: f64) -> Option<f32> {
    let total: f64 = values.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    let reaches = |(_, weight): &&(f32, f64)| {
        below += weight;
        below >= share * total
    };
    values.iter().find(reaches).or(values.last()).map(|(value, _)| *value)
}

/// Digits of round numbers.
const ROUND: [f32; 9] = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];

/// The next round number upwards.
fn round_up(value: f32) -> f32 {
    let (digit, power) = digits(value);
    power * ROUND.into_iter().find(|round| *round >= 0.9999 * digit).unwrap_or(10.0)
}

/// The next round number downwards.
fn round_down(value: f32) -> f32 {
    let (digit, power) = digits(value);
    power * ROUND.into_iter().rev().find(|round| *round <= 1.0001 * digit).unwrap_or(1.0)
}

/// The next step upwards of 1, 2 or 5 times a power of ten.
fn round_step(value: f32) -> f32 {
    let (digit, power) = digits(value);
    power * [1.0, 2.0, 5.0].into_iter().find(|round| *round >= 0.8 * digit).unwrap_or(10.0)
}

/// A number as a digit, 1..10, times a power of ten.
fn digits(value: f32) -> (f32, f32) {
    let value = value.clamp(1e-30, 1e30);
    let power = 10_f32.powi(value.log10().floor() as i32);
    (value / power, power)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(low: f32, high: f32, spacing: Spacing) -> ColourScale {
        ColourScale { low, high, spacing, ramp: Ramp::Viridis }
    }

    /// Truth: the definitions of a linear and a logarithmic scale.
    #[test]
    fn places_and_values_are_inverse() {
        for scale in [scale(0.0, 8.0, Spacing::Linear), scale(0.02, 20.0, Spacing::Logarithmic)] {
            for along in [0.0, 0.25, 0.7, 1.0] {
                assert!((scale.along(scale.value_at(along)) - along).abs() < 1e-5);
            }
        }
        assert_eq!(scale(0.0, 8.0, Spacing::Linear).along(2.0), 0.25);
        assert!((scale(0.1, 10.0, Spacing::Logarithmic).along(1.0) - 0.5).abs() < 1e-6);
        // An empty range, or one that starts at nothing, is no reason for what is not a number.
        assert!(scale(3.0, 3.0, Spacing::Linear).along(4.0) > 1.0);
        assert!(scale(0.0, 3.0, Spacing::Logarithmic).along(0.0).is_finite());
    }

    /// Written out by hand.
    #[test]
    fn marks_are_round_in_the_unit_that_is_shown() {
        let lux = |scale: ColourScale| -> Vec<f32> {
            scale
                .ticks(ShownIn::Unit(Unit::Lumens))
                .into_iter()
                .map(|value| (179.0 * value * 100.0).round() / 100.0)
                .collect()
        };
        assert_eq!(lux(scale(0.0, 1000.0 / 179.0, Spacing::Linear)), [0.0, 200.0, 400.0, 600.0, 800.0, 1000.0]);
        assert_eq!(
            lux(scale(10.0 / 179.0, 1000.0 / 179.0, Spacing::Logarithmic)),
            [10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0]
        );
        let lines = Isolines::of_scale(&scale(0.0, 1000.0 / 179.0, Spacing::Linear), ShownIn::Unit(Unit::Lumens));
        assert_eq!(lines.values().len(), 4);
        assert_eq!(Isolines::at([5.0, -1.0, f32::NAN, 2.0, 5.0]).values(), [2.0, 5.0]);
        assert_eq!([round_up(730.0), round_up(0.101), round_down(730.0), round_down(0.1)], [800.0, 0.15, 600.0, 0.1]);
    }
}
