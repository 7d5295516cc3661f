//! Scenes with instances, made ready for rays: a tree over trees.

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::sync::Arc;

use raywood::{Aabb, BoundsMargin, BuildOptions, Bvh, Hit, HitRules, Instance, MeshPart};
use raywood::{ObjectPoint, Ray, Spheres, StructureStats, Tlas, Traceable, Transform, Vec3};
use raywood_scene::{MaterialId, Rgb, Scene};

use crate::prepare_error::PrepareError;

/// What stands somewhere. Hits name primitives by their numbers among all of the scene's: first the triangles of its mesh, then its spheres.
pub(crate) struct Object<'a> {
    surfaces: ObjectSurfaces<'a>,
    /// The number of its first primitive.
    first: u32,
}

enum ObjectSurfaces<'a> {
    Triangles(Bvh<MeshPart<'a>>),
    Spheres(Bvh<&'a Spheres>),
}

impl Object<'_> {
    fn traceable(&self) -> &dyn Traceable {
        match &self.surfaces {
            ObjectSurfaces::Triangles(tree) => tree,
            ObjectSurfaces::Spheres(tree) => tree,
        }
    }

    /// A hit with the primitive's number in the scene.
    #[inline(always)]
    fn in_scene(&self, hit: Hit) -> Hit {
        Hit { primitive: self.first + hit.primitive, ..hit }
    }

    fn stats(&self) -> StructureStats {
        match &self.surfaces {
            ObjectSurfaces::Triangles(tree) => tree.stats(),
            ObjectSurfaces::Spheres(tree) => tree.stats(),
        }
    }
}

impl Traceable for Object<'_> {
    fn bounds(&self) -> Aabb {
        self.traceable().bounds()
    }

    fn bounds_margin(&self) -> BoundsMargin {
        self.traceable().bounds_margin()
    }

    #[inline]
    fn intersect_within(&self, ray: &Ray, limit: f32, mask: u32) -> Option<Hit> {
        let hit = match &self.surfaces {
            ObjectSurfaces::Triangles(tree) => tree.intersect_within(ray, limit, mask),
            ObjectSurfaces::Spheres(tree) => tree.intersect_within(ray, limit, mask),
        };
        hit.map(|hit| self.in_scene(hit))
    }

    #[inline]
    fn occluded_within(&self, ray: &Ray, mask: u32) -> bool {
        match &self.surfaces {
            ObjectSurfaces::Triangles(tree) => tree.occluded_within(ray, mask),
            ObjectSurfaces::Spheres(tree) => tree.occluded_within(ray, mask),
        }
    }

    fn object_point(&self, ray: &Ray, hit: &Hit) -> ObjectPoint {
        let own = Hit { primitive: hit.primitive - self.first, ..*hit };
        self.traceable().object_point(ray, &own)
    }

    fn intersect_chosen(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        let mut accepts = |hit: &Hit| accepts(&self.in_scene(*hit));
        let hit = self.traceable().intersect_chosen(ray, limit, rules, &mut accepts);
        hit.map(|hit| self.in_scene(hit))
    }

    fn visit_hits(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        visit: &mut dyn FnMut(Hit) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        let mut visit = |hit| visit(self.in_scene(hit));
        self.traceable().visit_hits(ray, limit, rules, &mut visit)
    }

    fn intersect_many(&self, rays: &[Ray], mask: u32, hits: &mut [Option<Hit>]) {
        self.traceable().intersect_many(rays, mask, hits);
        for hit in hits {
            *hit = hit.map(|hit| self.in_scene(hit));
        }
    }

    fn occluded_many(&self, rays: &[Ray], mask: u32, occluded: &mut [bool]) {
        self.traceable().occluded_many(rays, mask, occluded);
    }
}

/// The trees of a scene with instances.
///
/// Hits tell instances apart: 0 is all triangles that stand in the world as they are, then come those of the scene, last all spheres.
pub(crate) struct Instanced<'a> {
    pub(crate) tree: Tlas<Object<'a>>,
    /// How surfaces of the scene's instances are shaded, in their order.
    placed: Vec<Placed>,
    /// The objects, each once.
    objects: Vec<Arc<Object<'a>>>,
}

/// How surfaces of an instance differ from those of its object.
pub(crate) struct Placed {
    /// Its way at time 0.
    way: Way,
    /// The transform at time 1, if it moves.
    later: Option<Transform>,
    pub(crate) material: Option<MaterialId>,
    pub(crate) tint: Rgb,
}

impl Placed {
    /// The way of its object into the world at a time.
    #[inline(always)]
    pub(crate) fn way(&self, time: f32) -> Cow<'_, Way> {
        match &self.later {
            None => Cow::Borrowed(&self.way),
            Some(later) => Cow::Owned(Way::new(self.way.to_world.blended(later, time))),
        }
    }

    /// Whether it moves.
    #[inline(always)]
    pub(crate) fn moves(&self) -> bool {
        self.later.is_some()
    }
}

/// The way of an object into the world.
#[derive(Clone)]
pub(crate) struct Way {
    pub(crate) to_world: Transform,
    /// What turns normals, up to their length.
    normals: Transform,
    pub(crate) mirrored: bool,
}

impl Way {
    fn new(to_world: Transform) -> Self {
        Self { to_world, normals: to_world.for_normals(), mirrored: to_world.mirrors() }
    }

    /// What becomes of a normal of any length; zero if it has none.
    #[inline]
    pub(crate) fn normal(&self, normal: Vec3) -> Vec3 {
        self.normals.vector(normal).normalize_or_zero()
    }
}

impl<'a> Instanced<'a> {
    /// Builds a tree over each object, and one over these. `watcher` is told how far that is.
    pub(crate) fn build(
        scene: &'a Scene,
        options: &BuildOptions,
        mut watcher: impl FnMut(f64) -> ControlFlow<()> + Send,
    ) -> Result<Self, PrepareError> {
        let triangles = &scene.mesh.triangles;
        let total = triangles.triangles().len().max(1) as f64;
        let mut tree_of = |part: std::ops::Range<u32>| {
            let (before, share) = (f64::from(part.start) / total, part.len() as f64 / total);
            let tree =
                Bvh::build_watched(MeshPart::new(triangles, part.clone()), options, |done| {
                    watcher(before + share * done)
                })?;
            let surfaces = ObjectSurfaces::Triangles(tree);
            Ok::<_, PrepareError>(Arc::new(Object { surfaces, first: part.start }))
        };

        let world = tree_of(0..scene.instances.own_triangles(triangles))?;
        let objects: Vec<_> = scene.instances.objects().map(tree_of).collect::<Result<_, _>>()?;
        let spheres = Bvh::build_with(&scene.spheres, options)?;
        let first = triangles.triangles().len() as u32;
        let spheres = Arc::new(Object { surfaces: ObjectSurfaces::Spheres(spheres), first });
        let all = objects.iter().chain([&world, &spheres]).cloned().collect();

        let mut instances = vec![Instance::new(world, Transform::IDENTITY)];
        instances.extend(scene.instances.placed().iter().map(|placed| {
            let object = Arc::clone(&objects[placed.object as usize]);
            Instance { later: placed.later, ..Instance::new(object, placed.transform) }
        }));
        instances.push(Instance::new(spheres, Transform::IDENTITY));
        let tree = Tlas::build_with(instances, options)?;
        let placed = scene.instances.placed().iter().map(|placed| Placed {
            way: Way::new(placed.transform),
            later: placed.later,
            material: placed.material,
            tint: placed.tint,
        });
        Ok(Self { placed: placed.collect(), tree, objects: all })
    }

    /// How surfaces of an instance are shaded, if otherwise than in their object.
    #[inline(always)]
    pub(crate) fn placed(&self, instance: u32) -> Option<&Placed> {
        self.placed.get((instance as usize).wrapping_sub(1))
    }

    /// What all trees have together.
    pub(crate) fn stats(&self) -> StructureStats {
        let mut all = StructureStats::default();
        all.bytes = self.tree.bytes();
        for object in &self.objects {
            let own = object.stats();
            all.primitives += own.primitives;
            all.references += own.references;
            all.nodes += own.nodes;
            all.leaves += own.leaves;
            all.empty_leaves += own.empty_leaves;
            all.bytes += own.bytes;
            all.depth = all.depth.max(own.depth);
            all.max_leaf_primitives = all.max_leaf_primitives.max(own.max_leaf_primitives);
        }
        let filled = all.leaves - all.empty_leaves;
        all.mean_leaf_primitives = all.references as f64 / filled.max(1) as f64;
        all
    }
}
