//! The clock of a core, as far as a program can tell it: by operations of one cycle each that must wait for each other.

use std::hint::black_box;

use crate::timing::{Timing, seconds};

/// The clock of the cores while so many threads worked: an estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct Clock {
    /// How many threads.
    pub threads: usize,
    /// On how many cores these ran: as many, or all that there are.
    pub cores: usize,
    /// How long a cycle took, again and again between the measurements.
    pub cycle: Timing,
}

impl Clock {
    /// Cycles a second; 0 if it was never measured.
    pub fn hertz(&self) -> f64 {
        let seconds = self.cycle.median();
        if seconds > 0.0 { 1.0 / seconds } else { 0.0 }
    }
}

/// Interruptions make a chain take longer, never shorter: of so many the shortest counts.
const CHAINS: usize = 5;

/// The steps of a chain: some 25 microseconds, long for the clock that times it and short for the system's interruptions.
const STEPS: u32 = 50_000;

/// An addition and an exclusive or, which take one cycle each on every processor of today.
const CYCLES_PER_STEP: u32 = 2;

/// How long a cycle of this thread's core takes now, in seconds.
pub(super) fn cycle() -> f64 {
    let chains = (0..CHAINS).map(|_| seconds(|| chain(STEPS)).0);
    chains.fold(f64::INFINITY, f64::min) / f64::from(STEPS * CYCLES_PER_STEP)
}

/// A chain of dependent operations. Neither compiler nor processor can shorten it: additions and exclusive ors of numbers that are not
/// known beforehand cannot be merged.
fn chain(steps: u32) -> u64 {
    let (addend, mask) = black_box((0x9E37_79B9_7F4A_7C15, 0xD1B5_4A32_D192_ED03));
    let mut value = black_box(1_u64);
    for _ in 0..steps {
        value = value.wrapping_add(addend) ^ mask;
    }
    black_box(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_takes_time_by_its_length() {
        let shortest = |steps| {
            let chains = (0..20).map(|_| seconds(|| chain(steps)).0);
            chains.fold(f64::INFINITY, f64::min)
        };
        let factor = shortest(800_000) / shortest(100_000);
        assert!((4.0..16.0).contains(&factor), "eight times as long takes {factor} times the time");
    }

    #[test]
    fn clocks_are_those_of_processors() {
        let clock = Clock { threads: 1, cores: 1, cycle: Timing::new(vec![cycle(); 3]) };
        assert!((1e8..1e10).contains(&clock.hertz()), "{} Hz", clock.hertz());
        assert_eq!(Clock { cycle: Timing::default(), ..clock }.hertz(), 0.0);
    }
}
