//! What lies near a region of the scene's space: one walk through all levels for closest points and overlaps.
//!
//! Distances under scaling and shear are not those of the object's space. So it is the object that is taken into the scene, in double precision: the corners of a triangle when it
//! is looked at, and around each box of its tree an upright box of the scene.

use std::ops::ControlFlow;

use super::place::Placement;
use super::{Tlas, Traceable, Transform};
use crate::double::{Double3, dot, double};
use crate::simd::{Kernel, Simd, dispatch_on};
use crate::structures::WideNode;
use crate::structures::wide::parts::Told;
use crate::structures::wide::search::{Leaf, Planes, Query, SearchStack, lanes, planes};
use crate::structures::wide::top::TopQuery;
use crate::{Bvh, Geometry, WideBvh};

/// An affine transform in double precision: what transforms of several levels are together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Affine {
    rows: [[f64; 4]; 3],
}

impl Affine {
    pub(super) const IDENTITY: Self =
        Self { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };

    /// Another one, and after it this.
    fn after(&self, first: &Transform) -> Self {
        let first = first.rows().map(|row| row.map(f64::from));
        let entry = |row: &[f64; 4], column: usize| {
            row[0] * first[0][column] + row[1] * first[1][column] + row[2] * first[2][column]
        };
        let row = |row: [f64; 4]| {
            let own = [0, 1, 2, 3].map(|column| entry(&row, column));
            [own[0], own[1], own[2], own[3] + row[3]]
        };
        Self { rows: self.rows.map(row) }
    }

    /// Where a point goes.
    #[inline(always)]
    pub(super) fn point(&self, p: Double3) -> Double3 {
        self.rows.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3])
    }

    /// By how much everything becomes larger, if it is by as much in all directions: of what turns, mirrors and scales evenly.
    pub(super) fn similarity(&self) -> Option<f64> {
        let dot = |i: usize, j: usize| self.rows.iter().map(|row| row[i] * row[j]).sum::<f64>();
        let squares = [dot(0, 0), dot(1, 1), dot(2, 2)];
        let mean = (squares[0] + squares[1] + squares[2]) / 3.0;
        let is_even = squares.iter().all(|square| (square - mean).abs() <= UNEVEN * mean);
        let is_upright = [dot(0, 1), dot(1, 2), dot(2, 0)].iter().all(|d| d.abs() <= UNEVEN * mean);
        (is_even && is_upright).then(|| mean.sqrt())
    }

    /// Where a point comes from, under a similarity of this scale.
    pub(super) fn back(&self, point: Double3, scale: f64) -> Double3 {
        let p = [0, 1, 2].map(|i| point[i] - self.rows[i][3]);
        let square = scale * scale;
        [0, 1, 2].map(|j| {
            (self.rows[0][j] * p[0] + self.rows[1][j] * p[1] + self.rows[2][j] * p[2]) / square
        })
    }
}

/// How uneven a similarity's scale may be, as a share of its square: what rounding of some rotations adds up to.
const UNEVEN: f64 = 1.0 / (1 << 20) as f64;

/// A primitive by the numbers that a hit with it would have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbers {
    pub(super) instance: u32,
    pub(super) primitive: u32,
}

/// Looks at primitives near a region. Each returns the square of the distance from the region beyond which nothing counts from there on.
pub(super) trait Near {
    /// Looks at a triangle, by its corners in the scene's space.
    fn triangle(&mut self, corners: [Double3; 3], numbers: Numbers) -> ControlFlow<(), f64>;

    /// Looks at another primitive, which `placed` takes into the scene's space.
    fn other(
        &mut self,
        geometry: &dyn Geometry,
        placed: &Affine,
        numbers: Numbers,
    ) -> ControlFlow<(), f64>;
}

/// A search for what lies near a region: what [`Searchable`]s hand on to each other.
pub struct SpaceSearch<'a> {
    /// A box around the region.
    pub(super) min: Double3,
    pub(super) max: Double3,
    /// The square of the distance from that box beyond which nothing counts; falls.
    pub(super) limit: f64,
    pub(super) mask: u32,
    /// From the space of the object that is searched into the scene's.
    pub(super) placed: Affine,
    /// The number of the object's first instance.
    pub(super) first: u32,
    pub(super) near: &'a mut dyn Near,
}

/// What can be searched where it stands: what [`Tlas::closest_point`] and [`Tlas::overlapping`] ask for. Types of one's own that are a [`Bvh`] or a [`Tlas`] hand the search on to it.
pub trait Searchable: Traceable {
    /// Has the search look at what is near.
    fn search(&self, search: &mut SpaceSearch<'_>) -> ControlFlow<()>;
}

/// How far at least the boxes of an object's tree are from a region, when they are taken into the scene's space.
struct Distances {
    placed: Affine,
    /// The region's box, larger by what rounding may move a transformed box.
    min: Double3,
    max: Double3,
}

/// The rounding of a transformed box, per unit of its largest term.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

impl Distances {
    /// Those of boxes that reach no further from zero than `reach` along any axis.
    fn new(search: &SpaceSearch<'_>, reach: f32) -> Self {
        let SpaceSearch { min, max, placed, .. } = search;
        let slack = |axis: usize, side: f64| {
            let [x, y, z, moved] = placed.rows[axis].map(f64::abs);
            ROUNDING * ((x + y + z) * f64::from(reach) + moved + side.abs())
        };
        Self {
            placed: *placed,
            min: [0, 1, 2].map(|axis| min[axis] - slack(axis, min[axis])),
            max: [0, 1, 2].map(|axis| max[axis] + slack(axis, max[axis])),
        }
    }

    /// The squares of these distances; infinite for children that are not there.
    #[inline(always)]
    fn squares(&self, planes: &Planes) -> [f64; 16] {
        let mut squares = [0.0; 16];
        for (axis, &[x, y, z, moved]) in self.placed.rows.iter().enumerate() {
            // The side of a box that goes farthest down, and the one that goes farthest up.
            let side = |factor: f64, axis: usize| {
                let is_negative = usize::from(factor < 0.0);
                (&planes[axis][is_negative], &planes[axis][1 - is_negative])
            };
            let ((x0, x1), (y0, y1), (z0, z1)) = (side(x, 0), side(y, 1), side(z, 2));
            let (min, max) = (self.min[axis], self.max[axis]);
            for lane in 0..16 {
                let [x0, y0, z0] = [x0[lane], y0[lane], z0[lane]].map(f64::from);
                let [x1, y1, z1] = [x1[lane], y1[lane], z1[lane]].map(f64::from);
                let least = x * x0 + y * y0 + z * z0 + moved;
                let greatest = x * x1 + y * y1 + z * z1 + moved;
                let (above, below) = (least - max, min - greatest);
                let gap = if above > below { above } else { below };
                let gap = if gap > 0.0 { gap } else { 0.0 };
                squares[lane] += gap * gap;
            }
        }
        for ((square, least), greatest) in squares.iter_mut().zip(&planes[0][0]).zip(&planes[0][1])
        {
            *square = if least <= greatest { *square } else { f64::INFINITY };
        }
        squares
    }

    /// Whether the box around some corners comes as near as that.
    #[inline(always)]
    fn are_near(&self, corners: &[Double3; 3], limit: f64) -> bool {
        let gap = |axis: usize| {
            let [a, b, c] = corners.map(|corner| corner[axis]);
            let (above, below) =
                (a.min(b).min(c) - self.max[axis], self.min[axis] - a.max(b).max(c));
            above.max(below).max(0.0)
        };
        let gaps = [gap(0), gap(1), gap(2)];
        dot(gaps, gaps) <= limit
    }
}

impl<B: Searchable> Searchable for Tlas<B> {
    fn search(&self, search: &mut SpaceSearch<'_>) -> ControlFlow<()> {
        let (placements, tree) = (&self.built.placements[..], &self.built.tree);
        let distances = Distances::new(search, tree.reach());
        tree.search(&mut SearchInstances { placements, distances, search })
    }
}

/// A search through the instances of a scene.
struct SearchInstances<'s, 'a, B> {
    placements: &'s [Placement<B>],
    distances: Distances,
    search: &'s mut SpaceSearch<'a>,
}

impl<B: Searchable> TopQuery for SearchInstances<'_, '_, B> {
    fn keys(&self, node: &WideNode) -> [f64; 16] {
        self.distances.squares(planes(node))
    }

    fn limit(&self) -> f64 {
        self.search.limit
    }

    fn entry(&mut self, entry: u32) -> ControlFlow<()> {
        let Self { placements, search, .. } = self;
        let place = &placements[entry as usize];
        if place.mask & search.mask == 0 {
            return ControlFlow::Continue(());
        }
        let (placed, first) = (search.placed, search.first);
        search.placed = placed.after(&place.transform);
        search.first = first + place.first;
        let flow = place.object.search(search);
        (search.placed, search.first) = (placed, first);
        flow
    }
}

impl<G: Geometry + Send> Searchable for Bvh<G> {
    fn search(&self, search: &mut SpaceSearch<'_>) -> ControlFlow<()> {
        let (tree, geometry) = (&self.tree, &self.geometry);
        let distances = Distances::new(search, tree.reach());
        dispatch_on(tree.level(), SearchTree { tree, geometry, distances, search })
    }
}

/// A search through a tree.
struct SearchTree<'s, 'a, G> {
    tree: &'s WideBvh,
    geometry: &'s G,
    distances: Distances,
    search: &'s mut SpaceSearch<'a>,
}

impl<G: Geometry> Kernel for SearchTree<'_, '_, G> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let Self { tree, geometry, distances, search } = self;
        let mut query = SearchPrimitives { geometry, distances, told: tree.told(), search };
        tree.search(simd, &mut SearchStack::new(tree), &mut query)
    }
}

/// A search among the primitives of a tree.
struct SearchPrimitives<'s, 'a, G> {
    geometry: &'s G,
    distances: Distances,
    told: Told<'s>,
    search: &'s mut SpaceSearch<'a>,
}

/// The largest number that is certainly not larger.
#[inline(always)]
fn rounded_down(number: f64) -> f32 {
    let rounded = (number * (1.0 - f64::from(f32::EPSILON))) as f32;
    if rounded < f32::MAX { rounded } else { f32::MAX }
}

impl<'t, G: Geometry> Query<'t> for SearchPrimitives<'_, '_, G> {
    #[inline(always)]
    fn children<S: Simd>(&mut self, simd: S, node: &WideNode) -> (u32, S::F16) {
        let squares = self.distances.squares(planes(node));
        let limit = self.search.limit;
        let (mut chosen, mut keys) = (0, [0.0; 16]);
        for lane in 0..16 {
            let is_near = squares[lane] <= limit && squares[lane] < f64::INFINITY;
            chosen |= u32::from(is_near) << lane;
            keys[lane] = rounded_down(squares[lane]);
        }
        (chosen, simd.load16(&keys))
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        (self.search.limit as f32).next_up()
    }

    #[inline(always)]
    fn leaf<S: Simd>(&mut self, _: S, leaf: Leaf<'t>) -> ControlFlow<()> {
        let Self { geometry, distances, told, search } = self;
        let instance = search.first;
        for lane in lanes(leaf.triangles) {
            let corners = leaf.block.corners(lane);
            let corners = corners.map(|corner| search.placed.point(double(corner)));
            let primitive = leaf.block.primitives[lane];
            if distances.are_near(&corners, search.limit) && told.is_new(primitive) {
                search.limit = search.near.triangle(corners, Numbers { instance, primitive })?;
            }
        }
        for primitive in leaf.others() {
            let numbers = Numbers { instance, primitive };
            search.limit = search.near.other(*geometry, &search.placed, numbers)?;
        }
        ControlFlow::Continue(())
    }
}
