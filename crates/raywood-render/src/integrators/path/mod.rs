//! Path tracing: James Kajiya, "The Rendering Equation", SIGGRAPH 1986.
//!
//! Every path scatters at each surface that it meets, in a direction chosen at random, and asks from there for light: of one of the lights without extent, of
//! a point on a surface that shines, of a direction of the surroundings (next event estimation). What both ways of finding light may find is weighted by the power
//! heuristic (Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", 1995); paths that bring little end by Russian roulette
//! (Arvo and Kirk, "Particle Transport and Image Synthesis", 1990).
//!
//! Paths are followed in waves: a ray of each pixel of a square, then whatever waits, thousands at a time (after Laine, Karras and Aila, "Megakernels Considered
//! Harmful", 2013).

mod dice;
mod direct;
mod heuristic;
mod picture;
mod scatter;
mod shadow_rays;
mod vertices;
mod walks;
mod waves;

#[cfg(test)]
mod tests;

use std::cell::RefCell;

use super::{Integrator, TileRenderer};
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePass, TilePixels};
use picture::Picture;
use waves::{Scratch, Waves};

/// The registry's line for this method.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "path",
    help: "path tracing: soft light, from surfaces that shine, the surroundings and each other (Kajiya 1986)",
    shows_light: true,
    shows_all_materials: true,
    start: |frame| Box::new(Picture::new(frame)),
};

thread_local! {
    /// Kept from tile to tile, so that none asks for memory.
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

impl TileRenderer for Picture<'_> {
    fn render_tile(&self, tile: &Tile, pass: &TilePass, pixels: &mut TilePixels) -> RayCounts {
        SCRATCH.with_borrow_mut(|scratch| {
            let mut waves = Waves::new(self, tile, pixels, scratch);
            waves.follow_all(pass);
            waves.counts()
        })
    }
}
