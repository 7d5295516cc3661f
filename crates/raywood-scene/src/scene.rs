//! The scene: everything that a picture needs.

use raywood::{Aabb, MeshPart, Spheres, Vec3};

use crate::{Camera, Environment, Instances, Light, Material, MaterialId, Mesh, Rgb, TextureImage};

/// Surfaces, materials, lights and cameras.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What it is called: the built-in's or the file's name.
    pub name: String,
    /// All triangles: first those that stand in the world, then those of objects that [instances](Self::instances) show.
    pub mesh: Mesh,
    /// Objects, and where they stand.
    pub instances: Instances,
    /// Analytic spheres.
    pub spheres: Spheres,
    /// The material of each sphere.
    pub sphere_materials: Vec<MaterialId>,
    /// The materials that triangles and spheres name.
    pub materials: Vec<Material>,
    /// The images that the materials' textures name.
    pub images: Vec<TextureImage>,
    /// The lights that the file or the code gave; may be empty.
    pub lights: Vec<Light>,
    /// The cameras that the file or the code gave; may be empty. The first is the one to use.
    pub cameras: Vec<Camera>,
    /// The direction that is up, unit length, where the file, its format or the code says so.
    pub up: Option<Vec3>,
    /// What rays see that hit nothing.
    pub background: Background,
    /// The panorama around the scene, in place of the background.
    pub environment: Option<Environment>,
    /// What was left out or mended while loading, a line each, for the user to read.
    pub warnings: Vec<String>,
}

/// What rays see that hit nothing: a colour that blends from the horizon up and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Background {
    /// Straight up.
    pub zenith: Rgb,
    /// At the horizon.
    pub horizon: Rgb,
    /// Straight down.
    pub nadir: Rgb,
}

impl Default for Background {
    /// A quiet studio backdrop: light at the horizon, a little bluer above, grey below.
    fn default() -> Self {
        Self {
            zenith: Rgb::new(0.25, 0.33, 0.45),
            horizon: Rgb::new(0.70, 0.74, 0.78),
            nadir: Rgb::new(0.22, 0.22, 0.23),
        }
    }
}

impl Background {
    /// The colour in a direction that rises by `rise` in its length of one: 1 is straight up, 0 level, -1 straight down.
    #[inline(always)]
    pub fn color(&self, rise: f32) -> Rgb {
        let (end, height) = if rise >= 0.0 { (self.zenith, rise) } else { (self.nadir, -rise) };
        // The square root widens the change near the horizon, as a real sky does.
        let blend = height.min(1.0).sqrt();
        (1.0 - blend) * self.horizon + blend * end
    }
}

impl Scene {
    /// The box around everything; empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        let triangles = &self.mesh.triangles;
        let own = match self.instances.is_empty() {
            true => triangles.total_bounds(),
            false => {
                MeshPart::new(triangles, 0..self.instances.own_triangles(triangles)).total_bounds()
            }
        };
        let instances = self.instances.bounds(triangles).into_iter();
        instances.fold(own.union(self.spheres.total_bounds()), |all, one| all.union(one))
    }
}
