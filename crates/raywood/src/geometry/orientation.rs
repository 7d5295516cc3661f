//! How the direction of a ray lies among the axes: looked up instead of worked out, for no processor foresees where rays go.

use crate::simd::{Float, Simd};

/// An axis of space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

/// The side of a box on which a plane lies, and the corner of a box all of whose planes lie there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Side {
    /// That of smallest coordinates.
    Smallest,
    /// That of largest coordinates.
    Largest,
}

/// The axes in an order. (As large as a number, so that it is copied as one.)
#[derive(Clone, Copy, Debug)]
#[repr(align(4))]
pub(crate) struct Axes(pub(crate) [Axis; 3]);

impl Axes {
    /// Their numbers.
    #[inline(always)]
    pub(crate) fn numbers(self) -> [usize; 3] {
        let [x, y, z] = self.0;
        [x as usize, y as usize, z as usize]
    }
}

/// A side for each axis. (As large as a number, so that it is copied as one.)
#[derive(Clone, Copy, Debug)]
#[repr(align(4))]
pub(crate) struct Sides(pub(crate) [Side; 3]);

/// How a direction lies among the axes.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub(crate) struct Orientation {
    /// From which numbers of a [row](crate::simd::as_row) of a ray those of its permuted row come.
    lanes: [u8; 8],
    /// The axes in an order in which the last is the direction's largest and the triangle's orientation is kept.
    pub(crate) axes: Axes,
    /// On which side the ray enters boxes, per axis.
    pub(crate) entry_sides: Sides,
}

/// The lanes of the direction in the row of a ray, twice.
const DIRECTION_TWICE: [u8; 8] = [4, 5, 6, 7, 4, 5, 6, 7];

impl Orientation {
    /// That of the direction of a ray, none of whose coordinates is NaN, given by its row.
    #[inline(always)]
    pub(super) fn of<S: Simd>(simd: S, row: S::F8) -> &'static Self {
        let direction = simd.permuted8(row, &DIRECTION_TWICE);
        let sizes = direction.abs();
        let left = simd.permuted8(sizes, &[1, 2, 2, 3, 3, 3, 3, 3]);
        let right = simd.permuted8(sizes, &[0, 0, 1, 3, 3, 3, 3, 3]);
        let sizes = left.less_or_equal(right) & 7;
        let signs = simd.signs8(direction) & 7;
        &ALL[(sizes | signs << 3) as usize]
    }

    /// The row of a ray whose coordinates are in the order of [`axes`](Self::axes).
    #[inline(always)]
    pub(super) fn permuted<S: Simd>(&self, simd: S, row: S::F8) -> S::F8 {
        simd.permuted8(row, &self.lanes)
    }

    /// That of a direction of which three bits tell whether y is no larger than x, z than x and z than y, and three whether coordinates have a sign.
    const fn from_bits(bits: usize) -> Self {
        let main = match (bits & 3 == 3, bits & 4 == 4) {
            (true, _) => 0,
            (false, true) => 1,
            (false, false) => 2,
        };
        let signs = bits >> 3;
        // The first, second or third axis is last. The others swap where the direction runs backwards along it, which keeps the orientation of triangles
        // (Woop, Benthin and Wald 2013).
        let (x, y) = ((main + 1) % 3, (main + 2) % 3);
        let (x, y) = if signs >> main & 1 == 0 { (x, y) } else { (y, x) };
        let (a, b, c) = (x as u8, y as u8, main as u8);
        Self {
            lanes: [a, b, c, 3, 4 + a, 4 + b, 4 + c, 7],
            axes: Axes([axis(x), axis(y), axis(main)]),
            entry_sides: Sides([side(signs & 1), side(signs >> 1 & 1), side(signs >> 2 & 1)]),
        }
    }
}

/// The orientations by their bits.
static ALL: [Orientation; 64] = {
    let mut all = [Orientation::from_bits(0); 64];
    let mut bits = 0;
    while bits < all.len() {
        all[bits] = Orientation::from_bits(bits);
        bits += 1;
    }
    all
};

const fn axis(number: usize) -> Axis {
    match number {
        0 => Axis::X,
        1 => Axis::Y,
        _ => Axis::Z,
    }
}

const fn side(sign: usize) -> Side {
    match sign {
        0 => Side::Smallest,
        _ => Side::Largest,
    }
}
