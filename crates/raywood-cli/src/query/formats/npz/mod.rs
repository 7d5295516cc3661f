//! numpy's format of several arrays: a ZIP archive of `NAME.npy`, as `numpy.savez` and `numpy.savez_compressed` write it.
//!
//! | rows   | arrays in                                                                                                              |
//! | ------ | ---------------------------------------------------------------------------------------------------------------------- |
//! | rays   | `origins` and `directions` of shape (N, 3), or `ray_origins` and `ray_directions`; perhaps `t_min` and `t_max`, each (N,) or one number |
//! | rays   | or `rays`, of shape (N, 6) or (N, 8)                                                                                    |
//! | points | `points`, of shape (N, 3)                                                                                               |
//!
//! An only array may have any name. Arrays are read piece by piece, standard input from memory.
//!
//! Out: an array for each column; of lists of answers, also `offsets` of shape (rays + 1,), int64: the answers to ray `i` are
//! `offsets[i]` to `offsets[i+1] - 1`. Arrays are kept in memory until the end, and written uncompressed, as by `numpy.savez`.

mod archive;
mod read;
mod write;

pub(crate) use read::NpzRows;
pub(crate) use write::NpzWriter;
