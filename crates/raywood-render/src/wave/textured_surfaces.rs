//! The materials and normals of the textured surfaces that a wave hit, material by material.

use raywood::Vectorized;
use raywood_scene::Rgb;

use super::WAVE;
use super::bent_normals::bend_normals;
use super::columns::set;
use super::footprints::Footprints;
use super::surfaces::Surfaces;
use super::texture_reads::TextureReads;
use crate::PreparedScene;
use crate::prepared::Which;
use crate::textured::Shown;

/// The memory that textures need.
pub(crate) struct TextureMemory {
    footprints: [Footprints; 2],
    reads: TextureReads,
    /// What textures show at the surfaces of one material.
    shown: [Shown; WAVE],
}

impl Default for TextureMemory {
    fn default() -> Self {
        Self {
            footprints: Default::default(),
            reads: TextureReads::default(),
            shown: [[[1.0; 4]; _]; WAVE],
        }
    }
}

/// Finds what textures make of the surfaces of a wave, whose ways from the eye are known.
pub(crate) struct TextureSurfaces<'a> {
    pub(crate) scene: &'a PreparedScene<'a>,
    pub(crate) surfaces: &'a mut Surfaces,
    pub(crate) memory: &'a mut TextureMemory,
    /// By how much the cones that rays stand for widen on a way of length 1.
    pub(crate) spread: f32,
}

impl Vectorized for TextureSurfaces<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { scene, surfaces, memory, spread } = self;
        let TextureMemory { footprints, reads, shown } = memory;
        surfaces.textured.clear();
        surfaces.made_of.iter_mut().for_each(Vec::clear);
        let mut waiting = [0u8; WAVE];
        let mut left = 0;
        for number in 0..surfaces.count() {
            waiting[left] = number as u8;
            left += usize::from(scene.textured_material(surfaces.materials[number]).is_some());
        }
        if left == 0 {
            return;
        }
        for (set, footprints) in footprints.iter_mut().enumerate() {
            if !scene.scene().mesh.texture_coordinates[set].is_empty() || set == 0 {
                footprints.find(scene, surfaces, set, spread);
            }
        }

        // All surfaces of one material together.
        while left > 0 {
            let index = surfaces.materials[usize::from(waiting[0])];
            let mut same = [0u8; WAVE];
            let (mut same_count, mut others) = (0, 0);
            for entry in 0..left {
                let number = waiting[entry];
                let is_same = surfaces.materials[usize::from(number)] == index;
                same[same_count] = number;
                waiting[others] = number;
                same_count += usize::from(is_same);
                others += usize::from(!is_same);
            }
            left = others;
            let Some(material) = scene.textured_material(index) else { continue };
            let same = &same[..same_count];
            let shown = &mut shown[..same_count];
            material.clear(shown);
            reads.read(material, footprints, same, shown);
            if let Some(map) = material.normal() {
                let footprints = &footprints[usize::from(map.0.set.min(1))];
                bend_normals(scene, surfaces, map, footprints, same, shown);
            }
            for (&number, shown) in same.iter().zip(&*shown) {
                let number = usize::from(number);
                let mut own = scene.material(index).clone();
                let made_of =
                    material.apply(&mut own, shown, vertex_color(scene, surfaces, number));
                if let Some(all) = &mut surfaces.made_of {
                    all.push(made_of);
                }
                set(&mut surfaces.diffuse, number, own.diffuse);
                let count = surfaces.textured.len() as u32;
                surfaces.materials[number] = scene.material_count() + count;
                surfaces.textured.push(own);
            }
        }
    }
}

/// The colour that the mesh gives at a surface.
#[inline(always)]
pub(super) fn vertex_color(scene: &PreparedScene<'_>, surfaces: &Surfaces, number: usize) -> Rgb {
    let mesh = &scene.scene().mesh;
    let tint =
        scene.placed(surfaces.element(number).instance).map_or(Rgb::ONE, |placed| placed.tint);
    if mesh.colors.is_empty() {
        return tint;
    }
    let Which::Triangle(triangle) = scene.which(surfaces.primitive(number)) else {
        return tint;
    };
    let corners = mesh.triangles.triangles()[triangle as usize];
    let color = |i: usize| mesh.colors.get(corners[i] as usize).copied().unwrap_or(Rgb::ONE);
    let [u, v] = [surfaces.weights[0][number], surfaces.weights[1][number]];
    tint * ((1.0 - u - v) * color(0) + u * color(1) + v * color(2))
}
