//! The planes that divide a box into equal cells: where they lie, and which cells a box touches.

use crate::Aabb;

/// The most cells along one axis, so that cell numbers fit 16 bits.
const MAX_RESOLUTION: f64 = 32768.0;

/// A box divided by planes into `resolution[0] * resolution[1] * resolution[2]` cells, numbered along x first, then y, then z.
///
/// Plane `i` of an axis is a function of `i` alone, rounding included: building and tracing see the same planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice {
    min: [f32; 3],
    max: [f32; 3],
    cell: [f32; 3],
    resolution: [i32; 3],
}

/// The cells from `first` to `last`, both counted, on each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Block {
    pub(super) first: [u16; 3],
    pub(super) last: [u16; 3],
}

impl Block {
    /// How many cells the block has.
    pub(super) fn cells(&self) -> u64 {
        (0..3).map(|axis| u64::from(self.last[axis] - self.first[axis]) + 1).product()
    }

    /// The places of its cells, along x first, then y, then z.
    #[inline]
    pub(super) fn indices(&self) -> impl Iterator<Item = [i32; 3]> {
        let (low, high) = (self.first.map(i32::from), self.last.map(i32::from));
        let [mut x, mut y, mut z] = low;
        std::iter::from_fn(move || {
            if z > high[2] {
                return None;
            }
            let index = [x, y, z];
            x += 1;
            if x > high[0] {
                (x, y) = (low[0], y + 1);
                if y > high[1] {
                    (y, z) = (low[1], z + 1);
                }
            }
            Some(index)
        })
    }

    /// Whether the block is a single cell or a row of cells. A connected thing touches all cells of a row it spans.
    pub(super) fn is_row(&self) -> bool {
        (0..3).filter(|&axis| self.last[axis] > self.first[axis]).count() <= 1
    }
}

/// The planes of one axis of a lattice.
#[derive(Clone, Copy)]
pub(super) struct Planes {
    min: f32,
    max: f32,
    cell: f32,
}

impl Planes {
    /// Plane `index`, below the resolution.
    #[inline(always)]
    pub(super) fn inner(&self, index: i32) -> f32 {
        let plane = self.min + index as f32 * self.cell;
        if plane < self.max { plane } else { self.max }
    }
}

impl Lattice {
    /// Divides a finite box into about `cells` cells, never more, as near to cubes as can be: the cube-root rule of Cleary and
    /// Wyvill, "Analysis of an algorithm for fast ray tracing using uniform space subdivision", The Visual Computer 1988.
    ///
    /// An axis that is flatter than a cell gets one; so does one on which numbers are too sparse to tell planes apart.
    pub(super) fn new(bounds: &Aabb, cells: f64) -> Self {
        let (min, max) = (bounds.min.to_array(), bounds.max.to_array());
        // In double precision, where neither the difference of two floats nor the product of three overflows.
        let extent = [0, 1, 2].map(|axis| f64::from(max[axis]) - f64::from(min[axis]));

        // Take the edge of a cube of the right volume; leave out axes that are shorter than this edge; repeat with an area or
        // a length.
        let mut divided = extent.map(|e| e > 0.0);
        let mut edge = f64::INFINITY;
        loop {
            let axes = (0..3).filter(|&axis| divided[axis]);
            let count = axes.clone().count();
            if count == 0 {
                break;
            }
            edge =
                (axes.map(|axis| extent[axis]).product::<f64>() / cells).powf(1.0 / count as f64);
            let too_short = (0..3).filter(|&axis| divided[axis] && extent[axis] < edge);
            let Some(shortest) = too_short.min_by(|&a, &b| extent[a].total_cmp(&extent[b])) else {
                break;
            };
            divided[shortest] = false;
        }

        let resolution = [0, 1, 2].map(|axis| {
            if !divided[axis] {
                return 1;
            }
            // At least 16 floats to a cell.
            let largest = f64::from(min[axis].abs().max(max[axis].abs()));
            let most = extent[axis] / (16.0 * f64::from(f32::EPSILON) * largest);
            (extent[axis] / edge).min(most).clamp(1.0, MAX_RESOLUTION) as i32
        });
        // A single cell may be longer than any number; none times infinity would be none.
        let cell = [0, 1, 2].map(|axis| {
            (extent[axis] / f64::from(resolution[axis])).min(f64::from(f32::MAX)) as f32
        });
        Self { min, max, cell, resolution }
    }

    /// The box around all cells.
    pub(super) fn bounds(&self) -> Aabb {
        Aabb::new(self.min, self.max)
    }

    /// How many cells there are.
    pub(super) fn cells(&self) -> usize {
        self.resolution.iter().map(|&n| n as usize).product()
    }

    /// How many cells there are along an axis.
    #[inline]
    pub(super) fn resolution(&self, axis: usize) -> i32 {
        self.resolution[axis]
    }

    /// The number of a cell.
    #[inline]
    pub(super) fn number(&self, [x, y, z]: [i32; 3]) -> usize {
        let [nx, ny, _] = self.resolution.map(|n| n as usize);
        (z as usize * ny + y as usize) * nx + x as usize
    }

    /// Plane `index` of an axis, counted from 0 to the resolution. Never smaller than the plane before it, for rounding is
    /// monotone; the first and the last are the box's faces.
    #[inline]
    pub(super) fn plane(&self, axis: usize, index: i32) -> f32 {
        let planes = self.planes(axis);
        if index < self.resolution[axis] { planes.inner(index) } else { planes.max }
    }

    /// The planes of an axis.
    #[inline]
    pub(super) fn planes(&self, axis: usize) -> Planes {
        Planes { min: self.min[axis], max: self.max[axis], cell: self.cell[axis] }
    }

    /// What a step along each axis adds to a cell's number.
    #[inline]
    pub(super) fn strides(&self) -> [usize; 3] {
        let [nx, ny, _] = self.resolution.map(|n| n as usize);
        [1, nx, nx * ny]
    }

    /// About the cell of a coordinate: right but for rounding, and within range whatever the coordinate.
    #[inline]
    pub(super) fn near(&self, axis: usize, coordinate: f32) -> i32 {
        // The cast takes NaN to 0.
        let index = ((coordinate - self.min[axis]) / self.cell[axis]) as i32;
        index.clamp(0, self.resolution[axis] - 1)
    }

    /// The cells that a box touches, be it with a face only. The box must touch the lattice.
    pub(super) fn touched(&self, bounds: &Aabb) -> Block {
        let (mut block, mut axis) = (Block { first: [0; 3], last: [0; 3] }, 0);
        for (low, high) in bounds.min.to_array().into_iter().zip(bounds.max.to_array()) {
            block.first[axis] = self.first_reaching(axis, low) as u16;
            block.last[axis] = self.last_reaching(axis, high) as u16;
            axis += 1;
        }
        block
    }

    /// The first cell of an axis that reaches up to a coordinate.
    pub(super) fn first_reaching(&self, axis: usize, coordinate: f32) -> i32 {
        let mut index = self.near(axis, coordinate);
        while index > 0 && self.plane(axis, index) >= coordinate {
            index -= 1;
        }
        while index + 1 < self.resolution[axis] && self.plane(axis, index + 1) < coordinate {
            index += 1;
        }
        index
    }

    /// The last cell of an axis that reaches down to a coordinate.
    pub(super) fn last_reaching(&self, axis: usize, coordinate: f32) -> i32 {
        let mut index = self.near(axis, coordinate);
        while index + 1 < self.resolution[axis] && self.plane(axis, index + 1) <= coordinate {
            index += 1;
        }
        while index > 0 && self.plane(axis, index) > coordinate {
            index -= 1;
        }
        index
    }

    /// The box of a cell.
    pub(super) fn cell_bounds(&self, [x, y, z]: [i32; 3]) -> Aabb {
        let corner =
            |by: i32| [self.plane(0, x + by), self.plane(1, y + by), self.plane(2, z + by)];
        Aabb::new(corner(0), corner(1))
    }

    /// The box of a cell and a little around it: a 64th of the cell.
    ///
    /// For asking a geometry for its part in the cell. A hit's distance is rounded, so the point it names may lie a little off the
    /// primitive, in the cell next door; the margin makes that cell know the primitive too. Boxes need no margin: see the walk.
    pub(super) fn widened_cell_bounds(&self, index: [i32; 3]) -> Aabb {
        let bounds = self.cell_bounds(index);
        let margin = crate::Vec3::from(self.cell.map(|edge| edge / 64.0));
        // Near the largest number the sum overflows, and of a box without end no geometry can tell anything.
        let (least, greatest) = (crate::Vec3::splat(f32::MIN), crate::Vec3::splat(f32::MAX));
        Aabb::new((bounds.min - margin).max(least), (bounds.max + margin).min(greatest))
    }

    /// Where the cell of a number lies on each axis.
    pub(super) fn place(&self, number: usize) -> [i32; 3] {
        let [nx, ny, _] = self.resolution.map(|n| n as usize);
        [number % nx, number / nx % ny, number / (nx * ny)].map(|index| index as i32)
    }
}
