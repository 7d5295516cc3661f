//! The rays of a packet on their way: which of them are active at a node, after Wald, Boulos and Shirley, TOG 2007, and Overbeck, Ramamoorthi
//! and Mark, RT 2008.

use super::interval::Interval;
use crate::structures::Node;
use crate::traverse::Probe;
use crate::traverse::nearest::Nearest;
use crate::traverse::slab::entry;
use crate::{PreparedRay, Ray};

/// A ray that travels with others.
pub(super) struct Traveller {
    pub(super) ray: PreparedRay,
    /// What it has hit so far.
    pub(super) nearest: Nearest,
    /// Its place in the packet that was asked about.
    pub(super) place: usize,
}

impl Traveller {
    /// Whether the ray enters the node's box before what it has hit.
    #[inline]
    pub(super) fn enters(&self, node: &Node) -> bool {
        entry(&self.ray, self.nearest.t_max(), node).is_some()
    }
}

/// The active rays of a packet at a node: from the first that hits it to the last, whose successor is `end`. Rays between them may miss it.
#[derive(Clone, Copy, Default)]
pub(super) struct Active {
    pub(super) first: usize,
    pub(super) end: usize,
}

/// The valid rays of a packet.
pub(super) struct Travellers {
    all: Vec<Traveller>,
    interval: Interval,
    /// None of them looks further than this: the greatest of their ends, which hits bring nearer.
    t_max: f32,
}

impl Travellers {
    /// Sets out with all rays that can hit anything.
    pub(super) fn new(rays: &[Ray]) -> Self {
        let traveller = |(place, ray)| {
            let ray = PreparedRay::new(ray)?;
            Some(Traveller { nearest: Nearest::new(&ray), ray, place })
        };
        let all: Vec<_> = rays.iter().enumerate().filter_map(traveller).collect();
        let interval = Interval::of(all.iter().map(|traveller| &traveller.ray));
        let mut travellers = Self { all, interval, t_max: 0.0 };
        travellers.rays_were_shortened();
        travellers
    }

    /// All of them; `None` if there are none.
    pub(super) fn everybody(&self) -> Option<Active> {
        (!self.all.is_empty()).then_some(Active { first: 0, end: self.all.len() })
    }

    /// The first of the active rays.
    pub(super) fn leader(&self, active: Active) -> &PreparedRay {
        &self.all[active.first].ray
    }

    /// The active rays.
    pub(super) fn among(&mut self, active: Active) -> &mut [Traveller] {
        &mut self.all[active.first..active.end]
    }

    /// Which of the rays that are active at the parent are active at a node, or `None` if all of them miss it.
    #[inline]
    pub(super) fn active_at<P: Probe>(
        &self,
        node: &Node,
        parent: Active,
        probe: &mut P,
    ) -> Option<Active> {
        let rays = &self.all[parent.first..parent.end];
        // If the first of them hits it, all descend; if not, perhaps none can; else ask one after the other.
        probe.boxes(1);
        let mut skipped = 0;
        if !rays[0].enters(node) {
            probe.boxes(1);
            if self.interval.misses(self.t_max, &node.bounds()) {
                return None;
            }
            let others = &rays[1..];
            let first = others.iter().position(|ray| ray.enters(node));
            probe.boxes(first.map_or(others.len(), |place| place + 1));
            skipped = 1 + first?;
        }
        // From the other end: who is last. If nobody else hits the node, the first one is.
        let others = &rays[skipped + 1..];
        let last = others.iter().rposition(|ray| ray.enters(node));
        probe.boxes(others.len() - last.unwrap_or(0));
        let first = parent.first + skipped;
        Some(Active { first, end: first + 1 + last.map_or(0, |place| place + 1) })
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// How many of the active rays hit a node.
    pub(super) fn hitting(&self, active: Active, node: &Node) -> usize {
        self.all[active.first..active.end].iter().filter(|ray| ray.enters(node)).count()
    }

    /// Notes that rays look less far than before.
    pub(super) fn rays_were_shortened(&mut self) {
        let ends = self.all.iter().map(|traveller| traveller.nearest.t_max());
        self.t_max = ends.fold(f32::NEG_INFINITY, f32::max);
    }

    /// The rays with what they hit.
    pub(super) fn into_iter(self) -> impl Iterator<Item = Traveller> {
        self.all.into_iter()
    }
}
