//! Instances made ready for rays, and the tree over them.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use super::motion::Motion;
use super::transform::{Inverse, ObjectRay, RAY_ERROR};
use super::{
    BoundsMargin, Built, Instance, InstanceError, ObjectPoint, Tlas, Traceable, Transform,
};
use crate::structures::Bvh2;
use crate::structures::wide::top::{MOST_IN_LEAF, TopTree};
use crate::{
    Aabb, BuildError, BuildOptions, Builder, Geometry, Hit, PreparedRay, PrimitiveHit, Ray,
    SurfacePoint, parallel,
};

/// An instance as rays meet it, at time 0.
#[derive(Debug)]
pub(super) struct Placement<B> {
    pub(super) inverse: Inverse,
    pub(super) mask: u32,
    /// The number of the first of its instances on the lowest level.
    pub(super) first: u32,
    pub(super) object: Arc<B>,
    pub(super) transform: Transform,
    /// How it moves from there, if it does.
    pub(super) motion: Option<Box<Motion>>,
}

impl<B> Clone for Placement<B> {
    fn clone(&self) -> Self {
        let (object, motion) = (Arc::clone(&self.object), self.motion.clone());
        Self { object, motion, ..*self }
    }
}

/// Instances made ready, before there is a tree over them.
pub(super) struct Placed<B> {
    pub(super) placements: Vec<Placement<B>>,
    /// The box around each, empty where there is nothing.
    pub(super) boxes: Vec<Aabb>,
    /// How far beside their boxes rays may hit instances.
    pub(super) margin: BoundsMargin,
    /// How many instances there are on the lowest level.
    pub(super) leaves: u32,
}

/// Makes all instances ready. O(N), in parallel.
pub(super) fn place<B: Traceable>(instances: &[Instance<B>]) -> Result<Placed<B>, InstanceError> {
    // Numbers first: instances of scenes count as many as are in them.
    let (mut leaves, mut firsts) = (0, Vec::with_capacity(instances.len()));
    for instance in instances {
        firsts.push(leaves as u32);
        leaves = instance.object.instances().saturating_add(leaves);
        if leaves > InstanceError::MAX_INSTANCES {
            return Err(InstanceError::TooManyInstances { instances: leaves });
        }
    }
    if instances.len() > InstanceError::MAX_INSTANCES {
        return Err(InstanceError::TooManyInstances { instances: instances.len() });
    }

    // Results would be copied twice until it is known whether all are good: so it is only remembered which is the first that is not.
    let first_bad = AtomicUsize::new(usize::MAX);
    let placements = parallel::map(instances.len(), |number| {
        let Instance { object, transform, later, mask, id: _ } = &instances[number];
        let inverse = transform.inverse().unwrap_or_else(|_| {
            first_bad.fetch_min(number, Relaxed);
            Inverse::NONE
        });
        let motion = later.as_ref().and_then(|later| match Motion::new(transform, later) {
            Ok(motion) => Some(Box::new(motion)),
            Err(_) => {
                first_bad.fetch_min(number, Relaxed);
                None
            }
        });
        let (object, first) = (Arc::clone(object), firsts[number]);
        Placement { inverse, mask: *mask, first, object, transform: *transform, motion }
    });
    let instance = first_bad.into_inner();
    if let Some(Err(error)) = instances.get(instance).map(Instance::check) {
        return Err(InstanceError::BadTransform { instance, error });
    }

    let around = parallel::map(placements.len(), |number| placements[number].around());
    let mut margin = BoundsMargin::NONE;
    for (instance, &(bounds, own_margin)) in around.iter().enumerate() {
        if !bounds.is_empty() {
            if !bounds.is_finite() {
                return Err(InstanceError::BadBounds { instance, bounds });
            }
            margin = margin.max(own_margin);
        }
    }
    let boxes = around.into_iter().map(|(bounds, _)| bounds).collect();
    Ok(Placed { placements, boxes, margin, leaves: leaves as u32 })
}

impl<B: Traceable> Placed<B> {
    /// With a tree over the boxes that are not empty.
    pub(super) fn build(self, options: &BuildOptions) -> Result<Built<B>, InstanceError> {
        let tree = top_tree(&self.boxes, options)?;
        let built_cost = tree.cost();
        Ok(self.under(tree, built_cost))
    }

    /// With this tree, which cost so much when it was built.
    pub(super) fn under(self, tree: TopTree, built_cost: f64) -> Built<B> {
        let Self { placements, boxes: _, margin, leaves } = self;
        let moves = placements.iter().any(|place| place.motion.is_some() || place.object.moves());
        Built { placements, tree, built_cost, margin, leaves, moves }
    }
}

/// What origins of rays may be larger by when they are rounded, and to spare.
const ROUNDED: f64 = 1.0 + 1e-6;

/// Boxes as a geometry, for builders.
struct Boxes<'a> {
    boxes: &'a [Aabb],
    /// The numbers of those that are not empty, if some are.
    full: Option<Vec<u32>>,
}

impl<'a> Boxes<'a> {
    /// Those that are not empty.
    fn of(boxes: &'a [Aabb]) -> Self {
        let is_full = |number: &u32| !boxes[*number as usize].is_empty();
        let numbers = 0..boxes.len() as u32;
        let some_empty = boxes.iter().any(Aabb::is_empty);
        Self { boxes, full: some_empty.then(|| numbers.filter(is_full).collect()) }
    }

    /// The number of a box among all.
    #[inline(always)]
    fn number(&self, primitive: u32) -> u32 {
        self.full.as_ref().map_or(primitive, |full| full[primitive as usize])
    }
}

impl Geometry for Boxes<'_> {
    fn len(&self) -> usize {
        self.full.as_ref().map_or(self.boxes.len(), Vec::len)
    }

    #[inline(always)]
    fn bounds(&self, primitive: u32) -> Aabb {
        self.boxes[self.number(primitive) as usize]
    }

    fn intersect(&self, _: u32, _: &PreparedRay) -> Option<PrimitiveHit> {
        None
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        SurfacePoint { position: ray.at(hit.t), normal: crate::Vec3::ZERO, clearance: 0.0 }
    }
}

/// The tree over the boxes of instances, those that are empty left out.
fn top_tree(boxes: &[Aabb], options: &BuildOptions) -> Result<TopTree, InstanceError> {
    let mut options = BuildOptions {
        max_leaf_size: 1,
        reinsertion_passes: Some(options.reinsertion_passes.unwrap_or(REINSERTION_PASSES)),
        ..options.clone()
    };
    // What lies side by side on the curve needs no tree as long as one node holds it: most of the time goes into such small trees.
    if options.wide_builder == Builder::Lbvh && !options.improves() {
        options.max_leaf_size = MOST_IN_LEAF;
    }
    let boxes = Boxes::of(boxes);
    let tree =
        Bvh2::build_by(options.wide_builder, &boxes, &options).map_err(|error| match error {
            BuildError::TooManyPrimitives { primitives } => {
                InstanceError::TooManyInstances { instances: primitives }
            }
            BuildError::BadBounds { primitive, bounds } => {
                InstanceError::BadBounds { instance: boxes.number(primitive) as usize, bounds }
            }
            error => InstanceError::Build(error),
        })?;
    Ok(TopTree::of(&tree, |entry| (boxes.number(entry), boxes.bounds(entry))))
}

/// How often the top-level tree is improved by reinsertion unless the options say it.
const REINSERTION_PASSES: usize = 4;

impl<B: Traceable> Placement<B> {
    /// The box around the instance, empty if there is nothing, and how far beside that rays may hit it.
    fn around(&self) -> (Aabb, BoundsMargin) {
        let Self { object, transform, inverse, motion, .. } = self;
        let bounds = object.bounds();
        if bounds.is_empty() {
            return (Aabb::EMPTY, BoundsMargin::NONE);
        }
        if let Some(motion) = motion {
            let inner = object.bounds_margin();
            let mut share = RAY_ERROR * motion.condition;
            share += inner.share * motion.stretch * motion.stretch_back * ROUNDED;
            let length = share * motion.distance + inner.length * motion.stretch * ROUNDED;
            return (motion.bounds(transform, &bounds), BoundsMargin { share, length });
        }
        // What rounding moves a ray in the object's space, and what a ray there may pass beside the object's box, both as the world sees it.
        let (inner, distance) = (object.bounds_margin(), inverse.distance());
        let (mut share, mut inner_length) = (RAY_ERROR * inverse.condition, 0.0);
        if inner != BoundsMargin::NONE {
            share += inner.share * transform.stretch() * inverse.stretch() * ROUNDED;
            inner_length = inner.length * transform.stretch() * ROUNDED;
        }
        let margin = BoundsMargin { share, length: share * distance + inner_length };
        (transform.bounds(&bounds), margin)
    }

    /// The closest hit with the instance up to a limit, which lies in the scene's units.
    #[inline(always)]
    pub(super) fn intersect(&self, ray: &Ray, limit: f32, mask: u32) -> Option<Hit> {
        let seen = self.inverse.ray(ray);
        let hit = self.object.intersect_within(&seen.ray, seen.limit(limit), mask)?;
        Some(self.in_scene(&hit, &seen))
    }

    /// A hit of a ray in the object's space as the scene tells of it.
    #[inline(always)]
    pub(super) fn in_scene(&self, hit: &Hit, seen: &ObjectRay) -> Hit {
        Hit { t: hit.t * seen.unit, instance: self.first + hit.instance, ..*hit }
    }

    #[inline(always)]
    pub(super) fn occluded(&self, ray: &Ray, mask: u32) -> bool {
        self.object.occluded_within(&self.inverse.ray(ray).ray, mask)
    }

    /// The point of a hit, whose instance is that within the object.
    pub(super) fn point(&self, ray: &Ray, hit: &Hit) -> ObjectPoint {
        let seen = self.inverse.ray(ray);
        let hit = Hit { t: hit.t / seen.unit, ..*hit };
        self.object.object_point(&seen.ray, &hit).placed(&self.transform, &self.inverse)
    }
}

impl<B: Traceable> Tlas<B> {
    /// The closest hit of what the mask lets see, unless it lies beyond the limit.
    #[inline]
    pub(super) fn closest(&self, ray: &Ray, limit: f32, mask: u32) -> Option<Hit> {
        let prepared = PreparedRay::new(ray)?;
        let mut best: Option<Hit> = None;
        let _ = self.walk(ray, &prepared, limit, mask, |place, limit| {
            match place.intersect(ray, limit, mask) {
                Some(hit) if is_nearer(&hit, best.as_ref()) => {
                    best = Some(hit);
                    ControlFlow::Continue(limit.min(hit.t))
                }
                _ => ControlFlow::Continue(limit),
            }
        });
        best
    }

    /// Whether anything blocks the ray that the mask lets see.
    #[inline]
    pub(super) fn any(&self, ray: &Ray, mask: u32) -> bool {
        let Some(prepared) = PreparedRay::new(ray) else { return false };
        let flow = self.walk(ray, &prepared, f32::INFINITY, mask, |place, limit| {
            match place.occluded(ray, mask) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(limit),
            }
        });
        flow.is_break()
    }

    /// Tells `visit` of each instance that the mask lets see and the ray may meet: see [`TopTree::walk`].
    #[inline(always)]
    pub(super) fn walk(
        &self,
        ray: &Ray,
        prepared: &PreparedRay,
        limit: f32,
        mask: u32,
        mut visit: impl FnMut(&Placement<B>, f32) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        let Built { placements, tree, margin, .. } = &self.built;
        tree.walk(self.level, prepared, margin.of(ray), limit, |number, limit| {
            let place = &placements[number as usize];
            if place.mask & mask == 0 {
                return ControlFlow::Continue(limit);
            }
            visit(place, limit)
        })
    }
}

/// Whether a hit is nearer than another, or equally near in an instance of a lower number. An instance is met once, so equal numbers do not occur.
#[inline(always)]
pub(super) fn is_nearer(hit: &Hit, best: Option<&Hit>) -> bool {
    best.is_none_or(|best| hit.t < best.t || (hit.t == best.t && hit.instance < best.instance))
}
