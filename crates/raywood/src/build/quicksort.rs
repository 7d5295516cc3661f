//! Selecting and sorting large lists in a build that may be stopped at any time, which the standard library's forms do not allow. Hoare, "Algorithm 64: Quicksort" and
//! "Algorithm 65: Find", Communications of the ACM 1961; pivots from samples after Floyd and Rivest 1975.

use std::cmp::Ordering;

use super::driver::partition_stretch;
use super::{Cancelled, Work};
use crate::parallel;

/// Shorter lists are left to the standard library.
const SHORT: usize = 1 << 16;

/// How many items of a list are looked at to choose one that divides it.
const SAMPLE: usize = 63;

/// After so many passes the pivots are known to be bad, and the standard library, which is never slow, takes over.
const MOST_PASSES: usize = 64;

/// Puts that item in place `nth` which would be there if all were sorted, lesser ones before and greater ones behind it. The order must be total. O(n).
///
/// Where the others come to lie depends on nothing but the items.
pub(super) fn select<T: Copy>(
    mut items: &mut [T],
    mut nth: usize,
    work: Work<'_>,
    compare: impl Fn(&T, &T) -> Ordering,
) -> Result<(), Cancelled> {
    for _ in 0..MOST_PASSES {
        if items.len() <= SHORT {
            break;
        }
        let place = partition(items, nth, work, &compare)?;
        match nth.cmp(&place) {
            Ordering::Less => items = &mut items[..place],
            Ordering::Equal => return Ok(()),
            Ordering::Greater => {
                items = &mut items[place + 1..];
                nth -= place + 1;
            }
        }
    }
    items.select_nth_unstable_by(nth, compare);
    Ok(())
}

/// Sorts a list, in parallel. The order must be total, so that there is only one result.
pub(super) fn sort<T: Copy + Send>(
    items: &mut [T],
    work: Work<'_>,
    compare: impl Fn(&T, &T) -> Ordering + Sync,
) -> Result<(), Cancelled> {
    if work.is_watched() {
        return sort_in_passes(items, MOST_PASSES, work.without_progress(), &compare);
    }
    parallel::sort_unstable_by(items, compare);
    Ok(())
}

fn sort_in_passes<T: Copy + Send>(
    items: &mut [T],
    passes: usize,
    work: Work<'_>,
    compare: &(impl Fn(&T, &T) -> Ordering + Sync),
) -> Result<(), Cancelled> {
    work.check()?;
    if items.len() <= SHORT || passes == 0 {
        items.sort_unstable_by(compare);
        return work.ask();
    }
    let place = partition(items, items.len() / 2, work, compare)?;
    let (lesser, greater) = items.split_at_mut(place);
    let (lesser, greater) = parallel::join_if(
        true,
        || sort_in_passes(lesser, passes - 1, work, compare),
        || sort_in_passes(&mut greater[1..], passes - 1, work, compare),
    );
    lesser.and(greater)
}

/// Divides a list by an item that would probably come to lie near place `nth`, and tells where it lies: lesser ones before it, the others behind.
fn partition<T: Copy>(
    items: &mut [T],
    nth: usize,
    work: Work<'_>,
    compare: &impl Fn(&T, &T) -> Ordering,
) -> Result<usize, Cancelled> {
    let step = items.len() / SAMPLE;
    let mut sample = [0; SAMPLE];
    for (number, place) in sample.iter_mut().enumerate() {
        *place = number * step + step / 2;
    }
    sample.sort_unstable_by(|&a, &b| compare(&items[a], &items[b]));
    let last = items.len() - 1;
    items.swap(sample[nth * SAMPLE / items.len()], last);

    let pivot = items[last];
    let mut lesser = 0;
    work.without_progress().in_stretches(last, |stretch| {
        let is_less = |item: &T| compare(item, &pivot).is_lt();
        lesser = partition_stretch(items, lesser, stretch, is_less);
    })?;
    items.swap(lesser, last);
    Ok(lesser)
}

#[cfg(test)]
mod tests {
    use super::super::watched;
    use super::*;
    use crate::BuildError;
    use std::ops::ControlFlow;

    /// Numbers in different orders, each once.
    fn lists() -> Vec<Vec<u32>> {
        let n = 5 * SHORT as u32 + 7;
        let shuffled = (0..n).map(|i| (u64::from(i) * 611_953 % u64::from(n)) as u32).collect();
        let pipes = (0..n).map(|i| if i % 2 == 0 { i } else { n - i - n % 2 }).collect();
        vec![(0..n).collect(), (0..n).rev().collect(), shuffled, pipes, vec![3, 1, 2]]
    }

    #[test]
    fn the_nth_item_comes_to_its_place() {
        for list in lists() {
            let last = list.len() - 1;
            for nth in [0, 1, last / 3, last / 2, last] {
                let mut items = list.clone();
                select(&mut items, nth, Work::UNWATCHED, u32::cmp).expect("nobody stops it");
                assert_eq!(items[nth], nth as u32 + u32::from(last == 2));
                assert!(items[..nth].iter().all(|item| *item < items[nth]));
                assert!(items[nth + 1..].iter().all(|item| *item > items[nth]));
                items.sort_unstable();
                let mut list = list.clone();
                list.sort_unstable();
                assert!(items == list, "all items are still there");
            }
        }
    }

    #[test]
    fn watched_or_not_the_order_is_the_same() {
        for list in lists() {
            let (mut selected, mut sorted) = (list.clone(), list.clone());
            let nth = list.len() / 3;
            let result = watched(
                |_| ControlFlow::Continue(()),
                |work| {
                    select(&mut selected, nth, work, u32::cmp)?;
                    Ok(sort(&mut sorted, work, u32::cmp)?)
                },
            );
            assert_eq!(result, Ok(()));
            let (mut items, mut expected) = (list.clone(), list);
            select(&mut items, nth, Work::UNWATCHED, u32::cmp).expect("nobody stops it");
            assert!(selected == items);
            sort(&mut expected, Work::UNWATCHED, u32::cmp).expect("nobody stops it");
            assert!(sorted == expected && sorted.is_sorted());
        }
    }

    #[test]
    fn equal_items_do_not_hang() {
        let mut items = vec![1; 3 * SHORT];
        select(&mut items, SHORT, Work::UNWATCHED, u32::cmp).expect("nobody stops it");
        let mut asked = 0;
        let stop_soon = |_| {
            asked += 1;
            if asked > 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let stopped = watched(stop_soon, |work| Ok(sort(&mut items, work, u32::cmp)?));
        assert_eq!(stopped, Err(BuildError::Cancelled));
    }
}
