//! Claims of the paper, findings here, and whether they agree. Verdicts come from numbers,
//! by a rule that is stated.

use std::fmt;

use super::Report;
use crate::measure::records::Table;

/// How a claim fares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// As the paper says.
    Confirmed,
    /// More so than the paper says.
    Better,
    /// Otherwise here.
    NotSoHere,
}

impl Verdict {
    /// Of a gain: better from `better` on, confirmed from `enough` on.
    pub fn at_least(value: f64, enough: f64, better: f64) -> Self {
        if value >= better {
            Self::Better
        } else if value >= enough {
            Self::Confirmed
        } else {
            Self::NotSoHere
        }
    }

    /// Of a cost: better up to `better`, confirmed up to `enough`.
    pub fn at_most(value: f64, enough: f64, better: f64) -> Self {
        Self::at_least(-value, -enough, -better)
    }

    /// Of what is so or not.
    pub fn so(holds: bool) -> Self {
        if holds { Self::Confirmed } else { Self::NotSoHere }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Confirmed => "confirmed",
            Self::Better => "better",
            Self::NotSoHere => "not so here",
        })
    }
}

/// A statement of the paper beside what was found.
#[derive(Clone, Debug)]
pub struct Claim {
    /// Section, table or figure.
    pub place: &'static str,
    /// Statement of the paper.
    pub says: &'static str,
    /// Finding, with its numbers.
    pub found: String,
    /// When the verdict is *confirmed* or *better*.
    pub rule: &'static str,
    /// The verdict.
    pub verdict: Verdict,
}

impl Claim {
    /// A claim whose runs were left out.
    pub fn unanswered(place: &'static str, says: &'static str, rule: &'static str, why: &str) -> Self {
        let found = format!("left out: {why}");
        Self { place, says, found, rule, verdict: Verdict::NotSoHere }
    }
}

/// The claims of some reports as a Markdown table.
pub fn claims_markdown(reports: &[Report]) -> String {
    let row = |(report, claim): (&Report, &Claim)| {
        vec![
            claim.place.to_owned(),
            claim.says.to_owned(),
            claim.found.clone(),
            format!("*{}*", claim.verdict),
            claim.rule.to_owned(),
            format!("`selflink tables --only {}`", report.part.name()),
        ]
    };
    let claims = reports.iter().flat_map(|report| report.claims.iter().map(move |claim| (report, claim)));
    let head = ["where", "the paper", "here", "verdict", "rule", "command"];
    Table::new("", head, claims.map(row).collect()).markdown_with(6)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the definitions.
    #[test]
    fn verdicts_follow_their_bounds() {
        let gains = [0.5, 1.0, 1.9, 2.0].map(|value| Verdict::at_least(value, 1.0, 2.0).to_string());
        assert_eq!(gains, ["not so here", "confirmed", "confirmed", "better"]);
        let costs = [0.1, 0.2, 0.3, 0.4, f64::NAN].map(|value| Verdict::at_most(value, 0.3, 0.1));
        use Verdict::{Better, Confirmed, NotSoHere};
        assert_eq!(costs, [Better, Confirmed, Confirmed, NotSoHere, NotSoHere]);
    }
}
