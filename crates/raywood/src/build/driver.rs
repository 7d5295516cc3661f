//! The recursion that every top-down builder shares: in place like quicksort, over an array of boxes with numbers.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::quicksort::select;
use super::{Cancelled, PackedAabb, Primitive, Work};
use crate::structures::{Bvh2, MAX_DEPTH, Node};
use crate::{Aabb, BuildError, Geometry, parallel};

/// Sets larger than this build their two halves in parallel.
pub(super) const PARALLEL_SUBTREES: usize = 4096;

/// Sets larger than this may be divided in parallel, which takes room for as many primitives again.
pub(super) const LARGE_SET: usize = 1 << 15;

/// Chooses how a set of primitives is divided: the part in which top-down builders differ.
pub(crate) trait Splitter: Sync {
    /// Whether it makes use of [`Set::spare`].
    const USES_SPARE: bool = false;

    /// Permutes the set so that the left child's primitives come first and tells how many these are and what is around both children, or says by
    /// `None` that the set should be a leaf.
    ///
    /// The answer must depend on the arguments alone, never on timing or threads. Splits of large sets ask [`Set::work`] now and then whether to go on; if not, any
    /// answer will do.
    fn split(&self, set: &mut Set<'_>) -> Option<Split>;
}

/// Some primitives, to be divided: at least two.
pub(crate) struct Set<'a> {
    pub(super) primitives: &'a mut [Primitive],
    /// Room for as many primitives, for those who would rather copy them than swap; empty for sets up to [`LARGE_SET`].
    pub(super) spare: &'a mut [Primitive],
    /// What is around them.
    pub(super) around: Around,
    /// To be asked while a large set is divided.
    pub(super) work: Work<'a>,
}

/// What is around some primitives.
#[derive(Clone, Copy)]
pub(crate) struct Around {
    /// The box around their boxes.
    pub(crate) bounds: PackedAabb,
    /// The box around the centres of these.
    pub(super) centers: PackedAabb,
}

impl Around {
    pub(super) const NOTHING: Self = Self { bounds: PackedAabb::EMPTY, centers: PackedAabb::EMPTY };

    /// Makes it what is around another primitive too.
    #[inline(always)]
    pub(super) fn include(&mut self, primitive: &Primitive) {
        self.bounds.grow(primitive.bounds());
        self.centers = self.centers.including(primitive.center());
    }

    /// Makes it what is around both.
    #[inline(always)]
    pub(super) fn grow(&mut self, other: &Self) {
        self.bounds.grow(&other.bounds);
        self.centers.grow(&other.centers);
    }

    pub(super) fn of(primitives: &[Primitive]) -> Self {
        parallel::fold(primitives, Self::NOTHING, Self::include, Self::grow)
    }
}

/// A set of primitives divided in two.
pub(crate) struct Split {
    /// How many primitives go left; neither none nor all.
    pub(super) left_count: usize,
    /// What is around them.
    pub(super) left: Around,
    /// What is around the others.
    pub(super) right: Around,
    /// Whether the set in its new order lies in [`Set::spare`].
    pub(super) in_spare: bool,
}

impl Split {
    /// The set divided as it stands, its first `left_count` primitives to the left.
    pub(super) fn at(primitives: &[Primitive], left_count: usize) -> Self {
        let (left, right) = primitives.split_at(left_count);
        Self { left_count, left: Around::of(left), right: Around::of(right), in_spare: false }
    }
}

/// The bounds of every primitive, checked.
pub(crate) fn primitive_bounds<G: Geometry>(
    geometry: &G,
    work: Work<'_>,
) -> Result<Vec<PackedAabb>, BuildError> {
    map_bounds(geometry, work, |_, bounds| bounds)
}

/// Every primitive, its bounds checked.
pub(super) fn primitives<G: Geometry>(
    geometry: &G,
    work: Work<'_>,
) -> Result<Vec<Primitive>, BuildError> {
    map_bounds(geometry, work, Primitive::new)
}

/// `f` of every primitive's number and bounds, which are checked.
fn map_bounds<G: Geometry, T: Send>(
    geometry: &G,
    work: Work<'_>,
    f: impl Fn(u32, PackedAabb) -> T + Send + Sync,
) -> Result<Vec<T>, BuildError> {
    let primitives = geometry.len();
    if primitives > BuildError::MAX_PRIMITIVES {
        return Err(BuildError::TooManyPrimitives { primitives });
    }
    let first_bad = AtomicUsize::new(usize::MAX);
    let mapped = parallel::map_watched(primitives, work, |primitive| {
        let bounds = PackedAabb::from(geometry.bounds(primitive as u32));
        if !bounds.is_sound() {
            first_bad.fetch_min(primitive, Ordering::Relaxed);
        }
        f(primitive as u32, bounds)
    })?;
    match first_bad.into_inner() {
        usize::MAX => Ok(mapped),
        primitive => {
            let primitive = primitive as u32;
            Err(BuildError::BadBounds { primitive, bounds: geometry.bounds(primitive) })
        }
    }
}

/// Builds the tree over a geometry. The same for any number of threads.
pub(super) fn build<G: Geometry, S: Splitter>(
    geometry: &G,
    splitter: &S,
    work: Work<'_>,
) -> Result<Bvh2, BuildError> {
    let [listing, building] = work.shares([1.0, 20.0]);
    let primitives = primitives(geometry, listing)?;
    Ok(build_over(primitives, splitter, building)?)
}

/// Builds the tree over (checked) primitives, numbered from 0. The same for any number of threads.
pub(super) fn build_over<S: Splitter>(
    mut primitives: Vec<Primitive>,
    splitter: &S,
    work: Work<'_>,
) -> Result<Bvh2, Cancelled> {
    let n = primitives.len();
    let Some(&some) = primitives.first() else {
        return Ok(Bvh2::from_parts(Vec::new(), Vec::new()));
    };
    let [making_room, growing, copying] = work.shares([1.0, 50.0, 2.0]);
    let spare = if S::USES_SPARE && n > LARGE_SET { n } else { 0 };
    let mut spare = parallel::map_watched(spare, making_room, |_| some)?;
    let mut indices = vec![0; n];
    let around = Around::of(&primitives);
    let set = Set { primitives: &mut primitives, spare: &mut spare, around, work: growing };
    let tree = grow(splitter, Place { set, indices: &mut indices, first: 0, depth: 1 })?;
    drop((primitives, spare));

    Ok(Bvh2::from_parts(tree.into_nodes(copying)?, indices))
}

/// What a subtree is built from.
struct Place<'a> {
    set: Set<'a>,
    /// Where the numbers of its primitives go in the end.
    indices: &'a mut [u32],
    /// Where these start in the array of all.
    first: usize,
    /// The level of its root, from 1.
    depth: usize,
}

/// A subtree that was built: small ones in one piece by one thread, so that nobody has to know beforehand where nodes will lie.
pub(super) enum Subtree {
    /// All nodes depth first, pair by pair, the root first; numbers of nodes count from it.
    Piece(Vec<Node>),
    /// Two subtrees and the box around both.
    Pair(PackedAabb, Box<[Self; 2]>),
}

/// Builds a subtree, in parallel if it is large.
fn grow<S: Splitter>(splitter: &S, place: Place<'_>) -> Result<Subtree, Cancelled> {
    let Place { mut set, indices, first, depth } = place;
    let (count, work) = (set.primitives.len(), set.work);
    work.check()?;
    if count <= PARALLEL_SUBTREES {
        let mut nodes = Vec::with_capacity(count);
        nodes.push(Node::leaf(set.around.bounds.into(), first as u32, count as u32));
        subdivide(
            splitter,
            set.primitives,
            &set.around,
            Reached { number: 0, first, depth },
            &mut nodes,
        );
        write_numbers(set.primitives, indices);
        work.done()?;
        return Ok(Subtree::Piece(nodes));
    }
    // Every level below takes about as long as this one.
    let levels = (count as f64).log2();
    let [dividing, growing] = work.shares([1.0, levels]);
    let bounds = set.around.bounds;
    let split = split(splitter, &mut set, depth);
    dividing.done()?;
    let Some(Split { left_count, left, right, in_spare }) = split else {
        write_numbers(set.primitives, indices);
        let leaf = Node::leaf(bounds.into(), first as u32, count as u32);
        growing.done()?;
        return Ok(Subtree::Piece(vec![leaf]));
    };

    let Set { primitives, spare, .. } = set;
    let (primitives, spare) = if in_spare { (spare, primitives) } else { (primitives, spare) };
    let (left_primitives, right_primitives) = primitives.split_at_mut(left_count);
    let (left_spare, right_spare) = spare.split_at_mut(left_count.min(spare.len()));
    let (left_indices, right_indices) = indices.split_at_mut(left_count);
    let [left_work, right_work] =
        growing.shares([left_primitives.len() as f64, right_primitives.len() as f64]);
    let depth = depth + 1;
    let below_left = Place {
        set: Set {
            primitives: left_primitives,
            spare: room(left_spare),
            around: left,
            work: left_work,
        },
        indices: left_indices,
        first,
        depth,
    };
    let below_right = Place {
        set: Set {
            primitives: right_primitives,
            spare: room(right_spare),
            around: right,
            work: right_work,
        },
        indices: right_indices,
        first: first + left_count,
        depth,
    };
    let (left, right) =
        parallel::join_if(true, || grow(splitter, below_left), || grow(splitter, below_right));
    Ok(Subtree::Pair(bounds, Box::new([left?, right?])))
}

/// Divides a set as the splitter wants to, but in the middle where the tree might else become too deep.
fn split<S: Splitter>(splitter: &S, set: &mut Set<'_>, depth: usize) -> Option<Split> {
    match must_halve(set.primitives.len(), depth) {
        true => Some(split_at_median(set)),
        false => splitter.split(set),
    }
}

/// Whether only halving, from here on, keeps the depth within the traversal's stack. The set's node lies on level `depth`, from 1.
pub(super) fn must_halve(count: usize, depth: usize) -> bool {
    depth + count.next_power_of_two().trailing_zeros() as usize >= MAX_DEPTH
}

/// The spare room of a set, which small sets do without.
fn room(spare: &mut [Primitive]) -> &mut [Primitive] {
    if spare.len() > LARGE_SET { spare } else { &mut [] }
}

/// Writes down the order of primitives.
fn write_numbers(primitives: &[Primitive], indices: &mut [u32]) {
    for (primitive, index) in primitives.iter().zip(indices) {
        *index = primitive.number();
    }
}

/// Where the recursion has come to.
struct Reached {
    /// The number of the set's node in the piece.
    number: usize,
    /// Where the set's primitives start in the array of all.
    first: usize,
    /// The node's level, from 1.
    depth: usize,
}

/// Divides the last node but those to its right, a leaf over all of the set, as long as the splitter wants to.
fn subdivide<S: Splitter>(
    splitter: &S,
    primitives: &mut [Primitive],
    around: &Around,
    Reached { number, first, depth }: Reached,
    nodes: &mut Vec<Node>,
) {
    if primitives.len() == 1 {
        return;
    }
    let mut set = Set { primitives, spare: &mut [], around: *around, work: Work::UNWATCHED };
    let Some(Split { left_count, left, right, .. }) = split(splitter, &mut set, depth) else {
        return;
    };
    let (left_primitives, right_primitives) = set.primitives.split_at_mut(left_count);
    debug_assert!(!left_primitives.is_empty() && !right_primitives.is_empty());

    // The children lie side by side, the left one's descendants follow, then the right one's.
    let child = nodes.len();
    let middle = first + left_count;
    nodes[number] = Node::interior(around.bounds.into(), child as u32);
    nodes.push(Node::leaf(left.bounds.into(), first as u32, left_count as u32));
    let right_count = right_primitives.len() as u32;
    nodes.push(Node::leaf(right.bounds.into(), middle as u32, right_count));
    let depth = depth + 1;
    let reached = Reached { number: child, first, depth };
    subdivide(splitter, left_primitives, &left, reached, nodes);
    let reached = Reached { number: child + 1, first: middle, depth };
    subdivide(splitter, right_primitives, &right, reached, nodes);
}

impl Subtree {
    /// The box around it.
    pub(super) fn bounds(&self) -> PackedAabb {
        match self {
            Self::Piece(nodes) => nodes[0].bounds().into(),
            Self::Pair(bounds, _) => *bounds,
        }
    }

    /// All nodes depth first, pair by pair, the root first.
    pub(super) fn into_nodes(self, work: Work<'_>) -> Result<Vec<Node>, Cancelled> {
        if let Self::Piece(nodes) = self {
            work.done()?;
            return Ok(nodes);
        }
        let [making_room, copying] = work.shares([1.0, 1.0]);
        let mut nodes = making_room.copies(Node::leaf(Aabb::EMPTY, 0, 1), self.len())?;
        let (root, descendants) = nodes.split_at_mut(1);
        self.copy_to(&mut root[0], descendants, 1, copying)?;
        Ok(nodes)
    }

    /// How many nodes it has.
    fn len(&self) -> usize {
        match self {
            Self::Piece(nodes) => nodes.len(),
            Self::Pair(_, children) => 1 + children[0].len() + children[1].len(),
        }
    }

    /// Copies the root to its place, and all other nodes to theirs, the first of which has the given number.
    fn copy_to(
        &self,
        root: &mut Node,
        descendants: &mut [Node],
        first: usize,
        work: Work<'_>,
    ) -> Result<(), Cancelled> {
        work.check()?;
        match self {
            Self::Piece(nodes) => {
                let moved = |node: &Node| match node.is_leaf() {
                    true => *node,
                    false => node.with_children_at(node.left_first() + first as u32 - 1),
                };
                *root = moved(&nodes[0]);
                for (node, copy) in nodes[1..].iter().zip(descendants) {
                    *copy = moved(node);
                }
                work.done()
            }
            Self::Pair(bounds, children) => {
                *root = Node::interior((*bounds).into(), first as u32);
                let (pair, below) = descendants.split_at_mut(2);
                let (left_root, right_root) = pair.split_at_mut(1);
                let below_left = children[0].len() - 1;
                let (left, right) = below.split_at_mut(below_left);
                let [left_work, right_work] = work.shares([left.len() as f64, right.len() as f64]);
                let behind_left = first + 2 + below_left;
                let (left, right) = parallel::join_if(
                    true,
                    || children[0].copy_to(&mut left_root[0], left, first + 2, left_work),
                    || children[1].copy_to(&mut right_root[0], right, behind_left, right_work),
                );
                left.and(right)
            }
        }
    }
}

/// Halves a set by the order of its centroids along the axis on which these spread most. Always succeeds.
pub(super) fn split_at_median(set: &mut Set<'_>) -> Split {
    let axis = Aabb::from(set.around.centers).extent().max_axis();
    let left_count = set.primitives.len() / 2;
    let selected = select(set.primitives, left_count, set.work, |a, b| {
        let by_center = a.center()[axis].total_cmp(&b.center()[axis]);
        by_center.then_with(|| a.number().cmp(&b.number()))
    });
    match selected {
        Ok(()) => Split::at(set.primitives, left_count),
        Err(Cancelled) => {
            let nothing = Around::NOTHING;
            Split { left_count, left: nothing, right: nothing, in_spare: false }
        }
    }
}

/// Divides a set by a property of each primitive; `None` if all or none have it.
pub(super) fn partition_by(
    set: &mut Set<'_>,
    goes_left: impl Fn(&Primitive) -> bool,
) -> Option<Split> {
    let (work, count) = (set.work.without_progress(), set.primitives.len());
    let mut left_count = 0;
    work.in_stretches(count, |stretch| {
        left_count = partition_stretch(set.primitives, left_count, stretch, &goes_left);
    })
    .ok()?;
    let divides = 0 < left_count && left_count < count;
    divides.then(|| Split::at(set.primitives, left_count))
}

/// Moves what goes left among a stretch of items to the end of the `left_count` that were found before, and tells how many these are then.
#[inline]
pub(super) fn partition_stretch<T>(
    items: &mut [T],
    mut left_count: usize,
    stretch: Range<usize>,
    goes_left: impl Fn(&T) -> bool,
) -> usize {
    // Every item is swapped to the end of those that go left, which counts it among them or not: no branch to be foreseen.
    for place in stretch {
        let goes_left = goes_left(&items[place]);
        items.swap(place, left_count);
        left_count += usize::from(goes_left);
    }
    left_count
}
