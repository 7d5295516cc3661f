//! An opened glTF file: its JSON, checked, and its buffers.

use std::borrow::Cow;
use std::path::Path;

use gltf_json::{Root, Value, deserialize};

use super::{check, container};
use crate::error::{LoadError, Place};
use crate::formats::Input;
use crate::formats::notes::Notes;

/// The JSON and the buffers. Indices in the JSON are in range.
pub(super) struct Document<'a> {
    pub(super) path: &'a Path,
    /// The JSON.
    pub(super) root: Root,
    /// The contents of its buffers.
    pub(super) buffers: Vec<Cow<'a, [u8]>>,
}

impl<'a> Document<'a> {
    /// Reads and checks a file.
    pub(super) fn open(input: &Input<'a>, notes: &mut Notes) -> Result<Self, LoadError> {
        let parts = container::split(input, notes)?;
        let root = parse(input, parts.json)?;
        check::check(input, &root, notes)?;
        let buffers = container::buffers(input, &root, parts.binary)?;
        Ok(Self { path: input.path, root, buffers })
    }

    /// An error at a value of the JSON.
    #[cold]
    pub(super) fn error(&self, json: impl Into<String>, message: impl Into<String>) -> LoadError {
        self.error_at(Place::Json(json.into()), message)
    }

    /// An error at a place.
    #[cold]
    pub(super) fn error_at(&self, place: Place, message: impl Into<String>) -> LoadError {
        LoadError::new(self.path, place, message)
    }
}

/// Reads the JSON.
fn parse(input: &Input<'_>, json: &[u8]) -> Result<Root, LoadError> {
    // Some writers fill the end of the JSON chunk with zeros instead of blanks.
    let padding = json.iter().rev().take_while(|&&byte| byte == 0).count();
    let json = &json[..json.len() - padding];
    deserialize::from_slice(json).map_err(|error| {
        if let Ok(value) = deserialize::from_slice::<Value>(json)
            && let Some(version) = value["asset"]["version"].as_str()
            && !version.starts_with("2.")
        {
            let place = Place::Json("asset.version".to_owned());
            let message = format!("found glTF {version}, expected 2.0");
            return LoadError::new(input.path, place, message);
        }
        let (line, column) = (error.line(), error.column());
        let text = error.to_string();
        let message = text.split(" at line ").next().unwrap_or(&text);
        if json.len() == input.bytes.len() {
            let message = format!("{message} (column {column})");
            LoadError::new(input.path, Place::Line(line), message)
        } else {
            let place = Place::Json(format!("JSON line {line} column {column}"));
            LoadError::new(input.path, place, message)
        }
    })
}
