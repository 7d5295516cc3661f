//! Filling the blocks of all leaves, in the order of the curve, and finding on the way which nodes of the tree above are best kept.

use std::ops::Range;

use super::tree::{Bough, Pair, Piece, Tree};
use super::window::{Window, is_triangle};
use crate::build::{KeyBits, PackedAabb, Work};
use crate::geometry::{LANES, TriangleBlock};
use crate::parallel::join_if;
use crate::simd::Part;
use crate::structures::wide::collapse::BLOCK_LINES;
use crate::structures::wide::division::Trees;
use crate::structures::wide::node::{Reference, WIDTH};
use crate::structures::wide::sharing::{Place, Sharing};
use crate::{Geometry, Vec3};

/// What fills blocks.
pub(super) struct LeafFill<'a, G> {
    pub(super) geometry: &'a G,
    /// All primitives in the order of the curve.
    pub(super) keys: &'a [u64],
    pub(super) bits: KeyBits,
    /// One by half the surface of the box around everything; infinite if that has none.
    pub(super) per_area: f64,
    pub(super) work: Work<'a>,
}

/// What is known of a node: the box around it, and what it costs.
type Known = (PackedAabb, Trees);

impl<G: Geometry> LeafFill<'_, G> {
    /// Fills the blocks of a tree's leaves, which are as many as the part has room for, and completes the tree.
    pub(super) fn fill(&self, tree: &mut Tree, mut blocks: Part<'_>) -> Known {
        if self.work.check().is_err() {
            blocks.abandon();
            return (PackedAabb::EMPTY, Trees::one(0.0));
        }
        match tree {
            Tree::Piece(piece) => {
                let known = self.piece(piece, &mut blocks);
                // If the build is stopped, the next piece sees it.
                let _ = self.work.part(piece.span().len(), self.keys.len()).done();
                known
            }
            Tree::Pair(pair) => {
                let Pair { children: [left, right], division, .. } = &mut **pair;
                let left_blocks = blocks.take(BLOCK_LINES * left.sizes().blocks);
                let (left, right) =
                    join_if(true, || self.fill(left, left_blocks), || self.fill(right, blocks));
                let (known, best) = self.node(&left, &right);
                *division = best;
                known
            }
        }
    }

    fn piece(&self, piece: &mut Piece, blocks: &mut Part<'_>) -> Known {
        let mut window = Window::default();
        window.read(self.geometry, self.keys, self.bits, piece.span());
        piece.leaves = vec![PackedAabb::EMPTY; piece.starts.len() - 1];
        self.bough(piece, piece.root, blocks, &window)
    }

    fn bough(
        &self,
        piece: &mut Piece,
        bough: Bough,
        blocks: &mut Part<'_>,
        window: &Window,
    ) -> Known {
        match bough {
            Bough::Group { first, count } => self.group(piece, (first, count), blocks, window),
            Bough::Branch(number) => {
                let [left, right] = piece.branches[number as usize].children;
                let left = self.bough(piece, left, blocks, window);
                let right = self.bough(piece, right, blocks, window);
                let (known, best) = self.node(&left, &right);
                piece.branches[number as usize].division = best;
                known
            }
        }
    }

    /// A node with two children.
    fn node(&self, left: &Known, right: &Known) -> (Known, [u8; WIDTH]) {
        let bounds = left.0.union(right.0);
        let area = self.area(&bounds);
        let (trees, division) = Trees::of_node(&left.1, &right.1, |below| area + below);
        ((bounds, trees), division)
    }

    /// Fills the blocks of the leaves of a group.
    fn group(
        &self,
        piece: &mut Piece,
        (first, count): (u32, u32),
        blocks: &mut Part<'_>,
        window: &Window,
    ) -> Known {
        let sharing = Sharing::of(&piece.leaf_sizes(first, count));
        let mut places = [const { None }; WIDTH];
        for place in &mut places[..sharing.blocks] {
            let line = blocks.first();
            *place = Some((line, blocks.put_default::<TriangleBlock>()));
        }
        let mut whole = PackedAabb::EMPTY;
        let mut areas = 0.0;
        for lane in 0..count as usize {
            let number = first as usize + lane;
            let Place { block, at_end } = sharing.place(lane);
            let Some((line, block)) = &mut places[block] else { continue };
            let (bounds, mixed) = self.leaf(piece.leaf(number), at_end, block, window);
            let size = piece.leaf(number).len();
            let reference = Reference::leaf(*line, size, mixed, at_end);
            piece.leaves[number] = bounds.with_tag(reference.0);
            whole.grow(&bounds);
            areas += self.area(&bounds);
        }
        // One node, or nothing but leaves.
        let as_one = if count > 1 { self.area(&whole) + areas } else { areas };
        let mut trees = Trees::one(as_one);
        trees.most = count as usize;
        trees.costs[1..count as usize].fill(as_one);
        trees.costs[count as usize - 1] = areas;
        (whole, trees)
    }

    /// Puts a leaf into lanes of a block. Tells the box around it, and whether there are primitives in it that are no triangles.
    #[inline(always)]
    fn leaf(
        &self,
        span: Range<usize>,
        at_end: bool,
        block: &mut TriangleBlock,
        window: &Window,
    ) -> (PackedAabb, bool) {
        let (keys, corners) = (&self.keys[span.clone()], window.corners(span));
        let first_lane = if at_end { LANES - keys.len() } else { 0 };
        let mut bounds = box_around(corners);
        let mut mixed = false;
        for (number, (&key, corners)) in keys.iter().zip(corners).enumerate() {
            let (lane, primitive) = (first_lane + number, self.bits.number(key));
            if is_triangle(corners) {
                block.set(lane, primitive, corners.map(|[x, y, z, _]| Vec3::new(x, y, z)));
            } else {
                mixed = true;
                bounds.grow(&self.geometry.bounds(primitive).into());
                block.set_other(lane, primitive, self.geometry.bounding_ball(primitive));
            }
        }
        (bounds, mixed)
    }

    /// How often rays meet a box: its surface relative to the whole's, so that it neither overflows nor vanishes; of a line every part is met as often as the whole.
    fn area(&self, bounds: &PackedAabb) -> f32 {
        match self.per_area < f64::INFINITY {
            true => (bounds.half_area() * self.per_area) as f32,
            false => 1.0,
        }
    }
}

/// The box around the corners of triangles; others do not count. A function of its own, for the compiler makes better loops of it so.
#[inline(never)]
fn box_around(corners: &[[[f32; 4]; 3]]) -> PackedAabb {
    corners
        .as_flattened()
        .iter()
        .fold(PackedAabb::EMPTY, |bounds, &corner| bounds.including(corner))
}
