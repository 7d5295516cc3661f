"""Pictures by regions, and how much of what differs is noise. crates/raywood-testkit/src/significance.rs has the same in Rust, with its sources."""

import numpy as np

# The share of a mean by which rounding may move it.
ROUNDING = 2e-5


def means(picture, regions):
    """The mean light of each region, row after row, and at last of the whole picture."""
    size = picture.shape[0]
    edge = size // regions
    blocks = picture.reshape(regions, edge, regions, edge, 3).mean(axis=(1, 3))
    return np.concatenate([blocks.reshape(-1, 3), picture.mean(axis=(0, 1))[None]])


class Estimates:
    """Means of independent runs (the first axis), their standard errors, and the degrees of freedom of these."""

    def __init__(self, mean, error, freedom):
        self.mean, self.error, self.freedom = mean, error, freedom

    @staticmethod
    def of_runs(runs):
        runs = np.array(runs, dtype=float)
        return Estimates(runs.mean(axis=0), runs.std(axis=0, ddof=1) / len(runs) ** 0.5, len(runs) - 1)

    def is_exact(self):
        """Where there is no noise."""
        return self.error <= ROUNDING * np.abs(self.mean)

    def deviates_from(self, other):
        """What Welch's test says of each, as deviates of the normal distribution."""
        rounding = ROUNDING * np.maximum(np.abs(self.mean), np.abs(other.mean))
        a, b = self.error**2, other.error**2
        variance = a + b + rounding**2
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.where(variance > 0, (self.mean - other.mean) / np.sqrt(variance), 0)
            freedom = variance**2 / (a**2 / self.freedom + b**2 / other.freedom)
        freedom = np.where(np.isfinite(freedom), np.minimum(freedom, 1e9), 1e9)
        scale = (8 * freedom + 1) / (8 * freedom + 3)
        return np.sign(t) * scale * np.sqrt(freedom * np.log1p(t * t / freedom))


def chi_squared_deviate(deviates):
    """The same of the sum of the squares of all."""
    spread = 2 / (9 * len(deviates))
    return (np.cbrt(np.mean(deviates**2)) - (1 - spread)) / spread**0.5
