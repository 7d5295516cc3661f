//! Any number of geometries of any kinds as one.

use std::fmt;

use super::{Geometry, PreparedRay, PrimitiveHit, PrimitivePoint, SurfacePoint};
use crate::{Aabb, Hit, Ray, Vec3};

/// Geometries of any kinds in one tree, owned or borrowed, under one numbering: first all primitives of the first, then all of the second, and so on.
///
/// [`locate`](Self::locate) tells which geometry a hit is on, and which of its primitives. Each has a mask of its own for queries [with one](crate::QueryOptions::mask). Triangles are
/// traced as fast as those of a single mesh: the tree has them. Other primitives cost a search among the geometries and a call through a table. Two kinds that are known
/// when the program is written can also be [`Joined`](super::Joined); what shall move on its own is an [`Instance`](crate::Instance).
///
/// ```
/// use raywood::{Assembly, Boxes, Aabb, Bvh, QueryOptions, Ray, Spheres, TriangleMesh};
///
/// let floor = TriangleMesh::new(vec![[-9.0, 0.0, -9.0], [9.0, 0.0, -9.0], [0.0, 0.0, 18.0]], vec![[0, 2, 1]])?;
/// let mut scene = Assembly::new();
/// let floor = scene.add(&floor);
/// let glass = scene.add_masked(Spheres::new(vec![([0.0, 1.0, 0.0].into(), 1.0)])?, 0b10);
/// let crates = scene.add(Boxes::new(vec![Aabb::new([3.0, 0.0, 0.0], [4.0, 1.0, 1.0])])?);
///
/// let bvh = Bvh::build(scene)?;
/// let down = |x| Ray::new([x, 5.0, 0.5], [0.0, -1.0, 0.0]);
/// let seen = |x| bvh.intersect(&down(x)).map(|hit| bvh.geometry().locate(hit.primitive));
/// assert_eq!(seen(0.0), Some((glass, 0)));
/// assert_eq!(seen(3.5), Some((crates, 0)));
/// assert_eq!(seen(2.0), Some((floor, 0)));
///
/// let solid = bvh.intersect_with(&down(0.0), QueryOptions::new().mask(0b01)).expect("the floor");
/// assert_eq!(bvh.geometry().locate(solid.primitive), (floor, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Default)]
pub struct Assembly<'a> {
    parts: Vec<Part<'a>>,
    len: usize,
}

/// A geometry among others.
struct Part<'a> {
    geometry: Box<dyn Geometry + Send + 'a>,
    /// The number of its first primitive.
    first: usize,
    mask: u32,
}

impl<'a> Assembly<'a> {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a geometry, or a reference to one, behind those that are there, and tells its number: 0 for the first.
    pub fn add(&mut self, geometry: impl Geometry + Send + 'a) -> usize {
        self.add_masked(geometry, u32::MAX)
    }

    /// As [`add`](Self::add), of a geometry that belongs to the given groups, a bit each: of its primitives' [masks](Geometry::mask) only these bits are left.
    pub fn add_masked(&mut self, geometry: impl Geometry + Send + 'a, mask: u32) -> usize {
        let first = self.len;
        self.len = first.saturating_add(geometry.len());
        self.parts.push(Part { geometry: Box::new(geometry), first, mask });
        self.parts.len() - 1
    }

    /// How many geometries there are.
    pub fn count(&self) -> usize {
        self.parts.len()
    }

    /// A geometry by its number; `None` if there is none.
    pub fn get(&self, geometry: usize) -> Option<&(dyn Geometry + Send + 'a)> {
        self.parts.get(geometry).map(|part| &*part.geometry)
    }

    /// Which geometry a primitive belongs to, and its number there. O(log n) of the number of geometries.
    ///
    /// # Panics
    ///
    /// If there is no such primitive.
    pub fn locate(&self, primitive: u32) -> (usize, u32) {
        assert!((primitive as usize) < self.len, "primitive {primitive} of {}", self.len);
        // The last that begins no later: those without primitives come before it.
        let geometry = self.parts.partition_point(|part| part.first <= primitive as usize) - 1;
        (geometry, primitive - self.parts[geometry].first as u32)
    }

    /// The number in this assembly of a primitive of one of its geometries: the opposite of [`locate`](Self::locate). `None` if there is no such primitive.
    pub fn primitive(&self, geometry: usize, primitive: u32) -> Option<u32> {
        let part = self.parts.get(geometry)?;
        let exists = (primitive as usize) < part.geometry.len();
        exists.then_some(u32::try_from(part.first).ok()?.checked_add(primitive)?)
    }

    /// The geometry that a primitive belongs to, and its number there.
    #[inline]
    fn part(&self, primitive: u32) -> (&Part<'a>, u32) {
        let (geometry, primitive) = self.locate(primitive);
        (&self.parts[geometry], primitive)
    }
}

impl fmt::Debug for Assembly<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = self.parts.iter().map(|part| (part.geometry.len(), part.mask));
        f.write_str("Assembly of (primitives, mask) ")?;
        f.debug_list().entries(parts).finish()
    }
}

impl Geometry for Assembly<'_> {
    fn len(&self) -> usize {
        self.len
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        let (part, primitive) = self.part(primitive);
        part.geometry.bounds(primitive)
    }

    fn has_sound_bounds(&self) -> bool {
        self.parts.iter().all(|part| part.geometry.has_sound_bounds())
    }

    fn clipped_bounds(&self, primitive: u32, cell: &Aabb) -> Aabb {
        let (part, primitive) = self.part(primitive);
        part.geometry.clipped_bounds(primitive, cell)
    }

    fn triangle(&self, primitive: u32) -> Option<[Vec3; 3]> {
        let (part, primitive) = self.part(primitive);
        part.geometry.triangle(primitive)
    }

    fn prefetch(&self, primitive: u32) {
        let (part, primitive) = self.part(primitive);
        part.geometry.prefetch(primitive);
    }

    fn prefetch_rest(&self, primitive: u32) {
        let (part, primitive) = self.part(primitive);
        part.geometry.prefetch_rest(primitive);
    }

    fn bounding_ball(&self, primitive: u32) -> Option<(Vec3, f32)> {
        let (part, primitive) = self.part(primitive);
        part.geometry.bounding_ball(primitive)
    }

    fn overlaps(&self, primitive: u32, cell: &Aabb) -> bool {
        let (part, primitive) = self.part(primitive);
        part.geometry.overlaps(primitive, cell)
    }

    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        let (part, primitive) = self.part(primitive);
        part.geometry.intersect(primitive, ray)
    }

    fn closest_point(&self, primitive: u32, point: Vec3) -> Option<PrimitivePoint> {
        let (part, primitive) = self.part(primitive);
        part.geometry.closest_point(primitive, point)
    }

    fn winding_number(&self, primitive: u32, point: Vec3) -> f64 {
        let (part, primitive) = self.part(primitive);
        part.geometry.winding_number(primitive, point)
    }

    fn intersect_all(
        &self,
        primitive: u32,
        ray: &PreparedRay,
        found: &mut dyn FnMut(PrimitiveHit),
    ) {
        let (part, primitive) = self.part(primitive);
        part.geometry.intersect_all(primitive, ray, found);
    }

    fn mask(&self, primitive: u32) -> u32 {
        let (part, primitive) = self.part(primitive);
        part.mask & part.geometry.mask(primitive)
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (part, primitive) = self.part(hit.primitive);
        part.geometry.surface_point(ray, &Hit { primitive, ..*hit })
    }
}
