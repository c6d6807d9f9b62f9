//! Transport: one link, from the root cluster to itself, refined until every link carries little
//! enough, and light moved over what has come of it.
//!
//! A [`LinkSolution`] owns the elements, the links between them and their light. It does four
//! things, each of which whoever drives it asks for:
//!
//! 1. [`LinkSolution::refine`] judges a part of the pairs that wait (`Oracle`) and applies the
//!    verdicts.
//! 2. [`LinkSolution::converge`] moves light over the stored links until nothing changes
//!    ([`Gatherer`]).
//! 3. [`LinkSolution::recheck`] judges the stored links again, for B has grown; those that fail
//!    wait.
//! 4. [`LinkSolution::merge_back`] undoes refinement that a coarser threshold does not ask for.
//!
//! This module imports `base`, `scene`, `geometry` and `hierarchy`.

mod audit;
mod bounds;
mod candidate;
mod closure;
mod coarsen;
mod edit;
mod entering;
mod form_factor;
mod harmonics;
mod link;
mod nodes;
mod oracle;
mod pair_samples;
mod push;
mod push_weights;
mod recheck;
mod refine;
mod rules;
mod solution;
pub mod solution_view;
mod stem;
mod sweep;
mod verdict;
mod visibility;
mod waiting;

pub use audit::{Audit, audit};
pub use candidate::Waiting;
pub use entering::{ENTERING_RAYS, entering_power, lets_daylight_in, new_hierarchy};
pub use form_factor::{Exchange, exchange};
pub use harmonics::NormalMoments;
pub use link::{Link, LinkTable, VisibilitySource};
pub use recheck::{RecheckReasons, Rechecked};
pub use refine::{Applied, Counts, Refinement, RejectedPair};
pub use rules::{ClusterModel, LinkRules, Push};
pub use solution::LinkSolution;
pub use solution_view::{LinkError, LinkView, SolutionView};
pub use sweep::{Change, Gatherer, LARGEST_RETURN, Light};
pub use verdict::{OccludedPair, Rejection};
