//! Reads rows from several arrays side by side.

use raywood_scene::quoted;

use super::super::Rows;
use super::super::npy::{NpyArray, NpyRows};
use super::archive::Archive;
use crate::failure::Failure;
use crate::query::input::Input;
use crate::query::kind::Subject;

const ORIGINS: &[&str] = &["origins", "ray_origins"];
const DIRECTIONS: &[&str] = &["directions", "ray_directions"];
const T_MIN: &[&str] = &["t_min"];
const T_MAX: &[&str] = &["t_max"];

/// The rows of an archive.
pub(crate) enum NpzRows {
    /// One array has them all.
    Whole(NpyRows),
    /// Rays in several.
    Parts(Box<Parts>),
}

/// Rays in several arrays.
pub(crate) struct Parts {
    origins: NpyArray,
    directions: NpyArray,
    /// `t_min` and `t_max`, unless neither is there.
    interval: Option<[Limit; 2]>,
    numbers: [Vec<f32>; 4],
}

/// Where rays begin or end.
enum Limit {
    Same(f32),
    Each(NpyArray),
}

impl NpzRows {
    /// Finds the arrays.
    pub(crate) fn open(input: Input, subject: Subject) -> Result<Self, Failure> {
        let archive = Archive::open(input)?;
        let names: Vec<_> = archive.names().collect();

        // One array.
        let whole = subject.name();
        let whole = match names[..] {
            [only] if !ORIGINS.contains(&only) && !DIRECTIONS.contains(&only) => only,
            _ => whole,
        };
        if let Some(array) = archive.array(&[whole])? {
            warn_of_others(&archive, &[&[whole]]);
            return NpyRows::new(array, subject).map(Self::Whole);
        }

        // Several.
        let found = match subject {
            Subject::Rays => archive.array(ORIGINS)?.zip(archive.array(DIRECTIONS)?),
            Subject::Points => None,
        };
        let Some((origins, directions)) = found else {
            let expected = match subject {
                Subject::Rays => "`origins` and `directions`, or `rays`",
                Subject::Points => "`points`",
            };
            let found = listed(&names);
            return Err(archive.input.complain(format_args!("has {found}, expected {expected}")));
        };
        warn_of_others(&archive, &[ORIGINS, DIRECTIONS, T_MIN, T_MAX]);
        for array in [&origins, &directions] {
            if !matches!(array.shape(), [_, 3]) {
                return Err(array.unexpected("(N, 3)"));
            }
        }
        if directions.rows() != origins.rows() {
            let expected = format!("({}, 3) as the origins have", origins.rows());
            return Err(directions.unexpected(&expected));
        }
        let limits = [archive.array(T_MIN)?, archive.array(T_MAX)?];
        let interval = if limits.iter().any(Option::is_some) {
            let [t_min, t_max] = limits;
            let rows = origins.rows();
            Some([Limit::new(t_min, 0.0, rows)?, Limit::new(t_max, f32::INFINITY, rows)?])
        } else {
            None
        };
        let numbers = Default::default();
        Ok(Self::Parts(Box::new(Parts { origins, directions, interval, numbers })))
    }
}

/// Tells of arrays that nothing is done with.
fn warn_of_others(archive: &Archive, used: &[&[&str]]) {
    let unused = archive.names().filter(|name| !used.iter().any(|names| names.contains(name)));
    archive.input.warn_of_unused("array", unused);
}

/// The names of arrays for a message, the first of very many.
fn listed(names: &[&str]) -> String {
    const MOST: usize = 8;
    if names.is_empty() {
        return "no arrays".to_owned();
    }
    let first: Vec<_> = names.iter().take(MOST).map(|name| quoted(name.as_bytes())).collect();
    let more = match names.len().saturating_sub(MOST) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    first.join(", ") + &more
}

impl Limit {
    fn new(array: Option<NpyArray>, missing: f32, rows: u64) -> Result<Self, Failure> {
        let Some(mut array) = array else { return Ok(Self::Same(missing)) };
        match *array.shape() {
            [] | [1] => {
                let mut number = Vec::new();
                array.read(1, &mut number)?;
                Ok(Self::Same(number[0]))
            }
            [count] | [count, 1] if count == rows => Ok(Self::Each(array)),
            _ => Err(array.unexpected(&format!("({rows},) or one number"))),
        }
    }

    fn read(&mut self, rows: usize, numbers: &mut Vec<f32>) -> Result<(), Failure> {
        numbers.clear();
        match self {
            Self::Same(number) => numbers.resize(rows, *number),
            Self::Each(array) => {
                array.read(rows, numbers)?;
            }
        }
        Ok(())
    }
}

impl Rows for NpzRows {
    fn width(&self) -> usize {
        match self {
            Self::Whole(rows) => rows.width(),
            Self::Parts(parts) => {
                if parts.interval.is_some() {
                    8
                } else {
                    6
                }
            }
        }
    }

    fn total(&self) -> Option<u64> {
        match self {
            Self::Whole(rows) => rows.total(),
            Self::Parts(parts) => Some(parts.origins.rows()),
        }
    }

    fn read(&mut self, rows: usize, numbers: &mut Vec<f32>) -> Result<usize, Failure> {
        match self {
            Self::Whole(whole) => whole.read(rows, numbers),
            Self::Parts(parts) => parts.read(rows, numbers),
        }
    }
}

impl Parts {
    fn read(&mut self, rows: usize, numbers: &mut Vec<f32>) -> Result<usize, Failure> {
        let [origins, directions, t_min, t_max] = &mut self.numbers;
        origins.clear();
        directions.clear();
        let rows = self.origins.read(rows, origins)?;
        self.directions.read(rows, directions)?;
        if let Some([first, last]) = &mut self.interval {
            first.read(rows, t_min)?;
            last.read(rows, t_max)?;
        }
        for row in 0..rows {
            numbers.extend(&origins[3 * row..3 * row + 3]);
            numbers.extend(&directions[3 * row..3 * row + 3]);
            if self.interval.is_some() {
                numbers.extend([t_min[row], t_max[row]]);
            }
        }
        Ok(rows)
    }
}
