//! Fair timing on machines that do other things too: contestants take turns, and medians are told with their spread.

use std::time::Instant;

/// How long something took, several times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timing {
    /// Seconds of each round, shortest first.
    sorted: Vec<f64>,
}

impl Timing {
    /// From the seconds of each round.
    pub fn new(mut seconds: Vec<f64>) -> Self {
        seconds.sort_unstable_by(f64::total_cmp);
        Self { sorted: seconds }
    }

    /// How often it was measured.
    pub fn rounds(&self) -> usize {
        self.sorted.len()
    }

    /// The median in seconds; 0 if nothing was measured.
    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    /// Half the distance between the quartiles, as a share of the median: half of all rounds were about as near to it as this, or nearer.
    pub fn spread(&self) -> f64 {
        let median = self.median();
        let distance = self.quantile(0.75) - self.quantile(0.25);
        if median > 0.0 { 0.5 * distance / median } else { 0.0 }
    }

    /// The time below which a share of the rounds lies, between two of them by linear interpolation.
    fn quantile(&self, share: f64) -> f64 {
        let Some(last) = self.sorted.len().checked_sub(1) else { return 0.0 };
        let place = share * last as f64;
        let (below, part) = (place.floor() as usize, place.fract());
        let above = self.sorted[(below + 1).min(last)];
        self.sorted[below] + part * (above - self.sorted[below])
    }
}

/// Seconds that `f` takes, and its result.
pub fn seconds<T>(f: impl FnOnce() -> T) -> (f64, T) {
    let started = Instant::now();
    let result = f();
    (started.elapsed().as_secs_f64(), result)
}

/// Times contestants in turn, round after round, every other round backwards, so that what slows the machine for a while slows all of
/// them alike. `run(i)` runs contestant `i` and says how many seconds that took, by which it may leave out preparations; `None` ends it all.
pub fn take_turns(
    contestants: usize,
    rounds: usize,
    mut run: impl FnMut(usize) -> Option<f64>,
) -> Option<Vec<Timing>> {
    let mut seconds = vec![Vec::with_capacity(rounds); contestants];
    for round in 0..rounds {
        for place in 0..contestants {
            let contestant = if round % 2 == 0 { place } else { contestants - 1 - place };
            seconds[contestant].push(run(contestant)?);
        }
    }
    Some(seconds.into_iter().map(Timing::new).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_and_spreads() {
        let timing = Timing::new(vec![5.0, 1.0, 3.0, 2.0, 4.0]);
        assert_eq!((timing.rounds(), timing.median()), (5, 3.0));
        assert_eq!(timing.spread(), 0.5 * (4.0 - 2.0) / 3.0);
        assert_eq!(Timing::new(vec![1.0, 2.0]).median(), 1.5);
        let once = Timing::new(vec![7.0]);
        assert_eq!((once.median(), once.spread()), (7.0, 0.0));
        assert_eq!((Timing::default().median(), Timing::default().spread()), (0.0, 0.0));
    }

    #[test]
    fn turns_are_taken_there_and_back() {
        let mut order = Vec::new();
        let timings = take_turns(3, 2, |contestant| {
            order.push(contestant);
            Some(order.len() as f64)
        });
        assert_eq!(order, [0, 1, 2, 2, 1, 0]);
        assert_eq!(timings.expect("not ended")[2], Timing::new(vec![3.0, 4.0]));
        assert_eq!(take_turns(3, 2, |_| None), None);
    }
}
