//! Scenes made by code, asked for by name: `hall`, `terrain?n=2048&seed=7`.
//!
//! To add a scene, write a file with a `pub(super) const ENTRY` and name it in `BUILTINS`.

mod error;
mod forest;
mod hall;
mod mill;
pub mod modelling;
mod sphereflake;
mod terrain;
mod whitted;

pub use error::BuiltinError;

use crate::{Scene, closest_name};

/// The scene that is rendered when none is named.
pub const DEFAULT_BUILTIN: &str = "hall";

/// All built-in scenes, the default one first.
const BUILTINS: &[Builtin] =
    &[hall::ENTRY, whitted::ENTRY, sphereflake::ENTRY, terrain::ENTRY, forest::ENTRY, mill::ENTRY];

/// A scene made by code.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// What it is asked for by.
    pub name: &'static str,
    /// What it shows, in one line.
    pub description: &'static str,
    /// What can be chosen about it.
    pub parameters: &'static [Parameter],
    build: fn(&Values) -> Scene,
}

/// Something that can be chosen about a built-in scene: a whole number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// What it does, in one line.
    pub description: &'static str,
    /// Its value when not given.
    pub default: u64,
    /// The smallest value allowed.
    pub min: u64,
    /// The largest value allowed.
    pub max: u64,
}

/// The value of every parameter of a scene.
#[derive(Clone, Debug)]
struct Values {
    parameters: &'static [Parameter],
    /// In the order of `parameters`.
    values: Vec<u64>,
}

impl Values {
    /// The value of a parameter, which must be one that the scene's entry declares.
    fn get(&self, name: &str) -> u64 {
        let index = self.parameters.iter().position(|p| p.name == name);
        self.values[index.expect("the scene's entry declares the parameter")]
    }
}

/// All built-in scenes, the default one first.
pub fn builtins() -> &'static [Builtin] {
    BUILTINS
}

/// Makes a built-in scene, from its name and perhaps parameters: `hall`, `terrain?n=2048&seed=7`.
///
/// # Errors
///
/// A name or parameter that does not exist, a value that is no whole number or out of range.
pub fn builtin(name_and_parameters: &str) -> Result<Scene, BuiltinError> {
    let (name, query) = name_and_parameters.split_once('?').unwrap_or((name_and_parameters, ""));
    let names = || BUILTINS.iter().map(|b| b.name);
    let Some(entry) = BUILTINS.iter().find(|b| b.name == name) else {
        return Err(BuiltinError::UnknownScene {
            name: name.to_owned(),
            suggestion: closest_name(name, names()),
            known: names().collect(),
        });
    };
    let values = parse_values(entry, query)?;
    let mut scene = (entry.build)(&values);
    scene.name = entry.name.to_owned();
    scene.up = Some(raywood::Vec3::Y);
    Ok(scene)
}

/// Reads `key=value&key=value`; what is not given has its default.
fn parse_values(entry: &Builtin, query: &str) -> Result<Values, BuiltinError> {
    let scene = entry.name;
    let mut given = vec![None; entry.parameters.len()];
    for pair in query.split('&').filter(|pair| !pair.is_empty()) {
        let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
        let names = || entry.parameters.iter().map(|p| p.name);
        let Some(index) = names().position(|name| name == key) else {
            return Err(BuiltinError::UnknownParameter {
                scene,
                name: key.to_owned(),
                suggestion: closest_name(key, names()),
                known: names().collect(),
            });
        };
        let Parameter { name, min, max, .. } = entry.parameters[index];
        if given[index].is_some() {
            return Err(BuiltinError::RepeatedParameter { scene, name });
        }
        match value.parse() {
            Ok(number) if (min..=max).contains(&number) => given[index] = Some(number),
            _ => {
                let value = value.to_owned();
                return Err(BuiltinError::BadValue { scene, name, value, min, max });
            }
        }
    }
    let values = entry.parameters.iter().zip(given).map(|(p, v)| v.unwrap_or(p.default)).collect();
    Ok(Values { parameters: entry.parameters, values })
}

#[cfg(test)]
mod tests;
