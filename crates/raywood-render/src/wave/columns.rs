//! Numbers and vectors of the points of a wave, in columns, so that loops over them become vectors.

use raywood::Vec3;

use super::WAVE;

/// A number for each point.
pub(crate) type Column = [f32; WAVE];

/// A vector for each point.
pub(crate) type Columns = [Column; 3];

pub(crate) const ZERO: Columns = [[0.0; WAVE]; 3];

#[inline(always)]
pub(crate) fn set(columns: &mut Columns, number: usize, v: Vec3) {
    columns[0][number] = v.x;
    columns[1][number] = v.y;
    columns[2][number] = v.z;
}

#[inline(always)]
pub(crate) fn get(columns: &Columns, number: usize) -> Vec3 {
    Vec3::new(columns[0][number], columns[1][number], columns[2][number])
}

/// At least so many entries of columns, and a whole number of the widest vectors: a loop over them leaves no rest to be done one by one, which is most of the work where few surfaces have the same
/// material. What the entries beyond hold does not matter.
#[inline(always)]
pub(crate) fn whole_vectors(count: usize) -> usize {
    const WIDEST: usize = 16;
    ((count + WIDEST - 1) & !(WIDEST - 1)).min(WAVE)
}
