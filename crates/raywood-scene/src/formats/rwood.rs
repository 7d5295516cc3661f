//! Saved trees and scenes, the program's own format: see `saved/`.

use raywood::SavedTree;

use super::{Format, Input};
use crate::Scene;
use crate::error::LoadError;
use crate::saved::SavedScene;

pub(super) const FORMAT: Format = Format {
    name: "Raywood",
    extensions: &["rwood"],
    description: "a scene saved with its tree",
    recognises: |bytes| bytes.starts_with(&SavedTree::SIGNATURE),
    load,
};

/// The scene alone. Who wants its tree too, and no copy of the bytes, [opens](SavedScene::open) it.
fn load(input: &Input<'_>) -> Result<Scene, LoadError> {
    Ok(SavedScene::open(input.path, input.bytes.to_vec())?.scene)
}
