//! How much of surfaces is there at many hits, as close up: for shadow rays that follow light through holes.
//!
//! What one hit needs lies in five arrays, each far from the last. So each array is read for all hits before the next one is: then the waits for memory overlap.

use raywood::Hit;

use crate::PreparedScene;
use crate::prepared::Which;
use crate::textured::{Layer, Slot};

/// The textures that tell how much of a surface is there.
const SLOTS: [Slot; 2] = [Slot::Color, Slot::OpacityMap];

/// How much of surfaces is there at hits, and memory to find out.
#[derive(Default)]
pub(crate) struct Opacities {
    /// Of each hit; one where there is no hit.
    all: Vec<f32>,
    /// The hits on surfaces that may have holes.
    suspects: Vec<Suspect>,
}

/// A hit on a surface that may have holes.
struct Suspect {
    /// Its number among all.
    number: usize,
    material: u32,
    triangle: u32,
    weights: [f32; 2],
    corners: [u32; 3],
    /// Where each texture is read, what there is in memory, and in which shares that is blended.
    points: [[f32; 2]; 2],
    texels: [[[u8; 4]; 4]; 2],
    shares: [[f32; 4]; 2],
}

impl Opacities {
    /// Finds out how much is there at hits, number for number: 1 is all.
    pub(crate) fn find(&mut self, scene: &PreparedScene<'_>, hits: &[Option<Hit>]) -> &[f32] {
        let Self { all, suspects } = self;
        all.clear();
        all.resize(hits.len(), 1.0);
        suspects.clear();
        // Nothing has holes anywhere.
        if scene.transmissive_bounds(true).is_empty() {
            return all;
        }
        for (number, hit) in hits.iter().enumerate() {
            let Some(hit) = hit else { continue };
            let material = scene.material_index(hit) as u32;
            let Which::Triangle(triangle) = scene.which(hit.primitive) else { continue };
            if scene.material(material).perforated {
                let weights = [hit.u, hit.v];
                suspects.push(Suspect::new(number, material, triangle, weights));
            }
        }

        let mesh = &scene.scene().mesh;
        for suspect in &mut *suspects {
            suspect.corners = mesh.triangles.triangles()[suspect.triangle as usize];
        }
        let layer = |suspect: &Suspect, slot: Slot| -> Option<&Layer<'_>> {
            scene.textured_material(suspect.material)?.layer(slot)
        };
        for (place, slot) in SLOTS.into_iter().enumerate() {
            for suspect in &mut *suspects {
                let Some(Layer { texture, .. }) = layer(suspect, slot) else { continue };
                let coordinates = &mesh.texture_coordinates[usize::from(texture.set.min(1))];
                suspect.points[place] =
                    texture.point_on(coordinates, suspect.corners, suspect.weights);
            }
            for suspect in &mut *suspects {
                let Some(Layer { grid, image, .. }) = layer(suspect, slot) else { continue };
                let blend = grid.blend(0, suspect.points[place]);
                suspect.texels[place] = image.fetch(0, blend.texels);
                suspect.shares[place] = blend.shares;
            }
        }
        for suspect in &*suspects {
            let Some(material) = scene.textured_material(suspect.material) else { continue };
            let [color, map] = [0, 1].map(|place| {
                layer(suspect, SLOTS[place]).map_or([1.0; 4], |layer| {
                    layer.image.mix(0, suspect.texels[place], suspect.shares[place])
                })
            });
            all[suspect.number] = material.opacity(color, map);
        }
        all
    }
}

impl Suspect {
    fn new(number: usize, material: u32, triangle: u32, weights: [f32; 2]) -> Self {
        Self {
            number,
            material,
            triangle,
            weights,
            corners: [0; 3],
            points: [[0.0; 2]; 2],
            texels: [[[0; 4]; 4]; 2],
            shares: [[0.0; 4]; 2],
        }
    }
}
