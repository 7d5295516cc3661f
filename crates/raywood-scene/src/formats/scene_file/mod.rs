//! Scene files: models, spheres, materials, lights and cameras put together in TOML. `docs/scene-file.md` describes them.
//!
//! | file | concept |
//! | --- | --- |
//! | `syntax` | values of the document, each of which knows its line and column |
//! | `transform`, `material`, `view` | what they are read as: places, materials, lights and cameras |
//! | `palette` | materials with a name |
//! | `model` | models: loading them, placing them, changing their materials |
//! | `assembly` | the scene in the making |

mod assembly;
mod material;
mod model;
mod palette;
mod syntax;
mod transform;
mod view;

use std::path::{Path, PathBuf};

use raywood::Vec3;
use toml::de::DeTable;

use self::assembly::Assembly;
use self::model::Models;
use self::palette::Palette;
use self::syntax::{Source, Value};
use super::{Format, Input, file_name};
use crate::error::{LoadError, quoted};
use crate::{Background, Environment, Scene, Sky, load_environment};

pub(super) const FORMAT: Format = Format {
    name: "scene file",
    extensions: &["toml"],
    description: "models, spheres, materials, lights and cameras put together",
    recognises: |_| false,
    load,
};

/// The keys of a scene file.
const KEYS: &[&str] =
    &["model", "sphere", "material", "light", "camera", "background", "environment", "up"];

fn load(input: &Input<'_>) -> Result<Scene, LoadError> {
    let text = str::from_utf8(input.bytes).map_err(|error| {
        let text = str::from_utf8(&input.bytes[..error.valid_up_to()]).unwrap_or_default();
        let source = Source { path: input.path, text };
        source.error(text.len(), "a byte that is no UTF-8, expected text")
    })?;
    let source = Source { path: input.path, text };
    let document = DeTable::parse(text).map_err(|error| {
        let message = error.message().replace('\n', ", ");
        source.error(error.span().map_or(0, |span| span.start), message)
    })?;
    let fields = syntax::Fields::of_document(&source, &document, KEYS)?;

    let up = fields.read("up", Value::direction)?;
    let mut assembly = Assembly::default();
    let palette = Palette::read(&fields, &mut assembly)?;
    for value in fields.tables("sphere")? {
        sphere(value, &palette, &mut assembly)?;
    }
    for value in fields.tables("light")? {
        assembly.scene.lights.push(view::light(value)?);
    }
    for value in fields.tables("camera")? {
        let camera = view::camera(value, up.unwrap_or(Vec3::Y))?;
        assembly.scene.cameras.push(camera);
    }
    let background = fields.read("background", view::background)?;
    let (panorama, sky) = fields.read("environment", |value| surroundings(value, input))?.unzip();
    let sky = sky.flatten();

    let has_lights = sky.is_some() || !assembly.scene.lights.is_empty();
    let mut models = Models::new(input, up.unwrap_or(Vec3::Y), has_lights);
    for value in fields.tables("model")? {
        models.show(value, &palette, &mut assembly)?;
    }

    // What the file does not say is as the first model has it that says so.
    let mut scene = assembly.finish().map_err(|message| fields.error(message))?;
    scene.up = up.or(models.first_up);
    if let (Some(sky), Some(panorama)) = (sky, &panorama) {
        let axes = scene.axes();
        scene.lights.extend(sky.lights(panorama, &axes));
    }
    scene.environment = match background {
        None => panorama.or(models.first_environment),
        Some(_) => panorama,
    };
    let mut backgrounds = models.scenes.iter().map(|model| model.background);
    let first = backgrounds.find(|background| *background != Background::default());
    scene.background = background.or(first).unwrap_or_default();
    Ok(scene)
}

/// A table of a sphere.
fn sphere(
    value: Value<'_>,
    palette: &Palette<'_>,
    assembly: &mut Assembly,
) -> Result<(), LoadError> {
    let fields = value.fields("[[sphere]]", &["center", "radius", "material"])?;
    let center = fields.require("center")?.vector()?;
    let radius = fields.require("radius")?.above_zero()?;
    let material = fields.require("material")?;
    let material = palette.number(material, assembly)?;
    assembly.add_sphere((center, radius), material).map_err(|message| fields.error(message))
}

/// What is around the scene: the panorama of a file, or of a sky by formula.
fn surroundings(
    value: Value<'_>,
    input: &Input<'_>,
) -> Result<(Environment, Option<Sky>), LoadError> {
    let Some(sky) = value.as_text().and_then(Sky::from_name) else {
        return Ok((load_environment(&find(value, input)?)?, None));
    };
    let sky = sky.map_err(|error| value.error(error.to_string()))?;
    let panorama = sky.panorama().ok_or_else(|| value.error("a sky of absurd numbers"))?;
    Ok((panorama, Some(sky)))
}

/// The file that a text names, sought from the folder of the scene file.
fn find(value: Value<'_>, input: &Input<'_>) -> Result<PathBuf, LoadError> {
    let name = value.text()?.as_bytes();
    let folder = input.path.parent().unwrap_or(Path::new(""));
    file_name::find(folder, name).ok_or_else(|| {
        let place = match folder.as_os_str().is_empty() {
            true => "the folder of the scene file".to_owned(),
            false => folder.display().to_string(),
        };
        value.error(format!("no such file: {}, sought from {place}", quoted(name)))
    })
}
