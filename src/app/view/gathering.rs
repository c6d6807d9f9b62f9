//! The gathered picture of the view: a thread that refines it while the camera stands still.
//!
//! It has threads of its own, is stopped at once when anything moves or changes, and never waits
//! for the window, nor the window for it: what it has painted lies in a slot.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::Builder;

use rayon::ThreadPool;

use crate::app::Wake;
use crate::base::cancel::CancelToken;
use crate::base::threads::{background_pool, lock, pool, within};
use crate::gather::Field;
use crate::read::picture::{GatheredPicture, Start};
use crate::render::{Camera, Display, Pixels, Reading, developed};
use crate::solve::{Snapshot, USUAL_ERROR};

/// Everything that decides a picture: another sitting is another picture.
#[derive(Clone)]
struct Sitting {
    field: Arc<Field>,
    camera: Camera,
    size: [u32; 2],
    /// Noise that suffices, as a share of the local light.
    error: f32,
    has_lines: bool,
}

impl Painted {
    /// Noise that suffices, as a share of the local light.
    pub fn goal(&self) -> f32 {
        self.sitting.error
    }
}

impl PartialEq for Sitting {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.field, &other.field)
            && (self.camera, self.size, self.error, self.has_lines)
                == (other.camera, other.size, other.error, other.has_lines)
    }
}

/// How it is shown; a change of it costs no new light.
#[derive(Clone, Copy, PartialEq)]
struct Look {
    /// Factor on radiosities, m²/W.
    exposure: f32,
    reading: Option<Reading>,
}

/// A picture as far as it is.
#[derive(Clone)]
pub struct Painted {
    pub pixels: Arc<Pixels>,
    /// Counts up.
    pub serial: u64,
    /// Noise that nine tenths of the picture stay below, as a share of the local light.
    pub noise: f32,
    /// Whether that is as low as was asked for.
    pub is_done: bool,
    sitting: Sitting,
    look: Look,
}

/// A picture that the thread is asked for; cancelled once something else is in view.
#[derive(Clone)]
struct Ask {
    sitting: Sitting,
    look: Look,
    cancel: CancelToken,
}

type Slot = Arc<Mutex<Option<Painted>>>;

/// The thread, what was last asked of it and what it painted.
pub struct Gathering {
    asks: Option<Sender<Option<Ask>>>,
    slot: Slot,
    /// Stops the thread's work on what was asked for last.
    cancel: CancelToken,
    /// Picture and look of the frame before, and whether it was asked for.
    last: Option<(Sitting, Look)>,
    is_asked: bool,
}

impl Gathering {
    /// Starts the thread; without one pictures stay those of the mesh.
    pub fn start(wake: &Wake) -> Self {
        let (asks, inbox) = channel();
        let slot = Slot::default();
        let easel = Easel {
            inbox,
            slot: slot.clone(),
            wake: wake.clone(),
            pool: background_pool("picture", 0).ok(),
            serial: 0,
        };
        let started = Builder::new().name("picture".into()).spawn(move || easel.run());
        Self { asks: started.is_ok().then_some(asks), slot, cancel: CancelToken::new(), last: None, is_asked: false }
    }

    /// The picture of what the view shows, as far as it is; `None` while it shows the mesh. Asks
    /// for one once the view has stood still for a frame.
    pub fn follow(
        &mut self,
        snapshot: &Snapshot,
        camera: &Camera,
        display: &Display,
        size: [u32; 2],
        ctx: &egui::Context,
    ) -> Option<Painted> {
        let field = snapshot.field.clone()?;
        let error = snapshot.stats.error_asked.unwrap_or(USUAL_ERROR) as f32;
        let has_lines = display.reading.is_some_and(|reading| !reading.isolines.values().is_empty());
        let sitting = Sitting { field, camera: *camera, size, error, has_lines };
        let look = Look { exposure: display.exposure, reading: display.reading };
        let is_same = self.last.as_ref().is_some_and(|(last, _)| *last == sitting);
        let looks_same = self.last.as_ref().is_some_and(|(_, last)| *last == look);
        if !is_same {
            self.cancel.cancel();
            (self.cancel, self.is_asked) = (CancelToken::new(), false);
            // A view that stands still draws no further frame by itself.
            ctx.request_repaint_after(crate::app::REPAINT_INTERVAL_ON_CPU);
        } else if !self.is_asked || !looks_same {
            if let Some(asks) = &self.asks {
                // A thread that broke paints nothing: the mesh stays in view.
                let _ = asks.send(Some(Ask { sitting: sitting.clone(), look, cancel: self.cancel.clone() }));
            }
            self.is_asked = true;
        }
        let painted = lock(&self.slot).clone().filter(|painted| painted.sitting == sitting && painted.look == look);
        self.last = Some((sitting, look));
        painted
    }

    /// Nothing that is gathered is in view.
    pub fn rest(&mut self) {
        if self.last.take().is_some() {
            self.cancel.cancel();
            (self.cancel, self.is_asked) = (CancelToken::new(), false);
            if let Some(asks) = &self.asks {
                let _ = asks.send(None);
            }
        }
    }
}

impl Drop for Gathering {
    fn drop(&mut self) {
        self.asks = None;
        self.cancel.cancel();
    }
}

/// State of the thread.
struct Easel {
    inbox: Receiver<Option<Ask>>,
    slot: Slot,
    wake: Wake,
    pool: Option<ThreadPool>,
    serial: u64,
}

impl Easel {
    fn run(mut self) {
        let mut work: Option<(Ask, GatheredPicture)> = None;
        loop {
            let is_busy = work.as_ref().is_some_and(|(_, picture)| !picture.is_done());
            let first = match is_busy {
                true => None,
                false => match self.inbox.recv() {
                    Ok(ask) => Some(ask),
                    Err(_) => return,
                },
            };
            match self.inbox.try_iter().last().or(first) {
                Some(Some(ask)) => match &mut work {
                    Some((of, picture)) if of.sitting == ask.sitting => {
                        *of = ask;
                        self.publish(of, picture);
                    }
                    _ => {
                        let Sitting { field, camera, size, error, has_lines } = ask.sitting.clone();
                        let lens = camera.lens(size[0] as f32 / size[1] as f32);
                        let picture = GatheredPicture::new(field, lens, size, error, Start::Coarse, has_lines);
                        work = Some((ask, picture));
                    }
                },
                Some(None) => {
                    work = None;
                    *lock(&self.slot) = None;
                }
                None => {}
            }
            let Some((ask, picture)) = work.as_mut().filter(|(_, picture)| !picture.is_done()) else { continue };
            match within(self.pool.as_ref(), || picture.advance(&ask.cancel)) {
                Some(()) => self.publish(ask, picture),
                // Something has moved: it gets no better, and another one will be asked for.
                None => work = None,
            }
        }
    }

    fn publish(&mut self, Ask { sitting, look, .. }: &Ask, picture: &GatheredPicture) {
        let develop = || developed(picture, look.exposure, look.reading.as_ref());
        let pixels = within(self.pool.as_ref(), develop);
        let (Some(pixels), Some(noise)) = (pixels, picture.noise()) else { return };
        self.serial += 1;
        let painted = Painted {
            pixels: Arc::new(pixels),
            serial: self.serial,
            noise,
            is_done: picture.is_done(),
            sitting: sitting.clone(),
            look: *look,
        };
        *lock(&self.slot) = Some(painted);
        (self.wake)();
    }
}

/// A picture for a file, in the size asked for; `None` where it was cancelled.
pub fn gather_for_file(
    field: &Arc<Field>,
    camera: &Camera,
    size: [u32; 2],
    error: f32,
    has_lines: bool,
    cancel: &CancelToken,
) -> Option<GatheredPicture> {
    let lens = camera.lens(size[0] as f32 / size[1] as f32);
    let mut picture = GatheredPicture::new(field.clone(), lens, size, error, Start::Fine, has_lines);
    let advance = || {
        while !picture.is_done() {
            picture.advance(cancel)?;
        }
        Some(())
    };
    within(pool("picture", 0).ok().as_ref(), advance)?;
    Some(picture)
}
