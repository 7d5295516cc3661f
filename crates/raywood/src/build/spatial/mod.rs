//! Spatial splits: trees in which triangles may lie in several leaves, each of which knows a part of them. Stich, Friedrich and Dietrich, "Spatial Splits
//! in Bounding Volume Hierarchies", HPG 2009.
//!
//! A large triangle among small ones makes the boxes around it large, whatever set it is put into. Where the boxes of the best two sets overlap, a plane that cuts
//! space, and the triangles that it crosses, may cost less. References live in one array with room for more of them, which goes along with the sets: so sets are
//! divided in place, and how much is cut does not depend on threads.

mod bins;
mod cut;
pub(crate) mod margin;
mod partition;

use super::driver::{self, Around, PARALLEL_SUBTREES, Set, Split, Splitter};
use super::sah_binned::BinnedSah;
use super::{Cancelled, PackedAabb, Primitive, Work};
use crate::structures::{Bvh2, Node};
use crate::{Aabb, BuildError, BuildOptions, Geometry, Vec3, parallel};
use bins::best_cut;
use partition::partition;

/// A cut is looked for only where the boxes of the best two sets share at least so much of the root's surface. Ten times less costs half of the build's time
/// more and gains nothing.
const LEAST_OVERLAP: f64 = 1e-3;

/// About how long it takes, in the units of [`Bvh2::cost_for_wide`].
pub(super) const COST: f64 = 1000.0;
/// Builds the binary tree, in parallel. A primitive may lie in several leaves, whose boxes are around parts of it. The same for any number of threads.
///
/// # Errors
///
/// Too many primitives, one whose box is empty or not finite, or the wish to stop.
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &BuildOptions,
    work: Work<'_>,
) -> Result<Bvh2, BuildError> {
    let options = options.clamped();
    let [listing, building] = work.shares([1.0, 100.0]);
    let mut references = driver::primitives(geometry, listing)?;
    let count = references.len();
    let Some(&some) = references.first() else {
        return Ok(Bvh2::from_parts(Vec::new(), Vec::new()));
    };
    let around = Around::of(&references);
    let room = (f64::from(options.spatial_splits) * count as f64) as usize;
    references.resize((count + room).min(BuildError::MAX_PRIMITIVES), some);

    let least_overlap = LEAST_OVERLAP * around.bounds.half_area();
    let margin = margin::margin(&around.bounds.into());
    let objects = BinnedSah::new(&options);
    let builder = SpatialBuilder { geometry, least_overlap, margin, objects };
    let set = References { references: &mut references, count, around };
    let mut tree = builder.grow(set, 1, building)?;
    fit(&mut tree.nodes);
    Ok(Bvh2::from_parts(tree.nodes, tree.numbers))
}

/// Makes the boxes of interior nodes those around their children.
fn fit(nodes: &mut [Node]) {
    for number in (0..nodes.len()).rev() {
        let node = nodes[number];
        if !node.is_leaf() {
            let left = node.left_first() as usize;
            let bounds = nodes[left].bounds().union(nodes[left + 1].bounds());
            nodes[number] = node.with_bounds(bounds);
        }
    }
}

/// References to be divided.
struct References<'a> {
    /// Those of the set, and behind them room for more.
    references: &'a mut [Primitive],
    /// How many there are.
    count: usize,
    /// What is around them.
    around: Around,
}

/// A subtree: all nodes depth first, pair by pair, the root first, and the primitives' numbers in the order of leaves. Both are numbered from its own first.
#[derive(Default)]
struct Subtree {
    nodes: Vec<Node>,
    numbers: Vec<u32>,
}

/// What all sets are divided by.
struct SpatialBuilder<'a, G> {
    geometry: &'a G,
    /// See [`LEAST_OVERLAP`]; half an area.
    least_overlap: f64,
    /// See [`margin`].
    margin: f32,
    objects: BinnedSah,
}

impl<G: Geometry> SpatialBuilder<'_, G> {
    /// Builds a subtree whose root lies on level `depth`, from 1; in parallel if it is large.
    fn grow(
        &self,
        mut set: References<'_>,
        depth: usize,
        work: Work<'_>,
    ) -> Result<Subtree, Cancelled> {
        work.check()?;
        let bounds = set.around.bounds;
        if set.count > PARALLEL_SUBTREES {
            // Every level below takes about as long as this one.
            let levels = (set.count as f64).log2();
            let [dividing, growing] = work.shares([1.0, levels]);
            let divided = self.divide(&mut set, depth, dividing);
            dividing.done()?;
            if let Some(divided) = divided {
                let [left, right] = set.split_at(&divided);
                let [left_work, right_work] =
                    growing.shares([left.count as f64, right.count as f64]);
                let (left, right) = parallel::join_if(
                    true,
                    || self.grow(left, depth + 1, left_work),
                    || self.grow(right, depth + 1, right_work),
                );
                return Ok(Subtree::of(bounds, [left?, right?]));
            }
        }
        let mut tree = Subtree::default();
        tree.nodes.push(Node::leaf(bounds.into(), 0, 0));
        self.subdivide(set, (0, depth), &mut tree);
        // Many of them wait to be put together.
        tree.nodes.shrink_to_fit();
        tree.numbers.shrink_to_fit();
        work.done()?;
        Ok(tree)
    }

    /// Makes node `number` that of a set, and appends what is below it.
    fn subdivide(
        &self,
        mut set: References<'_>,
        (number, depth): (usize, usize),
        tree: &mut Subtree,
    ) {
        let bounds = set.around.bounds.into();
        let Some(divided) = self.divide(&mut set, depth, Work::UNWATCHED) else {
            let references = &set.references[..set.count];
            let first = tree.numbers.len() as u32;
            tree.numbers.extend(references.iter().map(Primitive::number));
            let bounds =
                references.iter().fold(Aabb::EMPTY, |all, part| all.union(self.enlarged(part)));
            tree.nodes[number] = Node::leaf(bounds, first, set.count as u32);
            return;
        };
        let child = tree.nodes.len();
        tree.nodes[number] = Node::interior(bounds, child as u32);
        tree.nodes.extend([Node::leaf(bounds, 0, 0); 2]);
        let [left, right] = set.split_at(&divided);
        self.subdivide(left, (child, depth + 1), tree);
        self.subdivide(right, (child + 1, depth + 1), tree);
    }

    /// The box of a reference with its margin.
    fn enlarged(&self, reference: &Primitive) -> Aabb {
        let Aabb { min, max } = Aabb::from(*reference.bounds());
        let margin = Vec3::splat(self.margin);
        let larger = Aabb { min: min - margin, max: max + margin };
        larger.intersection(&self.geometry.bounds(reference.number()))
    }

    /// Divides a set in two, the left one's references first, or says by `None` that it should be a leaf.
    fn divide(&self, set: &mut References<'_>, depth: usize, work: Work<'_>) -> Option<Split> {
        let References { references, count, around } = set;
        if *count == 1 {
            return None;
        }
        let mut objects =
            Set { primitives: &mut references[..*count], spare: &mut [], around: *around, work };
        if driver::must_halve(*count, depth) {
            return Some(driver::split_at_median(&mut objects));
        }
        let split = self.objects.split(&mut objects)?;
        if references.len() == *count || split.overlap() < self.least_overlap {
            return Some(split);
        }
        let cost = split.cost(*count);
        let cut = best_cut(self.geometry, &references[..*count], &around.bounds, work);
        let cut = cut.filter(|cut| cut.cost < cost);
        let cut = cut.and_then(|cut| partition(self.geometry, references, *count, cut.plane, work));
        let Some((cut, total)) = cut else { return Some(split) };
        *count = total;
        Some(cut)
    }
}

impl<'a> References<'a> {
    /// The two sets that it was divided into. The room left goes to where more is to be gained: in proportion to what they cost.
    fn split_at(self, split: &Split) -> [Self; 2] {
        let Self { references, count, .. } = self;
        let Split { left_count, left, right, .. } = *split;
        let right_count = count - left_count;
        let room = references.len() - count;
        let cost = |around: &Around, count: usize| around.bounds.half_area() * count as f64;
        let (left_cost, right_cost) = (cost(&left, left_count), cost(&right, right_count));
        // Not a number, where nothing costs anything, is none.
        let left_room = (room as f64 * (left_cost / (left_cost + right_cost))) as usize;
        let left_end = left_count + left_room.min(room);
        references.copy_within(left_count..count, left_end);
        let (left_references, right_references) = references.split_at_mut(left_end);
        [
            Self { references: left_references, count: left_count, around: left },
            Self { references: right_references, count: right_count, around: right },
        ]
    }
}

impl Split {
    /// Half the surface of what both boxes share.
    fn overlap(&self) -> f64 {
        let (left, right) = (Aabb::from(self.left.bounds), Aabb::from(self.right.bounds));
        let shared = left.intersection(&right);
        if shared.is_empty() { 0.0 } else { shared.half_area() }
    }

    /// `N_l*A_l + N_r*A_r` in half areas, of so many primitives in all.
    fn cost(&self, count: usize) -> f64 {
        let (left_count, right_count) = (self.left_count as f64, (count - self.left_count) as f64);
        left_count * self.left.bounds.half_area() + right_count * self.right.bounds.half_area()
    }
}

impl Subtree {
    /// Two subtrees as one, in the given box.
    fn of(bounds: PackedAabb, [left, right]: [Self; 2]) -> Self {
        let mut nodes = Vec::with_capacity(1 + left.nodes.len() + right.nodes.len());
        // What lies below the pair of roots comes to lie behind it, first that of the left one.
        let below_left = 3 - 1;
        let below_right = below_left + left.nodes.len() - 1;
        let moved = |node: &Node, below: usize, first: usize| match node.is_leaf() {
            true => Node::leaf(node.bounds(), node.left_first() + first as u32, node.count()),
            false => node.with_children_at(node.left_first() + below as u32),
        };
        let middle = left.numbers.len();
        let from_left = |node: &Node| moved(node, below_left, 0);
        let from_right = |node: &Node| moved(node, below_right, middle);
        nodes.push(Node::interior(bounds.into(), 1));
        nodes.extend([from_left(&left.nodes[0]), from_right(&right.nodes[0])]);
        nodes.extend(left.nodes[1..].iter().map(from_left));
        nodes.extend(right.nodes[1..].iter().map(from_right));
        let mut numbers = left.numbers;
        numbers.reserve_exact(right.numbers.len());
        numbers.extend(right.numbers);
        Self { nodes, numbers }
    }
}
