//! The answers to a piece of the input, as columns.

use super::field::{Element, Field};

/// The numbers of a column, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Values {
    F32(Vec<f32>),
    I32(Vec<i32>),
    Bool(Vec<bool>),
}

impl Values {
    /// An empty column of a type.
    pub(crate) fn empty(element: Element) -> Self {
        match element {
            Element::F32 => Self::F32(Vec::new()),
            Element::I32 => Self::I32(Vec::new()),
            Element::Bool => Self::Bool(Vec::new()),
        }
    }

    /// Appends the numbers of some rows in bytes, little endian, as numpy has them.
    pub(crate) fn append_bytes(&self, numbers: std::ops::Range<usize>, bytes: &mut Vec<u8>) {
        match self {
            Self::F32(values) => {
                values[numbers].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
            }
            Self::I32(values) => {
                values[numbers].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
            }
            Self::Bool(values) => bytes.extend(values[numbers].iter().map(|&x| u8::from(x))),
        }
    }
}

/// A column with what it is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Column {
    pub(crate) field: Field,
    pub(crate) values: Values,
}

/// Which rows of a table answer which rows of the input, where each of these has a list of answers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lists {
    /// The number of the first row of the input.
    pub(crate) first: u64,
    /// Where the answers to each row begin in this table; last, how many there are in it.
    pub(crate) offsets: Vec<usize>,
}

impl Lists {
    /// The number of the input's row that each row of the table answers.
    pub(crate) fn questions(&self) -> impl Iterator<Item = u64> + '_ {
        let lengths = self.offsets.windows(2).map(|ends| ends[1] - ends[0]);
        (self.first..).zip(lengths).flat_map(|(row, count)| std::iter::repeat_n(row, count))
    }
}

/// Answers to consecutive rows of the input.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Table {
    /// How many rows each column has.
    pub(crate) rows: usize,
    pub(crate) columns: Vec<Column>,
    /// Where rows of the input have lists of answers. Else each has one row.
    pub(crate) lists: Option<Lists>,
    /// How many answers are no misses.
    pub(crate) successes: u64,
}
