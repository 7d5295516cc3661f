//! Tables and charts as plain data: what experiments and comparisons hand to whoever shows them.

/// A table of measured values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// What it shows, in one line.
    pub caption: String,
    /// What stands above each column, the unit with it.
    pub columns: Vec<String>,
    /// As many cells in each as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows yet.
    pub fn new(caption: impl Into<String>, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|&column| column.to_owned()).collect();
        Self { caption: caption.into(), columns, rows: Vec::new() }
    }
}

/// What stands in a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A whole number.
    Count(u64),
    /// A measured number and to how many decimals it is shown.
    Number(f64, usize),
    /// A share of one, shown in percent.
    Share(f64),
    /// A measured number, to how many decimals it is shown, and its spread as a share of it.
    Spread(f64, usize, f64),
    /// Nothing was measured here.
    Nothing,
}

impl Cell {
    /// Words.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// A number of which three digits count.
    pub fn significant(value: f64) -> Self {
        Self::Number(value, decimals(value))
    }

    /// A number of which three digits count, and its spread as a share of it.
    pub fn with_spread(value: f64, spread: f64) -> Self {
        Self::Spread(value, decimals(value), spread)
    }

    /// A whole number.
    pub fn count(count: usize) -> Self {
        Self::Count(count as u64)
    }

    /// Whether it is a number, or stands where one would.
    pub fn is_numeric(&self) -> bool {
        !matches!(self, Self::Text(_))
    }
}

/// How many decimals show three significant digits of a number.
fn decimals(value: f64) -> usize {
    if value == 0.0 || !value.is_finite() {
        return 0;
    }
    // Of the number as it will be rounded: 9.996 is 10.0.
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    (2 - rounded.abs().log10().floor() as i32).clamp(0, 8) as usize
}

/// A chart of either kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Chart {
    /// Lines over a common axis.
    Plot(Plot),
    /// Bars for categories.
    Bars(BarChart),
}

/// Lines through measured points.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What it shows, in one line.
    pub title: String,
    /// The axis to the right.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// The lines.
    pub series: Vec<Series>,
}

/// What an axis measures.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it measures, the unit with it.
    pub label: String,
    /// How values are spread over it.
    pub scale: Scale,
}

impl Axis {
    /// Equal steps are equally long.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear }
    }

    /// Equal factors are equally long.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Logarithmic }
    }
}

/// How values are spread over an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps are equally long; zero is on the axis.
    Linear,
    /// Equal factors are equally long; only positive values can be shown.
    Logarithmic,
}

/// A named line.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What the legend calls it.
    pub name: String,
    /// Its points from left to right.
    pub points: Vec<[f64; 2]>,
    /// Measured, or what to compare it with.
    pub line: Line,
}

impl Series {
    /// A line through measured points.
    pub fn measured(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self { name: name.into(), points, line: Line::Measured }
    }

    /// A line to compare measurements with.
    pub fn ideal(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self { name: name.into(), points, line: Line::Ideal }
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// Solid, with a mark at each point.
    Measured,
    /// Dashed, without marks.
    Ideal,
}

/// Bars, grouped by category, one of each group for every series.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart {
    /// What it shows, in one line.
    pub title: String,
    /// What the bars' lengths mean.
    pub value: Axis,
    /// To how many decimals values are written beside the bars.
    pub decimals: usize,
    /// The names of the groups.
    pub categories: Vec<String>,
    /// The bars of each group.
    pub series: Vec<BarSeries>,
}

/// One bar of each group.
#[derive(Clone, Debug, PartialEq)]
pub struct BarSeries {
    /// What the legend calls it.
    pub name: String,
    /// A value for each category, `None` where nothing was measured.
    pub values: Vec<Option<f64>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_count() {
        let cases = [
            (0.0, "0"),
            (1.0, "1.00"),
            (0.012345, "0.0123"),
            (-0.5, "-0.500"),
            (9.996, "10.0"),
            (99.96, "100"),
            (123.4, "123"),
            (1_234_567.8, "1234568"),
        ];
        for (number, text) in cases {
            let digits = decimals(number);
            assert_eq!(format!("{number:.digits$}"), text);
        }
    }
}
