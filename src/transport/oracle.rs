//! The oracle: decides what becomes of a pair; pure, so that a wave can be judged in parallel.
//!
//! The power oracle of the paper (section 2.3, [Lischinski 94]): refine while B_s·F·A_r > ε, with ε_partial where the ends
//! see each other only in part; rays in proportion to B·F·A/ε within bounds (section 2.4). The error oracle (`link_error`)
//! looks the same way and decides otherwise.

use crate::hierarchy::{Cluster, ElementId, Hierarchy, Shape};

use super::candidate::{Candidate, Directions, end_to_split};
use super::form_factor::{Exchange, exchange, self_exchange};
use super::link::{Evidence, Link};
use super::link_error::Facing;
use super::rays::{RayPlan, RaySampler, Spread, Survey};
use super::recheck::Doubts;
use super::rules::{ClusterModel, OracleKind};
use super::sight::{Sight, SightKind, Thresholds};
use super::verdict::{Decision, OccludedPair, Rejection, Verdict};

/// A stored link may exceed its threshold by this factor before it is judged again: B creeps up towards its limit, and a
/// round for the last few percent refines links that matter as little as those beside them.
const MARGIN: f32 = 1.1;

/// Rays of a self-link that is kept: there are few of them, and of their points few face each other.
const SELF_RAYS: u32 = 32;

/// Clusters of up to this many polygons are looked at pair by pair before their self-link is kept.
const MOST_CONVEX: usize = 8;

/// Judges pairs against one state of the solution.
pub struct Oracle<'a> {
    /// Elements.
    pub hierarchy: &'a Hierarchy,
    /// Largest colour of each element's radiosity B, W/m².
    pub brightness: &'a [f32],
    /// Standard deviation of that over the leaves of each element, W/m².
    pub spread: &'a [f32],
    /// What links are refined by.
    pub kind: OracleKind,
    /// Whether anything may be split; pairs are kept as they are where memory holds no more.
    pub may_split: bool,
    /// Thresholds.
    pub thresholds: Thresholds,
    /// What clusters are to light.
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
        let (estimate, bound, overlapping) = match exchange(self.hierarchy, a, b) {
            Exchange::FacingAway => return Verdict::alike(candidate, Decision::Reject(Rejection::FacingAway)),
            Exchange::Facing { estimate, bound, overlapping } => (estimate, bound, overlapping),
        };
        let brightness_to_a = if candidate.directions.to_a { self.brightness[b.index()] } else { 0.0 };
        let brightness_to_b = if candidate.directions.to_b { self.brightness[a.index()] } else { 0.0 };
        let strongest = brightness_to_a.max(brightness_to_b);
        // A dark direction waits for its own judgement and needs nothing of this one.
        let weakest = match (brightness_to_a > 0.0, brightness_to_b > 0.0) {
            (true, true) => brightness_to_a.min(brightness_to_b),
            _ => strongest,
        };
        let sight = if strongest > 0.0 {
            // Where both directions would be refined anyway, a mixture of seen and blocked rays says all.
            let stop_when_mixed = match self.kind {
                OracleKind::Energy => self.may_split && weakest * bound > self.thresholds.epsilon_partial,
                // By this oracle, V decides what is refined.
                OracleKind::Error => false,
            };
            self.look(candidate, strongest * estimate, strongest * bound, stop_when_mixed)
        } else {
            Sight::unseen(candidate)
        };
        let mut rays = sight.rays;
        let mut second_look = None;
        let mut decide = |asked: bool, receiver: ElementId, source: ElementId, spread: Spread| {
            if !asked {
                return Decision::NotAsked;
            }
            let form_factor = self.form_factor(receiver, source, estimate, sight.survey.as_ref());
            let link = Link::new(source, form_factor, sight.visibility, sight.evidence());
            let mut decision = match self.kind {
                OracleKind::Energy => self.decide(receiver, link, bound, sight.kind),
                OracleKind::Error => {
                    self.decide_by_error(receiver, link, Facing { estimate, bound, overlapping }, &sight)
                }
            };
            if let Decision::Accept(link) | Decision::AcceptAtGuard(link) = &mut decision
                && sight.kind == SightKind::Full
                && self.is_chosen_for_clear(link, bound)
            {
                let survey = second_look.get_or_insert_with(|| {
                    let survey = self.look_again((a, b), strongest * estimate);
                    rays += survey.cast;
                    survey
                });
                *link = link.with_visibility(if survey.cast > 0 { survey.visibility() } else { 1.0 });
            }
            if let Decision::Accept(link) | Decision::AcceptAtGuard(link) = &mut decision
                && let Some(plan) = sight.plan
                && self.model == ClusterModel::Oriented
                && self.sampler.emits_in_part(self.hierarchy, source)
            {
                let survey = self.sampler.survey(self.hierarchy, (a, b), spread, plan);
                rays += survey.cast;
                let (to, from) = (self.hierarchy.element(receiver), self.hierarchy.element(source));
                link.direct =
                    (from.area * survey.mean_visible_kernel()).min(1.0) / (to.exposed_share() * from.exposed_share());
            }
            decision
        };
        let to_a = decide(candidate.directions.to_a, a, b, Spread::EmissionOfB);
        let to_b = decide(candidate.directions.to_b, b, a, Spread::EmissionOfA);
        Verdict {
            to_a,
            to_b,
            visibility: sight.visibility,
            fully_visible: sight.kind == SightKind::Full,
            is_negligible: strongest * bound <= self.thresholds.epsilon_partial,
            rays,
        }
    }

    /// Whether nobody has judged a stored link whose source shines by now; where nothing may be split, all else stays as it is.
    pub fn is_unjudged(&self, link: &Link) -> bool {
        link.evidence() == Evidence::None && self.brightness[link.source().index()] > 0.0
    }

    /// Whether a stored link fails by the present radiosities and must be judged again.
    pub fn must_judge_again(&self, receiver: ElementId, link: &Link) -> bool {
        let source = link.source();
        let brightness = self.brightness[source.index()];
        if brightness <= 0.0 {
            return false;
        }
        if link.evidence() == Evidence::None {
            return true;
        }
        if self.kind == OracleKind::Error {
            return self.fails_by_error(receiver, link, MARGIN);
        }
        let hierarchy = self.hierarchy;
        let area = hierarchy.element(receiver).area;
        let (power, bound) = if receiver == source {
            (brightness * area, brightness * area)
        } else if hierarchy.element(receiver).is_patch() && hierarchy.element(source).is_patch() {
            // Patches have one estimate, and the link holds it.
            let sampled = hierarchy.element(receiver).exposed_share() * hierarchy.element(source).exposed_share();
            let power = brightness * link.form_factor * sampled * area;
            (power, power)
        } else {
            match exchange(hierarchy, receiver, source) {
                Exchange::FacingAway => return true,
                Exchange::Facing { estimate, bound, .. } => (brightness * estimate, brightness * bound),
            }
        };
        let rays = match link.evidence() {
            Evidence::Inherited => u32::MAX,
            Evidence::Clear(rays) | Evidence::Rays(rays) => u32::from(rays),
            Evidence::None => return true,
        };
        if bound > MARGIN * self.allowed_by(link.evidence()) {
            return receiver == source || end_to_split(hierarchy, receiver, source).is_some();
        }
        // More light than it was judged by may ask for more rays; a doubled count is worth a new look.
        bound > self.thresholds.epsilon_partial && self.thresholds.rays_for(power) >= rays.saturating_mul(2)
    }

    /// Whether a stored link that carries no more than it may must be judged again all the same.
    pub fn is_in_doubt(&self, receiver: ElementId, link: &Link, doubts: Doubts) -> bool {
        let (hierarchy, source) = (self.hierarchy, link.source());
        let brightness = self.brightness[source.index()];
        if brightness <= 0.0 || receiver == source && !doubts.cluster_model {
            return false;
        }
        let has_too_few = || match (link.evidence(), exchange(hierarchy, receiver, source)) {
            (Evidence::Clear(rays) | Evidence::Rays(rays), Exchange::Facing { estimate, .. }) => {
                self.thresholds.rays_for(brightness * estimate) > u32::from(rays)
            }
            // What it comes from had rays.
            _ => true,
        };
        let has_cluster = hierarchy.element(receiver).is_cluster() || hierarchy.element(source).is_cluster();
        doubts.cluster_model && has_cluster || doubts.more_rays && has_too_few()
    }

    /// Whether a pair that no ray came through could by now carry enough to be looked at again: it was dropped as negligible
    /// and is no more, or ε has become finer. To refine only those of its like that one of a few rays happened to come
    /// through, and forget the others, would lose light.
    pub fn is_doubtful(&self, occluded: &OccludedPair, doubts: Doubts) -> bool {
        if occluded.was_negligible && doubts.more_rays {
            return true;
        }
        if !(occluded.was_negligible || doubts.finer_epsilon) {
            return false;
        }
        let pair = &occluded.pair;
        let to = |asked: bool, source: ElementId| if asked { self.brightness[source.index()] } else { 0.0 };
        let brightness = to(pair.directions.to_a, pair.b).max(to(pair.directions.to_b, pair.a));
        match exchange(self.hierarchy, pair.a, pair.b) {
            Exchange::FacingAway => false,
            Exchange::Facing { bound, .. } => brightness * bound > MARGIN * self.thresholds.epsilon_partial,
        }
    }

    /// Power that a link may carry whose visibility is known so, W.
    pub fn allowed_by(&self, evidence: Evidence) -> f32 {
        match evidence {
            Evidence::Clear(_) | Evidence::Inherited => self.thresholds.epsilon,
            Evidence::Rays(_) | Evidence::None => self.thresholds.epsilon_partial,
        }
    }

    /// Power that a cluster may send while its self-link is kept, W.
    pub fn allowed_of_self(&self) -> f32 {
        match self.kind {
            OracleKind::Energy => self.thresholds.epsilon_partial,
            OracleKind::Error => self.thresholds.epsilon,
        }
    }

    /// A self-link is refined while the power that its cluster sends could matter; it has no rays, its estimate holds the
    /// cluster's own occlusion.
    fn judge_self(&self, candidate: &Candidate) -> Verdict {
        let element = self.hierarchy.element(candidate.a);
        let Shape::Cluster(cluster) = element.shape else {
            return Verdict::alike(candidate, Decision::Reject(Rejection::FacingAway));
        };
        let brightness = self.brightness[candidate.a.index()];
        let power = brightness * element.area;
        let mut rays = 0;
        let decision = if self.may_split && power > self.allowed_of_self() {
            Decision::Refine(candidate.a)
        } else if self.is_convex(&cluster) {
            Decision::Reject(Rejection::FacingAway)
        } else {
            let evidence = if brightness > 0.0 { Evidence::Inherited } else { Evidence::None };
            Decision::Accept(self.self_link(candidate.a, &cluster, evidence, &mut rays))
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

    /// A cluster's link to itself: F·V of what its polygons send each other by pairs of points on them, or, where they count as a
    /// volume or nothing is lit yet, by the closed form of a sphere of the same density.
    fn self_link(&self, id: ElementId, cluster: &Cluster, evidence: Evidence, rays: &mut u32) -> Link {
        let element = self.hierarchy.element(id);
        if element.area <= 0.0 {
            return Link::new(id, 0.0, 1.0, evidence);
        }
        if self.model == ClusterModel::Isotropic || evidence == Evidence::None {
            return Link::new(id, self_exchange(element, cluster) / element.area, 1.0, evidence);
        }
        let asked = SELF_RAYS.max(self.thresholds.rays_min);
        let plan = RayPlan { rays: asked, rays_if_blocked: asked, stop_when_mixed: false };
        let survey = self.sampler.survey(self.hierarchy, (id, id), Spread::Even, plan);
        *rays += survey.cast;
        let share = element.exposed_share();
        let form_factor = (element.area * survey.mean_kernel()).min(1.0) / (share * share);
        Link::new(id, form_factor, survey.visibility(), evidence)
    }

    /// Whether a small cluster's polygons, such as the sides of a box, all turn their backs on each other.
    pub fn is_convex(&self, cluster: &Cluster) -> bool {
        let patches = self.hierarchy.patches_below(cluster);
        let see_each_other = |a: &ElementId, b: &ElementId| exchange(self.hierarchy, *a, *b) != Exchange::FacingAway;
        patches.len() <= MOST_CONVEX
            && !patches.iter().enumerate().any(|(place, a)| patches[..place].iter().any(|b| see_each_other(a, b)))
    }

    /// Form factor F(r←s) without occlusion: by the estimate for patches and where nobody looked, else by how the polygons
    /// of the clusters are turned. Where random points lie on hidden parts as well, V is low by their shares and F high.
    fn form_factor(&self, receiver: ElementId, source: ElementId, estimate: f32, survey: Option<&Survey>) -> f32 {
        let (to, from) = (self.hierarchy.element(receiver), self.hierarchy.element(source));
        if to.area <= 0.0 {
            return 0.0;
        }
        let form_factor = match survey {
            Some(survey) if self.model == ClusterModel::Oriented && (to.is_cluster() || from.is_cluster()) => {
                from.area * survey.mean_kernel()
            }
            _ => estimate / to.area,
        };
        form_factor.min(1.0) / (to.exposed_share() * from.exposed_share())
    }

    /// Looks at other points of a pair than those that made it look clear.
    fn look_again(&self, pair: (ElementId, ElementId), power: f32) -> Survey {
        let asked = self.thresholds.rays_for(power);
        let plan = RayPlan { rays: asked, rays_if_blocked: asked, stop_when_mixed: false };
        self.sampler.survey(self.hierarchy, pair, Spread::EvenAgain, plan)
    }

    /// Whether a link is kept only because its ends looked clear of each other: it would be refined otherwise, or it was never
    /// looked at itself. Its V must then come from another look.
    fn is_chosen_for_clear(&self, link: &Link, bound: f32) -> bool {
        let brightness = self.brightness[link.source().index()];
        match link.evidence() {
            Evidence::None => false,
            Evidence::Inherited => true,
            Evidence::Clear(_) | Evidence::Rays(_) => brightness * bound > self.thresholds.epsilon_partial,
        }
    }

    fn decide(&self, receiver: ElementId, link: Link, bound: f32, sight: SightKind) -> Decision {
        let brightness = self.brightness[link.source().index()];
        if brightness <= 0.0 {
            return Decision::Accept(link.unjudged());
        }
        let allowed = match sight {
            SightKind::None => return Decision::Reject(Rejection::Occluded),
            SightKind::Full => self.thresholds.epsilon,
            SightKind::Partial | SightKind::Unknown => self.thresholds.epsilon_partial,
        };
        if brightness * bound <= allowed || !self.may_split {
            return Decision::Accept(link);
        }
        end_to_split(self.hierarchy, receiver, link.source()).map_or(Decision::AcceptAtGuard(link), Decision::Refine)
    }

    fn are_patches(&self, pair: &Candidate) -> bool {
        let is_flat = |id: ElementId| !self.hierarchy.element(id).is_cluster();
        is_flat(pair.a) && is_flat(pair.b)
    }

    /// Finds out how well the ends of a pair see each other, with as many rays as its power deserves.
    fn look(&self, candidate: &Candidate, power: f32, bound: f32, stop_when_mixed: bool) -> Sight {
        let survey = |spread: Spread, plan: RayPlan| {
            self.sampler.survey(self.hierarchy, (candidate.a, candidate.b), spread, plan)
        };
        if candidate.inherits_visible {
            let plan = RayPlan { rays: 0, rays_if_blocked: 0, stop_when_mixed };
            let found = (!self.are_patches(candidate)).then(|| survey(Spread::Even, plan));
            return Sight { visibility: 1.0, survey: found, plan: Some(plan), ..Sight::unseen(candidate) };
        }
        let is_refined = match self.kind {
            OracleKind::Energy => bound > self.thresholds.epsilon,
            OracleKind::Error => self.is_refined_unseen(bound),
        };
        if self.may_split && is_refined && bound > power {
            // Boxes that touch are refined in any case; what their members see is for their members to find out.
            return Sight::unseen(candidate);
        }
        let asked = self.thresholds.rays_for(power);
        let (to_reject, most) = self.thresholds.rays_to_reject(power);
        let plan = RayPlan { rays: asked, rays_if_blocked: to_reject.clamp(asked, most), stop_when_mixed };
        let found = survey(Spread::Even, plan);
        let mut rays = found.cast;
        let plan = RayPlan { rays_if_blocked: asked, stop_when_mixed: false, ..plan };
        // Patches that show each other no point face away; of a cluster, the faces that matter may have been missed.
        let face_away = found.cast == 0 && self.are_patches(candidate);
        let believed = face_away || found.cast >= to_reject || bound <= self.thresholds.epsilon_partial;
        let mut shows_lamp = |asked: bool, source: ElementId, spread: Spread| {
            asked && self.sampler.emits_in_part(self.hierarchy, source) && {
                let lamp = survey(spread, plan);
                rays += lamp.cast;
                lamp.visible > 0
            }
        };
        let mut is_occluded = || {
            let Directions { to_a, to_b } = candidate.directions;
            found.visible == 0
                && believed
                && !shows_lamp(to_a, candidate.b, Spread::EmissionOfB)
                && !shows_lamp(to_b, candidate.a, Spread::EmissionOfA)
        };
        let kind = if found.visible == found.cast && found.visible > 0 {
            SightKind::Full
        } else if is_occluded() {
            SightKind::None
        } else {
            SightKind::Partial
        };
        Sight { kind, visibility: found.visibility(), rays, asked, survey: Some(found), plan: Some(plan) }
    }
}
