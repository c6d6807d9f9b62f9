//! Colours of blocks: by the power that a link carries, by what is seen along it, by how far it was
//! refined, by its rays.

use crate::hierarchy::{ElementId, Hierarchy};
use crate::read::ramp::{VIRIDIS, along_ramp};
use crate::transport::{LinkView, SolutionView, VisibilitySource};

/// Quantity that the colour of a block stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Colouring {
    /// Power for each area of receiver and of source, so that blocks of any size compare;
    /// logarithmic.
    #[default]
    Power,
    /// Visibility V: fully visible, partly visible or hidden.
    Visibility,
    /// How often receiver and source were refined on the way from the root's self-link.
    Level,
    /// Rays that V is known by.
    Rays,
}

impl Colouring {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 4] = [Self::Power, Self::Visibility, Self::Level, Self::Rays];

    /// Name of the quantity for a person.
    pub fn name(self) -> &'static str {
        match self {
            Self::Power => "power",
            Self::Visibility => "visibility",
            Self::Level => "level",
            Self::Rays => "rays",
        }
    }
}

/// Name of links all of whose rays came through, for all legends.
pub const FULLY_VISIBLE: &str = "fully visible";
/// Name of links some of whose rays came through.
pub const PARTLY_VISIBLE: &str = "partly visible";
/// Name of links no ray of which came through.
pub const HIDDEN: &str = "hidden";
/// Name of links that no ray tested.
pub const NOT_TESTED: &str = "not tested";

/// Where there is no link: darker than all that is one.
pub const EMPTY: [u8; 3] = [13, 14, 16];
/// V = 1.
pub const SEEN_FULLY: [u8; 3] = [104, 182, 226];
/// V just below 1, and just above 0: light orange to brown.
pub const SEEN_PARTLY: [[u8; 3]; 2] = [[250, 196, 92], [122, 62, 20]];
/// V = 0, kept all the same.
pub const UNSEEN: [u8; 3] = [74, 40, 66];
/// Nobody looked yet, or a source was dark.
pub const UNJUDGED: [u8; 3] = [72, 76, 86];
/// A pair that holds this one was seen fully: no ray of its own was needed to accept it.
const INHERITED: [u8; 3] = [104, 182, 226];

/// Power density at either end of the ramp, as a multiple of what all power that is emitted or
/// comes in, spread evenly over all pairs would be.
const POWER_RANGE: [f32; 2] = [1e-2, 1e2];
/// Rays at the end of the ramp.
const MOST_RAYS: f32 = 1000.0;

/// Addition of a block to a pixel, for each unit of its share: a colour as squares of gamma-encoded
/// values, which stand for light, or a density in the first place.
pub(super) type Tone = [f32; 3];

/// How links become colours in one state of a solution.
pub struct Palette {
    colouring: Colouring,
    /// Density that counts as even, W/m⁴.
    even: f32,
    /// Refinements on the longest way from the root's self-link to a link.
    deepest: u16,
}

/// Legend of the colours, from one end of a ramp to the other or one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// Quantity shown, with its unit.
    pub title: String,
    /// The ramp's values at even places from 0 to 1; empty where there is no ramp.
    pub ticks: Vec<String>,
    /// Colours of their own.
    pub entries: Vec<LegendEntry>,
}

/// One colour and its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LegendEntry {
    /// Gamma-encoded colour.
    pub colour: [u8; 3],
    /// Meaning of the colour.
    pub name: &'static str,
}

impl Palette {
    /// The colours for one state of a solution.
    pub fn new(solution_view: &SolutionView, colouring: Colouring) -> Self {
        let hierarchy = solution_view.hierarchy();
        let area = hierarchy.element(Hierarchy::ROOT).area;
        // What comes in from outside is emitted too, beside the root.
        let from_outside = |link: &LinkView| hierarchy.element(link.source).is_sky();
        let entering: f32 = match hierarchy.outside().len() {
            0 => 0.0,
            _ => solution_view.all_links().filter(from_outside).map(|link| link.power.element_sum()).sum(),
        };
        let even = (solution_view.emitted(Hierarchy::ROOT).element_sum() + entering / area) / area;
        // Of receivers and sources alone: what no link ends at was passed by.
        let of_link = |link: LinkView| solution_view.depth(link.receiver) + solution_view.depth(link.source);
        let deepest = match colouring {
            Colouring::Level => solution_view.all_links().map(of_link).max().unwrap_or(0),
            _ => 0,
        };
        Self { colouring, even, deepest: deepest.max(1) }
    }

    /// Contribution of a link to the pixels that its block covers.
    pub(super) fn tone(&self, solution_view: &SolutionView, link: &LinkView) -> Tone {
        match self.colouring {
            Colouring::Power => [self.density(solution_view, link), 0.0, 0.0],
            _ => self.colour(solution_view, link).map(light),
        }
    }

    /// The gamma-encoded colour of what was added to a pixel, for each unit of the share that was
    /// covered.
    pub(super) fn resolve(&self, tone: Tone) -> [u8; 3] {
        match self.colouring {
            Colouring::Power => self.of_density(tone[0]),
            _ => tone.map(|light| (255.0 * light.sqrt()).round().min(255.0) as u8),
        }
    }

    /// The gamma-encoded colour of a link.
    pub fn colour(&self, solution_view: &SolutionView, link: &LinkView) -> [u8; 3] {
        match self.colouring {
            Colouring::Power => self.of_density(self.density(solution_view, link)),
            Colouring::Visibility => match link.visibility {
                _ if link.visibility_source == VisibilitySource::None => UNJUDGED,
                seen if seen >= 1.0 => SEEN_FULLY,
                seen if seen <= 0.0 => UNSEEN,
                seen => along_ramp(&[SEEN_PARTLY[1], SEEN_PARTLY[0]], seen),
            },
            Colouring::Level => {
                let depth = |id: ElementId| f32::from(solution_view.depth(id));
                along_ramp(&VIRIDIS, (depth(link.receiver) + depth(link.source)) / f32::from(self.deepest))
            }
            Colouring::Rays => match link.visibility_source {
                VisibilitySource::None => UNJUDGED,
                VisibilitySource::Inherited => INHERITED,
                VisibilitySource::Rays(rays) | VisibilitySource::Clear(rays) => {
                    along_ramp(&ROSE, f32::from(rays.max(1)).log10() / MOST_RAYS.log10())
                }
            },
        }
    }

    /// Power for each area of both ends, as a multiple of the even density.
    fn density(&self, solution_view: &SolutionView, link: &LinkView) -> f32 {
        let area = |id: ElementId| solution_view.hierarchy().element(id).area;
        let areas = area(link.receiver) * area(link.source);
        let even = self.even * areas;
        if even > 0.0 { link.power.element_sum() / even } else { 0.0 }
    }

    fn of_density(&self, density: f32) -> [u8; 3] {
        let [low, high] = POWER_RANGE.map(f32::log10);
        along_ramp(&VIRIDIS, if density > 0.0 { (density.log10() - low) / (high - low) } else { 0.0 })
    }

    /// The colour at a place of the ramp, 0..=1.
    pub fn along(&self, place: f32) -> [u8; 3] {
        match self.colouring {
            Colouring::Rays => along_ramp(&ROSE, place),
            _ => along_ramp(&VIRIDIS, place),
        }
    }

    /// Legend of the colours.
    pub fn legend(&self) -> Legend {
        let entry = |colour, name| LegendEntry { colour, name };
        let no_link = entry(EMPTY, "no link");
        let texts = |ticks: &[&str]| ticks.iter().map(|tick| (*tick).to_owned()).collect();
        match self.colouring {
            Colouring::Power => Legend {
                title: "power per area of both ends, 1 = Φ spread evenly".into(),
                ticks: texts(&["1/100", "1/10", "1", "10", "100"]),
                entries: vec![no_link],
            },
            Colouring::Visibility => Legend {
                title: "visibility V".into(),
                ticks: Vec::new(),
                entries: vec![
                    entry(SEEN_FULLY, FULLY_VISIBLE),
                    entry(SEEN_PARTLY[0], "mostly visible"),
                    entry(SEEN_PARTLY[1], PARTLY_VISIBLE),
                    entry(UNSEEN, HIDDEN),
                    entry(UNJUDGED, NOT_TESTED),
                    no_link,
                ],
            },
            Colouring::Level => Legend {
                title: "refinements on the way from the root's self-link".into(),
                ticks: (0..=2).map(|tick| (u32::from(self.deepest) * tick / 2).to_string()).collect(),
                entries: vec![no_link],
            },
            Colouring::Rays => Legend {
                title: "rays that the visibility is known by".into(),
                ticks: texts(&["1", "10", "100", "1000"]),
                entries: vec![entry(INHERITED, "inherited"), entry(UNJUDGED, NOT_TESTED), no_link],
            },
        }
    }
}

/// From dusk to a pale rose, apart from viridis and the blue of what is known to be clear.
const ROSE: [[u8; 3]; 4] = [[58, 26, 56], [138, 44, 84], [214, 92, 92], [252, 206, 170]];

/// A gamma-encoded value as light; squares are near enough for mixing.
pub(super) fn light(value: u8) -> f32 {
    let value = f32::from(value) / 255.0;
    value * value
}
