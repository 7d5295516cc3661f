//! Whitted's ray tracing: Turner Whitted, "An Improved Illumination Model for Shaded Display", CACM 1980.
//!
//! Each hit is lit by every light that a shadow ray reaches, and followed further where the surface mirrors or lets light
//! through. Light from all other directions is what the ambient light says.
//!
//! Rays are not followed one by one but in waves of those that belong together: the primary rays of a tile, the mirrored ones of a depth, the
//! shadow rays of a light. Structures trace such rays as packets.

mod coloured;
mod direct;
mod lit_points;
mod queue;
mod shade;
mod waves;

use std::cell::RefCell;

use super::{Frame, Integrator, TileRenderer};
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePass, TilePixels};
use waves::{Scratch, Waves};

/// The registry's line for this method.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "whitted",
    help: "direct light with sharp shadows, mirror reflection and refraction (Whitted 1980)",
    shows_light: true,
    shows_all_materials: false,
    start: |frame| Box::new(Whitted { frame }),
};

/// A picture of this method.
struct Whitted<'a> {
    frame: &'a Frame<'a>,
}

thread_local! {
    /// Kept from tile to tile, so that none asks for memory.
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

impl TileRenderer for Whitted<'_> {
    fn render_tile(&self, tile: &Tile, pass: &TilePass, pixels: &mut TilePixels) -> RayCounts {
        SCRATCH.with_borrow_mut(|scratch| {
            let mut waves = Waves::new(self.frame, pixels, scratch);
            waves.follow_all(tile, pass);
            waves.counts()
        })
    }
}
