//! The scene in the making: what models show is put into the world, or kept as objects that instances show.

use std::ops::Range;
use std::rc::Rc;

use raywood::{Spheres, Transform, TransformError, Vec3};

use crate::instances::is_worth_sharing;
use crate::mesh_join::MeshJoin;
use crate::{
    Instance, Instances, Light, LightKind, Material, MaterialId, Rgb, Scene, TextureImage,
};

/// The most triangles that are kept in memory, copies included, as many as glTF files may ask for.
const MOST_TRIANGLES: usize = 1 << 27;
/// The most instances, and the most spheres.
const MOST_PLACES: usize = 1 << 22;
/// The most materials, and the most lights and cameras.
const MOST_SMALL: usize = 1 << 18;
/// The most texels of all images together.
const MOST_TEXELS: u64 = 1 << 29;

/// The scene in the making.
#[derive(Default)]
pub(super) struct Assembly {
    /// What is not triangles.
    pub(super) scene: Scene,
    spheres: Vec<(Vec3, f32)>,
    world: MeshJoin,
    objects: Vec<Object>,
    object_triangles: usize,
    placed: Vec<Instance>,
    texels: u64,
}

/// Triangles of a mesh in a space of their own.
struct Object {
    scene: Rc<Scene>,
    triangles: Range<u32>,
    materials: Numbering,
}

/// The numbers in the whole scene of the materials of a model.
#[derive(Clone, Copy)]
struct Numbering {
    first: u32,
    count: u32,
}

impl Numbering {
    /// That of a material of the model; of one that the model has not, the first.
    fn of(self, own: Option<MaterialId>) -> MaterialId {
        self.first + own.filter(|id| *id < self.count).unwrap_or(0)
    }
}

/// A place where a model stands.
#[derive(Clone, Debug)]
pub(super) struct Standing {
    pub(super) transform: Transform,
    /// Where it is at time 1, if it moves.
    pub(super) later: Option<Transform>,
    /// In place of the model's own materials.
    pub(super) material: Option<MaterialId>,
    pub(super) tint: Rgb,
}

impl Standing {
    /// Where something is, at both times, that stands or moves in what stands here.
    pub(super) fn moved(
        &self,
        (first, later): (&Transform, Option<&Transform>),
    ) -> (Transform, Option<Transform>) {
        let moves = later.is_some() || self.later.is_some();
        let (own, there) = (later.unwrap_or(first), self.later.as_ref().unwrap_or(&self.transform));
        (first.then(&self.transform), moves.then(|| own.then(there)))
    }
}

/// A model, ready to be shown.
pub(super) struct Model {
    pub(super) scene: Rc<Scene>,
    /// Its materials, changed as the scene file says. The images of their textures have their numbers in the whole scene.
    pub(super) materials: Vec<Material>,
    pub(super) places: Vec<Standing>,
    pub(super) takes_lights: bool,
}

/// Complains if there would be more than may be.
fn within(have: usize, more: usize, most: usize, what: &str) -> Result<(), String> {
    match have.saturating_add(more) {
        sum if sum > most => {
            Err(format!("the scene would have {sum} {what}, expected at most {most}"))
        }
        _ => Ok(()),
    }
}

impl Assembly {
    /// Adds a material and gives its number.
    pub(super) fn add_material(&mut self, material: Material) -> Result<MaterialId, String> {
        within(self.scene.materials.len(), 1, MOST_SMALL, "materials")?;
        self.scene.materials.push(material);
        Ok(self.scene.materials.len() as u32 - 1)
    }

    /// Adds the images of a model; what its textures' image numbers grow by.
    pub(super) fn add_images(&mut self, model: &Scene) -> Result<u32, String> {
        let texels = |image: &TextureImage| u64::from(image.width()) * u64::from(image.height());
        self.texels += model.images.iter().map(texels).sum::<u64>();
        if self.texels > MOST_TEXELS {
            return Err(format!(
                "the images of all models have {} texels, expected at most {MOST_TEXELS}",
                self.texels
            ));
        }
        let first = self.scene.images.len() as u32;
        self.scene.images.extend_from_slice(&model.images);
        Ok(first)
    }

    /// Adds a sphere.
    pub(super) fn add_sphere(
        &mut self,
        sphere: (Vec3, f32),
        material: MaterialId,
    ) -> Result<(), String> {
        within(self.spheres.len(), 1, MOST_PLACES, "spheres")?;
        if Spheres::new(vec![sphere]).is_err() {
            return Err("the sphere reaches beyond the largest number".to_owned());
        }
        self.spheres.push(sphere);
        self.scene.sphere_materials.push(material);
        Ok(())
    }

    /// Shows a model at its places.
    pub(super) fn show(&mut self, model: Model) -> Result<(), String> {
        let Model { scene, materials, places, takes_lights } = model;
        within(self.scene.materials.len(), materials.len(), MOST_SMALL, "materials")?;
        let numbering =
            Numbering { first: self.scene.materials.len() as u32, count: materials.len() as u32 };
        self.scene.materials.extend(materials);

        self.show_world(&scene, &places, numbering)?;
        self.show_instances(&scene, &places, numbering)?;
        self.show_spheres(&scene, &places, numbering)?;
        if let [place] = &places[..] {
            self.take_view(&scene, &place.transform, takes_lights)?;
        }
        Ok(())
    }

    /// What stands in the model's world: an object, if that pays or it moves, else copies.
    fn show_world(
        &mut self,
        scene: &Rc<Scene>,
        places: &[Standing],
        materials: Numbering,
    ) -> Result<(), String> {
        let count = scene.instances.own_triangles(&scene.mesh.triangles);
        let moves = places.iter().any(|place| place.later.is_some());
        if is_worth_sharing(u64::from(count), places.len() as u64) || (moves && count > 0) {
            let object = self.add_object(scene, 0..count, materials)?;
            return self.place(Instance::new(object, Transform::IDENTITY), places);
        }
        let copies = (count as usize).saturating_mul(places.len());
        within(self.triangle_count(), copies, MOST_TRIANGLES, "triangles")?;
        for Standing { transform, material, tint, .. } in places {
            self.world.add(&scene.mesh, 0..count, (transform, *tint), |own| {
                Some(material.unwrap_or_else(|| materials.of(own)))
            });
        }
        Ok(())
    }

    /// What the model shows by instances itself.
    fn show_instances(
        &mut self,
        scene: &Rc<Scene>,
        places: &[Standing],
        materials: Numbering,
    ) -> Result<(), String> {
        let first = self.objects.len() as u32;
        for triangles in scene.instances.objects() {
            self.add_object(scene, triangles, materials)?;
        }
        for instance in scene.instances.placed() {
            let material = instance.material.map(|id| materials.of(Some(id)));
            let object = first + instance.object;
            self.place(Instance { object, material, ..instance.clone() }, places)?;
        }
        Ok(())
    }

    fn triangle_count(&self) -> usize {
        self.world.triangle_count() + self.object_triangles
    }

    fn add_object(
        &mut self,
        scene: &Rc<Scene>,
        triangles: Range<u32>,
        materials: Numbering,
    ) -> Result<u32, String> {
        within(self.triangle_count(), triangles.len(), MOST_TRIANGLES, "triangles")?;
        self.object_triangles += triangles.len();
        self.objects.push(Object { scene: Rc::clone(scene), triangles, materials });
        Ok(self.objects.len() as u32 - 1)
    }

    /// Instances of an object at all places of its model, in which it stands somewhere itself.
    fn place(&mut self, in_model: Instance, places: &[Standing]) -> Result<(), String> {
        let Instance { object, transform, later, material, tint } = in_model;
        within(self.placed.len(), places.len(), MOST_PLACES, "instances")?;
        for place in places {
            let (transform, later) = place.moved((&transform, later.as_ref()));
            let bad = |error: TransformError| format!("the place of an instance {error}");
            match &later {
                None => transform.check().map_err(bad)?,
                Some(later) => transform.check_motion(later).map_err(bad)?,
            }
            let (material, tint) = (place.material.or(material), tint * place.tint);
            self.placed.push(Instance { object, transform, later, material, tint });
        }
        Ok(())
    }

    /// Spheres are copied.
    fn show_spheres(
        &mut self,
        scene: &Scene,
        places: &[Standing],
        materials: Numbering,
    ) -> Result<(), String> {
        let spheres = scene.spheres.as_slice();
        let copies = spheres.len().saturating_mul(places.len());
        within(self.spheres.len(), copies, MOST_PLACES, "spheres")?;
        if copies == 0 {
            return Ok(());
        }
        if places.iter().any(|place| place.later.is_some()) {
            return Err("the model has spheres, which cannot move: expected no `to`".to_owned());
        }
        for Standing { transform, material, .. } in places {
            let factor = even_scale(transform).ok_or(
                "the model has spheres, which stay spheres only where it is scaled alike along all axes",
            )?;
            for (&(center, radius), own) in spheres.iter().zip(&scene.sphere_materials) {
                self.spheres.push((transform.point(center), factor * radius));
                let material = material.unwrap_or_else(|| materials.of(Some(*own)));
                self.scene.sphere_materials.push(material);
            }
        }
        Ok(())
    }

    /// Lights and cameras of a model that stands in one place.
    fn take_view(
        &mut self,
        scene: &Scene,
        to_world: &Transform,
        takes_lights: bool,
    ) -> Result<(), String> {
        within(self.scene.cameras.len(), scene.cameras.len(), MOST_SMALL, "cameras")?;
        within(self.scene.lights.len(), scene.lights.len(), MOST_SMALL, "lights")?;
        if *to_world == Transform::IDENTITY {
            // To the bit.
            self.scene.cameras.extend_from_slice(&scene.cameras);
            if takes_lights {
                self.scene.lights.extend_from_slice(&scene.lights);
            }
            return Ok(());
        }
        for camera in &scene.cameras {
            let mut camera = camera.clone();
            camera.eye = to_world.point(camera.eye);
            camera.target = to_world.point(camera.target);
            camera.up = to_world.vector(camera.up).normalize_or_zero();
            self.scene.cameras.push(camera);
        }
        if takes_lights {
            self.scene.lights.extend(scene.lights.iter().map(|light| moved(light, to_world)));
        }
        Ok(())
    }

    /// The scene.
    pub(super) fn finish(self) -> Result<Scene, String> {
        let Self { mut scene, spheres, world: mut all, objects, placed, .. } = self;
        let mut starts = Vec::new();
        for Object { scene: model, triangles, materials } in objects {
            starts.push(all.triangle_count() as u32);
            let to_itself = (&Transform::IDENTITY, Rgb::ONE);
            all.add(&model.mesh, triangles, to_itself, |own| Some(materials.of(own)));
        }
        let end = all.triangle_count() as u32;
        scene.mesh = all.finish().map_err(|error| error.to_string())?;
        scene.instances = Instances::new(starts, end, placed).map_err(|error| error.to_string())?;
        scene.spheres = Spheres::new(spheres).map_err(|error| error.to_string())?;
        Ok(scene)
    }
}

/// By what a transform scales, if it does so alike in all directions.
fn even_scale(transform: &Transform) -> Option<f32> {
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| transform.vector(axis));
    let factor = x.length();
    let is_even = |length: f32| (length - factor).abs() <= 1e-4 * factor;
    let is_square = |a: Vec3, b: Vec3| a.dot(b).abs() <= 1e-4 * factor * factor;
    let even = is_even(y.length()) && is_even(z.length());
    (even && is_square(x, y) && is_square(y, z) && is_square(z, x)).then_some(factor)
}

/// A light of a model that stands elsewhere. It is as bright on the surfaces of the model as it was: as these are further away from it where the model is larger, it is stronger.
fn moved(light: &Light, to_world: &Transform) -> Light {
    let mut light = light.clone();
    let direction_there = |direction: &mut Vec3| {
        *direction = to_world.vector(*direction).normalize_or_zero();
    };
    match &mut light.kind {
        LightKind::Point { position } => *position = to_world.point(*position),
        LightKind::Spot { position, direction, .. } => {
            *position = to_world.point(*position);
            direction_there(direction);
        }
        LightKind::Directional { direction, .. } => direction_there(direction),
        LightKind::Ambient => {}
    }
    if matches!(light.kind, LightKind::Point { .. } | LightKind::Spot { .. }) {
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| to_world.vector(axis));
        let volume = x.dot(y.cross(z)).abs();
        light.intensity *= volume.cbrt().powi(2);
    }
    light
}
