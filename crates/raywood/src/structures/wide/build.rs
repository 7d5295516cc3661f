//! Building the wide tree from a binary one.

use super::WideBvh;
use super::collapse::{BLOCK_LINES, NODE_LINES, Plan, primitives};
use super::linear;
use super::node::{Reference, WIDTH, WideNode};
use super::parts::Parts;
use super::sharing::Place;
use crate::build::{BuildMemory, Work};
use crate::geometry::{LANES, TriangleBlock};
use crate::simd::{Arena, Part};
use crate::structures::{AccelerationStructure, StructureKind};
use crate::{Aabb, BuildError, BuildOptions, Bvh2, Geometry, SimdLevel, Vec3, parallel};

/// About how long planning takes, in the units of [`Bvh2::cost`].
const PLAN_COST: f64 = 20.0;

/// About how long it takes to fill the tree.
const FILL_COST: f64 = 25.0;

/// Subtrees of more lines are filled in parallel.
const PARALLEL_LINES: usize = 1 << 13;

/// With which options the binary tree is built. Nobody limits its memory any more.
pub(crate) fn binary_options(options: &BuildOptions) -> BuildOptions {
    BuildOptions {
        max_leaf_size: options.max_leaf_size.min(options.clamped().wide_leaf_size),
        memory_limit: None,
        ..options.clone()
    }
}

/// Builds the tree.
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &BuildOptions,
    work: Work<'_>,
) -> Result<WideBvh, BuildError> {
    BuildMemory::check(StructureKind::BvhWide, geometry.len(), options)?;
    if linear::is_asked_for(options) {
        return linear::build(geometry, options, work);
    }
    let allowed = options;
    let options = binary_options(options);
    let [drafting, filling] = work.shares([Draft::best_cost(&options), FILL_COST]);
    let Draft { tree, parts, plan } = Draft::best(geometry, &options, drafting)?;
    let is_node = !tree.nodes().is_empty() && !plan.is_leaf(0);
    let lines = match tree.nodes() {
        [] => 0,
        _ if is_node => NODE_LINES + plan.lines_below(0),
        _ => BLOCK_LINES,
    };
    if lines > Reference::LINES {
        return Err(BuildError::TreeTooLarge { bytes: lines.saturating_mul(64) });
    }
    // Now it is known how large the tree becomes: scenes can be made in which it is larger than was to be expected.
    BuildMemory::check_lists(tree.bytes() + plan.bytes() + 64 * lines, geometry.len(), allowed)?;
    let wide = Wide { geometry, tree: &tree, plan: &plan, parts: &parts, work: filling, lines };
    let filled = Arena::filled(lines, |mut all| match tree.nodes() {
        [] => (Reference::NOTHING, 0),
        _ if is_node => (Reference::node(0), wide.fill(0, all)),
        _ => {
            let primitives = tree.primitive_indices();
            let corners: Vec<_> = primitives.iter().map(|&p| geometry.triangle(p)).collect();
            let mut block = TriangleBlock::default();
            let leaf = wide.leaf(primitives, &corners, (all.first(), false), &mut block);
            all.put(block);
            (leaf, 0)
        }
    });
    let filled = filled.ok_or(BuildError::Cancelled)?;
    Ok(finished(tree.bounds(), geometry.len(), &options, parts, filled))
}

/// A binary tree, and what is to be made of it.
struct Draft {
    tree: Bvh2,
    parts: Parts,
    plan: Plan,
}

impl Draft {
    fn new<G: Geometry>(
        geometry: &G,
        options: &BuildOptions,
        work: Work<'_>,
    ) -> Result<Self, BuildError> {
        let [building, planning] = work.shares([Bvh2::cost_for_wide(options), PLAN_COST]);
        let tree = Bvh2::build_for_wide(geometry, options, building)?;
        let parts = Parts::of(&tree, geometry.len());
        let plan = Plan::new(&tree, &parts, planning)?;
        Ok(Self { tree, parts, plan })
    }

    /// One with triangles cut, if the options ask for that and it costs less than one without: reinsertion finds better trees of whole triangles in some scenes.
    fn best<G: Geometry>(
        geometry: &G,
        options: &BuildOptions,
        work: Work<'_>,
    ) -> Result<Self, BuildError> {
        if !options.cuts_triangles() {
            return Self::new(geometry, options, work);
        }
        let whole = BuildOptions { spatial_splits: 0.0, ..options.clone() };
        let costs = [options, &whole].map(|options| Bvh2::cost_for_wide(options) + PLAN_COST);
        let [cutting, keeping_whole] = work.shares(costs);
        let cut = Self::new(geometry, options, cutting)?;
        let whole = Self::new(geometry, &whole, keeping_whole)?;
        Ok(if cut.plan.cost() < whole.plan.cost() { cut } else { whole })
    }

    /// About how long the best takes.
    fn best_cost(options: &BuildOptions) -> f64 {
        let whole = BuildOptions { spatial_splits: 0.0, ..options.clone() };
        let cost = Bvh2::cost_for_wide(options) + PLAN_COST;
        match options.cuts_triangles() {
            true => cost + Bvh2::cost_for_wide(&whole) + PLAN_COST,
            false => cost,
        }
    }
}

/// The tree of lines that were filled, with its root and how many nodes lie on the longest way from there.
pub(super) fn finished(
    bounds: Aabb,
    primitives: usize,
    options: &BuildOptions,
    parts: Parts,
    (arena, (root, depth)): (Arena, (Reference, usize)),
) -> WideBvh {
    WideBvh {
        bounds,
        primitives: primitives as u32,
        triangle_test: options.triangle_test,
        reach: bounds.min.abs().max(bounds.max.abs()).max_element(),
        parts,
        depth,
        root,
        arena,
        level: SimdLevel::active(),
    }
}

/// What the leaves of a node are made of, kept so that not every node needs memory of its own.
#[derive(Default)]
struct Scratch {
    references: Vec<u32>,
    corners: Vec<Option<[Vec3; 3]>>,
}

/// A wide tree that is being made.
struct Wide<'a, G> {
    geometry: &'a G,
    tree: &'a Bvh2,
    plan: &'a Plan,
    parts: &'a Parts,
    work: Work<'a>,
    /// How many cache lines all of it has.
    lines: usize,
}

impl<G: Geometry> Wide<'_, G> {
    /// Fills the place of node `number` of the binary tree with a wide node and everything below it: first its children side by side, leaves and then nodes, then what is
    /// below the first of these, and so on. Returns how many nodes lie on the longest way down.
    fn fill(&self, number: usize, mut all: Part<'_>) -> usize {
        let place = all.take(NODE_LINES);
        self.fill_below(number, place, all, &mut Scratch::default())
    }

    /// Fills the place of a node and that of everything below it. What is in `scratch` does not matter.
    fn fill_below(
        &self,
        number: usize,
        mut place: Part<'_>,
        mut below: Part<'_>,
        scratch: &mut Scratch,
    ) -> usize {
        let Scratch { references, corners } = scratch;
        let is_large = below.len() > PARALLEL_LINES;
        if is_large && self.work.check().is_err() {
            place.abandon();
            return 0;
        }
        let children = self.plan.children(self.tree, number);
        let leaves = children.numbers().filter(|&child| self.plan.is_leaf(child));
        // All their corners before anything is made of them: they lie all over the memory, and the processor waits for many at a time.
        references.clear();
        leaves.for_each(|leaf| references.extend_from_slice(primitives(self.tree, leaf)));
        corners.clear();
        corners.extend(references.iter().map(|&primitive| self.geometry.triangle(primitive)));

        let sharing = self.plan.sharing(self.tree, self.parts, &children);
        let mut places = below.take(BLOCK_LINES * sharing.blocks);
        let mut blocks = [TriangleBlock::default(); WIDTH];
        let mut unused = &corners[..];
        let mut node = WideNode::EMPTY;
        let mut nodes = [const { None }; WIDTH];
        for (lane, number) in children.numbers().enumerate() {
            let child = if self.plan.is_leaf(number) {
                let primitives = primitives(self.tree, number);
                let (corners, others) = unused.split_at(primitives.len());
                unused = others;
                let Place { block, at_end } = sharing.place(lane);
                let line = places.first() + BLOCK_LINES * block;
                self.leaf(primitives, corners, (line, at_end), &mut blocks[block])
            } else {
                let place = below.take(NODE_LINES);
                let child = Reference::node(place.first());
                nodes[lane] = Some((number, place));
                child
            };
            node.set(lane, &self.tree.nodes()[number].bounds(), child);
        }
        place.put(node);
        blocks[..sharing.blocks].iter().for_each(|&block| places.put(block));

        let tasks = nodes.into_iter().flatten().map(|(number, place)| {
            let below = below.take(self.plan.lines_below(number));
            (number, place, below)
        });
        let deepest = match is_large {
            true => {
                let fill = |(number, place, below): (usize, Part<'_>, Part<'_>)| {
                    let lines = below.len();
                    let depth = self.fill_below(number, place, below, &mut Scratch::default());
                    if lines <= PARALLEL_LINES {
                        // If the build is stopped, the next large node sees it.
                        let _ = self.work.part(lines, self.lines).done();
                    }
                    depth
                };
                parallel::map_tasks(tasks.collect(), fill).into_iter().max()
            }
            false => {
                let fill = |(number, place, below)| self.fill_below(number, place, below, scratch);
                tasks.map(fill).max()
            }
        };
        1 + deepest.unwrap_or(0)
    }

    /// Puts the primitives of a leaf, which are triangles of these corners or none, into lanes of a block.
    #[inline(always)]
    fn leaf(
        &self,
        primitives: &[u32],
        corners: &[Option<[Vec3; 3]>],
        (line, at_end): (usize, bool),
        block: &mut TriangleBlock,
    ) -> Reference {
        let count = self.parts.distinct(primitives).count();
        let first = if at_end { LANES - count } else { 0 };
        let mut mixed = false;
        for (lane, (number, primitive)) in self.parts.distinct(primitives).enumerate() {
            mixed |= corners[number].is_none();
            match corners[number] {
                Some(corners) => block.set(first + lane, primitive, corners),
                None => {
                    let ball = self.geometry.bounding_ball(primitive);
                    block.set_other(first + lane, primitive, ball);
                }
            }
        }
        Reference::leaf(line, count, mixed, at_end)
    }
}
