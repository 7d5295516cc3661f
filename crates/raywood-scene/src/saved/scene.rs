//! The section `scene` of a saved scene: everything that is small. `docs/format.md` specifies it.

use raywood::Vec3;

use super::stored::{Fault, Reader, Stored, stored_enum, stored_struct};
use crate::{Background, Camera, Light, LightKind, Material, Pattern};

/// The version of what stands in the section.
const VERSION: u32 = 1;

/// What the section holds.
pub(super) struct Small {
    pub(super) up: Option<Vec3>,
    pub(super) background: Background,
    pub(super) materials: Vec<Material>,
    pub(super) lights: Vec<Light>,
    pub(super) cameras: Vec<Camera>,
}

impl Small {
    /// As bytes, its version first.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        VERSION.put(&mut bytes);
        self.put(&mut bytes);
        bytes
    }

    /// From all of some bytes.
    pub(super) fn of_bytes(bytes: &[u8]) -> Result<Self, Fault> {
        let mut reader = Reader { bytes, at: 0 };
        let version = u32::get(&mut reader)?;
        if version != VERSION {
            let problem = format!(
                "a scene of version {version}, expected version {VERSION}; save it again from its model"
            );
            return Err(Fault { at: 0, problem });
        }
        let small = Self::get(&mut reader)?;
        match reader.at == bytes.len() {
            true => Ok(small),
            false => Err(reader.fault("more bytes than the scene has")),
        }
    }
}

stored_struct!(Small { up, background, materials, lights, cameras });
stored_struct!(Background { zenith, horizon, nadir });
stored_struct!(Material {
    name,
    diffuse,
    pattern,
    specular,
    shininess,
    mirror,
    transmission,
    ior,
    absorption,
    emission,
});
stored_struct!(Light { name, kind, intensity });
stored_struct!(Camera { name, eye, target, up, fov_y });
stored_enum!(Pattern {
    0 => Plain {},
    1 => Checker { other, size },
    2 => Marble { vein, size },
    3 => Tiles { other, size, edge, joint },
    4 => Masonry { length, height, joint },
});
stored_enum!(LightKind {
    0 => Point { position },
    1 => Spot { position, direction, cos_inner, cos_outer },
    2 => Directional { direction },
    3 => Ambient {},
});
