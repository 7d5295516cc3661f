//! Numbers as tables and charts write them.

use raywood_lab::figures::Cell;

use crate::print::thousands;

/// What stands in a table's cell.
pub(crate) fn cell(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => text.clone(),
        Cell::Count(count) => thousands(*count),
        Cell::Number(value, decimals) => number(*value, *decimals),
        Cell::Share(share) if share.is_finite() => format!("{:.1} %", 100.0 * share),
        Cell::Spread(value, decimals, spread) => {
            format!("{} ±{:.0}%", number(*value, *decimals), 100.0 * spread)
        }
        Cell::Share(_) | Cell::Nothing => "\u{2013}".to_owned(),
    }
}

/// A number with so many decimals and commas between thousands; a dash if it is none.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "\u{2013}".to_owned();
    }
    let digits = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = digits.split_at(digits.find('.').unwrap_or(digits.len()));
    let whole = whole.parse().map_or_else(|_| whole.to_owned(), thousands);
    let is_zero = digits.bytes().all(|digit| matches!(digit, b'0' | b'.'));
    let sign = if value < 0.0 && !is_zero { "\u{2212}" } else { "" };
    format!("{sign}{whole}{fraction}")
}

/// A number on an axis, as short as it can be said: 0.5, 20, 1k, 2.5M.
pub(crate) fn short(value: f64) -> String {
    let (scaled, suffix) = match value.abs() {
        size if size >= 1e9 => (value / 1e9, "G"),
        size if size >= 1e6 => (value / 1e6, "M"),
        size if size >= 1e3 => (value / 1e3, "k"),
        _ => (value, ""),
    };
    // Seven significant digits hide what the division of decimal numbers leaves behind.
    let exponent = if scaled == 0.0 { 0 } else { scaled.abs().log10().floor() as i32 };
    let decimals = (6 - exponent).clamp(0, 12) as usize;
    let digits = format!("{:.decimals$}", scaled.abs());
    let digits = if digits.contains('.') {
        digits.trim_end_matches('0').trim_end_matches('.')
    } else {
        &digits
    };
    let sign = if value < 0.0 { "\u{2212}" } else { "" };
    format!("{sign}{digits}{suffix}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_exact() {
        assert_eq!(number(1234567.891, 2), "1,234,567.89");
        assert_eq!(number(-1234.0, 0), "\u{2212}1,234");
        assert_eq!((number(-0.001, 1), number(0.25, 3)), ("0.0".into(), "0.250".into()));
        assert_eq!((number(f64::NAN, 1), number(f64::INFINITY, 0)), ("–".into(), "–".into()));
        let cases = [0.0, 0.05, 0.30000000000000004, 20.0, 999.0, 1000.0, 2.5e6, 1048576.0, -3.0];
        let texts = ["0", "0.05", "0.3", "20", "999", "1k", "2.5M", "1.048576M", "\u{2212}3"];
        assert_eq!(cases.map(short), texts);
    }

    #[test]
    fn cells() {
        let cells = [Cell::text("tree"), Cell::Count(1234), Cell::Number(2.5, 2), Cell::Share(0.5)];
        assert_eq!(cells.map(|c| cell(&c)), ["tree", "1,234", "2.50", "50.0 %"]);
        assert_eq!(cell(&Cell::with_spread(2.5, 0.123)), "2.50 ±12%");
        assert_eq!(cell(&Cell::Nothing), "–");
    }
}
