//! The sum of the parts of a pair, and whether the oracle would keep the whole as one link.

use crate::hierarchy::{ElementId, Hierarchy};
use crate::transport::form_factor::{Exchange, exchange};
use crate::transport::link::{Link, VisibilitySource};
use crate::transport::oracle::Oracle;

/// Sums over the parts of a pair, as the whole's means.
#[derive(Clone, Copy, Debug, Default)]
pub struct Combined {
    /// F·V.
    transfer: f32,
    /// F without occlusion, of the whole surfaces that light can reach.
    form_factor: f32,
    /// F·V of what the source emits.
    direct: f32,
    /// Rays that looked at the parts.
    rays: u32,
    /// Links among the parts.
    pub links: u32,
    /// Of these, how many somebody looked at, and how many of those were seen in part.
    judged: u32,
    mixed: u32,
    /// Of these, how many looked clear by rays of their own.
    clear: u32,
    /// Parts that no ray came through.
    pub occluded: u32,
    /// Whether few rays were enough to believe that of one of these.
    pub was_negligible: bool,
}

impl Combined {
    /// Adds a part that has a link: `weight` is its receiver's share in the area of the whole's,
    /// `emission` its source's emission in multiples of the whole's. What the source reflects
    /// counts as spread evenly over it.
    pub fn add(&mut self, hierarchy: &Hierarchy, receiver: ElementId, link: &Link, weight: f32, emission: f32) {
        let reachable =
            hierarchy.element(receiver).reachable_share() * hierarchy.element(link.source()).reachable_share();
        self.transfer += weight * link.transfer();
        self.form_factor += weight * link.form_factor * reachable;
        self.direct += weight * link.direct * emission;
        self.links += 1;
        let rays = match link.visibility_source() {
            VisibilitySource::None => return,
            VisibilitySource::Inherited => 0,
            VisibilitySource::Clear(rays) => {
                self.clear += 1;
                rays
            }
            VisibilitySource::Rays(rays) => {
                self.mixed += 1;
                rays
            }
        };
        self.judged += 1;
        self.rays = self.rays.saturating_add(u32::from(rays));
    }

    /// Adds a part that is occluded; its form factor makes the whole's visibility less.
    pub fn add_occluded(&mut self, hierarchy: &Hierarchy, pair: (ElementId, ElementId), weight: f32, negligible: bool) {
        let area = hierarchy.element(pair.0).area;
        if let Exchange::Facing { estimate, .. } = exchange(hierarchy, pair.0, pair.1)
            && area > 0.0
        {
            self.form_factor += weight * (estimate / area).min(1.0);
        }
        self.occluded += 1;
        self.was_negligible |= negligible;
    }

    /// As a link: the same power passes over it as over its parts, by F and V of their means.
    fn as_link(
        &self,
        hierarchy: &Hierarchy,
        receiver: ElementId,
        source: ElementId,
        visibility_source: VisibilitySource,
    ) -> Link {
        let reachable = hierarchy.element(receiver).reachable_share() * hierarchy.element(source).reachable_share();
        let form_factor = (self.form_factor.min(1.0) / reachable).max(self.transfer);
        let visibility = if form_factor > 0.0 { self.transfer / form_factor } else { 0.0 };
        let mut link = Link::new(source, form_factor, visibility, visibility_source);
        link.direct = self.direct;
        link
    }

    /// Mean visibility V, 0..=1.
    fn visibility(&self) -> f32 {
        if self.form_factor > 0.0 { (self.transfer / self.form_factor).min(1.0) } else { 0.0 }
    }

    /// How V is known where so many rays would have been cast at the whole. It counts as clear if
    /// it is so clear that more likely than not all of them would have come through, which is what
    /// a look at the whole would have made of it.
    fn visibility_source(&self, asked: u32) -> VisibilitySource {
        let rays = self.rays.clamp(1, u32::from(u16::MAX)) as u16;
        if self.judged == 0 && self.occluded == 0 {
            VisibilitySource::None
        } else if self.mixed == 0 && self.occluded == 0 && self.clear == 0 {
            VisibilitySource::Inherited
        } else if self.visibility().powi(asked.min(1024) as i32) >= 0.5 {
            VisibilitySource::Clear(rays)
        } else {
            VisibilitySource::Rays(rays)
        }
    }
}

impl Oracle<'_> {
    /// The link of a pair whose parts come to this, if it were not refined by the present
    /// radiosities.
    pub fn accept_merged(&self, receiver: ElementId, source: ElementId, combined: &Combined) -> Option<Link> {
        let hierarchy = self.hierarchy;
        let max_radiosity = self.max_radiosity[source.index()];
        if receiver == source {
            let visibility_source =
                if max_radiosity > 0.0 { VisibilitySource::Inherited } else { VisibilitySource::None };
            return self.accepts_self(source).then(|| combined.as_link(hierarchy, receiver, source, visibility_source));
        }
        let Exchange::Facing { estimate, bound, .. } = exchange(hierarchy, receiver, source) else {
            return None;
        };
        let visibility_source = combined.visibility_source(self.thresholds.rays_for(max_radiosity * estimate));
        let link = combined.as_link(hierarchy, receiver, source, visibility_source);
        if max_radiosity <= 0.0 {
            return Some(link.unjudged());
        }
        if visibility_source == VisibilitySource::None {
            // The whole is bright where those of its parts that were looked at are dark.
            return None;
        }
        (max_radiosity * bound <= self.allowed_by(visibility_source)).then_some(link)
    }
}
