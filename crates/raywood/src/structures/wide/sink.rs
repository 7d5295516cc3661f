//! Where closest hits go: a slice of hits, or columns.

use crate::simd::{Float, Simd};
use crate::{Hit, HitColumns, HitColumnsMut};

/// The hits of sixteen rays.
pub(super) struct SixteenHits<F> {
    pub(super) t: F,
    pub(super) u: F,
    pub(super) v: F,
    /// The bits of primitive numbers.
    pub(super) primitives: [f32; 16],
    /// Where something is hit.
    pub(super) hit: u32,
}

/// A place for each ray's hit.
pub(super) trait Sink {
    /// The same for some of the rays.
    type Part<'a>: Sink
    where
        Self: 'a;

    /// The places of `count` rays from `start` on.
    fn part(&mut self, start: usize, count: usize) -> Self::Part<'_>;

    /// Writes what a ray hit.
    fn set(&mut self, ray: usize, hit: Option<Hit>);

    /// Writes what sixteen rays from `start` on hit.
    fn set_sixteen<S: Simd>(&mut self, simd: S, start: usize, hits: SixteenHits<S::F16>);

    /// Asks for the memory to be written to.
    fn prefetch<S: Simd>(&self, simd: S);
}

impl Sink for &mut [Option<Hit>] {
    type Part<'a>
        = &'a mut [Option<Hit>]
    where
        Self: 'a;

    #[inline(always)]
    fn part(&mut self, start: usize, count: usize) -> &mut [Option<Hit>] {
        &mut self[start..start + count]
    }

    #[inline(always)]
    fn set(&mut self, ray: usize, hit: Option<Hit>) {
        self[ray] = hit;
    }

    #[inline(always)]
    fn set_sixteen<S: Simd>(&mut self, _: S, start: usize, hits: SixteenHits<S::F16>) {
        let (t, u, v) = (hits.t.to_array(), hits.u.to_array(), hits.v.to_array());
        for (lane, hit) in self[start..].iter_mut().take(16).enumerate() {
            let primitive = hits.primitives[lane].to_bits();
            let found = Hit { t: t[lane], u: u[lane], v: v[lane], primitive, instance: 0 };
            *hit = (primitive != HitColumns::NONE).then_some(found);
        }
    }

    #[inline(always)]
    fn prefetch<S: Simd>(&self, simd: S) {
        simd.prefetch_slice(self);
    }
}

impl Sink for HitColumnsMut<'_> {
    type Part<'a>
        = HitColumnsMut<'a>
    where
        Self: 'a;

    #[inline(always)]
    fn part(&mut self, start: usize, count: usize) -> HitColumnsMut<'_> {
        HitColumnsMut::part(self, start, count)
    }

    #[inline(always)]
    fn set(&mut self, ray: usize, hit: Option<Hit>) {
        HitColumnsMut::set(self, ray, hit);
    }

    #[inline(always)]
    fn set_sixteen<S: Simd>(&mut self, simd: S, start: usize, hits: SixteenHits<S::F16>) {
        let zero = simd.splat16(0.0);
        let t = simd.splat16(f32::INFINITY).replaced(hits.hit, hits.t).to_array();
        let u = zero.replaced(hits.hit, hits.u).to_array();
        let v = zero.replaced(hits.hit, hits.v).to_array();
        let primitives = hits.primitives.map(f32::to_bits);
        let places = self.t[start..].first_chunk_mut::<16>();
        if let Some(places) = places {
            *places = t;
            self.u[start..start + 16].copy_from_slice(&u);
            self.v[start..start + 16].copy_from_slice(&v);
            self.primitive[start..start + 16].copy_from_slice(&primitives);
        } else {
            let count = self.len() - start;
            self.t[start..].copy_from_slice(&t[..count]);
            self.u[start..].copy_from_slice(&u[..count]);
            self.v[start..].copy_from_slice(&v[..count]);
            self.primitive[start..].copy_from_slice(&primitives[..count]);
        }
    }

    #[inline(always)]
    fn prefetch<S: Simd>(&self, simd: S) {
        simd.prefetch_slice(self.t);
        simd.prefetch_slice(self.u);
        simd.prefetch_slice(self.v);
        simd.prefetch_slice(self.primitive);
    }
}
