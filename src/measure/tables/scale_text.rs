//! Beyond what can be measured: what the fitted laws say of 10⁷ to 10⁹ polygons, and where today's
//! design stops.

use super::fit::PowerLaw;
use super::growth::Growth;
use super::lab::Run;
use crate::base::format::{bytes, count, number, percent, quantity};
use crate::hierarchy::Element;
use crate::measure::records::Table;
use crate::scene::Polygon;
use crate::transport::Link;

/// Polygons of the forecast.
const SIZES: [(f64, &str); 3] = [(1e7, "10⁷"), (1e8, "10⁸"), (1e9, "10⁹")];
/// More polygons than anybody has.
const MOST: f64 = 1e12;
/// Numbers that a u32 can tell apart.
const U32: f64 = 4_294_967_296.0;

/// A law, and what grows from the largest room measured with no less than its number of polygons:
/// small rooms have costs that do not grow, so a law through them all tells too little.
struct Forecast {
    law: PowerLaw,
    largest: (f64, f64),
}

impl Forecast {
    fn new(growth: &Growth, law: Option<PowerLaw>, of: impl Fn(&Run) -> f64) -> Option<Self> {
        let run = growth.largest()?;
        Some(Self { law: law?, largest: (run.polygons as f64, of(run)) })
    }

    /// At least in proportion.
    fn at(&self, polygons: f64) -> f64 {
        let (largest, value) = self.largest;
        value * (polygons / largest).powf(self.law.exponent.max(1.0))
    }
}

fn time_of(growth: &Growth) -> Option<Forecast> {
    Forecast::new(growth, growth.time, Run::time)
}

fn elements_of(growth: &Growth) -> Option<Forecast> {
    Forecast::new(growth, growth.elements, |run| run.stats.bytes.elements as f64)
}

/// Table of the memory and time that each mode would take.
pub fn forecast(growths: &[Growth]) -> Option<Table> {
    let row = |growth: &Growth| {
        let (time, links, elements) = (time_of(growth)?, growth.links?, elements_of(growth)?);
        Some(SIZES.map(|(size, name)| {
            let link_bytes = links.at(size) * size_of::<Link>() as f64;
            let memory = |elements: f64| bytes((link_bytes + elements) as usize);
            vec![
                format!("{}, {name}", growth.name),
                duration(time.law.at(size)),
                duration(time.at(size)),
                number(links.at(size)),
                bytes(link_bytes as usize),
                memory(elements.law.at(size)),
                memory(elements.at(size)),
            ]
        }))
    };
    let rows: Vec<Vec<String>> = growths.iter().filter_map(row).flatten().collect();
    (!rows.is_empty()).then(|| Table {
        caption: "What larger rooms would take on this machine's threads: by the fitted laws, and with time and elements growing from the largest room measured at least in proportion to the polygons, \
                  which is the likelier one, for laws through small rooms bend. Links by their law. Scene, BVH and pairs that wait are not in the memory"
            .into(),
        head: ["", "time by law", "time", "links", "bytes of links", "memory by law", "memory"].map(String::from).into(),
        rows,
    })
}

/// A time from seconds to years.
fn duration(seconds: f64) -> String {
    match seconds {
        seconds if seconds < 3600.0 => crate::base::format::seconds(seconds),
        seconds if seconds < 100.0 * 3600.0 => quantity(seconds / 3600.0, "h"),
        seconds if seconds < 1000.0 * 86400.0 => quantity(seconds / 86400.0, "days"),
        seconds => quantity(seconds / (365.25 * 86400.0), "years"),
    }
}

/// Where the design stops, and what would have to change: numbers from the laws and from the sizes
/// of the types.
pub fn limits(growths: &[Growth], epsilon: f64) -> Vec<String> {
    let Some(adaptive) = growths.iter().find(|growth| growth.name == "adaptive") else { return Vec::new() };
    let (Some(run), Some(time), Some(links), Some(elements)) =
        (adaptive.largest(), time_of(adaptive), adaptive.links, elements_of(adaptive))
    else {
        return Vec::new();
    };
    let polygons = run.polygons as f64;
    let elements_each = run.stats.elements as f64 / polygons;
    let bytes_each = run.stats.bytes.elements as f64 / polygons;
    let seconds = run.stats.seconds;
    let share = |part: f64| percent(part / seconds.total);
    let most_elements = U32 / elements_each;
    let most_links = links_reach(links.factor, links.exponent);
    let scene_each = size_of::<Polygon>() as f64 + 4.0 * 12.0;
    vec![
        "## Where today's design stops".into(),
        format!(
            "In the largest room that adaptive clusters solved ({} polygons) building the hierarchy took {}, refining {} and gathering {} of {} (of one run). An element has {} bytes, a link {}; \
             with radiosities, sums and vertices a polygon costs {} at the end of the solve, in {} elements.",
            count(run.polygons),
            share(seconds.hierarchy),
            share(seconds.refine),
            share(seconds.gather),
            quantity(seconds.total, "s"),
            size_of::<Element>(),
            size_of::<Link>(),
            quantity(bytes_each, "bytes"),
            number(elements_each)
        ),
        format!(
            "- **Element ids are u32.** At {} elements a polygon they end at {} polygons. Nothing checks this: beyond, ids would wrap.\n\
             - **Places of links are u32** (`LinkTable` keeps where each receiver's links start), so at {} links{}.\n\
             - **Vertex indices are u32**: with four vertices of its own a polygon, they end at {} polygons.\n\
             - **Everything is in memory at once**: scene (about {} a polygon with its own corners), BVH, elements, the whole table of links; while a wave is applied its candidates too. \
             At 10⁹ polygons elements and radiosities alone are {}, the scene about {}.\n\
             - **Every gather sweeps every element** and copies all radiosities, whether or not anything has changed there: this, not the links, is what grows with the polygons. \
             10⁹ polygons would take {}, but by their law only {} links.",
            number(elements_each),
            number(most_elements),
            number(U32),
            most_links,
            number(U32 / 4.0),
            quantity(scene_each, "bytes"),
            bytes(elements.at(1e9) as usize),
            bytes((scene_each * 1e9) as usize),
            duration(time.at(1e9)),
            number(links.at(1e9))
        ),
        "## What would have to change".into(),
        format!(
            "- **10⁷ polygons** need {} for elements and links and {} here: today's design does that on a machine with memory for it.\n\
             - **10⁸ polygons** need {}: elements must shrink. Clusters of few small polygons that no link ever opens need no elements for what they hold: an element could be made \
             when a link first asks for its children, from a hierarchy on disk. The links at ε = {epsilon:e} Φ are {}, so nearly all of the tree stays closed.\n\
             - **10⁹ polygons** need {}: besides, 64-bit ids (or 32-bit ids within a part), the scene and its BVH in parts that are loaded when rays or links reach them, gathering in parts that only touch \
             receivers with links, and display of what the camera sees. {} of the element ids would be in use at {} elements a polygon.",
            bytes(elements.at(1e7) as usize + (links.at(1e7) * size_of::<Link>() as f64) as usize),
            duration(time.at(1e7)),
            bytes(elements.at(1e8) as usize),
            number(links.at(1e8)),
            bytes(elements.at(1e9) as usize),
            percent(1e9 * elements_each / U32),
            number(elements_each)
        ),
    ]
}

/// Polygons at which a law of links reaches what a u32 can count, as part of a sentence.
fn links_reach(factor: f64, exponent: f64) -> String {
    let reached = (U32 / factor).powf(1.0 / exponent);
    if exponent <= 0.0 || reached > MOST {
        return ", which adaptive clusters do not come near by their law".into();
    }
    format!(", which adaptive clusters reach at {} polygons by their law", number(reached))
}
