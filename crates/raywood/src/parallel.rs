//! The few parallel forms that builds and batches use: in the caller's rayon pool with the feature `rayon`, on the calling
//! thread without. Every one gives the same result for any number of threads.

#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::build::{Cancelled, Work};
use crate::simd::huge_pages;
use crate::{HitColumnsMut, Vec3};

/// How many items a task handles at least: enough that handing it out costs nothing in comparison.
const GRAIN: usize = 4096;

/// Pieces of a batch are multiples of this: rays that are traced together as a packet are the same ones for any number of threads, and packets of
/// other rays may round differently.
#[cfg(feature = "rayon")]
const PACKET: usize = 256;

/// Runs both closures, in parallel if `parallel` holds, and returns what they return.
pub(crate) fn join_if<A: Send, B: Send>(
    parallel: bool,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "rayon")]
    if parallel {
        return rayon::join(a, b);
    }
    let _ = parallel;
    (a(), b())
}

/// The results of `f` for each piece of so many items, in order.
pub(crate) fn map_pieces<T: Sync, A: Send>(
    items: &[T],
    piece: usize,
    f: impl Fn(&[T]) -> A + Send + Sync,
) -> Vec<A> {
    #[cfg(feature = "rayon")]
    return items.par_chunks(piece).map(f).collect();
    #[cfg(not(feature = "rayon"))]
    items.chunks(piece).map(f).collect()
}

/// The results of `f` for a few large tasks, in order.
pub(crate) fn map_tasks<T: Send, A: Send>(
    tasks: Vec<T>,
    f: impl Fn(T) -> A + Send + Sync,
) -> Vec<A> {
    #[cfg(feature = "rayon")]
    return tasks.into_par_iter().map(f).collect();
    #[cfg(not(feature = "rayon"))]
    tasks.into_iter().map(f).collect()
}

/// The results of `f` for 0 to `n-1`, in order.
pub(crate) fn map<T: Send>(n: usize, f: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    #[cfg(feature = "rayon")]
    return (0..n).into_par_iter().with_min_len(GRAIN).map(f).collect();
    #[cfg(not(feature = "rayon"))]
    (0..n).map(f).collect()
}

/// The same of a build that may be watched.
pub(crate) fn map_watched<T: Send>(
    n: usize,
    work: Work<'_>,
    f: impl Fn(usize) -> T + Send + Sync,
) -> Result<Vec<T>, Cancelled> {
    let mut results = huge_pages::vec_for(n);
    work.in_stretches(n, |stretch| {
        #[cfg(feature = "rayon")]
        results.par_extend(stretch.into_par_iter().with_min_len(GRAIN).map(&f));
        #[cfg(not(feature = "rayon"))]
        results.extend(stretch.map(&f));
    })?;
    Ok(results)
}

/// How many threads there are. For how work is divided, never for what comes out.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "rayon")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "rayon"))]
    1
}

/// Folds a slice in pieces and merges these into one; `step` and `merge` must not care about order.
pub(crate) fn fold<T: Sync, A: Clone + Send + Sync>(
    items: &[T],
    start: A,
    step: impl Fn(&mut A, &T) + Sync,
    merge: impl Fn(&mut A, &A) + Sync,
) -> A {
    // In place: an accumulator may be large.
    let fold_piece = |piece: &[T]| {
        let mut accumulator = start.clone();
        piece.iter().for_each(|item| step(&mut accumulator, item));
        accumulator
    };
    #[cfg(feature = "rayon")]
    if items.len() > 2 * GRAIN {
        let mut pieces: Vec<A> = items.par_chunks(GRAIN).map(fold_piece).collect();
        let (whole, rest) = pieces.split_at_mut(1);
        rest.iter().for_each(|piece| merge(&mut whole[0], piece));
        return pieces.swap_remove(0);
    }
    let _ = (merge, GRAIN);
    fold_piece(items)
}

/// Folds the numbers from 0 to `n-1` in pieces and merges these into one; `step` and `merge` must not care about order. For a build that may be watched.
pub(crate) fn fold_numbers<A: Copy + Send + Sync>(
    n: usize,
    work: Work<'_>,
    start: A,
    step: impl Fn(&mut A, usize) + Sync,
    merge: impl Fn(&mut A, &A) + Sync,
) -> Result<A, Cancelled> {
    let mut whole = start;
    work.in_stretches(n, |stretch| {
        let fold_piece = |piece: usize| {
            let first = stretch.start + piece * GRAIN;
            let mut accumulator = start;
            (first..stretch.end.min(first + GRAIN)).for_each(|i| step(&mut accumulator, i));
            accumulator
        };
        let pieces = 0..stretch.len().div_ceil(GRAIN);
        #[cfg(feature = "rayon")]
        let pieces: Vec<A> = pieces.into_par_iter().map(fold_piece).collect();
        #[cfg(not(feature = "rayon"))]
        let pieces = pieces.map(fold_piece);
        pieces.into_iter().for_each(|piece| merge(&mut whole, &piece));
    })?;
    Ok(whole)
}

/// Has `fill` write pieces of a list, whose first place it is told, and merges in their order what it returns of each. For a build that may be watched.
pub(crate) fn fill_pieces_and_fold<T: Send, A: Copy + Send + Sync>(
    places: &mut [T],
    work: Work<'_>,
    start: A,
    fill: impl Fn(usize, &mut [T]) -> A + Sync,
    merge: impl Fn(&mut A, &A) + Sync,
) -> Result<A, Cancelled> {
    let mut whole = start;
    work.in_stretches(places.len(), |stretch| {
        let first = stretch.start;
        let fill = |(piece, places): (usize, &mut [T])| fill(first + piece * GRAIN, places);
        #[cfg(feature = "rayon")]
        let pieces: Vec<A> = places[stretch].par_chunks_mut(GRAIN).enumerate().map(fill).collect();
        #[cfg(not(feature = "rayon"))]
        let pieces = places[stretch].chunks_mut(GRAIN).enumerate().map(fill);
        pieces.into_iter().for_each(|piece| merge(&mut whole, &piece));
    })?;
    Ok(whole)
}

/// Has `f` write the outputs beside a piece of the inputs, piece by piece. Both slices have the same length.
pub(crate) fn fill_pieces<I: Sync, O: Send>(
    inputs: &[I],
    outputs: &mut [O],
    f: impl Fn(&[I], &mut [O]) + Sync,
) {
    debug_assert_eq!(inputs.len(), outputs.len());
    #[cfg(feature = "rayon")]
    {
        // Pieces large enough that filling pipelines at their beginning costs little, small enough that all threads have some.
        let threads = rayon::current_num_threads();
        let piece = inputs.len().div_ceil(4 * threads).clamp(1, 4096).next_multiple_of(PACKET);
        inputs.par_chunks(piece).zip(outputs.par_chunks_mut(piece)).for_each(|(i, o)| f(i, o));
    }
    #[cfg(not(feature = "rayon"))]
    f(inputs, outputs);
}

/// Has `f` write the outputs beside pieces of so many inputs. Both slices have the same length.
pub(crate) fn fill_chunks<I: Sync, O: Send>(
    inputs: &[I],
    outputs: &mut [O],
    size: usize,
    f: impl Fn(&[I], &mut [O]) + Sync,
) {
    debug_assert_eq!(inputs.len(), outputs.len());
    #[cfg(feature = "rayon")]
    inputs.par_chunks(size).zip(outputs.par_chunks_mut(size)).for_each(|(i, o)| f(i, o));
    #[cfg(not(feature = "rayon"))]
    inputs.chunks(size).zip(outputs.chunks_mut(size)).for_each(|(i, o)| f(i, o));
}

/// Has `f` write the hits of a piece of the directions, piece by piece. There are as many of both.
pub(crate) fn fill_columns(
    directions: &[Vec3],
    hits: HitColumnsMut<'_>,
    f: &(impl Fn(&[Vec3], HitColumnsMut<'_>) + Sync),
) {
    #[cfg(feature = "rayon")]
    if directions.len() > PIECE_OF_COLUMNS {
        let half = (directions.len() / 2).next_multiple_of(PACKET);
        let (first, second) = directions.split_at(half);
        let (first_hits, second_hits) = hits.split_at(half);
        rayon::join(|| fill_columns(first, first_hits, f), || fill_columns(second, second_hits, f));
        return;
    }
    f(directions, hits);
}

/// As many rays as a task takes at most: more of them would not be shared out evenly, fewer would often prepare for packets.
#[cfg(feature = "rayon")]
const PIECE_OF_COLUMNS: usize = 16 * PACKET;

/// Writes `f` of each input to the output beside it. Both slices have the same length.
pub(crate) fn fill<I: Sync, O: Send>(inputs: &[I], outputs: &mut [O], f: impl Fn(&I) -> O + Sync) {
    debug_assert_eq!(inputs.len(), outputs.len());
    #[cfg(feature = "rayon")]
    inputs
        .par_iter()
        .zip_eq(outputs)
        .with_min_len(16)
        .for_each(|(input, output)| *output = f(input));
    #[cfg(not(feature = "rayon"))]
    for (input, output) in inputs.iter().zip(outputs) {
        *output = f(input);
    }
}

/// Sorts a slice. The order must be total, so that there is only one result.
pub(crate) fn sort_unstable_by<T: Send>(
    items: &mut [T],
    compare: impl Fn(&T, &T) -> std::cmp::Ordering + Sync,
) {
    #[cfg(feature = "rayon")]
    if items.len() > 2 * GRAIN {
        items.par_sort_unstable_by(compare);
        return;
    }
    items.sort_unstable_by(compare);
}
