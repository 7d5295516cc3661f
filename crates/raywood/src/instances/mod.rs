//! Scenes of instances: a tree over trees, each of which stands at many places.

mod change;
mod chosen;
mod closest_point;
mod crossings;
mod error;
mod frustum;
mod many;
mod motion;
mod overlap;
mod pairs;
mod place;
mod point;
mod solid;
mod space;
mod sphere_cast;
mod times;
mod towards;
mod traceable;
mod transform;
mod view;
mod walk;

use std::ops::ControlFlow;
use std::sync::Arc;

pub use error::InstanceError;
pub use frustum::FrustumSearch;
pub use overlap::SceneRegion;
pub use pairs::PairSearch;
use place::Placement;
pub use point::ObjectPoint;
pub use solid::{Enclosure, InsideSearch, SceneSolid};
pub use space::{Searchable, SpaceSearch};
pub use sphere_cast::SweptSearch;
pub use traceable::{BoundsMargin, Traceable};
pub use transform::{Transform, TransformError};
pub use walk::WalkSearch;

use crate::structures::wide::top::TopTree;
use crate::{
    Aabb, BuildOptions, Bvh, Hit, HitColumns, HitRules, Ray, SimdLevel, SurfacePoint, TriangleMesh,
    Vec3, parallel,
};

/// An object at a place.
#[derive(Debug)]
pub struct Instance<B> {
    /// What stands there; shared with other instances.
    pub object: Arc<B>,
    /// Where: from the object's space into the scene's. Of what moves at time 0.
    pub transform: Transform,
    /// Where it has moved to at time 1, if it moves. Between, the two matrices are [blended](Transform::blended) linearly: each point moves on a straight line at an even pace, and what turns
    /// shrinks a little on the way, halfway by the cosine of half the angle, so large turns take shorter times or more instances. No blend may [flatten](Transform::check_motion) the object, as one
    /// of half a turn does.
    ///
    /// Rays that say nothing of a time see time 0, as do closest points, overlaps and all other questions that are not asked at a [time](crate::QueryOptions::at).
    pub later: Option<Transform>,
    /// The groups it belongs to, a bit each: a query with a mask sees it if they have a bit in common. Of none, nobody sees it.
    pub mask: u32,
    /// A number of the caller's own, such as that of a material.
    pub id: u32,
}

impl<B> Instance<B> {
    /// An object at a place, in all groups, its `id` zero.
    pub fn new(object: Arc<B>, transform: Transform) -> Self {
        Self { object, transform, later: None, mask: u32::MAX, id: 0 }
    }

    /// The same on its way to another place, where it is at time 1: see [`later`](Self::later).
    #[must_use]
    pub fn moving_to(self, later: Transform) -> Self {
        Self { later: Some(later), ..self }
    }

    /// Whether it can stand where it is to stand, and move as it is to move.
    fn check(&self) -> Result<(), TransformError> {
        match &self.later {
            None => self.transform.check(),
            Some(later) => self.transform.check_motion(later),
        }
    }
}

// Not derived: objects need not be copied.
impl<B> Clone for Instance<B> {
    fn clone(&self) -> Self {
        Self { object: Arc::clone(&self.object), ..*self }
    }
}

/// A scene of instances: a top-level tree over the boxes of objects that stand somewhere, with the queries of rays.
///
/// ```
/// use raywood::{Bvh, Instance, Ray, Tlas, Transform, TriangleMesh};
/// use std::sync::Arc;
///
/// let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let leaf = Arc::new(Bvh::build(TriangleMesh::new(positions, vec![[0, 1, 2]])?)?);
/// let at = |x: f32| Instance::new(Arc::clone(&leaf), Transform::scaling([2.0, 2.0, 2.0]).then(&Transform::translation([x, 0.0, 0.0])));
/// let mut scene = Tlas::build(vec![at(0.0), at(10.0)])?;
///
/// let ray = Ray::new([10.5, 0.5, 3.0], [0.0, 0.0, -1.0]);
/// let hit = scene.intersect(&ray).expect("the ray hits the second");
/// assert_eq!((hit.instance, hit.primitive, hit.t), (1, 0, 3.0));
///
/// scene.set_transform(1, Transform::translation([0.0, 20.0, 0.0]));
/// scene.rebuild()?;
/// assert!(!scene.occluded(&ray));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// - Transforms are affine and invertible: rotation, any scaling, mirroring, shear. Rays are taken into the object's space, not the object out of it: nothing is copied.
///   Directions are not normalised there, so that distances are those of the scene.
/// - [`Hit::instance`] is the number of the instance, from 0. Where objects are scenes themselves, instances are numbered through in order, those of the first object
///   first: the numbers tell apart the instances of the lowest level, and [`locate`](Self::locate) says which of this scene's instances one belongs to.
/// - At exactly equal `t` the lowest instance wins, and of it the primitive that its object finds: the lowest one, but where distances that differ there are one after rounding here.
/// - No ray slips between triangles of one instance that share an edge.
/// - Rays of batches that meet the same instance are traced through it together, which rounds differently: [`Hit::agrees_with`] says by how much, and of equally near ones a higher instance may then be named. Answers never depend on the number of threads.
/// - Masks are those of instances; those of primitives ([`Geometry::mask`](crate::Geometry::mask)) count where there are [options](Self::intersect_with).
/// - Instances may [move](Instance::later): rays [at a time](Self::intersect_at) see them where they are then. Their boxes hold all that they pass through, so what moves far costs rays that pass by, at any time.
/// - A ray hits what it hits in the object's space after its origin and direction were rounded there to single precision: `docs/numerics.md`, "Instances", has the bounds.
#[derive(Clone, Debug)]
pub struct Tlas<B = Bvh<TriangleMesh>> {
    /// As the caller has set them.
    instances: Vec<Instance<B>>,
    options: BuildOptions,
    level: SimdLevel,
    built: Built<B>,
}

/// A scene as it was when it was built.
#[derive(Debug)]
struct Built<B> {
    placements: Vec<Placement<B>>,
    tree: TopTree,
    /// What the tree cost when it was built; it may have new boxes since.
    built_cost: f64,
    /// How far beside their boxes rays may hit instances.
    margin: BoundsMargin,
    /// How many instances there are on the lowest level.
    leaves: u32,
    /// Whether any of them moves.
    moves: bool,
}

impl<B> Clone for Built<B> {
    fn clone(&self) -> Self {
        Self { placements: self.placements.clone(), tree: self.tree.clone(), ..*self }
    }
}

impl<B: Traceable> Tlas<B> {
    /// Builds the scene with good defaults. O(N log N) for N instances, whatever is in them; in parallel in the caller's rayon pool.
    ///
    /// # Errors
    ///
    /// A transform that is not finite or has no inverse, an instance that reaches beyond the largest number, too many.
    pub fn build(instances: Vec<Instance<B>>) -> Result<Self, InstanceError> {
        Self::build_with(instances, &BuildOptions::default())
    }

    /// Builds the scene with options, of which [`wide_builder`](BuildOptions::wide_builder), `bins`, costs and reinsertion count. Those of
    /// [`BuildPreset::Fastest`](crate::BuildPreset) are for scenes in which everything moves with every picture.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build).
    pub fn build_with(
        instances: Vec<Instance<B>>,
        options: &BuildOptions,
    ) -> Result<Self, InstanceError> {
        let built = place::place(&instances)?.build(options)?;
        Ok(Self { instances, options: options.clone(), level: SimdLevel::active(), built })
    }

    /// The instances.
    pub fn instances(&self) -> &[Instance<B>] {
        &self.instances
    }

    /// The box around everything, at all times; empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.built.tree.bounds()
    }

    /// How much memory the scene takes besides its objects, in bytes.
    pub fn bytes(&self) -> usize {
        let Built { placements, tree, .. } = &self.built;
        let moving = placements.iter().filter(|place| place.motion.is_some()).count();
        let lists = size_of_val(&placements[..]) + size_of_val(&self.instances[..]);
        tree.bytes() + lists + moving * size_of::<motion::Motion>()
    }

    /// Which instance of this scene a hit's [`instance`](Hit::instance) belongs to, and the number that it has in the object there: 0 in one that is no scene.
    ///
    /// # Panics
    ///
    /// If there is no such instance.
    pub fn locate(&self, instance: u32) -> (usize, u32) {
        let Built { placements, leaves, .. } = &self.built;
        assert!(instance < *leaves, "instance {instance} of {leaves}");
        let index = placements.partition_point(|place| place.first <= instance) - 1;
        (index, instance - placements[index].first)
    }

    /// The vector instructions that trace the top-level tree.
    pub fn simd_level(&self) -> SimdLevel {
        self.level
    }

    /// Has other vector instructions trace the top-level tree than the [active](SimdLevel::active) ones, as [`Bvh::set_simd_level`] does: for measuring and testing.
    pub fn set_simd_level(&mut self, level: SimdLevel) {
        self.level = if level.is_available() { level } else { SimdLevel::Portable };
    }

    /// The closest hit at `t_min <= t < t_max`; of equally near ones that of the lowest instance.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.intersect_masked(ray, u32::MAX)
    }

    /// Whether the ray hits anything at `t_min <= t < t_max`. It stops at the first hit it finds.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_masked(ray, u32::MAX)
    }

    /// As [`intersect`](Self::intersect), of instances alone whose [mask](Instance::mask) has a bit in common with `mask`, on every level.
    #[inline]
    pub fn intersect_masked(&self, ray: &Ray, mask: u32) -> Option<Hit> {
        self.closest(ray, f32::INFINITY, mask)
    }

    /// As [`occluded`](Self::occluded), of instances alone whose [mask](Instance::mask) has a bit in common with `mask`, on every level.
    #[inline]
    pub fn occluded_masked(&self, ray: &Ray, mask: u32) -> bool {
        self.any(ray, mask)
    }

    /// [`intersect_masked`](Self::intersect_masked) for many rays, those that meet the same instances together, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn intersect_batch_masked(&self, rays: &[Ray], mask: u32, hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        parallel::fill_chunks(rays, hits, many::MOST, |rays, hits| {
            self.closest_of_many(rays, mask, hits);
        });
    }

    /// [`occluded_masked`](Self::occluded_masked) for many rays, those that meet the same instances together, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_batch_masked(&self, rays: &[Ray], mask: u32, occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        parallel::fill_chunks(rays, occluded, many::MOST, |rays, occluded| {
            self.any_of_many(rays, mask, occluded);
        });
    }

    /// [`intersect`](Self::intersect) for many rays, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn intersect_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.intersect_batch_masked(rays, u32::MAX, hits);
    }

    /// [`occluded`](Self::occluded) for many rays, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_batch(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.occluded_batch_masked(rays, u32::MAX, occluded);
    }

    /// [`intersect_batch`](Self::intersect_batch) on the calling thread.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn intersect_batch_serial(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        self.intersect_many(rays, u32::MAX, hits);
    }

    /// [`occluded_batch`](Self::occluded_batch) on the calling thread.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_batch_serial(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        self.occluded_many(rays, u32::MAX, occluded);
    }

    /// The closest hits of rays from one point, as [`Bvh::intersect_from`], on the calling thread.
    pub fn intersect_from_serial(&self, origin: Vec3, directions: &[Vec3], hits: &mut HitColumns) {
        let rays: Vec<_> =
            directions.iter().map(|&direction| Ray::new(origin, direction)).collect();
        let mut found = vec![None; rays.len()];
        self.intersect_many(&rays, u32::MAX, &mut found);
        hits.assign(&found);
    }

    /// The point that a ray hit, in the scene's space, from which the next ray can be spawned. `hit` must be this scene's answer to `ray`.
    ///
    /// The normal is that of the object by the inverse transposed matrix: it points outside where the object's does, of mirrored objects too, whose triangles then have
    /// their corners clockwise.
    pub fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.object_point(ray, hit).rounded()
    }
}

impl<B: Traceable> Traceable for Tlas<B> {
    fn bounds(&self) -> Aabb {
        self.built.tree.bounds()
    }

    fn bounds_margin(&self) -> BoundsMargin {
        self.built.margin
    }

    fn instances(&self) -> usize {
        self.built.leaves as usize
    }

    #[inline]
    fn intersect_within(&self, ray: &Ray, limit: f32, mask: u32) -> Option<Hit> {
        self.closest(ray, limit, mask)
    }

    #[inline]
    fn occluded_within(&self, ray: &Ray, mask: u32) -> bool {
        self.any(ray, mask)
    }

    fn object_point(&self, ray: &Ray, hit: &Hit) -> ObjectPoint {
        let (index, instance) = self.locate(hit.instance);
        let place = &self.built.placements[index];
        place.point(ray, &Hit { instance, ..*hit })
    }

    fn intersect_chosen(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        self.closest_chosen(ray, limit, rules, accepts)
    }

    fn occluded_chosen(
        &self,
        ray: &Ray,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> bool {
        self.any_chosen(ray, rules, accepts)
    }

    fn visit_hits(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        visit: &mut dyn FnMut(Hit) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        self.visit_crossings(ray, limit, rules, visit)
    }

    fn moves(&self) -> bool {
        self.built.moves
    }

    #[inline]
    fn intersect_within_at(&self, ray: &Ray, limit: f32, mask: u32, time: f32) -> Option<Hit> {
        self.closest_at(ray, limit, mask, time)
    }

    #[inline]
    fn occluded_within_at(&self, ray: &Ray, mask: u32, time: f32) -> bool {
        self.any_at(ray, mask, time)
    }

    fn object_point_at(&self, ray: &Ray, hit: &Hit, time: f32) -> ObjectPoint {
        let (index, instance) = self.locate(hit.instance);
        let place = &self.built.placements[index];
        place.point_at(ray, &Hit { instance, ..*hit }, time)
    }

    fn intersect_many_at(&self, rays: &[Ray], times: &[f32], mask: u32, hits: &mut [Option<Hit>]) {
        self.closest_of_many_at(rays, times, mask, hits);
    }

    fn occluded_many_at(&self, rays: &[Ray], times: &[f32], mask: u32, occluded: &mut [bool]) {
        self.any_of_many_at(rays, times, mask, occluded);
    }

    fn intersect_many(&self, rays: &[Ray], mask: u32, hits: &mut [Option<Hit>]) {
        for (rays, hits) in rays.chunks(many::MOST).zip(hits.chunks_mut(many::MOST)) {
            self.closest_of_many(rays, mask, hits);
        }
    }

    fn occluded_many(&self, rays: &[Ray], mask: u32, occluded: &mut [bool]) {
        for (rays, occluded) in rays.chunks(many::MOST).zip(occluded.chunks_mut(many::MOST)) {
            self.any_of_many(rays, mask, occluded);
        }
    }
}
