//! Error of a link, estimated as refinement by link error does.

use super::super::form_factor::{Exchange, exchange};
use super::super::link_error::{Facing, LinkError, SourceLight, estimated_error, radiosity_stddev_of, seen_by};
use super::{LinkView, SolutionView};

impl SolutionView {
    /// Power that a link is likely to misplace, make up or lose by each cause, W: what the error
    /// oracle holds against ε, whichever oracle the solution is refined by. Nobody looked at an
    /// unjudged link: it counts as if no ray had met it. A self-link may be wrong by all that it
    /// could carry.
    pub fn error(&self, link: &LinkView) -> LinkError {
        let source = link.source;
        let max_radiosity = self.radiosity(source).max_element();
        if link.receiver == source {
            let all = max_radiosity * self.hierarchy.element(source).area;
            return LinkError { sight: all, ..LinkError::default() };
        }
        if max_radiosity <= 0.0 {
            return LinkError::default();
        }
        match exchange(&self.hierarchy, link.receiver, source) {
            Exchange::Facing { estimate, bound, overlapping } => {
                let facing = Facing { estimate, bound, overlapping };
                let light = SourceLight { max_radiosity, radiosity_stddev: self.radiosity_stddev(source) };
                let seen = seen_by(link.visibility, link.visibility_source).unwrap_or((link.visibility, Some(0)));
                estimated_error(&self.hierarchy, (link.receiver, source), facing, light, seen)
            }
            // One end lies behind the other: all that it carries is wrong.
            Exchange::FacingAway => LinkError { sight: link.power.max_element(), ..LinkError::default() },
        }
    }

    /// Standard deviation of radiosity over an element's leaves, W/m².
    fn radiosity_stddev(&self, id: crate::hierarchy::ElementId) -> f32 {
        let radiosity_stddev = self.radiosity_stddev.get_or_init(|| {
            let max_radiosity: Vec<f32> =
                self.light.radiosity.iter().map(|radiosity| radiosity.max_element()).collect();
            let mut radiosity_stddev = Vec::new();
            radiosity_stddev_of(&self.hierarchy, &max_radiosity, &mut radiosity_stddev);
            radiosity_stddev
        });
        radiosity_stddev.get(id.index()).copied().unwrap_or(0.0)
    }
}
