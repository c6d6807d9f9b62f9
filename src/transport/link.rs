//! Links and the table that keeps them by receiver.

use glam::Vec3;
use rayon::prelude::*;

use crate::hierarchy::ElementId;

/// How a link's visibility V is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VisibilitySource {
    /// Not yet judged: the source was dark. V is that of the pair it came from.
    None,
    /// From as many rays as its power deserved, this number.
    Rays(u16),
    /// As many rays as its power deserved, this number, all came through. V is from others: of
    /// pairs seen in part some look clear by chance, and to believe that would make up light.
    Clear(u16),
    /// A pair that holds this one looked clear; V is from rays of its own.
    Inherited,
}

/// Light transport from a source to a receiver, which is implicit: links lie in the table at their
/// receiver.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Link {
    source: u32,
    /// Form factor F(r←s) without occlusion.
    pub form_factor: f32,
    /// F·V of what the source emits: a lamp in a dark housing sends its light where the lamp faces,
    /// not all around as the cluster of both does.
    pub direct: f32,
    visibility: u16,
    visibility_source: u16,
}

const UNJUDGED: u16 = 0;
const INHERITED: u16 = u16::MAX;
/// Set where a look was clear; the other bits count rays.
const CLEAR: u16 = 1 << 15;
const MOST_RAYS: u16 = CLEAR - 2;

impl Link {
    /// A link with visibility V in 0..=1.
    pub fn new(source: ElementId, form_factor: f32, visibility: f32, visibility_source: VisibilitySource) -> Self {
        let visibility_source = match visibility_source {
            VisibilitySource::None => UNJUDGED,
            VisibilitySource::Rays(rays) => rays.clamp(1, MOST_RAYS),
            VisibilitySource::Clear(rays) => CLEAR | rays.min(MOST_RAYS),
            VisibilitySource::Inherited => INHERITED,
        };
        let link =
            Self { source: source.0, form_factor, direct: 0.0, visibility: quantised(visibility), visibility_source };
        Self { direct: link.transfer(), ..link }
    }

    /// The link with another visibility V in 0..=1.
    pub fn with_visibility(self, visibility: f32) -> Self {
        Self::new(self.source(), self.form_factor, visibility, self.visibility_source())
    }

    /// The link with another source.
    pub fn with_source(self, source: ElementId) -> Self {
        Self { source: source.0, ..self }
    }

    /// The link as if nobody had looked at the pair.
    pub fn unjudged(self) -> Self {
        Self { visibility_source: UNJUDGED, ..self }
    }

    /// The element that sends.
    #[inline]
    pub fn source(&self) -> ElementId {
        ElementId(self.source)
    }

    /// Mean visibility V, 0..=1.
    #[inline]
    pub fn visibility(&self) -> f32 {
        f32::from(self.visibility) / f32::from(u16::MAX)
    }

    /// How V is known.
    pub fn visibility_source(&self) -> VisibilitySource {
        match self.visibility_source {
            UNJUDGED => VisibilitySource::None,
            INHERITED => VisibilitySource::Inherited,
            rays if rays & CLEAR != 0 => VisibilitySource::Clear(rays & !CLEAR),
            rays => VisibilitySource::Rays(rays),
        }
    }

    /// Irradiance that the link brings of the source's radiosity B and the part of it B_e that the
    /// source emits, W/m².
    #[inline]
    pub fn irradiance(&self, radiosity: Vec3, emitted: Vec3) -> Vec3 {
        self.transfer() * (radiosity - emitted) + self.direct * emitted
    }

    /// F·V of what the source reflects.
    #[inline]
    pub fn transfer(&self) -> f32 {
        self.form_factor * self.visibility()
    }
}

/// V as 16 bits.
pub fn quantised(visibility: f32) -> u16 {
    (visibility.clamp(0.0, 1.0) * f32::from(u16::MAX)).round() as u16
}

/// All links, those of one receiver side by side.
#[derive(Clone, Debug, Default)]
pub struct LinkTable {
    /// Where each receiver's links start; one longer than the number of receivers that the table
    /// knows.
    starts: Vec<u32>,
    links: Vec<Link>,
}

impl LinkTable {
    /// Number of links.
    pub fn len(&self) -> usize {
        self.links.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.links.is_empty()
    }

    /// Memory of the links alone, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.links[..])
    }

    /// Receivers that the table knows; later elements have no links yet.
    pub fn receivers(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Every link, in the order of receivers.
    pub fn all(&self) -> &[Link] {
        &self.links
    }

    /// Places in [`Self::all`] of a receiver's links.
    #[inline]
    pub fn range(&self, receiver: ElementId) -> std::ops::Range<usize> {
        match self.starts.get(receiver.index()..receiver.index() + 2) {
            Some(&[start, end]) => start as usize..end as usize,
            _ => 0..0,
        }
    }

    /// A receiver's links.
    #[inline]
    pub fn of(&self, receiver: ElementId) -> &[Link] {
        &self.links[self.range(receiver)]
    }

    /// Takes up further links (with their receivers) for `receivers` elements in all; old links
    /// come first, then new ones in their order.
    pub fn append(&mut self, receivers: usize, further: &[(ElementId, Link)]) {
        let mut starts = vec![0_u32; receivers + 1];
        for receiver in 0..receivers {
            starts[receiver + 1] = self.of(ElementId(receiver as u32)).len() as u32;
        }
        for (receiver, _) in further {
            starts[receiver.index() + 1] += 1;
        }
        for receiver in 0..receivers {
            starts[receiver + 1] += starts[receiver];
        }
        let total = starts[receivers] as usize;
        let mut links = vec![Link::new(ElementId(0), 0.0, 0.0, VisibilitySource::None); total];
        let mut next: Vec<u32> = starts[..receivers].to_vec();
        for (receiver, place) in next.iter_mut().enumerate().take(self.receivers()) {
            let old = self.of(ElementId(receiver as u32));
            links[*place as usize..*place as usize + old.len()].copy_from_slice(old);
            *place += old.len() as u32;
        }
        for (receiver, link) in further {
            let place = &mut next[receiver.index()];
            links[*place as usize] = *link;
            *place += 1;
        }
        (self.starts, self.links) = (starts, links);
    }

    /// Takes out the links for which `take` answers yes and returns them with their receivers, in
    /// order; judged in parallel.
    pub fn drain(&mut self, take: impl Fn(ElementId, &Link) -> bool + Sync) -> Vec<(ElementId, Link)> {
        let receivers = self.receivers();
        let drained: Vec<Vec<(ElementId, Link)>> = (0..receivers)
            .into_par_iter()
            .with_min_len(256)
            .map(|receiver| {
                let receiver = ElementId(receiver as u32);
                self.of(receiver).iter().filter(|link| take(receiver, link)).map(|link| (receiver, *link)).collect()
            })
            .collect();
        let mut kept = 0;
        let mut start = 0;
        for (receiver, out) in drained.iter().enumerate() {
            let end = self.starts[receiver + 1] as usize;
            let mut out = out.iter().map(|(_, link)| link.source).peekable();
            for place in start..end {
                let link = self.links[place];
                if out.peek() == Some(&link.source) {
                    out.next();
                } else {
                    self.links[kept] = link;
                    kept += 1;
                }
            }
            start = end;
            self.starts[receiver + 1] = kept as u32;
        }
        self.links.truncate(kept);
        drained.into_iter().flatten().collect()
    }
}
