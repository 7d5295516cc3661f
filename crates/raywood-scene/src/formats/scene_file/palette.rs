//! The materials that a scene file defines: `[material.NAME]`, and those described where they are used.

use std::collections::BTreeMap;

use super::assembly::Assembly;
use super::material::MaterialChange;
use super::syntax::{Fields, Value, known_names};
use crate::error::LoadError;
use crate::{Material, MaterialId};

/// The materials with a name, and their numbers.
#[derive(Default)]
pub(super) struct Palette<'a> {
    named: BTreeMap<&'a str, MaterialId>,
}

impl<'a> Palette<'a> {
    /// Those of a scene file, in the order in which they stand there.
    pub(super) fn read(fields: &Fields<'a>, assembly: &mut Assembly) -> Result<Self, LoadError> {
        let mut palette = Self::default();
        let Some(materials) = fields.get("material") else { return Ok(palette) };
        for (name, value) in materials.any_fields("[material]")?.entries() {
            if !value.is_table() {
                return Err(value.expected("a table, headed [material.NAME]"));
            }
            let material = MaterialChange::read(value)?.material(name);
            let number = assembly.add_material(material).map_err(|message| value.error(message))?;
            palette.named.insert(name, number);
        }
        Ok(palette)
    }

    /// The number of the material that a value names, or describes.
    pub(super) fn number(
        &self,
        value: Value<'_>,
        assembly: &mut Assembly,
    ) -> Result<MaterialId, LoadError> {
        if value.is_table() {
            let material = MaterialChange::read(value)?.material("");
            return assembly.add_material(material).map_err(|message| value.error(message));
        }
        let Some(name) = value.as_text() else {
            return Err(value.expected("the name of a material, or a table that describes one"));
        };
        self.named.get(name).copied().ok_or_else(|| {
            let names: Vec<_> = self.named.keys().copied().collect();
            value.expected(&format!(
                "a material that a table [material.NAME] describes{}",
                known_names(name, &names)
            ))
        })
    }

    /// The material that a value names.
    pub(super) fn named(
        &self,
        value: Value<'_>,
        assembly: &mut Assembly,
    ) -> Result<Material, LoadError> {
        let number = self.number(value, assembly)?;
        Ok(assembly.scene.materials[number as usize].clone())
    }
}
