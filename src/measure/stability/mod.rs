//! Where methods of this family fail, row by row: each known failure as a small scene with a truth
//! that does not come from the solver.
//!
//! `selflink selftest` runs the rows and prints a line for each; `tests/stability` runs the same
//! rows as tests. A truth is a closed form, an invariant, a brute-force solution ([`matrix`]) or
//! the path-traced reference. What a row asks for is never loosened: where the method cannot meet
//! it, the row's check carries, beside what is allowed, what is known to be reached
//! ([`Check::known_to`]), and `docs/limits.md` says why, how much and how a person notices.

mod clusters;
mod convergence;
mod form_factors;
mod invariance;
mod leaks;
pub mod matrix;
pub mod measure;
mod mesh;
pub mod scenes;

use serde::Serialize;

use crate::solve::SolverError;

/// One way to fail.
pub struct Row {
    /// Number in the list of known failures, from 1.
    pub number: u32,
    /// Short name, as `--only` takes it.
    pub name: &'static str,
    /// Requirement, in one line.
    pub asked: &'static str,
    /// Why it cannot be met in full, in one sentence, where that is known; `docs/limits.md` has
    /// more.
    pub limit: Option<&'static str>,
    measure: fn() -> Result<Vec<Check>, SolverError>,
}

/// How a value must lie beside its truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Relation {
    /// No farther from it than allowed, on either side.
    Near,
    /// No more above it than allowed.
    AtMost,
}

/// One value of a row beside its truth.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// Measured quantity, and the mode of the solve.
    pub what: String,
    /// True value.
    pub truth: f64,
    /// Value that was found.
    pub ours: f64,
    /// How the two must lie.
    pub relation: Relation,
    /// How far `ours` may be off, in its own unit.
    pub allowed: f64,
    /// How far it is known to be off where it cannot be within `allowed`, with some margin.
    pub known: Option<f64>,
}

/// Outcome of a check or a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Within what is allowed.
    Pass,
    /// Beyond that, but no farther than is known and listed.
    KnownLimit,
    /// Beyond both.
    Fail,
}

impl Check {
    /// A value that must lie this near to the truth, in its own unit.
    pub fn near(what: impl Into<String>, truth: f64, ours: f64, allowed: f64) -> Self {
        Self { what: what.into(), truth, ours, relation: Relation::Near, allowed, known: None }
    }

    /// A value that must lie within this share of the truth.
    pub fn within(what: impl Into<String>, truth: f64, ours: f64, share: f64) -> Self {
        Self::near(what, truth, ours, share * truth.abs())
    }

    /// A value that may not exceed a bound.
    pub fn at_most(what: impl Into<String>, bound: f64, ours: f64) -> Self {
        let relation = Relation::AtMost;
        Self { what: what.into(), truth: bound, ours, relation, allowed: 0.0, known: None }
    }

    /// The check with a known limit: the value is known to be off by as much as this, in its own
    /// unit.
    pub fn known_to(self, known: f64) -> Self {
        Self { known: Some(known), ..self }
    }

    /// The check with a known limit: the value is known to be off by as much as this share of the
    /// truth.
    pub fn known_within(self, share: f64) -> Self {
        let known = share * self.truth.abs();
        self.known_to(known)
    }

    /// The check with a known limit where there is one, in the value's own unit.
    pub fn known_where(self, is_known: bool, known: f64) -> Self {
        if is_known { self.known_to(known) } else { self }
    }

    /// How far the value is off on the side that matters, in its own unit; infinite where it is no
    /// number.
    pub fn off(&self) -> f64 {
        let above = self.ours - self.truth;
        let off = match self.relation {
            Relation::Near => above.abs(),
            Relation::AtMost => above.max(0.0),
        };
        if above.is_nan() { f64::INFINITY } else { off }
    }

    /// Pass, known limit or fail.
    pub fn verdict(&self) -> Verdict {
        let off = self.off();
        match self.known {
            _ if off <= self.allowed => Verdict::Pass,
            Some(known) if off <= known => Verdict::KnownLimit,
            _ => Verdict::Fail,
        }
    }

    /// By how much it is off, as a multiple of what is allowed: of several checks the largest says
    /// most.
    fn excess(&self) -> f64 {
        let off = self.off();
        if off > 0.0 { off / self.allowed.max(1e-6 * self.truth.abs()).max(f64::MIN_POSITIVE) } else { 0.0 }
    }
}

/// Result of a row.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// Number of the row.
    pub number: u32,
    /// Name of the row.
    pub name: &'static str,
    /// Requirement of the row.
    pub asked: &'static str,
    /// Limit of the row, where one is known.
    pub limit: Option<&'static str>,
    /// The worst verdict of all checks.
    pub verdict: Verdict,
    /// Time it took, s.
    pub seconds: f64,
    /// All that was measured.
    pub checks: Vec<Check>,
}

impl Finding {
    /// The check that is worst: of the worst verdict, the farthest off.
    pub fn worst(&self) -> Option<&Check> {
        let order = |check: &&Check| (check.verdict(), check.excess());
        self.checks.iter().max_by(|a, b| {
            let ((a, a_excess), (b, b_excess)) = (order(a), order(b));
            a.cmp(&b).then(a_excess.total_cmp(&b_excess))
        })
    }
}

impl Row {
    /// Makes the row's scenes, solves them and compares.
    ///
    /// # Errors
    /// A solve that cannot start: no row asks for one.
    pub fn run(&self) -> Result<Finding, SolverError> {
        let begun = std::time::Instant::now();
        let checks = (self.measure)()?;
        let verdict = checks.iter().map(Check::verdict).max().unwrap_or(Verdict::Fail);
        let &Self { number, name, asked, limit, .. } = self;
        Ok(Finding { number, name, asked, limit, verdict, seconds: begun.elapsed().as_secs_f64(), checks })
    }
}

/// Every row, by number.
pub fn rows() -> Vec<Row> {
    let mut rows: Vec<Row> =
        [form_factors::rows(), leaks::rows(), clusters::rows(), mesh::rows(), invariance::rows(), convergence::rows()]
            .into_iter()
            .flatten()
            .collect();
    rows.sort_by_key(|row| row.number);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the definition of the relations; what is no number is never right.
    #[test]
    fn a_check_says_how_far_it_is_off() {
        let near = Check::near("x", 2.0, 2.5, 0.1);
        assert_eq!((near.off(), near.verdict()), (0.5, Verdict::Fail));
        assert_eq!(near.known_to(0.6).verdict(), Verdict::KnownLimit);
        assert_eq!(Check::within("x", 2.0, 2.1, 0.06).verdict(), Verdict::Pass);
        assert_eq!(Check::at_most("x", 1.0, -5.0).verdict(), Verdict::Pass);
        assert_eq!(Check::at_most("x", 1.0, 1.1).verdict(), Verdict::Fail);
        assert_eq!(Check::at_most("x", 1.0, f64::NAN).known_to(1e9).verdict(), Verdict::Fail);
    }

    /// All 25, each once, and none that measures nothing is a pass.
    #[test]
    fn rows_are_numbered_from_one() {
        let numbers: Vec<u32> = rows().iter().map(|row| row.number).collect();
        assert_eq!(numbers, (1..=25).collect::<Vec<_>>());
    }
}
