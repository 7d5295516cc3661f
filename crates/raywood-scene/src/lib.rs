//! Scenes for ray tracing: what there is, what it looks like, what lights it and from where it is seen.

mod axes;
pub mod builtin;
mod camera;
mod camera_path;
mod color;
mod environment;
mod error;
mod files_read;
mod flatten;
pub mod formats;
mod framing;
mod instances;
mod light;
mod load;
mod material;
mod mesh;
mod mesh_join;
mod metallic_roughness;
mod noise;
mod pattern;
mod saved;
mod scene;
mod spelling;
mod surface_layers;
mod surface_textures;
mod texture;
mod texture_image;

pub use axes::Axes;
pub use builtin::{BuiltinError, DEFAULT_BUILTIN, builtin, builtins};
pub use camera::Camera;
pub use color::{Rgb, linear_to_srgb, luminance, srgb_to_linear};
pub use environment::{Environment, Sky, SkyError, load_environment};
pub use error::{LoadError, Place, quoted};
pub use files_read::{FileStamp, files_read};
pub use flatten::TooManyTriangles;
pub use framing::{
    Framing, ambient, default_camera, default_direction, default_lights, frame_bounds,
};
pub use instances::{Instance, Instances, InstancesError};
pub use light::{Light, LightKind};
pub use load::{LoadOptions, load_bytes, load_file};
pub use material::{Material, MaterialId};
pub use mesh::Mesh;
pub use metallic_roughness::{LightShares, MetallicRoughness};
pub use pattern::Pattern;
pub use saved::{SavedScene, save_scene};
pub use scene::{Background, Scene};
pub use spelling::closest_name;
pub use surface_layers::{Clearcoat, Sheen};
pub use surface_textures::SurfaceTextures;
pub use texture::{ImageId, Magnification, Texture, TextureTransform, Wrap};
pub use texture_image::{Encoding, TexelBlend, TexelGrid, TextureImage, blend_levels};
