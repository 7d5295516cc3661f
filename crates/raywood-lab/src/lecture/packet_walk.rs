//! Rays that walk through a binary tree together, only to count what they share: the plain form of packet traversal (Wald, Slusallek, Benthin
//! and Wagner, "Interactive Rendering with Coherent Ray Tracing", Eurographics 2001), without anything that would make it fast.

use raywood::{Bvh2, Geometry, Node, PreparedRay, Ray};

use super::lab::PACKET;

/// What packets did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PacketCounts {
    /// Packets that walked.
    pub(super) packets: u64,
    /// Rays in them.
    pub(super) rays: u64,
    /// Nodes that packets visited: at least one ray of each hit their box.
    pub(super) nodes: u64,
    /// Rays that hit the box of a visited node, summed over these.
    pub(super) hits: u64,
}

impl PacketCounts {
    /// The rays of a packet that hit a visited node, on average: how many single visits one visit of the packet stands for.
    pub(super) fn rays_per_node(&self) -> f64 {
        self.hits as f64 / self.nodes as f64
    }

    /// Rays in the packet over the average number of rays that hit a visited node: 1 if all stay together, as many as there are rays
    /// if each goes its own way.
    pub(super) fn coherence(&self) -> f64 {
        self.rays as f64 / self.packets as f64 / self.rays_per_node()
    }
}

/// A ray on its way with others.
struct Traveller {
    ray: PreparedRay,
    /// The closest hit so far, or where the ray ends; before its start once it needs no more answers.
    t_max: f32,
}

/// Walks rays together through the tree, and counts. `any_hit` rays leave at their first hit. Returns the closest distances, by which
/// the walk can be checked.
pub(super) fn walk<G: Geometry>(
    tree: &Bvh2,
    geometry: &G,
    rays: &[Ray],
    any_hit: bool,
    counts: &mut PacketCounts,
) -> Vec<Option<f32>> {
    assert!(rays.len() <= PACKET, "a packet has at most {PACKET} rays");
    counts.packets += 1;
    counts.rays += rays.len() as u64;
    let mut hits = vec![None; rays.len()];
    let mut travellers: Vec<_> = rays
        .iter()
        .map(|ray| PreparedRay::new(ray).map(|ray| Traveller { t_max: ray.t_max, ray }))
        .collect();

    // Nodes to visit with the rays that hit their parent, one bit each.
    let mut stack = Vec::new();
    if let Some(root) = tree.nodes().first() {
        stack.push((root, u64::MAX >> (64 - rays.len().max(1))));
    }
    while let Some((node, candidates)) = stack.pop() {
        let active = hitting(node, candidates, &travellers);
        if active == 0 {
            continue;
        }
        counts.nodes += 1;
        counts.hits += u64::from(active.count_ones());
        if !node.is_leaf() {
            let [near, far] = ordered_children(tree, node, active, &travellers);
            stack.extend([(far, active), (near, active)]);
            continue;
        }
        let first = node.left_first() as usize;
        for &primitive in &tree.primitive_indices()[first..first + node.count() as usize] {
            for i in bits(active) {
                let Some(traveller) = &mut travellers[i] else { continue };
                let Some(hit) = geometry.intersect(primitive, &traveller.ray) else { continue };
                if hit.t < traveller.t_max {
                    hits[i] = Some(hit.t);
                    traveller.t_max = if any_hit { f32::NEG_INFINITY } else { hit.t };
                }
            }
        }
    }
    hits
}

/// Which of the candidates hit the node's box.
fn hitting(node: &Node, candidates: u64, travellers: &[Option<Traveller>]) -> u64 {
    let hits = |i: &usize| travellers[*i].as_ref().is_some_and(|t| entry(node, t).is_some());
    bits(candidates).filter(hits).fold(0, |set, i| set | 1 << i)
}

/// The children, first the one that the first active ray meets first.
fn ordered_children<'a>(
    tree: &'a Bvh2,
    node: &Node,
    active: u64,
    travellers: &[Option<Traveller>],
) -> [&'a Node; 2] {
    let first = node.left_first() as usize;
    let (left, right) = (&tree.nodes()[first], &tree.nodes()[first + 1]);
    let leader = travellers[active.trailing_zeros() as usize].as_ref();
    let distance =
        |child: &Node| leader.and_then(|leader| entry(child, leader)).unwrap_or(f32::INFINITY);
    if distance(left) <= distance(right) { [left, right] } else { [right, left] }
}

/// Where a ray enters a node's box, if it does before its closest hit: the slab test, a little generous.
fn entry(node: &Node, Traveller { ray, t_max }: &Traveller) -> Option<f32> {
    let bounds = node.bounds();
    let (mut near, mut far) = (ray.t_min, *t_max);
    for axis in 0..3 {
        let to_plane = |plane: f32| (plane - ray.origin[axis]) * ray.reciprocal[axis];
        let (a, b) = (to_plane(bounds.min[axis]), to_plane(bounds.max[axis]));
        // `f32::max` and `min` drop the NaN of a ray that runs along a face.
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    (near <= far + far.abs() * 1e-6).then_some(near)
}

/// The places of the bits that are set.
fn bits(set: u64) -> impl Iterator<Item = usize> {
    let mut rest = set;
    std::iter::from_fn(move || {
        let place = (rest != 0).then(|| rest.trailing_zeros() as usize);
        rest &= rest.wrapping_sub(1);
        place
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lecture::shapes;
    use crate::rng::Rng;
    use raywood::BuildOptions;

    #[test]
    fn packets_hit_what_single_rays_hit() {
        let scene = shapes::soup(2_000);
        let mesh = &scene.mesh.triangles;
        let tree = Bvh2::build(mesh, &BuildOptions::default()).expect("a tree");
        let single = raywood::Bvh::build(mesh).expect("a tree");
        let mut rng = Rng::new(3);
        let rays: Vec<_> =
            (0..PACKET).map(|_| Ray::new(3.0 * rng.direction(), rng.direction())).collect();
        let rays: Vec<_> =
            rays.iter().map(|ray| Ray::new(ray.origin, 0.3 * ray.direction - ray.origin)).collect();
        let mut counts = PacketCounts::default();
        let hits = walk(&tree, mesh, &rays, false, &mut counts);
        for (ray, hit) in rays.iter().zip(&hits) {
            // The facade clips distances to boxes, which may move them by a rounding.
            match (single.intersect(ray), hit) {
                (Some(a), Some(b)) => assert!((a.t - b).abs() < 1e-5, "{a:?} {b}"),
                (a, b) => assert_eq!(a.is_some(), b.is_some()),
            }
        }
        assert!(hits.iter().flatten().count() > 10);
        assert!((1.0..=64.0).contains(&counts.coherence()), "{counts:?}");
    }

    #[test]
    fn equal_rays_stay_together_and_one_ray_is_alone() {
        let scene = shapes::soup(2_000);
        let mesh = &scene.mesh.triangles;
        let tree = Bvh2::build(mesh, &BuildOptions::default()).expect("a tree");
        let ray = Ray::new([0.1, 0.2, 5.0], [0.0, 0.0, -1.0]);
        let coherence = |rays: &[Ray]| {
            let mut counts = PacketCounts::default();
            walk(&tree, mesh, rays, false, &mut counts);
            counts.coherence()
        };
        assert_eq!(coherence(&[ray; PACKET]), 1.0);
        assert_eq!(coherence(&[ray]), 1.0);
        let away = Ray::new([9.0, 9.0, 9.0], [1.0, 0.0, 0.0]);
        let mut rays = [away; PACKET];
        rays[0] = ray;
        assert_eq!(coherence(&rays), 64.0);
    }
}
