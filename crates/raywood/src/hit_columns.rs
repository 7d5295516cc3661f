//! The answers to many closest-hit queries, number by number.

use crate::Hit;

/// Closest hits of many rays as columns: a place of each column a ray.
///
/// Where [`Hit`]s are read as wholes, a slice of them does as well; columns are written faster, 16 rays at a time, and are what vector code
/// and array libraries read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HitColumns {
    /// Distances in units of the direction's length; infinite where nothing is hit.
    pub t: Vec<f32>,
    /// First surface coordinates, as [`Hit::u`]; 0 where nothing is hit.
    pub u: Vec<f32>,
    /// Second surface coordinates, as [`Hit::v`]; 0 where nothing is hit.
    pub v: Vec<f32>,
    /// Which primitive; [`HitColumns::NONE`] where nothing is hit.
    pub primitive: Vec<u32>,
    /// Which instance, as [`Hit::instance`]; empty where there are no instances, which means 0 for all.
    pub instance: Vec<u32>,
}

impl HitColumns {
    /// Stands for a primitive where nothing is hit.
    pub const NONE: u32 = u32::MAX;

    /// Columns for `count` rays that hit nothing.
    pub fn new(count: usize) -> Self {
        let mut columns = Self::default();
        columns.resize(count);
        columns
    }

    /// Makes room for exactly `count` rays. New ones hit nothing, and there are no instances.
    pub fn resize(&mut self, count: usize) {
        self.t.resize(count, f32::INFINITY);
        self.u.resize(count, 0.0);
        self.v.resize(count, 0.0);
        self.primitive.resize(count, Self::NONE);
        self.instance.clear();
    }

    /// Takes over hits, their instances too.
    pub(crate) fn assign(&mut self, hits: &[Option<Hit>]) {
        self.resize(hits.len());
        let mut columns = self.as_mut();
        hits.iter().enumerate().for_each(|(ray, hit)| columns.set(ray, *hit));
        self.instance.extend(hits.iter().map(|hit| hit.map_or(0, |hit| hit.instance)));
    }

    /// How many rays.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there is no ray.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// What a ray hit. O(1).
    ///
    /// # Panics
    ///
    /// If there is no such ray.
    pub fn get(&self, ray: usize) -> Option<Hit> {
        let (t, u, v, primitive) = (self.t[ray], self.u[ray], self.v[ray], self.primitive[ray]);
        let instance = self.instance.get(ray).copied().unwrap_or(0);
        (primitive != Self::NONE).then_some(Hit { t, u, v, primitive, instance })
    }

    /// What each ray hit, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Option<Hit>> + '_ {
        (0..self.len()).map(|ray| self.get(ray))
    }

    /// All columns, to be written.
    pub(crate) fn as_mut(&mut self) -> HitColumnsMut<'_> {
        let Self { t, u, v, primitive, instance: _ } = self;
        HitColumnsMut { t, u, v, primitive }
    }
}

/// A part of columns, to be written. All have the same length.
pub struct HitColumnsMut<'a> {
    pub(crate) t: &'a mut [f32],
    pub(crate) u: &'a mut [f32],
    pub(crate) v: &'a mut [f32],
    pub(crate) primitive: &'a mut [u32],
}

impl<'a> HitColumnsMut<'a> {
    /// How many rays.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Writes what a ray hit.
    ///
    /// # Panics
    ///
    /// If there is no such ray.
    #[inline(always)]
    pub fn set(&mut self, ray: usize, hit: Option<Hit>) {
        let (u, v, primitive) =
            hit.map_or((0.0, 0.0, HitColumns::NONE), |hit| (hit.u, hit.v, hit.primitive));
        self.t[ray] = hit.map_or(f32::INFINITY, |hit| hit.t);
        (self.u[ray], self.v[ray], self.primitive[ray]) = (u, v, primitive);
    }

    /// Whether there is no ray.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// The part of `count` rays from `start` on.
    pub(crate) fn part(&mut self, start: usize, count: usize) -> HitColumnsMut<'_> {
        let range = start..start + count;
        HitColumnsMut {
            t: &mut self.t[range.clone()],
            u: &mut self.u[range.clone()],
            v: &mut self.v[range.clone()],
            primitive: &mut self.primitive[range],
        }
    }

    /// The first `count` rays, and the others.
    #[cfg(feature = "rayon")]
    pub(crate) fn split_at(self, count: usize) -> (Self, Self) {
        let (t, t_rest) = self.t.split_at_mut(count);
        let (u, u_rest) = self.u.split_at_mut(count);
        let (v, v_rest) = self.v.split_at_mut(count);
        let (primitive, primitive_rest) = self.primitive.split_at_mut(count);
        (
            Self { t, u, v, primitive },
            Self { t: t_rest, u: u_rest, v: v_rest, primitive: primitive_rest },
        )
    }
}
