//! Comma-separated values: a line of names, then a row a line.
//!
//! | rows   | names in, in any order                                                                          |
//! | ------ | ----------------------------------------------------------------------------------------------- |
//! | rays   | `origin_x` ... `origin_z`, `direction_x` ... `direction_z`, or `ox` ... `oz`, `dx` ... `dz`; perhaps `t_min`, `t_max` |
//! | points | `x`, `y`, `z`                                                                                   |
//!
//! If the first line has numbers in place of names, columns are in the order of the table: 6 or 8 of rays, 3 of points.
//!
//! An empty field is NaN, as pandas writes it; that of `t_min` 0 and of `t_max` infinity. Answers have the names of their columns, those with three numbers a
//! row `position_x` and so on; lists of answers one line each and `ray` first, the number of the ray from 0.

mod read;
mod write;

pub(crate) use read::CsvRows;
pub(crate) use write::CsvWriter;
