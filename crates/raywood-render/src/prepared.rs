//! A scene made ready for rays: one structure over all its surfaces, and its materials in the form that shading reads.

use std::ops::{ControlFlow, Range};

use raywood::{Aabb, BuildOptions, Geometry, Hit, Joined, SimdLevel, Spheres};
use raywood::{Structure, StructureKind, StructureStats, TriangleMesh, Vec3};
use raywood_scene::{Axes, Environment, Material, MaterialId, Rgb, Scene};

use crate::few_boxes::few_boxes;
use crate::instanced::{Instanced, Placed};
use crate::light_sampling::to_angles;
use crate::prepare_error::PrepareError;
use crate::surface_material::SurfaceMaterial;
use crate::textured::TexturedMaterial;
use crate::tracer::Tracer;

/// All surfaces of a scene: first its triangles, then its spheres.
pub type Surfaces<'a> = Joined<&'a TriangleMesh, &'a Spheres>;

/// A scene made ready for rays. Borrows the scene, which therefore cannot change meanwhile.
pub struct PreparedScene<'a> {
    scene: &'a Scene,
    tracer: Tracer<'a>,
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
    pub fn new(scene: &'a Scene) -> Result<Self, PrepareError> {
        Self::with_structure(scene, StructureKind::default())
    }

    /// Builds a structure of the given kind over the scene's surfaces, on the threads of the current rayon pool. The picture does not
    /// depend on the kind. Of a scene with instances each object gets one, and there is a tree over the instances: only [`StructureKind::BvhWide`] can that.
    ///
    /// A surface whose material number does not exist gets the default material.
    ///
    /// # Errors
    ///
    /// The structure cannot be built, or not over instances.
    pub fn with_structure(scene: &'a Scene, kind: StructureKind) -> Result<Self, PrepareError> {
        Self::build_watched(scene, kind, &BuildOptions::default(), |_| ControlFlow::Continue(()))
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
    ) -> Result<Self, PrepareError> {
        if !scene.instances.is_empty() {
            if kind != StructureKind::BvhWide {
                return Err(PrepareError::Kind { kind, visible: scene.visible_triangles() });
            }
            let instanced = Instanced::build(scene, options, watcher)?;
            return Ok(Self::with_tracer(scene, Tracer::Instances(instanced)));
        }
        let structure = Structure::build_watched(kind, Self::surfaces(scene), options, watcher)?;
        Ok(Self::from_structure(scene, structure))
    }

    /// All surfaces of a scene without instances, for a structure over them.
    pub fn surfaces(scene: &'a Scene) -> Surfaces<'a> {
        Joined { first: &scene.mesh.triangles, second: &scene.spheres }
    }

    /// Takes a structure over the scene's [surfaces](Self::surfaces) that is already there. For scenes without instances.
    pub fn from_structure(scene: &'a Scene, structure: Structure<Surfaces<'a>>) -> Self {
        Self::with_tracer(scene, Tracer::Surfaces(structure))
    }

    fn with_tracer(scene: &'a Scene, tracer: Tracer<'a>) -> Self {
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
            tracer,
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
        match self.environment() {
            None => self.scene.background.color(direction.dot(self.axes.up)),
            Some(panorama) => in_panorama(panorama, self.axes.to_local(direction)),
        }
    }

    /// The structure over the scene's surfaces; `None` if it has instances, for which there is no single one.
    pub fn structure(&self) -> Option<&Structure<Surfaces<'a>>> {
        match &self.tracer {
            Tracer::Surfaces(structure) => Some(structure),
            Tracer::Instances(_) => None,
        }
    }

    /// What rays are sent through.
    #[inline(always)]
    pub(crate) fn tracer(&self) -> &Tracer<'a> {
        &self.tracer
    }

    /// Counts, memory and quality of the structure. Of a scene with instances nodes, leaves and memory of all trees together, and the depth of the deepest below the one over
    /// instances; levels and quality are those of no single tree and left out. O(size of the structure).
    pub fn stats(&self) -> StructureStats {
        match &self.tracer {
            Tracer::Surfaces(structure) => structure.stats(),
            Tracer::Instances(instanced) => instanced.stats(),
        }
    }

    /// The vector instructions that trace the scene; `None` where none are used.
    pub fn simd_level(&self) -> Option<SimdLevel> {
        self.tracer.simd_level()
    }

    /// Has other vector instructions trace the structure: see [`Structure::set_simd_level`]. Those of objects stay as they were when these were built.
    pub fn set_simd_level(&mut self, level: SimdLevel) {
        match &mut self.tracer {
            Tracer::Surfaces(structure) => structure.set_simd_level(level),
            Tracer::Instances(instanced) => instanced.tree.set_simd_level(level),
        }
    }

    /// How surfaces of an instance are shaded; `None` where they stand in the world as they are.
    #[inline(always)]
    pub(crate) fn placed(&self, instance: u32) -> Option<&Placed> {
        match &self.tracer {
            Tracer::Surfaces(_) => None,
            Tracer::Instances(instanced) => instanced.placed(instance),
        }
    }

    /// Whether any of its instances moves. If none does, times do not matter.
    #[inline(always)]
    pub(crate) fn moves(&self) -> bool {
        self.tracer.moves()
    }

    /// Whether it has instances.
    #[inline(always)]
    pub(crate) fn has_instances(&self) -> bool {
        matches!(self.tracer, Tracer::Instances(_))
    }

    /// The number of the triangle that a primitive is, or else that of the sphere.
    #[inline(always)]
    pub(crate) fn which(&self, primitive: u32) -> Which {
        match primitive.checked_sub(self.triangle_count) {
            None => Which::Triangle(primitive),
            Some(sphere) => Which::Sphere(sphere),
        }
    }

    /// The material of an element.
    #[inline(always)]
    pub(crate) fn material_of(&self, element: impl Into<Element>) -> &SurfaceMaterial {
        &self.materials[self.material_index(element)]
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

    /// The number of the material of an element.
    #[inline(always)]
    pub(crate) fn material_index(&self, element: impl Into<Element>) -> usize {
        let Element { primitive, instance } = element.into();
        let last = self.materials.len() - 1;
        if let Some(id) = self.placed(instance).and_then(|placed| placed.material) {
            return (id as usize).min(last);
        }
        let id = match self.which(primitive) {
            Which::Triangle(triangle) => self.scene.mesh.materials.get(triangle as usize),
            Which::Sphere(sphere) => self.scene.sphere_materials.get(sphere as usize),
        };
        id.map_or(last, |&id: &MaterialId| (id as usize).min(last))
    }

    /// Everything that is to be seen: the elements of what stands in the world, then those of each instance.
    pub(crate) fn elements(&self) -> impl Iterator<Item = Element> + '_ {
        let Scene { mesh, instances, spheres, .. } = self.scene;
        let in_world =
            |primitives: Range<u32>| primitives.map(|primitive| Element { primitive, instance: 0 });
        let own = in_world(0..instances.own_triangles(&mesh.triangles));
        let balls = in_world(self.triangle_count..self.triangle_count + spheres.len() as u32);
        let objects: Vec<_> = instances.objects().collect();
        let placed = (1..).zip(instances.placed()).flat_map(move |(instance, placed)| {
            let triangles = objects[placed.object as usize].clone();
            triangles.map(move |primitive| Element { primitive, instance })
        });
        own.chain(balls).chain(placed)
    }

    /// The corners of a triangle at a time, in the world.
    #[inline]
    pub(crate) fn corners(&self, triangle: u32, instance: u32, time: f32) -> [Vec3; 3] {
        let corners = self.scene.mesh.triangles.corners(triangle);
        match self.placed(instance) {
            None => corners,
            Some(placed) => {
                let way = placed.way(time);
                corners.map(|corner| way.to_world.point(corner))
            }
        }
    }

    /// The light that a material sends out, by its [number](Self::material_index), in the mean over its texture.
    pub(crate) fn mean_emission(&self, index: u32) -> Rgb {
        match self.textured_material(index) {
            Some(textured) => textured.mean_emission().max(Rgb::ZERO),
            None => self.material(index).emission,
        }
    }

    /// Puts a panorama around the scene, in place of its own panorama or background; `None` leaves it these.
    pub fn set_environment(&mut self, environment: Option<Environment>) {
        self.environment = environment;
    }

    /// The panorama that was [put around](Self::set_environment) the scene in place of its own.
    pub fn other_environment(&self) -> Option<&Environment> {
        self.environment.as_ref()
    }

    /// The panorama around the scene, if there is one.
    #[inline(always)]
    pub(crate) fn environment(&self) -> Option<&Environment> {
        self.environment.as_ref().or(self.scene.environment.as_ref())
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
        let wanted = |element: &Element| is_wanted(self.material_of(*element));
        let boxes = match self.has_instances() {
            false => {
                let surfaces = Self::surfaces(self.scene);
                let elements = self.elements().filter(wanted);
                elements.map(|element| surfaces.bounds(element.primitive)).collect()
            }
            true => self.instanced_bounds(is_wanted),
        };
        // More boxes than this cost a shadow ray more than they save; holes are often many small things all over the place.
        let has_holes = self.materials.iter().any(|material| material.perforated);
        let most = if has_holes { 32 } else { 8 };
        few_boxes(boxes, most)
    }

    /// The same of a scene with instances, before there are few: a box for each instance.
    fn instanced_bounds(&self, is_wanted: impl Fn(&SurfaceMaterial) -> bool) -> Vec<Aabb> {
        let Scene { mesh, instances, .. } = self.scene;
        let surfaces = Self::surfaces(self.scene);
        let wanted = |element: &Element| is_wanted(self.material_of(*element));
        let in_world = self.elements().take_while(|element| element.instance == 0).filter(wanted);
        let mut boxes: Vec<_> =
            in_world.map(|element| surfaces.bounds(element.primitive)).collect();

        // Each object once, unless an instance has a material for all of it.
        let around = |range: Range<u32>| {
            let elements = range.map(|primitive| Element { primitive, instance: 0 });
            let bounds = elements.filter(wanted).map(|element| surfaces.bounds(element.primitive));
            bounds.fold(Aabb::EMPTY, |all, one| all.union(one))
        };
        let parts: Vec<_> = instances.objects().map(around).collect();
        let whole = instances.object_bounds(&mesh.triangles);
        for placed in instances.placed() {
            let object = placed.object as usize;
            let bounds = match placed.material {
                None => parts[object],
                Some(id) if is_wanted(self.material(id.min(self.material_count() - 1))) => {
                    whole[object]
                }
                Some(_) => Aabb::EMPTY,
            };
            if !bounds.is_empty() {
                boxes.push(placed.bounds(&bounds));
            }
        }
        boxes
    }
}

/// What a panorama shows in a direction across, along and up. Not inlined, so that shading without one stays small.
#[inline(never)]
fn in_panorama(panorama: &Environment, direction: Vec3) -> Rgb {
    let [down, turn] = to_angles(direction);
    panorama.light(turn, down)
}

/// A primitive of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Element {
    pub(crate) primitive: u32,
    /// 0 for what stands in the world as it is.
    pub(crate) instance: u32,
}

impl From<&Hit> for Element {
    #[inline(always)]
    fn from(hit: &Hit) -> Self {
        Self { primitive: hit.primitive, instance: hit.instance }
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
