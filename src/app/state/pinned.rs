//! A solution that is kept, A, beside the running one, B: what the view shows of both, and how they
//! differ.

use std::sync::Arc;
use std::task::Poll;

use crate::app::Wake;
use crate::app::state::comparison::Shading;
use crate::app::view::paint::Beside;
use crate::base::threads::Background;
use crate::measure::accuracy::{Contrast, contrast};
use crate::solve::{Snapshot, SolverParams};

/// Sides that the view shows while a solution is pinned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// A at the left of the divider, B at its right.
    #[default]
    Split,
    A,
    B,
    /// B − A in colours.
    Difference,
}

/// The solution that is kept.
pub struct PinnedSolution {
    pub snapshot: Arc<Snapshot>,
    pub params: SolverParams,
    /// RMS error by the reference and its standard error, where it was measured.
    pub measured: Option<(f64, f64)>,
    /// The exposure of the view when it was kept, without its correction, m²/W.
    exposure: f32,
}

/// State of the comparison.
pub struct Pinned {
    solution: Option<PinnedSolution>,
    pub sides: Sides,
    /// Where the divider stands, as a share of the view's width.
    pub divider: f32,
    difference: Option<Difference>,
    /// A difference that is being computed.
    awaited: Option<Background<Difference>>,
}

/// How the two differ, as found for one snapshot of B.
struct Difference {
    of: Arc<Snapshot>,
    rms: f64,
    /// B's mesh in the colours of the difference.
    painted: Arc<Snapshot>,
}

impl Default for Pinned {
    fn default() -> Self {
        Self { solution: None, sides: Sides::Split, divider: 0.5, difference: None, awaited: None }
    }
}

impl Pinned {
    /// Keeps a solution as A.
    pub fn keep(&mut self, snapshot: Arc<Snapshot>, params: SolverParams, measured: Option<(f64, f64)>, exposure: f32) {
        self.let_go();
        self.solution = Some(PinnedSolution { snapshot, params, measured, exposure });
    }

    /// Lets A go.
    pub fn let_go(&mut self) {
        (self.solution, self.difference, self.awaited) = (None, None, None);
        self.sides = Sides::Split;
    }

    /// A.
    pub fn solution(&self) -> Option<&PinnedSolution> {
        self.solution.as_ref()
    }

    /// The metered exposure of both, m²/W, which is A's while one is kept: whoever compares wants
    /// no other difference.
    pub fn exposure(&self, metered: f32) -> f32 {
        self.solution.as_ref().map_or(metered, |solution| solution.exposure)
    }

    /// RMS difference of B to A as a share of A's RMS radiosity, of the newest B for which it was
    /// found.
    pub fn rms(&self) -> Option<f64> {
        self.difference.as_ref().map(|difference| difference.rms)
    }

    /// Finds how B differs, on a thread of its own, where nobody looks for that already.
    pub fn note(&mut self, b: Option<&Arc<Snapshot>>, wake: &Wake) {
        if let Some(awaited) = &self.awaited {
            let Poll::Ready(found) = awaited.poll() else { return };
            self.difference = found.or(self.difference.take());
            self.awaited = None;
        }
        let (Some(solution), Some(b)) = (&self.solution, b) else { return };
        if self.difference.as_ref().is_some_and(|difference| Arc::ptr_eq(&difference.of, b)) {
            return;
        }
        let (a, b, wake) = (solution.snapshot.clone(), b.clone(), wake.clone());
        let find = move || Difference::new(b.clone(), &contrast(&a, &b));
        self.awaited = Background::start("difference", move || wake(), find).ok();
    }

    /// A beside what the view shows, where both are to be seen.
    pub fn beside(&self) -> Option<Beside> {
        let solution = self.solution.as_ref().filter(|_| self.sides == Sides::Split)?;
        Some(Beside { snapshot: solution.snapshot.clone(), share: self.divider })
    }

    /// A alone, where it alone is to be seen.
    pub fn alone(&self) -> Option<Arc<Snapshot>> {
        self.solution.as_ref().filter(|_| self.sides == Sides::A).map(|solution| solution.snapshot.clone())
    }

    /// The difference in colours, where it is to be seen and was found.
    pub fn painted(&self) -> Option<Arc<Snapshot>> {
        let difference =
            self.difference.as_ref().filter(|_| self.sides == Sides::Difference && self.solution.is_some());
        difference.map(|difference| difference.painted.clone())
    }
}

impl Difference {
    fn new(of: Arc<Snapshot>, found: &Contrast) -> Self {
        Self { rms: found.rms, painted: Shading::Difference.painted(&of, &found.at_vertices), of }
    }
}
