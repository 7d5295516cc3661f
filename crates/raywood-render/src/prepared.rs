//! A scene made ready for rays: one structure over all its surfaces, and its materials in the form that shading reads.

use std::ops::ControlFlow;

use raywood::{Aabb, BuildError, BuildOptions, Geometry, Joined, SimdLevel, Spheres};
use raywood::{Structure, StructureKind, TriangleMesh, Vec3};
use raywood_scene::{Axes, Material, MaterialId, Pattern, Rgb, Scene};

use crate::few_boxes::few_boxes;

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
        let materials: Vec<_> = scene
            .materials
            .iter()
            .chain([&Material::default()])
            .map(SurfaceMaterial::new)
            .collect();
        let mut prepared = Self {
            scene,
            structure,
            bounds: scene.bounds(),
            materials,
            triangle_count: scene.mesh.triangles.len() as u32,
            axes: scene.axes(),
            transmissive_bounds: Vec::new(),
        };
        prepared.transmissive_bounds = prepared.find_transmissive_bounds();
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

    /// Boxes outside of which no surface lets light through: empty if none does anywhere.
    pub(crate) fn transmissive_bounds(&self) -> &[Aabb] {
        &self.transmissive_bounds
    }

    /// A few boxes around all primitives that let light through.
    fn find_transmissive_bounds(&self) -> Vec<Aabb> {
        if !self.materials.iter().any(|material| material.transmissive) {
            return Vec::new();
        }
        let geometry = self.structure.geometry();
        let transmissive =
            |primitive: &u32| self.materials[self.material_index(*primitive)].transmissive;
        let primitives = (0..geometry.len() as u32).filter(transmissive);
        few_boxes(primitives.map(|primitive| geometry.bounds(primitive)).collect())
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
}

impl SurfaceMaterial {
    fn new(material: &Material) -> Self {
        let finite_or = |x: f32, other: f32| if x.is_finite() { x } else { other };
        let positive = |color: Rgb| Rgb::from(color.to_array().map(|x| finite_or(x, 0.0).max(0.0)));
        let share = |color: Rgb| positive(color).min(Rgb::ONE);

        let transmission = share(material.transmission);
        let transmissive = transmission.max_element() > 0.0;
        let mirror = if transmissive { Rgb::ZERO } else { share(material.mirror) };
        let specular = positive(material.specular);
        let ior = finite_or(material.ior, 1.0);
        Self {
            diffuse: positive(material.diffuse),
            pattern: material.pattern,
            specular,
            shininess: finite_or(material.shininess, 50.0).max(0.0),
            mirror,
            transmission,
            ior: if ior > 0.0 { ior } else { 1.0 },
            absorption: positive(material.absorption),
            emission: positive(material.emission),
            transmissive,
            mirrors: mirror.max_element() > 0.0,
            shiny: specular.max_element() > 0.0,
        }
    }
}
