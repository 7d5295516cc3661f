//! Straight lines through measured points, and means of ratios.

/// The exponent `p` of the power law `y = c * x^p` that fits best: the slope of the least-squares line through the logarithms. NaN if
/// there are no two different `x`.
pub(super) fn growth_exponent(points: &[[f64; 2]]) -> f64 {
    let points: Vec<_> = points
        .iter()
        .filter(|[x, y]| *x > 0.0 && *y > 0.0)
        .map(|[x, y]| [x.ln(), y.ln()])
        .collect();
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let (mean_x, mean_y) = (mean(0), mean(1));
    let (mut xy, mut xx) = (0.0, 0.0);
    for [x, y] in &points {
        xy += (x - mean_x) * (y - mean_y);
        xx += (x - mean_x) * (x - mean_x);
    }
    xy / xx
}

/// The mean of ratios; NaN of none.
pub(super) fn geometric_mean(ratios: &[f64]) -> f64 {
    (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp()
}

/// The least and the greatest.
pub(super) fn range(values: &[f64]) -> (f64, f64) {
    let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
    values.iter().fold((low, high), |(low, high), &v| (low.min(v), high.max(v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_of_power_laws_are_found() {
        let law = |p: f64| [1e3, 1e4, 1e6].map(|x: f64| [x, 7.0 * x.powf(p)]);
        for p in [0.0, 0.33, 1.0, 2.0] {
            assert!((growth_exponent(&law(p)) - p).abs() < 1e-12);
        }
        assert!(growth_exponent(&[[1.0, 2.0]]).is_nan());
        assert!(growth_exponent(&[]).is_nan());
    }

    #[test]
    fn means_of_ratios_do_not_depend_on_their_direction() {
        assert!((geometric_mean(&[2.0, 8.0]) - 4.0).abs() < 1e-12);
        assert!((geometric_mean(&[0.5, 2.0]) - 1.0).abs() < 1e-12);
        assert_eq!(range(&[3.0, 1.0, 2.0]), (1.0, 3.0));
    }
}
