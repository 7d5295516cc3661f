//! Finds all there is to know of the surfaces that a wave hit, before anything is shaded.

use raywood::{SimdLevel, Vectorized};

use super::Traced;
use super::surfaces::Surfaces;
use super::textured_surfaces::{TextureMemory, TextureSurfaces};
use crate::PreparedScene;

/// Finds the surfaces that a wave of rays hit, how long the ways there are, and what textures make of them.
pub(crate) struct FindSurfaces<'a, W, M> {
    pub(crate) scene: &'a PreparedScene<'a>,
    pub(crate) wave: &'a W,
    pub(crate) surfaces: &'a mut Surfaces,
    pub(crate) textures: &'a mut TextureMemory,
    /// By how much the cones that rays stand for widen on a way of length 1.
    pub(crate) spread: f32,
    /// What loops are compiled for.
    pub(crate) level: SimdLevel,
    /// Looks at the rays that hit nothing.
    pub(crate) miss: M,
}

impl<W: Traced, M: FnMut(usize)> Vectorized for FindSurfaces<'_, W, M> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { scene, wave, surfaces, textures: memory, spread, level, miss } = self;
        surfaces.find(scene, wave, miss);
        surfaces.find_lengths(wave);
        if scene.is_textured() {
            level.run(TextureSurfaces { scene, surfaces: &mut *surfaces, memory, spread });
        }
    }
}
