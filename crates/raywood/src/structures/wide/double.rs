//! Rays and triangles of double precision in the tree: which triangles of a leaf may be hit is told by vectors in single precision, where by double
//! precision.

use std::sync::LazyLock;

use super::batch::{Found, Wave};
use super::node::Reference;
use super::ray_search::RaySearch;
use super::sink::{Sink, SixteenHits};
use super::source::{Common, Source};
use super::step::lanes;
use super::{WideBvh, packet, single};
use crate::double::Double3;
use crate::doubles::{LocalFrame, LocalRay, PreparedRay64};
use crate::geometry::{Candidates, LANES, TriangleBlock};
use crate::minmax::larger;
use crate::simd::{Kernel, Simd, dispatch_on};
use crate::{Hit, Hit64, HitColumns, PreparedRay, Ray, Ray64, SimdLevel, TriangleMesh};
use crate::{TriangleMesh64, Vec3};

/// The mesh that a tree is a rounded image of, and how it is rounded.
#[derive(Clone, Copy)]
pub(crate) struct DoubleScene<'a> {
    pub(crate) mesh: &'a TriangleMesh64,
    pub(crate) frame: &'a LocalFrame,
    pub(crate) level: SimdLevel,
}

/// A search in double precision.
#[repr(C)]
pub(super) struct InDouble {
    /// Where looking further is of no use, as seen in the frame.
    t_max: f32,
    /// The closest hit's triangle, or [`NONE`].
    primitive: u32,
    /// And its distance, at first the ray's end.
    distance: f64,
    local: LocalRay,
    single: PreparedRay,
    exact: PreparedRay64,
}

/// Stands for a triangle where none was hit.
const NONE: u32 = u32::MAX;

impl InDouble {
    /// Tests a triangle, and takes its hit if it is nearer, or equally near with a lower number.
    #[inline(always)]
    fn offer(&mut self, scene: DoubleScene<'_>, primitive: u32) {
        let corners = scene.mesh.corners(primitive);
        let Some(t) = self.exact.hit_distance(corners, self.distance) else { return };
        // The ray's end itself does not count, and the least number there stands for none.
        if t < self.distance || t == self.distance && primitive < self.primitive {
            (self.distance, self.primitive) = (t, primitive);
            self.t_max = self.local.limit(t);
        }
    }
}

impl RaySearch for InDouble {
    type Scene<'a> = DoubleScene<'a>;
    type Ray = Ray64;
    type LeafHits = Candidates;
    type Hit = Hit64;

    const NO_HITS: Candidates = Candidates::NONE;
    const IS_ROUNDED: bool = true;

    #[inline(always)]
    fn is_valid<S: Simd>(_: S, ray: &Ray64) -> bool {
        ray.is_valid()
    }

    #[inline(always)]
    fn new<S: Simd>(simd: S, scene: DoubleScene<'_>, ray: &Ray64) -> Self {
        let local = scene.frame.ray(ray);
        Self {
            single: PreparedRay::of_valid(simd, &local.ray),
            local,
            exact: PreparedRay64::new(ray, scene.level),
            t_max: local.ray.t_max,
            primitive: NONE,
            distance: ray.t_max,
        }
    }

    #[inline(always)]
    fn single(&self) -> &PreparedRay {
        &self.single
    }

    #[inline(always)]
    fn displacement(&self) -> f32 {
        self.local.displacement
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn test_leaf<S: Simd>(&self, simd: S, tree: &WideBvh, leaf: Reference) -> Candidates {
        let block = tree.block(leaf);
        block.candidates(simd, &self.single, self.local.displacement, leaf.lanes(), self.t_max)
    }

    #[inline(always)]
    fn may_hit(found: &Candidates) -> bool {
        found.lanes != 0
    }

    #[inline(always)]
    fn take_closest<S: Simd>(
        &mut self,
        simd: S,
        tree: &WideBvh,
        scene: DoubleScene<'_>,
        leaf: Reference,
        found: &Candidates,
    ) -> bool {
        let numbers = &tree.block(leaf).primitives;
        let before = self.t_max;
        let mut left = found.lanes;
        while left != 0 {
            // The nearest first, so that others need not be asked.
            let (near, places) = simd.least8(left, simd.load8(&found.near));
            if near > self.t_max {
                break;
            }
            let lane = places.trailing_zeros() as usize % LANES;
            left &= !(1 << lane);
            self.offer(scene, numbers[lane]);
        }
        self.t_max < before
    }

    #[inline(always)]
    fn is_blocked_by<S: Simd>(
        &self,
        _: S,
        tree: &WideBvh,
        scene: DoubleScene<'_>,
        leaf: Reference,
        found: &Candidates,
    ) -> bool {
        let numbers = &tree.block(leaf).primitives;
        for lane in lanes(found.lanes) {
            let corners = scene.mesh.corners(numbers[lane]);
            if self.exact.hit_distance(corners, self.distance).is_some() {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn prefetch<const SECOND: bool>(
        &self,
        tree: &WideBvh,
        scene: DoubleScene<'_>,
        leaf: Reference,
        found: &Candidates,
    ) {
        let numbers = &tree.block(leaf).primitives;
        for lane in lanes(found.lanes) {
            scene.mesh.prefetch::<SECOND>(numbers[lane]);
        }
    }

    #[inline(always)]
    fn block(&mut self) {
        self.t_max = f32::NEG_INFINITY;
    }

    #[inline(always)]
    fn is_blocked(&self) -> bool {
        self.t_max == f32::NEG_INFINITY
    }

    #[inline(always)]
    fn hit(&self, scene: DoubleScene<'_>) -> Option<Hit64> {
        if self.primitive == NONE {
            return None;
        }
        let corners = scene.mesh.corners(self.primitive);
        Some(self.exact.hit_at(self.distance, self.primitive, corners))
    }
}

/// Looks for the closest hit.
struct Closest<'a> {
    tree: &'a WideBvh,
    scene: DoubleScene<'a>,
    ray: &'a Ray64,
}

impl Kernel for Closest<'_> {
    type Output = Option<Hit64>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Hit64> {
        let Self { tree, scene, ray } = self;
        let mut search = InDouble::new(simd, scene, ray);
        single::closest(simd, tree, scene, &mut search, &mut ());
        search.hit(scene)
    }
}

/// Looks for any hit.
struct Any<'a> {
    tree: &'a WideBvh,
    scene: DoubleScene<'a>,
    ray: &'a Ray64,
}

impl Kernel for Any<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { tree, scene, ray } = self;
        single::is_blocked(simd, tree, scene, &InDouble::new(simd, scene, ray), &mut ())
    }
}

impl WideBvh {
    /// The closest hit of a ray of double precision, where this is a tree over the scene's image.
    pub(crate) fn closest_in_double(&self, scene: DoubleScene<'_>, ray: &Ray64) -> Option<Hit64> {
        if !ray.is_valid() {
            return None;
        }
        dispatch_on(self.level, Closest { tree: self, scene, ray })
    }

    /// Whether a ray of double precision hits anything.
    pub(crate) fn any_in_double(&self, scene: DoubleScene<'_>, ray: &Ray64) -> bool {
        ray.is_valid() && dispatch_on(self.level, Any { tree: self, scene, ray })
    }

    /// The closest hits of many rays.
    pub(crate) fn closest_of_batch_in_double(
        &self,
        scene: DoubleScene<'_>,
        rays: &[Ray64],
        hits: &mut [Option<Hit64>],
    ) {
        dispatch_on(self.level, ClosestOfBatch { tree: self, scene, rays, hits });
    }

    /// Whether anything blocks each of many rays.
    pub(crate) fn any_of_batch_in_double(
        &self,
        scene: DoubleScene<'_>,
        rays: &[Ray64],
        occluded: &mut [bool],
    ) {
        dispatch_on(self.level, AnyOfBatch { tree: self, scene, rays, occluded });
    }
}

/// Finds the closest hits of many rays: as [`batch::Closest`](super::batch::Closest).
struct ClosestOfBatch<'a> {
    tree: &'a WideBvh,
    scene: DoubleScene<'a>,
    rays: &'a [Ray64],
    hits: &'a mut [Option<Hit64>],
}

impl Kernel for ClosestOfBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { tree, scene, rays, hits } = self;
        let (mut rest, mut rounded) = (Vec::new(), Vec::new());
        let mut scratch = packet::Scratch::new(tree);
        let pieces = rays.chunks(packet::RAYS).zip(hits.chunks_mut(packet::RAYS));
        for (number, (rays, hits)) in pieces.enumerate() {
            let first = number * packet::RAYS;
            let mut sink = ExactHits { scene, rays, hits };
            let rays = RoundedRays::new(scene, rays, &mut rounded);
            let piece = packet::Piece { tree, geometry: &*NOTHING, rays, first };
            packet::closest::<S, _, _, false>(simd, &piece, &mut sink, &mut scratch, &mut rest);
        }
        for &number in &rest {
            hits[number] = None;
        }
        let finish = |number: usize, found: Found<Hit64>| hits[number] = found.hit;
        let rest = rest.iter().map(|&number| (number, rays[number]));
        let wave = Wave::<InDouble, _, _, false> { tree, scene, rays: rest, finish };
        for number in dispatch_on(tree.level, wave) {
            hits[number] = tree.closest_in_double(scene, &rays[number]);
        }
    }
}

/// Finds out whether anything blocks each of many rays: as [`batch::Any`](super::batch::Any).
struct AnyOfBatch<'a> {
    tree: &'a WideBvh,
    scene: DoubleScene<'a>,
    rays: &'a [Ray64],
    occluded: &'a mut [bool],
}

impl Kernel for AnyOfBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { tree, scene, rays, occluded } = self;
        let (mut rest, mut rounded) = (Vec::new(), Vec::new());
        let mut scratch = packet::Scratch::new(tree);
        let pieces = rays.chunks(packet::RAYS).zip(occluded.chunks_mut(packet::RAYS));
        for (number, (rays, occluded)) in pieces.enumerate() {
            let first = number * packet::RAYS;
            let rays = RoundedRays::new(scene, rays, &mut rounded);
            let piece = packet::Piece { tree, geometry: &*NOTHING, rays, first };
            packet::any::<S, _, false>(simd, &piece, occluded, &mut scratch, &mut rest);
        }
        for &number in &rest {
            occluded[number] = false;
        }
        let finish = |number: usize, found: Found<Hit64>| occluded[number] = found.is_blocked;
        let rest = rest.iter().map(|&number| (number, rays[number]));
        let wave = Wave::<InDouble, _, _, true> { tree, scene, rays: rest, finish };
        for number in dispatch_on(tree.level, wave) {
            occluded[number] = tree.any_in_double(scene, &rays[number]);
        }
    }
}

/// A geometry for kernels that ask one about what is no triangle: here everything is.
static NOTHING: LazyLock<TriangleMesh> = LazyLock::new(TriangleMesh::default);

/// Rays of a packet as they are seen in single precision, beside what they are in truth.
#[derive(Clone, Copy)]
struct RoundedRays<'a> {
    scene: DoubleScene<'a>,
    rounded: &'a [Ray],
    exact: &'a [Ray64],
    displacement: f32,
}

impl<'a> RoundedRays<'a> {
    /// Those of some rays, in memory that can be used again.
    #[inline(always)]
    fn new(scene: DoubleScene<'a>, exact: &'a [Ray64], rounded: &'a mut Vec<Ray>) -> Self {
        rounded.clear();
        let mut displacement = 0.0;
        for ray in exact {
            let local = scene.frame.ray(ray);
            // One from far away would make all others doubtful.
            if local.is_usual() {
                displacement = larger(local.displacement, displacement);
                rounded.push(local.ray);
            } else {
                rounded.push(Ray::NONE);
            }
        }
        Self { scene, rounded, exact, displacement }
    }
}

impl Source for RoundedRays<'_> {
    const COMMON: Option<Common> = None;
    const IS_ROUNDED: bool = true;

    #[inline(always)]
    fn point(&self) -> Option<Vec3> {
        None
    }

    #[inline(always)]
    fn len(&self) -> usize {
        self.rounded.len()
    }

    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        self.rounded[number]
    }

    #[inline(always)]
    fn part(&self, start: usize, count: usize) -> Self {
        let rounded = Source::part(&self.rounded, start, count);
        Self { rounded, exact: &self.exact[start..start + rounded.len()], ..*self }
    }

    #[inline(always)]
    fn columns<S: Simd>(&self, simd: S, start: usize) -> [S::F16; 8] {
        self.rounded.columns(simd, start)
    }

    #[inline(always)]
    fn prefetch<S: Simd>(&self, simd: S) {
        simd.prefetch_slice(self.exact);
    }

    #[inline(always)]
    fn displacement(&self) -> f32 {
        self.displacement
    }

    #[inline(always)]
    fn line(&self, number: usize) -> [Double3; 2] {
        let ray = &self.exact[number];
        [ray.origin, ray.direction]
    }

    #[inline(always)]
    fn corners(&self, block: &TriangleBlock, lane: usize) -> [Double3; 3] {
        self.scene.mesh.corners(block.primitives[lane])
    }

    fn settle(&self, number: usize, primitive: u32, than: Option<u32>) -> Option<f32> {
        let DoubleScene { mesh, level, .. } = self.scene;
        let ray = PreparedRay64::new(&self.exact[number], level);
        let t = ray.hit_distance(mesh.corners(primitive), ray.t_max)?;
        if let Some(other) = than {
            let before = ray.known_distance(mesh.corners(other))?;
            if !(t < before || t == before && primitive < other) {
                return None;
            }
        }
        Some(t as f32)
    }
}

/// Where closest hits go: the packet knows which triangle a ray hits, and double precision where.
struct ExactHits<'a> {
    scene: DoubleScene<'a>,
    rays: &'a [Ray64],
    hits: &'a mut [Option<Hit64>],
}

impl ExactHits<'_> {
    #[inline(always)]
    fn hit(&self, ray: usize, primitive: u32) -> Option<Hit64> {
        let DoubleScene { mesh, level, .. } = self.scene;
        let ray = PreparedRay64::new(&self.rays[ray], level);
        ray.known_hit(primitive, mesh.corners(primitive))
    }
}

impl Sink for ExactHits<'_> {
    type Part<'a>
        = ExactHits<'a>
    where
        Self: 'a;

    #[inline(always)]
    fn part(&mut self, start: usize, count: usize) -> ExactHits<'_> {
        let places = start..start + count;
        ExactHits { rays: &self.rays[places.clone()], hits: &mut self.hits[places], ..*self }
    }

    #[inline(always)]
    fn set(&mut self, ray: usize, hit: Option<Hit>) {
        self.hits[ray] = hit.and_then(|hit| self.hit(ray, hit.primitive));
    }

    #[inline(always)]
    fn set_sixteen<S: Simd>(&mut self, _: S, start: usize, hits: SixteenHits<S::F16>) {
        for ray in start..self.rays.len().min(start + 16) {
            let primitive = hits.primitives[ray - start].to_bits();
            let is_hit = primitive != HitColumns::NONE;
            self.hits[ray] = if is_hit { self.hit(ray, primitive) } else { None };
        }
    }

    #[inline(always)]
    fn prefetch<S: Simd>(&self, simd: S) {
        simd.prefetch_slice(self.hits);
    }
}
