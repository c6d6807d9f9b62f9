//! A logarithmic axis with marks at 1, 2 and 5 times the powers of ten, however short it is.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};

/// The axis, from its least to its largest value; both above 0.
#[derive(Clone, Copy, Debug)]
pub struct LogAxis {
    low: f64,
    high: f64,
}

impl LogAxis {
    /// An axis that holds all these values with some room to spare; those that are not positive are
    /// left out.
    pub fn around(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let usable = values.into_iter().filter(|value| *value > 0.0 && value.is_finite());
        let (low, high) = usable.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        (low <= high).then(|| {
            let room = (high / low).powf(0.06).max(1.15);
            Self { low: low / room, high: high * room }
        })
    }

    /// Part of a stretch that lies on the axis, which ends above 0; none where all of it lies
    /// beside.
    pub fn clip(&self, from: f64, to: f64) -> Option<(f64, f64)> {
        let (from, to) = (from.max(self.low), to.min(self.high));
        (from < to).then_some((from, to))
    }

    /// Values to be marked with a number.
    pub fn marks(&self, most: usize) -> Vec<f64> {
        let steps: [&[f64]; 3] = [&[1.0, 2.0, 5.0], &[1.0, 3.0], &[1.0]];
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let of = |steps: &[f64]| {
            let all = decades.clone().flat_map(|decade| steps.iter().map(move |step| step * 10_f64.powi(decade)));
            all.filter(|value| (self.low..=self.high).contains(value)).collect::<Vec<_>>()
        };
        let choices = steps.map(of);
        choices.iter().find(|marks| marks.len() <= most).unwrap_or(&choices[2]).clone()
    }
}

impl Ranged for LogAxis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value / self.low).ln() / (self.high / self.low).ln();
        limit.0 + (share * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        self.marks(hint.max_num_points())
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the definition of a logarithmic scale, and numbers people like.
    #[test]
    fn marks_are_round_and_evenly_spread_by_ratio() {
        let axis = LogAxis { low: 0.01, high: 1.0 };
        assert_eq!(axis.map(&0.1, (0, 200)), 100);
        assert_eq!(axis.map(&0.1, (200, 0)), 100);
        let near = |marks: Vec<f64>, wanted: &[f64]| {
            marks.len() == wanted.len() && marks.iter().zip(wanted).all(|(a, b)| (a / b - 1.0).abs() < 1e-9)
        };
        assert!(near(LogAxis { low: 0.04, high: 0.3 }.marks(10), &[0.05, 0.1, 0.2]));
        assert!(near(LogAxis { low: 0.9e-3, high: 200.0 }.marks(7), &[1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0]));
        assert!(LogAxis::around([0.0, f64::NAN]).is_none());
        assert_eq!(axis.clip(-0.3, 0.5), Some((0.01, 0.5)));
        assert_eq!(axis.clip(0.5, f64::INFINITY), Some((0.5, 1.0)));
        assert_eq!((axis.clip(-3.0, 0.0), axis.clip(2.0, 3.0)), (None, None));
    }
}
