//! `[[model]]`: a file or a built-in scene, where it stands, and what is changed of its materials.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use raywood::Vec3;

use super::assembly::{Assembly, Model, Standing};
use super::material::MaterialChange;
use super::palette::Palette;
use super::syntax::{Fields, Value, known_names};
use super::transform;
use crate::error::{LoadError, quoted};
use crate::formats::{Input, Nesting};
use crate::load::{load_nested, read_file};
use crate::{Environment, Material, Rgb, Scene, builtin, builtins};

const KEYS: [&str; 12] = [
    "file",
    "parameters",
    "lights",
    "material",
    "override",
    "instance",
    "tint",
    "translate",
    "rotate",
    "scale",
    "matrix",
    "to",
];

/// The keys of a place.
const PLACE_KEYS: [&str; 7] = ["material", "tint", "translate", "rotate", "scale", "matrix", "to"];

/// What precedes the name of a built-in scene.
const BUILTIN_PREFIX: &str = "builtin:";

/// So many scene files may each show the next.
const DEEPEST: usize = 16;
/// So many files may be loaded for one.
const MOST_FILES: usize = 4096;

/// The models that a scene file shows, each loaded once.
pub(super) struct Models<'a> {
    input: &'a Input<'a>,
    nesting: Nesting,
    up: Vec3,
    has_lights: bool,
    loaded: HashMap<String, (Rc<Scene>, u32)>,
    /// In the order in which they are shown, each once.
    pub(super) scenes: Vec<Rc<Scene>>,
    /// The direction that is up in the first model that says so, as it stands.
    pub(super) first_up: Option<Vec3>,
    /// The panorama around the first model that has one. No other is kept.
    pub(super) first_environment: Option<Environment>,
}

impl<'a> Models<'a> {
    /// None yet. `up` is what single angles turn around; if the scene file `has_lights`, those of models are left out unless they are asked for.
    pub(super) fn new(input: &'a Input<'a>, up: Vec3, has_lights: bool) -> Self {
        let mut open = input.nesting.open.clone();
        open.push(canonical(input.path));
        let nesting = Nesting { open, files: Arc::clone(&input.nesting.files) };
        let (loaded, scenes) = (HashMap::new(), Vec::new());
        let (first_up, first_environment) = (None, None);
        Self { input, nesting, up, has_lights, loaded, scenes, first_up, first_environment }
    }

    /// Shows the model of a table.
    pub(super) fn show(
        &mut self,
        value: Value<'_>,
        palette: &Palette<'_>,
        assembly: &mut Assembly,
    ) -> Result<(), LoadError> {
        let fields = value.fields("[[model]]", &KEYS)?;
        let failed = |message: String| fields.error(message);

        // Where it stands: in one place, or where its instances say.
        let all = place(&fields, self.up, palette, assembly)?;
        let mut places = Vec::new();
        for instance in fields.tables("instance")? {
            let instance = instance.fields("[[model.instance]]", &PLACE_KEYS)?;
            let own = place(&instance, self.up, palette, assembly)?;
            let (transform, later) = own.moved((&all.transform, all.later.as_ref()));
            places.push(Standing {
                transform,
                later,
                material: own.material.or(all.material),
                tint: all.tint * own.tint,
            });
        }
        if fields.get("instance").is_none() {
            places.push(all);
        }

        let (scene, first_image) = self.load(&fields, assembly)?;
        if let (None, Some(up), [place]) = (self.first_up, scene.up, &places[..]) {
            let up = place.transform.vector(up).normalize_or_zero();
            self.first_up = Some(up).filter(|up| *up != Vec3::ZERO);
        }
        let mut materials = scene.materials.clone();
        for textures in materials.iter_mut().filter_map(|material| material.textures.as_mut()) {
            textures.all_mut().for_each(|texture| {
                texture.image = texture.image.saturating_add(first_image);
            });
        }
        if let Some(changes) = fields.get("override") {
            for (name, change) in changes.any_fields("[model.override]")?.entries() {
                override_material(&mut materials, name, change, palette, assembly)?;
            }
        }
        let takes_lights = fields.read("lights", Value::boolean)?.unwrap_or(!self.has_lights);
        assembly.show(Model { scene, materials, places, takes_lights }).map_err(failed)
    }

    /// The scene of a model, and the number of its first image in the whole scene.
    fn load(
        &mut self,
        fields: &Fields<'_>,
        assembly: &mut Assembly,
    ) -> Result<(Rc<Scene>, u32), LoadError> {
        let file = fields.require("file")?;
        let mut name = file.text()?.to_owned();
        if let Some(parameters) = fields.get("parameters") {
            if !name.starts_with(BUILTIN_PREFIX) {
                return Err(parameters.error(format!(
                    "`parameters` are for built-in scenes, as \"{BUILTIN_PREFIX}terrain\", and {} is a file",
                    quoted(name.as_bytes())
                )));
            }
            for (key, value) in parameters.any_fields("`parameters`")?.entries() {
                let separator = if name.contains('?') { '&' } else { '?' };
                name += &format!("{separator}{key}={}", value.whole_number()?);
            }
        }
        if let Some((scene, first_image)) = self.loaded.get(&name) {
            return Ok((Rc::clone(scene), *first_image));
        }

        let mut scene = match name.strip_prefix(BUILTIN_PREFIX) {
            Some(name) => builtin(name).map_err(|error| file.error(error.to_string()))?,
            None => self.load_file(file)?,
        };
        let environment = scene.environment.take();
        self.first_environment = self.first_environment.take().or(environment);
        let warnings = std::mem::take(&mut scene.warnings);
        let of_model = |warning: String| format!("{}: {warning}", scene.name);
        assembly.scene.warnings.extend(warnings.into_iter().map(of_model));
        let first_image = assembly.add_images(&scene).map_err(|message| file.error(message))?;
        let scene = Rc::new(scene);
        self.scenes.push(Rc::clone(&scene));
        self.loaded.insert(name, (Rc::clone(&scene), first_image));
        Ok((scene, first_image))
    }

    /// Loads a model from a file beside the scene file, or elsewhere.
    fn load_file(&self, file: Value<'_>) -> Result<Scene, LoadError> {
        let path = super::find(file, self.input).map_err(|error| or_builtin(file, error))?;
        let here = canonical(&path);
        if let Some(first) = self.nesting.open.iter().position(|open| *open == here) {
            let chain = self.nesting.open[first..].iter().chain([&here]);
            let names: Vec<_> = chain.map(|path| last_part(path)).collect();
            let message =
                format!("a scene file cannot show itself, but here {}", names.join(" shows "));
            return Err(file.error(message));
        }
        if self.nesting.open.len() > DEEPEST {
            return Err(file.error(format!("more than {DEEPEST} scene files show each other")));
        }
        if self.nesting.files.fetch_add(1, Ordering::Relaxed) >= MOST_FILES {
            return Err(file.error(format!("more than {MOST_FILES} files are to be loaded")));
        }
        load_nested(&path, &read_file(&path)?, self.input.options, &self.nesting)
    }
}

/// The place that a table describes.
fn place(
    fields: &Fields<'_>,
    up: Vec3,
    palette: &Palette<'_>,
    assembly: &mut Assembly,
) -> Result<Standing, LoadError> {
    let material = fields.read("material", |value| palette.number(value, assembly))?;
    let tint = fields.read("tint", |value| value.color(f32::MAX))?.unwrap_or(Rgb::ONE);
    let (transform, later) = transform::read(fields, up)?;
    Ok(Standing { transform, later, material, tint })
}

/// Changes the materials of a name, or puts another in their place.
fn override_material(
    materials: &mut [Material],
    name: &str,
    change: Value<'_>,
    palette: &Palette<'_>,
    assembly: &mut Assembly,
) -> Result<(), LoadError> {
    if !materials.iter().any(|material| material.name == name) {
        let names: Vec<_> = materials.iter().map(|material| &material.name[..]).collect();
        let message = format!(
            "the model has no material {}{}",
            quoted(name.as_bytes()),
            known_names(name, &names)
        );
        return Err(change.error(message));
    }
    let matching = materials.iter_mut().filter(|material| material.name == name);
    if change.is_table() {
        let change = MaterialChange::read(change)?;
        matching.for_each(|material| change.apply(material));
    } else {
        let other = palette.named(change, assembly)?;
        matching.for_each(|material| *material = other.clone());
    }
    Ok(())
}

/// A better error about a file that is not there, where a built-in scene has its name.
fn or_builtin(file: Value<'_>, error: LoadError) -> LoadError {
    let name = file.as_text().unwrap_or_default();
    let plain = name.split('?').next().unwrap_or_default();
    match builtins().iter().any(|scene| scene.name == plain) {
        true => file.error(format!("no such file, did you mean \"{BUILTIN_PREFIX}{name}\"?")),
        false => error,
    }
}

/// One name for each file.
fn canonical(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

fn last_part(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
