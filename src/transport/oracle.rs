//! The oracle: decides what becomes of a pair; pure, so that a wave can be judged in parallel.
//!
//! The power oracle of the paper (section 2.3, [Lischinski 94]): refine while B_s·F·A_r > ε, with
//! ε_partial where the ends see each other only in part; rays in proportion to B·F·A/ε within
//! bounds (section 2.4).

use crate::hierarchy::{Cluster, ElementId, Hierarchy, Shape};

use super::candidate::{Candidate, Directions, end_to_split};
use super::form_factor::{Exchange, exchange, self_exchange};
use super::link::{Link, VisibilitySource};
use super::pair_samples::{PairSamples, RayBudget, RaySampler, SampleDensity};
use super::recheck::RecheckReasons;
use super::rules::ClusterModel;
use super::verdict::{Decision, OccludedPair, Rejection, Verdict};
use super::visibility::{Thresholds, VisibilityEstimate, VisibilityKind};

/// A stored link may exceed its threshold by this factor before it is judged again: B creeps up
/// towards its limit, and a round for the last few percent refines links that matter as little as
/// those beside them.
const MARGIN: f32 = 1.1;

/// Rays of a self-link that is kept: there are few of them, and of their points few face each
/// other.
const SELF_RAYS: u32 = 32;

/// Clusters of up to this many polygons are looked at pair by pair before their self-link is kept.
const MOST_CONVEX: usize = 8;

/// Judges pairs against one state of the solution.
pub struct Oracle<'a> {
    /// Elements.
    pub hierarchy: &'a Hierarchy,
    /// Largest colour of each element's radiosity B, W/m².
    pub max_radiosity: &'a [f32],
    /// Whether anything may be split; pairs are kept as they are where memory holds no more.
    pub may_split: bool,
    /// Thresholds.
    pub thresholds: Thresholds,
    /// Model of how clusters exchange light.
    pub model: ClusterModel,
    /// Casts visibility rays.
    pub sampler: RaySampler<'a>,
}

impl Oracle<'_> {
    /// Decides about a candidate.
    pub fn judge(&self, candidate: &Candidate) -> Verdict {
        if candidate.is_self() {
            return self.judge_self(candidate);
        }
        let (a, b) = (candidate.a, candidate.b);
        let Exchange::Facing { estimate, bound, .. } = exchange(self.hierarchy, a, b) else {
            return Verdict::alike(candidate, Decision::Reject(Rejection::FacingAway));
        };
        let max_radiosity_to_a = if candidate.directions.to_a { self.max_radiosity[b.index()] } else { 0.0 };
        let max_radiosity_to_b = if candidate.directions.to_b { self.max_radiosity[a.index()] } else { 0.0 };
        let strongest = max_radiosity_to_a.max(max_radiosity_to_b);
        // A dark direction waits for its own judgement and needs nothing of this one.
        let weakest = match (max_radiosity_to_a > 0.0, max_radiosity_to_b > 0.0) {
            (true, true) => max_radiosity_to_a.min(max_radiosity_to_b),
            _ => strongest,
        };
        let seen = if strongest > 0.0 {
            // Where both directions would be refined anyway, a mixture of seen and blocked rays
            // says all.
            let stop_when_mixed = self.may_split && weakest * bound > self.thresholds.epsilon_partial;
            self.look(candidate, strongest * estimate, strongest * bound, stop_when_mixed)
        } else {
            VisibilityEstimate::unseen(candidate)
        };
        let mut rays = seen.rays;
        let mut second_look = None;
        let mut decide = |asked: bool, receiver: ElementId, source: ElementId, density: SampleDensity| {
            if !asked {
                return Decision::NotAsked;
            }
            let form_factor = self.form_factor(receiver, source, estimate, seen.samples.as_ref());
            let link = Link::new(source, form_factor, seen.visibility, seen.visibility_source());
            let mut decision = self.decide(receiver, link, bound, seen.kind);
            if let Decision::Accept(link) | Decision::AcceptAtGuard(link) = &mut decision
                && seen.kind == VisibilityKind::Full
                && self.is_chosen_for_clear(link, bound)
            {
                let samples = second_look.get_or_insert_with(|| {
                    let samples = self.look_again((a, b), strongest * estimate);
                    rays += samples.cast;
                    samples
                });
                *link = link.with_visibility(if samples.cast > 0 { samples.visibility() } else { 1.0 });
            }
            if let Decision::Accept(link) | Decision::AcceptAtGuard(link) = &mut decision
                && let Some(budget) = seen.budget
                && self.model == ClusterModel::Oriented
                && self.sampler.emits_in_part(self.hierarchy, source)
            {
                let samples = self.sampler.sample_pairs(self.hierarchy, (a, b), density, budget);
                rays += samples.cast;
                let (to, from) = (self.hierarchy.element(receiver), self.hierarchy.element(source));
                link.direct = (from.area * samples.mean_visible_kernel()).min(1.0)
                    / (to.reachable_share() * from.reachable_share());
            }
            decision
        };
        let to_a = decide(candidate.directions.to_a, a, b, SampleDensity::EmissionOfB);
        let to_b = decide(candidate.directions.to_b, b, a, SampleDensity::EmissionOfA);
        Verdict {
            to_a,
            to_b,
            visibility: seen.visibility,
            fully_visible: seen.kind == VisibilityKind::Full,
            is_negligible: strongest * bound <= self.thresholds.epsilon_partial,
            rays,
        }
    }

    /// Whether nobody has judged a stored link whose source shines by now; where nothing may be
    /// split, all else stays as it is.
    pub fn is_unjudged(&self, link: &Link) -> bool {
        link.visibility_source() == VisibilitySource::None && self.max_radiosity[link.source().index()] > 0.0
    }

    /// Whether a stored link fails by the present radiosities and must be judged again.
    pub fn must_judge_again(&self, receiver: ElementId, link: &Link) -> bool {
        let source = link.source();
        let max_radiosity = self.max_radiosity[source.index()];
        if max_radiosity <= 0.0 {
            return false;
        }
        if link.visibility_source() == VisibilitySource::None {
            return true;
        }
        let hierarchy = self.hierarchy;
        let area = hierarchy.element(receiver).area;
        let (power, bound) = if receiver == source {
            (max_radiosity * area, max_radiosity * area)
        } else if hierarchy.element(receiver).is_patch() && hierarchy.element(source).is_patch() {
            // Patches have one estimate, and the link holds it.
            let sampled = hierarchy.element(receiver).reachable_share() * hierarchy.element(source).reachable_share();
            let power = max_radiosity * link.form_factor * sampled * area;
            (power, power)
        } else {
            match exchange(hierarchy, receiver, source) {
                Exchange::FacingAway => return true,
                Exchange::Facing { estimate, bound, .. } => (max_radiosity * estimate, max_radiosity * bound),
            }
        };
        let rays = match link.visibility_source() {
            VisibilitySource::Inherited => u32::MAX,
            VisibilitySource::Clear(rays) | VisibilitySource::Rays(rays) => u32::from(rays),
            VisibilitySource::None => return true,
        };
        if bound > MARGIN * self.allowed_by(link.visibility_source()) {
            return receiver == source || end_to_split(hierarchy, receiver, source).is_some();
        }
        // More light than it was judged by may ask for more rays; a doubled count is worth a new
        // look.
        bound > self.thresholds.epsilon_partial && self.thresholds.rays_for(power) >= rays.saturating_mul(2)
    }

    /// Whether a stored link that carries no more than it may must be judged again all the same.
    pub fn link_needs_recheck(&self, receiver: ElementId, link: &Link, reasons: RecheckReasons) -> bool {
        let (hierarchy, source) = (self.hierarchy, link.source());
        let max_radiosity = self.max_radiosity[source.index()];
        if max_radiosity <= 0.0 || receiver == source && !reasons.cluster_model {
            return false;
        }
        let has_too_few = || match (link.visibility_source(), exchange(hierarchy, receiver, source)) {
            (VisibilitySource::Clear(rays) | VisibilitySource::Rays(rays), Exchange::Facing { estimate, .. }) => {
                self.thresholds.rays_for(max_radiosity * estimate) > u32::from(rays)
            }
            // What it comes from had rays.
            _ => true,
        };
        let has_cluster = hierarchy.element(receiver).is_cluster() || hierarchy.element(source).is_cluster();
        reasons.cluster_model && has_cluster || reasons.more_rays && has_too_few()
    }

    /// Whether a pair that no ray came through could by now carry enough to be looked at again: it
    /// was dropped as negligible and is no more, or ε has become finer. To refine only those of its
    /// like that one of a few rays happened to come through, and forget the others, would lose
    /// light.
    pub fn occluded_needs_recheck(&self, occluded: &OccludedPair, reasons: RecheckReasons) -> bool {
        if occluded.was_negligible && reasons.more_rays {
            return true;
        }
        if !(occluded.was_negligible || reasons.finer_epsilon) {
            return false;
        }
        let pair = &occluded.pair;
        let to = |asked: bool, source: ElementId| if asked { self.max_radiosity[source.index()] } else { 0.0 };
        let max_radiosity = to(pair.directions.to_a, pair.b).max(to(pair.directions.to_b, pair.a));
        match exchange(self.hierarchy, pair.a, pair.b) {
            Exchange::FacingAway => false,
            Exchange::Facing { bound, .. } => max_radiosity * bound > MARGIN * self.thresholds.epsilon_partial,
        }
    }

    /// Power that a link may carry whose visibility is known so, W.
    pub fn allowed_by(&self, visibility_source: VisibilitySource) -> f32 {
        match visibility_source {
            VisibilitySource::Clear(_) | VisibilitySource::Inherited => self.thresholds.epsilon,
            VisibilitySource::Rays(_) | VisibilitySource::None => self.thresholds.epsilon_partial,
        }
    }

    /// Whether a cluster sends no more than it may while its self-link is kept.
    pub fn accepts_self(&self, cluster: ElementId) -> bool {
        let power = self.max_radiosity[cluster.index()] * self.hierarchy.element(cluster).area;
        power <= self.thresholds.epsilon_partial
    }

    /// A self-link is refined while the power that its cluster sends could matter; it has no rays,
    /// its estimate holds the cluster's own occlusion.
    fn judge_self(&self, candidate: &Candidate) -> Verdict {
        let element = self.hierarchy.element(candidate.a);
        let Shape::Cluster(cluster) = element.shape else {
            return Verdict::alike(candidate, Decision::Reject(Rejection::FacingAway));
        };
        let mut rays = 0;
        let decision = if self.may_split && !self.accepts_self(candidate.a) {
            Decision::Refine(candidate.a)
        } else if self.is_convex(&cluster) {
            Decision::Reject(Rejection::FacingAway)
        } else {
            let is_lit = self.max_radiosity[candidate.a.index()] > 0.0;
            let visibility_source = if is_lit { VisibilitySource::Inherited } else { VisibilitySource::None };
            Decision::Accept(self.self_link(candidate.a, &cluster, visibility_source, &mut rays))
        };
        Verdict {
            to_a: decision,
            to_b: Decision::NotAsked,
            visibility: 1.0,
            fully_visible: false,
            is_negligible: false,
            rays,
        }
    }

    /// A cluster's link to itself: F·V of what its polygons send each other by pairs of points on
    /// them, or, where they count as a volume or nothing is lit yet, by the closed form of a sphere
    /// of the same density.
    fn self_link(&self, id: ElementId, cluster: &Cluster, visibility_source: VisibilitySource, rays: &mut u32) -> Link {
        let element = self.hierarchy.element(id);
        if element.area <= 0.0 {
            return Link::new(id, 0.0, 1.0, visibility_source);
        }
        if self.model == ClusterModel::Isotropic || visibility_source == VisibilitySource::None {
            return Link::new(id, self_exchange(element, cluster) / element.area, 1.0, visibility_source);
        }
        let asked = SELF_RAYS.max(self.thresholds.rays_min);
        let budget = RayBudget { rays: asked, rays_if_blocked: asked, stop_when_mixed: false };
        let samples = self.sampler.sample_pairs(self.hierarchy, (id, id), SampleDensity::Even, budget);
        *rays += samples.cast;
        let share = element.reachable_share();
        let form_factor = (element.area * samples.mean_kernel()).min(1.0) / (share * share);
        Link::new(id, form_factor, samples.visibility(), visibility_source)
    }

    /// Whether a small cluster's polygons, such as the sides of a box, all turn their backs on each
    /// other.
    pub fn is_convex(&self, cluster: &Cluster) -> bool {
        let patches = self.hierarchy.patches_below(cluster);
        let see_each_other = |a: &ElementId, b: &ElementId| exchange(self.hierarchy, *a, *b) != Exchange::FacingAway;
        patches.len() <= MOST_CONVEX
            && !patches.iter().enumerate().any(|(place, a)| patches[..place].iter().any(|b| see_each_other(a, b)))
    }

    /// Form factor F(r←s) without occlusion: by the estimate for patches and where nobody looked,
    /// else by how the polygons of the clusters are turned. Where random points lie on hidden parts
    /// as well, V is low by their shares and F high.
    fn form_factor(&self, receiver: ElementId, source: ElementId, estimate: f32, samples: Option<&PairSamples>) -> f32 {
        let (to, from) = (self.hierarchy.element(receiver), self.hierarchy.element(source));
        if to.area <= 0.0 {
            return 0.0;
        }
        let form_factor = match samples {
            Some(samples) if self.model == ClusterModel::Oriented && (to.is_cluster() || from.is_cluster()) => {
                from.area * samples.mean_kernel()
            }
            _ => estimate / to.area,
        };
        form_factor.min(1.0) / (to.reachable_share() * from.reachable_share())
    }

    /// Looks at other points of a pair than those that made it look clear.
    fn look_again(&self, pair: (ElementId, ElementId), power: f32) -> PairSamples {
        let asked = self.thresholds.rays_for(power);
        let budget = RayBudget { rays: asked, rays_if_blocked: asked, stop_when_mixed: false };
        self.sampler.sample_pairs(self.hierarchy, pair, SampleDensity::EvenAgain, budget)
    }

    /// Whether a link is kept only because its ends looked clear of each other: it would be refined
    /// otherwise, or it was never looked at itself. Its V must then come from another look.
    fn is_chosen_for_clear(&self, link: &Link, bound: f32) -> bool {
        let max_radiosity = self.max_radiosity[link.source().index()];
        match link.visibility_source() {
            VisibilitySource::None => false,
            VisibilitySource::Inherited => true,
            VisibilitySource::Clear(_) | VisibilitySource::Rays(_) => {
                max_radiosity * bound > self.thresholds.epsilon_partial
            }
        }
    }

    fn decide(&self, receiver: ElementId, link: Link, bound: f32, kind: VisibilityKind) -> Decision {
        let max_radiosity = self.max_radiosity[link.source().index()];
        if max_radiosity <= 0.0 {
            return Decision::Accept(link.unjudged());
        }
        let allowed = match kind {
            VisibilityKind::None => return Decision::Reject(Rejection::Occluded),
            VisibilityKind::Full => self.thresholds.epsilon,
            VisibilityKind::Partial | VisibilityKind::Unknown => self.thresholds.epsilon_partial,
        };
        if max_radiosity * bound <= allowed || !self.may_split {
            return Decision::Accept(link);
        }
        end_to_split(self.hierarchy, receiver, link.source()).map_or(Decision::AcceptAtGuard(link), Decision::Refine)
    }

    fn are_patches(&self, pair: &Candidate) -> bool {
        let is_flat = |id: ElementId| !self.hierarchy.element(id).is_cluster();
        is_flat(pair.a) && is_flat(pair.b)
    }

    /// Finds out how well the ends of a pair see each other, with as many rays as its power
    /// deserves.
    fn look(&self, candidate: &Candidate, power: f32, bound: f32, stop_when_mixed: bool) -> VisibilityEstimate {
        let samples = |density: SampleDensity, budget: RayBudget| {
            self.sampler.sample_pairs(self.hierarchy, (candidate.a, candidate.b), density, budget)
        };
        if candidate.inherits_visible {
            let budget = RayBudget { rays: 0, rays_if_blocked: 0, stop_when_mixed };
            let found = (!self.are_patches(candidate)).then(|| samples(SampleDensity::Even, budget));
            return VisibilityEstimate {
                visibility: 1.0,
                samples: found,
                budget: Some(budget),
                ..VisibilityEstimate::unseen(candidate)
            };
        }
        if self.may_split && bound > self.thresholds.epsilon && bound > power {
            // Boxes that touch are refined in any case; what their members see is for their members
            // to find out.
            return VisibilityEstimate::unseen(candidate);
        }
        let asked = self.thresholds.rays_for(power);
        let (to_reject, most) = self.thresholds.rays_to_reject(power);
        let budget = RayBudget { rays: asked, rays_if_blocked: to_reject.clamp(asked, most), stop_when_mixed };
        let found = samples(SampleDensity::Even, budget);
        let mut rays = found.cast;
        let budget = RayBudget { rays_if_blocked: asked, stop_when_mixed: false, ..budget };
        // Patches that show each other no point face away; of a cluster, the faces that matter may
        // have been missed.
        let face_away = found.cast == 0 && self.are_patches(candidate);
        let believed = face_away || found.cast >= to_reject || bound <= self.thresholds.epsilon_partial;
        let mut shows_lamp = |asked: bool, source: ElementId, density: SampleDensity| {
            asked && self.sampler.emits_in_part(self.hierarchy, source) && {
                let lamp = samples(density, budget);
                rays += lamp.cast;
                lamp.visible > 0
            }
        };
        let mut is_occluded = || {
            let Directions { to_a, to_b } = candidate.directions;
            found.visible == 0
                && believed
                && !shows_lamp(to_a, candidate.b, SampleDensity::EmissionOfB)
                && !shows_lamp(to_b, candidate.a, SampleDensity::EmissionOfA)
        };
        let kind = if found.visible == found.cast && found.visible > 0 {
            VisibilityKind::Full
        } else if is_occluded() {
            VisibilityKind::None
        } else {
            VisibilityKind::Partial
        };
        VisibilityEstimate {
            kind,
            visibility: found.visibility(),
            rays,
            asked,
            samples: Some(found),
            budget: Some(budget),
        }
    }
}
