//! Checks of a glTF file's JSON that come before all reading: what it requires, that indices are in range, that values
//! are of their kind.

use gltf_json::mesh::Semantic;
use gltf_json::validation::{Checked, Error, Validate};
use gltf_json::{Path, Root};

use crate::error::{LoadError, Place, quoted};
use crate::formats::Input;
use crate::formats::notes::Notes;

/// Extensions that a file may require: those that change what is seen and are understood, and those of images in formats that are not, without
/// which the shapes are still right.
const KNOWN: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "EXT_texture_avif",
    "MSFT_texture_dds",
];

/// Refuses what cannot be read, and says what is wrong but does no harm.
pub(super) fn check(input: &Input<'_>, root: &Root, notes: &mut Notes) -> Result<(), LoadError> {
    let error =
        |place: String, message: &str| Err(LoadError::new(input.path, Place::Json(place), message));
    let version = &root.asset.version;
    if !version.starts_with("2.") {
        let message = format!("found glTF {}, expected 2.0", quoted(version.as_bytes()));
        return error("asset.version".to_owned(), &message);
    }

    // Extensions.
    for (i, extension) in root.extensions_required.iter().enumerate() {
        if !KNOWN.contains(&&**extension) {
            let message = format!("requires the extension {extension}, which is not known here");
            return error(format!("extensionsRequired[{i}]"), &message);
        }
    }
    let others: Vec<&str> = root
        .extensions_used
        .iter()
        .map(|extension| &**extension)
        .filter(|extension| !KNOWN.contains(extension))
        .take(16)
        .collect();
    if !others.is_empty() {
        notes.say(format!("extensions left out: {}", others.join(", ")));
    }

    // The library's own checks take it for granted that this index is in range.
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            if let Some(accessor) = position
                && accessor.value() >= root.accessors.len()
            {
                let (found, count) = (accessor.value(), root.accessors.len());
                let place = format!("meshes[{m}].primitives[{p}].attributes.POSITION");
                let message = format!("found accessor {found}, but there are {count}");
                return error(place, &message);
            }
        }
    }

    let mut faults = Vec::new();
    root.validate(root, Path::new, &mut |path, fault| faults.push((path().0, fault)));
    faults
        .retain(|(path, fault)| !(path.starts_with("extensions") && *fault == Error::Unsupported));
    for (path, fault) in faults {
        let problem = match fault {
            Error::IndexOutOfBounds => "names an element that is not there",
            Error::Invalid => "has a value that glTF does not know",
            Error::Missing => "is missing",
            Error::Oversize => "is larger than this machine can address",
            Error::Unsupported => "is not supported",
        };
        if is_harmless(&path) {
            notes.mend_line(Place::Json(path), problem, "no harm to the picture")?;
        } else {
            return error(path, problem);
        }
    }
    Ok(())
}

/// Whether the picture does not depend on a value.
fn is_harmless(path: &str) -> bool {
    let unused = ["animations", "skins", "images", "samplers", "textures"];
    let unread = [".min", ".max", ".target", ".byteStride", "<invalid semantic name>\"]"];
    unused.iter().any(|start| path.starts_with(start))
        || unread.iter().any(|end| path.ends_with(end))
}
