//! Every hit of one ray with the wide tree, each crossing once.

use std::ops::ControlFlow;

use super::WideBvh;
use super::node::Reference;
use super::parts::Told;
use super::single::SmallStack;
use super::step::{lanes, others};
use crate::geometry::{BlockHits, TriangleBlock, cross_triangle};
use crate::hit::RayHit;
use crate::simd::{Float, Kernel, Simd};
use crate::traverse::slab::inside_own_bounds;
use crate::{Geometry, Hit, PreparedRay, PrimitiveHit};

/// Who is told of hits, of single precision or double.
pub(crate) trait HitVisitor<H: RayHit = Hit> {
    /// Whether the limit shrinks as hits are found, so that it pays to visit what is near first.
    const LIMIT_SHRINKS: bool;

    /// The distance beyond which hits are of no use; what lies exactly there may still be.
    fn limit(&self) -> H::Distance;

    /// Takes a hit, perhaps one beyond the limit, and says whether to go on.
    fn visit(&mut self, hit: H) -> ControlFlow<()>;
}

/// Tells a visitor of every hit within the ray's interval and up to the visitor's limit, in any order.
pub(super) struct Crossings<'a, V> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a dyn Geometry,
    pub(super) ray: &'a PreparedRay,
    pub(super) visitor: &'a mut V,
}

impl<V: HitVisitor> Kernel for Crossings<'_, V> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let Self { tree, geometry, ray, visitor } = self;
        let told = tree.told();
        let visitor = &mut WithinInterval { t_min: ray.t_min, t_max: ray.t_max, told, visitor };
        let ray = &with_longer_interval(ray);
        let slabs = tree.slabs(ray);
        let mut stack = SmallStack::new(tree);
        let (keys, items) = stack.parts();
        let (mut top, mut current) = (1, tree.root);
        loop {
            if current == Reference::NOTHING {
                return ControlFlow::Continue(());
            }
            if current.is_leaf() {
                let block = tree.block(current);
                let others = others(block, current);
                let triangles = current.lanes() & !others;
                let hits = block.intersect(simd, ray, triangles, visitor.limit());
                if hits.hit != 0 {
                    visit_certain(simd, block, ray, &hits, visitor)?;
                }
                if hits.doubtful | others != 0 {
                    let numbers = &block.primitives;
                    for lane in lanes(hits.doubtful) {
                        visit_doubtful(block, lane, ray, visitor)?;
                    }
                    for lane in lanes(others) {
                        visit_other(geometry, numbers[lane], ray, visitor)?;
                    }
                }
            } else {
                let node = tree.node(current);
                let (met, near) = slabs.children_met(simd, node, visitor.limit());
                top += if V::LIMIT_SHRINKS {
                    simd.push_sorted(met, near, &node.children, (keys, items), top).0
                } else {
                    let (count, _) = simd.push_chosen(met, &node.children, items, top);
                    // All of them will be visited.
                    for &item in &items[top..top + count] {
                        simd.prefetch(tree.address(Reference(item)));
                    }
                    count
                };
            }

            // On to the next; where the limit shrinks, to the next that begins before it.
            top -= 1;
            if V::LIMIT_SHRINKS {
                let end = slabs.end_of_keys(visitor.limit());
                while keys[top] > end {
                    top -= 1;
                }
            }
            current = Reference(items[top]);
        }
    }
}

/// By how much of themselves the ends of the interval are moved apart: twice the error of a distance.
const MARGIN: f32 = 1.0 / 4096.0;

/// The ray over an interval so much longer that bringing a hit into its own box takes it neither in nor out: what counts is where it is then.
fn with_longer_interval(ray: &PreparedRay) -> PreparedRay {
    let mut longer = *ray;
    longer.t_min -= MARGIN * ray.t_min.abs();
    longer.t_max += MARGIN * ray.t_max.abs();
    longer
}

/// Hands on hits within an interval, each once.
struct WithinInterval<'a, V> {
    t_min: f32,
    t_max: f32,
    told: Told<'a>,
    visitor: &'a mut V,
}

impl<V: HitVisitor> HitVisitor for WithinInterval<'_, V> {
    const LIMIT_SHRINKS: bool = V::LIMIT_SHRINKS;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.visitor.limit()
    }

    #[inline(always)]
    fn visit(&mut self, hit: Hit) -> ControlFlow<()> {
        if self.t_min <= hit.t && hit.t < self.t_max && self.told.is_new(hit.primitive) {
            self.visitor.visit(hit)
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// Tells of the triangles of a block that are certainly hit.
#[inline(always)]
fn visit_certain<S: Simd, V: HitVisitor>(
    simd: S,
    block: &TriangleBlock,
    ray: &PreparedRay,
    hits: &BlockHits,
    visitor: &mut V,
) -> ControlFlow<()> {
    let (inside, t) = block.inside_own_bounds(simd, ray, hits);
    let t = t.to_array();
    for lane in lanes(inside) {
        visitor.visit(as_hit(block.primitives[lane], hits.get(lane, t[lane])))?;
    }
    ControlFlow::Continue(())
}

/// Tells of a triangle of which single precision cannot say whether it is hit.
#[cold]
#[inline(never)]
fn visit_doubtful<V: HitVisitor>(
    block: &TriangleBlock,
    lane: usize,
    ray: &PreparedRay,
    visitor: &mut V,
) -> ControlFlow<()> {
    let crossing = cross_triangle(ray, block.corners(lane));
    match crossing.and_then(|hit| inside_own_bounds(ray, hit, &block.bounds(lane))) {
        Some(hit) => visitor.visit(as_hit(block.primitives[lane], hit)),
        None => ControlFlow::Continue(()),
    }
}

/// Tells of the hits with a primitive that is no triangle.
#[cold]
#[inline(never)]
fn visit_other<V: HitVisitor>(
    geometry: &dyn Geometry,
    primitive: u32,
    ray: &PreparedRay,
    visitor: &mut V,
) -> ControlFlow<()> {
    let bounds = geometry.bounds(primitive);
    let mut flow = ControlFlow::Continue(());
    geometry.intersect_all(primitive, ray, &mut |hit| {
        if let (Some(hit), true) = (inside_own_bounds(ray, hit, &bounds), flow.is_continue()) {
            flow = visitor.visit(as_hit(primitive, hit));
        }
    });
    flow
}

/// The hit with a primitive.
#[inline(always)]
pub(super) fn as_hit(primitive: u32, PrimitiveHit { t, u, v }: PrimitiveHit) -> Hit {
    Hit { t, u, v, primitive, instance: 0 }
}
