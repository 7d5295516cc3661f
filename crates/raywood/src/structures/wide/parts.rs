//! Primitives that lie in several leaves, each of which knows the box of a part: what spatial splits make of large triangles.
//!
//! Closest and any hits, closest points and moving spheres do not care how often they see a primitive. Who tells of primitives one by one must not tell of one twice.

use crate::build::part_margin;
use crate::{Aabb, Bvh2, Vec3};

/// Which primitives lie in several leaves.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parts {
    /// A bit each; empty if there are none.
    bits: Vec<u64>,
    /// The middle of the tree's box.
    pub(super) center: Vec3,
    /// How far the box reaches from there along any axis.
    half: f32,
}

impl Parts {
    /// None: every primitive lies in one leaf.
    pub(super) fn none() -> Self {
        Self { bits: Vec::new(), center: Vec3::ZERO, half: 0.0 }
    }

    /// Those that the leaves of a binary tree name more than once.
    pub(super) fn of(tree: &Bvh2, primitives: usize) -> Self {
        let bounds = tree.bounds();
        let references = tree.primitive_indices();
        if references.len() == primitives {
            return Self::none();
        }
        let words = primitives.div_ceil(64);
        let (mut once, mut several) = (vec![0u64; words], vec![0u64; words]);
        for &reference in references {
            let (word, bit) = (reference as usize / 64, 1 << (reference % 64));
            several[word] |= once[word] & bit;
            once[word] |= bit;
        }
        Self::from_bits(several, &bounds)
    }

    /// Those of which the bits are set, of a tree with such a box.
    pub(super) fn from_bits(bits: Vec<u64>, bounds: &Aabb) -> Self {
        if bits.is_empty() {
            return Self::none();
        }
        let (center, half) = part_margin::center_and_half(bounds);
        Self { bits, center, half }
    }

    /// A bit for each primitive; none if there are no parts.
    pub(super) fn bits(&self) -> &[u64] {
        &self.bits
    }

    /// The same of so many primitives: those that are new lie in one leaf each.
    pub(super) fn resized(&self, primitives: usize) -> Self {
        let mut resized = self.clone();
        if self.exist() {
            resized.bits.resize(primitives.div_ceil(64), 0);
        }
        if let (Some(last), used @ 1..) = (resized.bits.last_mut(), primitives % 64) {
            *last &= (1 << used) - 1;
        }
        resized
    }

    /// The same, out of this, which has none then.
    pub(super) fn take_bits(&mut self) -> Vec<u64> {
        std::mem::take(&mut self.bits)
    }

    /// By how much boxes count as larger for a ray that starts at `origin`: nothing where the [margin](part_margin) that the boxes of parts already have is enough.
    #[inline(always)]
    pub(super) fn margin(&self, origin: Vec3) -> f32 {
        if !self.exist() {
            return 0.0;
        }
        self.margin_at((origin - self.center).abs().max_element())
    }

    /// The same for all that starts so far from the [`center`](Self::center) along any axis.
    #[inline(always)]
    pub(super) fn margin_at(&self, distance: f32) -> f32 {
        if !self.exist() || distance <= part_margin::USUAL_DISTANCE * self.half {
            return 0.0;
        }
        part_margin::PER_DISTANCE * (distance + self.half)
    }

    /// Whether there are any.
    #[inline(always)]
    pub(super) fn exist(&self) -> bool {
        !self.bits.is_empty()
    }

    /// Whether the primitive is one of them.
    #[inline(always)]
    pub(super) fn contain(&self, primitive: u32) -> bool {
        self.exist() && self.bits[primitive as usize / 64] >> (primitive % 64) & 1 == 1
    }

    /// The primitives that a leaf of some references has, each once: several parts of one may have come together.
    #[inline(always)]
    pub(super) fn distinct(&self, references: &[u32]) -> impl Iterator<Item = (usize, u32)> {
        references.iter().copied().enumerate().filter(|&(place, primitive)| {
            !self.contain(primitive) || !references[..place].contains(&primitive)
        })
    }

    /// How much memory they take.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.bits[..])
    }
}

/// Which primitives have been told of. Only those that lie in several leaves are remembered.
pub(crate) struct Told<'t> {
    parts: &'t Parts,
    /// In order of their numbers.
    numbers: Vec<u32>,
}

impl<'t> Told<'t> {
    pub(super) fn nothing(parts: &'t Parts) -> Self {
        Self { parts, numbers: Vec::new() }
    }

    /// Whether this is the first time that it is asked about the primitive.
    #[inline(always)]
    pub(crate) fn is_new(&mut self, primitive: u32) -> bool {
        !self.parts.contain(primitive) || self.remember(primitive)
    }

    #[inline(never)]
    fn remember(&mut self, primitive: u32) -> bool {
        match self.numbers.binary_search(&primitive) {
            Ok(_) => false,
            Err(place) => {
                self.numbers.insert(place, primitive);
                true
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structures::AccelerationStructure;
    use crate::structures::wide::WideBvh;
    use crate::structures::wide::node::Reference;
    use crate::{BuildOptions, Geometry, Ray, TriangleMesh};

    /// Random numbers from -1 to 1.
    fn random(seed: u32) -> impl FnMut() -> f32 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        }
    }

    const BEAMS: u32 = 500;

    /// Beams that run through each other askew.
    fn beams() -> TriangleMesh {
        let mut random = random(3);
        let mut corners = Vec::new();
        for _ in 0..BEAMS {
            let mut point = || Vec3::new(random(), random(), random());
            let (from, to) = (point(), point());
            corners.extend([from, to, to + 0.1 * point()]);
        }
        let triangles = (0..BEAMS).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        TriangleMesh::new(corners, triangles).expect("finite")
    }

    /// Where the edges of a triangle cross the planes between its parts: there the boxes of two parts only meet at a corner.
    fn corners_of_parts(mesh: &TriangleMesh, primitive: u32, bounds: &Aabb) -> Vec<(usize, Vec3)> {
        let own = mesh.bounds(primitive);
        let margin = part_margin::margin(&mesh.total_bounds());
        let corners = mesh.corners(primitive);
        let mut found = Vec::new();
        for axis in 0..3 {
            for plane in [bounds.min[axis] + margin, bounds.max[axis] - margin] {
                if own.min[axis] >= plane || plane >= own.max[axis] {
                    continue;
                }
                for edge in 0..3 {
                    let (a, b) = (corners[edge], corners[(edge + 1) % 3]);
                    let share = (plane - a[axis]) / (b[axis] - a[axis]);
                    if 0.0 < share && share < 1.0 {
                        found.push((axis, a + share * (b - a)));
                    }
                }
            }
        }
        found
    }

    #[test]
    fn no_hit_is_lost_where_parts_meet() {
        let mesh = beams();
        let plain = WideBvh::build(&mesh, &BuildOptions::default()).expect("it builds");
        let options = BuildOptions { spatial_splits: 4.0, ..Default::default() };
        let cut = WideBvh::build(&mesh, &options).expect("it builds");
        let mut random = random(9);
        let (mut hits, mut targets) = (0, 0);
        let mut pending = vec![(cut.root, cut.bounds)];
        while let Some((reference, bounds)) = pending.pop() {
            if reference == Reference::NOTHING {
                continue;
            }
            if !reference.is_leaf() {
                pending
                    .extend(cut.node(reference).children().map(|(bounds, child)| (child, bounds)));
                continue;
            }
            for (_, primitive) in cut.primitives_of(reference) {
                for (axis, corner) in corners_of_parts(&mesh, primitive, &bounds) {
                    targets += 1;
                    for trial in 0..200 {
                        // Nearly along the plane or one of the others, so that the slack of the box test does not help; a few roundings beside the corner.
                        let mut direction = [random(), random(), random()];
                        let flat = [0.0, 1e-6, 1e-3, 1.0][trial % 4];
                        direction[axis] *= flat;
                        direction[(axis + 1 + trial / 4 % 2) % 3] *= flat;
                        let direction = Vec3::from(direction).normalize_or_zero();
                        let distance = [1.0, 6.0, 60.0, 2000.0][trial / 8 % 4];
                        let beside = distance * 4.0 * f32::EPSILON;
                        let beside = beside * Vec3::new(random(), random(), random());
                        let ray = Ray::new(corner + beside - distance * direction, direction);
                        let expected = plain.intersect(&mesh, &ray, &mut ());
                        hits += usize::from(expected.is_some_and(|hit| hit.primitive == primitive));
                        assert_eq!(cut.intersect(&mesh, &ray, &mut ()), expected, "{ray:?}");
                    }
                }
            }
        }
        assert!(targets > 100 && hits > 10 * targets, "{hits} hits of {targets} targets");
    }
}
