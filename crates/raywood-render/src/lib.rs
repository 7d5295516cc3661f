//! Scenes to images: ray tracing on the `raywood` library.
//!
//! [`PreparedScene`] makes a scene ready for rays, [`render`] or [`render_passes`] follow them, [`ImageFormat`] writes the [`Image`]. [`heat_map`] shows what the
//! structure does for each pixel, [`bounds_overlay`] its boxes.

mod bounds_overlay;
mod bsdf;
mod camera_rays;
mod denoise;
mod exposure;
mod few_boxes;
mod film;
pub mod fresnel;
mod heat_map;
mod image;
mod image_file;
mod instanced;
mod integrators;
mod layers;
mod lens;
mod light_sampling;
mod lights;
mod options;
mod passes;
mod path_samples;
mod pixel_filter;
mod power;
mod prepare_error;
mod prepared;
mod progress;
mod ray_cone;
mod render;
mod rgb_image;
mod sampling;
mod shading;
mod shadows;
mod stats;
mod surface_material;
mod textured;
mod tiles;
mod tone_map;
mod tracer;
mod view;
mod wave;

pub use bounds_overlay::{BoundsOverlay, bounds_overlay};
pub use camera_rays::{CameraError, CameraRays};
pub use denoise::denoise;
pub use exposure::{exposure_for, key_exposure};
pub use film::{Film, FilmPixel};
pub use heat_map::{HeatMap, HeatQuantity, heat_map};
pub use image::{Image, srgb8};
pub use image_file::{Contents, IMAGE_FORMATS, ImageFormat, WriteAndSeek, WriteOptions, write_png};
pub use integrators::{Features, INTEGRATORS, Integrator, NO_ID, features, primitive_ids};
pub use layers::{Aov, Layer, LayerSources, Values};
pub use lens::{Lens, depth_at};
pub use options::{RenderError, RenderOptions};
pub use passes::{Ended, Goal, noise, render_passes};
pub use pixel_filter::PixelFilter;
pub use prepare_error::PrepareError;
pub use prepared::{PreparedScene, Surfaces};
pub use progress::{Progress, Standing};
pub use render::render;
pub use rgb_image::RgbImage;
pub use sampling::PixelSamples;
pub use shadows::shadow_ray;
pub use stats::{RayCounts, RenderStats};
pub use tone_map::{TONE_MAPS, ToneMap, soft_clip};
pub use view::{Setting, View, choose_camera, choose_lights, default_view};
