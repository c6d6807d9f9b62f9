//! A thread that reads solutions for a window: what lies under the pointer, probes, a work plane.
//!
//! Like the solver's thread it never waits for its owner, nor its owner for it: questions go in, of
//! which the newest of a kind counts, and a small report comes out. It has half of the machine's
//! threads.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::Vec3;
use rayon::prelude::*;

use super::grid::WorkPlane;
use super::lit_mesh::{LitMesh, READING_ERROR, SurfaceReading};
use super::plane::{Measuring, PlaneReading};
use crate::base::actor::{Actor, Desk};
use crate::scene::Scene;
use crate::solve::Snapshot;

/// While meshes change, making them ready for rays takes this share of the time at most, as one
/// part in so many.
const BUILD_SHARE: u32 = 8;
/// For the pointer alone, meshes of more triangles than this are not made ready: that would take
/// seconds and much memory.
const MOST_POINTED: usize = 1 << 20;
/// Probes are read again to half the standard error, until it is below this share of the light
/// there.
const SETTLED_ERROR: f32 = 0.0025;
/// Pause between two readings of the probes: what is asked meanwhile comes first.
const SETTLE_AFTER: Duration = Duration::from_millis(20);
/// The share of a plane that is measured is reported this often.
const TELL_EVERY: Duration = Duration::from_millis(50);

/// A ray from the eye through the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The eye.
    pub origin: Vec3,
    /// Where to; of any length.
    pub direction: Vec3,
}

/// Readings along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Looked {
    /// The ray.
    pub ray: Ray,
    /// The surface that the ray met first.
    pub reading: Option<SurfaceReading>,
}

/// A place on a surface, and what is read there.
#[derive(Clone, Copy, Debug)]
pub struct Probed {
    /// The place.
    pub point: Vec3,
    /// Unit normal of the surface.
    pub normal: Vec3,
    /// The present reading; `None` where there is no surface any more.
    pub reading: Option<SurfaceReading>,
}

/// Results of the thread.
#[derive(Clone, Default)]
pub struct Report {
    /// Reading under the pointer.
    pub looked: Option<Looked>,
    /// The light in which pointer and probes were read.
    pub light: Option<Arc<Snapshot>>,
    /// The probes, in the order given.
    pub probes: Arc<Vec<Probed>>,
    /// The share of the work plane that is measured, while it is.
    pub progress: Option<f32>,
    /// The work plane as last measured.
    pub plane: Option<Arc<PlaneReading>>,
    /// Why a plane cannot be measured, one sentence.
    pub failure: Option<String>,
}

enum Ask {
    Light(Arc<Scene>, Arc<Snapshot>),
    Look(Option<Ray>),
    Probe(Vec<(Vec3, Vec3)>),
    Measure(WorkPlane),
    ForgetPlane,
}

/// The thread; dropping it lets the thread end by itself.
pub struct Surveyor(Actor<Ask, Report>);

impl Surveyor {
    /// Starts the thread. `wake` is called on it whenever there is something new; it must not
    /// block.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub fn spawn(wake: Box<dyn Fn() + Send>) -> std::io::Result<Self> {
        let run = |desk| {
            let (light, lit, look, plane, build) = (None, None, None, None, None);
            Session { desk, light, lit, look, probes: Vec::new(), plane, build, probes_error: None }.run();
        };
        Actor::spawn("surveyor", wake, run).map(Self)
    }

    /// The newest light of a scene, whose faces are turned and doubled as it is solved.
    pub fn show(&self, scene: Arc<Scene>, snapshot: Arc<Snapshot>) {
        self.0.ask(Ask::Light(scene, snapshot));
    }

    /// Asks what a ray meets, now and in each new light until another is asked for.
    pub fn look(&self, ray: Option<Ray>) {
        self.0.ask(Ask::Look(ray));
    }

    /// Sets the probes, as points and normals of surfaces; they are read in each new light.
    pub fn probe(&self, places: Vec<(Vec3, Vec3)>) {
        self.0.ask(Ask::Probe(places));
    }

    /// Measures a work plane in the newest light; one that is being measured is given up.
    pub fn measure(&self, plane: WorkPlane) {
        self.0.ask_instead(Ask::Measure(plane));
    }

    /// Gives the work plane up and forgets it.
    pub fn forget_plane(&self) {
        self.0.ask_instead(Ask::ForgetPlane);
    }

    /// Results of the thread.
    pub fn report(&self) -> Report {
        self.0.report()
    }
}

struct Session {
    desk: Desk<Ask, Report>,
    light: Option<(Arc<Scene>, Arc<Snapshot>)>,
    lit: Option<LitMesh>,
    look: Option<Ray>,
    probes: Vec<(Vec3, Vec3)>,
    /// A plane that is to be measured.
    plane: Option<WorkPlane>,
    /// When a mesh was last made ready, and how long that took.
    build: Option<(Instant, Duration)>,
    /// Standard error, as a share of the light there, to which the probes are read next; `None`
    /// once they are settled.
    probes_error: Option<f32>,
}

impl Session {
    fn run(mut self) {
        let mut patience = None;
        loop {
            let Some(asks) = self.desk.take(patience) else { return };
            for ask in asks {
                match ask {
                    Ask::Light(scene, snapshot) => {
                        self.light = Some((scene, snapshot));
                        self.probes_error = Some(READING_ERROR);
                    }
                    Ask::Look(ray) => self.look = ray,
                    Ask::Probe(places) => {
                        self.probes = places;
                        self.probes_error = Some(READING_ERROR);
                    }
                    Ask::Measure(plane) => self.plane = Some(plane),
                    Ask::ForgetPlane => {
                        self.plane = None;
                        self.desk.tell(|report| (report.plane, report.progress, report.failure) = (None, None, None));
                    }
                }
            }
            patience = self.work();
        }
    }

    /// Answers what can be answered; how long to wait before the rest is tried again, if there is a
    /// rest.
    fn work(&mut self) -> Option<Duration> {
        let (scene, snapshot) = self.light.clone()?;
        let can_look = self.look.is_some() && snapshot.mesh.triangles.len() <= MOST_POINTED;
        let is_asked = can_look || !self.probes.is_empty() || self.plane.is_some();
        if !is_asked {
            // A light that nobody looks at is not held.
            (self.lit, self.probes_error) = (None, None);
            self.desk.tell(|report| (report.looked, report.light) = (None, None));
            return None;
        }
        let wait = self.follow(&scene, &snapshot);
        let Some(lit) = self.lit.clone() else { return wait };
        self.answer(&lit);
        if wait.is_some() {
            return wait;
        }
        if let Some(plane) = self.plane.take() {
            self.measure(&lit, plane);
        }
        let is_settled = self.probes.is_empty() || lit.snapshot().field.is_none();
        let finer = |error: f32| 0.5 * error;
        self.probes_error = self.probes_error.map(finer).filter(|error| !is_settled && *error >= SETTLED_ERROR);
        self.probes_error.map(|_| SETTLE_AFTER)
    }

    /// Takes over the newest light; makes its mesh ready unless that was done a moment ago. How
    /// long to wait until then.
    fn follow(&mut self, scene: &Arc<Scene>, snapshot: &Arc<Snapshot>) -> Option<Duration> {
        if let Some(relit) = self.lit.as_ref().and_then(|lit| lit.relit(scene, snapshot)) {
            self.lit = Some(relit);
            return None;
        }
        if let Some((at, took)) = self.build
            && self.plane.is_none()
            && self.lit.is_some()
            && at.elapsed() < BUILD_SHARE * took
        {
            return Some(BUILD_SHARE * took - at.elapsed());
        }
        let begun = Instant::now();
        let build = || LitMesh::new(scene.clone(), snapshot.clone());
        self.lit = Some(self.desk.work(build));
        self.build = Some((Instant::now(), begun.elapsed()));
        None
    }

    /// The pointer and the probes.
    fn answer(&mut self, lit: &LitMesh) {
        let looked = self.look.map(|ray| Looked { ray, reading: lit.under(ray.origin, ray.direction) });
        let probed = |&(point, normal): &(Vec3, Vec3), error: f32| Probed {
            point,
            normal,
            reading: lit.at(point, normal, error),
        };
        let read = |error: f32| self.desk.work(|| self.probes.par_iter().map(|place| probed(place, error)).collect());
        let probes = self.probes_error.map(|error| Arc::new(read(error)));
        self.desk.tell(|report| {
            report.looked = looked;
            report.light = Some(lit.snapshot().clone());
            report.probes = probes.unwrap_or_else(|| report.probes.clone());
        });
    }

    /// Measures a plane; goes on answering for the pointer meanwhile.
    fn measure(&mut self, lit: &LitMesh, plane: WorkPlane) {
        let mut measuring = match Measuring::new(lit, plane, READING_ERROR) {
            Ok(measuring) => measuring,
            Err(error) => {
                self.desk.tell(|report| (report.failure, report.progress) = (Some(error.to_string()), None));
                return;
            }
        };
        self.desk.tell(|report| (report.failure, report.progress) = (None, Some(0.0)));
        let mut reported = Instant::now();
        loop {
            if !self.desk.work(|| measuring.advance()) {
                let measured = Arc::new(measuring.finish());
                self.desk.tell(|report| (report.plane, report.progress) = (Some(measured), None));
                return;
            }
            if self.look_again() {
                self.answer(lit);
            }
            if self.desk.cancel.is_cancelled() {
                let (waiting, has_owner) = self.desk.waiting();
                if !has_owner || waiting.iter().any(|ask| matches!(ask, Ask::Measure(_) | Ask::ForgetPlane)) {
                    self.desk.tell(|report| report.progress = None);
                    return;
                }
                // The token was meant for what was done before.
                self.desk.cancel.reset();
            }
            if reported.elapsed() > TELL_EVERY {
                let share = measuring.share();
                self.desk.tell(|report| report.progress = Some(share));
                reported = Instant::now();
            }
        }
    }

    /// Takes up where the pointer went; everything else that was asked has to wait.
    fn look_again(&mut self) -> bool {
        let mut has_moved = false;
        let look = &mut self.look;
        self.desk.waiting().0.retain(|ask| match ask {
            Ask::Look(ray) => {
                (*look, has_moved) = (*ray, true);
                false
            }
            _ => true,
        });
        has_moved
    }
}
