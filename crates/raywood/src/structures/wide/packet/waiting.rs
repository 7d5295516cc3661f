//! The rays of a piece that no packet has taken yet.

use super::{ALL, GROUP};
use crate::Ray;
use crate::structures::wide::source::Source;

/// A bit for each of sixteen times sixteen rays.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    pub(super) rays: [u32; GROUP],
}

impl Waiting {
    /// The first rays.
    #[inline(always)]
    pub(super) fn first(count: usize) -> Self {
        let mut rays = [0; GROUP];
        for (group, rays) in rays.iter_mut().enumerate() {
            let here = count.saturating_sub(group * GROUP).min(GROUP);
            *rays = (1 << here) - 1;
        }
        Self { rays }
    }

    /// How many there are.
    #[inline(always)]
    pub(super) fn count(&self) -> u32 {
        self.rays.iter().map(|rays| rays.count_ones()).sum()
    }

    /// Without those that a packet has.
    #[inline(always)]
    pub(super) fn without(&self, members: &[u32; GROUP]) -> Self {
        let mut rays = self.rays;
        for (rays, members) in rays.iter_mut().zip(members) {
            *rays &= !members;
        }
        Self { rays }
    }

    /// Appends their numbers, counted from `first`.
    #[inline]
    pub(super) fn append_to(&self, numbers: &mut Vec<usize>, first: usize) {
        for (group, &rays) in self.rays.iter().enumerate() {
            let first = first + group * GROUP;
            if rays == ALL {
                // As where nothing has anything in common: soon done.
                numbers.extend(first..first + GROUP);
            } else {
                numbers.extend(
                    (0..GROUP).filter(|lane| rays >> lane & 1 == 1).map(|lane| first + lane),
                );
            }
        }
    }

    /// The one that comes after `before` others.
    #[inline]
    fn nth(&self, mut before: usize) -> usize {
        for (group, rays) in self.rays.iter().enumerate() {
            let here = rays.count_ones() as usize;
            if before < here {
                let mut rays = *rays;
                for _ in 0..before {
                    rays &= rays - 1;
                }
                return group * GROUP + rays.trailing_zeros() as usize;
            }
            before -= here;
        }
        0
    }
}

/// Rays by their number among those that wait.
pub(super) struct Waiters<'a, R> {
    rays: &'a R,
    waiting: &'a Waiting,
    pub(super) count: usize,
}

impl<'a, R: Source> Waiters<'a, R> {
    #[inline(always)]
    pub(super) fn new(rays: &'a R, waiting: &'a Waiting) -> Self {
        Self { rays, waiting, count: waiting.count() as usize }
    }

    /// What is known of all rays.
    #[inline(always)]
    pub(super) fn source(&self) -> &R {
        self.rays
    }

    #[inline(always)]
    pub(super) fn ray(&self, number: usize) -> Ray {
        let all = self.count == self.rays.len();
        self.rays.ray(if all { number } else { self.waiting.nth(number) })
    }
}
