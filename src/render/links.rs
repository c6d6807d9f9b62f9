//! Links over the view: which of them are drawn, and how. Never more than can be read: the
//! strongest, the rest in words.

use std::cmp::Ordering;
use std::fmt;

use rustc_hash::FxHashSet;
use serde::{Deserialize, Serialize};

use super::outline::element_outline;
use super::overlay::{Line, power_colour};
use crate::base::format;
use crate::hierarchy::ElementId;
use crate::read::ramp::{VIRIDIS, along_ramp};
use crate::transport::{LinkView, SolutionView, VisibilitySource};

/// As many links as can still be distinguished.
pub const USUAL_LINKS: usize = 200;

/// Which links are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LinkFilter {
    /// Least power of the strongest channel, as a share of ε.
    pub least_power: f32,
    /// Between two patches.
    pub patch_patch: bool,
    /// Between a cluster and a patch, either way.
    pub cluster_patch: bool,
    /// Between two clusters, self-links among them.
    pub cluster_cluster: bool,
    /// Whose ends see each other in full.
    pub full: bool,
    /// In part.
    pub partial: bool,
    /// Not at all, or nobody looked.
    pub unseen: bool,
    /// So many at most, the strongest.
    pub strongest: usize,
}

impl Default for LinkFilter {
    fn default() -> Self {
        Self {
            least_power: 0.0,
            patch_patch: true,
            cluster_patch: true,
            cluster_cluster: true,
            full: true,
            partial: true,
            unseen: true,
            strongest: USUAL_LINKS,
        }
    }
}

impl LinkFilter {
    /// Whether a link passes, whatever its rank.
    pub fn passes(&self, link: &LinkView, epsilon_watts: f64) -> bool {
        let kind = match (link.receiver_is_cluster, link.source_is_cluster) {
            (false, false) => self.patch_patch,
            (true, true) => self.cluster_cluster,
            (true, false) | (false, true) => self.cluster_patch,
        };
        let sight = match Seen::of(link) {
            Seen::Full => self.full,
            Seen::Partial => self.partial,
            Seen::Not => self.unseen,
        };
        kind && sight && f64::from(link.power.max_element()) >= f64::from(self.least_power) * epsilon_watts
    }
}

/// How the ends of a link see each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seen {
    /// All rays came through.
    Full,
    /// Some did.
    Partial,
    /// None did, or nobody looked.
    Not,
}

impl Seen {
    /// That of a link.
    pub fn of(link: &LinkView) -> Self {
        match link.visibility_source {
            VisibilitySource::None => Self::Not,
            _ if link.visibility >= 1.0 => Self::Full,
            _ if link.visibility > 0.0 => Self::Partial,
            _ => Self::Not,
        }
    }

    /// Colour of the kind of link, which the colour-blind tell from the others (M. Okabe and K.
    /// Ito's set); gamma-encoded.
    pub fn colour(self) -> [u8; 3] {
        match self {
            Self::Full => [86, 180, 233],
            Self::Partial => [230, 159, 0],
            Self::Not => [204, 121, 167],
        }
    }
}

/// Meaning of the colour of a link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LinkColour {
    /// Power over that of the strongest link, over three decades.
    #[default]
    Power,
    /// How its ends see each other.
    Visibility,
    /// The level of its source below the root.
    Level,
}

/// How links are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct LinkStyle {
    /// Meaning of the colours.
    pub colour: LinkColour,
    /// Whether both ends have outlines: rims of patches, boxes of clusters.
    pub ends: bool,
}

impl Default for LinkStyle {
    fn default() -> Self {
        Self { colour: LinkColour::Power, ends: true }
    }
}

/// The links that are drawn, and how many are not.
#[derive(Clone, Debug, Default)]
pub struct ChosenLinks {
    /// The strongest of those that pass, strongest first.
    pub links: Vec<LinkView>,
    /// Links to choose from.
    pub all: usize,
    /// Links that pass the filter.
    pub passing: usize,
    /// Power of the links that are drawn, sum of the channels, W.
    pub power: f64,
    /// Power of the links to choose from, sum of the channels, W.
    pub power_of_all: f64,
}

/// Widths and diameters, pixels.
const LINK_WIDTH: f32 = 2.0;
const OUTLINE_WIDTH: f32 = 1.2;
const PATCH_DOT: f32 = 6.0;
const CLUSTER_DOT: f32 = 9.0;
/// A self-link has no length: its dot stands for it.
const SELF_DOT: f32 = 14.0;
/// Opacity of outlines, which must not hide lines.
const OUTLINE_OPACITY: u8 = 150;

impl ChosenLinks {
    /// Chooses among links; of any number of them only the strongest are kept.
    pub fn new(links: impl IntoIterator<Item = LinkView>, filter: &LinkFilter, epsilon_watts: f64) -> Self {
        let mut chosen = Self::default();
        let room = (2 * filter.strongest).max(1024);
        for link in links {
            chosen.all += 1;
            chosen.power_of_all += f64::from(link.power.element_sum());
            if filter.passes(&link, epsilon_watts) {
                chosen.passing += 1;
                chosen.links.push(link);
                if chosen.links.len() >= room {
                    chosen.keep_strongest(filter.strongest);
                }
            }
        }
        chosen.keep_strongest(filter.strongest);
        chosen.links.sort_by(by_power);
        chosen.power = chosen.links.iter().map(|link| f64::from(link.power.element_sum())).sum();
        chosen
    }

    fn keep_strongest(&mut self, count: usize) {
        if count < self.links.len() {
            self.links.select_nth_unstable_by(count, by_power);
            self.links.truncate(count);
        }
    }

    /// Lines for them, weakest first so that strong ones end on top: outlines of the ends where
    /// they are wanted, then the links with dots at their ends.
    pub fn lines(&self, solution_view: &SolutionView, style: LinkStyle) -> Vec<Line> {
        let hierarchy = solution_view.hierarchy();
        let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
        let colours: Vec<[u8; 4]> =
            self.links.iter().map(|link| opaque(self.colour(solution_view, link, style.colour))).collect();
        let mut lines = Vec::new();
        let mut outlined: FxHashSet<ElementId> = FxHashSet::default();
        for (link, [r, g, b, _]) in self.links.iter().zip(&colours) {
            // A box is all that shows where a self-link is.
            let ends = if style.ends || link.source == link.receiver { &[link.source, link.receiver][..] } else { &[] };
            for &end in ends {
                if outlined.insert(end) {
                    let edges = element_outline(hierarchy, end).into_iter();
                    let colour = [*r, *g, *b, OUTLINE_OPACITY];
                    lines.extend(edges.map(|[from, to]| Line::new(from, to, OUTLINE_WIDTH, colour)));
                }
            }
        }
        lines.reverse();
        for (link, &colour) in self.links.iter().zip(&colours).rev() {
            let dot = |is_cluster: bool| if is_cluster { CLUSTER_DOT } else { PATCH_DOT };
            if link.source == link.receiver {
                lines.push(Line::dot(link.source_centre, SELF_DOT, colour));
            } else {
                lines.push(Line::new(link.receiver_centre, link.source_centre, LINK_WIDTH, colour));
                lines.push(Line::dot(link.source_centre, dot(link.source_is_cluster), colour));
            }
        }
        lines
    }

    fn colour(&self, solution_view: &SolutionView, link: &LinkView, by: LinkColour) -> [u8; 3] {
        match by {
            LinkColour::Power => {
                let most = self.links.first().map_or(0.0, |strongest| strongest.power.element_sum());
                power_colour(if most > 0.0 { link.power.element_sum() / most } else { 0.0 })
            }
            LinkColour::Visibility => Seen::of(link).colour(),
            LinkColour::Level => level_colour(solution_view.depth(link.source), solution_view.deepest()),
        }
    }
}

/// Strongest first; equals in the order of their ends.
fn by_power(a: &LinkView, b: &LinkView) -> Ordering {
    b.power
        .element_sum()
        .total_cmp(&a.power.element_sum())
        .then_with(|| (a.receiver, a.source).cmp(&(b.receiver, b.source)))
}

/// Colour of a level below the root.
pub fn level_colour(level: u16, deepest: u16) -> [u8; 3] {
    along_ramp(&VIRIDIS, f32::from(level) / f32::from(deepest.max(1)))
}

/// How many are drawn, how much of the power they carry, and why the others are not there.
impl fmt::Display for ChosenLinks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let drawn = self.links.len();
        if self.all == 0 {
            return write!(f, "No link is kept here yet");
        }
        if drawn == 1 && self.all == 1 {
            return write!(f, "1 link drawn");
        }
        if drawn == self.all {
            return write!(f, "All {} drawn", format::things(self.all, "link", "links"));
        }
        write!(f, "{} of {} drawn", format::count(drawn), format::things(self.all, "link", "links"))?;
        if self.power_of_all > 0.0 {
            write!(f, ", {} of the power", percent(self.power / self.power_of_all))?;
        }
        match self.all - self.passing {
            0 => Ok(()),
            filtered => write!(f, "; {} filtered out", format::count(filtered)),
        }
    }
}

/// Whole per cent, and never all where something is missing.
fn percent(share: f64) -> String {
    match 100.0 * share {
        percent if percent > 99.0 && percent < 100.0 => "over 99 %".into(),
        percent if percent > 0.0 && percent < 1.0 => "under 1 %".into(),
        percent => format!("{percent:.0} %"),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn link(
        source: u32,
        power: f32,
        clusters: [bool; 2],
        visibility: f32,
        visibility_source: VisibilitySource,
    ) -> LinkView {
        LinkView {
            receiver: ElementId(1),
            source: ElementId(source),
            receiver_centre: Vec3::ZERO,
            source_centre: Vec3::X,
            receiver_is_cluster: clusters[0],
            source_is_cluster: clusters[1],
            form_factor: 0.1,
            visibility,
            visibility_source,
            // Blue alone: the strongest channel is the sum.
            power: Vec3::Z * power,
            levels_up: 0,
            irradiance: Vec3::splat(power),
        }
    }

    fn links() -> [LinkView; 4] {
        [
            link(2, 1.0, [false, false], 1.0, VisibilitySource::Rays(4)),
            link(3, 8.0, [true, false], 0.5, VisibilitySource::Rays(9)),
            link(4, 2.0, [true, true], 1.0, VisibilitySource::None),
            link(5, 4.0, [false, true], 0.0, VisibilitySource::Rays(4)),
        ]
    }

    fn sources(filter: LinkFilter) -> Vec<u32> {
        ChosenLinks::new(links(), &filter, 2.0).links.iter().map(|link| link.source.0).collect()
    }

    /// Truth: each filter by hand.
    #[test]
    fn filters_take_what_they_name_and_the_strongest_come_first() {
        let all = LinkFilter::default();
        assert_eq!(sources(all), [3, 5, 4, 2]);
        assert_eq!(sources(LinkFilter { strongest: 2, ..all }), [3, 5]);
        assert_eq!(sources(LinkFilter { strongest: 0, ..all }), [0_u32; 0]);
        assert_eq!(sources(LinkFilter { least_power: 1.5, ..all }), [3, 5], "of ε = 2 W");
        assert_eq!(sources(LinkFilter { patch_patch: false, ..all }), [3, 5, 4]);
        assert_eq!(sources(LinkFilter { cluster_patch: false, ..all }), [4, 2]);
        assert_eq!(sources(LinkFilter { cluster_cluster: false, ..all }), [3, 5, 2]);
        assert_eq!(sources(LinkFilter { full: false, ..all }), [3, 5, 4]);
        assert_eq!(sources(LinkFilter { partial: false, ..all }), [5, 4, 2]);
        assert_eq!(sources(LinkFilter { unseen: false, ..all }), [3, 2]);
    }

    /// Truth: sorting all of them.
    #[test]
    fn many_links_leave_the_strongest() {
        let many = (0..5000_u32)
            .map(|number| link(number, ((number * 7919) % 5003) as f32, [false; 2], 1.0, VisibilitySource::None));
        let chosen = ChosenLinks::new(many.clone(), &LinkFilter { strongest: 3, ..LinkFilter::default() }, 1.0);
        let mut powers: Vec<f32> = many.map(|link| link.power.element_sum()).collect();
        powers.sort_by(|a, b| b.total_cmp(a));
        assert_eq!(chosen.links.iter().map(|link| link.power.element_sum()).collect::<Vec<_>>(), powers[..3]);
        assert_eq!((chosen.all, chosen.passing), (5000, 5000));
    }

    #[test]
    fn the_rest_is_summed_up_in_words() {
        let words = |filter| ChosenLinks::new(links(), &filter, 2.0).to_string();
        let all = LinkFilter::default();
        assert_eq!(words(all), "All 4 links drawn");
        assert_eq!(words(LinkFilter { strongest: 2, ..all }), "2 of 4 links drawn, 80 % of the power");
        assert_eq!(
            words(LinkFilter { partial: false, ..all }),
            "3 of 4 links drawn, 47 % of the power; 1 filtered out"
        );
        assert_eq!(ChosenLinks::new([], &all, 2.0).to_string(), "No link is kept here yet");
        assert_eq!([0.999, 0.004, 0.5].map(percent), ["over 99 %", "under 1 %", "50 %"]);
    }
}
