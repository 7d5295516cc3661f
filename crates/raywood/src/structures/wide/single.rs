//! One ray through the wide tree.

use super::WideBvh;
use super::node::{Reference, WIDTH};
use super::ray_search::{InSingle, RaySearch, slabs};
use crate::simd::{Kernel, Simd};
use crate::traverse::nearest::Nearest;
use crate::{Geometry, Hit, PreparedRay, Probe, Ray};

/// Looks for the closest hit.
pub(super) struct Closest<'a, P, const FAST: bool> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a dyn Geometry,
    pub(super) ray: &'a Ray,
    pub(super) probe: &'a mut P,
}

impl<P: Probe, const FAST: bool> Kernel for Closest<'_, P, FAST> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Hit> {
        let Self { tree, geometry, ray, probe } = self;
        let ray = PreparedRay::with(simd, ray)?;
        let mut search = InSingle::<FAST>::of(ray, Nearest::new(&ray));
        closest(simd, tree, geometry, &mut search, probe);
        search.hit(geometry)
    }
}

/// Looks for the closest hit up to a limit: what lies beyond may be found or not.
pub(super) struct ClosestWithin<'a, const FAST: bool> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a dyn Geometry,
    pub(super) ray: &'a Ray,
    pub(super) limit: f32,
}

impl<const FAST: bool> Kernel for ClosestWithin<'_, FAST> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Hit> {
        let Self { tree, geometry, ray, limit } = self;
        let ray = PreparedRay::with(simd, ray)?;
        let mut search = InSingle::<FAST>::of(ray, Nearest::within(&ray, limit));
        closest(simd, tree, geometry, &mut search, &mut ());
        search.hit(geometry)
    }
}

/// Finds the closest hit of a ray.
#[inline(always)]
pub(super) fn closest<S: Simd, P: Probe, Q: RaySearch>(
    simd: S,
    tree: &WideBvh,
    scene: Q::Scene<'_>,
    search: &mut Q,
    probe: &mut P,
) {
    let slabs = slabs(search, tree);
    let mut stack = SmallStack::new(tree);
    let (keys, items) = stack.parts();
    let (mut top, mut current) = (1, tree.root);
    loop {
        if current == Reference::NOTHING {
            return;
        }
        probe.nodes(1);
        if current.is_leaf() {
            probe.primitives(current.count());
            let hits = search.test_leaf(simd, tree, current);
            search.take_closest(simd, tree, scene, current, &hits);
        } else {
            let node = tree.node(current);
            probe.boxes(WIDTH);
            let (met, near) = slabs.children_met(simd, node, search.t_max());
            top += simd.push_sorted(met, near, &node.children, (keys, items), top).0;
        }

        // On to the next that begins before the closest hit.
        let end = slabs.end_of_keys(search.t_max());
        current = loop {
            top -= 1;
            if keys[top] <= end {
                break Reference(items[top]);
            }
        };
    }
}

/// Looks for any hit.
pub(super) struct Any<'a, P, const FAST: bool> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a dyn Geometry,
    pub(super) ray: &'a Ray,
    pub(super) probe: &'a mut P,
}

impl<P: Probe, const FAST: bool> Kernel for Any<'_, P, FAST> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { tree, geometry, ray, probe } = self;
        let Some(ray) = PreparedRay::with(simd, ray) else { return false };
        let search = InSingle::<FAST>::of(ray, Nearest::new(&ray));
        is_blocked(simd, tree, geometry, &search, probe)
    }
}

/// Whether anything blocks a ray.
#[inline(always)]
pub(super) fn is_blocked<S: Simd, P: Probe, Q: RaySearch>(
    simd: S,
    tree: &WideBvh,
    scene: Q::Scene<'_>,
    search: &Q,
    probe: &mut P,
) -> bool {
    let slabs = slabs(search, tree);
    let mut stack = SmallStack::new(tree);
    let (keys, items) = stack.parts();
    let (mut top, mut current) = (1, tree.root);
    loop {
        if current == Reference::NOTHING {
            return false;
        }
        probe.nodes(1);
        if current.is_leaf() {
            probe.primitives(current.count());
            let hits = search.test_leaf(simd, tree, current);
            if search.is_blocked_by(simd, tree, scene, current, &hits) {
                return true;
            }
        } else {
            let node = tree.node(current);
            probe.boxes(WIDTH);
            let (met, near) = slabs.children_met(simd, node, search.t_max());
            top += simd.push_sorted(met, near, &node.children, (keys, items), top).0;
        }
        top -= 1;
        current = Reference(items[top]);
    }
}

/// How many items a stack has room for without asking for memory: enough for eight levels, and few trees have more.
const SMALL: usize = 160;

/// The stack of one ray: on the program's own stack unless the tree is unusually deep.
pub(super) struct SmallStack {
    keys: [f32; SMALL],
    items: [u32; SMALL],
    large: (Vec<f32>, Vec<u32>),
}

impl SmallStack {
    #[inline(always)]
    pub(super) fn new(tree: &WideBvh) -> Self {
        let size = tree.stack_size();
        let large = if size > SMALL { (vec![0.0; size], vec![0; size]) } else { (vec![], vec![]) };
        Self { keys: [0.0; SMALL], items: [0; SMALL], large }
    }

    /// The keys and the items.
    #[inline(always)]
    pub(super) fn parts(&mut self) -> (&mut [f32], &mut [u32]) {
        let (keys, items) = if self.large.0.is_empty() {
            (&mut self.keys[..], &mut self.items[..])
        } else {
            (&mut self.large.0[..], &mut self.large.1[..])
        };
        // Below all others lies the end, nearer than any limit.
        (keys[0], items[0]) = (f32::NEG_INFINITY, Reference::NOTHING.0);
        (keys, items)
    }
}
