//! The tests of pictures, one subject per file, in one program: what is generic is compiled once for all of them.

mod bounds_overlay;
mod common;
mod film;
mod first_hits;
mod heat_map;
mod instances;
mod optics;
mod path;
mod references;
mod rendering;
mod textures;
mod view;
mod whitted;
