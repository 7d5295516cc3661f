//! A scene made ready for rays: one structure over all its surfaces, and its materials in the form that shading reads.

use std::ops::ControlFlow;

use raywood::{Aabb, BuildError, BuildOptions, Geometry, Joined, SimdLevel, Spheres};
use raywood::{Structure, StructureKind, TriangleMesh, Vec3};
use raywood_scene::{Axes, Material, MaterialId, Pattern, Rgb, Scene};

use crate::few_boxes::few_boxes;
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
        self.scene.background.color(direction.dot(self.axes.up))
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

/// Which kind of surface a primitive is, and its number among those.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Which {
    /// A triangle of the mesh.
    Triangle(u32),
    /// An analytic sphere.
    Sphere(u32),
}

/// What shading reads of a [`Material`]: the same numbers, made safe (in range, not NaN), with the questions asked at
/// every hit already answered.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceMaterial {
    pub(crate) diffuse: Rgb,
    pub(crate) pattern: Pattern,
    pub(crate) specular: Rgb,
    pub(crate) shininess: f32,
    pub(crate) mirror: Rgb,
    /// The share mirrored at grazing angles.
    pub(crate) grazing: f32,
    pub(crate) transmission: Rgb,
    pub(crate) ior: f32,
    pub(crate) absorption: Vec3,
    pub(crate) emission: Rgb,
    /// Whether any light gets through.
    pub(crate) transmissive: bool,
    /// Whether the surface mirrors as `mirror` says.
    pub(crate) mirrors: bool,
    /// Whether lights leave a highlight.
    pub(crate) shiny: bool,
    /// Whether there may be points where not all of the surface is there.
    pub(crate) perforated: bool,
    /// How much of the surface is there; the rest lets rays straight on.
    pub(crate) opacity: f32,
    /// How much of the ambient light arrives.
    pub(crate) ambient: f32,
}

impl SurfaceMaterial {
    fn new(material: &Material) -> Self {
        let mut safe = Self {
            diffuse: material.diffuse,
            pattern: material.pattern,
            specular: material.specular,
            shininess: material.shininess,
            mirror: material.mirror,
            grazing: 1.0,
            transmission: material.transmission,
            ior: material.ior,
            absorption: positive(material.absorption),
            emission: positive(material.emission),
            transmissive: false,
            mirrors: false,
            shiny: false,
            perforated: false,
            opacity: 1.0,
            ambient: 1.0,
        };
        safe.make_safe();
        safe
    }

    /// Brings numbers into their range and answers the questions that follow from them.
    #[inline(always)]
    pub(crate) fn make_safe(&mut self) {
        let share = |color: Rgb| positive(color).min(Rgb::ONE);
        self.diffuse = positive(self.diffuse);
        self.transmission = share(self.transmission);
        self.transmissive = self.transmission.max_element() > 0.0;
        self.mirror = if self.transmissive { Rgb::ZERO } else { share(self.mirror) };
        self.mirrors = self.mirror.max_element() > 0.0;
        self.specular = positive(self.specular);
        self.shiny = self.specular.max_element() > 0.0;
        self.shininess = finite_or(self.shininess, 50.0).max(0.0);
        let ior = finite_or(self.ior, 1.0);
        self.ior = if ior > 0.0 { ior } else { 1.0 };
    }
}

#[inline(always)]
fn finite_or(x: f32, other: f32) -> f32 {
    if x.is_finite() { x } else { other }
}

#[inline(always)]
fn positive(color: Rgb) -> Rgb {
    let channel = |x: f32| finite_or(x, 0.0).max(0.0);
    Rgb::new(channel(color.x), channel(color.y), channel(color.z))
}
