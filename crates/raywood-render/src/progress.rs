//! How far a rendering is, and the wish to stop it: what the renderer shares with whoever watches.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Shared between a rendering and its watcher. The renderer asks at every ray that follows from another whether it shall
/// stop, so it does within milliseconds.
#[derive(Debug, Default)]
pub struct Progress {
    // Read with every ray, written once: on a cache line of its own, away from the counters that every tile changes.
    cancelled: OwnCacheLine<AtomicBool>,
    done: OwnCacheLine<AtomicU64>,
    total: AtomicU64,
    standing: Mutex<Standing>,
}

/// How far a picture is that is rendered in passes, by those that are done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Standing {
    /// The most samples of a pixel.
    pub samples: u32,
    /// The relative error, once it can be estimated.
    pub noise: Option<f32>,
    /// The share of the work that is done, as far as one can tell, 0 to 1.
    pub fraction: f64,
}

#[derive(Debug, Default)]
#[repr(align(128))]
struct OwnCacheLine<T>(T);

impl Progress {
    /// Nothing done yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks the rendering to stop soon. It then returns [`RenderError::Cancelled`](crate::RenderError::Cancelled).
    pub fn cancel(&self) {
        self.cancelled.0.store(true, Ordering::Relaxed);
    }

    /// Whether somebody asked to stop.
    #[inline]
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.0.load(Ordering::Relaxed)
    }

    /// Pixels finished so far; in a pass, samples of pixels.
    pub fn pixels_done(&self) -> u64 {
        self.done.0.load(Ordering::Relaxed)
    }

    /// Pixels in all; 0 before the rendering starts.
    pub fn pixels_total(&self) -> u64 {
        self.total.load(Ordering::Relaxed)
    }

    /// The share that is done, of a picture or a pass, 0 to 1.
    pub fn fraction(&self) -> f64 {
        match self.pixels_total() {
            0 => 0.0,
            total => self.pixels_done() as f64 / total as f64,
        }
    }

    /// How far a picture in passes is; zeros of others.
    pub fn standing(&self) -> Standing {
        *self.standing.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn set_standing(&self, standing: Standing) {
        *self.standing.lock().unwrap_or_else(PoisonError::into_inner) = standing;
    }

    pub(crate) fn start(&self, total: u64) {
        self.done.0.store(0, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
    }

    pub(crate) fn add(&self, pixels: u64) {
        self.done.0.fetch_add(pixels, Ordering::Relaxed);
    }
}
