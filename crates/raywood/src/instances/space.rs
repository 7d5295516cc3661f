//! What lies near a region of the scene's space: one walk through all levels for closest points and overlaps.
//!
//! Distances under scaling and shear are not those of the object's space. So it is the object that is taken into the scene, in double precision: the corners of a triangle when it
//! is looked at, and around each box of its tree an upright box of the scene.

use std::ops::ControlFlow;

use super::frustum::FrustumSearch;
use super::pairs::PairSearch;
use super::place::Placement;
use super::solid::{Enclosure, InsideSearch};
use super::sphere_cast::SweptSearch;
use super::view::{Limits, View};
use super::walk::WalkSearch;
use super::{Tlas, Traceable, Transform};
use crate::double::{Double3, add, cross, dot, double, largest_magnitude, scale};
use crate::geometry::round_down;
use crate::simd::{Float, Kernel, Simd, SimdLevel, dispatch_on};
use crate::structures::WideNode;
use crate::structures::wide::parts::Told;
use crate::structures::wide::search::{Leaf, Query, SearchStack, planes};
use crate::structures::wide::top::TopQuery;
use crate::{Aabb, Bvh, Geometry, Vec3, WideBvh};

/// An affine transform in double precision: what transforms of several levels are together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Affine {
    pub(super) rows: [[f64; 4]; 3],
}

impl Affine {
    pub(super) const IDENTITY: Self =
        Self { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };

    /// Another one, and after it this.
    pub(super) fn after(&self, first: &Transform) -> Self {
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

/// The rounding of coordinates in double precision, per unit of their largest term.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

impl Affine {
    /// An upright box around one that is placed: rounded outwards, and larger by `slack` for each unit of the largest coordinate, or of `farthest`. Finite, of a finite one.
    pub(super) fn bounds(&self, bounds: &Aabb, slack: f64, farthest: f64) -> Aabb {
        let (low, high) = (double(bounds.min), double(bounds.max));
        let [mut min, mut max] = [[0.0; 3]; 2];
        let mut terms = [0.0; 3];
        for axis in 0..3 {
            let row = &self.rows[axis];
            let (mut least, mut greatest, mut term) = (row[3], row[3], row[3].abs());
            for column in 0..3 {
                let (a, b) = (row[column] * low[column], row[column] * high[column]);
                least += a.min(b);
                greatest += a.max(b);
                term += a.abs().max(b.abs());
            }
            (min[axis], max[axis], terms[axis]) = (least, greatest, term);
        }
        let margin = (slack + ROUNDING) * largest_magnitude(terms) + slack * farthest;
        Aabb {
            min: Vec3::from(min.map(|x| round_down(x - margin).max(f32::MIN))),
            max: Vec3::from(max.map(|x| -round_down(-(x + margin)).max(f32::MIN))),
        }
    }

    /// Where points come from, whatever transform this is; `None` where no numbers are large enough.
    pub(super) fn back_in_general(&self, points: [Double3; 3]) -> Option<[Double3; 3]> {
        let row = |i: usize| [self.rows[i][0], self.rows[i][1], self.rows[i][2]];
        let (a, b, c) = (row(0), row(1), row(2));
        // The columns of the inverse, but for the determinant.
        let columns = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = dot(a, columns[0]);
        let back = points.map(|p| {
            let [x, y, z] = [0, 1, 2].map(|i| (p[i] - self.rows[i][3]) / determinant);
            add(scale(x, columns[0]), add(scale(y, columns[1]), scale(z, columns[2])))
        });
        back.as_flattened().iter().all(|x| x.is_finite()).then_some(back)
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

/// What can be searched where it stands: what [`Tlas::closest_point`], [`Tlas::overlapping`] and [`Tlas::solid`] ask for. Types of one's own that are a [`Bvh`] or a [`Tlas`] hand everything on to it.
pub trait Searchable: Traceable {
    /// Has the search look at what is near.
    fn search(&self, search: &mut SpaceSearch<'_>) -> ControlFlow<()>;

    /// Tells of what touches a frustum.
    fn search_frustum(&self, search: &mut FrustumSearch<'_>) -> ControlFlow<()>;

    /// Looks for what a moving sphere touches first.
    fn search_swept(&self, search: &mut SweptSearch<'_>);

    /// Tells of what touches another geometry.
    fn search_pairs(&self, search: &mut PairSearch<'_>) -> ControlFlow<()>;

    /// Walks through the boxes.
    fn walk_boxes(&self, walk: &mut WalkSearch<'_>) -> ControlFlow<()>;

    /// Sums up what [`encloses`](Self::encloses) needs to know. O(N).
    fn enclosure(&self) -> Enclosure;

    /// Whether a point is inside, by what was summed up of this object.
    fn encloses(&self, enclosure: &Enclosure, search: &mut InsideSearch<'_>) -> bool;
}

impl SpaceSearch<'_> {
    /// How what is searched now looks from the region, if it reaches no further from zero than that along any axis.
    fn view(&self, reach: f32) -> View {
        View::new([self.min, self.max], &self.placed, reach)
    }
}

impl<B: Searchable> Searchable for Tlas<B> {
    fn search(&self, search: &mut SpaceSearch<'_>) -> ControlFlow<()> {
        let (placements, tree) = (&self.built.placements[..], &self.built.tree);
        let view = search.view(tree.reach());
        let limits = view.limits(search.limit);
        let level = self.level;
        tree.search(&mut SearchInstances { placements, level, view, limits, search })
    }

    fn search_frustum(&self, search: &mut FrustumSearch<'_>) -> ControlFlow<()> {
        search.through_scene(self)
    }

    fn search_swept(&self, search: &mut SweptSearch<'_>) {
        search.through_scene(self);
    }

    fn search_pairs(&self, search: &mut PairSearch<'_>) -> ControlFlow<()> {
        search.through_scene(self)
    }

    fn walk_boxes(&self, walk: &mut WalkSearch<'_>) -> ControlFlow<()> {
        walk.through_scene(self)
    }

    fn enclosure(&self) -> Enclosure {
        Enclosure::of_scene(self)
    }

    fn encloses(&self, enclosure: &Enclosure, search: &mut InsideSearch<'_>) -> bool {
        enclosure.holds_in_scene(self, search)
    }
}

/// A search through the instances of a scene.
struct SearchInstances<'s, 'a, B> {
    placements: &'s [Placement<B>],
    level: SimdLevel,
    view: View,
    limits: Limits,
    search: &'s mut SpaceSearch<'a>,
}

/// Looks at the children of a node.
struct Children<'a> {
    view: &'a View,
    node: &'a WideNode,
    limit: f32,
}

impl Kernel for Children<'_> {
    type Output = (u32, [f32; 16]);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let (near, squares) = self.view.boxes(simd, planes(self.node), self.limit);
        (near, squares.to_array())
    }
}

impl<B: Searchable> TopQuery for SearchInstances<'_, '_, B> {
    fn children(&mut self, node: &WideNode) -> (u32, [f32; 16]) {
        let (view, limit) = (&self.view, self.limits.boxes);
        dispatch_on(self.level, Children { view, node, limit })
    }

    fn limit(&self) -> f32 {
        self.limits.boxes
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
        self.limits = self.view.limits(search.limit);
        flow
    }
}

impl<G: Geometry + Send> Searchable for Bvh<G> {
    fn search(&self, search: &mut SpaceSearch<'_>) -> ControlFlow<()> {
        let (tree, geometry) = (&self.tree, &self.geometry);
        dispatch_on(tree.level(), SearchTree { tree, geometry, search })
    }

    fn search_frustum(&self, search: &mut FrustumSearch<'_>) -> ControlFlow<()> {
        search.through_tree(self)
    }

    fn search_swept(&self, search: &mut SweptSearch<'_>) {
        search.through_tree(self);
    }

    fn search_pairs(&self, search: &mut PairSearch<'_>) -> ControlFlow<()> {
        search.through_tree(self)
    }

    fn walk_boxes(&self, walk: &mut WalkSearch<'_>) -> ControlFlow<()> {
        walk.through_tree(self)
    }

    fn enclosure(&self) -> Enclosure {
        Enclosure::of_tree(self)
    }

    fn encloses(&self, enclosure: &Enclosure, search: &mut InsideSearch<'_>) -> bool {
        enclosure.holds_in_tree(self, search)
    }
}

/// A search through a tree.
struct SearchTree<'s, 'a, G> {
    tree: &'s WideBvh,
    geometry: &'s G,
    search: &'s mut SpaceSearch<'a>,
}

impl<G: Geometry> Kernel for SearchTree<'_, '_, G> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let Self { tree, geometry, search } = self;
        let view = search.view(tree.reach());
        let limits = view.limits(search.limit);
        let mut query = SearchPrimitives { geometry, view, limits, told: tree.told(), search };
        tree.search(simd, &mut SearchStack::new(tree), &mut query)
    }
}

/// A search among the primitives of a tree.
struct SearchPrimitives<'s, 'a, G> {
    geometry: &'s G,
    view: View,
    limits: Limits,
    told: Told<'s>,
    search: &'s mut SpaceSearch<'a>,
}

impl<G> SearchPrimitives<'_, '_, G> {
    /// Nothing counts any more beyond the square of this distance.
    fn shorten(&mut self, limit: f64) {
        if limit != self.search.limit {
            self.search.limit = limit;
            self.limits = self.view.limits(limit);
        }
    }
}

impl<'t, G: Geometry> Query<'t> for SearchPrimitives<'_, '_, G> {
    #[inline(always)]
    fn children<S: Simd>(&mut self, simd: S, node: &WideNode) -> (u32, S::F16) {
        self.view.boxes(simd, planes(node), self.limits.boxes)
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limits.boxes
    }

    #[inline(always)]
    fn leaf<S: Simd>(&mut self, simd: S, leaf: Leaf<'t>) -> ControlFlow<()> {
        let instance = self.search.first;
        if leaf.triangles != 0 {
            let mut near = self.view.triangles(simd, leaf.block, leaf.triangles, self.limits);
            while let Some(lane) = near.take(simd) {
                let primitive = leaf.block.primitives[lane];
                if self.told.is_new(primitive) {
                    let corners = leaf.block.corners(lane);
                    let corners = corners.map(|corner| self.search.placed.point(double(corner)));
                    let limit =
                        self.search.near.triangle(corners, Numbers { instance, primitive })?;
                    self.shorten(limit);
                    near.keep_within(simd, &self.view, self.limits);
                }
            }
        }
        for primitive in leaf.others() {
            let numbers = Numbers { instance, primitive };
            let limit = self.search.near.other(self.geometry, &self.search.placed, numbers)?;
            self.shorten(limit);
        }
        ControlFlow::Continue(())
    }
}
