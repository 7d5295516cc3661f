//! The way of a ray through the octree: front to back, by the distances to the planes that bound and divide each cell, in the
//! spirit of Revelles, Ureña and Lastra, "An Efficient Parametric Algorithm for Octree Traversal", WSCG 2000.
//!
//! Theirs steps from octant to octant by comparing distances, and follows one chain of cells. Here all octants are tested at once, as slabs
//! between planes as thick as `traverse/margins.rs` says, so that rays in planes and through edges visit all the cells they touch.

use super::cell::{middle, octant};
use super::{MAX_LEVELS, Node, Octree};
use crate::minmax::{larger, smaller};
use crate::traverse::margins::Margins;
use crate::{Aabb, PreparedRay, Probe, Vec3};

/// An interior cell some of whose octants are still to be visited.
#[derive(Clone, Copy)]
struct Frame {
    node: Node,
    cell: Aabb,
    middle: Vec3,
    /// These octants, numbered as the ray meets them.
    waiting: u8,
    /// Where the ray enters each octant, numbered so.
    near: [f32; 8],
}

impl Frame {
    const NONE: Self = Self {
        node: Node { first: 0, content: 0 },
        cell: Aabb { min: Vec3::ZERO, max: Vec3::ZERO },
        middle: Vec3::ZERO,
        waiting: 0,
        near: [0.0; 8],
    };
}

/// Shows `visit` the references of every leaf that the ray meets, front to back. The answer is the distance from which on cells are
/// no longer of interest, or `None` to stop.
#[inline]
pub(super) fn walk<P: Probe>(
    tree: &Octree,
    ray: &PreparedRay,
    probe: &mut P,
    mut visit: impl FnMut(&mut P, &[u32]) -> Option<f32>,
) {
    let Some(&root) = tree.nodes.first() else { return };
    let flip = ray.entry_corner(0) | ray.entry_corner(1) << 1 | ray.entry_corner(2) << 2;
    let margins = Margins::new(&tree.bounds, ray);
    let begin = -margins.limit(-ray.t_min);
    let mut end = margins.limit(ray.t_max);

    // At most one frame a level.
    let mut stack = [Frame::NONE; MAX_LEVELS];
    let mut height = 0;
    let (mut node, mut cell) = (root, tree.bounds);
    loop {
        probe.nodes(1);
        if node.count() > 0 {
            let Some(nearer) = visit(probe, tree.leaf_primitives(&node)) else { return };
            end = margins.limit(nearer);
        } else {
            let octants = node.octants();
            probe.boxes(octants.count_ones() as usize);
            let middle = middle(&cell);
            let (touched, near) = meet(ray, &margins, &cell, middle, begin, end);
            let waiting = flipped(octants, flip) & touched;
            if waiting != 0 {
                stack[height] = Frame { node, cell, middle, waiting, near };
                height += 1;
            }
        }

        // On to the next octant that begins before the end. An octant comes after all those that the ray could leave for it: their
        // numbers along the ray have fewer bits set, so they are smaller.
        loop {
            if height == 0 {
                return;
            }
            let top = &mut stack[height - 1];
            let turned = top.waiting.trailing_zeros() as usize;
            top.waiting &= top.waiting - 1;
            if top.waiting == 0 {
                height -= 1;
            }
            if top.near[turned & 7] <= end {
                let number = turned ^ flip;
                node = tree.nodes[top.node.child(number)];
                // Nobody asks where a leaf lies.
                if node.count() == 0 {
                    cell = octant(&top.cell, top.middle, number);
                }
                break;
            }
        }
    }
}

/// A set of octants renumbered as a ray meets them: along each axis whose bit is set in `flip` the other way round.
#[inline]
fn flipped(set: u8, flip: usize) -> u8 {
    let x = if flip & 1 != 0 { (set & 0x55) << 1 | (set >> 1) & 0x55 } else { set };
    let y = if flip & 2 != 0 { (x & 0x33) << 2 | (x >> 2) & 0x33 } else { x };
    if flip & 4 != 0 { y.rotate_left(4) } else { y }
}

/// The octants of a cell that the ray meets in an interval and where it enters each, numbered as it meets them: bit `a` of the number is
/// set in those that are further along axis `a`.
#[inline]
fn meet(
    ray: &PreparedRay,
    margins: &Margins,
    cell: &Aabb,
    middle: Vec3,
    begin: f32,
    end: f32,
) -> (u8, [f32; 8]) {
    let [x, y, z] = [
        halves(ray, margins, cell, middle, 0),
        halves(ray, margins, cell, middle, 1),
        halves(ray, margins, cell, middle, 2),
    ];
    let near_x = [larger(x.near[0], begin), larger(x.near[1], begin)];
    let far_x = [smaller(x.far[0], end), smaller(x.far[1], end)];
    let mut near = [0.0; 8];
    let mut touched = 0;
    for further in 0..4 {
        let (i, j) = (further & 1, further >> 1);
        let near_xy = larger(y.near[j], near_x[i]);
        let far_xy = smaller(y.far[j], far_x[i]);
        near[further] = larger(z.near[0], near_xy);
        near[further + 4] = larger(z.near[1], near_xy);
        touched |= u8::from(near[further] <= smaller(z.far[0], far_xy)) << further;
        touched |= u8::from(near[further + 4] <= smaller(z.far[1], far_xy)) << (further + 4);
    }
    (touched, near)
}

/// Where a ray enters and leaves the half of a cell that it meets first along an axis, and the other. NaN for a ray along the face of a
/// thick plane, which then decides nothing.
struct Halves {
    near: [f32; 2],
    far: [f32; 2],
}

#[inline(always)]
fn halves(ray: &PreparedRay, margins: &Margins, cell: &Aabb, middle: Vec3, axis: usize) -> Halves {
    let (low, high) = (cell.min[axis], cell.max[axis]);
    let (first, last) = if ray.entry_corner(axis) == 0 { (low, high) } else { (high, low) };
    let (margin, reciprocal) = (margins.planes[axis], ray.reciprocal[axis]);
    let first = first - ray.origin[axis];
    let middle = middle[axis] - ray.origin[axis];
    let last = last - ray.origin[axis];
    Halves {
        near: [(first - margin) * reciprocal, (middle - margin) * reciprocal],
        far: [(middle + margin) * reciprocal, (last + margin) * reciprocal],
    }
}
