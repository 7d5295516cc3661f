//! A scene made ready for rays: one structure over all its surfaces, and its materials in the form that shading reads.

use std::ops::ControlFlow;

use raywood::{Aabb, BuildError, BuildOptions, Geometry, Joined, SimdLevel, Spheres};
use raywood::{Structure, StructureKind, TriangleMesh, Vec3};
use raywood_scene::{Axes, Environment, Material, MaterialId, Rgb, Scene};

use crate::few_boxes::few_boxes;
use crate::light_sampling::to_angles;
use crate::surface_material::SurfaceMaterial;
use crate::textured::TexturedMaterial;

/// All surfaces of a scene: first its triangles, then its spheres.
pub type Surfaces<'a> = Joined<&'a TriangleMesh, &'a Spheres>;

/// A scene made ready for rays. Borrows the scene, which therefore cannot change meanwhile.
pub struct PreparedScene<'a> {
    scene: &'a Scene,
    structure: Structure<Surfaces<'a>>,
    bounds: Aabb,
    materials: Vec<SurfaceMaterial>,
    triangle_count: u32,
    axes: Axes,
    transmissive_bounds: Vec<Aabb>,
    perforated_bounds: Vec<Aabb>,
    /// Of each material what its textures make of it.
    textured: Vec<Option<TexturedMaterial<'a>>>,
    is_textured: bool,
    environment: Option<Environment>,
}

impl<'a> PreparedScene<'a> {
    /// Builds the default structure over the scene's surfaces: see [`with_structure`](Self::with_structure).
    ///
    /// # Errors
    ///
    /// The structure cannot be built.
    pub fn new(scene: &'a Scene) -> Result<Self, BuildError> {
        Self::with_structure(scene, StructureKind::default())
    }

    /// Builds a structure of the given kind over the scene's surfaces, on the threads of the current rayon pool. The picture does not
    /// depend on the kind.
    ///
    /// A surface whose material number does not exist gets the default material.
    ///
    /// # Errors
    ///
    /// The structure cannot be built.
    pub fn with_structure(scene: &'a Scene, kind: StructureKind) -> Result<Self, BuildError> {
        let structure = Structure::build(kind, Self::surfaces(scene), &BuildOptions::default())?;
        Ok(Self::from_structure(scene, structure))
    }

    /// As [`with_structure`](Self::with_structure), built as the options say, while `watcher` is told how far the build is and may stop it: see
    /// [`Structure::build_watched`].
    ///
    /// # Errors
    ///
    /// The structure cannot be built, or the watcher stopped it.
    pub fn build_watched(
        scene: &'a Scene,
        kind: StructureKind,
        options: &BuildOptions,
        watcher: impl FnMut(f64) -> ControlFlow<()> + Send,
    ) -> Result<Self, BuildError> {
        let structure = Structure::build_watched(kind, Self::surfaces(scene), options, watcher)?;
        Ok(Self::from_structure(scene, structure))
    }

    /// All surfaces of a scene, for a structure over them.
    pub fn surfaces(scene: &'a Scene) -> Surfaces<'a> {
        Joined { first: &scene.mesh.triangles, second: &scene.spheres }
    }

    /// Takes a structure over the scene's [surfaces](Self::surfaces) that is already there.
    pub fn from_structure(scene: &'a Scene, structure: Structure<Surfaces<'a>>) -> Self {
        // The default comes last, for the surfaces without a material.
        let mut materials: Vec<_> = scene
            .materials
            .iter()
            .chain([&Material::default()])
            .map(SurfaceMaterial::new)
            .collect();
        let textured: Vec<_> =
            scene.materials.iter().map(|m| TexturedMaterial::new(m, &scene.images)).collect();
        for (material, textured) in materials.iter_mut().zip(&textured) {
            material.perforated = textured.as_ref().is_some_and(|t| t.is_perforated);
        }
        let is_textured = textured.iter().any(Option::is_some);
        let mut prepared = Self {
            scene,
            structure,
            bounds: scene.bounds(),
            materials,
            triangle_count: scene.mesh.triangles.len() as u32,
            axes: scene.axes(),
            transmissive_bounds: Vec::new(),
            perforated_bounds: Vec::new(),
            textured,
            is_textured,
            environment: None,
        };
        prepared.perforated_bounds = prepared.bounds_of(|material| material.perforated);
        prepared.transmissive_bounds =
            prepared.bounds_of(|material| material.transmissive | material.perforated);
        prepared
    }

    /// The scene as it was given.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// The box around all surfaces; empty if there are none.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Which way is up, and two level directions.
    pub fn axes(&self) -> &Axes {
        &self.axes
    }

    /// What a ray sees that hits nothing; its direction is of unit length.
    #[inline(always)]
    pub(crate) fn background(&self, direction: Vec3) -> Rgb {
        match &self.environment {
            None => self.scene.background.color(direction.dot(self.axes.up)),
            Some(panorama) => in_panorama(panorama, self.axes.to_local(direction)),
        }
    }

    /// The structure over the scene's surfaces.
    pub fn structure(&self) -> &Structure<Surfaces<'a>> {
        &self.structure
    }

    /// Has other vector instructions trace the structure: see [`Structure::set_simd_level`].
    pub fn set_simd_level(&mut self, level: SimdLevel) {
        self.structure.set_simd_level(level);
    }

    /// The number of the triangle that a primitive is, or else that of the sphere.
    #[inline(always)]
    pub(crate) fn which(&self, primitive: u32) -> Which {
        match primitive.checked_sub(self.triangle_count) {
            None => Which::Triangle(primitive),
            Some(sphere) => Which::Sphere(sphere),
        }
    }

    /// The material of a primitive.
    #[inline(always)]
    pub(crate) fn material_of(&self, primitive: u32) -> &SurfaceMaterial {
        &self.materials[self.material_index(primitive)]
    }

    /// A material by its [number](Self::material_index).
    #[inline(always)]
    pub(crate) fn material(&self, index: u32) -> &SurfaceMaterial {
        &self.materials[index as usize]
    }

    /// How many materials there are.
    #[inline(always)]
    pub(crate) fn material_count(&self) -> u32 {
        self.materials.len() as u32
    }

    /// The number of the material of a primitive.
    #[inline(always)]
    pub(crate) fn material_index(&self, primitive: u32) -> usize {
        let id = match self.which(primitive) {
            Which::Triangle(triangle) => self.scene.mesh.materials.get(triangle as usize),
            Which::Sphere(sphere) => self.scene.sphere_materials.get(sphere as usize),
        };
        let last = self.materials.len() - 1;
        id.map_or(last, |&id: &MaterialId| (id as usize).min(last))
    }

    /// How many primitives there are.
    pub(crate) fn primitive_count(&self) -> u32 {
        self.structure.geometry().len() as u32
    }

    /// The corners of a triangle of the mesh.
    #[inline]
    pub(crate) fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.scene.mesh.triangles.corners(triangle)
    }

    /// The light that a material sends out, by its [number](Self::material_index), in the mean over its texture.
    pub(crate) fn mean_emission(&self, index: u32) -> Rgb {
        match self.textured_material(index) {
            Some(textured) => textured.mean_emission().max(Rgb::ZERO),
            None => self.material(index).emission,
        }
    }

    /// Puts a panorama around the scene, in place of its background, or takes it away.
    pub fn set_environment(&mut self, environment: Option<Environment>) {
        self.environment = environment;
    }

    /// The panorama around the scene, if there is one.
    pub(crate) fn environment(&self) -> Option<&Environment> {
        self.environment.as_ref()
    }

    /// Whether any surface may be textured.
    #[inline(always)]
    pub(crate) fn is_textured(&self) -> bool {
        self.is_textured
    }

    /// What textures make of a material, by its [number](Self::material_index); nothing if it has none.
    #[inline(always)]
    pub(crate) fn textured_material(&self, index: u32) -> Option<&TexturedMaterial<'a>> {
        self.textured.get(index as usize)?.as_ref()
    }

    /// Boxes outside of which no surface lets light through: empty if none does anywhere. With `opaque` only holes do.
    pub(crate) fn transmissive_bounds(&self, opaque: bool) -> &[Aabb] {
        if opaque { &self.perforated_bounds } else { &self.transmissive_bounds }
    }

    /// A few boxes around all primitives of some materials.
    fn bounds_of(&self, is_wanted: impl Fn(&SurfaceMaterial) -> bool) -> Vec<Aabb> {
        if !self.materials.iter().any(&is_wanted) {
            return Vec::new();
        }
        let geometry = self.structure.geometry();
        let wanted = |primitive: &u32| is_wanted(&self.materials[self.material_index(*primitive)]);
        let primitives = (0..geometry.len() as u32).filter(wanted);
        // More boxes than this cost a shadow ray more than they save; holes are often many small things all over the place.
        let has_holes = self.materials.iter().any(|material| material.perforated);
        let most = if has_holes { 32 } else { 8 };
        few_boxes(primitives.map(|primitive| geometry.bounds(primitive)).collect(), most)
    }
}

/// What a panorama shows in a direction across, along and up. Not inlined, so that shading without one stays small.
#[inline(never)]
fn in_panorama(panorama: &Environment, direction: Vec3) -> Rgb {
    let [down, turn] = to_angles(direction);
    panorama.light(turn, down)
}

/// Which kind of surface a primitive is, and its number among those.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Which {
    /// A triangle of the mesh.
    Triangle(u32),
    /// An analytic sphere.
    Sphere(u32),
}
