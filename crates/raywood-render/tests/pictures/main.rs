//! The tests of pictures, one subject per file, in one program: what is generic is compiled once for all of them.

mod bounds_overlay;
mod common;
mod features;
mod first_hits;
mod heat_map;
mod image_files;
mod instances;
mod mitsuba;
mod motion;
mod optics;
mod path;
mod references;
mod rendering;
mod sampling;
mod scene_files;
mod textures;
mod view;
mod whitted;
