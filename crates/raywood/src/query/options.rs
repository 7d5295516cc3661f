//! Which hits count for a query: sides of the surface, groups of primitives, one to skip, a filter of one's own.

use crate::geometry::meets_front;
use crate::structures::Chooser;
use crate::{Geometry, Hit, Hit64, PreparedRay, Ray};

/// A side of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Face {
    /// The side that the normal points to: of a triangle, the one from which its corners are seen counter-clockwise; of a sphere, the outside.
    Front,
    /// The other side.
    Back,
}

/// Says of each hit whether it counts. Every `FnMut(&Hit) -> bool` does, and for hits of double precision every `FnMut(&Hit64) -> bool`.
pub trait HitFilter<H = Hit> {
    /// Whether the hit counts.
    fn accepts(&mut self, hit: &H) -> bool;
}

impl<H, F: FnMut(&H) -> bool> HitFilter<H> for F {
    #[inline(always)]
    fn accepts(&mut self, hit: &H) -> bool {
        self(hit)
    }
}

/// The filter that lets every hit count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AcceptAll;

impl<H> HitFilter<H> for AcceptAll {
    #[inline(always)]
    fn accepts(&mut self, _: &H) -> bool {
        true
    }
}

/// What lets a hit count, for one query: [`intersect_with`](crate::Bvh::intersect_with), [`occluded_with`](crate::Bvh::occluded_with),
/// [`all_hits_with`](crate::Bvh::all_hits_with), [`nearest_hits_with`](crate::Bvh::nearest_hits_with), and the same of a [`Tlas`](crate::Tlas). A hit that does not count is as if it
/// were not there: the ray goes on behind it.
///
/// Plain queries ask nothing of this, masks included, and pay nothing for it.
///
/// ```
/// use raywood::{Bvh, Face, QueryOptions, Ray, Spheres};
///
/// let bvh = Bvh::build(Spheres::new(vec![([0.0; 3].into(), 1.0), ([5.0, 0.0, 0.0].into(), 1.0)])?)?;
/// let ray = Ray::new([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
/// let t = |options| bvh.intersect_with(&ray, options).map(|hit| hit.t);
/// assert_eq!(t(QueryOptions::new()), Some(2.0));
/// assert_eq!(t(QueryOptions::new().cull(Face::Front)), Some(4.0));
/// assert_eq!(t(QueryOptions::new().skip(0)), Some(7.0));
///
/// let far = bvh.intersect_with(&ray, QueryOptions::new().filter(|hit| hit.t > 8.0));
/// assert_eq!(far.map(|hit| hit.t), Some(9.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct QueryOptions<F = AcceptAll> {
    cull: Option<Face>,
    mask: u32,
    skip: Skip,
    time: f32,
    filter: F,
}

/// The primitive that does not count, by the numbers of its instance and its own.
type Skip = Option<(u32, u32)>;

impl Default for QueryOptions {
    fn default() -> Self {
        Self::new()
    }
}

impl QueryOptions {
    /// Every hit counts, except of primitives whose [mask](Geometry::mask) is zero.
    pub fn new() -> Self {
        Self { cull: None, mask: u32::MAX, skip: None, time: 0.0, filter: AcceptAll }
    }
}

impl<F> QueryOptions<F> {
    /// Hits of this side of the surface do not count.
    pub fn cull(self, face: Face) -> Self {
        Self { cull: Some(face), ..self }
    }

    /// Only primitives count whose [mask](Geometry::mask) has a bit in common with this one; in scenes of instances, whose instances' [masks](crate::Instance::mask) have one as well, on
    /// every level.
    pub fn mask(self, mask: u32) -> Self {
        Self { mask, ..self }
    }

    /// This primitive does not count: the one that a ray starts on, where its point is known by other means than [a hit](crate::SurfacePoint).
    pub fn skip(self, primitive: u32) -> Self {
        self.skip_in(0, primitive)
    }

    /// This primitive of this instance does not count: as [`skip`](Self::skip), which means that of instance 0, in [scenes of instances](crate::Tlas), by the numbers that
    /// [hits](Hit) have there.
    pub fn skip_in(self, instance: u32, primitive: u32) -> Self {
        Self { skip: Some((instance, primitive)), ..self }
    }

    /// At this time, from 0 to 1: a [scene](crate::Tlas) is seen as it is then, whose instances may [move](crate::Instance::later). 0 if nothing is said; what is beyond counts as the nearest,
    /// NaN as 0. Everything else stands still.
    ///
    /// ```
    /// use raywood::{Bvh, Instance, QueryOptions, Ray, Spheres, Tlas, Transform};
    /// use std::sync::Arc;
    ///
    /// let ball = Arc::new(Bvh::build(Spheres::new(vec![([0.0; 3].into(), 1.0)])?)?);
    /// let flies = Instance::new(ball, Transform::IDENTITY).moving_to(Transform::translation([10.0, 0.0, 0.0]));
    /// let scene = Tlas::build(vec![flies])?;
    ///
    /// let ray = Ray::new([5.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert!(scene.intersect(&ray).is_none());
    /// assert_eq!(scene.intersect_with(&ray, QueryOptions::new().at(0.5)).map(|hit| hit.t), Some(2.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn at(self, time: f32) -> Self {
        Self { time, ..self }
    }

    /// Only those hits count that the filter accepts, as of leaves drawn on larger triangles. It is asked last, in any order, of no hit twice, and not of all: a
    /// closest-hit query does not ask of what lies behind a hit that counts. Give `&mut filter` to keep it.
    ///
    /// Answers are as certain as the filter: one that always says the same of the same hit makes them independent of order. A panic in it passes through and
    /// leaves everything usable.
    pub fn filter<N: FnMut(&Hit) -> bool>(self, filter: N) -> QueryOptions<N> {
        let Self { cull, mask, skip, time, filter: _ } = self;
        QueryOptions { cull, mask, skip, time, filter }
    }
}

impl<F> QueryOptions<F> {
    /// As [`filter`](Self::filter), of hits of [double precision](crate::Bvh64::intersect_with).
    pub fn filter64<N: FnMut(&Hit64) -> bool>(self, filter: N) -> QueryOptions<N> {
        let Self { cull, mask, skip, time, filter: _ } = self;
        QueryOptions { cull, mask, skip, time, filter }
    }

    /// Whether the hit with a primitive, given by the numbers of its instance and its own, counts, but for the filter.
    #[inline(always)]
    pub(crate) fn lets_count(
        &self,
        numbers: (u32, u32),
        mask: impl FnOnce() -> u32,
        face: impl FnOnce() -> Face,
    ) -> bool {
        self.skip != Some(numbers)
            && self.mask & mask() != 0
            && self.cull.is_none_or(|culled| face() != culled)
    }

    /// Whether the filter lets a hit count.
    #[inline(always)]
    pub(crate) fn accepts<H>(&mut self, hit: &H) -> bool
    where
        F: HitFilter<H>,
    {
        self.filter.accepts(hit)
    }
}

/// The part of [`QueryOptions`] that is asked where a hit is found: what [`Traceable`](crate::Traceable)s hand on to each other. The rest of them the scene asks itself.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct HitRules {
    /// Only instances and primitives count whose masks have a bit in common with this one.
    pub mask: u32,
    /// Hits of this side of the surface do not count. It is that of the object, however the object is placed: of a mirrored one, too, the outside is the front.
    pub cull: Option<Face>,
    /// When the ray looks at what moves: see [`QueryOptions::at`].
    pub time: f32,
}

impl HitRules {
    /// Everything counts that some group sees, at time 0.
    pub const ALL: Self = Self { mask: u32::MAX, cull: None, time: 0.0 };

    /// These rules, and a filter, as options of a tree in a scene.
    pub(crate) fn with<F: HitFilter>(self, filter: F) -> QueryOptions<F> {
        let Self { mask, cull, time } = self;
        QueryOptions { cull, mask, skip: None, time, filter }
    }
}

/// The part of [`QueryOptions`] that knows hits by their numbers in a scene.
pub(crate) struct HitChooser<F> {
    skip: Skip,
    filter: F,
}

impl<F: HitFilter> Chooser for HitChooser<F> {
    #[inline(always)]
    fn counts(&mut self, hit: &Hit) -> bool {
        self.skip != Some((hit.instance, hit.primitive)) && self.filter.accepts(hit)
    }
}

impl<F: HitFilter> QueryOptions<F> {
    /// The options in their two parts.
    pub(crate) fn parts(self) -> (HitRules, HitChooser<F>) {
        let Self { cull, mask, skip, time, filter } = self;
        (HitRules { mask, cull, time }, HitChooser { skip, filter })
    }

    /// The options at work on a ray.
    pub(crate) fn chooser<'a, G: Geometry>(
        self,
        geometry: &'a G,
        ray: &'a PreparedRay,
    ) -> OptionChooser<'a, G, F> {
        OptionChooser { options: self, geometry, ray }
    }
}

/// Chooses hits of a ray by options.
pub(crate) struct OptionChooser<'a, G, F> {
    options: QueryOptions<F>,
    geometry: &'a G,
    ray: &'a PreparedRay,
}

impl<G: Geometry, F: HitFilter> Chooser for OptionChooser<'_, G, F> {
    #[inline(always)]
    fn counts(&mut self, hit: &Hit) -> bool {
        let Self { options, geometry, ray } = self;
        let numbers = (hit.instance, hit.primitive);
        let mask = || geometry.mask(hit.primitive);
        options.lets_count(numbers, mask, || face(*geometry, ray, hit)) && options.accepts(hit)
    }
}

/// Which side of the surface a ray hits.
fn face<G: Geometry>(geometry: &G, ray: &PreparedRay, hit: &Hit) -> Face {
    let front = match geometry.triangle(hit.primitive) {
        Some(corners) => meets_front(ray, corners),
        None => {
            let &PreparedRay { origin, direction, t_min, t_max, .. } = ray;
            let ray = Ray { origin, t_min, direction, t_max };
            geometry.surface_point(&ray, hit).normal.dot(direction) < 0.0
        }
    };
    if front { Face::Front } else { Face::Back }
}
