//! Sorting numbers by their highest bits: a radix sort from the lowest digit to the highest, stable and the same for any number of threads.

use super::{Cancelled, Work};
use crate::parallel;
use crate::simd::huge_pages;

/// How many bits a digit has.
const DIGIT_BITS: u32 = 11;

/// How many values a digit has.
const DIGITS: usize = 1 << DIGIT_BITS;

/// Fewer numbers are sorted by comparing them: clearing the counts would take longer.
const FEW: usize = 2048;

/// A thread asks whether to go on after so many numbers.
const STRETCH: usize = 1 << 16;

/// Pieces that threads count and move at a time hold at least as many numbers.
const PIECE: usize = 1 << 16;

/// Sorts `numbers`, which are in the order of their lowest `bits` bits already: only the bits above count. O(n), in parallel.
pub(super) fn sort_above(
    bits: u32,
    numbers: &mut Vec<u64>,
    work: Work<'_>,
) -> Result<(), Cancelled> {
    if numbers.len() <= FEW {
        numbers.sort_unstable();
        return work.done();
    }
    let mut moved = huge_pages::zeros(numbers.len());
    let shifts = (bits..u64::BITS).step_by(DIGIT_BITS as usize);
    let pass = work.part(1, shifts.len());
    for shift in shifts {
        if move_by_digit(shift, numbers, &mut moved, work)? {
            std::mem::swap(numbers, &mut moved);
        }
        pass.done()?;
    }
    Ok(())
}

/// The same of a part of a list.
pub(super) fn sort_slice_above(
    bits: u32,
    numbers: &mut [u64],
    work: Work<'_>,
) -> Result<(), Cancelled> {
    if numbers.len() <= FEW {
        numbers.sort_unstable();
        return Ok(());
    }
    let mut sorted = numbers.to_vec();
    sort_above(bits, &mut sorted, work)?;
    numbers.copy_from_slice(&sorted);
    Ok(())
}

/// Copies all numbers to another place, ordered by one digit and else as before. Copies none, and says so, if all have the same digit.
fn move_by_digit(
    shift: u32,
    from: &[u64],
    to: &mut [u64],
    work: Work<'_>,
) -> Result<bool, Cancelled> {
    let digit = |number: u64| (number >> shift) as usize % DIGITS;
    let pieces = from.len().div_ceil(PIECE).min(parallel::threads());
    let piece = from.len().div_ceil(pieces);
    let counts = parallel::map_pieces(from, piece, |numbers| {
        let mut counts = vec![0u32; DIGITS];
        for stretch in numbers.chunks(STRETCH) {
            if work.ask().is_err() {
                break;
            }
            stretch.iter().for_each(|&number| counts[digit(number)] += 1);
        }
        counts
    });
    work.check()?;
    let first = digit(from[0]);
    if counts.iter().map(|counts| counts[first] as usize).sum::<usize>() == from.len() {
        return Ok(false);
    }

    // Every piece has a place of its own for each value of the digit, behind those of the pieces before it.
    let mut places: Vec<_> = counts.iter().map(|_| Vec::with_capacity(DIGITS)).collect();
    let mut rest = to;
    for value in 0..DIGITS {
        for (places, counts) in places.iter_mut().zip(&counts) {
            let (place, behind) = rest.split_at_mut(counts[value] as usize);
            places.push(place.iter_mut());
            rest = behind;
        }
    }
    let tasks = from.chunks(piece).zip(places).collect();
    parallel::map_tasks(tasks, |(numbers, mut places)| {
        for stretch in numbers.chunks(STRETCH) {
            if work.ask().is_err() {
                return;
            }
            for &number in stretch {
                if let Some(place) = places[digit(number)].next() {
                    *place = number;
                }
            }
        }
    });
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_sorted_by_their_upper_bits_alone() {
        let mut state = 1u64;
        for (count, mask) in [
            (0, u64::MAX),
            (1, u64::MAX),
            (FEW, u64::MAX),
            (FEW + 1, u64::MAX),
            (300_001, u64::MAX),
            // Most digits the same, or all.
            (300_001, 0xff << 40),
            (300_001, 0x3 << 62),
            (300_001, 0),
        ] {
            let mut numbers: Vec<u64> = (0..count)
                .map(|place| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    state & mask & !0x7fff_ffff | place as u64
                })
                .collect();
            let mut expected = numbers.clone();
            expected.sort();
            sort_above(31, &mut numbers, Work::UNWATCHED).expect("nobody stops it");
            assert!(numbers == expected, "{count} numbers, mask {mask:x}");
        }
    }
}
