//! The tests of scenes and formats, one subject per file, in one program.

mod any_bytes;
mod crossings_real;
mod formats_gltf;
mod formats_hostile;
mod formats_real;
mod formats_support;
mod formats_text;
mod instances;
mod saved;
mod scene_file_errors;
mod scene_files;
mod texture_files;
