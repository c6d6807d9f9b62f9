//! The paper's tables and statements, run again: its rows above ours, and a verdict on each of its
//! claims.
//!
//! A [`Lab`] makes measured runs at pinned settings ([`Effort`]); each [`Part`] makes a [`Report`]
//! of them, which holds tables for people, a record of every run with all its parameters for
//! programs, and [`Claim`]s whose verdicts are computed from the numbers.

mod claims;
mod columns;
mod effort;
#[cfg(feature = "gui")]
pub mod figures;
mod fit;
mod growth;
mod lab;
pub mod paper;
mod partial;
mod push;
mod rays;
mod report;
mod scale;
mod scale_text;
mod table1;
mod table2;

pub use claims::{Claim, Verdict, claims_markdown};
pub use effort::Effort;
pub use fit::{PowerLaw, fit};
pub use lab::{Lab, LeftOut, Room, Run};
pub use report::Report;

/// A part of the paper that can be run by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// Table 1: HR against IC.
    Table1,
    /// Table 2: ways to cluster.
    Table2,
    /// Section 3.3: immediate against deferred push.
    Push,
    /// Section 2.3: ε_partial and what ε means.
    Partial,
    /// Section 2.4: visibility rays.
    Rays,
    /// Sections 1.1 and 1.2: growth with the number of polygons.
    Scale,
    /// Figures 2 to 7.
    Figures,
}

impl Part {
    /// All of them, in the order in which they are run.
    pub const ALL: [Self; 7] =
        [Self::Table1, Self::Table2, Self::Push, Self::Partial, Self::Rays, Self::Scale, Self::Figures];

    /// Name of the part on the command line and of its files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Table1 => "table1",
            Self::Table2 => "table2",
            Self::Push => "push",
            Self::Partial => "partial",
            Self::Rays => "rays",
            Self::Scale => "scale",
            Self::Figures => "figures",
        }
    }

    /// The part with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|part| part.name() == name)
    }

    /// Runs the part; nothing for the figures, which need a graphics adapter (`figures::draw`, with
    /// the feature `gui`).
    pub fn run(self, lab: &mut Lab<'_>) -> Option<Report> {
        Some(match self {
            Self::Table1 => table1::run(lab),
            Self::Table2 => table2::run(lab),
            Self::Push => push::run(lab),
            Self::Partial => partial::run(lab),
            Self::Rays => rays::run(lab),
            Self::Scale => scale::run(lab),
            Self::Figures => return None,
        })
    }
}
