//! What the fuzz targets run: files of the crates' tests, which the ordinary tests run on what was found.

#[path = "../../crates/raywood-scene/tests/scenes/any_bytes.rs"]
mod any_bytes;
#[cfg(feature = "command")]
#[path = "../../crates/raywood-cli/tests/any_rows.rs"]
mod any_rows;
#[path = "../../crates/raywood/tests/library/build_and_query.rs"]
mod build_and_query;
#[path = "../../crates/raywood-scene/tests/scenes/formats_support.rs"]
mod formats_support;

pub use any_bytes::{gltf, hdr, image, obj, ply, scene_file, stl};
#[cfg(feature = "command")]
pub use any_rows::any_rows;
pub use build_and_query::run as build_and_query;
