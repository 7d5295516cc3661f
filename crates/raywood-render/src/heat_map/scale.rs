//! The scale of a heat map: where it ends, which numbers stand at its bar, and how they are written.

use super::HeatMap;

/// The share of pixels, in percent, that the scale holds: the few hot pixels at edges would darken all others.
const PERCENT_WITHIN: f64 = 99.5;

/// Where scales may end, times a power of ten. Finer than 1, 2, 5, so that a map uses at least two thirds of the colours.
const ENDS: [f64; 9] = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];

/// Between numbers at the bar, times a power of ten.
const STEPS: [f64; 4] = [1.0, 2.0, 2.5, 5.0];

impl HeatMap {
    /// Where the map's own scale ends: the least pleasant number that is not below 99.5% of the pixels for which anything was counted.
    pub fn default_maximum(&self) -> f32 {
        round_up(self.percentile_of_counted(PERCENT_WITHIN))
    }

    /// Where one scale for several maps ends: the largest of their own; 1 for none.
    pub fn common_maximum<'a>(maps: impl IntoIterator<Item = &'a Self>) -> f32 {
        let maxima = maps.into_iter().map(Self::default_maximum);
        maxima.reduce(f32::max).unwrap_or(1.0)
    }
}

/// The least number of [`ENDS`] times a power of ten that is not below `value`; 1 if that is not above zero.
fn round_up(value: f32) -> f32 {
    if !(value > 0.0 && value.is_finite()) {
        return 1.0;
    }
    let power = 10f64.powf(f64::from(value).log10().floor());
    // Compared as the numbers that are returned, so that a number of the series stays itself.
    let ends = ENDS.map(|end| (end * power) as f32);
    ends.into_iter().find(|&end| value <= end).unwrap_or(value)
}

/// A maximum that a scale can end at: what is not above zero, or not a number, counts as 1.
pub(super) fn usable(maximum: f32) -> f32 {
    if maximum > 0.0 && maximum.is_finite() { maximum } else { 1.0 }
}

/// The numbers at a bar from 0 to `maximum`: both ends, and multiples of a pleasant step between, in at most `intervals` intervals.
pub(super) fn ticks(maximum: f32, intervals: usize) -> Vec<f32> {
    let maximum = f64::from(usable(maximum));
    let power = 10f64.powf((maximum / intervals.max(1) as f64).log10().floor());
    // A hair of tolerance: 1.5 / 0.3 may be more than 5.
    let fits = |step: &f64| maximum / step <= intervals as f64 + 1e-6;
    // Counts are whole: beside 2.5 a reader would look for halves.
    let even = |step: &f64| *step < 1.0 || step.fract() == 0.0;
    let steps = STEPS.map(|step| step * power).into_iter().filter(even);
    let step = steps.chain([10.0 * power]).find(fits).unwrap_or(maximum);
    let multiples = (1..intervals).map(|k| k as f64 * step);
    // What comes close to the end would stand in its number.
    let between = multiples.take_while(|tick| *tick < maximum - 0.4 * step);
    [0.0].into_iter().chain(between).chain([maximum]).map(|tick| tick as f32).collect()
}

/// A number as legends have it: short, with four digits at most.
pub(super) fn number(value: f32) -> String {
    let value = f64::from(value);
    let (value, unit) = match value {
        v if v >= 999_950.0 => (v / 1e6, "M"),
        v if v >= 9999.5 => (v / 1e3, "k"),
        v => (v, ""),
    };
    if value >= 1e7 || (value > 0.0 && value < 1e-3) {
        return format!("{value:.1e}{unit}");
    }
    let decimals = match value {
        v if v >= 99.95 => 0,
        v if v >= 9.995 => 1,
        v if v >= 0.9995 => 2,
        _ => 3,
    };
    let text = format!("{value:.decimals$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    format!("{text}{unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_end_at_pleasant_numbers_that_are_not_smaller() {
        for (value, end) in [
            (0.0, 1.0),
            (f32::NAN, 1.0),
            (f32::INFINITY, 1.0),
            (0.11, 0.15),
            (1.0, 1.0),
            (1.2, 1.5),
            (7.0, 8.0),
            (8.5, 10.0),
            (10.0, 10.0),
            (97.0, 100.0),
            (101.0, 150.0),
            (254.3, 300.0),
            (871_414.0, 1e6),
        ] {
            assert_eq!(round_up(value), end, "{value}");
        }
        for power in -30..30 {
            for mantissa in [1.0, 1.01, 1.5, 1.51, 3.0, 5.5, 7.9, 9.99] {
                let value = mantissa * 10f32.powi(power);
                let end = round_up(value);
                assert!(end >= value && end <= 1.51 * value, "{value}: {end}");
                assert_eq!(round_up(end), end, "{value}");
            }
        }
    }

    #[test]
    fn ticks_are_even_and_end_at_the_maximum() {
        assert_eq!(ticks(100.0, 5), [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
        assert_eq!(ticks(150.0, 5), [0.0, 50.0, 100.0, 150.0]);
        assert_eq!(ticks(3.0, 6), [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0]);
        assert_eq!(ticks(80.0, 5), [0.0, 20.0, 40.0, 60.0, 80.0]);
        assert_eq!(ticks(47.0, 5), [0.0, 10.0, 20.0, 30.0, 40.0, 47.0]);
        assert_eq!(ticks(42.0, 5), [0.0, 10.0, 20.0, 30.0, 42.0]);
        assert_eq!(ticks(15.0, 6), [0.0, 5.0, 10.0, 15.0]);
        assert_eq!(ticks(150.0, 6), [0.0, 25.0, 50.0, 75.0, 100.0, 125.0, 150.0]);
        assert_eq!(ticks(7.0, 1), [0.0, 7.0]);
        for intervals in 1..9 {
            for maximum in [1e-30, 0.3, 1.0, 1.7, 12.0, 99.9, 12_345.0, 1e30, -1.0, f32::NAN] {
                let ticks = ticks(maximum, intervals);
                assert!((2..=intervals + 1).contains(&ticks.len()), "{maximum}: {ticks:?}");
                assert!(ticks.is_sorted_by(|a, b| a < b), "{maximum}: {ticks:?}");
            }
        }
    }

    #[test]
    fn numbers_are_short() {
        let numbers = [0.0, 0.25, 1.0, 2.5, 23.44, 100.0, 1500.0, 9999.0, 10_000.0, 871_414.0];
        let texts = ["0", "0.25", "1", "2.5", "23.4", "100", "1500", "9999", "10k", "871k"];
        assert_eq!(numbers.map(number), texts);
        assert_eq!([1e6, 1.25e6, 1e30, 1e-9].map(number), ["1M", "1.25M", "1.0e24M", "1.0e-9"]);
        for exponent in -40..38 {
            assert!(number(1.23456 * 10f32.powi(exponent)).len() <= 8, "{exponent}");
        }
    }
}
