//! Groups: small leaves share what looks from some of them found.
//!
//! A scene of a million leaves needs no look from each: what a chair's bolts reflect is known well
//! enough by a few looks from all of them. A leaf that counts too little for a look of its own
//! therefore belongs to the group of the smallest cluster around it from where enough looks are
//! planned; larger clusters hold the looks of those within. The mean over a group's looks is that
//! of its area. The links tell how it differs from face to face, by where each is turned, as far as
//! the looks themselves agree with them (a regression).

use std::ops::{AddAssign, Mul};

use super::field::Field;
use crate::hierarchy::{ElementId, Shape};

/// Looks that tell the mean of a group.
const LEAST_LOOKS: f64 = 8.0;
/// Stands for "in no group" and "no member".
const NONE: u32 = u32::MAX;

/// A leaf of a group.
#[derive(Clone, Copy, Debug)]
struct Member {
    leaf: ElementId,
    group: u32,
    /// Area that each of its looks stands for, m².
    weight: f32,
    /// Light of the member by the links, as a multiple of the group's mean.
    lit: f32,
}

/// The leaves that share looks, with the groups in which they do.
#[derive(Debug, Default)]
pub struct Groups {
    /// The cluster of each group, and the group around it; that one comes first.
    clusters: Vec<(ElementId, u32)>,
    members: Vec<Member>,
    /// Looks that are planned from each of them, parallel to the arena; 0 for other leaves.
    planned: Vec<f32>,
    /// Place of each of them among the members, or [`NONE`], likewise.
    places: Vec<u32>,
    /// Change of a leaf's light by the looks for each change by the links, 0..=1.
    slope: f32,
}

/// Sums over looks from a leaf or a group, and how many they were.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mean<T> {
    /// Σ of what each look found.
    pub sum: T,
    /// Weight of the looks.
    pub looks: f32,
}

/// Light of leaves by the means of their groups.
pub struct Shared<'a, T> {
    groups: &'a Groups,
    means: Vec<Mean<T>>,
}

impl<T: Copy + Mul<f32, Output = T>> Shared<'_, T> {
    /// The mean of a member's group, and the multiple of it that is that leaf's; none where nobody
    /// looked from the group.
    pub fn of(&self, leaf: ElementId) -> Option<(T, f32)> {
        let place = self.groups.places.get(leaf.index())?;
        let member = self.groups.members.get(*place as usize)?;
        let Mean { sum, looks } = self.means[member.group as usize];
        (looks > 0.0).then(|| (sum * looks.recip(), 1.0 + self.groups.slope * (member.lit - 1.0)))
    }
}

impl Groups {
    /// Groups the leaves of which fewer than one look is `planned`; `lit` is each leaf's light by
    /// the links, in any unit.
    pub fn new(field: &Field, lit: &[f32], planned: impl Fn(ElementId) -> f64) -> Self {
        let hierarchy = field.hierarchy();
        let small: Vec<(ElementId, f64)> = field
            .leaves()
            .filter(|leaf| Self::may_hold(field, *leaf))
            .map(|leaf| (leaf, planned(leaf)))
            .filter(|(_, looks)| *looks > 0.0 && *looks < 1.0)
            .collect();
        if small.is_empty() {
            return Self::default();
        }
        let mut groups = Self { planned: vec![0.0; hierarchy.elements().len()], ..Self::default() };
        small.iter().for_each(|(leaf, planned)| groups.planned[leaf.index()] = *planned as f32);
        let mut looks = vec![0.0; hierarchy.elements().len()];
        small.iter().for_each(|(leaf, planned)| looks[leaf.index()] = *planned);
        let clusters = hierarchy.ids().filter(|id| hierarchy.element(*id).is_cluster());
        for id in clusters.clone().rev() {
            looks[id.index()] = hierarchy.element(id).children().map(|child| looks[child.index()]).sum();
        }
        let mut group_of = vec![NONE; hierarchy.elements().len()];
        for id in clusters {
            let around = hierarchy.element(id).parent().map_or(NONE, |parent| group_of[parent.index()]);
            group_of[id.index()] = if around == NONE || looks[id.index()] >= LEAST_LOOKS {
                groups.clusters.push((id, around));
                groups.clusters.len() as u32 - 1
            } else {
                around
            };
        }
        let member = |&(leaf, planned): &(ElementId, f64)| {
            let around = hierarchy.element(leaf).parent().map_or(NONE, |parent| group_of[parent.index()]);
            let weight = f64::from(field.area(leaf)) / planned;
            Member { leaf, group: around, weight: weight as f32, lit: lit[leaf.index()] }
        };
        groups.members = small.iter().map(member).collect();
        groups.places = vec![NONE; hierarchy.elements().len()];
        small.iter().zip(0..).for_each(|((leaf, _), place)| groups.places[leaf.index()] = place);
        groups.set_means(field);
        groups
    }

    /// Whether a leaf may share its looks: neither a lamp, nor a part of a polygon that was split
    /// to tell its parts apart.
    pub fn may_hold(field: &Field, leaf: ElementId) -> bool {
        let hierarchy = field.hierarchy();
        let is_whole = hierarchy.element(leaf).parent().is_some_and(|parent| hierarchy.element(parent).is_cluster());
        is_whole && !field.emits(leaf)
    }

    /// Looks that were planned from a leaf that shares them: less than one.
    pub fn planned(&self, leaf: ElementId) -> Option<f64> {
        self.planned.get(leaf.index()).map(|looks| f64::from(*looks)).filter(|looks| *looks > 0.0)
    }

    /// The leaves that share looks.
    pub fn leaves(&self) -> impl Iterator<Item = ElementId> {
        self.members.iter().map(|member| member.leaf)
    }

    /// Makes the links' light of each member a multiple of its group's mean.
    fn set_means(&mut self, field: &Field) {
        let mut means = vec![Mean::default(); self.clusters.len()];
        for member in &self.members {
            let area = field.area(member.leaf);
            let mean: &mut Mean<f32> = &mut means[member.group as usize];
            mean.sum += area * member.lit;
            mean.looks += area;
        }
        self.pull(&mut means);
        for member in &mut self.members {
            let Mean { sum, looks: area } = means[member.group as usize];
            let mean = if area > 0.0 { sum / area } else { 0.0 };
            member.lit = if mean > 0.0 { member.lit / mean } else { 1.0 };
        }
    }

    /// Gives each group what those within it found.
    fn pull<T: Copy + AddAssign>(&self, means: &mut [Mean<T>]) {
        for (group, &(_, around)) in self.clusters.iter().enumerate().rev() {
            let Mean { sum, looks } = means[group];
            if let Some(above) = means.get_mut(around as usize) {
                above.sum += sum;
                above.looks += looks;
            }
        }
    }

    /// Mean of each group, where looks from leaves found these sums.
    fn means<T>(&self, found: impl Fn(ElementId) -> Mean<T>) -> Vec<Mean<T>>
    where
        T: Copy + Default + AddAssign + Mul<f32, Output = T>,
    {
        let mut means = vec![Mean::<T>::default(); self.clusters.len()];
        for member in &self.members {
            let of_leaf = found(member.leaf);
            if of_leaf.looks > 0.0 {
                let mean = &mut means[member.group as usize];
                mean.sum += of_leaf.sum * member.weight;
                mean.looks += of_leaf.looks * member.weight;
            }
        }
        self.pull(&mut means);
        means
    }

    /// Light of each member by its group's mean, where looks from leaves found these sums.
    pub fn shared<T>(&self, found: impl Fn(ElementId) -> Mean<T>) -> Shared<'_, T>
    where
        T: Copy + Default + AddAssign + Mul<f32, Output = T>,
    {
        Shared { groups: self, means: self.means(found) }
    }

    /// Learns how far light differs as the links say, from all looks so far, which found these
    /// sums.
    pub fn learn(&mut self, found: impl Fn(ElementId) -> Mean<f32>) {
        let means = self.means(&found);
        let (mut together, mut by_links) = (0.0, 0.0);
        for member in &self.members {
            let (of_leaf, Mean { sum, looks }) = (found(member.leaf), means[member.group as usize]);
            if of_leaf.looks > 0.0 && sum > 0.0 {
                let mean = f64::from(sum / looks);
                let (weight, change) = (f64::from(member.weight) * mean, f64::from(member.lit) - 1.0);
                together += weight * change * (f64::from(of_leaf.sum) - f64::from(of_leaf.looks) * mean);
                by_links += weight * change * change * f64::from(of_leaf.looks) * mean;
            }
        }
        self.slope = if by_links > 0.0 { (together / by_links).clamp(0.0, 1.0) as f32 } else { 0.0 };
    }

    /// The leaves that share looks, each with the square of its cluster's diagonal, m².
    pub fn sizes(&self, field: &Field) -> impl Iterator<Item = (ElementId, f32)> {
        self.members.iter().map(|member| (member.leaf, size_of(field, self.clusters[member.group as usize].0)))
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.clusters[..])
            + size_of_val(&self.members[..])
            + size_of_val(&self.planned[..])
            + size_of_val(&self.places[..])
    }
}

/// Square of the diagonal of a cluster's box, m².
fn size_of(field: &Field, cluster: ElementId) -> f32 {
    match field.hierarchy().element(cluster).shape {
        Shape::Cluster(cluster) => 4.0 * cluster.half_extent.length_squared(),
        Shape::Patch(_) | Shape::Sky(_) => 0.0,
    }
}
