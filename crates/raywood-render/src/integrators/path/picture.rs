//! What is the same for all paths of a picture.

use raywood_scene::MetallicRoughness;

use super::heuristic::Strategy;
use crate::bsdf::GlassTable;
use crate::integrators::Frame;
use crate::light_sampling::{AreaLights, EnvironmentLight};
use crate::surface_material::SurfaceMaterial;

/// A picture that is begun: its lights with extent, ready to be asked, and what there is to know of rough glass.
pub(super) struct Picture<'a> {
    pub(super) frame: &'a Frame<'a>,
    pub(super) area: Option<AreaLights>,
    pub(super) environment: Option<EnvironmentLight>,
    pub(super) glass: Vec<GlassTable>,
    pub(super) strategy: Strategy,
}

impl<'a> Picture<'a> {
    /// O(primitives) where something shines.
    pub(super) fn new(frame: &'a Frame<'a>) -> Self {
        let scene = frame.scene;
        let mut glass: Vec<GlassTable> = Vec::new();
        for material in &scene.scene().materials {
            let is_glass = |made_of: MetallicRoughness| made_of.transmission > 0.0;
            let bends = material.ior.is_finite() && material.ior > 0.0 && material.ior != 1.0;
            if !(material.metallic_roughness.is_some_and(is_glass) && bends) {
                continue;
            }
            // For each colour that it parts.
            for ior in SurfaceMaterial::new(material).iors() {
                if glass.iter().all(|table| table.ior != ior) {
                    glass.push(GlassTable::new(ior));
                }
            }
        }
        Self {
            frame,
            area: AreaLights::new(scene),
            environment: EnvironmentLight::new(scene),
            glass,
            strategy: Strategy::Both,
        }
    }
}
