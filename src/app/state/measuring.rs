//! The window's side of the surveyor: what lies under the pointer, probes, the work plane.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::Vec3;

use crate::app::Wake;
use crate::app::format;
use crate::app::widgets::dialog::PathField;
use crate::base::photometry::{Quantity, ShownIn, Unit, lux, weighted};
use crate::read::survey::{
    NamedReading, PlaneReading, Probed, Ray, Report, SurfaceReading, Surveyor, WorkPlane, write_plane, write_probes,
};
use crate::render::{ColourScale, Isolines, Ramp, Reading, Spacing, upper_end};
use crate::scene::{Scene, TaskArea};
use crate::solve::Snapshot;

/// Maintained illuminance of a task area for writing and reading (EN 12464-1), lx.
const USUAL_TARGET: f32 = 500.0;
/// Uniformity of such an area.
const USUAL_UNIFORMITY: f32 = 0.6;
/// Share of the points that the scale of a work plane spans at most, from the darkest.
const SCALED_SHARE: f64 = 0.98;
/// Readings are of the light in view when the surveyor has had less time than this to read it: no
/// mark flickers meanwhile.
const GRACE: Duration = Duration::from_millis(400);

/// A place on a surface that a person reads.
pub struct Probe {
    /// Name of the probe; a person may change it.
    pub name: String,
    pub point: Vec3,
    pub normal: Vec3,
}

/// Table that is written to a file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Table {
    Probes,
    Plane,
}

/// State of the measure tool and of the reading under the pointer.
pub struct Measuring {
    surveyor: Option<Surveyor>,
    report: Report,
    /// The pointer's ray that was asked about.
    pointer: Option<Ray>,
    /// The light that the surveyor was shown.
    shown: Option<Arc<Snapshot>>,
    /// The newest light.
    latest: Option<Arc<Snapshot>>,
    /// Since when there is newer light than what was read.
    behind_since: Option<Instant>,
    /// Whether a click places a probe.
    pub places_probes: bool,
    probes: Vec<Probe>,
    /// Point and normal of what is selected, which is read like a probe.
    selection: Option<(Vec3, Vec3)>,
    /// Probes placed so far, for their names.
    placed: usize,
    /// The plane that is set up; measured when asked.
    pub plane: WorkPlane,
    /// The light and the plane that were asked for.
    asked: Option<(Arc<Snapshot>, WorkPlane)>,
    /// Whether a drag in the view draws a task area.
    pub draws_area: bool,
    /// Where the pointer was pressed to draw it.
    pub pressed: Option<egui::Pos2>,
    /// Corners of the area that is being drawn.
    pub drawn: Option<[Vec3; 2]>,
    /// Average illuminance that the plane is to have, lx.
    pub target: f32,
    /// Uniformity that it is to have.
    pub least_uniformity: f32,
    /// Whether the points are drawn over the view.
    pub shows_points: bool,
    /// Whether their values are written there.
    pub writes_values: bool,
    /// Where tables are written.
    pub save: PathField,
    /// Table for which the file dialog was opened.
    pub saves: Table,
}

impl Default for Measuring {
    fn default() -> Self {
        Self {
            surveyor: None,
            report: Report::default(),
            pointer: None,
            shown: None,
            latest: None,
            behind_since: None,
            places_probes: false,
            probes: Vec::new(),
            selection: None,
            placed: 0,
            plane: WorkPlane::default(),
            asked: None,
            draws_area: false,
            pressed: None,
            drawn: None,
            target: USUAL_TARGET,
            least_uniformity: USUAL_UNIFORMITY,
            shows_points: true,
            writes_values: true,
            save: PathField::default(),
            saves: Table::Plane,
        }
    }
}

impl Measuring {
    /// Another scene is in view: nothing of the former holds.
    pub fn start_with(&mut self, scene: &Scene) {
        self.forget_plane();
        self.probes.clear();
        self.send_probes();
        (self.placed, self.places_probes) = (0, false);
        self.plane = WorkPlane::for_scene(scene);
        (self.draws_area, self.drawn) = (false, None);
        (self.target, self.least_uniformity) = (USUAL_TARGET, USUAL_UNIFORMITY);
        if scene.task_area.is_some() {
            self.set_task_area(scene.task_area, scene.up_axis());
        }
    }

    /// Sets the task area with what it asks for; without one the whole plane counts.
    pub fn set_task_area(&mut self, area: Option<TaskArea>, up: Vec3) {
        let Some(TaskArea { corners, height, average_lux, uniformity }) = area else {
            self.plane.area = None;
            return;
        };
        self.plane.height = height;
        self.plane.set_area(corners, up);
        (self.target, self.least_uniformity) = (average_lux, uniformity);
    }

    /// The task area with what it asks for, if one was drawn.
    pub fn task_area(&self) -> Option<TaskArea> {
        let (average_lux, uniformity) = (self.target, self.least_uniformity);
        self.plane.area.map(|corners| TaskArea { corners, height: self.plane.height, average_lux, uniformity })
    }

    /// Follows a drag in the view that draws a task area: where the pointer took hold, where it is,
    /// and whether it let go.
    pub fn draw_area(&mut self, scene: &Scene, [from, to]: [Ray; 2], has_ended: bool) {
        let Some((level, up)) = self.plane.level(scene) else { return };
        let on_plane = |ray: Ray| {
            let distance = (level - ray.origin.dot(up)) / ray.direction.dot(up);
            (distance > 0.0 && distance.is_finite()).then(|| ray.origin + distance * ray.direction)
        };
        if let (Some(from), Some(to)) = (on_plane(from), on_plane(to)) {
            let (lower, upper) = scene.bounds();
            self.drawn = Some([from, to].map(|corner| corner.clamp(lower, upper)));
        }
        if has_ended && let Some(corners) = self.drawn.take() {
            self.plane.set_area(corners, up);
            self.draws_area = false;
        }
    }

    /// Corners of the task area's rectangle as drawn or as set up, in turn.
    pub fn area_outline(&self, scene: &Scene) -> Option<[Vec3; 4]> {
        let [a, b] = self.drawn.or(self.plane.area)?;
        let (level, up) = self.plane.level(scene)?;
        let mut axes = (0..3).filter(|&axis| up[axis] == 0.0);
        let across = axes.next()?;
        let corner = |first: Vec3, second: Vec3| {
            let mut corner = second;
            corner[across] = first[across];
            corner + (level - corner.dot(up)) * up
        };
        Some([corner(a, a), corner(b, a), corner(b, b), corner(a, b)])
    }

    /// Shows the surveyor the light in view where it is asked for, and takes up what it found;
    /// `latest` is the solver's newest light, which the view may wait with.
    pub fn note(&mut self, scene: &Arc<Scene>, snapshot: &Arc<Snapshot>, latest: &Arc<Snapshot>, is_settled: bool) {
        self.latest = Some(latest.clone());
        let Some(surveyor) = &self.surveyor else { return };
        let is_probed = !self.probes.is_empty() || self.selection.is_some();
        let is_wanted = self.pointer.is_some() || is_probed || self.asked.is_some();
        if is_wanted && self.shown.as_ref().is_none_or(|shown| !Arc::ptr_eq(shown, snapshot)) {
            surveyor.show(scene.clone(), snapshot.clone());
            self.shown = Some(snapshot.clone());
        }
        self.report = surveyor.report();
        self.behind_since = match self.report.light.as_ref().is_some_and(|read| !Arc::ptr_eq(read, latest)) {
            true => self.behind_since.or_else(|| Some(Instant::now())),
            false => None,
        };
        // While the solver works, each plane would be of a picture that is gone when it is there.
        if let Some((asked, plane)) = &self.asked
            && is_settled
            && (!Arc::ptr_eq(asked, snapshot) || *plane != self.plane)
        {
            surveyor.measure(self.plane);
            self.asked = Some((snapshot.clone(), self.plane));
        }
    }

    /// Whether readings of surfaces are of light that the solver has left behind.
    pub fn is_stale(&self) -> bool {
        self.behind_since.is_some_and(|since| since.elapsed() > GRACE)
    }

    /// Whether the plane is of such light, or of another height or grid than is set up.
    pub fn plane_is_stale(&self) -> bool {
        let latest = self.plane_reading().zip(self.latest.as_ref());
        latest.is_some_and(|(plane, latest)| !Arc::ptr_eq(&plane.snapshot, latest) || plane.plane != self.plane)
    }

    /// Follows the pointer; `None` while it is not over the view.
    pub fn point_at(&mut self, ray: Option<Ray>, wake: &Wake) {
        if ray != self.pointer {
            if self.pointer.is_none() {
                // The next frame shows the surveyor the light in view.
                wake();
            }
            self.pointer = ray;
            self.with_surveyor(wake, |surveyor| surveyor.look(ray));
        }
    }

    /// Reading of the surface under the pointer, as far as it is known.
    pub fn under_pointer(&self) -> Option<&SurfaceReading> {
        self.pointer?;
        self.report.looked.as_ref()?.reading.as_ref()
    }

    /// Whether a click or drag in the view measures instead of selecting and turning.
    pub fn is_placing(&self) -> bool {
        self.places_probes || self.draws_area
    }

    /// Clicks select again, and drags turn the view.
    pub fn stop_placing(&mut self) {
        (self.places_probes, self.draws_area) = (false, false);
        (self.drawn, self.pressed) = (None, None);
    }

    /// Places a probe.
    pub fn place(&mut self, point: Vec3, normal: Vec3, wake: &Wake) {
        self.placed += 1;
        self.probes.push(Probe { name: format!("P{}", self.placed), point, normal });
        self.with_surveyor(wake, |_| {});
        self.send_probes();
        wake();
    }

    /// Takes a probe away.
    pub fn remove(&mut self, index: usize) {
        self.probes.remove(index);
        self.send_probes();
    }

    /// Takes all probes away.
    pub fn remove_all(&mut self) {
        self.probes.clear();
        self.send_probes();
    }

    /// Reads a place on a surface that is selected, or none.
    pub fn select(&mut self, place: Option<(Vec3, Vec3)>, wake: &Wake) {
        if place == self.selection {
            return;
        }
        self.selection = place;
        if place.is_some() {
            self.with_surveyor(wake, |_| {});
        }
        self.send_probes();
        wake();
    }

    /// Reading of the selection, once it is there.
    pub fn at_selection(&self) -> Option<SurfaceReading> {
        let (point, _) = self.selection?;
        self.report.probes.iter().find(|found| found.point == point)?.reading
    }

    fn send_probes(&self) {
        if let Some(surveyor) = &self.surveyor {
            let probes = self.probes.iter().map(|probe| (probe.point, probe.normal));
            surveyor.probe(probes.chain(self.selection).collect());
        }
    }

    /// Probes with what is known of them.
    pub fn probes(&self) -> impl Iterator<Item = (&Probe, Option<&Probed>)> {
        let found = |probe: &Probe| self.report.probes.iter().find(|found| found.point == probe.point);
        self.probes.iter().map(move |probe| (probe, found(probe)))
    }

    /// The name of a probe, to be changed.
    pub fn name_mut(&mut self, index: usize) -> &mut String {
        &mut self.probes[index].name
    }

    /// Measures the plane that is set up, in the light in view.
    pub fn measure_plane(&mut self, scene: &Arc<Scene>, snapshot: &Arc<Snapshot>, wake: &Wake) {
        let plane = self.plane;
        self.with_surveyor(wake, |surveyor| {
            surveyor.show(scene.clone(), snapshot.clone());
            surveyor.measure(plane);
        });
        self.shown = Some(snapshot.clone());
        self.asked = Some((snapshot.clone(), plane));
        if self.surveyor.is_none() {
            self.report.failure = Some("no thread is left to measure with: close other programs and try again".into());
        }
    }

    /// Gives the plane up.
    pub fn forget_plane(&mut self) {
        self.asked = None;
        self.report.plane = None;
        if let Some(surveyor) = &self.surveyor {
            surveyor.forget_plane();
        }
    }

    /// The share of the plane that is measured, while it is.
    pub fn progress(&self) -> Option<f32> {
        self.report.progress
    }

    /// Why there is no plane, if it was asked for.
    pub fn failure(&self) -> Option<&str> {
        self.report.failure.as_deref().filter(|_| self.asked.is_some())
    }

    /// The plane as last measured.
    pub fn plane_reading(&self) -> Option<&Arc<PlaneReading>> {
        self.report.plane.as_ref().filter(|_| self.asked.is_some())
    }

    /// How its values are coloured: as the irradiance in view where there is a legend of it,
    /// otherwise, in lx, from nothing to nearly the brightest point.
    pub fn plane_scale(&self, reading: Option<&Reading>) -> Option<Reading> {
        let plane = self.plane_reading()?;
        if let Some(reading) = reading.filter(|reading| reading.quantity == Quantity::Irradiance) {
            return Some(*reading);
        }
        let high = end_of(plane.values.iter().flatten().map(|value| weighted(value.to_array())));
        let scale = ColourScale {
            low: 0.0,
            high,
            spacing: Spacing::Linear,
            ramp: reading.map_or(Ramp::Viridis, |reading| reading.scale.ramp),
        };
        Some(Reading {
            quantity: Quantity::Irradiance,
            shown_in: ShownIn::Unit(Unit::Lumens),
            scale: scale.rounded(),
            fills: true,
            isolines: Isolines::default(),
        })
    }

    /// The rows of a table as CSV.
    pub fn csv(&self, table: Table, scene: &Scene) -> std::io::Result<Vec<u8>> {
        let mut text = Vec::new();
        match table {
            Table::Plane => {
                if let Some(plane) = self.plane_reading() {
                    write_plane(&mut text, plane)?;
                }
            }
            Table::Probes => {
                let named = self.probes().map(|(probe, found)| NamedReading {
                    name: &probe.name,
                    point: scene.to_file(probe.point),
                    normal: probe.normal,
                    reading: found.and_then(|found| found.reading),
                });
                write_probes(&mut text, named)?;
            }
        }
        Ok(text)
    }

    /// Starts the surveyor where it is not yet there; without a further thread nothing is read, and
    /// the next question tries again.
    fn with_surveyor(&mut self, wake: &Wake, ask: impl FnOnce(&Surveyor)) {
        if self.surveyor.is_none() {
            let wake = wake.clone();
            self.surveyor = Surveyor::spawn(Box::new(move || wake())).ok();
        }
        if let Some(surveyor) = &self.surveyor {
            ask(surveyor);
        }
    }
}

/// Illuminance with its standard error where it was gathered: *312 ± 4 lx*.
pub fn lux_in_words(reading: &SurfaceReading) -> String {
    let value = f64::from(lux(reading.irradiance.to_array()));
    match reading.standard_error {
        Some(error) => format!("{} lx", format::plus_minus(value, lux(error.to_array()).into())),
        None => format!("{} lx", format::number(value)),
    }
}

/// The upper end of a scale of values that count alike.
fn end_of(values: impl Iterator<Item = f32>) -> f32 {
    upper_end(&mut values.map(|value| (value, 1.0)).collect::<Vec<_>>(), SCALED_SHARE).unwrap_or(0.0).max(1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: values by hand. One point that is a hundred times as bright as the others changes the
    /// end by less than they differ, of few points as of many; without one, nothing is cut off from
    /// few.
    #[test]
    fn one_outlier_does_not_rule_the_scale() {
        for count in [5, 12, 50, 400] {
            let even: Vec<f32> = (0..count).map(|index| 100.0 + 40.0 * index as f32 / count as f32).collect();
            let plain = end_of(even.iter().copied());
            assert!((131.0..140.0).contains(&plain), "{count} points: {plain}");
            let mut with_lamp = even;
            with_lamp[count / 2] = 12_000.0;
            let guarded = end_of(with_lamp.into_iter());
            assert!((123.0..140.0).contains(&guarded), "{count} points: {guarded}");
        }
        assert_eq!(end_of([50.0].into_iter()), 50.0);
        assert_eq!(end_of([].into_iter()), 1e-6);
    }
}
