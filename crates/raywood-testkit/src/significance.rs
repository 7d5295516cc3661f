//! Whether two noisy means differ by more than their noise: Welch's t-test, and Pearson's chi-squared over many of them.
//!
//! What is told is a deviate: how many standard deviations a number of the normal distribution would have to be off to be as unlikely, if only noise were at work.

/// A mean of independent runs, and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Its standard error.
    pub error: f64,
    /// The degrees of freedom of that error: one less than there were runs.
    pub freedom: f64,
}

/// The share of a mean by which rounding in single precision may move it, where there is no noise at all.
const ROUNDING: f64 = 2e-5;

impl Estimate {
    /// Of runs, at least two.
    pub fn of_runs(runs: &[f64]) -> Self {
        let count = runs.len() as f64;
        let freedom = count - 1.0;
        let mean = runs.iter().sum::<f64>() / count;
        let squares: f64 = runs.iter().map(|run| (run - mean).powi(2)).sum();
        Self { mean, error: (squares / freedom / count).sqrt(), freedom }
    }

    /// Whether there is no noise in it.
    pub fn is_exact(&self) -> bool {
        self.error <= ROUNDING * self.mean.abs()
    }

    /// The deviate of the difference of two means (Welch, "The Generalization of Student's Problem when Several Different Population Variances are Involved", 1947),
    /// with the sign of `self - other`.
    pub fn deviate_from(&self, other: &Self) -> f64 {
        let rounding = ROUNDING * self.mean.abs().max(other.mean.abs());
        let [own, others] = [self, other].map(|estimate| estimate.error.powi(2));
        let variance = own + others + rounding.powi(2);
        if variance == 0.0 {
            return 0.0;
        }
        let t = (self.mean - other.mean) / variance.sqrt();
        let freedom =
            variance.powi(2) / (own.powi(2) / self.freedom + others.powi(2) / other.freedom);
        normal_deviate_of_t(t, freedom)
    }
}

/// The normal deviate as unlikely as `t` of Student's distribution (Wallace, "Bounds on Normal Approximations to Student's and the Chi-square Distributions", 1959):
/// within 0.1 from five degrees of freedom and a deviate of five on.
fn normal_deviate_of_t(t: f64, freedom: f64) -> f64 {
    // Hardly anything is left of noise, or it is known exactly.
    if freedom > 1e9 {
        return t;
    }
    let scale = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    t.signum() * scale * (freedom * (t * t / freedom).ln_1p()).sqrt()
}

/// The deviate of the sum of the squares of so many independent normal deviates (Wilson and Hilferty, "The Distribution of Chi-square", 1931); above zero where
/// they are larger than noise makes them.
pub fn chi_squared_deviate(deviates: &[f64]) -> f64 {
    let count = deviates.len() as f64;
    let sum: f64 = deviates.iter().map(|deviate| deviate * deviate).sum();
    let spread = 2.0 / (9.0 * count);
    ((sum / count).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;

    /// A number of the normal distribution, by the sum of twelve others.
    fn normal(rng: &mut Rng) -> f64 {
        (0..12).map(|_| f64::from(rng.unit())).sum::<f64>() - 6.0
    }

    /// Quantiles of Student's distribution and of chi-squared from tables, as normal deviates.
    #[test]
    fn deviates_are_those_of_tables() {
        // One in 40 and one in 2000 is above these.
        for (freedom, t, deviate) in [(5.0, 2.571, 1.96), (15.0, 2.131, 1.96), (15.0, 4.073, 3.291)]
        {
            let found = normal_deviate_of_t(t, freedom);
            assert!((found - deviate).abs() < 0.04, "{found} for {t} of {freedom}");
            assert_eq!(normal_deviate_of_t(-t, freedom), -found);
        }
        // One in 20 and one in 1000.
        for (count, sum, deviate) in
            [(10, 18.307, 1.645), (64, 83.675, 1.645), (64, 104.716, 3.090)]
        {
            let each = (sum / f64::from(count)).sqrt();
            let found = chi_squared_deviate(&vec![each; count as usize]);
            assert!((found - deviate).abs() < 0.03, "{found} for {sum} of {count}");
        }
    }

    /// Deviates of noise alone are as large as they should be, those of a difference are not.
    #[test]
    fn noise_is_told_from_differences() {
        let mut rng = Rng::new(7);
        let mut estimate = |mean: f64, count: usize| {
            let runs: Vec<f64> = (0..count).map(|_| mean + normal(&mut rng)).collect();
            Estimate::of_runs(&runs)
        };
        let mut deviates = |off: f64| -> Vec<f64> {
            (0..1000).map(|_| estimate(5.0 + off, 8).deviate_from(&estimate(5.0, 32))).collect()
        };
        let noise = deviates(0.0);
        assert!(chi_squared_deviate(&noise).abs() < 3.0);
        let large = noise.iter().filter(|deviate| deviate.abs() > 1.96).count();
        assert!((30..=75).contains(&large), "{large} of 1000, not 50");
        assert!(chi_squared_deviate(&deviates(0.4)) > 10.0);
    }

    #[test]
    fn what_has_no_noise_may_be_rounded() {
        let exact = |mean: f64| Estimate { mean, error: 0.0, freedom: 7.0 };
        assert_eq!(exact(0.0).deviate_from(&exact(0.0)), 0.0);
        assert!(exact(1.0).deviate_from(&exact(1.0 + 1e-6)).abs() < 0.1);
        assert!(exact(1.0).deviate_from(&exact(1.001)) < -10.0);
        assert!(exact(0.0).is_exact() && !Estimate::of_runs(&[1.0, 1.001]).is_exact());
    }
}
