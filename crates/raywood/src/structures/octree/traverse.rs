//! The way of a ray through the octree: front to back, by the distances to the planes that bound and divide each cell, in the
//! spirit of Revelles, Ureña and Lastra, "An Efficient Parametric Algorithm for Octree Traversal", WSCG 2000.
//!
//! Theirs steps from octant to octant by comparing distances, and follows one chain of cells. Here all octants are tested as slabs with
//! the slack that every structure has, so that rays in planes and through edges visit all the cells they touch.

use super::cell::{middle, octant};
use super::{MAX_LEVELS, Node, Octree};
use crate::minmax::{larger, smaller};
use crate::traverse::slab::lengthened;
use crate::{Aabb, PreparedRay, Probe, Vec3};

/// An interior cell some of whose octants are still to be visited.
#[derive(Clone, Copy)]
struct Frame {
    node: Node,
    cell: Aabb,
    /// These octants, numbered as the ray meets them.
    waiting: u8,
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
    let flip = ray.entry_corners[0] | ray.entry_corners[1] << 1 | ray.entry_corners[2] << 2;
    let mut limit = ray.t_max;

    // At most one frame a level.
    let empty = Frame { node: Node::default(), cell: Aabb::EMPTY, waiting: 0 };
    let mut stack = [empty; MAX_LEVELS];
    let mut height = 0;
    let (mut node, mut cell) = (root, tree.bounds);
    loop {
        probe.nodes(1);
        let octants = node.octants();
        if octants == 0 {
            let Some(nearer) = visit(probe, tree.leaf_primitives(&node)) else { return };
            limit = nearer;
        } else {
            probe.boxes(octants.count_ones() as usize);
            let waiting = flipped(octants, flip) & touched(ray, &cell, limit);
            if waiting != 0 {
                stack[height] = Frame { node, cell, waiting };
                height += 1;
            }
        }

        // On to the next octant that begins before the limit. An octant comes after all those that the ray could leave for it: their
        // numbers along the ray have fewer bits set, so they are smaller.
        let end = lengthened(limit);
        (node, cell) = loop {
            if height == 0 {
                return;
            }
            let top = &mut stack[height - 1];
            let number = top.waiting.trailing_zeros() as usize ^ flip;
            let (parent, child) = (top.node, octant(&top.cell, middle(&top.cell), number));
            top.waiting &= top.waiting - 1;
            if top.waiting == 0 {
                height -= 1;
            }
            if entry(ray, &child) <= end {
                break (tree.nodes[parent.child(number)], child);
            }
        };
    }
}

/// A set of octants renumbered as a ray meets them: along each axis whose bit is set in `flip` the other way round.
#[inline]
fn flipped(set: u8, flip: usize) -> u8 {
    let x = if flip & 1 != 0 { (set & 0x55) << 1 | (set >> 1) & 0x55 } else { set };
    let y = if flip & 2 != 0 { (x & 0x33) << 2 | (x >> 2) & 0x33 } else { x };
    if flip & 4 != 0 { y.rotate_left(4) } else { y }
}

/// The octants of a cell that the ray meets before the limit, numbered as it meets them: bit `a` of the number is set in those
/// that are further along axis `a`.
#[inline]
fn touched(ray: &PreparedRay, cell: &Aabb, limit: f32) -> u8 {
    let ends = [cell.min.to_array(), cell.max.to_array()];
    let middle = middle(cell).to_array();
    let (mut near, mut far) = ([ray.t_min; 8], [limit; 8]);
    for axis in 0..3 {
        let first = ray.entry_corners[axis] & 1;
        let enter = distance(ray, axis, ends[first][axis]);
        let cross = distance(ray, axis, middle[axis]);
        let leave = distance(ray, axis, ends[1 - first][axis]);
        for number in 0..8 {
            let further = number >> axis & 1 == 1;
            near[number] = larger(if further { cross } else { enter }, near[number]);
            far[number] = smaller(if further { leave } else { cross }, far[number]);
        }
    }
    (0..8).fold(0, |set, i| set | u8::from(near[i] <= lengthened(far[i])) << i)
}

/// The distance at which the ray enters a box, if it does.
#[inline]
fn entry(ray: &PreparedRay, bounds: &Aabb) -> f32 {
    let corners: [&Vec3; 2] = [&bounds.min, &bounds.max];
    (0..3).fold(ray.t_min, |near, axis| {
        larger(distance(ray, axis, corners[ray.entry_corners[axis] & 1][axis]), near)
    })
}

/// The distance to a plane across an axis: the formula of the slab test, monotone in the plane. NaN for a ray in the plane.
#[inline]
fn distance(ray: &PreparedRay, axis: usize, plane: f32) -> f32 {
    (plane - ray.origin[axis]) * ray.reciprocal[axis]
}
