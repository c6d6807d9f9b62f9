//! How one mode's costs grow with the number of polygons.

use super::fit::{PowerLaw, fit};
use super::lab::{LeftOut, Run};

/// One mode's runs and laws.
pub struct Growth {
    /// Name of the mode in the tables.
    pub name: &'static str,
    /// The runs, small rooms first.
    pub runs: Vec<Result<Run, LeftOut>>,
    /// Time, s, of the number of polygons.
    pub time: Option<PowerLaw>,
    /// Links.
    pub links: Option<PowerLaw>,
    /// Pairs judged.
    pub pairs: Option<PowerLaw>,
    /// Bytes of links, elements and radiosities.
    pub memory: Option<PowerLaw>,
    /// Bytes of elements and radiosities alone.
    pub elements: Option<PowerLaw>,
}

impl Growth {
    pub fn new(name: &'static str, runs: Vec<Result<Run, LeftOut>>) -> Self {
        let law = |of: &dyn Fn(&Run) -> f64| {
            fit(&runs.iter().flatten().map(|run| (run.polygons as f64, of(run))).collect::<Vec<_>>())
        };
        Self {
            time: law(&Run::time),
            links: law(&|run| run.stats.links as f64),
            pairs: law(&|run| run.stats.pairs_judged as f64),
            memory: law(&|run| run.bytes() as f64),
            elements: law(&|run| run.stats.bytes.elements as f64),
            name,
            runs,
        }
    }

    /// The exponent that the time of the first room that took too long has at least over the
    /// largest one solved, with that room's polygons.
    pub fn least_exponent(&self) -> Option<(usize, f64)> {
        let largest = self.largest()?;
        let left_out = self.runs.iter().filter_map(|run| run.as_ref().err()).find(|run| run.longer_than.is_some())?;
        let (time, size) = (left_out.longer_than? / largest.time(), left_out.polygons as f64 / largest.polygons as f64);
        Some((left_out.polygons, time.ln() / size.ln()))
    }

    /// The largest room that was solved.
    pub fn largest(&self) -> Option<&Run> {
        self.runs.iter().flatten().last()
    }
}
