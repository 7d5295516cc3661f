//! JSON lines: an object a line.
//!
//! In: `{"origin": [0, 0, 5], "direction": [0, 0, -1]}`, perhaps with `"t_min"` and `"t_max"`; of points `{"point": [0, 0, 5]}`. A coordinate that is `null` is NaN; a
//! `t_min` that is `null` 0, a `t_max` infinity.
//!
//! Out: an object for each row of the input, with its columns, three numbers a row as an array, `null` where nothing is hit or found; lists of answers as
//! `{"hits": [{"t": ...}, ...]}`.

mod read;
mod write;

pub(crate) use read::JsonRows;
pub(crate) use write::JsonWriter;
