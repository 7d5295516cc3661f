//! The range of a chart's axis: where values lie on it, and where it is marked.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use raywood_lab::figures::Scale;

use super::values::short;

/// An axis from its least to its greatest value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AxisRange {
    scale: Scale,
    min: f64,
    max: f64,
    ticks: Vec<f64>,
}

impl AxisRange {
    /// An axis that shows all of the values that it can. `margin` is the share of its length that is added after the greatest.
    pub(super) fn around(scale: Scale, values: impl Iterator<Item = f64>, margin: f64) -> Self {
        let can_be_shown =
            |value: &f64| value.is_finite() && (scale == Scale::Linear || *value > 0.0);
        let (min, max) = values
            .filter(can_be_shown)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), v| (min.min(v), max.max(v)));
        match scale {
            _ if min > max => Self::around(scale, [1.0, 10.0].into_iter(), margin),
            Scale::Linear => {
                let (min, max) = (min.min(0.0), max.max(0.0));
                let length = if max > min { max - min } else { 1.0 };
                let step = round_step(length / 5.0);
                let min = (min / step).floor() * step;
                let max = min + (max - min).max(step) + margin * length;
                let ticks = (0..=40).map(|i| min + f64::from(i) * step);
                // The first step that is past the end by more than rounding.
                let ticks = ticks.take_while(|tick| *tick <= max + 1e-9 * step).collect();
                Self { scale, min, max, ticks }
            }
            Scale::Logarithmic => {
                let (low, high) = (min.log10(), max.log10());
                let room = 0.04 * (high - low).max(0.25);
                let (low, high) = (low - room, high + room + margin * (high - low));
                let ticks = logarithmic_ticks(low, high);
                Self { scale, min: 10f64.powf(low), max: 10f64.powf(high), ticks }
            }
        }
    }

    /// The least value.
    pub(super) fn min(&self) -> f64 {
        self.min
    }

    /// Whether a value lies on the axis.
    pub(super) fn shows(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }

    /// How many characters the longest of the numbers beside it has.
    pub(super) fn longest_tick(&self) -> usize {
        self.ticks.iter().map(|tick| short(*tick).chars().count()).max().unwrap_or(0)
    }

    fn place(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value,
            Scale::Logarithmic => value.max(f64::MIN_POSITIVE).log10(),
        }
    }
}

/// The next of 1, 2, 5, 10, 20, 50 ... above a length.
fn round_step(length: f64) -> f64 {
    let power = 10f64.powf(length.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= length);
    factor.unwrap_or(10.0) * power
}

/// Powers of ten between two exponents, with their doubles and halves where they are few, left out in part where they are many.
fn logarithmic_ticks(low: f64, high: f64) -> Vec<f64> {
    let factors: &[f64] = match high - low {
        decades if decades < 0.7 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
        decades if decades < 2.2 => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    let every = ((high - low) / 7.0).ceil().max(1.0) as usize;
    let decades = (low.floor() as i32..=high.ceil() as i32).step_by(every);
    decades
        .flat_map(|decade| factors.iter().map(move |factor| factor * 10f64.powi(decade)))
        .filter(|tick| (low..=high).contains(&tick.log10()))
        .collect()
}

impl Ranged for AxisRange {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let (low, high) = (self.place(self.min), self.place(self.max));
        let share = ((self.place(*value) - low) / (high - low)).clamp(0.0, 1.0);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.min..self.max
    }
}

impl ValueFormatter<f64> for AxisRange {
    fn format_ext(&self, value: &f64) -> String {
        short(*value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_axes_begin_at_zero_and_are_marked_in_round_steps() {
        let axis = AxisRange::around(Scale::Linear, [3.0, 11.0].into_iter(), 0.0);
        assert_eq!((axis.min, axis.max), (0.0, 11.0));
        assert_eq!(axis.ticks, [0.0, 5.0, 10.0]);
        assert_eq!(axis.map(&5.5, (100, 300)), 200);
        let below = AxisRange::around(Scale::Linear, [-3.0, 1.0].into_iter(), 0.0);
        assert!(below.shows(-3.0) && below.shows(0.0) && !below.shows(2.0));
    }

    #[test]
    fn logarithmic_axes_show_positive_values_only() {
        let axis = AxisRange::around(Scale::Logarithmic, [0.0, 1e3, 1e6, -1.0].into_iter(), 0.0);
        assert!(axis.shows(1e3) && axis.shows(1e6) && !axis.shows(1e2));
        assert_eq!(axis.ticks.len(), 4, "{:?}", axis.ticks);
        let narrow = AxisRange::around(Scale::Logarithmic, [100.0, 200.0].into_iter(), 0.0);
        assert!(narrow.ticks.len() >= 2, "{:?}", narrow.ticks);
    }

    #[test]
    fn an_axis_of_nothing_or_of_one_value_is_still_an_axis() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            for values in [vec![], vec![f64::NAN], vec![0.0], vec![7.0, 7.0], vec![1e-300, 1e300]] {
                let axis = AxisRange::around(scale, values.iter().copied(), 0.1);
                assert!(axis.min < axis.max, "{scale:?} {values:?}: {axis:?}");
                assert!(!axis.ticks.is_empty() && axis.ticks.len() <= 41, "{values:?}: {axis:?}");
                let _ = axis.map(&f64::NAN, (0, 100));
            }
        }
    }
}
