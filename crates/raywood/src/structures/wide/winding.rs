//! Winding numbers through the wide tree: Barill, Dickson, Schmidt, Levin and Jacobson, "Fast Winding Numbers for Soups and Clouds", ACM Transactions
//! on Graphics 2018.
//!
//! What is far away, beside its size, is seen as one small piece of surface; what is near is taken triangle by triangle, in double precision.

use std::collections::HashMap;
use std::f64::consts::PI;

use super::WideBvh;
use super::node::{Reference, WIDTH};
use super::parts::Told;
use crate::double::{Double3, add, cross, dot, double, scale, single, sub};
use crate::geometry::{LANES, TriangleBlock};
use crate::{Aabb, Geometry};

/// How many times its own radius something must be away to be seen as one piece.
const FAR: f64 = 2.0;

/// What sixteen children look like from afar, in coordinates relative to the tree's centre and size.
#[derive(Clone, Debug)]
struct Children {
    /// The middle of their surface, by axis.
    centers: [[f32; WIDTH]; 3],
    /// The sums of their triangles' normals, as long as the areas, by axis.
    areas: [[f32; WIDTH]; 3],
    /// The squares of the distances from which they can be seen as one piece; infinite where there is no child.
    far: [f32; WIDTH],
    /// The child: of a node twice its number, of a leaf its [`Reference`].
    children: [u32; WIDTH],
}

impl Children {
    const NONE: Self = Self {
        centers: [[0.0; WIDTH]; 3],
        areas: [[0.0; WIDTH]; 3],
        far: [f32::INFINITY; WIDTH],
        children: [Reference::NOTHING.0; WIDTH],
    };
}

/// Writes a vector into a lane of columns.
fn set_column(columns: &mut [[f32; WIDTH]; 3], lane: usize, vector: Double3) {
    for (column, coordinate) in columns.iter_mut().zip(vector) {
        column[lane] = coordinate as f32;
    }
}

/// The sums over some triangles.
struct Sums {
    area: f64,
    /// Centres times areas.
    centers: Double3,
    normals: Double3,
    bounds: Aabb,
}

impl Sums {
    const NONE: Self =
        Self { area: 0.0, centers: [0.0; 3], normals: [0.0; 3], bounds: Aabb::EMPTY };

    fn join(&mut self, other: &Self) {
        self.area += other.area;
        self.centers = add(self.centers, other.centers);
        self.normals = add(self.normals, other.normals);
        self.bounds = self.bounds.union(other.bounds);
    }

    /// Where the surface is, and how far it reaches from there at most.
    fn center_and_radius(&self) -> (Double3, f64) {
        if self.bounds.is_empty() {
            return ([0.0; 3], 0.0);
        }
        let (min, max) = (double(self.bounds.min), double(self.bounds.max));
        let center = match self.area > 0.0 {
            true => scale(1.0 / self.area, self.centers),
            false => scale(0.5, add(min, max)),
        };
        let across = [0, 1, 2].map(|i| (center[i] - min[i]).abs().max((max[i] - center[i]).abs()));
        (center, dot(across, across).sqrt())
    }
}

/// What the nodes of a wide tree look like from afar.
#[derive(Clone, Debug)]
pub(crate) struct Winding {
    nodes: Vec<Children>,
    /// The root, as of [`Children::children`].
    root: u32,
    center: Double3,
    /// One over the tree's size.
    scale: f64,
    /// The lanes of leaves whose primitives belong to leaves before them.
    repeated: HashMap<u32, u32>,
}

impl Winding {
    /// Sums everything up. O(N).
    pub(crate) fn new<G: Geometry>(tree: &WideBvh, geometry: &G) -> Self {
        let bounds = tree.bounds();
        let size = match bounds.is_empty() {
            true => 0.0,
            false => bounds.half_area().sqrt(),
        };
        let scale = if size > 0.0 { 1.0 / size } else { 1.0 };
        let center = match bounds.is_empty() {
            true => [0.0; 3],
            false => double(bounds.center()),
        };
        let repeated = HashMap::new();
        let mut winding = Self { nodes: Vec::new(), root: tree.root.0, center, scale, repeated };
        if tree.root != Reference::NOTHING {
            winding.root = winding.sum_up(tree, geometry, tree.root, &mut tree.told()).1;
        }
        winding
    }

    /// Sums up what a reference means.
    fn sum_up<G: Geometry>(
        &mut self,
        tree: &WideBvh,
        geometry: &G,
        reference: Reference,
        told: &mut Told<'_>,
    ) -> (Sums, u32) {
        let mut sums = Sums::NONE;
        if reference.is_leaf() {
            let mut repeated = 0;
            for (lane, primitive) in tree.primitives_of(reference) {
                if told.is_new(primitive) {
                    sums.join(&sums_of(geometry, primitive));
                } else {
                    repeated |= 1 << lane;
                }
            }
            if repeated != 0 {
                self.repeated.insert(reference.0, repeated);
            }
            return (sums, reference.0);
        }
        let number = self.nodes.len();
        self.nodes.push(Children::NONE);
        for (lane, (_, child)) in tree.node(reference).children().enumerate() {
            let (child_sums, child) = self.sum_up(tree, geometry, child, told);
            let (center, radius) = child_sums.center_and_radius();
            let center = scale(self.scale, sub(center, self.center));
            let area = scale(self.scale * self.scale, child_sums.normals);
            let node = &mut self.nodes[number];
            set_column(&mut node.centers, lane, center);
            set_column(&mut node.areas, lane, area);
            let far = FAR * radius * self.scale;
            node.far[lane] = (far * far) as f32;
            node.children[lane] = child;
            sums.join(&child_sums);
        }
        (sums, 2 * number as u32)
    }

    /// The winding number of the surface around a point.
    #[inline(always)]
    pub(crate) fn around<G: Geometry>(
        &self,
        tree: &WideBvh,
        geometry: &G,
        point: Double3,
        stack: &mut Vec<u32>,
    ) -> f64 {
        let rounded = single(point);
        let mut ones = 0.0;
        let angles = self.angles(tree, point, stack, |block, triangles, others| {
            for lane in super::search::lanes(others) {
                ones += geometry.winding_number(block.primitives[lane], rounded);
            }
            let coordinate =
                |lane: usize, corner, axis| f64::from(block.coordinates(corner, axis)[lane]);
            half_angles(coordinate, triangles, point)
        });
        angles / (4.0 * PI) + ones
    }

    /// The same of a mesh of double precision: the tree stands in its frame, while `corners` are those of its triangles, and `point` a point beside them.
    #[inline(always)]
    pub(crate) fn around_in_double(
        &self,
        tree: &WideBvh,
        (point, in_frame): (Double3, Double3),
        stack: &mut Vec<u32>,
        corners: impl Fn(u32) -> [Double3; 3],
    ) -> f64 {
        let angles = self.angles(tree, in_frame, stack, |block, triangles, _| {
            let mut near = [[[0.0; 3]; 3]; LANES];
            for lane in super::search::lanes(triangles) {
                near[lane] = corners(block.primitives[lane]);
            }
            half_angles(|lane, corner, axis| near[lane][corner][axis], triangles, point)
        });
        angles / (4.0 * PI)
    }

    /// The sum of all solid angles of triangles around a point, 4 pi where they go around once. `half_angles` tells half of the sum of those of a leaf, by the lanes of its triangles and of what is none.
    #[inline(always)]
    fn angles(
        &self,
        tree: &WideBvh,
        point: Double3,
        stack: &mut Vec<u32>,
        mut half_angles: impl FnMut(&TriangleBlock, u32, u32) -> f64,
    ) -> f64 {
        if self.root == Reference::NOTHING.0 {
            return 0.0;
        }
        let place = scale(self.scale, sub(point, self.center));
        let place = [place[0] as f32, place[1] as f32, place[2] as f32];
        let (mut near, mut far) = (0.0, 0.0);
        stack.clear();
        stack.push(self.root);
        while let Some(item) = stack.pop() {
            if item & 1 == 0 {
                let node = &self.nodes[item as usize / 2];
                let (angle, mut close) = seen_as_pieces(node, place);
                far += angle;
                while close != 0 {
                    let child = node.children[close.trailing_zeros() as usize];
                    close &= close - 1;
                    if child != Reference::NOTHING.0 {
                        stack.push(child);
                    }
                }
                continue;
            }
            let leaf = Reference(item);
            let block = tree.block(leaf);
            let others = super::step::others(block, leaf);
            let repeated = match self.repeated.is_empty() {
                true => 0,
                false => self.repeated.get(&leaf.0).copied().unwrap_or(0),
            };
            near += half_angles(block, leaf.lanes() & !others & !repeated, others);
        }
        far + 2.0 * near
    }
}

/// The sums over one primitive.
fn sums_of<G: Geometry>(geometry: &G, primitive: u32) -> Sums {
    let bounds = geometry.bounds(primitive);
    let Some(corners) = geometry.triangle(primitive) else {
        return Sums { bounds, ..Sums::NONE };
    };
    let [a, b, c] = [double(corners[0]), double(corners[1]), double(corners[2])];
    let normal = scale(0.5, cross(sub(b, a), sub(c, a)));
    let area = dot(normal, normal).sqrt();
    let center = scale(1.0 / 3.0, add(a, add(b, c)));
    Sums { area, centers: scale(area, center), normals: normal, bounds }
}

/// The solid angle of all children that are far away, and a set of the others. Plain loops over columns, of which the compiler makes vectors.
#[inline(always)]
fn seen_as_pieces(node: &Children, [px, py, pz]: [f32; 3]) -> (f64, u32) {
    let (mut angles, mut is_close) = ([0.0f32; WIDTH], [0u32; WIDTH]);
    for lane in 0..WIDTH {
        let x = node.centers[0][lane] - px;
        let y = node.centers[1][lane] - py;
        let z = node.centers[2][lane] - pz;
        let square = x * x + y * y + z * z;
        let across = node.areas[0][lane] * x + node.areas[1][lane] * y + node.areas[2][lane] * z;
        let angle = across / (square * square.sqrt());
        let is_far = square > node.far[lane];
        angles[lane] = if is_far { angle } else { 0.0 };
        is_close[lane] = u32::from(!is_far) << lane;
    }
    let (mut angle, mut close) = (0.0f32, 0);
    for lane in 0..WIDTH {
        angle += angles[lane];
        close |= is_close[lane];
    }
    (f64::from(angle), close)
}

/// Half the sum of the solid angles of some triangles, by lane, corner and axis: van Oosterom and Strackee, "The Solid Angle of a Plane Triangle", IEEE Transactions on
/// Biomedical Engineering 1983. Half an angle is that of a complex number, and the product of these has the sum of the angles, but for whole turns,
/// which are counted: one arcus tangent does for all.
#[inline(always)]
fn half_angles(
    coordinate: impl Fn(usize, usize, usize) -> f64,
    chosen: u32,
    point: Double3,
) -> f64 {
    let (mut real, mut imaginary) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        let corner = |corner: usize, axis: usize| coordinate(lane, corner, axis) - point[axis];
        let a = [corner(0, 0), corner(0, 1), corner(0, 2)];
        let b = [corner(1, 0), corner(1, 1), corner(1, 2)];
        let c = [corner(2, 0), corner(2, 1), corner(2, 2)];
        let (la, lb, lc) = (dot(a, a).sqrt(), dot(b, b).sqrt(), dot(c, c).sqrt());
        let volume = dot(a, cross(b, c));
        let other = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        // No angle at all where the point is a corner.
        let size = volume.abs() + other.abs();
        let is_some = chosen >> lane & 1 == 1 && size > 0.0;
        real[lane] = if is_some { other / size } else { 1.0 };
        imaginary[lane] = if is_some { volume / size } else { 0.0 };
    }
    let (mut x, mut y, mut turns) = (1.0, 0.0, 0.0);
    for lane in 0..LANES {
        let (u, v) = (real[lane], imaginary[lane]);
        let product = x * v + y * u;
        if y >= 0.0 && v >= 0.0 && product < 0.0 {
            turns += 1.0;
        } else if y < 0.0 && v < 0.0 && product >= 0.0 {
            turns -= 1.0;
        }
        (x, y) = (x * u - y * v, product);
    }
    y.atan2(x) + 2.0 * PI * turns
}
