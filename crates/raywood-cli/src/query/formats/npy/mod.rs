//! numpy's format of one array.
//!
//! | bytes            | content                                                                                     |
//! | ---------------- | ------------------------------------------------------------------------------------------- |
//! | 6                | `\x93NUMPY`                                                                                 |
//! | 2                | version: 1.0, 2.0 or 3.0                                                                    |
//! | 2, or 4 from 2.0 | length of the header, little endian                                                         |
//! | that many        | a Python dictionary: `{'descr': '<f4', 'fortran_order': False, 'shape': (100, 6), }`, spaces, a line's end |
//! | the rest         | the numbers, row after row, or in Fortran order column after column                        |
//!
//! Read here rather than by a crate: those that there are bring a parser generator along for this dictionary.
//!
//! In: shape (N, 6) of rays, origin and direction; (N, 8) with `t_min` and `t_max`; (N, 3) of points; numbers of any real type, of any byte order, in C or
//! Fortran order. Out: an array of shape (N,) or (N, 3) if there is one column, else a structured array, whose columns are read as `hits["t"]`; lists of
//! answers a row each, and `ray` first, the number of the ray from 0.

mod array;
mod element;
mod header;
mod read;
mod write;

pub(in crate::query) use array::NpyArray;
pub(in crate::query) use header::{column_type, header};
pub(crate) use read::NpyRows;
pub(crate) use write::NpyWriter;
